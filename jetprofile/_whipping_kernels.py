"""The march of `spinline.jetprofile.whipping.thinning`, compiled: one jet after another."""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile._solvents_kernels import leave

__all__ = ["march"]


@njit(cache=True, error_model="numpy")
def _gained(
    x: float, u0: float, u1: float, width: float, electric: float, gamma: float, mobility: float, p: float
) -> float:
    """Growth of ``x = 1/A^2`` over a step: the electric part exact, surface tension implicit, never past terminal."""
    free = mobility * electric * u0**p * -math.expm1(p * math.log1p(-width / u0)) / p
    terminal = (electric / (gamma * math.sqrt(0.5 * (u0 + u1)))) ** (4.0 / 3.0)
    y0 = min(x / terminal, 1.0)
    share = min(free / terminal, 1e12)
    if share < 1e-9:
        small: float = free * (1.0 - y0**0.75)
        return small
    y = y0
    for _ in range(30):  # Newton on y = y0 + share (1 - y^(3/4)): monotone, so kept between y0 and 1
        root = max(y, 1e-300) ** 0.75
        new = y - (y - y0 - share * (1.0 - root)) / (1.0 + 0.75 * share * root / max(y, 1e-300))
        new = min(max(new, y0), 1.0)
        done = abs(new - y) <= 1e-14 * new
        y = new
        if done:
            break
    value: float = max(y - y0, 0.0) * terminal
    return value


@njit(cache=True, error_model="numpy")
def march(given: FloatArray, solvents: FloatArray, rates: FloatArray, stations: FloatArray, out: FloatArray) -> None:
    """March jets: `given` (jet, 7) of electric, gamma, eta, flight, start, power, span; `out` (jet, 5).

    `solvents` (jet, solvent) are the parts of the undried volume at the start, and are used up; `rates` theirs.

    `out` holds ``x = 1/A^2``, the undried fraction left, the time, the mean rate of stretching, and 1 where it landed wet.
    """
    for i in range(given.shape[0]):
        electric, gamma, eta, flight = given[i, 0], given[i, 1], given[i, 2], given[i, 3]
        p, span = given[i, 5], given[i, 6]
        x, time, left, strain, weighted, landed = given[i, 4] ** -4.0, 0.0, 1.0, 0.0, 0.0, False
        u1 = 1.0
        for j in range(1, stations.size):
            u0, step = u1, span * (stations[j] - stations[j - 1])
            u1 = math.exp(-span * stations[j])
            width = u0 * -math.expm1(-step)
            dried = leave(solvents[i], rates[i], width)  # width/dried is the mean rate of the step
            gained = _gained(x, u0, u1, width, electric, gamma, 2 * dried / (width * eta), p)
            # exact where x is linear over the step, and so is the part of it that there is time for
            spent = 2 * dried / (math.sqrt(x + gained) + math.sqrt(x))
            part, took = 1.0, spent
            if spent > flight - time:
                pace = max(flight - time, 0.0) / (2 * dried)
                part, took = min(pace * (2 * math.sqrt(x) + pace * gained), 1.0), flight - time
                landed = True
            longer = 0.5 * math.log1p(part * gained / x)
            if took > 0:
                weighted += longer * longer / took
            strain += longer
            x, time, left = x + part * gained, time + took, u0 - part * width
            if landed:
                break
        out[i, 0], out[i, 1], out[i, 2] = x, left, time
        out[i, 3] = weighted / strain if strain > 0 else 0.0
        out[i, 4] = 1.0 if landed else 0.0
