"""Whole frames: the track of the jet, blocks of rows, images, several jets."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.xray.frame.blocks import FRAME_FLAGS, Frame, FrameFit, fit_frame, require_track

_NAMES = {
    "FRAME_FLAGS": "blocks",
    "Frame": "blocks",
    "FrameFit": "blocks",
    "fit_frame": "blocks",
    "require_track": "blocks",
}

__all__ = [
    "FRAME_FLAGS",
    "Frame",
    "FrameFit",
    "fit_frame",
    "require_track",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
