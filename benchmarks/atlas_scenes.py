"""Random scenes over the whole parameter box, for the stability atlas and the accuracy campaign.

A scene follows from (seed, index) alone. Half the coupling and relaxation numbers are drawn over their whole range, the others
so that the numbers which decide, eps V' and De, are even in their logarithm about the places where a model changes.
"""

from pathlib import Path

import numpy as np

MODELS = ("auto", "affine", "manifold", "conformation", "chain", "walk", "two-fluid")
SHARES = (0.41, 0.12, 0.13, 0.14, 0.02, 0.08, 0.10)
SLIPPING = ("manifold", "chain", "two-fluid")
CONTRADICTIONS = 0.05  # of the scenes may ask for what excludes itself
STRANDS, STEPS, MORE_STEPS = 100, 700, 4000  # of a walk at each point, of a chain, of one whose beads are few


def _any(rng, shares, *values):
    return values[int(rng.choice(len(values), p=shares))]


def draw(seed, index):
    """Scene number `index`, as a dictionary."""
    rng = np.random.default_rng([seed, index])
    u = rng.uniform
    model = str(rng.choice(MODELS, p=SHARES))
    phi = float(_any(rng, (0.4, 0.47, 0.13), 10 ** u(-5, -0.5), 10 ** u(-2, -0.7), u(0.3, 0.99)))
    quality = str(rng.choice(["theta", "good"]))
    thinnest = -6.5 if model == "chain" and quality == "theta" else -9  # most meshes are wider than a jet of nanometres
    radius, speed = 10 ** u(thinnest, -2), 10 ** u(-5, 3)
    flow = np.pi * radius**2 * speed
    jet, v, slope, transit = _jet(rng, radius, flow)
    full = 1 / phi if quality == "theta" else phi**-0.5
    steepest = float(slope.max())
    here = float(slope[min(int(np.searchsorted(v, full)), v.size - 1)])  # V' at the crossover, or at the end
    deborah = float(_any(rng, (0.5, 0.5), 10 ** u(-3, 7), here * 10 ** u(-8, 8)))
    relaxation = float(np.clip(deborah / max(here, 1e-30) * radius / speed, 1e-12, 1e11))
    coupling = float(_any(rng, (0.5, 0.5), np.clip(3 * steepest / 10 ** u(-8, 1), 1e-3, 1e18), 10 ** u(-3, 15)))
    inertia = float(_any(rng, (0.5, 0.45, 0.05), 0.0, 3 / coupling * 10 ** u(-10, 0), 10 ** u(-12, 3)))
    kuhn = 10 ** u(-9.5, -8)
    scene = {
        "solution": {
            "polymer": str(rng.choice(["PEO", "PVP", "PCL"])),
            "solvent": str(rng.choice(["water", "ethanol", "acetone"])),
            "volume_fraction": phi,
            "relaxation_time": f"{relaxation!r} s",
            "viscosity": f"{10 ** u(-3, 4)!r} Pa s",
            "kuhn_length": f"{kuhn!r} m",
        },
        "jet": jet,
        "effects": {
            name: _any(rng, (0.6, 0.2, 0.2), "auto", True, False) for name in ("evaporation", "relaxation", "radial")
        },
        "network": {
            "model": model,
            "closure": str(rng.choice(["force", "stretch"])),
            "solvent_quality": quality,
            "coupling": coupling,
            "inertia": inertia,
        },
        "rheology": {
            "diffusivity": f"{10 ** u(-16, -7)!r} m^2/s",
            "constitutive": str(rng.choice(["auto", "UCM", "Oldroyd-B", "FENE-P"])),
        },
        "accuracy": {
            "rtol": 10 ** u(-3, -1),
            "points": int(rng.choice([2, 17, 101])),
            "strands": STRANDS,
            "steps": STEPS,
        },
    }
    humidity = float(_any(rng, (0.35, 0.6, 0.05), 0.0, u(0, 1), 1.0))
    if u() < 0.7:
        scene["ambient"] = {"relative_humidity": humidity}
    law = str(rng.choice(["lattice", "linear", "langevin", "fene"]))
    if model in SLIPPING:
        scene["network"]["force_law"] = law
    beads = 10 ** u(1.3, 2.8)
    strands = transit * radius / (kuhn * (full if quality == "theta" else phi**-0.75))  # along the jet
    if model == "chain" and u() < 0.8:  # as many joined as leave a chain of that many beads
        scene["network"]["coarse_grain"] = max(1.0, float(strands / beads))
        scene["accuracy"]["steps"] = MORE_STEPS
    if model == "walk":
        scene["network"]["walk_tension"] = _any(
            rng, (0.4, 0.2, 0.2, 0.2), "affine", "manifold", "conformation", "two-fluid"
        )
        if scene["network"]["walk_tension"] in SLIPPING:
            scene["network"]["force_law"] = law
    if model == "conformation" and u() < 0.15:
        scene["effects"]["disentanglement"] = True
        scene["solution"]["molar_mass"] = f"{10 ** u(1, 4)!r} kg/mol"
    if u() >= CONTRADICTIONS:
        _reconcile(scene)
    return scene


