"""The uncharged chain: exact steady jet, orders in space and time, conservation, free fall."""

import math
from dataclasses import replace

import numpy as np
import pytest
from spun_cases import AREA, material, orders, pvp, radii, rotating, spun

from spinline.base.errors import InputError
from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun.chain import parameters, start_cylinder
from spinline.jetprofile.spun.laws import JetLaw
from spinline.jetprofile.spun.steady import steady_jet

AT = np.array([0.05, 0.1, 0.2, 0.5, 1, 2, 4]) * 1e-2
# the steady equation at v0 = 600 cm/s, computed independently to 1e-12 (um)
FAST = np.array([49.603603, 49.236240, 48.567133, 46.887374, 44.685253, 41.464606, 37.349450]) * 1e-6


def test_fast_jet_is_the_steady_one():
    found = [radii(spun(pvp(length, 6.0, stress="given"), 12e-3), AT) for length in (8e-4, 4e-4, 2e-4, 1e-4)]
    worst = [np.abs(r / FAST - 1).max() for r in found]
    assert worst[2] < 1e-4  # l = 0.02 cm: 4.1e-5
    assert math.log2(worst[2] / worst[3]) > 1.85


@pytest.fixture(scope="module")
def slow():
    """Jet slower than its waves, settled, on three grids."""
    return [spun(pvp(length), 20e-3) for length in (2e-4, 1e-4, 5e-5)]


def test_slow_jet_second_order(slow):
    found = [radii(chain, AT) for chain in slow]
    assert orders(found).min() > 1.9
    assert np.abs(found[0] / found[2] - 1).max() < 3e-4


def test_slow_jet_is_the_smooth_passage(slow):
    """The tension that comes from inside is that of the steady jet through v = c."""
    settings = slow[1].settings
    steady = steady_jet(
        AT,
        density=settings.density,
        modulus=settings.law.modulus,
        relaxation_time=settings.law.relaxation_time,
        flow_rate=settings.inlet.flow_rate,
        radius=settings.inlet.radius,
        current=settings.inlet.charge_density * settings.inlet.flow_rate,
        field=settings.loads.field,
    )
    worst = [np.abs(radii(chain, AT) / steady.radius - 1).max() for chain in slow]
    assert worst[1] < 1e-4
    assert worst[1] / worst[2] > 3.5
    assert 2.2e-3 < steady.sonic < 2.4e-3


def test_no_zigzag(slow):
    y, n = slow[2].nodes, slow[2].n
    radius = np.sqrt(y[:n, c.VOLUME] / np.pi / -np.diff(y[:, c.X]))[::-1]
    third = np.abs(np.diff(radius[2:60], 3)) / 8
    assert third.max() < 5e-9  # m; 2.4e-11 measured


def test_momentum_balance_of_a_steady_jet(slow):
    """rho Q (v - v0) = P(x) - P(x0) + int f A dx between two nodes, to the scheme's order."""
    gaps = []
    for chain in slow:
        y, n, s = chain.nodes, chain.n, chain.settings
        length = -np.diff(y[:, c.X])
        pull = y[:n, c.VOLUME] / length * s.law.modulus * (y[:n, c.AZZ] - y[:n, c.ARR])
        force = s.inlet.charge_density * s.loads.field + s.density * s.loads.gravity
        first, last = (int(np.argmin(np.abs(y[:, c.X] - x))) for x in (4e-2, 2e-3))
        middle = 0.5 * (pull[1:] + pull[:-1])  # at nodes 1..n-1
        gained = s.density * s.inlet.flow_rate * (y[first, c.VX] - y[last, c.VX])
        done = middle[first - 1] - middle[last - 1] + force * y[first:last, c.VOLUME].sum()
        gaps.append(abs(gained / done - 1))
    assert gaps[0] < 3e-4
    assert gaps[2] < gaps[0]


def test_volume_and_charge_to_rounding(slow):
    for chain in slow:
        y, n, inlet = chain.nodes, chain.n, chain.settings.inlet
        came = AREA * inlet.length + inlet.flow_rate * chain.time
        assert y[:n, c.VOLUME].sum() == pytest.approx(came, rel=1e-12)
        assert y[:n, c.CHARGE].sum() == pytest.approx(inlet.charge_density * came, rel=1e-12)


def test_free_fall():
    s = pvp(2e-4, 1.0, 0.0)
    s = replace(s, law=JetLaw("ucm", 0.0, 1e-3), loads=replace(s.loads, field=0.0))
    chain = spun(s, 30e-3)
    y = chain.nodes[:-1]
    fast = y[:, c.VX] ** 2 / (1.0 + 2 * 9.80665 * y[:, c.X])
    lead = 1.0 * 30e-3 + 0.5 * 9.80665 * 30e-3**2 + 2e-3
    assert y[0, c.X] == pytest.approx(lead, rel=1e-13)
    inserted = slice(12, None)
    assert np.abs(fast[inserted] - 1).max() < 3e-4


