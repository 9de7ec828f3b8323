"""``spinline window``: what a process does, mapped over its settings; of a scene's network, or of a recipe's fibre."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from spinline.base.errors import InputError
from spinline.cli.options import ForceOption, JsonOption, SetOption, bundled, page
from spinline.cli.progress import progress_of
from spinline.cli.speech import say

if TYPE_CHECKING:
    import xarray as xr

    from spinline.report.window_page import Point

__all__ = ["register"]


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command(
        "window", short_help="Map fibre, crossover, orientation and dryness over voltage, gap, flow, concentration."
    )(window)


def window(
    scene: Annotated[
        str,
        typer.Argument(
            metavar="SCENE|RECIPE",
            help="Scene or recipe file, or the name of a bundled one.",
            autocompletion=lambda incomplete: bundled("scenes")(incomplete) + bundled("recipes")(incomplete),
        ),
    ],
    voltage: Annotated[str | None, typer.Option(help='"15 kV", or "5 kV .. 25 kV".')] = None,
    gap: Annotated[str | None, typer.Option(help='"15 cm", or "10 cm .. 20 cm".')] = None,
    flow_rate: Annotated[str | None, typer.Option(help='"1 mL/hour .. 10 mL/hour". Default: the file\'s.')] = None,
    concentration: Annotated[str | None, typer.Option(help='"3 wt% .. 8 wt%". Default: the file\'s.')] = None,
    conductivity: Annotated[str | None, typer.Option(help='"0.01 S/m". Default: the file\'s.')] = None,
    humidity: Annotated[str | None, typer.Option(help='Relative, "40 %". Default: the file\'s.')] = None,
    k_factor: Annotated[
        str | None, typer.Option(help="Of a scene: band of k over its estimate. Default: 0.5 .. 2.")
    ] = None,
    steps: Annotated[int | None, typer.Option(help="Values in a range. Default: 41; of a recipe 15.")] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Map, netCDF. Default: the file's name with -window.nc.")
    ] = None,
    figure: Annotated[Path | None, typer.Option(help="Figure (.png, .pdf, .svg). Default: beside OUT.")] = None,
    no_figure: Annotated[bool, typer.Option("--no-figure", help="Make no figure.")] = False,
    html: Annotated[
        Path | None, typer.Option(help="Page with sliders and values, opens offline (.html).", callback=page)
    ] = None,
    json: JsonOption = False,
    force: ForceOption = False,
    set_: SetOption = None,
) -> None:
    """Map the process: of a scene crossover, orientation and dryness, of a recipe the fibre and its regime."""
    import json as json_

    from spinline.base.files import outputs
    from spinline.base.units import parse
    from spinline.report.window_page import save_window_page
    from spinline.solve.results import save

    target = out or Path(f"{Path(scene).stem}-window.nc")
    picture = None if no_figure else figure or target.with_suffix(".png")
    outputs(target, picture, html, force=force, result=target)
    if picture is not None:
        from spinline.report.style import check_format

        check_format(picture)
    recipe = _is_recipe(scene)
    count = (15 if recipe else 41) if steps is None else steps
    if not 2 <= count <= 2000:
        raise InputError("--steps", "is out of range", value=steps, allowed="2 to 2000", remedy="take 41")
    ranges: dict[str, Any] = {
        name: None if text is None else _range(text, kind, f"--{name.replace('_', '-')}", count)
        for name, text, kind in (
            ("voltage", voltage, "potential"),
            ("gap", gap, "length"),
            ("flow_rate", flow_rate, "flow rate"),
        )
    }
    ranges["mass_fraction"] = (
        None if concentration is None else _range(concentration, "mass fraction", "--concentration", count)
    )
    if recipe:
        if k_factor is not None:
            raise InputError("--k-factor", "is for a scene: a recipe has no k", value=k_factor, remedy="leave it out")
        more = [] if conductivity is None else [f'solution.conductivity="{conductivity}"']
        more += [] if humidity is None else [f'ambient.relative_humidity="{humidity}"']
        found, answer, words, points = _of_recipe(scene, ranges, [*(set_ or []), *more])
    else:
        for name in ("voltage", "gap"):
            if ranges[name] is None:
                raise InputError(
                    f"--{name}",
                    "is missing: the estimate of k needs it",
                    remedy='give a value or a range, "5 kV .. 25 kV"',
                )
        sigma = None if conductivity is None else parse(conductivity, "conductivity", "--conductivity").value
        wet = None if humidity is None else parse(humidity, "fraction", "--humidity").value
        factors = _range("0.5 .. 2" if k_factor is None else k_factor, "number", "--k-factor", 2)
        given = {"conductivity": sigma, "relative_humidity": wet, "k_factor": (factors[0], factors[-1])}
        found, answer, words = _of_scene(scene, ranges, given, set_ or [])
        points = []
    if picture is not None:
        _figure(recipe)(found, picture, force=force)
    if html is not None:
        save_window_page(found, html, points, force=force)
    save(found, target, force=force)
    if json:
        say(json_.dumps(answer))
        return
    for line in words:
        say(line)
    say("wrote " + ", ".join(str(path) for path in (target, picture, html) if path is not None))


def _figure(recipe: bool) -> "Callable[..., Any]":
    if recipe:
        from spinline.report.fibre_window_figure import save_fibre_window_figure

        return save_fibre_window_figure
    from spinline.report.window_figure import save_window_figure

    return save_window_figure


def _is_recipe(source: str) -> bool:
    """Whether a file is a recipe, or a scene."""
    from spinline.recipe.recipe_file import bundled_recipes
    from spinline.scene.file import bundled_scenes, read_toml
    from spinline.scene.kinds import kind_of

    data, _, _ = read_toml(source, {**bundled_recipes(), **bundled_scenes()}, (), noun="scene or recipe")
    return kind_of(data) == "recipe"


def _of_scene(
    scene: str, ranges: dict[str, Any], given: dict[str, Any], overrides: list[str]
) -> "tuple[xr.Dataset, dict[str, Any], list[str]]":
    """Map, answer in names and in words."""
    import numpy as np

    from spinline.scene.file import load_scene
    from spinline.study.window import operating_window

    with progress_of("scenes") as progress:
        found = operating_window(load_scene(scene, overrides), **ranges, **given, progress=progress)
    reached = np.isfinite(found["crossover_position"].values).reshape(3, -1).mean(axis=1)
    k, (low, high) = found["k"].sel(k_factor=1.0).values, given["k_factor"]
    answer = {
        "points": int(k.size),
        "k_low": float(k.min()),
        "k_high": float(k.max()),
        "reached_low": float(reached[0]),
        "reached": float(reached[1]),
        "reached_high": float(reached[2]),
        "viscosity_law": found.attrs["viscosity_law"],
        "air": found.attrs["air"],
    }
    estimate = f"k = {k.min():.3g} to {k.max():.3g}, to a factor of {low:g} to {high:g}"
    if np.isnan(k).all():
        estimate = "jets computed from their settings"
    words = [
        f"{estimate}; viscosity: {answer['viscosity_law']}; drying: {answer['air']}",
        f"crossover within the jet in {100 * reached[1]:.3g} % of the window "
        f"({100 * reached[0]:.3g} to {100 * reached[2]:.3g} % for k within its factor)",
    ]
    return found, answer, words


def _of_recipe(
    recipe: str, ranges: dict[str, Any], overrides: list[str]
) -> "tuple[xr.Dataset, dict[str, Any], list[str], list[Point]]":
    """Map, answer in names and in words, and what was measured."""
    import numpy as np

    from spinline.recipe.recipe_file import load_recipe
    from spinline.recipe.window import fibre_window
    from spinline.report.window_page import AXES, Point

    sheet = load_recipe(recipe, overrides)
    with progress_of("recipes") as progress:
        found = fibre_window(sheet, **ranges, progress=progress)
    median = found["fibre_diameter"].values[1]
    names, counts = np.unique(found["regime"].values[1], return_counts=True)
    answer: dict[str, Any] = {
        "points": int(median.size),
        "refused": int(np.isnan(median).sum()),
        "fibre_diameter_least": float(np.nanmin(median)) if np.isfinite(median).any() else None,
        "fibre_diameter_most": float(np.nanmax(median)) if np.isfinite(median).any() else None,
        "regimes": {str(name): int(count) for name, count in zip(names, counts, strict=True)},
    }
    share = ", ".join(
        f"{name} {100 * count / median.size:.3g} %"
        for name, count in sorted(answer["regimes"].items(), key=lambda x: -x[1])
    )
    if answer["fibre_diameter_least"] is None:
        words = [f"no point could be computed: {found['reason'].values.ravel()[0]}"]
    else:
        low, high = 1e9 * answer["fibre_diameter_least"], 1e9 * answer["fibre_diameter_most"]
        words = [f"fibres of {low:.3g} to {high:.3g} nm (medians); of the window: {share}"]
    if median.size == 1:
        words.append('one point: a range is mapped, for example --voltage "8 kV .. 25 kV"')
    odd = found["remark"].values[1].ravel()
    answer["outside"] = int(np.count_nonzero(odd != ""))
    if answer["outside"]:
        words.append(
            f"warning: {answer['outside']} of {odd.size} points lie outside anything that is spun, as {odd[odd != ''][-1]}"
        )
    points = [
        Point({name: float(getattr(one.recipe, name)) for name in AXES}, "fibre_diameter", one.diameter)
        for one in sheet.measurements()
    ]
    return found, answer, words, points


def _range(text: str, kind: str, field: str, steps: int) -> list[float]:
    """``"5 kV .. 25 kV"`` as so many values; one value alone."""
    import numpy as np

    from spinline.base.units import parse

    ends = [end.strip() for end in text.split("..")]
    meant = _range_meant(text) if len(ends) == 1 else ""
    if meant:
        raise InputError(field, "is neither a value nor a range", value=text, remedy=f'write a range as "{meant}"')
    if len(ends) > 2:
        raise InputError(field, "is neither a value nor a range", value=text, remedy='write it as "5 kV .. 25 kV"')
    if len(ends) == 2 and _bare(ends[0]):  # "5 .. 25 kV": the unit is that of the other end
        ends[0] += " " + ends[1].lstrip("+-0123456789.eE ")
    numbers = [parse(end, kind, field).value for end in ends]
    if kind == "mass fraction" and max(numbers) > 1:
        percent = text if "%" in text else f"{text} wt%"
        raise InputError(
            field,
            "is more than polymer alone",
            value=text,
            allowed="0 to 1, or 0 wt% to 100 wt%",
            remedy=f'percent by mass are written "{percent}"',
        )
    if len(numbers) == 1:
        return numbers
    if not numbers[0] < numbers[1]:
        raise InputError(field, "does not rise", value=text, remedy="swap its ends")
    return [float(x) for x in np.linspace(numbers[0], numbers[1], steps)]


def _range_meant(text: str) -> str:
    """The range of "5-25 kV", "5 to 25 kV", "5, 25 kV" or "15 +/- 10 kV" as it is written here; "" of any other text."""
    from spinline.base.quantity_text import written

    found = written(text)
    if found is not None and found.std > 0:
        std = 0.01 * found.std * found.value if found.std_unit == "%" else found.std
        return f"{found.value - std:g} .. {found.value + std:g} {found.unit}"
    number = r"\d+(?:\.\d+)?"
    parts = re.fullmatch(rf"({number})\s*([^\d\s,–-]*)\s*(?:-|–|—|:|;|,\s|to|bis)\s*({number})\s*(\D.*)", text.strip())
    return f"{parts[1]} {parts[2]} .. {parts[3]} {parts[4]}".replace("  ", " ") if parts else ""


def _bare(text: str) -> bool:
    """Whether a text is a number without a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True
