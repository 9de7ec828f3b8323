"""A spun jet in pictures: side and top view, radius, stretch and charge along it; and a short animation."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.errors import InputError
from spinline.base.files import replacing
from spinline.report.style import BLUE, GREEN, LEGEND, ORANGE, RED, SheetAxes, sheet_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["check_animation", "spun_figure", "write_animation"]


def spun_figure(jet: "xr.Dataset", axes: SheetAxes = None, index: int = -1) -> Any:
    """Six panels of one moment.

    Parameters
    ----------
    jet : Dataset
        Result of ``spinline spin``.
    axes : six Axes, optional
        Where to draw.
    index : int
        Which moment.

    Returns
    -------
    axes : ndarray of Axes, (2, 3)
    """
    sheet, panels = sheet_of(axes, 2, 3, (12.0, 7.0), layout="constrained")
    side, top, thin, stretch, charge, laid = panels.ravel()
    frame = jet.isel(time=index)
    x, y, z = (100 * frame[name].values for name in "xyz")
    side.plot(y, x, color=BLUE, lw=0.8)
    side.set(xlabel="$y$ (cm)", ylabel="$x$ from the nozzle (cm)", title=f"side, {1e3 * float(frame['time']):.4g} ms")
    side.invert_yaxis()
    top.plot(y, z, color=BLUE, lw=0.8)
    top.set(xlabel="$y$ (cm)", ylabel="$z$ (cm)", title="top")
    top.set_aspect("equal", "datalim")
    whole = frame["valid_element"].values
    arc = np.where(whole, 100 * frame["element_arc_length"].values, np.nan)
    thin.semilogy(arc, np.where(whole, 1e6 * frame["radius"].values, np.nan), color=BLUE)
    thin.set(xlabel="arc length (cm)", ylabel="radius (µm)")
    stretch.semilogy(arc, np.where(whole, frame["stretch_ratio"].values, np.nan), color=GREEN)
    stretch.set(xlabel="arc length (cm)", ylabel="stretch")
    line = np.where(whole, 1e9 * frame["charge"].values / frame["element_length"].values, np.nan)
    charge.plot(arc, line, color=RED)
    charge.set(xlabel="arc length (cm)", ylabel="charge per length (nC/m)")
    _laid(laid, jet)
    return panels if axes is not None else sheet


def _laid(axis: Any, jet: "xr.Dataset") -> None:
    if jet.sizes.get("deposit", 0) == 0:
        axis.text(0.5, 0.5, "nothing has landed", ha="center", va="center", transform=axis.transAxes)
        axis.set_axis_off()
        return
    y, z = (100 * np.stack([jet[f"deposit_{n}0"].values, jet[f"deposit_{n}1"].values]) for n in ("y", "z"))
    axis.plot(y, z, color=ORANGE, lw=0.6)
    axis.plot([], [], color=ORANGE, label="laid")
    axis.set(xlabel="along the collector (cm)", ylabel="across (cm)", title="laid so far")
    axis.set_aspect("equal", "datalim")
    axis.legend(**LEGEND)


def check_animation(path: str | Path) -> Path:
    """Refuse an animation that cannot be made, before anything is computed.

    Raises
    ------
    InputError
        For another format, or .mp4 without ffmpeg.
    """
    from matplotlib import animation

    target = Path(path)
    if target.suffix not in (".gif", ".mp4"):
        raise InputError("--movie", "is no animation", value=str(path), allowed=".gif, .mp4")
    if target.suffix == ".mp4" and not animation.writers.is_available("ffmpeg"):
        raise InputError("--movie", "needs ffmpeg for .mp4", value=str(path), remedy="install it, or write a .gif")
    return target


def write_animation(jet: "xr.Dataset", path: str | Path, *, rate: int = 12, force: bool = True) -> Path:
    """Side view moment by moment: .gif, or .mp4 where ffmpeg is installed.

    Raises
    ------
    InputError
        For another format, or .mp4 without ffmpeg.
    """
    from matplotlib import animation
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    target = check_animation(path)
    sheet = Figure(figsize=(4.5, 6.0), dpi=90)
    FigureCanvasAgg(sheet)
    axis = sheet.subplots()
    x, y = 100 * jet["x"].values, 100 * jet["y"].values
    wide = max(float(np.nanmax(np.abs(y))), 0.02 * float(np.nanmax(x))) * 1.1
    (curve,) = axis.plot([], [], color=BLUE, lw=0.9)
    axis.set(xlim=(-wide, wide), ylim=(float(np.nanmax(x)) * 1.02, 0.0), xlabel="$y$ (cm)", ylabel="$x$ (cm)")

    def draw(index: int) -> tuple[Any, ...]:
        curve.set_data(y[index], x[index])
        axis.set_title(f"{1e3 * float(jet['time'].values[index]):.4g} ms")
        return (curve,)

    film = animation.FuncAnimation(sheet, draw, frames=jet.sizes["time"], interval=1000 / rate)
    with replacing(target, force=force) as place:
        film.save(place, writer="pillow" if target.suffix == ".gif" else "ffmpeg", fps=rate)
    return target
