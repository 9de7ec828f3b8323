"""Names of a package that load when first asked for (PEP 562): importing the package imports nothing heavy."""

from __future__ import annotations

import sys
from importlib import import_module

TYPE_CHECKING = False  # as typing's, which would be most of the cost of importing the package
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any

__all__ = ["lazily"]


def lazily(package: str, names: Mapping[str, str]) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """``__getattr__`` and ``__dir__`` of a package.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    names : mapping
        Public name to the module of the package that has it (dotted where that is deeper, or of another package if it
        begins with ``spinline.``); the module's own path with a colon behind it where the name *is* that module.

    Examples
    --------
    ``__getattr__, __dir__ = lazily(__name__, _NAMES)``, below ``__all__``.
    """

    def get(name: str) -> Any:
        if name not in names:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        place, whole, _ = names[name].partition(":")
        module = import_module(place if place.startswith("spinline.") else f"{package}.{place}")
        return module if whole else getattr(module, name)

    def listed() -> list[str]:
        return sorted(sys.modules[package].__all__)

    return get, listed
