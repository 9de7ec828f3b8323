"""Polymer fraction over all rows of a jet at once, by a penalised Poisson likelihood.

The counts of every pixel are Poisson about the model of `forward`; the fraction is a smooth function of r/R and z, radius,
axis, level and slope of the beam (and the blur) are smooth functions of z (`map_basis`), and how smooth each of them is the
counts tell themselves (`map_smoothing`). Fisher scoring takes all unknowns at once,

    (A + S) step = g - S c,   A = sum_i (B_i B_i^T) x F_i,

with F_i the Fisher matrix of row i and B_i the four splines that it touches. The covariance is that of the posterior,
``(A + S)^-1``: taken over the map, its intervals hold what they say, noise and smoothing bias together (Nychka), to the
extent that the jet is as smooth as the prior's draws (`map_smoothing`). Those of a smoother one are up to a fifth too wide;
detail that the counts cannot show, a rise narrow and deep in the noise, is smoothed away, and its error understated.

The logarithm of the counts is never taken, zero counts are data, and a fraction outside [0, 1] is not cut off.

References
----------
Nychka, J. Am. Statist. Assoc. 83, 1134 (1988). Wood, Pya and Safken, J. Am. Statist. Assoc. 111, 1548 (2016).
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.xray.map.basis import axial_basis, radial_basis
from spinline.xray.map.data import MapData, map_data, started
from spinline.xray.map.result import MapFit, MapState
from spinline.xray.row.chords import checked_edges, equal_shells
from spinline.xray.row.forward import Absorber, Detector, row_model
from spinline.xray.row.limit import free_parameters, require_contrast
from spinline.xray.row.model import NUISANCES

__all__ = ["fit_map"]

_ROWS_PER_SPLINE = 8


def fit_map(
    counts: ArrayLike,
    absorber: Absorber,
    detector: Detector | Sequence[Detector],
    *,
    z: ArrayLike | None = None,
    nuisances: Sequence[str] = ("radius", "axis", "amplitude", "slope"),
    radius: ArrayLike | None = None,
    axis: ArrayLike | None = None,
    amplitude: ArrayLike = 1.0,
    slope: ArrayLike = 0.0,
    shells: int | ArrayLike = 10,
    radial_splines: int = 14,
    axial_splines: int | None = None,
    good: ArrayLike | None = None,
    saturation: float = np.inf,
    path: ArrayLike = 1.0,
    axis_offset: ArrayLike | None = None,
    begun: MapState | None = None,
    keep: Callable[[MapState], None] | None = None,
) -> MapFit:
    """Estimate the polymer fraction phi(r, z) of a jet from an image of it.

    Parameters
    ----------
    counts : array_like, shape (rows, pixels)
        Raw photon counts, dark included, >= 0; frames of a steady jet summed.
    absorber : Absorber
    detector : Detector or sequence of Detector
        Flat, dark, veil and blur of every row, or one for each; pixel and blur are the same in all.
    z : array_like, shape (rows,), optional
        Places of the rows, m, rising, not necessarily evenly; square pixels where left out.
    nuisances : sequence of str
        What is fitted beside the fraction: any of "radius", "axis", "amplitude", "slope", "blur". Each is smooth along z.
    radius, axis : array_like, shape () or (rows,), optional
        m. The start where fitted (found where left out), the value where not (then needed).
    amplitude, slope : array_like, shape () or (rows,)
        Held at these where not fitted.
    shells : int or array_like
        Shells of the tabulated fraction: a number of equal width, or edges r/R from 0 to 1. They do not affect the fit.
    radial_splines, axial_splines : int, optional
        Most detail there can be: 4 to 60 across; 1 to the number of rows along, one for 8 rows where left out (8 at least).
    good : array_like of bool, optional
        False for bad pixels; the shape of `counts`, or of one row.
    saturation : float
        Counts at or over this are refused unless masked.
    path : array_like, shape () or (rows,)
        Factor on the paths through the jet: 1/cos of a tilt along the beam, cos of a lean in the image (then the radius is
        that of the row, 1/cos wider than the jet's).
    axis_offset : array_like, shape (rows,), optional
        m: by how much the axis of a row lies aside of the smooth axis that all rows share, such as between images.
    begun : MapState, optional
        What an interrupted fit of the same counts passed to `keep` last: it goes on there, and ends in the same numbers.
    keep : callable, optional
        Called with the state before each turn.

    Returns
    -------
    MapFit

    Raises
    ------
    InputError
        For a contrast near 0, negative counts, dark counts over the counts, saturated pixels, other shapes than flat's, z that
        does not rise, a radius or axis neither fitted nor given, or counts that cannot tell the unknowns apart.

    Notes
    -----
    0.5 ms per row of 360 pixels without blur, in proportion to the rows. The drift of the beam and the jet are taken as
    smooth over the spacing of the splines along z: a shift from row to row is not in the model.
    Flat and dark are taken as exact: average enough of them.
    """
    from spinline.xray.map.report import reported  # compiled: loaded when first used
    from spinline.xray.map.scoring import MapModel, best_map

    require_contrast(absorber)
    data = map_data(counts, detector, good, saturation, path)
    rows = data.counts.shape[0]
    edges = equal_shells(shells) if isinstance(shells, int) else checked_edges(shells)
    free_parameters(1, nuisances)
    names = tuple(name for name in NUISANCES if name in nuisances)
    if "blur" in names and data.blur == 0.0:
        raise InputError("blur", "cannot be fitted from 0", value=0.0, remedy="give Detector a first guess of the blur")
    places = data.pixel * np.arange(rows, dtype=np.float64) if z is None else real("z", z, unit="m")
    if places.shape != (rows,) or (np.diff(places) <= 0.0).any():
        raise InputError("z", "does not rise from row to row", value=z, allowed=f"{rows} numbers")
    across = _count("radial_splines", radial_splines, 4, 60)
    most = min(rows, max(8, -(-rows // _ROWS_PER_SPLINE) + 3))
    along = most if axial_splines is None else _count("axial_splines", axial_splines, 1, rows)
    held = _held(data, names, radius, axis, amplitude, slope)
    one = detector if isinstance(detector, Detector) else next(iter(detector))
    offsets = None if axis_offset is None else real("axis_offset", axis_offset, unit="m") / data.pixel
    if offsets is not None and offsets.shape != (rows,):
        raise InputError("axis_offset", "is not one number for each row", value=f"array of shape {offsets.shape}")
    row = row_model(absorber, one, np.array([0.0, 1.0]), 3.0 * one.blur if "blur" in names else None)
    model = MapModel(
        data, radial_basis(across), axial_basis(places, along), absorber, names, row._parts, row._reach, offsets
    )
    known_radius, known_axis = (held[:, i] if v is not None else None for i, v in ((0, radius), (1, axis)))
    best = best_map(model, held, started(data, known_radius, known_axis), begun, keep)
    return reported(model, best, places, edges)


def _held(
    data: MapData,
    names: Sequence[str],
    radius: ArrayLike | None,
    axis: ArrayLike | None,
    amplitude: ArrayLike,
    slope: ArrayLike,
) -> FloatArray:
    """Nuisances as given, shape (rows, 5), lengths in pixels; 0 where not given."""
    rows, pixels = data.counts.shape
    half = 0.5 * data.pixel * pixels
    out = np.zeros((rows, len(NUISANCES)))
    given = {
        "radius": (radius, {"above": 0.0, "unit": "m"}, data.pixel),
        "axis": (axis, {"above": -half, "below": half, "unit": "m"}, data.pixel),
        "amplitude": (amplitude, {"above": 0.0}, 1.0),
        "slope": (slope, {"above": -1.0, "below": 1.0}, 1.0),
    }
    for i, (name, (value, bounds, unit)) in enumerate(given.items()):
        if value is None:
            if name not in names:
                raise InputError(name, "is neither fitted nor given", remedy=f"give {name}, or add it to nuisances")
            continue
        array = real(name, value, **bounds)
        if array.shape not in ((), (rows,)):
            raise InputError(name, "is neither a number nor one for each row", value=f"array of shape {array.shape}")
        out[:, i] = array / unit
    out[:, 4] = data.blur / data.pixel
    return out


def _count(name: str, value: int, least: int, most: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not least <= value <= most:
        raise InputError(
            name, "is not a possible number of splines", value=value, allowed=f"an integer, [{least}, {most}]"
        )
    return int(value)
