"""The recipe file: what a lab notebook holds, in TOML. What is missing gets what is usual; unknown keys are refused."""

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

from spinline.base.errors import InputError
from spinline.base.units import Measured, parse
from spinline.recipe.believe import USUAL_TEMPERATURE, Recipe
from spinline.recipe.elsewhere import elsewhere
from spinline.recipe.measured import Measurement
from spinline.recipe.mixture_text import in_toml, mixture_remedy
from spinline.recipe.predict import Fibre, predict
from spinline.rheology.materials import POLYMERS, polymer
from spinline.rheology.names import known_as
from spinline.rheology.solvents import SOLVENTS, mixture_density, solvent_density
from spinline.scene.advice import GAUGES
from spinline.scene.file import checked, read_toml
from spinline.scene.quantities import (
    Conductivity,
    FlowRate,
    Fraction,
    Label,
    Length,
    MolarMass,
    Read,
    Section,
    Sheet,
    Temperature,
    Viscosity,
)

__all__ = ["RecipeSheet", "bundled_recipes", "fibre", "load_recipe"]

Potential = Annotated[Measured, Read("potential", 1.0, 1e6)]
Tension = Annotated[Measured, Read("surface tension", 1e-4, 1.0)]
Current = Annotated[Measured, Read("current", 1e-15, 1.0)]


_COLDEST, _HOTTEST = 200.0, 450.0  # K, of a line


class PerVolume(Measured):
    """Mass of polymer in a volume of solution, kg/m3."""


_BY_VOLUME = Read("concentration", 0.0, 3e4)


class _ReadConcentration(Read):
    """A mass fraction, or a mass in a volume of solution ("12 % w/v", "120 mg/mL")."""

    def __call__(self, text: Any) -> Measured:
        try:
            return super().__call__(text)
        except PydanticCustomError:
            with suppress(InputError):
                parse(text, "concentration", "")
                found = _BY_VOLUME(text)  # with its own range
                return PerVolume(found.value, found.std, found.text)
            raise


Concentration = Annotated[Measured, _ReadConcentration("mass fraction", 0.0, 1.0)]


def _shares(given: Any) -> Any:
    """Shares of a mixture as numbers, "40 %" too; any other form is refused with the one to write."""
    if isinstance(given, Mapping) and any(isinstance(share, str) for share in given.values()):
        found = {}
        for name, share in given.items():
            try:
                found[name] = parse(share, "mass fraction", "").value if isinstance(share, str) else share
            except InputError as error:
                words = {"key": str(name), "problem": error.problem, "allowed": "> 0, by mass", "remedy": error.remedy}
                raise PydanticCustomError("quantity", "{problem}", words) from None
        return found
    if isinstance(given, str | Mapping):
        return given
    names = [str(one) for one in given] if isinstance(given, list) else []
    remedy = (
        f"write {in_toml(dict.fromkeys(names, 1.0))}" if names else 'for example "DMF", or { DCM = 0.6, DMF = 0.4 }'
    )
    words = {"allowed": "a name, or names with their shares by mass", "remedy": remedy}
    raise PydanticCustomError("quantity", "is no solvent", words)


class SolutionOfRecipe(Section):
    """``[solution]`` of a recipe."""

    polymer: str
    solvent: Annotated[str | dict[str, float], BeforeValidator(_shares)]
    concentration: Concentration | None = None
    molar_mass: MolarMass | None = None
    viscosity: Viscosity | None = None
    conductivity: Conductivity | None = None
    surface_tension: Tension | None = None
    temperature: Temperature | None = None


def _bare_gauge(given: Any) -> Any:
    """The number of "21G", "G21", "21 gauge"."""
    form = r"\s*(?:G\s*(?P<behind>\d\d)|(?P<before>\d\d)[\s-]*(?:G|ga|gauge)?)\s*"
    named = re.fullmatch(form, given, re.IGNORECASE) if isinstance(given, str) else None
    number = int(named["behind"] or named["before"]) if named else given
    if isinstance(number, bool) or not isinstance(number, int | float) or number not in GAUGES:
        words = {
            "allowed": f"{min(GAUGES)} to {max(GAUGES)}",
            "remedy": 'gauge = 21, or radius = "0.26 mm", the inner one',
        }
        raise PydanticCustomError("quantity", "is no gauge of a needle that is known", words)
    return int(number)


class JetOfRecipe(Section):
    """``[jet]`` of a recipe: the needle's settings."""

    voltage: Potential
    gap: Length
    flow_rate: FlowRate
    radius: Length | None = None
    gauge: Annotated[int, BeforeValidator(_bare_gauge)] | None = None
    current: Current | None = None


class AmbientOfRecipe(Section):
    """``[ambient]`` of a recipe."""

    temperature: Temperature | None = None
    relative_humidity: Fraction | None = None


class CollectorOfRecipe(Section):
    """``[collector]`` of a recipe; kept for the mat."""

    kind: Literal["plate", "drum", "belt"] = "plate"
    speed: Annotated[Measured, Read("velocity", 0.0, 1e3, closed=True)] | None = None


