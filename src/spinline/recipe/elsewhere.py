"""A recipe at other settings: the viscosity and the current that were given follow the laws from its own settings to those.

A viscosity belongs to the concentration at which it was measured, a current to its voltage, gap and flow: at other ones they
are multiplied by what the laws say of the two, ``mu' = mu mu_law(c')/mu_law(c)``, and the current likewise. The concentration
about which the laboratory spins, which tells of that of entanglement, stays the recipe's own.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from spinline.recipe.believe import Recipe, believe
from spinline.recipe.model import UNKNOWNS, Fibres, spun

__all__ = ["elsewhere"]

_NAN = float("nan")


def elsewhere(recipe: Recipe, **changes: Any) -> Recipe:
    """The recipe with some of its fields changed.

    Parameters
    ----------
    recipe : Recipe
    **changes
        Fields of `Recipe`; a viscosity or a current among them is taken as it is.

    Returns
    -------
    Recipe
    """
    if recipe.usual_fraction != recipe.usual_fraction:
        recipe = replace(recipe, usual_fraction=recipe.mass_fraction)
    other = replace(recipe, **changes)
    if "viscosity" not in changes and recipe.viscosity == recipe.viscosity:
        ratio = _medians(other, viscosity=_NAN).viscosity / _medians(recipe, viscosity=_NAN).viscosity
        other = replace(other, viscosity=recipe.viscosity * float(ratio[0]))
    if "current" not in changes and recipe.current == recipe.current:
        ratio = _medians(other, current=_NAN).current / _medians(recipe, current=_NAN).current
        other = replace(other, current=recipe.current * float(ratio[0]))
    return other


def _medians(recipe: Recipe, **left_out: Any) -> Fibres:
    return spun(believe(replace(recipe, **left_out))[0], np.zeros((1, len(UNKNOWNS))), rung="terminal")
