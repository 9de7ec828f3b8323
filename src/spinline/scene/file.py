"""The scene file: what a user writes, checked, with every quantity in SI.

A scene is TOML. Quantities are text with their unit; unknown keys are refused and the nearest known one is suggested.
`load_scene` reads a path or the name of a bundled scene; `Scene.model_validate` checks a dictionary.
"""

from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from spinline.scene.jets import HyperbolicJet, JetspinJet, LagrangianJetFile, PowerLawJet, TableJet
from spinline.scene.materials_file import own_materials
from spinline.scene.sections import (
    JET_SECTIONS,
    MODELS,
    AccuracySection,
    NetworkSection,
    PolymerData,
    Scene,
    SolutionSection,
    SolventData,
    add_jet_section,
    add_model,
    register_law,
)
from spinline.scene.sheets import LONGEST, apply_override, checked, given_file, read_toml

__all__ = [
    "JET_SECTIONS",
    "LONGEST",
    "MODELS",
    "AccuracySection",
    "HyperbolicJet",
    "JetspinJet",
    "LagrangianJetFile",
    "NetworkSection",
    "PolymerData",
    "PowerLawJet",
    "Scene",
    "SolutionSection",
    "SolventData",
    "TableJet",
    "add_jet_section",
    "add_model",
    "apply_override",
    "bundled_scenes",
    "checked",
    "given_file",
    "json_schema",
    "load_scene",
    "read_toml",
    "register_law",
    "scene_from_dict",
]


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
    return own_materials(scene)


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


def bundled_scenes() -> dict[str, Path]:
    """Names of the bundled scenes and their files."""
    folder = Path(str(resources.files("spinline") / "data" / "scenes"))
    return {file.stem: file for file in sorted(folder.glob("*.toml"))}


def json_schema() -> dict[str, Any]:
    """JSON Schema of the scene file, for editors."""
    schema = Scene.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "spinline scene"}
