"""How the jet moves: analytic profiles, tables, fits, and imported Lagrangian jets."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if __name__ != "spinline.jetprofile":
    raise ImportError("import spinline.jetprofile, not jetprofile")

if TYPE_CHECKING:
    from spinline.jetprofile.jetspin import iter_jetspin, read_jetspin

_NAMES = {
    "iter_jetspin": "jetspin",
    "read_jetspin": "jetspin",
}

__all__ = ["iter_jetspin", "read_jetspin"]


def __getattr__(name: str) -> Any:
    if name in _NAMES:
        return getattr(import_module(f"spinline.jetprofile.{_NAMES[name]}"), name)
    raise AttributeError(f"module 'spinline.jetprofile' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
