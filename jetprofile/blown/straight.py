"""The straight part of a blown jet: a boundary-value problem, solved by collocation and continuation in the drag.

Steady, Q fixed, f = pi a^2 = Q/v::

    rho Q v' = F' + rho g f + q_t           F = f (tau_zz - tau_rr + 3 mu_s v') + pi a sigma
    newton     tau = 0, mu_s = mu
    ucm        v A_zz' = 2 v' A_zz - (A_zz - 1)/theta     v A_rr' = -v' A_rr - (A_rr - 1)/theta     tau = G (A - 1), mu_s = 0
    oldroyd-b  the same with mu_s > 0

The far end pulls with `end_tension` beyond capillarity (0: a free end). That condition, not the inlet, decides: while the jet
is slower than its elastic waves one characteristic runs upstream, so velocity *and* inlet stress cannot both be chosen. For
`ucm` the entry is an elastic jump (A_rr = A_zz^(-1/2) at the nozzle); eliminating F::

    v' [3 G + tau_zz + 2 tau_rr - sigma/(2 a) - rho v^2] = (tau_zz - tau_rr)/theta - v (rho g + q_t/f)

whose bracket is ``rho (c^2 - v^2)``. Where it vanishes there is no such jet: verdict *critical*. With a solvent the jet has no
such place, and enters relaxed (A = 1): `oldroyd-b` is the law to take.

Shooting from the nozzle fails: a Newtonian jet forgets its inlet by more e-folds than a double has. Collocation (scipy's
`solve_bvp`) from a crude guess fails for some gas velocities; here the drag is raised from 1e-4 of itself, the step halved
where a solve fails, and only a solution whose momentum closes to 1e-6 is handed out.

**Bound.** A strongly stretched UCM jet whose tension falls downstream has ``v' <= 1/theta``: ``v <= v_0 + z/theta``, whatever
the air does. A relaxation time of 5 ms forbids more than 2.01 m/s after 10 mm; do not tune the drag to hide it.

Verdicts: *converged*; *compressed* (axial stress below 0 somewhere: air slower than the jet; a straight jet does not exist
there); *critical*; *slack* (no tension at the nozzle gives that pull). Only the first two hold a profile.

References
----------
Yarin, Sinha-Ray, Pourdeyhimi, J. Appl. Phys. 108, 034913 (2010); Sinha-Ray, Sinha-Ray, Yarin, Pourdeyhimi, Polymer 56, 452
(2015); review Eqs. (43), with the error of (43b) put right: vapour leaves with the jet's velocity.
"""

import warnings
from collections.abc import Callable
from itertools import pairwise
from typing import Any, get_args

import numpy as np
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import brentq

from spinline.base.checks import FloatArray, number, positive
from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.quadrature import gauss
from spinline.jetprofile.blown.air import Air
from spinline.jetprofile.blown.drag import DRAG_LAWS, TangentialLaw
from spinline.jetprofile.blown.straight_results import BlownSolution, Law, StraightBlownJet, Verdict

__all__ = ["BlownSolution", "Law", "StraightBlownJet", "Verdict", "straight_blown_jet"]

_POINTS = 400
_MOST_STEPS, _MOST_NODES = 80, 60_000
_MOST_CALLS = 12_000  # of one march
_BUDGET, _CALL = 1e8, 200  # places evaluated in all, and what a call counts beside them
_SHOOT = 8e-4  # s: relaxation times from which shooting is tried first


def straight_blown_jet(
    solution: BlownSolution,
    air: Air,
    length: float,
    *,
    law: Law | None = None,
    drag: TangentialLaw = "ziabicki-kawai",
    end_tension: float = 0.0,
    gravity: float = 9.81,
    inlet_stretch: float | None = None,
    rtol: float = 1e-8,
) -> StraightBlownJet:
    """Straight blown jet from the nozzle to `length`.

    Parameters
    ----------
    solution : BlownSolution
    air : Air
    length : float
        m.
    law : {"newton", "ucm", "oldroyd-b"}, optional
        Default: newton without relaxation, oldroyd-b with a solvent's viscosity, ucm else.
    drag : str
    end_tension : float
        Pull beyond capillarity at the end, N.
    gravity : float
        Along the jet, m/s2.
    inlet_stretch : float, optional
        ``ucm``: A_zz at the nozzle, *marched* from there without a condition at the end.
    rtol : float
        In [1e-12, 1e-4].

    Returns
    -------
    StraightBlownJet
        See its verdict; a profile is only ever a converged one.

    Raises
    ------
    InputError
        For a law that the solution does not have the properties for.
    """
    problem = _Problem(
        solution,
        air,
        positive("length", length, "m"),
        _law(solution, law),
        DRAG_LAWS[_drag(drag)],
        gravity,
        number("rtol", rtol, least=1e-12, most=1e-4),
    )
    pull = number("end_tension", end_tension, unit="N")
    if inlet_stretch is not None:
        if problem.law != "ucm":
            raise InputError("inlet_stretch", "is for law ucm alone", value=inlet_stretch)
        return problem.march(number("inlet_stretch", inlet_stretch, above=0.0))
    return problem.solve(pull)


