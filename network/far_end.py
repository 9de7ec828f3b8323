"""What lies beyond the end of a jet, and how much of it the network upstream feels.

The steady network is held from downstream (`manifold`, `two_fluid`): what it does at the end L decides, over some
distance, what it does before. Nothing local says over how much: ``eps V' <= 1/4`` is neither needed nor enough. So the
network is marched twice from the same place, and the difference is the answer:

* from a *free end*, T = T(1): nothing pulls;
* from the *slow root*, where the network goes on as the jet does, ``dln w/ds = dln V/ds``. For the linear spring::

      w_q = V (1 - q)/(2 eps V'),   q = sqrt(1 - 4 eps V')        (2 V where eps V' > 1/4: there is no root)

The true network lies between, as long as the jet beyond goes on smoothly. A slow root has no boundary layer: it is the take-up
end. A strand law with a contour has no root where the jet outruns the contour and nothing relaxes: whatever the jet does
beyond pulls on a rod, and the second march is the network at its contour everywhere.

Small changes die out upstream as ``exp(-int V/(eps w^2 T'(w)) ds)``; for V = g s as ``(s/L)^p``, ``p = 2 q/(1 - q)``. Both
marches start so far beyond the end that this is small, where the jet (or its straight continuation) allows it.

References
----------
Greenfeld et al., Phys. Rev. E 84, 041806 (2011); review Eq. (32a).
"""

from collections.abc import Callable
from typing import Literal, get_args

import numpy as np
from scipy.optimize import brentq

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network.tension import Tension

__all__ = [
    "End",
    "beyond",
    "check_end",
    "continued",
    "elastic_reach",
    "influence",
    "influence_of",
    "reach",
    "root_of",
    "slow_root",
]

End = Literal["take-up", "free", "extended"]
Profile = Callable[[FloatArray], FloatArray]

_FARTHEST = 9.0  # lengths of the jet that a march may begin beyond it
_SHARE = 0.95  # of the contour that the flow may reach where a march begins
_FORGOTTEN = 14.0  # e-foldings of the influence: 1e-6
_SCAN = 400
_NEAR = 1 + np.linspace(-0.2, 0.2, 41)


def check_end(end: str) -> End:
    """Return a known end, refuse any other."""
    if not isinstance(end, str) or end not in get_args(End):
        raise InputError("end", "is not known", value=end, allowed='"take-up", "free", "extended"')
    return end  # type: ignore[return-value]


def continued(profile: Profile, length: float, known_to: float) -> Profile:
    """V(s) for every s >= 0: the jet's own as far as it is known, then on with the slope it ends with.

    A jet that slows at its end keeps its velocity there.
    """
    if np.isinf(known_to):
        return profile
    step = 1e-3 * min(length, known_to)
    last, before = profile(np.array([known_to, known_to - step]))
    slope = max(float(last - before) / step, 0.0)

    def everywhere(s: FloatArray) -> FloatArray:
        value: FloatArray = profile(np.minimum(s, known_to)) + slope * np.maximum(s - known_to, 0.0)
        return value

    return everywhere


def slow_root(
    velocity_ratio: float,
    slope: float,
    eps: float,
    law: Tension,
    *,
    inertia: float = 0.0,
    log_ratio: float = 0.0,
    relaxation_time: float = np.inf,
) -> float:
    """Stretch of a strand where the network goes on as the jet does, ``dln w/ds = dln V/ds``; NaN where there is none.

    Parameters
    ----------
    velocity_ratio, slope : float
        V > 0 and V' there.
    eps : float
        ``c / alpha_v``.
    law : Tension
        Of the strands.
    inertia : float, optional
        I.
    log_ratio : float, optional
        ``ln(lam / w)`` there: 0 where strands do not relax.
    relaxation_time : float, optional
        th; inf where they do not.

    Returns
    -------
    float
        lam > 0, below the contour.

    Examples
    --------
    >>> round(slow_root(4.0, 1.0, 0.24, Tension.linear()) / 4, 6)
    1.666667
    """
    v, g, share = velocity_ratio, slope / velocity_ratio, float(np.exp(log_ratio))

    def excess(lam: FloatArray) -> FloatArray:
        tension = law.tension(lam)
        _, compliance = law.state(tension)
        slack = (tension - law.tension_at_rest / lam) * share / (2 * relaxation_time * lam**2)
        with np.errstate(divide="ignore", over="ignore"):
            stiff = np.where(compliance > 0, 1 / compliance, np.inf)
            pull = (eps * stiff - inertia) * lam * (g - slack) - eps * slack * tension
        return 1 - v * share / lam - share * pull

    if not law.bounded and np.isinf(relaxation_time):
        room = 1 - 4 * (eps - inertia) * slope
        return float("nan") if room < 0 else 2 * v / (1 + float(np.sqrt(room)))
    flow = v * share
    grid = np.concatenate((np.geomspace(1e-3 * min(flow, 1.0), 1e3 * max(flow, 1.0), _SCAN), flow * _NEAR))
    if law.bounded:
        grid = np.concatenate((grid, law.full_stretch * (1 - np.geomspace(1e-9, 0.9, _SCAN))))
        grid = grid[grid < law.full_stretch * (1 - 1e-10)]
    grid = np.unique(grid)
    value = excess(grid)
    first = np.flatnonzero((value[:-1] < 0) & (value[1:] >= 0))
    if not first.size:
        return float("nan")
    i = int(first[0])
    return float(brentq(lambda x: float(excess(np.asarray(x))), grid[i], grid[i + 1], xtol=1e-14, rtol=1e-14))


