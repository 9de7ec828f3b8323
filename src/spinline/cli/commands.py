"""The command line. Every command is a function of a few options; what it does is done elsewhere.

Bad input ends with exit code 2 and one message on standard error; warnings go to standard error too, so that standard
output holds the answer alone.
"""

import gc
import os
import sys
import warnings
from copy import copy
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.files import command, note_input
from spinline.base.progress import telling
from spinline.cli.cite import register as register_cite
from spinline.cli.deposit import register as register_deposit
from spinline.cli.fibre import register as register_fibre
from spinline.cli.fit import register as register_fit
from spinline.cli.group import Commands
from spinline.cli.images import register as register_images
from spinline.cli.jet import register as register_jet
from spinline.cli.options import (
    ForceOption,
    JsonOption,
    ModelOption,
    ReportOption,
    RtolOption,
    SceneArgument,
    SetOption,
    load,
    table,
)
from spinline.cli.signals import stopping
from spinline.cli.simulate import register as register_simulate
from spinline.cli.speech import say, streams, unheard
from spinline.cli.spin import register as register_spin
from spinline.cli.sweep import register as register_sweep
from spinline.cli.trade import plan
from spinline.cli.trade import trade as trade_command
from spinline.cli.window import register as register_window

if TYPE_CHECKING:
    from spinline.base.checks import FloatArray
    from spinline.base.named_arrays import NamedArrays
    from spinline.scene.file import Scene

__all__ = ["app", "main"]


app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="The polymer network inside an electrospinning jet.",
    context_settings={"help_option_names": ["-h", "--help"]},
)


class Along(StrEnum):
    """Which distance a bead jet's radius is fitted against."""

    arc = "arc"
    x = "x"


def _version(wanted: bool) -> None:
    if wanted:
        from spinline.base.version import __version__

        say(f"spinline {__version__}")
        raise typer.Exit


@app.callback()
def _top(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """The polymer network inside an electrospinning jet."""


@app.command()
def run(
    scene: SceneArgument,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Result, netCDF. Default: SCENE's name with .nc.")
    ] = None,
    figure: Annotated[Path | None, typer.Option(help="Figure (.png, .pdf, .svg). Default: beside OUT.")] = None,
    no_figure: Annotated[bool, typer.Option("--no-figure", help="Make no figure.")] = False,
    report: ReportOption = None,
    csv: Annotated[Path | None, typer.Option(help="Profile as a table.", callback=table)] = None,
    trade: Annotated[
        bool, typer.Option("--trade", help="Measure every model on this scene as well, for the report: takes a while.")
    ] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="With --trade: only the rung next to the affine network.")
    ] = False,
    json: JsonOption = False,
    force: ForceOption = False,
    model: ModelOption = None,
    rtol: RtolOption = None,
    set_: SetOption = None,
) -> None:
    """Jet, network and concentration of a scene: one file out, one figure."""
    if quick and not trade:
        raise InputError("--quick", "is of the trade", remedy="add --trade, or leave it out")
    loaded = load(scene, model, rtol, set_)
    from spinline.base.files import outputs
    from spinline.solve import results

    target = out or _default_out(scene, loaded)
    picture = None if no_figure else (figure or target.with_suffix(".png"))
    if picture is not None:
        from spinline.report.figures import check_format

        check_format(picture)
    files = [file for file in (target, picture, report, csv) if file is not None]
    outputs(*files, force=force, result=target)
    result = _solved(loaded)
    if trade:
        from spinline.study.trade import trade as measure

        measured = measure(loaded, quick=quick, progress=lambda words: say(f"measuring {words}", err=True))
        result.attrs["trade"] = measured.json()
    results.save(result, target, force=force)
    if picture is not None:
        from spinline.report.figures import save_figure

        save_figure(result, picture, force=force)
    if report is not None:
        from spinline.report.page import save_report

        drawn = picture is not None and picture.suffix.lower() == ".png"
        save_report(result, report, force=force, picture=picture.read_bytes() if picture and drawn else None)
    if csv is not None:
        results.to_csv(result, csv, force=force)
    if json:
        say(results.to_json(result))
        return
    from spinline.report.sentences import words

    say(result.attrs["title"])
    for sentence in words(result):
        say(f"  {sentence}")
    if trade:
        say(f"  Measured: {measured.recommendation}.")
    say("wrote " + ", ".join(map(str, files)))


