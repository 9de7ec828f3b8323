"""The commands for what lies on the collector: deposit, mat."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.words import label
from spinline.cli.options import ForceOption, JsonOption, ReportOption, SetOption, table
from spinline.cli.speech import say

if TYPE_CHECKING:
    import xarray as xr

    from spinline.deposit.collectors import Belt, Drum, Plate

__all__ = ["register"]

_ROW_BYTES = 60


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command("deposit")(deposit)
    app.command("mat")(mat)


def deposit(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SCENE|JET|RUN_DIR", help="Scene with [laydown] and [collector], file of landings, or run."
        ),
    ],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Fibres, HDF5. Default: SOURCE's name with .h5.")
    ] = None,
    kind: Annotated[str, typer.Option("--collector", help="plate, belt or drum, for a jet or a run.")] = "plate",
    distance: Annotated[str | None, typer.Option(help="Of the collector. Default: where the beads landed.")] = None,
    speed: Annotated[str | None, typer.Option(help="Of the belt or the drum's surface.")] = None,
    radius: Annotated[str | None, typer.Option(help="Of the drum.")] = None,
    plan: Annotated[bool, typer.Option("--plan", help="Say how much it will be, and stop.")] = False,
    csv: Annotated[Path | None, typer.Option(help="Segments as a table.", callback=table)] = None,
    json: JsonOption = False,
    force: ForceOption = False,
    set_: SetOption = None,
) -> None:
    """Fibres on the collector from a jet's landings, or from a fitted laydown."""
    from spinline.base.files import outputs
    from spinline.scene.file import bundled_scenes, given_file

    file = given_file(source, bundled_scenes())
    source = str(file)
    target = out or Path(file.name if file.suffix == "" else file.stem).with_suffix(".h5")
    from spinline.setup.mat import (
        kept_options,
        laid_file,
        landings_of,
        lay_scene,
        options_of,
        options_text,
        rows_of,
        scene_jet,
    )

    if out is None and target == file and laid_file(source) is None:
        landings_of(source)  # what holds no landings is told so, not that it is in the way of its own fibres
    outputs(target, csv, force=force, result=target, form=("HDF5", ".h5"))

    attributes: dict[str, Any] = {"source": file.name}
    numbers: dict[str, Any] = {}
    run, surface, options = scene_jet(source, set_ or []) if file.suffix == ".toml" else (None, None, None)
    if options is not None:
        attributes["mat"] = options_text(options)
    if file.suffix == ".toml" and run is None:
        from spinline.scene.mat_file import load_mat_scene

        scene = load_mat_scene(source, set_ or [])
        from spinline.plan.odd_settings import odd_laydown

        for odd in odd_laydown(scene):
            warnings.warn(odd, SpinlineWarning, stacklevel=1)
        rows = rows_of(scene)
        if plan:
            say(f"{rows} segments, {rows * _ROW_BYTES / 1e6:.3g} MB, about {max(rows / 1.5e6, 0.1):.2g} s")
            return
        attributes |= {
            "title": scene.title,
            "scene": scene.text,
            "mat": options_text(options_of(scene.mat)),
            "collector_kind": scene.collector.kind,
            "seed": scene.mat.seed,
        }
        if scene.collector.radius is not None:
            attributes["circumference"] = 2 * 3.141592653589793 * scene.collector.radius.value
        blocks = lay_scene(scene)
    else:
        if set_ and run is None:
            raise InputError("--set", "changes keys of a scene, and this is a jet", value=set_[0])
        from spinline.deposit.landing import feed_remark, lay

        if kept := kept_options(run or source):
            attributes.setdefault("mat", kept)
        segments = laid_file(run or source)
        if segments is not None and (distance, speed, radius) != (None, None, None):
            raise InputError(
                "--speed", "is for beads; this jet laid its fibre on a collector of its own", remedy="take it out"
            )
        if segments is None:
            record = landings_of(run or source)
            given = (kind, distance, speed, radius)
            surface = surface or _collector(*_kept_collector(record.attributes, *given), _landed(record))
            segments = lay(record, surface)
            attributes |= {"collector_kind": surface.kind, "collector_distance": surface.distance}
            if surface.kind == "drum":
                attributes["circumference"] = 2 * 3.141592653589793 * surface.radius  # type: ignore[union-attr]
            numbers = {f"imbalance_{key}": value for key, value in record.imbalance().items()}
        if remark := feed_remark(segments, float(getattr(surface, "surface_speed", 0.0))):
            warnings.warn(remark, SpinlineWarning, stacklevel=1)
        if plan:
            say(f"{len(segments)} segments")
            return
        blocks = iter([segments])
    numbers |= _write(target, blocks, attributes, csv, force=force)
    if json:
        import json as js

        say(js.dumps(numbers, indent=1))
        return
    polymer = numbers["polymer_volume"] * 1e9
    say(f"{numbers['segments']} segments, {numbers['length']:.4g} m of fibre, polymer {polymer:.4g} mm3")
    say(f"wrote {target}")


