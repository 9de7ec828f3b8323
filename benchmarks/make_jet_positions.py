"""The bundled images of ten positions: a jet of PEO along 5 mm, as the ten frames of the review's Fig. 34 are along one.

    python benchmarks/make_jet_positions.py [FOLDER]

writes peo5-positions.npz and peo5-positions.toml: one image and one flat of each position, 0.5 mm apart and 0.6 mm high,
8 keV, 5 um pixels, 32 photons a count, a detector with a blur of 4 um and 2 % of its light in a tail of 40 um. Each position
has its own level and slope of the beam, its own axis and an error of the stage of 5 um. The jet is that of the scene peo5-water
from 0.2 mm on; the fraction is that of the solution at first and rises by a quarter along the 5 mm, as evaporation would have
it. Made with the package's own model: an example, no proof (that is `xray_lab.py`).
"""

import sys
from pathlib import Path

import numpy as np

import spinline as sl
from spinline import xray

PIXEL, ROWS, COLUMNS, STEP, COUNT = 5e-6, 120, 72, 0.5e-3, 10
PHOTONS, GAIN, START = 1.6e6, 32.0, 0.2e-3  # per pixel, photons a count, m from the nozzle
BLUR, TAIL = 4e-6, (0.02, 40e-6)


def fraction(z, start):
    """Polymer fraction of the whole section along the jet."""
    return start * (1.0 + 0.25 * (z / 5e-3) ** 2)


def main(folder: Path) -> None:
    """Write counts, flats and the images file."""
    rng = np.random.default_rng(20200813)
    scene = sl.load_scene("peo5-water")
    solution = sl.solve.build_solution(scene)
    profile = sl.solve.build_jet(scene, solution)
    absorber = xray.solution_absorber("PEO", "water", 8.0)
    arrays, lines = {}, []
    for k in range(COUNT):
        z = k * STEP + (np.arange(ROWS) + 0.5) * PIXEL
        radius = profile.radius(z + START)
        x = np.linspace(-1, 1, COLUMNS)
        flat = PHOTONS * (1 - 0.1 * (x - 0.1 * rng.normal()) ** 2) * (1 + 0.01 * rng.standard_normal((ROWS, COLUMNS)))
        level, slope, axis = 1 + 0.01 * rng.normal(), 0.005 * rng.normal(), 6e-6 * rng.normal()
        seen = np.empty_like(flat)
        for i in range(ROWS):
            one = xray.Detector(flat[i], PIXEL, blur=BLUR, tail_share=TAIL[0], tail_length=TAIL[1])
            jet = xray.RoundJet(np.array([fraction(z[i], solution.volume_fraction)]), radius[i], axis)
            seen[i] = xray.expected_counts(jet, absorber, one, amplitude=level, slope=slope)
        arrays[f"jet_{k}"] = np.minimum(np.rint(rng.poisson(seen) / GAIN), 65535).astype(np.uint16)
        arrays[f"flat_{k}"] = np.minimum(np.rint(rng.poisson(9 * flat) / 9 / GAIN), 65535).astype(np.uint16)
        off = k * STEP + 5e-6 * rng.normal() * (k > 0)
        lines += [
            "",
            "[[positions]]",
            f'counts = "peo5-positions.npz:jet_{k}"',
            f'flat = "peo5-positions.npz:flat_{k}"',
            f'offset = "{1e3 * off:.4f} +/- 0.005 mm"',
            *(["calibration_rows = [0, 40]"] if k == 0 else []),
        ]
    np.savez_compressed(folder / "peo5-positions.npz", **arrays)
    head = [
        'title = "PEO 5 wt% in water, ten positions along 5 mm, simulated at 8 keV"',
        "dark = 0",
        "gain = 32",
        "flat_frames = 9                     # each flat is a mean of nine exposures",
        'pixel_size = "5 um"',
        'energy = "8 keV"',
        'blur = "fit"                        # the detector is one: fitted to all rows of all positions',
        'tail_share = "0.02 +/- 0.003"       # glare, from a measured edge',
        'tail_length = "40 +/- 5 um"',
        'method = "map"',
        "shells = 3",
        "block_rows = 10",
    ]
    tail = ["", "[solution]", 'polymer = "PEO"', 'solvent = "water"', "mass_fraction = 0.05"]
    (folder / "peo5-positions.toml").write_text("\n".join([*head, *lines, *tail]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "src/spinline/data/images")
