"""Monte Carlo random walk of strands on the cubic lattice: the rung `walk` of the ladder."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.network.walk.sample import StrandSample, WalkMethod, sample_paths, sample_strands

_NAMES = {
    "StrandSample": "sample",
    "WalkMethod": "sample",
    "sample_paths": "sample",
    "sample_strands": "sample",
}

__all__ = [
    "StrandSample",
    "WalkMethod",
    "sample_paths",
    "sample_strands",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