class MeasuredOfRecipe(Section):
    """``[measured]``, or ``[[measured]]``: a fibre of the same rig, and the settings that were other ones then."""

    fibre_diameter: Length
    voltage: Potential | None = None
    gap: Length | None = None
    flow_rate: FlowRate | None = None
    concentration: Concentration | None = None
    relative_humidity: Fraction | None = None
    viscosity: Viscosity | None = None
    current: Current | None = None


class RecipeSheet(Sheet):
    """A whole recipe."""

    title: Label = ""
    solution: SolutionOfRecipe
    jet: JetOfRecipe
    ambient: AmbientOfRecipe = AmbientOfRecipe()
    collector: CollectorOfRecipe = CollectorOfRecipe()
    measured: MeasuredOfRecipe | list[MeasuredOfRecipe] | None = None

    def recipe(self) -> Recipe:
        """In SI, names as the library has them."""
        s, j, air = self.solution, self.jet, self.ambient
        radius = _value(j.radius)
        if j.gauge is not None:
            if j.radius is not None:
                raise InputError("jet.gauge", "is given beside jet.radius", value=j.gauge, remedy="leave one out")
            radius = GAUGES[j.gauge]
        kelvin = _value(air.temperature)
        kelvin = kelvin if kelvin == kelvin else _value(s.temperature)
        given = {
            "viscosity": s.viscosity,
            "conductivity": s.conductivity,
            "surface_tension": s.surface_tension,
            "current": j.current,
        }
        chain = _named(
            s.polymer,
            POLYMERS,
            "solution.polymer",
            "a row of `spinline fibre --table` takes any name, as a usual chain",
        )
        solvent = _solvent(s.solvent)
        where = "solution.temperature" if air.temperature is None else "ambient.temperature"
        _liquid(solvent, kelvin, where)
        return Recipe(
            polymer=chain,
            solvent=solvent,
            voltage=j.voltage.value,
            gap=j.gap.value,
            flow_rate=j.flow_rate.value,
            mass_fraction=_mass_fraction(s.concentration, chain, solvent, kelvin, "solution"),
            needle_radius=radius,
            molar_mass=_value(s.molar_mass),
            viscosity=_value(s.viscosity),
            conductivity=_value(s.conductivity),
            surface_tension=_value(s.surface_tension),
            current=_value(j.current),
            temperature=kelvin,
            relative_humidity=_value(air.relative_humidity),
            spread=_spreads(given),
        )

    def measurements(self) -> list[Measurement]:
        """What was measured on this rig."""
        recipe = self.recipe()
        many = self.measured if isinstance(self.measured, list) else [self.measured] if self.measured else []
        found = []
        for one in many:
            names = {
                "voltage": one.voltage,
                "gap": one.gap,
                "flow_rate": one.flow_rate,
                "relative_humidity": one.relative_humidity,
                "viscosity": one.viscosity,
                "current": one.current,
            }
            changes: dict[str, Any] = {name: value.value for name, value in names.items() if value is not None}
            if one.concentration is not None:
                changes["mass_fraction"] = _mass_fraction(
                    one.concentration, recipe.polymer, recipe.solvent, recipe.temperature, "measured"
                )
            given = {name: m for name in ("viscosity", "current") if (m := names[name]) is not None}
            spread = {name: value for name, value in (recipe.spread or {}).items() if name not in given}
            changes["spread"] = {**spread, **_spreads(given)}
            size = one.fibre_diameter
            found.append(Measurement(elsewhere(recipe, **changes), size.value, max(_log_sd(size), 0.02)))
        return found


def _mass_fraction(
    given: Measured | None, chain: str, solvent: Mapping[str, float], kelvin: float, section: str
) -> float:
    """Mass fraction of what is given as one, or by volume of solution: volumes add up."""
    if not isinstance(given, PerVolume):
        return _value(given)
    solid = polymer(chain).density
    if given.value >= solid:
        raise InputError(
            f"{section}.concentration",
            "is more than the polymer's density",
            value=given.text,
            allowed=f"below {solid:.4g} kg/m3",
        )
    rest = (1 - given.value / solid) * mixture_density(solvent, kelvin if kelvin == kelvin else USUAL_TEMPERATURE)
    return given.value / (given.value + rest)


def _value(measured: Measured | None) -> float:
    return math.nan if measured is None else measured.value


def _log_sd(measured: Measured) -> float:
    """Standard deviation of the logarithm of what has this mean and this standard deviation, if it is log-normal."""
    ratio = measured.std / measured.value
    # of 1e150 and more the square is out of range
    return math.sqrt(math.log1p(ratio**2) if ratio < 1e9 else 2 * math.log(ratio))


def _spreads(given: Mapping[str, Measured | None]) -> dict[str, float]:
    return {name: _log_sd(m) for name, m in given.items() if m is not None and m.std > 0 and m.value > 0}


def _named(name: str, table: Any, field: str, remedy: str = "") -> str:
    known = known_as(name, table)
    if known is None:
        raise InputError(field, "is not in the library", value=name, allowed=", ".join(sorted(table)), remedy=remedy)
    return known


