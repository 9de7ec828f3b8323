"""Sections ``[jet]`` of the jets that somebody else provides: laws, tables, simulated beads."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from spinline.scene.air_and_rheology import refusal
from spinline.scene.quantities import Conductivity, ElectricField, Exponent, FlowRate, Length, Number, Section, Time

__all__ = ["HyperbolicJet", "JetspinJet", "LagrangianJetFile", "PowerLawJet", "TableJet"]


class PowerLawJet(Section):
    """``[jet]`` with ``profile = "power-law"``, Eq. (31)."""

    profile: Literal["power-law"]
    radius: Length
    flow_rate: FlowRate
    length: Length
    beta: Exponent
    k: Number | None = None
    electric_field: ElectricField | None = None
    conductivity: Conductivity | None = None

    @model_validator(mode="after")
    def _k_or_process(self) -> Self:
        process = (self.electric_field, self.conductivity)
        if self.k is None and None in process:
            raise refusal("k", "is missing; give k, or electric_field and conductivity for an estimate of it")
        if self.k is not None and process != (None, None):
            raise refusal("k", "is given beside electric_field and conductivity; drop one or the other")
        return self


class HyperbolicJet(Section):
    """``[jet]`` with ``profile = "hyperbolic"``, Fig. 35."""

    profile: Literal["hyperbolic"]
    radius: Length
    flow_rate: FlowRate
    length: Length
    p: Number


class TableJet(Section):
    """``[jet]`` with ``profile = "table"``: a CSV file of (z, radius) or (z, velocity)."""

    profile: Literal["table"]
    path: str
    flow_rate: FlowRate
    radius: Length | None = None
    length: Length | None = None


class JetspinJet(Section):
    """``[jet]`` with ``profile = "jetspin"``: a run directory, a file of it, or what ``import-jet`` wrote."""

    profile: Literal["jetspin"]
    path: str
    time: Annotated[Time | Literal["all", "last"], Field(union_mode="left_to_right")] = "last"
    source: str | None = None
    unit: str | None = None


class LagrangianJetFile(Section):
    """``[jet]`` with ``profile = "lagrangian"``: beads of any simulator, in any format that `read_beads` knows."""

    profile: Literal["lagrangian"]
    path: str
    radius: Length | None = None
    unit: str | None = None
    time: Annotated[Time | Literal["all", "last"], Field(union_mode="left_to_right")] = "last"
