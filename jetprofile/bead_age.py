"""Age of the elements of a bead jet: what lies between an element and the nozzle was fed since it left.

::

    age = volume between element and nozzle / Q

exactly, at a constant feed, straight or bent, steady or not, as long as nothing evaporates. The time that the arc takes at the
speed of the beads is not the age in a bent jet: the beads also fly sideways (in the bundled PVP run it says 130 ms of elements
that are 13 ms old). Q is often not known: a simulation's inlet velocity need not be its flux. It follows from the motion: in a
settled jet the stretch grows from one element to the next as its own rate says, ``d ln Lambda = edot dV/Q``.
"""

from typing import Protocol, Self

import numpy as np

from spinline.base.checks import BoolArray, FloatArray

__all__ = ["bead_ages", "bead_flow_rate", "element_age"]

_SPREAD = 0.5  # of the middle half of the pairs, over their median


class Beads(Protocol):
    """What of a bead jet says how old its elements are; names, shapes and units of `LagrangianJet`."""

    @property
    def time(self) -> FloatArray | None:
        """Moments, s; none of one moment."""

    @property
    def x(self) -> FloatArray:
        """Of the beads along the spin axis, m."""

    @property
    def y(self) -> FloatArray:
        """Across it, m."""

    @property
    def z(self) -> FloatArray:
        """Across both, m."""

    @property
    def arc_length(self) -> FloatArray:
        """Of the elements, m."""

    @property
    def element_radius(self) -> FloatArray:
        """M."""

    @property
    def stretch(self) -> FloatArray:
        """Material stretch of the elements."""

    @property
    def element_strain_rate(self) -> FloatArray:
        """1/s."""

    @property
    def bead_velocity(self) -> FloatArray:
        """m/s."""

    @property
    def usable(self) -> BoolArray:
        """Where there is an element."""

    def at(self, time: float | None = None, /) -> Self:
        """One moment of it."""


def bead_flow_rate(jet: Beads) -> float:
    """Flow rate in m3/s that the motion of a settled bead jet implies; NaN where it does not agree on one.

    Parameters
    ----------
    jet : LagrangianJet
        One moment, or many: the last then.

    Returns
    -------
    float
        Median over pairs of neighbours of ``edot dV/d ln Lambda``; NaN without velocities, with fewer than three pairs that
        stretch, or where the middle half of them differ by more than half of it.
    """
    one = jet if jet.time is None else jet.at()
    volume, rate, level = _volumes(one), one.element_strain_rate[one.usable], np.log(one.stretch[one.usable])
    rise = np.diff(level)
    mean = 0.5 * (rate[1:] + rate[:-1])
    fed = 0.5 * (volume[1:] + volume[:-1])
    with np.errstate(invalid="ignore"):  # NaN without velocities
        good = (rise > 0) & (mean > 0)
    if int(good.sum()) < 3:
        return float("nan")
    low, middle, high = np.percentile(mean[good] * fed[good] / rise[good], [25, 50, 75])
    return float(middle) if high - low <= _SPREAD * middle else float("nan")


def bead_ages(jet: Beads) -> tuple[FloatArray, float]:
    """Age of the elements of a bead jet in s, and the flow rate (m3/s) behind it.

    By what was fed since, at the flow rate that the motion implies; where there is none (NaN), by the time it takes along
    the arc at the speed of the beads; NaN without velocities.
    """
    rate = bead_flow_rate(jet)
    if np.isfinite(rate):
        return element_age(jet, rate), rate
    between = 0.5 * (jet.bead_velocity[..., 1:] + jet.bead_velocity[..., :-1])
    step = np.diff(jet.arc_length, axis=-1, prepend=0.0)
    ages: FloatArray = np.cumsum(step / np.where(between > 0, between, np.nan), axis=-1)
    return ages, rate


def element_age(jet: Beads, flow_rate: float) -> FloatArray:
    """Age of the elements in s at a flow rate in m3/s, (..., element); NaN where there is no element."""
    if jet.time is not None:
        return np.stack([element_age(jet.at(float(t)), flow_rate) for t in jet.time])
    volume = _volumes(jet)
    age = np.full(jet.usable.shape, np.nan)
    age[jet.usable] = (np.cumsum(volume) - 0.5 * volume) / flow_rate
    return age


def _volumes(jet: Beads) -> FloatArray:
    length = np.sqrt(np.diff(jet.x) ** 2 + np.diff(jet.y) ** 2 + np.diff(jet.z) ** 2)
    value: FloatArray = (np.pi * jet.element_radius**2 * length)[jet.usable]
    return value
