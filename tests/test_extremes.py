"""Extremes of the closed forms: a number within bounds, or an InputError; no warning, nothing between."""

import contextlib

import mpmath
import numpy as np
import pytest

from spinline import jetprofile, network, rheology, xray
from spinline.base.errors import InputError

VALUES = [
    0.0,
    1e-300,
    1e-100,
    1e-12,
    0.5,
    1.0,
    1e12,
    1e150,
    1e300,
    -1.0,
    np.nan,
    np.inf,
    [],
    [0.5],
    np.full(1000, 0.5),
    np.float32(0.5),
    "x",
    None,
]
FUNCTIONS = [
    (network.random_walk, ("velocity_ratio", "volume_fraction")),
    (network.stretched_walk, ("stretch", "volume_fraction")),
    (network.affine_network, ("velocity_ratio", "volume_fraction")),
    (network.network_state, ("network_velocity_ratio", "velocity_ratio", "volume_fraction")),
    (network.network_at_rest, ("volume_fraction",)),
    (network.crossover_velocity_ratio, ("volume_fraction",)),
    (network.compaction_velocity_ratio, ("volume_fraction",)),
    (network.extension_velocity_ratio, ("extension", "volume_fraction")),
    (network.segment_time, ("viscosity", "kuhn_length", "temperature")),
    (network.affinity, ("mesh_size", "velocity", "viscosity", "kuhn_length", "temperature")),
    (network.elastic_coupling, ("effective_size", "velocity", "viscosity", "radius", "temperature")),
    (network.strand_force, ("force", "kuhn_length", "temperature")),
    (jetprofile.estimate_k, ("radius", "flow_rate", "conductivity", "viscosity", "electric_field")),
    (xray.thin_mean_limit, ("radius", "contrast", "photons", "pixel")),
    (xray.thin_centre_limit, ("radius", "contrast", "photons")),
    (rheology.polymer, ("name",)),
    (rheology.solvent_density, ("name", "temperature")),
]


@pytest.mark.parametrize(("function", "names"), FUNCTIONS, ids=lambda f: getattr(f, "__name__", ""))
def test_a_number_or_a_named_error(function, names: tuple[str, ...]) -> None:
    answered = 0
    for name in names:
        for value in VALUES:
            with contextlib.suppress(InputError):  # any other exception, or a RuntimeWarning, fails
                function(**(dict.fromkeys(names, 0.5) | {name: value}))
                answered += 1
    assert answered or function in (rheology.polymer, rheology.solvent_density)


def test_the_walk_where_the_force_cancels() -> None:
    """At V -> 0 the affine force is f_0 V to the last bit, though 1 + (V - 1) rounds to 0."""
    walk = network.random_walk([1e-100, 1e-30, 1e-17], 0.05)
    np.testing.assert_allclose(walk.force, 0.15 * np.array([1e-100, 1e-30, 1e-17]), rtol=1e-15)
    assert (walk.axial_stretch > 0).all()


@pytest.mark.parametrize(
    ("radius", "contrast"), [(1e-300, 1e-100), (1e-120, 1e100), (5e-5, 300.0), (1e120, 1e-100), (1e300, 1e-300)]
)
def test_thin_limits_do_not_pass_through_the_cube_of_the_radius(radius: float, contrast: float) -> None:
    with mpmath.workdps(30):
        r, d = mpmath.mpf(radius), mpmath.mpf(contrast)
        mean = 1 / (d * mpmath.sqrt(16 * 1e4 * r**3 / 3))
        centre = 1 / (2 * r * d * 100)
    for law, exact, more in ((xray.thin_mean_limit, mean, (1.0,)), (xray.thin_centre_limit, centre, ())):
        if exact > 1e308:
            with pytest.raises(InputError, match="limit"):
                law(radius, contrast, 1e4, *more)
        else:
            assert float(law(radius, contrast, 1e4, *more)) == pytest.approx(float(exact), rel=1e-14)
