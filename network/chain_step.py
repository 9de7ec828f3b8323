"""One implicit time step of the bead chain: TR-BDF2 in the age of the beads.

The trapezoidal rule to ``t + gamma dt``, gamma = 2 - sqrt 2, then the second backward difference to ``t + dt``:
second order, L-stable, both stages with the same matrix; a third-order companion gives the local error (Hosea and
Shampine, Appl. Numer. Math. 20, 21 (1996)). The rates of a stage are read off its own equation, never from stiff forces.

A step may pass many entries. A bead still in the nozzle at the time of a stage is held there, at V = 1.
"""

import math
from dataclasses import replace

import numpy as np

from spinline.checks import FloatArray
from spinline.network import _chain_kernels as kernels
from spinline.network import _flow_kernels as look
from spinline.network.chain_model import Chain
from spinline.network.chain_state import ChainState
from spinline.network.flow import Segment
from spinline.network.force_laws import law_code

__all__ = ["advance", "with_rates"]

_GAMMA = 2 - math.sqrt(2)
_D = _GAMMA / 2
_W = math.sqrt(2) / 4
_ERROR = ((4 * _W - 1) / 3, -1 / 3, 2 * _D / 3)  # second-order weights less third-order ones
_SLACK = 1e-9  # of one spacing: entries this near to a time count as at that time
_MOST_ITERATIONS = 30


def with_rates(chain: Chain, span: Segment, number: int, state: ChainState) -> ChainState:
    """Rates of a state from the equation of motion itself: at a start, and where the flow has a corner in time."""
    velocities = state.velocities.copy()
    rates, surplus = np.empty_like(velocities), np.empty_like(velocities)
    kernels.rates(
        *_tables(span),
        span.share(state.time),
        state.positions,
        state.tensions,
        velocities,
        _released(chain, state.newest, velocities.size, state.time, inclusive=True),
        chain.elasticity / chain.step,
        float(chain.inertia),
        chain.flow.length,
        chain.rest_tension,
        rates,
        surplus,
    )
    return replace(state, velocities=velocities, rates=rates, surplus=surplus, span=number)


def advance(
    chain: Chain, span: Segment, state: ChainState, time: float, watch: float, tolerance: float
) -> tuple[ChainState | None, float, int]:
    """Step to a new time within one span of the flow.

    Parameters
    ----------
    chain, span, state
        The chain, the flow now, the state with valid rates.
    time : float
        End of the step.
    watch : float
        Beads in (0, watch] count in the error.
    tolerance : float
        Of Newton's method, in units of the spacing.

    Returns
    -------
    tuple
        The new state (None where Newton's method fails), the local error in position over the local velocity per
        unit of time, and the Newton iterations.
    """
    dt = time - state.time
    begin = _with_entries(chain, span, state, time)
    tables, n, h = _tables(span), begin.positions.size, chain.step
    age = np.empty(n)
    look.ages_of(*tables, begin.positions, age)
    inertia, pull = float(chain.inertia), chain.elasticity / h
    work = np.empty((7, n))
    left = np.zeros(1, dtype=np.int64)  # beads that have left at the far end: for good
    g = _D * dt

    def stage(
        at: float, known: FloatArray, push: FloatArray, guess: FloatArray, tension: FloatArray
    ) -> tuple[int, int, FloatArray]:
        x = np.empty(n)
        look.positions_of(*tables, guess, x)
        free = _released(chain, begin.newest, n, at)
        x[free:] = at - h * (begin.newest - n + 1 + np.arange(free, n))
        count = kernels.solve_stage(
            *tables, span.share(at), x, tension, known, push, free, g, pull, inertia, h, chain.flow.length,
            law_code(chain.law), chain.contour or 1.0, chain.rest_force, chain.rest_tension,
            tolerance, _MOST_ITERATIONS, left, work,
        )  # fmt: skip
        return count, free, x

    def found(known: FloatArray, push: FloatArray, x: FloatArray, free: int) -> FloatArray:
        out = np.empty((5, n))  # age, rate, velocity, surplus, reference V
        look.stage_rates(*tables, x, known, push, free, g, inertia, out[0], out[1], out[2], out[3], out[4])
        return out

    tension = begin.tensions.copy()
    known, push = age + g * begin.rates, inertia * begin.velocities + g * begin.surplus
    first, free, x = stage(state.time + _GAMMA * dt, known, push, age + 2 * g * begin.rates, tension)
    if first < 0:
        return None, math.inf, _MOST_ITERATIONS
    age2, rate2, _, surplus2, _ = found(known, push, x, free)

    known = age + dt * _W * (begin.rates + rate2)
    push = inertia * begin.velocities + dt * _W * (begin.surplus + surplus2)
    rest = 1 - _GAMMA
    guess = age2 + dt * rest * (rate2 + (rate2 - begin.rates) * (rest / (2 * _GAMMA)))
    second, free, x = stage(time, known, push, guess, tension)
    if second < 0:
        return None, math.inf, first + _MOST_ITERATIONS
    _, rate3, velocity, surplus3, speed = found(known, push, x, free)

    defect = dt * (_ERROR[0] * begin.rates + _ERROR[1] * rate2 + _ERROR[2] * rate3) * speed
    defect[free:] = 0.0
    error = kernels.error_norm(x, defect, speed, int(left[0]), watch, work) / dt
    if inertia > 0:
        wrong = dt * (_ERROR[0] * begin.surplus + _ERROR[1] * surplus2 + _ERROR[2] * surplus3) / (inertia + g)
        seen = (x > 0) & (x <= watch)
        if seen.any():
            error = max(error, float(np.max(np.abs(wrong[seen] / speed[seen]))))
    end = replace(begin, time=time, positions=x, tensions=tension, velocities=velocity, rates=rate3, surplus=surplus3)
    return _without(end, int(left[0])), error, first + second


