"""Single-distance phase retrieval: fringes folded back into absorption, after Paganin.

For one material close behind the object (the transport-of-intensity equation), a distance z on,

    I/I_0 = (1 - z (delta/mu) Laplacian) exp(-mu L),   so   exp(-mu L) = F^-1[F[I/I_0]/(1 + 4 pi^2 z (delta/mu) f^2)]

with the ratio delta/mu of the solution as the only regularisation: where mu is small, the filter is a broad low-pass (its
width, ``sqrt(z delta/mu)``, is 21 um for water at 10 keV and 10 cm), it smooths the noise, and takes drift
and veil for signal. Linear and cheap; valid where the fringes are one pair at an edge: ``z < pixel^2/lambda``, or a detector
that does not resolve more. `fit_row_phase` has no such bound and gives errors; this is its start, and the quick look.

A mixture is one material only where delta/mu does not change with the fraction; PEO in water at 10 keV changes it by 0.4 %
per 0.01 of the fraction, and so biases what is found (xray.md has the figures).

References
----------
Paganin, Mayo, Gureyev, Miller, Wilkins, J. Microsc. 206, 33 (2002).
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.xray.matter.medium import Medium

__all__ = ["contact_transmission"]


def contact_transmission(
    ratio: ArrayLike,
    pixel: float,
    distance: float,
    delta_over_mu: float | Medium,
    *,
    fraction: float = 0.0,
    across: bool = True,
) -> FloatArray:
    """Transmission as it were right behind the object, from that at a distance.

    Parameters
    ----------
    ratio : array_like, shape (pixels,) or (rows, pixels)
        (counts - dark)/flat, finite.
    pixel : float
        m, > 0.
    distance : float
        m, >= 0; 0 returns `ratio`.
    delta_over_mu : float or Medium
        m, >= 0; or the solution (`solution_medium`), at its polymer `fraction`.
    fraction : float
        Polymer fraction at which a medium's ratio is taken.
    across : bool
        True: each row for itself, as a jet that hardly changes along its axis asks for. False: both ways of an image.

    Returns
    -------
    ndarray, the shape of `ratio`.

    Raises
    ------
    InputError
        For what is not finite or negative, under 4 pixels across (or along, where both ways are filtered), or a pixel so small
        beside ``sqrt(distance delta/mu)`` that the filter overflows.

    Notes
    -----
    Beyond its ends the image goes on mirrored. 0.05 ms for 400 pixels. The second difference stands for the derivative, so that
    the filter is that of the pixel grid, and passes the mean exactly.
    """
    image = real("ratio", ratio)
    if image.ndim not in (1, 2) or image.shape[-1] < 4 or (not across and image.ndim != 2):
        raise InputError("ratio", "is not a row or an image", value=f"array of shape {image.shape}")
    if not across and image.shape[0] < 4:
        raise InputError(
            "ratio", "has too few rows to filter both ways", value=f"array of shape {image.shape}", allowed=">= 4"
        )
    p, z = positive("pixel", pixel, "m"), number("distance", distance, least=0.0, unit="m")
    length = delta_over_mu if isinstance(delta_over_mu, int | float) else _of(delta_over_mu, fraction)
    root = float(np.sqrt(z) * np.sqrt(number("delta_over_mu", length, least=0.0, unit="m")))
    if root > 1e100 * p:
        raise InputError(
            "pixel", "is too small beside the filter's width", value=p, allowed=f"over {1e-100 * root:.3g} m"
        )
    strength = (root / p) ** 2
    if strength == 0.0:
        return image.copy()
    from scipy.fft import dctn, idctn

    axes = (-1,) if across else (-2, -1)
    laplacian: FloatArray = np.zeros(1)
    for axis in axes:
        n = image.shape[axis]
        shape = [1] * image.ndim
        shape[axis] = n
        laplacian = laplacian + (2.0 - 2.0 * np.cos(np.pi * np.arange(n) / n)).reshape(shape)
    return np.asarray(idctn(dctn(image, axes=axes) / (1.0 + strength * laplacian), axes=axes))


def _of(medium: object, fraction: float) -> float:
    """delta/mu of a solution."""
    if not isinstance(medium, Medium):
        raise InputError("delta_over_mu", "is neither a length nor a medium", value=medium, allowed="m, or a Medium")
    return medium.delta_over_mu(number("fraction", fraction))
