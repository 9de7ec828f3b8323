"""The bead chain in time, Eq. (32a) in full: every strand of the network, from the nozzle to the far end.

::

    I x_n'' = V(x_n, t) - x_n' + (eps / h) [T(w_ahead) - T(w_behind)],   w = distance of neighbours / h
    eps = c / alpha_v,   T(w) = f(w / V_S) / f_0  (linear springs: T = w)

Beads leave the nozzle (x = 0) with V = 1, one every h; the far end is free: tension T(1). The bead just
beyond ``x = length`` keeps that share of its drag which its strand has still inside, so leaving takes no event.

How it is solved: unknowns are the tensions of the strands and the ages ``b(x) = int dx / U`` of the beads, U the speed
of the steady network where there is one, else V (`chain_reference`): a settled bead ages at exactly one, whatever the
jet. Implicit, second order (`chain_step`), one tridiagonal system a Newton iteration, O(N) a step.
The step follows the accuracy of the slip alone, not the entries: a step may pass thousands of beads.

The stretch of a strand belongs to its midpoint; given to a bead it errs by ``h w w' / 2``.

Validity: while ``eps V' < 1/4``; beyond, no steady state exists and the inlet stretch grows. The layer of the free end
(``eps w`` wide) is stable but not resolved in time: errors are controlled in (0, accurate_to]. With a jump of V at
the nozzle (slip of the first bead) or a strong pull there, steps shrink to h, which is slow but right.

References
----------
Greenfeld et al., Phys. Rev. E 84, 041806 (2011); review Eqs. (32)-(33).
"""

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from time import monotonic

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.network._objects import instance
from spinline.network.chain.flow import Segment
from spinline.network.chain.model import Chain, ChainError
from spinline.network.chain.profile import ChainProfile, profile
from spinline.network.chain.reference import steady_reference
from spinline.network.chain.state import ChainState, affine_start, empty_start, load_states, save_states
from spinline.network.chain.step import Room, advance, with_rates

__all__ = ["ChainResult", "Progress", "run_chain"]

Progress = Callable[[ChainState], None]

_SAFETY, _LEAST_FACTOR, _MOST_FACTOR = 0.85, 0.2, 4.0
_SMALLEST = 1e-9  # of one spacing: no step below
_SHARE = 0.1  # of the tolerance, for one step: what beads see at a locking front adds up
_MOST_STEP = 0.01  # of the residence time: the estimate of the error needs to see the flow


@dataclass(frozen=True, eq=False)
class ChainResult:
    """What a run gives.

    Attributes
    ----------
    chain : Chain
    state : ChainState
        The chain at the end; its `steps`, `rejected` and `iterations` tell the cost.
    snapshots : list of ChainState
        At the times asked for.
    """

    chain: Chain
    state: ChainState
    snapshots: list[ChainState]

    @property
    def profile(self) -> ChainProfile:
        """Stretch, tension and extension along the chain at the end."""
        return profile(self.chain, self.state)

    @property
    def profiles(self) -> list[ChainProfile]:
        """The same at the times asked for."""
        return [profile(self.chain, state) for state in self.snapshots]

    def stretch_at(self, position: ArrayLike) -> FloatArray:
        """Local stretch w at positions (initial radii), see `ChainProfile.stretch_at`; NaN outside the chain."""
        return self.profile.stretch_at(position)


