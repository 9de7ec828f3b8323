"""A blown jet in pictures: its straight part, and the beads to the collector."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.report.style import BLUE, GREEN, LEGEND, ORANGE, RED, SheetAxes, sheet_of

if TYPE_CHECKING:
    import xarray as xr

    from spinline.jetprofile.blown.straight_jet import BlownJet

__all__ = ["blown_figure", "blown_run_figure", "save_blown_figure"]


def blown_figure(jet: "BlownJet", axes: SheetAxes = None) -> Any:
    """Four panels: radius, velocities, stress and tension, bending waves; returns the axes, or the figure made for them."""
    sheet, panels = sheet_of(axes, 2, 2, (9.0, 6.5), layout="constrained")
    radius, speed, force, wave = panels.ravel()
    x = jet.solved
    mm = 1e3 * x.z
    radius.semilogy(mm, 1e6 * x.radius, color=BLUE)
    radius.set(ylabel="jet radius (µm)")
    speed.semilogy(mm, x.velocity, color=BLUE, label="jet")
    speed.semilogy(mm, np.maximum(x.air_velocity, 1e-3), color=RED, label="air")
    speed.set(ylabel="velocity (m/s)")
    speed.legend(**LEGEND)
    force.plot(mm, 1e6 * x.tension, color=BLUE)
    force.set_ylabel("tension (µN)", color=BLUE)
    stress = force.twinx()
    stress.plot(mm, x.axial_stress / 1e3, color=ORANGE)
    stress.set_ylabel("axial stress (kPa)", color=ORANGE)
    wave.plot(mm, np.sign(x.wave_speed_squared) * np.sqrt(np.abs(x.wave_speed_squared)), color=GREEN)
    wave.axhline(0.0, color="0.6", lw=0.8)
    wave.set(ylabel="bending waves, $\\pm|c_b^2|^{1/2}$ (m/s)")
    if np.isfinite(x.bending_start):
        for axis in (radius, speed, force, wave):
            axis.axvline(1e3 * x.bending_start, color="0.5", ls=":")
        radius.annotate("bending may begin", (1e3 * x.bending_start, 1e6 * x.radius[0]), fontsize="small", color="0.4")
    for axis in (force, wave):
        axis.set_xlabel("distance from the nozzle (mm)")
    return panels if axes is not None else sheet


def save_blown_figure(jet: "BlownJet", path: Path, *, force: bool = True) -> None:
    """Draw and save."""
    from spinline.report.style import save_sheet

    save_sheet(blown_figure(jet), path, force=force, dpi=150)


def blown_run_figure(run: "xr.Dataset", axes: SheetAxes = None) -> Any:
    """Four panels of a run: side view of some moments, radius along the jet, what landed where, its radii."""
    sheet, panels = sheet_of(axes, 2, 2, (9.5, 8.0), layout="constrained")
    side, thin, laid, sizes = panels.ravel()
    for index in np.unique(np.linspace(0, run.sizes["time"] - 1, 6).astype(int)):
        frame = run.isel(time=int(index))
        last = index == run.sizes["time"] - 1
        side.plot(1e3 * frame["y"], 1e3 * frame["x"], color=BLUE if last else "0.75", lw=1.0 if last else 0.6)
    side.set(xlabel="$y$ (mm)", ylabel="distance from the nozzle (mm)", title="side: last moment, earlier ones grey")
    side.invert_yaxis()
    frame = run.isel(time=-1)
    whole = frame["valid_element"].values
    thin.semilogy(
        np.where(whole, 1e3 * frame["element_arc_length"], np.nan),
        np.where(whole, 1e6 * frame["radius"], np.nan),
        color=BLUE,
    )
    thin.set(xlabel="arc length (mm)", ylabel="radius (µm)")
    volume = run["landing_volume"].values
    down = volume > 0
    for jet in np.unique(run["landing_jet"].values):
        own = run["landing_jet"].values == jet
        laid.plot(1e3 * run["landing_y"].values[own], 1e3 * run["landing_z"].values[own], lw=0.5)
    laid.set(xlabel="$y$ (mm)", ylabel="$z$ across the machine (mm)", title="where it touched down")
    laid.set_aspect("equal", "datalim")
    if down.any():
        radius = np.sqrt(volume[down] / (np.pi * run["landing_flight_length"].values[down]))
        sizes.hist(2e6 * radius, bins=30, weights=1e3 * run["landing_flight_length"].values[down], color=ORANGE)
        sizes.set(xlabel="diameter at landing (µm)", ylabel="fibre (mm)")
    else:
        sizes.text(0.5, 0.5, "nothing has landed", ha="center", va="center", transform=sizes.transAxes)
        sizes.set_axis_off()
    return panels if axes is not None else sheet
