"""March of a drying jet: steps of Radau's method with error control, restarted where the jet's profile has a kink."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.rheology._drying_kernels import NODES, STAGES, interpolate
from spinline.rheology._map_kernels import NO_HEAT, Heat, attempt
from spinline.rheology.diffusion_laws import DiffusionLaw

__all__ = ["March", "march", "tabulated"]

_PIECES = 4096
_MOST_STEPS = 20_000
_SHORTEST = 1e-25  # step over the way


def tabulated(law: DiffusionLaw) -> FloatArray:
    """Cubic pieces of ln D on [0, 1], for the compiled loops: to 1e-10 for a law that is smooth over 1e-2."""
    phi = np.linspace(0.0, 1.0, _PIECES + 1)
    return np.ascontiguousarray(CubicSpline(phi, np.log(law(phi))).c)


@dataclass(frozen=True)
class March:
    """At the places asked for: u in the cells and what has left (n, m + 1), the time, and with heat the enthalpy that has
    passed the surface (J per m3 at the start); place and time of events, or NaN.
    """

    values: FloatArray
    time: FloatArray
    events: tuple[tuple[float, float], ...]
    enthalpy: FloatArray


@dataclass
class _Books:
    """Enthalpy through the surface so far, and the temperature that it leaves: both conserved to rounding."""

    share: FloatArray
    heat: Heat
    start: float
    passed: float = 0.0

    @classmethod
    def open(cls, y: FloatArray, share: FloatArray, heat: Heat) -> "_Books | None":
        """Those of a jet at its start; None without heat."""
        if not heat[0].size:
            return None
        books = cls(share, heat, 0.0)
        books.start = float(books._capacity(y[np.newaxis])[0] * (y[share.size] - heat[2][1]))
        return books

    def _capacity(self, state: FloatArray) -> FloatArray:
        sub, _, air = self.heat
        value: FloatArray = air[3] * (air[8] + (state[:, : self.share.size] @ self.share) * sub[0, 0] * sub[0, 2])
        return value

    def at(self, theta: FloatArray, ticks: FloatArray, states: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Enthalpy passed until `theta` of a step, and the states (theta, n) with the temperature that it leaves."""
        passed = self.passed + interpolate(ticks[:, np.newaxis], theta)[:, 0]
        states[:, self.share.size] = self.heat[2][1] + (self.start + passed) / self._capacity(states)
        return passed, states


