"""The answer of a run in sentences; nothing here draws."""

from typing import TYPE_CHECKING

import numpy as np

from spinline.network_models.registry import RUNGS
from spinline.rheology.solution import LEAST_STRANDS

if TYPE_CHECKING:
    import xarray as xr

    from spinline.base.named_arrays import NamedArrays

__all__ = ["headline", "words"]

_ROUNDING = 1e-9  # of a number: what is less is no uncertainty


def headline(result: "xr.Dataset | NamedArrays") -> str:
    """The crossover in a line."""
    position, radius = float(result["crossover_position"]), float(result["crossover_radius"])
    if np.isnan(position):
        return f"full stretch (V = {float(result['crossover_velocity_ratio']):.3g}) is not reached within this jet"
    ratio = float(result["crossover_radius_ratio"])
    return (
        f"fully stretched at {1e3 * position:.3g} mm, radius {1e6 * radius:.3g} µm = {ratio:.3g} of the initial radius"
    )


def words(result: "xr.Dataset | NamedArrays") -> list[str]:
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
    free = _slips(result.attrs["model"]) and result.attrs.get("network_end", "free") == "free"
    where = "At the free end" if free else "At the end"
    sentences.append(f"{where}, {1e3 * place[end]:.3g} mm, {_state(result, end)}.")
    sentences += _frozen(result)
    sentences += _across(result)
    sentences += _fibre(result)
    sentences += _uncertain(result)
    return sentences


def _across(result: "xr.Dataset | NamedArrays") -> list[str]:
    """What lies beyond the end, and whether there is time to contract."""
    sentences = []
    if "far_end_effect" in result:
        effect = float(result["far_end_effect"])
        sentences.append(f"What lies beyond the end of the jet changes the network by {effect:.2g} at most.")
    if result.attrs.get("lateral_contraction"):
        sentences.append(f"Contraction across the jet: {result.attrs['lateral_contraction']}.")
    return sentences


def _slips(model: str) -> bool:
    """Whether a result's network ends at a free end of its own."""
    rung = RUNGS.get(model)
    return rung is not None and rung.slips


def _uncertain(result: "xr.Dataset | NamedArrays") -> list[str]:
    """What the uncertain inputs leave of the answer."""
    if "uncertain_inputs" not in result.attrs:
        return []
    parts = []
    for name, scale, unit in (
        ("crossover_position", 1e3, "mm"),
        ("crossover_radius", 1e6, "µm"),
        ("frozen_position", 1e3, "mm"),
        ("frozen_orientation", 1, ""),
        ("end_orientation", 1, ""),
        ("fibre_radius", 1e6, "µm"),
        ("fibre_diameter", 1e9, "nm"),
    ):
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


def _interval(result: "xr.Dataset | NamedArrays", name: str, scale: float, unit: str) -> str:
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


def _dried(result: "xr.Dataset | NamedArrays", end: int) -> list[str]:
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
        first, coldest, last = (float(t) - 273.15 for t in (kelvin[0], np.nanmin(kelvin), kelvin[end]))
        if coldest < first - 0.2:
            sentences.append(f"It cools to {coldest:.3g} °C on the way and ends at {last:.3g} °C.")
        else:
            sentences.append(f"It goes from {first:.3g} to {last:.3g} °C.")
    if "deborah_number" in result:
        w, affine = (float(result[name].values[end]) for name in ("strand_stretch", "stretch_ratio"))
        sentences.append(
            f"The strands relax while they are stretched: {w:.3g} times at the end, where the solution is stretched "
            f"{affine:.3g} times."
        )
    if "skin_thickness" in result:
        surface, axis = (float(result[f"{name}_polymer_fraction"].values[end]) for name in ("surface", "axis"))
        skin = 1e6 * float(result["skin_thickness"].values[end])
        thick = f"the skin is {skin:.3g} µm thick" if skin > 0 else "there is no skin"
        if skin >= 1e6 * float(result["radius"].values[end]) * (1 - 1e-9):
            thick = "all of the section is past its glass"
        sentences.append(
            f"Drying leaves a fraction of {surface:.3g} at the surface against {axis:.3g} on the axis; {thick}."
        )
    return sentences


def _frozen(result: "xr.Dataset | NamedArrays") -> list[str]:
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


def _fibre(result: "xr.Dataset | NamedArrays") -> list[str]:
    """The dry fibre, with the interval of its diameter where the inputs have one."""
    if "fibre_diameter" not in result or not np.isfinite(float(result["fibre_diameter"])):
        return []
    diameter = 1e9 * float(result["fibre_diameter"])
    spread = f" ± {1e9 * float(result['fibre_diameter_std']):.2g}" if "fibre_diameter_std" in result else ""
    spread += _interval(result, "fibre_diameter", 1e9, "nm")
    if float(result.attrs["strands_per_chain"]) < LEAST_STRANDS:
        return [
            f"No fibre is to be expected: without an entangled network the jet breaks up. Its polymer alone is a thread of "
            f"{diameter:.4g}{spread} nm in diameter."
        ]
    held = "arrest_position" in result and np.isfinite(float(result["arrest_position"]))
    until = "what became solid" if held else "the last section, were it stretched no more"
    return [f"The dry fibre is {diameter:.4g}{spread} nm in diameter: {until}."]


def _state(result: "xr.Dataset | NamedArrays", index: int) -> str:
    def at(name: str) -> float:
        return float(result[name].values[index])

    fraction = f"has a polymer volume fraction of {at('core_polymer_fraction'):.3g}"
    width = f"{at('radial_contraction'):.3g}" if at("radial_contraction") >= 1e-3 else "less than a thousandth"
    core = "is compact polymer" if bool(result["compacted"].values[index]) else fraction
    return (
        f"the strands are at {at('relative_extension'):.3g} of their contour, oriented O = {at('orientation'):.3g}, "
        f"contracted to {width}; the network's radius is {1e6 * at('network_radius'):.3g} µm in a "
        f"jet of {1e6 * at('radius'):.3g} µm, and its core {core} "
        f"(solution: {float(result['volume_fraction']):.3g})"
    )


def _difference(result: "xr.Dataset | NamedArrays") -> str:
    gap = float(result["crossover_extension_position"]) - float(result["crossover_position"])
    if np.isnan(gap):
        return ""
    return f", {1e3 * abs(gap):.3g} mm {'after' if gap > 0 else 'before'} full stretch by Eq. (38)"
