"""Figures and the HTML page."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.report.page import html, save_report, words

_NAMES = {
    "html": "page",
    "save_report": "page",
    "words": "page",
}

__all__ = [
    "html",
    "save_report",
    "words",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
