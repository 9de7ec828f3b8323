"""Which effects a run includes, as it was decided (`spinline.plan.switches`)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Effects"]


@dataclass(frozen=True)
class Effects:
    """What is included, why, and the numbers behind it.

    Attributes
    ----------
    on : mapping
        Key of ``[effects]`` to whether it is included; what is not there is not.
    why : mapping
        The same keys to a sentence.
    left_out : tuple of str
        Names of the effects that are not, for a reader.
    numbers : EffectNumbers or None
        None where nothing asked for them.
    """

    on: Mapping[str, bool] = field(default_factory=dict)
    why: Mapping[str, str] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()
    numbers: Any = None

    def __getitem__(self, key: str) -> bool:
        return self.on.get(key, False)

    @property
    def any(self) -> bool:
        """Something is included."""
        return any(self.on.values())

    @property
    def evaporation(self) -> bool:
        """The jet loses solvent."""
        return self["evaporation"]

    @property
    def relaxation(self) -> bool:
        """Strands give stretch back."""
        return self["relaxation"]

    @property
    def radial(self) -> bool:
        """The fraction across the jet is solved for."""
        return self["radial"]

    @property
    def heat(self) -> bool:
        """The jet cools, and takes up water."""
        return self["heat"]
