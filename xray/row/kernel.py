"""The counts of a row and the curvature of their likelihood, pixel by pixel (compiled); the model is that of `model`.

Work is done only where the jet is: outside it nothing is absorbed, and a blurred nothing is nothing.
"""

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit

__all__ = ["absorbed_columns", "beam_counts", "blurred_columns", "damped_step", "poisson_curvature"]


@njit(cache=True, error_model="numpy", nogil=True)
def absorbed_columns(
    x: FloatArray,
    fraction: FloatArray,
    radius: float,
    axis: float,
    edges: FloatArray,
    base: float,
    contrast: float,
    columns: FloatArray,
) -> tuple[int, int]:
    """Transmission less 1 of each cell, and its derivatives with fractions, radius and axis.

    Parameters
    ----------
    x : ndarray, shape (cells + 1,)
        Edges of the cells, m, evenly spaced.
    fraction : ndarray, shape (shells,)
    radius, axis : float
        m.
    edges : ndarray, shape (shells + 1,)
        r/R.
    base, contrast : float
        Attenuation of the solvent less that of air, and D, 1/m.
    columns : ndarray, shape (shells + 3, cells)
        Filled from the first to before the last cell that the jet touches; elsewhere left as it was.

    Returns
    -------
    first, last : int

    Notes
    -----
    Chords as in `chords.disc_chords`.
    """
    shells = fraction.size
    cells = x.size - 1
    step = (x[cells] - x[0]) / cells
    first = min(max(int(np.floor((axis - radius - x[0]) / step)), 0), cells)
    last = min(max(int(np.ceil((axis + radius - x[0]) / step)), first), cells)
    columns[:, first:last] = 0.0
    depth, by_radius, by_axis = columns[0], columns[shells + 1], columns[shells + 2]
    for j in range(shells):
        share = edges[j + 1]
        r = radius * share
        mu = base + contrast * fraction[j]  # of this disc, over that of the shell outside it
        if j + 1 < shells:
            mu -= base + contrast * fraction[j + 1]
        low = min(max(int(np.floor((axis - r - x[0]) / step)), first), last)
        high = min(max(int(np.ceil((axis + r - x[0]) / step)), low), last)
        chord = columns[j + 1]
        s = min(max((x[low] - axis) / r, -1.0), 1.0)
        root, angle = np.sqrt((1.0 - s) * (1.0 + s)), np.arcsin(s)
        area = s * root + angle
        for e in range(low, high):
            s = min(max((x[e + 1] - axis) / r, -1.0), 1.0)
            next_root, next_angle = np.sqrt((1.0 - s) * (1.0 + s)), np.arcsin(s)
            next_area = s * next_root + next_angle
            over = 2.0 * r / (x[e + 1] - x[e])
            length = (next_area - area) * (0.5 * r * over)
            chord[e] = length
            depth[e] += mu * length
            by_radius[e] += mu * share * over * (next_angle - angle)
            by_axis[e] -= mu * over * (next_root - root)
            root, angle, area = next_root, next_angle, next_area
    for j in range(shells, 1, -1):
        for e in range(first, last):
            columns[j, e] -= columns[j - 1, e]
    for e in range(first, last):
        t = np.expm1(-depth[e])
        depth[e] = t
        by_radius[e] *= -(1.0 + t)
        by_axis[e] *= -(1.0 + t)
    for j in range(1, shells + 1):
        for e in range(first, last):
            columns[j, e] *= -contrast * (1.0 + depth[e])
    return first, last


