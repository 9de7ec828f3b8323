"""Grey pictures without loss, PNG above all, by the package imageio. JPEG is refused: what it keeps are no counts."""

from pathlib import Path

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import Account, Array, FrameReader, frames_shape, needs

__all__ = ["FORMAT"]


class _Picture:
    """A picture in memory."""

    threads = True

    def __init__(self, path: Path, key: str) -> None:
        try:
            import imageio.v3 as imageio
        except ImportError:
            raise needs("imageio", key, path.name, f"{path.suffix} picture") from None
        try:
            array = np.asarray(imageio.imread(path))
        except (OSError, ValueError, SyntaxError) as error:
            raise InputError(
                key,
                f"cannot be read ({type(error).__name__})",
                value=path.name,
                remedy="copy it again, or save it as TIFF",
            ) from None
        if array.ndim == 3 and array.shape[-1] in (3, 4):
            colours = array[..., :3]
            if not (colours == colours[..., :1]).all():
                raise InputError(
                    key,
                    "is a colour image, no counts",
                    value=path.name,
                    remedy="give the detector's raw frames, (z, x)",
                )
            array = colours[..., 0]
        self.shape = frames_shape(array.shape, key, path.name)
        self.array, self.dtype = array.reshape(self.shape), array.dtype
        self.account = Account(path.name)

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        return self.array[start:stop]


class _Pictures:
    name = "picture"
    suffixes = (".png", ".bmp", ".jpg", ".jpeg")
    inside = False

    def owns(self, head: bytes) -> bool:
        """Whether a file begins as PNG does."""
        return head.startswith(b"\x89PNG\r\n\x1a\n")

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open a picture."""
        if path.suffix.lower() in (".jpg", ".jpeg"):
            raise InputError(
                key, "is a JPEG: what it keeps are no counts", value=path.name, remedy="give the detector's raw frames"
            )
        return _Picture(path, key)


FORMAT = _Pictures()
