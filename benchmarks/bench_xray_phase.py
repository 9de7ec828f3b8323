"""Fringes, spectra and the 8 keV scans: what each neglect costs, what each remedy leaves, at which price.

    python benchmarks/bench_xray_phase.py [bias] [profiles] [scatter] [smooth] [taper] [matrix] [quiet] [alarms] [spectra]
        [scans] [speed]

Everything where no part is named. PEO in water, phi = 0.05, 10 keV, 0.67 um pixels unless said.
"""

import itertools
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

from spinline import xray
from spinline.base.errors import InputError

PIXEL = 0.67e-6
WATER = xray.solution_medium("PEO", "water", 10.0)
NUISANCES = ("radius", "axis", "amplitude", "slope")
PHI = np.array([0.05])
SHAPES = {
    "uniform": lambda r: np.ones_like(r),
    "parabola, rim a tenth of the centre": lambda r: 1 - 0.9 * r**2,
    "parabola, centre a tenth of the rim": lambda r: 0.1 + 0.9 * r**2,
    "linear, rim a tenth of the centre": lambda r: 1 - 0.9 * r,
    "skin, 0.5 + 2 (r/R)^12": lambda r: 0.5 + 2 * r**12,
    "thin skin, 0.7 + 3 (r/R)^40": lambda r: 0.7 + 3 * r**40,
    "core, 0.1 + exp(-(r/0.4 R)^2)": lambda r: 0.1 + np.exp(-((r / 0.4) ** 2)),
}
_ROOTS = np.sqrt((np.arange(20000) + 0.5) / 20000)


