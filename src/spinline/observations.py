"""What was measured along a jet: radii and polymer fractions with their standard deviations.

An `Observation` holds one kind of value. They come from CSV tables (`read_table`), where every header names its
quantity and unit, and from reduced X-ray maps (`read_map`), netCDF files with dimensions ``row`` and ``shell``.

=========  ================================================================================================
kind       what is measured
=========  ================================================================================================
`radius`   jet radius, m
`mean`     polymer volume fraction, mean of the cross-section
`core`     polymer volume fraction of the core: where the contracted network is, or of a disc of r/R < outer around it
`chord`    mean polymer volume fraction along the chord through the axis, as Eq. (42) gives it
`shell`    polymer volume fraction of a ring, ``inner < r/R < outer``
=========  ================================================================================================

A value without a standard deviation is refused: without it neither an interval nor a likelihood means anything.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from spinline.checks import BoolArray, FloatArray
from spinline.errors import InputError, SpinlineWarning

__all__ = ["Kind", "Observation", "read_map", "read_table"]

Kind = Literal["radius", "mean", "core", "chord", "shell"]
_UNIT = {"radius": "m", "mean": "", "core": "", "chord": "", "shell": ""}
_COLUMNS = {
    "radius": ("radius", "jet_radius"),
    "mean": ("mean_polymer_fraction", "mean_fraction", "fraction"),
    "core": ("core_polymer_fraction", "core_fraction", "fraction"),
    "chord": ("chord_polymer_fraction", "chord_fraction", "fraction"),
}
_MAP = {
    "radius": "jet_radius", "mean": "mean_polymer_fraction", "shell": "polymer_fraction", "core": "polymer_fraction",
    "chord": "polymer_fraction",
}  # fmt: skip
_LARGEST = 10.0  # a fraction beyond this is a percentage, or not a fraction


@dataclass(frozen=True, eq=False)
class Observation:
    """Values of one kind along the jet; arrays (n,).

    Attributes
    ----------
    kind : {"radius", "mean", "core", "chord", "shell"}
        See the module's text.
    z : ndarray
        Distance from the nozzle as measured, m.
    value, std : ndarray
        Measured value and its standard deviation, SI.
    inner, outer : ndarray, optional
        Relative radii r/R that bound the ring, for ``kind = "shell"``; or the disc that a "core" was averaged over.
    covariance : ndarray, (rows, shells, shells), optional
        Of the rings of one row, where it is known; values are then row by row, and `std` is its diagonal's root.
    source : str
        File, for messages.
    notes : tuple of str
        What was left out or odd, in words.
    """

    kind: Kind
    z: FloatArray
    value: FloatArray
    std: FloatArray
    inner: FloatArray | None = None
    outer: FloatArray | None = None
    covariance: FloatArray | None = None
    source: str = "data"
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind):
            raise InputError("kind", "is not known", value=self.kind, allowed=", ".join(get_args(Kind)))
        unit = _UNIT[self.kind]
        arrays = {"z": self.z, "value": self.value, "std": self.std}
        if (self.inner is None) != (self.outer is None) or (self.kind == "shell" and self.outer is None):
            raise InputError(self.source, "has rings without their edges", remedy="give inner and outer")
        if self.inner is not None and self.outer is not None:
            arrays |= {"inner": self.inner, "outer": self.outer}
        for name, array in arrays.items():
            kept = np.atleast_1d(np.asarray(array, dtype=np.float64))
            if kept.ndim != 1 or kept.shape != np.shape(np.atleast_1d(self.z)):
                raise InputError(f"{self.source}: {name}", "must have one value for each z", value=kept.shape)
            object.__setattr__(self, name, kept)
        if not self.z.size:
            raise InputError(self.source, f"has no {self.kind} values", remedy="give at least one row of numbers")
        _refuse(self.source, "z", self.z, ~np.isfinite(self.z), "a finite length in m")
        if self.kind == "radius":
            _refuse(self.source, "radius", self.value, ~(self.value > 0), "(0, inf) m")
        else:
            bad = ~(np.abs(self.value) <= _LARGEST)
            _refuse(self.source, f"{self.kind} fraction", self.value, bad, f"[-{_LARGEST:g}, {_LARGEST:g}]",
                    "fractions, not percent; write the unit [%] in the header if they are percent")  # fmt: skip
        good = (self.std > 0) & np.isfinite(self.std)
        _refuse(self.source, "std", self.std, ~good, f"(0, inf) {unit}".strip(),
                "give the standard deviation of every value, or std in the fit file")  # fmt: skip
        _refuse(self.source, "value", self.value, ~np.isfinite(self.value), "a finite number")

    @property
    def size(self) -> int:
        """Number of values."""
        return int(self.z.size)

    def whiten(self, residual: FloatArray) -> FloatArray:
        """Residuals over their standard deviation, decorrelated within a row where a covariance is known."""
        if self.covariance is None:
            return residual / self.std
        factor = np.linalg.cholesky(self.covariance)
        rows = residual.reshape(factor.shape[0], factor.shape[1], 1)
        value: FloatArray = np.linalg.solve(factor, rows).ravel()
        return value

    def log_norm(self) -> float:
        """Logarithm of the likelihood's constant, ``-sum ln(std sqrt(2 pi))`` or its like with a covariance."""
        constant = -0.5 * self.size * np.log(2 * np.pi)
        if self.covariance is None:
            return float(constant - np.log(self.std).sum())
        return float(constant - 0.5 * np.linalg.slogdet(self.covariance)[1].sum())

    def within(self, low: float, high: float) -> "Observation":
        """Values between two measured distances (m), what was left out in `notes`.

        Raises
        ------
        InputError
            If none is left.
        """
        keep = (self.z >= low) & (self.z <= high)
        if keep.all():
            return self
        if not keep.any():
            raise InputError(
                f"{self.source}: z", "has no value in the range asked for", value=_extent(self.z),
                allowed=f"[{low:g}, {high:g}] m", remedy="widen z_range",
            )  # fmt: skip
        note = (
            f"{self.source}: {int((~keep).sum())} of {self.size} {self.kind} values lie outside [{low:g}, {high:g}] m"
        )
        return self._kept(keep, note)

    def _kept(self, keep: BoolArray, note: str) -> "Observation":
        covariance = self.covariance
        if covariance is not None:
            covariance = covariance[keep.reshape(covariance.shape[:2])[:, 0]]
        return replace(
            self, z=self.z[keep], value=self.value[keep], std=self.std[keep], covariance=covariance,
            inner=None if self.inner is None else self.inner[keep],
            outer=None if self.outer is None else self.outer[keep], notes=(*self.notes, note),
        )  # fmt: skip


