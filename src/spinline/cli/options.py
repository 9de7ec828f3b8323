"""Arguments that several commands share, and how a scene is read from them."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from spinline.scene.file import Scene

__all__ = ["ForceOption", "JsonOption", "ModelOption", "RtolOption", "SceneArgument", "SetOption", "bundled", "load"]


def bundled(kind: str) -> Callable[[str], list[str]]:
    """Completes the names of what is bundled: "scenes", "recipes", "images", "sweeps" or "fits"."""

    def names(incomplete: str) -> list[str]:
        folder = Path(__file__).parents[1] / "data" / kind
        return sorted(file.stem for file in folder.glob("*.toml") if file.stem.startswith(incomplete))

    return names


SceneArgument = Annotated[
    str,
    typer.Argument(
        metavar="SCENE", help="Scene file, or the name of a bundled scene.", autocompletion=bundled("scenes")
    ),
]
ModelOption = Annotated[str | None, typer.Option("--model", help="Override network.model.")]
RtolOption = Annotated[str | None, typer.Option("--rtol", help="Override accuracy.rtol.")]
SetOption = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Override a key of the file.")]
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
