"""Radial drying: the cylinder series, conservation, both ends of the Peclet number, glass and skin, refusals."""

from itertools import pairwise

import numpy as np
import pytest

from spinline.base.errors import InputError
from spinline.jetprofile import PowerLaw
from spinline.rheology import vapour
from spinline.rheology.diffusion_laws import ConstantDiffusion, ExponentialDiffusion, FreeVolumeDiffusion
from spinline.rheology.drying import cylinder_series, dry_radially, drying_peclet
from spinline.rheology.element_path import straight_path
from spinline.rheology.evaporation import evaporate
from spinline.rheology.volatile import Volatile

pytestmark = pytest.mark.filterwarnings("ignore::spinline.base.errors.SpinlineWarning")
NU, SH, DA = 1.5e-5, 2.0, 2.5e-5
R0 = 1e-4
PLAIN = PowerLaw(radius=R0, flow_rate=np.pi * R0**2, k=1e-6, beta=1.0)  # 1 m/s, does not stretch for 100 m
THINNING = PowerLaw(radius=R0, flow_rate=np.pi * R0**2 * 0.1, k=0.5, beta=0.5)
D = 1e-6


def at_biot(biot: float, diffusion: float = D) -> Volatile:
    """Near dryness the activity is e u, hence Bi = e D_a Sh C/(2 D)."""
    return Volatile("x", 2 * diffusion * biot / (DA * SH * np.e), DA)


@pytest.mark.parametrize("biot", [1e-2, 1.0, 1e2])
def test_cylinder_series_second_order_and_1e_8_by_richardson(biot: float) -> None:
    phi0 = 1 - 2.0**-36  # so little solvent that the radius is constant; exact in binary
    first = (1 - phi0) / phi0
    fourier = np.array([0.05, 0.2, 0.5])
    path = straight_path(PLAIN, fourier * R0**2 / D)
    lost = []
    for cells in (20, 40, 80):
        dried = dry_radially(
            path,
            phi0,
            at_biot(biot),
            ConstantDiffusion(D),
            air_viscosity=NU,
            sherwood_floor=SH,
            cells=cells,
            rtol=1e-10,
        )
        lost.append(dried.lost / (phi0 * first))
    nodes, weights = np.polynomial.legendre.leggauss(60)
    profile = cylinder_series(np.sqrt(0.5 * (1 + nodes)), fourier[:, np.newaxis], biot)
    exact = 1 - np.sum(0.5 * weights * profile, axis=1)
    errors = [np.abs(value / exact - 1).max() for value in lost]
    assert min(np.log2(np.divide(errors[:-1], errors[1:]))) > 1.9
    once = [(4 * b - a) / 3 for a, b in pairwise(lost)]
    twice = (16 * once[1] - once[0]) / 15
    np.testing.assert_allclose(twice, exact, rtol=1e-8)
    # and the profile, at the cells' own radii
    x = np.sqrt(0.5 * (dried.edges[:, 1:] ** 2 + dried.edges[:, :-1] ** 2)) / R0
    u = (1 / dried.polymer_fraction - 1) / first
    np.testing.assert_allclose(u[:, :40], cylinder_series(x, fourier[:, np.newaxis], biot)[:, :40], rtol=3e-3)


def test_series_starts_full_and_decays() -> None:
    assert float(cylinder_series(0.5, 1e-3, 1.0)) == pytest.approx(1.0, abs=1e-10)
    # lumped limit: u = exp(-2 Bi Fo)
    assert float(cylinder_series(0.3, 50.0, 1e-6)) == pytest.approx(np.exp(-1e-4), rel=1e-6)
    assert float(cylinder_series(1.0, 0.1, 1e6)) < 1e-5


