"""Files in and out: the one place that opens a file for writing.

What holds for every file that is written:

* whole or not at all: the bytes go to a file without a name, reach the disk (fsync) and take their name in one step;
  a kill at any moment leaves the old file or the new one, and nothing beside it;
* a new file takes its name only where there is none: of two processes one is told;
* only a regular file is replaced, and only if asked; a symbolic link stays, what it points to is replaced; folders,
  devices, pipes and sockets are refused;
* a file that the same command reads (`command`, `note_input`) is never replaced, by whatever name;
* a full or read-only disk is one message.
"""

import errno
import os
import re
import shutil
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import IO, Any

from spinline.base.errors import InputError
from spinline.base.naming import (
    SCRATCH,
    keep_mode,
    kind_of,
    named,
    nameless,
    reason_of,
    scratch_folder,
    scratch_name,
    sync_folder,
)
from spinline.base.seals import digest_of, trailer

__all__ = [
    "Sink",
    "command",
    "copy_file",
    "copy_tree",
    "discard",
    "make_folder",
    "new_folder",
    "note_input",
    "outputs",
    "readable",
    "replacing",
    "stamp",
    "streaming",
    "writable",
    "write_bytes",
    "write_text",
]

_ELSEWHERE = "choose another place"
_inputs: ContextVar[set[tuple[int, int]] | None] = ContextVar("inputs", default=None)


def stamp(path: str | Path) -> tuple[int, ...]:
    """What changes when a file changes: device, inode, size, times of content and inode. Key of caches.

    Raises
    ------
    InputError
        If the file is not there.
    """
    try:
        state = os.stat(path)
    except (OSError, ValueError) as error:
        raise InputError(str(path), f"cannot be read ({reason_of(error)})", remedy="check the path") from None
    return state.st_dev, state.st_ino, state.st_size, state.st_mtime_ns, state.st_ctime_ns


@contextmanager
def command() -> Iterator[None]:
    """Within it, files that were read are inputs, which nothing that is written may replace."""
    token = _inputs.set(set())
    try:
        yield
    finally:
        _inputs.reset(token)


def note_input(path: str | Path) -> None:
    """Say that a file is an input of the present command."""
    known = _inputs.get()
    if known is not None:
        with suppress(OSError, ValueError):
            state = os.stat(path)
            known.add((state.st_dev, state.st_ino))


def readable(path: str | Path, field: str | None = None, remedy: str = "check the path") -> Path:
    """A regular file that is there, noted as an input of the command.

    Parameters
    ----------
    path : path
    field : str, optional
        Key shown in the error; default: the path itself.
    remedy : str

    Raises
    ------
    InputError
        For anything else: a pipe would wait for ever, a device never ends.
    """
    name = str(path) if field is None else field
    shown = None if field is None else str(path)
    try:
        mode = os.stat(path).st_mode
    except (OSError, ValueError) as error:
        problem = "is not a file" if isinstance(error, FileNotFoundError) else f"cannot be read ({reason_of(error)})"
        raise InputError(name, problem, value=shown, remedy=remedy) from None
    if not stat.S_ISREG(mode):
        raise InputError(name, f"is {kind_of(mode)}, not a file", value=shown, remedy=remedy)
    note_input(path)
    return path if isinstance(path, Path) else Path(path)


def writable(path: str | Path, *, force: bool = False) -> Path:
    """Check that a file can be written, before anything is computed.

    Parameters
    ----------
    path : path
        File to write.
    force : bool
        Let it exist.

    Returns
    -------
    Path

    Raises
    ------
    InputError
        If it exists (without `force`), is no regular file, is an input of this command, or its folder is missing or
        closed.
    """
    file = Path(path)
    target = _target(file)
    mode: int | None
    try:
        mode = os.stat(target).st_mode
    except (FileNotFoundError, NotADirectoryError):
        mode = None
    except (OSError, ValueError) as error:
        raise InputError(str(path), f"cannot be written ({reason_of(error)})", remedy=_ELSEWHERE) from None
    if mode is not None and stat.S_ISDIR(mode):
        raise InputError(str(path), "is a folder, not a file", remedy="give a file name")
    if mode is not None and not stat.S_ISREG(mode):
        raise InputError(str(path), f"is {kind_of(mode)}: nothing is written over it", remedy="give a file name")
    _spare_inputs(file, target)
    if mode is not None and not force:
        raise InputError(str(path), "exists", remedy="choose another name, or --force to overwrite")
    if not target.parent.is_dir():
        raise InputError(str(path), "cannot be written: its folder does not exist", remedy=f"make {target.parent}")
    if not os.access(target.parent, os.W_OK) or (mode is not None and not os.access(target, os.W_OK)):
        raise InputError(str(path), "cannot be written: no permission", remedy=_ELSEWHERE)
    return file


