"""Refusal by name of an argument that is not the object asked for."""

from typing import Any

from spinline.base.errors import InputError

__all__ = ["instance"]


def instance(field: str, value: Any, kind: type | tuple[type, ...], remedy: str = "") -> None:
    """Raise InputError unless `value` is of that kind."""
    if not isinstance(value, kind):
        name = kind.__name__ if isinstance(kind, type) else " or ".join(k.__name__ for k in kind)
        raise InputError(field, f"is not a {name}", value=type(value).__name__, remedy=remedy)
