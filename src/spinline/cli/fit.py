"""Commands that compare a model with measurements: ``fit`` and ``compare-theory``."""

from pathlib import Path
from typing import Annotated

import typer

from spinline.base.errors import InputError
from spinline.cli.options import ForceOption, JsonOption, SceneArgument
from spinline.cli.speech import say

__all__ = ["register"]


def fit(
    fit_file: Annotated[str, typer.Argument(metavar="FIT", help="Fit file, or the name of a bundled fit.")],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Result, netCDF; .json and .png go beside it.")
    ] = None,
    sampler: Annotated[str | None, typer.Option(help="Override fit.sampler: least-squares, emcee.")] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Override fit.seed.")] = None,
    no_figure: Annotated[bool, typer.Option("--no-figure", help="Make no figure.")] = False,
    copy: Annotated[
        bool, typer.Option("--copy", help="Copy the bundled fit FIT here, with its data, and stop.")
    ] = False,
    json: JsonOption = False,
    force: ForceOption = False,
) -> None:
    """Parameters of a jet, with intervals, from radii and X-ray fractions."""
    from spinline.fit.fit_file import load_fit

    if copy:
        _copy(fit_file, force=force)
        return
    loaded = load_fit(fit_file)
    chosen = loaded.sampler if sampler is None else sampler
    if chosen not in ("least-squares", "emcee"):
        raise InputError("--sampler", "is not known", value=chosen, allowed="least-squares, emcee")
    from spinline.base.files import outputs, write_text

    target = out or (Path(fit_file).with_suffix(".nc") if Path(fit_file).exists() else Path(f"{loaded.name}.nc"))
    if target.suffix != ".nc":
        target = target.with_name(target.name + ".nc")
    text, picture = target.with_suffix(".json"), target.with_suffix(".png")
    files = [target, text] if no_figure else [target, text, picture]
    outputs(*files, force=force)
    from spinline.fit.least_squares import fit as solve
    from spinline.fit.output import fit_dataset, fit_json, fit_words
    from spinline.solve import results

    best = solve(loaded.problem)
    drawn = None
    if chosen == "emcee":
        from spinline.fit.posterior import sample

        drawn = sample(best, seed=loaded.seed if seed is None else seed, steps=loaded.steps, walkers=loaded.walkers)
    result = fit_dataset(best, drawn, source=loaded)
    results.save(result, target, force=force)
    write_text(text, fit_json(result) + "\n", force=force)
    if not no_figure:
        from spinline.report.fit_figure import save_fit_figure

        save_fit_figure(result, picture, force=force)
    if json:
        say(fit_json(result))
        return
    say(result.attrs["title"])
    for line in fit_words(result):
        say(f"  {line}")
    say("wrote " + ", ".join(map(str, files)))


def compare_theory(
    scene: SceneArgument,
    reduced: Annotated[Path, typer.Argument(metavar="MAP", help="Reduced X-ray map, netCDF.")],
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Result, netCDF; .png goes beside it.")] = None,
    core_within: Annotated[float, typer.Option(help="Rings within this r/R make the core.")] = 0.4,
    at: Annotated[list[str] | None, typer.Option(help='z of a section across the jet, "1 mm"; repeat.')] = None,
    fitted: Annotated[
        Path | None, typer.Option("--fit", help="Take the best parameters of this fit (.nc), and its bands.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Override a key of the scene.")
    ] = None,
    no_figure: Annotated[bool, typer.Option("--no-figure", help="Make no figure.")] = False,
    json: JsonOption = False,
    force: ForceOption = False,
) -> None:
    """A reduced X-ray map against a scene: Figs. 36 and 37, and the likelihood."""
    from spinline.base.files import outputs
    from spinline.base.units import parse
    from spinline.fit.overlay import compare_theory as compare
    from spinline.fit.overlay import theory_words
    from spinline.scene.file import load_scene
    from spinline.solve import results

    loaded = load_scene(scene, set_ or ())
    target = out or Path(f"{reduced.stem}-theory.nc")
    if target.suffix != ".nc":
        target = target.with_name(target.name + ".nc")
    files = [target] if no_figure else [target, target.with_suffix(".png")]
    outputs(*files, force=force)
    places = None if not at else [parse(place, "length", "--at").value for place in at]
    values = None if fitted is None else _fitted(fitted)
    draws = [] if fitted is None else _fit_draws(fitted)
    result = compare(loaded, reduced, core_within=core_within, places=places, values=values, draws=draws)
    results.save(result, target, force=force)
    if not no_figure:
        from spinline.report.overlay_figure import save_overlay

        save_overlay(result, files[-1], force=force)
    if json:
        say(results.to_json(result))
        return
    say(result.attrs["title"])
    for line in theory_words(result):
        say(f"  {line}")
    say("wrote " + ", ".join(map(str, files)))


def _fitted(path: Path) -> dict[str, float]:
    """Best parameters of a fit, and what it held fixed."""
    import json as json_

    from spinline.base.netcdf import open_dataset

    found = open_dataset(path)
    if "best" not in found or "fixed" not in found.attrs:
        raise InputError(str(path), "is not a fit", remedy="make one with `spinline fit`")
    best = {str(n): float(v) for n, v in zip(found["parameter"].values, found["best"].values, strict=True)}
    lost = [name for name, value in best.items() if value != value]
    if lost:
        raise InputError(
            str(path), "has parameters that were not identified", value=", ".join(lost), remedy="fit again"
        )
    return {**json_.loads(found.attrs["fixed"]), **best}


def _fit_draws(path: Path) -> list[dict[str, float]]:
    """Draws of a fit's posterior: those it holds, or of its covariance."""
    from spinline.base.netcdf import open_dataset
    from spinline.fit.posterior import stored_draws

    return stored_draws(open_dataset(path))


def _copy(name: str, *, force: bool) -> None:
    from spinline.base.files import copy_tree
    from spinline.fit.fit_file import bundled_fits

    known = bundled_fits()
    if name not in known:
        raise InputError("--copy", "is not a bundled fit", value=name, allowed=", ".join(known))
    folder = Path(name)
    if folder.exists() and not force:
        raise InputError(name, "exists", remedy="--force to overwrite its files")
    copy_tree(known[name].parent, folder, force=force)
    say(f"wrote {folder / 'fit.toml'}")


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command()(fit)
    app.command("compare-theory")(compare_theory)
