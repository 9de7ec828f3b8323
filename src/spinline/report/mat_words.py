"""A mat's numbers in words, without what draws pictures."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["sentences"]


def sentences(result: "xr.Dataset") -> list[str]:
    """The answer in words."""
    get = {str(name): float(value) for name, value in result.data_vars.items() if not value.dims}
    shares = zip(result["envelope"].values, result["envelope_porosity"].values, strict=True)
    envelopes = ", ".join(f"{f'{100 * float(p):.1f} %' if np.isfinite(p) else 'none'} ({e})" for e, p in shares)
    windows = f"{result.attrs['realisations']} windows of {float(result.attrs['window_m']) * 1e6:.3g} µm"
    lines = [
        f"{get['laid_length']:.4g} m of fibre, diameter {get['mean_diameter'] * 1e9:.4g} ± "
        f"{get['diameter_deviation'] * 1e9:.3g} nm (length-weighted)",
        f"areal density {_both(get, 'areal_density', 1e3)} g/m2, thickness {_both(get, 'mean_thickness', 1e6)} µm in {windows}",
        f"porosity {envelopes} at slope m = {float(result.attrs['slope']):g} (an input: porosity follows from it)",
        f"order parameter S2 {get['order_parameter']:.3f} about {np.degrees(get['director']):.1f}° to the machine",
    ]
    if np.isfinite(get["bubble_point_radius"]):
        lines.append(f"bubble-point radius {_both(get, 'bubble_point_radius', 1e6)} µm")
    names = ("law", "permeability", "pressure_drop")
    speed = f"{float(result.attrs['face_velocity']) * 100:g} cm/s"
    for name, k, drop in zip(*(result[n].values for n in names), strict=True):
        if np.isfinite(k):
            lines.append(f"permeability {k:.3g} m2 by {name}: {drop:.3g} Pa at {speed}")
        else:
            lines.append(f"permeability: {name} does not hold at this solidity")
    if "permeability_direct" in result:
        lines.append(f"permeability {get['permeability_direct']:.3g} m2 by the Stokes flow through the first window")
    if "measured_mean_ratio" in result:
        value, low, high = result["measured_mean_ratio"].values
        lines.append(f"measured mean diameter over laid: {value:.3g} (95 %: {low:.3g} to {high:.3g})")
    return lines


def _both(numbers: dict[str, float], name: str, scale: float) -> str:
    """Mean and standard deviation over the windows."""
    spread = numbers[f"{name}_std"] * scale
    return f"{numbers[name] * scale:.3g}" + (f" ± {spread:.2g}" if np.isfinite(spread) else "")
