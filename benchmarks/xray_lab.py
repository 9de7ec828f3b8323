"""What the facts of a lab do to a reduction: glare, leans, tilts, flats, shared light, alarms, several positions, replicated.

    PYTHONPATH=src python benchmarks/xray_lab.py [PART ...] [--replicates N]

Parts: glare, lean, tilt, flats, alarms, positions, speed. Counts come from `tests/beam_generator.py`, which shares no code with
the package. Results go into `xray_lab.json`, of which the tests replay a sample. z is error over stated error.
"""

import argparse
import json
import sys
import tempfile
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "tests"))

from beam_generator import CONTRAST, PHI, PIXEL, SOLVENT, Lab, shared_light, transmissions  # noqa: E402
from position_generator import fraction_of, positions, radius_of  # noqa: E402

from spinline import xray  # noqa: E402
from spinline.base.errors import InputError, SpinlineWarning  # noqa: E402
from spinline.images import images_from_dict  # noqa: E402
from spinline.images.geometry import path_factor  # noqa: E402
from spinline.radiography.prepare import prepare  # noqa: E402
from spinline.radiography.reduce import reduce_images  # noqa: E402
from spinline.xray.frame.shared import row_shifts  # noqa: E402

OUT = HERE / "xray_lab.json"
WATER = xray.Absorber(SOLVENT, CONTRAST)
BEAM = ("radius", "axis", "amplitude", "slope")
GIVEN = {
    "counts": "a.npz",
    "flat": "a.npz",
    "dark": 0.0,
    "gain": 1.0,
    "pixel_size": "0.67 um",
    "polymer_attenuation": f"{(SOLVENT + CONTRAST) / 113.0:.8f} cm2/g",
    "solvent_attenuation": f"{SOLVENT / 100:.5f} cm2/g",
    "shells": 1,
    "block_rows": 4,
    "solution": {
        "polymer": {"name": "p", "density": "1.13 g/cm3"},
        "solvent": {"name": "s", "density": "1 g/cm3"},
        "volume_fraction": PHI,
    },
}


def summary(error, std):
    """Bias, mean stated error, rms z and 95 % coverage."""
    z = np.asarray(error) / np.asarray(std)
    return {
        "bias": float(np.mean(error)),
        "std": float(np.mean(std)),
        "rms_z": float(np.sqrt(np.mean(z**2))),
        "covers_95": float(np.mean(np.abs(z) < 1.96)),
        "n": int(z.size),
    }


def glare_replicate(share, length, seed, photons=2e6, blur=0.7):
    """30 blocks of a jet of 75 to 15 um, the fraction known in the widest four: fractions, errors, what was found."""
    rng = np.random.default_rng(seed)
    radii, pixels = np.linspace(75, 15, 30) * 1e-6, 358
    seen = transmissions(radii, pixels, Lab(blur=blur * PIXEL, tail=(share, length * PIXEL)))
    one = xray.Detector(np.full(pixels, photons), PIXEL, blur=PIXEL, tail_share=0.03, tail_length=15 * PIXEL)
    good = np.ones(pixels, dtype=bool)
    blocks = [
        xray.Block(rng.poisson(photons * t).astype(float), good, one, r, 0.0, known=PHI if i < 4 else None)
        for i, (r, t) in enumerate(zip(radii, seen, strict=True))
    ]
    prior = {"tail_length": (length * PIXEL, 0.1 * length * PIXEL)} if length > 50 else None
    unknown = ("blur", "tail_share", "tail_length", "attenuation")
    found = xray.fit_detector(blocks, WATER, unknown, shells=1, prior=prior)
    v = found.values
    detector = replace(one, blur=v["blur"], tail_share=max(v["tail_share"], 0.0), tail_length=v["tail_length"])
    scaled = WATER.along(v["attenuation"])
    covariance = found.covariance.copy()
    at = found.names.index("attenuation")
    covariance[at] /= v["attenuation"]
    covariance[:, at] /= v["attenuation"]
    mean, std = [], []
    for block in blocks:
        here = replace(block, detector=detector)
        fit = xray.fit_row(here.counts, scaled, detector, shells=1, radius=here.radius, axis=0.0)
        turn = row_shifts(fit, scaled, here, found.names, BEAM)
        mean.append(fit.mean_fraction)
        std.append(float(np.sqrt(fit.mean_fraction_std**2 + (turn @ covariance @ turn.T)[0, 0])))
    return radii, np.array(mean), np.array(std), found


