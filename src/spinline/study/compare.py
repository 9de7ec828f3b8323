"""What differs between two results: scene, models, numbers, and profiles along the jet.

Profiles are compared where both jets are, at the places of both (linear between them where the grids differ), by the largest
relative difference ``|a - b| / max(|a|, |b|)`` and by the largest difference over the larger profile's largest value: the first
is strict where a variable is nearly zero, the second is what a figure shows. Maps across the jet are compared in the same
way, the worst place across it for each place along it.

Where a result carries the uncertainty of its inputs, a number's difference is given in standard uncertainties too,
``|a - b| / (s_a^2 + s_b^2)^(1/2)``, as if the two results' inputs were independent: what they share makes it an underestimate.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import xarray as xr

from spinline.base.checks import FloatArray, number
from spinline.base.errors import InputError

__all__ = ["Comparison", "ProfileDifference", "ScalarDifference", "TextDifference", "compare"]

_NOT_MODELS = (
    "plan",
    "trade",
    "bands",
    "scene",
    "title",
    "warnings",
    "references",
    "Conventions",
    "source",
    "crossover",
    "crossover_extension",
    "jet_attributes",
)
_ROUNDING = 1e-12


@dataclass(frozen=True)
class TextDifference:
    """A key of the scene, or an attribute; None where it is not given."""

    name: str
    a: Any
    b: Any


@dataclass(frozen=True)
class ScalarDifference:
    """A number; `relative` is ``|a - b| / max(|a|, |b|)``, NaN where one is NaN.

    Attributes
    ----------
    name, unit : str
    a, b : float
    relative : float
    a_std, b_std : float
        Standard uncertainties from the inputs', NaN where there are none.
    sigmas : float
        Difference over their root sum of squares (of the one there is); NaN without any.
    """

    name: str
    unit: str
    a: float
    b: float
    relative: float
    a_std: float = float("nan")
    b_std: float = float("nan")
    sigmas: float = float("nan")


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
    not_compared : tuple of str
        Maps whose places across the jet differ, and what lies along the jet in one result only.
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
    not_compared: tuple[str, ...] = ()

    @property
    def same(self) -> bool:
        """No number differs, neither has variables of its own, and all were compared."""
        return not (self.scalars or self.profiles or self.only_a or self.only_b or self.not_compared)

    def to_dict(self) -> dict[str, Any]:
        """For JSON: NaN as None."""
        from spinline.solve.results import plain

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
    level = number("tolerance", rtol, least=0.0, below=1.0)
    if ("time" in a.dims) != ("time" in b.dims) or ("time" in a.dims and a["time"].shape != b["time"].shape):
        raise InputError("results", "have different times", remedy="take one time of each: jet.time in the scene")
    names_a, names_b = _names(a), _names(b)
    common = [name for name in names_a if name in names_b]
    scalars = [_scalar(name, a, b) for name in common if not _along(a[name]) and not _along(b[name])]
    profiled = [name for name in common if _along(a[name]) and _along(b[name]) and _across_alike(name, a, b)]
    span, places, profiles = _profiles(a, b, profiled)
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
        not_compared=tuple(n for n in common if (_along(a[n]) or _along(b[n])) and n not in profiled),
    )


def _names(result: xr.Dataset) -> list[str]:
    """Variables that are compared: of uncertainties only the numbers' own, with their number."""
    return [
        str(name)
        for name, v in result.data_vars.items()
        if not {"bead", "quantile"} & set(v.dims) and v.dtype.kind in "fb" and not str(name).endswith("_std")
    ]


def _along(variable: xr.DataArray) -> bool:
    return "z" in variable.dims or "element" in variable.dims


def _across_alike(name: str, a: xr.Dataset, b: xr.Dataset) -> bool:
    """Whether a map has the same places across the jet in both; a profile has none."""
    grids = [tuple(r[d].values.tolist() for d in r[name].dims if d in ("r", "layer")) for r in (a, b)]
    return grids[0] == grids[1]


def _scalar(name: str, a: xr.Dataset, b: xr.Dataset) -> list[ScalarDifference]:
    one, other = np.atleast_1d(a[name].values).astype(float), np.atleast_1d(b[name].values).astype(float)
    unit = str(a[name].attrs.get("units", ""))
    label = [name] if one.size == 1 else [f"{name}[{i}]" for i in range(one.size)]
    stds = [float(r[f"{name}_std"]) if f"{name}_std" in r else float("nan") for r in (a, b)]
    spread = float(np.sqrt(np.nansum(np.square(stds))))
    return [
        ScalarDifference(
            text,
            unit,
            float(x),
            float(y),
            float(_relative(x, y)),
            stds[0],
            stds[1],
            abs(float(x) - float(y)) / spread if spread > _ROUNDING * abs(x) else float("nan"),
        )
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
        return np.broadcast_to(values[:1], (grid.size, *values.shape[1:])).astype(float)
    left, right = values[i], values[i + 1]
    tall = (-1, *[1] * (values.ndim - 1))  # a map across the jet has columns
    here, there, at = (x.reshape(tall) for x in (place[i], place[i + 1], grid))
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(there > here, (at - here) / (there - here), 0.0)
        between = left + share * (right - left)
    value: FloatArray = np.where(at == here, left, np.where(at == there, right, between))
    return value


def _difference(name: str, grid: FloatArray, x: FloatArray, y: FloatArray) -> ProfileDifference:
    one_sided = int((np.isnan(x) != np.isnan(y)).sum())
    relative = np.nan_to_num(_relative(x, y), nan=0.0)
    at = np.unravel_index(int(np.argmax(relative)), relative.shape)
    finite = np.isfinite(x) & np.isfinite(y)
    size = max(np.abs(x[finite]).max(initial=0.0), np.abs(y[finite]).max(initial=0.0))
    gap = np.abs(x[finite] - y[finite]).max(initial=0.0)
    return ProfileDifference(
        name, float(relative[at]), float(gap / size) if size else 0.0, float(grid[at[0]]), one_sided
    )


def _scene(result: xr.Dataset) -> dict[str, Any]:
    """Tables of the scene a result was made from, with what was set on the command line."""
    from spinline.study.sweep_file import scene_tables

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
    """A value in SI with its uncertainty where the scene reads it as a quantity, so that "125 um" is "0.125 mm"."""
    from spinline.base.units import parse
    from spinline.scene.keys import full_key, read_value, reader
    from spinline.scene.quantities import Read

    try:
        name = full_key(key, key)
        how = reader(name)
        if isinstance(how, Read) and isinstance(value, str | int | float):
            measured = parse(value, how.kind, key)
            return float(f"{measured.value:.12g}"), float(f"{measured.std:.12g}")
        read = read_value(name, value, key, ranged=False)
    except InputError:
        read = value
    read = _bare(read)
    return float(f"{read:.12g}") if isinstance(read, int | float) and not isinstance(read, bool) else repr(read)
