"""Jets that several tests of the spun solver share (values of the published PVP case, SI)."""

import math
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun.chain import Chain, start_cylinder
from spinline.jetprofile.spun.laws import JetLaw
from spinline.jetprofile.spun.settings import Collector, Grid, Inlet, Loads, SpunSettings

STATC = 3.3356409519815204e-10
PER_CM3 = STATC * 1e6
FIELD = 1.876298 * 299.792458 * 100
R0 = 50e-6
AREA = math.pi * R0**2


def pvp(length: float, speed: float = 1.75, charge: float = 44000.0, stress: str = "free", start: float = 2e-3, **grid):
    """PVP jet with the flow rate given; `length` in m, `charge` in statC/cm3."""
    if grid.get("repulsion", "none") in ("hybrid", "exact"):
        grid = {"feed_length": 0.16, "feed_charge": charge * PER_CM3 * AREA} | grid
    return SpunSettings(
        density=839.253525,
        law=JetLaw("ucm", 5e3 / 3, 0.4e-3),
        inlet=Inlet(AREA * speed, R0, charge_density=charge * PER_CM3, stress=stress, length=start),
        loads=Loads(gap=0.16, field=FIELD, gravity=9.80665),
        grid=Grid(element_length=length, **({"repulsion": "none"} | grid)),
        collector=Collector("none"),
    )


def spun(settings: SpunSettings, time: float) -> Chain:
    chain = start_cylinder(settings)
    chain.march(time)
    return chain


def radii(chain: Chain, at) -> np.ndarray:
    """Radius at positions on the axis: 1/sqrt(pi dx/dq) of the spline through the nodes."""
    y, n = chain.nodes, chain.n
    label = np.concatenate(([0.0], np.cumsum(y[:n, c.LABEL][::-1])))
    return np.sqrt(CubicSpline(y[::-1, c.X], label)(np.asarray(at), 1) / math.pi)


def material(chain: Chain, at) -> np.ndarray:
    """Positions of material points: labels from the front, as lengths at the nozzle's radius, m."""
    y, n = chain.nodes, chain.n
    label = np.concatenate(([0.0], np.cumsum(y[:n, c.LABEL]))) / AREA
    return CubicSpline(label, y[:, :3])(np.asarray(at))


def rotating(
    settings: SpunSettings, frequency: float, amplitude: float = 1e-5, ramp: float = 2e-3, load_ramp: float = 0.0
):
    return replace(
        settings,
        inlet=replace(settings.inlet, amplitude=amplitude, frequency=frequency, ramp=ramp),
        loads=replace(settings.loads, ramp=load_ramp),
    )


def orders(results: list[np.ndarray]) -> np.ndarray:
    """Observed orders of the last three of a sequence of halved grids."""
    first, second = results[-3] - results[-2], results[-2] - results[-1]
    if first.ndim > 1:
        first, second = np.linalg.norm(first, axis=-1), np.linalg.norm(second, axis=-1)
    return np.log2(np.abs(first) / np.abs(second))
