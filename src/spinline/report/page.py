"""The report of a run: one HTML file that opens offline, the answer first."""

import base64
import math
from html import escape
from pathlib import Path

import numpy as np
import xarray as xr

from spinline.base.files import write_text
from spinline.network_models.registry import RUNGS
from spinline.report.figures import headline, png
from spinline.report.page_parts import planned, traded
from spinline.solve.results import described, scalars

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


def words(result: xr.Dataset) -> list[str]:
    """The answer in sentences: crossover, and the network there and at the end of the jet.

    Parameters
    ----------
    result : xarray.Dataset
        From `spinline.run`; of several times, the last is described.

    Returns
    -------
    list of str
    """
    if "time" in result.dims:
        last = result.isel(time=-1)
        return [f"Times: {result.sizes['time']}; this is the last, {float(last['time']):.6g} s.", *words(last)]
    line = headline(result)
    sentences = [f"The network is {line}." if line.startswith("fully") else f"{line[0].upper()}{line[1:]}."]
    extension, position = result.attrs["crossover_extension_criterion"], float(result["crossover_extension_position"])
    if np.isfinite(position):
        radius = 1e6 * float(result["crossover_extension_radius"])
        sentences.append(
            f"Its strands pass {float(extension):g} of their contour at {1e3 * position:.3g} mm, radius {radius:.3g} µm"
            f"{_difference(result)}."
        )
    along = "arc_length" if "element" in result.dims else "z"
    place = result[along].values
    known = np.isfinite(result["stretch_ratio"].values)
    if np.isfinite(float(result["crossover_position"])):
        here = int(np.nanargmin(np.where(known, np.abs(place - float(result["crossover_position"])), np.nan)))
        sentences.append(f"At the crossover {_state(result, here)}.")
    end = int(np.flatnonzero(known)[-1])
    sentences += _dried(result, end)
    where = "At the free end" if _slips(result.attrs["model"]) else "At the end"
    sentences.append(f"{where}, {1e3 * place[end]:.3g} mm, {_state(result, end)}.")
    sentences += _frozen(result)
    sentences += _fibre(result)
    sentences += _uncertain(result)
    return sentences


def _slips(model: str) -> bool:
    """Whether a result's network ends at a free end of its own."""
    rung = RUNGS.get(model)
    return rung is not None and rung.slips


def _uncertain(result: xr.Dataset) -> list[str]:
    """What the uncertain inputs leave of the answer."""
    if "uncertain_inputs" not in result.attrs:
        return []
    parts = []
    for name, scale, unit in (
        ("crossover_position", 1e3, "mm"), ("crossover_radius", 1e6, "µm"), ("frozen_position", 1e3, "mm"),
        ("frozen_orientation", 1, ""), ("end_orientation", 1, ""), ("fibre_radius", 1e6, "µm"),
        ("fibre_diameter", 1e9, "nm"),
    ):  # fmt: skip
        if f"{name}_std" not in result:
            continue
        value, std = scale * float(result[name]), scale * float(result[f"{name}_std"])
        if np.isfinite(value) and std <= _ROUNDING * value:
            parts.append(f"{name.replace('_', ' ')} does not depend on them")
        elif np.isfinite(value) and np.isfinite(std):
            text = f"{name.replace('_', ' ')} {value:.4g} ± {std:.2g}{' ' + unit if unit else ''}"
            parts.append(text + _interval(result, name, scale, unit))
    inputs = result.attrs["uncertain_inputs"]
    return [f"With {inputs}: {'; '.join(parts)}." if parts else f"With {inputs} nothing can be said of the errors."]


def _interval(result: xr.Dataset, name: str, scale: float, unit: str) -> str:
    """The 95 % interval of the draws in words; an end that is NaN lies beyond the jet."""
    if f"{name}_band" not in result:
        return ""
    low, high = scale * result[f"{name}_band"].values[[0, -1]]
    if np.isnan(low) and np.isnan(high):
        return ""
    if np.isnan(low) or np.isnan(high):
        side, end = ("below", high) if np.isnan(low) else ("above", low)
        return f" (95 %: {side} {end:.4g}{' ' + unit if unit else ''})"
    return f" (95 %: {low:.4g} to {high:.4g})"


def html(result: xr.Dataset) -> str:
    """HTML text of the report."""
    attrs = result.attrs
    picture = base64.b64encode(png(result)).decode("ascii")
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
<img alt="Jet and network radius, strands, stretch and polymer fraction along the jet" src="data:image/png;base64,{picture}">
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


def _of_inputs(result: xr.Dataset) -> str:
    """What the uncertainties are of."""
    if "uncertain_inputs" not in result.attrs:
        return "<p>No input carries an uncertainty; write one as <code>125 +/- 3 um</code>.</p>"
    bands = f"; intervals: {result.attrs['bands']}" if "bands" in result.attrs else ""
    text = f"Uncertain inputs: {result.attrs['uncertain_inputs']}. ±: standard uncertainty, to first order{bands}."
    return f"<p>{escape(text)} A dash: beyond the end of the jet, or not known.</p>"


def _numbers(result: xr.Dataset) -> str:
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


