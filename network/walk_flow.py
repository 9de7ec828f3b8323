"""Strand in a flow gradient, its drag and its shape self-consistent: Eq. (35a) with v(z) across the strand.

A strand moves with the network at u; the flow varies linearly across it, v(z) = v_c + edot (z - z_c), z_c the
mean position of its segments. With lengths in b, the drag on segment j (see `walk_strand`) is

    h_j = w (z_j - z_c) + s,        w = tau_0 edot,    s = tau_0 (v_c - u)/b

positions follow from the mean steps, which follow from the tension, which follows from the drag:

    z_j = sum_{i<j} m_i + m_j/2,    m_j = sinh f_j/(cosh f_j + 2 cosh f_0),
    f_j = f_e + N s/2 - sum_{i<j} h_i - h_j/2

iterated from ``f_j = f_e``. Differences give ``f'' = -w m(f)``: the middle of the strand is tauter than its ends by

    w x N^2/8   (s = 0, x = xi/xi_max),

and for small forces ``f_j = f_e cos[q (j - (N + 1)/2)]/cos(q N/2)``, q^2 = w/(1 + 2 cosh f_0). Without end forces that
mode grows at ``w = (1 + 2 cosh f_0) pi^2/N^2``: the coil-stretch transition of a free chain. Nearby the iteration
converges as slowly as (w/w_c)^k.

In real jets it is negligible: PEO 5 wt% in water (phi = 0.05, 125 um, 3.2 mL/h, k = 1, beta = 0.47), N_s = 400,
w = 4e-8 at most; the tension in the middle exceeds that of the ends by 2e-4 of it (tests/test_walk_flow.py). The walk
at uniform force is right, and what accumulates does so over the network, not along one strand.
"""

from dataclasses import dataclass

import numpy as np

from spinline.checks import FloatArray, real
from spinline.errors import InputError
from spinline.network.lattice_walk import relative_extension
from spinline.network.walk_strand import MOST_VARYING, Strand, hydrodynamic_strand, tension, whole

__all__ = ["FlowStrand", "flow_strand"]


@dataclass(frozen=True)
class FlowStrand:
    """Self-consistent strand.

    Attributes
    ----------
    strand : Strand
        What to walk.
    position : ndarray
        Mean axial position of each segment from the upstream end, in b.
    hydrodynamic_force : ndarray
        Drag on each segment, dimensionless.
    excess : float
        Largest ``|f_j - f_e|``: what the local hydrodynamic force adds to the end forces.
    iterations : int
        Until the tensions changed by less than `tolerance`.
    change : float
        Last change, relative to the largest tension.
    """

    strand: Strand
    position: FloatArray
    hydrodynamic_force: FloatArray
    excess: float
    iterations: int
    change: float


def flow_strand(
    segments: int,
    end_force: float,
    lateral_force: float,
    flow_gradient: float,
    *,
    slip: float = 0.0,
    tolerance: float = 1e-13,
    most_iterations: int = 10_000,
) -> FlowStrand:
    """Strand in a linear flow, iterated to self-consistency.

    Parameters
    ----------
    segments : int
        N_s, in [1, 1e7].
    end_force : float
        Mean of the axial forces of the network on its two ends, f_e.
    lateral_force : float
        f_0, in [0, 700].
    flow_gradient : float
        ``w = tau_0 edot``, dimensionless, |w| <= 1e100; tau_0 by `segment_time`.
    slip : float, optional
        ``tau_0 (v_c - u)/b``: flow past the strand's centre.
    tolerance : float, optional
        Largest change of a tension in the last iteration, relative to the largest tension.
    most_iterations : int, optional
        Refused beyond. An iteration costs about 30 ns per segment.

    Returns
    -------
    FlowStrand

    Raises
    ------
    InputError
        Out of range; or not converged, which happens close to the coil-stretch transition, in compression
        (w < 0) and under a negative end force.
    """
    n = whole("segments", segments, most=MOST_VARYING, remedy="take the uniform force of the ends")
    end = float(_number("end_force", end_force, 1e150))
    rest = float(real("lateral_force", lateral_force, least=0.0, most=700.0))
    w = float(_number("flow_gradient", flow_gradient, 1e100))
    s = float(_number("slip", slip, 1e100))
    epsilon = float(real("tolerance", tolerance, least=1e-15, most=1.0))
    rounds = whole("most_iterations", most_iterations, most=10**9)
    force = np.full(n, end)
    change = np.inf
    for done in range(1, rounds + 1):  # noqa: B007
        step = relative_extension(force, rest)
        position = np.cumsum(step) - step / 2
        drag = w * (position - position.mean()) + s
        new = end + tension(drag)
        largest = float(np.abs(new).max())
        change = float(np.abs(new - force).max()) / largest if largest else 0.0
        force = new
        if change <= epsilon:
            break
    if change > epsilon:
        critical = (1 + 2 * np.cosh(rest)) * (np.pi / n) ** 2
        raise InputError(
            "flow_gradient",
            f"does not converge in {rounds} iterations (last change {change:.1e})",
            value=w,
            allowed=f"well below or above the coil-stretch transition at {critical:.3g}",
            remedy="allow more iterations or a larger tolerance",
        )
    strand = hydrodynamic_strand(end, drag, rest)
    return FlowStrand(strand, position, drag, float(np.abs(force - end).max()), done, change)


def _number(field: str, value: float, most: float) -> FloatArray:
    array = real(field, value, least=-most, most=most)
    if array.ndim:
        raise InputError(field, "must be a single number", value=f"array of shape {array.shape}")
    return array
