"""The commands for X-ray images: preview, reduce, exposure."""

import os
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from spinline.base.errors import InputError
from spinline.base.progress import report, silent
from spinline.cli.options import ForceOption, JsonOption, SetOption, table
from spinline.cli.speech import say

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from spinline.rheology.solution import Solution

__all__ = ["register"]

ImagesArgument = Annotated[str, typer.Argument(metavar="IMAGES", help="Images file, or the name of a bundled set.")]
MethodOption = Annotated[str | None, typer.Option("--method", help="Override method: chord, row, map, phase.")]


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command("preview")(preview)
    app.command("reduce")(reduce)
    app.command("exposure")(exposure)


def preview(
    images: ImagesArgument,
    figure: Annotated[Path | None, typer.Option(help="Figure (.png, .pdf, .svg). Default: IMAGES-preview.png.")] = None,
    no_figure: Annotated[bool, typer.Option("--no-figure", help="Make no figure.")] = False,
    json: JsonOption = False,
    force: ForceOption = False,
    set_: SetOption = None,
) -> None:
    """Edges, axis, saturation and the error to expect, before anyone waits."""
    from spinline.base.files import outputs
    from spinline.scene.images_file import load_images

    loaded = load_images(images, set_ or [])
    picture = None if no_figure else figure or _beside(images, loaded.name, "-preview.png")
    outputs(picture, force=force)
    from spinline.radiography.preview import preview_images

    seen = preview_images(loaded)
    if picture is not None:
        from spinline.report.images_figure import preview_sheet, save_sheet

        save_sheet(preview_sheet(seen), picture, force=force)
    if json:
        _print_json(seen.numbers())
        return
    say(loaded.title or loaded.name)
    for sentence in seen.lines():
        say(f"  {sentence}")
    for remark in seen.experiment.remarks:
        say(f"warning: {remark}", err=True)
    if picture is not None:
        say(f"wrote {picture}")


def reduce(
    images: ImagesArgument,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Result, netCDF. Default: IMAGES' name with .nc.")
    ] = None,
    figure: Annotated[Path | None, typer.Option(help="Figure (.png, .pdf, .svg). Default: beside OUT.")] = None,
    no_figure: Annotated[bool, typer.Option("--no-figure", help="Make no figure.")] = False,
    csv: Annotated[Path | None, typer.Option(help="One line a block, as a table.", callback=table)] = None,
    json: JsonOption = False,
    force: ForceOption = False,
    method: MethodOption = None,
    noisy: Annotated[
        bool, typer.Option("--noisy", help="Go on although errors are expected to exceed the signal.")
    ] = False,
    workers: Annotated[int | None, typer.Option(help='Processes for frames = "each". Default: one a core.')] = None,
    set_: SetOption = None,
) -> None:
    """X-ray frames in, polymer concentration with error bars out. Interrupted, the same command goes on."""
    from spinline.base.files import outputs
    from spinline.scene.images_file import load_images

    overrides = list(set_ or []) + ([] if method is None else [f'method="{method}"'])
    loaded = load_images(images, overrides)
    target = out or _beside(images, loaded.name, ".nc")
    picture = None if no_figure else (figure or target.with_suffix(".png"))
    if picture is not None:
        from spinline.report.figures import check_format

        check_format(picture)
    files = [file for file in (target, picture, csv) if file is not None]
    if workers is not None and workers < 1:
        raise InputError("--workers", "is not a number of processes", value=workers, allowed=">= 1")
    outputs(*files, force=force, result=target)
    from spinline.radiography import reduction_dataset as reduction
    from spinline.radiography.reduce import reduce_images
    from spinline.solve import results

    kept = target.with_name(f"{target.name}.partial")
    with _progress() as said:
        result = reduce_images(
            loaded, checkpoint=kept, workers=workers or os.cpu_count() or 1, noisy=noisy, progress=said
        )
    results.save(result, target, force=force)
    if picture is not None:
        from spinline.report.images_figure import reduction_sheet, save_sheet

        save_sheet(reduction_sheet(result), picture, force=force)
    if csv is not None:
        reduction.to_csv(result, csv, force=force)
    if json:
        say(results.to_json(result))
        return
    say(result.attrs["title"])
    for sentence in reduction.lines(result):
        say(f"  {sentence}")
    say("wrote " + ", ".join(map(str, files)))


_OPTIONS = {
    "energy_kev": "--energy",
    "low_kev": "--lowest",
    "high_kev": "--highest",
    "sigma": "--sigma",
    "photons": "--photons",
    "shells": "--shells",
    "radius": "--radius",
    "pixel": "--pixel",
    "blur": "--blur",
    "tail_share": "--tail-share",
    "tail_length": "--tail-length",
}


@contextmanager
def _as_options() -> "Iterator[None]":
    """Errors by the names of the options."""
    try:
        yield
    except InputError as error:
        remedy = error.remedy.replace("low_kev", "--lowest").replace("high_kev", "--highest")
        raise InputError(
            _OPTIONS.get(error.field, error.field),
            error.problem,
            value=error.value,
            allowed=error.allowed,
            remedy=remedy,
        ) from None