def save_report(result: xr.Dataset, path: str | Path, *, force: bool = False) -> Path:
    """Write the report.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    return write_text(path, html(result), force=force)


def _dried(result: xr.Dataset, end: int) -> list[str]:
    """What has evaporated, what relaxed and the skin, at the end of the jet."""
    sentences = []
    if "evaporated_fraction" in result:
        lost = 100 * float(result["evaporated_fraction"].values[end])
        mean = float(result["mean_polymer_fraction"].values[end])
        change = (
            f"loses {lost:.3g} % of its volume" if lost >= 0 else f"takes up {-lost:.3g} % of its volume from the air"
        )
        sentences.append(f"The jet {change}; its mean polymer fraction ends at {mean:.3g}.")
    if "temperature" in result:
        kelvin = result["temperature"].values
        sentences.append(
            f"It cools to {np.nanmin(kelvin) - 273.15:.3g} degC on the way and ends at {float(kelvin[end]) - 273.15:.3g} degC."
        )
    if "deborah_number" in result:
        w, affine = (float(result[name].values[end]) for name in ("network_velocity_ratio", "stretch_ratio"))
        sentences.append(
            f"The strands relax while they are stretched: {w:.3g} times at the end, where the solution is stretched "
            f"{affine:.3g} times."
        )
    if "skin_thickness" in result:
        surface, axis = (float(result[f"{name}_polymer_fraction"].values[end]) for name in ("surface", "axis"))
        skin = 1e6 * float(result["skin_thickness"].values[end])
        thick = f"the skin is {skin:.3g} µm thick" if skin > 0 else "there is no skin"
        sentences.append(
            f"Drying leaves a fraction of {surface:.3g} at the surface against {axis:.3g} on the axis; {thick}."
        )
    return sentences


def _frozen(result: xr.Dataset) -> list[str]:
    """The structure that stays."""
    if "frozen_position" not in result:
        return []
    sentences = []
    for name, what in (("skin", "The surface"), ("frozen", "The jet, on average,"), ("core", "The axis")):
        if f"{name}_position" not in result or not np.isfinite(float(result[f"{name}_position"])):
            continue
        at = {
            key: float(result[f"{name}_{key}"]) for key in ("position", "radius", "orientation", "stretch", "relaxed")
        }
        solid = "becomes solid" if "crystals" in str(result.attrs.get(f"{name}_structure", "")) else "turns to glass"
        text = f"{what} {solid} at {1e3 * at['position']:.3g} mm, radius {1e6 * at['radius']:.3g} µm"
        if name == "frozen":
            text += (
                f": what stays is O = {at['orientation']:.3g} and a stretch of {at['stretch']:.3g}; "
                f"{100 * at['relaxed']:.3g} % of the affine stretch relaxed on the way"
            )
        else:
            text += f", with O = {at['orientation']:.3g}"
        sentences.append(text + ".")
    if not sentences:
        sentences.append(f"No structure is frozen in: {result.attrs['frozen_structure']}.")
    return sentences


def _fibre(result: xr.Dataset) -> list[str]:
    """The dry fibre, with the interval of its diameter where the inputs have one."""
    if "fibre_diameter" not in result or not np.isfinite(float(result["fibre_diameter"])):
        return []
    diameter = 1e9 * float(result["fibre_diameter"])
    spread = f" ± {1e9 * float(result['fibre_diameter_std']):.2g}" if "fibre_diameter_std" in result else ""
    spread += _interval(result, "fibre_diameter", 1e9, "nm")
    held = "arrest_position" in result and np.isfinite(float(result["arrest_position"]))
    until = "what became solid" if held else "the last section, were it stretched no more"
    return [f"The dry fibre is {diameter:.4g}{spread} nm in diameter: {until}."]


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
    "polymer", "polymer_density", "solvent", "solvent_density", "solution_density", "mass_fraction", "temperature",
    "kuhn_length", "strands_per_chain",
    "zero_shear_viscosity", "relaxation_time_at_rest", "jet", "initial_radius", "initial_velocity", "flow_rate",
)  # fmt: skip


def _state(result: xr.Dataset, index: int) -> str:
    def at(name: str) -> float:
        return float(result[name].values[index])

    fraction = f"has a polymer volume fraction of {at('core_polymer_fraction'):.3g}"
    core = "is compact polymer" if bool(result["compacted"].values[index]) else fraction
    return (
        f"the strands are at {at('relative_extension'):.3g} of their contour, oriented O = {at('orientation'):.3g}, "
        f"contracted to {at('radial_contraction'):.3g}; the network's radius is {1e6 * at('network_radius'):.3g} µm in a "
        f"jet of {1e6 * at('radius'):.3g} µm, and its core {core} "
        f"(solution: {float(result['volume_fraction']):.3g})"
    )


def _difference(result: xr.Dataset) -> str:
    gap = float(result["crossover_extension_position"]) - float(result["crossover_position"])
    if np.isnan(gap):
        return ""
    return f", {1e3 * abs(gap):.3g} mm {'after' if gap > 0 else 'before'} full stretch by Eq. (38)"


def _number(value: float, digits: int = 6) -> str:
    return "—" if math.isnan(value) else f"{value:.{digits}g}"


def _unit(name: str) -> str:
    unit = described(name)[0]
    return "" if unit == "1" else unit


def _shown(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
