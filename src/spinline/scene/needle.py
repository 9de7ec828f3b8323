"""``[jet]`` with ``profile = "needle"``: the settings of the bench, from which the straight jet is computed."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from spinline.base.units import Measured
from spinline.scene.air_and_rheology import refusal
from spinline.scene.quantities import Conductivity, FlowRate, Length, Number, NumberOrZero, Read, Section

__all__ = ["FieldTable", "NeedleJet"]

Voltage = Annotated[Measured, Read("potential", 1e-3, 1e7)]
SurfaceTension = Annotated[
    Measured, Read("surface tension", 1e-5, 2.0, remedy="72 mN/m for water, 20 to 40 for other solvents")
]
Current = Annotated[Measured, Read("current", 1e-18, 1e3)]
Acceleration = Annotated[Measured, Read("acceleration", -1e4, 1e4)]
Permittivity = Annotated[Measured, Read("number", 1.0, 1e6, closed=True, remedy="relative, 80 for water")]
Share = Annotated[Measured, Read("fraction", 0.005, 1.0, remedy="share of the viscosity that is the solvent's")]


FIELDS = ("hyperboloid", "needle", "uniform")


class FieldTable(Section):
    """Field along the axis from a field solver: a CSV file with columns ``z [unit]`` and ``field [unit]``."""

    table: str


class _FieldRead:
    """Reads ``field``: a name, or ``{ table = "file.csv" }``."""

    def __call__(self, value: Any) -> str | FieldTable:
        if isinstance(value, FieldTable) or (isinstance(value, str) and value in FIELDS):
            return value
        if isinstance(value, Mapping) and set(value) == {"table"} and isinstance(value["table"], str):
            return FieldTable(table=value["table"])
        names = ", ".join(f'"{name}"' for name in FIELDS)
        allowed = f'{names}, {{ table = "file.csv" }}'
        raise PydanticCustomError("quantity", "is not known", {"allowed": allowed, "remedy": ""})

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        table = {"type": "object", "properties": {"table": {"type": "string"}}, "required": ["table"]}
        return {"anyOf": [{"enum": list(FIELDS)}, table], "description": "electric field of the electrodes"}


class NeedleJet(Section):
    """``[jet]`` with ``profile = "needle"``: voltage, gap, needle and solution give the jet."""

    profile: Literal["needle"]
    radius: Length
    flow_rate: FlowRate
    voltage: Voltage
    gap: Length
    conductivity: Conductivity
    surface_tension: SurfaceTension
    permittivity: Permittivity
    current: Current | None = None
    field: Annotated[str | FieldTable, _FieldRead()] = "hyperboloid"
    log: Literal["local", "constant", "slender"] = "local"
    law: Literal["fene-p", "oldroyd-b", "giesekus", "newtonian"] = "fene-p"
    solvent_share: Share = Measured(0.1, 0.0, "0.1")
    extensibility: Number | None = None
    mobility: NumberOrZero = Measured(0.0, 0.0, "0")
    end: Length | None = None
    length: Length | None = None
    gravity: Acceleration = Measured(9.81, 0.0, "9.81 m/s2")

    @model_validator(mode="after")
    def _within(self) -> Self:
        if self.end is not None and self.end.value > self.gap.value * (1 + 1e-9):
            raise refusal("end", "lies beyond the plate: jet.gap is shorter")
        last = self.gap if self.end is None else self.end
        if self.length is not None and self.length.value > last.value * (1 + 1e-9):
            raise refusal("length", "reaches beyond jet.end, where the conditions at the end are (default: jet.gap)")
        return self
