"""The scene file: what a user writes, checked, with every quantity in SI.

A scene is TOML. Quantities are text with their unit; unknown keys are refused and the nearest known one is suggested.
`load_scene` reads a path or the name of a bundled scene; `Scene.model_validate` checks a dictionary.
"""

import difflib
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, Self, TypeVar, Union, get_args

from pydantic import BaseModel, Discriminator, Field, Tag, ValidationError, model_validator
from pydantic_core import ErrorDetails

from spinline.base.errors import InputError
from spinline.base.text import parsed_toml, read_toml_text
from spinline.base.units import Measured
from spinline.rheology.constitutive import ConstitutiveLaw
from spinline.scene.air_and_rheology import AmbientSection, EffectsSection, RheologySection, add_law, refusal
from spinline.scene.jets import HyperbolicJet, JetspinJet, LagrangianJetFile, PowerLawJet, TableJet
from spinline.scene.mat_sections import CollectorSection, MatSection
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

__all__ = [
    "LONGEST",
    "HyperbolicJet",
    "JetspinJet",
    "LagrangianJetFile",
    "PowerLawJet",
    "Scene",
    "TableJet",
    "bundled_scenes",
    "given_file",
    "json_schema",
    "load_scene",
    "scene_from_dict",
]


_Sheet = TypeVar("_Sheet", bound=Sheet)
LONGEST = 1_000_000  # characters of a scene


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
    PowerLawJet | HyperbolicJet | NeedleJet | TableJet | JetspinJet | LagrangianJetFile | SpunJet,
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


def scene_from_dict(
    data: Mapping[str, Any], *, text: str = "", folder: Path | None = None, name: str = "scene"
) -> Scene:
    """Check a scene given as nested dictionaries.

    Raises
    ------
    InputError
        With every problem found, one to a line.
    """
    scene = checked(Scene, data, text, folder, name)
    if scene.solution.materials is None:
        return scene
    from spinline.scene.materials_file import own_materials

    return own_materials(scene)


def checked(model: type[_Sheet], data: Mapping[str, Any], text: str, folder: Path | None, name: str) -> _Sheet:
    """A sheet from nested dictionaries, or an error with every problem found."""
    try:
        sheet = model.model_validate(data)
    except ValidationError as error:
        raise explain(error, name, data, model) from None
    sheet._text, sheet._folder, sheet._name = text, folder or Path(), name
    return sheet


def load_scene(source: str | Path, overrides: Sequence[str] = ()) -> Scene:
    """Read a scene file, or a bundled scene by its name.

    Parameters
    ----------
    source : path or str
        A TOML file, or a name that `bundled_scenes` lists. A file of that name goes first.
    overrides : sequence of str
        ``"jet.k=0.8"``: TOML values that replace the file's; text needs no quotes.

    Returns
    -------
    Scene

    Raises
    ------
    InputError
        For an unreadable file, TOML that does not parse, or any key or value that cannot be right.
    """
    data, text, path = read_toml(source, bundled_scenes(), overrides)
    return scene_from_dict(data, text=text, folder=path.resolve().parent, name=path.stem)


def read_toml(
    source: str | Path, bundled: Mapping[str, Path], overrides: Sequence[str], noun: str = "scene"
) -> tuple[dict[str, Any], str, Path]:
    """Content, text and path of a TOML file or of a bundled one of that name, overrides applied."""
    path = given_file(source, bundled)
    near = difflib.get_close_matches(str(source)[:200], bundled, n=1)
    hint = f"did you mean the bundled {near[0]!r}?" if near else "`spinline scenes` lists the bundled ones"
    data, text = read_toml_text(path, noun, LONGEST, hint)
    for override in overrides:
        _override(data, override)
    if overrides:
        text = text.rstrip() + "\n" + "".join(f"# --set {override}\n" for override in overrides)
    return data, text, path


def given_file(source: str | Path, bundled: Mapping[str, Path]) -> Path:
    """The file of that name, else the bundled one."""
    try:
        there = Path(source).exists()
    except (OSError, ValueError):  # a name that no file can have
        there = False
    return Path(source) if there else bundled.get(str(source), Path(source))


def bundled_scenes() -> dict[str, Path]:
    """Names of the bundled scenes and their files."""
    folder = Path(str(resources.files("spinline") / "data" / "scenes"))
    return {file.stem: file for file in sorted(folder.glob("*.toml"))}


def json_schema() -> dict[str, Any]:
    """JSON Schema of the scene file, for editors."""
    schema = Scene.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "spinline scene"}


def _override(data: dict[str, Any], override: str) -> None:
    key, equals, value = override.partition("=")
    steps = [step.strip() for step in key.split(".")]
    if not equals or not all(steps) or "\n" in override:
        raise InputError("--set", "is not KEY=VALUE", value=override, remedy='for example --set "jet.radius=100 um"')
    try:
        parsed = parsed_toml(f"value = {value}", "--set", "value")["value"]
    except InputError:
        parsed = value.strip()
    for step in steps[:-1]:
        data = data.setdefault(step, {})
        if not isinstance(data, dict):
            raise InputError("--set", f"{step} is a value, not a section", value=override)
    data[steps[-1]] = parsed


