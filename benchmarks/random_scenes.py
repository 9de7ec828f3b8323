"""Random scenes, drawn from the scene file's own keys: every quantity over its range, every word from its list.

`scene(seed)` gives the tables of a scene. Most values are drawn near what people spin (a factor of ten about the middle of
``USUAL``), one in eight over the whole range that the key allows; keys that may be left out mostly are. It shares no code with
`benchmarks.atlas_scenes`, whose box is smaller.
"""

import math
import random
import typing
from typing import Any

from spinline.scene.air_and_rheology import _PARAMETERS, RheologySection
from spinline.scene.keys import _known, reader
from spinline.scene.quantities import Read

USUAL = {
    "jet.radius": 100e-6,
    "jet.flow_rate": 1e-9,
    "jet.length": 5e-3,
    "jet.k": 1.0,
    "jet.p": 5.0,
    "jet.electric_field": 6e4,
    "jet.conductivity": 1e-2,
    "solution.mass_fraction": 0.06,
    "solution.volume_fraction": 0.06,
    "solution.molar_mass": 500.0,
    "solution.kuhn_length": 1e-9,
    "solution.viscosity": 1.0,
    "solution.solvent_viscosity": 1e-3,
    "solution.relaxation_time": 1e-2,
    "network.spring": 3.0,
    "network.coupling": 1e4,
    "network.inertia": 1e-3,
    "network.coarse_grain": 3.0,
    "network.drag_viscosity": 1e-3,
    "ambient.pressure": 1e5,
    "ambient.air_viscosity": 1.5e-5,
    "ambient.vapour_diffusivity": 1e-5,
    "ambient.saturation": 0.02,
    "rheology.B": 7.0,
    "rheology.m": 0.1,
    "rheology.intrinsic_viscosity": 0.3,
    "rheology.martin_constant": 0.3,
    "rheology.extensibility": 100.0,
    "rheology.sherwood_floor": 0.5,
    "rheology.diffusivity": 1e-9,
    "rheology.D_decay": 5.0,
    "rheology.D_gap": 1.0,
    "rheology.D_growth": 1.0,
    "solution.polymer_density": 1150.0,
    "solution.solvent_density": 900.0,
}
POLYMERS = ("PEO", "PMMA", "PVP", "PCL", "PAN", "PS", "PVA", "PLA", "nylon")
SOLVENTS = ("water", "ethanol", "acetone", "chloroform", "dichloromethane", "DMF", "toluene", "THF", "limonene")
LEFT_OUT = 0.8  # of the keys that may be


def quantity(rng: random.Random, key: str) -> Any:
    """A value of a key, with its SI unit where it has one."""
    how = reader(key)
    assert isinstance(how, Read)
    low, high = how.low, how.high
    wide = rng.random() < 0.125
    if key in USUAL and not wide:
        value = USUAL[key] * 10 ** rng.uniform(-1.0, 1.0)
        value = min(max(value, low + 1e-12 * (high - low)), high) if value >= high or value <= low else value
    elif low > 0 or high / max(low, 1e-30) > 1e4:
        floor = low if low > 0 else high * 1e-12
        value = math.exp(rng.uniform(math.log(floor), math.log(high)))
    else:
        value = rng.uniform(low, high)
    if key.endswith("temperature") and not wide:
        value = rng.uniform(275.0, 330.0)
    if key == "jet.beta" and not wide:
        value = rng.uniform(0.3, 0.7)
    from spinline.base.units import QUANTITIES

    unit = QUANTITIES[how.kind].unit
    doubt = f" +/- {abs(value) * 10 ** rng.uniform(-3, -0.3):.3g}" if rng.random() < 0.02 else ""
    return f"{value:.6g}{doubt} {unit}".strip() if unit or doubt else value