# of tables, texts, pictures and films: never netCDF
_NO_RESULT = re.compile(
    r"\.(?:csv|tsv|txt|dat|xlsx?|json|toml|html|png|pdf|svg|jpe?g|tiff?|vtk|vtp|xyz|gif|mp4|zip)", re.IGNORECASE
)


def outputs(
    *paths: str | Path | None,
    force: bool = False,
    result: Path | None = None,
    form: tuple[str, str] = ("netCDF", ".nc"),
) -> None:
    """Check all files that a command is going to write, before anything is computed: each `writable`, no two the same.

    `result` is written as `form`, a format and its ending: a name that says another format is refused.

    Raises
    ------
    InputError
    """
    known: dict[str, str | Path] = {}
    for path in paths:
        if path is None:
            continue
        writable(path, force=force)
        place = os.path.realpath(path)
        if place in known:
            raise InputError(
                str(path), "is named for two outputs", value=str(known[place]), remedy="give each a name of its own"
            )
        known[place] = path
    if result is not None and _NO_RESULT.fullmatch(result.suffix):
        raise InputError(
            str(result),
            f"is written as {form[0]}, and is named as {result.suffix}",
            allowed=form[1],
            remedy=f"name it {result.with_suffix(form[1])}; tables, figures and pages have options of their own (--help)",
        )


def write_bytes(path: str | Path, data: bytes | memoryview, *, force: bool = False) -> Path:
    """Write a file, whole or not at all; see the head of this module.

    Raises
    ------
    InputError
        As `writable`, and for whatever the system says while writing.
    """
    with streaming(path, force=force) as sink:
        sink.write(data)
    return Path(path)


def write_text(path: str | Path, text: str, *, force: bool = False) -> Path:
    """Write UTF-8 text as `write_bytes` does."""
    return write_bytes(path, text.encode("utf-8", errors="backslashreplace"), force=force)


class Sink:
    """A file to write to, at any place, that never raises in the middle of a library.

    HDF5 crashes when its file cannot be flushed. What the disk does not take is kept here instead, `check` says so, and
    `streaming` raises once the library is done.
    """

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self._full: OSError | None = None
        self._rest: dict[int, bytes] = {}

    def write(self, data: Any) -> int:
        """Write at the present place."""
        view = memoryview(data).cast("B")
        if self._full is None:
            start, done = self._file.tell(), 0
            try:
                while done < len(view):
                    done += self._file.write(view[done:])
            except OSError as error:
                self._full = error
                self._file.seek(start)
            else:
                return done
        self._rest[self._file.tell()] = bytes(view)
        self._file.seek(len(view), os.SEEK_CUR)
        return len(view)

    def read(self, size: int = -1) -> bytes:
        """Read from the present place."""
        if self._full is not None and (raw := self._rest.get(self._file.tell())) is not None:
            self._file.seek(len(raw), os.SEEK_CUR)
            return raw[: size if size >= 0 else None]
        return self._file.read(size)

    def readinto(self, buffer: Any) -> int:
        """Read into a buffer; what is not there is zeros."""
        view = memoryview(buffer).cast("B")
        data = self.read(len(view))
        view[: len(data)] = data
        view[len(data) :] = bytes(len(view) - len(data))
        return len(view)

    def seek(self, offset: int, whence: int = 0) -> int:
        """Move."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Present place."""
        return self._file.tell()

    def truncate(self, size: int | None = None) -> int:
        """Cut, or lengthen with zeros."""
        if self._full is None:
            try:
                return self._file.truncate(size)
            except OSError as error:
                self._full = error
        return self._file.tell() if size is None else size

    def flush(self) -> None:
        """Nothing is held back."""

    def check(self) -> None:
        """Raise what the system said, if it did."""
        if self._full is not None:
            raise self._full

    def seal(self) -> None:
        """Put the checksum of all that was written behind it."""
        self.check()
        self._file.seek(0)
        end = trailer(digest_of(self._file))
        self._file.seek(0, os.SEEK_END)
        self.write(end)
        self.check()


@contextmanager
def streaming(path: str | Path, *, force: bool = False, sealing: bool = False) -> Iterator[Sink]:
    """A file without a name to write to at any place; it takes the name `path` when all went well.

    Parameters
    ----------
    path : path
    force : bool
        Replace a regular file.
    sealing : bool
        End it with a seal.

    Raises
    ------
    InputError
        As `writable`, and for whatever the system says while writing.
    """
    file = writable(path, force=force)
    target = _target(file)
    with _refusals(path), nameless(target.parent) as (raw, give_name):
        sink = Sink(raw)
        yield sink
        sink.check()
        if sealing:
            sink.seal()
        os.fsync(raw.fileno())
        keep_mode(raw.fileno(), target)
        _spare_inputs(file, target)
        give_name(target, force)
        sync_folder(target.parent)


