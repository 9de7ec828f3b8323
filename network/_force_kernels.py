"""Scalar kernels of the force laws, for loops compiled by numba; the array functions use these very ones.

``f = F b / (k_B T)`` against ``x = xi / xi_max``; equations, limits and accuracy stand in `force_laws`.
Nothing is checked here: at ``|x| >= 1`` a bounded law returns an infinite force of the sign of x and an
infinite stiffness, so that a solver can reject the step.

References
----------
Kroeger, J. Non-Newton. Fluid Mech. 223, 77 (2015): starting value of the inverse Langevin function.
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit

__all__ = [
    "FENE",
    "LANGEVIN",
    "LATTICE",
    "LINEAR",
    "deficit_kernel",
    "extension_kernel",
    "force_kernel",
    "map_deficit",
    "map_extension",
    "map_force",
    "map_stiffness",
    "stiffness_kernel",
]

LINEAR, LATTICE, LANGEVIN, FENE = 0, 1, 2, 3

_SERIES = 1e-3  # below, three terms of the inverse Langevin series are exact to 1e-18
_FRACTION = 2.0  # below, the continued fraction; above, coth f - 1 by its exponential


@njit(cache=True, error_model="numpy")
def force_kernel(code: int, x: float, rest: float) -> float:
    """Force f that holds the extension x."""
    if code == LINEAR:
        return 3 * x
    room = (1 - x) * (1 + x)
    if not room > 0:
        return math.copysign(math.inf, x) if room <= 0 else math.nan
    if code == LATTICE:
        slope = x / math.sqrt(room)
        pull = 2 * math.cosh(rest) * slope
        if math.isinf(pull):  # overflow: asinh y = ln 2y there
            return math.atanh(x) + math.copysign(rest + math.log(2 * abs(slope)), x)
        return math.atanh(x) + math.asinh(pull)
    if code == FENE:
        return 3 * x / room
    return _inverse_langevin(x)


@njit(cache=True, error_model="numpy")
def stiffness_kernel(code: int, x: float, rest: float) -> float:
    """Stiffness df/dx at the extension x."""
    if code == LINEAR:
        return 3.0
    room = (1 - x) * (1 + x)
    if not room > 0:
        return math.inf if room <= 0 else math.nan
    if code == LATTICE:
        a = 2 * math.cosh(rest)
        return (1 + a / math.hypot(math.sqrt(room), a * x)) / room
    if code == FENE:
        return 3 * (1 + x * x) / (room * room)
    if abs(x) < _SERIES:
        return 3 + x * x * (5.4 + x * x * (297 / 35))
    return 1 / _langevin_slope(abs(_inverse_langevin(x)))


@njit(cache=True, error_model="numpy")
def extension_kernel(code: int, f: float, rest: float) -> float:
    """Extension x that the force f gives."""
    if code == LINEAR:
        return f / 3
    size = abs(f)
    if code == LATTICE:
        top = max(size, rest)
        stretch = _exp_difference(size, top) * (-math.expm1(-2 * size) / 2)
        x = stretch / _lattice_partition(size, rest, top)
    elif code == FENE:
        x = 2 * size / (3 + math.hypot(3.0, 2 * size))
    else:
        x = _langevin(size)
    return math.copysign(x, f)


@njit(cache=True, error_model="numpy")
def deficit_kernel(code: int, f: float, rest: float) -> float:
    """What lacks to full extension, 1 - x, without cancellation at large f."""
    if code == LINEAR:
        return (3 - f) / 3
    if f <= 0:
        return 1 - extension_kernel(code, f, rest)
    if code == LATTICE:
        top = max(f, rest)
        slack = _exp_difference(-f, top) + 2 * _cosh(rest, top)
        return slack / _lattice_partition(f, rest, top)
    if code == FENE:
        root = math.hypot(3.0, 2 * f)
        return (3 + 9 / (root + 2 * f)) / (3 + root)
    if f < _FRACTION:
        return 1 - _langevin(f)
    return _langevin_deficit(f)


@njit(cache=True)
def map_force(code: int, x: FloatArray, rest: FloatArray, out: FloatArray) -> None:
    """`force_kernel` over flat arrays."""
    for i in range(out.size):
        out[i] = force_kernel(code, x[i], rest[i])


@njit(cache=True)
def map_stiffness(code: int, x: FloatArray, rest: FloatArray, out: FloatArray) -> None:
    """`stiffness_kernel` over flat arrays."""
    for i in range(out.size):
        out[i] = stiffness_kernel(code, x[i], rest[i])


@njit(cache=True)
def map_extension(code: int, f: FloatArray, rest: FloatArray, out: FloatArray) -> None:
    """`extension_kernel` over flat arrays."""
    for i in range(out.size):
        out[i] = extension_kernel(code, f[i], rest[i])


@njit(cache=True)
def map_deficit(code: int, f: FloatArray, rest: FloatArray, out: FloatArray) -> None:
    """`deficit_kernel` over flat arrays."""
    for i in range(out.size):
        out[i] = deficit_kernel(code, f[i], rest[i])


@njit(cache=True)
def _exp_difference(a: float, b: float) -> float:
    """``exp(a - b)`` with the rounding of the difference put back."""
    s = a - b
    t = s - a
    error = (a - (s - t)) + (-b - t)
    return math.exp(s) * (1 + error)


@njit(cache=True)
def _cosh(f: float, shift: float) -> float:
    """``cosh(f) exp(-shift)`` for 0 <= f <= shift."""
    return _exp_difference(f, shift) * (1 + math.exp(-2 * f)) / 2


@njit(cache=True)
def _lattice_partition(size: float, rest: float, shift: float) -> float:
    return _cosh(size, shift) + 2 * _cosh(rest, shift)


@njit(cache=True)
def _langevin(f: float) -> float:
    """``coth f - 1/f`` for f >= 0."""
    if f >= _FRACTION:
        return 1 - _langevin_deficit(f)
    # Gauss's continued fraction f/(3 + f^2/(5 + f^2/(7 + ...))): sums of positive terms only
    square = f * f
    tail = 25.0
    for odd in range(23, 2, -2):
        tail = odd + square / tail
    return f / tail


@njit(cache=True)
def _langevin_deficit(f: float) -> float:
    """``1 - coth f + 1/f`` for f >= 2."""
    fade = math.exp(-2 * f)
    return 1 / f - 2 * fade / (1 - fade)


@njit(cache=True)
def _langevin_slope(f: float) -> float:
    """``dL/df`` for f > 0: ``1/f^2 - 1/sinh^2 f``, or ``1 - L^2 - 2 L/f`` where that cancels."""
    if f < _FRACTION:
        value = _langevin(f)
        return 1 - value * value - 2 * value / f
    fade = math.exp(-2 * f)
    return (1 / f) ** 2 - 4 * fade / (1 - fade) ** 2


@njit(cache=True)
def _inverse_langevin(x: float) -> float:
    y = abs(x)
    square = y * y
    if y < _SERIES:
        return 3 * x + x * square * (1.8 + square * (297 / 175))
    # 0.3 % at worst, then two steps of third order: 3e-8, 1e-22
    f = y * (3 - square * (1.00651 + square * (0.962251 - square * (1.47353 - 0.48953 * square))))
    f /= (1 - y) * (1 + 1.01524 * y)
    for _ in range(2):
        # 1 - y is exact for y > 1/2, which f > 2 implies
        residual = _langevin(f) - y if f < _FRACTION else (1 - y) - _langevin_deficit(f)
        slope = _langevin_slope(f)
        # L'' = 2 (L/f - L')/f - 2 L L'
        curve = 2 * (y / f - slope) / f - 2 * y * slope
        step = residual / slope
        f -= step / (1 - 0.5 * step * curve / slope)
    return math.copysign(f, x)