def scene(seed: int) -> dict[str, Any]:
    """Tables of a random scene."""
    rng = random.Random(f"spinline {seed}")
    tables: dict[str, Any] = {
        "title": f"random {seed}",
        "solution": {
            "polymer": rng.choice(POLYMERS[:5] if rng.random() < 0.9 else POLYMERS),
            "solvent": rng.choice(SOLVENTS),
        },
        "jet": {},
        "network": {},
        "accuracy": {"points": rng.choice((2, 11, 51, 101, 401)), "draws": rng.choice((0, 4, 16))},
    }
    solution, jet = tables["solution"], tables["jet"]
    if rng.random() < 0.15:
        share = rng.uniform(0.05, 0.95)
        pair = rng.sample(SOLVENTS, 2)
        solution["solvent"] = {pair[0]: share, pair[1]: 1.0 - share}
    fraction = rng.choice(("mass_fraction", "mass_fraction", "volume_fraction"))
    solution[fraction] = quantity(rng, f"solution.{fraction}")
    for key in ("molar_mass", "viscosity"):
        if rng.random() < 0.6:
            solution[key] = quantity(rng, f"solution.{key}")
    for key in (
        "kuhn_length",
        "temperature",
        "polymer_density",
        "solvent_density",
        "solvent_viscosity",
        "relaxation_time",
    ):
        if rng.random() > LEFT_OUT:
            solution[key] = quantity(rng, f"solution.{key}")
    jet["profile"] = rng.choice(("power-law", "power-law", "power-law", "hyperbolic"))
    for key in ("radius", "flow_rate", "length"):
        jet[key] = quantity(rng, f"jet.{key}")
    if jet["profile"] == "hyperbolic":
        jet["p"] = quantity(rng, "jet.p")
    else:
        jet["beta"] = quantity(rng, "jet.beta")
        keys = ("k",) if rng.random() < 0.7 else ("electric_field", "conductivity")
        jet |= {key: quantity(rng, f"jet.{key}") for key in keys}
    for section in ("network", "ambient", "rheology", "effects", "accuracy"):
        if section in ("ambient", "rheology") and rng.random() < 0.5:
            continue
        for name in [key for key in _known() if key.startswith(f"{section}.")]:
            key = name.partition(".")[2]
            if rng.random() < LEFT_OUT or name in ("accuracy.points", "accuracy.draws"):
                continue
            tables.setdefault(section, {})[key] = _any(rng, name)
        if section == "rheology":
            _parameters(rng, tables.setdefault("rheology", {}))
    if rng.random() < 0.4:
        rungs = ("auto", "affine", "manifold", "conformation", "walk")
        tables["network"]["model"] = "chain" if rng.random() < 0.01 else rng.choice(rungs)  # a chain takes minutes
    return tables


def _parameters(rng: random.Random, chosen: dict[str, Any]) -> None:
    """The parameters that the chosen laws need; seldom others, or none."""
    for name, choice, law, _ in _PARAMETERS:
        chosen.pop(name, None)
        taken = chosen.get(choice, RheologySection.model_fields[choice].default)
        if (taken == law) != (rng.random() < 0.01):
            chosen[name] = _any(rng, f"rheology.{name}")


def _any(rng: random.Random, name: str) -> Any:
    how = reader(name)
    words = _words(name)
    if words and (how is None or rng.random() < 0.5):
        return rng.choice(words)
    if isinstance(how, Read):
        return quantity(rng, name)
    if name == "accuracy.rtol":
        return 10 ** rng.uniform(-4, -0.5)
    if name == "accuracy.strands":
        return rng.choice((2, 100, 3000))
    if name == "accuracy.shells":
        return rng.choice((8, 40, 120))
    if name == "accuracy.steps":
        return rng.choice((1, 200, 5000))
    if how is int:
        return rng.randrange(1, 50)
    return rng.uniform(-2, 2)


def _words(name: str) -> list[Any]:
    from spinline.scene.file import Scene

    section, _, key = name.partition(".")
    kind = Scene.model_fields[section].annotation
    models = [one for one in (kind, *typing.get_args(kind)) if hasattr(one, "model_fields")]
    found: list[Any] = []

    def collect(annotation: Any) -> None:
        if typing.get_origin(annotation) is typing.Literal:
            found.extend(typing.get_args(annotation))
        elif annotation is bool:
            found.extend((True, False))
        else:
            for one in typing.get_args(annotation):
                collect(one)

    for model in models:
        if key in model.model_fields:
            collect(model.model_fields[key].annotation)
    return found
