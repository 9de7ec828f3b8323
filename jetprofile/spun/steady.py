"""Rung 0: the steady quasi-one-dimensional jet with Q and I given, charge frozen, and a smooth passage of the wave speed.

``rho Q v' = T' + lambda E + rho A g``, ``T = P + alpha pi r - lambda^2 [ln(L/r) - m/2]/(4 pi eps0)`` (m = 1: Maxwell's radial
pressure, from the energy), ``P = A G (A_zz - A_rr)``, ``lambda = I/v``; upper-convected Maxwell along the jet. Eliminating A:

``v' [rho A c^2 - rho Q v]/v = P-relaxation + lambda E + rho A g``,
``rho A c^2 = A G (A_zz + 2 A_rr) - alpha pi r/2 + lambda^2 [2 ln(L/r) - (1 + 2 m)/2]/(4 pi eps0)``.

A jet that leaves slower than c and ends faster passes v = c once; there both sides vanish together, which fixes the
tension at the inlet as choked flow does. A jet that leaves faster has its inlet stress given; one that never passes takes it
from its far end, and is refused here.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from spinline.base.checks import FloatArray, computable, number, positive, real
from spinline.base.errors import InputError
from spinline.jetprofile.spun._codes import COULOMB

__all__ = ["SteadyJet", "steady_jet"]


@dataclass(frozen=True)
class SteadyJet:
    """A steady jet at positions `z` (m); SI. `sonic` is where v passes c, m (NaN: faster from the start)."""

    z: FloatArray
    radius: FloatArray
    velocity: FloatArray
    axial: FloatArray
    radial: FloatArray
    tension: FloatArray
    wave_speed: FloatArray
    sonic: float


@dataclass(frozen=True)
class _Model:
    density: float
    modulus: float
    theta: float
    flow: float
    current: float
    field: float
    gravity: float
    surface: float
    log_length: float
    pressure: float

    def parts(self, y: FloatArray) -> tuple[float, float, float, float]:
        """v, the factor of v', the driving side, and rho A c^2."""
        v, azz, arr = math.exp(min(max(y[0], -100.0), 100.0)), y[1], y[2]  # a trial step may overshoot
        area = self.flow / v
        r = math.sqrt(area / math.pi)
        charge = self.current / v
        stiff = area * self.modulus * (azz + 2 * arr) - 0.5 * self.surface * math.pi * r
        if charge and self.log_length:
            stiff += COULOMB * charge**2 * (2 * math.log(self.log_length / r) - 0.5 - self.pressure)
        relax = area * self.modulus * (azz - arr) / (self.theta * v)
        drive = charge * self.field + self.density * area * self.gravity - relax
        return v, self.density * self.flow * v - stiff, drive, stiff

    def rates(self, _: float, y: FloatArray) -> list[float]:
        v, factor, drive, _stiff = self.parts(y)
        rise = drive / factor  # (ln v)'
        return [rise, 2 * rise * y[1] - (y[1] - 1) / (self.theta * v), -rise * y[2] - (y[2] - 1) / (self.theta * v)]


