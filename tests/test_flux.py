"""The polymer flux of every closure, and the time that the network has to contract."""

import numpy as np
import pytest

from spinline import network as net
from spinline.jetprofile import PowerLaw


@pytest.mark.parametrize("closure", ["force", "stretch"])
@pytest.mark.parametrize("phi", [0.01, 0.05, 0.1, 0.2, 0.3, 0.5])
def test_the_flux_closes(closure, phi):
    """phi_p u (r_P/r)^2 = phi V: under "stretch" it was 0.9926 ... 0.796 for phi = 0.05 ... 0.3, divided by the other closure's rest."""
    v = np.geomspace(1, 30, 60)
    for w, lam, nu in ((v, None, None), (v * 0.8, None, None), (v * 1.3, v**0.6, None), (v, v**0.5, 1 / (1 + v / 10))):
        n = net.network_state(w, v, phi, strand_stretch=lam, entanglements_left=nu, closure=closure)
        carried = n.core_polymer_fraction_conservative * n.flux_velocity_ratio * n.network_radius_ratio_conservative**2
        np.testing.assert_allclose(carried, phi * v, rtol=1e-10)
        if closure == "stretch":  # it is the network's own velocity that carries it
            np.testing.assert_array_equal(n.flux_velocity_ratio, w)
        dried = net.dried_state(n, v, phi, 0.7)
        carried = (
            dried.core_polymer_fraction_conservative
            * dried.flux_velocity_ratio
            * dried.network_radius_ratio_conservative**2
        )
        np.testing.assert_allclose(carried * 0.7, phi * v, rtol=1e-10)


def test_at_rest_every_closure_has_the_solution():
    for closure in ("force", "stretch"):
        n = net.network_state(1.0, 1.0, 0.2, closure=closure)
        assert float(n.core_polymer_fraction_conservative) == pytest.approx(0.2, rel=1e-14)
        assert float(n.network_radius_ratio_conservative) == pytest.approx(1.0, rel=1e-14)
        assert float(n.flux_velocity_ratio) == pytest.approx(1.0, rel=1e-14)


def test_rungs_meet_where_they_agree():
    """One formula for the flux of all: where strands do not relax and do not slip, it is the affine one."""
    v = np.geomspace(1, 25, 40)
    affine = net.affine_network(v, 0.05)
    near = net.network_state(v * (1 + 1e-6), v, 0.05, strand_stretch=v * (1 - 1e-6))
    for name in (
        "core_polymer_fraction_conservative",
        "network_radius_ratio_conservative",
        "core_polymer_fraction",
        "flux_velocity_ratio",
    ):
        np.testing.assert_allclose(getattr(near, name), getattr(affine, name), rtol=2e-5)


def test_strands_that_have_joined_are_farther_from_their_contour():
    n = net.network_state(10.0, 10.0, 0.05, entanglements_left=[1.0, 0.25])
    assert n.conformation.relative_extension[1] == pytest.approx(float(net.random_walk(10.0, 0.025).relative_extension))
    assert (np.diff(n.conformation.relative_extension) < 0).all()
    assert (np.diff(n.core_polymer_fraction) < 0).all()


def test_no_time_to_contract():
    """PEO 5 wt% at its crossover: Eq. (39) has 0.25, the lateral equation 1, for every F from 1e-3 to 1e3."""
    jet = PowerLaw(radius=125e-6, flow_rate=8.9e-10, k=1.0, beta=0.47)
    phi = 0.0444
    end = float(jet.position_of(1 / phi))
    z = np.linspace(0, end, 201)
    v = jet.velocity_ratio(z)
    walk = net.affine_network(v, phi).conformation
    q = walk.radial_contraction / walk.radial_contraction[0]
    assert float(q[-1]) == pytest.approx(0.25, abs=0.002)
    assert float(q[-1] * np.sqrt(v[-1])) == pytest.approx(1.19, abs=0.01)
    assert float(net.lateral_limit(q[-1], v[-1])) == 1.0
    time = net.lateral_time(jet.residence_time(z), 1e4, jet.initial_velocity / jet.initial_radius)
    assert 1e-4 < float(time[-1]) < 1e-2
    for scale in (1.0, 1e3, 1e6):
        across = net.lateral_network(scale * time, v, q, phi)
        assert float(across.radius_ratio[-1]) == pytest.approx(1.0, abs=2e-3)


def test_from_which_fraction_on_the_limit_contracts_at_the_crossover():
    """q V^(1/2) at V_S passes 1 at phi = 0.062 for q = xi_perp/xi_0, at 0.0636 for the size over that at rest."""
    at = []
    for phi in (0.061, 0.063, 0.0645):
        walk = net.random_walk([1.0, 1 / phi], phi).radial_contraction
        at.append(float(walk[1] / walk[0] / np.sqrt(phi)))
    assert at[0] > at[1] > 1 > at[2]
    assert at[0] * np.tanh(0.183) / 0.183 > 1 > at[1] * np.tanh(0.189) / 0.189