def read_table(path: str | Path, kind: Kind, *, std: str | None = None) -> Observation:
    """Read a CSV table of radii or fractions.

    Parameters
    ----------
    path : path
        Columns ``z [mm]``, ``radius [um]`` or ``mean_fraction``, ``core_fraction``, ``chord_fraction``, and ``std``
        (or the value's name with ``_std``), in any order.
    kind : {"radius", "mean", "core", "chord"}
        What the table holds.
    std : str, optional
        Standard deviation where the table has none: "1 um", "0.002", or "2 %" of the value.

    Returns
    -------
    Observation
        Sorted by z.

    Raises
    ------
    InputError
        Naming file, column, value, what is allowed and the remedy.

    Warns
    -----
    SpinlineWarning
        Where z does not increase: the rows are sorted, and may have been put together from several tables.
    """
    from spinline.jetprofile.columns import read_columns

    file = str(path)
    if kind not in _COLUMNS:
        raise InputError("kind", "is not in a table", value=kind, allowed=", ".join(_COLUMNS), remedy='use "map"')
    unit = "length" if kind == "radius" else "number"
    names = _COLUMNS[kind]
    kinds = {"z": "length"} | dict.fromkeys(names, unit) | {f"{name}_std": unit for name in names} | {"std": unit}
    columns = read_columns(path, kinds, required=("z",))
    found = [name for name in names if name in columns]
    if len(found) != 1:
        problem = f"has no column {names[0]}" if not found else "has two columns for one quantity"
        raise InputError(file, problem, value=list(columns), allowed=f"one of {', '.join(names)}",
                         remedy="name the column for what it holds")  # fmt: skip
    spread = [name for name in columns if name == "std" or name.endswith("_std")]
    if len(spread) > 1:
        raise InputError(file, "has two columns of standard deviations", value=spread, remedy="keep one")
    z, value = columns["z"], columns[found[0]]
    if not z.size:
        raise InputError(file, "has a header and no numbers", remedy="give at least one row")
    for name in ("z", found[0]):
        _refuse(file, name, columns[name], ~np.isfinite(columns[name]), "finite numbers", "fill or remove the row")
    deviation = columns[spread[0]] if spread else _default_std(file, kind, value, std)
    _refuse(file, spread[0] if spread else "std", deviation, ~((deviation > 0) & np.isfinite(deviation)),
            f"(0, inf) {_UNIT[kind]}".strip(), "a standard deviation is positive")  # fmt: skip
    notes: tuple[str, ...] = ()
    if (np.diff(z) < 0).any():
        first = int(np.flatnonzero(np.diff(z) < 0)[0]) + 1
        notes = (
            f"{file}: z does not increase at row {first + 1} (z = {z[first]:g} m after {z[first - 1]:g} m); rows were "
            "sorted; check that the table is of one jet",
        )
        warnings.warn(notes[0], SpinlineWarning, stacklevel=2)
    order = np.argsort(z, kind="stable")
    return Observation(kind, z[order], value[order], deviation[order], source=file, notes=notes)


