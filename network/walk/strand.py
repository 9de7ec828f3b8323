"""A strand to walk: how many segments, and the force on each, Eqs. (34)-(35).

Each Kuhn segment steps along one of six lattice directions with ``P+- = exp(+-f_a) / (2 sum_a cosh f_a)``,
Eq. (34), a in x, y, z. The force is the same on every segment (`uniform_strand`, `affine_strand`: Eq. 37), or
any given one (`varying_strand`), or the sum of what the network does at the ends and the flow along the strand
(`hydrodynamic_strand`: Eq. (35a) before it is contracted). `flow_strand` takes the flow self-consistently.

Tension along a strand. Number the segments j = 1...N from the upstream end. Drag pulls each with
``h_j = tau_0 [v(z_j) - u]/b`` (tau_0 = mu_s b^3/(k_B T), u the velocity of the strand). The tension falls by
what each segment takes: with half of its own drag on either side of its middle,

    f_j = f_down + h_j/2 + sum_{i > j} h_i,        f_up = f_down + sum_i h_i

The two end forces differ by the whole drag, so only their mean, `end_force`, is free.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.network.lattice_walk import affine_force
from spinline.network.mesh import SolventQuality, network_at_rest, rest_force

__all__ = [
    "MOST_SEGMENTS",
    "MOST_VARYING",
    "Strand",
    "affine_strand",
    "hydrodynamic_strand",
    "single",
    "step_probabilities",
    "tension",
    "uniform_strand",
    "varying_strand",
    "whole",
]

MOST_SEGMENTS = 10**12  # beyond, float64 no longer tells the weights of neighbouring counts apart
MOST_VARYING = 10**6  # forces, probabilities and thresholds take some 300 bytes a segment on the way


@dataclass(frozen=True)
class Strand:
    """Segments of a strand and the forces on them; build it with the functions of this module.

    Attributes
    ----------
    segments : int
        N_s.
    forces : ndarray
        ``f = F b / (k_B T)`` along x, y (lateral) and z (axial): shape (1, 3) if uniform, else (N_s, 3),
        upstream end first.
    """

    segments: int
    forces: FloatArray

    @property
    def uniform(self) -> bool:
        """Whether every segment feels the same force."""
        return len(self.forces) == 1

    @property
    def repeats(self) -> int:
        """Segments that share one row of `forces`."""
        return self.segments if self.uniform else 1


def uniform_strand(segments: int, axial_force: float, lateral_force: float = 0.0) -> Strand:
    """Strand under the same force on every segment.

    Parameters
    ----------
    segments : int
        N_s, in [1, 1e12].
    axial_force : float
        f_z, any sign, ``|f_z| <= 1e300``.
    lateral_force : float, optional
        f_0 along both x and y; 3 phi for an ideal network.

    Returns
    -------
    Strand

    Raises
    ------
    InputError
        For values out of range, not finite or not single.
    """
    n = whole("segments", segments, most=MOST_SEGMENTS)
    f, f0 = single("axial_force", axial_force), single("lateral_force", lateral_force)
    return Strand(n, np.array([[f0, f0, f]]))


def affine_strand(
    velocity_ratio: float,
    volume_fraction: float,
    *,
    affinity: float = 1.0,
    solvent_quality: SolventQuality = "theta",
) -> Strand:
    """Strand of a network in a jet stretched by V: ``f_z = f_0 [1 + A (V - 1)]``, N_s rounded.

    Parameters
    ----------
    velocity_ratio, volume_fraction, affinity, solvent_quality
        As for `random_walk`, single numbers; phi >= 1e-6.

    Returns
    -------
    Strand
        N_s is phi^-2 (good solvent phi^-5/4) to the nearest integer: 400 at phi = 0.05.
    """
    phi = real("volume_fraction", volume_fraction, least=1e-6, below=1.0)
    if phi.ndim:
        raise InputError("volume_fraction", "must be a single number", value=f"array of shape {phi.shape}")
    segments = round(float(network_at_rest(phi, solvent_quality).segments))
    force = affine_force(velocity_ratio, phi, affinity=affinity, solvent_quality=solvent_quality)
    if force.ndim:
        raise InputError("velocity_ratio", "must be a single number", value=f"array of shape {force.shape}")
    return uniform_strand(min(segments, MOST_SEGMENTS), float(force), float(rest_force(phi, solvent_quality)[0]))


def varying_strand(forces: ArrayLike) -> Strand:
    """Strand under a force given segment by segment.

    Parameters
    ----------
    forces : array_like, shape (N_s, 3)
        f along x, y, z, upstream end first; N_s in [1, 1e6].

    Returns
    -------
    Strand
    """
    f = real("forces", forces, least=-1e300, most=1e300)
    if f.ndim != 2 or f.shape[1] != 3 or not f.shape[0]:
        raise InputError("forces", "has the wrong shape", value=str(f.shape), allowed="(segments, 3), segments >= 1")
    _affordable(f.shape[0])
    return Strand(f.shape[0], np.ascontiguousarray(f))


def hydrodynamic_strand(end_force: float, hydrodynamic_force: ArrayLike, lateral_force: float = 0.0) -> Strand:
    """Strand whose axial force accumulates the drag of its segments, Eq. (35a) before contraction.

    Parameters
    ----------
    end_force : float
        Mean of the two axial end forces, dimensionless.
    hydrodynamic_force : array_like, shape (N_s,)
        Drag on each segment ``h_j = tau_0 [v(z_j) - u]/b``, upstream end first.
    lateral_force : float, optional
        f_0 along x and y.

    Returns
    -------
    Strand
    """
    h = real("hydrodynamic_force", hydrodynamic_force, least=-1e290, most=1e290)
    if h.ndim != 1 or not h.size:
        raise InputError("hydrodynamic_force", "must be one number per segment", value=f"shape {h.shape}")
    _affordable(h.size)
    f, f0 = single("end_force", end_force), single("lateral_force", lateral_force)
    return varying_strand(np.column_stack([np.full((h.size, 2), f0), f + tension(h)]))


def tension(drag: FloatArray) -> FloatArray:
    """Tension in the middle of each segment less the mean end force."""
    below = np.cumsum(drag[::-1])[::-1]  # sum over i >= j
    value: FloatArray = below - drag / 2 - below[0] / 2
    return value


def step_probabilities(forces: FloatArray) -> FloatArray:
    """Probabilities of a step along +x, -x, +y, -y, +z, -z, Eq. (34).

    Parameters
    ----------
    forces : ndarray, shape (..., 3)
        f along x, y, z, |f| <= 1e300.

    Returns
    -------
    ndarray, shape (..., 6)
        They sum to 1 to rounding; the largest exponential is factored out, and a probability below 1e-323 is 0.
    """
    signed = np.stack([forces, -forces], axis=-1).reshape(*forces.shape[:-1], 6)
    weight = np.exp(signed - signed.max(axis=-1, keepdims=True))
    value: FloatArray = weight / weight.sum(axis=-1, keepdims=True)
    return value


def whole(field: str, value: int, *, least: int = 1, most: int, remedy: str = "") -> int:
    """Check one whole number in [least, most]."""
    allowed = f"whole numbers in [{least}, {most}]"
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | np.integer):
        raise InputError(field, "is not a whole number", value=value, allowed=allowed, remedy=remedy)
    if not least <= value <= most:
        raise InputError(field, "is out of range", value=int(value), allowed=allowed, remedy=remedy)
    return int(value)


def single(field: str, value: float, *, least: float = -1e300, most: float = 1e300) -> float:
    """Check one real number in [least, most]."""
    array = real(field, value, least=least, most=most)
    if array.ndim:
        raise InputError(field, "must be a single number", value=f"array of shape {array.shape}")
    return float(array)


def _affordable(segments: int) -> None:
    if segments > MOST_VARYING:
        remedy = "take the uniform force of the ends (`uniform_strand`): it is the limit of a long strand"
        raise InputError(
            "segments", "is too many for forces that vary", value=segments, allowed=f"<= {MOST_VARYING}", remedy=remedy
        )
