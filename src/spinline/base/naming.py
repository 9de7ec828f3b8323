"""How a file that is written gets its name: in one step, once, and without leavings. Used by `files` alone."""

import errno
import os
import shutil
import stat
import tempfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from socket import gethostname
from typing import IO

from spinline.base.errors import InputError

__all__ = [
    "SCRATCH",
    "clear_leavings",
    "keep_mode",
    "kind_of",
    "lock_folder",
    "named",
    "nameless",
    "reason_of",
    "release_folder",
    "scratch_folder",
    "scratch_name",
    "sync_folder",
    "unlock_folder",
]

SCRATCH = ".spinline-"  # how the names of what is under way begin; machine and process follow


def scratch_name(folder: Path, ending: str = "") -> Path:
    """A name for what is under way, which says whose it is."""
    return folder / f"{SCRATCH}{_machine()}-{os.getpid()}-{ending or os.urandom(4).hex()}"


@contextmanager
def scratch_folder(folder: Path) -> Iterator[Path]:
    """A folder for what is under way; what dead processes left beside it is removed."""
    clear_leavings(folder)
    with tempfile.TemporaryDirectory(prefix=f"{scratch_name(folder).name}-", dir=folder) as made:
        yield Path(made)


@contextmanager
def nameless(folder: Path) -> Iterator[tuple[IO[bytes], Callable[[Path, bool], None]]]:
    """A file without a name, and what gives it one; where the file system has none such, one in a scratch folder."""
    clear_leavings(folder)
    try:
        handle = os.open(folder, os.O_TMPFILE | os.O_RDWR, 0o666)
    except (AttributeError, OSError) as error:  # no such flag, or no such file system
        if getattr(error, "errno", None) in (errno.ENOSPC, errno.EROFS, errno.EDQUOT, errno.EACCES):
            raise
        with scratch_folder(folder) as scratch, (scratch / "part").open("wb+", buffering=0) as raw:

            def close_and_name(target: Path, force: bool) -> None:
                raw.close()  # Windows renames no open file
                named(scratch / "part", target, force=force)

            yield raw, close_and_name
        return
    with os.fdopen(handle, "wb+", buffering=0) as raw:

        def give_name(target: Path, force: bool) -> None:
            link = f"/proc/self/fd/{handle}"
            if not os.path.lexists(target):
                _link(link, target)
                return
            if not force:
                raise OSError(errno.EEXIST, "exists")
            part = scratch_name(folder)
            _link(link, part)
            try:
                part.replace(target)
            except OSError:
                part.unlink(missing_ok=True)
                raise

        yield raw, give_name


def named(part: Path, target: Path, *, force: bool) -> None:
    """Give a file that is whole the name it is to have."""
    if force:
        part.replace(target)
        return
    try:
        os.link(part, target)
    except OSError as error:
        if error.errno not in (errno.EPERM, errno.ENOTSUP, errno.EOPNOTSUPP, errno.EMLINK):
            raise
        with target.open("xb"):  # no hard links here: take the name first
            pass
        part.replace(target)


def keep_mode(handle: int, target: Path) -> None:
    """A file that is replaced keeps its permissions."""
    with suppress(OSError, AttributeError):  # a system without permissions of this kind
        os.fchmod(handle, stat.S_IMODE(os.stat(target).st_mode))


def sync_folder(folder: Path) -> None:
    """The names in a folder reach the disk."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def kind_of(mode: int) -> str:
    """In words, what is there in place of a regular file."""
    kinds: tuple[tuple[Callable[[int], bool], str], ...] = (
        (stat.S_ISDIR, "a folder"),
        (stat.S_ISFIFO, "a pipe"),
        (stat.S_ISCHR, "a device"),
        (stat.S_ISBLK, "a device"),
        (stat.S_ISSOCK, "a socket"),
    )
    return next((words for test, words in kinds if test(mode)), "no regular file")


def reason_of(error: BaseException) -> str:
    """What the system said, in one line."""
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return str(text).splitlines()[0]


def lock_folder(folder: Path) -> None:
    """Take a folder for this process, until it ends or lets go; nothing is left in the folder.

    Raises
    ------
    InputError
        If another process has it.
    """
    if os.name == "nt":  # folders are not opened there; the exclusive making of files still holds
        return
    taken = InputError(str(folder), "is being written by another process", remedy="wait for it, or choose another OUT")
    try:
        handle = os.open(folder, os.O_RDONLY)
    except FileNotFoundError:  # it has just let go of it
        raise taken from None
    state = os.fstat(handle)
    if (state.st_dev, state.st_ino) in _locks:
        os.close(handle)
        return
    try:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise taken from None
    except (ImportError, OSError):  # a system, or a file system, without locks
        pass
    _locks[state.st_dev, state.st_ino] = handle


def unlock_folder(folder: Path) -> None:
    """Let go of a folder, before it is removed."""
    with suppress(OSError):
        state = os.stat(folder)
        handle = _locks.pop((state.st_dev, state.st_ino), None)
        if handle is not None:
            os.close(handle)


def release_folder(folder: Path) -> None:
    """Let go of a folder that this process has; an empty one is removed while it is still this one's."""
    with suppress(OSError):
        state = os.stat(folder)
        handle = _locks.get((state.st_dev, state.st_ino))
        if handle is None and os.name != "nt":
            return
        with suppress(OSError):
            folder.rmdir()
        if handle is not None:
            del _locks[state.st_dev, state.st_ino]
            os.close(handle)


_locks: dict[tuple[int, int], int] = {}


def _link(source: str, target: Path) -> None:
    folder = os.open(target.parent, os.O_RDONLY)
    try:  # a folder's handle makes Python follow the link in /proc
        os.link(source, target.name, dst_dir_fd=folder, follow_symlinks=True)
    finally:
        os.close(folder)


def _machine() -> str:
    return f"{zlib.crc32(gethostname().encode()):08x}"


def clear_leavings(folder: Path) -> None:
    """Remove what processes of this machine left in a folder when they were killed."""
    ours = f"{SCRATCH}{_machine()}-"
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if not entry.name.startswith(ours):
                continue
            owner = entry.name.removeprefix(ours).partition("-")[0]
            if owner.isdigit() and not _alive(int(owner)):
                if entry.is_dir(follow_symlinks=False):
                    shutil.rmtree(entry.path, ignore_errors=True)
                else:
                    with suppress(OSError):
                        os.unlink(entry.path)


def _alive(process: int) -> bool:
    if os.name == "nt":  # signal 0 would end it there
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True
