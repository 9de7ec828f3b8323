"""Pores of a mat, four ways, from voxels.

==================  ==================================================================================
`ball_fits`         share of the volume where a ball of radius r, centred there, fits (distance to solid)
`pore_size`         share of the pores that a ball of radius r can cover (largest ball: local thickness)
`bubble_point`      radius of the largest ball that can pass from top to bottom
`open_areas`        areas of the openings seen from above, as on an SEM image
==================  ==================================================================================

A distance transform measures to the *centres* of solid voxels; the surface is half a voxel nearer, which is taken off here
(without it P(r) of a random network is 4 to 16 % too high). Everything is in voxels; multiply by the voxel.

References
----------
Hildebrand, Rueegsegger, J. Microsc. 185, 67 (1997) (local thickness). Miles, Math. Biosci. 21, 23 (1974), and Lantuejoul (1980)
(weights of what touches the edge).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage

from spinline.base.checks import BoolArray, FloatArray, real
from spinline.base.errors import InputError

__all__ = ["OpenAreas", "ball_fits", "bubble_point", "distance_to_solid", "open_areas", "pore_size"]

_HALF = 0.5  # from the centre of a solid voxel to its face


def distance_to_solid(solid: BoolArray, *, periodic: bool = False) -> FloatArray:
    """Distance of each voxel's centre to the solid's surface, in voxels; 0 in the solid, inf where there is no solid.

    Parameters
    ----------
    solid : ndarray of bool
        Two or three axes.
    periodic : bool
        The first two axes wrap.
    """
    box = _box(solid)
    if not box.any():
        return np.full(box.shape, np.inf)
    plain = np.maximum(_edt(~box) - _HALF, 0.0)
    if periodic:  # wrapped distances are not longer: what lies farther than the longest of them cannot matter
        look = int(np.ceil(plain.max())) + 1
        pads = [min(n, look) for n in box.shape[:2]]
        width = [(pad, pad) for pad in pads] + [(0, 0)] * (box.ndim - 2)
        wide = _edt(~np.pad(box, width, mode="wrap"))
        inner = tuple(slice(pad, pad + n) for pad, n in zip(pads, box.shape[:2], strict=True))
        return np.maximum(wide[inner] - _HALF, 0.0)
    return plain


def ball_fits(solid: BoolArray, radius: ArrayLike, *, periodic: bool = False) -> FloatArray:
    """Share of all voxels at which a ball of each radius (voxels, >= 0) fits; at 0 the porosity."""
    r = real("radius", radius, least=0.0)
    distance = np.sort(distance_to_solid(solid, periodic=periodic).ravel())
    return np.asarray(1 - np.searchsorted(distance, np.maximum(r, 1e-12), side="left") / distance.size)


def pore_size(solid: BoolArray, radius: ArrayLike, *, periodic: bool = False) -> FloatArray:
    """Share of the pore volume that balls of each radius can cover: 1 at 0, falling.

    Parameters
    ----------
    solid : ndarray of bool
    radius : array_like, (n,)
        In voxels, >= 0; two distance transforms each.
    periodic : bool
        The first two axes wrap.
    """
    r = real("radius", radius, least=0.0)
    box = _box(solid)
    pores = int((~box).sum())
    if not pores:
        raise InputError("pores", "there are none: every voxel is fibre", remedy="take finer voxels or a thinner mat")
    distance = distance_to_solid(box, periodic=periodic)
    out = np.empty(r.shape)
    for index in np.ndindex(*r.shape):
        size = float(r[index])
        centres = distance >= size
        if not centres.any():
            out[index] = 0.0
        elif size == 0 or not np.isfinite(distance).all():
            out[index] = 1.0
        else:
            around = _to(centres, periodic, int(np.ceil(size)) + 1)
            out[index] = np.count_nonzero((around <= size + _HALF) & ~box) / pores
    return out


def bubble_point(solid: BoolArray) -> float:
    """Radius, in voxels, of the largest ball that passes along the last axis from face to face; 0 if none does.

    The sides are closed. inf for an empty box.
    """
    distance = distance_to_solid(solid)
    if np.isinf(distance).all():
        return float("inf")
    low, high = 0, 0
    levels = np.unique(distance[distance > 0])
    high = levels.size
    while low < high:
        middle = (low + high) // 2
        if _through(distance >= levels[middle]):
            low = middle + 1
        else:
            high = middle
    return float(levels[low - 1]) if low else 0.0


class OpenAreas(NamedTuple):
    """Openings of a plane image, those inside it; areas in pixels and their weights for the edge (Miles-Lantuejoul)."""

    area: FloatArray
    weight: FloatArray

    @property
    def mean(self) -> float:
        """Mean area; NaN if there is none."""
        return float(np.average(self.area, weights=self.weight)) if self.area.size else float("nan")

    @property
    def variation(self) -> float:
        """Standard deviation of the area over its mean."""
        if not self.area.size:
            return float("nan")
        spread = np.average((self.area - self.mean) ** 2, weights=self.weight)
        return float(np.sqrt(spread) / self.mean)


def open_areas(solid: BoolArray, *, least: int = 9) -> OpenAreas:
    """Areas of the openings in a plane image (True in fibre).

    Parameters
    ----------
    solid : ndarray of bool, (x, y)
    least : int
        Openings of fewer pixels are dropped: sharp corners break into crumbs on a raster (mean areas come out 16 to 20 % low
        and their spread too wide if they are kept).

    Returns
    -------
    OpenAreas
        Those that touch the edge are left out, and the others weighted for it.
    """
    box = _box(solid)
    if box.ndim != 2:
        raise InputError("solid", "must be a plane image", value=f"shape {box.shape}")
    labels, count = ndimage.label(~box)
    if not count:
        return OpenAreas(np.empty(0), np.empty(0))
    area = np.bincount(labels.ravel(), minlength=count + 1)[1:].astype(float)
    boxes = ndimage.find_objects(labels)
    nx, ny = box.shape
    keep, weight = [], []
    for k, (sx, sy) in enumerate(boxes):
        touches = sx.start == 0 or sy.start == 0 or sx.stop == nx or sy.stop == ny
        keep.append(not touches and area[k] >= least)
        room = (nx - (sx.stop - sx.start)) * (ny - (sy.stop - sy.start))
        weight.append(nx * ny / room if room > 0 else 0.0)
    kept = np.array(keep, dtype=bool)
    return OpenAreas(area[kept], np.array(weight)[kept])


def _through(open_: BoolArray) -> bool:
    if not (open_[..., 0].any() and open_[..., -1].any()):
        return False
    labels, _ = ndimage.label(open_)
    first, last = np.unique(labels[..., 0]), np.unique(labels[..., -1])
    return bool(np.intersect1d(first[first > 0], last).size)


def _to(centres: BoolArray, periodic: bool, reach: int) -> FloatArray:
    """Distance to the nearest of `centres`."""
    if not periodic:
        return _edt(~centres)
    pads = [min(n, reach) for n in centres.shape[:2]]
    width = [(pad, pad) for pad in pads] + [(0, 0)] * (centres.ndim - 2)
    wide = _edt(~np.pad(centres, width, mode="wrap"))
    inner = tuple(slice(pad, pad + n) for pad, n in zip(pads, centres.shape[:2], strict=True))
    return wide[inner]


def _edt(free: BoolArray) -> FloatArray:
    value: FloatArray = ndimage.distance_transform_edt(free)
    return value


def _box(solid: BoolArray) -> BoolArray:
    box = np.asarray(solid)
    if box.dtype != np.bool_ or box.ndim not in (2, 3) or not box.size:
        raise InputError("solid", "must be voxels or pixels, True in fibre", value=f"{box.dtype}, shape {box.shape}")
    return box
