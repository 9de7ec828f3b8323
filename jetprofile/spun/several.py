"""Several jets side by side that repel one another, Eq. (27): chains marched in turn beside the others' charges.

Over an eighth of the time between two elements each chain sees the others' charges move on straight lines, so the coupling is
of second order in that interval. Each jet has its own nozzle, applied field and feed; the others' feeds are felt too, as rows
of points. Left out is what the others' mirror charges do.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun.run import SpunRun
from spinline.jetprofile.spun.settings import SpunSettings

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["SpunJets", "pattern", "shifted"]

PARTS = 8  # intervals of coupling per element that enters
POINTS = 64  # of a feed


def pattern(kind: str, count: int, spacing: float) -> FloatArray:
    """Nozzles about the axis, (count, 2) in m: a "line", a "square" of equal rows or a "ring", neighbours `spacing` apart."""
    if kind == "line":
        return np.stack([spacing * (np.arange(count) - 0.5 * (count - 1)), np.zeros(count)], axis=-1)
    if kind == "square":
        side = math.isqrt(count)
        if side * side != count:
            raise InputError("jets", "are no square", value=count, allowed="4, 9, 16, ...")
        at = spacing * (np.arange(side) - 0.5 * (side - 1))
        return np.stack([np.repeat(at, side), np.tile(at, side)], axis=-1)
    if kind == "ring":
        turn = 2 * math.pi * np.arange(count) / count
        wide = 0.5 * spacing / math.sin(math.pi / count) if count > 1 else 0.0
        return wide * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    raise InputError("pattern", "is not known", value=kind, allowed="line, square, ring")


@dataclass
class SpunJets:
    """Jets on their way: one run each, their nozzles at `offsets` (jet, 2), m across the axis."""

    runs: list[SpunRun]
    offsets: FloatArray

    @classmethod
    def start(cls, settings: SpunSettings, offsets: FloatArray) -> "SpunJets":
        """Jets of one kind, their noise of successive seeds.

        Raises
        ------
        InputError
            Where charge moves in the jets, or two nozzles are one.
        """
        at = real("offsets", offsets, unit="m").reshape(-1, 2)
        if settings.conductivity > 0.0:
            raise InputError(
                "charge",
                "moves in the liquid: jets side by side need theirs frozen",
                remedy='charge = "frozen", or one jet',
            )
        apart = np.linalg.norm(at[:, None] - at[None], axis=-1) + np.diag(np.full(len(at), np.inf))
        if len(at) > 1 and apart.min() < 4.0 * settings.inlet.radius:
            raise InputError(
                "spacing",
                "lets two nozzles touch",
                value=float(apart.min()),
                allowed=f">= {4 * settings.inlet.radius:g} m",
            )
        return cls([SpunRun.start(replace(settings, seed=settings.seed + i)) for i in range(len(at))], at)

    def advance(self, end: float) -> None:
        """March all to `end`, s, and store a frame of each."""
        settings = self.runs[0].chain.settings
        part = float(self.runs[0].chain.clock[0]) / settings.inlet.flow_rate / PARTS
        now = self.runs[0].chain.time
        steps = max(math.ceil((end - now) / part * (1 - 1e-12)), 1)
        for moment in now + (end - now) * np.arange(1, steps + 1) / steps:
            charges = [self._charges(run, place) for run, place in zip(self.runs, self.offsets, strict=True)]
            start = self.runs[0].chain.time
            for i, run in enumerate(self.runs):
                others = np.concatenate([q for j, q in enumerate(charges) if j != i] or [np.zeros((7, 0))], axis=1)
                others[1:3] -= self.offsets[i][:, None]
                run.march(float(moment), (start, others))
        for run in self.runs:
            run.store()

    def to(self, times: FloatArray, progress: Callable[[float], None] | None = None) -> Iterator[int]:
        """March through `times` not yet reached; yields the index of each as it is stored."""
        for index, moment in enumerate(np.atleast_1d(times)):
            if index < len(self.runs[0].times):
                continue
            self.advance(float(moment))
            if progress is not None:
                progress(float(moment))
            yield index

    @staticmethod
    def _charges(run: SpunRun, place: FloatArray) -> FloatArray:
        """Place, velocity and charge of a jet's nodes and of its feed, (7, n)."""
        chain = run.chain
        y, n = chain.nodes, chain.n
        out = np.zeros((7, n + 1))
        out[:6] = y[:, : c.VZ + 1].T
        out[6, :n] = 0.5 * y[:n, c.CHARGE]
        out[6, 1:] += 0.5 * y[:n, c.CHARGE]
        out[1:3] += place[:, None]
        grid = chain.settings.grid
        lines = [
            line
            for line in ((grid.feed_length, grid.feed_charge), *grid.feed_lines)
            if line[0] > 0.0 and line[1] != 0.0
        ]
        for length, charge in lines:
            feed = np.zeros((7, POINTS))
            feed[0] = -length * (np.arange(POINTS) + 0.5) / POINTS
            feed[1:3] = place[:, None]
            feed[6] = charge * length / POINTS
            out = np.concatenate((out, feed), axis=1)
        return out

    def pack(self) -> dict[str, Any]:
        """All arrays that a checkpoint needs."""
        return {f"jet{i}_{name}": value for i, run in enumerate(self.runs) for name, value in run.pack().items()}

    @classmethod
    def unpack(cls, settings: SpunSettings, offsets: FloatArray, held: dict[str, Any]) -> "SpunJets":
        """The jets that `pack` stored."""
        runs = []
        for i in range(len(offsets)):
            own = {name.removeprefix(f"jet{i}_"): v for name, v in held.items() if name.startswith(f"jet{i}_")}
            runs.append(SpunRun.unpack(replace(settings, seed=settings.seed + i), own))
        return cls(runs, offsets)


def shifted(jet: "xr.Dataset", offset: Sequence[float], number: int) -> "xr.Dataset":
    """A jet's result in the laboratory: its nozzle at `offset`, its number on what it laid."""
    changed = {}
    for axis, name in enumerate("yz"):
        for own in (name, f"deposit_{name}", f"deposit_{name}0", f"deposit_{name}1"):
            changed[own] = jet[own] + float(offset[axis])
            changed[own].attrs = jet[own].attrs
    changed["deposit_jet"] = jet["deposit_jet"] + number
    changed["deposit_jet"].attrs = jet["deposit_jet"].attrs
    return jet.assign(changed).assign_attrs(jet=number, nozzle_y=float(offset[0]), nozzle_z=float(offset[1]))
