"""Content of a run's files, each opened once: a small one is read, a large one mapped into memory."""

import mmap
import os
from pathlib import Path

from spinline.base.errors import InputError
from spinline.base.files import readable

__all__ = ["Content", "content_of", "forget_pages", "head_of"]

Content = mmap.mmap | bytes
_SMALL = 2 << 20  # bytes; mapping costs more than reading below
_FLAGS = os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)


def content_of(path: Path) -> Content:
    """All bytes of a file; what is mapped may be larger than memory.

    Raises
    ------
    InputError
        If it is no file, or cannot be opened.
    """
    return _content(path, None)


def head_of(path: Path, size: int) -> bytes:
    """The first bytes of a file; raises as `content_of`."""
    return bytes(_content(path, size))


def _content(path: Path, wanted: int | None) -> Content:
    try:
        file = os.open(readable(path), _FLAGS)  # a file object asks the system three times as much
        try:
            size = os.fstat(file).st_size
            if size > _SMALL and wanted is None:
                return mmap.mmap(file, 0, access=mmap.ACCESS_READ)
            return _read(file, size if wanted is None else min(wanted, size))
        finally:
            os.close(file)
    except OSError as error:
        raise InputError(
            str(path), f"cannot be opened ({error.strerror})", remedy="check the path and its permissions"
        ) from None


def _read(file: int, size: int) -> bytes:
    """So many bytes, or as many as there are."""
    found = os.read(file, size)
    while len(found) < size and (more := os.read(file, size - len(found))):
        found += more
    return found


def forget_pages(content: Content) -> None:
    """Let go of the pages of a mapped file that have been read."""
    if isinstance(content, mmap.mmap) and hasattr(mmap, "MADV_DONTNEED"):
        content.madvise(mmap.MADV_DONTNEED)
