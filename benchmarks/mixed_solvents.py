"""Threads of mixed solvents against exact integrations: how far the fibre's radius and the time until it is solid lie off.

    python benchmarks/mixed_solvents.py

Exact: stretching, surface tension and each solvent's loss together, by LSODA, sharing nothing with the march of
`spinline.jetprofile.whipping`. Once with the law that is marched (each solvent leaves by its share, as an ideal mixture in
volumes at its own wet bulb), and once as straight jets dry: Flory and Huggins' activities between the solvents, and one
temperature where the heat of all that leaves is what the air brings. Beside the march: one constant rate until all solvents
are gone, and the one that is exact for a race. Departures are of ln a and ln t. Half a minute.
"""

import json
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from spinline.base.constants import EPS0
from spinline.jetprofile.whipping import log_term, thinning
from spinline.recipe import UNKNOWNS, Recipe, spun
from spinline.recipe.believe import believe
from spinline.recipe.constants import CONSTANTS, TAKEN
from spinline.rheology._heat_kernels import surface
from spinline.rheology.evaporant import Evaporant
from spinline.rheology.thermal import air_viscosity, saturation_pressure
from spinline.rheology.transfer import law_index

KELVIN, PRESSURE = 296.15, 101325.0
# polymer, solvents by mass, mass fraction, relative humidity
THREADS = [
    ("PCL", {"DCM": 0.6, "DMF": 0.4}, 0.12, 0.40),
    ("PCL", {"DCM": 0.8, "DMF": 0.2}, 0.12, 0.40),
    ("PCL", {"DCM": 0.2, "DMF": 0.8}, 0.12, 0.40),
    ("PVDF", {"DMF": 0.6, "acetone": 0.4}, 0.18, 0.45),
    ("PVDF", {"DMAc": 0.6, "acetone": 0.4}, 0.18, 0.45),
    ("PVDF", {"DMSO": 0.5, "acetone": 0.5}, 0.15, 0.45),
    ("PVDF", {"NMP": 0.5, "acetone": 0.5}, 0.15, 0.45),
    ("PLA", {"chloroform": 0.67, "acetone": 0.33}, 0.08, 0.45),
    ("PLA", {"DMF": 0.5, "acetone": 0.5}, 0.08, 0.45),
    ("PCL", {"chloroform": 0.5, "ethanol": 0.5}, 0.10, 0.45),
    ("PS", {"THF": 0.5, "DMF": 0.5}, 0.20, 0.45),
    ("PVP", {"water": 0.5, "ethanol": 0.5}, 0.10, 0.85),
    ("PVP", {"water": 0.9, "ethanol": 0.1}, 0.10, 0.30),
    ("PET", {"TFA": 0.7, "DCM": 0.3}, 0.15, 0.45),
]
# water beside a solvent that leaves faster, by the humidity
DAMP = [
    ("PVP", {"water": 0.2, "ethanol": 0.8}, 0.10),
    ("PVP", {"water": 0.5, "ethanol": 0.5}, 0.10),
    ("PVP", {"water": 0.8, "ethanol": 0.2}, 0.10),
    ("PLA", {"water": 0.2, "acetone": 0.8}, 0.08),
    ("PLA", {"water": 0.5, "acetone": 0.5}, 0.08),
]
HUMIDITIES = (0.3, 0.5, 0.7, 0.9)


def as_straight_jets(names, rates, humidity):
    """Rates of loss by the shares, with activities and one temperature; of a pure solvent `rates`."""
    water = min(humidity, 0.97) * float(saturation_pressure("water", KELVIN))
    liquids = [Evaporant.build(n, KELVIN, ambient_pressure=water if n == "water" else 0.0) for n in names]
    columns = (
        "density",
        "molar_mass",
        "heat_capacity",
        "vapour_heat_capacity",
        "diffusivity",
        "chi",
        "ambient_pressure",
    )
    sub = np.array([[getattr(e, c) for c in columns] + [1.0, 0.0, e.molar_mass / e.density] for e in liquids])
    tables, volume = np.stack([e.laws for e in liquids]), sub[:, 9]
    air = np.array([PRESSURE, KELVIN, 0.0, 0.0, 1.0, 0.0, 1.0, law_index("kase-matsuo"), 1.0, 0.0, 1.0])
    nu = float(air_viscosity(KELVIN)) * 8.31446261815324 * KELVIN / (0.0289644 * PRESSURE)
    place = np.array([1.0, nu / 2, 0.0, 1.0])

    def loss(share):
        activity, flux = share * np.exp(1 - volume * np.sum(share / volume)), np.empty(len(names))

        def excess(kelvin):
            heat, carried, _ = surface(activity, 1.0, kelvin, sub, tables, air, place, flux)
            return heat - carried if heat == heat else -1e9

        excess(brentq(excess, 240.0, KELVIN + 4.9, xtol=1e-9))
        return flux / sub[:, 0]

    pure = np.diag([loss(row) for row in np.eye(len(names))])
    return lambda share: rates * loss(share) / pure


