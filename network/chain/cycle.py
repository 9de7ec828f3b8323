"""A settled chain over the period between two entries: what it does on average, and by how much it sticks and slips.

Beads enter one every h; a chain of linear springs passes that by unnoticed. One whose strands come to their contour locks and
slips with every bead that enters: a snapshot of it is a phase of that cycle, and two snapshots differ. What can be reported is
the average over a period and the range within it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.network._objects import instance
from spinline.network.chain.march import run_chain
from spinline.network.chain.model import Chain
from spinline.network.chain.profile import ChainProfile, profile
from spinline.network.chain.state import ChainState

__all__ = ["ChainCycle", "chain_cycle"]


@dataclass(frozen=True, eq=False)
class ChainCycle:
    """Stretch of the strands over one period, at stations (n,).

    Attributes
    ----------
    stations : ndarray
        Initial radii.
    mean, low, high : ndarray
        Average over the period and the range within it; NaN outside the chain.
    profiles : list of ChainProfile
        The moments behind them.
    """

    stations: FloatArray
    mean: FloatArray
    low: FloatArray
    high: FloatArray
    profiles: list[ChainProfile]

    @property
    def swing(self) -> float:
        """Largest range over the average."""
        share = (self.high - self.low) / self.mean
        return float(np.nanmax(share)) if np.isfinite(share).any() else float("nan")


def chain_cycle(
    chain: Chain,
    state: ChainState,
    stations: ArrayLike,
    *,
    moments: int = 12,
    rtol: float = 1e-4,
    most_steps: int = 1_000_000,
) -> ChainCycle:
    """Follow a settled chain for one period between entries.

    Parameters
    ----------
    chain : Chain
        With beads that enter.
    state : ChainState
        Where it has settled.
    stations : array_like, (n,)
        Initial radii.
    moments : int, optional
        Within the period, 2 to 1000.
    rtol, most_steps
        As for `run_chain`.

    Returns
    -------
    ChainCycle

    Raises
    ------
    InputError
        For a chain into which no beads enter, or values out of range.
    ChainError
        As `run_chain`.
    """
    instance("chain", chain, Chain)
    instance("state", state, ChainState)
    if not chain.entry:
        raise InputError("chain", "has no entries: it has no period", value=False, allowed="entry = True")
    if isinstance(moments, bool) or not isinstance(moments, int | np.integer) or not 2 <= moments <= 1000:
        raise InputError("moments", "is not a number of moments", value=moments, allowed="integers, [2, 1000]")
    s = real("stations", stations).ravel()
    times = state.time + chain.step * (np.arange(moments) + 1) / moments
    run = run_chain(
        chain, float(times[-1]), start=state, rtol=rtol, output_times=times, most_steps=state.steps + most_steps
    )
    profiles = [profile(chain, one) for one in run.snapshots]
    values = np.stack([one.stretch_at(s) for one in profiles])
    return ChainCycle(s, values.mean(axis=0), values.min(axis=0), values.max(axis=0), profiles)
