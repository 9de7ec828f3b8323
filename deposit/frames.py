"""Landings from stored frames of a bead jet, where the simulator kept no record of them.

A bead is followed by its *label*; it lands in the interval between two frames at the root of the gap (`touch_down`), so its
time and place are as good as the frames are close. Frames without labels cannot be matched by place: a simulator renumbers
its beads as they enter and leave. JETSPIN: take ``bead.dat`` (`print binary removed`), or ``traj.dat`` in style 4 (labels).
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.deposit.collectors import Collector
from spinline.deposit.landing import LandingRecord
from spinline.deposit.touchdown import touch_down

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["BeadFrame", "landings_from_frames", "landings_from_table"]


class BeadFrame(NamedTuple):
    """One stored moment; beads from the nozzle on or towards it, in any order.

    `volume` (m3) and `polymer_fraction` are those of the element between the bead and the next *higher* label.
    """

    time: float
    label: ArrayLike
    position: ArrayLike  # (bead, 3), m
    volume: ArrayLike
    velocity: ArrayLike | None = None
    polymer_fraction: ArrayLike = 1.0


def landings_from_frames(frames: Iterable[BeadFrame], collector: Collector) -> LandingRecord:
    """Record of a run's landings.

    Parameters
    ----------
    frames : iterable of BeadFrame
        In order of time; one is held at a time. Labels rise from the far end to the nozzle (order of leaving the nozzle).
    collector : Collector

    Returns
    -------
    LandingRecord
        A fibre begins anew after a bead that was never seen to land.

    Raises
    ------
    InputError
        For times that do not rise, a label twice in a frame, fewer than two landings.
    """
    before: _Frame | None = None
    landed: dict[int, tuple[float, FloatArray, FloatArray, float, float, float]] = {}
    for raw in frames:
        now = _Frame(raw)
        if before is not None:
            if not now.time > before.time:
                raise InputError("frames", "are not in order of time", value=now.time, allowed=f"> {before.time:g} s")
            _step(before, now, collector, landed)
        before = now
    labels = sorted(landed)
    if len(labels) < 2:
        raise InputError(
            "frames", f"hold {len(labels)} landings: fibres need two", remedy="run longer, or check the distance"
        )
    rows = [landed[label] for label in labels]
    fibre = np.cumsum(np.r_[0, np.diff(labels) != 1])
    time = np.array([row[0] for row in rows])
    # a bead may touch before the one ahead of it: the fibre is laid in the order of its labels
    time = np.maximum.accumulate(time)
    return LandingRecord.from_arrays(
        time,
        np.array([row[1] for row in rows]),
        np.array([row[3] for row in rows]),
        np.array([row[4] for row in rows]),
        velocity=np.array([row[2] for row in rows]),
        polymer_fraction=np.array([row[5] for row in rows]),
        fibre=fibre,
        attributes={"source": "frames"},
    )


def landings_from_table(table: "xr.Dataset", *, polymer_fraction: float = 1.0) -> LandingRecord:
    """Record from JETSPIN's table of landed beads (``bead.dat``, read by `read_jetspin`).

    A bead's volume and length there are those of the element to its *follower*, which is the next row. Rows with a value
    that cannot be (NaN, length 0) break the fibre. Times, single precision there, are made to not run back.
    """
    if "landing" not in table.dims or "element_length" not in table:
        raise InputError(
            "landings",
            "are no table of landed beads",
            value=list(map(str, table.data_vars)),
            remedy="give bead.dat of a JETSPIN run, with its log.txt beside it",
        )
    get = {name: np.asarray(table[name].values, dtype=np.float64) for name in table.data_vars}
    place = np.stack([get["x"], get["y"], get["z"]], axis=-1)
    speed = np.stack([get["velocity_x"], get["velocity_y"], get["velocity_z"]], axis=-1)
    good = np.isfinite(place).all(axis=1) & np.isfinite(get["time"]) & np.isfinite(speed).all(axis=1)
    element = good & (get["volume"] > 0) & (get["element_length"] > 0)
    joined = element[:-1] & good[1:]
    fibre = np.cumsum(np.r_[0, ~joined])
    volume, length, charge = np.zeros(good.size), np.full(good.size, np.nan), np.zeros(good.size)
    volume[1:], length[1:], charge[1:] = get["volume"][:-1], get["element_length"][:-1], get["charge"][:-1]
    if int(good.sum()) < 2:
        raise InputError("landings", "are fewer than two", remedy="run longer")
    return LandingRecord.from_arrays(
        np.maximum.accumulate(get["time"][good]),
        place[good],
        volume[good],
        length[good],
        velocity=speed[good],
        polymer_fraction=polymer_fraction,
        charge=charge[good],
        fibre=fibre[good],
        attributes={"source": "bead.dat"},
    )


class _Frame:
    def __init__(self, raw: BeadFrame) -> None:
        self.time = float(real("frame time", raw.time, unit="s"))
        label = real("label", raw.label)
        self.label: NDArray[np.int64] = label.astype(np.int64)
        self.position = real("position", raw.position, unit="m")
        if label.ndim != 1 or self.position.shape != (label.size, 3):
            raise InputError("frame", "needs a label and a position (3) per bead", value=f"{self.position.shape}")
        if np.unique(self.label).size != label.size:
            raise InputError("label", f"stands twice in the frame at {self.time:g} s")
        self.velocity = None if raw.velocity is None else real("velocity", raw.velocity, unit="m/s")
        self.volume = np.broadcast_to(np.asarray(raw.volume, dtype=np.float64), label.shape)
        self.fraction = np.broadcast_to(np.asarray(raw.polymer_fraction, dtype=np.float64), label.shape)
        self.row = {int(name): k for k, name in enumerate(self.label)}


def _step(
    before: _Frame,
    now: _Frame,
    collector: Collector,
    landed: dict[int, tuple[float, FloatArray, FloatArray, float, float, float]],
) -> None:
    shared = [label for label in before.row if label in now.row and label not in landed]
    if not shared:
        return
    i, j = [before.row[k] for k in shared], [now.row[k] for k in shared]
    moving = before.velocity is not None and now.velocity is not None
    down = touch_down(
        collector,
        before.time,
        now.time,
        before.position[i],
        now.position[j],
        before.velocity[i] if moving and before.velocity is not None else None,
        now.velocity[j] if moving and now.velocity is not None else None,
    )
    for n in np.flatnonzero(down.landed).tolist():
        label = shared[n]
        ahead = label - 1  # its element is the one towards the bead that left before it
        length = volume = fraction = np.nan
        if ahead in before.row:
            volume, fraction = float(before.volume[before.row[ahead]]), float(before.fraction[before.row[ahead]])
            length = _flight_length(before, now, ahead, down.position[n], (down.time[n] - before.time))
        landed[label] = (float(down.time[n]), down.position[n], down.velocity[n], volume, length, fraction)


def _flight_length(before: _Frame, now: _Frame, ahead: int, here: FloatArray, elapsed: float) -> float:
    """Distance, when this bead lands, to the bead ahead of it (at rest on the collector, or between its two frames)."""
    start = before.position[before.row[ahead]]
    if ahead in now.row:
        start = start + (now.position[now.row[ahead]] - start) * (elapsed / (now.time - before.time))
    return float(np.linalg.norm(here - start))
