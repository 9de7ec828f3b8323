"""The fit file: what ``spinline fit`` reads. TOML; unknown keys are refused and the nearest known one is suggested.

::

    title = "PEO 5 wt%, 12 March"
    scene = "scene.toml"            # or a bundled scene: all that is not fitted, and priors where it says +/-
    [[data]]
    path = "radius.csv"             # z [mm], radius [um], std [um]
    kind = "radius"                 # "mean", "core", "chord", or "map" for a reduced X-ray map
    z_range = ["0 mm", "4 mm"]      # optional; std = "2 %" where the file has none
    [parameters]
    k = "free"                      # nothing known
    beta = "0.47 +/- 0.05"          # a prior
    fraction_scale = "1 +/- 0.05"
    length_scale = 1.0              # fixed
    volume_fraction = "scene"       # as the scene has it: the default for all that is not listed
    [fit]
    loss = "gauss"                  # "huber", "cauchy"
    sampler = "least-squares"       # "emcee"
    seed = 0
"""

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.base.units import QUANTITIES, Measured, parse
from spinline.base.words import label
from spinline.fit.model import OF_NEEDLE, PARAMETERS
from spinline.fit.observations import Observation, read_table
from spinline.fit.observed_map import read_map
from spinline.fit.problem import FitProblem, Prior
from spinline.fit.scene_model import forward_model, start_of
from spinline.scene.file import Scene, load_scene, read_toml

__all__ = ["FitFile", "bundled_fits", "load_fit", "scene_priors"]

_TOP = ("title", "scene", "data", "parameters", "fit")
_DATA = ("path", "kind", "std", "z_range", "use", "core_within")
_FIT = ("loss", "sampler", "seed", "steps", "walkers")
_KINDS = ("radius", "mean", "core", "chord", "map")
_SAMPLERS = ("least-squares", "emcee")


@dataclass(frozen=True, eq=False)
class FitFile:
    """A checked fit file.

    Attributes
    ----------
    problem : FitProblem
    scene : Scene
    sampler : {"least-squares", "emcee"}
    seed : int
    steps : int
        Most steps of the sampler.
    walkers : int or None
    text : str
        The TOML it was made from.
    name : str
        Stem of the file, or bundled name.
    """

    problem: FitProblem
    scene: Scene
    sampler: str
    seed: int
    steps: int
    walkers: int | None
    text: str
    name: str


def bundled_fits() -> dict[str, Path]:
    """Names of the bundled fits and their files."""
    folder = Path(str(resources.files("spinline") / "data" / "fits"))
    return {file.parent.name: file for file in sorted(folder.glob("*/fit.toml"))}


def load_fit(source: str | Path) -> FitFile:
    """Read a fit file, or a bundled fit by its name.

    Parameters
    ----------
    source : path or str
        A file of that name goes first.

    Returns
    -------
    FitFile

    Raises
    ------
    InputError
        For an unreadable file, or any key, value or data file that cannot be right.
    """
    data, text, path = read_toml(source, bundled_fits(), (), "fit")
    name = path.stem if path == Path(source) else str(source)
    return _build(data, path.resolve().parent, text, name)


def scene_priors(scene: Scene) -> dict[str, Prior]:
    """Priors of a scene: its quantities that carry ``+/-``, by the name of the parameter they are of."""
    jet = scene.jet
    wanted: dict[str, Any] = {
        "k": getattr(jet, "k", None),
        "beta": getattr(jet, "beta", None),
        "p": getattr(jet, "p", None),
        "initial_radius": getattr(jet, "radius", None),
        "flow_rate": getattr(jet, "flow_rate", None),
        "volume_fraction": scene.solution.volume_fraction,
        "relaxation_time": scene.solution.relaxation_time,
        "viscosity": scene.solution.viscosity,
        **{name: getattr(jet, key, None) for name, key in OF_NEEDLE.items()},
    }
    found = {name: Prior(q.value, q.std) for name, q in wanted.items() if isinstance(q, Measured) and q.std > 0}
    mass = scene.solution.mass_fraction
    if mass is not None and mass.std > 0:
        found["volume_fraction"] = _from_mass(scene, mass)
    return found


def _from_mass(scene: Scene, mass: Measured) -> Prior:
    """Prior of the volume fraction from one of the mass fraction, to first order."""
    from spinline.setup.build import build_solution

    def volume(value: float) -> float:
        section = scene.solution.model_copy(update={"mass_fraction": Measured(value)})
        return float(build_solution(scene.model_copy(update={"solution": section})).volume_fraction)

    step = 1e-4 * min(mass.value, 1 - mass.value)
    slope = (volume(mass.value + step) - volume(mass.value - step)) / (2 * step)
    return Prior(volume(mass.value), slope * mass.std)