def mat(
    fibres: Annotated[Path, typer.Argument(metavar="FIBRES", help="What `spinline deposit` wrote.")],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Result, netCDF. Default: FIBRES' name with .nc.")
    ] = None,
    figure: Annotated[Path | None, typer.Option(help="Figure (.png, .pdf, .svg). Default: beside OUT.")] = None,
    no_figure: Annotated[bool, typer.Option("--no-figure", help="Make no figure.")] = False,
    picture: Annotated[Path | None, typer.Option(help="Top view alone, as a microscope shows it.")] = None,
    report: ReportOption = None,
    measured: Annotated[Path | None, typer.Option(help="Measured diameters, a table, to compare with.")] = None,
    measured_unit: Annotated[
        str | None, typer.Option(help="m, mm, um, nm or px, where the table does not say.")
    ] = None,
    measured_column: Annotated[str | None, typer.Option(help="Its name, where several could be meant.")] = None,
    pixel_size: Annotated[str | None, typer.Option(help="Of the measured image.")] = None,
    export: Annotated[
        list[Path] | None, typer.Option(help="First window for other programs: .vtp, .ply, .csv, .tif, .raw.")
    ] = None,
    slope: Annotated[float | None, typer.Option(help="Steepest slope at which a fibre hangs, 1 (no unit).")] = None,
    window: Annotated[str | None, typer.Option(help="Side of the windows.")] = None,
    envelope: Annotated[str | None, typer.Option(help="mean-top, max-top or percentile.")] = None,
    law: Annotated[list[str] | None, typer.Option(help="Law of permeability; several times for several.")] = None,
    direct: Annotated[bool, typer.Option("--direct", help="Compute the Stokes flow in the first window too.")] = False,
    realisations: Annotated[int | None, typer.Option(help="Windows.")] = None,
    seed: Annotated[int | None, typer.Option(help="Of the windows' places.")] = None,
    plan: Annotated[bool, typer.Option("--plan", help="Say how much it will be, and stop.")] = False,
    csv: Annotated[Path | None, typer.Option(help="Scalars as a table.", callback=table)] = None,
    json: JsonOption = False,
    force: ForceOption = False,
) -> None:
    """Thickness, porosity, pores, orientation, diameters and permeability of a mat."""
    from spinline.base.files import outputs
    from spinline.base.units import parse

    size = _size_of_pixels(measured, measured_unit, measured_column, pixel_size)
    target = out or fibres.with_suffix(".nc")
    sheet = None if no_figure else figure or target.with_suffix(".png")
    raw = [path.with_suffix(".json") for path in export or [] if path.suffix.lower() == ".raw"]  # it says their shape
    from spinline.deposit.fibres import FibreFile

    if out is None and target == fibres:
        FibreFile(fibres).close()  # what is no file of fibres is told so, not that it is in the way of its own result
    outputs(target, sheet, picture, report, csv, *(export or []), *raw, force=force, result=target)
    for path in export or []:
        _check_export(path)
    if sheet is not None or picture is not None:
        from spinline.report.style import check_format

        for path in filter(None, (sheet, picture)):
            check_format(path)
    from spinline.deposit.mat import analyse_mat, first_stack
    from spinline.deposit.whole import Rolled
    from spinline.setup.mat import options_from_text

    side = parse(window, "length", "--window").value if window is not None else None
    with FibreFile(fibres) as opened:
        file = opened
        turn = opened.circumference
        mat_of: Any = Rolled(opened, turn) if turn > 0 else opened
        options = options_from_text(
            str(file.attributes.get("mat", "")),
            {
                "window": side,
                "slope": slope,
                "envelope": envelope,
                "permeability": tuple(law) if law else None,
                "direct": direct or None,
                "realisations": realisations,
                "seed": seed,
            },
        )
        if plan:
            say(f"{file.rows} segments in {-(-file.rows // 262144)} chunks, {options.realisations} windows")
            return
        result = analyse_mat(mat_of, options)
        stack = first_stack(mat_of, options) if export else None
    result.attrs |= {"title": label(str(file.attributes.get("title", "")) or fibres.stem), "source": fibres.name}
    if measured is not None:
        _compare(result, measured, measured_unit, measured_column, size)
    _save(result, target, sheet, picture, report, csv, force=force)
    for path in export or []:
        _export(path, stack, options, force=force)
    _say(result, json, [p for p in (target, sheet, picture, report, csv, *(export or [])) if p is not None])