def run_chain(
    chain: Chain,
    until: float,
    *,
    start: ChainState | str = "empty",
    rtol: float = 1e-4,
    time_step: float | None = None,
    accurate_to: float | None = None,
    output_times: ArrayLike = (),
    progress: Progress | bool = False,
    checkpoint: str | Path | None = None,
    checkpoint_seconds: float = 30.0,
    most_steps: int = 10_000_000,
) -> ChainResult:
    """Follow a bead chain in time.

    Parameters
    ----------
    chain : Chain
    until : float
        End, units of r_0 / v_0, > time of the start.
    start : ChainState or {"empty", "affine"}
        "empty": the first bead at the nozzle; "affine": beads along the whole jet, as the flow alone would put them.
    rtol : float
        Error of the stretch, roughly: what is controlled is the local error of the velocities of the beads relative to
        the jet's, root mean square, to a tenth of `rtol` (calibrated on fronts of locking); in [1e-10, 0.1].
    time_step : float, optional
        A fixed step in place of the adaptive one (no error control).
    accurate_to : float, optional
        End of the part whose error is controlled, initial radii; 0.95 of the jet by default.
    output_times : array_like
        Times, increasing, of the snapshots; steps end there.
    progress : bool or callable
        True draws a bar; a callable gets each accepted state.
    checkpoint : path, optional
        File to write while running; where it exists, the run goes on from there, bit for bit as if never stopped.
    checkpoint_seconds : float
        Wall time between writings, >= 0.
    most_steps : int
        Give up beyond, with `ChainError`.

    Returns
    -------
    ChainResult

    Raises
    ------
    InputError
        For arguments out of range.
    ChainError
        Where the step becomes too small or the steps too many.

    Notes
    -----
    About 0.1 to 0.4 us per bead and step with linear springs, 0.3 to 0.6 us with bounded laws; 300 bytes per bead. Bounded
    laws with inertia can end in `ChainError` where a slack part locks at speed: the impact has no width in time.
    """
    instance("chain", chain, Chain, remedy="make one with spinline.network.Chain")
    tolerance = number("rtol", rtol, least=1e-10, most=0.1)
    most = number("most_steps", most_steps, least=1)
    seconds = number("checkpoint_seconds", checkpoint_seconds, least=0.0)
    fixed = None if time_step is None else positive("time_step", time_step)
    watch = 0.95 * chain.flow.length if accurate_to is None else positive("accurate_to", accurate_to, "r_0")
    if not (isinstance(progress, bool) or callable(progress)):
        raise InputError("progress", "is neither a bool nor a function", value=type(progress).__name__)
    if not (checkpoint is None or isinstance(checkpoint, str | Path)):
        raise InputError("checkpoint", "is not a path", value=type(checkpoint).__name__)
    state = _start(chain, start)
    end = number("until", until, above=state.time)
    outputs = real("output_times", output_times, least=state.time, most=end).ravel()
    if np.any(np.diff(outputs) <= 0):
        raise InputError("output_times", "must increase", value=outputs.tolist())
    key = f"{chain.fingerprint()} {end!r} {tolerance!r} {fixed!r} {watch!r} {outputs.tolist()!r}"
    snapshots: list[ChainState] = []
    spans: dict[int, Segment] = {}
    room = Room()
    if checkpoint is not None and Path(checkpoint).exists():
        *snapshots, state = load_states(checkpoint, key)
    # Newton's error stays small against the local error, above the rounding of positions
    fine = max(1e-3 * tolerance, 64 * np.finfo(float).eps * chain.flow.length / chain.step)
    with ExitStack() as stack:
        report = stack.enter_context(_bar(state.time, end)) if progress is True else (progress or None)
        last_write = monotonic()
        while True:
            if len(snapshots) < outputs.size and state.time >= outputs[len(snapshots)]:
                snapshots.append(state)
            if report is not None:
                report(state)
            if state.time >= end:
                break
            if state.steps >= most:
                raise ChainError(f"chain: {most_steps} steps at time {state.time:g}; raise most_steps or rtol")
            barrier = min([end, *outputs[outputs > state.time][:1].tolist()])
            state = _next(chain, spans, room, state, barrier, fixed, watch, _SHARE * tolerance, fine)
            if checkpoint is not None and monotonic() - last_write >= seconds:
                save_states(checkpoint, [*snapshots, state], key)
                last_write = monotonic()
    if checkpoint is not None:
        save_states(checkpoint, [*snapshots, state], key)
    return ChainResult(chain, state, snapshots)


def _start(chain: Chain, start: ChainState | str) -> ChainState:
    if isinstance(start, ChainState):
        return start
    if not isinstance(start, str):
        start = type(start).__name__
    if start == "empty":
        if not chain.entry:
            raise InputError("start", "must hold beads where none enter", value=start, remedy='use "affine"')
        return empty_start(chain)
    if start == "affine":
        return affine_start(chain)
    raise InputError("start", "is not known", value=start, allowed='"empty", "affine" or a ChainState')


