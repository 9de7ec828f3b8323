"""Settings of the PEO jet that tests of a needle's jet share: 5 wt% in water (Fig. 35's liquid), 6 kV over 10 cm."""

from typing import Any

from spinline.jetprofile.ehd import NeedleSettings

PEO: dict[str, Any] = {
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
    """That needle, with some settings changed."""
    return NeedleSettings(**(PEO | change))