def _solvent(given: str | dict[str, float]) -> dict[str, float]:
    shares = {given: 1.0} if isinstance(given, str) else given
    found: dict[str, float] = {}
    for name, share in shares.items():
        if not (math.isfinite(share) and share > 0):
            raise InputError(f"solution.solvent.{name}", "is not a share", value=share, allowed="> 0, by mass")
        known = _named(name, SOLVENTS, "solution.solvent", mixture_remedy(name))
        found[known] = found.get(known, 0.0) + float(share)
    total = sum(found.values())
    if not found or (abs(total - 1) > 0.02 and abs(total - 100) > 2):
        remedy = f"mass fractions: parts by mass are {in_toml(shares)}" if found else "mass fractions"
        raise InputError("solution.solvent", "has shares that do not add up to 1", value=shares, remedy=remedy)
    return {name: share / total for name, share in found.items()}


def bundled_recipes() -> dict[str, Path]:
    """Names of the bundled recipes and their files."""
    from importlib import resources

    folder = Path(str(resources.files("spinline") / "data" / "recipes"))
    return {file.stem: file for file in sorted(folder.glob("*.toml"))}


def _liquid(solvent: Mapping[str, float], kelvin: float, field: str) -> None:
    """Refuse a temperature at which a solvent freezes, boils at once, or that no line has."""
    if kelvin != kelvin:
        return
    shown, remedy = f"{kelvin - 273.15:.4g} degC", 'lines are usually at "23 degC"'
    if not _COLDEST <= kelvin <= _HOTTEST:
        allowed = f"[{_COLDEST - 273.15:.0f}, {_HOTTEST - 273.15:.0f}] degC"
        raise InputError(field, "is out of range", value=shown, allowed=allowed, remedy=remedy)
    for name in solvent:
        try:
            solvent_density(name, kelvin)
        except InputError as error:
            raise InputError(
                field, f"{error.problem}: {name} is no liquid there", value=shown, allowed=error.allowed, remedy=remedy
            ) from None


def load_recipe(source: str | Path, overrides: tuple[str, ...] | list[str] = ()) -> RecipeSheet:
    """Read a recipe file, or a bundled recipe by its name.

    Raises
    ------
    InputError
        For an unreadable file, TOML that does not parse, or any key or value that cannot be right.
    """
    data, text, path = read_toml(source, bundled_recipes(), overrides, noun="recipe")
    return checked(RecipeSheet, data, text, path.resolve().parent, path.stem)


def fibre(recipe: "str | Path | RecipeSheet | Recipe", *, rung: str = "race", shares: bool = True) -> Fibre:
    """The fibre of a recipe.

    Parameters
    ----------
    recipe : path, str, RecipeSheet or Recipe
        A recipe file, a bundled recipe's name, or a recipe.
    rung : {"race", "terminal", "envelope", "lagrangian"}
    shares : bool
        With variance shares.

    Returns
    -------
    Fibre

    Examples
    --------
    >>> found = fibre("pan-dmf", shares=False)
    >>> 1e-7 < found.fibre_diameter < 6e-7
    True
    """
    if isinstance(recipe, Recipe):
        return predict(recipe, rung=rung, shares=shares)
    sheet = recipe if isinstance(recipe, RecipeSheet) else load_recipe(recipe)
    found = predict(sheet.recipe(), sheet.measurements(), rung=rung, shares=shares)
    return replace(found, remarks=(*found.remarks, *_laid(sheet, found), *_taken_as_exact(sheet)))


def _laid(sheet: RecipeSheet, found: Fibre) -> tuple[str, ...]:
    """What a moving collector does with a fibre that is made so fast."""
    speed = _value(sheet.collector.speed)
    if not speed > 0:
        return ()
    if speed < found.laying_speed:
        words = "lays loops, the more aligned the nearer the two are"
    else:
        words = "pulls: fibres are aligned, thinner than said here, or torn"
    return (
        f"the collector moves at {speed:.3g} m/s, one unbroken fibre would be made at {found.laying_speed:.3g} m/s: it {words}",
    )


_WEIGHED = ("viscosity", "conductivity", "surface_tension", "current", "fibre_diameter")


def _taken_as_exact(sheet: RecipeSheet) -> tuple[str, ...]:
    """What carries a ``+/-`` that no interval has in it."""
    measured = sheet.measured if isinstance(sheet.measured, list) else [sheet.measured] if sheet.measured else []
    sections: dict[str, list[Any]] = {
        "solution": [sheet.solution],
        "jet": [sheet.jet],
        "ambient": [sheet.ambient],
        "measured": measured,
    }
    keys = [
        f"{name}.{key}"
        for name, parts in sections.items()
        for part in parts
        for key, value in part
        if isinstance(value, Measured) and value.std > 0 and key not in _WEIGHED
    ]
    keys = list(dict.fromkeys(keys))
    return (f"the +/- of {', '.join(keys)} is not in the interval: try its ends with --set",) if keys else ()
