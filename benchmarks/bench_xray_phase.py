"""Fringes, spectra and the 8 keV scans: what each neglect costs, what each remedy leaves, at which price.

    python benchmarks/bench_xray_phase.py [bias] [scatter] [alarms] [spectra] [scans] [speed]

Everything where no part is named. PEO in water, phi = 0.05, 10 keV, 0.67 um pixels unless said.
"""

import sys
import time
from pathlib import Path

import numpy as np

from spinline import xray
from spinline.errors import InputError

PIXEL = 0.67e-6
WATER = xray.solution_medium("PEO", "water", 10.0)
NUISANCES = ("radius", "axis", "amplitude", "slope")
PHI = np.array([0.05])


def quadrature(radius, distance, pixels, axis, per_pixel=None):
    """Counts per photon by Gauss-Legendre of the diffraction integral: nothing of the package but the medium."""
    m = WATER
    mu = (m.solvent - m.air + 0.05 * m.contrast)[0]
    delta = (m.delta_solvent - m.delta_air + 0.05 * m.delta_contrast)[0]
    wave = m.wavelength[0]
    rate = 0.5 * mu + 2j * np.pi * delta / wave
    nodes = int(max(1500, 3 * 4 * radius**2 / (wave * distance)))
    per_pixel = per_pixel or int(max(10, 3 * PIXEL * 2 * radius / (wave * distance)))
    t, w = np.polynomial.legendre.leggauss(50)
    panels = np.linspace(-np.pi / 2, np.pi / 2, nodes // 50 + 1)
    half = 0.5 * np.diff(panels)[:, None]
    angle = (0.5 * (panels[1:] + panels[:-1])[:, None] + half * t).ravel()
    source = axis + radius * np.sin(angle)
    strength = (np.exp(-2 * rate * radius * np.cos(angle)) - 1) * (half * w).ravel() * radius * np.cos(angle)
    g, v = np.polynomial.legendre.leggauss(per_pixel)
    seen = np.empty(pixels)
    for i, x in enumerate(PIXEL * (np.arange(pixels) - 0.5 * (pixels - 1))):
        phase = np.pi * (x + 0.5 * PIXEL * g[:, None] - source) ** 2 / (wave * distance)
        u = 1 + np.exp(-0.25j * np.pi) / np.sqrt(wave * distance) * (np.exp(1j * phase) @ strength)
        seen[i] = 0.5 * v @ np.abs(u) ** 2
    return seen


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
        fit = xray.fit_row_phase(1e7 * seen, WATER, detector, z, nuisances=NUISANCES)
        print(
            f"{100 * z:5.0f} cm   {np.abs(seen - model).max():.1e}   {held:+.2f} (edges known), {free} (free)   {paganin:+.4f}"
            f"   {fit.mean_fraction - 0.05:+.5f} +/- {fit.mean_fraction_std:.1e}, "
            f"radius {1e9 * (fit.jet.radius - 50e-6):+.2f} nm"
        )


def scatter(replicates: int = 150) -> None:
    print(
        f"phase likelihood, {replicates} replicates: standard deviation over the bound, bias over its error, coverage"
    )
    for radius, z, photons, blur in ((50e-6, 0.01, 1e6, 0.0), (50e-6, 0.1, 1e5, 1.2e-6), (50e-6, 0.2, 1e5, 1.2e-6),
                                     (25e-6, 0.1, 1e6, 0.0), (10e-6, 0.2, 1e5, 0.0)):  # fmt: skip
        detector = xray.Detector(np.full(int(3 * radius / PIXEL), photons), PIXEL, blur=blur)
        jet = xray.RoundJet(PHI, radius, 1e-6)
        mean = xray.fresnel_counts(jet, WATER, detector, z)
        bound = xray.phase_error_limit(jet, WATER, detector, z, nuisances=NUISANCES).mean
        plain = xray.error_limit(jet, WATER.absorber, detector, nuisances=NUISANCES).mean
        start = time.process_time()
        fits = [
            xray.fit_row_phase(xray.noisy_counts(mean, 1, i), WATER, detector, z, nuisances=NUISANCES)
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
        ("third harmonic, 1 % of the photons on 20 um LuAG", xray.harmonic_spectrum(10.0, {3: 0.01}).seen_by(crystal), mono),
        ("third harmonic, 5 % of the photons on 20 um LuAG", xray.harmonic_spectrum(10.0, {3: 0.05}).seen_by(crystal), mono),
        ("13 keV, 4 keV at half height, mean attenuation", xray.gaussian_spectrum(13.0, 4.0 / 2.3548), None),
        ("9 to 17 keV, flat, mean attenuation", xray.Spectrum(np.linspace(9, 17, 33), np.ones(33)), None),
        ("13 +- 4 keV (sd, from 3 keV), mean attenuation", broad, None),
        ("the same behind 0.2 mm of Al", broad.behind(xray.Material("Al", 2699.0), 2e-4), None),
        ("13 +- 4 keV from 7 keV up, mean attenuation", xray.Spectrum(hard, np.exp(-0.5 * ((hard - 13) / 4) ** 2)), None),
    ]  # fmt: skip
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
    parts = {"bias": bias, "scatter": scatter, "alarms": alarms, "spectra": spectra, "scans": scans, "speed": speed}
    for part in sys.argv[1:] or parts:
        parts[part]()
        print()