@pytest.mark.parametrize("decades", [-6, -3, 0, 3, 5, 6])
@pytest.mark.parametrize(
    "law", [ConstantDiffusion(1e-9), ExponentialDiffusion(1e-9, 5.0), FreeVolumeDiffusion(1e-12, 0.1, 0.05)]
)
def test_both_masses_are_conserved_at_any_peclet(decades: int, law) -> None:
    phi0 = 0.1
    dilute = float(law(np.array([phi0]))[0])
    x = Volatile("x", 2 * dilute * 10.0**decades / (DA * SH), DA, ambient=0.3, chi=0.4)
    assert drying_peclet(DA, SH, x.saturation, dilute) == pytest.approx(10.0**decades, rel=1e-12)
    z = np.linspace(1e-4, 0.05, 8)
    dried = dry_radially(
        straight_path(THINNING, z), phi0, x, law, air_viscosity=NU, sherwood_floor=SH, cells=24, rtol=1e-5
    )
    np.testing.assert_allclose(dried.lost + dried.remaining, 1.0, rtol=1e-12)
    area = np.diff(dried.edges**2, axis=1) * dried.polymer_fraction  # polymer between radii, over the length
    expected = phi0 * R0**2 / THINNING.stretch_ratio(z)[:, np.newaxis] * dried.polymer_share
    np.testing.assert_allclose(area, expected, rtol=1e-10)
    np.testing.assert_allclose(area.sum(axis=1), expected.sum(axis=1), rtol=1e-12)
    end = vapour.equilibrium_fraction(0.3, 0.4)
    assert (dried.polymer_fraction >= phi0 * (1 - 1e-4)).all()
    assert (dried.polymer_fraction <= end * (1 + 1e-4)).all()
    assert (np.diff(dried.polymer_fraction, axis=1) > -1e-4).all()  # the surface is the driest


def test_fast_diffusion_is_uniform_drying_at_rate_one() -> None:
    x = Volatile("x", 1e-4, DA, ambient=0.4)
    z = np.linspace(0.002, 0.1, 6)
    path = straight_path(THINNING, z)
    flat = evaporate(path, 0.1, [x], air_viscosity=NU)
    gaps = []
    for diffusion in (1e-6, 1e-5, 1e-4):
        dried = dry_radially(path, 0.1, x, ConstantDiffusion(diffusion), air_viscosity=NU, cells=16, rtol=1e-9)
        gaps.append(np.abs(dried.mean_fraction / flat.polymer_fraction - 1).max())
    assert np.log10(gaps[0] / gaps[1]) == pytest.approx(1.0, abs=0.1)
    assert gaps[2] < 1e-4
    np.testing.assert_allclose(dried.edges[:, -1], flat.radius, rtol=1e-4)
    np.testing.assert_allclose(dried.time, THINNING.residence_time(z), rtol=1e-5)


def test_slow_diffusion_dries_the_surface_at_once() -> None:
    x = at_biot(1e6, 1e-12)
    dried = dry_radially(
        straight_path(PLAIN, [1e-3]), 0.1, x, ConstantDiffusion(1e-12), air_viscosity=NU, sherwood_floor=SH
    )
    assert dried.polymer_fraction[0, -1] > 0.99
    assert dried.polymer_fraction[0, 0] == pytest.approx(0.1, rel=1e-6)


def test_stretch_enters_through_the_exposure_alone() -> None:
    """With Sh constant, a thinning jet and a plain one dry alike where dz/v_0 is the same."""
    x = Volatile("x", 1e-5, DA)
    z = np.array([0.001, 0.004])
    thin = dry_radially(
        straight_path(THINNING, 0.1 * z),
        0.1,
        x,
        ConstantDiffusion(1e-8),
        air_viscosity=NU,
        sherwood_floor=9.0,
        rtol=1e-9,
    )
    plain = dry_radially(
        straight_path(PLAIN, z), 0.1, x, ConstantDiffusion(1e-8), air_viscosity=NU, sherwood_floor=9.0, rtol=1e-9
    )
    np.testing.assert_allclose(thin.polymer_fraction, plain.polymer_fraction, rtol=1e-7)
    np.testing.assert_allclose(
        thin.edges[:, 1:], plain.edges[:, 1:] / np.sqrt(THINNING.stretch_ratio(0.1 * z))[:, np.newaxis], rtol=1e-7
    )


