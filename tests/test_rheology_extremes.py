"""Extremes of rheology: a correct number (against mpmath), or an InputError that names the field; no warning, nothing between."""

import contextlib
import dataclasses
import itertools

import mpmath
import numpy as np
import pytest

from spinline import rheology
from spinline.base.errors import InputError
from spinline.jetprofile import PowerLaw
from spinline.rheology import (
    FENEP,
    ConstantDiffusion,
    ExponentialDiffusion,
    FreeVolumeDiffusion,
    Giesekus,
    Maxwell,
    OldroydB,
    Solution,
    Volatile,
    entanglement,
    solvents,
    straight_path,
    vapour,
)
from spinline.rheology.conformation import conformation

pytestmark = pytest.mark.filterwarnings("ignore::spinline.base.errors.SpinlineWarning")

VALUES = [
    0.0,
    1e-308,
    1e-300,
    1e-100,
    1e-12,
    0.5,
    1.0,
    1e12,
    1e150,
    1e300,
    1.7e308,
    -1.0,
    -1e300,
    np.nan,
    np.inf,
    -np.inf,
    [],
    [0.5],
    np.full(1000, 0.5),
    np.float32(0.5),
    "x",
    None,
    True,
    1j,
]
PAIRED = [0.0, 1e-300, 1e-12, 1e12, 1e300, -1e300]

