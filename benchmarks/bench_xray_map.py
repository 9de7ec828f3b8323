"""The map against row-by-row Abel inversion, its error bars over replicates, and its cost.

Run: ``python benchmarks/bench_xray_map.py [abel|errors|family|cost] [--replicates 1000] [--kind smooth]``, everything
when nothing is named; `abel` needs PyAbel. Phantoms: a jet of PEO in water at 10 keV, 300 rows of 0.67 um pixels, radius
falling from 100 to 40 um, polymer fraction rising first in the core, then at the rim ("smooth": rises as wide as half the
radius and a third of the length; "sharp": the rim a skin of r^6, within a tenth of the length). `family` takes others, in
100 rows: those that the smoothing was chosen on ("chosen on"), and those that it was judged on afterwards and nothing was
changed for ("judged on"). They come from Gauss quadrature along chords at 16 places in each pixel and share no code with
the package.
"""

import argparse
import time
from collections.abc import Callable

import numpy as np
from scipy.ndimage import gaussian_filter1d

from spinline import xray

PIXEL = 0.67e-6
SOLUTION = xray.Absorber(531.9, -137.44, 0.6)
NODES, SHARES = np.polynomial.legendre.leggauss(40)
ROWS, PIXELS = 300, 361
SHELLS = np.linspace(0, 1, 11)
Profile = Callable[[np.ndarray, float], np.ndarray]


def rise(x: float) -> float:
    return 1 / (1 + np.exp(-x))


def smooth(r: np.ndarray, z: float) -> np.ndarray:
    core = 0.03 * rise((z - 0.3) / 0.12) * np.exp(-((r / 0.6) ** 2))
    return 0.05 + core + 0.05 * rise((z - 0.6) / 0.15) * r**2


def sharp(r: np.ndarray, z: float) -> np.ndarray:
    core = 0.04 * rise((z - 0.3) / 0.08) * np.exp(-((r / 0.45) ** 2))
    return 0.05 + core + 0.05 * rise((z - 0.65) / 0.1) * r**6


PROFILES = {"smooth": smooth, "sharp": sharp}
CHOSEN_ON: dict[str, Profile] = {
    "flat": lambda r, z: 0.05 + 0 * r,
    "line": lambda r, z: 0.05 + 0.05 * z + 0 * r,
    "parabola": lambda r, z: 0.05 + 0.06 * z * (1 - r**2),
    "tapered": lambda r, z: 0.05 + 0.1 * z**2 * (0.4 + 0.6 * r**2),
    "quartic": lambda r, z: 0.05 + 0.06 * rise((z - 0.5) / 0.15) * r**4,
    "thin skin": lambda r, z: 0.05 + 0.06 * rise((z - 0.5) / 0.12) * r**12,
    "core": lambda r, z: 0.05 + 0.05 * rise((z - 0.4) / 0.1) * np.exp(-((r / 0.35) ** 2)),
    "wave": lambda r, z: 0.06 + 0.02 * np.sin(7 * z) * np.cos(2.5 * r),
}
JUDGED_ON: dict[str, Profile] = {
    **PROFILES,
    "front": lambda r, z: 0.05 + 0.05 * rise((z - 0.5) / 0.12) * rise((r - 0.55) / 0.12),
    "skin": lambda r, z: 0.05 + 0.07 * z**1.5 * r**8,
    "ring": lambda r, z: 0.05 + 0.04 * rise((z - 0.4) / 0.15) * np.exp(-(((r - 0.6) / 0.25) ** 2)),
    "wane": lambda r, z: 0.08 - 0.04 * np.exp(-3 * z) * (1 - 0.5 * r**2),
    "bead": lambda r, z: 0.06 + 0.015 * np.cos(9 * z) * (1 - r**2) ** 2,
}