@contextmanager
def replacing(path: str | Path, *, force: bool = False) -> Iterator[Path]:
    """A path to write to for libraries that want one; what is there in the end takes the name `path`.

    Raises
    ------
    InputError
        As `streaming`.
    """
    file = writable(path, force=force)
    target = _target(file)
    with _refusals(path), scratch_folder(target.parent) as scratch:
        part = scratch / target.name
        yield part
        with part.open("rb+") as written:
            os.fsync(written.fileno())
            keep_mode(written.fileno(), target)
        _spare_inputs(file, target)
        named(part, target, force=force)
        sync_folder(target.parent)


@contextmanager
def new_folder(path: str | Path) -> Iterator[Path]:
    """A folder to fill that takes the name `path` when all went well, if nothing has it by then.

    Raises
    ------
    InputError
    """
    place = Path(path)
    if os.path.lexists(place):
        raise InputError(str(path), "exists", remedy="choose another name")
    writable(place)
    with _refusals(path), scratch_folder(place.parent) as scratch:
        inside = scratch / "folder"
        inside.mkdir()
        yield inside
        for file in inside.rglob("*"):
            if file.is_file():
                with file.open("rb+") as written:
                    os.fsync(written.fileno())
        if os.path.lexists(place):
            raise OSError(errno.EEXIST, "exists")
        inside.rename(place)
        sync_folder(place.parent)


def discard(folder: Path, own: Callable[[str], bool]) -> None:
    """Remove a folder of ours, and nothing of anybody else's.

    Parameters
    ----------
    folder : Path
    own : callable
        Of a path relative to the folder, with ``/``: whether the program made that file.

    Raises
    ------
    InputError
        If the folder is a symbolic link, or holds anything that is not ours; then nothing is removed.
    """
    if folder.is_symlink() or not folder.is_dir():
        raise InputError(str(folder), "is not a folder of this program's", remedy="choose another name")
    files = [file for file in folder.rglob("*") if file.is_symlink() or not file.is_dir()]
    names = [file.relative_to(folder).as_posix() for file in files]
    foreign = sorted(name for name in names if not own(name) and not name.rpartition("/")[2].startswith(SCRATCH))
    if foreign:
        shown = ", ".join(foreign[:3]) + (f" and {len(foreign) - 3} more" if len(foreign) > 3 else "")
        raise InputError(
            str(folder),
            "holds files that are not its own, and is left alone",
            value=shown,
            remedy="move them, or choose another name",
        )
    try:
        grave = scratch_name(folder.parent)
        folder.rename(grave)  # at once: half a store is never seen
        shutil.rmtree(grave)
    except OSError as error:
        raise InputError(str(folder), f"cannot be removed ({reason_of(error)})", remedy=_ELSEWHERE) from None


def copy_file(source: Path, target: Path, *, force: bool = False) -> Path:
    """Copy a file, as `write_bytes` writes."""
    note_input(source)
    try:
        data = source.read_bytes()
    except OSError as error:
        raise InputError(str(source), f"cannot be read ({reason_of(error)})", remedy="check the path") from None
    return write_bytes(target, data, force=force)


def copy_tree(source: Path, target: Path, *, force: bool = False) -> None:
    """Copy the files of a folder; all names are checked before the first is written."""
    if not os.path.lexists(target):
        with new_folder(target) as inside:
            shutil.copytree(source, inside, dirs_exist_ok=True)
        return
    files = [file for file in sorted(source.rglob("*")) if file.is_file()]
    places = [target / file.relative_to(source) for file in files]
    for place in places:
        make_folder(place.parent)
        writable(place, force=force)
    for file, place in zip(files, places, strict=True):
        copy_file(file, place, force=force)


def make_folder(path: Path) -> Path:
    """A folder that is there, made if need be.

    Raises
    ------
    InputError
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(str(path), f"cannot be made ({reason_of(error)})", remedy=_ELSEWHERE) from None
    return path


@contextmanager
def _refusals(path: str | Path) -> Iterator[None]:
    """What the system says while writing, as one message."""
    try:
        yield
    except OSError as error:
        if error.errno in (errno.EEXIST, errno.ENOTEMPTY, errno.ENOTDIR):
            raise InputError(
                str(path),
                "was made by another process meanwhile",
                remedy="choose another name, or start the same command again",
            ) from None
        raise InputError(str(path), f"cannot be written ({reason_of(error)})", remedy=_ELSEWHERE) from None


def _target(file: Path) -> Path:
    """The file itself, or where a symbolic link leads."""
    try:
        return Path(os.path.realpath(file)) if file.is_symlink() else file
    except (OSError, ValueError) as error:
        raise InputError(str(file), f"cannot be written ({reason_of(error)})", remedy=_ELSEWHERE) from None


def _spare_inputs(file: Path, target: Path) -> None:
    known = _inputs.get()
    if not known:
        return
    try:
        state = os.stat(target)
    except OSError:
        return
    if (state.st_dev, state.st_ino) in known:
        raise InputError(
            str(file), "is an input of this very command: it is not written over", remedy="choose another name"
        )
