"""Pictures and report of a mat: top view, thickness, diameters, orientation, pores, permeability."""

import base64
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from spinline.base.files import write_text
from spinline.base.words import page
from spinline.deposit.diameters import lognormal
from spinline.deposit.picture import grey_levels, scale_bar
from spinline.report.mat_words import sentences
from spinline.report.style import BLUE, GREY, LEGEND, ORANGE, drawn, grid, plain_text

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["mat_sheet", "save_mat_report", "sentences", "top_view", "top_view_sheet"]

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; color: #111; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
.answer { font-size: 1.15rem; border-left: 4px solid #0072B2; padding-left: 1rem; }
table { border-collapse: collapse; } td { padding: .15rem .8rem .15rem 0; }
td.number { text-align: right; font-variant-numeric: tabular-nums; } img { max-width: 100%; }
"""


def mat_sheet(result: "xr.Dataset") -> Figure:
    """Six panels of a mat."""
    sheet = Figure(figsize=(13.0, 8.2), layout="constrained")
    FigureCanvasAgg(sheet)
    sheet.suptitle(plain_text(str(result.attrs.get("title", ""))))
    parts = [sheet.add_subplot(2, 3, k + 1, projection="polar" if k == 3 else None) for k in range(6)]
    top_view(parts[0], result)
    thickness_map(parts[1], sheet, result)
    diameters(parts[2], result)
    rose(parts[3], result)
    pores(parts[4], result)
    permeabilities(parts[5], result)
    return sheet


def top_view_sheet(result: "xr.Dataset") -> Figure:
    """The top view alone."""
    sheet = Figure(figsize=(7.0, 7.0))
    FigureCanvasAgg(sheet)
    top_view(sheet.add_axes((0.0, 0.0, 1.0, 1.0)), result)
    return sheet


def top_view(axis: "Axes", result: "xr.Dataset") -> None:
    """As a microscope shows it, with a scale bar."""
    height = result["height"].values
    pixel = float(result.attrs["pixel_m"])
    grey = grey_levels(height, pixel, float(result["mean_diameter"]))
    width, depth = height.shape[0] * pixel, height.shape[1] * pixel
    axis.imshow(
        grey.T, origin="lower", cmap="gray", vmin=0, vmax=1, extent=(0, width, 0, depth), interpolation="bicubic"
    )
    bar, label = scale_bar(width)
    x, y = 0.95 * width - bar, 0.05 * depth
    behind = [x - 0.02 * width, x + bar + 0.02 * width]
    axis.fill_between(behind, y - 0.02 * depth, y + 0.075 * depth, color="black", alpha=0.6, lw=0)
    axis.plot([x, x + bar], [y, y], color="white", linewidth=3, solid_capstyle="butt")
    axis.text(x + bar / 2, y + 0.012 * depth, label, color="white", ha="center", va="bottom", fontsize=9)
    axis.set_xlim(0, width)
    axis.set_ylim(0, depth)
    axis.set_xticks([])
    axis.set_yticks([])


def thickness_map(axis: "Axes", sheet: Figure, result: "xr.Dataset") -> None:
    """Mean thickness over the mat."""
    x, y = result["x"].values, result["y"].values
    scale, unit = (1e3, "mm") if max(np.ptp(x), np.ptp(y)) < 1 else (1.0, "m")
    shown = axis.pcolormesh(
        x * scale, y * scale, result["thickness"].values.T * 1e6, cmap="cividis", shading="nearest", rasterized=True
    )
    if 0.1 < (np.ptp(x) or 1) / (np.ptp(y) or 1) < 10:
        axis.set_aspect("equal")
    axis.set_xlabel(f"along the machine ({unit})")
    axis.set_ylabel(f"across ({unit})")
    sheet.colorbar(shown, ax=axis, label="thickness (µm)", shrink=0.85)


def diameters(axis: "Axes", result: "xr.Dataset") -> None:
    """Histogram with the lognormal law of its mean and spread; measured ones beside it."""
    low, high = result["diameter_low"].values * 1e9, result["diameter_high"].values * 1e9
    density = result["diameter_density"].values / 1e9
    axis.bar(low, density, high - low, align="edge", color=BLUE, alpha=0.6, label="laid, per length")
    mean, deviation = float(result["mean_diameter"]) * 1e9, float(result["diameter_deviation"]) * 1e9
    if deviation > 1e-3 * mean:
        law = lognormal(mean, deviation)
        d = np.linspace(max(mean - 4 * deviation, 1e-3 * mean), mean + 5 * deviation, 400)
        axis.plot(
            d,
            np.exp(-0.5 * ((np.log(d) - law.mu) / law.s) ** 2) / (d * law.s * np.sqrt(2 * np.pi)),
            color="black",
            label=f"lognormal, {mean:.4g} ± {deviation:.3g} nm",
        )
        axis.set_xlim(max(0.0, mean - 4 * deviation), mean + 6 * deviation)
    if "measured_diameter" in result:
        axis.hist(
            result["measured_diameter"].values * 1e9,
            25,
            weights=result["measured_weight"].values,
            density=True,
            histtype="step",
            color=ORANGE,
            linewidth=2,
            label=plain_text(str(result.attrs.get("measured", "measured"))),
        )
        every = result["measured_diameter"].values * 1e9
        axis.set_xlim(min(axis.get_xlim()[0], every.min()), max(axis.get_xlim()[1], every.max()))
    axis.set_ylim(0, 1.3 * axis.get_ylim()[1])
    axis.set_xlabel("fibre diameter (nm)")
    axis.set_ylabel("probability density (1/nm)")
    axis.legend(**LEGEND, loc="upper right")


def rose(axis: Any, result: "xr.Dataset") -> None:
    """Directions, both ends of each fibre."""
    density = result["orientation_density"].values.reshape(36, 5).mean(axis=1)
    angle = result["orientation"].values.reshape(36, 5).mean(axis=1)
    for shift in (0.0, np.pi):
        axis.bar(angle + shift, density, np.pi / 36, color=BLUE, alpha=0.7, edgecolor="white", linewidth=0.3)
    axis.plot(np.linspace(0, 2 * np.pi, 200), np.full(200, 1 / np.pi), color="black", linewidth=0.8, linestyle=":")
    axis.set_yticklabels([])
    axis.tick_params(labelsize=8)
    axis.set_title(f"order parameter S2 = {float(result['order_parameter']):.3f} (dotted: isotropic)", fontsize=9)


def pores(axis: "Axes", result: "xr.Dataset") -> None:
    """Share of the pores that balls of a radius cover."""
    r = result["pore_radius"].values * 1e6
    cumulative, spread = result["pore_cumulative"].values, result["pore_cumulative_std"].values
    axis.plot(r, cumulative, "o-", color=BLUE, markersize=4)
    band = np.where(np.isfinite(spread), spread, 0.0)
    low, high = np.maximum(cumulative - band, 0), np.minimum(cumulative + band, 1)
    axis.fill_between(r, low, high, color=BLUE, alpha=0.2, linewidth=0)
    bubble = float(result["bubble_point_radius"]) * 1e6
    if np.isfinite(bubble):
        axis.axvline(bubble, color=ORANGE, linestyle="--", label=f"bubble point {bubble:.3g} µm")
        axis.legend(**LEGEND, loc="lower left")
    axis.set_xlabel("pore radius (µm)")
    axis.set_ylabel("share of the pores")
    axis.set_ylim(0, 1.05)
    grid(axis)


def permeabilities(axis: "Axes", result: "xr.Dataset") -> None:
    """Permeability by law, and the computed one."""
    names = [str(name) for name in result["law"].values]
    k, spread = result["permeability"].values, result["permeability_std"].values
    axis.bar(range(len(names)), np.nan_to_num(k), yerr=np.nan_to_num(spread), color=BLUE, alpha=0.7, capsize=4)
    for place, value in enumerate(k):
        if not np.isfinite(value):
            axis.text(place, 0, "outside\nits range", ha="center", va="bottom", fontsize=8, color=GREY)
    if "permeability_direct" in result:
        direct = result["permeability_direct"]
        axis.axhline(
            float(direct),
            color=ORANGE,
            linestyle="--",
            label=f"Stokes flow, first window (solidity {float(direct.attrs['solidity']):.3f})",
        )
        axis.set_ylim(0, 1.35 * max(float(np.nanmax(np.append(k, 0.0))), float(direct)))
        axis.legend(**LEGEND, loc="upper right")
    axis.set_xticks(range(len(names)), names, rotation=20, ha="right", fontsize=8)
    axis.set_ylabel("permeability (m$^2$)")
    grid(axis)


def save_mat_report(result: "xr.Dataset", path: str | Path, *, force: bool = False) -> Path:
    """One HTML file: the answer, pictures, numbers."""
    picture = base64.b64encode(drawn(mat_sheet(result), dpi=110)).decode("ascii")
    answer = "".join(f"<p>{escape(line)}</p>" for line in sentences(result))
    scalars = [
        (str(name), float(v), str(v.attrs.get("units", ""))) for name, v in result.data_vars.items() if not v.dims
    ]
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td class='number'>{value:.6g}</td><td>{escape(unit)}</td></tr>"
        for name, value, unit in scalars
    )
    settings = "".join(f"<tr><td>{escape(str(k))}</td><td>{escape(str(v))}</td></tr>" for k, v in result.attrs.items())
    title = escape(str(result.attrs.get("title", "mat")))
    text = f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<style>{_STYLE}</style></head><body>
<h1>{title}</h1>
<div class="answer">{answer}</div>
<h2>Pictures</h2>
<img alt="Top view, thickness map, diameters, orientation, pores, permeability" src="data:image/png;base64,{picture}">
<h2>Numbers</h2><table>{rows}</table>
<h2>How it was made</h2><table>{settings}</table>
</body></html>
"""
    return write_text(path, page(text), force=force)
