"""Which physics a scene needs: governing numbers, estimates, the choice, remarks."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.plan.choice import MARGIN, Plan, plan_scene, resolved

_NAMES = {
    "MARGIN": "choice",
    "Plan": "choice",
    "plan_scene": "choice",
    "resolved": "choice",
}

__all__ = [
    "MARGIN",
    "Plan",
    "plan_scene",
    "resolved",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
