"""The command that makes X-ray frames of a computed jet."""

import inspect
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import Field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from spinline.base.constants import KEV
from spinline.base.errors import InputError
from spinline.cli.speech import say
from spinline.radiography.camera import Camera

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["register", "simulate_image"]


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("simulate-image")(simulate_image)


def simulate_image(source: str, **given: Any) -> None:
    """X-ray frames of a computed jet, with the images file that reduces them."""
    from spinline.base.files import outputs
    from spinline.radiography.simulate import simulate, write_frames

    out, force = given.pop("out"), given.pop("force")
    z_from, z_to = given.pop("z_from"), given.pop("z_to")
    # a name of its own: NAME.toml, which goes beside NAME.npz, may be the very scene
    target = out or Path(f"{Path(source).stem}-frames.npz")
    if Path(target).suffix.lower() not in (".npz", ".tif", ".tiff"):
        raise InputError("--out", "is neither .npz nor .tif", value=str(target), remedy="name it frames.npz")
    outputs(target, target.with_suffix(".toml"), force=force)
    camera = _camera(given)
    result = _result(source)
    start = None if z_from is None else _read(z_from, "length", "--from")
    stop = None if z_to is None else _read(z_to, "length", "--to")
    with _by_options():
        made = simulate(result, camera, start=start, stop=stop)
    files = write_frames(made, result, target, force=force)
    _, rows, pixels = made.counts.shape
    say(
        f"{made.counts.shape[0]} frames of {rows} x {pixels} pixels; darkest {100 * (1 - made.transmission.min()):.3g} % "
        f"under the beam, mean polymer fraction {made.jet.mean_fraction.min():.4g} to {made.jet.mean_fraction.max():.4g}"
    )
    say("wrote " + ", ".join(map(str, files)))


@contextmanager
def _by_options() -> Iterator[None]:
    """Errors by the names of the options."""
    options = {item.name: _option(item) for item in fields(Camera) if item.metadata} | {
        "start": "--from",
        "stop": "--to",
    }
    try:
        yield
    except InputError as error:
        field, value, allowed = options.get(error.field, error.field), error.value, error.allowed
        if error.field in ("tilt", "tilt_out"):
            value, allowed = math.degrees(value), "-60 to 60 degrees"
        raise InputError(field, error.problem, value=value, allowed=allowed, remedy=error.remedy) from None


def _read(given: Any, kind: str, option: str) -> Any:
    """An option as the camera takes it."""
    if given is None or kind in ("number", "count"):
        return given
    if kind == "degrees":
        return math.radians(given)
    from spinline.base.units import parse

    value = parse(given, kind, option).value
    return value / KEV if kind == "energy" else value


def _camera(given: dict[str, Any]) -> Camera:
    return Camera(
        **{
            item.name: _read(given[item.name], item.metadata["kind"], _option(item))
            for item in fields(Camera)
            if item.metadata
        }
    )


def _option(item: "Field[Any]") -> str:
    """Name of a camera's field on the command line."""
    return str(item.metadata["option"]) or "--" + item.name.replace("_", "-")


def _asked(item: "Field[Any]") -> inspect.Parameter:
    """A camera's field as an option: quantities as text with their unit."""
    kind, default = item.metadata["kind"], cast("Any", item.default)
    as_asked: dict[str, tuple[Any, Any]] = {
        "energy": (str, f"{float(default or 0):g} keV"),
        "length": (str, _shown(default) if kind == "length" else ""),
        "degrees": (float, 0.0),
        "number": (float, default),
        "count": (int | None if default is None else int, default),
    }
    hint, shown = as_asked[kind]
    annotation: Any = Annotated[hint, typer.Option(_option(item), help=item.metadata["help"])]
    return inspect.Parameter(item.name, inspect.Parameter.KEYWORD_ONLY, default=shown, annotation=annotation)


def _shown(length: float) -> str:
    return f"{1e6 * length:g} um" if length else "0 um"


def _parameters() -> list[inspect.Parameter]:
    """The command's own parameters, and one for each field of the camera."""
    source = Annotated[
        str, typer.Argument(metavar="SOURCE", help="Result of run (.nc), a scene file, or a bundled scene's name.")
    ]
    own = [
        (
            "out",
            Path | None,
            None,
            typer.Option("-o", "--out", help="Frames, .npz or .tif. Default: SOURCE's name with -frames.npz."),
        ),
        ("z_from", str | None, None, typer.Option("--from", help='Field of view along the jet, "0.1 mm".')),
        ("z_to", str | None, None, typer.Option("--to", help='Its end, "0.4 mm".')),
        ("force", bool, False, typer.Option("--force", help="Overwrite files.")),
    ]
    keyword = inspect.Parameter.KEYWORD_ONLY
    return [
        inspect.Parameter("source", inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=source),
        *(inspect.Parameter(n, keyword, default=d, annotation=Annotated[h, o]) for n, h, d, o in own),
        *(_asked(item) for item in fields(Camera) if item.metadata),
    ]


simulate_image.__signature__ = inspect.Signature(_parameters())  # type: ignore[attr-defined]
simulate_image.__annotations__ = {parameter.name: parameter.annotation for parameter in _parameters()}


def _result(source: str) -> "xr.Dataset":
    """A result from its file, or by running a scene."""
    if Path(source).suffix == ".nc":
        from spinline.solve.results import open_result

        return open_result(source)
    from spinline.scene.file import load_scene
    from spinline.solve.spine import run

    return run(load_scene(source))
