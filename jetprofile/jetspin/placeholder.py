"""The place-holder bead: present in binary files while the next bead is still leaving the nozzle."""

import numpy as np

from spinline.jetprofile.jetspin.frames import Block
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import RunParameters

__all__ = ["drop_placeholders"]


def drop_placeholders(block: Block, parameters: RunParameters, notes: Notes) -> None:
    """Leave out the row before the nozzle point in frames that are not yet inserted.

    Such a row sits one resolution from the nozzle point and has no stress; a row that does not is kept, since
    then the flag is the damaged one.
    """
    step = parameters.resolution
    if block.inserted is None or step is None:
        return
    frames = np.flatnonzero(~block.inserted & (block.length >= 2))
    last = block.first[frames] + block.length[frames] - 1
    squared = np.zeros(len(frames))
    for axis in "xyz":
        if axis in block.values:
            squared += (block.values[axis][last] - block.values[axis][last - 1]) ** 2
    fits = np.abs(np.sqrt(squared) - step) < 1e-2 * step
    if "stress" in block.values:
        fits &= block.values["stress"][last - 1] == 0
    notes.add(
        "{n} frames flagged as not inserted have no place-holder bead; all their beads are kept",
        (~fits).sum(),
    )
    last, frames = last[fits], frames[fits]
    notes.add("{n} place-holder beads (the next bead, not yet inserted)", len(frames), warn=False, dropped=True)
    for values in block.values.values():
        values[last - 1] = values[last]
    block.bad[last - 1] = block.bad[last]
    block.length[frames] -= 1
