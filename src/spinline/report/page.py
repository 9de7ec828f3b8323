"""The report of a run: one HTML file that opens offline, the answer first."""

import base64
import math
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.files import write_text
from spinline.base.words import page
from spinline.report.figures import png
from spinline.report.page_parts import planned, traded
from spinline.report.sentences import words
from spinline.solve.results import described, scalars

if TYPE_CHECKING:
    import xarray as xr

    from spinline.base.named_arrays import NamedArrays

__all__ = ["html", "save_report", "words"]

_ROUNDING = 1e-9  # of a number: what is less is no uncertainty
_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; color: #111; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
.answer { font-size: 1.15rem; border-left: 4px solid #0072B2; padding-left: 1rem; }
.warning { border-left: 4px solid #D55E00; padding-left: 1rem; }
table { border-collapse: collapse; } td, th { padding: .15rem .8rem .15rem 0; text-align: left; vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
pre { background: #f4f4f4; padding: 1rem; overflow-x: auto; } img { max-width: 100%; }
"""


def html(result: "xr.Dataset | NamedArrays", picture: bytes | None = None) -> str:
    """HTML text of the report; `picture` is the figure's PNG, where it is drawn already."""
    attrs = result.attrs
    drawn = base64.b64encode(png(result) if picture is None else picture).decode("ascii")
    answer = "".join(f"<p>{escape(sentence)}</p>" for sentence in words(result))
    remarks = str(attrs.get("warnings", "")).splitlines()
    warned = "".join(f"<p class='warning'>{escape(remark)}</p>" for remark in remarks)
    numbers = _numbers(result)
    used = "".join(
        f"<tr><td>{escape(label)}</td><td>{escape(str(attrs[key]))}</td></tr>" for label, key in _MODELS if key in attrs
    )
    inputs = "".join(
        f"<tr><td>{escape(key)}</td><td>{escape(_shown(attrs[key]))}</td></tr>" for key in _INPUTS if key in attrs
    )
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{escape(str(attrs["title"]))}</title>
<style>{_STYLE}</style></head><body>
<h1>{escape(str(attrs["title"]))}</h1>
<div class="answer">{answer}</div>
{warned}
<h2>Pictures</h2>
<img alt="Jet and network radius, strands, stretch and polymer fraction along the jet" src="data:image/png;base64,{drawn}">
<h2>Numbers</h2>
{_of_inputs(result)}
<table>{numbers}</table>
<h2>Models used, and why</h2>
<table>{used}</table>
<p>Valid for the first millimetres of a jet, before entanglements are lost.</p>
{planned(attrs)}
{traded(attrs)}
<h2>Inputs</h2>
<table>{inputs}</table>
<pre>{escape(str(attrs["scene"]))}</pre>
<p>{escape(str(attrs["references"]))}</p>
<p>Made by spinline {escape(str(attrs["spinline_version"]))}; save the scene above and run <code>spinline run</code> on it
to make this again.</p>
</body></html>
"""


def _of_inputs(result: "xr.Dataset | NamedArrays") -> str:
    """What the uncertainties are of."""
    if "uncertain_inputs" not in result.attrs:
        return "<p>No input carries an uncertainty; write one as <code>125 +/- 3 um</code>.</p>"
    bands = f"; intervals: {result.attrs['bands']}" if "bands" in result.attrs else ""
    text = f"Uncertain inputs: {result.attrs['uncertain_inputs']}. ±: standard uncertainty, to first order{bands}."
    return f"<p>{escape(text)} A dash: beyond the end of the jet, or not known.</p>"


def _numbers(result: "xr.Dataset | NamedArrays") -> str:
    """Rows of the table of numbers; with uncertain inputs their standard uncertainty and interval beside them."""
    found = scalars(result)
    uncertain = "uncertain_inputs" in result.attrs
    rows = ""
    if uncertain:
        rows = "<tr><th></th><th></th><th>±</th><th>68 %</th><th>95 %</th><th></th><th></th></tr>"
    for name, value in found.items():
        if uncertain and name.endswith("_std"):
            continue
        rows += f"<tr><td><code>{name}</code></td><td class='number'>{_number(value)}</td>"
        if uncertain:
            std = found.get(f"{name}_std", float("nan"))
            rows += f"<td class='number'>{_number(0.0 if std <= _ROUNDING * abs(value) else std, 2)}</td>"
            ends = result[f"{name}_band"].values if f"{name}_band" in result else np.full(5, np.nan)
            rows += "".join(
                f"<td>{_number(ends[i], 4)} to {_number(ends[j], 4)}</td>" if np.isfinite(ends).any() else "<td></td>"
                for i, j in ((1, 3), (0, 4))
            )
        rows += f"<td>{_unit(name)}</td><td>{escape(described(name)[1])}</td></tr>"
    return rows


def save_report(
    result: "xr.Dataset | NamedArrays", path: str | Path, *, force: bool = False, picture: bytes | None = None
) -> Path:
    """Write the report; `picture` as for `html`.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    return write_text(path, page(html(result, picture)), force=force)


_MODELS = (
    ("model", "model"),
    ("why", "model_reason"),
    ("closure", "closure"),
    ("force law", "force_law"),
    ("solvent quality", "solvent_quality"),
    ("crossover, Eq. (38)", "crossover"),
    ("crossover by extension", "crossover_extension"),
    ("evaporation", "evaporation_reason"),
    ("relaxation", "relaxation_reason"),
    ("radial gradients", "radial_reason"),
    ("evaporative cooling", "heat_reason"),
    ("left out", "effects_left_out"),
    ("air and solvent", "evaporation"),
    ("concentration laws", "concentration_laws"),
    ("constitutive model", "constitutive_model"),
    ("composition", "composition_path"),
    ("structure that stays", "frozen_structure"),
    ("of the skin", "skin_structure"),
    ("of the core", "core_structure"),
    ("skin", "skin_criterion"),
    ("coupling alpha_v", "coupling"),
    ("viscosity in it", "drag_viscosity"),
    ("A of the solvent's drag alone", "affinity_of_solvent_drag"),
)
_INPUTS = (
    "polymer",
    "polymer_density",
    "solvent",
    "solvent_density",
    "solution_density",
    "mass_fraction",
    "temperature",
    "kuhn_length",
    "strands_per_chain",
    "zero_shear_viscosity",
    "relaxation_time_at_rest",
    "jet",
    "initial_radius",
    "initial_velocity",
    "flow_rate",
)


def _number(value: float, digits: int = 6) -> str:
    return "—" if math.isnan(value) else f"{value:.{digits}g}"


def _unit(name: str) -> str:
    unit = described(name)[0]
    return "" if unit == "1" else unit


def _shown(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
