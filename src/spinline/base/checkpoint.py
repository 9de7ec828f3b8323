"""What is done so far, kept in a folder beside the result, so that interrupted work goes on where it stopped.

Each piece is one npz file that is written whole or not at all. The folder belongs to one job: a fingerprint of the images file,
the data and the version says which, and pieces of another job are thrown away.
"""

import hashlib
import os
import shutil
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.errors import InputError

__all__ = ["Checkpoint", "fingerprint"]

_MARK = "spinline-job"


class Checkpoint:
    """Pieces of one job on disk.

    Parameters
    ----------
    folder : path
        Made if need be.
    job : str
        From `fingerprint`; None in a process that only adds pieces to a folder another one looks after.
    """

    def __init__(self, folder: Path, job: str | None) -> None:
        self.folder = folder
        if job is None:
            return
        mark = folder / _MARK
        try:
            if folder.exists():
                if not mark.is_file():
                    raise InputError(
                        str(folder), "is in the way: it is no checkpoint", remedy="move it, or choose another OUT"
                    )
                if mark.read_text(encoding="ascii") != job:
                    shutil.rmtree(folder)
            if not folder.exists():
                folder.mkdir()
                mark.write_text(job, encoding="ascii")
        except OSError as error:
            raise InputError(
                str(folder), f"cannot be written ({error.strerror})", remedy="choose another OUT"
            ) from None

    def save(self, name: str, **arrays: Any) -> None:
        """Store a piece."""
        part = self.folder / f".{name}.{os.getpid()}.part"
        with part.open("wb") as file:
            np.savez(file, **arrays)
        part.replace(self.folder / f"{name}.npz")

    def load(self, name: str) -> dict[str, NDArray[Any]] | None:
        """A piece, or None."""
        file = self.folder / f"{name}.npz"
        if not file.is_file():
            return None
        with np.load(file, allow_pickle=False) as data:
            return {key: data[key] for key in data.files}

    def has(self, name: str) -> bool:
        """Whether a piece is there."""
        return (self.folder / f"{name}.npz").is_file()

    def clear(self) -> None:
        """Throw all of it away: the job is done."""
        shutil.rmtree(self.folder, ignore_errors=True)


def fingerprint(text: str, files: list[Path]) -> str:
    """Name of a job: its text, and name, size and time of its files."""
    digest = hashlib.sha256(text.encode())
    for file in files:
        state = file.stat()
        digest.update(f"\n{file.resolve()} {state.st_size} {state.st_mtime_ns}".encode())
    return digest.hexdigest()
