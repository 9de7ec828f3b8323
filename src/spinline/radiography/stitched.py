"""What several positions along a jet are written as: one Dataset, the rows of all of them in the order of their places."""

from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from spinline.base.checks import FloatArray
from spinline.radiography.positions import Place
from spinline.radiography.reduction_dataset import assemble
from spinline.radiography.stage import Seam
from spinline.scene.images_file import Images
from spinline.xray.frame.blocks import FrameFit

__all__ = ["assemble_positions"]

_FAR = 4.0  # standard deviations of two positions' radii
_APART = 0.01  # probability of a seam under which the positions do not agree


def assemble_positions(
    images: Images,
    places: list[Place],
    fits: list[FrameFit],
    joint: FrameFit | None,
    z: FloatArray,
    found: list[Seam],
    remarks: list[str],
) -> xr.Dataset:
    """Dataset of a reduction of several positions.

    Parameters
    ----------
    images : Images
    places : list of Place
        In the order of their offsets.
    fits : list of FrameFit
        Of each, block by block.
    joint : FrameFit or None
        The map of all of them, of rows at `z`.
    z : ndarray, shape (rows,)
    found : list of Seam
    remarks : list of str

    Returns
    -------
    xarray.Dataset
        As of one position, along `row`, with the coordinate `position`; and along `seam` what neighbours say of the same place.
    """
    changes = {"title": images.title} | ({} if joint is None else {"block_rows": 1})  # a map takes every row
    first = replace(places[0].experiment, images=places[0].experiment.images.model_copy(update=changes))
    said = _words(places, found, remarks)
    facts = {name: float(np.median([place.facts[name] for place in places])) for name in places[0].facts}
    if joint is not None:
        result = assemble(replace(first, remarks=()), [joint], facts, each=False, remarks=said)
        at, position = z, _nearest(places, z)
    else:
        parts = [
            assemble(
                replace(place.experiment, remarks=()), [fit], place.facts, each=False, remarks=said if i == 0 else ()
            )
            for i, (place, fit) in enumerate(zip(places, fits, strict=True))
        ]
        result = xr.concat(
            parts, dim="row", data_vars="minimal", coords="minimal", compat="override", combine_attrs="override"
        )
        at = np.concatenate([_middles(place, fit) for place, fit in zip(places, fits, strict=True)])
        position = np.repeat(np.arange(len(places)), [fit.rows.shape[0] for fit in fits])
        order = np.argsort(at, kind="stable")
        result, at, position = result.isel(row=order), at[order], position[order]
    unit = {name: dict(result[name].attrs) for name in ("z", "row")}
    result = result.assign_coords(
        z=("row", at, unit["z"] | {"long_name": "distance along the jet, by the stage"}),
        row=(
            "row",
            np.arange(at.size, dtype=np.float64),
            unit["row"] | {"long_name": "row of all positions, by their place"},
        ),
        position=("row", position, {"long_name": "position that the row is from, or nearest to"}),
    )
    if joint is None:  # a map has the stage's error in its own
        stage = np.array([place.offset_std for place in places])[position]
        std = np.hypot(result["jet_radius_std"].values, np.abs(np.gradient(result["jet_radius"].values, at)) * stage)
        result["jet_radius_std"] = ("row", std, dict(result["jet_radius_std"].attrs))
    result = _with_seams(result, found)
    moved = {
        "position_offset": ([place.offset for place in places], "offset of the position, its radii told"),
        "position_offset_std": ([place.offset_std for place in places], "standard deviation of it"),
        "position_moved": ([place.moved for place in places], "by how much that is farther along than the stage said"),
    }
    result = result.assign(
        {
            name: ("place", np.array(v, dtype=np.float64), {"units": "m", "long_name": words})
            for name, (v, words) in moved.items()
        }
    )
    result.attrs |= {
        "images": images.text,
        "title": images.title or images.name,
        "frames": sum(place.experiment.used for place in places),
        "frames_read": "; ".join(
            f"{place.experiment.used} of {place.experiment.stack.account.source}" for place in places
        ),
        "positions": len(places),
    }
    return result


def _middles(place: Place, fit: FrameFit) -> FloatArray:
    return np.array([place.z[start:stop].mean() for start, stop in fit.rows.tolist()])


def _nearest(places: list[Place], z: FloatArray) -> NDArray[np.int64]:
    middles = np.array([place.z.mean() for place in places])
    nearest: NDArray[np.int64] = np.argmin(np.abs(z[:, None] - middles), axis=1).astype(np.int64)
    return nearest


def _with_seams(result: xr.Dataset, found: list[Seam]) -> xr.Dataset:
    """The result with what neighbouring positions say of the same place."""
    values = {
        "seam_chi_squared": ([s.chi_squared for s in found], "chi-squared of the mean fractions of two positions"),
        "seam_blocks": ([float(s.blocks) for s in found], "blocks that both see"),
        "seam_probability": ([s.probability for s in found], "of a larger chi-squared by chance"),
    }
    return result.assign(
        {
            name: ("seam", np.array(v, dtype=np.float64), {"units": "1", "long_name": words})
            for name, (v, words) in values.items()
        }
    )


def _words(places: list[Place], found: list[Seam], remarks: list[str]) -> tuple[str, ...]:
    """Remarks of all positions, each once, and of seams that do not agree."""
    said = list(dict.fromkeys([*remarks, *(r for place in places for r in place.experiment.remarks)]))
    said += [
        f"positions {s.first} and {s.second} disagree where they overlap: chi-squared {s.chi_squared:.3g} of {s.blocks} blocks "
        f"(probability {s.probability:.2g}); check offset, flats and drift"
        for s in found
        if s.probability < _APART
    ]
    said += [
        f"positions {s.first} and {s.second} see radii {1e6 * abs(s.radius_gap):.2g} um apart where they overlap "
        f"({abs(s.radius):.0f} standard deviations): check offset and pixel_size"
        for s in found
        if abs(s.radius) > _FAR
    ]
    return tuple(said)
