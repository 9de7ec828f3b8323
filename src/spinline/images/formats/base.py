"""What every format of frame files shares: the reader's protocol, its account of a file, and the registry of formats."""

import pkgutil
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from spinline.base.errors import InputError

__all__ = [
    "Account",
    "Array",
    "FrameFormat",
    "FrameReader",
    "PlacedFrames",
    "formats",
    "frames_shape",
    "needs",
    "not_cut_short",
    "open_file",
    "register",
    "split_source",
]

#: Any array of numbers.
Array = NDArray[Any]
_HEAD = 64  # bytes by which a format may know its files


@dataclass(frozen=True)
class Account:
    """What a file holds, and what of it is not there.

    Attributes
    ----------
    source : str
        The file, with the array inside it where there are several.
    parts : str
        What its frames are: "12 pages", "3 datasets of 4 frames"; empty where there is nothing to say.
    missing : tuple of int
        Frames that were never written: what is read there is no measurement.
    remarks : tuple of str
        What else the file holds that is not read.
    metadata : dict
        SI numbers that the file gives: "energy" (J), "pixel_size" (m), "propagation_distance" (m).
    """

    source: str
    parts: str = ""
    missing: tuple[int, ...] = ()
    remarks: tuple[str, ...] = ()
    metadata: dict[str, float] = field(default_factory=dict)


class FrameReader(Protocol):
    """Frames of one file, read a few at a time.

    Attributes
    ----------
    shape : (int, int, int)
        Frames, rows, columns.
    dtype : numpy.dtype
        Of what `read` returns.
    threads : bool
        Several threads may read at once.
    account : Account
    """

    @property
    def shape(self) -> tuple[int, int, int]:
        """Frames, rows, columns."""

    @property
    def dtype(self) -> np.dtype[Any]:
        """Of what `read` returns."""

    @property
    def threads(self) -> bool:
        """Several threads may read at once."""

    @property
    def account(self) -> Account:
        """What the file holds."""

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`, shape (stop - start, rows, columns)."""


class PlacedFrames:
    """Frames of plain numbers at known places in a file.

    Parameters
    ----------
    path, key
    places : sequence of int
        Byte at which each frame begins.
    shape : (int, int)
        Rows and columns.
    kind : str
        Of the numbers, as numpy writes it.
    name : str
        Of the format, for the account.
    """

    threads = True

    def __init__(
        self, path: Path, key: str, places: Sequence[int], shape: tuple[int, int], kind: str, name: str
    ) -> None:
        self.path, self.places, self.dtype = path, places, np.dtype(kind)
        self.shape = frames_shape((len(places), *shape), key, path.name)
        self.account = Account(path.name, f"{len(places)} frames ({name})")

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        count = self.shape[1] * self.shape[2]
        places = self.places[start:stop]
        out = np.empty((len(places), *self.shape[1:]), self.dtype)
        with self.path.open("rb") as file:
            for i, place in enumerate(places):
                file.seek(place)
                one = np.frombuffer(file.read(count * self.dtype.itemsize), self.dtype)
                if one.size != count:
                    raise EOFError(f"{self.path.name} ends early, in frame {start + i}")
                out[i] = one.reshape(self.shape[1:])
        return out


def not_cut_short(path: Path, key: str, size: int) -> None:
    """Refuse a file that is smaller than its header says."""
    if path.stat().st_size < size:
        raise InputError(
            key, "is cut short", value=f"{path.name}: {path.stat().st_size} bytes of {size}", remedy="copy it again"
        )


class FrameFormat(Protocol):
    """A kind of file.

    Attributes
    ----------
    name : str
    suffixes : tuple of str
        In lower case, with the dot.
    inside : bool
        One file may hold several arrays: ``file.h5:/path/inside``.
    """

    name: str
    suffixes: tuple[str, ...]
    inside: bool

    def owns(self, head: bytes) -> bool:
        """Whether a file that begins so is of this kind."""

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open a file; `key` is that of the images file, for errors and for arrays by name.

        Raises
        ------
        InputError
            For what cannot be read: naming the key, the file and what to do.
        """


_REGISTERED: dict[str, FrameFormat] = {}


def register(form: FrameFormat) -> None:
    """Add a format; one of the same name is replaced."""
    formats()
    _REGISTERED[form.name] = form


def formats() -> dict[str, FrameFormat]:
    """All formats by name: those of this folder, and those that were registered."""
    for name, form in _built_in().items():
        _REGISTERED.setdefault(name, form)
    return dict(_REGISTERED)


@cache
def _built_in() -> dict[str, FrameFormat]:
    package = import_module("spinline.images.formats")
    found = {}
    for module in pkgutil.iter_modules(package.__path__):
        form = getattr(import_module(f"{package.__name__}.{module.name}"), "FORMAT", None)
        if form is not None:
            found[form.name] = form
    return found


def split_source(source: str) -> tuple[str, str | None]:
    """File (or pattern), and the path inside it: of "scan.h5:/entry/data" "scan.h5" and "/entry/data"."""
    suffixes = sorted({suffix for form in formats().values() if form.inside for suffix in form.suffixes}, key=len)
    match = re.fullmatch(
        rf"(?P<file>.+(?:{'|'.join(map(re.escape, suffixes))}))(?::(?P<inside>/?[^:]+))?", source, re.IGNORECASE
    )
    return (match["file"], match["inside"]) if match else (source, None)


def open_file(path: Path, inside: str | None, key: str) -> FrameReader:
    """Open a file by its suffix, or by its first bytes where the suffix says nothing.

    Raises
    ------
    InputError
        For a file of no known kind, or what its format refuses.
    """
    known = formats().values()
    candidates = [form for form in known if path.name.lower().endswith(form.suffixes)]
    with path.open("rb") as file:
        head = file.read(_HEAD)
    if not head:
        raise InputError(key, "is an empty file", value=path.name, remedy="copy it again")
    mine = [form for form in candidates if form.owns(head)] or [form for form in known if form.owns(head)] or candidates
    if not mine:
        packed = head.startswith((b"\x1f\x8b", b"BZh", b"\xfd7zXZ", b"\x28\xb5\x2f\xfd"))
        raise InputError(
            key,
            "is of no known kind",
            value=path.name,
            remedy="it is compressed: unpack it" if packed else "save it as TIFF or npy",
            allowed=", ".join(sorted({s for form in known for s in form.suffixes})) + ", or a pattern",
        )
    return mine[0].open(path, inside, key)


def frames_shape(shape: tuple[int, ...], key: str, source: str) -> tuple[int, int, int]:
    """(frames, rows, columns) of an array: one dimension is one row, two are one frame.

    Raises
    ------
    InputError
        For other numbers of dimensions, or none of something.
    """
    if len(shape) > 3:
        shape = (*(n for n in shape[:-2] if n != 1), *shape[-2:])
    full = (1,) * (3 - len(shape)) + tuple(shape)
    if not 1 <= len(shape) <= 3 or min(full) < 1:
        raise InputError(
            key,
            "is not a stack of frames",
            value=f"{source}: array of shape {shape}",
            allowed="(frame, z, x) or (z, x)",
        )
    return full[0], full[1], full[2]


def needs(package: str, key: str, source: str, why: str) -> InputError:
    """The refusal of a file whose decoder is not installed."""
    return InputError(
        key,
        f"needs the package {package} ({why})",
        value=source,
        remedy=f"pip install {package}, or all of them: pip install spinline[formats]; or save it uncompressed as TIFF or npy",
    )
