"""Counts of all rows of a map, the slope of their likelihood and its expected curvature, row by row (compiled).

The model of a row is that of `forward`, with the chords of `map_basis`: exact averages over pixels (over parts of them,
where the blur or a strong absorber asks for it, as in `model`), the exponential, the blur on a row that goes on beyond the
detector's ends, the beam. Each row has its own local parameters: a coefficient for every radial spline, then radius, axis,
amplitude, slope and blur, lengths in pixels.
"""

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.xray.row.tail import spread_pixels

__all__ = ["expected_rows", "row_curvature"]


@njit(cache=True, error_model="numpy", nogil=True)
def _chord_table(s: float, table: FloatArray, mu: FloatArray, out: FloatArray) -> float:
    """Fill H_j(s); return the chord through attenuations mu."""
    cells, _, size = table.shape
    side = abs(s)
    if side >= 1.0:
        for j in range(size):
            out[j] = table[0, 0, j] if s > 0.0 else -table[0, 0, j]
        return 0.0
    t = np.sqrt(1.0 - side) * cells
    i = min(int(t), cells - 1)
    u = t - i
    c = table[i]
    sign = 1.0 if s > 0.0 else -1.0
    slope = 0.0
    for j in range(size):
        out[j] = sign * (c[0, j] + u * (c[1, j] + u * (c[2, j] + u * c[3, j])))
        slope += mu[j] * (c[1, j] + u * (2.0 * c[2, j] + 3.0 * u * c[3, j]))
    if t < 1e-3:
        return 0.0
    return float(-0.5 * slope * cells * cells / t)


@njit(cache=True, error_model="numpy", nogil=True)
def _row(
    local: FloatArray,
    size: int,
    table: FloatArray,
    base: float,
    contrast: float,
    step: float,
    offset: float,
    columns: FloatArray,
    low_h: FloatArray,
    high_h: FloatArray,
    mu: FloatArray,
) -> tuple[int, int]:
    """Transmission less 1 (column 0) and its derivatives with fractions, radius and axis, on the fine pixels touched."""
    m = columns.shape[0]
    radius, axis = local[size], local[size + 1]
    for j in range(size):
        mu[j] = base + contrast * local[j]
    first = min(max(int(np.floor((axis - radius - offset) / step)), 0), m)
    last = min(max(int(np.ceil((axis + radius - offset) / step)), first), m)
    scale = radius * radius / step
    s = (offset + first * step - axis) / radius
    gamma = _chord_table(s, table, mu, low_h)
    psi = 0.0
    for j in range(size):
        psi += mu[j] * low_h[j]
    for e in range(first, last):
        s_next = (offset + (e + 1) * step - axis) / radius
        gamma_next = _chord_table(s_next, table, mu, high_h)
        psi_next = 0.0
        for j in range(size):
            psi_next += mu[j] * high_h[j]
        t = np.exp(-scale * (psi_next - psi))
        row = columns[e]
        row[0] = t - 1.0
        factor = -contrast * t * scale
        for j in range(size):
            row[1 + j] = factor * (high_h[j] - low_h[j])
            low_h[j] = high_h[j]
        row[1 + size] = -t * radius / step * (2.0 * (psi_next - psi) - (s_next * gamma_next - s * gamma))
        row[2 + size] = t * radius / step * (gamma_next - gamma)
        s, gamma, psi = s_next, gamma_next, psi_next
    return first, last