def march(
    start: float,
    positions: FloatArray,
    breaks: FloatArray,
    y: FloatArray,
    share: FloatArray,
    table: FloatArray,
    air: FloatArray,
    along: Callable[[FloatArray], FloatArray],
    rtol: float,
    atol: FloatArray,
    events: tuple[tuple[int, float], ...] = (),
    heat: Heat = NO_HEAT,
) -> March:
    """Solve from `start` to the last position.

    Parameters
    ----------
    start, positions, breaks
        m; positions increasing, none before the start; kinks of the jet.
    y : ndarray, (m + 1,)
        State at the start.
    share, table, air
        As `_drying_kernels.fluxes` takes them.
    along : callable
        Stretch, speed and pace at places: (n,) to (n, 3).
    rtol, atol : float, ndarray (m + 1,)
    events : tuple of (cell, u)
        First place where u of a cell falls to a value.
    heat : tuple of ndarray, optional
        What `_map_kernels.surface_rates` takes: the state then has the temperature between the cells and the loss.

    Raises
    ------
    InputError
        Where the equations cannot be followed.
    """
    values, time, enthalpy = np.tile(y, (positions.size, 1)), np.zeros(positions.size), np.zeros(positions.size)
    nan, clock, books = float("nan"), 0.0, _Books.open(y, share, heat)
    found = [(nan, nan)] * len(events)
    amount, kept = air[6] * air[7] ** 2, air[10] > 0
    x, end = start, float(positions[-1])
    marks = [float(b) for b in breaks if start < b < end]
    stages, first, error, booked_rates = np.zeros((3, y.size)), np.empty(y.size), np.empty(y.size), np.empty(3)
    tolerance = max(10 * np.finfo(float).eps / rtol, min(0.03, rtol**0.5))
    taken, h = 0, 0.0
    for stop in [*marks, end]:
        guess, known, old_h, old_size = np.zeros_like(stages), False, 0.0, 0.0
        if not h:
            h = _first_step(stop - x, y, x, share, table, air, along, rtol, atol, heat)
        while x < stop:
            taken += 1
            if taken > _MOST_STEPS or h < max(16 * np.spacing(abs(x)), _SHORTEST * (end - start)):
                raise InputError(
                    "jet",
                    f"cannot be dried beyond {x:.6g} m: the fraction across it changes too fast there",
                    remedy="more cells, a smoother D(phi), or effects.radial = false",
                )
            last = x + h >= stop or stop - x - h < 0.05 * h
            step = stop - x if last else h
            places = along(np.concatenate(([x], x + NODES[:2] * step, [x + (1 - 1e-12) * step])))  # this side of a kink
            scale = atol + rtol * np.abs(y)
            if known:
                guess = interpolate(stages, 1 + NODES * step / old_h) - stages[2]
            done, _, size = attempt(
                y,
                step,
                guess,
                scale,
                tolerance,
                share,
                table,
                air,
                heat,
                places,
                trial := np.empty_like(stages),
                first,
                error,
                booked_rates,
            )
            if not done:
                if known:  # once more without the guess
                    known = False
                    guess = np.zeros_like(stages)
                    h = 0.5 * step
                else:
                    h = 0.25 * step
                continue
            safety = 0.9 * 17 / (16 + done)
            if size > 1:
                h = step * max(0.2, min(0.9, safety * size**-0.25))
                known = False
                guess = np.zeros_like(stages)
                continue
            after = y + trial[2]
            if books is not None:
                through = step * (STAGES @ booked_rates)
                passed, booked = books.at(np.ones(1), through, after[np.newaxis].copy())
                if abs(booked[0, share.size] - after[share.size]) > scale[share.size]:
                    h, known, guess = 0.5 * step, False, np.zeros_like(stages)
                    continue
            left = air[6] * ((y + trial)[:, : share.size] + 1) @ share if kept else 1.0
            ticks = step * (STAGES @ (places[1:, 2] * amount / (places[1:, 0] * left)))
            inside = np.flatnonzero((positions > x) & (positions <= (stop if last else x + step)))
            share_of_step = np.minimum((positions[inside] - x) / step, 1.0)
            values[inside] = y + interpolate(trial, share_of_step)
            if books is not None:
                enthalpy[inside], values[inside] = books.at(share_of_step, through, values[inside])
                books.passed, after = float(passed[0]), booked[0]
            if inside.size:
                time[inside] = clock + interpolate(ticks[:, np.newaxis], share_of_step)[:, 0]
            for i, (cell, level) in enumerate(events):
                if np.isnan(found[i][0]) and y[cell] > level >= after[cell]:
                    theta = _root(trial, y, cell, level)
                    found[i] = (
                        x + step * theta,
                        clock + float(interpolate(ticks[:, np.newaxis], np.asarray([theta]))[0, 0]),
                    )
            factor = 0.9 * 17 / (16 + done) * (size**-0.25 if size > 0 else 10.0)
            if known and old_size > 0 and size > 0:  # Gustafsson's predictor
                factor = min(factor, factor * step / old_h * (old_size / size) ** 0.25)
            x, y, stages, clock = (stop if last else x + step), after, trial, clock + float(ticks[2])
            h, old_h, old_size, known = step * min(8.0, max(0.2, factor)), step, max(size, 1e-4), True
    return March(values, time, tuple(found), enthalpy)


def _first_step(
    span: float,
    y: FloatArray,
    x: float,
    share: FloatArray,
    table: FloatArray,
    air: FloatArray,
    along: Callable[[FloatArray], FloatArray],
    rtol: float,
    atol: FloatArray,
    heat: Heat,
) -> float:
    """A hundredth of what the outermost cell changes by in scale, no more than the way to go."""
    places = along(np.full(4, x + 1e-9 * span))
    first, error, stages = np.empty(y.size), np.empty(y.size), np.zeros((3, y.size))
    scale = atol + rtol * np.abs(y)
    no_guess, rest = np.zeros_like(stages), np.empty(3)
    attempt(y, 1e-30 * span, no_guess, scale, 1.0, share, table, air, heat, places, stages, first, error, rest)
    rate = float(np.max(np.abs(first) / scale))
    return min(span, 0.1 / rate) if rate > 0 else span


def _root(stages: FloatArray, y: FloatArray, cell: int, level: float) -> float:
    def excess(theta: float) -> float:
        return float(y[cell] + interpolate(stages[:, cell : cell + 1], np.asarray([theta]))[0, 0] - level)

    return float(brentq(excess, 0.0, 1.0, xtol=1e-13)) if excess(0.0) > 0 >= excess(1.0) else 1.0
