"""The rungs of the ladder, cheapest first: the one place where a rung is named."""

from spinline.network_models import affine, chain, conformation, manifold, two_fluid, walk
from spinline.network_models.rung import RUNGS, Rung, cheapest, rung_of, simplest
from spinline.scene.file import MODELS, NetworkSection, add_model

__all__ = ["RUNGS", "cheapest", "register", "rung_in", "rung_of", "simplest"]

RUNGS.update(
    {module.RUNG.name: module.RUNG for module in (affine, manifold, conformation, two_fluid, chain, walk)}
)  # in the order that "auto" tries them


def register(rung: Rung) -> None:
    """Add a rung: `network.model` may name it from now on, and a trade measures it."""
    RUNGS[rung.name] = rung
    if rung.name not in MODELS:
        add_model(rung.name, rung.slips)


def rung_in(network: NetworkSection) -> Rung:
    """The rung of a scene that names one; of one that samples strands, under the tension of the rung that it names besides."""
    return RUNGS[network.model].under(RUNGS[network.walk_tension])