def quadrature(radius, distance, pixels, axis, per_pixel=None, shape=None, blur=0.0, medium=WATER, line=0):
    """Counts per photon by Gauss-Legendre of the diffraction integral: nothing of the package but the medium.

    `shape` gives the fraction over r/R, scaled to a mean of 0.05; the blur is the integral of the Gaussian over each pixel.
    """
    m = medium
    wave = m.wavelength[line]
    base = 0.5 * (m.solvent - m.air)[line] + 2j * np.pi * (m.delta_solvent - m.delta_air)[line] / wave
    rate = 0.5 * m.contrast[line] + 2j * np.pi * m.delta_contrast[line] / wave
    if blur:
        pad = int(np.ceil(6 * blur / PIXEL))
        fine = 20
        seen = quadrature_points(radius, distance, pixels + 2 * pad, axis, fine, shape, base, rate, wave)
        from scipy.special import erf

        x = PIXEL / fine * (np.arange(seen.size) - 0.5 * (seen.size - 1))
        ends = (PIXEL * (np.arange(pixels + 1) - 0.5 * pixels)[:, None] - x) / blur / np.sqrt(2)
        return 1 + 0.5 * np.diff(erf(ends), axis=0) @ (seen - 1) / fine
    nodes = int(max(1500, 3 * 4 * radius**2 / (wave * distance)))
    per_pixel = per_pixel or int(max(10, 3 * PIXEL * 2 * radius / (wave * distance)))
    t, w = np.polynomial.legendre.leggauss(50)
    panels = np.linspace(-np.pi / 2, np.pi / 2, nodes // 50 + 1)
    half = 0.5 * np.diff(panels)[:, None]
    angle = (0.5 * (panels[1:] + panels[:-1])[:, None] + half * t).ravel()
    source = axis + radius * np.sin(angle)
    strength = (np.exp(-depths(shape, radius, angle, base, rate)) - 1) * (half * w).ravel() * radius * np.cos(angle)
    g, v = np.polynomial.legendre.leggauss(per_pixel)
    seen = np.empty(pixels)
    for i, x in enumerate(PIXEL * (np.arange(pixels) - 0.5 * (pixels - 1))):
        phase = np.pi * (x + 0.5 * PIXEL * g[:, None] - source) ** 2 / (wave * distance)
        u = 1 + np.exp(-0.25j * np.pi) / np.sqrt(wave * distance) * (np.exp(1j * phase) @ strength)
        seen[i] = 0.5 * v @ np.abs(u) ** 2
    return seen


def quadrature_points(radius, distance, pixels, axis, fine, shape, base, rate, wave):
    """The same at `fine` points a pixel."""
    t, w = np.polynomial.legendre.leggauss(50)
    panels = np.linspace(-np.pi / 2, np.pi / 2, int(max(3000, 3 * 4 * radius**2 / (wave * distance))) // 50 + 1)
    half = 0.5 * np.diff(panels)[:, None]
    angle = (0.5 * (panels[1:] + panels[:-1])[:, None] + half * t).ravel()
    strength = (np.exp(-depths(shape, radius, angle, base, rate)) - 1) * (half * w).ravel() * radius * np.cos(angle)
    source = axis + radius * np.sin(angle)
    x = PIXEL / fine * (np.arange(pixels * fine) - 0.5 * (pixels * fine - 1))
    seen = np.empty(x.size)
    for i in range(0, x.size, 50):
        phase = np.pi * (x[i : i + 50, None] - source) ** 2 / (wave * distance)
        u = 1 + np.exp(-0.25j * np.pi) / np.sqrt(wave * distance) * (np.exp(1j * phase) @ strength)
        seen[i : i + 50] = np.abs(u) ** 2
    return seen


def depths(shape, radius, angle, base, rate):
    """What the wave meets on the chord at R sin(angle)."""
    height = np.cos(angle)
    if shape is None:
        return 2 * radius * height * (base + 0.05 * rate)
    g, v = np.polynomial.legendre.leggauss(40)
    y = np.concatenate([(k + 0.5 * (1 + g)) / 4 for k in range(4)])
    fraction = shape(np.hypot(np.sin(angle)[:, None], height[:, None] * y)) @ np.tile(v / 8, 4)
    return 2 * radius * height * (base + 0.05 / shape(_ROOTS).mean() * fraction * rate)


def profiles(distances=(0.01, 0.1, 0.2), shapes=tuple(SHAPES)) -> None:
    """Bias of the mean where the jet is no staircase: 0.05 of each shape, noise-free counts of 1e7 photons."""
    print("bias of the mean fraction, R = 50 um, 1e7 photons, phantoms by quadrature; +/- error given, [misfit]")
    detectors = {b: xray.Detector(np.full(224, 1e7), PIXEL, blur=b) for b in (0.0, 1.2e-6)}
    free = (*NUISANCES, "distance")
    ways = {
        "uniform": {"profile": "shells", "nuisances": free},
        "three shells": {"profile": "shells", "shells": 3, "nuisances": free},
        "smooth": {"nuisances": free},
        "smooth, refraction free": {"nuisances": (*free, "refraction")},
    }
    for z, blur in itertools.product(distances, detectors):
        for name, shape in ((name, SHAPES[name]) for name in shapes):
            seen = 1e7 * quadrature(50e-6, z, 224, 2e-6, shape=shape, blur=blur)
            said = []
            for way, options in ways.items():
                fit = xray.fit_row_phase(seen, WATER, detectors[blur], z, **options)
                said.append(f"{way} {fit.mean_fraction - 0.05:+.4f} +/- {fit.mean_fraction_std:.4f} [{fit.misfit:.0f}]")
            print(f"  {100 * z:3.0f} cm, blur {1e6 * blur:.1f} um, {name}: " + ", ".join(said), flush=True)


def smooth(replicates: int = 60) -> None:
    """Coverage of continuous profiles, with the refraction free as `reduce` has it, on noisy phantoms by quadrature."""
    print(f"coverage, {replicates} replicates each: bias, its error, sd over the error given, 95 % intervals that hold")
    free = (*NUISANCES, "distance", "refraction")
    scores = []
    for case, (photons, name) in enumerate(itertools.product((1e5, 1e6, 1e7), list(SHAPES)[:5])):
        detector = xray.Detector(np.full(224, photons), PIXEL)
        mean = photons * quadrature(50e-6, 0.1, 224, 2e-6, shape=SHAPES[name])
        fits = [
            xray.fit_row_phase(xray.noisy_counts(mean, 100 + case, i), WATER, detector, 0.1, nuisances=free)
            for i in range(replicates)
        ]
        found = np.array([f.mean_fraction for f in fits])
        z = (found - 0.05) / np.array([f.mean_fraction_std for f in fits])
        scores.extend(z)
        print(
            f"  {photons:.0e}, {name}: {found.mean() - 0.05:+.4f} +/- {found.std() / np.sqrt(replicates):.4f}, {z.std():.3f}, "
            f"{100 * np.mean(np.abs(z) < 1.96):.1f} %, not converged {sum(not f.converged for f in fits)}",
            flush=True,
        )
    z = np.array(scores)
    print(f"  all: sd of the scores {z.std():.3f}, {100 * np.mean(np.abs(z) < 1.96):.1f} % of {z.size}")


def tapered(distance, photons, taper, blur, rows=40, lean=0.0, height=6):
    """A noisy frame of a jet that narrows by `taper` pixels a row, each row the mean of `height` sections of it."""
    at = np.arange(rows * height) / height + 0.5 / height - 0.5 * rows
    radius, axis = 50e-6 - taper * PIXEL * at, 1e-6 + lean * PIXEL * at
    detector = xray.Detector(np.ones(224), PIXEL, blur=blur)
    image = np.array(
        [
            xray.fresnel_counts(xray.RoundJet(PHI, r, a), WATER, detector, distance)
            for r, a in zip(radius, axis, strict=True)
        ]
    )
    image = image.reshape(rows, height, -1).mean(axis=1)
    counts = np.random.default_rng(3).poisson(photons * image).astype(float)
    shape = counts.shape
    return counts, np.full(shape, photons), radius.reshape(rows, height).mean(axis=1)


def taper() -> None:
    """Blocks of ten rows of a jet that narrows and leans, each section its own wave."""
    from spinline.xray.frame import Frame, fit_frame
    from spinline.xray.phase.frame import fit_frame_phase, track_fringes

    print(
        "blocks of 10 rows at 1e6 photons a row: scores of the mean, misfit, radius off; taper left out, and modelled"
    )
    for z, pixels, blur, lean in (
        (0.1, 0.1, 0.0, 0.0),
        (0.1, 0.05, 1.2e-6, 0.03),
        (0.05, 0.03, 0.5e-6, 0.0),
        (0.01, 0.05, 0.0, 0.0),
    ):
        counts, flat, radius = tapered(z, 1e6, pixels, blur, lean=lean)
        frame = Frame(counts, flat, 0 * flat, np.ones(flat.shape, bool), PIXEL, blur)
        track = track_fringes(frame, WATER, z)
        law = xray.phase_law(WATER, z)
        for name, fit in (
            ("left out", fit_frame(frame, WATER.absorber, shells=1, block_rows=10, track=track, one=law)),
            ("modelled", fit_frame_phase(frame, WATER, z, shells=1, block_rows=10, track=track)),
        ):
            off = 1e9 * (fit.values["radius"] - radius.reshape(-1, 10).mean(axis=1))
            print(
                f"  {100 * z:.0f} cm, {pixels:g} pixels a row, blur {1e6 * blur:.1f} um, {name}: scores "
                f"{np.round((fit.mean - 0.05) / fit.mean_std, 1)}, misfit {np.round(fit.misfit, 1)}, {np.round(off, 1)} nm",
                flush=True,
            )


def reduced(folder, counts, photons, **keys):
    """What `reduce` makes of a frame: "refused", "flagged", or "silent"; and the significance."""
    from spinline.base.errors import SpinlineWarning
    from spinline.images import images_from_dict
    from spinline.radiography.reduce import reduce_images

    rng = np.random.default_rng(5)
    np.savez(
        folder / "a.npz",
        counts=counts,
        dark=np.zeros(counts.shape[1:]),
        flat=rng.poisson(photons, (40, *counts.shape[1:])).astype(float),
    )
    file = {
        "counts": "a.npz",
        "flat": "a.npz",
        "dark": "a.npz",
        "gain": 1.0,
        "pixel_size": "0.67 um",
        "energy": "10 keV",
        "shells": 1,
        "solution": {"polymer": "PEO", "solvent": "water", "volume_fraction": 0.05},
        **keys,
    }
    try:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always", SpinlineWarning)
            result = reduce_images(images_from_dict(file, folder=folder), noisy=True)
    except InputError as error:
        return (
            f"refused ({error.field}: {error.problem[:40]})"
            if "fringes" in error.problem
            else f"stopped ({error.field})",
            np.nan,
        )
    masks, names = result["flags"].attrs["flag_masks"], result["flags"].attrs["flag_meanings"].split()
    bit = masks[names.index("fringes")]
    flagged = bool((result["flags"].values & bit > 0).all())
    words = any("fringes" in str(w.message).lower() and "standard deviations" in str(w.message) for w in said)
    whole = flagged and words and "meets Fresnel fringes" in result.attrs["fringes"]
    return "flagged" if whole else "silent", float(result["fringe_significance"])


def matrix(methods=("chord", "row", "map"), distances=(0.01, 0.1, 0.2)) -> None:
    """Fringed frames of 8 rows reduced as absorption: every one has to be refused or flagged."""
    tally, missed = {}, []
    cases = itertools.product(
        methods,
        distances,
        (1e3, 1e4, 1e5, 1e6, 1e7),
        ((0.0, None), (1.2e-6, "1.2 um"), (1.2e-6, None)),
        (None, True),
    )
    with tempfile.TemporaryDirectory() as scratch:
        for method, z, photons, (blur, said), told in cases:
            if method == "map" and (told or photons in (1e4, 1e6) or (blur and not said)):
                continue  # ten seconds each; the test is the same
            mean = xray.fresnel_counts(
                xray.RoundJet(PHI, 50e-6, 2e-6), WATER, xray.Detector(np.full(224, photons), PIXEL, blur=blur), z
            )
            counts = np.random.default_rng(1).poisson(mean, (1, 8, 224)).astype(float)
            keys = {"method": method, "blur": said, "propagation_distance": f"{100 * z:g} cm" if told else None}
            outcome, sd = reduced(Path(scratch), counts, photons, **{k: v for k, v in keys.items() if v is not None})
            kind = outcome.split(" ")[0]
            tally[method, kind] = tally.get((method, kind), 0) + 1
            if kind == "silent":
                missed.append((method, z, photons, blur, said, told, sd))
    for (method, kind), count in sorted(tally.items()):
        print(f"  {method}: {kind} {count}")
    print(f"  missed: {len(missed)} of {sum(tally.values())}", *missed, sep="\n    ")


def quiet(shapes=tuple(SHAPES), radii=(50e-6, 25e-6)) -> None:
    """The same without fringes: alarms, over shapes of the profile, photons, and a blur left out or overstated."""
    from spinline.xray.frame import Frame
    from spinline.xray.frame.track import track_jet
    from spinline.xray.phase.fringe_frame import frame_fringes

    edges = np.linspace(0, 1, 61)
    middle = 0.5 * (edges[1:] + edges[:-1])
    found = []
    blurs = ((0.0, 0.0), (1.2e-6, 1.2e-6), (1.2e-6, 0.0), (0.8e-6, 1.2e-6))
    for name, photons, (blur, said), radius in itertools.product(shapes, (1e3, 1e5, 1e7), blurs, radii):
        shape = SHAPES[name]
        fraction = 0.05 * shape(middle) / shape(_ROOTS).mean()
        detector = xray.Detector(np.full(int(4.5 * radius / PIXEL), photons), PIXEL, blur=blur)
        mean = xray.expected_counts(
            xray.RoundJet(fraction, radius, 2e-6, edges), WATER.absorber, detector, amplitude=1.01, slope=0.005
        )
        counts = np.random.default_rng(2).poisson(mean, (24, mean.size)).astype(float)
        flat = np.full(counts.shape, photons)
        frame = Frame(counts, flat, 0 * flat, np.ones(flat.shape, bool), PIXEL, said)
        track = track_jet(counts, flat, 0 * flat, frame.good)
        found.append(frame_fringes(frame, WATER, track=track).significance)
    s = np.array(found)
    print(
        f"  {s.size} frames of 24 rows without fringes: {(s >= 5).sum()} alarms, largest {s.max():.2f}, mean {s.mean():.2f}"
    )


def bias() -> None:
    print("bias of the mean fraction at R = 50 um, 1e7 photons, phantoms by quadrature")
    print("distance   worst pixel   absorption      Paganin (sharp, edges known)   likelihood")
    n, known = 224, {"shells": 1, "nuisances": ("amplitude", "slope"), "radius": 50e-6, "axis": 2e-6}
    detector = xray.Detector(np.full(n, 1e7), PIXEL)
    for z in (0.01, 0.05, 0.1, 0.2):
        seen = quadrature(50e-6, z, n, 2e-6)
        model = xray.fresnel_counts(xray.RoundJet(PHI, 50e-6, 2e-6), WATER, detector, z) / 1e7
        folded = xray.contact_transmission(seen, PIXEL, z, WATER.delta_over_mu(0.05))
        paganin = xray.fit_row(1e7 * folded, WATER.absorber, detector, **known).mean_fraction - 0.05
        held = xray.fit_row(1e7 * seen, WATER.absorber, detector, **known).mean_fraction - 0.05
        try:
            free = f"{xray.fit_row(1e7 * seen, WATER.absorber, detector, shells=1).mean_fraction - 0.05:+.2f}"
        except InputError:
            free = "refused"
        fit = xray.fit_row_phase(1e7 * seen, WATER, detector, z, nuisances=NUISANCES, profile="shells")
        print(
            f"{100 * z:5.0f} cm   {np.abs(seen - model).max():.1e}   {held:+.2f} (edges known), {free} (free)   {paganin:+.4f}"
            f"   {fit.mean_fraction - 0.05:+.5f} +/- {fit.mean_fraction_std:.1e}, "
            f"radius {1e9 * (fit.jet.radius - 50e-6):+.2f} nm"
        )


def scatter(replicates: int = 150) -> None:
    print(
        f"phase likelihood, {replicates} replicates: standard deviation over the bound, bias over its error, coverage"
    )
    for radius, z, photons, blur in (
        (50e-6, 0.01, 1e6, 0.0),
        (50e-6, 0.1, 1e5, 1.2e-6),
        (50e-6, 0.2, 1e5, 1.2e-6),
        (25e-6, 0.1, 1e6, 0.0),
        (10e-6, 0.2, 1e5, 0.0),
    ):
        detector = xray.Detector(np.full(int(3 * radius / PIXEL), photons), PIXEL, blur=blur)
        jet = xray.RoundJet(PHI, radius, 1e-6)
        mean = xray.fresnel_counts(jet, WATER, detector, z)
        bound = xray.phase_error_limit(jet, WATER, detector, z, nuisances=NUISANCES).mean
        plain = xray.error_limit(jet, WATER.absorber, detector, nuisances=NUISANCES).mean
        start = time.process_time()
        fits = [
            xray.fit_row_phase(xray.noisy_counts(mean, 1, i), WATER, detector, z, nuisances=NUISANCES, profile="shells")
            for i in range(replicates)
        ]
        cost = (time.process_time() - start) / replicates
        found = np.array([f.mean_fraction for f in fits])
        z_scores = (found - 0.05) / np.array([f.mean_fraction_std for f in fits])
        print(
            f"R {1e6 * radius:3.0f} um, {100 * z:3.0f} cm, {photons:.0e} photons, blur {1e6 * blur:.1f} um: "
            f"{found.std(ddof=1) / bound:.3f}, {(found.mean() - 0.05) / (bound / np.sqrt(replicates)):+.1f}, "
            f"{100 * np.mean(np.abs(z_scores) < 1.96):.1f} %; bound {bound:.1e}, of absorption {plain:.1e} "
            f"({plain / bound:.1f} times), not converged {sum(not f.converged for f in fits)}, {1e3 * cost:.0f} ms CPU a row"
        )


def alarms(rows: int = 700) -> None:
    print(f"fringe test, {rows} rows without fringes: alarms at 5, largest and mean significance")
    for photons, blur, radius in ((1e3, 0.0, 50e-6), (1e5, 1.2e-6, 50e-6), (1e6, 0.0, 25e-6)):
        detector = xray.Detector(np.full(int(4.5 * radius / PIXEL), photons), PIXEL, blur=blur)
        mean = xray.expected_counts(xray.RoundJet(PHI, radius, 2e-6), WATER.absorber, detector)
        found = [
            xray.detect_fringes(xray.noisy_counts(mean, 2, i), WATER, detector, estimate=False) for i in range(rows)
        ]
        s = np.array([f.significance for f in found])
        print(
            f"  {photons:.0e} photons, blur {blur:.1e}, R {radius:.0e}: {(s >= 5).sum()}, {s.max():.2f}, {s.mean():.2f}"
        )
    print("with fringes, R = 50 um: significance of one row, distance found")
    for z in (0.01, 0.1, 0.2):
        for photons, blur in ((1e3, 0.0), (1e4, 1.2e-6), (1e6, 1.2e-6)):
            detector = xray.Detector(np.full(224, photons), PIXEL, blur=blur)
            mean = xray.fresnel_counts(xray.RoundJet(PHI, 50e-6, 2e-6), WATER, detector, z)
            tests = [
                xray.detect_fringes(xray.noisy_counts(mean, 3, i), WATER, detector, estimate=i < 3) for i in range(20)
            ]
            at = ", ".join(f"{100 * t.distance:.2f}" for t in tests[:3])
            print(
                f"  {100 * z:3.0f} cm, {photons:.0e} photons, blur {blur:.1e}: "
                f"detected {sum(t.detected for t in tests)} of 20, "
                f"least {min(t.significance for t in tests):.0f}; distance {at} cm"
            )


def spectra() -> None:
    print("spectra, R = 50 um, 1e7 photons: bias of one line, of the spectral fit")
    detector, mono = xray.Detector(np.full(224, 1e7), PIXEL), WATER.absorber
    crystal = xray.scintillator_response(xray.Material("Lu3Al5O12", 6730.0), 20e-6)
    broad, hard = xray.gaussian_spectrum(13.0, 4.0), np.linspace(7, 23, 33)
    cases = [
        ("third harmonic, 1 % of the signal", xray.harmonic_spectrum(10.0, {3: 0.01}), mono),
        ("third harmonic, 5 % of the signal", xray.harmonic_spectrum(10.0, {3: 0.05}), mono),
        (
            "third harmonic, 1 % of the photons on 20 um LuAG",
            xray.harmonic_spectrum(10.0, {3: 0.01}).seen_by(crystal),
            mono,
        ),
        (
            "third harmonic, 5 % of the photons on 20 um LuAG",
            xray.harmonic_spectrum(10.0, {3: 0.05}).seen_by(crystal),
            mono,
        ),
        ("13 keV, 4 keV at half height, mean attenuation", xray.gaussian_spectrum(13.0, 4.0 / 2.3548), None),
        ("9 to 17 keV, flat, mean attenuation", xray.Spectrum(np.linspace(9, 17, 33), np.ones(33)), None),
        ("13 +- 4 keV (sd, from 3 keV), mean attenuation", broad, None),
        ("the same behind 0.2 mm of Al", broad.behind(xray.Material("Al", 2699.0), 2e-4), None),
        (
            "13 +- 4 keV from 7 keV up, mean attenuation",
            xray.Spectrum(hard, np.exp(-0.5 * ((hard - 13) / 4) ** 2)),
            None,
        ),
    ]
    for name, spectrum, absorber in cases:
        medium = xray.solution_medium("PEO", "water", spectrum)
        counts = xray.spectral_counts(xray.RoundJet(PHI, 50e-6, 2e-6), medium, detector)
        ignored = xray.fit_row(counts, absorber or medium.absorber, detector, shells=1).mean_fraction - 0.05
        start = time.process_time()
        fit = xray.fit_row_spectrum(counts, medium, detector, shells=1)
        cost = time.process_time() - start
        print(
            f"  {name}: {ignored:+.4f}; {fit.mean_fraction - 0.05:+.1e} +/- {fit.mean_fraction_std:.1e}, "
            f"{spectrum.energy_kev.size} lines, {1e3 * cost:.1f} ms CPU"
        )


def scans() -> None:
    import h5py

    file = Path(__file__).parents[1] / "src/spinline/data/spray-8keV/qst_spray_monochromatic_Re-6700_averaged.hdf5"
    with h5py.File(file) as data:
        x, theta = 1e-3 * data["jets/x"][:].astype(float), data["jets/theta"][:].astype(float)
        extinction = data["jets/ext_length"][:].astype(float)
    water = xray.material("water")
    tables = float(water.attenuation(8.0)), float(water.attenuation(8.0, coherent=False))
    print(f"water at 8 keV: total {tables[0]:.1f}, without coherent scatter {tables[1]:.1f} 1/m")
    for name, more in (("width of the step", {}), ("a point", {"width": 0.0}), ("no share", {"share": 0.0})):
        start = time.process_time()
        fit = xray.fit_sections(x, theta, extinction, **more)
        even = fit.integral / fit.integral.mean()
        print(
            f"  {name}: mu {fit.attenuation:.1f} +/- {fit.attenuation_std:.1f} 1/m "
            f"({100 * (fit.attenuation / tables[0] - 1):+.1f} %, "
            f"{100 * (fit.attenuation / tables[1] - 1):+.1f} %), share {100 * fit.share:.2f} %, integral over views "
            f"{100 * even.std():.2f} % (worst {100 * np.abs(even - 1).max():.2f} %), scatter {fit.scatter:.4f}, "
            f"good {100 * fit.good.mean():.1f} %, {time.process_time() - start:.1f} s CPU"
        )
        for section, std, jet in zip(fit.sections, fit.std, (0, 1), strict=True):
            print(
                f"    radius {1e3 * section.minor:.4f} +/- {1e3 * std.minor:.4f} mm, long axis {1e3 * section.major:.4f} +/- "
                f"{1e3 * std.major:.4f} mm, tilt {np.rad2deg(fit.tilt(jet)):.1f} degrees"
            )


def speed() -> None:
    print("CPU time of one row, best of 5")
    for radius, z in ((50e-6, 0.1), (25e-6, 0.1), (10e-6, 0.1)):
        detector = xray.Detector(np.full(int(3 * radius / PIXEL), 1e6), PIXEL)
        mean = xray.fresnel_counts(xray.RoundJet(PHI, radius), WATER, detector, z)
        counts = xray.noisy_counts(mean, 1)
        parts = []
        for call in (
            lambda r=radius, d=detector, z=z: xray.fresnel_counts(xray.RoundJet(PHI, r), WATER, d, z),
            lambda c=counts, d=detector, z=z: xray.fit_row_phase(c, WATER, d, z),
            lambda c=counts, d=detector: xray.detect_fringes(c, WATER, d, estimate=False),
        ):
            best = np.inf
            for _ in range(5):
                start = time.process_time()
                call()
                best = min(best, time.process_time() - start)
            parts.append(f"{1e3 * best:.1f}")
        print(
            f"  R {1e6 * radius:.0f} um, {detector.flat.size} pixels: counts {parts[0]}, fit {parts[1]}, test {parts[2]} ms"
        )


if __name__ == "__main__":
    parts = {
        "bias": bias,
        "profiles": profiles,
        "scatter": scatter,
        "smooth": smooth,
        "taper": taper,
        "matrix": matrix,
        "quiet": quiet,
        "alarms": alarms,
        "spectra": spectra,
        "scans": scans,
        "speed": speed,
    }
    for part in sys.argv[1:] or parts:
        parts[part]()
        print()