@app.command()
def crossover(
    scene: SceneArgument,
    json: JsonOption = False,
    model: ModelOption = None,
    rtol: RtolOption = None,
    set_: SetOption = None,
) -> None:
    """Where, and at which radius, the network is fully stretched: one line."""
    loaded = load(scene, model, rtol, set_)
    from spinline.solve import results

    result = _solved(loaded)
    if json:
        names = tuple(str(name) for name in result.data_vars if str(name).startswith("crossover"))
        say(results.to_json(result, ("volume_fraction", *names, *(["time"] if "time" in result.dims else []))))
        return
    if "time" in result.dims:
        for moment in range(result.sizes["time"]):
            say(f"{float(result['time'][moment]):.6g} s: {_crossover_line(result.isel(time=moment))}")
        return
    say(_crossover_line(result))


@app.command()
def check(scene: SceneArgument, model: ModelOption = None, rtol: RtolOption = None, set_: SetOption = None) -> None:
    """What is wrong or odd with a scene, before anything runs."""
    loaded = load(scene, model, rtol, set_)
    from spinline.plan.effects.lateral import lateral_words
    from spinline.solve.spine import build_jet, build_solution, examine

    solution = build_solution(loaded)
    if loaded.jet.profile == "spun":  # what it is given is checked; it is not spun for that
        from spinline.plan.odd_settings import odd_spinning
        from spinline.setup.spun import spun_remarks

        for remark in (*odd_spinning(loaded, loaded.jet), *spun_remarks(loaded.jet, solution, loaded)):
            say(f"remark: {remark}")
        say(f"{loaded.name}: can be spun; phi = {solution.volume_fraction:.6g}")
        return
    jet = build_jet(loaded, solution)
    remarks = examine(loaded, solution, jet)
    for remark in remarks:
        say(f"remark: {remark}")
    lateral = lateral_words(loaded, solution, jet)
    if lateral:
        say(f"note: {lateral}")
    phi = solution.volume_fraction
    say(
        f"{loaded.name}: can run; phi = {phi:.6g}, r0 = {jet.initial_radius:.6g} m"
        + (", nothing odd" if not remarks else "")
    )


@app.command()
def scenes(
    copy: Annotated[
        str | None, typer.Option(metavar="NAME", help="Copy this bundled scene or set of images, with its data.")
    ] = None,
    to: Annotated[Path, typer.Option(help="Folder to copy to.")] = Path(),
    force: ForceOption = False,
) -> None:
    """List the bundled scenes and images, or copy one to start from."""
    import tomllib

    from spinline.base.files import copy_file, copy_tree, writable
    from spinline.recipe.recipe_file import bundled_recipes
    from spinline.scene.file import bundled_scenes
    from spinline.scene.images_file import bundled_images

    known = bundled_scenes() | bundled_images() | bundled_recipes()
    if copy is None:
        for name, file in known.items():
            say(f"{name:24s}{tomllib.loads(file.read_text(encoding='utf-8'))['title']}")
        return
    if copy not in known:
        raise InputError("--copy", "is not a bundled scene", value=copy, allowed=", ".join(known))
    source = known[copy]
    writable(to / source.name, force=force)
    content = tomllib.loads(source.read_text(encoding="utf-8"))
    data = content["counts"] if "counts" in content else content["jet"].get("path")
    if data is not None:
        origin, target = source.parent / data, to / data
        if origin.is_dir():
            if target.exists() and not force:
                raise InputError(str(target), "exists", remedy="--force to overwrite its files")
            copy_tree(origin, target, force=force)
        else:
            copy_file(origin, target, force=force)
    copy_file(source, to / source.name, force=force)
    say(f"wrote {to / source.name}")


@app.command()
def schema(
    out: Annotated[Path | None, typer.Option("-o", "--out", help="File to write; default: standard output.")] = None,
    force: ForceOption = False,
) -> None:
    """JSON Schema of the scene file, for editors."""
    import json

    from spinline.base.files import write_text
    from spinline.scene.file import json_schema

    text = json.dumps(json_schema(), indent=2)
    if out is None:
        say(text)
    else:
        write_text(out, text + "\n", force=force)


app.command()(plan)
app.command("trade")(trade_command)