# the law, and a value that each argument may have
LAWS = [
    (rheology.volume_fraction, {"mass_fraction": 0.5, "polymer_density": 1e3, "solvent_density": 1e3}),
    (rheology.mass_fraction, {"volume_fraction": 0.5, "polymer_density": 1e3, "solvent_density": 1e3}),
    (rheology.molar_fraction, {"mass_fraction": 0.5, "molar_mass": 100.0, "solvent_molar_mass": 0.018}),
    (rheology.mass_fraction_from_molar, {"molar_fraction": 0.5, "molar_mass": 100.0, "solvent_molar_mass": 0.018}),
    (
        rheology.viscosity,
        {"concentration": 0.5, "initial_concentration": 0.1, "initial_viscosity": 1.0, "B": 7.0, "m": 0.1},
    ),
    (
        rheology.relaxation_time,
        {"concentration": 0.5, "initial_concentration": 0.1, "initial_relaxation_time": 1.0, "n": 1.0},
    ),
    (rheology.scaled, {"volume_fraction": 0.5, "initial_volume_fraction": 0.1, "initial_value": 1.0, "exponent": 2.0}),
    (
        rheology.scaled_viscosity,
        {
            "volume_fraction": 0.5,
            "initial_volume_fraction": 0.1,
            "initial_viscosity": 1.0,
            "solvent_viscosity": 1e-3,
            "exponent": 2.0,
        },
    ),
    (
        rheology.martin_viscosity,
        {"concentration": 1.0, "intrinsic_viscosity": 1.0, "martin_constant": 0.4, "solvent_viscosity": 1e-3},
    ),
    (rheology.modulus, {"viscosity": 1.0, "relaxation_time": 1.0}),
    (rheology.scaling_exponents, {"solvent_quality": "good"}),
    (rheology.solvent_activity, {"volume_fraction": 0.5, "chi": 0.4}),
    (rheology.equilibrium_fraction, {"relative_humidity": 0.5, "chi": 0.4}),
    (rheology.vapour_pressure, {"name": "water", "temperature": 298.0}),
    (rheology.vapour_diffusivity, {"name": "water", "temperature": 298.0, "pressure": 1e5}),
    (
        vapour.vapour_concentration,
        {"vapour_pressure": 1e3, "molar_mass": 0.018, "liquid_density": 1e3, "temperature": 298.0},
    ),
    (vapour.air_kinematic_viscosity, {"temperature": 298.0, "pressure": 1e5}),
    (rheology.tensile_force, {"axial_stress": 1.0, "radial_stress": -1.0, "radius": 1e-4}),
    (rheology.maxwell_startup, {"weissenberg": 0.4, "reduced_time": 1.0}),
    (rheology.steady_fenep, {"weissenberg": 0.4, "extensibility": 400.0}),
    (rheology.sherwood, {"reynolds": 1.0, "schmidt": 0.6, "floor": 0.0}),
    (rheology.power_law_loss, {"distance": 10.0, "k": 1.0, "beta": 0.5, "rate": 1e-4}),
    (rheology.drying_peclet, {"vapour_diffusivity": 1e-5, "sherwood": 1.0, "saturation": 1e-5, "diffusivity": 1e-9}),
    (rheology.cylinder_series, {"radius_ratio": 0.5, "fourier": 0.1, "biot": 1.0}),
    (rheology.overlap_fraction, {"segments_per_chain": 100.0}),
    (rheology.entanglement_fraction, {"molar_mass": 100.0, "entanglement_molar_mass": 10.0, "entanglements": 2.0}),
    (
        entanglement.entanglement,
        {
            "volume_fraction": 0.1,
            "segments_per_chain": 1e3,
            "kuhn_length": 1e-9,
            "molar_mass": 100.0,
            "entanglement_molar_mass": 10.0,
        },
    ),
    (
        rheology.packing_entanglement_molar_mass,
        {"density": 1e3, "repeat_unit_molar_mass": 0.1, "backbone_bonds": 2, "kuhn_length": 1e-9},
    ),
    (
        rheology.vitrification_fraction,
        {"data": "PS", "solvent_glass_transition": 120.0, "temperature": 298.0, "solvent_density": 900.0},
    ),
    (rheology.polymer, {"name": "PEO"}),
    (rheology.polymer_property, {"data": "PS", "name": "density"}),
    (rheology.property_source, {"data": "PS", "name": "density"}),
    (rheology.solvent_density, {"name": "DMF", "temperature": 298.0}),
    (rheology.solvent_viscosity, {"name": "DMF", "temperature": 298.0}),
    (rheology.solvent_surface_tension, {"name": "ethanol", "temperature": 298.0}),
    (rheology.solvent_glass_transition, {"name": "DMF"}),
    (rheology.mixture_density, {"shares": {"DMF": 0.5, "THF": 0.5}, "temperature": 298.0}),
    (rheology.mixture_viscosity, {"shares": {"DMF": 0.5, "THF": 0.5}, "temperature": 298.0}),
    (rheology.mixture_surface_tension, {"shares": {"DMF": 0.5, "THF": 0.5}, "temperature": 298.0}),
    (ConstantDiffusion, {"value": 1e-9}),
    (ExponentialDiffusion, {"dilute": 1e-9, "decay": 1.0}),
    (FreeVolumeDiffusion, {"dry": 1e-12, "gap": 0.1, "growth": 0.1}),
    (FENEP, {"extensibility": 400.0}),
    (Giesekus, {"mobility": 0.1}),
    (OldroydB, {"solvent_viscosity": 1e-3}),
    (
        Volatile,
        {"name": "x", "saturation": 1e-5, "diffusivity": 1e-5, "ambient": 0.4, "chi": 0.4, "molar_volume": 1e-5},
    ),
    (
        Volatile.build,
        {
            "name": "water",
            "temperature": 298.0,
            "convention": "mass",
            "pressure": 1e5,
            "density": 1e3,
            "vapour_pressure": 1e3,
            "molar_mass": 0.018,
        },
    ),
    (
        Solution.build,
        {
            "polymer_data": "PEO",
            "solvent": "water",
            "mass_fraction": 0.05,
            "temperature": 293.0,
            "polymer_density": 1e3,
            "solvent_density": 1e3,
            "kuhn_length": 1e-9,
            "molar_mass": 600.0,
            "viscosity": 1.0,
            "relaxation_time": 1.0,
            "surface_tension": 0.06,
            "conductivity": 1e-2,
            "solvent_viscosity": 1e-3,
            "solvent_molar_mass": 0.018,
        },
    ),
]


