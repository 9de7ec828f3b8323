"""The nozzle's point and the making of new elements, compiled.

One element of the volume `step` enters per ``step/Q``. The element at the nozzle grows from half to one and a half of it;
then it is split into a closed element and a growing one. The new node lies on the cubic through the nozzle (value, and
slope ``dx/dq = 1/A0`` that the flow rate dictates) and the next two nodes; its velocity on the cubic through four
nodes; stress and charge are linear in the label with their mean kept, so nothing is made or lost.

A liquid that enters relaxed is pulled thin by its solvent's viscosity alone, within ``3 mu_s Q/P``: less than an element.
What it keeps of that is ``A_zz A^2`` (and ``A_rr/A``), so where it enters relaxed these are what an element that grows
takes in and what its split keeps (`affine_inlet`).
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    AMPLITUDE,
    ARR,
    ARR_IN,
    AZZ,
    AZZ_IN,
    CHARGE,
    COLUMNS,
    CONFORMATION,
    FLOW,
    INLET,
    LABEL,
    LAW,
    MX,
    OMEGA,
    PHASE,
    PRESCRIBED,
    RAMP,
    SOLVENT,
    TEMP,
    VOLUME,
    VX,
    IntArray,
    X,
    Y,
    Z,
)

__all__ = ["affine_inlet", "lagrange", "nozzle", "smooth", "split"]


@njit(cache=True, error_model="numpy")
def smooth(t: float, span: float) -> tuple[float, float]:
    """Ramp from 0 to 1 with two continuous derivatives, and its rate."""
    if span <= 0.0 or t >= span:
        return 1.0, 0.0
    if t <= 0.0:
        return 0.0, 0.0
    u = t / span
    return u * u * u * (10.0 + u * (-15.0 + 6.0 * u)), 30.0 * u * u * (1.0 - u) ** 2 / span


@njit(cache=True, error_model="numpy")
def nozzle(t: float, n: int, speed: float, y: FloatArray, p: FloatArray) -> None:
    """Put the nozzle node on its circle and give it the speed at which material leaves."""
    share, rise = smooth(t, p[RAMP])
    turn = p[OMEGA] * t + p[PHASE]
    c, s = p[AMPLITUDE] * math.cos(turn), p[AMPLITUDE] * math.sin(turn)
    y[n, X], y[n, Y], y[n, Z] = 0.0, share * c, share * s
    y[n, VX] = speed
    y[n, VX + 1] = rise * c - share * p[OMEGA] * s
    y[n, VX + 2] = rise * s + share * p[OMEGA] * c


@njit(cache=True, error_model="numpy")
def lagrange(at: float, s0: float, s1: float, s2: float, s3: float) -> tuple[float, float, float, float]:
    """Weights of a cubic through four labels."""
    return (
        (at - s1) * (at - s2) * (at - s3) / ((s0 - s1) * (s0 - s2) * (s0 - s3)),
        (at - s0) * (at - s2) * (at - s3) / ((s1 - s0) * (s1 - s2) * (s1 - s3)),
        (at - s0) * (at - s1) * (at - s3) / ((s2 - s0) * (s2 - s1) * (s2 - s3)),
        (at - s0) * (at - s1) * (at - s2) / ((s3 - s0) * (s3 - s1) * (s3 - s2)),
    )


@njit(cache=True, error_model="numpy")
def affine_inlet(p: FloatArray, k: IntArray) -> bool:
    """Whether the first stretch may be shorter than an element: relaxed liquid, and a solvent that carries the pull."""
    relaxed = p[AZZ_IN] == 1.0 and p[ARR_IN] == 1.0
    value: bool = relaxed and k[INLET] == PRESCRIBED and k[LAW] == CONFORMATION and p[SOLVENT] > 0.0
    return value


@njit(cache=True, error_model="numpy")
def split(n: int, step: float, speed: float, y: FloatArray, p: FloatArray, k: IntArray) -> None:
    """Split the growing element; afterwards the chain has n + 1 elements and the nozzle is node n + 1."""
    grown = y[n - 1, LABEL]
    new = grown - step
    whole = _length(n - 1, n, y)
    s1 = grown
    s2 = s1 + (y[n - 2, LABEL] if n > 1 else step)
    s3 = s2 + (y[n - 3, LABEL] if n > 2 else step)
    for c in range(COLUMNS):
        y[n + 1, c] = y[n, c]
    # position: x(s) = x_n + b s + c2 s^2 + c3 s^3, through nodes n - 1 and n - 2
    for c in range(3):
        slope = speed / p[FLOW] if c == 0 else 0.0
        if n > 1:
            u1 = (y[n - 1, X + c] - y[n + 1, X + c] - slope * s1) / (s1 * s1)
            u2 = (y[n - 2, X + c] - y[n + 1, X + c] - slope * s2) / (s2 * s2)
            cubic = (u2 - u1) / (s2 - s1)
            square = u1 - cubic * s1
        else:
            square, cubic = (y[n - 1, X + c] - y[n + 1, X + c] - slope * s1) / (s1 * s1), 0.0
        y[n, X + c] = y[n + 1, X + c] + new * (slope + new * (square + new * cubic))
        y[n, VX + c] = _velocity(n, c, new, s1, s2, s3, y)
        y[n, MX + c] = 0.5 * y[n - 1, MX + c]
    azz, arr = y[n - 1, AZZ], y[n - 1, ARR]
    _share(n, grown, new, step, y)
    if affine_inlet(p, k):
        _affine(n, new / grown, whole, azz, arr, y)


@njit(cache=True, error_model="numpy")
def _velocity(n: int, c: int, at: float, s1: float, s2: float, s3: float, y: FloatArray) -> float:
    """Velocity component c of the new node, from the nozzle (now node n + 1) and up to three nodes."""
    if n > 2:
        a, b, d, e = lagrange(at, 0.0, s1, s2, s3)
        value: float = a * y[n + 1, VX + c] + b * y[n - 1, VX + c] + d * y[n - 2, VX + c] + e * y[n - 3, VX + c]
        return value
    part = at / s1
    value = (1.0 - part) * y[n + 1, VX + c] + part * y[n - 1, VX + c]
    return value


@njit(cache=True, error_model="numpy")
def _share(n: int, grown: float, new: float, step: float, y: FloatArray) -> None:
    """Conformation (linear in its logarithm), charge and volume of the two parts; means kept."""
    old = n - 1
    before = y[n - 2, LABEL] if n > 1 else step
    apart = 0.5 * (grown + before)
    near, far = 0.5 * (new - grown), 0.5 * (grown - step)  # centres of the new parts from that of the old element
    for col in (AZZ, ARR):
        own = y[old, col]
        rise = 0.0
        if n > 1 and own > 0.0 and y[n - 2, col] > 0.0:
            rise = math.log(y[n - 2, col] / own) / apart
        y[n, col] = own * math.exp(rise * near)
        y[old, col] = own * math.exp(rise * far)
    charge, volume = y[old, CHARGE], y[old, VOLUME]
    density = charge / grown
    rise = (y[n - 2, CHARGE] / before - density) / apart if n > 1 else 0.0
    y[n, CHARGE] = new * (density + rise * near)
    y[old, CHARGE] = charge - y[n, CHARGE]
    y[n, VOLUME] = volume * (new / grown)
    y[old, VOLUME] = volume - y[n, VOLUME]
    y[n, TEMP] = y[old, TEMP]
    y[n, LABEL], y[old, LABEL] = new, step


@njit(cache=True, error_model="numpy")
def _length(i: int, j: int, y: FloatArray) -> float:
    return math.sqrt((y[i, X] - y[j, X]) ** 2 + (y[i, Y] - y[j, Y]) ** 2 + (y[i, Z] - y[j, Z]) ** 2)


@njit(cache=True, error_model="numpy")
def _affine(n: int, part: float, whole: float, azz: float, arr: float, y: FloatArray) -> None:
    """Conformation of the new element (the `part` of the old one's label) and the old, as an affine stretch has it.

    ``A_zz A^2`` and ``A_rr/A``, over the old element's, are linear in the label with their mean kept; `whole` is its length.
    """
    old = n - 1
    thin, thick = (
        whole * (1.0 - part) / _length(old, n, y),
        whole * part / _length(n, n + 1, y),
    )  # areas over the old one's
    if n > 1:
        front = _length(n - 2, old, y)
        area = y[n - 2, LABEL] / front / ((y[n, LABEL] + y[old, LABEL]) / whole)
        apart = 0.5 * (1.0 + y[n - 2, LABEL] / (y[n, LABEL] + y[old, LABEL]))
        for col in (AZZ, ARR):
            own, power = (azz, 2.0) if col == AZZ else (arr, -1.0)
            rise = (y[n - 2, col] * area**power / own - 1.0) / apart
            rise = min(max(rise, -1.0), 1.0)
            y[n, col] = own * (1.0 - 0.5 * (1.0 - part) * rise) * thick**-power
            y[old, col] = own * (1.0 + 0.5 * part * rise) * thin**-power
        return
    y[n, AZZ], y[old, AZZ] = azz / thick**2, azz / thin**2
    y[n, ARR], y[old, ARR] = arr * thick, arr * thin
