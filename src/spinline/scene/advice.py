"""What to write in place of a key that a file cannot have, and what is usual for one that it lacks."""

from collections.abc import Mapping
from typing import Any

from spinline.base.errors import InputError
from spinline.base.units import parse

__all__ = ["GAUGES", "instead", "usual"]

# inner radius of a needle by its gauge, m: half the nominal inner diameter of regular walls in suppliers' charts (0.413 mm of
# 22 G; 0.00525, 0.00425, 0.00425 and 0.00325 inch of 31 to 34 G); ISO 9626 has the least inner diameters of metric tubes
GAUGES = {
    14: 0.80e-3,
    15: 0.69e-3,
    16: 0.60e-3,
    17: 0.54e-3,
    18: 0.42e-3,
    19: 0.34e-3,
    20: 0.30e-3,
    21: 0.26e-3,
    22: 0.21e-3,
    23: 0.17e-3,
    24: 0.155e-3,
    25: 0.13e-3,
    26: 0.13e-3,
    27: 0.105e-3,
    28: 0.09e-3,
    29: 0.09e-3,
    30: 0.08e-3,
    31: 0.0665e-3,
    32: 0.054e-3,
    33: 0.054e-3,
    34: 0.0413e-3,
}

_USUAL = {
    "jet.beta": "measured jets give 0.4 to 0.6, 0.47 for PEO in water; fit yours with `spinline fit-jet`",
    "jet.radius": 'the inner radius of the nozzle, "0.26 mm" for 21 G',
    "jet.voltage": 'needles are usually at 8 to 25 kV, "15 kV"',
    "jet.gap": 'collectors stand 5 to 30 cm away, "15 cm"',
    "jet.flow_rate": 'pumps of one needle usually give 0.1 to 10 mL/hour, "1 mL/hour"',
    "jet.length": 'how far the straight jet is followed, "5 mm"; electrospun jets bend after 10 to 50 mm',
    "jet.conductivity": 'measure it, or take what is usual: "30 mS/m" in water, "1.5 mS/m" in DMF, less in chloroform',
    "jet.surface_tension": 'nearly that of the solvent: "72 mN/m" for water, "36 mN/m" for DMF, "27 mN/m" for chloroform',
    "jet.permittivity": "relative, nearly that of the solvent: 80 for water, 37 for DMF, 5 for chloroform",
    "solution.solvent": 'a name, "DMF", or shares by mass, { DMF = 0.6, acetone = 0.4 }',
    "solution.polymer": 'a name, "PAN"',
    "solution.molar_mass": 'the bottle\'s label or the supplier says it, "600 kg/mol"',
    "collector.distance": 'collectors stand 5 to 30 cm away, "15 cm"',
}
_WHOLE = {"jet": "peo5-water", "solution": "peo5-water"}

_ACROSS = ("diameter", "inner_diameter", "nozzle_diameter", "needle_diameter", "needle_inner_diameter", "d", "id", "d0")
_TURNS = ("rpm", "rotation_speed", "rotational_speed", "drum_rpm", "drum_speed")
_SALTS = ("salt", "additive", "additives", "salt_concentration", "dopant", "surfactant")
_WHAT_IT_DOES = "what it does is in the conductivity (and the surface tension): give those that are measured with it"
_DRYING = "drying follows from [ambient], relative_humidity and temperature, and [effects]"


def usual(key: str, *, recipe: bool) -> str:
    """What to do about a key that is missing.

    Parameters
    ----------
    key : str
        With its section, "jet.voltage".
    recipe : bool
        Whether the file is a recipe.
    """
    if key in _WHOLE:
        return f"add [{key}]; `spinline scenes --copy {'pan-dmf' if recipe else _WHOLE[key]}` gives one to start from"
    where = f"add it to [{key.rpartition('.')[0]}]" if "." in key else "add it"
    return f"{where}: {_USUAL[key]}" if key in _USUAL else where


def instead(name: str, value: Any, known: list[str], sections: Mapping[str, list[str]]) -> str:
    """What to write for a key that is not known, "" where nothing is plain.

    Parameters
    ----------
    name : str
        The key, without its section.
    value : object
        As given.
    known : list of str
        Keys of its section.
    sections : mapping
        Keys of the other sections, by section.
    """
    plain = name.lower()
    if "radius" in known and plain in _ACROSS:
        return f"give half of it as {_half(value)}"
    if "radius" in known and "gauge" not in known and plain in ("gauge", "needle", "needle_gauge"):
        return f"give its inner radius, {_of_gauge(value)}"
    if plain in _TURNS and "rotation" in known:
        return f'write rotation = "{value} rpm"' if isinstance(value, int | float) else 'write rotation = "240 rpm"'
    if plain in _TURNS and "speed" in known:
        return "write speed, that of its surface: pi times the diameter times the turns, 15.7 m/s of 10 cm at 3000 rpm"
    if plain in _SALTS:
        return _WHAT_IT_DOES
    if plain in ("drying", "evaporation") and "ambient" in sections:
        return _DRYING
    home = next((section for section, keys in sections.items() if name in keys and name not in known), "")
    return f"it belongs to [{home}]" if home else ""


def _half(value: Any) -> str:
    try:
        return f'radius = "{500 * parse(value, "length", "").value:.4g} mm"'
    except (InputError, TypeError):
        return 'radius, "0.26 mm"'


def _of_gauge(value: Any) -> str:
    digits = "".join(letter for letter in str(value) if letter.isdigit())
    radius = GAUGES.get(int(digits)) if 0 < len(digits) < 3 else None
    return 'radius = "0.26 mm" for 21 G' if radius is None else f'radius = "{1e3 * radius:.4g} mm"'
