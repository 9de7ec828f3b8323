"""Observations from a reduced X-ray map: netCDF with dimensions ``row`` and ``shell``, as ``spinline reduce`` writes it."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.fit.observations import Kind, Observation, refuse

__all__ = ["read_map"]

_MAP = {
    "radius": "jet_radius",
    "mean": "mean_polymer_fraction",
    "shell": "polymer_fraction",
    "core": "polymer_fraction",
    "chord": "polymer_fraction",
}


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
    somewhat too narrow; a note says so. So does one for rows by method "map",
    which are smoothed together. A calibration error that all rows share (``calibration_std``) is taken out of the
    standard deviation of the mean: it belongs in ``fraction_offset`` or ``fraction_scale``, and the note says how much.
    """
    import xarray as xr

    if isinstance(path, xr.Dataset):
        file, dataset = "map", path
    else:
        from spinline.base.netcdf import open_dataset

        file, dataset = str(path), open_dataset(path)
    if "frame" in dataset.dims:
        raise InputError(
            file,
            "holds a map of every frame",
            value=dataset.sizes["frame"],
            allowed="one map",
            remedy='reduce with frames = "sum"',
        )
    if "row" not in dataset.dims:
        raise InputError(
            file,
            "is not a reduced map: it has no dimension row",
            value=list(map(str, dataset.dims)),
            remedy="make one with `spinline reduce`",
        )
    chosen = list(dict.fromkeys(use))
    chords = dataset.attrs.get("method") == "chord"
    allowed = ["radius", "mean", "chord"] if chords else ["radius", "mean", "core", "shell"]
    for kind in chosen:
        if kind not in allowed:
            known = kind in _MAP
            problem = f"is not in a map by method {dataset.attrs.get('method', 'row')!r}" if known else "is not known"
            raise InputError(
                "use",
                problem,
                value=kind,
                allowed=", ".join(allowed),
                remedy='for example use = ["radius", "mean", "chord"]' if chords else "",
            )
    z = _place(dataset, file)
    found = [_of_map(dataset, file, kind, z, core_within) for kind in chosen]
    shared = [kind for kind in chosen if kind != "radius"]
    if dataset.attrs.get("method") == "map":
        note = (
            f"{file}: rows of a map are smoothed together and are taken as independent: chi-squared and standard errors are "
            'too sharp; method "row" has rows that are'
        )
        found[0] = replace(found[0], notes=(*found[0].notes, note))
    if len(shared) > 1:
        note = f"{file}: {' and '.join(shared)} of a row come from the same counts and are taken as independent"
        found[-1] = replace(found[-1], notes=(*found[-1].notes, note))
    return found


def _of_map(dataset: Any, file: str, kind: Kind, z: FloatArray, core_within: float) -> Observation:
    name = _MAP[kind]
    for wanted in (name, f"{name}_std"):
        if wanted not in dataset:
            raise InputError(
                file,
                f"has no variable {wanted}",
                value=sorted(map(str, dataset.data_vars)),
                allowed=", ".join(_MAP.values()) + ", each with _std",
            )
    scale = 1.0
    if kind == "radius":
        from spinline.base.units import parse_unit

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
            "shell",
            np.repeat(z, shells),
            value.ravel(),
            std.ravel(),
            np.tile(inner, rows),
            np.tile(outer, rows),
            covariance,
            source,
            note,
        )
    inside = 0.5 * (inner + outer) <= core_within
    if not inside.any():
        raise InputError("core_within", "holds no shell", value=core_within, allowed=f">= {0.5 * (inner + outer)[0]:g}")
    weight = np.where(inside, outer**2 - inner**2, 0.0)
    weight /= weight.sum()
    spread = std**2 @ weight**2 if covariance is None else np.einsum("i,rij,j->r", weight, covariance, weight)
    reach = np.full(z.size, outer[inside].max())
    return Observation("core", z, value @ weight, np.sqrt(spread), np.zeros(z.size), reach, source=source, notes=note)


def _place(dataset: Any, file: str) -> FloatArray:
    from spinline.base.units import parse_unit

    for name in ("z", "position", "distance"):
        if name in dataset.variables and dataset[name].dims == ("row",):
            scale, _ = parse_unit(dataset[name].attrs.get("units", "m"), "length", f"{file}: {name}")
            z: FloatArray = scale * np.asarray(dataset[name].values, dtype=np.float64)
            refuse(file, name, z, ~np.isfinite(z), "finite lengths")
            return z
    raise InputError(
        file,
        "has no coordinate z on row",
        value=list(map(str, dataset.coords)),
        remedy="reduce with the pixel size and the nozzle's row, or add the coordinate z (m)",
    )


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
        raise InputError(
            f"{file}: {name}",
            "is not r/R at the centres of shells that fill the jet from its axis",
            value=centres.tolist(),
            allowed="increasing, in (0, 1)",
        )
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
    return own, (
        *note,
        f"{file}: rows share a calibration error of {typical:.2g} in the fraction, taken out of the std of "
        f"each: give fraction_offset or fraction_scale a prior of that size",
    )


def _whole(file: str, name: str, whole: BoolArray) -> tuple[BoolArray, tuple[str, ...]]:
    if not whole.any():
        raise InputError(f"{file}: {name}", "is NaN in every row", remedy="reduce the images again")
    if whole.all():
        return whole, ()
    return whole, (f"{file}: {int((~whole).sum())} of {whole.size} rows of {name} are NaN and left out",)
