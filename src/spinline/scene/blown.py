"""``[jet]`` with ``profile = "blown"``: a jet drawn by fast gas, straight or bead by bead to the collector."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from spinline.base.units import Measured
from spinline.scene.air_and_rheology import refusal
from spinline.scene.quantities import FlowRate, Fraction, Length, Lifetime, Number, Read, Section, Temperature

__all__ = ["BlownJetSection"]

SurfaceTension = Annotated[Measured, Read("surface tension", 0.0, 1e2, closed=True)]
GasVelocity = Annotated[Measured, Read("velocity", 0.0, 1500.0, closed=True)]
Ratio = Annotated[Measured, Read("number", 1.0, 10.0, remedy="total pressure over that of the room")]
Spread = Annotated[Measured, Read("number", 0.05, 0.2, closed=True, remedy="0.094 is measured")]
Share = Annotated[Measured, Read("fraction", 0.0, 1.0, remedy="share of the viscosity that is the solvent's")]
Force = Annotated[Measured, Read("force", -1.0, 1.0, closed=True)]
Acceleration = Annotated[Measured, Read("acceleration", -1e4, 1e4)]
Frequency = Annotated[Measured, Read("rate", 0.0, 1e9, closed=True)]


class BlownJetSection(Section):
    """``[jet]`` with ``profile = "blown"``.

    The gas: `nozzle_diameter` and one of `air_velocity` and `pressure_ratio`. The straight part reaches to `length`; with
    `bending` the jet of the scene is that of the beads, from `start` to the collector.
    """

    profile: Literal["blown"]
    radius: Length
    flow_rate: FlowRate
    surface_tension: SurfaceTension
    nozzle_diameter: Length
    air_velocity: GasVelocity | None = None
    pressure_ratio: Ratio | None = None
    gas_temperature: Temperature | None = None
    gas_profile: Literal["gaussian", "schlichting"] = "gaussian"
    spread: Spread = Measured(0.094, 0.0, "0.094")
    turbulence_intensity: Fraction = Measured(0.2, 0.0, "0.2")
    drag: Literal["ziabicki-kawai", "matsui"] = "ziabicki-kawai"
    law: Literal["auto", "newton", "ucm", "oldroyd-b", "fene-p"] = "auto"
    solvent_share: Share = Measured(0.1, 0.0, "0.1")
    extensibility: Number | None = None
    length: Length
    gravity: Acceleration = Measured(9.81, 0.0, "9.81 m/s2")
    bending: bool = False
    start: Annotated[Literal["auto"] | Length, Field(union_mode="left_to_right")] = "auto"
    element_length: Length | None = None
    longest_element: Length | None = None
    cfl: Annotated[float, Field(gt=0, le=1)] = 0.4
    lift: bool = False
    nozzle_amplitude: Length | None = None
    nozzle_frequency: Frequency | None = None
    time: Lifetime = Measured(0.02, 0.0, "20 ms")
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if (self.air_velocity is None) == (self.pressure_ratio is None):
            raise refusal("air_velocity", "give one of air_velocity and pressure_ratio, not both and not none")
        if (self.nozzle_amplitude is None) != (self.nozzle_frequency is None):
            raise refusal("nozzle_frequency", "goes with nozzle_amplitude: a nozzle that circles has both")
        if not isinstance(self.start, str) and self.start.value > self.length.value:
            raise refusal("start", "lies beyond jet.length, where the straight part ends")
        if self.law == "newton" and self.extensibility is not None:
            raise refusal("extensibility", 'is given, and law = "newton" has no strands')
        return self
