"""The replica of JETSPIN's equations against runs of JETSPIN itself: the yardstick must be right before anything is held to it."""

import json
from pathlib import Path

import numpy as np
import pytest
from jetspin_replica import Beads, parameters

DATA = Path(__file__).parent / "data" / "jetspin"
PVP = (  # time s; x, y, z cm; stress; speed along x; beads: columns of the statout.dat of the run whose frames are in `DATA`
    (0.001, 0.7070069823, 0.03085789221, 0.006273478984, 25188.23228, 922.917381, 10.0),
    (0.002, 1.762615864, 0.08826466274, 0.01436486178, 11556.802, 1170.340627, 19.0),
    (0.003, 3.021116185, 0.1658800039, 0.02005705857, 8153.435913, 1338.125157, 28.0),
    (0.004, 4.427988764, 0.2553713024, 0.02380533489, 6348.218851, 1472.256186, 37.0),
    (0.005, 5.961115106, 0.351687942, 0.02661556448, 5104.212753, 1592.476803, 46.0),
)
STORED = json.loads((Path(__file__).parents[1] / "benchmarks" / "jetspin_replica.json").read_text())


def recorded(run, columns):
    """Rows of a run's statout.dat: time and the columns asked for."""
    rows = [row.split() for row in (DATA / run / "statout.dat").read_text().splitlines() if not row.startswith("#")]
    return np.array([[float(row[i].replace("Infinity", "inf")) for i in (1, *columns)] for row in rows])


def test_one_dimension_to_the_last_digits_printed():
    """JETSPIN's second example: its own scheme and step, bead by bead through eight releases."""
    p = parameters(
        gap=200.0,
        radius=1.5e-2,
        step=0.1,
        density=0.818912288,
        charge=3761.26389,
        viscosity=100.0,
        modulus=1e4,
        potential=277.8140832,
        tension=0.0,
        circle=0.0,
        speed=0.0,
        gravity=0.0,
    )
    jet = Beads.start(p)
    for time, x, stress, speed in recorded("ex2_1d_insert", (2, 3, 4))[1:7]:
        jet.fixed(time, 1e-6)
        assert [jet.y[0, 0], jet.y[0, 3], jet.y[0, 4]] == pytest.approx([x, stress, speed], rel=5e-9)
    assert jet.n == 8


def test_bending_jet_with_its_own_scheme():
    """The published PVP jet, Runge-Kutta at 1e-7 s as recorded: the first bead at 1, 2, ..., 5 ms."""
    jet = Beads.start(parameters())
    for time, x, y, z, stress, speed, beads in PVP:
        jet.fixed(time, 1e-7)
        assert jet.y[0, [0, 3, 4]] == pytest.approx([x, stress, speed], rel=3e-6)
        assert jet.y[0, 1:3] == pytest.approx([y, z], abs=1e-5 * np.hypot(y, z))
        assert jet.n + jet.coming == beads


def test_the_three_numbers_at_ten_milliseconds():
    """Without an error in time: x, distance from the axis, stress of the first bead, as computed independently before; JETSPIN's own
    runs at 1e-7 and 1e-8 s have 15.29814 and 15.29793, 0.87848 and 0.87862, 2395.141 and 2395.188.
    """
    jet = Beads.start(parameters())
    jet.adaptive(1e-2, 1e-8)
    assert [round(float(v), d) for v, d in zip(jet.front, (5, 5, 3), strict=True)] == [15.29790, 0.87865, 2395.183]
    assert jet.n == 89


def test_stored_costs():
    """Located releases and error control against Heun at 1e-7 s, the same equations in the same language."""
    assert STORED["times cheaper than Heun 1e-7"] >= 15
    chosen, heun = (STORED["schemes"][name] for name in ("Dormand-Prince 1e-6", "Heun 1e-7"))
    assert chosen["path error of the first bead, cm"] < 1e-4
    assert chosen["path error of the first bead, cm"] < heun["path error of the first bead, cm"]
    assert chosen["worst bead at 10 ms, cm"] < heun["worst bead at 10 ms, cm"]
    assert STORED["spun jet, 10 ms"]["elements"] >= 89
    assert STORED["spun jet, 10 ms"]["seconds"] < 1.0
