"""Drying with heat over its whole box: every case a finite answer within physical bounds or a named refusal.

    python benchmarks/heat_box.py --cases 100000 -o benchmarks/heat_box.json
    python benchmarks/heat_box.py --check benchmarks/heat_box.json --cases 1000

A case follows from its index alone: solvents and mixtures of the library, air and jet from 200 to 400 K, RH 0 to 1,
polymer fraction 1e-4 to 1, radii 10 nm to 1 mm, all three transfer laws, blown or not. One letter a case: ``.`` a
result; ``b`` boils, ``c`` the air is all water, ``j`` cannot be followed, ``o`` another refusal by name; ``!`` a
failure (a value that is not finite or out of bounds, a warning, an exception that is no refusal).
"""

import argparse
import json
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

from spinline.base.errors import InputError
from spinline.jetprofile import PowerLaw
from spinline.rheology import straight_path
from spinline.rheology.evaporant import Evaporant
from spinline.rheology.heat import dry_with_heat
from spinline.rheology.thermal import saturation_pressure
from spinline.rheology.vapour import VAPOURS

SEED = 13
LAWS = ("kase-matsuo", "churchill-bernstein", "yarin")


def case(index: int) -> str:
    """One letter."""
    draw = np.random.default_rng((SEED, index))
    names = list(draw.choice([n for n in VAPOURS if n != "water"], draw.integers(0, 3), replace=False))
    names += ["water"] if not names or draw.random() < 0.7 else []
    jet_at, air_at = draw.uniform(200, 400, 2)
    rh = draw.choice([0.0, 1.0, draw.random()])
    radius = 10 ** draw.uniform(-8, -3)
    phi = (
        float(min(10 ** draw.uniform(-4, 0), 1 - 1e-9))
        if draw.random() < 0.7
        else float(1 - 10 ** draw.uniform(-9, -0.1))
    )
    share = draw.dirichlet(np.ones(len(names)))
    if names[-1] == "water" and len(names) > 1 and draw.random() < 0.5:
        share = np.append(share[:-1] / share[:-1].sum(), 0.0)
    jet = PowerLaw(
        radius=radius,
        flow_rate=np.pi * radius**2 * 10 ** draw.uniform(-3, 1),
        k=draw.uniform(0.3, 3),
        beta=draw.uniform(0.25, 1),
    )
    place = np.linspace(0.02, 1.0, 25) * radius * 10 ** draw.uniform(0, 4)
    law, floor, wind = draw.choice(LAWS), draw.choice([0.0, 0.3]), draw.choice([0.0, draw.uniform(-30, 30)])
    chi = draw.uniform(-1, 2, len(names))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.filterwarnings("ignore", module="chemicals")
            far = rh * float(saturation_pressure("water", air_at))
            liquids = [
                Evaporant.build(n, 298.15, ambient_pressure=far if n == "water" else 0.0, chi=float(x))
                for n, x in zip(names, chi, strict=True)
            ]
            found = dry_with_heat(
                straight_path(jet, place),
                phi,
                liquids,
                share,
                temperature=jet_at,
                air_temperature=air_at,
                transfer=str(law),
                sherwood_floor=float(floor),
                air_velocity=float(wind),
            )
    except InputError as error:
        text = str(error)
        return "b" if "boiling" in text else "c" if "all the air" in text else "j" if "cannot be dried" in text else "o"
    except Exception:
        return "!"
    parts = (
        found.lost,
        found.temperature,
        found.radius,
        found.velocity,
        found.sherwood,
        found.nusselt,
        found.solvent_volume,
    )
    good = all(np.isfinite(p).all() for p in parts)
    good &= bool((found.polymer_fraction > 0).all() and (found.polymer_fraction <= 1 + 1e-9).all())
    good &= bool(
        (found.solvent_volume > -1e-9).all() and found.temperature.min() > 120 and found.temperature.max() < 480
    )
    flux = found.radius**2 * found.velocity * found.polymer_fraction
    return "." if good and np.allclose(flux, flux[0], rtol=1e-10) else "!"


def main() -> None:
    """Run or check."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--check", type=Path)
    parser.add_argument("-o", "--out", type=Path)
    asked = parser.parse_args()
    begin = time.process_time()
    letters = "".join(case(i) for i in range(asked.cases))
    counts = Counter(letters)
    print(dict(counts), f"{(time.process_time() - begin) / asked.cases * 1e3:.2f} ms a case")
    if asked.out:
        asked.out.write_text(
            json.dumps({"seed": SEED, "cases": asked.cases, "counts": counts, "letters": letters}, indent=1) + "\n"
        )
    if asked.check:
        said = json.loads(asked.check.read_text())["letters"][: asked.cases]
        print("changed:", [i for i, (a, b) in enumerate(zip(letters, said, strict=False)) if a != b])


if __name__ == "__main__":
    main()
