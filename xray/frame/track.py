"""Where the jet is in every row of a frame: edges to a part of a pixel, and the level of the beam, all rows at once.

Each row is fitted by a uniform round jet,

    counts = flat A (1 + s u) exp(-m L(x; R, a)) + dark,

with its own attenuation m, radius R, axis a, level A and slope s, by Fisher scoring of the Poisson likelihood; all rows
step together, as arrays. The start comes from groups of rows, each summed until the jet in it is found (`start`), and lines
between them. A jet that is not uniform shifts the radius by much less than a pixel: good enough for the quick look
(`quick`) and as the start of the fit by shells (`frame`).
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.xray.row.block import smoothed_outliers
from spinline.xray.row.start import find_jet

__all__ = ["Track", "track_jet"]

_GROUPS = (16, 6, 3, 1)
_STEPS = 15
_TOGETHER = 64  # rows: what the processor keeps at hand
_FINE = 16  # pixels of the radius; of more, some are summed
_SURE = 0.1  # of the radius: an error under this is a jet that was found


@dataclass(frozen=True, eq=False)
class Track:
    """A uniform jet in each row; lengths in pixels, the axis from the middle of the row.

    Attributes
    ----------
    radius, axis, level, slope, attenuation : ndarray, shape (rows,)
        Attenuation per pixel length.
    covariance : ndarray, shape (rows, 5, 5)
        Of attenuation, radius, axis, level, slope, in this order; NaN where the row was not fitted on its own.
    radius_std, axis_std : ndarray, shape (rows,)
        Standard deviations; those of the group of rows around where the row itself does not hold the jet.
    found : ndarray of bool, shape (rows,)
        The row itself holds the jet: its radius is known to 10 %. Elsewhere radius and axis are those of its neighbours.
    """

    radius: FloatArray
    axis: FloatArray
    level: FloatArray
    slope: FloatArray
    attenuation: FloatArray
    covariance: FloatArray
    radius_std: FloatArray
    axis_std: FloatArray
    found: BoolArray


def track_jet(counts: FloatArray, flat: FloatArray, dark: FloatArray, good: BoolArray) -> Track | None:
    """Follow a jet down a frame.

    Parameters
    ----------
    counts, flat, dark : ndarray, shape (rows, pixels)
        Photons: measured, expected without a jet above dark (> 0 where good), dark.
    good : ndarray of bool, shape (rows, pixels)
        Pixels to use.

    Returns
    -------
    Track, or None where no jet is found even in the sum of all rows.

    Notes
    -----
    About 0.07 ms a row of 400 pixels.
    """
    shapes = {name: np.shape(a) for name, a in (("counts", counts), ("flat", flat), ("dark", dark), ("good", good))}
    if len(set(shapes.values())) > 1 or len(shapes["counts"]) != 2:
        raise InputError("counts", "must be a frame (rows, pixels), as flat, dark and good", value=str(shapes))
    rows = counts.shape[0]
    usable = good.sum(axis=1) >= 8
    if not usable.any():
        return None
    coarse: tuple[FloatArray, ...] | None = None
    for groups in _GROUPS:
        if groups > rows:
            continue
        coarse = _coarse(counts, flat, dark, good, groups)
        if coarse is not None:
            break
    if coarse is None:
        return None
    radius, axis, depth, radius_std, axis_std = coarse
    ratio = np.where(good, (counts - dark) / np.where(good, flat, 1.0), np.nan)
    start = np.empty((rows, 5))
    start[:, 0], start[:, 1], start[:, 2] = depth, radius, axis
    start[:, 3], start[:, 4] = _air_level(ratio, radius, axis), 0.0
    together = int(np.clip(radius.min() // _FINE, 1, 4))
    fitted, covariance, settled = _uniform(counts, flat, dark, good & usable[:, None], start, together)
    spread = np.sqrt(np.maximum(covariance[:, 1, 1], 0.0))
    off = np.abs(fitted[:, 1] - radius) > 0.25 * radius + 2.0 + 3.0 * spread
    deep = fitted[:, 0] > 4.0 * np.sqrt(np.maximum(covariance[:, 0, 0], 0.0))
    found = settled & usable & deep & (spread < _SURE * fitted[:, 1]) & ~off
    at = np.where(found[:, None], fitted, start)
    covariance[~(settled & usable)] = np.nan
    own = [np.sqrt(np.where(found, covariance[:, i, i], 0.0)) for i in (1, 2)]
    radius_std, axis_std = np.where(found, own[0], radius_std), np.where(found, own[1], axis_std)
    return Track(at[:, 1], at[:, 2], at[:, 3], at[:, 4], at[:, 0], covariance, radius_std, axis_std, found)


def _coarse(
    counts: FloatArray, flat: FloatArray, dark: FloatArray, good: BoolArray, groups: int
) -> tuple[FloatArray, ...] | None:
    """Radius, axis, attenuation of every row and the first two's errors; None where too few groups of rows show the jet."""
    rows, n = counts.shape
    bounds = np.linspace(0, rows, groups + 1).astype(int)
    total = [np.add.reduceat(np.where(good, a, 0.0), bounds[:-1], axis=0) for a in (counts, flat, dark)]
    lit = total[1] > 0
    start = np.zeros((groups, 5))
    start[:, 1], start[:, 3] = 0.25 * n, 1.0
    tried = lit.sum(axis=1) >= max(8, n // 2)
    at = np.arange(n)
    for g in np.flatnonzero(tried):
        seen = lit[g]
        clean = smoothed_outliers(total[0][g][seen])
        ratio = np.interp(at, at[seen], (clean - total[2][g][seen]) / total[1][g][seen])
        r, a, depth = find_jet(ratio)
        m = -np.log1p(-min(max(depth, 1e-4), 0.999)) / (2.0 * r)
        level = float(_air_level(ratio[None, :], np.array([r]), np.array([a]))[0])
        start[g] = m, r, a, level, 0.0
    fitted, covariance, settled = _uniform(total[0], total[1], total[2], lit & tried[:, None], start)
    spread = np.sqrt(np.maximum(covariance[:, 1, 1], 0.0))
    most = _SURE if groups > 1 else 3.0 * _SURE  # the last resort may be vague
    sure = settled & tried & (fitted[:, 0] > 0) & (spread < most * fitted[:, 1])
    if sure.sum() < max(1, groups // 3):
        return None
    middle = 0.5 * (bounds[1:] + bounds[:-1] - 1)[sure]
    rows_at = np.arange(rows)
    radius, axis, m = (
        np.interp(rows_at, middle, _median5(np.abs(fitted[sure, i]) if i == 1 else fitted[sure, i])) for i in (1, 2, 0)
    )
    errors = (np.interp(rows_at, middle, np.sqrt(np.maximum(covariance[sure, i, i], 0.0))) for i in (1, 2))
    return radius, axis, m, *errors


def _median5(values: FloatArray) -> FloatArray:
    """Running median of five: one group that found something else is outvoted; the ends keep their trend."""
    if values.size < 5:
        return values
    windows = np.lib.stride_tricks.sliding_window_view(values, 5)
    middle = np.median(windows, axis=1)
    spread = np.median(np.abs(windows - middle[:, None]), axis=1)
    inner = values[2:-2]
    out = values.copy()
    out[2:-2] = np.where(np.abs(inner - middle) > 4.0 * spread + 0.5, middle, inner)
    for end, near in ((0, 2), (1, 2), (-1, -3), (-2, -3)):
        if abs(values[end] - out[near]) > 8.0 * spread[0 if end >= 0 else -1] + 0.5 + 0.3 * abs(out[near]):
            out[end] = out[near]
    return out


def _air_level(ratio: FloatArray, radius: FloatArray, axis: FloatArray) -> FloatArray:
    """Level of the beam outside the jet, of each row; of the whole row where the jet leaves no air."""
    n = ratio.shape[1]
    x = np.arange(n) - 0.5 * (n - 1)
    outside = (np.abs(x - axis[:, None]) > 1.05 * radius[:, None] + 2.0) & np.isfinite(ratio)
    count = outside.sum(axis=1)
    everywhere = np.isfinite(ratio)
    inside = np.where(everywhere, ratio, 0.0).sum(axis=1) / np.maximum(everywhere.sum(axis=1), 1)
    level = np.where(outside, ratio, 0.0).sum(axis=1) / np.maximum(count, 1)
    level = np.where(count >= 4, level, inside)
    return np.where(level > 0, level, 1.0)


def _uniform(
    counts: FloatArray, flat: FloatArray, dark: FloatArray, good: BoolArray, start: FloatArray, together: int = 1
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Uniform jets of the largest likelihood in all rows; parameters, covariance and whether the row settled.

    `together` pixels are summed to one: what a wide jet loses by that is far under its error.
    """
    parts = [
        _uniform_part(counts[part], flat[part], dark[part], good[part], start[part], together)
        for part in (slice(i, i + _TOGETHER) for i in range(0, counts.shape[0], _TOGETHER))
    ]
    at, covariance, settled = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return at, covariance, settled


def _uniform_part(
    counts: FloatArray, flat: FloatArray, dark: FloatArray, good: BoolArray, start: FloatArray, together: int
) -> tuple[FloatArray, FloatArray, BoolArray]:
    rows, n = counts.shape
    limit = np.array([np.inf, 2.0 * n, 0.5 * n, np.inf, 0.9])
    u = np.linspace(-1.0, 1.0, n)
    edges = np.arange(n + 1) - 0.5 * n
    data, flat, dark = (np.where(good, array, 0.0) for array in (counts, flat, dark))
    if together > 1:
        n //= together
        data, flat, dark = (a[:, : n * together].reshape(rows, n, together).sum(axis=2) for a in (data, flat, dark))
        u = u[: n * together].reshape(n, together).mean(axis=1)
        edges = edges[: n * together + 1 : together]
        good = flat > 0
    at = start.copy()
    weight = good.astype(np.float64)

    def look(which: BoolArray, p: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Fisher matrix, gradient and deviance (less what does not depend on the parameters)."""
        m, r, a, level, slope = (p[:, i, None] for i in range(5))
        s = np.clip((edges - a) / r, -1.0, 1.0)
        root = np.sqrt((1.0 - s) * (1.0 + s))
        angle = np.arcsin(s)
        chord = np.diff(s * root + angle, axis=1) * (r**2 / together)
        bend = 1.0 + slope * u
        seen = flat[which] * bend * np.exp(np.minimum(-m * chord, 30.0))
        lit = level * seen
        mean = np.maximum(lit + dark[which], 1e-12)
        jacobian = np.empty((p.shape[0], 5, n))
        np.multiply(lit, -chord, out=jacobian[:, 0])
        np.multiply(lit, np.diff(angle, axis=1) * (-2.0 / together * m * r), out=jacobian[:, 1])
        np.multiply(lit, np.diff(root, axis=1) * (2.0 / together * m * r), out=jacobian[:, 2])
        jacobian[:, 3] = seen
        np.multiply(lit, u / bend, out=jacobian[:, 4])
        w = weight[which]
        weighted = jacobian * (w / mean)[:, None, :]
        fisher = weighted @ jacobian.transpose(0, 2, 1)
        gradient = (weighted @ (data[which] - mean)[:, :, None])[:, :, 0]
        return fisher, gradient, 2.0 * (w * mean - data[which] * np.log(mean)).sum(axis=1)

    everyone = np.ones(rows, dtype=np.bool_)
    fisher, gradient, deviance = look(everyone, at)
    damping = np.full(rows, 1e-3)
    active = np.asarray(good.any(axis=1))
    settled = np.zeros(rows, dtype=np.bool_)
    for _ in range(_STEPS):
        if not active.any():
            break
        f, g, p = fisher[active], gradient[active], at[active]
        scale = np.sqrt(np.maximum(np.einsum("rii->ri", f), 1e-300))
        scaled = f / (scale[:, :, None] * scale[:, None, :])
        scaled += (damping[active][:, None, None] + 1e-12) * np.eye(5)
        step = np.linalg.solve(scaled, (g / scale)[:, :, None])[:, :, 0] / scale
        gain = (g * step).sum(axis=1)
        new = p + step
        bad = (new[:, 1] < 0.3) | (np.abs(new) > limit).any(axis=1) | (new[:, 3] <= 0) | ~np.isfinite(new).all(axis=1)
        new = np.where(bad[:, None], p, new)
        nf, ng, nd = look(active, new)
        better = ~bad & (nd <= deviance[active])
        index = np.flatnonzero(active)
        moved = index[better]
        at[moved], fisher[moved], gradient[moved], deviance[moved] = new[better], nf[better], ng[better], nd[better]
        damping[index] = np.where(better, np.maximum(0.1 * damping[index], 1e-12), 10.0 * damping[index])
        end = (gain < 1e-2) | (damping[index] > 10.0)  # at a kink, an edge on a pixel's, no step leads down
        settled[index[end & (gain < 1.0)]] = True
        active[index[end]] = False
    covariance = np.full((rows, 5, 5), np.nan)
    sound = np.asarray((np.einsum("rii->ri", fisher) > 0).all(axis=1))
    scale = np.sqrt(np.einsum("rii->ri", fisher[sound]))
    scaled = fisher[sound] / (scale[:, :, None] * scale[:, None, :]) + 1e-12 * np.eye(5)
    covariance[sound] = np.linalg.inv(scaled) / (scale[:, :, None] * scale[:, None, :])
    return at, covariance, settled & sound
