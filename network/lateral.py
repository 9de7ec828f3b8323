"""Network across a moving jet: Eq. (32b) with the motion of the beads kept, and the surface of the jet as its bound.

Eq. (32b) balances the drag of the inward flow against the strands for beads at rest. A bead that travels down the jet feels
the drag of its own slip; with x = r/r_0 at rest (0 on the axis, 1 at the surface), ``eps = c / alpha_v``::

    w dr/ds = -r V' / 2 + eps d2r/dx2,      r(0) = 0,      dr/dx = q  at x = 1

where ``q = xi_perp / xi_0`` is the lateral contraction of the strands (the walk's) and w the axial velocity of the network.
The term in V' is integrated exactly: with ``r = E rho``, ``ln E = -int V' / (2 w) ds`` (``E = V^(-1/2)`` for w = V) and the
Fourier number ``F = int eps ds / w = c k_B T t / (xi_eff mu r_0^2)``::

    d rho/dF = d2 rho/dx2,      rho(0) = 0,      d rho/dx = q / E  at x = 1,      E rho(1) <= V^(-1/2)

The last is the surface of the jet: where strands are wider than the flow makes their mesh, they press against it and the
network fills the jet. It leaves the surface where ``q V^(1/2)`` falls under 1, near full stretch, and then shrinks from
outside, through a layer ``F^(1/2)`` deep.

Limits: F -> 0 moves with the solution; F -> infinity is ``r_P / r = min(1, q V^(1/2))``; w -> 0 is Eq. (32b) (`radial`).
Eq. (39), ``r_P / r = q``, is none of them: it lets the strands contract beyond the flow at once. F says how much of that
there is time for: with alpha_v = 1e3 to 1e7 it is 1e-2 to 1e-6 over 5 mm, and only the outermost 10 to 0.1 % can follow.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, computable, number, positive, real
from spinline.base.errors import InputError

__all__ = ["DRAGS", "LateralNetwork", "lateral_limit", "lateral_network", "lateral_time"]

DRAGS = {"xi mu": 1.0, "6 pi xi mu": 6 * np.pi}
"""Drag of a bead over ``xi_eff mu u``: as alpha_v has it (the review), and Stokes's for a sphere of radius xi_eff."""

_MOST_REFINED = 5
_GAMMA = 2.0 - np.sqrt(2.0)  # TR-BDF2


@dataclass(frozen=True, eq=False)
class LateralNetwork:
    """Network across the jet at each station.

    Attributes
    ----------
    layer_edges : ndarray, (layers + 1,)
        x, radius of the layers' edges at rest over r_0; fine towards the surface.
    edges : ndarray, (stations, layers + 1)
        Where they are, over r_0.
    radius_ratio : ndarray, (stations,)
        ``r_P / r``, network radius over jet radius, <= 1.
    polymer_fraction : ndarray, (stations, layers)
        Mean of each layer; its integral over the network, times w, is the same at every station.
    mesh : ndarray, (stations, layers)
        Lateral mesh over the mesh at rest, ``dr / dx``.
    detached : ndarray of bool, (stations,)
        Whether the network has left the surface of the jet.
    compacted : ndarray of bool, (stations, layers)
        Where `polymer_fraction` has passed 1.
    error : float
        Estimated largest error of `radius_ratio`, by halving steps and layers.
    """

    layer_edges: FloatArray
    edges: FloatArray
    radius_ratio: FloatArray
    polymer_fraction: FloatArray
    mesh: FloatArray
    detached: BoolArray
    compacted: BoolArray
    error: float


@computable
def lateral_time(residence_time: ArrayLike, coupling: float, pace: float, spring: float = 3.0) -> FloatArray:
    """Time the network has to contract, ``F = c k_B T t/(xi_eff mu r_0^2)``: how much of `lateral_limit` is reached.

    Parameters
    ----------
    residence_time : array_like
        Time from the nozzle, s, >= 0.
    coupling : float
        alpha_v > 0, with a drag of ``xi_eff mu`` a bead; divide F by 6 pi for Stokes's.
    pace : float
        ``v_0/r_0``, 1/s, > 0.
    spring : float, optional
        c > 0.

    Returns
    -------
    ndarray
        F; far below 1 the network moves with the solution (r_P/r = 1), far above it is `lateral_limit`.

    Examples
    --------
    >>> round(float(lateral_time(0.0354, 1e4, 145.0)), 5)
    0.00154
    """
    time = real("residence_time", residence_time, least=0.0, unit="s")
    value: FloatArray = positive("spring", spring) / positive("coupling", coupling) * positive("pace", pace) * time
    return value


