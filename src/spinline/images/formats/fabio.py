"""What beamlines and cameras write beside TIFF and HDF5, by the package fabio: EDF, CBF, ADSC and Mar IMG, ..."""

from copy import copy
from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import Account, Array, FrameReader, frames_shape, needs

__all__ = ["FORMAT"]


class _Images:
    """Frames of a file that fabio opens."""

    threads = False

    def __init__(self, path: Path, key: str) -> None:
        try:
            import fabio
        except ImportError:
            raise needs("fabio", key, path.name, f"{path.suffix or 'this kind of'} file") from None
        import logging

        logging.getLogger("fabio").setLevel(logging.CRITICAL)  # what is wrong with a file is raised, and said once
        self._open = fabio.open
        try:
            image = fabio.open(str(path))
        except Exception as error:
            raise InputError(
                key,
                f"cannot be read ({str(error).splitlines()[0] if str(error) else type(error).__name__})",
                value=path.name,
                remedy="copy it again, or save it as TIFF",
            ) from None
        data = image.data
        if data is None or data.ndim < 2:
            raise InputError(key, "holds no image", value=path.name, remedy="copy it again: it may be cut short")
        self.path, self.count = path, int(image.nframes)
        self.shape = frames_shape((self.count * int(np.prod(data.shape[:-2])), *data.shape[-2:]), key, path.name)
        self.dtype: np.dtype[Any] = np.dtype(data.dtype)
        kind = type(image).__name__
        self.image = image if self.count > 1 else None  # a pattern may name thousands of files of one image
        self.account = Account(path.name, f"{self.shape[0]} images ({kind})")

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        image = self._open(str(self.path)) if self.image is None else self.image
        out = np.empty((stop - start, *self.shape[1:]), self.dtype)
        for i in range(start, stop) if self.count > 1 else (0,):
            frame = _frame(image, i) if self.count > 1 else image
            data = np.asarray(frame.data)
            if getattr(frame, "incomplete_data", False) or getattr(frame, "incomplete_file", False):
                raise EOFError(f"{self.path.name} ends early, in frame {i}")
            if self.count == 1:
                return data.reshape(self.shape)[start:stop]
            out[i - start] = data
        return out


def _frame(image: Any, i: int) -> Any:
    """One frame of many; a copy of what holds it where that would keep its numbers for good."""
    many = getattr(image, "_frames", None)
    return copy(many[i]) if many is not None and len(many) > i else image.get_frame(i)


class _Fabio:
    name = "fabio"
    suffixes = (
        ".edf",
        ".cor",
        ".cbf",
        ".img",
        ".mar2300",
        ".mar3450",
        ".mccd",
        ".kcd",
        ".fit2d",
        ".msk",
        ".pnm",
        ".pgm",
        ".dm3",
        ".gfrm",
        ".raw2d",
        ".ehf",
        ".bef",
        ".edf.gz",
        ".sfrm",
        ".osc",
    )
    inside = False

    def owns(self, head: bytes) -> bool:
        """Whether a file begins as CBF or EDF does."""
        return head.startswith(b"###CBF") or (head[:1] in b"{\n" and b"HeaderID" in head)

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open all images of a file."""
        return _Images(path, key)


FORMAT = _Fabio()
