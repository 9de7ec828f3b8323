"""Beads that cannot be where, or what, the file says."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from spinline.jetprofile.jetspin.frames import Block, Floats
from spinline.jetprofile.jetspin.header import RunParameters
from spinline.jetprofile.jetspin.notes import Notes

__all__ = ["DETOUR", "FAR", "check_content", "check_positions"]

Flags = NDArray[np.bool_]
FAR = 20.0  # collector distances; nothing of a jet is farther away
DETOUR = 6.0  # path over two elements against the straight line between their ends, and against both neighbours
_FAST = 1e6  # m/s
_STIFF = 1e15  # Pa


def check_positions(
    bead: dict[str, Floats], there: Flags, error: float, parameters: RunParameters, notes: Notes
) -> tuple[Flags, Flags]:
    """Deposited beads, and beads whose position is not believed.

    Positions more than `FAR` collector distances away are set to NaN. A bead behind the nozzle, or one that
    makes a sharp detour (the path over it is `DETOUR` times both the straight line and the elements around),
    keeps its position.
    """
    x, y, z = bead["x"], bead["y"], bead["z"]
    collector = parameters.collector_distance
    odd = np.isnan(x) & there
    deposited = np.zeros(x.shape, dtype=np.bool_)
    limit = 1e3 if collector is None else FAR * collector
    lost = (np.abs(x) > limit) | (np.abs(y) > limit) | (np.abs(z) > limit)
    if lost.any():
        shown = f"{limit:.4g} m" if collector is None else f"{FAR:.0f} collector distances"
        notes.add(f"{{n}} beads farther than {shown} from the nozzle have NaN positions", int(lost.sum()))
        for values in (x, y, z):
            values[lost] = np.nan
        odd |= lost
    if collector is not None:
        deposited = x >= collector - error - 1e-6 * collector
        if parameters.removing is not False:
            beyond = x > collector + 2 * error + 1e-6 * collector
            notes.add("{n} beads beyond the collector, taken as deposited", int(beyond.sum()))
    behind = x < -error - 1e-9
    inner = there.copy()
    inner[:, 0] = False
    behind &= inner
    notes.add("{n} beads behind the nozzle (x < 0); the elements beside them are not valid", int(behind.sum()))
    odd |= behind
    stray = _detours(bead, deposited)
    notes.add("{n} beads far off the line of their neighbours; the elements beside them are not valid", int(stray.sum()))
    odd |= stray
    return deposited, odd


def _detours(bead: dict[str, Floats], deposited: Flags) -> Flags:
    """Inner beads that stand out of the line of their neighbours by far more than the elements around."""
    stray = np.zeros(deposited.shape, dtype=np.bool_)
    if stray.shape[1] < 5:
        return stray
    points = [bead[axis] for axis in "xyz"]
    one = np.sqrt(sum((p[:, 1:] - p[:, :-1]) ** 2 for p in points))
    two = np.sqrt(sum((p[:, 2:] - p[:, :-2]) ** 2 for p in points))
    path = one[:, 1:] + one[:, :-1]  # over bead 1, 2, ...
    stray[:, 1:-1] = path > DETOUR * two
    around = np.full(path.shape, np.inf)
    around[:, 1:-1] = np.maximum(one[:, :-3], one[:, 3:])
    around[:, 0], around[:, -1] = one[:, 2], one[:, -3]
    around[:, -2] = np.where(np.isnan(around[:, -2]), one[:, -4] if one.shape[1] > 3 else np.inf, around[:, -2])
    stray[:, 1:-1] &= path > DETOUR * around
    stray[:, 1:-1] &= ~deposited[:, 2:]
    return stray


def check_content(
    block: Block, pad: Callable[[Floats], Floats], parameters: RunParameters, notes: Notes
) -> Flags:
    """Beads whose volume, mass or charge cannot be; volumes are judged by mass and charge, and the reverse."""
    volume = pad(block.values["volume"])
    odd: Flags = np.isfinite(volume) & ~(volume > 0)
    notes.add("{n} volumes are not positive; their elements have no radius", int(odd.sum()))
    nominal, mass, charge = parameters.element_volume, parameters.mass_unit, parameters.charge_unit
    if nominal is None or mass is None or charge is None:
        return odd
    share = volume / nominal
    by_mass, by_charge = pad(block.values["mass"]) / mass, pad(block.values["charge"]) / charge
    large = share > 1.001
    differs = np.abs(share - by_mass) > 1e-4 * np.abs(share)
    differs_too = np.abs(share - by_charge) > 1e-4 * np.abs(share)
    heavy = (by_mass > 1.001) & (by_charge > 1.001) & ~large
    notes.add(
        "{n} beads have more mass and charge than their volume can hold (JETSPIN 1.21 gives beads inserted after a "
        "restart wrong ones)",
        int((heavy & differs).sum()),
    )
    wrong = (large | (differs & differs_too & ~heavy)) & ~odd
    notes.add("{n} volumes contradict mass and charge; their elements are not valid", int(wrong.sum()))
    single = (differs ^ differs_too) & ~wrong
    notes.add("{n} beads have a mass or charge that contradicts their volume", int(single.sum()))
    return odd | wrong
