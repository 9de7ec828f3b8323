"""Figures, one style for all of them, and the HTML page of a run."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.report.page import html, save_report
    from spinline.report.sentences import words

_NAMES = {
    "html": "page",
    "save_report": "page",
    "words": "sentences",
}

__all__ = [
    "html",
    "save_report",
    "words",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
