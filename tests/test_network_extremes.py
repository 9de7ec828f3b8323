"""The network's objects at the extremes: a number or a named error for every argument; random draws over the whole box."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from spinline import network as net
from spinline.base.errors import InputError
from spinline.jetprofile import PowerLaw

VALUES = [
    *(0.0, 1e-300, 1e-100, 1e-12, 0.5, 1.0, 3, 1e12, 1e150, 1e300, -1.0, np.nan, np.inf),
    *([], [0.5], np.full(1000, 0.5), np.float32(0.5), "x", None, True),
]


def linear(s):
    return 1 + 0.1 * s


@pytest.fixture(scope="module")
def cases():
    """Functions and methods, each with arguments that work."""
    jet = PowerLaw(radius=125e-6, flow_rate=1e-9, k=1.0, beta=0.47)
    flow = net.Flow.from_profiles([linear], [0.0], 4.0)
    chain = net.Chain(flow=flow, spacing=0.2, coupling=100.0)
    result = net.run_chain(chain, 2.0)
    steady = net.steady_network(linear, 10.0, coupling=10.0, spring=1.0)
    fene = net.Tension.of("fene", 20.0)
    strand = net.uniform_strand(50, 0.5, 0.1)
    sample = net.sample_strands(strand, 100, 1)
    return [
        (net.Flow.from_profiles, {"profiles": [linear], "times": [0.0], "length": 4.0, "rtol": 1e-6, "kinks": ()}),
        (lambda **k: net.Flow.switching(jet, jet, **k), {"length": 4.0, "at": 1.0, "over": 1.0, "rtol": 1e-6}),
        (net.Flow.from_jet, {"jet": jet, "length": 4.0, "rtol": 1e-6}),
        (flow.velocity_ratio, {"position": 1.0, "time": 0.0}),
        (flow.residence_time, {"position": 1.0, "time": 0.0}),
        (
            net.Chain,
            {
                "flow": flow,
                "spacing": 0.2,
                "coupling": 100.0,
                "spring": 1.0,
                "inertia": 0.0,
                "law": "fene",
                "contour": 5.0,
                "coarse_grain": 1.0,
            },
        ),
        (
            lambda **k: net.run_chain(chain, **k),
            {
                "until": 1.0,
                "start": "empty",
                "rtol": 1e-3,
                "time_step": 0.1,
                "accurate_to": 3.0,
                "output_times": (),
                "most_steps": 50,
            },
        ),
        (lambda **k: net.run_chain(until=1.0, **k), {"chain": chain}),
        (net.start_from, {"chain": chain, "positions": [1.0, 0.5, 0.0, -0.2]}),
        (net.affine_start, {"chain": chain}),
        (net.empty_start, {"chain": chain}),
        (lambda **k: net.coarse_graining_error(until=1.0, **k), {"chain": chain, "position": 0.5, "rtol": 1e-3}),
        (result.stretch_at, {"position": 0.5}),
        (net.eq33, {"velocity_ratio": 1.0, "slope": 0.1, "eps": 0.1}),
        (
            net.steady_network,
            {
                "velocity_ratio": linear,
                "length": 10.0,
                "coupling": 10.0,
                "spring": 1.0,
                "inertia": 0.0,
                "law": None,
                "breaks": (),
                "rtol": 1e-6,
            },
        ),
        (steady.tension, {"s": 1.0}),
        (steady.stretch, {"s": 1.0}),
        (steady.first_passage, {"stretch": 1.5}),
        (steady.relative_extension, {"s": 1.0}),
        (net.Tension.of, {"law": "fene", "full_stretch": 20.0}),
        (net.Tension, {"law": "fene", "full_stretch": 20.0}),
        (fene.tension, {"stretch": 1.0}),
        (fene.stretch, {"tension": 1.0}),
        (net.radial_mesh, {"beads": 5, "kappa": 0.1, "mesh": 1.0}),
        (net.solve_radial_mesh, {"beads": 5, "kappa": 0.1, "mesh": 1.0}),
        (net.uniform_strand, {"segments": 5, "axial_force": 1.0, "lateral_force": 0.1}),
        (net.affine_strand, {"velocity_ratio": 2.0, "volume_fraction": 0.1, "affinity": 1.0}),
        (net.varying_strand, {"forces": np.ones((4, 3))}),
        (net.hydrodynamic_strand, {"end_force": 1.0, "hydrodynamic_force": np.ones(4), "lateral_force": 0.1}),
        (
            net.flow_strand,
            {
                "segments": 20,
                "end_force": 1.0,
                "lateral_force": 0.1,
                "flow_gradient": 0.01,
                "slip": 0.0,
                "tolerance": 1e-13,
                "most_iterations": 100,
            },
        ),
        (
            net.sample_strands,
            {"strand": strand, "strands": 10, "seed": 1, "first": 0, "threads": 1, "chunk": 100, "method": "auto"},
        ),
        (net.sample_paths, {"strand": strand, "strands": 3, "seed": 1, "first": 0}),
        (net.walk_moments, {"strand": strand}),
        (net.exact_law, {"strand": strand, "axes": ("z",)}),
        (net.sample_moments, {"sample": sample}),
        (net.sample_average, {"sample": sample, "function": lambda r: r[:, 2]}),
        (net.sample_histogram, {"sample": sample, "quantity": "z", "bins": 5}),
    ]


def test_a_number_or_a_named_error(cases) -> None:
    for function, good in cases:
        function(**good)
        for name in good:
            for value in VALUES:
                try:
                    function(**(good | {name: value}))
                except (InputError, net.ChainError):
                    continue
                except Exception as error:  # a RuntimeWarning too
                    pytest.fail(f"{function}: {name} = {value!r:.40}: {error!r}")


def test_refusals_name_the_field(cases) -> None:
    for function, good in cases:
        for name in set(good) & {"chain", "strand", "sample", "law", "profiles", "length", "function", "quantity"}:
            with pytest.raises(InputError, match=name):
                function(**(good | {name: -1.0}))


def campaign():
    path = Path(__file__).parent.parent / "benchmarks" / "draws_network.py"
    spec = importlib.util.spec_from_file_location("draws_network", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_random_draws_answer_or_refuse_by_name() -> None:
    """The first 60 of the campaign's 10,000 (benchmarks/draws_network.json), as the campaign judges them."""
    draws = campaign()
    counts, _, wrong = draws.campaign(draws.SEED, range(60), 600.0, 400)
    assert not wrong
    for part, by_law in counts.items():
        for law, counter in by_law.items():
            assert counter["answered"] >= (1 if part != "laws" or law == "linear" else 0), (part, law, counter)


@pytest.mark.parametrize("number", [309, 1008, 2529, 4568])
def test_massless_beads_keep_their_order_to_the_far_end(number: int) -> None:
    """Draws in which a long step turned beads round in the layer of the free end, where no error is controlled."""
    draws = campaign()
    drawn, profile, rng = draws.scene(draws.SEED, number)
    assert draws.outcome("chain", drawn, profile, rng.spawn(4)[3], 600.0, 400) == "answered"


def test_the_campaign_sees_what_is_wrong(monkeypatch) -> None:
    draws = campaign()
    monkeypatch.setitem(draws.PARTS, "laws", lambda *_: draws.bounded(np.array([0.5, 1.5]), 0, 1))
    counts, _, wrong = draws.campaign(draws.SEED, range(2), 600.0, 400, ("laws",))
    assert len(wrong) == 2
    assert counts["laws"]["linear"] == {"wrong": 1}
