"""TIFF: every page of the frames' shape and type, however it was written.

Pages that were appended one by one are a series each to most readers, which then see one frame; previews are pages of another
shape. Here a file is the list of its pages: those of the shape that holds most pixels are frames, in their order, and the
account says how many others there are. What cameras write as one page with many frames behind it (ImageJ) is read so.
"""

from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import Account, Array, FrameReader, frames_shape, needs

__all__ = ["FORMAT"]

_COLOURS = (3, 4)
_CENTIMETRE, _INCH = 3, 2
_SEPARATE = 2
_LOSSY, _BITS = (6, 7), 8  # JPEG; of more bits it may be without loss
_UNITS = {"um": 1e-6, "µm": 1e-6, "\\u00b5m": 1e-6, "micron": 1e-6, "mm": 1e-3, "nm": 1e-9, "m": 1.0, "cm": 1e-2}
_LEAST, _MOST = 1e-9, 2e-3  # m, of a pixel that is no default of an editor


class _Even:
    """Frames at even distances in a file, uncompressed."""

    threads = True

    def __init__(
        self, path: Path, offset: int, step: int, shape: tuple[int, int, int], dtype: np.dtype[Any], account: Account
    ) -> None:
        self.path, self.offset, self.step, self.shape, self.dtype = path, offset, step, shape, dtype
        self.account = account

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        each = self.shape[1] * self.shape[2]
        together = self.step == each * self.dtype.itemsize
        out = np.empty((stop - start, each), self.dtype)
        with self.path.open("rb") as file:
            for i in range(1 if together else stop - start):
                file.seek(self.offset + (start + i) * self.step)
                data = np.fromfile(file, self.dtype, out.size if together else each)
                if data.size < (out.size if together else each):
                    raise EOFError(f"{self.path.name} ends early, in frame {start + data.size // each + i}")
                if together:
                    return data.reshape(stop - start, *self.shape[1:])
                out[i] = data
        return out.reshape(stop - start, *self.shape[1:])


