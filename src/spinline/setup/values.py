"""Optional quantities of a scene as numbers."""

from typing import Any

from spinline.base.units import Measured

__all__ = ["given"]


def given(measured: Measured | None, default: Any = None) -> Any:
    """Value in SI of an optional quantity of a scene, or the default."""
    return default if measured is None else measured.value