def glare(replicates):
    """The fraction against the radius under glare, and what is said of the tail."""
    out = {}
    for share, length in ((0.02, 10.0), (0.05, 20.0), (0.01, 100.0)):
        runs = [glare_replicate(share, length, seed) for seed in range(replicates)]
        error = np.array([run[1] - PHI for run in runs])[:, 4:]
        std = np.array([run[2] for run in runs])[:, 4:]
        weight = (std**-2).mean(axis=0)
        radii = runs[0][0][4:]
        line = np.polyfit(radii, error.mean(axis=0), 1, w=np.sqrt(weight))
        shares = np.array([run[3].values["tail_share"] for run in runs])
        out[f"{100 * share:g} % {length:g} px"] = summary(error, std) | {
            "weighted_bias": float((weight * error.mean(axis=0)).sum() / weight.sum()),
            "slope_75_to_15_um": float(line[0] * -60e-6),
            "slope_std": _slope_std(radii, std, replicates),
            "share": float(shares.mean()),
            "share_sd": float(shares.std()),
            "share_std": float(runs[0][3].std["tail_share"]),
        }
    seen = transmissions(np.linspace(75, 15, 30) * 1e-6, 358, Lab(blur=0.5 * PIXEL, tail=(0.01, 100 * PIXEL)))
    one = xray.Detector(np.full(358, 2e6), PIXEL, blur=PIXEL, tail_share=0.03, tail_length=30 * PIXEL)
    rng, good = np.random.default_rng(1), np.ones(358, dtype=bool)
    blocks = [
        xray.Block(rng.poisson(2e6 * t).astype(float), good, one, r, 0.0, known=PHI if i < 4 else None)
        for i, (r, t) in enumerate(zip(np.linspace(75, 15, 30) * 1e-6, seen, strict=True))
    ]
    try:
        vague = xray.fit_detector(blocks, WATER, ("blur", "tail_share", "tail_length", "attenuation"), shells=1).vague
    except InputError as error:
        vague = (str(error),)
    out["1 % 100 px without a prior"] = {"vague": list(vague)}
    return out


def _slope_std(radii, std, replicates):
    """Standard deviation of the fraction's change from 75 to 15 um, statistical part."""
    columns = np.stack((np.ones_like(radii), radii), axis=1) / std.mean(axis=0)[:, None]
    return float(60e-6 * np.sqrt(np.linalg.inv(columns.T @ columns)[1, 1] / replicates))


