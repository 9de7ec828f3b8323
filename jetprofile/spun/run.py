"""A whole computation: march, frames, impulses of the air, record of the landings, and the result as a Dataset.

A run is a `Chain`, the frames stored so far and nothing else, so what a checkpoint holds goes on bit by bit.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from spinline.base.checks import FloatArray, positive
from spinline.base.errors import InputError
from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun.chain import Chain, start_cylinder
from spinline.jetprofile.spun.noise import impulses
from spinline.jetprofile.spun.settings import SpunSettings
from spinline.jetprofile.spun.start import start_straight

__all__ = ["SpunRun", "moments"]


def moments(time: float, count: int) -> FloatArray:
    """`count` equal times up to `time`, s."""
    end = positive("time", time, "s")
    if count < 1:
        raise InputError("frames", "must be 1 or more", value=count)
    return end * np.arange(1, count + 1) / count


@dataclass
class SpunRun:
    """A spun jet on its way.

    Attributes
    ----------
    chain : Chain
        The jet now.
    frames : list of ndarray
        States stored, front first, with the label of the front and which nodes are held: one array per frame.
    times : list of float
        When, s.
    """

    chain: Chain
    frames: list[FloatArray] = field(default_factory=list)
    times: list[float] = field(default_factory=list)

    @classmethod
    def start(cls, settings: SpunSettings) -> "SpunRun":
        """A run at its beginning."""
        if settings.start is not None:
            return cls(start_straight(settings, settings.start))
        return cls(start_cylinder(settings))

    def advance(self, end: float) -> None:
        """March to `end` in s, and store a frame."""
        self.march(end)
        self.store()

    def march(self, end: float, others: tuple[float, FloatArray] | None = None) -> None:
        """March to `end` in s, with the air's impulses on the way; `others`: see `Chain.march`."""
        chain, air = self.chain, self.chain.settings.air
        if air is not None and air.noise > 0.0:
            done = math.floor(chain.time / air.interval * (1 + 1e-12) + 1e-9)
            while (done + 1) * air.interval <= end * (1 + 1e-12):
                done += 1
                chain.march(done * air.interval, others=others)
                kick = impulses(
                    chain.state,
                    chain.n,
                    float(chain.clock[3]),
                    chain.settings.density,
                    air.noise,
                    air.grain,
                    air.interval,
                    chain.settings.seed,
                    done,
                )
                free = chain.held[: chain.n] == 0
                chain.state[: chain.n, c.VX : c.VX + 3][free] += kick[free]
        chain.march(end, others=others)

    def store(self) -> None:
        """Keep the state of now as a frame."""
        chain = self.chain
        stored: FloatArray = np.column_stack((chain.nodes, chain.held[: chain.n + 1].astype(np.float64)))
        self.frames.append(stored)
        self.times.append(chain.time)

    def to(self, times: FloatArray, progress: Callable[[float], None] | None = None) -> Iterator[int]:
        """March through `times` not yet reached; yields the index of each as it is stored."""
        for index, moment in enumerate(np.atleast_1d(times)):
            if index < len(self.times):
                continue
            self.advance(float(moment))
            if progress is not None:
                progress(float(moment))
            yield index

    def pack(self) -> dict[str, Any]:
        """All arrays that a checkpoint needs."""
        chain = self.chain
        sizes = np.array([f.shape[0] for f in self.frames], dtype=np.int64)
        width = c.COLUMNS + 1
        return {
            "state": chain.state,
            "held": chain.held,
            "marks": chain.marks,
            "clock": chain.clock,
            "landed": chain.landed,
            "now": np.array([chain.time, chain.step]),
            "n": np.array([chain.n]),
            "times": np.array(self.times),
            "sizes": sizes,
            "frames": np.concatenate(self.frames) if self.frames else np.zeros((0, width)),
        }

    @classmethod
    def unpack(cls, settings: SpunSettings, held: dict[str, Any]) -> "SpunRun":
        """The run that `pack` stored."""
        chain = Chain(
            settings,
            float(held["now"][0]),
            int(held["n"][0]),
            np.array(held["state"]),
            np.array(held["held"]),
            np.array(held["marks"]),
            np.array(held["clock"]),
            np.array(held["landed"]),
            float(held["now"][1]),
        )
        cuts = np.cumsum(held["sizes"])[:-1]
        frames = [np.array(f) for f in np.split(np.array(held["frames"]), cuts)] if held["sizes"].size else []
        return cls(chain, frames, [float(t) for t in held["times"]])
