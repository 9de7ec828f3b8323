"""How the keys of a scene file are read: quantities as text with their unit, within a physical range."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from spinline.base.errors import InputError
from spinline.base.units import QUANTITIES, Measured, parse
from spinline.base.words import label


@dataclass(frozen=True)
class Read:
    """Reads a quantity: text with a unit, within a physical range (in SI)."""

    kind: str
    low: float
    high: float
    closed: bool = False
    remedy: str = ""
    words: str = ""

    @property
    def allowed(self) -> str:
        """The range in words."""
        if self.words:
            return self.words
        ends = "[]" if self.closed else "()"
        return f"{ends[0]}{self.low:g}, {self.high:g}{ends[1]} {QUANTITIES[self.kind].unit}".strip()

    def __call__(self, text: Any) -> Measured:
        """Parse and check one value."""
        try:
            measured = parse(text, self.kind, "")
        except InputError as error:
            remedy = _by_mass(self.kind, text) or error.remedy
            words = {"problem": error.problem, "allowed": error.allowed or self.allowed, "remedy": remedy}
            raise PydanticCustomError("quantity", "{problem}", words) from None
        value = measured.value
        if not (self.low <= value <= self.high if self.closed else self.low < value < self.high):
            remedy = self.remedy or _percent(self.kind, value)
            raise PydanticCustomError("range", "is out of range", {"allowed": self.allowed, "remedy": remedy})
        return measured

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        quantity = QUANTITIES[self.kind]
        kinds: Any = "string" if quantity.unit else ["string", "number"]
        return {"type": kinds, "description": f"{self.kind}, {self.allowed}", "examples": [quantity.example]}


def _by_mass(kind: str, text: Any) -> str:
    """The key of a share by mass that stands where a mass in a volume is due."""
    if kind != "concentration":
        return ""
    try:
        parse(text, "mass fraction", "")
    except InputError:
        return ""
    return f'a share by mass is another key: mass_fraction = "{text}"'


def _percent(kind: str, value: float) -> str:
    """What a share above 1 was meant to be."""
    unit = {"mass fraction": "wt%", "volume fraction": "vol%", "fraction": "%"}.get(kind)
    return f'a share is at most 1; percent are written "{value:g} {unit}"' if unit and 1 < value <= 100 else ""


Length = Annotated[Measured, Read("length", 1e-12, 1e3)]
Label = Annotated[str, AfterValidator(label)]  # a title or name: one harmless line
KuhnLength = Annotated[Measured, Read("length", 1e-11, 1e-6)]
FlowRate = Annotated[Measured, Read("flow rate", 1e-30, 1.0)]
Time = Annotated[Measured, Read("time", 0.0, 1e9, closed=True)]
Lifetime = Annotated[Measured, Read("time", 0.0, 1e12)]
Temperature = Annotated[Measured, Read("temperature", 50.0, 1000.0)]
Density = Annotated[Measured, Read("density", 1.0, 3e4)]
Concentration = Annotated[Measured, Read("concentration", 0.0, 3e4)]
HeatCapacity = Annotated[Measured, Read("heat capacity", 1.0, 1e5)]
LatentHeat = Annotated[Measured, Read("heat of vaporisation", 1e3, 1e8)]
MolarEnthalpy = Annotated[Measured, Read("molar enthalpy", 1.0, 1e7)]
Supercooling = Annotated[Measured, Read("temperature", 0.0, 200.0, closed=True, words="[0, 200] K, a difference")]
MolarMass = Annotated[Measured, Read("molar mass", 1e-3, 1e6)]
Viscosity = Annotated[Measured, Read("viscosity", 1e-7, 1e15)]
Velocity = Annotated[Measured, Read("velocity", -1e3, 1e3)]
Pressure = Annotated[Measured, Read("pressure", 0.0, 1e9)]
ElectricField = Annotated[Measured, Read("electric field", 0.0, 1e10)]
Conductivity = Annotated[Measured, Read("conductivity", 0.0, 1e8)]
MassFraction = Annotated[Measured, Read("mass fraction", 0.0, 1.0)]
VolumeFraction = Annotated[Measured, Read("volume fraction", 0.0, 1.0)]
Fraction = Annotated[Measured, Read("fraction", 0.0, 1.0, closed=True)]
Exponent = Annotated[Measured, Read("number", 0.25, 1.0, closed=True, remedy="measured jets give 0.4 to 0.6")]
Number = Annotated[Measured, Read("number", 0.0, 1e30)]
VapourPressure = Annotated[Measured, Read("pressure", 0.0, 1e8)]
Diffusivity = Annotated[Measured, Read("diffusivity", 1e-30, 1.0)]
IntrinsicViscosity = Annotated[Measured, Read("intrinsic viscosity", 0.0, 1e6)]
Proper = Annotated[Measured, Read("fraction", 0.0, 1.0)]
NumberOrZero = Annotated[Measured, Read("number", 0.0, 1e30, closed=True)]


class Section(BaseModel):
    """A section of the file: unknown keys are refused, what is read does not change."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True)


class Sheet(Section):
    """A whole checked file. `text` and `folder` say where it came from."""

    _text: str = ""
    _folder: Path = Path()
    _name: str = ""

    @property
    def text(self) -> str:
        """The TOML it was made from, overrides as a comment at its end."""
        return self._text

    @property
    def folder(self) -> Path:
        """Folder that relative paths in it start from."""
        return self._folder

    @property
    def name(self) -> str:
        """Stem of the file, or bundled name."""
        return self._name