def exact(jet, shares, loss, power, solid):
    """Undried radius and time where the thread is solid or lands."""
    q, gamma, eta, phi = (
        jet[n] for n in ("charge_density", "surface_tension", "extensional_viscosity", "volume_fraction")
    )
    push = q * q * log_term(TAKEN.chi) / (4 * EPS0)

    def slope(_, y):
        area, part = np.exp(y[0]), np.maximum(y[1:], 0.0)
        u = phi + part.sum()
        drive = max(push * area / u - gamma / np.sqrt(area * u), 0.0)
        return [-drive / (eta * u**-power), *(-loss(part / part.sum()) / area)]

    def ends(_, y):
        return phi + np.sum(y[1:]) - phi / solid

    ends.terminal = True
    start = [2 * np.log(jet["start"]), *((1 - phi) * shares)]
    found = solve_ivp(slope, (0, jet["flight_time"]), start, method="LSODA", rtol=1e-9, atol=1e-13, events=ends)
    return np.exp(0.5 * found.y[0, -1]), found.t[-1]


def race_rate(shares, rates, phi, power, solid):
    """``(1 - u^p)/k = p int u^(p-1) du/k(u)``: the mean of 1/k over even steps of u^p."""
    x, weight = np.polynomial.legendre.leggauss(400)
    last = (phi / solid) ** power
    left = (((last + (1 - last) * 0.5 * (x + 1)) ** (1 / power)) - phi) / (1 - phi)
    unit = rates / rates.max()
    sigma = [brentq(lambda s, goal=goal: shares @ np.exp(-unit * s) - goal, 0, 1e6, xtol=1e-14) for goal in left]
    parts = shares * np.exp(-unit * np.array(sigma)[:, np.newaxis])
    return 2 / np.sum(weight * parts.sum(axis=1) / (parts @ rates))


def judge():
    """Departures of the threads, and of those in damp air."""
    damp = []
    for polymer, solvent, fraction in DAMP:
        rows = depart([(polymer, solvent, fraction, humidity) for humidity in HUMIDITIES])["threads"]
        by = {
            f"{humidity:.1f}": row["side by side, as straight jets"][0]
            for humidity, row in zip(HUMIDITIES, rows, strict=True)
        }
        damp.append({"polymer": polymer, "solvent": solvent, "ln a by humidity": by})
    return {**depart(THREADS), "damp air": damp}


def depart(threads):
    """Departures of every thread, and their medians and largest."""
    power, departures, rows = CONSTANTS.viscosity_power, {}, []
    for polymer, solvent, fraction, humidity in threads:
        recipe = Recipe(
            polymer,
            solvent,
            15e3,
            0.15,
            1e-6 / 3600,
            mass_fraction=fraction,
            usual_fraction=fraction,
            temperature=KELVIN,
            relative_humidity=humidity,
        )
        b = believe(recipe)[0]
        middle = spun(b, np.zeros((1, len(UNKNOWNS))))
        shares, rates = np.array(b.shares), b.evaporation * np.array(b.ratios)
        jet = {
            "charge_density": float(middle.charge_density[0]),
            "surface_tension": b.surface_tension,
            "extensional_viscosity": CONSTANTS.trouton * float(middle.viscosity[0]),
            "volume_fraction": b.volume_fraction,
            "flight_time": b.flight_time,
            "start": b.onset_radius,
        }
        known = {"power": power, "solid_fraction": b.solid_fraction, "chi": TAKEN.chi, "steps": 3000}
        constant = race_rate(shares, rates, b.volume_fraction, power, b.solid_fraction)
        forms = {
            "side by side": thinning(**jet, evaporation=b.evaporation, mixture=(shares, b.ratios), **known),
            "until all are gone": thinning(**jet, evaporation=b.evaporation, **known),
            "the race's constant": thinning(**jet, evaporation=constant, **known),
        }
        laws = {
            "ideal": lambda share, k=rates: k * share,
            "as straight jets": as_straight_jets(list(solvent), rates, humidity),
        }
        row = {"polymer": polymer, "solvent": solvent}
        for law, loss in laws.items():
            radius, took = exact(jet, shares, loss, power, b.solid_fraction)
            row[law] = float(f"{radius:.4g}")
            for form, found in forms.items():
                off = np.log(float(found.radius) / radius), np.log(float(found.time) / took)
                departures.setdefault(law, {}).setdefault(form, []).append(np.abs(off))
                row[f"{form}, {law}"] = np.round(off, 4).tolist()
        rows.append(row)
    words = ("radius: median, largest", "time: median, largest")
    summary = {
        law: {
            form: {
                name: [round(float(np.median(v)), 4), round(float(np.max(v)), 4)]
                for name, v in zip(words, np.transpose(values), strict=True)
            }
            for form, values in forms.items()
        }
        for law, forms in departures.items()
    }
    return {"departures": summary, "threads": rows}


if __name__ == "__main__":
    text = json.dumps(judge(), indent=1)
    Path(__file__).with_suffix(".json").write_text(text + "\n", encoding="utf-8")
    print(text)