@njit(cache=True, error_model="numpy", nogil=True)
def blurred_columns(
    columns: FloatArray, first: int, last: int, parts: int, reach: int, widest: float, blur: float, out: FloatArray
) -> None:
    """Columns blurred by a Gaussian and averaged over the cells of each pixel.

    Parameters
    ----------
    columns : ndarray, shape (columns, cells)
        A row that goes on by `reach` cells beyond either end; 0 before `first` and from `last` on, which is not looked at.
    parts : int
        Cells of a pixel.
    reach, widest : int, float
        Cells that the kernel may reach, and how many of its standard deviations are kept.
    blur : float
        Standard deviation, in cells.
    out : ndarray, shape (columns + 1, pixels)
        The last one holds the derivative of the first with the blur (per cell).
    """
    width = columns.shape[0]
    pixels = out.shape[1]
    out[:] = 0.0
    if reach == 0:
        for c in range(width):
            if parts == 1:
                for e in range(first, last):
                    out[c, e] = columns[c, e]
            else:
                for e in range(first, last):
                    out[c, e // parts] += columns[c, e] / parts
        return
    m = min(reach, int(np.ceil(widest * blur)))
    kernel, change = np.empty(m + 1), np.empty(m + 1)
    total, variance = 0.0, 0.0
    for k in range(m + 1):
        square = (k / blur) ** 2
        kernel[k] = np.exp(-0.5 * square)
        share = kernel[k] if k == 0 else 2.0 * kernel[k]
        total += share
        variance += share * square
    variance /= total
    for k in range(m + 1):
        kernel[k] /= total
        change[k] = kernel[k] * ((k / blur) ** 2 - variance) / blur
    fine = pixels * parts
    low, high = max(first - reach - m, 0), min(last - reach + m, fine)  # cells of the row that anything reaches
    if low >= high:
        return
    line = np.empty(fine)
    padded = np.zeros(high - low + 2 * m)  # what lies within reach of these
    start = low + reach - m
    left, right = max(first, start), min(last, start + padded.size)
    for c in range(width + 1):
        source = columns[c] if c < width else columns[0]
        weights = kernel if c < width else change
        for e in range(left, right):
            padded[e - start] = source[e]
        for e in range(high - low):
            line[e] = weights[0] * padded[e + m]
        for k in range(1, m + 1):
            w = weights[k]
            for e in range(high - low):
                line[e] += w * (padded[e + m - k] + padded[e + m + k])
        if parts == 1:
            for e in range(high - low):
                out[c, low + e] = line[e]
        else:
            for e in range(high - low):
                out[c, (low + e) // parts] += line[e] / parts


@njit(cache=True, error_model="numpy", nogil=True)
def beam_counts(
    seen: FloatArray,
    flat: FloatArray,
    u: FloatArray,
    background: FloatArray,
    amplitude: float,
    bend: FloatArray,
    mean: FloatArray,
    jacobian: FloatArray,
) -> None:
    """Mean counts and their derivatives, from the transmission less 1 of each pixel and its derivatives.

    Parameters
    ----------
    seen : ndarray, shape (shells + 4, pixels)
        Transmission less 1; its derivatives with fractions, radius, axis; with the blur.
    flat, u, background, bend, mean : ndarray, shape (pixels,)
        Beam, position from -1 to 1, counts that pass the jet by, the beam's shape over the flat's; the last one is filled.
    jacobian : ndarray, shape (shells + 5 or more, pixels)
        The first are filled: fractions, radius, axis, amplitude, slope, blur.
    """
    rows = seen.shape[0]
    for i in range(flat.size):
        beam = flat[i] * bend[i]
        through = 1.0 + seen[0, i]
        jacobian[rows - 2, i] = beam * through
        jacobian[rows - 1, i] = amplitude * flat[i] * u[i] * through
        mean[i] = amplitude * beam * through + background[i]
    for c in range(1, rows):
        out = jacobian[c - 1] if c < rows - 1 else jacobian[rows]
        for i in range(flat.size):
            out[i] = amplitude * flat[i] * bend[i] * seen[c, i]


@njit(cache=True, error_model="numpy", nogil=True)
def poisson_curvature(
    counts: FloatArray,
    lit: NDArray[np.bool_],
    mean: FloatArray,
    jacobian: FloatArray,
    free: NDArray[np.int64],
    fisher: FloatArray,
    gradient: FloatArray,
) -> float:
    """Fill Fisher matrix and gradient of the logarithm of the likelihood; return the deviance, infinite for a mean <= 0.

    Parameters
    ----------
    counts, lit, mean : ndarray, shape (pixels,)
        Counts >= 0, which of them are used, and their means.
    jacobian : ndarray, shape (pixels, parameters)
    free : ndarray of int
        Columns that are fitted.
    fisher, gradient : ndarray, shapes (free, free) and (free,)

    Notes
    -----
    The deviance ``2 sum(c ln(c/lambda) - (c - lambda))`` is evaluated without cancellation, so that differences of 1e-6 show
    among 1e9 photons.
    """
    n = free.size
    fisher[:] = 0.0
    gradient[:] = 0.0
    row = np.empty(n)
    deviance = 0.0
    for i in range(counts.size):
        if not lit[i]:
            continue
        expected = mean[i]
        if not expected > 0.0:
            return np.inf
        off = (counts[i] - expected) / expected
        if off > -0.5:
            deviance += expected * ((1.0 + off) * np.log1p(off) - off)
        else:
            deviance += expected * ((1.0 + off) * np.log(max(1.0 + off, 1e-300)) - off)
        for a in range(n):
            row[a] = jacobian[i, free[a]]
        for a in range(n):
            slope = row[a]
            gradient[a] += slope * off
            slope /= expected
            for b in range(a + 1):
                fisher[a, b] += slope * row[b]
    for a in range(n):
        for b in range(a):
            fisher[b, a] = fisher[a, b]
    return 2.0 * deviance


@njit(cache=True, error_model="numpy", nogil=True)
def damped_step(fisher: FloatArray, gradient: FloatArray, damping: float, step: FloatArray) -> float:
    """Solve ``(F + d diag F) step = gradient`` by Cholesky; return ``gradient . step``, NaN if there is no such factor.

    Parameters
    ----------
    fisher, gradient, step : ndarray, shapes (n, n), (n,), (n,)
        The last one is filled.
    damping : float
        d.
    """
    n = gradient.size
    scale = np.empty(n)
    lower = np.empty((n, n))
    for a in range(n):
        scale[a] = np.sqrt(max(fisher[a, a], 1e-300))
    for a in range(n):
        for b in range(a + 1):
            total = fisher[a, b] / (scale[a] * scale[b])
            if a == b:
                total += damping
            for c in range(b):
                total -= lower[a, c] * lower[b, c]
            if a > b:
                lower[a, b] = total / lower[b, b]
            elif total > 0.0:
                lower[a, a] = np.sqrt(total)
            else:
                return np.nan
    for a in range(n):
        total = gradient[a] / scale[a]
        for c in range(a):
            total -= lower[a, c] * step[c]
        step[a] = total / lower[a, a]
    for a in range(n - 1, -1, -1):
        total = step[a]
        for c in range(a + 1, n):
            total -= lower[c, a] * step[c]
        step[a] = total / lower[a, a]
    gain = 0.0
    for a in range(n):
        step[a] /= scale[a]
        gain += gradient[a] * step[a]
    return gain
