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

Below f = 1, x = f/3 and the excess in the middle is ``w N_s^2/24 = w/(24 phi^4)`` of the end force: the number that
decides. In the jet of PEO 5 wt% in water (phi = 0.05, 125 um, 3.2 mL/h, k = 1, beta = 0.47; w = 3e-8) it is 2.2e-4 at most
(tests/test_walk_flow.py): the walk at uniform force is right, and what accumulates does so over the network, not along
one strand. It grows as phi^-4: in the same jet it is 14 % at phi = 0.01; and it is proportional to the viscosity in
tau_0, which is the solvent's.
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network.lattice_walk import relative_extension
from spinline.network.walk.strand import MOST_VARYING, Strand, hydrodynamic_strand, single, tension, whole

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
        N_s, in [1, 1e6].
    end_force : float
        Mean of the axial forces of the network on its two ends, f_e.
    lateral_force : float
        f_0, in [0, 700].
    flow_gradient : float
        ``w = tau_0 edot``, dimensionless, ``|w|`` <= 1e100; tau_0 by `segment_time`.
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
        Out of range; or not converged, which happens close to the coil-stretch transition and in strong
        compression (w < 0).

    Notes
    -----
    Without end force and slip the coil, f = 0, is a solution at any gradient, and the one returned.
    """
    n = whole("segments", segments, most=MOST_VARYING, remedy="take the uniform force of the ends")
    end = single("end_force", end_force, least=-1e150, most=1e150)
    rest = single("lateral_force", lateral_force, least=0.0, most=700.0)
    w = single("flow_gradient", flow_gradient, least=-1e100, most=1e100)
    s = single("slip", slip, least=-1e100, most=1e100)
    epsilon = single("tolerance", tolerance, least=1e-15, most=1.0)
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
            allowed=f"away from the coil-stretch transition at {critical:.3g}, and well above minus that",
            remedy="allow more iterations or a larger tolerance",
        )
    strand = hydrodynamic_strand(end, drag, rest)
    return FlowStrand(strand, position, drag, float(np.abs(force - end).max()), done, change)
