"""What joining strands costs: the error of a coarse-grained chain, by a second run with beads twice as far apart.

The steady chain with beads every m h differs from the continuous one by ``C (m h)^2`` (its leading term is
``(eps h^2 / 12) X''''`` along a trajectory), so from the physical one by ``C h^2 (m^2 - 1)`` and from the chain with 2 m by
``3 C h^2 m^2``. Richardson's estimate of the error is a third of the latter, times ``1 - 1/m^2``.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.network._objects import instance
from spinline.network.chain.march import run_chain
from spinline.network.chain.model import Chain

__all__ = ["coarse_graining_error"]


def coarse_graining_error(
    chain: Chain, until: float, position: ArrayLike, *, rtol: float = 1e-4, most_steps: int = 10_000_000
) -> tuple[FloatArray, FloatArray]:
    """Stretch of a coarse-grained chain and the estimated error of coarse-graining.

    Parameters
    ----------
    chain : Chain
        With its `coarse_grain` factor m, >= 1; error 0 for m = 1.
    until : float
        Time of both runs from the empty chain, units of r_0 / v_0; long enough to settle.
    position : array_like
        Stations, initial radii.
    rtol : float
        Of both runs; an error much below it is not resolved.
    most_steps : int
        Of each run, as for `run_chain`.

    Returns
    -------
    tuple of ndarray
        w at the stations, and the estimate of ``|w - w(m = 1)|``; NaN where the chain has not come.

    Notes
    -----
    Costs one and a half runs. Asymptotic: good to some 10 % once ``m h w`` is small against both ``w / V'`` and, near
    a kink of V, ``eps w``.
    """
    instance("chain", chain, Chain)
    s = real("position", position)
    m = chain.coarse_grain
    fine = run_chain(chain, until, rtol=rtol, most_steps=most_steps).stretch_at(s)
    coarse = run_chain(replace(chain, coarse_grain=2 * m), until, rtol=rtol, most_steps=most_steps).stretch_at(s)
    error: FloatArray = np.abs(coarse - fine) / 3 * (1 - 1 / m**2)
    return fine, error
