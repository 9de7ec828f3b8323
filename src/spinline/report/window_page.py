"""An operating window as one page that opens offline: map, sliders, values under the pointer, boundaries, what was measured.

The page holds every computed number in double precision and interpolates nothing. It asks for nothing outside itself (its own
policy forbids it), works by keyboard, and prints what it shows.
"""

import base64
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from spinline.base.errors import InputError
from spinline.base.files import write_text
from spinline.base.words import page
from spinline.study.rows import INCOMPLETE

__all__ = ["AXES", "VARIABLES", "Point", "save_window_page", "window_page"]

MOST = 2_000_000  # numbers that a page may hold: 16 MB
AXES = {  # name: label, unit, its number of SI
    "voltage": ("voltage", "kV", 1e-3),
    "gap": ("gap", "cm", 1e2),
    "flow_rate": ("flow rate", "mL/h", 3.6e9),
    "mass_fraction": ("polymer mass fraction", "%", 1e2),
}
VARIABLES = {  # name: label, unit, its number of SI; in the order that a page offers
    "fibre_diameter": ("fibre diameter", "nm", 1e9),
    "crossover_position": ("crossover from the nozzle", "mm", 1e3),
    "crossover_radius": ("jet radius at the crossover", "µm", 1e6),
    "full_stretch": ("stretch at the end over that of full stretch", "", 1.0),
    "orientation": ("orientation", "", 1.0),
    "core_polymer_fraction": ("polymer fraction of the core at the end", "%", 1e2),
    "dryness": ("solvent lost at the end of the jet", "%", 1e2),
    "strands_per_chain": ("strands per chain", "", 1.0),
    "viscosity": ("viscosity", "Pa s", 1.0),
    "k": ("k", "", 1.0),
    "current": ("current", "nA", 1e9),
}
_RESTS = {
    "k_estimate": "Estimate of k",
    "viscosity_law": "Viscosity",
    "air": "Drying",
    "rung": "Law of the diameter",
    "intervals": "Intervals",
    "borrowed": "Not given, so taken",
}


@dataclass(frozen=True)
class Point:
    """Something measured: where (axis name to SI value; what is left out was as in the scene), and what.

    Attributes
    ----------
    at : dict
        Axis to SI value.
    name : str
        Of the variable.
    value : float
        SI.
    """

    at: dict[str, float]
    name: str
    value: float


def window_page(window: xr.Dataset, measured: Sequence[Point] = ()) -> str:
    """HTML text of the page.

    Parameters
    ----------
    window : xarray.Dataset
        From `operating_window` or `fibre_window`: a dimension of three for the band, then the axes.
    measured : sequence of Point
        Marked where they lie.

    Returns
    -------
    str

    Raises
    ------
    InputError
        For a window of one point, or one of more numbers than a page can hold.
    """
    band, axes = _dimensions(window)
    names = [name for name in VARIABLES if name in window and np.isfinite(window[name].values).any()]
    size = int(window[names[0]].size if names else 0)
    if all(window.sizes[name] == 1 for name in axes):
        raise InputError("window", "is one point: nothing to draw", remedy="give a range, voltage 5 kV .. 20 kV")
    if not names:
        raise InputError("window", "has no numbers: no point could be computed", remedy="see its `reason`")
    if size * len(names) > MOST:
        raise InputError(
            "--html",
            "would hold too many numbers",
            value=size * len(names),
            allowed=f"at most {MOST}",
            remedy="take fewer --steps, or fewer ranges",
        )
    data = {
        "axes": [_axis(window, name) for name in axes],
        "bands": {"names": _band_names(window, band), "middle": 1},
        "variables": [_variable(window, name, (band, *axes)) for name in names],
        **_kinds(window, (band, *axes)),
        "measured": [_mark(point, axes) for point in measured],
    }
    rests = "".join(
        f"<p>{label}: {escape(str(window.attrs[key]))}</p>" for key, label in _RESTS.items() if window.attrs.get(key)
    )
    made = f"<p>Made by spinline {escape(str(window.attrs['spinline_version']))}.</p>"
    scene = f"<details><summary>Inputs</summary><pre>{escape(str(window.attrs['scene']))}</pre></details>"
    text = resources.files("spinline").joinpath("data", "pages", "window.html").read_text("utf-8")
    parts = {
        "title": escape(str(window.attrs["title"])),
        "rests": rests + scene + made,
        "data": json.dumps(data, allow_nan=False, ensure_ascii=True).replace("<", "\\u003c"),
    }
    # at once: what stands in the parts is nobody's place
    return page(re.sub("@(title|rests|data)@", lambda place: parts[place[1]], text))


