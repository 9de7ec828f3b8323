"""Rung ``affine``: the network moves with the solution, Eqs. (36)-(40) in closed form."""

from typing import TYPE_CHECKING

from spinline.network_models.rung import Rung, Setting

if TYPE_CHECKING:
    from spinline.setup.context import Context

__all__ = ["RUNG", "Affine"]


class Affine(Rung):
    """w = V, or the material stretch of a bead jet."""

    name = "affine"
    words = "the network moves with the solution: closed forms, Eqs. (36)-(40)"
    automatic = True
    cost = "a millisecond"

    def settings(self, context: "Context", quick: bool) -> list[Setting]:
        """As it is."""
        return [Setting("closed form")]


RUNG = Affine()
