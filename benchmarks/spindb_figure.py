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
    sheet = Figure(figsize=(9.0, 4.6), layout="constrained")
    left, right = sheet.subplots(1, 2)
    ends = np.array([30.0, 2e4])
    errors = []
    for i, paper in enumerate(papers):
        points = 1e9 * np.array([numbers for name, *numbers in found["predicted"] if name == paper])
        measured, low95, low, middle, high, high95 = points.T
        style = {"color": f"C{i % 10}", "linestyle": ""}
        left.plot(measured, middle, "os^vD"[i % 5], markersize=3.5, alpha=0.8, **style)
        left.vlines(measured, low, high, color=f"C{i % 10}", alpha=0.25, linewidth=0.8)
        ratio = np.log(measured / middle)
        errors.append((np.median(ratio), ratio, np.median(np.log(low / middle)), np.median(np.log(high / middle)), i))
        errors[-1] += (np.median(np.log(low95 / middle)), np.median(np.log(high95 / middle)))
    left.plot(ends, ends, color=GREY, linewidth=1)
    left.set(xscale="log", yscale="log", xlim=ends, ylim=ends)
    left.set(xlabel="measured diameter (nm)", ylabel="predicted diameter (nm), 68 % intervals")
    race = found["rungs"]["race"]
    left.set_title(
        f"{found['settings']} settings, one mark and colour a paper; factor {race['factor']:.2f}\n"
        "each paper predicted by constants that have not seen it",
        fontsize=9,
    )
    for row, (_, ratio, low, high, i, low95, high95) in enumerate(sorted(errors, key=lambda e: e[0])):
        right.hlines(row, np.exp(low95), np.exp(high95), color=GREY, alpha=0.35, linewidth=1)
        right.hlines(row, np.exp(low), np.exp(high), color=GREY, alpha=0.6, linewidth=4)
        right.plot(
            np.exp(ratio), np.full(len(ratio), row), "os^vD"[i % 5], color=f"C{i % 10}", markersize=3, linestyle=""
        )
    right.axvline(1.0, color=GREY, linewidth=1)
    right.set(xscale="log", xlim=(0.08, 12), xlabel="measured over predicted diameter", yticks=[], ylabel="papers")
    right.set_xticks([0.1, 0.2, 0.5, 1, 2, 5, 10], ["0.1", "0.2", "0.5", "1", "2", "5", "10"])
    right.set_title(
        f"bands: median 68 and 95 % intervals of a paper\n"
        f"they hold {100 * race['coverage_68']:.0f} and {100 * race['coverage_95']:.0f} % (mean over papers)",
        fontsize=9,
    )
    for axis in (left, right):
        grid(axis)
    save_sheet(sheet, HERE.parent / "docs" / "images" / "spindb.png", force=True, dpi=100)


if __name__ == "__main__":
    main()
