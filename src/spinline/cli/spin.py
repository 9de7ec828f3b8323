"""The command that spins a jet: bead by bead, from the nozzle to the collector."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.words import label
from spinline.cli.options import ForceOption, JsonOption, SetOption, load
from spinline.cli.progress import progress_of
from spinline.cli.speech import say

if TYPE_CHECKING:
    import xarray as xr

    from spinline.base.checkpoint import Checkpoint
    from spinline.base.checks import FloatArray
    from spinline.jetprofile.spun.run import SpunRun
    from spinline.jetprofile.spun.settings import SpunSettings
    from spinline.jetprofile.spun.several import SpunJets
    from spinline.scene.file import Scene

__all__ = ["register", "spin"]

Text = str | None
MOST = 1e6
"""Elements that may enter in a run: each ends a step."""


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command()(spin)


def spin(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SCENE", help='Scene with profile = "spun" or "blown", its bundled name, or a JETSPIN input.dat.'
        ),
    ],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Jet file, netCDF. Default: SCENE's name with .nc.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on where an interrupted run stopped.")] = False,
    seeds: Annotated[int, typer.Option(help="Runs with successive seeds; one file each.")] = 1,
    quick: Annotated[
        bool, typer.Option("--quick", help="Elements twice as long, tolerance ten times as wide.")
    ] = False,
    time: Annotated[Text, typer.Option(help='Until when, "20 ms".')] = None,
    frames: Annotated[int, typer.Option(help="Moments that are stored.")] = 40,
    flow_rate: Annotated[Text, typer.Option(help='For input.dat: the flow rate, "49.5 mL/hour".')] = None,
    law: Annotated[Text, typer.Option(help="For input.dat: ucm (the default) or linear-maxwell.")] = None,
    figure: Annotated[Path | None, typer.Option(help="Figure of the last moment.")] = None,
    movie: Annotated[Path | None, typer.Option(help="Animation, .gif or .mp4.")] = None,
    vtk: Annotated[Path | None, typer.Option(help="Last moment for ParaView, .vtk.")] = None,
    xyz: Annotated[Path | None, typer.Option(help="All moments for VMD or OVITO, .xyz.")] = None,
    set_: SetOption = None,
    json: JsonOption = False,
    force: ForceOption = False,
) -> None:
    """Spin a jet with its flow rate given, and write what flies and what has landed."""
    from spinline.base.checkpoint import claimed
    from spinline.base.files import outputs
    from spinline.scene.blown import BlownJetSection
    from spinline.setup.mat import mat_kept

    _check_counts(seeds, frames)
    scene = None if _is_input(source) else load(source, None, None, set_)
    if scene is not None and isinstance(scene.jet, BlownJetSection):
        from spinline.cli.blown import spin_blown

        files = {"figure": figure, "movie": movie, "vtk": vtk, "xyz": xyz}
        _of_spun_jets(flow_rate, law, quick)
        blown = scene if time is None else load(source, None, None, [*(set_ or []), f"jet.time={time}"])
        spin_blown(blown, out, seeds, frames, files, json=json, force=force, resume=resume)
        return
    stem = Path(source).parent.name if Path(source).name == "input.dat" else Path(source).stem
    target = out or Path(f"{stem or 'jet'}.nc")
    nozzles = _nozzles(scene, flow_rate, law)
    if len(nozzles) > 1 and seeds > 1:
        raise InputError("--seeds", "is for one jet", value=seeds, remedy="run several jets once for each jet.seed")
    count = max(seeds, len(nozzles))
    names = [target] if count == 1 else [target.with_stem(f"{target.stem}-{i}") for i in range(count)]
    alone = len(nozzles) < 2  # results that are there have to show that they are of this very run
    done = [alone and resume and not force and name.exists() for name in names]
    fresh = [name for name, there in zip(names, done, strict=True) if not there]
    outputs(*fresh, figure, movie, vtk, xyz, force=force, result=target)
    _check_pictures(figure, movie)
    first = next((name for name, there in zip(names, done, strict=True) if not there), names[0]) if alone else target
    with claimed(_kept_in(first)):  # at once: a straight jet may be solved before the first step
        settings, end, notes, title = _settings(source, scene, flow_rate, law, quick, time)
        for note in notes:
            say(note, err=True)
        together = [] if alone else _together(settings, nozzles, end, frames, target, resume, title, notes)
        for index, name in enumerate(names):
            if done[index]:
                jet = _finished(settings, settings.seed + index, end, frames, name)
            else:
                seed = settings.seed + index
                jet = together[index] if together else _one(settings, seed, end, frames, name, resume, title, notes)
                jet.attrs |= {} if scene is None else mat_kept(scene)
                _store(jet, name, force)
            _tell(jet, name, json)
    _extras(jet, figure, movie, vtk, xyz, force)


def _check_counts(seeds: int, frames: int) -> None:
    for name, count, most in (("--seeds", seeds, 10_000), ("--frames", frames, 1_000_000)):
        if not 1 <= count <= most:
            raise InputError(name, "is out of range", value=count, allowed=f"1 to {most:,}")


def _check_pictures(figure: Path | None, movie: Path | None) -> None:
    if figure is not None:
        from spinline.report.style import check_format

        check_format(figure)
    if movie is not None:
        from spinline.report.spun_figure import check_animation

        check_animation(movie)


def _is_input(source: str) -> bool:
    """Whether it is JETSPIN's input, and no scene."""
    return Path(source).name == "input.dat" or Path(source).suffix == ".dat"