def finite(result: object) -> bool:
    """Whether every number of a result is finite."""
    if dataclasses.is_dataclass(result) and not isinstance(result, type):
        return all(finite(getattr(result, f.name)) for f in dataclasses.fields(result) if f.name not in _MAY_BE_NAN)
    if isinstance(result, tuple):
        return all(finite(part) for part in result)
    return not isinstance(result, float | np.ndarray) or bool(np.isfinite(result).all())


_MAY_BE_NAN = ("vitrified_at", "vitrified_after", "name")


def answers(law, good: dict, changes) -> int:
    """How many changes are answered; anything but a finite number or an InputError fails."""
    count = 0
    for change in changes:
        with contextlib.suppress(InputError):
            result = law(**(good | change))
            assert finite(result) or law is rheology.power_law_loss, (change, result)  # NaN: nothing is left
            count += 1
    return count


@pytest.mark.parametrize(("law", "good"), LAWS, ids=lambda x: getattr(x, "__qualname__", ""))
def test_a_number_or_a_named_error(law, good: dict) -> None:
    assert finite(law(**good))
    answers(law, good, ({name: value} for name in good for value in VALUES))
    pairs = itertools.combinations([name for name, value in good.items() if isinstance(value, float)], 2)
    answers(law, good, ({a: x, b: y} for a, b in pairs for x in PAIRED for y in PAIRED))


JET = PowerLaw(radius=125e-6, flow_rate=8.9e-10, k=1.0, beta=0.47)
Z = np.linspace(1e-4, 5e-3, 4)
WATER = Volatile("water", 1.73e-5, 2.5e-5, ambient=0.4)
SMALL = [0.0, 1e-300, 1e-12, 1.0, 1e12, 1e300, -1.0, np.nan, np.inf, [], [0.5], np.float32(0.5), "x", None]


def evaporated(**change):
    arguments = {"volume_fraction": 0.05, "volatiles": [WATER], "air_viscosity": 1.5e-5} | change
    return rheology.evaporate(straight_path(JET, arguments.pop("z", Z), arguments.pop("given", None)), **arguments)


def dried(**change):
    arguments = {
        "volume_fraction": 0.05,
        "volatile": WATER,
        "diffusion": ConstantDiffusion(1e-9),
        "air_viscosity": 1.5e-5,
        "cells": 8,
        "rtol": 1e-4,
    } | change
    return rheology.dry_radially(straight_path(JET, Z), **arguments)


@pytest.mark.parametrize(
    "name",
    [
        "z",
        "given",
        "volume_fraction",
        "volatiles",
        "shares",
        "air_viscosity",
        "air_velocity",
        "activity",
        "polymer_molar_volume",
        "sherwood_floor",
    ],
)
def test_evaporation(name: str) -> None:
    answers(evaporated, {}, ({name: value} for value in SMALL))


@pytest.mark.parametrize("name", ["saturation", "diffusivity", "ambient", "chi", "molar_volume"])
def test_evaporation_of_any_solvent(name: str) -> None:
    def law(value):
        return evaporated(volatiles=[dataclasses.replace(WATER, **{name: value})])

    assert answers(law, {}, ({"value": value} for value in SMALL)) > 0


@pytest.mark.parametrize(
    "name",
    ["volume_fraction", "air_viscosity", "air_velocity", "sherwood_floor", "vitrification_fraction", "cells", "rtol"],
)
def test_radial_drying(name: str) -> None:
    answers(dried, {}, ({name: value} for value in SMALL))


def test_radial_drying_of_any_diffusivity() -> None:
    assert answers(lambda value: dried(diffusion=ConstantDiffusion(value)), {}, ({"value": v} for v in SMALL)) >= 4
    assert answers(lambda value: dried(volatile=Volatile("x", value, 2.5e-5)), {}, ({"value": v} for v in SMALL)) >= 4


@pytest.mark.parametrize("model", [Maxwell(), OldroydB(1.0), Giesekus(0.3), FENEP(400.0)])
def test_conformation_at_any_relaxation_time(model) -> None:
    t = np.linspace(0, 3e-2, 4)
    good = {"time": t, "stretch_ratio": np.exp(50 * t), "relaxation_time": 1e-2, "model": model}
    changes = [{name: value} for name in good if name != "model" for value in SMALL]
    changes += [{"start": (value, value)} for value in SMALL]
    changes += [{"relaxation_time": np.geomspace(1e-2, value, 4)} for value in (1e-90, 1e-12, 1e12, 1e90)]
    assert answers(conformation, good, changes) >= 6
    assert answers(lambda value: conformation(**good).stress(value), {}, ({"value": value} for value in SMALL)) == 6


