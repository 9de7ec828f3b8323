"""Where every bead of a chain is at one time: starts, checkpoints.

Beads are counted from the far end; the last one, where beads enter, is still inside the nozzle (x <= 0) and moves
with it at V = 1 until it passes x = 0 at the time ``newest * h``.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.checkpoint import pack, unpack
from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.base.files import readable, write_bytes
from spinline.network._objects import instance
from spinline.network.chain.model import Chain

__all__ = ["ChainState", "affine_start", "empty_start", "load_states", "save_states", "start_from"]

_ARRAYS = ("positions", "tensions", "velocities", "rates", "surplus")
_NUMBERS = ("time", "newest", "span", "next_step", "steps", "rejected", "iterations")


@dataclass(frozen=True, eq=False)
class ChainState:
    """A chain at one time; all that its future depends on.

    Attributes
    ----------
    time : float
        Units of r_0 / v_0.
    positions : ndarray, shape (n,)
        x of the beads, in initial radii, decreasing.
    tensions : ndarray, shape (n - 1,)
        T of the strand behind each bead.
    velocities : ndarray, shape (n,)
        x'.
    newest : int
        Number of the last bead; it enters at the time ``newest * h``.
    rates, surplus : ndarray, shape (n,)
        Rates of age and ``I x''`` at this time, kept for the next step.
    span : int
        Span of the flow in which the rates were computed; -1: compute them anew.
    next_step : float
        Proposed time step; 0 if there is none yet.
    steps, rejected, iterations : int
        Accepted and rejected steps and Newton iterations so far.
    """

    time: float
    positions: FloatArray
    tensions: FloatArray
    velocities: FloatArray
    newest: int
    rates: FloatArray
    surplus: FloatArray
    span: int = -1
    next_step: float = 0.0
    steps: int = 0
    rejected: int = 0
    iterations: int = 0


def empty_start(chain: Chain) -> ChainState:
    """Time 0: the first bead is at the nozzle and is the free far end."""
    instance("chain", chain, Chain)
    x = np.array([0.0, -chain.step])
    return _fresh(chain, x, np.full(1, chain.rest_tension), np.ones(2), newest=1)


def affine_start(chain: Chain) -> ChainState:
    """Time 0: beads along the whole jet where the flow alone would have carried them.

    Raises
    ------
    InputError
        Where that stretch is beyond the contour of the strands.
    """
    instance("chain", chain, Chain)
    flow, h = chain.flow, chain.step
    number = int(np.floor(float(flow.residence_time(flow.length)) / h))
    age = h * np.arange(number, -1, -1)
    s = np.interp(age, flow.residence_time(flow.nodes), flow.nodes)
    for _ in range(30):
        s = np.clip(s + (age - flow.residence_time(s)) * flow.velocity_ratio(s), 0.0, flow.length)
    if chain.entry:
        s = np.append(s, -h)
    return start_from(chain, s)


def start_from(chain: Chain, positions: FloatArray) -> ChainState:
    """Time 0: beads at given positions, moving with the flow.

    Parameters
    ----------
    chain : Chain
    positions : array_like, shape (n,), n >= 2
        In initial radii, strictly decreasing; where beads enter, the last two are at 0 and ``-h``.

    Raises
    ------
    InputError
        For positions out of order, or strands beyond their contour.
    """
    instance("chain", chain, Chain)
    x = real("positions", positions, most=chain.flow.length, unit="r_0")
    if x.ndim != 1 or x.size < 2 or np.any(np.diff(x) >= 0):
        raise InputError("positions", "needs two beads or more, strictly decreasing", value=f"shape {x.shape}")
    if chain.entry and not (x[-2] == 0 and abs(x[-1] + chain.step) <= 1e-9 * chain.step):
        raise InputError("positions", "must end with 0 and -h where beads enter", value=x[-2:].tolist())
    w = -np.diff(x) / chain.step
    if chain.law == "linear" or chain.contour is None:
        tensions = w
    else:
        worst = float(w.max())
        if worst >= chain.contour:
            remedy = 'start from the empty chain (start="empty") or place the beads closer'
            allowed = f"stretch below {chain.contour:g}"
            raise InputError(
                "positions", "stretch a strand beyond its contour", value=worst, allowed=allowed, remedy=remedy
            )
        from spinline.network.force_laws import force

        tensions = force(w / chain.contour, chain.law, chain.rest_force) / chain.rest_force
    velocities = np.where(x > 0, chain.flow.velocity_ratio(x, 0.0), 1.0)
    return _fresh(chain, x.copy(), tensions, velocities, newest=1)


def _fresh(chain: Chain, x: FloatArray, tensions: FloatArray, velocities: FloatArray, newest: int) -> ChainState:
    return ChainState(0.0, x, tensions, velocities, newest, np.zeros(x.size), np.zeros(x.size))


def save_states(path: str | Path, states: list[ChainState], fingerprint: str) -> None:
    """Write states to an .npz file, whole or not at all: a new file takes the place of the old one."""
    content: dict[str, np.ndarray] = {"fingerprint": np.array(fingerprint), "count": np.array(len(states))}
    for i, state in enumerate(states):
        for name in _ARRAYS + _NUMBERS:
            content[f"{name}_{i}"] = np.asarray(getattr(state, name))
    write_bytes(path, pack(content), force=True)


def load_states(path: str | Path, fingerprint: str) -> list[ChainState]:
    """Read what `save_states` wrote; refuse a file of another run."""
    try:
        content = unpack(readable(path, "checkpoint").read_bytes())
    except OSError as error:
        raise InputError("checkpoint", f"cannot be read ({error.strerror})", value=str(path)) from None
    if content is None or not {"fingerprint", "count"} <= set(content):
        raise InputError(
            "checkpoint",
            "cannot be read: it is damaged, or no checkpoint",
            value=str(path),
            remedy="remove it: the run then starts again",
        )
    owner, count = str(content["fingerprint"]), int(content["count"])
    if owner != fingerprint:
        remedy = "use another file, or the same chain, tolerances and times"
        raise InputError("checkpoint", "belongs to another run", value=str(path), remedy=remedy)
    return [_read(content, i) for i in range(count)]


def _read(content: dict[str, np.ndarray], i: int) -> ChainState:
    values: dict[str, Any] = {name: content[f"{name}_{i}"] for name in _ARRAYS}
    values |= {name: content[f"{name}_{i}"].item() for name in _NUMBERS}
    return ChainState(**values)