@app.command("fit-jet", short_help="Fit k and beta of a power law to a radius profile.")
def fit_jet(
    profile: Annotated[
        Path,
        typer.Argument(help="CSV (z, radius, radius_std, units in the header), an imported jet or a result (.nc)."),
    ],
    radius: Annotated[str | None, typer.Option(help='Initial radius, "125 um". Default: the largest.')] = None,
    z_from: Annotated[str | None, typer.Option("--from", help='Look no nearer than this, "3 mm".')] = None,
    z_to: Annotated[str | None, typer.Option("--to", help='Look no farther than this, "2 cm".')] = None,
    tolerance: Annotated[float, typer.Option(help="Departure of the radius that is still a power law.")] = 0.02,
    along: Annotated[Along, typer.Option(help="Distance that counts, for a bead jet.")] = Along.arc,
    unit: Annotated[str | None, typer.Option(help='Length unit of beads whose file has none, "cm".')] = None,
    json: JsonOption = False,
) -> None:
    """Fit the power law of Eq. (31) to a radius profile, and say where it holds."""
    import json as json_

    from spinline.base.units import parse
    from spinline.jetprofile.fit import fit_power_law

    z, r, std, r0 = _profile(profile, along, unit)
    if (empty := r != r).any() and not empty.all():  # of the last bead, which has no element
        warnings.warn(f"{profile}: rows without a radius left out: {int(empty.sum())}", SpinlineWarning, stacklevel=1)
        z, r, std = z[~empty], r[~empty], None if std is None else std[~empty]
    if radius is not None:
        r0 = parse(radius, "length", "--radius").value
    nearest = parse(z_from, "length", "--from").value if z_from is not None else 0.0
    farthest = parse(z_to, "length", "--to").value if z_to is not None else 1e300
    fit = fit_power_law(z, r, std, initial_radius=r0, z_range=(nearest, farthest), tolerance=tolerance)
    if json:
        from spinline.solve.results import plain

        say(json_.dumps({key: plain(value) for key, value in fit.__dict__.items()}))
        return
    share = fit.covariance[0, 1] / (fit.k_std * fit.beta_std) if fit.k_std and fit.beta_std else 0.0
    say(f"k = {fit.k:.5g} +/- {fit.k_std:.2g}, beta = {fit.beta:.5g} +/- {fit.beta_std:.2g}, correlation {share:.3f}")
    say(
        f"over {1e3 * fit.z_min:.4g} to {1e3 * fit.z_max:.4g} mm ({fit.samples} of {fit.samples_given} samples), "
        f"r0 = {1e6 * fit.initial_radius:.4g} um, R^2 = {fit.r_squared:.6f}, departure {100 * fit.departure:.2g} %"
    )


@app.command("import-jet")
def import_jet(
    run_dir: Annotated[Path, typer.Argument(metavar="RUN_DIR", help="JETSPIN run directory, zip, or a file of it.")],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Jet file, netCDF. Default: RUN_DIR's name with .nc.")
    ] = None,
    source: Annotated[str | None, typer.Option(help="Which file of the run to read, traj.xyz for example.")] = None,
    unit: Annotated[str | None, typer.Option(help='Length unit of XYZ without a log, "cm".')] = None,
    force: ForceOption = False,
) -> None:
    """Turn the output of a Lagrangian simulation into a jet file."""
    from spinline.base.files import outputs
    from spinline.base.netcdf import sizes_in
    from spinline.jetprofile.jetspin import write_jet
    from spinline.jetprofile.jetspin.detect import file_kind

    target = out or Path(run_dir.resolve().stem + ".nc")
    if run_dir.is_file() and run_dir.suffix.lower() != ".zip":
        file_kind(run_dir)  # before anything is said of the output, which may be the input
    outputs(target, force=force, result=target)
    write_jet(run_dir, target, source=source, unit=unit, force=force)
    sizes = sizes_in(target)
    say(f"wrote {target}: {sizes.get('time', 1)} times, up to {sizes.get('bead', 0)} beads")


REGISTERED = (
    register_fibre,
    register_sweep,
    register_window,
    register_fit,
    register_simulate,
    register_spin,
    register_images,
    register_deposit,
    register_jet,
    register_cite,
)
for register in REGISTERED:
    register(app)


def _asked(words: list[str]) -> typer.Typer:
    """The command line with the one command that is asked for: making all of them takes as long as a small run."""
    name = words[0] if words else ""
    found = [
        info
        for info in app.registered_commands
        if name == (info.name or getattr(info.callback, "__name__", "").replace("_", "-"))
    ]
    if not found:
        return app
    one = copy(app)
    one.registered_commands = found
    return one


