"""The two-fluid network: strands that slip against the solution and relax, steady, in one model (rung ``two-fluid``).

With V the solution's velocity, w the network's, lam the stretch of a strand (lengths by r_0, velocities by v_0)::

    w = V + eps w d[(lam/w) T(lam)]/ds                momentum: lam/w strands cross a plane for every chain line
    w dlam/ds = lam dw/ds - r(lam)/(2 th)             a strand follows its network and relaxes
    r(lam) = T(lam) - T(1)/lam                        the Maxwell strand; lam - 1/lam for the linear spring
    lam(0) = w(0)                                     strands enter as they are at rest
    eps = c/alpha_v,   th = theta v_0/r_0

Polymer is conserved: lam/w strands, all of N_s segments, are what a plane meets. With linear T, ``A = lam^2`` obeys the
upper-convected Maxwell law and ``lam^2/w`` is its stress times area, so the rung joins both branches of the ladder, each
at rate 1:

* th -> inf: lam = w, the `manifold`;
* eps -> 0: w = V, the conformation; for V = g s, ``lam^2 = A* + (1 - A*)(s/s_0)^(2 - 1/De)``, ``A* = 1/(1 - 2 De)``, De =
  th g.

At small th the slip changes sign, w < V: tension falls downstream and holds the network back. Relaxation forgets the far end:
with it a bounded law has a steady state where the elastic network, dragged by the whole jet beyond its contour, has none.

``strand_law = "shortcut"`` (r = lam - 1, tension T once a chain line) is a test law with the exact solution ``w = V + eps
g`` at De = 1/2, V = g s; it is neither limit above.

Along a bead jet s is the arc and V the stretch of the beads: one moment of it stands for the steady jet.

Method: in T and ``q = ln(lam/w)`` a box scheme with Newton's method (`_two_fluid_box`) on a mesh that follows the
solution, then every cell halved until what that changes, the error, is below
`rtol`. 5 to 50 ms.

References
----------
Greenfeld et al., Phys. Rev. E 84, 041806 (2011), review Eq. (32a), for the momentum; Doi, Onuki, J. Phys. II France 2, 1631
(1992), for two fluids; Bird, Armstrong, Hassager, Dynamics of Polymeric Liquids (1987), for the Maxwell law.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.network import far_end
from spinline.network._objects import instance
from spinline.network._two_fluid_box import Box, on_parabolas, start_of
from spinline.network._two_fluid_march import March, Solved
from spinline.network.far_end import End
from spinline.network.manifold import checked_profile
from spinline.network.tension import Tension

__all__ = ["StrandLaw", "TwoFluid", "two_fluid_network"]

StrandLaw = Literal["maxwell", "shortcut"]
Profile = Callable[[FloatArray], FloatArray]

_LONGEST = 1e100
_LOCKED = 0.95
_THINNEST = 1e-10  # of the jet: a free end's layer below is passed over


@dataclass(frozen=True, eq=False)
class TwoFluid:
    """A steady network that slips and relaxes; call its methods anywhere in [0, length].

    Attributes
    ----------
    length : float
        Last station, in initial radii.
    law : Tension
        Tension law of the strands.
    nodes : ndarray, (n,)
        Places s; the domain may go on beyond `length`.
    state : ndarray, (2 n - 1, 2)
        T and ``q = ln(lam/w)`` at node, middle, node, ...
    error : float
        Estimated relative error of w and lam at the nodes.
    end : {"take-up", "free", "extended"}
        What holds the network downstream.
    far_end_effect : float
        Largest relative change of w or lam, at the stations, between the two marches (`far_end`); inf where the second has
        none.
    moves_most : float
        Where that is, initial radii.
    """

    length: float
    law: Tension
    nodes: FloatArray
    state: FloatArray
    error: float
    end: End
    far_end_effect: float = float("nan")
    moves_most: float = float("nan")
    inertia: float = 0.0

    def velocity_ratio(self, s: ArrayLike) -> FloatArray:
        """Velocity of the network over v_0, w."""
        t, q = np.moveaxis(self._at(s), -1, 0)
        value: FloatArray = self.law.stretch(t) * np.exp(-q)
        return value

    def stretch(self, s: ArrayLike) -> FloatArray:
        """Stretch of the strands, ``lam = xi_par/xi_0``."""
        return self.law.stretch(self.tension(s))

    def tension(self, s: ArrayLike) -> FloatArray:
        """Tension T of a strand, in units of the strand force at rest."""
        value: FloatArray = self._at(s)[..., 0]
        return value

    def relative_extension(self, s: ArrayLike) -> FloatArray:
        """Extension ``xi_par / xi_max``; 0 for the linear spring, which has no contour."""
        return self.stretch(s) / self.law.full_stretch

    def first_passage(self, stretch: float) -> float:
        """First s where the stretch of the strands passes a value; NaN where it never does."""
        target = number("stretch", stretch)
        s = np.append(self.nodes[self.nodes < self.length], self.length)
        above = np.flatnonzero(self.stretch(s) >= target)
        if not above.size:
            return float("nan")
        k = int(above[0])
        if k == 0:
            return float(s[0])
        return float(brentq(lambda x: float(self.stretch(x)) - target, s[k - 1], s[k], xtol=1e-14, rtol=1e-14))

    @property
    def locked_from(self) -> float:
        """First place where strands are beyond 0.95 of their contour, initial radii; NaN if none is."""
        if not self.law.bounded:
            return float("nan")
        return self.first_passage(_LOCKED * self.law.full_stretch)

    def _at(self, s: ArrayLike) -> FloatArray:
        return on_parabolas(self.nodes, self.state, real("s", s, least=0.0, most=self.length))


def two_fluid_network(
    velocity_ratio: Profile,
    length: float,
    *,
    coupling: float | Profile,
    relaxation_time: float | Profile,
    spring: float = 3.0,
    law: Tension | None = None,
    strand_law: StrandLaw = "maxwell",
    end: End = "free",
    stations: ArrayLike | None = None,
    breaks: Sequence[float] = (),
    known_to: float | None = None,
    rtol: float = 1e-6,
) -> TwoFluid:
    """Steady network that slips and relaxes along a jet.

    Parameters
    ----------
    velocity_ratio : callable
        V(s) > 0 for arrays of s in [0, `known_to`], in initial radii; smooth but for `breaks`.
    length : float
        Last station, in initial radii, in (0, 1e100].
    coupling : float or callable
        alpha_v > 0, or alpha_v(s) along the jet.
    relaxation_time : float or callable
        ``th = theta v_0/r_0`` > 0, or th(s); inf for strands that do not relax.
    spring : float, optional
        c > 0: 3 for Gaussian strands, 1 as printed in Eq. (32a).
    law : Tension, optional
        Tension law; default the linear spring, which has no contour.
    strand_law : {"maxwell", "shortcut"}
        How strands relax; "shortcut" is a test law.
    end : {"free", "take-up", "extended"}
        "free": T = T(1) at `length`. "take-up": the network goes on as the jet does, from beyond `length` on. "extended":
        free, as far beyond `length` as it takes for the end not to be felt.
    stations : array_like, optional
        Where results are wanted and the far end is judged, in [0, length]; they become nodes. Default: 201 places.
    breaks : sequence of float, optional
        Places where V is not smooth.
    known_to : float, optional
        Where V(s) ends, at least `length`, its default; beyond, V goes on with the slope it has there. inf for a law.
    rtol : float, optional
        Of w and lam at the stations, in [1e-10, 1e-2].

    Returns
    -------
    TwoFluid

    Raises
    ------
    InputError
        For values out of range, or where no steady network is found.

    Examples
    --------
    >>> jet = lambda s: np.maximum(s, 1.0) ** 0.94
    >>> network = two_fluid_network(jet, 30.0, coupling=20.0, spring=1.0, relaxation_time=2.0, breaks=[1.0])
    >>> [round(float(f(4.0)), 4) for f in (network.velocity_ratio, network.stretch)]
    [3.731, 2.9766]
    """
    far = number("length", length, above=0.0, most=_LONGEST)
    tol = number("rtol", rtol, least=1e-10, most=1e-2)
    chosen = Tension.linear() if law is None else law
    instance("law", chosen, Tension, remedy="make one with Tension.of")
    if not isinstance(strand_law, str) or strand_law not in get_args(StrandLaw):
        raise InputError("strand_law", "is not known", value=strand_law, allowed='"maxwell", "shortcut"')
    held = far_end.check_end(end)
    known = far if known_to is None else (np.inf if known_to == np.inf else number("known_to", known_to, least=far))
    profile = far_end.continued(checked_profile(velocity_ratio), far, known)
    stiffness = positive("spring", spring)
    alpha = _along("coupling", coupling)
    box = Box(
        profile,
        lambda s: stiffness / alpha(np.minimum(s, far)),
        _along("relaxation_time", relaxation_time, endless=True, end=far),
        chosen,
        strand_law == "shortcut",
    )
    at = (
        np.linspace(0.0, far, 201)
        if stations is None
        else np.unique(real("stations", stations, least=0.0, most=far).ravel())
    )
    kinks = real("breaks", breaks).ravel()
    eps = float(box.eps(np.array([far]))[0])
    begin = far if held == "free" else _reach(box, far, eps)
    march = March(box, begin, np.append(at, far), kinks[(kinks > 0) & (kinks < begin)], tol, stiffness)
    th = float(box.relaxation(np.array([begin]))[0])
    gone = float(march.guess.state[-1, 1]) if np.isfinite(th) else 0.0
    root = far_end.root_of(profile, begin, eps, chosen, log_ratio=gone, relaxation_time=th)
    free = chosen.tension_at_rest
    pulled = float("nan") if np.isnan(root) else float(chosen.tension(root))
    thin = eps < _THINNEST * begin  # the layer of a free end is passed over
    if held == "take-up" or thin:
        first, second = float(chosen.tension(_LOCKED * chosen.full_stretch)) if np.isnan(pulled) else pulled, free
    else:
        first, second = free, pulled
    main = march.solve(first)
    found = TwoFluid(far, chosen, main.nodes, main.state, main.error, held)
    if thin and not np.isnan(pulled):
        return replace(found, far_end_effect=0.0, moves_most=far)
    if np.isnan(pulled):  # nothing steady beyond: the jet may pull the network to its contour, everywhere
        effect = chosen.full_stretch / found.stretch(at) - 1
    else:
        other = _second(march, main, second, 0.5 * (root if first == pulled else 1.0), chosen)
        if other is None:  # not known
            return replace(found, far_end_effect=float("inf"), moves_most=far)
        beside = replace(found, nodes=other.nodes, state=other.state)
        effect = np.maximum(
            np.abs(beside.velocity_ratio(at) / found.velocity_ratio(at) - 1),
            np.abs(beside.stretch(at) / found.stretch(at) - 1),
        )
    worst = int(np.argmax(effect))
    return replace(found, far_end_effect=float(effect[worst]), moves_most=float(at[worst]))


def _along(field: str, value: float | Profile, *, endless: bool = False, end: float = np.inf) -> Profile:
    """A number or a function of place as a function of place, held beyond `end`."""
    if callable(value):
        function = value

        def of_place(s: FloatArray) -> FloatArray:
            found = real(field, function(np.minimum(s, end)), above=0.0)
            return np.broadcast_to(found, s.shape)

        return of_place
    one = np.inf if endless and isinstance(value, float) and value == np.inf else positive(field, value)
    return lambda s: np.full(s.shape, one)


def _second(march: March, main: Solved, tension: float, stretch: float, law: Tension) -> Solved | None:
    """The second march; where the layer of its end is not resolved, from strands half as stretched as those of the first."""
    for end in (tension, float(law.tension(stretch))):
        try:
            return march.solve(end, main)
        except InputError:
            continue
    return None


def _reach(box: Box, length: float, eps: float) -> float:
    """Where the marches begin; strands taken as they relax in a network that moves with the flow."""
    places = far_end.beyond(length)
    if np.isinf(box.relaxation(places[:1])).all():
        return far_end.elastic_reach(box.profile, length, eps, box.law)
    before = np.linspace(0.0, length, 201)[:-1]
    tension = start_of(box, np.concatenate((before, places)))[2 * before.size :: 2, 0]
    return far_end.reach(places, far_end.influence_of(box.profile(places), tension, eps, box.law))
