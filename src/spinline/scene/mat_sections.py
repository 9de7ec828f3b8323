"""``[collector]``, ``[jets]``, ``[laydown]`` and ``[mat]``: where the fibre lands, and how the mat is analysed.

They stand in a scene beside its jet, or alone in a file (`MatScene`) whose fibres come from a fitted laydown.
"""

import difflib
import re
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from spinline.base.units import Measured
from spinline.scene.air_and_rheology import refusal
from spinline.scene.quantities import (
    Density,
    Fraction,
    Length,
    Lifetime,
    NumberOrZero,
    Proper,
    Section,
    Velocity,
)

__all__ = [
    "CollectorSection",
    "JetsSection",
    "LaydownSection",
    "MatSection",
    "angular_velocity",
]

_TURN = re.compile(r"\s*([-+]?\d+\.?\d*(?:[eE][-+]?\d+)?)\s*(rpm|rad/s|1/min|1/s|Hz)\s*$")
_PER_SECOND = {"rpm": 1 / 60, "1/min": 1 / 60, "1/s": 1.0, "Hz": 1.0, "rad/s": 0.15915494309189535}


def angular_velocity(text: Any) -> float:
    """Angular velocity in rad/s from text such as "240 rpm"."""
    match = _TURN.match(text) if isinstance(text, str) else None
    if match is None:
        words = {"problem": "is no rate of rotation", "allowed": "rpm, rad/s, 1/s", "remedy": 'for example "240 rpm"'}
        raise PydanticCustomError("quantity", "{problem}", words)
    return 2 * 3.141592653589793 * float(match[1]) * _PER_SECOND[match[2]]


def _listed(names: Any) -> Any:
    return [names] if isinstance(names, str) else names


def _known_laws(names: list[str]) -> list[str]:
    """Refuse a law of permeability that there is not, wherever the section is read: before hours of spinning."""
    from spinline.deposit.permeability import LAWS  # slow to import, and few scenes name one

    wrong = next((name for name in names if name not in LAWS), None)
    if names and wrong is None:
        return list(dict.fromkeys(names))
    near = difflib.get_close_matches(str(wrong), LAWS, 1)
    words = {
        "problem": "names no law" if wrong is None else f"{wrong[:40]!r} is no law of permeability",
        "allowed": ", ".join(LAWS),
        "remedy": f"did you mean {near[0]!r}?" if near else "take one or several of those",
    }
    raise PydanticCustomError("quantity", "{problem}", words)


class CollectorSection(Section):
    """``[collector]``: plate, belt or drum; `time` is how long fibre is laid."""

    kind: Literal["plate", "belt", "drum"] = "plate"
    distance: Length
    speed: Velocity | None = None
    rotation: Annotated[float, BeforeValidator(angular_velocity)] | None = None
    radius: Length | None = None
    time: Lifetime | None = None

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if self.kind == "plate" and (self.speed, self.rotation, self.radius) != (None, None, None):
            raise refusal("kind", 'is "plate": take out speed, rotation and radius, or take a belt or a drum')
        if self.kind == "belt" and (self.speed is None or self.rotation is not None or self.radius is not None):
            raise refusal("speed", "is what a belt needs, and neither rotation nor radius")
        if self.kind == "drum" and (self.radius is None or (self.speed is None) == (self.rotation is None)):
            raise refusal("radius", "is needed by a drum, and one of rotation and speed")
        return self


class JetsSection(Section):
    """``[jets]``: a row of them across the machine."""

    count: Annotated[int, Field(ge=1, le=10_000)] = 1
    spacing: Length = Measured(1e-2, 0.0, "1 cm")


class LaydownSection(Section):
    """``[laydown]``: the fitted law that lays kilometres (`Laydown`); `spread` is the footprint's standard deviation."""

    speed: Velocity
    spread: Length
    turning_length: Length
    diameter: Length
    diameter_deviation: Length | None = None
    correlation: Length | None = None
    polymer_fraction: Proper | Literal[1] = 1
    step: Length | None = None


class MatSection(Section):
    """``[mat]``: how the mat is analysed."""

    window: Length | None = None
    slope: NumberOrZero = Measured(0.1, 0.0, "0.1")
    envelope: Literal["mean-top", "max-top", "percentile"] = "mean-top"
    voxel: Length | None = None
    flatten: Fraction = Measured(0.0, 0.0, "0")
    permeability: Annotated[list[str], BeforeValidator(_listed), AfterValidator(_known_laws)] = Field(
        default_factory=lambda: ["davies"]
    )
    direct: bool = False
    realisations: Annotated[int, Field(ge=1, le=1000)] = 8
    polymer_density: Density = Measured(1200.0, 0.0, "1200 kg/m3")
    face_velocity: Velocity = Measured(0.05, 0.0, "5 cm/s")
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
