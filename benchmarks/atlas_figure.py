"""The map of where each model holds, for the documentation, from the summary of the stability atlas.

python benchmarks/atlas_figure.py benchmarks/atlas.json docs/images/atlas.png
"""

import json
import sys
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

NAMES = {
    "slip": r"$\log_{10}$ of the largest $c\,V'/\alpha_v$",
    "deborah": r"$\log_{10}$ De at the crossover",
    "volume_fraction": r"$\log_{10}\,\phi$",
    "stretch": r"$\log_{10}\,V$ at the end of the jet",
}
CLASSES = {  # colour and words; the order of the legend
    "affine": ("#4c956c", "affine"),
    "conformation": ("#3a7ca5", "conformation: relaxation matters"),
    "manifold": ("#e9b44c", "manifold: slip matters"),
    "unsteady": ("#c8553d", "no steady network (chain)"),
    "neither": ("#7d5ba6", "two-fluid: both matter"),
}
FORCED = ("affine", "manifold", "conformation", "two-fluid", "chain", "walk")


def _extent(summary, pair):
    x, y = pair
    return (*summary["axes"][x], *summary["axes"][y])


def _joined(counts, summary, size=None):
    """Bins joined, for enough scenes in each."""
    size = size or (1 if summary["scenes"] > 20_000 else 2)
    n, m = counts.shape[:2]
    return counts.reshape(n // size, size, m // size, size, *counts.shape[2:]).sum((1, 3))


def _holding(axis, summary, pair):
    """Which model holds, the more faintly the fewer of the scenes there agree."""
    counts = np.array(summary["held"][" ".join(pair)], dtype=float)
    kinds = list(CLASSES)
    counts = _joined(counts[..., [summary["classes"].index(kind) for kind in kinds]], summary)
    total = counts.sum(-1)
    best, share = counts.argmax(-1), counts.max(-1) / np.maximum(total, 1)
    colours = np.array([to_rgb(CLASSES[kind][0]) for kind in kinds])[best]
    weight = np.where(
        total >= (3 if summary["scenes"] > 20_000 else 1), 0.25 + 0.75 * np.clip((share - 0.25) / 0.75, 0, 1), 0.0
    )[..., np.newaxis]
    picture = weight * colours + (1 - weight)
    axis.imshow(np.swapaxes(picture, 0, 1), origin="lower", extent=_extent(summary, pair), aspect="auto")
    axis.set(xlabel=NAMES[pair[0]], ylabel=NAMES[pair[1]])


def _results(axis, summary, pair, model):
    """Share of scenes that end in a result."""
    counts = np.array(summary["came"][" ".join(pair)], dtype=float)
    counts = counts.sum(2) if model is None else counts[:, :, summary["models"].index(model)]
    drawn, results = counts[..., 0], counts[..., 1]
    size = (1 if model is None else 2) * (1 if summary["scenes"] > 20_000 else 2)
    drawn, results = (_joined(a, summary, size) for a in (drawn, results))
    share = np.divide(results, drawn, out=np.full_like(drawn, np.nan), where=drawn > 0)
    picture = axis.imshow(
        share.T, origin="lower", extent=_extent(summary, pair), aspect="auto", vmin=0, vmax=1, cmap="cividis"
    )
    asked = int(drawn.sum())
    axis.set_title(f"{model or 'every model'}: {int(results.sum())} of {asked}", fontsize=9)
    axis.set_xlabel(NAMES[pair[0]], fontsize=8)
    axis.set_ylabel(NAMES[pair[1]], fontsize=8)
    axis.tick_params(labelsize=8)
    return picture


def _limits(axis, pair, summary):
    """The laws behind the map."""
    if pair[1] == "slip":
        axis.axhline(np.log10(0.25), color="k", lw=1, ls="--")
        axis.text(_extent(summary, pair)[0] + 0.2, np.log10(0.25) + 0.15, "1/4", fontsize=8)
        return
    from spinline.network.concentration import compaction_velocity_ratio

    phi = np.logspace(-5, -0.01, 200)
    for v, style, words in (
        (1 / phi, "-", r"full stretch, $1/\phi$"),
        (compaction_velocity_ratio(phi, "theta"), ":", "core compact"),
    ):
        axis.plot(np.log10(phi), np.log10(v), color="k", ls=style, lw=1, label=words)
    axis.set_xlim(*summary["axes"][pair[0]])
    axis.set_ylim(*summary["axes"][pair[1]])
    axis.legend(fontsize=8, loc="lower left", framealpha=0.7)


def main():
    """Draw which model holds where, and where a result came."""
    summary = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    planes = [tuple(pair.split()) for pair in summary["held"]]
    sheet = Figure(figsize=(12, 9.6), layout="constrained")
    FigureCanvasAgg(sheet)
    upper, lower = sheet.subfigures(2, 1, height_ratios=(1.15, 1))
    for axis, pair in zip(upper.subplots(1, 2), planes, strict=True):
        _holding(axis, summary, pair)
        _limits(axis, pair, summary)
    patches = [Patch(color=colour, label=words) for colour, words in CLASSES.values()]
    upper.legend(handles=patches, loc="outside lower center", ncols=len(patches), fontsize=9, frameon=False)
    upper.suptitle(
        f"What holds within rtol = {summary['rtol_of_maps']:g}, for most scenes of a place (fainter where they differ; "
        f"{summary['scenes']} scenes)",
        fontsize=10.5,
    )
    axes = lower.subplots(2, 4).ravel()
    axes[-1].set_axis_off()
    for axis, model in zip(axes[:-1], (*FORCED, None), strict=True):
        picture = _results(axis, summary, planes[1 if model is None else 0], model)
    lower.colorbar(picture, ax=axes.tolist(), label="share with a result")
    lower.suptitle("Where a model that is asked for gives a result; the others are refused by name", fontsize=10.5)
    sheet.savefig(sys.argv[2], dpi=110)


if __name__ == "__main__":
    main()
