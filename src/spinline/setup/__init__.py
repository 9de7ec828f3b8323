"""From a scene to physics objects, each built once: solution, jet, grid, air, coupling, material, effect switches."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.setup.build import build_solution
    from spinline.setup.context import Context
    from spinline.setup.jet import build_jet, register_jet

_NAMES = {"Context": "context", "build_jet": "jet", "build_solution": "build", "register_jet": "jet"}

__all__ = ["Context", "build_jet", "build_solution", "register_jet"]

__getattr__, __dir__ = lazily(__name__, _NAMES)
