"""One implicit time step of the bead chain: TR-BDF2 in the age of the beads.

The trapezoidal rule to ``t + gamma dt``, gamma = 2 - sqrt 2, then the second backward difference to ``t + dt``:
second order, L-stable, both stages with the same matrix; a third-order companion gives the local error (Hosea and
Shampine, Appl. Numer. Math. 20, 21 (1996)). The rates of a stage are read off its own equation, never from stiff forces.

A step may pass many entries. A bead still in the nozzle at the time of a stage is held there, at V = 1.
"""

import math
from dataclasses import replace

import numpy as np

from spinline.base.checks import FloatArray
from spinline.network.chain import _kernels as kernels
from spinline.network.chain.flow import Segment
from spinline.network.chain.model import Chain
from spinline.network.chain.state import ChainState
from spinline.network.force_laws import law_code

__all__ = ["Room", "advance", "with_rates"]

_GAMMA = 2 - math.sqrt(2)
_SLACK = 1e-9  # of one spacing: entries this near to a time count as at that time
_MOST_ITERATIONS = 30


class Room:
    """Scratch arrays that grow with the chain."""

    def __init__(self) -> None:
        self._room = np.empty(0)

    def of(self, size: int) -> FloatArray:
        """Scratch for that many beads: rows without gaps, for which alone the kernels are compiled."""
        if self._room.size < kernels.ROWS * size:
            self._room = np.empty(kernels.ROWS * (size + size // 8))
        return self._room[: kernels.ROWS * size].reshape(kernels.ROWS, size)


def with_rates(chain: Chain, span: Segment, number: int, state: ChainState) -> ChainState:
    """Rates of a state from the equation of motion itself: at a start, and where the flow has a corner in time."""
    velocities = state.velocities.copy()
    rates, surplus = np.empty_like(velocities), np.empty_like(velocities)
    edges, _, cells = span.packed
    kernels.rates(
        edges,
        cells,
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
    chain: Chain, span: Segment, state: ChainState, time: float, watch: float, tolerance: float, room: Room
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
    room : Room
        Scratch arrays.

    Returns
    -------
    tuple
        The new state (None where Newton's method fails), the local error (root mean square over the beads of the error
        in position over the local velocity, per unit of time), and the Newton iterations.
    """
    begin = _with_entries(chain, span, state, time)
    n = begin.positions.size
    middle = state.time + _GAMMA * (time - state.time)
    tension = begin.tensions.copy()
    x, velocity, rate, surplus = (np.empty(n) for _ in range(4))
    count, left, error = kernels.step(
        *span.packed,
        (span.share(middle), span.share(time)),
        (state.time, middle, time),
        begin.newest,
        (_released(chain, begin.newest, n, middle), _released(chain, begin.newest, n, time)),
        (begin.positions, begin.velocities, begin.rates, begin.surplus),
        chain.elasticity / chain.step,
        float(chain.inertia),
        chain.step,
        chain.flow.length,
        (law_code(chain.law), chain.contour or 1.0, chain.rest_force, chain.rest_tension),
        tolerance,
        _MOST_ITERATIONS,
        watch,
        x,
        tension,
        velocity,
        rate,
        surplus,
        room.of(n),
    )
    if count < 0:
        return None, math.inf, _MOST_ITERATIONS
    end = replace(begin, time=time, positions=x, tensions=tension, velocities=velocity, rates=rate, surplus=surplus)
    return _without(end, left), error, count


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
    if not more and held >= free:
        return state
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