@njit(cache=True, error_model="numpy", nogil=True)
def _binned(
    columns: FloatArray, first: int, last: int, parts: int, reach: int, blur: float, step: float, out: FloatArray
) -> tuple[int, int]:
    """Blur and bin; out has one column more, the derivative of the first with the blur. Returns the pixels touched."""
    width = columns.shape[1]
    pixels = out.shape[0]
    low = max((first - 2 * reach) // parts, 0)
    high = min(-((-last) // parts), pixels)
    out[low:high] = 0.0
    if reach == 0:
        for e in range(first, min(last, pixels * parts)):
            for c in range(width):
                out[e // parts, c] += columns[e, c] / parts
        return low, high
    kernel, change = np.empty(reach + 1), np.empty(reach + 1)
    total, variance = 0.0, 0.0
    for k in range(reach + 1):
        x = k * step / blur
        kernel[k] = np.exp(-0.5 * x * x)
        share = kernel[k] if k == 0 else 2.0 * kernel[k]
        total += share
        variance += share * x * x
    variance /= total
    for k in range(reach + 1):
        x = k * step / blur
        kernel[k] /= total
        change[k] = kernel[k] * (x * x - variance) / blur
    for fine in range(low * parts, high * parts):
        pixel = out[fine // parts]
        for k in range(-reach, reach + 1):
            e = fine + reach + k
            if first <= e < last:
                w = kernel[abs(k)] / parts
                for c in range(width):
                    pixel[c] += w * columns[e, c]
                pixel[width] += change[abs(k)] / parts * columns[e, 0]
    return low, high


@njit(cache=True, error_model="numpy", nogil=True)
def _spread(seen: FloatArray, low: int, high: int, share: float, length: float) -> tuple[int, int]:
    """Spread the pixels from `low` to before `high`, of which alone `seen` says something, by the tail; all are touched."""
    pixels = seen.shape[0]
    seen[:low] = 0.0
    seen[high:] = 0.0
    spread_pixels(seen, share, length, low, high)
    return 0, pixels


@njit(cache=True, error_model="numpy", nogil=True)
def row_curvature(
    counts: FloatArray,
    good: FloatArray,
    flat: FloatArray,
    dark: FloatArray,
    veil: FloatArray,
    local: FloatArray,
    table: FloatArray,
    base: FloatArray,
    contrast: FloatArray,
    parts: int,
    reach: int,
    tail: tuple[float, float],
    fisher: FloatArray,
    gradient: FloatArray,
    score: FloatArray,
) -> None:
    """Fisher matrix and slope of each row's log-likelihood with its local parameters.

    Parameters
    ----------
    counts, good, flat, dark, veil : ndarray, shape (rows, pixels)
        `good` is 1 or 0; flat, dark and veil may have one row.
    local : ndarray, shape (rows, size + 5)
        Lengths in pixels.
    table : ndarray, shape (cells, 4, size)
    base, contrast : ndarray, shape (rows,)
        Per pixel's width, on the paths of each row.
    parts, reach : int
        Fine pixels in a pixel, and of them in the blur's half width.
    tail : (float, float)
        Share and length, pixels, of the detector's tail.
    fisher, gradient : ndarray, shapes (rows, size + 5, size + 5) and (rows, size + 5)
        Filled.
    score : ndarray, shape (rows, 4)
        Filled: deviance, Pearson's chi-square, sum of 1/mean, and how often the mean was not > 0.
    """
    rows, pixels = counts.shape
    size = table.shape[2]
    width = size + 5
    step = 1.0 / parts
    offset = -0.5 * pixels - reach * step
    columns = np.empty((pixels * parts + 2 * reach, size + 3))
    seen = np.empty((pixels, size + 4))
    low_h, high_h, mu = np.empty(size), np.empty(size), np.empty(size)
    weighted = np.empty((pixels, width))
    residual = np.empty(pixels)
    for i in range(rows):
        ref = i if flat.shape[0] > 1 else 0
        first, last = _row(local[i], size, table, base[i], contrast[i], step, offset, columns, low_h, high_h, mu)
        low, high = _binned(columns, first, last, parts, reach, local[i, width - 1], step, seen)
        if tail[0] != 0.0:
            low, high = _spread(seen, low, high, tail[0], tail[1])
        amplitude, slope = local[i, size + 2], local[i, size + 3]
        score[i] = 0.0
        a_a, a_s, s_s, g_a, g_s = 0.0, 0.0, 0.0, 0.0, 0.0
        for x in range(pixels):
            inside = low <= x < high
            u = (2.0 * x - (pixels - 1)) / (pixels - 1)
            tilt = 1.0 + slope * u
            f = flat[ref, x]
            through = 1.0 + seen[x, 0] if inside else 1.0
            mean = f * (amplitude * tilt * through + veil[ref, x]) + dark[ref, x]
            if inside:
                weighted[x] = 0.0
                residual[x] = 0.0
            if good[i, x] == 0.0:
                continue
            if not mean > 0.0:
                score[i, 3] += 1.0
                continue
            c = counts[i, x]
            off = (c - mean) / mean
            if off > -0.5:
                score[i, 0] += 2.0 * mean * ((1.0 + off) * np.log1p(off) - off)
            elif c > 0.0:
                score[i, 0] += 2.0 * mean * ((1.0 + off) * np.log(c / mean) - off)
            else:
                score[i, 0] += 2.0 * mean
            score[i, 1] += off * off * mean
            score[i, 2] += 1.0 / mean
            root = 1.0 / np.sqrt(mean)
            by_amplitude = f * tilt * through * root
            by_slope = f * amplitude * u * through * root
            if inside:
                row = weighted[x]
                beam = f * amplitude * tilt * root
                for j in range(size + 2):
                    row[j] = beam * seen[x, 1 + j]
                row[size + 2] = by_amplitude
                row[size + 3] = by_slope
                row[size + 4] = beam * seen[x, size + 3] if reach > 0 else 0.0
                residual[x] = (c - mean) * root
            else:
                a_a += by_amplitude * by_amplitude
                a_s += by_amplitude * by_slope
                s_s += by_slope * by_slope
                g_a += by_amplitude * (c - mean) * root
                g_s += by_slope * (c - mean) * root
        part = weighted[low:high]
        np.dot(part.T, part, fisher[i])
        np.dot(residual[low:high], part, gradient[i])
        fisher[i, size + 2, size + 2] += a_a
        fisher[i, size + 2, size + 3] += a_s
        fisher[i, size + 3, size + 2] += a_s
        fisher[i, size + 3, size + 3] += s_s
        gradient[i, size + 2] += g_a
        gradient[i, size + 3] += g_s


@njit(cache=True, error_model="numpy", nogil=True)
def expected_rows(
    flat: FloatArray,
    dark: FloatArray,
    veil: FloatArray,
    local: FloatArray,
    table: FloatArray,
    base: FloatArray,
    contrast: FloatArray,
    parts: int,
    reach: int,
    tail: tuple[float, float],
    out: FloatArray,
) -> None:
    """Mean counts of each row, shape (rows, pixels); arguments as in `row_curvature`."""
    rows, pixels = out.shape
    size = table.shape[2]
    step = 1.0 / parts
    offset = -0.5 * pixels - reach * step
    columns = np.empty((pixels * parts + 2 * reach, size + 3))
    seen = np.empty((pixels, size + 4))
    low_h, high_h, mu = np.empty(size), np.empty(size), np.empty(size)
    for i in range(rows):
        ref = i if flat.shape[0] > 1 else 0
        first, last = _row(local[i], size, table, base[i], contrast[i], step, offset, columns, low_h, high_h, mu)
        low, high = _binned(columns, first, last, parts, reach, local[i, size + 4], step, seen)
        if tail[0] != 0.0:
            low, high = _spread(seen, low, high, tail[0], tail[1])
        for x in range(pixels):
            through = 1.0 + seen[x, 0] if low <= x < high else 1.0
            u = (2.0 * x - (pixels - 1)) / (pixels - 1)
            beam = local[i, size + 2] * (1.0 + local[i, size + 3] * u)
            out[i, x] = flat[ref, x] * (beam * through + veil[ref, x]) + dark[ref, x]