def root_of(
    profile: Profile,
    s: float,
    eps: float,
    law: Tension,
    *,
    inertia: float = 0.0,
    log_ratio: float = 0.0,
    relaxation_time: float = np.inf,
) -> float:
    """`slow_root` of a jet at s; ``2 V lam/w`` for a linear spring that has none, NaN for another."""
    step = 1e-5 * s
    v, ahead = profile(np.array([s, s + step]))
    root = slow_root(
        float(v),
        float(ahead - v) / step,
        eps,
        law,
        inertia=inertia,
        log_ratio=log_ratio,
        relaxation_time=relaxation_time,
    )
    return 2 * float(v) * float(np.exp(log_ratio)) if np.isnan(root) and not law.bounded else root


def influence(velocity_ratio: FloatArray, slope: FloatArray, eps: float, law: Tension) -> FloatArray:
    """Rate, per initial radius, at which a small change of the tension dies out upstream along the slow root."""
    share = np.clip(1 - 4 * eps * np.maximum(slope, 0.0), 0.0, 1.0)
    w = 2 * velocity_ratio / (1 + np.sqrt(share))
    if law.bounded:
        w = np.minimum(w, 0.99 * law.full_stretch)
    return influence_of(velocity_ratio, law.tension(w), eps, law)


def influence_of(velocity_ratio: FloatArray, tension: FloatArray, eps: float, law: Tension) -> FloatArray:
    """The same where the tension is known, ``V lam'(T) / (eps lam^2)``."""
    lam, compliance = law.state(tension)
    rate: FloatArray = velocity_ratio * compliance / (eps * lam**2)
    return rate


def beyond(length: float) -> FloatArray:
    """Places from `length` to ten times that, dense at the beginning."""
    places: FloatArray = length * (1 + np.concatenate(([0.0], np.geomspace(1e-14, _FARTHEST, 800))))
    return places


def reach(s: FloatArray, rate: FloatArray, limit: float = np.inf) -> float:
    """Where the two marches begin: so far beyond the last station that their difference is forgotten there, if that can be.

    Parameters
    ----------
    s : ndarray
        Places from the last station on (`beyond`).
    rate : ndarray
        `influence` there.
    limit : float, optional
        No farther than that.

    Returns
    -------
    float
        At least the last station; at most the last of the places.
    """
    passed = np.concatenate(([0.0], np.cumsum(np.diff(s) * _mean(rate))))
    far = np.flatnonzero(passed >= _FORGOTTEN)
    return max(min(float(s[far[0] if far.size else -1]), limit), float(s[0]))


def elastic_reach(profile: Profile, length: float, eps: float, law: Tension) -> float:
    """`reach` of a network that does not relax; no farther than V reaches 0.95 of a contour."""
    s = beyond(length)
    v, step = profile(s), 1e-5 * s
    over = np.flatnonzero(v >= _SHARE * law.full_stretch)
    limit = float(s[max(int(over[0]) - 1, 0)]) if over.size else np.inf
    return reach(s, influence(v, (profile(s + step) - v) / step, eps, law), limit)


def _mean(values: FloatArray) -> FloatArray:
    both: FloatArray = 0.5 * (values[1:] + values[:-1])
    return both