def phantom(
    profile: Profile, rows: int = ROWS, drift: bool = True, last: float = 1.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Heights in [0, 1], radius, axis and transmission of each row; the beam's drift is in the transmission."""
    heights = np.linspace(0, last, rows)
    radius = 100e-6 / np.sqrt(1 + 5.25 * heights)
    axis = drift * PIXEL * (3 + 2 * np.sin(3 * heights))
    level = 1 + drift * (0.005 + 0.003 * np.cos(4 * heights))
    slope = drift * (0.005 + 0.002 * heights)
    u = np.linspace(-1, 1, PIXELS)
    out = np.empty((rows, PIXELS))
    for i, z in enumerate(heights):
        x = (np.arange(PIXELS * 16) + 0.5) * PIXEL / 16 - PIXEL * PIXELS / 2 - axis[i]
        half = np.sqrt(np.maximum(radius[i] ** 2 - x**2, 0))[:, None]
        r = np.hypot(x[:, None], 0.5 * (1 + NODES) * half) / radius[i]
        depth = half[:, 0] * ((531.9 - 0.6 - 137.44 * profile(r, z)) @ SHARES)
        out[i] = np.exp(-depth).reshape(PIXELS, 16).mean(axis=1) * level[i] * (1 + slope[i] * u)
    return heights, radius, axis, out


def truth(profile: Profile, heights: np.ndarray, edges: np.ndarray = SHELLS) -> np.ndarray:
    """Means over shells, shape (rows, shells)."""
    half = 0.5 * np.diff(edges)[:, None]
    r = edges[:-1, None] + half * (1 + NODES)
    share = half * SHARES * 2 * r / np.diff(edges**2)[:, None]
    return np.array([(share * profile(r, z)).sum(axis=1) for z in heights])


def abel_profiles(lines: np.ndarray) -> dict[str, np.ndarray]:
    """Attenuation at r = 0, 1, 2, ... pixels by every method of PyAbel that takes rows (rbasex, linbasex: images only)."""
    import abel

    out = {
        "direct": abel.direct.direct_transform(lines, verbose=False),
        "hansenlaw": abel.hansenlaw.hansenlaw_transform(lines, direction="inverse"),
        "onion_bordas": abel.onion_bordas.onion_bordas_transform(lines),
        "two_point": abel.dasch.two_point_transform(lines, basis_dir=None),
        "three_point": abel.dasch.three_point_transform(lines, basis_dir=None),
        "onion_peeling": abel.dasch.onion_peeling_transform(lines, basis_dir=None),
    }
    for strength in (0, 1, 10, 100, 1000):
        out[f"basex, reg {strength}"] = abel.basex.basex_transform(lines, reg=strength, basis_dir=None, verbose=False)
        for order in ("diff", "L2"):
            name = f"daun, {order} {strength}"
            out[name] = abel.daun.daun_transform(lines, reg=(order, strength), degree=1, basis_dir=None, verbose=False)
    return {name: value / PIXEL for name, value in out.items()}


def in_shells(profile: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Profiles at whole pixels, shape (rows, pixels), to area means over shells."""
    out = np.empty((len(radius), SHELLS.size - 1))
    for i, r in enumerate(radius / PIXEL):
        fine = (np.arange(2000) + 0.5) / 2000
        value = np.interp(fine * r, np.arange(profile.shape[1]), profile[i])
        shell = np.minimum((fine * 10).astype(int), 9)
        out[i] = np.bincount(shell, value * fine) / np.bincount(shell, fine)
    return out


def compare_with_abel(replicates: int) -> None:
    print(
        "RMSE of phi in 10 shells of all rows (and, in brackets, weighted by their areas); PyAbel knows axis, radius and beam"
    )
    area = np.diff(SHELLS**2)

    def error(found: np.ndarray, true: np.ndarray) -> tuple[float, float]:
        square = (found - true) ** 2
        return float(square.mean()), float((square @ area).mean())

    for kind, profile in PROFILES.items():
        heights, radius, _, mean = phantom(profile, drift=False)
        true = truth(profile, heights)
        middle = PIXELS // 2
        for photons in (1e5, 1e7):
            errors: dict[str, list[tuple[float, float]]] = {}
            for seed in range(replicates):
                counts = xray.noisy_counts(photons * mean, 21, seed)
                fit = xray.fit_map(counts, SOLUTION, xray.Detector(np.full(PIXELS, photons), PIXEL))
                errors.setdefault("map", []).append(error(fit.fraction, true))
                line = -np.log(counts / photons)
                both = 0.5 * (line[:, middle:] + line[:, middle::-1])
                for name, mu in abel_profiles(both).items():
                    phi = (mu - (531.9 - 0.6)) / -137.44
                    errors.setdefault(name, []).append(error(in_shells(phi, radius), true))
            rms = {name: np.sqrt(np.mean(e, axis=0)) for name, e in errors.items()}
            ours = rms.pop("map")
            print(f"{kind}, {photons:g} photons per pixel, {replicates} replicates: map {ours[0]:.4f} ({ours[1]:.4f})")
            for name, value in sorted(rms.items(), key=lambda item: item[1][0]):
                print(
                    f"    {name:18s} {value[0]:.4f} ({value[1]:.4f}), ratio {value[0] / ours[0]:.1f} ({value[1] / ours[1]:.1f})"
                )


def check_errors(replicates: int, profiles: dict[str, Profile], rows: int = ROWS) -> None:
    print(
        "error bars, over all rows (and 10 shells): root mean square z, share within 1.96, bias in standard deviations"
    )
    for kind, profile in profiles.items():
        heights, radius, axis, mean = phantom(profile, rows)
        true = truth(profile, heights)
        average = true @ np.diff(SHELLS**2)
        for photons in (1e5, 1e7):
            detector = xray.Detector(np.full(PIXELS, photons), PIXEL)
            z: dict[str, list[np.ndarray]] = {}
            misfit = []
            for seed in range(replicates):
                fit = xray.fit_map(xray.noisy_counts(photons * mean, 33, seed), SOLUTION, detector)
                assert fit.converged
                misfit.append(fit.misfit)
                for name, value, real, std in (
                    ("fraction", fit.fraction, true, fit.fraction_std),
                    ("mean fraction", fit.mean_fraction, average, fit.mean_fraction_std),
                    ("radius", fit.radius, radius, fit.radius_std),
                    ("axis", fit.axis, axis, fit.axis_std),
                ):
                    z.setdefault(name, []).append((value - real) / std)
            print(
                f"{kind}, {photons:g} photons, {replicates} replicates; misfit {np.mean(misfit):+.2f} +- {np.std(misfit):.2f}"
            )
            for name, values in z.items():
                all_z = np.array(values)
                rms, inside = np.sqrt((all_z**2).mean()), (np.abs(all_z) < 1.96).mean()
                print(f"    {name:14s} {rms:.3f} {100 * inside:.1f} % {all_z.mean():+.3f}", flush=True)


def check_family(replicates: int) -> None:
    for name, profiles in (("chosen on", CHOSEN_ON), ("judged on", JUDGED_ON)):
        print(name)
        check_errors(replicates, profiles, 100)


def measure_cost() -> None:
    print("cost: ms per row of process time (wall), best of 3")
    for rows, blur in ((1, 0.0), (10, 0.0), (100, 0.0), (300, 0.0), (300, 1.2e-6), (1000, 0.0), (10_000, 0.0)):
        mean = phantom(smooth, min(rows, 1000), last=min(rows / ROWS, 1.0))[3]
        if blur:
            mean = gaussian_filter1d(mean, blur / PIXEL, axis=1)
        counts = xray.noisy_counts(1e7 * np.repeat(mean, max(rows // 1000, 1), axis=0), 5)
        detector = xray.Detector(np.full(PIXELS, 1e7), PIXEL, blur=blur)
        best = [np.inf, np.inf]
        for _ in range(3):
            start = time.process_time(), time.perf_counter()
            fit = xray.fit_map(counts, SOLUTION, detector)
            taken = time.process_time() - start[0], time.perf_counter() - start[1]
            best = [min(a, b) for a, b in zip(best, taken, strict=True)]
        per = [1e3 * t / rows for t in best]
        print(f"    {rows:6d} rows, blur {blur * 1e6:.1f} um: {per[0]:.3f} ({per[1]:.3f}), {fit.iterations} turns")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", nargs="*", choices=["abel", "errors", "family", "cost", []])
    parser.add_argument("--replicates", type=int, default=1000)
    parser.add_argument("--kind", choices=PROFILES, help="of `errors`; all when left out")
    given = parser.parse_args()
    jobs = {
        "cost": measure_cost,
        "abel": lambda: compare_with_abel(min(given.replicates, 10)),
        "errors": lambda: check_errors(
            given.replicates, {k: p for k, p in PROFILES.items() if given.kind in (None, k)}
        ),
        "family": lambda: check_family(min(given.replicates, 50)),
    }
    for name, job in jobs.items():
        if not given.what or name in given.what:
            job()