def _nozzles(scene: "Scene | None", flow_rate: Text, law: Text) -> "FloatArray":
    """Places of the nozzles (jet, 2), m.

    Raises
    ------
    InputError
        For a scene of another jet.
    """
    import numpy as np

    from spinline.scene.spun import SpunJet

    if scene is None:
        return np.zeros((1, 2))
    from spinline.setup.spun import spun_nozzles

    if flow_rate is not None:
        raise InputError("--flow-rate", "is for a JETSPIN input.dat", remedy="--set jet.flow_rate=...")
    if law is not None:
        raise InputError("--law", "is for a JETSPIN input.dat", value=law, remedy="--set jet.law=...")
    if not isinstance(scene.jet, SpunJet):
        remedy = "`spinline run` takes any scene; `spinline scenes --copy peo5-spun` gives one to spin"
        raise InputError(
            "jet.profile", "is not a jet to spin", value=scene.jet.profile, allowed='"spun", "blown"', remedy=remedy
        )
    from spinline.plan.odd_settings import odd_spinning

    for odd in odd_spinning(scene, scene.jet):
        warnings.warn(odd, SpinlineWarning, stacklevel=1)
    return spun_nozzles(scene.jet)


def _of_spun_jets(flow_rate: Text, law: Text, quick: bool) -> None:
    """Refuse what a blown jet does not take."""
    if law is not None:
        raise InputError("--law", "is for a JETSPIN input.dat", value=law, remedy="--set jet.law=...")
    if flow_rate is not None:
        raise InputError("--flow-rate", "is for a JETSPIN input.dat", remedy="--set jet.flow_rate=...")
    if quick:
        raise InputError("--quick", "is for spun jets", remedy='--set "jet.element_length=..." takes longer elements')


def _settings(
    source: str, scene: "Scene | None", flow_rate: Text, law: Text, quick: bool, time: Text
) -> tuple["SpunSettings", float, tuple[str, ...], str]:
    """Settings, the end in s, what is to be said, a title."""
    from dataclasses import replace

    from spinline.base.units import parse

    until = None if time is None else parse(time, "time", "--time").value
    notes: tuple[str, ...] = ()
    if scene is None:
        from spinline.base.files import readable
        from spinline.jetprofile.spun.jetspin_input import translate

        given = None if flow_rate is None else parse(flow_rate, "flow rate", "--flow-rate").value
        text = readable(source).read_text(encoding="utf-8", errors="replace")
        found = translate(text, flow_rate=given, law=law or "ucm")
        settings, end, title = (
            found.settings,
            found.time,
            f"JETSPIN set-up of {label(Path(source).parent.resolve().name)}",
        )
        notes = tuple(f"differs: {words}" for words in found.differs)
        if found.ignored:
            notes += (f"not needed: {', '.join(found.ignored)}",)
    else:
        from spinline.setup.build import build_solution
        from spinline.setup.spun import spun_settings

        section: Any = scene.jet
        settings = spun_settings(section, build_solution(scene), scene=scene)
        end, title = section.time.value, scene.title
    end = end if until is None else until
    if not end > 0:
        raise InputError("--time", "must be more than 0", value=end)
    length, inlet = settings.grid.element_length, settings.inlet
    if inlet.speed * end > MOST * length:
        raise InputError(
            "element_length",
            f"is too short: {inlet.speed * end / length:.3g} elements would enter until {end:.3g} s",
            value=length,
            allowed=f">= {inlet.speed * end / MOST:.3g} m, or a shorter time",
        )
    if quick:
        grid = settings.grid
        wider = min(10 * grid.tolerance, 1e-2)
        settings = replace(settings, grid=replace(grid, element_length=2 * grid.element_length, tolerance=wider))
        notes += ("quick: elements twice as long; compare with the full run before you trust a number",)
    return settings, end, notes, title


