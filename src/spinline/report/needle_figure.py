"""Figure of the jet of a needle's settings: how it thins, what pulls it, who carries the current."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from spinline.jetprofile.ehd import StraightEhdJet

__all__ = ["needle_figure", "save_needle_figure"]


def needle_figure(jet: "StraightEhdJet", axes: Any = None) -> Any:
    """Four panels: radius, strain rate, tension and stress, shares of the current; returns the axes.

    Parameters
    ----------
    jet : StraightEhdJet
    axes : array of matplotlib axes, optional
        Four of them.
    """
    if axes is None:
        import matplotlib.pyplot as plt

        _, axes = plt.subplots(2, 2, figsize=(8, 6), layout="constrained", sharex=True)
    radius, rate, force, current = np.ravel(axes)
    z = jet.initial_radius / 4 * np.expm1(np.linspace(0.0, np.log1p(4 * jet.end / jet.initial_radius), 401))
    z[-1] = jet.end
    mm = z * 1e3
    radius.semilogy(mm, jet.radius(z) * 1e6)
    radius.set_ylabel("jet radius (µm)")
    radius.yaxis.set_major_formatter("{x:g}")
    radius.yaxis.set_minor_formatter("{x:g}")
    rate.semilogy(mm, jet.strain_rate(z))
    if jet.settings.relaxation_time > 0:
        rate.axhline(1 / jet.settings.relaxation_time, ls=":", c="0.5")
        rate.annotate("1/θ", (mm[-1], 1 / jet.settings.relaxation_time), ha="right", va="bottom", color="0.4")
    rate.set_ylabel("strain rate (1/s)")
    force.plot(mm, jet.tension(z) * 1e6, c="C0")
    force.set_ylabel("tension (µN)", color="C0")
    force.set_ylim(bottom=0)
    stress = force.twinx()
    stress.semilogy(mm, jet.tensile_stress(z) / 1e3, c="C1")
    stress.set_ylabel("N1 (kPa)", color="C1")
    share = jet.conduction_share(z)
    current.plot(mm, share, label="conducted")
    current.plot(mm, 1 - share, label="carried by the surface")
    current.set_ylim(0, 1)
    current.set_ylabel(f"share of {jet.current * 1e9:.3g} nA")
    current.legend(loc="center left")
    for axis in (force, current):
        axis.set_xlabel("distance from the needle (mm)")
    early, late = jet.bending.earliest, jet.bending.latest
    radius.set_xlim(0, mm[-1])
    if early < jet.end:
        for axis in (radius, rate, force, current):
            axis.axvspan(
                early * 1e3, min(late if np.isfinite(late) else jet.end, jet.end) * 1e3, color="C3", alpha=0.12, lw=0
            )
        radius.set_title("shaded: bending sets in", fontsize="small", color="C3")
    return axes


def save_needle_figure(jet: "StraightEhdJet", path: Path, *, force: bool = True) -> None:
    """Draw and save."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from spinline.report.style import save_sheet

    figure = Figure(figsize=(8, 6), layout="constrained")
    FigureCanvasAgg(figure)
    needle_figure(jet, figure.subplots(2, 2, sharex=True))
    save_sheet(figure, path, force=force, dpi=150)
