"""Drying with heat over its whole box: every case a finite answer within physical bounds or a named refusal.

    python benchmarks/heat_box.py --solvents 15 --cases 100000 -o benchmarks/heat_box.json
    python benchmarks/heat_box.py --cases 30000 -o benchmarks/heat_box_all.json
    python benchmarks/heat_box.py --solvents 15 --check benchmarks/heat_box.json --cases 1000

A case follows from its index and the number of solvents: the first so many of the library (15 when the first campaign ran; all
unless said) and mixtures of them, air and jet from 200 to 400 K, RH 0 to 1,
polymer fraction 1e-4 to 1, radii 10 nm to 1 mm, all three transfer laws, blown or not. One letter a case: ``.`` a
result; ``b`` boils, ``c`` the air is all water, ``j`` cannot be followed, ``o`` another refusal by name; ``!`` a
failure (a value that is not finite or out of bounds, mass or enthalpy not conserved to 1e-10, a warning, an exception
that is no refusal). Cases are done in chunks, each written before the next begins; a run that was stopped goes on from
the file, whose ``?`` are not judged yet.
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
from spinline.rheology.heat import POLYMER_HEAT_CAPACITY, dry_with_heat
from spinline.rheology.thermal import saturation_pressure
from spinline.rheology.vapour import VAPOURS

SEED = 13
LAWS = ("kase-matsuo", "churchill-bernstein", "yarin")


def case(index: int, solvents: int = len(VAPOURS)) -> str:
    """One letter, of the first so many solvents."""
    draw = np.random.default_rng((SEED, index))
    names = list(draw.choice([n for n in list(VAPOURS)[:solvents] if n != "water"], draw.integers(0, 3), replace=False))
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
    good &= (
        bool(np.allclose(flux, flux[0], rtol=1e-10)) and imbalance(found, liquids, phi, share, jet_at, air_at) < 1e-10
    )
    return "." if good else "!"


def imbalance(found, liquids, phi, share, jet_at, air_at, polymer=1200.0 * POLYMER_HEAT_CAPACITY):
    """Mass and enthalpy that the ledger and the jet disagree on, over the largest that either holds or passes."""
    rho, heat = (np.array([getattr(e, key) for e in liquids]) for key in ("density", "heat_capacity"))
    start = (1 - phi) * np.asarray(share) / np.sum(share)
    gone = rho @ (start[:, np.newaxis] - found.solvent_volume)
    mass = np.abs(found.mass_given_off - gone).max() / max(float(rho @ start), np.abs(gone).max())
    capacity, first = phi * polymer + (rho * heat) @ found.solvent_volume, phi * polymer + (rho * heat) @ start
    held = capacity * (found.temperature - air_at)
    wrong = np.abs(found.enthalpy_taken_up - (held - first * (jet_at - air_at))).max()
    return max(float(mass), float(wrong / max(first * abs(jet_at - air_at), np.abs(held).max())))


def summary(letters: list[str]) -> str:
    """The file's text."""
    text = "".join(letters).rstrip("?")
    counts = dict(sorted(Counter(text.replace("?", "")).items()))
    lines = [text[i : i + 100] for i in range(0, len(text), 100)]
    return (
        json.dumps({"seed": SEED, "cases": sum(counts.values()), "counts": counts, "letters": lines}, indent=1) + "\n"
    )


def said(path: Path) -> str:
    """Letters of a file; none where there is no file."""
    return "".join(json.loads(path.read_text())["letters"]) if path.exists() else ""


def main() -> None:
    """Run, go on, or check."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--solvents", type=int, default=len(VAPOURS), help="the first so many of the library")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="stop after so many (processor time)")
    parser.add_argument("--check", type=Path, help="a file whose first cases are judged again")
    parser.add_argument("-o", "--out", type=Path)
    asked = parser.parse_args()
    begin = time.process_time()
    before = said(asked.out) if asked.out else ""
    letters = list(before.ljust(asked.cases, "?"))
    todo = [i for i in range(asked.cases) if letters[i] == "?"]
    done = 0
    while done < len(todo) and time.process_time() - begin < asked.seconds:
        for i in todo[done : done + 500]:
            letters[i] = case(i, asked.solvents)
        done = min(done + 500, len(todo))
        if asked.out:
            asked.out.write_text(summary(letters))
    print(dict(Counter(letters)), f"{(time.process_time() - begin) / max(done, 1) * 1e3:.2f} ms a case")
    if asked.check:
        pairs = zip(letters, said(asked.check), strict=False)
        print("changed:", [i for i, (a, b) in enumerate(pairs) if a != b and "?" not in (a, b)])


if __name__ == "__main__":
    main()
