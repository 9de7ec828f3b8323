"""What beamlines and cameras write beside TIFF and HDF5, by the package fabio: EDF, CBF, ADSC and Mar IMG, SPE, MRC, ..."""

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
        try:
            self.image = fabio.open(str(path))
        except Exception as error:
            raise InputError(
                key,
                f"cannot be read ({str(error).splitlines()[0] if str(error) else type(error).__name__})",
                value=path.name,
                remedy="copy it again, or save it as TIFF",
            ) from None
        data = self.image.data
        if data is None or data.ndim < 2:
            raise InputError(key, "holds no image", value=path.name, remedy="copy it again: it may be cut short")
        self.path, self.count = path, int(self.image.nframes)
        self.shape = frames_shape((self.count * int(np.prod(data.shape[:-2])), *data.shape[-2:]), key, path.name)
        self.dtype: np.dtype[Any] = np.dtype(data.dtype)
        kind = type(self.image).__name__
        self.account = Account(path.name, f"{self.shape[0]} images ({kind})")

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        frames = [self.image] if self.count == 1 else [self.image.get_frame(i) for i in range(start, stop)]
        for i, frame in enumerate(frames):
            if getattr(frame, "incomplete_data", False) or getattr(frame, "incomplete_file", False):
                raise EOFError(f"{self.path.name} ends early, in frame {start + i}")
        if self.count == 1:
            return np.asarray(self.image.data).reshape(self.shape)[start:stop]
        return np.stack([np.asarray(frame.data) for frame in frames])


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
        ".spe",
        ".mrc",
        ".map",
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
