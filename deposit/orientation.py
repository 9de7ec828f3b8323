"""How fibres point: order parameter, director, distributions, tensors, and what an image shows.

``S2 = |<e^(2 i theta)>|`` and the director ``arg/2``, length-weighted. A finite isotropic sample of N independent pieces does
not give 0 but ``pi^(1/2)/(2 N^(1/2))`` on average. In space the tensor ``<t t>``: Hermans' factor about an axis u is
``(3 u.<tt>.u - 1)/2``: 1 for fibres along u, 1/4 in an isotropic mat about an axis in its plane, -1/2 about its normal.

An image has no fibres: `image_orientation` takes the structure tensor of its gradients, for like with like.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage

from spinline.base.checks import FloatArray, computable, number, real
from spinline.base.errors import InputError

__all__ = ["Order", "hermans", "image_orientation", "isotropic_order", "order_of", "orientation_density", "tensor"]


class Order(NamedTuple):
    """Order parameter S2 in [0, 1] and director in (-pi/2, pi/2], rad."""

    order_parameter: float
    director: float


@computable
def order_of(angle: ArrayLike, weight: ArrayLike | None = None) -> Order:
    """Order of plane directions.

    Parameters
    ----------
    angle : array_like
        rad; theta and theta + pi are the same fibre.
    weight : array_like, optional
        Lengths, for instance; >= 0. Default: all the same.

    Raises
    ------
    InputError
        For no direction, or no weight.
    """
    theta, w = _weighted(angle, weight)
    double = np.sum(w * np.exp(2j * theta)) / np.sum(w)
    return Order(float(min(abs(double), 1.0)), float(np.angle(double) / 2))


def isotropic_order(pieces: ArrayLike) -> FloatArray:
    """Mean order parameter of N independent random directions, ``pi^(1/2)/(2 N^(1/2))``; N >= 1."""
    return np.asarray(np.sqrt(np.pi / real("pieces", pieces, least=1.0)) / 2)


def orientation_density(
    angle: ArrayLike, weight: ArrayLike | None = None, bins: int = 36
) -> tuple[FloatArray, FloatArray]:
    """Probability density of the direction over [-pi/2, pi/2), 1/rad, and the bins' centres."""
    theta, w = _weighted(angle, weight)
    edges = np.linspace(-np.pi / 2, np.pi / 2, int(number("bins", bins, least=2, most=1e6)) + 1)
    folded = np.mod(theta + np.pi / 2, np.pi) - np.pi / 2
    density, _ = np.histogram(folded, edges, weights=w, density=True)
    return 0.5 * (edges[1:] + edges[:-1]), density


def tensor(direction: ArrayLike, weight: ArrayLike | None = None) -> FloatArray:
    """``<t t>`` of directions (n, 3), normalised here; (3, 3) of trace 1."""
    t = real("direction", direction)
    if t.ndim != 2 or t.shape[1] != 3:
        raise InputError("direction", "must be (n, 3)", value=f"shape {t.shape}")
    length = np.linalg.norm(t, axis=1)
    if not len(t) or not (length > 0).all():
        raise InputError("direction", "has one of no length, or none at all")
    t = t / length[:, None]
    w = np.ones(len(t)) if weight is None else real("weight", weight, least=0.0)
    return np.asarray(np.einsum("n,ni,nj->ij", w, t, t) / w.sum())


@computable
def hermans(orientation_tensor: ArrayLike, axis: ArrayLike) -> float:
    """Hermans' factor ``(3 u.T.u - 1)/2`` about an axis."""
    u = real("axis", axis)
    size = float(np.linalg.norm(u))
    if u.shape != (3,) or size == 0:
        raise InputError("axis", "must be a direction (3,)", value=np.asarray(axis).tolist())
    t = real("orientation_tensor", orientation_tensor)
    if t.shape != (3, 3):
        raise InputError("orientation_tensor", "must be a tensor (3, 3)", value=f"shape {t.shape}")
    return float((3 * (u / size) @ t @ (u / size) - 1) / 2)


def image_orientation(image: ArrayLike, sigma: float = 1.0) -> Order:
    """Order and director of an image's edges, by the structure tensor averaged over the image.

    Parameters
    ----------
    image : array_like, (x, y)
        Grey levels, first axis along the machine.
    sigma : float
        Of the Gaussian derivatives, pixels, > 0.

    Notes
    -----
    Gradients stand across the fibres; the director is along them. The order of a picture of isotropic cylinders is 0 as theirs
    is; between, it need not be that of the lengths.
    """
    grey = real("image", image)
    if grey.ndim != 2 or min(grey.shape) < 3:
        raise InputError("image", "must be a plane of 3 pixels or more", value=f"shape {grey.shape}")
    s = number("sigma", sigma, above=0.0, most=1e3)
    gx = ndimage.gaussian_filter(grey, s, order=(1, 0))
    gy = ndimage.gaussian_filter(grey, s, order=(0, 1))
    energy = float(np.sum(gx**2 + gy**2))
    if energy == 0:
        raise InputError("image", "is all one grey: it has no directions")
    double = -complex(float(np.sum(gx**2 - gy**2)), float(2 * np.sum(gx * gy))) / energy
    return Order(min(abs(double), 1.0), float(np.angle(double) / 2))


def _weighted(angle: ArrayLike, weight: ArrayLike | None) -> tuple[FloatArray, FloatArray]:
    theta = np.ravel(real("angle", angle, unit="rad"))
    w = np.ones(theta.size) if weight is None else np.ravel(real("weight", weight, least=0.0))
    if not theta.size or w.shape != theta.shape or not w.sum() > 0:
        raise InputError(
            "angle", "needs directions and weights, one each, not all zero", value=f"{theta.size}, {w.size}"
        )
    return theta, w