def read_map(
    path: "str | Path | Any", use: Sequence[Kind] = ("radius", "mean", "core"), *, core_within: float = 0.4
) -> list[Observation]:
    """Read a reduced X-ray map.

    Parameters
    ----------
    path : path or xarray.Dataset
        netCDF with dimensions ``row`` and ``shell``: ``jet_radius``, ``mean_polymer_fraction``, ``polymer_fraction``, each
        with ``_std``; coordinate ``z`` on row (m, or its ``units``), and ``shell`` or ``relative_radius``, r/R at the shells'
        centres. ``polymer_fraction_covariance`` (row, shell, shell) is used where it is there, and so is
        ``relative_radius_bounds``. z counts from where the map counts it: for ``spinline reduce`` the frame's first edge, so
        give an origin.
    use : sequence of {"radius", "mean", "core", "chord", "shell"}
        What to take. "core" is the disc of the shells whose centre lies within `core_within`; "shell" every shell; "chord", for
        a map by ``method = "chord"`` (whose shells are chords, not rings), the chord nearest the axis.
    core_within : float
        Relative radius, in (0, 1].

    Returns
    -------
    list of Observation
        In the order of `use`.

    Raises
    ------
    InputError
        Naming file, variable and what is missing or wrong.

    Notes
    -----
    Rows that the reduction left as NaN are left out and counted in `notes`. Shells of a row without a covariance are taken as
    independent, and so are "mean" and "core" of a row: they come from the same counts, so that intervals from both are
    somewhat too narrow; a note says so. A calibration error that all rows share (``calibration_std``) is taken out of the
    standard deviation of the mean: it belongs in ``fraction_offset`` or ``fraction_scale``, and the note says how much.
    """
    import xarray as xr

    if isinstance(path, xr.Dataset):
        file, dataset = "map", path
    else:
        from spinline.results import open_dataset

        file, dataset = str(path), open_dataset(path)
    if "frame" in dataset.dims:
        raise InputError(file, "holds a map of every frame", value=dataset.sizes["frame"], allowed="one map",
                         remedy='reduce with frames = "sum"')  # fmt: skip
    if "row" not in dataset.dims:
        raise InputError(file, "is not a reduced map: it has no dimension row", value=list(map(str, dataset.dims)),
                         remedy="make one with `spinline reduce`, or give a CSV table")  # fmt: skip
    chosen = list(dict.fromkeys(use))
    chords = dataset.attrs.get("method") == "chord"
    allowed = ["radius", "mean", "chord"] if chords else ["radius", "mean", "core", "shell"]
    for kind in chosen:
        if kind not in allowed:
            known = kind in _MAP
            problem = f"is not in a map by method {dataset.attrs.get('method', 'row')!r}" if known else "is not known"
            raise InputError("use", problem, value=kind, allowed=", ".join(allowed),
                             remedy='for example use = ["radius", "mean", "chord"]' if chords else "")  # fmt: skip
    z = _place(dataset, file)
    found = [_of_map(dataset, file, kind, z, core_within) for kind in chosen]
    shared = [kind for kind in chosen if kind != "radius"]
    if len(shared) > 1:
        note = f"{file}: {' and '.join(shared)} of a row come from the same counts and are taken as independent"
        found[-1] = replace(found[-1], notes=(*found[-1].notes, note))
    return found


