"""The command that answers the first question: this recipe, which fibre?"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from spinline.base.errors import InputError
from spinline.cli.options import ForceOption, JsonOption, SetOption, bundled
from spinline.cli.options import table as named_table
from spinline.cli.progress import progress_of
from spinline.cli.speech import say

if TYPE_CHECKING:
    from spinline.recipe.predict import Fibre

__all__ = ["register"]


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("fibre", short_help="Which fibre a recipe gives, with its interval.")(fibre)


def fibre(
    recipe: Annotated[
        str | None,
        typer.Argument(
            metavar="RECIPE", help="Recipe file, or the name of a bundled one.", autocompletion=bundled("recipes")
        ),
    ] = None,
    table: Annotated[Path | None, typer.Option(help="CSV table of experiments instead, one row each.")] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Table with the predictions, CSV.", callback=named_table)
    ] = None,
    rung: Annotated[
        str, typer.Option(help="race, terminal, envelope, or lagrangian (bead by bead; a minute).")
    ] = "race",
    json: JsonOption = False,
    force: ForceOption = False,
    set_: SetOption = None,
) -> None:
    """Diameter, orientation and regime of the fibre that a recipe gives, with intervals and what they are made of."""
    if (recipe is None) == (table is None):
        raise InputError(
            "RECIPE", "is needed, or --table; not both", remedy="`spinline scenes` lists the bundled recipes"
        )
    if table is not None:
        if set_:
            remedy = "change the table, or give one recipe"
            raise InputError("--set", "changes keys of a recipe, and this is a table", value=set_[0], remedy=remedy)
        _table(table, out, rung, json, force)
        return
    if out is not None:
        raise InputError("--out", "is of --table", value=str(out), remedy="leave it out, or take --json")
    assert recipe is not None
    from spinline.recipe import recipe_file

    sheet = recipe_file.load_recipe(recipe, set_ or [])
    found = recipe_file.fibre(sheet, rung=rung)
    if json:
        import json as json_

        say(json_.dumps(as_json(found), ensure_ascii=False))
        return
    say(sheet.title or sheet.name)
    for line in lines(found):
        say(f"  {line}")


def _table(table: Path, out: Path | None, rung: str, json: bool, force: bool) -> None:
    from spinline.base.files import note_input, writable, write_text
    from spinline.recipe.table import predict_table, read_experiments, written

    note_input(table)
    target = out or table.with_name(f"{table.stem}-fibres.csv")
    writable(target, force=force)
    rows = read_experiments(table)
    with progress_of("experiments") as progress:
        found = predict_table(rows, rung=rung, progress=progress)
    write_text(target, written(found), force=force)
    missed = sum(row["predicted_nm"] == "" for row in found)
    remarked = sum(row["remark"] != "" for row in found)
    if json:
        import json as json_

        say(json_.dumps({"rows": len(found), "not_predicted": missed, "with_remark": remarked, "out": str(target)}))
        return
    say(
        f"{len(found)} experiments"
        + (f", {missed} not predicted (the reason stands in their regime)" if missed else "")
        + (f", {remarked} with something to say (in their remark)" if remarked else "")
    )
    diameters = [name for name in rows[0] if name.startswith("fibre_diameter")]
    if diameters:
        say(f"{diameters[0]} is kept and not used: measured fibres sharpen the answer of a recipe, in its [measured]")
    say(f"wrote {target}")


_BY = {"terminal": "terminal law alone", "race": "race", "envelope": "envelope of loops"}


def as_json(found: "Fibre") -> dict[str, Any]:
    """The answer by its fixed names, SI."""
    from dataclasses import asdict

    plain: dict[str, Any] = {
        key: (dict(value) if hasattr(value, "items") else value) for key, value in asdict(found).items()
    }
    return plain


def lines(found: "Fibre") -> list[str]:
    """The answer in sentences."""
    from spinline.recipe.model import UNKNOWNS
    from spinline.recipe.regime import REGIMES

    def nm(size: float) -> str:
        return f"{1e9 * size:.3g}"

    (low, high), (lower, higher) = found.fibre_diameter_68, found.fibre_diameter_95
    hinges = found.orientation_68[1] > 100 * found.orientation_68[0]
    strands = "hinging on how fast they relax, which no recipe says" if hinges else "an order of magnitude"
    said = [
        f"Fibre diameter {nm(found.fibre_diameter)} nm; 68 %: {nm(low)} to {nm(high)}, 95 %: {nm(lower)} to {nm(higher)} nm.",
        f"Regime: {found.regime} ({REGIMES[found.regime]}), {100 * found.regimes[found.regime]:.0f} %. "
        f"Decided by {found.decides}.",
        f"Strands in the solid fibre: {'mostly relaxed, ' if found.orientation < 0.05 else ''}orientation O = "
        f"{found.orientation:.2g} ({found.orientation_68[0]:.2g} to {found.orientation_68[1]:.2g}), {strands}; "
        "neither drawing by a drum nor crystals are in it.",
    ]
    dry = "dry" if found.landing_fraction > 0.69 else "wet" if found.landing_fraction < 0.4 else "damp"
    said.append(
        f"It lands {dry} ({100 * found.landing_fraction:.0f} % of polymer); one unbroken fibre would be made at "
        f"{found.laying_speed:.3g} m/s."
    )
    if found.envelope_radius is not None:
        said.append(
            f"Loops of {1e3 * found.envelope_radius:.2g} mm, {1e3 * found.flight_time:.3g} ms from the onset of bending; the "
            "cone that the eye sees is of bends upon bends, and wider."
        )
    known = {**UNKNOWNS, "measured": "scatter of the measured fibres"}
    parts = [f"{known[name]} {100 * share:.0f} %" for name, share in found.variance_shares.items() if share > 0.03]
    if parts:
        said.append("The interval is made of: " + ", ".join(parts) + ".")
    nano, thick = [1e9 * value for value in found.current_68], found.viscosity_68
    said.append(
        f"On the way: current {1e9 * found.current:.3g} nA ({nano[0]:.3g} to {nano[1]:.3g}), viscosity {found.viscosity:.2g} "
        f"Pa s ({thick[0]:.2g} to {thick[1]:.2g}, 68 %); by "
        + ", ".join(f"the {_BY[name]} {nm(size)} nm" for name, size in found.trade.items())
        + "."
    )
    said += [f"Not given, so taken: {key}: {words}." for key, words in found.borrowed.items()]
    said += [f"Warning: {remark}." for remark in found.remarks]
    if found.variance_shares and "measured" not in found.variance_shares:
        said.append("One measured fibre of this rig ([measured] fibre_diameter) narrows all of it.")
    return said
