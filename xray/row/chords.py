"""Lengths of a beam's path through the shells of a round jet, averaged over each pixel.

The chord of a disc of radius r at the distance x from its axis is ``2 sqrt(r^2 - x^2)``. Its average over a pixel is exact,

    integral of sqrt(r^2 - x^2) dx = (x sqrt(r^2 - x^2) + r^2 asin(x/r))/2,

with x cut off at +-r, and so are its derivatives, ``r asin(x/r)`` with the radius and ``-sqrt(r^2 - x^2)`` with the position of
the axis. A shell is the difference of two discs. Summed over pixels that cover the jet, width times chord is the shell's area.
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError

__all__ = ["disc_chords", "equal_shells", "shell_chords", "shell_weights"]


def equal_shells(shells: int) -> FloatArray:
    """Edges r/R of `shells` shells of equal width, from 0 to 1: an array of ``shells + 1`` numbers."""
    if isinstance(shells, bool) or not isinstance(shells, int | np.integer) or not 1 <= shells <= 200:
        raise InputError("shells", "is not a number of shells", value=shells, allowed="an integer, [1, 200]")
    return np.linspace(0.0, 1.0, int(shells) + 1)


def shell_weights(edges: ArrayLike) -> FloatArray:
    """Share of the cross-section in each shell, ``r_(j+1)^2 - r_j^2``: a mean over shells is ``weights @ fraction``.

    Parameters
    ----------
    edges : array_like
        r/R, rising from 0 to 1.

    Returns
    -------
    ndarray, one fewer than `edges`, sum 1.
    """
    checked = checked_edges(edges)
    weights: FloatArray = np.diff(checked**2)
    return weights


def shell_chords(radii: ArrayLike, pixel_edges: ArrayLike, axis: float = 0.0) -> FloatArray:
    """Chord lengths of shells, averaged over each pixel.

    Parameters
    ----------
    radii : array_like
        Edges of the shells, m, rising from 0.
    pixel_edges : array_like
        Edges of the pixels across the jet, m, rising.
    axis : float
        Position of the jet's axis, m.

    Returns
    -------
    ndarray, shape (pixels, shells), m, >= 0 to rounding.

    Raises
    ------
    InputError
        For edges that do not rise, radii that do not start from 0, or what is not finite.

    Notes
    -----
    Exact to rounding, about ``1e-16 r^2`` over the pixel's width. Some 25 ns per pixel and shell.
    """
    r = real("radii", radii, least=0.0, unit="m")
    if r.ndim != 1 or r.size < 2 or r[0] != 0.0 or (np.diff(r) <= 0).any():
        raise InputError("radii", "do not rise from 0", value=radii, remedy="give the edges of the shells, the first 0")
    x = real("pixel_edges", pixel_edges, unit="m")
    if x.ndim != 1 or x.size < 2 or (np.diff(x) <= 0).any():
        raise InputError("pixel_edges", "do not rise", value=pixel_edges, remedy="give the n + 1 edges of n pixels")
    centre = real("axis", axis, unit="m")
    if centre.ndim:
        raise InputError("axis", "must be a single number", value=axis)
    discs, _, _ = disc_chords(r[1:], x, float(centre))
    discs[:, 1:] -= discs[:, :-1].copy()
    return discs


def disc_chords(radii: FloatArray, pixel_edges: FloatArray, axis: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Pixel-averaged chords of full discs, with their derivatives; arguments as in `shell_chords` (radii > 0), not checked.

    Returns
    -------
    chords, by_radius, by_axis : ndarray, shape (pixels, radii)
        m, and the derivatives with the disc's own radius and with the axis' position (both a pure number).
    """
    s = np.clip((pixel_edges[:, None] - axis) / radii, -1.0, 1.0)
    root = np.sqrt((1.0 - s) * (1.0 + s))
    angle = np.arcsin(s)
    over = 2.0 / np.diff(pixel_edges)[:, None]
    chords = np.diff(s * root + angle, axis=0) * over * (0.5 * radii**2)
    by_radius = np.diff(angle, axis=0) * over * radii
    by_axis = np.diff(root, axis=0) * over * -radii
    return chords, by_radius, by_axis


def checked_edges(edges: ArrayLike) -> FloatArray:
    """Edges r/R of shells as an array; refused unless they rise from 0 to 1."""
    array = real("edges", edges, least=0.0, most=1.0)
    if array.ndim != 1 or array.size < 2 or array[0] != 0.0 or array[-1] != 1.0 or (np.diff(array) <= 0).any():
        raise InputError("edges", "do not rise from 0 to 1", value=edges, remedy="give r/R of the shells' edges")
    return array