def _of_map(dataset: Any, file: str, kind: Kind, z: FloatArray, core_within: float) -> Observation:
    name = _MAP[kind]
    for wanted in (name, f"{name}_std"):
        if wanted not in dataset:
            raise InputError(file, f"has no variable {wanted}", value=sorted(map(str, dataset.data_vars)),
                             allowed=", ".join(_MAP.values()) + ", each with _std")  # fmt: skip
    scale = 1.0
    if kind == "radius":
        from spinline.units import parse_unit

        scale = parse_unit(dataset[name].attrs.get("units", "m"), "length", f"{file}: {name}")[0]
    if kind in ("radius", "mean"):
        value, std = scale * _rows(dataset, file, name), scale * _rows(dataset, file, f"{name}_std")
        keep, note = _whole(file, name, np.isfinite(value))
        if kind == "mean" and "calibration_std" in dataset:
            std, note = _without_shared(file, std, _rows(dataset, file, "calibration_std"), keep, note)
        return Observation(kind, z[keep], value[keep], std[keep], source=f"{file}: {name}", notes=note)
    value, std = _rows(dataset, file, name, 2), _rows(dataset, file, f"{name}_std", 2)
    inner, outer = _edges(dataset, file)
    keep, note = _whole(file, name, np.asarray(np.isfinite(value).all(axis=1)))
    z, value, std = z[keep], value[keep], std[keep]
    covariance = _covariance(dataset, file, keep, std)
    source = f"{file}: {name}"
    if kind == "chord":
        return Observation("chord", z, value[:, 0], std[:, 0], source=source, notes=note)
    if kind == "shell":
        rows, shells = value.shape
        if covariance is None:
            note = (*note, f"{file}: shells of a row are taken as independent (no polymer_fraction_covariance)")
        return Observation(
            "shell", np.repeat(z, shells), value.ravel(), std.ravel(), np.tile(inner, rows), np.tile(outer, rows),
            covariance, source, note,
        )  # fmt: skip
    inside = 0.5 * (inner + outer) <= core_within
    if not inside.any():
        raise InputError("core_within", "holds no shell", value=core_within, allowed=f">= {0.5 * (inner + outer)[0]:g}")
    weight = np.where(inside, outer**2 - inner**2, 0.0)
    weight /= weight.sum()
    spread = std**2 @ weight**2 if covariance is None else np.einsum("i,rij,j->r", weight, covariance, weight)
    reach = np.full(z.size, outer[inside].max())
    return Observation("core", z, value @ weight, np.sqrt(spread), np.zeros(z.size), reach, source=source, notes=note)


def _place(dataset: Any, file: str) -> FloatArray:
    from spinline.units import parse_unit

    for name in ("z", "position", "distance"):
        if name in dataset.variables and dataset[name].dims == ("row",):
            scale, _ = parse_unit(dataset[name].attrs.get("units", "m"), "length", f"{file}: {name}")
            z: FloatArray = scale * np.asarray(dataset[name].values, dtype=np.float64)
            _refuse(file, name, z, ~np.isfinite(z), "finite lengths")
            return z
    raise InputError(file, "has no coordinate z on row", value=list(map(str, dataset.coords)),
                     remedy="reduce with the pixel size and the nozzle's row, or add the coordinate z (m)")  # fmt: skip


def _rows(dataset: Any, file: str, name: str, dimensions: int = 1) -> FloatArray:
    wanted = ("row", "shell")[:dimensions]
    variable = dataset[name]
    if set(variable.dims) != set(wanted):
        raise InputError(f"{file}: {name}", "has other dimensions", value=variable.dims, allowed=str(wanted))
    return np.asarray(variable.transpose(*wanted).values, dtype=np.float64)


