"""Drag and lift of the air on the elements, Eqs. (20)-(22) and (24), compiled.

Drag per length ``-xi pi r rho_a (2 r/nu_a)^(-zeta) w |w|^eta`` along the tangent, w the tangential speed relative to the
air (the printed ``w^(1+eta)`` is not a number where the air is the faster). Lift lowers the tension by ``rho_a w^2 A`` in
the normal direction only.
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    AIR_DENSITY,
    AIR_VISCOSITY,
    AIR_X,
    AREA,
    DRAG_ETA,
    DRAG_XI,
    DRAG_ZETA,
    LENGTH,
    LIFT,
    TX,
    VX,
    IntArray,
)

__all__ = ["air_forces", "slip"]


@njit(cache=True, error_model="numpy")
def slip(i: int, y: FloatArray, p: FloatArray, w: FloatArray) -> float:
    """Tangential speed of element i relative to the air, m/s."""
    total = 0.0
    for c in range(3):
        total += (0.5 * (y[i, VX + c] + y[i + 1, VX + c]) - p[AIR_X + c]) * w[TX + c, i]
    return total


@njit(cache=True, error_model="numpy")
def air_forces(n: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, f: FloatArray) -> None:
    """Add drag, and lift where it is wanted."""
    for i in range(n):
        speed = slip(i, y, p, w)
        radius = math.sqrt(w[AREA, i] / math.pi)
        drag = p[DRAG_XI] * math.pi * radius * w[LENGTH, i] * p[AIR_DENSITY]
        drag *= (2.0 * radius / p[AIR_VISCOSITY]) ** (-p[DRAG_ZETA]) * speed * abs(speed) ** p[DRAG_ETA]
        lift = p[AIR_DENSITY] * speed * speed * w[AREA, i] if k[LIFT] == 1 else 0.0
        for c in range(3):
            half = 0.5 * drag * w[TX + c, i]
            f[i, c] -= half
            f[i + 1, c] -= half
            # as a negative tension in the bends; on straight parts the two ends of equal elements cancel
            if lift != 0.0:
                before = w[TX + c, i - 1] if i > 0 else w[TX + c, i]
                after = w[TX + c, i + 1] if i < n - 1 else w[TX + c, i]
                f[i, c] -= 0.5 * lift * (before - w[TX + c, i])
                f[i + 1, c] -= 0.5 * lift * (w[TX + c, i] - after)
