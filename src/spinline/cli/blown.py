"""What the commands jet and spin do with a scene whose jet is blown."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from spinline.base.errors import InputError
from spinline.cli.speech import say

if TYPE_CHECKING:
    import xarray as xr

    from spinline.scene.file import Scene

__all__ = ["show_blown", "spin_blown"]

_PLACES = (0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)  # of the straight part


def show_blown(scene: "Scene", figure: Path | None, csv: Path | None, *, json: bool, force: bool) -> None:
    """The straight part of a blown jet: table, verdict, figure."""
    import numpy as np

    from spinline.base.files import outputs, write_text
    from spinline.setup.blown import blown_jet, gas_of
    from spinline.setup.build import build_solution

    outputs(figure, csv, force=force)
    if figure is not None:
        from spinline.report.figures import check_format

        check_format(figure)
    section: Any = scene.jet
    solution = build_solution(scene)
    gas, notes = gas_of(section, scene)
    made = blown_jet(section, scene, solution)
    x = made.solved
    start = float(x.bending_start)
    if csv is not None:
        import pandas as pd

        columns = {
            "z [m]": x.z,
            "radius [m]": x.radius,
            "velocity [m/s]": x.velocity,
            "air_velocity [m/s]": x.air_velocity,
            "tension [N]": x.tension,
            "axial_stress [Pa]": x.axial_stress,
            "axial_conformation [1]": x.axial_conformation,
            "radial_conformation [1]": x.radial_conformation,
            "wave_speed_squared [m2/s2]": x.wave_speed_squared,
        }
        write_text(csv, str(pd.DataFrame(columns).to_csv(None, index=False)), force=force)
    if figure is not None:
        from spinline.report.blown_figure import save_blown_figure

        save_blown_figure(made, figure, force=force)
    if json:
        import json as js

        told: dict[str, Any] = {
            "model": made.model,
            "verdict": x.verdict,
            "message": x.message,
            "force_balance": x.force_balance,
            "bending_start": None if np.isnan(start) else start,
            "gas_velocity": gas.exit_velocity,
            "gas_core_length": gas.core_length,
            "notes": list(notes),
        }
        told["profile"] = {
            name: getattr(x, name).tolist()
            for name in ("z", "radius", "velocity", "air_velocity", "tension", "axial_stress", "wave_speed_squared")
        }
        say(js.dumps(told))
        return
    for note in notes:
        say(f"warning: {note}", err=True)
    say(made.model)
    say(
        f"gas {gas.exit_velocity:.4g} m/s, core {1e3 * gas.core_length:.3g} mm; "
        f"pull at the nozzle {1e6 * x.tension[0]:.4g} uN, force balance {x.force_balance:.1g}"
    )
    begins = "nowhere on the straight part" if np.isnan(start) else f"at {1e3 * start:.4g} mm"
    say(f"bending may begin {begins} (c_b^2 > 0)")
    say("")
    say(
        f"{'z mm':>9}{'r um':>10}{'v m/s':>10}{'air m/s':>10}{'rate 1/s':>10}{'stress Pa':>12}{'tension uN':>12}{'c_b2':>10}"
    )
    for share in _PLACES:
        z = share * made.end
        row: list[Any] = [
            z * 1e3,
            made.radius(z) * 1e6,
            made.velocity(z),
            gas.velocity(z),
            made.strain_rate(z),
            made.axial_stress(z),
            made.tension(z) * 1e6,
            made.wave_speed_squared(z),
        ]
        say(
            "".join(
                f"{float(value):>{width}.4g}" for value, width in zip(row, (9, 10, 10, 10, 10, 12, 12, 10), strict=True)
            )
        )
    say("")
    say(f"{'  ' if x.verdict == 'converged' else '! '}{x.verdict}{': ' + x.message if x.message else ''}")


def spin_blown(
    scene: "Scene",
    out: Path | None,
    seeds: int,
    frames: int,
    files: dict[str, Path | None],
    *,
    json: bool,
    force: bool,
    resume: bool,
) -> None:
    """Straight part and beads to the collector; one file a seed."""
    import json as js

    from spinline.base.files import outputs
    from spinline.base.netcdf import save_dataset
    from spinline.base.version import __version__
    from spinline.setup.blown import blown_dataset, gas_of
    from spinline.setup.build import build_solution
    from spinline.setup.mat import mat_kept

    for kind in ("vtk", "xyz", "movie"):
        if files[kind] is not None:
            raise InputError(f"--{kind}", "is for spun jets", remedy="--figure, or read the netCDF file")
    if resume:
        raise InputError("--resume", "is for spun jets: a blown one takes seconds", remedy="take it out")
    section: Any = scene.jet
    target = out or Path(f"{scene.name or 'jet'}.nc")
    names = [target] if seeds == 1 else [target.with_stem(f"{target.stem}-{i}") for i in range(seeds)]
    outputs(*names, files["figure"], force=force, result=target)
    solution = build_solution(scene)
    for note in gas_of(section, scene)[1]:
        say(f"warning: {note}", err=True)
    jet: Any = None
    for index, name in enumerate(names):
        about = {"title": scene.title, "spinline": __version__, "scene": scene.text, **mat_kept(scene)}
        jet = blown_dataset(scene, solution, frames=frames, seed=section.seed + index, about=about)
        save_dataset(jet, name, force=force)
        answer = _answer(jet, name)
        say(js.dumps(answer) if json else _words(answer))
    if files["figure"] is not None:
        from spinline.report.blown_figure import blown_run_figure
        from spinline.report.style import save_sheet

        save_sheet(blown_run_figure(jet), files["figure"], force=force)


def _answer(jet: "xr.Dataset", target: Path) -> dict[str, Any]:
    """Numbers of a run, SI."""
    import numpy as np

    from spinline.deposit.landing import LandingRecord
    from spinline.setup.collector import landings_alone

    last = jet.isel(time=-1)
    whole = last["valid_element"].values
    record = LandingRecord.from_dataset(landings_alone(jet))
    laid = record.volume > 0
    answer: dict[str, Any] = {
        "out": str(target),
        "time": float(last["time"]),
        "jets": int(jet.attrs["jets"]),
        "elements": int(whole.sum()),
        "landed": int(laid.sum()),
        "bending_start": float(jet.attrs["bending_start"]),
        "below_zero_wave_speed": float(jet.attrs["below_zero_wave_speed"]),
        "volume_imbalance": record.imbalance().get("volume"),
    }
    if laid.any():
        late = laid & (record.touch_time > record.touch_time.max() / 3)
        radius = np.sqrt(record.volume[late] / (np.pi * record.flight_length[late]))
        answer |= {
            "flight_radius": float(np.median(radius)),
            "flight_radius_5_95": [float(v) for v in np.quantile(radius, [0.05, 0.95])],
            "impact_speed": float(np.median(np.linalg.norm(record.velocity[late], axis=1))),
        }
    return answer


def _words(a: dict[str, Any]) -> str:
    said = f"wrote {a['out']}: {a['jets']} jet{'s' if a['jets'] > 1 else ''}, {1e3 * a['time']:.4g} ms, "
    said += f"{a['elements']} elements in flight, {a['landed']} landed"
    if "flight_radius" in a:
        low, high = (1e6 * v for v in a["flight_radius_5_95"])
        said += (
            f"; lands with a radius of {1e6 * a['flight_radius']:.4g} um ({low:.3g} to {high:.3g}) "
            f"at {a['impact_speed']:.3g} m/s"
        )
    else:
        said += "; nothing has landed yet: give it more time"
    return said + f"; c_b^2 < 0 on {a['below_zero_wave_speed']:.1%} of the elements"
