"""Beads that cannot be where, or what, the file says."""

import numpy as np
from numpy.typing import NDArray

from spinline.jetprofile.jetspin.frames import Block, Floats, Padder
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import RunParameters

__all__ = [
    "FAR",
    "KINK",
    "LONE_KINK",
    "check_content",
    "check_motion",
    "check_positions",
    "distance",
    "find_strays",
    "kinks",
    "peak_kink",
]

Flags = NDArray[np.bool_]
FAR = 20.0  # collector distances; nothing of a jet is farther away
KINK = 2.0  # by how much a kink may exceed those of the frames before and after
LONE_KINK = 10.0  # and what it may be in a frame without them (8 is met in sound runs)
_FAST = 1e6  # m/s
_STIFF = 1e15  # Pa


def check_positions(
    bead: Floats,
    there: Flags,
    error: float,
    parameters: RunParameters,
    notes: Notes,
) -> tuple[Flags, Flags]:
    """Deposited beads, and beads whose position (3, frame, bead) is not believed.

    Positions more than `FAR` collector distances away are set to NaN. A bead behind the nozzle keeps its position.
    """
    x = bead[0]
    collector = parameters.collector_distance
    odd = np.isnan(x) & there
    deposited = np.zeros(x.shape, dtype=np.bool_)
    limit = 1e3 if collector is None else FAR * collector
    # most runs need none of what follows; of NaN alone these are NaN, which is within no bounds
    low, high = (extreme.reduce(bead, axis=(1, 2)).tolist() for extreme in (np.fmin, np.fmax))
    if not all(-limit <= first and last <= limit for first, last in zip(low, high, strict=True)):
        lost = (np.abs(bead) > limit).any(axis=0)
        shown = f"{limit:.4g} m" if collector is None else f"{FAR:.0f} collector distances"
        notes.add(f"{{n}} beads farther than {shown} from the nozzle have NaN positions", np.count_nonzero(lost))
        bead[:, lost] = np.nan
        odd |= lost
    if collector is not None and not high[0] < collector - error - 1e-6 * collector:
        deposited = x >= collector - error - 1e-6 * collector
        if parameters.removing is not False:
            beyond = x > collector + 2 * error + 1e-6 * collector
            notes.add("{n} beads beyond the collector, taken as deposited", np.count_nonzero(beyond))
    if not low[0] >= -error - 1e-9:
        behind = (x < -error - 1e-9) & there
        behind[:, 0] = False
        notes.add(
            "{n} beads behind the nozzle (x < 0); the elements beside them are not valid", np.count_nonzero(behind)
        )
        odd |= behind
    return deposited, odd


def kinks(bead: Floats, length: Floats) -> Floats:
    """Path over every inner bead against the straight line between its neighbours; 1 where there is none.

    `length` is the distance between a bead and the next.
    """
    frames, count = bead[0].shape
    found = np.ones((frames, count))
    if count > 2:
        path, two = length[:, 1:] + length[:, :-1], distance(bead, 2)
        np.divide(path, two, out=found[:, 1:-1], where=two > 1e-4 * path)  # nowhere if one is not finite
    return found


def distance(bead: Floats, apart: int) -> Floats:
    """Distance between beads (3, frame, bead) so many numbers apart."""
    step = bead[:, :, apart:] - bead[:, :, :-apart]
    step *= step
    length: Floats = step[0] + step[1]
    length += step[2]
    np.sqrt(length, out=length)
    return length


def peak_kink(block: Block) -> float:
    """Sharpest kink of the frames of a block."""
    peak = 1.0
    for first, length in zip(block.first.tolist(), block.length.tolist(), strict=True):
        bead = np.zeros((3, 1, length))
        for number, axis in enumerate("xyz"):
            if axis in block.values:
                bead[number, 0] = block.values[axis][first : first + length]
        peak = max(peak, float(kinks(bead, distance(bead, 1)).max(initial=1.0)))
    return peak


def find_strays(bead: Floats, length: Floats, deposited: Flags, around: tuple[float, float], notes: Notes) -> Flags:
    """Beads at a kink that neither the frame before nor the one after knows the like of; they keep their position.

    `around` is the sharpest kink of the frame before these and of the one after, NaN where there is none.
    """
    kink = kinks(bead, length)
    kink[:, :-1][deposited[:, 1:]] = 1.0
    peak = np.empty(len(kink) + 2)
    peak[0], peak[-1] = around
    kink.max(axis=1, initial=1.0, out=peak[1:-1])
    if peak[1:-1].max(initial=1.0) <= KINK:  # no frame allows less
        return np.zeros(kink.shape, dtype=np.bool_)
    known = np.fmax(peak[:-2], peak[2:])
    allowed = np.where(np.isnan(known), LONE_KINK, KINK * known)
    stray: Flags = kink > allowed[:, None]
    notes.add(
        "{n} beads far off the line of their neighbours; the elements beside them are not valid",
        np.count_nonzero(stray),
    )
    return stray


def check_motion(pad: Padder, notes: Notes) -> Flags:
    """Beads with a velocity or a stress that nothing has."""
    odd: Flags = np.zeros(pad.there.shape, dtype=np.bool_)
    bounds = [(f"velocity_{axis}", _FAST, "speeds") for axis in "xyz"] + [("stress", _STIFF, "stresses")]
    for name, limit, text in bounds:
        if name in pad:
            wrong = np.abs(pad(name)) > limit
            notes.add(
                f"{{n}} {text} are beyond all bounds; the elements beside them are not valid",
                np.count_nonzero(wrong),
            )
            odd |= wrong
    return odd


def check_content(pad: Padder, parameters: RunParameters, notes: Notes) -> Flags:
    """Beads whose volume cannot be; it is judged by mass and charge, and they by it."""
    volume = pad("volume")
    odd: Flags = np.isfinite(volume) & ~(volume > 0)
    notes.add("{n} volumes are not positive; their elements have no radius", np.count_nonzero(odd))
    nominal, mass, charge = parameters.element_volume, parameters.mass_unit, parameters.charge_unit
    if nominal is None or mass is None or charge is None:
        return odd
    share = volume / nominal
    by_mass, by_charge = pad("mass") / mass, pad("charge") / charge
    large = share > 1.001
    differs = np.abs(share - by_mass) > 1e-4 * np.abs(share)
    differs_too = np.abs(share - by_charge) > 1e-4 * np.abs(share)
    heavy = (by_mass > 1.001) & (by_charge > 1.001) & ~large
    notes.add(
        "{n} beads have more mass and charge than their volume can hold (JETSPIN 1.21 gives wrong ones to "
        "beads inserted after a restart)",
        np.count_nonzero(heavy & differs),
    )
    wrong = (large | (differs & differs_too & ~heavy)) & ~odd
    notes.add("{n} volumes contradict mass and charge; their elements are not valid", np.count_nonzero(wrong))
    single = (differs ^ differs_too) & ~wrong
    notes.add("{n} beads have a mass or charge that contradicts their volume", np.count_nonzero(single))
    return odd | wrong
