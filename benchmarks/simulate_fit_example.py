"""Make the measurements of the bundled fit ``peo5-simulated``.

    python benchmarks/simulate_fit_example.py [FOLDER]

Truth and noise are below; everything follows from the seed.
"""

import sys
from pathlib import Path

import numpy as np

from spinline.fit.scene_model import forward_model
from spinline.scene import load_scene

SEED = 12
TRUTH = {
    "k": 0.93,
    "beta": 0.485,
    "volume_fraction": 0.0455,
    "fraction_scale": 0.97,
    "length_scale": 1.004,
    "origin": 35e-6,
}
NOISE = {"radius": 2e-6, "mean": 4e-3, "core": 2e-2}


BUNDLED = Path(__file__).parents[1] / "src/spinline/data/fits/peo5-simulated"


def write(folder):
    model = forward_model(load_scene(BUNDLED / "scene.toml"))
    rng = np.random.default_rng(SEED)
    for kind, count, end in (("radius", 50, 4.9e-3), ("mean", 30, 3.6e-3), ("core", 30, 3.6e-3)):
        z = np.round(np.linspace(6e-5, end, count), 6)
        seen = model.predict((z - TRUTH["origin"]) / TRUTH["length_scale"], TRUTH)
        scale = TRUTH["length_scale" if kind == "radius" else "fraction_scale"]
        value = scale * getattr(seen, kind) + NOISE[kind] * rng.standard_normal(count)
        with (folder / f"{kind}.csv").open("w", encoding="utf-8") as file:
            if kind == "radius":
                file.write("z [mm], radius [um], std [um]\n")
                file.writelines(
                    f"{1e3 * a:.3f}, {1e6 * b:.3f}, {1e6 * NOISE[kind]:g}\n" for a, b in zip(z, value, strict=True)
                )
            else:
                file.write(f"z [mm], {kind}_fraction, std\n")
                file.writelines(f"{1e3 * a:.3f}, {b:.5f}, {NOISE[kind]:g}\n" for a, b in zip(z, value, strict=True))


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else BUNDLED)
