"""The rungs of the ladder, cheapest first: the one place where a rung is named."""

from collections.abc import Iterable

from spinline.network_models import affine, chain, conformation, manifold, two_fluid, walk
from spinline.network_models.rung import Rung
from spinline.scene.file import MODELS, NetworkSection, add_model

__all__ = ["RUNGS", "cheapest", "register", "rung_in", "rung_of", "simplest"]

RUNGS: dict[str, Rung] = {
    module.RUNG.name: module.RUNG for module in (affine, manifold, conformation, two_fluid, chain, walk)
}  # in the order that "auto" tries them


def register(rung: Rung) -> None:
    """Add a rung: `network.model` may name it from now on, and a trade measures it."""
    RUNGS[rung.name] = rung
    if rung.name not in MODELS:
        add_model(rung.name, rung.slips)


def rung_of(name: str) -> Rung:
    """The rung of a name that the scene file allows."""
    return RUNGS[name]


def rung_in(network: NetworkSection) -> Rung:
    """The rung of a scene that names one; of one that samples strands, under the tension of the rung that it names besides."""
    return RUNGS[network.model].under(RUNGS[network.walk_tension])


def simplest() -> Rung:
    """The rung that holds nothing: what every other is measured against."""
    return next(rung for rung in RUNGS.values() if rung.automatic and not rung.holds)


def cheapest(effects: Iterable[str]) -> Rung | None:
    """The first rung, of those that "auto" may take, that holds all of these effects; None where none does."""
    asked = set(effects)
    return next((rung for rung in RUNGS.values() if rung.automatic and asked <= set(rung.holds)), None)
