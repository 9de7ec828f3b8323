"""Content of a run's files, each opened once: a small one is read, a large one mapped into memory."""

import mmap
import os
from pathlib import Path

from spinline.base.errors import InputError
from spinline.base.files import readable

__all__ = ["Content", "content_of", "forget_pages"]

Content = mmap.mmap | bytes
_SMALL = 2 << 20  # bytes; mapping costs more than reading below


def content_of(path: Path) -> Content:
    """All bytes of a file; what is mapped may be larger than memory.

    Raises
    ------
    InputError
        If it is no file, or cannot be opened.
    """
    try:
        with open(readable(path), "rb", buffering=0) as file:  # read at once as a whole
            if os.fstat(file.fileno()).st_size <= _SMALL:
                return file.read()
            return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    except OSError as error:
        raise InputError(
            str(path), f"cannot be opened ({error.strerror})", remedy="check the path and its permissions"
        ) from None


def forget_pages(content: Content) -> None:
    """Let go of the pages of a mapped file that have been read."""
    if isinstance(content, mmap.mmap) and hasattr(mmap, "MADV_DONTNEED"):
        content.madvise(mmap.MADV_DONTNEED)
