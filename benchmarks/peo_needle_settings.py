"""Settings of the PEO jet that the needle's benchmarks share: 5 wt% of 600 kDa in water, the liquid of the review's Fig. 35."""

from typing import Any

from spinline.jetprofile.ehd import NeedleSettings

__all__ = ["peo_needle"]

_PEO: dict[str, Any] = {
    "radius": 125e-6,
    "flow_rate": 3.2e-6 / 3600,
    "voltage": 6e3,
    "gap": 0.1,
    "conductivity": 0.01,
    "viscosity": 2.0,
    "surface_tension": 0.061,
    "density": 1000.0,
    "permittivity": 80.0,
    "relaxation_time": 7e-3,
    "extensibility": 507.0,
}


def peo_needle(**change: Any) -> NeedleSettings:
    """That needle at 6 kV over 10 cm, with some settings changed."""
    return NeedleSettings(**(_PEO | change))