def test_a_model_that_is_none() -> None:
    with pytest.raises(InputError, match="model"):
        conformation([0.0, 1.0], [1.0, 2.0], 1.0, "fene-p")  # type: ignore[arg-type]


@pytest.mark.parametrize("biot", [1e-300, 1e-9, 1e-3, 1.0, 1e4, 1e8, 1.01e8, 1e300])
def test_cylinder_series_against_mpmath(biot: float) -> None:
    with mpmath.workdps(30):
        bi = mpmath.mpf(biot)
        large = biot > 1e6
        roots = []
        for n in range(12):
            high = mpmath.besseljzero(0, n + 1)
            low = mpmath.besseljzero(1, n) if n else min(mpmath.sqrt(2 * bi), high) * mpmath.mpf("0.4")
            high = min(mpmath.sqrt(2 * bi), high) if n == 0 else high
            start = (high * (1 - 1 / bi), high * (1 - mpmath.mpf("0.9") / bi)) if large else (low, high)

            def excess(q, bi=bi, large=large):
                return (
                    q * mpmath.besselj(1, q) / bi - mpmath.besselj(0, q)
                    if large
                    else q * mpmath.besselj(1, q) - bi * mpmath.besselj(0, q)
                )

            if biot > 1e100:  # the zero of J_0 itself, to 100 digits
                roots.append(high)
                continue
            solver = "secant" if large else "anderson"
            roots.append(mpmath.findroot(excess, start, solver=solver, tol=1e-60, verify=False))
        for x in (0.0, 0.4, 1.0):
            for fo in (0.05, 1.0, min(0.5 / biot, 1e290) + 0.05):
                exact = sum(
                    2
                    * mpmath.besselj(1, q)
                    * mpmath.besselj(0, q * x)
                    * mpmath.exp(-(q**2) * mpmath.mpf(fo))
                    / (q * (mpmath.besselj(0, q) ** 2 + mpmath.besselj(1, q) ** 2))
                    for q in roots
                )
                assert float(rheology.cylinder_series(x, fo, biot)) == pytest.approx(float(exact), rel=1e-13, abs=4e-15)


def test_cylinder_series_refuses_what_it_cannot_sum() -> None:
    with pytest.raises(InputError, match=r"fourier = 1e-12: needs more than 200 terms"):
        rheology.cylinder_series(0.5, [1.0, 1e-12], 1.0)
    assert float(rheology.cylinder_series(0.5, 1e-6, 1.0, terms=2000)) == pytest.approx(1.0, abs=1e-12)
    with pytest.raises(InputError, match="terms"):
        rheology.cylinder_series(0.5, 1.0, 1.0, terms=0)
    assert rheology.cylinder_series(0.5, 1e300, 1e-300) == pytest.approx(np.exp(-2.0), rel=1e-13)


@pytest.mark.parametrize("k", [1e-300, 1e-12, 0.48, 1.0, 1e12, 1e300])
@pytest.mark.parametrize("beta", [1e-6, 0.25, 0.5, 1.0, 1e6])
def test_power_law_loss_against_mpmath(k: float, beta: float) -> None:
    for s, rate, (given, q) in itertools.product(
        (1e-300, 1e-3, 24.0, 1e12, 1e300), (1e-300, 1e-12, 1e-3, 1e300), (("velocity", (6, 5)), ("radius", (3, 2)))
    ):
        with mpmath.workdps(30):
            onset, p = mpmath.mpf(k) ** (-1 / mpmath.mpf(beta)), 1 + mpmath.mpf(beta) / 3
            path = mpmath.mpf(s) if s <= onset else onset * (1 + ((mpmath.mpf(s) / onset) ** p - 1) / p)
            power = mpmath.mpf(q[0]) / q[1]
            gone = mpmath.mpf(rate) * path / power
            exact = float(-mpmath.expm1(power * mpmath.log1p(-gone))) if gone < 1 else np.nan
        found = float(rheology.power_law_loss(s, k, beta, rate, given))  # type: ignore[arg-type]
        assert found == pytest.approx(exact, rel=3e-13, abs=1e-306, nan_ok=True)
    with pytest.raises(InputError, match="given"):
        rheology.power_law_loss(1.0, 1.0, 0.5, 0.1, "area")  # type: ignore[arg-type]