def _write(target: Path, blocks: Any, attributes: dict[str, Any], csv: Path | None, *, force: bool) -> dict[str, Any]:
    import numpy as np

    from spinline.deposit.fibres import FibreWriter

    rows = []
    with FibreWriter(target, attributes, force=force) as file:
        for block in blocks:
            file.write(block)
            if csv is not None:
                rows.append(block)
        sums = {
            "segments": file.rows,
            "length": file.total("total_length"),
            "volume": file.total("total_volume"),
            "polymer_volume": file.total("total_dry_volume"),
        }
    if csv is not None:
        from spinline.base.files import write_text

        names = ("x", "y", "dx", "dy", "touch_time", "radius", "length", "jet", "fibre")
        lines = ["x (m),y (m),dx (m),dy (m),touch_time (s),radius (m),length (m),jet,fibre"]
        for block in rows:
            table = np.column_stack([getattr(block, name) for name in names])
            lines += [",".join(f"{value:.9g}" for value in row) for row in table]
        write_text(csv, "\n".join(lines) + "\n", force=force)
    return sums


def _landed(record: Any) -> float:
    """Where the beads landed, m.

    Raises
    ------
    InputError
        Where none has.
    """
    if not len(record.position):
        raise InputError(
            "landings", "are none: nothing has reached the collector", remedy="run the jet longer, or nearer to it"
        )
    return float(record.position[:, 0].max())


def _kept_collector(
    kept: dict[str, Any], kind: str, distance: str | None, speed: str | None, radius: str | None
) -> tuple[str, str | None, str | None, str | None]:
    """Collector of the options, or the one that the jet flew to where none are given."""
    if (kind, distance, speed, radius) != ("plate", None, None, None) or "collector_distance" not in kept:
        return kind, distance, speed, radius
    text = [f"{float(kept[key])!r} {unit}" if key in kept else None for key, unit in _KEPT]
    return str(kept["collector_kind"]), text[0], text[1], text[2]


_KEPT = (("collector_distance", "m"), ("collector_speed", "m/s"), ("collector_radius", "m"))


def _collector(
    kind: str, distance: str | None, speed: str | None, radius: str | None, landed: float
) -> "Plate | Belt | Drum":
    from spinline.base.units import parse
    from spinline.deposit.collectors import collector

    return collector(
        kind,
        parse(distance, "length", "--distance").value if distance else landed,
        speed=parse(speed, "velocity", "--speed").value if speed else None,
        radius=parse(radius, "length", "--radius").value if radius else None,
    )


def _size_of_pixels(
    measured: Path | None, unit: str | None, column: str | None, pixel_size: str | None
) -> float | None:
    """In m, where it is given; what says how measured diameters are read is refused without them."""
    from spinline.base.units import parse

    for name, given in (("--measured-unit", unit), ("--measured-column", column), ("--pixel-size", pixel_size)):
        if measured is None and given is not None:
            raise InputError(name, "is for measured diameters", value=given, remedy="give them by --measured TABLE")
    return None if pixel_size is None else parse(pixel_size, "length", "--pixel-size").value


