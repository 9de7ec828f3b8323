"""Any TOML file of a user's: found, read, overrides applied, checked against its model."""

import difflib
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from spinline.base.errors import InputError
from spinline.base.text import parsed_toml, read_toml_text
from spinline.scene.problems import explain
from spinline.scene.quantities import Sheet

__all__ = ["LONGEST", "apply_override", "checked", "given_file", "hint_of", "read_toml", "refuse_another_kind"]


_Sheet = TypeVar("_Sheet", bound=Sheet)


LONGEST = 1_000_000  # characters of a scene


def checked(model: type[_Sheet], data: Mapping[str, Any], text: str, folder: Path | None, name: str) -> _Sheet:
    """A sheet from nested dictionaries, or an error with every problem found."""
    try:
        sheet = model.model_validate(data)
    except ValidationError as error:
        refuse_another_kind(data, _KINDS.get(model.__name__, ""), name)
        raise explain(error, name, data, model) from None
    sheet._text, sheet._folder, sheet._name = text, folder or Path(), name
    return sheet


# models of whole files, and what they are of
_KINDS = {"Scene": "scene", "MatScene": "scene", "RecipeSheet": "recipe", "Images": "file of images"}
_COMMANDS = {"scene": "run", "recipe": "fibre", "file of images": "reduce", "fit": "fit", "sweep": "sweep"}
_RECIPE = {
    "": {"title", "solution", "jet", "ambient", "collector", "measured"},
    "solution": {
        *(
            "polymer",
            "solvent",
            "concentration",
            "molar_mass",
            "viscosity",
            "conductivity",
            "surface_tension",
            "temperature",
        ),
    },
    "jet": {"voltage", "gap", "flow_rate", "radius", "gauge", "current"},
}


def refuse_another_kind(data: Mapping[str, Any], kind: str, name: str) -> None:
    """Refuse a file that is plainly of another kind, with the command that takes it.

    Raises
    ------
    InputError
    """
    found = _kind_of(data)
    if found and kind and found != kind:
        raise InputError(name, f"is a {found}, not a {kind}", remedy=f"`spinline {_COMMANDS[found]}` takes it")


def _kind_of(data: Mapping[str, Any]) -> str:
    """What a file's keys make it, "" where they do not say."""
    jet = data.get("jet")
    if isinstance(jet, Mapping) and ("profile" in jet or isinstance(data.get("network"), Mapping)):
        return "scene"
    if "counts" in data or "transmission" in data or "absorbance" in data:
        return "file of images"
    if "scene" in data and ("data" in data or "parameters" in data):
        return "fit"
    if "scene" in data and ("vary" in data or "design" in data):
        return "sweep"
    sections = {part: data if part == "" else data.get(part) for part in _RECIPE}
    fits = all(isinstance(keys, Mapping) and set(keys) <= _RECIPE[part] for part, keys in sections.items())
    return "recipe" if fits and isinstance(jet, Mapping) and {"voltage", "gap", "flow_rate"} <= set(jet) else ""


def read_toml(
    source: str | Path, bundled: Mapping[str, Path], overrides: Sequence[str], noun: str = "scene"
) -> tuple[dict[str, Any], str, Path]:
    """Content, text and path of a TOML file or of a bundled one of that name, overrides applied."""
    path = given_file(source, bundled)
    data, text = read_toml_text(path, noun, LONGEST, hint_of(source, bundled))
    for override in overrides:
        apply_override(data, override)
    if overrides:
        text = text.rstrip() + "\n" + "".join(f"# --set {override}\n" for override in overrides)
    return data, text, path


# folders of the package's data, what is in them, and the command that takes it
_BUNDLED = {
    "scenes": ("scene", "run"),
    "recipes": ("recipe", "fibre"),
    "images": ("file of images", "reduce"),
    "fits": ("fit", "fit"),
    "sweeps": ("sweep", "sweep"),
}


def hint_of(
    source: str | Path, bundled: Mapping[str, Path], otherwise: str = "`spinline scenes` lists the bundled ones"
) -> str:
    """What to do about a name that is no file and not bundled: another command's, or one that is nearly so called."""
    from importlib import resources

    name = str(source)[:200]
    data = Path(str(resources.files("spinline") / "data"))
    for folder, (what, command) in _BUNDLED.items():
        if re.fullmatch(r"[\w-]+", name) and (
            (data / folder / f"{name}.toml").is_file() or (data / folder / name).is_dir()
        ):
            return f"it is a bundled {what}: `spinline {command} {name}`"
    near = difflib.get_close_matches(name, bundled, n=1)
    return f"did you mean the bundled {near[0]!r}?" if near else otherwise or "`spinline scenes` lists the bundled ones"


def given_file(source: str | Path, bundled: Mapping[str, Path]) -> Path:
    """The file of that name, else the bundled one."""
    try:
        there = Path(source).exists()
    except (OSError, ValueError):  # a name that no file can have
        there = False
    return Path(source) if there else bundled.get(str(source), Path(source))


def apply_override(data: dict[str, Any], override: str) -> None:
    """Set one KEY=VALUE of nested dictionaries; text needs no quotes."""
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
