"""Files that are written whole or not at all, and refused before anything is computed."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from spinline.base.errors import InputError

__all__ = ["replacing", "writable"]


def writable(path: str | Path, *, force: bool = False) -> Path:
    """Check that a file can be written.

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
        If it exists (without `force`), is a folder, or its folder is missing or closed.
    """
    file = Path(path)
    if file.is_dir():
        raise InputError(str(path), "is a folder, not a file", remedy="give a file name")
    if file.exists() and not force:
        raise InputError(str(path), "exists", remedy="choose another name, or --force to overwrite")
    if not file.parent.is_dir():
        raise InputError(str(path), "cannot be written: its folder does not exist", remedy=f"make {file.parent}")
    if not os.access(file.parent, os.W_OK) or (file.exists() and not os.access(file, os.W_OK)):
        raise InputError(str(path), "cannot be written: no permission", remedy="choose another place")
    return file


@contextmanager
def replacing(path: str | Path, *, force: bool = False) -> Iterator[Path]:
    """A file beside `path` to write to, which takes its place when all went well.

    Raises
    ------
    InputError
        As `writable`, and for whatever the system says while writing.
    """
    file = writable(path, force=force)
    try:
        with tempfile.TemporaryDirectory(prefix=".spinline-", dir=file.parent) as scratch:
            part = Path(scratch) / file.name
            yield part
            part.replace(file)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(str(path), f"cannot be written ({reason})", remedy="choose another place") from None
