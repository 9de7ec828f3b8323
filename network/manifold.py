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
Legendre coefficients of w and T are below `rtol`. 15 to 130 panels, 1 to 10 ms, 0.2 ms for linear springs in a flow that is a
formula (`AlgebraicFlow`); errors below 1e-11 at the default rtol.

References
----------
Greenfeld et al., Phys. Rev. E 84, 041806 (2011); review Eqs. (32a), (33).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, computable, number, positive, real
from spinline.base.errors import InputError
from spinline.network import _manifold_kernels as kernels
from spinline.network import far_end
from spinline.network._objects import instance
from spinline.network.far_end import End
from spinline.network.force_laws import law_code
from spinline.network.tension import Tension

__all__ = ["AlgebraicFlow", "Manifold", "checked_profile", "eq33", "steady_network", "steady_rows"]

_LONGEST = 1e100
_MOST_TRIALS = (
    1000  # panels tried in all; jets smooth between their breaks take 240 at most, alpha_v to 1e15, rtol to 1e-13
)
_PER_BREAK = 100  # more of them for every break
_ODD_STRETCH = 1e9
_LOCKED = 0.95  # extension from which the network counts as locked

Profile = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class AlgebraicFlow:
    """``V = max(offset + s/scale, 1)^exponent``: power-law (offset 0) and hyperbolic (offset 1, exponent 2) jets.

    A profile like any other, along which linear springs are marched wholly in compiled code.

    Attributes
    ----------
    offset : float
        In [0, 1].
    scale, exponent : float
        > 0; the scale in initial radii.
    """

    offset: float
    scale: float
    exponent: float

    def __post_init__(self) -> None:
        number("offset", self.offset, least=0.0, most=1.0)
        positive("scale", self.scale)
        positive("exponent", self.exponent)

    def __call__(self, s: FloatArray) -> FloatArray:
        """V(s)."""
        value: FloatArray = np.maximum(self.offset + s / self.scale, 1.0) ** self.exponent
        return value


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
        flat, value = np.ascontiguousarray(x).ravel(), np.empty(x.size)
        kernels.tensions(self.edges, self.coefficients, flat, value)
        return value.reshape(x.shape)

    def stretch(self, s: ArrayLike) -> FloatArray:
        """Stretch ``w = xi_par / xi_0 = u / v_0`` at s."""
        return self.law.stretch(self.tension(s))

    def velocity_ratio(self, s: ArrayLike) -> FloatArray:
        """Velocity of the network over v_0: the stretch, since nothing relaxes."""
        return self.stretch(s)

    def first_passage(self, stretch: float) -> float:
        """First s where w passes a value; NaN where it never does. To rounding."""
        edges = np.stack((self.edges[:-1], self.edges[1:]), axis=1)
        value = number("stretch", stretch)
        return float(
            kernels.passage(edges, self.coefficients, len(edges), False, _compiled(self.law), self.length, value)
        )

    def relative_extension(self, s: ArrayLike) -> FloatArray:
        """Extension ``xi_par / xi_max`` at s; at most 1 for a bounded law, and 1 only by rounding."""
        return self.stretch(s) / self.law.full_stretch


@computable
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
    flow = velocity_ratio if isinstance(velocity_ratio, AlgebraicFlow) and not chosen.bounded else None
    begin = far if held == "free" or not upstream else _begin(profile, flow, far, eps, chosen)
    named = set(real("breaks", breaks).ravel().tolist())
    edges = [0.0, *sorted(b for b in named if 0 < b < begin), begin]

    def marched(tension: float, slow: bool) -> Manifold:
        march = _March(profile, flow, chosen, eps, mass, tol, -1.0 if upstream else 1.0)
        return march.network(edges, tension, slow, far, held)

    free = chosen.tension_at_rest
    if not upstream:  # held at the nozzle
        return marched(free, False)
    pulled = _pulled(profile, flow, begin, eps, chosen, mass)
    taken = float(chosen.tension(_LOCKED * chosen.full_stretch)) if np.isnan(pulled) else pulled  # as far as strands go
    take_up = held == "take-up"
    main = marched(taken if take_up else free, take_up and not np.isnan(pulled))
    here = main.stretch(at)
    if np.isnan(pulled):  # nothing steady beyond: the jet may pull the network to its contour, everywhere
        there = np.full_like(here, chosen.full_stretch)
    else:
        there = marched(free if take_up else pulled, not take_up).stretch(at)
    effect = np.abs(there / here - 1)
    worst = int(np.argmax(effect))
    return replace(main, far_end_effect=float(effect[worst]), moves_most=float(at[worst]))


