"""What a scene may hold: its sections as data, and how they are added to."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self, Union, get_args

from pydantic import Discriminator, Field, Tag, model_validator

from spinline.base.units import Measured
from spinline.rheology.constitutive import ConstitutiveLaw
from spinline.scene.air_and_rheology import AmbientSection, EffectsSection, RheologySection, add_law, refusal
from spinline.scene.blown import BlownJetSection
from spinline.scene.jets import HyperbolicJet, JetspinJet, LagrangianJetFile, PowerLawJet, TableJet
from spinline.scene.mat_sections import CollectorSection, JetsSection, MatSection
from spinline.scene.needle import NeedleJet
from spinline.scene.quantities import (
    Concentration,
    Density,
    HeatCapacity,
    KuhnLength,
    Label,
    LatentHeat,
    Lifetime,
    MassFraction,
    MolarEnthalpy,
    MolarMass,
    Number,
    NumberOrZero,
    Section,
    Sheet,
    Temperature,
    VapourPressure,
    Viscosity,
    VolumeFraction,
)
from spinline.scene.spun import SpunJet

__all__ = ["JET_SECTIONS", "MODELS"]


class PolymerData(Section):
    """A polymer that is not built in."""

    name: Label = "polymer"
    density: Density
    repeat_unit_molar_mass: MolarMass | None = None
    backbone_bonds: Annotated[int, Field(ge=1, le=1000)] | None = None
    kuhn_length: KuhnLength | None = None
    entanglement_molar_mass: MolarMass | None = None
    glass_transition: Temperature | None = None
    melting_temperature: Temperature | None = None
    melting_enthalpy: MolarEnthalpy | None = None
    heat_capacity: HeatCapacity | None = None


class SolventData(Section):
    """A solvent that is not built in; what follows the density matters to evaporation only, the heats to a jet that cools."""

    name: Label = "solvent"
    density: Density
    molar_mass: MolarMass | None = None
    vapour_pressure: VapourPressure | None = None
    latent_heat: LatentHeat | None = None
    heat_capacity: HeatCapacity | None = None
    glass_transition: Temperature | None = None


def _form(value: Any) -> str:
    """Which of its forms a polymer or solvent is given in."""
    if isinstance(value, PolymerData | SolventData) or (isinstance(value, Mapping) and "density" in value):
        return "properties"
    return "mixture" if isinstance(value, Mapping) else "name"


PolymerField = Annotated[
    Annotated[str, Tag("name")] | Annotated[PolymerData, Tag("properties")] | Annotated[PolymerData, Tag("mixture")],
    Discriminator(_form),
]


SolventField = Annotated[
    Annotated[str, Tag("name")]
    | Annotated[dict[str, Annotated[float, Field(gt=0, le=1)]], Tag("mixture")]
    | Annotated[SolventData, Tag("properties")],
    Discriminator(_form),
]


class SolutionSection(Section):
    """``[solution]``: what is spun."""

    polymer: PolymerField
    solvent: SolventField
    mass_fraction: MassFraction | None = None
    volume_fraction: VolumeFraction | None = None
    concentration: Concentration | None = None
    molar_mass: MolarMass | None = None
    kuhn_length: KuhnLength | None = None
    temperature: Temperature = Measured(293.15, 0.0, "293.15 K")
    polymer_density: Density | None = None
    solvent_density: Density | None = None
    viscosity: Annotated[Literal["estimate"] | Viscosity, Field(union_mode="left_to_right")] | None = None
    solvent_viscosity: Viscosity | None = None
    relaxation_time: Annotated[Literal["estimate"] | Lifetime, Field(union_mode="left_to_right")] | None = None
    materials: str | None = None

    @model_validator(mode="after")
    def _one_fraction(self) -> Self:
        given = [key for key in ("mass_fraction", "volume_fraction", "concentration") if getattr(self, key) is not None]
        if len(given) != 1:
            raise refusal(
                "mass_fraction", "give one of mass_fraction, volume_fraction and concentration, not both and not none"
            )
        return self


JetSection = Annotated[
    PowerLawJet | HyperbolicJet | NeedleJet | TableJet | JetspinJet | LagrangianJetFile | SpunJet | BlownJetSection,
    Field(discriminator="profile"),
]


JET_SECTIONS: dict[str, type[Section]] = {
    "power-law": PowerLawJet,
    "hyperbolic": HyperbolicJet,
    "needle": NeedleJet,
    "table": TableJet,
    "jetspin": JetspinJet,
    "lagrangian": LagrangianJetFile,
    "spun": SpunJet,
    "blown": BlownJetSection,
}


# rungs of the ladder by name, and whether their network slips against the solution: `spinline.network_models` has the rest
MODELS: dict[str, bool] = {
    "affine": False,
    "manifold": True,
    "conformation": False,
    "two-fluid": True,
    "chain": True,
    "walk": False,
}


class NetworkSection(Section):
    """``[network]``: model of the network, and its parameters."""

    model: Literal["auto", "affine", "manifold", "conformation", "two-fluid", "chain", "walk"] = "auto"
    walk_tension: Literal["affine", "manifold", "conformation", "two-fluid", "chain"] = "affine"
    closure: Literal["auto", "force", "stretch"] = "auto"
    spring: Number = Measured(3.0, 0.0, "3")
    drag_viscosity: Annotated[Literal["solvent", "solution"] | Viscosity, Field(union_mode="left_to_right")] = "solvent"
    coupling: Number | None = None
    coarse_grain: Number | None = None
    lateral: bool = False
    inertia: NumberOrZero = Measured(0.0, 0.0, "0")
    force_law: Literal["lattice", "linear", "langevin", "fene"] = "lattice"
    end: Literal["take-up", "free", "extended"] = "take-up"
    strand_law: Literal["maxwell", "shortcut"] = "maxwell"
    solvent_quality: Literal["theta", "good"] = "theta"
    crossover_extension: VolumeFraction = Measured(0.83, 0.0, "0.83")

    @model_validator(mode="before")
    @classmethod
    def _no_blobs(cls, keys: object) -> object:
        """The Pincus regime of a good solvent is refused by its name: `docs/physics/far-end.md` says why."""
        if isinstance(keys, dict) and keys.get("force_law") == "pincus":
            raise refusal(
                "force_law",
                "has no Pincus law: blobs give the exponent 2/3 and leave open the force at rest and the coupling, both by a "
                'power of phi; take solvent_quality = "good" with closure = "stretch", which needs no law of force where '
                "the network moves with the flow",
            )
        return keys

    @model_validator(mode="after")
    def _tension_is_walked(self) -> Self:
        if "walk_tension" in self.model_fields_set and self.model != "walk":
            raise refusal("walk_tension", f'is of model = "walk", and model is "{self.model}"; take that, or drop it')
        return self

    @property
    def closure_used(self) -> Literal["force", "stretch"]:
        """What "auto" stands for: "stretch" where a slipping network has a law with a contour, else "force".

        Such a network is solved for its stretch under that very law: ``f_z = f_0 T(w)``, not ``f_0 w``.
        """
        if self.closure != "auto":
            return self.closure
        mover = self.walk_tension if self.model == "walk" else self.model
        return "stretch" if MODELS.get(mover, False) and self.force_law != "linear" else "force"


class AccuracySection(Section):
    """``[accuracy]``: how far from the finest model an answer may be, points to write and shells across
    the jet, strands to walk at each point, steps in time that a chain may take, draws of the inputs that
    carry ``+/-`` (0: no bands).
    """

    rtol: Annotated[float, Field(gt=0, lt=1)] = 0.01
    points: Annotated[int, Field(ge=2, le=10_000_000)] = 401
    shells: Annotated[int, Field(ge=8, le=1000)] = 100
    strands: Annotated[int, Field(ge=2, le=100_000_000)] = 10_000
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    steps: Annotated[int, Field(ge=1, le=1_000_000_000)] = 20_000
    draws: Annotated[int, Field(ge=0, le=100_000)] = 128


class Scene(Sheet):
    """A checked scene. `text` and `folder` say where it came from."""

    title: Label = ""
    solution: SolutionSection
    jet: JetSection
    ambient: AmbientSection | None = None
    rheology: RheologySection | None = None
    effects: EffectsSection = EffectsSection()
    network: NetworkSection = NetworkSection()
    accuracy: AccuracySection = AccuracySection()
    collector: CollectorSection | None = None
    jets: JetsSection | None = None
    mat: MatSection | None = None


def add_jet_section(section: type[Section]) -> None:
    """Let ``[jet]`` have another profile; `section` names it in ``profile: Literal["name"]``."""
    (name,) = get_args(section.model_fields["profile"].annotation)
    JET_SECTIONS[name] = section
    Scene.model_fields["jet"].annotation = Union[tuple(JET_SECTIONS.values())]  # type: ignore[assignment]  # noqa: UP007
    Scene.model_rebuild(force=True)


def register_law(law: ConstitutiveLaw) -> None:
    """Add a constitutive law: ``rheology.constitutive`` may name it, and its parameters are keys of ``[rheology]``."""
    add_law(law)
    Scene.model_rebuild(force=True)


def add_model(name: str, slips: bool) -> None:
    """Let ``network.model`` be another rung."""
    MODELS[name] = slips
    NetworkSection.model_fields["model"].annotation = Literal["auto", *MODELS]  # type: ignore[assignment]
    movers = tuple(one for one in MODELS if one != "walk")
    NetworkSection.model_fields["walk_tension"].annotation = Literal[*movers]  # type: ignore[assignment]
    NetworkSection.model_rebuild(force=True)
    Scene.model_rebuild(force=True)
