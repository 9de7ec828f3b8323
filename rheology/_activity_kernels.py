"""Activities of solvents in a polymer, and how fast they leave by them, in compiled loops.

Logarithms of the coefficients ``a_i/phi_i`` and the shares of the others, ``1 - phi_i``, are each known to rounding of
itself, so that in a nearly pure solvent nothing cancels. Not compiled (`spinline.base.kernels.plain`) the two laws take
fractions (solvent, place) at many places as well.
"""

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.kernels import njit

__all__ = ["fall", "flory_huggins", "raoult"]


@njit(cache=True, error_model="numpy")
def _others(i: int, fractions: FloatArray, volumes: FloatArray) -> tuple[float, float]:
    """Fractions of the solvents beside the i-th one, and over their molar volumes."""
    beside, crowding = 0.0 * fractions[i], 0.0 * fractions[i]
    for j in range(volumes.size):
        if j != i:
            beside = beside + fractions[j]
            crowding = crowding + fractions[j] / volumes[j]
    return beside, crowding


@njit(cache=True, error_model="numpy")
def flory_huggins(
    fractions: FloatArray, polymer: float, volumes: FloatArray, chi: FloatArray, log: FloatArray, others: FloatArray
) -> None:
    """Flory and Huggins: ``ln(a_i/phi_i)`` into `log`, ``1 - phi_i`` into `others`."""
    n = volumes.size
    pull = 0.0 * polymer
    for j in range(n):
        pull = pull + fractions[j] * chi[j] / volumes[j]
    for i in range(n):
        beside, crowding = _others(i, fractions, volumes)
        others[i] = beside + polymer
        log[i] = others[i] - volumes[i] * crowding + polymer * (chi[i] - volumes[i] * pull)


@njit(cache=True, error_model="numpy")
def raoult(
    fractions: FloatArray, polymer: float, volumes: FloatArray, unit: float, log: FloatArray, others: FloatArray
) -> None:
    """Raoult, the polymer in molecules of the molar volume `unit`; as `flory_huggins`."""
    n = volumes.size
    for i in range(n):
        beside, crowding = _others(i, fractions, volumes)
        others[i] = beside + polymer
        log[i] = -np.log1p(volumes[i] * crowding + polymer * (volumes[i] / unit) - others[i])


@njit(cache=True, error_model="numpy")
def fall(
    y: FloatArray,
    phi0: float,
    inside: BoolArray,
    origin: FloatArray,
    volumes: FloatArray,
    chi: FloatArray,
    unit: float,
    saturation: FloatArray,
    ambient: FloatArray,
) -> tuple[float, FloatArray]:
    """Volume left, and the driving dC of each solvent over its volume (over 1 for solvents only in the air).

    y: logarithms of the volumes over their starts, whose logarithms are `origin`, or plain volumes of what is only in the air;
    `unit`: as for `raoult`, 0 for `flory_huggins`.
    """
    n = y.size
    u, fractions, log, others, out = np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    total = phi0
    for i in range(n):
        u[i] = np.exp(origin[i] + y[i]) if inside[i] else y[i]
        total += u[i]
    for i in range(n):
        fractions[i] = u[i] / total
    if unit > 0:
        raoult(fractions, phi0 / total, volumes, unit, log, others)
    else:
        flory_huggins(fractions, phi0 / total, volumes, chi, log, others)
    for i in range(n):
        if not inside[i]:
            over = np.exp(log[i]) * u[i] / total - ambient[i]
        elif others[i] < 0.5:  # nearly pure, 1 - ambient against 1 - activity: the plain difference would be noise
            over = ((1 - ambient[i]) + np.expm1(np.log1p(-others[i]) + log[i])) / u[i]
        else:
            over = np.exp(log[i]) / total - (ambient[i] / u[i] if ambient[i] > 0 else 0.0)
        out[i] = saturation[i] * over
    return total, out
