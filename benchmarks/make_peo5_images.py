"""The bundled images: frames of the jet of the scene peo5-water, as the theory has it, simulated with noise.

    python benchmarks/make_peo5_images.py [FOLDER]

writes peo5-images.npz: two frames, five flats, two darks of a camera with 2 photons per count, 100 counts of offset and
read noise, a dead and a hot pixel; the beam has drifted by 1 % and tilted by 1 % since the flats. 7 keV, 4 um pixels, the
nozzle's end at the first row. The network of the jet contracts: polymer within the network's radius, none outside, the mean
of the section everywhere that of the solution.
"""

import sys
from pathlib import Path

import numpy as np

import spinline as sl
from spinline import xray

PIXEL, ROWS, COLUMNS, PHOTONS, GAIN, OFFSET, READ = 4e-6, 240, 80, 1.1e5, 2.0, 100.0, 1.5


def jet(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Radius, polymer fraction of the core, and the core's radius over the jet's, at distances z."""
    scene = sl.load_scene("peo5-water")
    solution = sl.solve.build_solution(scene)
    profile = sl.solve.build_jet(scene, solution)
    network = sl.network.affine_network(profile.velocity_ratio(z), solution.volume_fraction)
    core = np.minimum(network.core_polymer_fraction_conservative, 1.0)
    return profile.radius(z), core, np.sqrt(solution.volume_fraction / core)


def images() -> dict[str, np.ndarray]:
    """Counts, flat and dark as a camera gives them."""
    rng = np.random.default_rng(20120516)
    z = (np.arange(ROWS) + 0.5) * PIXEL
    radius, core, share = jet(z)
    absorber = xray.solution_absorber("PEO", "water", 7.0)
    x, y = np.linspace(-1, 1, COLUMNS), np.linspace(-1, 1, ROWS)[:, None]
    flat = PHOTONS * (1 - 0.15 * (x - 0.2) ** 2 - 0.1 * y**2) * (1 + 0.01 * rng.standard_normal((ROWS, COLUMNS)))
    seen = np.empty((ROWS, COLUMNS))
    for i in range(ROWS):
        uniform = share[i] > 0.999
        fraction, edges = ([core[i]], [0, 1]) if uniform else ([core[i], 0.0], [0, share[i], 1])
        here = xray.RoundJet(np.array(fraction), radius[i], 3e-6 + 6e-6 * i / ROWS, np.array(edges, dtype=float))
        detector = xray.Detector(flat[i], PIXEL, blur=3e-6)
        seen[i] = xray.expected_counts(here, absorber, detector, amplitude=1.01, slope=0.01)

    def camera(photons: np.ndarray, frames: int) -> np.ndarray:
        counts = rng.poisson(photons, (frames, ROWS, COLUMNS)) / GAIN + OFFSET
        counts += READ * rng.standard_normal(counts.shape)
        counts[:, 120, 40], counts[:, 200, 30] = OFFSET, 60000
        return np.rint(np.clip(counts, 0, 65535)).astype(np.uint16)

    return {"counts": camera(seen, 2), "flat": camera(flat, 5), "dark": camera(np.zeros_like(flat), 2)}


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "src/spinline/data/images"
    np.savez_compressed(folder / "peo5-images.npz", **images())
