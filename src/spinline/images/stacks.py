"""Stacks of frames: one file or many, a part of the frames, a part of each frame, turned if need be; read in pieces.

A stack is (frame, z, x), the jet running along z; `transpose` swaps z and x. Files of a pattern are taken in the order of the
numbers in their names, each with as many frames as it holds. Nothing is loaded before it is asked for.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.images.file_names import gaps, in_order, kinds, no_file
from spinline.images.formats.base import Account, Array, FrameReader, open_file, split_source
from spinline.xray.frame.strips import Bands

__all__ = ["Stack", "open_stack"]

_AT_ONCE = 24_000_000  # bytes of frames in one read
_MANY_OPEN = 64  # files that are held open


@dataclass(frozen=True, eq=False)
class Stack:
    """A stack of frames that is read in pieces.

    Attributes
    ----------
    key, name : str
        The key of the images file that names it, and the file.
    reader : FrameReader
    transpose : bool
    rows_part, columns_part : slice
        The part of each frame that is read, after the transposition.
    chosen : tuple of int
        Frames of the reader, in order, that the stack is made of.
    turned : callable, optional
        What is done to every piece as it is read.
    """

    key: str
    name: str
    reader: FrameReader
    transpose: bool = False
    rows_part: slice = field(default_factory=lambda: slice(None))
    columns_part: slice = field(default_factory=lambda: slice(None))
    chosen: tuple[int, ...] = ()
    turned: Callable[[Array], Array] | None = None

    @property
    def account(self) -> Account:
        """What the files hold."""
        return self.reader.account

    @property
    def frames(self) -> int:
        """Number of frames; 1 for a single image."""
        return len(self.chosen)

    @property
    def rows(self) -> int:
        """Rows of a frame, along the jet."""
        return len(range(*self.rows_part.indices(self.reader.shape[2 if self.transpose else 1])))

    @property
    def columns(self) -> int:
        """Pixels of a row, across the jet."""
        return len(range(*self.columns_part.indices(self.reader.shape[1 if self.transpose else 2])))

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the numbers that are read."""
        return np.dtype(np.float64) if self.turned is not None else self.reader.dtype

    @property
    def at_once(self) -> int:
        """Frames to read in one piece."""
        pixels = self.reader.shape[1] * self.reader.shape[2]
        return max(1, _AT_ONCE // max(1, pixels * self.dtype.itemsize))

    @property
    def bands(self) -> Bands:
        """Where strips of the frames are taken."""
        return Bands.of(self.frames, self.rows, self.columns)

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`: (frames, rows, columns)."""
        which = self.chosen[start:stop]
        if len(which) < stop - start or not which:
            raise InputError(
                self.key,
                f"has no frames {start} to {stop}",
                value=self.name,
                allowed=f"0 to {self.frames}",
                remedy="was the file cut short?",
            )
        try:
            if which[-1] - which[0] == len(which) - 1:
                block = self.reader.read(which[0], which[-1] + 1)
            else:
                block = np.concatenate([self.reader.read(i, i + 1) for i in which])
        except InputError:
            raise
        except Exception as error:  # what a library makes of damaged bytes
            reason = _first_line(error)
            raise InputError(
                self.key,
                f"frames {start} to {stop} cannot be read ({reason})",
                value=self.name,
                remedy="copy the file again; or take the frames before, with frames",
            ) from None
        block = np.swapaxes(block, 1, 2) if self.transpose else block
        block = block[:, self.rows_part, self.columns_part]
        return block if self.turned is None else self.turned(block)

    def without(self, frames: tuple[int, ...]) -> "Stack":
        """The stack without some of its frames."""
        return replace(self, chosen=tuple(at for i, at in enumerate(self.chosen) if i not in frames))

    def source(self, frame: int) -> str:
        """File, and frame in it, that a frame of the stack comes from."""
        at = self.chosen[frame]
        return self.reader.origin(at) if isinstance(self.reader, _Files) else f"{self.account.source}[{at}]"


def open_stack(
    source: str,
    key: str,
    folder: Path = Path(),
    *,
    transpose: bool = False,
    roi: tuple[slice, slice] | None = None,
    frames: slice | None = None,
) -> Stack:
    """Open a stack; nothing but its shape, its type, and what is missing from it is read.

    Parameters
    ----------
    source : str
        A file of any of `formats.formats` (for those that hold several arrays ``file.h5:/path/inside``; without a path the one
        named `key`, or the only one), or a pattern such as ``frames/*.tif``.
    key : str
        Key of the images file, for errors.
    folder : path
        That relative paths start from.
    transpose : bool
        Swap the last two dimensions.
    roi : (slice, slice), optional
        Rows and columns that are read, after the transposition.
    frames : slice, optional
        Frames that are read.

    Returns
    -------
    Stack
        Without frames that were never written.

    Raises
    ------
    InputError
        For a file that is missing or of an unknown kind, no such array inside, an array that is no stack of frames, or a file
        that this one refers to and that is not there.
    """
    try:
        reader = _open(source, key, folder)
    except InputError:
        raise
    except Exception as error:  # what a library makes of damaged bytes
        reason = "damaged" if isinstance(error, IndexError) else _first_line(error)
        remedy = "copy the file again: it may be cut short; or save it as TIFF or npy"
        raise InputError(key, f"cannot be read ({reason})", value=source, remedy=remedy) from None
    if reader.dtype.kind not in ("uifb" if key == "bad_pixels" else "uif"):
        raise InputError(key, "holds no real numbers", value=str(reader.dtype), allowed="integers or floats")
    total = reader.shape[0]
    wanted = range(total)[frames] if frames is not None else range(total)
    if not wanted:
        raise InputError("frames", "leave no frame", value=f"{total} in {source}", allowed=f"a part of 0:{total}")
    gone = set(reader.account.missing)
    chosen = tuple(i for i in wanted if i not in gone)
    if not chosen:
        raise InputError(
            key,
            "holds no frame that was written: what is there is the file's fill value",
            value=source,
            remedy="was the acquisition stopped before it began? name another file",
        )
    rows, columns = roi or (slice(None), slice(None))
    stack = Stack(key, source, reader, transpose, rows, columns, chosen)
    if min(stack.rows, stack.columns) < 1 or any(
        part.stop is not None and part.stop > size
        for part, size in ((rows, reader.shape[2 if transpose else 1]), (columns, reader.shape[1 if transpose else 2]))
    ):
        raise InputError(
            "roi",
            f"goes beyond the frames of {key}",
            value=f"rows {rows.start}:{rows.stop}, columns {columns.start}:{columns.stop}",
            allowed=f"within {' x '.join(map(str, reader.shape[:0:-1] if transpose else reader.shape[1:]))}",
        )
    return stack


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__


def _open(source: str, key: str, folder: Path) -> FrameReader:
    name, inside = split_source(source)
    if not (folder / name).is_file() and any(c in name for c in "*?["):
        absolute = Path(name).is_absolute()
        found = (
            Path(Path(name).anchor).glob(str(Path(name).relative_to(Path(name).anchor)))
            if absolute
            else folder.glob(name)
        )
        files = in_order([file for file in found if file.is_file()])
        if not files:
            raise InputError(key, "matches no file", value=source, remedy=no_file(name, source))
        return open_file(files[0], inside, key) if len(files) == 1 else _Files(files, inside, key, name)
    path = folder / name
    if not path.is_file():
        what = "is a folder" if path.is_dir() else "is not a file"
        remedy = f'write "{source}/*.tif"' if path.is_dir() else no_file(name, source)
        raise InputError(key, what, value=source, remedy=remedy)
    return open_file(path, inside, key)


class _Files:
    """Many files one after the other."""

    def __init__(self, files: list[Path], inside: str | None, key: str, pattern: str) -> None:
        self.files, self.inside, self.key = files, inside, key
        self.open: dict[int, FrameReader] = {}
        first = self._reader(0)
        self.threads = False
        self.dtype = first.dtype
        counts: list[int] = []
        missing: list[int] = []
        remarks = list(first.account.remarks)
        for i, file in enumerate(files):
            reader = self._reader(i)
            if reader.shape[1:] != first.shape[1:]:
                raise InputError(
                    key,
                    f"{file.name} has another shape than the first file",
                    value=reader.shape[1:],
                    allowed=f"{first.shape[1:]}, that of {files[0].name}",
                    remedy="take it out of the pattern, or name the frames more closely",
                )
            self.dtype = np.result_type(self.dtype, reader.dtype)
            missing += [sum(counts) + j for j in reader.account.missing]
            counts.append(reader.shape[0])
        names = [file.name for file in files]
        remarks += [*gaps(names, key), *kinds(names, key, pattern)]
        self.bounds = np.cumsum([0, *counts])
        self.shape = (int(self.bounds[-1]), *first.shape[1:])
        self.account = Account(
            f"{files[0].name} ... {files[-1].name}",
            f"{len(files)} files in the order of their numbers",
            tuple(missing),
            tuple(remarks),
            first.account.metadata,
        )

    def _reader(self, i: int) -> FrameReader:
        reader = self.open.get(i)
        if reader is None:
            if len(self.open) >= _MANY_OPEN:
                self.open.pop(next(iter(self.open)))
            reader = self.open[i] = open_file(self.files[i], self.inside, self.key)
        return reader

    def origin(self, frame: int) -> str:
        """The file of a frame, with its number in it where the file has several."""
        i = int(np.searchsorted(self.bounds, frame, side="right")) - 1
        within = frame - int(self.bounds[i])
        return self.files[i].name + (f"[{within}]" if self.bounds[i + 1] - self.bounds[i] > 1 else "")

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        out = np.empty((stop - start, *self.shape[1:]), self.dtype)
        i = int(np.searchsorted(self.bounds, start, side="right")) - 1
        at = start
        while at < stop:
            low, high = int(self.bounds[i]), int(self.bounds[i + 1])
            end = min(stop, high)
            if end > at:
                out[at - start : end - start] = self._reader(i).read(at - low, end - low)
            at, i = max(at, end), i + 1
        return out
