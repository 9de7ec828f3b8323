"""Exponents of a jet's current at published settings, from the boundary-value problem of the straight jet.

    python benchmarks/current_exponents.py ../shared/data/spindb/experiments.csv

d ln I/d ln (voltage, flow rate, conductivity, viscosity) of two settings of each paper (drawn by chance), the rest of the
needle being the medians of the recipe's chain: a Newtonian liquid, FENE-P whose relaxation time is that of the recipe's
strands and follows its viscosity, and FENE-P of a hundredth of a second. The closed form of a viscous jet, which has neither
a needle nor surface tension, has the viscosity to the 1/6. Ten minutes on two cores.
"""

import time
from multiprocessing import Pool

import numpy as np
from spindb_calibrate import command, load

from spinline.base.errors import InputError
from spinline.jetprofile.ehd import NeedleSettings, NoSteadyJet, StraightEhdJet
from spinline.recipe.believe import believe
from spinline.recipe.constants import TAKEN
from spinline.recipe.model import UNKNOWNS, spun

STRANDS = "fene-p, strands"
SETTINGS = ("voltage", "flow_rate", "conductivity", "viscosity")
_STEP = np.log(1.15)
_PERMITTIVITY = 37.0  # of DMF; acetone 21, water 80
_EXTENSIBILITY = 500.0


def liquids(believed, made):
    """What is told apart, by name: the settings that each has beyond the needle's."""
    mu, phi = float(made.viscosity[0]), believed.volume_fraction
    strands = 3 * mu / (TAKEN.plateau * phi**TAKEN.plateau_power)
    fene = {"law": "fene-p", "extensibility": _EXTENSIBILITY}
    return {
        "newtonian": {"law": "newtonian"},
        STRANDS: {**fene, "relaxation_time": strands},
        "fene-p, 10 ms": {**fene, "relaxation_time": 0.01},
    }


def exponents(recipe):
    """Of one recipe, by liquid: the current, that of the chain, and the exponents; or why there is no steady jet."""
    believed = believe(recipe)[0]
    made = spun(believed, np.zeros((1, len(UNKNOWNS))))
    needle = {
        "radius": believed.needle_radius,
        "flow_rate": believed.flow_rate,
        "voltage": believed.voltage,
        "gap": believed.gap,
        "conductivity": believed.conductivity,
        "viscosity": float(made.viscosity[0]),
        "surface_tension": believed.surface_tension,
        "density": believed.density,
        "permittivity": _PERMITTIVITY,
    }
    found = {}
    for name, liquid in liquids(believed, made).items():
        follows = {"viscosity": ("viscosity", "relaxation_time")} if name == STRANDS else {}
        try:
            jet = StraightEhdJet(NeedleSettings(**needle, **liquid))
            slopes = {key: slope(needle | liquid, follows.get(key, (key,)), jet) for key in SETTINGS}
        except (NoSteadyJet, InputError) as error:
            found[name] = {"refused": str(error).split(";")[0]}
        else:
            found[name] = {"current": jet.current, "chain": float(made.current[0]), **slopes}
    return found


def slope(settings, keys, jet):
    """d ln I/d ln of settings that change together."""
    ends = []
    for step in (-_STEP, _STEP):
        changed = {key: settings[key] * np.exp(step) for key in keys}
        ends.append(np.log(StraightEhdJet(NeedleSettings(**settings | changed), near=jet).current))
    return float(np.diff(ends)[0] / (2 * _STEP))


def judge(path):
    """Everything, as a dictionary."""
    began = time.monotonic()
    data, rng = load(path), np.random.default_rng(0)
    chosen = []
    for paper in np.unique(data.paper):
        mine = np.flatnonzero(data.paper == paper)
        chosen += rng.choice(mine, min(2, mine.size), replace=False).tolist()
    with Pool(2) as pool:
        found = pool.map(exponents, [data.recipes[i] for i in chosen], chunksize=1)
    answer = {"settings": len(chosen), "liquids": {}}
    for name in found[0]:
        jets = [one[name] for one in found if "current" in one[name]]
        over = np.log([one["current"] / one["chain"] for one in jets])
        answer["liquids"][name] = {
            "jets": len(jets),
            **{key: quartiles([one[key] for one in jets]) for key in SETTINGS},
            "current over the chain's": quartiles(np.exp(over)),
            "sd of its logarithm": round(float(over.std()), 3),
        }
    return answer | {
        "each": {str(i): one for i, one in zip(chosen, found, strict=True)},
        "seconds": round(time.monotonic() - began, 1),
    }


def quartiles(values):
    """25, 50 and 75 %."""
    return np.percentile(values, (25, 50, 75)).round(3).tolist()


if __name__ == "__main__":
    command(judge, __doc__, __file__)