def main() -> None:
    """Run the command line; bad input ends with one message and exit code 2, a fault of the program with 70."""
    # looking for them reads what every package says of itself
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    os.environ["MPLBACKEND"] = "agg"  # figures are files; another value may not even exist
    warnings.filterwarnings("ignore", category=DeprecationWarning)  # of the libraries: a user can do nothing about it
    warnings.filterwarnings("always", category=SpinlineWarning)
    warnings.showwarning = _show_warning
    gc.set_threshold(50_000, 20, 20)  # imports make objects that stay: looking through them took a seventh of a run
    streams()
    code = 0
    stopped: list[int] = []
    try:
        with stopping(stopped), command(), telling():
            _note_arguments(sys.argv[1:])
            code = int(_asked(sys.argv[1:])(standalone_mode=True, prog_name="spinline") or 0)
        sys.stdout.flush()
    except SystemExit as ended:
        code = ended.code if isinstance(ended.code, int) else int(ended.code is not None)
        code = _flushed(code)
    except KeyboardInterrupt:  # before or behind the command itself
        code = 128 + stopped[0] if stopped else 130
    except InputError as error:
        say(f"error: {error}", err=True)
        code = 2
    except BrokenPipeError:
        unheard()
    except MemoryError:
        say("error: there is not enough memory for this; take fewer points, shells, strands or frames", err=True)
        code = 2
    except OSError as error:
        say(f"error: {error.filename or 'the system'}: {error.strerror or error}", err=True)
        unheard()
        code = 2
    except Exception as error:
        if os.environ.get("SPINLINE_TRACEBACK"):
            raise
        if stopped:  # the exception of the signal came out as another: of a class that was being made, for example
            sys.exit(128 + stopped[0])
        say(
            f"error: a fault of this program, please report it: {type(error).__name__}: {error} "
            "(SPINLINE_TRACEBACK=1 shows where)",
            err=True,
        )
        code = 70
    sys.exit(code)


def _note_arguments(words: list[str]) -> None:
    """Say which files are given to be read, so that an output with the same name is refused before anything is computed."""
    for before, word in zip(["", *words], words, strict=False):
        if not word.startswith("-") and (not before.startswith("-") or before in ("--table", "--measured", "--fit")):
            note_input(word)


def _flushed(code: int) -> int:
    """Write out what was said; a reader that went away is no error, a full disk is."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        unheard()
    except OSError as error:
        say(f"error: standard output: {error.strerror}", err=True)
        unheard()
        return code or 2
    return code


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    say(f"warning: {message}", err=True)


def _solved(scene: "Scene") -> "NamedArrays":
    """`spinline.run` without a Dataset: half the time of a start."""
    from spinline.solve.spine import solved

    result = solved(scene)
    for remark in str(result.attrs["warnings"]).splitlines():
        warnings.warn(remark, SpinlineWarning, stacklevel=2)
    return result


def _default_out(scene: str, loaded: "Scene") -> Path:
    path = Path(scene)
    return path.with_suffix(".nc") if path.exists() else Path(f"{loaded.name}.nc")


def _crossover_line(result: "NamedArrays") -> str:
    from spinline.report.sentences import headline

    line = headline(result)
    position = float(result["crossover_extension_position"])
    if position == position:
        share = float(result.attrs["crossover_extension_criterion"])
        radius = float(result["crossover_extension_radius"])
        line += f"; extension {share:g} at {1e3 * position:.3g} mm, radius {1e6 * radius:.3g} µm"
    return line


def _profile(
    path: Path, along: Along, unit: str | None
) -> "tuple[FloatArray, FloatArray, FloatArray | None, float | None]":
    """Distance, radius, its standard deviation and r_0 from a CSV file or an imported jet."""
    from spinline.jetprofile.readers import holds_beads, read_beads

    if path.suffix != ".nc" and not path.is_dir() and not holds_beads(path):
        from spinline.jetprofile.columns import read_columns

        kinds = {"z": "length", "radius": "length", "radius_std": "length"}
        columns = read_columns(path, kinds, required=("z", "radius"), others=True)
        return columns["z"], columns["radius"], columns.get("radius_std"), None
    from spinline.base.netcdf import open_dataset
    from spinline.jetprofile.lagrangian import LagrangianJet

    if path.suffix != ".nc":
        jet = read_beads(path, unit=unit).at()
    else:
        dataset = open_dataset(path)
        # a result, of a straight jet or of one moment of beads
        if "radius" in dataset and "initial_radius" in dataset.attrs:
            place = {"z": "z", "element": "arc_length"}.get(" ".join(map(str, dataset["radius"].dims)), "")
            if place in dataset:
                return dataset[place].values, dataset["radius"].values, None, float(dataset.attrs["initial_radius"])
        try:
            jet = LagrangianJet.from_dataset(dataset).at()
        except InputError as error:
            remedy = "give a table of z and radius, a result of `spinline run` or `spin`, or a file of `import-jet`"
            raise InputError(str(path), f"holds no radius along a jet: {error.problem}", remedy=remedy) from None
    distance = jet.arc_length if along is Along.arc else 0.5 * (jet.x[1:] + jet.x[:-1])
    return distance[jet.usable], jet.element_radius[jet.usable], None, jet.initial_radius