def lean(replicates):
    """Bias of leaning jets without noise, and z with it."""
    out = {}
    for degrees in (0.0, 2.0, 4.0, 8.0, 10.0, 15.0):
        lab = Lab(lean=np.radians(degrees))
        seen = transmissions(50e-6, 340, lab, rows=60)
        flat, good = np.full(seen.shape, 1e7), np.ones(seen.shape, dtype=bool)
        zero = np.zeros(seen.shape)
        biases = {}
        for rows in (1, 6):
            frame = xray.Frame(1e7 * seen, flat, zero, good, PIXEL)
            path = xray.track_jet(frame.counts, flat, zero, good)
            fit = xray.fit_frame(frame, WATER, shells=1, block_rows=rows, track=path, lean=xray.axis_lean(path).slope)
            biases[f"bias_{rows}_rows"] = float(np.nanmean(fit.mean) - PHI)
            biases[f"radius_off_um_{rows}_rows"] = float(np.nanmean(fit.values["radius"]) - 50e-6) * 1e6
        error, std = [], []
        for seed in range(max(replicates // 10, 2)):
            frame = xray.Frame(
                np.random.default_rng(seed).poisson(1e6 * seen).astype(float), 0.1 * flat, zero, good, PIXEL
            )
            path = xray.track_jet(frame.counts, frame.flat, zero, good)
            fit = xray.fit_frame(frame, WATER, shells=1, block_rows=2, track=path, lean=xray.axis_lean(path).slope)
            error.append(fit.mean - PHI)
            std.append(fit.mean_std)
        out[f"{degrees:g} deg"] = biases | summary(error, std)
    return out


def tilt(replicates):
    """Coverage of tilts and depths drawn from what is said of them, and at tilts held.

    An interval of 95 % is one for tilts drawn from what is said: "0 +/- 4 deg" must hold tilts of up to 7.8 degrees. At a tilt
    held it covers always or never, but for the noise; the average over the tilts drawn is what is 95 %.
    """
    cases = {
        "tilt_out 0 +/- 4 deg": ({"tilt_out": "0 +/- 4 deg"}, lambda r: (np.radians(4) * r.normal(), 1.0)),
        "tilt_out 3 +/- 2 deg": ({"tilt_out": "3 +/- 2 deg"}, lambda r: (np.radians(3 + 2 * r.normal()), 1.0)),
        "depth 1 +/- 0.01": ({"depth": "1 +/- 0.01"}, lambda r: (0.0, 1 + 0.01 * r.normal())),
        "both": (
            {"tilt_out": "0 +/- 4 deg", "depth": "1 +/- 0.01"},
            lambda r: (np.radians(4) * r.normal(), 1 + 0.01 * r.normal()),
        ),
        **{
            f"tilt_out {held} deg, given as 0 +/- 4 deg": (
                {"tilt_out": "0 +/- 4 deg"},
                lambda r, held=held: (np.radians(held), 1.0),
            )
            for held in (0, 2, 4, 6, 8, 10)
        },
    }
    out = {}
    detector = xray.Detector(np.full(220, 1e7), PIXEL)
    for name, (keys, draw) in cases.items():
        factor, errors = path_factor(images_from_dict({**GIVEN, **keys}))
        scaled = WATER.along(factor)
        relative = float(np.sqrt(sum(value**2 for value in errors.values())))
        error, std = [], []
        for seed in range(replicates):
            rng = np.random.default_rng(seed)
            turn, depth = draw(rng)
            seen = transmissions(50e-6, 220, Lab(tilt_out=turn, depth=depth), over=4, pad=20)[0]
            fit = xray.fit_row(rng.poisson(1e7 * seen), scaled, detector, shells=1)
            mu = scaled.solvent + scaled.contrast * fit.mean_fraction
            error.append(fit.mean_fraction - PHI)
            std.append(np.hypot(fit.mean_fraction_std, mu / scaled.contrast * relative))
        out[name] = summary(error, std)
    return out


def _reduced(counts, flat, **keys):
    with tempfile.TemporaryDirectory() as folder:
        np.savez(Path(folder) / "a.npz", counts=counts, flat=flat)
        return reduce_images(images_from_dict({**GIVEN, **keys}, folder=Path(folder)))


def flats_replicate(name, seed, rows=24, pixels=300, photons=1e7):
    """One image of a jet of 50 um with one fact of the lab in it."""
    rng = np.random.default_rng(seed)
    lab, keys, gain, flats = Lab(), {}, 1.0, 20
    beam = np.ones((rows, pixels))
    if name.startswith("bend"):
        lab = Lab(bend=1e-3)
        keys = {"flat_shape": 2} if name.endswith("given") else {}
    elif name == "drift 1 %":
        lab = Lab(amplitude=1 + 0.01 * rng.normal(), slope=0.01 * rng.normal())
    elif name == "hot pixels":
        beam = 1 + 0.03 * (rng.uniform(size=beam.shape) < 0.002)
    seen = np.tile(transmissions(50e-6, pixels, lab), (rows, 1))
    if name.startswith("shared"):
        blur = float(name.split()[1])
        lab = Lab(blur=blur * PIXEL)
        seen = np.tile(transmissions(50e-6, pixels, lab), (rows, 1))
        gain, keys = 10.0, {"gain": None}
        sharp = np.tile(transmissions(50e-6, pixels, Lab()), (rows, 1))
        counts = [shared_light(photons / 4 * sharp, blur, [seed, i]) / gain for i in range(4)]
        flat = [shared_light(np.full(beam.shape, photons / 4), blur, [seed, 100 + i]) / gain for i in range(60)]
        given = {key: value for key, value in {**GIVEN, **keys}.items() if value is not None}
        with tempfile.TemporaryDirectory() as folder:
            np.savez(Path(folder) / "a.npz", counts=np.array(counts), flat=np.array(flat))
            return reduce_images(images_from_dict(given, folder=Path(folder)))
    if name.startswith("averaged"):
        flat = rng.poisson(photons, (3, 22, rows, pixels)).mean(axis=1)
        keys = {"flat_frames": 22} if name.endswith("given") else {}
    else:
        flat = rng.poisson(photons, (flats, rows, pixels)).astype(float)
    counts = rng.poisson(photons * beam * seen).astype(float)
    if name.startswith("non-linear"):
        counts, flat = (a * (1 - 0.01 * a / photons) for a in (counts, flat))
        keys = {"linearity": "0.01"} if name.endswith("given") else {}
    return _reduced(counts[None], flat, **keys)


FLATS = (
    "plain",
    "bend 0.1 %",
    "bend 0.1 %, given",
    "drift 1 %",
    "hot pixels",
    "shared 0.8 px",
    "shared 1.2 px",
    "averaged 22",
    "averaged 22, given",
    "non-linear 1 %, given",
)


def flats(replicates):
    """Flats, drift, noise that pixels share, averages, a detector that is not linear, hot pixels."""
    out = {}
    for name in FLATS:
        error, std, said = [], [], set()
        for seed in range(replicates):
            result = flats_replicate(name, 1000 * (FLATS.index(name) + 1) + seed)
            error.append(result["mean_polymer_fraction"].values - PHI)
            std.append(result["mean_polymer_fraction_std"].values)
            said |= {line.split(":")[0][:60] for line in str(result.attrs["warnings"]).splitlines()}
        out[name] = summary(error, std) | {"gain": str(result.attrs["gain_source"]), "said": sorted(said)}
    return out


ALARMS = ("blur given", "blur fitted", "blur undeclared", "stripes", "neighbour", "true", "true, blurred")


def alarm_replicate(kind, seed, photons=1e7, rows=24, pixels=220):
    """Significance of fringes in one image; infinite where it is refused for them."""
    rng = np.random.default_rng(seed)
    medium = xray.solution_medium(xray.Material("C2H4O", 1130.0), xray.Material("water", 998.2), 10.0)
    blur = rng.uniform(0, 4e-6) if kind.startswith("blur") else rng.uniform(0, 1.5e-6)
    lab = Lab(
        blur=blur,
        axis=1e-6 * rng.normal(),
        solvent=float(medium.solvent[0] - medium.air[0]),
        contrast=float(medium.contrast[0]),
    )
    flat = np.ones((rows, pixels))
    if kind.startswith("true"):
        blur = rng.uniform(0.1e-6, 1.0e-6) if kind == "true, blurred" else 0.0
        distance = float(rng.choice([0.01, 0.02, 0.05, 0.1, 0.2]))
        one = xray.Detector(np.ones(pixels), PIXEL, blur=blur)
        seen = xray.fresnel_counts(xray.RoundJet(np.array([PHI]), 50e-6, lab.axis), medium, one, distance)
    else:
        seen = transmissions(50e-6, pixels, lab)[0]
    if kind == "stripes":
        flat = flat * (1 + 2e-4 * rng.normal(size=(1, pixels)))
    if kind == "neighbour":
        seen = seen * transmissions(2e-6, pixels, replace(lab, axis=rng.choice([-1, 1]) * 66e-6))[0]
    keys = {
        **{k: v for k, v in GIVEN.items() if not k.endswith("attenuation")},
        "energy": "10 keV",
        "shells": 3,
        "solution": {"polymer": "PEO", "solvent": "water", "volume_fraction": PHI},
    }
    if kind == "blur given":
        keys["blur"] = f"{1e6 * blur + 1e-3:.6f} um"
    if kind == "blur fitted":
        keys["blur"] = "fit"
    with tempfile.TemporaryDirectory() as folder:
        np.savez(
            Path(folder) / "a.npz",
            counts=rng.poisson(photons * np.tile(seen, (rows, 1))),
            flat=rng.poisson(photons * flat, (20, rows, pixels)),
        )
        try:
            experiment, *_ = prepare(images_from_dict(keys, folder=Path(folder)))
        except InputError as error:
            if "ringes" in str(error):
                return np.inf
            raise
    return experiment.fringes


def alarms(replicates):
    """False and true alarms of fringes."""
    out = {}
    for kind in ALARMS:
        seen = np.array([alarm_replicate(kind, seed) for seed in range(replicates)])
        finite = seen[np.isfinite(seen)]
        out[kind] = {
            "alarms": int((seen >= 5).sum()),
            "of": replicates,
            "largest": float(finite.max()) if finite.size else None,
            "smallest": float(seen.min()),
        }
    return out


def positions_replicate(seed, count=10, method="map"):
    """Ten overlapping positions: error and stated error of the mean fraction and radius, and the seams."""
    with tempfile.TemporaryDirectory() as folder:
        data = positions(Path(folder), count=count, rows=36, pixels=260, overlap=12, seed=seed, keys={"method": method})
        result = reduce_images(images_from_dict(data, folder=Path(folder)))
    z = result["z"].values
    return (
        result["mean_polymer_fraction"].values - fraction_of(z),
        result["mean_polymer_fraction_std"].values,
        result["jet_radius"].values - radius_of(z),
        result["jet_radius_std"].values,
        result["seam_chi_squared"].values,
        result["seam_blocks"].values,
    )


def several(replicates):
    """One map of ten positions, replicated."""
    from scipy.stats import chi2

    runs = []
    for seed in range(replicates):
        runs.append(positions_replicate(seed))
    chi, blocks = (np.concatenate([run[i] for run in runs]) for i in (4, 5))
    return {
        "fraction": summary(np.concatenate([r[0] for r in runs]), np.concatenate([r[1] for r in runs])),
        "radius": summary(np.concatenate([r[2] for r in runs]), np.concatenate([r[3] for r in runs])),
        "seams_probability": float(chi2.sf(chi.sum(), blocks.sum())),
        "seams": int(chi.size),
        "seams_chi_squared": float(chi.sum()),
        "seam_blocks": float(blocks.sum()),
    }


def speed(replicates):
    """Price of a row and of a map, with and without a tail, in one run: 300 rows of 220 pixels."""
    rng = np.random.default_rng(0)
    radii = np.linspace(50e-6, 40e-6, 300)
    seen = np.repeat(transmissions(radii[::10], 220), 10, axis=0)
    counts = rng.poisson(1e6 * seen).astype(float)
    flat, zero, good = np.full(counts.shape, 1e6), np.zeros(counts.shape), np.ones(counts.shape, dtype=bool)
    plain = xray.Frame(counts, flat, zero, good, PIXEL, blur=0.5 * PIXEL)
    tailed = replace(plain, tail_share=0.02, tail_length=10 * PIXEL)
    path = xray.track_jet(counts, flat, zero, good)
    slope = xray.axis_lean(path).slope
    jobs = {
        "row": lambda: xray.fit_frame(plain, WATER, shells=3, track=path),
        "row with tail, lean": lambda: xray.fit_frame(tailed, WATER, shells=3, track=path, lean=slope),
        "map": lambda: xray.fit_map(counts, WATER, plain.detector(flat[0], zero[0])),
        "map with tail, lean": lambda: xray.fit_map(
            counts, WATER, tailed.detector(flat[0], zero[0]), path=1 / np.hypot(1, slope)
        ),
    }
    took: dict[str, list[float]] = {name: [] for name in jobs}
    for job in jobs.values():
        job()
    for _ in range(5):
        for name, job in jobs.items():
            start = time.perf_counter()
            job()
            took[name].append((time.perf_counter() - start) / 300)
    best = {name: min(times) for name, times in took.items()}
    return {
        "ms_a_row": {name: 1e3 * value for name, value in best.items()},
        "row_ratio": best["row with tail, lean"] / best["row"],
        "map_ratio": best["map with tail, lean"] / best["map"],
    }


PARTS = {
    "glare": glare,
    "lean": lean,
    "tilt": tilt,
    "flats": flats,
    "alarms": alarms,
    "positions": several,
    "speed": speed,
}


def main() -> None:
    """Run what is asked for, and keep it beside what was there."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", default=list(PARTS), choices=list(PARTS))
    parser.add_argument("--replicates", type=int, default=100)
    asked = parser.parse_args()
    warnings.simplefilter("ignore", SpinlineWarning)
    kept = json.loads(OUT.read_text(encoding="utf-8")) if OUT.exists() else {}
    for part in asked.parts:
        start = time.perf_counter()
        found = PARTS[part](asked.replicates)
        kept[part] = {"replicates": asked.replicates, "results": found}
        OUT.write_text(json.dumps(kept, indent=1, allow_nan=False, default=float) + "\n", encoding="utf-8")
        print(part, round(time.perf_counter() - start), "s")
        print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
