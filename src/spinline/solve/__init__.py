"""From a scene to a result: the stages in order, the fields, one Dataset."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.solve.solved import Solved
    from spinline.solve.spine import Crossover, build_jet, build_solution, crossover, evaluate, examine, run

_NAMES = {
    "Crossover": "spine",
    "Solved": "solved",
    "build_jet": "spine",
    "build_solution": "spine",
    "crossover": "spine",
    "evaluate": "spine",
    "examine": "spine",
    "run": "spine",
}

__all__ = [
    "Crossover",
    "Solved",
    "build_jet",
    "build_solution",
    "crossover",
    "evaluate",
    "examine",
    "run",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