def steady_rows(
    flows: FloatArray,
    lengths: FloatArray,
    kinks: FloatArray,
    eps: FloatArray,
    *,
    end: End,
    rtol: FloatArray,
    targets: FloatArray,
    places: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Many `steady_network` at once: linear springs without inertia along jets that are formulas. About 0.2 ms a row.

    Parameters
    ----------
    flows : ndarray, (rows, 3)
        Offset, scale and exponent of each `AlgebraicFlow`.
    lengths, kinks, eps, rtol : ndarray, (rows,)
        L and the one break (0: none), initial radii; ``c / alpha_v``; tolerance.
    targets : ndarray, (rows, k)
        Stretches whose passages are wanted.
    end : {"take-up", "free", "extended"}
        As for `steady_network`.
    places : ndarray, (rows, m)
        Where w is wanted, initial radii, in [0, L]; NaN for nowhere.

    Returns
    -------
    stretch : ndarray, (rows, m)
        w; NaN where there is no place, and throughout a row that cannot be resolved.
    passages : ndarray, (rows, k)
        First s where w passes the targets, NaN where never.
    """
    stretch, passages = np.empty(places.shape), np.empty(targets.shape)
    columns = [np.ascontiguousarray(a, dtype=np.float64) for a in (flows, lengths, kinks, eps, rtol, targets, places)]
    march: Any = kernels.march_rows
    march(
        *columns,
        ("take-up", "free", "extended").index(far_end.check_end(end)),
        far_end.beyond(1.0),
        *kernels.tables(),
        _MOST_TRIALS + 2 * _PER_BREAK + 1,
        stretch,
        passages,
    )
    return stretch, passages


def _compiled(law: Tension) -> kernels.Law:
    return law_code(law.law), float(law.full_stretch), float(law.rest_force)


def _begin(profile: Profile, flow: AlgebraicFlow | None, length: float, eps: float, law: Tension) -> float:
    if flow is None:
        return far_end.elastic_reach(profile, length, eps, law)
    named = (float(flow.offset), float(flow.scale), float(flow.exponent))
    return float(kernels.begin_of(named, length, eps, far_end.beyond(1.0)))


def _pulled(
    profile: Profile, flow: AlgebraicFlow | None, place: float, eps: float, law: Tension, inertia: float
) -> float:
    """Tension of the slow root at a place; NaN where there is none."""
    if flow is None:
        root = far_end.root_of(profile, place, eps, law, inertia=inertia)
    else:
        root = float(kernels.root_linear((flow.offset, flow.scale, flow.exponent), place, eps, inertia))
    return float("nan") if np.isnan(root) else float(law.tension(root))


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
        self,
        profile: Profile,
        flow: AlgebraicFlow | None,
        law: Tension,
        eps: float,
        inertia: float,
        rtol: float,
        direction: float,
    ) -> None:
        self.profile, self.flow, self.law, self.eps, self.inertia = profile, flow, law, eps, inertia
        self.rtol, self.direction = rtol, direction
        self.panels: list[tuple[float, float, FloatArray]] = []
        self.trials = _MOST_TRIALS
        self.nodes, self.integral, self.to_legendre = kernels.tables()
        self.work = np.empty((kernels.STAGES + 5, kernels.STAGES + 1))

    def network(self, edges: list[float], tension: float, slow: bool, length: float, end: End) -> Manifold:
        """March over all pieces between `edges`, from a tension at the first; `slow` as for `over`."""
        upstream, pieces = self.direction < 0, list(pairwise(edges))
        for low, high in reversed(pieces) if upstream else pieces:
            tension, slow = self.over(low, high, tension, slow), False
        panels = self.panels[::-1] if upstream else self.panels
        places = np.array([panels[0][0], *(panel[1] for panel in panels)])
        found = np.array([panel[2] for panel in panels])
        locked = _locked_from(panels, self.law)
        locked = locked if locked <= length else float("nan")
        return Manifold(length, self.eps, self.inertia, self.law, places, found, locked, end)

    def over(self, low: float, high: float, tension: float, slow: bool) -> float:
        """March from one break to the next; return the tension there. `slow`: from the slow root, without a layer."""
        step = float(kernels.first_step(high - low, abs(self.eps - self.inertia), slow))
        self.trials += _PER_BREAK
        if self.flow is not None:
            return self._compiled(self.flow, low, high, tension, step)
        start, stop = (high, low) if self.direction < 0 else (low, high)
        distance, done = high - low, 0.0
        while done < distance:
            step, self.trials = min(step, distance - done), self.trials - 1
            last = distance - done <= step * (1 + 1e-12)
            a = start + self.direction * done
            b = stop if last else start + self.direction * (done + step)
            coefficients = np.empty(kernels.STAGES + 1)
            factor = self._panel(a, self.direction * step, tension, coefficients)
            if factor < 1 or self.trials < 0:
                if step < 1e-15 * done + 1e-30 * distance or self.trials < 0:
                    raise self._unresolved(a)
                step *= factor
                continue
            if a != b:  # a layer thinner than the rounding of s is marched through, but has no place to be stored
                self.panels.append((min(a, b), max(a, b), coefficients))
            tension = float(np.polynomial.legendre.legval(self.direction, coefficients))
            done = distance if last else done + step
            step *= factor
        return tension

    def _compiled(self, flow: AlgebraicFlow, low: float, high: float, tension: float, step: float) -> float:
        edges, panels = np.empty((self.trials + 1, 2)), np.empty((self.trials + 1, kernels.STAGES + 1))
        found: tuple[Any, ...] = kernels.march_flow(
            (float(flow.offset), float(flow.scale), float(flow.exponent)),
            float(low),
            float(high),
            float(tension),
            self.direction,
            step,
            self.trials,
            self.eps,
            self.inertia,
            _compiled(self.law),
            self.rtol,
            *kernels.tables(),
            0,
            edges,
            panels,
        )
        tension, count, self.trials, failed = found
        if failed >= 0:
            raise self._unresolved(failed)
        self.panels += [(float(edges[k, 0]), float(edges[k, 1]), panels[k]) for k in range(count)]
        return float(tension)

    def _panel(self, a: float, step: float, start: float, coefficients: FloatArray) -> float:
        """Coefficients of T over a signed step from a; the factor of the next step, below 1 where it is to be done again."""
        v = np.ascontiguousarray(self.profile(np.maximum(a + step * self.nodes, 0.0)))
        follows = self.law.tension(np.minimum(v, 0.999 * self.law.full_stretch)) if self.law.bounded else v
        law, matrices = _compiled(self.law), (self.integral, self.to_legendre, self.work)
        size = kernels.panel(v, follows, float(start), step, self.eps, self.inertia, law, *matrices, coefficients)
        return float(kernels.new_step(size / self.rtol))

    def _unresolved(self, place: float) -> InputError:
        v = float(self.profile(np.array([place]))[0])
        remedy = "is the jet smooth between its breaks? name its kinks, or loosen rtol"
        if v > _ODD_STRETCH:
            remedy = f"the jet is stretched {v:.2g}-fold there: lower its k, its field or its length"
        problem = f"the steady network cannot be resolved at s = {place:.9g}"
        return InputError("rtol", problem, value=self.rtol, remedy=remedy)