def _build(data: Mapping[str, Any], folder: Path, text: str, name: str) -> FitFile:
    _known(data, _TOP, "")
    if not isinstance(data.get("scene"), str):
        raise InputError(
            "scene",
            "is missing" if "scene" not in data else "is not a file name",
            value=data.get("scene"),
            remedy='add scene = "scene.toml", or a bundled scene',
        )
    local = folder / data["scene"]
    scene = load_scene(local if local.exists() else data["scene"])
    asked = _section(data, "parameters")
    _known(asked, tuple(PARAMETERS), "parameters.")
    priors, fixed = _parameters(scene, asked)
    # a parameter that is listed asks for its effect; otherwise the fit takes what a run takes
    on = {
        effect: True if key in asked or key in priors else None
        for effect, key in (("relaxation", "relaxation_time"), ("evaporation", "evaporation"))
    }
    for name_, prior in priors.items():
        start = start_of(scene, name_) if prior is None else None
        if start is not None:
            fixed[name_] = start
    model = forward_model(
        scene,
        relaxation=on["relaxation"],
        evaporation=on["evaporation"],
        values={**fixed, **{n: p.value for n, p in priors.items() if p is not None}},
    )
    listed = {n for n in priors if n in asked}
    free = {
        n: p if p is not None else Prior(model.values.get(n, PARAMETERS[n].low))
        for n, p in sorted(priors.items(), key=lambda item: list(PARAMETERS).index(item[0]))
        if n in model.names or n in listed
    }
    options = _section(data, "fit")
    _known(options, _FIT, "fit.")
    problem = FitProblem(
        model,
        tuple(_observations(data, folder)),
        free,
        options.get("loss", "gauss"),
        label(str(data.get("title", name))),
    )
    sampler = options.get("sampler", "least-squares")
    if sampler not in _SAMPLERS:
        raise InputError("fit.sampler", "is not known", value=sampler, allowed=", ".join(_SAMPLERS))
    walkers = options.get("walkers")
    return FitFile(
        problem,
        scene,
        sampler,
        _integer(options, "seed", 0, 0),
        _integer(options, "steps", 4000, 10),
        None if walkers is None else _integer(options, "walkers", 16, 2),
        text,
        name,
    )


def _parameters(scene: Scene, asked: Mapping[str, Any]) -> tuple[dict[str, Prior | None], dict[str, float]]:
    """Free parameters with their priors (None: nothing known), and fixed values."""
    own = scene_priors(scene)
    free: dict[str, Prior | None] = dict(own)
    fixed: dict[str, float] = {}
    for name, value in asked.items():
        kind = PARAMETERS[name]
        field = f"parameters.{name}"
        if value == "scene":
            if name in ("evaporation", "fraction_scale", "fraction_offset", "length_scale", "origin"):
                raise InputError(field, "is not in a scene", value=value, allowed='"free", a value, or value +/- std')
            continue
        free.pop(name, None)
        if value == "free":
            free[name] = None
            continue
        if isinstance(value, str) and not any(letter.isdigit() for letter in value):
            raise InputError(
                field, "is not understood", value=value, allowed='"free", "scene", a value, or value +/- std'
            )
        measured = parse(value, kind.kind, field)
        if not kind.low <= measured.value <= kind.high:
            raise InputError(
                field,
                "is out of range",
                value=value,
                allowed=f"[{kind.low:g}, {kind.high:g}] {QUANTITIES[kind.kind].unit}".strip(),
            )
        if measured.std > 0:
            free[name] = Prior(measured.value, measured.std)
        else:
            fixed[name] = measured.value
    return free, fixed


def _observations(data: Mapping[str, Any], folder: Path) -> list[Observation]:
    tables = data.get("data", [])
    if not isinstance(tables, list) or not all(isinstance(table, Mapping) for table in tables):
        raise InputError("data", "is not a list of tables", remedy="head every set of data with [[data]]")
    found: list[Observation] = []
    for number, table in enumerate(tables, 1):
        field = f"data {number}."
        _known(table, _DATA, field)
        for key in ("path", "kind"):
            if not isinstance(table.get(key), str):
                raise InputError(
                    f"{field}{key}",
                    "is missing" if key not in table else "is not text",
                    value=table.get(key),
                    remedy="every [[data]] needs path and kind",
                )
        kind = table["kind"]
        if kind not in _KINDS:
            raise InputError(f"{field}kind", "is not known", value=kind, allowed=", ".join(_KINDS))
        path = folder / table["path"]
        if not path.exists():
            raise InputError(
                f"{field}path", "does not exist", value=table["path"], remedy="paths start from the fit file's folder"
            )
        extra = [key for key in ("use", "core_within") if key in table and kind != "map"]
        if extra:
            raise InputError(f"{field}{extra[0]}", 'goes with kind = "map" only', value=table[extra[0]])
        if kind == "map":
            if "std" in table:
                raise InputError(f"{field}std", "goes with tables only: a map has its own", value=table["std"])
            use = table.get("use", ["radius", "mean", "core"])
            if not isinstance(use, Sequence) or isinstance(use, str):
                raise InputError(f"{field}use", "is not a list", value=use, remedy='for example ["radius", "core"]')
            parts = read_map(path, use, core_within=table.get("core_within", 0.4))
        else:
            parts = [read_table(path, kind, std=None if "std" not in table else str(table["std"]))]
        found += [part.within(*_range(table, field)) for part in parts] if "z_range" in table else parts
    return found


def _range(table: Mapping[str, Any], field: str) -> tuple[float, float]:
    ends = table["z_range"]
    if not isinstance(ends, list) or len(ends) != 2:
        raise InputError(
            f"{field}z_range", "is not a pair of lengths", value=ends, remedy='for example ["0 mm", "4 mm"]'
        )
    low, high = (parse(end, "length", f"{field}z_range").value for end in ends)
    if not low < high:
        raise InputError(f"{field}z_range", "is empty", value=ends, remedy="give the nearer end first")
    return low, high


def _section(data: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    section = data.get(name, {})
    if not isinstance(section, Mapping):
        raise InputError(name, "is a value, not a section", value=section, remedy=f"write [{name}]")
    return section


def _known(section: Mapping[str, Any], allowed: tuple[str, ...], prefix: str) -> None:
    for key in section:
        if key not in allowed:
            near = difflib.get_close_matches(key, allowed, n=1)
            raise InputError(
                f"{prefix}{key}",
                "is not a known key",
                allowed=", ".join(allowed),
                remedy=f"did you mean {near[0]!r}?" if near else "take it out",
            )


def _integer(section: Mapping[str, Any], key: str, default: int, least: int) -> int:
    value = section.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value < 2**63:
        raise InputError(f"fit.{key}", "is not a whole number in range", value=value, allowed=f">= {least}")
    return int(np.int64(value))
