"""The bead chain in time, Eq. (32a) in full: every strand of the network, from the nozzle to the far end."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.network.chain.cycle import ChainCycle, chain_cycle
    from spinline.network.chain.march import ChainResult, Progress, run_chain

_NAMES = {
    "ChainCycle": "cycle",
    "ChainResult": "march",
    "Progress": "march",
    "chain_cycle": "cycle",
    "run_chain": "march",
}

__all__ = [
    "ChainCycle",
    "ChainResult",
    "Progress",
    "chain_cycle",
    "run_chain",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
