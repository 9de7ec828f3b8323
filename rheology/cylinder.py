"""The analytic series for a drying cylinder of constant radius and diffusivity, against which `drying` is checked.

The surface gives off what is left there, ``-D du/dr = Bi (D/R) u``: flat profiles and ``exp(-2 Bi Fo)`` for Bi -> 0, a dry
surface for Bi -> infinity.

Cost and error: 200 roots, 10 ms; 1e-13 of u_0 for any Bi a double holds.

References
----------
Crank, The Mathematics of Diffusion (1975), section 5.3.3.
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, positive, real
from spinline.base.errors import InputError

__all__ = ["cylinder_series"]


def cylinder_series(radius_ratio: ArrayLike, fourier: ArrayLike, biot: float, terms: int = 200) -> FloatArray:
    """Closed form: what is left in a cylinder of constant radius and D, surface flux proportional to what is left there.

    Parameters
    ----------
    radius_ratio, fourier : array_like
        r/R in [0, 1]; D t/R^2 > 0.
    biot : float
        Bi > 0; ``drying_peclet`` times d(activity)/du.
    terms : int
        Roots taken, 1 to 10000; 200 do beyond D t/R^2 = 1e-4, ``2/sqrt(D t/R^2)`` in general.

    Returns
    -------
    ndarray
        u/u_0 = sum 2 Bi J_0(q r/R) exp(-q^2 Fo)/[(q^2 + Bi^2) J_0(q)], q J_1(q) = Bi J_0(q) (Crank, Eq. 5.46), to 1e-13.

    Raises
    ------
    InputError
        For values out of range, or where the terms left out come to more than 1e-13.
    """
    from scipy.special import j0, j1

    bi = positive("biot", biot)
    x = real("radius_ratio", radius_ratio, least=0.0, most=1.0)
    fo = real("fourier", fourier, above=0.0)
    if isinstance(terms, bool) or not isinstance(terms, int | np.integer) or not 1 <= terms <= 10000:
        raise InputError("terms", "is out of range", value=terms, allowed="integers, 1 to 10000")
    q = _cylinder_roots(bi, int(terms))
    # q J_1 = Bi J_0: whichever of the two Bessel functions does not vanish, and ratios that do not overflow
    small = bi < q
    ratio = np.where(small, bi, q) / np.where(small, q, bi)
    weight = 2 * np.where(small, ratio, 1.0) / (q * (1 + ratio**2) * np.where(small, j0(q), j1(q)))
    decay = np.exp(-(np.minimum(q * np.sqrt(fo[..., np.newaxis]), 40.0) ** 2))
    rest = 2 * terms * float(np.abs(weight[-1])) * float(decay[..., -1].max(initial=0.0))
    if rest > 1e-13:
        raise InputError(
            "fourier", f"needs more than {terms} terms", value=float(fo.min()), remedy="more terms, or a later time"
        )
    value: FloatArray = np.sum(weight * j0(x[..., np.newaxis] * q) * decay, axis=-1)
    return value


def _cylinder_roots(bi: float, terms: int) -> FloatArray:
    """Roots of ``q J_1(q) = Bi J_0(q)``, between the zeros of J_1 (Bi = 0) and of J_0 (Bi = infinity)."""
    from scipy.optimize import brentq
    from scipy.special import j0, j1, jn_zeros

    highs = jn_zeros(0, terms)
    lows = jn_zeros(1, terms)[:-1]
    if bi > 1e8:  # to third order in q/Bi
        return np.asarray(highs / (1 + 1 / bi), dtype=np.float64)
    scale = min(float(np.sqrt(2 * bi)), float(highs[0]))  # the first root is at most this, and at least half

    def excess(q: float) -> float:
        return float(q * j1(q) - bi * j0(q))

    first = scale * float(brentq(lambda t: excess(scale * t), 0.4, 1.0 + 1e-9, xtol=1e-300, rtol=1e-15))
    if bi < 1e-8:
        others = lows + bi / lows
    else:
        others = np.array([brentq(excess, a, b, xtol=1e-14, rtol=1e-15) for a, b in zip(lows, highs[1:], strict=True)])
    return np.concatenate(([first], others))