def exposure(
    source: Annotated[
        str, typer.Argument(metavar="SCENE", help="Scene or images file, or a bundled name: the solution.")
    ],
    sigma: Annotated[float, typer.Option(help="Standard deviation of the mean polymer fraction wanted.")] = 0.01,
    radius: Annotated[
        list[str] | None, typer.Option(help='Jet radius, "25 um"; again for more. Default: 100, 50, 25, 10 um.')
    ] = None,
    pixel: Annotated[
        str | None, typer.Option(help='Width of a pixel, "0.67 um". Default: of the images file, or 0.67 um.')
    ] = None,
    energy: Annotated[str | None, typer.Option(help='"10 keV". Default: the best, for each radius.')] = None,
    lowest: Annotated[str, typer.Option(help="Lowest energy that the source offers.")] = "5 keV",
    highest: Annotated[str, typer.Option(help="Highest energy that the source offers.")] = "40 keV",
    photons: Annotated[
        float | None, typer.Option(help="Photons per pixel of one frame, for the number of frames.")
    ] = None,
    shells: Annotated[int, typer.Option(help="Shells fitted; 1 for the mean alone.")] = 1,
    blur: Annotated[str, typer.Option(help="Standard deviation of the detector's blur.")] = "0 um",
    tail_share: Annotated[float, typer.Option(help="Glare: share of the light in the detector's far tail.")] = 0.0,
    tail_length: Annotated[str, typer.Option(help="Its length.")] = "0 um",
    json: JsonOption = False,
    set_: SetOption = None,
) -> None:
    """How many photons, which energy, how many frames."""
    from spinline.base.units import parse
    from spinline.scene.images_file import KEV

    solution, given_pixel, given_energy, coherent = _solution(source, set_ or [])
    width = parse(pixel, "length", "--pixel").value if pixel is not None else (given_pixel or 0.67e-6)
    usual = [r for r in (100e-6, 50e-6, 25e-6, 10e-6) if r > 3.0 * width] or [100.0 * width]
    radii = [parse(r, "length", "--radius").value for r in radius] if radius else usual
    fixed = parse(energy, "energy", "--energy").value / KEV if energy is not None else given_energy
    from spinline.radiography.exposure import as_rows, plan_exposure, table

    ends = [parse(text, "energy", name).value / KEV for text, name in ((lowest, "--lowest"), (highest, "--highest"))]
    with _as_options():
        plans = plan_exposure(
            solution,
            radii,
            sigma=sigma,
            pixel=width,
            energy_kev=fixed,
            photons_per_frame=photons,
            shells=shells,
            lowest_kev=ends[0],
            highest_kev=ends[1],
            coherent=coherent,
            blur=parse(blur, "length", "--blur").value,
            tail=(tail_share, parse(tail_length, "length", "--tail-length").value),
        )
    if json:
        _print_json(as_rows(plans))
        return
    say(
        f"{solution.polymer.name}, fraction {solution.volume_fraction:.4g}: photons per {1e6 * width:.3g} um pixel, "
        f"over rows and frames, for a standard deviation of {sigma:g} of the mean fraction"
    )
    for line in table(plans):
        say(line)


def _solution(source: str, overrides: list[str]) -> "tuple[Solution, float | None, float | None, bool]":
    """Solution, pixel, energy and kind of coefficient of a scene or an images file."""
    from spinline.scene.file import bundled_scenes, read_toml, scene_from_dict
    from spinline.scene.images_file import KEV, bundled_images, images_from_dict
    from spinline.scene.kinds import kind_of
    from spinline.setup.build import build_solution

    data, text, path = read_toml(source, bundled_scenes() | bundled_images(), overrides, "scene or file of images")
    if kind_of(data) != "file of images":
        scene = scene_from_dict(data, text=text, folder=path.resolve().parent, name=path.stem)
        return build_solution(scene), None, None, True
    images = images_from_dict(data, text=text, folder=path.resolve().parent, name=path.stem)
    energy = None if images.energy is None else images.energy.value / KEV
    pixel = None if images.pixel_size is None else images.pixel_size.value
    return build_solution(images), pixel, energy, images.coherent


def _beside(source: str, name: str, ending: str) -> Path:
    path = Path(source)
    return path.with_name(path.stem + ending) if path.exists() else Path(f"{name}{ending}")


def _print_json(data: Any) -> None:
    import json

    from spinline.solve.results import plain

    def clean(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: clean(item) for key, item in value.items()}
        return [clean(item) for item in value] if isinstance(value, list) else plain(value)

    say(json.dumps(clean(data), allow_nan=False, ensure_ascii=False))


@contextmanager
def _progress() -> "Iterator[Callable[[str, int, int], None]]":
    """A bar on standard error where that is a terminal; elsewhere a line now and then."""
    if not sys.stderr.isatty():
        yield report
        return
    from rich.console import Console
    from rich.progress import Progress

    with silent(), Progress(console=Console(stderr=True), transient=True) as bar:
        tasks: dict[str, Any] = {}

        def said(what: str, done: int, total: int) -> None:
            if what not in tasks:
                tasks[what] = bar.add_task(what, total=total)
            bar.update(tasks[what], completed=done)

        yield said