@computable
def steady_jet(
    z: ArrayLike,
    *,
    density: float,
    modulus: float,
    relaxation_time: float,
    flow_rate: float,
    radius: float,
    current: float = 0.0,
    field: float = 0.0,
    gravity: float = 9.80665,
    surface_tension: float = 0.0,
    log_length: float = 0.0,
    pressure: bool = True,
    axial: float = 1.0,
    radial: float = 1.0,
    rtol: float = 1e-11,
) -> SteadyJet:
    """Solve the steady jet.

    Parameters
    ----------
    z : array_like
        Increasing positions >= 0 from the inlet, m.
    density, modulus, relaxation_time, surface_tension
        kg/m3, Pa, s, N/m.
    flow_rate, radius, current
        Q (m3/s), the radius (m) and the convected current (A) at the inlet.
    field, gravity : float
        V/m, m/s2, along the jet.
    log_length : float
        L of the charge's own force, m; 0 leaves it out.
    pressure : bool
        With Maxwell's radial pressure.
    axial, radial : float
        A_zz and A_rr at the inlet; A_zz is used only where the jet leaves faster than its wave speed.
    rtol : float
        Of the integration.

    Returns
    -------
    SteadyJet

    Raises
    ------
    InputError
        Where no smooth passage exists (the far end then decides), or values are out of range.
    """
    at = np.atleast_1d(real("z", z, least=0.0, unit="m"))
    if at.ndim != 1 or not at.size or (np.diff(at) <= 0).any():
        raise InputError("z", "must increase and hold one position or more")
    model = _Model(
        positive("density", density, "kg/m3"),
        positive("modulus", modulus, "Pa"),
        positive("relaxation_time", relaxation_time, "s"),
        positive("flow_rate", flow_rate, "m3/s"),
        number("current", current),
        number("field", field),
        number("gravity", gravity),
        number("surface_tension", surface_tension, least=0.0),
        number("log_length", log_length, least=0.0),
        float(pressure),
    )
    v0 = flow_rate / (math.pi * positive("radius", radius, "m") ** 2)
    arr = positive("radial", radial)
    start = np.array([math.log(v0), positive("axial", axial), arr])
    end = max(float(at[-1]), 1e-12)
    if model.parts(start)[1] > 0.0:
        found = solve_ivp(model.rates, (0.0, end), start, method="DOP853", t_eval=at, rtol=rtol, atol=1e-12)
        return _result(model, at, found.y, math.nan)
    return _through(model, at, end, v0, arr, rtol)


_NEAR = 2e-3  # how far short of v = c (in momentum flux) a trial is stopped: beyond, the passage is a saddle


def _room(model: _Model, y: FloatArray) -> float:
    """``1 - c^2/v^2``: below 0 while the jet is slower than its waves."""
    v, factor, _, _ = model.parts(y)
    return factor / (model.density * model.flow * v)


def _march(
    model: _Model,
    azz: float,
    v0: float,
    arr: float,
    end: float,
    rtol: float,
    method: Literal["DOP853", "LSODA"] = "DOP853",
) -> tuple[int, FloatArray, FloatArray]:
    """March from the inlet: fate, positions, states (ln v, A_zz, A_rr).

    +1: v comes near c; -1: it falls far below its start; 0: neither before the end.
    """

    def sonic(_: float, y: FloatArray) -> float:
        return _room(model, y) + _NEAR

    def stall(_: float, y: FloatArray) -> float:
        value: float = y[0] - math.log(0.3 * v0)
        return value

    sonic.terminal = stall.terminal = True  # type: ignore[attr-defined]
    start = np.array([math.log(v0), azz, arr])
    if sonic(0.0, start) >= 0.0:
        return 1, np.zeros(1), start[:, None]
    found = solve_ivp(model.rates, (0.0, end), start, method=method, rtol=rtol, atol=1e-13, events=(sonic, stall))
    events = found.t_events or [np.zeros(0), np.zeros(0)]
    fate = 1 if events[0].size else -1 if events[1].size else 0
    return fate, found.t, found.y


def _inlet(model: _Model, v0: float, arr: float, far: float, rtol: float) -> float:
    """The inlet's A_zz of the jet that passes its wave speed smoothly: between those that stall and those that choke."""
    least = max((model.density * v0 * v0 - 2 * arr * model.modulus) / model.modulus, 0.0)
    grid = least + np.geomspace(1e-2, 1e6, 50)
    fates = [_march(model, float(a), v0, arr, far, 1e-7, "LSODA")[0] for a in grid]
    turns = [i for i in range(len(fates) - 1) if fates[i] != 1 and fates[i + 1] == 1]
    if not turns:
        raise InputError(
            "flow_rate",
            "gives no jet that passes its wave speed: the far end decides its tension",
            value=model.flow,
            remedy="solve the moving jet, or give the tension at its end",
        )
    low, high = float(grid[turns[0]]), float(grid[turns[0] + 1])
    method: Literal["DOP853", "LSODA"] = "LSODA"
    while True:
        mid = 0.5 * (low + high)
        if mid in (low, high):
            return mid
        if method == "LSODA" and high - low < 1e-3 * high:  # the last digits by the scheme that is used afterwards
            low, high, method = max(low - 1e-3 * high, 0.5 * low), high + 1e-3 * high, "DOP853"
        if _march(model, mid, v0, arr, far, rtol if method == "DOP853" else 1e-8, method)[0] == 1:
            high = mid
        else:
            low = mid


