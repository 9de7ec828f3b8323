"""The rungs of the ladder, one file each: what moves the network, and what that makes of it.

`registry` names them once, cheapest first; `rung` says what a rung is; `variables` is what all of them share.
"""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.network_models.registry import RUNGS, register, rung_of
    from spinline.network_models.rung import Network, Relaxed, Rung, Setting

_NAMES = {
    "RUNGS": "registry",
    "Network": "rung",
    "Relaxed": "rung",
    "Rung": "rung",
    "Setting": "rung",
    "register": "registry",
    "rung_of": "registry",
}

__all__ = ["RUNGS", "Network", "Relaxed", "Rung", "Setting", "register", "rung_of"]

__getattr__, __dir__ = lazily(__name__, _NAMES)