def test_glass_and_skin() -> None:
    x = Volatile("x", 2e-4, DA)
    z = np.linspace(1e-3, 1.0, 60)
    dried = dry_radially(
        straight_path(PLAIN, z),
        0.2,
        x,
        ExponentialDiffusion(5e-8, 2.0),
        air_viscosity=NU,
        sherwood_floor=SH,
        vitrification_fraction=0.8,
    )
    surface, centre = dried.vitrified_at
    assert 0 < surface < centre < 1.0
    np.testing.assert_allclose(dried.vitrified_after, dried.vitrified_at, rtol=1e-5)  # 1 m/s
    assert np.interp(surface, z, dried.polymer_fraction[:, -1]) == pytest.approx(0.8, abs=0.02)
    skin = dried.skin_thickness(0.8)
    assert (skin[z < surface] == 0).all()
    assert (skin[(z > surface * 1.2) & (z < centre * 0.9)] > 0).all()
    late = z > centre * 1.05
    np.testing.assert_allclose(skin[late], dried.edges[late, -1], rtol=1e-12)
    never = dry_radially(straight_path(PLAIN, z[:3]), 0.2, x, ConstantDiffusion(1e-9), air_viscosity=NU)
    assert np.isnan(never.vitrified_at).all()


def test_measured_radius_is_kept() -> None:
    z = np.linspace(0.001, 0.01, 4)
    path = straight_path(THINNING, z, "radius")
    dried = dry_radially(path, 0.1, Volatile("x", 1e-4, DA), ConstantDiffusion(1e-8), air_viscosity=NU)
    np.testing.assert_allclose(dried.edges[:, -1], THINNING.radius(z), rtol=1e-12)
    assert (np.diff(dried.remaining) < 0).all()


def test_diffusion_laws() -> None:
    phi = np.linspace(0, 1, 5)
    np.testing.assert_allclose(ExponentialDiffusion(2.0, 3.0)(phi), 2 * np.exp(-3 * phi), rtol=1e-15)
    free = FreeVolumeDiffusion(1e-13, 0.05, 0.06)(phi)
    assert free[-1] == 1e-13
    assert free[0] == pytest.approx(1e-13 * np.exp(1 / 0.11), rel=1e-14)
    assert (np.diff(free) < 0).all()


X = Volatile("x", 1e-5, DA)
PATH = straight_path(PLAIN, [1e-3])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: dry_radially(PATH, 0.0, X, ConstantDiffusion(1e-9), air_viscosity=NU), "volume_fraction"),
        (lambda: dry_radially(PATH, 0.1, X, ConstantDiffusion(1e-9), air_viscosity=NU, cells=4), "cells"),
        (lambda: dry_radially(PATH, 0.1, X, ConstantDiffusion(1e-9), air_viscosity=NU, cells=20.5), "cells"),  # type: ignore[arg-type]
        (lambda: dry_radially(PATH, 0.1, X, ConstantDiffusion(1e-9), air_viscosity=NU, rtol=1.0), "rtol"),
        (
            lambda: dry_radially(PATH, 0.1, X, ConstantDiffusion(1e-9), air_viscosity=NU, vitrification_fraction=0.05),
            "vitrification_fraction",
        ),
        (lambda: dry_radially(PATH, 0.1, X, lambda phi: 1e-9 * (0.5 - phi), air_viscosity=NU), "diffusion"),
        (lambda: dry_radially(PATH, 0.1, X, ConstantDiffusion(1e-9), air_viscosity=-1.0), "air_viscosity"),
        (lambda: ConstantDiffusion(0.0), "value"),
        (lambda: ExponentialDiffusion(1e-9, -1.0), "decay"),
        (lambda: FreeVolumeDiffusion(1e-9, 1e-3, 0.0), "gap"),
        (lambda: drying_peclet(1.0, 1.0, 1.0, 0.0), "diffusivity"),
        (lambda: cylinder_series(2.0, 1.0, 1.0), "radius_ratio"),
        (
            lambda: dry_radially(PATH, 0.1, X, ConstantDiffusion(1e-9), air_viscosity=NU).skin_thickness(2.0),
            "volume_fraction",
        ),
    ],
)
def test_refusals(call, words: str) -> None:
    with pytest.raises(InputError, match=words):
        call()