def _compare(
    result: "xr.Dataset", measured: Path, unit: str | None, column: str | None, pixel_size: float | None
) -> None:
    """Measured diameters beside the mat's, into the result."""
    import numpy as np

    from spinline.deposit.diameters import compare_diameters
    from spinline.deposit.measured import read_diameters

    sample = read_diameters(measured, unit=unit, pixel_size=pixel_size, column=column)
    width = (result["diameter_high"] - result["diameter_low"]).values
    weight = result["diameter_density"].values * width
    rng = np.random.default_rng(int(result.attrs["seed"]))
    low, high = result["diameter_low"].values, result["diameter_high"].values
    drawn = rng.choice(weight.size, 4000, p=weight / weight.sum())
    ours = low[drawn] + rng.uniform(size=4000) * (high[drawn] - low[drawn])
    found = compare_diameters(ours, sample.diameter, second_length=sample.weight)
    names = ("mean_ratio", "deviation_ratio", "distance")
    for name in names:
        value = getattr(found, name)
        result[f"measured_{name}"] = ("interval", list(value), {"units": "1", "long_name": "value, low, high (95 %)"})
    result["measured_diameter"] = ("measured", sample.diameter, {"units": "m"})
    result["measured_weight"] = ("measured", sample.weight, {"units": "1"})
    result.attrs["measured"] = sample.source


def _save(
    result: "xr.Dataset",
    target: Path,
    sheet: Path | None,
    picture: Path | None,
    report: Path | None,
    csv: Path | None,
    *,
    force: bool,
) -> None:
    from spinline.base.netcdf import save_dataset

    save_dataset(result, target, force=force)
    if sheet is not None or picture is not None or report is not None:
        from spinline.report.mat_figure import mat_sheet, save_mat_report, top_view_sheet
        from spinline.report.style import save_sheet

        if sheet is not None:
            save_sheet(mat_sheet(result), sheet, force=force)
        if picture is not None:
            save_sheet(top_view_sheet(result), picture, force=force)
        if report is not None:
            save_mat_report(result, report, force=force)
    if csv is not None:
        from spinline.base.files import write_text

        lines = ["name,value,unit"]
        lines += [
            f"{name},{float(v):.9g},{v.attrs.get('units', '')}" for name, v in result.data_vars.items() if not v.dims
        ]
        write_text(csv, "\n".join(lines) + "\n", force=force)


_LINES, _VOXELS = (".vtp", ".ply", ".csv"), (".tif", ".tiff", ".raw")


def _check_export(path: Path) -> None:
    if path.suffix.lower() not in (*_LINES, *_VOXELS):
        raise InputError("--export", "has no known ending", value=path.name, allowed=".vtp, .ply, .csv, .tif, .raw")


def _export(path: Path, stack: Any, options: Any, *, force: bool) -> None:
    from spinline.deposit import exports
    from spinline.deposit.voxels import voxelise

    kind = path.suffix.lower()
    if kind in _LINES:
        lines = dict(zip(_LINES, (exports.write_vtp, exports.write_ply, exports.write_csv), strict=True))
        lines[kind](path, stack, force=force)
        return
    voxels = dict(zip(_VOXELS, (exports.write_tiff, exports.write_tiff, exports.write_raw), strict=True))
    edge = options.voxel or float(stack.passages.radius.mean()) / 3
    voxels[kind](path, voxelise(stack, edge), edge, force=force)


def _say(result: "xr.Dataset", json: bool, files: list[Path]) -> None:
    if json:
        import json as js

        scalars = {str(name): float(value) for name, value in result.data_vars.items() if not value.dims}
        laws = {str(k): float(v) for k, v in zip(result["law"].values, result["permeability"].values, strict=True)}
        say(js.dumps({**scalars, "permeability": laws}, indent=1).replace("NaN", "null"))
        return
    from spinline.report.mat_words import sentences

    say(str(result.attrs["title"]))
    for line in sentences(result):
        say(f"  {line}")
    for path in files:
        say(f"wrote {path}")
