"""Commands on many scenes and many results: ``sweep``, ``compare``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from spinline.cli.options import ForceOption, JsonOption, ModelOption, RtolOption, SetOption
from spinline.cli.progress import progress_of
from spinline.cli.speech import say

if TYPE_CHECKING:
    import xarray as xr

    from spinline.study.compare import Comparison

__all__ = ["register"]

WorkersOption = Annotated[int | None, typer.Option(metavar="N", help="Processes. Default: as many as it pays for.")]


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command()(sweep)
    app.command()(compare)


def sweep(
    file: Annotated[str, typer.Argument(metavar="SWEEP", help="Sweep file, or the name of a bundled sweep.")],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Store, zarr. Default: SWEEP's name with .zarr.")
    ] = None,
    sobol: Annotated[
        bool, typer.Option("--sobol", help="Sobol' indices: the design that they need, and a table.")
    ] = False,
    output: Annotated[list[str] | None, typer.Option(help="Number whose indices to print, repeatable.")] = None,
    workers: WorkersOption = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help="dask scheduler, tcp://host:8786.")] = None,
    json: JsonOption = False,
    force: ForceOption = False,
    model: ModelOption = None,
    rtol: RtolOption = None,
    set_: SetOption = None,
) -> None:
    """Many scenes into one store; run again after a kill, it goes on where it was."""
    import json as json_

    import numpy as np

    from spinline.study.rows import STATUS_NAMES, WAYS
    from spinline.study.sensitivity import OUTPUTS
    from spinline.study.sensitivity import sobol as sobol_
    from spinline.study.sweep import load_sweep, run_sweep

    loaded = load_sweep(file, _overrides(model, rtol, set_), sensitivity=sobol)
    target = out or Path(f"{Path(file).stem}.zarr")
    with progress_of("scenes") as progress:
        try:
            result = run_sweep(loaded, target, workers=workers, scheduler=scheduler, force=force, progress=progress)
        except KeyboardInterrupt:
            say(f"stopped; what is done is in {target}: the same command goes on from there", err=True)
            raise typer.Exit(130) from None
    status, counts = np.unique(result["status"].values, return_counts=True)
    ways, rows = np.unique(result["computed_by"].values, return_counts=True)
    tally = {STATUS_NAMES[int(s)]: int(n) for s, n in zip(status, counts, strict=True)}
    answer: dict[str, Any] = {
        "out": str(target),
        "scenes": int(counts.sum()),
        **tally,
        "computed_by": {WAYS[int(code)]: int(n) for code, n in zip(ways, rows, strict=True) if int(code) in WAYS},
    }
    found = sobol_(result, output or OUTPUTS) if result.attrs["design"] == "sensitivity" else None
    if json:
        if found is not None:
            answer["indices"] = _index_rows(found)
        say(json_.dumps(answer))
        return
    states, done = (", ".join(f"{n} {name}" for name, n in told.items()) for told in (tally, answer["computed_by"]))
    say(f"{answer['scenes']} scenes, {states}; {done}")
    for name, many in _reasons(result):
        say(f"  {many}: {name}")
    if found is not None:
        _index_table(found)
    say(f"wrote {target}")


def compare(
    a: Annotated[Path, typer.Argument(metavar="A.nc", help="Result of `spinline run`.")],
    b: Annotated[Path, typer.Argument(metavar="B.nc", help="Another.")],
    tolerance: Annotated[float, typer.Option(help="Relative difference that is none.")] = 1e-12,
    json: JsonOption = False,
) -> None:
    """What differs between two results: scene, models, numbers, profiles."""
    import json as json_

    from spinline.solve.results import open_result
    from spinline.study.compare import compare as compare_

    found = compare_(open_result(a), open_result(b), rtol=tolerance)
    if json:
        say(json_.dumps(found.to_dict(), ensure_ascii=False))
        return
    _comparison(found)


def _comparison(found: "Comparison") -> None:
    for heading, texts in (("scene", found.scene), ("models", found.models)):
        for text in texts:
            say(f"{heading:9s}{text.name}: {_shown(text.a)} | {_shown(text.b)}")
    for s in found.scalars:
        unit = "" if s.unit in ("", "1") else f" {s.unit}"
        apart = f", {s.sigmas:.2g} standard uncertainties" if s.sigmas == s.sigmas else ""
        one, other = (
            f"{x:.6g}" + (f" ± {std:.2g}" if std == std else "") for x, std in ((s.a, s.a_std), (s.b, s.b_std))
        )
        say(f"number   {s.name}: {one} | {other}{unit} ({_percent(s.relative)}{apart})")
    for p in found.profiles:
        alone = f"; {p.one_sided} places in one only" if p.one_sided else ""
        say(
            f"profile  {p.name}: {_percent(p.largest)} at {1e3 * p.position:.4g} mm, "
            f"{_percent(p.of_range)} of its largest{alone}"
        )
    for which, names in (("first", found.only_a), ("second", found.only_b)):
        if names:
            say(f"only in the {which}: {', '.join(names)}")
    if found.not_compared:
        say(f"not compared, other places across the jet: {', '.join(found.not_compared)}")
    if found.same:
        say(f"no number differs by more than {found.rtol:g}")
    if found.places:
        say(f"profiles compared at {found.places} places, {1e3 * found.span[0]:.4g} to {1e3 * found.span[1]:.4g} mm")
    else:
        say("the jets do not overlap: no profile was compared")


def _shown(value: Any) -> str:
    text = "-" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 100 else text[:97] + "..."


def _percent(share: float) -> str:
    return "one is not a number" if share != share else f"{100 * share:.3g} %"


def _overrides(model: str | None, rtol: str | None, overrides: list[str] | None) -> list[str]:
    forced = list(overrides or [])
    if model is not None:
        forced.append(f'network.model="{model}"')
    if rtol is not None:
        forced.append(f"accuracy.rtol={rtol}")
    return forced


def _reasons(result: "xr.Dataset", most: int = 5) -> list[tuple[str, int]]:
    """The commonest reasons, values left out, with how often."""
    import re
    from collections import Counter

    reasons = result["reason"].values
    bad = reasons[result["status"].values != 0]
    tally = Counter(re.sub(r" = [^:]+:", ":", str(reason)) for reason in bad)
    return tally.most_common(most)


def _index_rows(found: "xr.Dataset") -> list[dict[str, Any]]:
    from spinline.solve.results import plain

    rows = []
    for output in found["output"].values:
        for parameter in found["parameter"].values:
            at = found.sel(output=output, parameter=parameter)
            row = {str(name): plain(float(at[name])) for name in found.data_vars if "parameter" in found[name].dims}
            rows.append({"output": str(output), "parameter": str(parameter), **row})
    return rows


def _index_table(found: "xr.Dataset") -> None:
    share = 100 * float(found.attrs["confidence"])
    say(f"Sobol' indices, {share:g} % intervals; first order | total")
    for output in found["output"].values:
        one = found.sel(output=output)
        say(f"{output}: {float(one['mean']):.4g} +/- {float(one['std']):.2g}")
        if not one["first_order"].notnull().any():
            say("  does not vary")
            continue
        for parameter in found["parameter"].values:
            at = one.sel(parameter=parameter)
            text = " | ".join(
                f"{float(at[k]):6.3f} [{float(at[k + '_low']):6.3f}, {float(at[k + '_high']):6.3f}]"
                for k in ("first_order", "total_order")
            )
            say(f"  {parameter:28s} {text}")
