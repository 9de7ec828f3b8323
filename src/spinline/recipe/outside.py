"""Settings of a recipe that no spinning line has: the chain answers, and says that nothing like it was ever spun."""

import difflib
from typing import Any

from spinline.base.words import shortened
from spinline.recipe.believe import DAMPEST, USUAL_TEMPERATURE, Recipe, evaporation_rate
from spinline.recipe.dissolves import solution_remarks
from spinline.rheology.materials import POLYMERS

__all__ = ["outside_remarks", "size_remarks", "watery"]

_BREAKDOWN = 3e6  # V/m, of air
_RATES = (2.5e-12, 1.4e-8)  # m3/s: 0.009 to 50 mL/hour; 611 published settings have 0.1 to 22
_GAPS = (0.019, 0.6)  # m; 2 to 50 cm are published
_LEAST_POLYMER, _MOST_POLYMER = 1e-3, 0.5
# what solutions that spin have, by the recipe's fields: least, most, and the same in words
_SPUN: dict[str, tuple[float, float, str]] = {
    "voltage": (100.0, 2e5, "{:.3g} V is out of the 100 to 200000 at which jets are spun"),
    "viscosity": (2e-3, 1e3, "{:.3g} Pa s is out of the 0.002 to 1000 of solutions that spin"),
    "conductivity": (1e-10, 10.0, "{:.3g} S/m is out of the 1e-10 to 10 of solutions that spin"),
    "surface_tension": (0.01, 0.08, "{:.3g} N/m is out of the 0.01 to 0.08 of solutions that spin"),
    "current": (1e-10, 1e-4, "{:.3g} A is out of the 1e-10 to 1e-4 of electrospun jets"),
    "needle_radius": (1e-5, 3e-3, "an inner radius of {:.3g} m is out of the 1e-5 to 0.003 of needles"),
    "molar_mass": (5.0, 2e4, "{:.3g} kg/mol is out of the 5 to 20000 of polymers that spin"),
    "temperature": (273.15, 343.15, "{:.4g} K is out of the 273 to 343 at which solutions are spun"),
}
_WIDE = 1.0  # sd of a logarithm
_SIZES = (5e-9, 5e-5)  # m
_SOME_WATER = 0.05  # of the solvent, by mass: less keeps no jet wet and no air's water out
_MUCH = 0.3  # of another, by mass: a fifth of ethanol moves a fibre by less than 7 %
_DAMP = 0.5  # relative humidity from which air's water settles on jets that a faster solvent cools


def watery(recipe: Recipe) -> bool:
    """Whether there is enough water in the solvent to speak of."""
    return recipe.solvent.get("water", 0.0) > _SOME_WATER


def _cooled_by_another(recipe: Recipe) -> bool:
    """Whether water stands beside much of a solvent that leaves faster."""
    others = [name for name, share in recipe.solvent.items() if name != "water" and share > _MUCH]
    return watery(recipe) and any(_leaves(name) > _leaves("water") for name in others)


def _leaves(name: str) -> float:
    return evaporation_rate({name: 1.0}, USUAL_TEMPERATURE, 0.0)


def outside_remarks(recipe: Recipe) -> tuple[str, ...]:
    """What of a recipe lies outside anything that is spun.

    Parameters
    ----------
    recipe : Recipe

    Returns
    -------
    tuple of str
    """
    said = [*solution_remarks(recipe)]
    if recipe.polymer not in POLYMERS:
        by_lower = {name.lower(): name for name in POLYMERS}
        near = difflib.get_close_matches(recipe.polymer.lower()[:100], by_lower, n=1, cutoff=0.75)
        hint = f" (did you mean {by_lower[near[0]]}?)" if near else ""
        said.append(
            f"{shortened(recipe.polymer)} is not in the library{hint}: a usual chain is taken, within wide spreads"
        )
    field = recipe.voltage / recipe.gap
    if field > _BREAKDOWN:
        said.append(f"{field / 1e5:.3g} kV/cm between needle and collector: air breaks down at 30")
    if not _RATES[0] <= recipe.flow_rate <= _RATES[1]:
        said.append(f"a flow of {recipe.flow_rate * 3.6e9:.3g} mL/hour is out of the usual 0.05 to 20: check its unit")
    if not _GAPS[0] <= recipe.gap <= _GAPS[1]:
        said.append(f"a gap of {100 * recipe.gap:.3g} cm is out of the usual 5 to 30: check its unit")
    if recipe.mass_fraction > _MOST_POLYMER:
        said.append(f"{100 * recipe.mass_fraction:.3g} wt% of polymer is no solution that flows through a needle")
    if recipe.mass_fraction < _LEAST_POLYMER:
        said.append(f"{100 * recipe.mass_fraction:.3g} wt% of polymer holds no jet together: check its unit")
    for name, (least, most, words) in _SPUN.items():
        value: Any = getattr(recipe, name)
        if value == value and not least <= value <= most:
            said.append(f"{words.format(value)}: check its unit")
    if recipe.relative_humidity > DAMPEST and watery(recipe):
        said.append(
            f"water dries ever more slowly towards 100 % relative humidity: computed as at {100 * DAMPEST:.0f} %, the jet "
            "lands wetter than said here"
        )
    if recipe.relative_humidity >= _DAMP and _cooled_by_another(recipe):
        said.append(
            f"air of {100 * recipe.relative_humidity:.0f} % relative humidity wets a jet that a solvent faster than its water "
            "cools: it dries later than computed, and the fibre is thinner than said here, by a tenth to a half"
        )
    said += [
        f"{name} is given with a spread wider than itself: worth no more than none"
        for name, spread in (recipe.spread or {}).items()
        if spread > _WIDE
    ]
    return tuple(said)


def size_remarks(diameter: float) -> tuple[str, ...]:
    """What to say of a fibre (diameter in m) of a size that was never spun."""
    if diameter < _SIZES[0]:
        return (f"{1e9 * diameter:.2g} nm is a few chains side by side: no fibre is so thin, the laws end before it",)
    if diameter > _SIZES[1]:
        return (f"{1e6 * diameter:.3g} um is thicker than any electrospun fibre: the laws end before it",)
    return ()
