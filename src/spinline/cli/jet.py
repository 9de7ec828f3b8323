"""``spinline jet``: the jet of a scene with its numbers and verdicts, before any network."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from spinline.cli.options import ForceOption, JsonOption, SceneArgument, SetOption, load, table
from spinline.cli.speech import say

if TYPE_CHECKING:
    from spinline.base.checks import FloatArray
    from spinline.jetprofile.ehd import StraightEhdJet

__all__ = ["register"]

_PLACES = (0.0, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)  # of the jet's end


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("jet")(jet)


def jet(
    scene: SceneArgument,
    figure: Annotated[Path | None, typer.Option(help="Figure (.png, .pdf, .svg).")] = None,
    csv: Annotated[Path | None, typer.Option(help="The jet as a table.", callback=table)] = None,
    json: JsonOption = False,
    force: ForceOption = False,
    set_: SetOption = None,
) -> None:
    """The straight jet of a needle's settings, or of a gas nozzle's: radius, tension, and whether there is one."""
    from spinline.base.errors import InputError
    from spinline.base.files import outputs
    from spinline.scene.needle import NeedleJet
    from spinline.setup.build import build_solution
    from spinline.setup.needle import needle_jet

    loaded = load(scene, None, None, set_)
    if loaded.jet.profile == "blown":
        from spinline.cli.blown import show_blown

        show_blown(loaded, figure, csv, json=json, force=force)
        return
    if not isinstance(loaded.jet, NeedleJet):
        raise InputError(
            "jet.profile",
            "is not computed from a needle's settings",
            value=loaded.jet.profile,
            allowed='"needle", "blown"',
            remedy="`spinline run` shows any jet; `spinline scenes` lists those of a needle and of a gas nozzle",
        )
    outputs(figure, csv, force=force)
    if figure is not None:
        from spinline.report.figures import check_format

        check_format(figure)
    made = needle_jet(loaded.jet, loaded, build_solution(loaded))
    if csv is not None:
        _table(made, csv, force=force)
    if figure is not None:
        from spinline.report.needle_figure import save_needle_figure

        save_needle_figure(made, figure, force=force)
    if json:
        say(_json(made))
        return
    _print(made)


def _print(made: "StraightEhdJet") -> None:
    import numpy as np

    onset = made.bending
    say(made.model)
    say(f"current {made.current * 1e9:.4g} nA, pull at the needle {float(made.tension(0.0)) * 1e6:.4g} uN")
    bends = (
        "not within the gap"
        if np.isnan(onset.position)
        else (f"at {onset.position * 1e3:.3g} mm ({onset.earliest * 1e3:.3g} to {onset.latest * 1e3:.3g} mm)")
    )
    say(f"bending sets in {bends}; straight jet shown to {made.end * 1e3:.4g} mm")
    say("")
    say(f"{'z mm':>9}{'r um':>10}{'v m/s':>10}{'rate 1/s':>10}{'N1 Pa':>11}{'tension uN':>12}{'conducted':>11}")
    for share in _PLACES:
        z = share * made.end
        columns: list[Any] = [
            z * 1e3,
            made.radius(z) * 1e6,
            made.velocity(z),
            made.strain_rate(z),
            made.tensile_stress(z),
            made.tension(z) * 1e6,
            made.conduction_share(z),
        ]
        widths = (9, 10, 10, 10, 11, 12, 11)
        say("".join(f"{float(value):>{width}.4g}" for value, width in zip(columns, widths, strict=True)))
    say("")
    for verdict in made.verdicts:
        say(f"{'  ' if verdict.good else '! '}{verdict}")
    for remark in made.remarks():
        if "verdict" not in remark and not any(str(one) in remark for one in made.verdicts):
            say(f"warning: {remark}", err=True)


def _columns(made: "StraightEhdJet") -> "dict[str, FloatArray]":
    import numpy as np

    z = made.initial_radius / 4 * np.expm1(np.linspace(0.0, np.log1p(4 * made.end / made.initial_radius), 401))
    z[-1] = made.end
    own = {"z": z, "radius": made.radius(z), "velocity": made.velocity(z), "strain_rate": made.strain_rate(z)}
    return own | made.fields(z) | {"field_inside": made.field_inside(z)}


def _table(made: "StraightEhdJet", path: Path, *, force: bool) -> None:
    import pandas as pd

    from spinline.base.files import write_text

    units = {
        "z": "m",
        "radius": "m",
        "velocity": "m/s",
        "strain_rate": "1/s",
        "tension": "N",
        "tensile_stress": "Pa",
        "line_charge": "C/m",
        "conduction_share": "1",
        "field_inside": "V/m",
    }
    columns = _columns(made)
    table = pd.DataFrame({f"{name} [{units[name]}]": values for name, values in columns.items()})
    write_text(path, str(table.to_csv(None, index=False)), force=force)


def _json(made: "StraightEhdJet") -> str:
    import json

    import numpy as np

    def clean(value: object) -> object:
        if isinstance(value, np.ndarray):
            return [clean(float(one)) for one in value]
        return None if isinstance(value, float) and not np.isfinite(value) else value

    told = {name: clean(value) for name, value in made.numbers().items()}
    told |= {"model": made.model, "end": made.end, "residual": made.residual}
    told["verdicts"] = [
        {"name": one.name, "value": clean(one.value), "limit": clean(one.limit), "good": one.good, "text": one.text}
        for one in made.verdicts
    ]
    told["profile"] = {name: clean(values) for name, values in _columns(made).items()}
    return json.dumps(told)
