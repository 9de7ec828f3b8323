"""The directory of a run: which of its files are there."""

import os
import re
from pathlib import Path

from spinline.base.errors import InputError

__all__ = ["Folder"]

_FRAME = re.compile(r"frame(\d+)\.xyz", re.IGNORECASE)


class Folder:
    """A directory, of which regular files are asked for by name.

    Parameters
    ----------
    path : Path
    listed : bool
        List it once, instead of asking the system for one name after another: cheaper where many names are wanted,
        dear beside a single file among thousands.
    """

    def __init__(self, path: Path, *, listed: bool) -> None:
        self.path = path
        self._regular = _listing(path) if listed else None

    def file(self, name: str) -> Path | None:
        """The regular file of this name, None if there is none."""
        if self._regular is not None:
            return self.path / name if self._regular.get(name) else None
        path = self.path / name
        return path if os.path.isfile(path) else None

    def has(self, name: str) -> bool:
        """Whether there is a regular file of this name."""
        return self.file(name) is not None if self._regular is None else self._regular.get(name, False)

    def frames(self) -> list[str]:
        """Names of the ``frame*.xyz`` in order of their number.

        Raises
        ------
        InputError
            If the directory cannot be listed.
        """
        listing = self._regular
        if listing is None:
            listing = _listing(self.path)
        if listing is None:
            raise InputError(
                str(self.path), "cannot be listed", remedy="check its permissions, or give a file of the run itself"
            )
        numbered = [(int(match[1]), name) for name in listing if (match := _FRAME.fullmatch(name)) is not None]
        return [name for _, name in sorted(numbered)]


def _listing(path: Path) -> dict[str, bool] | None:
    """Names in a directory, and which are regular files or links to some; None if it cannot be listed."""
    try:
        with os.scandir(path) as entries:
            return {entry.name: _is_file(entry) for entry in entries}
    except OSError:
        return None


def _is_file(entry: "os.DirEntry[str]") -> bool:
    try:
        return entry.is_file()
    except OSError:  # a ring of links
        return False