def _tables(span: Segment) -> tuple[FloatArray, FloatArray, FloatArray]:
    return span.nodes, span.age, span.slowness


def _released(chain: Chain, newest: int, size: int, time: float, *, inclusive: bool = False) -> int:
    """How many of the beads have left the nozzle."""
    if not chain.entry:
        return size
    passed = time / chain.step
    last = math.floor(passed + _SLACK) if inclusive else math.ceil(passed - _SLACK) - 1
    return min(max(size - (newest - last), 0), size)


def _with_entries(chain: Chain, span: Segment, state: ChainState, until: float) -> ChainState:
    """Lengthen the chain by the beads that the step will pass, and release the one just at x = 0."""
    if not chain.entry:
        return state
    more = max(math.floor(until / chain.step + _SLACK) + 1 - state.newest, 0)
    free = _released(chain, state.newest, state.positions.size, state.time, inclusive=True)
    held = _released(chain, state.newest, state.positions.size, state.time)
    number = state.newest + 1 + np.arange(more)
    slow = span.slowness[1, 0]
    wait = np.zeros(more)
    longer = replace(
        state,
        newest=state.newest + more,
        positions=np.concatenate((state.positions, state.time - chain.step * number)),
        tensions=np.concatenate((state.tensions, np.full(more, chain.rest_tension))),
        velocities=np.concatenate((state.velocities, 1 + wait)),
        rates=np.concatenate((state.rates, slow + wait)),
        surplus=np.concatenate((state.surplus, wait)),
    )
    for i in range(held, free):  # at most the one bead at x = 0
        ahead = longer.tensions[i - 1] if i else chain.rest_tension
        share = span.share(state.time)
        flow = share / span.slowness[1, 0] + (1 - share) / span.slowness[0, 0]
        drag = flow + chain.elasticity / chain.step * (ahead - longer.tensions[i])
        if chain.inertia:
            longer.surplus[i] = drag - longer.velocities[i]
        else:
            longer.velocities[i], longer.rates[i] = drag, drag * slow
    return longer


def _without(state: ChainState, left: int) -> ChainState:
    """Drop the beads that have left; at least one strand stays."""
    gone = min(left, state.positions.size - 2)
    if gone <= 0:
        return state
    return replace(
        state,
        positions=state.positions[gone:].copy(),
        tensions=state.tensions[gone:].copy(),
        velocities=state.velocities[gone:].copy(),
        rates=state.rates[gone:].copy(),
        surplus=state.surplus[gone:].copy(),
    )
