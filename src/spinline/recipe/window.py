"""Operating window of a recipe: fibre, orientation and regime against voltage, gap, flow rate and concentration.

The recipe's other settings, its priors and its measured fibres hold at every point; what was given of viscosity and current
follows the laws (`spinline.recipe.elsewhere`), and all concentrations are tried about the recipe's own. The draws are the same
everywhere, so that neighbours differ by what was changed and not by chance.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.base.version import __version__
from spinline.base.words import label
from spinline.recipe.elsewhere import elsewhere
from spinline.recipe.outside import outside_remarks, size_remarks
from spinline.recipe.predict import Fibre, one_laboratory, predict
from spinline.recipe.recipe_file import RecipeSheet
from spinline.recipe.regime import REGIMES

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["fibre_window"]

_DRAWS = 512  # a quantile of so many Sobol' points is good to 2 %
_BAND = ("16 % of the draws below", "median", "84 % of the draws below")
_AXES = {
    "voltage": ("V", 1.0, 1e6),
    "gap": ("m", 1e-4, 100.0),
    "flow_rate": ("m3 s-1", 1e-15, 1e-3),
    "mass_fraction": ("1", 1e-4, 0.99),
}
_OUT = {
    "fibre_diameter": ("m", "diameter of the dry fibre"),
    "orientation": ("1", "Hermans orientation of the strands in the solid fibre, an order of magnitude"),
    "current": ("A", "current that the jet carries"),
    "viscosity": ("Pa s", "zero-shear viscosity of the solution"),
}


def fibre_window(
    sheet: RecipeSheet,
    *,
    voltage: ArrayLike | None = None,
    gap: ArrayLike | None = None,
    flow_rate: ArrayLike | None = None,
    mass_fraction: ArrayLike | None = None,
    rung: str = "race",
    progress: Callable[[int, int], None] | None = None,
) -> "xr.Dataset":
    """Fibres over a grid of settings.

    Parameters
    ----------
    sheet : RecipeSheet
        From `load_recipe`.
    voltage, gap, flow_rate, mass_fraction : array_like, optional
        V, m, m3/s, -; rising; the recipe's own if left out.
    rung : str
        As for `fibre`.
    progress : callable, optional
        Called with the number of points that are done, and of all.

    Returns
    -------
    xarray.Dataset
        Along `interval` (16 %, median, 84 %) and the four axes: `fibre_diameter`, `orientation`, `regime`, `status` (0 or 2),
        `reason`, and `remark` (what lies outside all that is spun).

    Raises
    ------
    InputError
        For axes that cannot be.

    Notes
    -----
    About 20 ms a point; median and interval to 2 %.
    """
    import xarray as xr

    recipe, measured = one_laboratory(sheet.recipe(), sheet.measurements())
    given = {"voltage": voltage, "gap": gap, "flow_rate": flow_rate, "mass_fraction": mass_fraction}
    axes = {name: _axis(name, getattr(recipe, name) if values is None else values) for name, values in given.items()}
    shape = tuple(values.size for values in axes.values())
    found = {name: np.full((3, *shape), np.nan) for name in _OUT}
    regime, reason = np.full((3, *shape), "no answer", dtype=object), np.full((3, *shape), "", dtype=object)
    remark = reason.copy()
    total = int(np.prod(shape))
    borrowed: dict[str, str] = {}
    for done, (place, values) in enumerate(zip(np.ndindex(shape), product(*axes.values()), strict=True)):
        changes: dict[str, Any] = {name: float(x) for name, x in zip(axes, values, strict=True)}
        at = (slice(None), *place)
        remark[at] = "; ".join(outside_remarks(replace(recipe, **changes)))
        try:
            here = elsewhere(recipe, **changes)
            one = predict(here, measured, rung=rung, draws=_DRAWS, shares=False)
        except InputError as error:
            reason[at] = str(error)
            continue
        for name, three in _bands(one).items():
            found[name][at] = three
        remark[at] = "; ".join((*outside_remarks(here), *size_remarks(one.fibre_diameter)))
        regime[at], borrowed = one.regime, dict(one.borrowed)
        if progress is not None:
            progress(done + 1, total)
    dims = ("interval", *axes)
    variables: dict[str, Any] = {
        name: (dims, found[name], {"units": unit, "long_name": words}) for name, (unit, words) in _OUT.items()
    }
    variables["regime"] = (dims, regime.astype(str), {"long_name": "likeliest regime", **REGIMES})
    variables["status"] = (
        dims,
        np.where(regime == "no answer", 2, 0).astype(np.uint8),
        {"long_name": "0 ok, 2 refused"},
    )
    variables["reason"] = (dims, reason.astype(str), {"long_name": "why a point has no numbers"})
    variables["remark"] = (
        dims,
        remark.astype(str),
        {"long_name": "what of a point's settings lies outside all that is spun"},
    )
    coordinates = {name: (name, values, {"units": _AXES[name][0]}) for name, values in axes.items()}
    known = {0: "no fibre measured", 1: "one measured fibre"}.get(len(measured), f"{len(measured)} measured fibres")
    attributes = {
        "title": sheet.title or label(sheet.name),
        "scene": sheet.text,
        "spinline_version": __version__,
        "rung": rung,
        "intervals": f"68 % of {_DRAWS} draws of what is not known, {known}",
        "borrowed": "; ".join(f"{key}: {words}" for key, words in borrowed.items()),
    }
    return xr.Dataset(variables, {"interval": ("interval", list(_BAND)), **coordinates}, attributes)


def _bands(one: Fibre) -> dict[str, tuple[float, float, float]]:
    low, high = one.fibre_diameter_68
    less, more = one.orientation_68
    return {
        "fibre_diameter": (low, one.fibre_diameter, high),
        "orientation": (less, one.orientation, more),
        "current": (one.current,) * 3,
        "viscosity": (one.viscosity,) * 3,
    }


def _axis(name: str, values: ArrayLike) -> FloatArray:
    unit, low, high = _AXES[name]
    if np.ndim(values) == 0 and np.isnan(float(np.asarray(values))):
        raise InputError(name, "is not in the recipe", remedy="give it, or a range of it")
    array = np.atleast_1d(real(name, values, least=low, most=high, unit=unit))
    if array.ndim != 1 or not array.size or np.any(np.diff(array) <= 0):
        raise InputError(name, "is not a rising list", value=array.tolist(), remedy="sort it")
    return array
