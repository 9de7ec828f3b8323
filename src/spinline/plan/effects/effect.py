"""What an effect is: an object with its name, its switch and its estimate."""

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from spinline.plan.estimates import Estimate
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.network_models.rung import Rung
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["Effect"]


class Effect(ABC):
    """An effect that a run may hold or leave out; a new one overrides what it does otherwise.

    Attributes
    ----------
    name : str
        As in `spinline plan`.
    symbol : str
        What its number is.
    switch : str
        Its key in ``[effects]``; empty for one that goes with the rung.
    after : str
        Switch of the effect without which it is nothing.
    moves : bool
        It moves the network: a rung that does not hold it errs by its estimate.
    """

    name: str = ""
    symbol: str = ""
    switch: str = ""
    after: str = ""
    moves: bool = False

    @abstractmethod
    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """Its number, and the error of an answer that leaves it out.

        Parameters
        ----------
        context : Context
            One moment.
        known : EffectNumbers
            Governing numbers of the scene.
        """

    def error(self, context: Context, known: "EffectNumbers") -> tuple[float, str]:
        """The estimated error alone, and where there is none why: what its switch is decided by."""
        found = self.estimate(context, known)
        return found.error, found.words if np.isnan(found.error) else ""

    def idle(self, context: Context) -> str:
        """Why it cannot matter in a scene, before any estimate; empty where it may."""
        return ""

    def check(self, context: Context) -> None:
        """Refuse before a run what the run would refuse with it on.

        Raises
        ------
        InputError
        """
        return  # most refuse nothing

    def held(self, context: Context, rung: "Rung", automatic: bool) -> bool:
        """Whether a run by a rung holds it; of effects without a switch. `automatic`: "auto" took the rung."""
        return self.name in rung.holds

    def _nothing(self, words: str) -> Estimate:
        """The estimate where there is none."""
        return Estimate(self.name, self.symbol, float("nan"), float("nan"), words)
