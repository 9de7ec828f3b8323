"""Permeability computed, not looked up: Stokes flow through a periodic box of voxels.

Forces f on the solid voxels make the velocity vanish there: with G the periodic Green operator of Stokes flow (no mean flow)
and P the restriction to the solid, ``P G P f = -U``. The mean force is the pressure gradient, so in voxels and unit viscosity
``k = N / sum(lambda)``, ``f = -lambda U``. Conjugate gradients raise the drag towards its value, so k falls to it: the
iteration stops when k changes by less than `tolerance` over 10 steps, an upper value.

Forces sit at the centres of voxels within the fibre, so the flow holds to a surface within its own: along the cylinders of a
square array at solidity 0.2 k is 34, 26, 15, 9, 4.2 and 1.9 % high at 2, 3, 4, 8, 16 and 32 voxels a radius. Fibres stamped
`GROWN` of a voxel thicker have their own permeability within 7 % at 2 to 8 voxels a radius, along and across, at solidities of
0.05 and 0.2 (mean over the array's place on the grid; across against Sangani and Acrivos' drag); random beds agree within 4 %
between 2 and 4 voxels. That one number is from the square arrays, whose drag is known.

Cost: six FFTs a step; memory about ten boxes of doubles: 128^3 takes 0.2 GB.
"""

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import fft

from spinline.base.checks import BoolArray, FloatArray, number, positive
from spinline.base.errors import InputError, SpinlineWarning

__all__ = ["GROWN", "StokesResult", "stokes_permeability"]

GROWN = 0.2  # voxels: what a radius is to be stamped thicker by, for its flow to be that of the fibre


@dataclass(frozen=True)
class StokesResult:
    """What the calculation gave.

    Attributes
    ----------
    permeability : float
        k in voxels squared; times the voxel squared in m2.
    solidity : float
        Of the box.
    iterations : int
    converged : bool
        k changed by less than the tolerance over the last 10 steps.
    """

    permeability: float
    solidity: float
    iterations: int
    converged: bool


def stokes_permeability(
    solid: BoolArray, axis: int = -1, *, tolerance: float = 1e-4, most_iterations: int = 2000
) -> StokesResult:
    """Permeability of a periodic box of voxels along one axis.

    Parameters
    ----------
    solid : ndarray of bool, two or three axes
        True in fibre. Two axes: cylinders across the plane.
    axis : int
        Direction of the flow.
    tolerance : float
        On k over 10 steps.
    most_iterations : int

    Returns
    -------
    StokesResult
        Not converged: with a warning, an upper value.

    Raises
    ------
    InputError
        For a box without solid (nothing holds the flow).
    """
    box = np.asarray(solid)
    if box.dtype != np.bool_ or box.ndim not in (2, 3):
        raise InputError("solid", "must be voxels, True in fibre", value=f"{box.dtype}, shape {box.shape}")
    if not box.any():
        raise InputError("solid", "has no fibre: nothing holds the flow", remedy="take a larger box or another window")
    if box.all():
        return StokesResult(0.0, 1.0, 0, True)
    limit, most = positive("tolerance", tolerance), int(number("most_iterations", most_iterations, least=1, most=1e7))
    waves = _waves(box.shape)
    square = np.asarray(sum(w**2 for w in waves), dtype=np.float64)
    square.flat[0] = np.inf  # no mean flow
    waves = _odd(waves, box.shape)
    odd = np.asarray(sum(w**2 for w in waves), dtype=np.float64)
    odd[odd == 0] = np.inf
    direction = axis % box.ndim
    where = np.flatnonzero(box)
    dims = box.ndim

    def apply(force: FloatArray) -> FloatArray:
        spectra: list[Any] = []
        for component in range(dims):
            field = np.zeros(box.shape)
            field.flat[where] = force[component]
            spectra.append(fft.rfftn(field))
        push = sum(w * s for w, s in zip(waves, spectra, strict=True)) / odd
        out = np.empty_like(force)
        for component in range(dims):
            spectra[component] = (spectra[component] - waves[component] * push) / square
            out[component] = fft.irfftn(spectra[component], s=box.shape).ravel()[where]
        return out

    target = np.zeros((dims, where.size))
    target[direction] = 1.0
    answer, residual = np.zeros_like(target), target.copy()
    search, norm = residual.copy(), float(np.sum(residual**2))
    history: list[float] = []
    start, converged, step = norm, False, 0
    for step in range(1, most + 1):
        image = apply(search)
        curvature = float(np.sum(search * image))
        if not curvature > 0:
            break
        length = norm / curvature
        answer += length * search
        residual -= length * image
        fresh = float(np.sum(residual**2))
        history.append(box.size / float(answer[direction].sum()))
        if fresh <= 1e-24 * start or (step > 20 and abs(history[-11] / history[-1] - 1) < limit):
            converged = True
            break
        search *= fresh / norm
        search += residual
        norm = fresh
    if not converged:
        warnings.warn(
            f"the Stokes flow has not settled after {step} steps; its permeability is an upper value",
            SpinlineWarning,
            stacklevel=2,
        )
    return StokesResult(history[-1] if history else float("nan"), float(box.mean()), step, converged)


def _waves(shape: tuple[int, ...]) -> list[FloatArray]:
    """Wave numbers along each axis, shaped to broadcast; those of the half spectrum last."""
    waves: list[FloatArray] = []
    for axis, n in enumerate(shape):
        k = 2 * np.pi * (np.fft.rfftfreq(n) if axis == len(shape) - 1 else np.fft.fftfreq(n))
        form = [1] * len(shape)
        form[axis] = k.size
        waves.append(np.asarray(k, dtype=np.float64).reshape(form))
    return waves


def _odd(waves: list[FloatArray], shape: tuple[int, ...]) -> list[FloatArray]:
    """The same for first derivatives: the highest wave of an even side has no sign, and none."""
    out = []
    for k, n in zip(waves, shape, strict=True):
        one = k.copy()
        if n % 2 == 0:
            one[np.abs(np.abs(one) - np.pi) < 1e-12] = 0.0
        out.append(one)
    return out
