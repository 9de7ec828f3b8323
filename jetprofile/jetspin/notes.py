"""What a reader met on its way: counted by kind, warned about once, and kept with the result."""

import warnings
from dataclasses import dataclass
from operator import index
from typing import SupportsIndex

from spinline.base.errors import SpinlineWarning

__all__ = ["Notes"]


@dataclass
class _Entry:
    count: int
    warn: bool
    dropped: bool
    told: bool = False


class Notes:
    """Oddities of one reading, one entry per kind.

    Parameters
    ----------
    where : str
        Name of the file or run, put before every warning.
    """

    def __init__(self, where: str) -> None:
        self.where = where
        self._entries: dict[str, _Entry] = {}

    def add(self, text: str, count: SupportsIndex = 1, *, warn: bool = True, dropped: bool = False) -> None:
        """Count `count` more oddities of the kind `text`, in which ``{n}`` stands for their number.

        `warn` makes it a warning; `dropped` lists it among what was left out of the result.
        """
        number = index(count)
        if number <= 0:
            return
        entry = self._entries.setdefault(text, _Entry(0, warn, dropped))
        entry.count += number

    def include(self, other: "Notes") -> None:
        """Count all that `other` has counted."""
        for text, entry in other._entries.items():
            self.add(text, entry.count, warn=entry.warn, dropped=entry.dropped)

    def _texts(self, *, warn: bool, dropped: bool) -> list[str]:
        return [
            text.replace("{n}", str(entry.count))
            for text, entry in self._entries.items()
            if (warn and entry.warn) or (dropped and entry.dropped)
        ]

    @property
    def warnings(self) -> str:
        """All warnings, one per line."""
        return "\n".join(self._texts(warn=True, dropped=False))

    @property
    def dropped(self) -> str:
        """What was left out and why, one item per line."""
        return "\n".join(self._texts(warn=False, dropped=True))

    def emit(self, stacklevel: int = 2) -> None:
        """Warn about every kind not yet warned about."""
        for text, entry in self._entries.items():
            if entry.warn and not entry.told:
                entry.told = True
                message = f"{self.where}: {text.replace('{n}', str(entry.count))}"
                warnings.warn(message, SpinlineWarning, stacklevel=stacklevel + 1)
