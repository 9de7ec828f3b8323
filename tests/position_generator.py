"""Ten images along one jet, each with its own beam, flats and place of the axis; shares no code with the package."""

import numpy as np
from beam_generator import PHI, PIXEL, Lab, transmissions


def radius_of(z):
    """A jet that thins as electrospun ones do: 60 um at the nozzle, 42 um after 0.5 mm."""
    return 60e-6 * (1 + z / 0.35e-3) ** -0.4


def fraction_of(z):
    """The mean fraction: it rises a little along the jet."""
    return PHI + 0.02 * z / 0.5e-3


def positions(
    folder, *, count=10, rows=72, pixels=300, photons=2e6, overlap=24, seed=0, blur=0.6, flats=12, frames=2, keys=None
):
    """Write frames and flats of every position; the images file as dictionaries, and what was put in."""
    rng = np.random.default_rng(seed)
    step = (rows - overlap) * PIXEL
    places, truth = [], []
    for k in range(count):
        start = k * step
        z = start + (np.arange(rows) + 0.5) * PIXEL
        lab = Lab(
            blur=blur * PIXEL, amplitude=1 + 0.01 * rng.normal(), slope=0.004 * rng.normal(), axis=2e-6 * rng.normal()
        )
        seen = np.concatenate(
            [transmissions(r, pixels, lab, phi=f) for r, f in zip(radius_of(z), fraction_of(z), strict=True)]
        )
        pattern = 1 + 0.05 * rng.normal(size=(rows, pixels))
        counts = rng.poisson(photons / frames * pattern * seen, (frames, rows, pixels)).astype(np.uint32)
        flat = rng.poisson(photons * pattern, (flats, rows, pixels)).astype(np.uint32)
        np.savez(folder / f"p{k}.npz", counts=counts, flat=flat)
        off = 1e-6 * rng.normal()
        places.append({"counts": f"p{k}.npz", "flat": f"p{k}.npz", "offset": f"{1e6 * (start + off):.6f} +/- 1 um"})
        truth.append(z)
    return {
        "dark": 0.0,
        "gain": 1.0,
        "pixel_size": "0.67 um",
        "polymer_attenuation": f"{(520.9 - 136.9) / 113.0:.8f} cm2/g",
        "solvent_attenuation": "5.209 cm2/g",
        "method": "map",
        "shells": 1,
        "block_rows": 12,
        "positions": places,
        "solution": {
            "polymer": {"name": "p", "density": "1.13 g/cm3"},
            "solvent": {"name": "s", "density": "1 g/cm3"},
            "volume_fraction": PHI,
        },
        **(keys or {}),
    }
