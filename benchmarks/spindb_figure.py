"""Predicted against measured diameters, from the committed result of `spindb.py`: the picture of the docs."""

import json
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spinline.report.style import GREY, grid, save_sheet

HERE = Path(__file__).parent


def main():
    found = json.loads((HERE / "spindb.json").read_text(encoding="utf-8"))
    papers = sorted({paper for paper, *_ in found["predicted"]})
    sheet = Figure(figsize=(5.6, 5.2), layout="constrained")
    axis = sheet.subplots()
    ends = np.array([30.0, 2e4])
    inside = found["rungs"]["race"]
    for i, paper in enumerate(papers):
        points = 1e9 * np.array([(m, p) for name, m, p in found["predicted"] if name == paper])
        axis.plot(points[:, 0], points[:, 1], "os^vD"[i % 5], color=f"C{i % 10}", markersize=4, alpha=0.7, linestyle="")
    axis.plot(ends, ends, color=GREY, linewidth=1)
    for factor in (2.0, 4.0):
        axis.plot(ends, factor * ends, color=GREY, linestyle=":", linewidth=1)
        axis.plot(ends, ends / factor, color=GREY, linestyle=":", linewidth=1)
    axis.set(
        xscale="log",
        yscale="log",
        xlim=ends,
        ylim=ends,
        xlabel="measured diameter (nm)",
        ylabel="predicted diameter (nm)",
    )
    axis.set_title(
        f"{found['rows']} settings of {found['papers']} papers, one mark a paper; factor {inside['factor']:.2f}",
        fontsize=9,
    )
    grid(axis)
    save_sheet(sheet, HERE.parent / "docs" / "images" / "spindb.png", force=True, dpi=100)


if __name__ == "__main__":
    main()
