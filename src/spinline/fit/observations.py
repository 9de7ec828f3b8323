"""What was measured along a jet: radii and polymer fractions with their standard deviations.

An `Observation` holds one kind of value. They come from CSV tables (`read_table`), where every header names its
quantity and unit, and from reduced X-ray maps (`spinline.fit.observed_map`).

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
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError, SpinlineWarning

__all__ = ["Kind", "Observation", "read_table", "refuse"]

Kind = Literal["radius", "mean", "core", "chord", "shell"]
_UNIT = {"radius": "m", "mean": "", "core": "", "chord": "", "shell": ""}
_COLUMNS = {
    "radius": ("radius", "jet_radius"),
    "mean": ("mean_polymer_fraction", "mean_fraction", "fraction"),
    "core": ("core_polymer_fraction", "core_fraction", "fraction"),
    "chord": ("chord_polymer_fraction", "chord_fraction", "fraction"),
}
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
        refuse(self.source, "z", self.z, ~np.isfinite(self.z), "a finite length in m")
        if self.kind == "radius":
            refuse(self.source, "radius", self.value, ~(self.value > 0), "(0, inf) m")
        else:
            bad = ~(np.abs(self.value) <= _LARGEST)
            refuse(
                self.source,
                f"{self.kind} fraction",
                self.value,
                bad,
                f"[-{_LARGEST:g}, {_LARGEST:g}]",
                "fractions, not percent; write the unit [%] in the header if they are percent",
            )
        good = (self.std > 0) & np.isfinite(self.std)
        refuse(
            self.source,
            "std",
            self.std,
            ~good,
            f"(0, inf) {unit}".strip(),
            "give the standard deviation of every value, or std in the fit file",
        )
        refuse(self.source, "value", self.value, ~np.isfinite(self.value), "a finite number")

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
                f"{self.source}: z",
                "has no value in the range asked for",
                value=_extent(self.z),
                allowed=f"[{low:g}, {high:g}] m",
                remedy="widen z_range",
            )
        note = (
            f"{self.source}: {int((~keep).sum())} of {self.size} {self.kind} values lie outside [{low:g}, {high:g}] m"
        )
        return self._kept(keep, note)

    def _kept(self, keep: BoolArray, note: str) -> "Observation":
        covariance = self.covariance
        if covariance is not None:
            covariance = covariance[keep.reshape(covariance.shape[:2])[:, 0]]
        return replace(
            self,
            z=self.z[keep],
            value=self.value[keep],
            std=self.std[keep],
            covariance=covariance,
            inner=None if self.inner is None else self.inner[keep],
            outer=None if self.outer is None else self.outer[keep],
            notes=(*self.notes, note),
        )


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
    columns = read_columns(path, kinds, required=("z", names), others=True)
    found = [name for name in names if name in columns]
    if len(found) > 1:
        raise InputError(
            file,
            "has two columns for one quantity",
            value=list(columns),
            allowed=f"one of {', '.join(names)}",
            remedy="name the column for what it holds",
        )
    spread = [name for name in columns if name == "std" or name.endswith("_std")]
    if len(spread) > 1:
        raise InputError(file, "has two columns of standard deviations", value=spread, remedy="keep one")
    z, value = columns["z"], columns[found[0]]
    if not z.size:
        raise InputError(file, "has a header and no numbers", remedy="give at least one row")
    for name in ("z", found[0]):
        refuse(file, name, columns[name], ~np.isfinite(columns[name]), "finite numbers", "fill or remove the row")
    deviation = columns[spread[0]] if spread else _default_std(file, kind, value, std)
    refuse(
        file,
        spread[0] if spread else "std",
        deviation,
        ~((deviation > 0) & np.isfinite(deviation)),
        f"(0, inf) {_UNIT[kind]}".strip(),
        "a standard deviation is positive",
    )
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


def _default_std(file: str, kind: Kind, value: FloatArray, std: str | None) -> FloatArray:
    if std is None:
        raise InputError(file, "has no standard deviations", remedy='add a column std, or std = "2 %" to the fit file')
    from spinline.base.units import parse

    if isinstance(std, str) and std.strip().endswith("%"):
        return parse(std, "fraction", f"std of {file}").value * np.abs(value)
    return np.full_like(value, parse(std, "length" if kind == "radius" else "number", f"std of {file}").value)


def refuse(file: str, column: str, values: FloatArray, bad: BoolArray, allowed: str, remedy: str = "") -> None:
    """InputError that names file, column, row (counted from 1) and value, if any is bad."""
    if bad.any():
        row = int(np.flatnonzero(bad)[0])
        more = f", and {int(bad.sum()) - 1} more" if bad.sum() > 1 else ""
        number = float(values[row])
        problem = "is not finite" if not np.isfinite(number) else "is out of range"
        raise InputError(
            f"{file}: {column}",
            f"{problem} at row {row + 1}{more}",
            value=number,
            allowed=allowed,
            remedy=remedy or "correct or remove the row",
        )


def _extent(z: FloatArray) -> str:
    return f"{float(z.min()):g} to {float(z.max()):g} m"
