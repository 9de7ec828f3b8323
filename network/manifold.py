"""The steady network at finite coupling: the slow manifold of the bead flux behind Eq. (33).

Beads leave the nozzle at a constant rate, so the stretch of the strands ``w = xi_par / xi_0`` is the network's velocity
``u / v_0``. With tension T(w) (``T = w`` for the linear spring; ``f(w / V_S) / f_0`` for a law of `force_laws`),
``eps = c / alpha_v`` and inertia I, the bead balance (Eq. 32a) is::

    w = V + (eps T'(w) - I) w dw/ds

Series: ``w = V + eps V V' + ...``; Eq. (33) is right to O(eps) only. For ``eps T' > I`` the equation is violently unstable
downstream (growth rate ``1 / (eps w)``) and as stable upstream: it is marched from its far end back to the nozzle, and no
condition is set at the inlet. For the linear spring with ``I > eps`` it is the other way round.

How much the far end decides is measured, not judged by ``eps V' <= 1/4``: two marches, from a free end and from the slow
root of `far_end`, and the largest difference of w at the stations is `far_end_effect`. For ``V = g s`` the network that
does not depend on the far end is ``w / V = (1 - sqrt(1 - 4 eps g)) / (2 eps g)``; a finite jet forgets its end as ``(s /
L)^p`` only. A network at its contour is held by its end whatever the coupling: *locking* is nonlocal. As ``alpha_v ->
inf``, it is fully extended from the s_1 that satisfies ``int_{s_1}^{L} (V_S - V) ds = 0`` on.

Method: Radau IIA collocation with 12 stages (order 23, L-stable) on panels marched upstream, each accepted when the last
Legendre coefficients of w and T are below `rtol`. 30 to 170 panels, 5 to 60 ms; errors below 1e-11 at the default rtol.

References
----------
Greenfeld et al., Phys. Rev. E 84, 041806 (2011); review Eqs. (32a), (33).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.network import far_end
from spinline.network._objects import instance
from spinline.network.far_end import End
from spinline.network.tension import Tension

__all__ = ["Manifold", "checked_profile", "eq33", "steady_network"]

_STAGES = 12
_IDENTITY = np.eye(_STAGES)
_LONGEST = 1e100
_MOST_TRIALS = (
    1000  # panels tried in all; jets smooth between their breaks take 240 at most, alpha_v to 1e15, rtol to 1e-13
)
_PER_BREAK = 100  # more of them for every break
_LOCKED = 0.95  # extension from which the network counts as locked

Profile = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class Manifold:
    """A steady network; call its methods anywhere in [0, length].

    Attributes
    ----------
    length : float
        Far end L, in initial radii.
    eps, inertia : float
        ``c / alpha_v`` and I.
    law : Tension
        Tension law of the strands.
    edges : ndarray, (panel + 1,)
        Panel edges, increasing.
    coefficients : ndarray, (panel, stages + 1)
        Legendre coefficients of T on each panel.
    locked_from : float
        Upstream end of the stretch of the jet over which strands are beyond 0.95 of their contour; NaN if none is.
    end : {"free", "take-up", "extended"}
        What holds the network downstream.
    far_end_effect : float
        Largest relative change of w, at the stations, between the two marches (`far_end`).
    moves_most : float
        Where that is, initial radii.
    """

    length: float
    eps: float
    inertia: float
    law: Tension
    edges: FloatArray
    coefficients: FloatArray
    locked_from: float
    end: End = "free"
    far_end_effect: float = 0.0
    moves_most: float = float("nan")

    def tension(self, s: ArrayLike) -> FloatArray:
        """Tension T at s, in units of the strand force at rest."""
        x = real("s", s, least=0.0, most=self.length)
        i = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, self.edges.size - 2)
        local = 2 * (x - self.edges[i]) / (self.edges[i + 1] - self.edges[i]) - 1
        degree = np.arange(self.coefficients.shape[1])
        basis = np.polynomial.legendre.legvander(local, degree[-1])
        value: FloatArray = np.sum(basis * self.coefficients[i], axis=-1)
        return value.reshape(x.shape)

    def stretch(self, s: ArrayLike) -> FloatArray:
        """Stretch ``w = xi_par / xi_0 = u / v_0`` at s."""
        return self.law.stretch(self.tension(s))

    def velocity_ratio(self, s: ArrayLike) -> FloatArray:
        """Velocity of the network over v_0: the stretch, since nothing relaxes."""
        return self.stretch(s)

    def first_passage(self, stretch: float) -> float:
        """First s where w passes a value; NaN where it never does. To 1e-12 of the panel."""
        stretch = number("stretch", stretch)
        for low, high in pairwise([*self.edges[self.edges < self.length].tolist(), self.length]):
            s = np.linspace(low, high, 33)
            above = np.flatnonzero(self.stretch(s) >= stretch)
            if not above.size:
                continue
            k = int(above[0])
            if k == 0:
                return float(s[0])
            crossing = brentq(
                lambda x: float(self.stretch(x)) - stretch, s[k - 1], s[k], xtol=1e-14, rtol=1e-14, maxiter=1000
            )
            return float(crossing)  # a panel may span decades: bisection alone takes some 100 steps there
        return float("nan")

    def relative_extension(self, s: ArrayLike) -> FloatArray:
        """Extension ``xi_par / xi_max`` at s; at most 1 for a bounded law, and 1 only by rounding."""
        return self.stretch(s) / self.law.full_stretch


def eq33(velocity_ratio: ArrayLike, slope: ArrayLike, eps: float) -> FloatArray:
    """Stretch by Eq. (33), ``w = V / (1 - eps V')``: the first iterate, right to O(eps).

    Parameters
    ----------
    velocity_ratio, slope : array_like
        V > 0 and dV/ds at the same places.
    eps : float
        ``c / alpha_v`` > 0.

    Returns
    -------
    ndarray

    Raises
    ------
    InputError
        Where ``eps V' >= 1``: the formula has no value there.
    """
    v, rise = real("velocity_ratio", velocity_ratio, above=0.0), real("slope", slope)
    try:
        v, rise = np.broadcast_arrays(v, rise)
    except ValueError:
        raise InputError("slope", f"does not broadcast: shapes {v.shape} and {rise.shape}") from None
    share = positive("eps", eps) * rise
    real("eps * slope", share, below=1.0, remedy="Eq. (33) has no value there; raise alpha_v")
    return v / (1 - share)


def steady_network(
    velocity_ratio: Profile,
    length: float,
    *,
    coupling: float,
    spring: float = 3.0,
    inertia: float = 0.0,
    law: Tension | None = None,
    breaks: Sequence[float] = (),
    end: End = "free",
    stations: ArrayLike | None = None,
    known_to: float | None = None,
    rtol: float = 1e-10,
) -> Manifold:
    """Steady network along a jet, marched the stable way.

    Parameters
    ----------
    velocity_ratio : callable
        V(s) > 0 for arrays of s in [0, `known_to`], in initial radii; smooth but for `breaks`.
    length : float
        Last station L, in initial radii, in (0, 1e100].
    coupling : float
        alpha_v > 0.
    spring : float, optional
        c > 0: 3 for Gaussian strands, 1 as printed in Eq. (32a).
    inertia : float, optional
        I >= 0.
    law : Tension, optional
        Tension law; default the linear spring, which has no contour.
    breaks : sequence of float, optional
        Places where V is not smooth (s_0 of a power-law jet).
    end : {"free", "take-up", "extended"}
        "free": T = T(1) at `length`. "take-up": the network goes on as the jet does, from beyond `length` on. "extended":
        free, as far beyond `length` as it takes for the end not to be felt.
    stations : array_like, optional
        Where the far end is judged, in [0, length]. Default: 201 places.
    known_to : float, optional
        Where V(s) ends, at least `length`, its default; beyond, V goes on with the slope it has there. inf for a law.
    rtol : float, optional
        Tolerance of w, relative, in [1e-13, 1e-2].

    Returns
    -------
    Manifold

    Raises
    ------
    InputError
        For values out of range; where inertia and elasticity balance, so that neither march is stable.

    Examples
    --------
    >>> network = steady_network(lambda s: 1 + 0.1 * s, 50.0, coupling=10.0, spring=1.0)
    >>> round(float(network.stretch(20.0)), 6)
    3.030615
    """
    far, alpha = number("length", length, above=0.0, most=_LONGEST), positive("coupling", coupling)
    eps = positive("spring", spring) / alpha
    mass = number("inertia", inertia, least=0.0)
    tol = number("rtol", rtol, least=1e-13, most=1e-2)
    chosen = Tension.linear() if law is None else law
    instance("law", chosen, Tension, remedy="make one with Tension.of")
    held = far_end.check_end(end)
    known = far if known_to is None else (np.inf if known_to == np.inf else number("known_to", known_to, least=far))
    profile = far_end.continued(checked_profile(velocity_ratio), far, known)
    at = np.linspace(0.0, far, 201) if stations is None else real("stations", stations, least=0.0, most=far).ravel()
    upstream = eps > mass
    if not upstream and (chosen.bounded or eps == mass):
        raise InputError(
            "inertia",
            "is as large as the elastic coupling: no march of the steady network is stable",
            value=mass,
            allowed=f"< c/alpha_v = {eps:g}",
            remedy="use the chain in time, or lower I",
        )
    begin = far_end.elastic_reach(profile, far, eps, chosen) if upstream and held != "free" else far
    named = set(real("breaks", breaks).ravel().tolist())
    edges = [0.0, *sorted(b for b in named if 0 < b < begin), begin]

    def marched(tension: float) -> Manifold:
        march = _March(profile, chosen, eps, mass, tol, -1.0 if upstream else 1.0)
        pieces = list(pairwise(edges))
        for low, high in reversed(pieces) if upstream else pieces:
            tension = march.over(low, high, tension)
        panels = march.panels[::-1] if upstream else march.panels
        places = np.array([panels[0][0], *(panel[1] for panel in panels)])
        locked = _locked_from(panels, chosen)
        return Manifold(
            far,
            eps,
            mass,
            chosen,
            places,
            np.array([panel[2] for panel in panels]),
            locked if locked <= far else float("nan"),
            held,
        )

    free = chosen.tension_at_rest
    if not upstream:  # held at the nozzle
        return marched(free)
    root = far_end.root_of(profile, begin, eps, chosen, inertia=mass)
    pulled = float("nan") if np.isnan(root) else float(chosen.tension(root))
    taken = float(chosen.tension(_LOCKED * chosen.full_stretch)) if np.isnan(pulled) else pulled  # as far as strands go
    first, second = (free, pulled) if held != "take-up" else (taken, free)
    main = marched(first)
    here = main.stretch(at)
    # nothing steady beyond: the jet may pull the network to its contour, everywhere
    there = np.full_like(here, chosen.full_stretch) if np.isnan(pulled) else marched(second).stretch(at)
    effect = np.abs(there / here - 1)
    worst = int(np.argmax(effect))
    return replace(main, far_end_effect=float(effect[worst]), moves_most=float(at[worst]))


def checked_profile(velocity_ratio: Profile) -> Profile:
    """The jet's V(s), refused where it is not one positive number for each place."""
    if not callable(velocity_ratio):
        raise InputError("velocity_ratio", "is not a function V(s)", value=type(velocity_ratio).__name__)

    def profile(s: FloatArray) -> FloatArray:
        v = np.asarray(velocity_ratio(s))
        if v.dtype != np.float64 or not (
            v.min(initial=1.0) > 0 and v.max(initial=1.0) < np.inf
        ):  # else as it should be
            v = real("velocity_ratio", v, above=0.0, remedy="the jet must move forward everywhere")
        if v.shape not in ((), s.shape):
            raise InputError("velocity_ratio", "must return one value for each place", value=f"{v.shape} for {s.shape}")
        return np.broadcast_to(v, s.shape)

    return profile


def _locked_from(panels: list[tuple[float, float, FloatArray]], law: Tension) -> float:
    if not law.bounded:
        return float("nan")
    for low, high, coefficients in panels:
        local = np.linspace(-1, 1, 33)
        extension = law.stretch(np.polynomial.legendre.legval(local, coefficients)) / law.full_stretch
        if (extension >= _LOCKED).any():
            at = float(local[np.argmax(extension >= _LOCKED)])
            return low + 0.5 * (1 + at) * (high - low)
    return float("nan")


class _March:
    """Marches T panel by panel; `direction` is -1 upstream, 1 downstream."""

    def __init__(
        self, profile: Profile, law: Tension, eps: float, inertia: float, rtol: float, direction: float
    ) -> None:
        self.profile, self.law, self.eps, self.inertia, self.rtol = profile, law, eps, inertia, rtol
        self.direction = direction
        self.panels: list[tuple[float, float, FloatArray]] = []
        self.trials = _MOST_TRIALS
        self.nodes, self.integral, self.to_legendre = _radau(_STAGES)
        self.signs = np.where(np.arange(_STAGES + 1) % 2 == 0, 1.0, -1.0)  # Legendre polynomials at -1

    def over(self, low: float, high: float, tension: float) -> float:
        """March from one break to the next; return the tension there."""
        start, stop = (high, low) if self.direction < 0 else (low, high)
        distance, done = high - low, 0.0
        step = min(distance, 0.1 * max(abs(self.eps - self.inertia), 1e-15 * distance))
        self.trials += _PER_BREAK
        while done < distance:
            step, self.trials = min(step, distance - done), self.trials - 1
            last = distance - done <= step * (1 + 1e-12)
            a = start + self.direction * done
            b = stop if last else start + self.direction * (done + step)
            solved = self._panel(a, self.direction * step, tension)
            if solved is None or solved[1] > 1 or self.trials < 0:
                if step < 1e-15 * done + 1e-30 * distance or self.trials < 0:
                    raise InputError(
                        "rtol",
                        f"the steady network cannot be resolved at s = {a:.9g}",
                        value=self.rtol,
                        remedy="is the jet smooth between its breaks? name its kinks, or loosen rtol",
                    )
                step *= 0.5
                continue
            coefficients, error = solved
            if a != b:  # a layer thinner than the rounding of s is marched through, but has no place to be stored
                self.panels.append((min(a, b), max(a, b), coefficients))
            tension = float(coefficients.sum() if self.direction > 0 else coefficients @ self.signs)
            done = distance if last else done + step
            step *= 3.0 if error < 1e-4 else 1.5 if error < 1e-2 else 1.0
        return tension

    def _panel(self, a: float, step: float, start: float) -> tuple[FloatArray, float] | None:
        """Legendre coefficients of T over a signed step from a, and the error over the tolerance; None if Newton fails."""
        v = self.profile(np.maximum(a + step * self.nodes[1:], 0.0))
        weights = step * self.integral
        guesses = [np.full(_STAGES, start), self.law.tension(np.minimum(v, 0.999 * self.law.full_stretch))]
        if abs(float(guesses[1][0]) - start) < 0.1 * start:  # beyond the layer at the end the network follows the jet
            guesses.reverse()
        for guess in guesses:
            found = self._newton(guess, start, v, weights)
            if found is not None:
                break
        else:
            return None
        values = np.concatenate(([start], found))
        coefficients = self.to_legendre @ values
        if step < 0:
            coefficients = coefficients * self.signs
        tail = max(
            float(np.abs(self.to_legendre[-2:] @ y).max() / np.abs(y).max()) for y in (values, self.law.stretch(values))
        )
        return coefficients, tail / self.rtol

    def _newton(self, tension: FloatArray, start: float, v: FloatArray, weights: FloatArray) -> FloatArray | None:
        w, compliance = self.law.state(tension)
        if not np.isfinite(w).all() or w.min() <= 0:
            return None
        for _ in range(30):
            # dT/ds = (w - V) / ((eps - I dw/dT) w), and its derivative with respect to T
            pull = self.eps - self.inertia * compliance
            share = v / w
            rate, slope = (1 - share) / pull, share / w * compliance / pull
            residual = tension - start - weights @ rate
            change = np.linalg.solve(_IDENTITY - weights * slope, residual)
            tension = tension - change
            if not np.isfinite(tension).all():
                return None
            w, compliance = self.law.state(tension)
            if not w.min() > 0:
                return None
            if np.abs(change).max() <= 1e-14 * np.abs(tension).max() + 1e-300:
                return tension
        small = np.abs(change).max() <= 1e-11 * np.abs(tension).max()
        return tension if small else None


@lru_cache(maxsize=4)
def _radau(stages: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes (0 and the Radau IIA nodes on (0, 1]), integration matrix, and values-to-Legendre matrix."""
    legendre = np.polynomial.legendre
    difference = np.zeros(stages + 1)
    difference[stages], difference[stages - 1] = 1.0, -1.0
    roots = np.sort(legendre.legroots(difference).real)
    roots[-1] = 1.0
    derivative = legendre.legder(difference)
    for _ in range(3):
        inner = roots[:-1]
        roots[:-1] = inner - legendre.legval(inner, difference) / legendre.legval(inner, derivative)
    vander = legendre.legvander(roots, stages - 1)
    integrals = np.stack(
        [legendre.legval(roots, legendre.legint(np.eye(stages)[k], lbnd=-1)) for k in range(stages)], axis=1
    )
    all_nodes = np.concatenate(([-1.0], roots))
    to_legendre = np.linalg.inv(legendre.legvander(all_nodes, stages))
    integral = 0.5 * integrals @ np.linalg.inv(vander)
    return (0.5 * (1 + all_nodes)).astype(np.float64), integral.astype(np.float64), to_legendre.astype(np.float64)
