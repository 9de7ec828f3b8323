"""The map of the stability atlas, for the documentation.

python benchmarks/atlas_figure.py benchmarks/atlas.json docs/images/atlas.png
"""

import json
import sys
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

NAMES = {
    "volume_fraction": "volume fraction",
    "velocity_ratio": "velocity ratio aimed at",
    "coupling": "alpha_v",
    "deborah": "De",
}


def main():
    """Draw the share of scenes that end in a result, the others being refused by name."""
    summary = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    sheet = Figure(figsize=(10, 4), layout="constrained")
    FigureCanvasAgg(sheet)
    for axis, (pair, counts) in zip(sheet.subplots(1, 2), summary["maps"].items(), strict=True):
        x, y = pair.split()
        drawn, results = np.moveaxis(np.array(counts, dtype=float), -1, 0)
        share = np.divide(results, drawn, out=np.full_like(drawn, np.nan), where=drawn > 0)
        extent = (*summary["axes"][x], *summary["axes"][y])
        picture = axis.imshow(share.T, origin="lower", extent=extent, aspect="auto", vmin=0, vmax=1, cmap="cividis")
        axis.set(xlabel=f"log10 {NAMES[x]}", ylabel=f"log10 {NAMES[y]}")
    sheet.colorbar(picture, ax=sheet.axes, label="share of scenes with a result")
    sheet.suptitle(f"{summary['scenes']} scenes: a result, or a refusal by name", fontsize=10.5)
    sheet.savefig(sys.argv[2], dpi=110)


if __name__ == "__main__":
    main()