@computable
def lateral_limit(contraction: ArrayLike, velocity_ratio: ArrayLike) -> FloatArray:
    """``r_P/r`` of a network with all the time it takes, ``min(1, q V^(1/2))``; Eq. (39) says q.

    Parameters
    ----------
    contraction : array_like
        q > 0, lateral size of the strands over that at rest.
    velocity_ratio : array_like
        V > 0.

    Notes
    -----
    A strand that the flow has made narrower than its own lateral size pushes outward: the network fills the jet for as long as
    ``q V^(1/2) > 1``. Eq. (39), r_P/r = q from the nozzle on, would need a lateral tension beyond f_0, the strands' own at
    rest.
    """
    q, v = real("contraction", contraction, above=0.0), real("velocity_ratio", velocity_ratio, above=0.0)
    value: FloatArray = np.minimum(1.0, q * np.sqrt(v))
    return value


def lateral_network(
    fourier: ArrayLike,
    velocity_ratio: ArrayLike,
    contraction: ArrayLike,
    volume_fraction: float,
    *,
    network_velocity_ratio: ArrayLike | None = None,
    layers: int = 60,
    rtol: float = 1e-4,
) -> LateralNetwork:
    """Radius and concentration of the network across the jet.

    Parameters
    ----------
    fourier : array_like, (stations,)
        F, >= 0, not falling: time from the nozzle times ``c k_B T / (xi_eff mu r_0^2)``.
    velocity_ratio : array_like, (stations,)
        V, > 0, 1 at the first station.
    contraction : array_like, (stations,)
        Lateral size of the strands over that at rest, q > 0 (`network_state` gives it; over its own value at V = 1).
    volume_fraction : float
        Polymer fraction at rest, in (0, 1).
    network_velocity_ratio : array_like, (stations,), optional
        w > 0; V if left out. Between stations ln V and 1/w are taken as straight lines of each other.
    layers : int, optional
        Layers to begin with, 8 to 10,000.
    rtol : float, optional
        Layers and steps are doubled until halving them changes ``r_P / r`` by no more, [1e-8, 0.1].

    Returns
    -------
    LateralNetwork

    Raises
    ------
    InputError
        For values out of range, stations that do not go forward, or an accuracy that is not reached.

    Notes
    -----
    Second order in layers and steps; about 65 ms for 400 stations at 1e-4. What happens between stations is
    interpolated: give enough of them.
    """
    phi = number("volume_fraction", volume_fraction, above=0.0, below=1.0)
    time = real("fourier", fourier, least=0.0, most=1e12)
    v = real("velocity_ratio", velocity_ratio, above=0.0, most=1e150)
    q = real("contraction", contraction, above=0.0, most=1e6)
    w = v if network_velocity_ratio is None else real("network_velocity_ratio", network_velocity_ratio, above=0.0)
    if not (time.ndim == 1 and time.shape == v.shape == q.shape == w.shape and time.size):
        shapes = ", ".join(str(a.shape) for a in (time, v, q, w))
        raise InputError(
            "fourier", "is not one value a station, as the others are", value=shapes, allowed="(stations,)"
        )
    if (np.diff(time) < 0).any():
        raise InputError(
            "fourier", "falls along the jet", value=float(np.diff(time).min()), allowed=">= 0 between stations"
        )
    if isinstance(layers, bool) or not isinstance(layers, int | np.integer) or not 8 <= layers <= 10_000:
        raise InputError("layers", "is not a number of layers", value=layers, allowed="integers, [8, 10000]")
    tolerance = number("rtol", positive("rtol", rtol), least=1e-8, most=0.1)
    slip = 0.5 * (v / w)[1:] + 0.5 * (v / w)[:-1]
    shrink = np.exp(np.concatenate(([0.0], -0.5 * np.cumsum(slip * np.diff(np.log(v))))))
    if shrink.min() < 1e-150 or shrink.max() > 1e150:
        raise InputError(
            "network_velocity_ratio",
            "is so far from V that the network is crushed",
            value=float(shrink.min()),
            remedy="take the network nearer to the flow, or a shorter jet",
        )
    pull, cap = q / shrink, v**-0.5 / shrink
    cap = np.where(np.abs(cap - 1) < 1e-12, 1.0, cap)  # rounding of w = V
    size, steps = int(layers), 1
    coarse, _, _ = _march(time, pull, cap, size, steps)
    folded = False
    for _ in range(_MOST_REFINED):
        size, steps = 2 * size, 2 * steps
        lag, distance, detached = _march(time, pull, cap, size, steps)
        thickness = -np.diff(distance)
        mesh = shrink[:, None] * (1 - np.diff(lag, axis=1) / thickness)
        error = float(np.abs((lag[:, -1] - coarse[:, -1]) / cap).max()) / 3
        settled = error <= tolerance
        if settled and (mesh > 0).all():
            break
        if settled and folded:  # twice: no finer grid unfolds it
            station = int(np.argmax((mesh <= 0).any(axis=1)))
            raise InputError(
                "contraction",
                f"folds layers of the network over one another at station {station}: it falls too steeply there",
                value=float(q[station]),
                remedy="give a denser or less stretched network, or leave the lateral motion out",
            )
        folded = settled
        coarse = lag
    else:
        raise InputError(
            "rtol",
            f"is not reached (error {error:.2g})",
            value=tolerance,
            remedy="give more stations, or a larger rtol",
        )
    x = 1 - distance
    edges = shrink[:, None] * (x - lag)
    with np.errstate(over="ignore"):
        spread = (edges[:, 1:] + edges[:, :-1]) / (x[1:] + x[:-1]) * mesh * w[:, None]
        fraction = phi / spread
    return LateralNetwork(x, edges, (1 - lag[:, -1]) / cap, fraction, mesh, detached, fraction > 1, error)