def _jet(rng, radius, flow):
    """Section of a jet; its V and V' per initial radius from the nozzle to the end, and the time to there."""
    u = rng.uniform
    beta = float(rng.choice([0.25, 0.5, 1.0, u(0.25, 1.0)]))
    k, p, stretch = 10 ** u(-2, 2), 10 ** u(-2, 3), 10 ** u(0, 8)
    profile = str(rng.choice(["power-law", "hyperbolic", "table", "lagrangian"], p=[0.7, 0.1, 0.1, 0.1]))
    jet = {"profile": profile, "radius": f"{radius!r} m"}
    if profile in ("power-law", "hyperbolic"):
        aim = (stretch / k**2) ** (0.5 / beta) if profile == "power-law" else p * (np.sqrt(stretch) - 1)
        length = float(min(max(min(aim, 1e7) * radius, 1.001 * radius), 900.0))
        jet |= {"flow_rate": f"{flow!r} m^3/s", "length": f"{length!r} m"}
        first = k ** (-1 / beta)
        s = np.geomspace(min(first, 0.5 * length / radius), length / radius, 200)
        if profile == "power-law":
            jet |= {"k": k, "beta": beta}
            v = np.maximum(k**2 * s ** (2 * beta), 1.0)
            slope = np.where(s >= first, 2 * beta * v / s, 0.0)
        else:
            jet |= {"p": p}
            v, slope = (1 + s / p) ** 2, 2 * (1 + s / p) / p
        return jet, v, slope, float(s[0] + np.sum(np.diff(s) / np.sqrt(v[1:] * v[:-1])))
    n = int(rng.integers(2, 40))
    z = np.cumsum(10 ** u(-1, 1, n)) * radius
    v = np.cumprod(np.concatenate(([1.0], 10 ** u(0, np.log10(stretch) / n + 1e-3, n - 1))))
    jet["samples"] = (z - z[0], v, flow / (np.pi * radius**2))
    if profile == "table":
        jet["flow_rate"] = f"{flow!r} m^3/s"
    transit = float(z[0] + np.sum(np.diff(z) / np.sqrt(v[1:] * v[:-1]))) / radius
    return jet, v[1:], np.diff(v) / np.diff(z) * radius, transit


def _reconcile(scene):
    """Take out what excludes itself."""
    network, effects, model = scene["network"], scene["effects"], scene["network"]["model"]
    relaxing = ("conformation", "two-fluid")
    mover = network.get("walk_tension", "affine") if model == "walk" else model
    if (effects["relaxation"] is True and mover not in ("auto", *relaxing)) or (
        effects["relaxation"] is False and mover in relaxing
    ):
        effects["relaxation"] = "auto"
    if effects["radial"] is True and effects["evaporation"] is False:
        effects["evaporation"] = "auto"
    if True in (effects["evaporation"], effects["radial"]) and "ambient" not in scene:
        scene["ambient"] = {"relative_humidity": 0.4}
    if model == "walk" and mover == "affine":
        network["closure"] = "force"
    if model == "chain" and scene["jet"]["profile"] == "lagrangian":
        network["model"] = "affine"
        del network["force_law"]


def build(scene, folder):
    """The scene checked, its table written where it has one."""
    from spinline.scene import scene_from_dict

    jet = dict(scene["jet"])
    if "samples" in jet:
        z, v, v0 = jet.pop("samples")
        path = Path(folder) / "jet.csv"
        if jet["profile"] == "table":
            rows = ["z [m],velocity [m/s]", *(f"{a!r},{b * v0!r}" for a, b in zip(z.tolist(), v.tolist(), strict=True))]
            del jet["radius"]
        else:
            radius = float(jet["radius"].split()[0])
            rows = ["x [m],y [m],z [m],radius [m],velocity [m/s]"]
            beads = enumerate(zip(z.tolist(), v.tolist(), strict=True))
            rows += [
                f"{a!r},{0.1 * a * float(np.sin(i))!r},0.0,{radius / float(np.sqrt(b))!r},{b * v0!r}"
                for i, (a, b) in beads
            ]
            fields = rows[-1].split(",")
            rows[-1] = ",".join([*fields[:3], "", fields[4]])
        path.write_text("\n".join(rows) + "\n", encoding="utf-8")
        jet["path"] = path.name
    return scene_from_dict({**scene, "jet": jet}, folder=Path(folder))
