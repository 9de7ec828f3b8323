"""One detector row: its counts, their likelihood, and what the photons allow."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.xray.row.fit import fit_row

_NAMES = {
    "fit_row": "fit",
}

__all__ = [
    "fit_row",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
