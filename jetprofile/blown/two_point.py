"""The equations of a straight blown jet and the ways they are solved: see `straight` for what they say.

Newton by collocation and continuation in the drag; with a solvent by `viscous_profile`; ucm by shooting where it forgets
slowly, else as the limit of ever less solvent. Every profile that leaves here closes its force balance to 1e-6.
"""

import warnings
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import brentq

from spinline.base.checks import FloatArray, number
from spinline.base.errors import SpinlineWarning
from spinline.base.quadrature import gauss
from spinline.jetprofile.blown._profile_kernels import CONSTANTS
from spinline.jetprofile.blown.air import Air
from spinline.jetprofile.blown.straight_results import BlownSolution, Law, StraightBlownJet, Verdict
from spinline.jetprofile.blown.viscous_profile import ViscousProblem, ViscousProfile, solve_viscous

__all__ = ["TwoPoint"]

_POINTS = 400
_MOST_STEPS, _MOST_NODES = 80, 60_000
_UNFOUND = (
    "the solver gave up, which does not show that there is no jet: try a little less air speed or relaxation time"
)
_MOST_CALLS = 12_000  # of one march
_BUDGET, _CALL = 1e8, 200  # places evaluated in all, and what a call counts beside them
_SHOOT = 8e-4  # s: relaxation times from which shooting is tried first


class TwoPoint:
    """One jet as a two-point problem, drag times `share`.

    State: ln v/v_0, then F (in scale) where there is a viscosity, then ln B_zz, ln B_rr where there is elasticity: B = h A.
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
        rate = (y[1] * self.scale - np.pi * a * s.surface_tension) / (3 * s.viscosity * f)
        return np.stack([rate / v, (s.density * s.flow_rate * rate - push) / self.scale])

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
            return np.array([first[0], end])

        return residual

    def solve(self, pull: float) -> StraightBlownJet:
        """Two-point solution."""
        if self.law in ("oldroyd-b", "fene-p"):
            return self.with_solvent(pull)
        if self.law == "ucm":
            found = self.shoot(pull) if self.s.relaxation_time >= _SHOOT else None
            if found is not None:
                return found
            self.work = 0.0
            return self.without_solvent(pull)
        return self.newtonian(pull)

    def newtonian(self, pull: float) -> StraightBlownJet:
        """By continuation in the drag and the pull."""
        mesh = np.unique(
            np.concatenate([np.linspace(0, self.length, 81), np.geomspace(1e-4, 1, 41) * self.length, self.kinks])
        )
        y = np.zeros((2, mesh.size))
        y[1] = np.pi * self.s.radius * self.s.surface_tension / self.scale
        reached, factor, share = 0.0, 4.0, 1e-4
        last: Any = None
        for _ in range(_MOST_STEPS):
            self.share = share
            if self.work > _BUDGET:
                break
            run = self._collocate(mesh, y, pull * share, 1e-3, 20_000)
            if run is not None:
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
            return self.unfound(f"no straight jet is found beyond {reached:.3g} of the drag")
        return self.finished(last, pull)

    def finished(self, run: Any, pull: float) -> StraightBlownJet:
        """The same collocation to ever finer tolerances, down to what is asked for."""
        for tolerance in (1e-5, 1e-6, 1e-7, 1e-8, 1e-9):
            finer = self._collocate(run.x, run.y, pull, tolerance, _MOST_NODES) if tolerance > 0.5 * self.rtol else None
            if finer is None:
                break  # the force balance decides whether what is there is good
            run = finer
        return self.profile(run.sol, run.x, abs(float(self.pull(run.y[:, -1])) - pull))

    def viscous(self, pull: float, solvent: float, *, drawn: bool) -> ViscousProblem:
        """The problem with a solvent viscosity; `drawn`: it enters by an elastic jump, as without solvent."""
        s = self.s
        constants = {
            "flow_rate": s.flow_rate,
            "initial_velocity": self.v0,
            "density": s.density,
            "gravity": self.gravity,
            "surface_tension": s.surface_tension,
            "modulus": (s.viscosity - solvent) / s.relaxation_time,
            "relaxation_time": s.relaxation_time,
            "solvent_viscosity": solvent,
            "inverse_extensibility": 1 / s.extensibility if self.law == "fene-p" else 0.0,
            "drag_factor": self.drag[0],
            "drag_power": self.drag[1],
            "air_density": self.air.density,
            "air_viscosity": self.air.kinematic_viscosity,
            "share": 1.0,
            "scale": self.scale,
            "drawn": float(drawn),
        }
        row = np.array([constants[name] for name in CONSTANTS])
        return ViscousProblem(row, lambda z: self.air.velocity(np.clip(z, 0.0, self.length)), tuple(self.kinks), pull)

    def with_solvent(self, pull: float) -> StraightBlownJet:
        """Oldroyd-B and FENE-P."""
        problem = self.viscous(pull, self.s.solvent_viscosity, drawn=False)
        found = solve_viscous(problem, max(10 * self.rtol, 1e-10))
        if found.reached < 1:
            return self.unfound(f"no straight jet is found beyond {found.reached:.3g} of the way to it")
        curve = found.curve(problem)
        return self.profile(lambda z: curve(z).T, found.z, 0.0)

    def without_solvent(self, pull: float) -> StraightBlownJet:
        """Ucm as the limit of ever less solvent, then by collocation."""
        shares = (0.1, 0.03, 0.01, 3e-3, 1e-3) if self.s.relaxation_time < _SHOOT else (3e-3, 1e-3)
        found: ViscousProfile | None = None
        for share in shares:
            problem = self.viscous(pull, share * self.s.viscosity, drawn=True)
            nearer = solve_viscous(problem, 1e-5, near=found)
            if nearer.reached < 1:
                break
            found = nearer
        if found is None:
            return self.unfound("no straight jet is found, with or without solvent")
        y = found.y.T[[0, 2, 3]]
        fast = np.flatnonzero(self.bracket(y) < 0)
        if fast.size:
            k = fast[0]
            v = float(self.speed(y[:, k]))
            a = np.sqrt(self.s.flow_rate / (np.pi * v))
            slack = self.s.surface_tension / (2 * a) > self.s.density * v * v
            why = (
                "capillarity is more than its elasticity holds" if slack else "the jet is faster than its elastic waves"
            )
            remedy = "and the end has no say; take a solvent viscosity (oldroyd-b, fene-p)"
            return self.nothing("critical", f"from {found.z[k] * 1e3:.4g} mm on {why}, {remedy}")
        run = self._collocate(found.z, y, pull, 1e-3, 20_000)
        if run is None:
            return self.unfound("jets with ever less solvent have no limit that is found")
        return self.finished(run, pull)

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

    def unfound(self, message: str) -> StraightBlownJet:
        """No profile because the solver has none, in words that do not blame the jet."""
        return self.nothing("slack", f"{message}; {_UNFOUND}")

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
        if self.law == "fene-p":
            spring = 1 + (azz + 2 * arr - 3) / s.extensibility
            azz, arr = azz / spring, arr / spring
        tension = self.pull(y) + capillary
        stress = (tension - capillary) / f
        air = self.air.velocity(z)
        wave = (stress + s.surface_tension / a - self.air.density * (air - v) ** 2) / s.density
        largest = float(np.abs(tension).max())
        balance = max(self.balance(at, np.unique(steps)), miss / max(largest, 1e-300))
        if not balance <= 1e-6:
            return self.unfound(f"the force balance closes to {balance:.2g} only: no profile is given")
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