def _law(solution: BlownSolution, law: Law | None) -> Law:
    elastic, solvent = solution.relaxation_time > 0, solution.solvent_viscosity > 0
    if law is None:
        return "newton" if not elastic else "oldroyd-b" if solvent else "ucm"
    if law not in get_args(Law):
        raise InputError("law", "is not known", value=law, allowed='"newton", "ucm", "oldroyd-b"')
    if law != "newton" and not elastic:
        raise InputError("relaxation_time", f"is needed by the law {law}", value=0.0, allowed="(0, inf) s")
    if law == "oldroyd-b" and not solvent:
        raise InputError(
            "solvent_viscosity", "is needed by the law oldroyd-b", value=0.0, allowed="(0, viscosity) Pa s"
        )
    return law


def _drag(drag: str) -> str:
    if drag not in DRAG_LAWS:
        raise InputError("drag", "is not known", value=drag, allowed='"ziabicki-kawai", "matsui"')
    return drag


class _Problem:
    """One jet as a two-point problem, drag times `share`.

    State: ln v/v_0, then F (in scale) where there is a solvent viscosity, then ln A_zz, ln A_rr where there is elasticity.
    """

    def __init__(
        self,
        solution: BlownSolution,
        air: Air,
        length: float,
        law: Law,
        drag: tuple[float, float],
        gravity: float,
        rtol: float,
    ) -> None:
        self.s, self.air, self.length, self.law, self.drag, self.rtol = solution, air, length, law, drag, rtol
        self.gravity = number("gravity", gravity, unit="m/s2")
        self.v0 = solution.velocity
        self.viscous = (
            solution.viscosity if law == "newton" else solution.solvent_viscosity if law == "oldroyd-b" else 0.0
        )
        self.g_mod = solution.modulus if law != "newton" else 0.0
        self.scale = 10 * 3 * solution.viscosity * solution.flow_rate / length
        self.kinks = [0.0, *sorted(k for k in air.kinks() if 0 < k < length), length]
        self.share = 1.0
        self.work = 0.0

    def push(self, z: FloatArray, v: FloatArray) -> FloatArray:
        """Weight and drag, N/m."""
        factor, power = self.drag
        f = self.s.flow_rate / v
        a = np.sqrt(f / np.pi)
        w = self.air.velocity(np.clip(z, 0.0, self.length)) - v
        reach = (2 * a / self.air.kinematic_viscosity) ** -power
        drag = factor * np.pi * a * self.air.density * reach * np.abs(w) ** (2 - power) * np.sign(w)
        return np.asarray(self.s.density * self.gravity * f + self.share * drag)

    def speed(self, y: FloatArray) -> FloatArray:
        """v, m/s, held within the range of a double while a solver tries."""
        return np.asarray(self.v0 * np.exp(np.clip(y[0], -40.0, 40.0)))

    def slope(self, z: FloatArray, y: FloatArray) -> FloatArray:
        """Rates of the state, (state, n)."""
        self.work += np.size(z) + _CALL
        if self.work > _BUDGET:
            raise _TooLongError
        s, v = self.s, self.speed(y)
        f = s.flow_rate / v
        a = np.sqrt(f / np.pi)
        push = self.push(np.asarray(z), v)
        if self.law == "ucm":
            azz, arr = np.exp(np.clip(y[1:3], -60.0, 60.0))
            bracket = self.g_mod * (azz + 2 * arr) - s.surface_tension / (2 * a) - s.density * v * v
            rate = (self.g_mod * (azz - arr) / s.relaxation_time - v * push / f) / bracket
            return np.stack([rate / v, *self._relax(rate, v, azz, arr)])
        rows = []
        elastic: FloatArray | float = 0.0
        if self.law == "oldroyd-b":
            azz, arr = np.exp(np.clip(y[2:4], -60.0, 60.0))
            elastic = f * self.g_mod * (azz - arr)
        rate = (y[1] * self.scale - np.pi * a * s.surface_tension - elastic) / (3 * self.viscous * f)
        rows = [rate / v, (s.density * s.flow_rate * rate - push) / self.scale]
        if self.law == "oldroyd-b":
            rows += self._relax(rate, v, azz, arr)
        return np.stack(rows)

    def _relax(self, rate: FloatArray, v: FloatArray, azz: FloatArray, arr: FloatArray) -> list[FloatArray]:
        theta = self.s.relaxation_time
        return [(2 * rate - (1 - 1 / azz) / theta) / v, (-rate - (1 - 1 / arr) / theta) / v]

    def pull(self, y: FloatArray) -> FloatArray:
        """Tension less capillarity, N."""
        f = self.s.flow_rate / self.speed(y)
        if self.law == "ucm":
            return np.asarray(f * self.g_mod * (np.exp(y[1]) - np.exp(y[2])))
        return np.asarray(y[1] * self.scale - np.sqrt(np.pi * f) * self.s.surface_tension)

    def bracket(self, y: FloatArray) -> FloatArray:
        """``rho (c^2 - v^2)`` of ucm over 3 G."""
        v = self.speed(y)
        a = np.sqrt(self.s.flow_rate / (np.pi * v))
        stress = self.g_mod * (np.exp(y[1]) + 2 * np.exp(y[2]))
        return np.asarray((stress - self.s.surface_tension / (2 * a) - self.s.density * v * v) / (3 * self.g_mod))

    def ends(self, pull: float) -> Callable[[FloatArray, FloatArray], FloatArray]:
        """Boundary conditions."""

        def residual(first: FloatArray, last: FloatArray) -> FloatArray:
            end = (float(self.pull(last)) - pull) / self.scale
            if self.law == "ucm":
                return np.array([first[0], first[2] + 0.5 * first[1], end])
            if self.law == "newton":
                return np.array([first[0], end])
            return np.array([first[0], end, first[3] + 0.5 * first[2], self.entry(first)])

        return residual

    def solve(self, pull: float) -> StraightBlownJet:
        """Two-point solution: by shooting where a ucm jet forgets slowly, else by continuation in the drag (and the pull)."""
        if self.law == "ucm" and self.s.relaxation_time >= _SHOOT:
            found = self.shoot(pull)
            if found is not None:
                return found
            self.work = 0.0
        mesh = np.unique(
            np.concatenate([np.linspace(0, self.length, 81), np.geomspace(1e-4, 1, 41) * self.length, self.kinks])
        )
        states = {"newton": 2, "ucm": 3, "oldroyd-b": 4}[self.law]
        y = np.zeros((states, mesh.size))
        if self.law != "ucm":
            y[1] = np.pi * self.s.radius * self.s.surface_tension / self.scale
        reached, factor, share = 0.0, 4.0, 1e-4
        last: Any = None
        for _ in range(_MOST_STEPS):
            self.share = share
            if self.work > _BUDGET:
                break
            run = self._collocate(mesh, y, pull * share, 1e-3, 20_000)
            good = run is not None
            if good:
                last, mesh, y, reached = run, run.x, run.y, share
                if share == 1.0:
                    break
                mesh, y = _thinned(mesh, y, self.kinks)
                factor = min(factor**1.5, 30.0)
                share = min(share * factor, 1.0)
            else:
                factor = factor**0.5
                if factor < 1.0005:
                    break
                share = min(reached * factor if reached else share * 0.1, 1.0)
        self.share = 1.0
        if last is None or reached < 1.0:
            return self.stopped(last, reached)
        run = last
        for tolerance in (1e-5, 1e-6, 1e-7, 1e-8, 1e-9):
            finer = self._collocate(run.x, run.y, pull, tolerance, _MOST_NODES) if tolerance > 0.5 * self.rtol else None
            if finer is None:
                break  # the force balance decides whether what is there is good
            run = finer
        return self.profile(run.sol, run.x, abs(float(self.pull(run.y[:, -1])) - pull))

    def _collocate(self, mesh: FloatArray, y: FloatArray, pull: float, tolerance: float, nodes: int) -> Any:
        """One solve of the two-point problem; None where it did not converge."""
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            try:
                run = solve_bvp(self.slope, self.ends(pull), mesh, y, tol=tolerance, max_nodes=nodes)
            except (ValueError, np.linalg.LinAlgError, RuntimeError, _TooLongError):
                return None
        if run.status != 0 or not np.isfinite(run.y).all() or float(np.abs(run.y[0]).max()) > 35:
            return None
        if self.law == "ucm" and float(self.bracket(run.y).min()) <= 0:
            return None
        return run

    def stopped(self, last: Any, reached: float) -> StraightBlownJet:
        """Why the continuation ended."""
        if last is not None and self.law == "ucm":
            left = float(self.bracket(last.y).min() / np.exp(np.abs(last.y[1])).max())
            if left < 0.05:
                where = float(last.x[int(np.argmin(self.bracket(last.y)))]) * 1e3
                return self.nothing(
                    "critical",
                    f"at {reached:.3g} of the drag the jet comes to its elastic wave speed at {where:.4g} mm; "
                    "take a solvent viscosity (oldroyd-b) or a longer relaxation time",
                )
        if self.work > _BUDGET:
            return self.nothing(
                "slack", f"the solver has used up its budget at {reached:.3g} of the drag: no profile is given"
            )
        return self.nothing("slack", f"no straight jet is found beyond {reached:.3g} of the drag")

    def entry(self, first: FloatArray) -> float:
        """What keeps a boundary layer of the solvent's away from the nozzle: it enters at ucm's rate."""
        s, v = self.s, self.speed(first)
        f = s.flow_rate / v
        a = np.sqrt(f / np.pi)
        azz, arr = np.exp(np.clip(first[2:4], -60.0, 60.0))
        bracket = self.g_mod * (azz + 2 * arr) + 3 * self.viscous / s.relaxation_time
        rate = (
            self.g_mod * (azz - arr) / s.relaxation_time - v * self.push(np.zeros(1), np.atleast_1d(v))[0] / f
        ) / bracket
        solvent = first[1] * self.scale - np.pi * a * s.surface_tension - f * self.g_mod * (azz - arr)
        return float((solvent - 3 * self.viscous * f * rate) / self.scale)

    def shoot(self, pull: float) -> StraightBlownJet | None:
        """Ucm by the inlet stretch that gives the end's pull; None where no bracket is found or the march is too touchy."""

        def miss(log_stretch: float) -> float:
            pieces, ended = self.pieces(log_stretch)
            if ended:
                return 1e9 if ended == "critical" and pieces else -1e9
            return float(self.pull(pieces[-1].y[:, -1]) - pull) / self.scale

        z = np.linspace(0.0, self.length, 400)
        whole = abs(float(np.trapezoid(self.push(z, np.full(z.size, 5 * self.v0)), z)))
        area = np.pi * self.s.radius**2
        high = float(np.log1p(4 * (whole + abs(pull)) / (area * self.g_mod)))
        low = high
        for _ in range(12):  # downwards, where marches are smooth
            if miss(low) < 0:
                break
            high, low = low, low - 0.4
        else:
            return None
        if low == high:
            return None
        root = float(brentq(miss, low, high, xtol=1e-15, rtol=8.9e-16, maxiter=200))
        if abs(miss(root)) * self.scale > 1e-6 * abs(float(self.pull(np.array([0.0, root, -0.5 * root])))):
            return None
        out = self.march(float(np.exp(root)))
        return out if out.z.size else None

    def march(self, inlet_stretch: float) -> StraightBlownJet:
        """Ucm from a given A_zz at the nozzle."""
        pieces, ended = self.pieces(float(np.log(inlet_stretch)))
        if ended:
            where = pieces[-1].t[-1] * 1e3 if pieces else 0.0
            return self.nothing(
                "critical" if ended == "critical" else "slack", f"the march ends at {where:.4g} mm ({ended})"
            )

        def at(z: FloatArray) -> FloatArray:
            out = np.empty((3, np.size(z)))
            for run in pieces:
                inside = (z >= run.t[0]) & (z <= run.t[-1])
                if inside.any():
                    out[:, inside] = run.sol(z[inside])
            return out

        return self.profile(at, np.concatenate([run.t for run in pieces]), 0.0)

    def pieces(self, log_stretch: float) -> tuple[list[Any], str]:
        """Marches between the air's kinks, and what ended them early ("": nothing)."""
        y = np.array([0.0, log_stretch, -0.5 * log_stretch])
        if float(self.bracket(y)) <= 0:
            return [], "critical"

        def critical(z: float, y: FloatArray) -> float:
            return float(self.bracket(y)) - 1e-6

        def slow(z: float, y: FloatArray) -> float:
            return float(y[0]) + 12.0

        calls = 0

        def counted(z: Any, y: Any) -> Any:
            nonlocal calls
            calls += 1
            if calls > _MOST_CALLS:
                raise _TooLongError
            return self.slope(z, y)

        critical.terminal = slow.terminal = True  # type: ignore[attr-defined]
        pieces: list[Any] = []
        for low, high in pairwise(self.kinks):
            try:
                run = solve_ivp(
                    counted,
                    (low, high),
                    y,
                    method="DOP853",
                    rtol=max(self.rtol * 1e-2, 1e-12),
                    atol=1e-12,
                    events=[critical, slow],
                    dense_output=True,
                )
            except _TooLongError:
                return pieces, "stiff"
            pieces.append(run)
            y = run.y[:, -1]
            if run.status != 0:
                return pieces, "critical" if run.t_events and len(run.t_events[0]) else "slack"
        return pieces, ""

    def nothing(self, verdict: Verdict, message: str) -> StraightBlownJet:
        """A verdict without a profile."""
        e = np.empty(0)
        return StraightBlownJet(e, e, e, e, e, e, e, e, e, verdict, message, float("nan"), float("nan"))

    def profile(self, at: Callable[[FloatArray], FloatArray], steps: FloatArray, miss: float) -> StraightBlownJet:
        """Fields of a solution, its verdict and its force balance."""
        s = self.s
        parts = [np.linspace(low, high, _POINTS) for low, high in pairwise(self.kinks)]
        z = np.unique(np.concatenate([*parts, np.geomspace(1e-4, 1, _POINTS) * self.length]))
        y = at(z)
        v = self.speed(y)
        f = s.flow_rate / v
        a = np.sqrt(f / np.pi)
        capillary = np.pi * a * s.surface_tension
        ones = np.ones_like(z)
        azz, arr = np.exp(y[-2:]) if self.law != "newton" else (ones, ones)
        tension = self.pull(y) + capillary
        stress = (tension - capillary) / f
        air = self.air.velocity(z)
        wave = (stress + s.surface_tension / a - self.air.density * (air - v) ** 2) / s.density
        largest = float(np.abs(tension).max())
        balance = max(self.balance(at, np.unique(steps)), miss / max(largest, 1e-300))
        if not balance <= 1e-6:
            return self.nothing("slack", f"the force balance closes to {balance:.2g} only: no profile is given")
        verdict: Verdict = "converged"
        message = ""
        negative = np.flatnonzero(stress < -1e-6 * np.abs(stress).max())
        if negative.size:
            verdict = "compressed"
            place = f"from {z[negative[0]] * 1e3:.5g} mm on (lowest stress {stress.min():.4g} Pa)"
            message = f"the jet is in compression {place}: a straight jet does not exist there"
            warnings.warn(message, SpinlineWarning, stacklevel=4)
        start = _first_above(z, wave)
        return StraightBlownJet(z, v, a, air, tension, stress, azz, arr, wave, verdict, message, balance, start)

    def balance(self, at: Callable[[FloatArray], FloatArray], steps: FloatArray) -> float:
        """Momentum integrated by Gauss-Legendre on the solver's own steps, against the tensions at the ends."""
        nodes, weights = gauss(8)
        low, high = steps[:-1, None], steps[1:, None]
        z = (0.5 * (low + high) + 0.5 * (high - low) * nodes).ravel()
        weight = (0.5 * (high - low) * weights).ravel()
        total = float(np.sum(weight * self.push(z, self.speed(at(z)))))
        first, last = at(steps[[0]])[:, 0], at(steps[[-1]])[:, 0]
        ends = []
        for y in (first, last):
            capillary = np.sqrt(np.pi * self.s.flow_rate / self.speed(y)) * self.s.surface_tension
            ends.append(float(self.pull(y) + capillary))
        inertia = float(self.s.density * self.s.flow_rate * (self.speed(last) - self.speed(first)))
        largest = max(abs(ends[0]), abs(ends[1]), abs(total), abs(inertia))
        return abs(ends[1] - ends[0] + total - inertia) / largest if largest else 0.0


def _thinned(mesh: FloatArray, y: FloatArray, kinks: list[float]) -> tuple[FloatArray, FloatArray]:
    """Every other node of a mesh that has grown large, kinks kept."""
    if mesh.size < 400:
        return mesh, y
    keep = np.isin(mesh, kinks)
    keep[::2] = True
    return mesh[keep], y[:, keep]


class _TooLongError(Exception):
    """A march that takes too many steps."""


def _first_above(z: FloatArray, value: FloatArray) -> float:
    """First place where the value becomes positive, linear between points; NaN if nowhere."""
    above = np.flatnonzero(value > 0)
    if not above.size:
        return float("nan")
    k = int(above[0])
    if k == 0:
        return float(z[0])
    share = -value[k - 1] / (value[k] - value[k - 1])
    return float(z[k - 1] + share * (z[k] - z[k - 1]))
