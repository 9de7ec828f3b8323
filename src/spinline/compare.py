"""What differs between two results: scene, models, numbers, and profiles along the jet.

Profiles are compared where both jets are, at the places of both (linear between them where the grids differ), by the largest
relative difference ``|a - b| / max(|a|, |b|)`` and by the largest difference over the larger profile's largest value: the first
is strict where a variable is nearly zero, the second is what a figure shows.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import xarray as xr

from spinline.checks import FloatArray, number
from spinline.errors import InputError

__all__ = ["Comparison", "ProfileDifference", "ScalarDifference", "TextDifference", "compare"]

_NOT_MODELS = ("scene", "title", "warnings", "references", "Conventions", "source", "crossover", "crossover_extension",
               "jet_attributes")  # fmt: skip
_ROUNDING = 1e-12


@dataclass(frozen=True)
class TextDifference:
    """A key of the scene, or an attribute; None where it is not given."""

    name: str
    a: Any
    b: Any


@dataclass(frozen=True)
class ScalarDifference:
    """A number; `relative` is ``|a - b| / max(|a|, |b|)``, NaN where one is NaN."""

    name: str
    unit: str
    a: float
    b: float
    relative: float


@dataclass(frozen=True)
class ProfileDifference:
    """A variable along the jet.

    Attributes
    ----------
    name : str
    largest : float
        Largest relative difference.
    of_range : float
        Largest difference over the largest value of either.
    position : float
        Where `largest` is, m from the nozzle (arc length for bead jets).
    one_sided : int
        Places where only one of the two is a number.
    """

    name: str
    largest: float
    of_range: float
    position: float
    one_sided: int


@dataclass(frozen=True)
class Comparison:
    """What `compare` found; every part lists only what differs by more than `rtol`.

    Attributes
    ----------
    rtol : float
        Below this numbers are the same.
    scene, models : tuple of TextDifference
        Keys of the scene (what was overridden counts), and attributes that say how it was computed.
    scalars : tuple of ScalarDifference
    profiles : tuple of ProfileDifference
    only_a, only_b : tuple of str
        Variables that one result has alone.
    span : tuple of float
        m, where profiles were compared; NaN where the jets do not overlap.
    places : int
        Points compared.
    """

    rtol: float
    scene: tuple[TextDifference, ...]
    models: tuple[TextDifference, ...]
    scalars: tuple[ScalarDifference, ...]
    profiles: tuple[ProfileDifference, ...]
    only_a: tuple[str, ...]
    only_b: tuple[str, ...]
    span: tuple[float, float]
    places: int

    @property
    def same(self) -> bool:
        """No number differs, and neither has variables of its own."""
        return not (self.scalars or self.profiles or self.only_a or self.only_b)

    def to_dict(self) -> dict[str, Any]:
        """For JSON: NaN as None."""
        from spinline.results import plain

        def clean(value: Any) -> Any:
            if isinstance(value, Mapping):
                return {key: clean(inner) for key, inner in value.items()}
            if isinstance(value, list | tuple):
                return [clean(inner) for inner in value]
            return plain(value) if isinstance(value, float) else value

        cleaned: dict[str, Any] = clean({"same": self.same, **asdict(self)})
        return cleaned


def compare(a: xr.Dataset, b: xr.Dataset, *, rtol: float = _ROUNDING) -> Comparison:
    """Differences of two results.

    Parameters
    ----------
    a, b : xarray.Dataset
        From `spinline.run` or `open_result`. Of several times, both must have the same.
    rtol : float
        Differences up to this are none.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        For results of different times.
    """
    level = number("rtol", rtol, least=0.0, below=1.0)
    if ("time" in a.dims) != ("time" in b.dims) or ("time" in a.dims and a["time"].shape != b["time"].shape):
        raise InputError("results", "have different times", remedy="take one time of each: jet.time in the scene")
    names_a, names_b = _names(a), _names(b)
    common = [name for name in names_a if name in names_b]
    scalars = [_scalar(name, a, b) for name in common if not _along(a[name])]
    span, places, profiles = _profiles(a, b, [name for name in common if _along(a[name]) and _along(b[name])])
    return Comparison(
        rtol=level,
        scene=_texts(_flat(_scene(a)), _flat(_scene(b))),
        models=_texts(_models(a), _models(b)),
        scalars=tuple(s for many in scalars for s in many if not s.relative <= level),
        profiles=tuple(p for p in profiles if p.one_sided or not p.largest <= level),
        only_a=tuple(name for name in names_a if name not in names_b),
        only_b=tuple(name for name in names_b if name not in names_a),
        span=span,
        places=places,
    )


def _names(result: xr.Dataset) -> list[str]:
    return [str(name) for name, v in result.data_vars.items() if "bead" not in v.dims and v.dtype.kind in "fb"]


def _along(variable: xr.DataArray) -> bool:
    return "z" in variable.dims or "element" in variable.dims


def _scalar(name: str, a: xr.Dataset, b: xr.Dataset) -> list[ScalarDifference]:
    one, other = np.atleast_1d(a[name].values).astype(float), np.atleast_1d(b[name].values).astype(float)
    unit = str(a[name].attrs.get("units", ""))
    label = [name] if one.size == 1 else [f"{name}[{i}]" for i in range(one.size)]
    return [
        ScalarDifference(text, unit, float(x), float(y), float(_relative(x, y)))
        for text, x, y in zip(label, one, other, strict=True)
    ]


def _relative(x: Any, y: Any) -> FloatArray:
    """``|x - y| / max(|x|, |y|)``; 0 where both are NaN, equal or infinite alike; NaN where one is NaN."""
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    same = (x == y) | (np.isnan(x) & np.isnan(y))
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        value = np.abs(x - y) / np.maximum(np.abs(x), np.abs(y))
    return np.where(same, 0.0, np.where(np.isinf(x) != np.isinf(y), 1.0, value))


def _profiles(
    a: xr.Dataset, b: xr.Dataset, names: list[str]
) -> tuple[tuple[float, float], int, list[ProfileDifference]]:
    moments = range(a.sizes["time"]) if "time" in a.dims else [None]
    found: dict[str, list[ProfileDifference]] = {name: [] for name in names}
    places, span = 0, (float("nan"), float("nan"))
    for moment in moments:
        one, other = (r if moment is None else r.isel(time=moment) for r in (a, b))
        at_a, known_a = _places(one)
        at_b, known_b = _places(other)
        if not at_a.size or not at_b.size:
            continue
        low, high = max(at_a[0], at_b[0]), min(at_a[-1], at_b[-1])
        if not low <= high:
            continue
        every = np.unique(np.concatenate((at_a, at_b)))
        grid = every[(every >= low) & (every <= high)]
        span, places = (float(low), float(high)), places + grid.size
        for name in names:
            x = _on(grid, at_a, one[name].values[known_a])
            y = _on(grid, at_b, other[name].values[known_b])
            found[name].append(_difference(name, grid, x, y))
    merged = [max(parts, key=lambda p: (p.largest, p.one_sided)) for parts in found.values() if parts]
    return span, places, merged


def _places(result: xr.Dataset) -> tuple[FloatArray, Any]:
    place = result["arc_length" if "element" in result.dims else "z"].values
    known = np.flatnonzero(np.isfinite(place) & np.isfinite(result["stretch_ratio"].values))
    order = known[np.argsort(place[known], kind="stable")]
    return place[order], order


def _on(grid: FloatArray, place: FloatArray, values: Any) -> FloatArray:
    """Values on a grid: those of the places themselves, linear between; flags are those of the nearer place upstream."""
    if values.dtype == bool:
        return np.asarray(
            values[np.clip(np.searchsorted(place, grid, side="right") - 1, 0, place.size - 1)], dtype=float
        )
    i = np.clip(np.searchsorted(place, grid, side="right") - 1, 0, max(place.size - 2, 0))
    if place.size == 1:
        return np.full(grid.shape, float(values[0]))
    left, right = values[i], values[i + 1]
    step = place[i + 1] - place[i]
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(step > 0, (grid - place[i]) / step, 0.0)
        between = left + share * (right - left)
    value: FloatArray = np.where(grid == place[i], left, np.where(grid == place[i + 1], right, between))
    return value


def _difference(name: str, grid: FloatArray, x: FloatArray, y: FloatArray) -> ProfileDifference:
    one_sided = int((np.isnan(x) != np.isnan(y)).sum())
    relative = np.nan_to_num(_relative(x, y), nan=0.0)
    at = int(np.argmax(relative))
    finite = np.isfinite(x) & np.isfinite(y)
    size = max(np.abs(x[finite]).max(initial=0.0), np.abs(y[finite]).max(initial=0.0))
    gap = np.abs(x[finite] - y[finite]).max(initial=0.0)
    return ProfileDifference(name, float(relative[at]), float(gap / size) if size else 0.0, float(grid[at]), one_sided)


def _scene(result: xr.Dataset) -> dict[str, Any]:
    """Tables of the scene a result was made from, with what was set on the command line."""
    from spinline.sweep_file import scene_tables

    try:
        return scene_tables(str(result.attrs.get("scene", "")))
    except (tomllib.TOMLDecodeError, InputError):
        return {}


def _flat(data: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in data.items():
        flat |= _flat(value, f"{before}{key}.") if isinstance(value, Mapping) else {f"{before}{key}": value}
    return flat


def _models(result: xr.Dataset) -> dict[str, Any]:
    return {str(key): value for key, value in result.attrs.items() if key not in _NOT_MODELS}


def _texts(a: Mapping[str, Any], b: Mapping[str, Any]) -> tuple[TextDifference, ...]:
    keys = [*a, *(key for key in b if key not in a)]
    return tuple(
        TextDifference(key, _bare(a.get(key)), _bare(b.get(key)))
        for key in keys
        if _meaning(key, a.get(key)) != _meaning(key, b.get(key))
    )


def _bare(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def _meaning(key: str, value: Any) -> Any:
    """A value in SI where the scene reads it as a quantity, so that "125 um" is "0.125 mm"."""
    from spinline.sweep_keys import full_key, read_value

    try:
        read = read_value(full_key(key, key), value, key, ranged=False)
    except InputError:
        read = value
    read = _bare(read)
    return float(f"{read:.12g}") if isinstance(read, int | float) and not isinstance(read, bool) else repr(read)
