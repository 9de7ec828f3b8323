"""``[jet]`` with ``profile = "spun"``: a jet computed bead by bead from the needle to the collector."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from spinline.base.units import Measured
from spinline.scene.air_and_rheology import refusal
from spinline.scene.quantities import Conductivity, FlowRate, Length, Read, Section, Time

__all__ = ["SpunJet"]

Voltage = Annotated[Measured, Read("potential", 0.0, 1e7, closed=True)]
SurfaceTension = Annotated[Measured, Read("surface tension", 0.0, 1e2, closed=True)]
Frequency = Annotated[Measured, Read("rate", 0.0, 1e9, closed=True)]
Current = Annotated[Measured, Read("current", 0.0, 1e3)]
ChargeDensity = Annotated[Measured, Read("charge density", 0.0, 1e12)]
Speed = Annotated[Measured, Read("velocity", -1e3, 1e3)]
Permittivity = Annotated[Measured, Read("number", 1.0, 1e6, closed=True, remedy="relative, 80 for water")]
Acceleration = Annotated[Measured, Read("acceleration", -1e4, 1e4)]
Interval = Annotated[Measured, Read("time", 1e-9, 1.0)]
SideField = Annotated[Measured, Read("electric field", 0.0, 1e9, closed=True)]
MagneticField = Annotated[Measured, Read("magnetic field", -1e3, 1e3, closed=True)]
Noise = Annotated[Measured, Read("velocity diffusivity", 0.0, 1e12)]
Stress = Annotated[Measured, Read("pressure", 0.0, 1e9, closed=True)]


class SpunJet(Section):
    """``[jet]`` with ``profile = "spun"``."""

    profile: Literal["spun"]
    radius: Length
    flow_rate: FlowRate
    voltage: Voltage
    gap: Length
    conductivity: Conductivity | None = None
    surface_tension: SurfaceTension | None = None
    permittivity: Permittivity = Measured(80.0, 0.0, "80")
    gravity: Acceleration = Measured(9.81, 0.0, "9.81 m/s2")
    current: Current | None = None
    field: Literal["hyperboloid", "uniform"] = "hyperboloid"
    charge: Literal["conducting", "frozen", "none"] = "conducting"
    charge_density: ChargeDensity | None = None
    law: Literal["fene-p", "ucm", "linear-maxwell", "oldroyd-b", "giesekus", "herschel-bulkley"] = "fene-p"
    solvent_share: Annotated[float, Field(gt=0, lt=1)] = 0.1
    extensibility: Annotated[float, Field(gt=3)] | None = None
    mobility: Annotated[float, Field(gt=0, le=1)] = 0.1
    yield_stress: Stress | None = None
    index: Annotated[float, Field(gt=0, le=2)] = 1.0
    start: Literal["needle", "straight-jet"] = "needle"
    start_position: Length | None = None
    inlet_stress: Literal["free", "given"] = "free"
    element_length: Length | None = None
    longest_element: Length | None = None
    largest_turn: Annotated[float, Field(ge=0.01, le=1.5)] | None = None
    nozzle_amplitude: Length | None = None
    nozzle_frequency: Frequency | None = None
    time: Time = Measured(0.02, 0.0, "20 ms")
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    tolerance: Annotated[float, Field(gt=1e-12, le=1e-2)] = 1e-5
    bending: Literal["none", "viscous", "elastic"] = "none"
    image: bool = False
    side_field: SideField | None = None
    side_kind: Literal["rotating", "square"] = "rotating"
    side_frequency: Frequency | None = None
    magnetic_field: MagneticField | None = None
    magnetic_direction: Literal["x", "y", "z"] = "x"
    drying: bool = False
    air_drag: bool = False
    air_lift: bool = False
    air_field: str | None = None
    noise: Noise | None = None
    noise_length: Length | None = None
    noise_time: Interval = Measured(2e-5, 0.0, "20 us")
    jets: Annotated[int, Field(ge=1, le=400)] = 1
    jet_spacing: Length | None = None
    jet_pattern: Literal["line", "square", "ring"] = "line"
    collector: Literal["plate", "belt", "drum", "none"] = "plate"
    collector_speed: Speed | None = None
    collector_radius: Length | None = None

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.charge == "frozen" and (self.charge_density is None) == (self.current is None):
            raise refusal("charge_density", "frozen charge needs one of charge_density and current")
        if self.nozzle_amplitude is not None and self.nozzle_frequency is None:
            raise refusal("nozzle_frequency", "is missing: a nozzle with an amplitude circles")
        if (self.side_field is None) != (self.side_frequency is None):
            raise refusal("side_frequency", "and side_field go together: a transverse field that turns or switches")
        if self.noise_length is not None and self.noise is None:
            raise refusal("noise", "is missing: noise_length says which piece of the jet it belongs to")
        if self.jets > 1 and self.jet_spacing is None:
            raise refusal("jet_spacing", "is missing: the distance between the nozzles of several jets")
        if self.jets > 1 and self.charge == "conducting":
            raise refusal("charge", 'moves in the liquid: jets side by side need charge = "frozen", or "none"')
        if self.jet_pattern == "square" and round(self.jets**0.5) ** 2 != self.jets:
            raise refusal("jets", "are no square: 4, 9, 16, ...")
        if self.collector == "drum" and self.collector_radius is None:
            raise refusal("collector_radius", "is missing: a drum has one")
        return self