@pytest.mark.parametrize("humidity", [1e-300, 1e-12, 0.4, 0.9, 1 - 1e-8, 1 - 2.0**-53])
@pytest.mark.parametrize("chi", [-5.0, 0.0, 0.45, 0.5, 0.500001, 1.0, 5.0])
def test_equilibrium_fraction_against_mpmath(humidity: float, chi: float) -> None:
    found = rheology.equilibrium_fraction(humidity, chi)
    assert 0 < found <= 1
    with mpmath.workdps(50):
        phi = mpmath.mpf(found)
        if found < 1:
            excess = mpmath.log1p(-phi) + phi + mpmath.mpf(chi) * phi**2 - mpmath.log(mpmath.mpf(humidity))
            assert abs(excess / (-1 / (1 - phi) + 1 + 2 * mpmath.mpf(chi) * phi) / phi) < 1e-15


@pytest.mark.parametrize("weissenberg", [1e-300, 1e-8, 0.3, 0.499999, 0.5, 0.500001, 10.0, 1e8, 1e300])
@pytest.mark.parametrize("limit", [3.0001, 400.0, 1e12])
def test_steady_fenep_against_mpmath(weissenberg: float, limit: float) -> None:
    axial, radial = rheology.steady_fenep(weissenberg, limit)
    with mpmath.workdps(60):
        de, size = mpmath.mpf(weissenberg), mpmath.mpf(limit)
        near = 1 / mpmath.mpf(axial)
        gap = mpmath.findroot(
            lambda g: 1 / g + 2 / (g + 3 * de) - size + (size - 3) / (g + 2 * de),
            (near * (1 - mpmath.mpf("1e-4")), near * (1 + mpmath.mpf("1e-4"))),
            solver="anderson",
            tol=1e-80,
            verify=False,
        )
        assert float(axial * gap) == pytest.approx(1.0, rel=3e-15)
        assert float(radial * (gap + 3 * de)) == pytest.approx(1.0, rel=3e-15)


def test_tensile_force_does_not_pass_through_the_square_of_the_radius() -> None:
    assert rheology.tensile_force(1e300, 0.0, 1e-250) == pytest.approx(np.pi * 1e-200, rel=1e-14)
    assert rheology.tensile_force(1e-300, 0.0, 1e250) == pytest.approx(np.pi * 1e200, rel=1e-14)
    with pytest.raises(InputError, match=r"tensile force.*beyond what a double holds"):
        rheology.tensile_force(1e300, -1e300, 1e300)


@pytest.mark.parametrize(
    ("law", "arguments", "words"),
    [
        (rheology.modulus, (1e300, 1e-300), "modulus"),
        (rheology.modulus, (1e-300, 1e300), "modulus"),
        (rheology.viscosity, (1.0, 0.5, 1e300, 300.0, 1.0), "viscosity"),
        (rheology.martin_viscosity, (1e300, 1e300, 1.0, 1.0), "decades"),
        (rheology.scaled, (1.0, 1e-300, 1.0, 20.0), "decades"),
        (rheology.equilibrium_fraction, ([0.4, 0.5],), "single number"),
    ],
)
def test_results_beyond_a_double_are_named(law, arguments: tuple, words: str) -> None:
    with pytest.raises(InputError, match=words):
        law(*arguments)


def test_solvents_take_their_names_in_any_case() -> None:
    assert solvents.solvent_density(" WATER ", 298.15) == solvents.solvent_density("water", 298.15)