def _distances(layers: int, depth: float) -> FloatArray:
    """Distances of the layers' edges from the surface, 1 ... 0: the outermost layers a few per cent of `depth` thick."""
    from scipy.optimize import brentq  # slow to import, and seldom needed

    y = np.linspace(1.0, 0.0, layers + 1)
    share = min(3 * depth, 1.0)
    if share > 0.99:
        return y
    a = brentq(lambda a: a / np.sinh(a) - max(share, 1e-9), 1e-3, 40.0)
    return np.asarray(np.sinh(a * y) / np.sinh(a))


def _march(
    time: FloatArray, pull: FloatArray, cap: FloatArray, layers: int, steps: int
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Lag ``x - rho`` of the layers' edges at every station; `steps` steps of TR-BDF2 from one station to the next."""
    distance = _distances(layers, float(np.sqrt(time[-1] - time[0])))
    h = -np.diff(distance)
    lag = np.zeros((time.size, layers + 1))
    free = np.zeros(time.size, dtype=np.bool_)
    bands = np.zeros((3, layers))
    left, right = 2 / (h[:-1] * (h[:-1] + h[1:])), 2 / (h[1:] * (h[:-1] + h[1:]))
    bands[0, 1:], bands[2, :-2] = right, left[1:]
    bands[1, :-1] = -(left + right)
    bands[2, -2], bands[1, -1] = 2 / h[-1] ** 2, -2 / h[-1] ** 2  # the half layer at the surface
    source = 2 / h[-1]
    now = lag[0, 1:]
    detached = False
    for k in range(1, time.size):
        step = (time[k] - time[k - 1]) / steps
        if step > 0:
            for j in range(steps):
                ends = [
                    (1 - pull[k - 1] - (pull[k] - pull[k - 1]) * u, 1 - cap[k - 1] - (cap[k] - cap[k - 1]) * u)
                    for u in ((j + f) / steps for f in (0.0, _GAMMA, 1.0))
                ]
                now, detached = _step(now, step, bands, source, ends)
        lag[k, 1:], free[k] = now, detached
    return lag, distance, free


def _step(
    now: FloatArray, step: float, bands: FloatArray, source: float, ends: list[tuple[float, float]]
) -> tuple[FloatArray, bool]:
    """One step of TR-BDF2 with the surface as a bound on the outermost edge; `ends` are slope and least lag there."""
    (slope0, least0), (slope1, least1), (slope2, least2) = ends
    flow = _times(bands, now)
    flow[-1] += source * slope0
    if now[-1] <= least0:  # the surface pushes back
        flow[-1] = max(flow[-1], 0.0)
    half = 0.5 * _GAMMA * step
    middle, _ = _solve(now + half * flow, half, bands, source * slope1, least1)
    share = 1 / (_GAMMA * (2 - _GAMMA))
    right = share * middle - (1 - _GAMMA) ** 2 * share * now
    return _solve(right, (1 - _GAMMA) / (2 - _GAMMA) * step, bands, source * slope2, least2)


def _times(bands: FloatArray, lag: FloatArray) -> FloatArray:
    out: FloatArray = bands[1] * lag
    out[:-1] += bands[0, 1:] * lag[1:]
    out[1:] += bands[2, :-1] * lag[:-1]
    return out


def _solve(right: FloatArray, step: float, bands: FloatArray, source: float, least: float) -> tuple[FloatArray, bool]:
    """Implicit stage: free of the surface if that keeps it inside, held at it if not."""
    from scipy.linalg import solve_banded  # slow to import, and seldom needed

    matrix = -step * bands
    matrix[1] += 1
    load = right.copy()
    load[-1] += step * source
    free = solve_banded((1, 1), matrix, load)
    if free[-1] > least:
        return free, True
    matrix[1, -1], matrix[2, -2] = 1.0, 0.0
    load[-1] = least
    return solve_banded((1, 1), matrix, load), False
