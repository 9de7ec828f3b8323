"""Runs at one temperature, with a theta solvent and no crystals: heat, library interactions and solids are in
test_heat_run.py.
"""

import warnings

import xarray as xr

import spinline as sl
from spinline.base.errors import SpinlineWarning

ISOTHERMAL = ("effects.heat=false", "rheology.chi=0.5", "rheology.crystallisation=none")
HUMID = "ambient.relative_humidity=0.4"
WET = (HUMID, "effects.evaporation=true")
LONG = "jet.length=10 mm"
RELAXING = ("solution.relaxation_time=10 ms", "network.model=conformation")
ACROSS = (*WET, "effects.radial=true", "rheology.diffusivity=1e-10 m2/s")


def quiet(name: str, *overrides: str) -> xr.Dataset:
    """Run without remarks; anything numpy has to say is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", SpinlineWarning)
        warnings.filterwarnings("ignore", module="chemicals")
        return sl.run(sl.load_scene(name, (*ISOTHERMAL, *overrides)))
