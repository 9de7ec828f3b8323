"""Arguments that several commands share, and how a scene is read from them."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spinline.base.errors import InputError

if TYPE_CHECKING:
    from spinline.scene.file import Scene

__all__ = [
    "ForceOption",
    "JsonOption",
    "ModelOption",
    "ReportOption",
    "RtolOption",
    "SceneArgument",
    "SetOption",
    "bundled",
    "load",
    "page",
    "table",
]


def bundled(kind: str) -> Callable[[str], list[str]]:
    """Completes the names of what is bundled: "scenes", "recipes", "images", "sweeps" or "fits"."""

    def names(incomplete: str) -> list[str]:
        folder = Path(__file__).parents[1] / "data" / kind
        return sorted(file.stem for file in folder.glob("*.toml") if file.stem.startswith(incomplete))

    return names


_OTHERS = [
    ".xlsx",
    ".xlsm",
    ".xls",
    ".ods",
    ".nc",
    ".h5",
    ".hdf5",
    ".json",
    ".toml",
    ".html",
    ".htm",
    ".pdf",
    ".png",
    ".svg",
    ".jpg",
    ".jpeg",
    ".tif",
    ".tiff",
    ".docx",
    ".csv",
]


def _written_as(form: str, given: Path | None, *endings: str) -> Path | None:
    """The file, or a refusal where its name says another format: a spreadsheet or a viewer would refuse it later."""
    if given is not None and given.suffix.lower() in set(_OTHERS) - set(endings):
        raise InputError(
            str(given),
            f"is written as {form}, and is named as {given.suffix}",
            allowed=", ".join(endings),
            remedy=f"name it {given.with_suffix(endings[0])}",
        )
    return given


def table(given: Path | None) -> Path | None:
    """A table's file, of an option: CSV, under a name that says no other format."""
    return _written_as("CSV", given, ".csv", ".txt", ".tsv", ".dat")


def page(given: Path | None) -> Path | None:
    """A page's file, of an option: HTML, under a name that says no other format."""
    return _written_as("HTML", given, ".html", ".htm")


SceneArgument = Annotated[
    str,
    typer.Argument(
        metavar="SCENE", help="Scene file, or the name of a bundled scene.", autocompletion=bundled("scenes")
    ),
]
ModelOption = Annotated[str | None, typer.Option("--model", help="Override network.model.")]
RtolOption = Annotated[str | None, typer.Option("--rtol", help="Override accuracy.rtol.")]
SetOption = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Override a key of the file.")]
ReportOption = Annotated[Path | None, typer.Option("--report", help="Report, one HTML file.", callback=page)]
JsonOption = Annotated[bool, typer.Option("--json", help="Print names and SI values as JSON.")]
ForceOption = Annotated[bool, typer.Option("--force", help="Overwrite files.")]


def load(scene: str, model: str | None, rtol: str | None, overrides: list[str] | None) -> "Scene":
    """Read a scene with what the command line overrides."""
    from spinline.scene.file import load_scene

    forced = list(overrides or [])
    if model is not None:
        forced.append(f'network.model="{model}"')
    if rtol is not None:
        forced.append(f"accuracy.rtol={rtol}")
    return load_scene(scene, forced)