def explain(error: ValidationError, name: str, data: Mapping[str, Any], root: type[BaseModel]) -> InputError:
    """One InputError from all that pydantic found in a file whose top is `root`."""
    details = error.errors(include_url=False)
    lines = list(dict.fromkeys(str(_problem(detail, data, root)) for detail in _foremost(details)))
    first = _problem(_foremost(details)[0], data, root)
    if len(lines) == 1:
        return first
    return InputError(name, f"has {len(lines)} problems:\n  " + "\n  ".join(lines))


def _foremost(details: list[ErrorDetails]) -> list[ErrorDetails]:
    """Of the branches of a union keep the one that speaks of the value, not of its type."""
    best: dict[str, ErrorDetails] = {}
    for detail in details:
        key = _key(detail)
        if key not in best or best[key]["type"] in _TYPE_ERRORS:
            best[key] = detail
    return list(best.values())


_TYPE_ERRORS = frozenset({"string_type", "literal_error", "model_type", "dict_type", "float_type", "bool_type"})
_FORMS = frozenset({"name", "mixture", "properties"})  # branches of unions, as profiles are: no keys of the user's


def _key(detail: ErrorDetails) -> str:
    steps = [str(step) for step in detail["loc"]]
    kept = [
        step
        for i, step in enumerate(steps)
        if not ((step in _FORMS or step in JET_SECTIONS) and i == (2 if steps[0] == "solution" else 1))
        and "[" not in step
    ]
    context = detail.get("ctx") or {}
    return ".".join([*kept, context["key"]] if "key" in context else kept) or "scene"


_USUAL = {
    "jet.beta": "add it to [jet]: measured jets give 0.4 to 0.6, 0.47 for PEO in water; fit yours with `spinline fit-jet`",
}
_NEEDLE = (
    'the needle\'s settings belong to profile = "needle" (voltage, gap, conductivity, surface_tension, permittivity, no k '
    "and beta); `spinline scenes --copy peo5-needle` gives one to start from"
)
_OF_A_NEEDLE = dict.fromkeys(
    (
        f"jet.{name}"
        for name in ("voltage", "gap", "distance", "surface_tension", "permittivity", "current", "needle", "gauge")
    ),
    _NEEDLE,
)


def _problem(detail: ErrorDetails, data: Mapping[str, Any], root: type[BaseModel]) -> InputError:
    key, kind, context = _key(detail), detail["type"], detail.get("ctx") or {}
    value = detail["input"]
    if isinstance(value, Measured):
        value = value.value
    if kind in ("quantity", "range", "refusal"):
        shown = None if kind == "refusal" else value
        remedy = context["remedy"] or ("" if kind == "refusal" else _change(key, root))
        return InputError(key, detail["msg"], value=shown, allowed=context["allowed"], remedy=remedy)
    if kind == "missing":
        where = f"add it to [{key.rpartition('.')[0]}]" if "." in key else "add it"
        return InputError(key, "is missing", remedy=_USUAL.get(key, where))
    if kind == "extra_forbidden":
        known = _known_keys(key, data, root)
        near = difflib.get_close_matches(key.rpartition(".")[2], known, n=1)
        hint = f"did you mean {near[0]!r}?" if near else _OF_A_NEEDLE.get(key, "take it out")
        return InputError(key, "is not a known key", value=value, allowed=", ".join(known), remedy=hint)
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        section = value if isinstance(value, Mapping) else {}
        problem = "is not known" if "profile" in section else "is missing"
        profiles = ", ".join(f'"{name}"' for name in JET_SECTIONS)
        return InputError(
            f"{key}.profile",
            problem,
            value=section.get("profile"),
            allowed=profiles,
            remedy=_change(f"{key}.profile", root),
        )
    allowed = str(context.get("expected", "")).replace("True", "true").replace("False", "false")
    if not allowed:
        words = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
        allowed = ", ".join(f"{words[k]} {v}" for k, v in context.items() if k in words)
    message = "is not known" if kind == "literal_error" else detail["msg"].replace("Input should be", "should be")
    return InputError(key, message, value=value, allowed=allowed, remedy=_change(key, root))


def _change(key: str, root: type[BaseModel]) -> str:
    return f"change it in the {'scene' if root is Scene else 'file'}, or with --set {key}=VALUE"


def _known_keys(key: str, data: Mapping[str, Any], root: type[BaseModel]) -> list[str]:
    models: dict[str, type[BaseModel]] = {
        "solution": SolutionSection,
        "solution.polymer": PolymerData,
        "solution.solvent": SolventData,
        **{f"jet {name}": section for name, section in JET_SECTIONS.items()},
        "ambient": AmbientSection,
        "rheology": RheologySection,
        "effects": EffectsSection,
        "network": NetworkSection,
        "accuracy": AccuracySection,
        "collector": CollectorSection,
        "mat": MatSection,
    }
    section = key.rpartition(".")[0]
    if root is not Scene and section in root.model_fields:  # another sheet: its own sections
        kinds = [root.model_fields[section].annotation, *get_args(root.model_fields[section].annotation)]
        return [
            name
            for kind in kinds
            if isinstance(kind, type) and issubclass(kind, BaseModel)
            for name in kind.model_fields
        ]
    if section == "jet":
        section = f"jet {data['jet']['profile']}"
    return list(models.get(section, root).model_fields)