def _through(model: _Model, at: FloatArray, end: float, v0: float, arr: float, rtol: float) -> SteadyJet:
    """Bisect the inlet's stress, and carry the trajectory across v = c by a cubic in z through states before it."""
    far = max(10.0 * end, 1e3 * math.sqrt(model.flow / (math.pi * v0)))
    azz = _inlet(model, v0, arr, far, rtol)
    start = np.array([math.log(v0), azz, arr])

    def short(_: float, y: FloatArray) -> float:
        return _room(model, y) + 0.05

    short.terminal = True  # type: ignore[attr-defined]
    first = solve_ivp(
        model.rates, (0.0, far), start, method="DOP853", rtol=rtol, atol=1e-13, events=short, dense_output=True
    )
    path = first.sol
    assert path is not None
    stop = float(first.t[-1])
    back = np.linspace(0.0, 1.0, 9)
    width = stop - _place(model, path, stop, -0.25)
    if first.status != 1 or not width > 0.0:
        raise InputError(
            "radius",
            "lets the jet leave so near its wave speed that the passage lies at the inlet",
            value=math.sqrt(model.flow / (math.pi * v0)),
            remedy="solve the moving jet",
        )
    nodes = stop - width * back
    fit = [np.polynomial.Polynomial.fit((nodes - stop) / width, path(nodes)[row], 4) for row in range(3)]

    def crossing(x: float) -> FloatArray:
        return np.array([float(p((x - stop) / width)) for p in fit])

    beyond = stop
    while _room(model, crossing(beyond)) < 0.03:
        beyond += 0.02 * width
        if beyond > stop + 3 * width:
            raise InputError("flow_rate", "gives a passage of the wave speed too slow to be followed", value=model.flow)
    states = np.empty((3, at.size))
    for i, x in enumerate(at):
        states[:, i] = path(x) if x <= stop else crossing(float(x))
    rest = at > beyond
    if rest.any():
        found = solve_ivp(
            model.rates, (beyond, end), crossing(beyond), method="DOP853", t_eval=at[rest], rtol=rtol, atol=1e-13
        )
        states[:, rest] = found.y
    low, high = stop, beyond
    for _ in range(60):
        mid = 0.5 * (low + high)
        low, high = (mid, high) if _room(model, crossing(mid)) < 0.0 else (low, mid)
    return _result(model, at, states, 0.5 * (low + high))


def _place(model: _Model, sol: Callable[[float], FloatArray], stop: float, room: float) -> float:
    """Where on a trajectory the room is `room` (or its start)."""
    low, high = 0.0, stop
    if _room(model, sol(0.0)) > room:
        return 0.0
    for _ in range(60):
        mid = 0.5 * (low + high)
        low, high = (mid, high) if _room(model, sol(mid)) < room else (low, mid)
    return low


def _result(model: _Model, at: FloatArray, y: FloatArray, sonic: float) -> SteadyJet:
    v = np.exp(y[0])
    area = model.flow / v
    stiff = np.array([model.parts(column)[3] for column in y.T])
    return SteadyJet(
        z=at,
        radius=np.sqrt(area / np.pi),
        velocity=v,
        axial=y[1],
        radial=y[2],
        tension=area * model.modulus * (y[1] - y[2]),
        wave_speed=np.sqrt(np.maximum(stiff, 0) / (model.density * area)),
        sonic=sonic,
    )
