"""The command line: one file a group of commands."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.cli.commands import app, main

_NAMES = {
    "app": "commands",
    "main": "commands",
}

__all__ = [
    "app",
    "main",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