class _Pages:
    """Pages that have to be decoded, one by one."""

    threads = False

    def __init__(
        self, path: Path, file: Any, pages: list[int], planes: int, shape: tuple[int, int], dtype: Any, key: str
    ) -> None:
        self.path, self.file, self.pages, self.planes, self.key = path, file, pages, planes, key
        self.shape, self.dtype = (len(pages) * planes, *shape), np.dtype(dtype)
        self.account = Account(path.name)

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        out = np.empty((stop - start, *self.shape[1:]), self.dtype)
        for i in range(start, stop):
            page = self.file.pages[self.pages[i // self.planes]]
            try:
                out[i - start] = page.asarray().reshape(self.planes, *self.shape[1:])[i % self.planes]
            except (ImportError, ValueError, KeyError, RuntimeError) as error:
                missing = _decoder(error, page)
                if missing is None:
                    raise ValueError(f"frame {i}: {error}") from None
                raise needs("imagecodecs", self.key, self.path.name, missing) from None
        return out


def _decoder(error: Exception, page: Any) -> str | None:
    """The compression that lacks a decoder; None for other errors."""
    text = str(error)
    if isinstance(error, ImportError) or "imagecodecs" in text or "compression" in text.lower():
        return f"compression {getattr(page.compression, 'name', page.compression)}"
    return None


class _Tiff:
    name = "tiff"
    suffixes = (".tif", ".tiff", ".btf", ".tf8", ".lsm")
    inside = False

    def owns(self, head: bytes) -> bool:
        """Whether a file begins as TIFF does, of either byte order, 32 or 64 bits."""
        return head[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open all pages of one shape."""
        import logging

        import tifffile

        logging.getLogger("tifffile").setLevel(logging.CRITICAL)  # what is wrong with a file is raised, and said once
        file = tifffile.TiffFile(path)
        pages = file.pages
        kinds: dict[tuple[Any, ...], list[int]] = {}
        for i in range(len(pages)):
            page: Any = pages[i]
            kinds.setdefault((page.shape, str(page.dtype)), []).append(i)
        if not kinds:
            raise InputError(
                key, "holds no image: it is damaged", value=path.name, remedy="copy it again: it may be cut short"
            )
        (shape, dtype), mine = max(kinds.items(), key=lambda kind: len(kind[1]) * int(np.prod(kind[0][0])))
        planes = 1
        if len(shape) == 3 and int(getattr(pages[mine[0]], "planarconfig", 1)) == _SEPARATE:
            planes, shape = shape[0], shape[1:]  # planes one after the other: frames that a writer took for colours
        if len(shape) == 3 and shape[-1] in _COLOURS:
            raise InputError(
                key,
                "is a colour image, no counts",
                value=f"{path.name}: pages of shape {shape}",
                remedy="give the detector's raw frames, (frame, z, x) or (z, x)",
            )
        if int(pages[mine[0]].compression) in _LOSSY and pages[mine[0]].bitspersample == _BITS:  # type: ignore[union-attr]
            raise InputError(
                key,
                "is compressed as JPEG: what it keeps are no counts",
                value=path.name,
                remedy="give the detector's raw frames",
            )
        if dtype == "None" or len(shape) != 2:
            raise InputError(key, "holds pages that are no images", value=f"{path.name}: shape {shape}")
        others = {
            " x ".join(map(str, s)) + (f", {kind}" if kind != dtype else ""): len(i)
            for (s, kind), i in kinds.items()
            if i is not mine
        }
        said = tuple(
            f"{path.name} holds {count} more page{'s' * (count > 1)} of shape {other}: not read"
            for other, count in others.items()
        )
        one: Any = pages[mine[0]]
        many = planes if planes > 1 or len(mine) > 1 else _behind(file, one)
        said_to_be = int((file.imagej_metadata or {}).get("images", 0)) if file.is_imagej else 0
        if said_to_be > len(mine) * many:
            raise InputError(
                key,
                f"is cut short: it says {said_to_be} frames, and holds {len(mine) * many}",
                value=path.name,
                remedy="copy it again",
            )
        account = Account(
            path.name,
            f"{len(mine)} page{'s' * (len(mine) > 1)}" + (f" of {many} frames" if many > 1 else ""),
            remarks=said,
            metadata=_metadata(file, one),
        )
        even = _even(pages, mine, one, many)
        size = frames_shape((len(mine) * many, *shape), key, path.name)
        if even is not None:
            kind = np.dtype(f"{file.byteorder}{np.dtype(dtype).kind}{np.dtype(dtype).itemsize}")
            file.close()
            return _Even(path, *even, size, kind, account)
        reader = _Pages(path, file, mine, planes, shape, dtype, key)
        reader.account = account
        return reader


def _behind(file: Any, page: Any) -> int:
    """Frames that lie behind one page, as ImageJ writes them."""
    series = file.series[0]
    count = int(np.prod(series.shape)) // max(int(np.prod(page.shape)), 1)
    return count if count > 1 and series.dataoffset is not None else 1


def _even(pages: Any, mine: list[int], one: Any, many: int) -> tuple[int, int] | None:
    """Offset of the first frame and distance of the next, where frames lie evenly and plainly in the file."""
    size = one.nbytes // many if one.nbytes and len(one.shape) == 3 else one.nbytes
    if one.compression != 1 or one.fillorder != 1 or one.bitspersample % 8 or not one.is_contiguous:
        return None
    if many > 1 and len(mine) == 1:
        return int(one.dataoffsets[0]), size
    if many > 1:
        return None
    offsets = []
    for i in mine:
        page = pages[i]
        if not page.is_contiguous or page.compression != 1 or sum(page.databytecounts) != size:
            return None
        offsets.append(int(page.dataoffsets[0]))
    steps = np.diff(offsets)
    if steps.size and ((steps != steps[0]).any() or steps[0] < size):
        return None
    return offsets[0], int(steps[0]) if steps.size else size


def _metadata(file: Any, page: Any) -> dict[str, float]:
    """Pixel size, where it is given by ImageJ or as a resolution that is no editor's default."""
    tag = page.tags.get("XResolution")
    if tag is None:
        return {}
    try:
        per = tag.value[0] / tag.value[1]
    except (ZeroDivisionError, TypeError, IndexError):
        return {}
    unit = (file.imagej_metadata or {}).get("unit", "") if file.is_imagej else ""
    if unit:
        size = _UNITS.get(str(unit), 0.0) / per if per > 0 else 0.0
        return {"pixel_size": size} if _LEAST < size < _MOST else {}
    scale = {_CENTIMETRE: 1e-2, _INCH: 0.0254}.get(int(page.tags.valueof("ResolutionUnit", 1)), 0.0)
    size = scale / per if per > 0 else 0.0
    return {"pixel_size": size} if _LEAST < size < 5e-5 else {}  # 300 or 72 dots an inch are an editor's


FORMAT = _Tiff()