def _edges(dataset: Any, file: str) -> tuple[FloatArray, FloatArray]:
    """Edges of the shells: as given, or each centre halfway between them, from 0 outwards."""
    if "relative_radius_bounds" in dataset:
        bounds = np.asarray(dataset["relative_radius_bounds"].values, dtype=np.float64)
        if bounds.ndim == 2 and bounds.shape[1] == 2 and (np.diff(bounds, axis=1) > 0).all() and (bounds >= 0).all():
            return bounds[:, 0].copy(), bounds[:, 1].copy()
        raise InputError(f"{file}: relative_radius_bounds", "is not pairs of rising edges", value=bounds.shape)
    name = "shell" if "shell" in dataset.coords else "relative_radius" if "relative_radius" in dataset else None
    if name is None:
        raise InputError(file, "has no coordinate shell", remedy="give r/R at the shells' centres")
    centres = np.asarray(dataset[name].values, dtype=np.float64)
    edges = [0.0]
    for centre in centres:
        edges.append(2 * float(centre) - edges[-1])
    rising = np.diff(edges) > 0
    if not (np.isfinite(centres).all() and rising.all() and edges[-1] <= 1 + 1e-6):
        raise InputError(f"{file}: {name}", "is not r/R at the centres of shells that fill the jet from its axis",
                         value=centres.tolist(), allowed="increasing, in (0, 1)")  # fmt: skip
    return np.array(edges[:-1]), np.array(edges[1:])


def _covariance(dataset: Any, file: str, keep: BoolArray, std: FloatArray) -> FloatArray | None:
    name = "polymer_fraction_covariance"
    if name not in dataset:
        return None
    variable = dataset[name]
    if variable.dims[0] != "row" or variable.ndim != 3 or variable.shape[1:] != (std.shape[1],) * 2:
        raise InputError(f"{file}: {name}", "has other dimensions", value=variable.dims, allowed="(row, shell, shell)")
    matrix = np.asarray(variable.values, dtype=np.float64)[keep]
    if not np.isfinite(matrix).all() or not (np.linalg.eigvalsh(matrix) > 0).all():
        raise InputError(f"{file}: {name}", "is not positive definite", remedy="reduce again, or drop the variable")
    return matrix


def _without_shared(
    file: str, std: FloatArray, shared: FloatArray, keep: BoolArray, note: tuple[str, ...]
) -> tuple[FloatArray, tuple[str, ...]]:
    """Standard deviations without the part that all rows share."""
    inside = np.where(np.isfinite(shared), np.abs(shared), 0.0)
    if not (inside[keep] > 0).any():
        return std, note
    own = np.sqrt(np.maximum(std**2 - inside**2, 0.0))
    typical = float(np.median(inside[keep]))
    return own, (*note, f"{file}: rows share a calibration error of {typical:.2g} in the fraction, taken out of the std of "
                        f"each: give fraction_offset or fraction_scale a prior of that size")  # fmt: skip


def _whole(file: str, name: str, whole: BoolArray) -> tuple[BoolArray, tuple[str, ...]]:
    if not whole.any():
        raise InputError(f"{file}: {name}", "is NaN in every row", remedy="reduce the images again")
    if whole.all():
        return whole, ()
    return whole, (f"{file}: {int((~whole).sum())} of {whole.size} rows of {name} are NaN and left out",)


def _default_std(file: str, kind: Kind, value: FloatArray, std: str | None) -> FloatArray:
    if std is None:
        raise InputError(file, "has no standard deviations", remedy='add a column std, or std = "2 %" to the fit file')
    from spinline.units import parse

    if isinstance(std, str) and std.strip().endswith("%"):
        return parse(std, "fraction", f"std of {file}").value * np.abs(value)
    return np.full_like(value, parse(std, "length" if kind == "radius" else "number", f"std of {file}").value)


def _refuse(file: str, column: str, values: FloatArray, bad: BoolArray, allowed: str, remedy: str = "") -> None:
    """InputError that names file, column, row (counted from 1) and value, if any is bad."""
    if bad.any():
        row = int(np.flatnonzero(bad)[0])
        more = f", and {int(bad.sum()) - 1} more" if bad.sum() > 1 else ""
        number = float(values[row])
        problem = "is not finite" if not np.isfinite(number) else "is out of range"
        raise InputError(f"{file}: {column}", f"{problem} at row {row + 1}{more}", value=number, allowed=allowed,
                         remedy=remedy or "correct or remove the row")  # fmt: skip


def _extent(z: FloatArray) -> str:
    return f"{float(z.min()):g} to {float(z.max()):g} m"