def save_window_page(
    window: xr.Dataset, path: str | Path, measured: Sequence[Point] = (), *, force: bool = False
) -> Path:
    """Write the page.

    Raises
    ------
    InputError
        As `window_page`, and for a file that cannot be written.
    """
    return write_text(path, window_page(window, measured), force=force)


def _dimensions(window: xr.Dataset) -> tuple[str, list[str]]:
    axes = [name for name in AXES if name in window.sizes]
    return next(str(name) for name in window["status"].dims if name not in axes), axes


def _band_names(window: xr.Dataset, band: str) -> list[str]:
    if band != "k_factor":
        return [str(name) for name in window[band].values]
    low, _, high = (float(factor) for factor in window[band].values)
    return [f"{low:g} k", "k as estimated", f"{high:g} k"]


def _axis(window: xr.Dataset, name: str) -> dict[str, Any]:
    label, unit, scale = AXES[name]
    return {"name": name, "label": label, "unit": unit, "scale": scale, "values": window[name].values.tolist()}


def _variable(window: xr.Dataset, name: str, dims: tuple[str, ...]) -> dict[str, Any]:
    label, unit, scale = VARIABLES[name]
    words = str(window[name].attrs.get("long_name", label))
    values = window[name].transpose(*dims).values
    return {
        "name": name,
        "label": label,
        "unit": unit,
        "scale": scale,
        "words": words[:1].upper() + words[1:],
        "data": _packed(values, "<f8"),
    }


def _kinds(window: xr.Dataset, dims: tuple[str, ...]) -> dict[str, Any]:
    """What sort of point each is, and why some have no numbers."""
    if "regime" in window:
        words = window["regime"].transpose(*dims).values.astype(str)
        names, codes = np.unique(words, return_inverse=True)
        meant = window["regime"].attrs
        names = np.array([f"{name}: {meant[name]}" if name in meant else name for name in names])
        label = "the regimes"
    else:
        answered = window["status"].transpose(*dims).values <= INCOMPLETE
        reached = np.isfinite(window["crossover_position"].transpose(*dims).values)
        names = np.array(
            ["no numbers", "fully stretched beyond the end of the jet, if at all", "fully stretched within it"]
        )
        codes = np.where(answered, np.where(reached, 2, 1), 0)
        label = "where the network is fully stretched within the jet from where it is not"
    codes = np.reshape(codes, [window.sizes[name] for name in dims]).astype(np.uint8)
    said = window["reason"].transpose(*dims).values.astype(str)
    if "remark" in window:
        said = np.where(said == "", window["remark"].transpose(*dims).values.astype(str), said)
    why, told = np.unique(said, return_inverse=True)
    return {
        "kinds": {
            "label": label,
            "names": names.tolist(),
            "banded": bool(np.any(codes != codes[1:2])),
            "data": _packed(codes, "u1"),
        },
        "why": {"words": why.tolist(), "data": _packed(told, "<i4")},
    }


def _mark(point: Point, axes: list[str]) -> dict[str, Any]:
    _, unit, scale = VARIABLES[point.name]
    return {
        "at": [point.at.get(name) for name in axes],
        "value": {"name": point.name, "si": point.value},
        "text": f"{point.value * scale:.4g} {unit} measured".replace("  ", " "),
    }


def _packed(values: Any, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")