def _one(
    settings: "SpunSettings",
    seed: int,
    end: float,
    frames: int,
    target: Path,
    resume: bool,
    title: str,
    notes: tuple[str, ...],
) -> "xr.Dataset":
    """One run, kept beside its result while it is under way."""
    from dataclasses import replace

    from spinline.jetprofile.spun.dataset import to_dataset
    from spinline.jetprofile.spun.run import SpunRun, moments

    own = replace(settings, seed=seed)
    times = moments(end, frames)
    kept = _checkpoint(target, f"{own!r} {times.tolist()}", resume)
    held = kept.load("run")
    run = SpunRun.start(own) if held is None else SpunRun.unpack(own, held)
    _follow(run, times, kept)
    return to_dataset(run, attributes=_about(own, title, notes))


def _together(
    settings: "SpunSettings",
    nozzles: "FloatArray",
    end: float,
    frames: int,
    target: Path,
    resume: bool,
    title: str,
    notes: tuple[str, ...],
) -> list["xr.Dataset"]:
    """Jets that repel one another: one result each."""
    from spinline.jetprofile.spun.dataset import to_dataset
    from spinline.jetprofile.spun.run import moments
    from spinline.jetprofile.spun.several import SpunJets, shifted

    times = moments(end, frames)
    kept = _checkpoint(target, f"{settings!r} {nozzles.tolist()} {times.tolist()}", resume)
    held = kept.load("run")
    jets = SpunJets.start(settings, nozzles) if held is None else SpunJets.unpack(settings, nozzles, held)
    _follow(jets, times, kept)
    about = _about(settings, title, notes) | {"jets": len(nozzles)}
    return [
        shifted(to_dataset(run, attributes=about), place, index)
        for index, (run, place) in enumerate(zip(jets.runs, nozzles, strict=True))
    ]


def _kept_in(target: Path) -> Path:
    """Where a run is kept while it is under way, beside its result."""
    return target.with_name(f".{target.name}.spin")


def _checkpoint(target: Path, what: str, resume: bool) -> "Checkpoint":
    from spinline.base.checkpoint import Checkpoint, fingerprint
    from spinline.base.version import __version__

    return Checkpoint(_kept_in(target), fingerprint(f"{what} {__version__}", []), afresh=not resume)