def _next(
    chain: Chain,
    spans: dict[int, Segment],
    room: Room,
    state: ChainState,
    barrier: float,
    fixed: float | None,
    watch: float,
    rtol: float,
    fine: float,
) -> ChainState:
    """One accepted step; `spans` keeps the references found."""
    number = int(np.searchsorted(chain.flow.times, state.time, side="right"))
    if number not in spans:
        spans[number] = steady_reference(chain, chain.flow.segment(state.time))
    span = spans[number]
    if state.span != number:
        state = with_rates(chain, span, number, state)
    largest = _MOST_STEP * float(-chain.flow.age[-1, 0])
    first = chain.step if chain.entry else max(chain.step, 0.1 * largest)  # too long a one is found out, and shortened
    dt = fixed or state.next_step or first
    barrier = min(barrier, span.end)
    rejected, iterations = 0, 0
    while True:
        time = _landing(chain, state.time, dt, barrier, aligned=fixed is None)
        if not time > state.time:
            raise ChainError(
                f"chain: step of {dt:.1e} at time {state.time:g} is lost in rounding; raise rtol or spacing"
            )
        after, error, count = advance(chain, span, state, time, watch, fine, room)
        iterations += count
        taken = time - state.time
        if after is not None and fixed is None and _turned(chain, after):
            after = None
        # an error of position far below a spacing is no error of stretch: a bead may be kicked as it enters
        allowed = max(rtol, 0.1 * rtol * chain.step / taken)
        if after is not None and (fixed is not None or error <= allowed):
            factor = min(_MOST_FACTOR, _SAFETY * (allowed / error) ** 0.5) if error > 0 else _MOST_FACTOR
            # a step cut short by a barrier says little about the next one
            proposal = max(taken * max(factor, _LEAST_FACTOR), dt if taken < dt and factor >= 1 else 0.0)
            return replace(
                after,
                next_step=min(proposal, largest),
                steps=state.steps + 1,
                rejected=state.rejected + rejected,
                iterations=state.iterations + iterations,
            )
        rejected += 1
        if fixed is not None:
            raise ChainError(f"chain: no solution at time {time:g} with time_step = {fixed:g}; shorten it")
        shrink = 0.25 if after is None else min(max(_SAFETY * (allowed / error) ** 0.5, _LEAST_FACTOR), 0.7)
        dt = taken * shrink
        if not dt > _SMALLEST * chain.step:
            raise ChainError(
                f"chain: step below {dt:.1e} at time {state.time:g} (local error {error:.1e} against rtol = {rtol:g}); "
                "raise rtol, or end `accurate_to` before the free end's layer"
            )


def _turned(chain: Chain, state: ChainState) -> bool:
    """Whether beads without mass are out of order: the flow and the strands keep them in it, an error turns them."""
    return not chain.inertia and bool((state.positions[1:] >= state.positions[:-1]).any())


def _landing(chain: Chain, time: float, dt: float, barrier: float, *, aligned: bool) -> float:
    """End of a step: not beyond the barrier, and on an entry where it passes one."""
    if aligned and chain.entry:
        h = chain.step
        entry = h * np.floor((time + dt) / h + 1e-9)
        following = h * (np.floor(time / h + 1e-9) + 1)
        if entry > time + 1e-9 * h:
            dt = float(entry) - time
        elif time + 2 * dt > following:
            dt = 0.5 * (float(following) - time)
        target = float(entry) if entry > time + 1e-9 * h else time + dt
    else:
        target = time + dt
    if target >= barrier - 1e-9 * chain.step:
        return barrier
    return target


class _bar:
    """A progress bar of the time reached."""

    def __init__(self, begin: float, end: float) -> None:
        from rich.progress import Progress as Bar

        self._bar = Bar(transient=True)
        self._begin, self._end = begin, end

    def __enter__(self) -> Progress:
        self._bar.start()
        task = self._bar.add_task("chain", total=self._end - self._begin)

        def show(state: ChainState) -> None:
            text = f"chain, {state.positions.size} beads"
            self._bar.update(task, completed=state.time - self._begin, description=text)

        return show

    def __exit__(self, *_: object) -> None:
        self._bar.stop()
