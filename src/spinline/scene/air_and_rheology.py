"""Sections of a scene about the air and the solution as it dries: ``[ambient]``, ``[rheology]``, ``[effects]``."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from spinline.base.units import Measured
from spinline.rheology.constitutive import LAWS, ConstitutiveLaw
from spinline.scene.quantities import (
    Diffusivity,
    Fraction,
    IntrinsicViscosity,
    Lifetime,
    Number,
    NumberOrZero,
    Pressure,
    Proper,
    Read,
    Section,
    Supercooling,
    Temperature,
    Time,
    Velocity,
)

__all__ = ["AmbientSection", "EffectsSection", "RheologySection", "add_law", "refusal"]


def refusal(key: str, problem: str) -> PydanticCustomError:
    """Error of a section as a whole, said of one of its keys."""
    return PydanticCustomError("refusal", "{problem}", {"key": key, "problem": problem, "allowed": "", "remedy": ""})


class AmbientSection(Section):
    """``[ambient]``: the air; what evaporation needs. The last three replace what the property library gives."""

    relative_humidity: Fraction | None = None
    temperature: Temperature | None = None
    pressure: Pressure | None = None
    air_velocity: Velocity | None = None
    air_viscosity: Diffusivity | None = None
    vapour_diffusivity: Diffusivity | None = None
    saturation: Number | None = None


# parameter, the choice it belongs to, the law that uses it, whether that law cannot do without; of the constitutive laws
# the tables of `spinline.rheology.constitutive` say it
_PARAMETERS = (
    ("intrinsic_viscosity", "law", "martin", True),
    ("martin_constant", "law", "martin", True),
    ("D_decay", "D_law", "exponential", True),
    ("D_gap", "D_law", "free-volume", True),
    ("D_growth", "D_law", "free-volume", True),
    ("crystallisation_half_time", "crystallisation", "nakamura", True),
    ("avrami_exponent", "crystallisation", "nakamura", False),
    ("flow_enhancement", "crystallisation", "nakamura", False),
    ("maximum_crystallinity", "crystallisation", "nakamura", False),
)


class RheologySection(Section):
    """``[rheology]``: how viscosity, relaxation and diffusion follow the concentration, and how the solvent leaves."""

    law: Literal["yarin", "scaling", "martin", "constant"] = "yarin"
    B: NumberOrZero = Measured(7.0, 0.0, "7")
    m: Number = Measured(0.1, 0.0, "0.1")
    n: Annotated[float, Field(ge=-10, le=10)] | None = None
    intrinsic_viscosity: IntrinsicViscosity | None = None
    martin_constant: NumberOrZero | None = None
    constitutive: str = "auto"
    rouse_time: Time | None = None
    constraint_release: Annotated[float, Field(ge=0, le=1)] = 1.0
    entanglement_release: Annotated[float, Field(ge=0, le=1000)] = 0.3
    convention: Literal["mass", "yarin2001"] = "mass"
    activity: Literal["flory-huggins", "raoult", "unit"] = "flory-huggins"
    chi: Annotated[float, Field(ge=-5, le=5)] | None = None
    sherwood_floor: NumberOrZero = Measured(0.0, 0.0, "0")
    D_law: Literal["constant", "exponential", "free-volume"] = "constant"
    diffusivity: Diffusivity | None = None
    D_decay: NumberOrZero | None = None
    D_gap: Number | None = None
    D_growth: NumberOrZero | None = None
    vitrification_fraction: Proper | None = None
    transfer: Literal["kase-matsuo", "churchill-bernstein", "yarin"] = "kase-matsuo"
    chi_water: Annotated[float, Field(ge=-10, le=20)] | None = None
    chi_water_solvent: Annotated[float, Field(ge=-10, le=20)] | None = None
    crystallisation: Literal["equilibrium", "nakamura", "none"] = "equilibrium"
    supercooling: Supercooling = Measured(0.0, 0.0, "0 K")
    crystallisation_half_time: Lifetime | None = None
    avrami_exponent: Annotated[float, Field(ge=1, le=4)] | None = None
    flow_enhancement: NumberOrZero | None = None
    maximum_crystallinity: Fraction | None = None

    def parameters(self, law: ConstitutiveLaw) -> dict[str, float]:
        """Parameters of a constitutive law, SI: those given, and the defaults of the others that have one."""
        found: dict[str, float] = {}
        for parameter in law.parameters:
            given = getattr(self, parameter.name, None)
            value = parameter.default if given is None else given.value
            if value is not None:
                found[parameter.name] = value
        return found

    @model_validator(mode="after")
    def _parameters_have_a_law(self) -> Self:
        chosen = {
            "law": self.law,
            "constitutive": self.constitutive,
            "D_law": self.D_law,
            "crystallisation": self.crystallisation,
        }
        # what finite strands alone have is a choice of them
        listed = [
            (parameter.name, "constitutive", law.name, parameter.needed)
            for law in LAWS.values()
            for parameter in law.parameters
        ]
        for key, choice, needed, must in (*_PARAMETERS, *listed):
            given, used = getattr(self, key) is not None, chosen[choice]
            if given and used != needed and not (choice == "constitutive" and used == "auto" and not must):
                raise refusal(key, f'is given, but {choice} = "{used}" does not use it; drop it, or take "{needed}"')
            if must and not given and used == needed:
                raise refusal(key, f'is missing: {choice} = "{needed}" needs it')
        return self


def _keys_of_laws() -> None:
    """Names of the constitutive laws, and their parameters, as keys of ``[rheology]``: from their tables."""
    fields = RheologySection.__pydantic_fields__
    fields["constitutive"].annotation = Literal["auto", *LAWS]  # type: ignore[assignment]
    for law in LAWS.values():
        for parameter in law.parameters:
            read = Read(parameter.kind, parameter.low, parameter.high, closed=parameter.closed)
            field = FieldInfo.from_annotated_attribute(Annotated[Measured, read] | None, None)  # type: ignore[arg-type]
            field.description = f"{law.name}: {parameter.words}"
            fields[parameter.name] = field
    RheologySection.model_rebuild(force=True)


_keys_of_laws()


def add_law(law: ConstitutiveLaw) -> None:
    """Let ``rheology.constitutive`` be another law, its parameters keys beside it; see `spinline.scene.register_law`."""
    LAWS[law.name] = law
    _keys_of_laws()


Switch = Literal["auto", True, False]


class EffectsSection(Section):
    """``[effects]``: which physics to include; "auto" takes what exceeds rtol and has its data."""

    evaporation: Switch = "auto"
    relaxation: Switch = "auto"
    radial: Switch = "auto"
    heat: Switch = "auto"
    disentanglement: Switch = False