def _follow(run: "SpunRun | SpunJets", times: "FloatArray", kept: "Checkpoint") -> None:
    """March through the moments, kept on the way."""
    frames, reached = len(times), 0
    with progress_of("moments") as progress:
        try:
            for index in run.to(times):
                reached = index + 1
                progress(reached, frames)
                if reached % max(frames // 20, 1) == 0 or reached == frames:
                    kept.save("run", **run.pack())
        except (KeyboardInterrupt, SystemExit) as ended:  # Ctrl-C, or a request to end (SIGTERM)
            chain = (run.runs[0] if hasattr(run, "runs") else run).chain
            at = f"stopped at {1e3 * chain.time:.4g} ms of {1e3 * times[-1]:.4g} ms"
            say(f"{at}; the same command with --resume goes on from the last moment kept", err=True)
            raise typer.Exit(130 if isinstance(ended, KeyboardInterrupt) else int(ended.code or 0)) from None
    kept.clear()


def _about(settings: "SpunSettings", title: str, notes: tuple[str, ...]) -> dict[str, Any]:
    """Attributes of a result."""
    from spinline.base.version import __version__

    about = {"title": title, "model": _model(settings), "spinline": __version__, "settings": repr(settings)}
    return about | ({"notes": "\n".join(notes)} if notes else {})


def _finished(settings: "SpunSettings", seed: int, end: float, frames: int, target: Path) -> "xr.Dataset":
    """The run that is there, where it is the one that was asked for.

    Raises
    ------
    InputError
        Where it is any other file.
    """
    from dataclasses import replace

    from spinline.base.netcdf import open_dataset
    from spinline.base.version import __version__

    jet = open_dataset(target)
    same = (jet.attrs.get("settings"), jet.attrs.get("spinline")) == (repr(replace(settings, seed=seed)), __version__)
    whole = jet.sizes.get("time") == frames and abs(float(jet["time"][-1]) - end) <= 1e-9 * end
    if not (same and whole):
        raise InputError(
            str(target),
            "exists, and is not the run that is to go on",
            remedy="choose another name, or --force to overwrite",
        )
    return jet


def _model(s: "SpunSettings") -> str:
    charge = "charge conducts" if s.conductivity else "charge frozen" if s.inlet.charge_density else "no charge"
    return f"Lagrangian chain, {s.law.name}, {s.grid.repulsion} repulsion, {charge}, bending {s.grid.bending}"


def _store(jet: "xr.Dataset", target: Path, force: bool) -> None:
    from spinline.base.netcdf import save_dataset

    save_dataset(jet, target, force=force)


def _answer(jet: "xr.Dataset", target: Path) -> dict[str, Any]:
    """Numbers of a run, SI."""
    import numpy as np

    last = jet.isel(time=-1)
    whole = last["valid_element"].values
    answer: dict[str, Any] = {
        "out": str(target),
        "time": float(last["time"]),
        "elements": int(whole.sum()),
        "landed": int(jet.sizes["deposit"]),
        "reach": float(np.nanmax(last["x"].values)),
        "smallest_radius": float(np.nanmin(np.where(whole, last["radius"].values, np.nan))) if whole.any() else None,
    }
    if "current" in jet.attrs:
        answer["current"] = float(jet.attrs["current"])
    if jet.sizes["deposit"]:
        y, z = (jet[f"deposit_{a}1"].values - jet.attrs.get(f"nozzle_{a}", 0.0) for a in "yz")
        r = np.hypot(y, z)  # of the nodes: a chord's middle lies inside
        late = jet["deposit_time"].values > 0.5 * (jet["deposit_time"].values[0] + jet["deposit_time"].values[-1])
        answer |= {
            "landing_radius": float(np.mean(r[late])) if late.any() else float(r.mean()),
            "cone_angle": float(2 * np.arctan(np.mean(r[late]) / jet.attrs["collector_distance"]))
            if late.any()
            else None,
            "deposit_radius": float(np.mean(jet["deposit_radius"].values[late])) if late.any() else None,
        }
    return answer


def _tell(jet: "xr.Dataset", target: Path, json: bool) -> None:
    import json as js

    answer = _answer(jet, target)
    say(js.dumps(answer) if json else _words(answer))


def _words(a: dict[str, Any]) -> str:
    said = f"wrote {a['out']}: {1e3 * a['time']:.4g} ms, {a['elements']} elements in flight, {a['landed']} landed"
    if a.get("smallest_radius"):
        said += f", thinnest {1e6 * a['smallest_radius']:.4g} um at up to {100 * a['reach']:.4g} cm"
    if a.get("landing_radius") is not None:
        said += f"; lands {100 * a['landing_radius']:.4g} cm off the axis"
        if a.get("deposit_radius"):
            said += f", radius {1e6 * a['deposit_radius']:.4g} um, 2 atan(R/h) = {57.29578 * a['cone_angle']:.4g} deg"
    return said


def _extras(
    jet: "xr.Dataset", figure: Path | None, movie: Path | None, vtk: Path | None, xyz: Path | None, force: bool
) -> None:
    from spinline.base.files import write_text

    if figure is not None:
        from spinline.report.spun_figure import spun_figure
        from spinline.report.style import save_sheet

        save_sheet(spun_figure(jet), figure, force=force)
    if movie is not None:
        from spinline.report.spun_figure import write_animation

        write_animation(jet, movie, force=force)
    if vtk is not None:
        from spinline.jetprofile.spun.exports import vtk_text

        write_text(vtk, vtk_text(jet), force=force)
    if xyz is not None:
        from spinline.jetprofile.spun.exports import xyz_text

        write_text(xyz, xyz_text(jet), force=force)
