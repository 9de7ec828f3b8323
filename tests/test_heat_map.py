"""The map of a jet that cools: its mass and its enthalpy, against the state and against the surface written out again."""

import numpy as np
import pytest

from spinline.base.errors import InputError
from spinline.jetprofile import PowerLaw
from spinline.rheology import ConstantDiffusion, ExponentialDiffusion, straight_path, thermal, vapour
from spinline.rheology.evaporant import Evaporant
from spinline.rheology.heat_map import dry_radially_with_heat

pytestmark = pytest.mark.filterwarnings("ignore::spinline.base.errors.SpinlineWarning")
JET = PowerLaw(radius=20e-6, flow_rate=0.02e-6 / 3600, k=0.5, beta=0.47)
PHI, COLD, WARM, RHO, C = 0.08, 293.15, 303.15, 1200.0, 1450.0
SKIN = ExponentialDiffusion(1e-9, 6.0)


def liquid(name: str) -> Evaporant:
    far = 0.3 * vapour.vapour_pressure("water", WARM) if name == "water" else 0.0
    return Evaporant.build(name, COLD, chi=0.45, ambient_pressure=far)


def run(e: Evaporant, law, position, **given):
    given = {"cells": 100, "rtol": 1e-5, "polymer_density": RHO, "polymer_heat_capacity": C, **given}
    return dry_radially_with_heat(
        straight_path(JET, position), PHI, e, law, temperature=COLD, air_temperature=WARM, **given
    )


@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize(
    ("name", "law"),
    [
        ("acetone", ConstantDiffusion(1e-9)),
        ("acetone", SKIN),
        ("DCM", ConstantDiffusion(1e-10)),
        ("DMF", ConstantDiffusion(1e-9)),
        ("formic acid", SKIN),
        ("water", ConstantDiffusion(1e-9)),
    ],
)
def test_mass_and_enthalpy_of_the_map_are_conserved_to_dryness(name: str, law, rtol: float) -> None:
    """200 places, 100 cells: what passed the surface, integrated by the same stages, is what the jet has lost, to 1e-10."""
    e = liquid(name)
    found = run(e, law, np.linspace(0.3 / 200, 0.3, 200), rtol=rtol)
    assert found.polymer_fraction.shape == (200, 100)
    assert found.mean_fraction[-1] > (0.91 if name == "water" else 0.999)  # water: in balance with the air
    wet = PHI * ((1 / found.polymer_fraction - 1) @ found.polymer_share)  # solvent per volume at the start
    gone = e.density * (1 - PHI - wet)
    np.testing.assert_allclose(found.mass_given_off, gone, rtol=0, atol=1e-10 * gone.max())

    def enthalpy(solvent, kelvin):
        return (PHI * RHO * C + solvent * e.density * e.heat_capacity) * (kelvin - WARM)

    change = enthalpy(wet, found.temperature) - enthalpy(1 - PHI, COLD)
    scale = np.abs(found.enthalpy_taken_up).max()
    np.testing.assert_allclose(found.enthalpy_taken_up, change, rtol=0, atol=1e-10 * scale)
    assert found.temperature[-1] == pytest.approx(WARM, abs=max(300 * rtol, 1e-3))  # dry, or in balance: as warm as air


def test_what_passes_the_surface_is_the_flux_written_out_again() -> None:
    """The books against a quadrature over places of a balance of its own: no code shared but the properties' tables."""
    e, gas, p = liquid("acetone"), 8.31446261815324, 101325.0
    nodes, weight = np.polynomial.legendre.leggauss(8)
    kink = JET.initial_radius * JET.kinks()[0]
    edges = np.concatenate((np.geomspace(1e-12, kink, 40), np.linspace(kink, 3e-3, 80)[1:]))
    half = 0.5 * np.diff(edges)
    place = (0.5 * (edges[1:] + edges[:-1])[:, np.newaxis] + half[:, np.newaxis] * nodes).ravel()
    found = run(e, SKIN, np.append(place, edges[-1]), rtol=1e-9)
    t, surface, left = found.temperature[:-1], found.polymer_fraction[:-1, -1], found.remaining[:-1]
    film = 0.5 * (t + WARM)
    mu, k = thermal.air_viscosity(film), thermal.air_conductivity(film)
    nu = mu * gas * film / (0.0289644 * p)
    d = e.diffusivity * (film / 298.15) ** 1.75
    speed = JET.velocity(place)
    radius = JET.initial_radius * np.sqrt(left * JET.initial_velocity / speed)
    power = 0.495 * (2 * radius * speed / nu) ** (1 / 3)
    at = (1 - surface) * np.exp(surface + 0.45 * surface**2) * np.array([e.pressure(float(v)) for v in t])
    flux = d * power * np.sqrt(nu / d) * e.molar_mass / (gas * film) * p * -np.log1p(-at / p)
    give = k * power * np.sqrt(mu * 1006 / k)
    b = flux * e.vapour_heat_capacity / give
    latent = np.array([e.latent_heat(float(v)) for v in t])
    taken = give * (WARM - t) * b / np.expm1(b) - flux * (latent + e.heat_capacity * (t - WARM))
    area = JET.initial_radius**2 * JET.initial_velocity
    for booked, rate in ((found.mass_given_off, flux), (found.enthalpy_taken_up, taken)):
        total = float(half @ (rate.reshape(half.size, -1) @ weight)) / area
        assert booked[-1] == pytest.approx(total, rel=3e-7)


def test_a_map_of_a_scene_keeps_its_books() -> None:
    """Cells left below dryness take what they lack from wet ones: what has gone stays what passed the surface."""
    from dataclasses import replace

    from spinline.drying.along_jet import _not_below_dryness

    path = straight_path(JET, np.linspace(3e-4, 0.03, 100))
    found = run(liquid("DCM"), ConstantDiffusion(1e-10), path.position)
    wet = 1 / found.polymer_fraction - 1
    wet[:5, -3:] = -1e-7
    wet[-1] = -1e-7
    left = PHI * (1 + wet @ found.polymer_share)
    lacking = replace(found, polymer_fraction=1 / (1 + wet), remaining=left, lost=1 - left)
    mended = _not_below_dryness(lacking, path, PHI)
    assert mended.polymer_fraction.max() <= 1
    assert (left[:5] > PHI).all()
    np.testing.assert_allclose(mended.remaining, np.maximum(left, PHI), rtol=1e-14)
    np.testing.assert_allclose(mended.lost + mended.remaining, 1.0, rtol=1e-15)
    wet[-1] = -1e-3
    with pytest.raises(InputError, match="dries beyond dryness"):
        _not_below_dryness(replace(lacking, polymer_fraction=1 / (1 + wet)), path, PHI)
