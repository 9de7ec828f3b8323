"""What is done so far, kept in a folder beside the result, so that interrupted work goes on where it stopped.

Each piece is one sealed npz file that is written whole or not at all. The folder belongs to one job: a fingerprint of the
images file, the data and the version says which, and pieces of another job are thrown away. Pieces that are damaged are
thrown away too, with a word, and made again. One process at a time has the folder.
"""

import hashlib
import io
import os
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.files import discard, make_folder, stamp, write_bytes
from spinline.base.naming import lock_folder, release_folder, unlock_folder
from spinline.base.seals import sealed, unsealed

__all__ = ["Checkpoint", "claimed", "fingerprint", "pack", "unpack"]

_MARK = "spinline-job"
_OWN = re.compile(rf"{_MARK}|[^/]+\.npz|\.[^/]+\.part")


class Checkpoint:
    """Pieces of one job on disk.

    Parameters
    ----------
    folder : path
        Made if need be.
    job : str
        From `fingerprint`; None in a process that only adds pieces to a folder another one looks after.
    afresh : bool
        Throw away what is there of the same job too.

    Raises
    ------
    InputError
        If something that is no checkpoint is in the way, or another process has it.
    """

    def __init__(self, folder: Path, job: str | None, *, afresh: bool = False) -> None:
        self.folder = folder
        if job is None:
            return
        if os.path.lexists(folder):
            self._take(job, afresh)
        if not os.path.lexists(folder):
            make_folder(folder)
            write_bytes(folder / _MARK, sealed(job.encode()))
        lock_folder(folder)

    def _take(self, job: str, afresh: bool) -> None:
        """Go on with the folder, or throw away what is another job's, or damaged."""
        _folder_of_ours(self.folder)
        lock_folder(self.folder)
        if not os.listdir(self.folder):  # claimed
            write_bytes(self.folder / _MARK, sealed(job.encode()))
            return
        try:
            content = unsealed((self.folder / _MARK).read_bytes())
        except OSError:
            content = None
        if content == job.encode() and not afresh:
            return
        unlock_folder(self.folder)
        try:
            discard(self.folder, lambda name: _OWN.fullmatch(name) is not None)
        except InputError as error:
            raise InputError(
                str(self.folder),
                f"is in the way: it {error.problem}",
                value=error.value,
                remedy="move it, or choose another OUT",
            ) from None
        if content is None:
            words = f"{self.folder} is damaged: the work is done again from the start"
            warnings.warn(words, SpinlineWarning, stacklevel=4)

    def save(self, name: str, **arrays: Any) -> None:
        """Store a piece."""
        write_bytes(self.folder / f"{name}.npz", pack(arrays), force=True)

    def load(self, name: str) -> dict[str, NDArray[Any]] | None:
        """A piece; None where there is none, or a damaged one, which is thrown away with a word."""
        file = self.folder / f"{name}.npz"
        if not file.is_file():
            return None
        try:
            found = unpack(file.read_bytes())
        except OSError:
            found = None
        if found is None:
            warnings.warn(f"{file} is damaged: that part is done again", SpinlineWarning, stacklevel=2)
            file.unlink(missing_ok=True)
        return found

    def has(self, name: str) -> bool:
        """Whether a piece is there, and whole."""
        return self.load(name) is not None

    def clear(self) -> None:
        """Throw all of it away: the job is done."""
        unlock_folder(self.folder)
        try:
            discard(self.folder, lambda name: _OWN.fullmatch(name) is not None)
        except InputError as error:
            warnings.warn(str(error), SpinlineWarning, stacklevel=2)


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """Within it a checkpoint's folder is this process's, before the job is known; one in which nothing is kept is removed.

    Raises
    ------
    InputError
        As `Checkpoint`.
    """
    if os.path.lexists(folder):
        _folder_of_ours(folder)
    make_folder(folder)
    lock_folder(folder)
    try:
        yield
    finally:
        release_folder(folder)


def _folder_of_ours(folder: Path) -> None:
    if not folder.is_dir() or folder.is_symlink():
        raise InputError(str(folder), "is in the way: it is no checkpoint", remedy="move it, or choose another OUT")


def pack(arrays: dict[str, Any]) -> bytes:
    """Arrays as the bytes of a sealed npz file."""
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return sealed(stream.getvalue())


def unpack(data: bytes) -> dict[str, NDArray[Any]] | None:
    """What `pack` packed; None if it is damaged or something else."""
    body = unsealed(data)
    if body is None:
        return None
    try:
        with np.load(io.BytesIO(body), allow_pickle=False) as found:
            return {key: found[key] for key in found.files}
    except Exception:  # sealed, but no npz of ours
        return None


def fingerprint(text: str, files: list[Path]) -> str:
    """Name of a job: its text, and its files with what changes when they change."""
    digest = hashlib.sha256(text.encode("utf-8", "backslashreplace"))
    for file in files:
        digest.update(f"\n{file.resolve()} {stamp(file)[2:4]}".encode("utf-8", "backslashreplace"))
    return digest.hexdigest()
