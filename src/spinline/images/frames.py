"""Frames on disk, by the names they had before: `stacks` opens them, `sums` adds them up, `noise` says how they scatter."""

from spinline.images.noise import PairNoise, pair_noise
from spinline.images.stacks import Stack, open_stack
from spinline.images.sums import FrameSum, sample_frames, sum_frames

__all__ = ["FrameSum", "PairNoise", "Stack", "open_stack", "pair_noise", "sample_frames", "sum_frames"]