def test_bent_chain_second_order_without_charge():
    """Nozzle on a circle, 10 ms: material points between the start's kinks and the nozzle."""
    at = np.array([0.4, 0.8, 1.0, 1.2, 1.4, 1.6]) * 1e-2
    found = []
    for length in (2e-4, 1e-4, 5e-5):
        chain = spun(rotating(pvp(length, tolerance=1e-8), 2000.0, ramp=1e-3), 10e-3)
        found.append(material(chain, at))
    assert orders(found).min() > 1.9


def test_error_control_holds_its_tolerance():
    """Dormand-Prince against itself at 1e-10, through more than 50 entries."""
    base = rotating(pvp(2e-4), 2000.0, ramp=1e-3)
    at = np.array([0.3, 0.8, 1.2, 1.5]) * 1e-2
    runs = {}
    for tol in (1e-4, 1e-6, 1e-10):
        chain = spun(replace(base, grid=replace(base.grid, tolerance=tol)), 10e-3)
        runs[tol] = material(chain, at)
    assert chain.clock[1] > 50
    for tol in (1e-4, 1e-6):
        assert np.abs(runs[tol] - runs[1e-10]).max() / chain.reach < 10 * tol


def test_order_in_time_through_entries():
    """Equal steps: the fifth order survives the entries."""
    base = rotating(pvp(8e-4), 2000.0, ramp=1e-3)
    at = np.array([0.3, 0.8, 1.2]) * 1e-2
    found = []
    for step in (4e-5, 2e-5, 1e-5, 2.5e-6):
        s = replace(base, grid=replace(base.grid, fixed_step=step))
        found.append(material(spun(s, 10e-3), at))
    errors = [np.abs(f - found[-1]).max() for f in found[:3]]
    assert math.log2(errors[1] / errors[2]) > 3.8


def test_what_cannot_be_followed_is_said():
    """A thread that its surface pulls back into the nozzle."""
    s = pvp(2e-4, 0.05, 0.0)
    s = replace(s, surface_tension=1.0, law=JetLaw("ucm", 10.0, 1e-3), loads=replace(s.loads, field=0.0, gravity=0.0))
    with pytest.raises(InputError, match="cannot be followed beyond"):
        spun(s, 50e-3)


@pytest.mark.parametrize(
    "law",
    [
        JetLaw("ucm", 1000.0, 1e-3),
        JetLaw("linear-maxwell", 3000.0, 1e-3),
        JetLaw("giesekus", 1000.0, 1e-3, mobility=0.3),
        JetLaw("fene-p", 1000.0, 1e-3, extensibility=100.0),
        JetLaw("herschel-bulkley", 3000.0, 1e-3, yield_stress=10.0, consistency=3.0, index=1.0),
    ],
)
def test_laws_agree_where_they_must(law):
    """Slow flow: every law is a Newtonian thread of extensional viscosity 3 Pa s."""
    s = pvp(2e-4, 1.0, 0.0)
    s = replace(s, law=law, loads=replace(s.loads, field=0.0), inlet=replace(s.inlet, length=2e-3))
    p, k = parameters(s)
    from spinline.jetprofile.spun._law_kernels import law_rates, stress_ratio

    azz, arr = 1.0, 1.0
    for _ in range(20000):
        zz, rr = law_rates(k[c.LAW], 1.0, azz, arr, law.modulus, law.relaxation_time, p)
        azz, arr = azz + 1e-6 * zz, arr + 1e-6 * rr
    bingham = 10.0 if law.name == "herschel-bulkley" else 0.0
    if bingham:
        bingham *= math.tanh(100.0 * law.relaxation_time)
    assert law.modulus * stress_ratio(k[c.LAW], azz, arr, p) == pytest.approx(3.0 + bingham, rel=6e-3)


def test_stiffness_is_the_derivative_of_the_tension():
    """rho c^2 A against a difference of P l; and the charge's part, 2 ln(L/r) - 3/2 with Maxwell's pressure."""
    from spinline.jetprofile.spun._law_kernels import stiffness, stress_ratio

    for law in (JetLaw("ucm", 1.0, 1.0), JetLaw("fene-p", 1.0, 1.0, extensibility=60.0)):
        p, k = parameters(replace(pvp(1e-4), law=law))

        def pull(length, azz=3.0, arr=0.7):
            return stress_ratio(k[c.LAW], azz * length**2, arr / length, p) / length  # noqa: B023

        h = 1e-6
        assert stiffness(k[c.LAW], 3.0, 0.7, p) == pytest.approx((pull(1 + h) - pull(1 - h)) / (2 * h), rel=1e-8)

    def charge(length, reach=1e3):
        return -((math.log(reach * math.sqrt(length))) - 0.5) / length**2

    slope = (charge(1 + 1e-6) - charge(1 - 1e-6)) / 2e-6
    assert slope == pytest.approx(2 * math.log(1e3) - 1.5, rel=1e-8)


def test_start_is_a_cylinder_of_the_given_length():
    for length in (1.7e-4, 2e-4, 5e-5):
        chain = start_cylinder(pvp(length))
        y, n = chain.nodes, chain.n
        assert y[0, c.X] == pytest.approx(2e-3, rel=1e-14)
        assert y[:n, c.VOLUME].sum() == pytest.approx(AREA * 2e-3, rel=1e-13)
        growing = y[n - 1, c.VOLUME] / (AREA * length)
        assert 0.499 < growing < 1.501
