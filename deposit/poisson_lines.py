"""Random networks in closed form: what a mat of independent straight fibres must give.

Lines of length density nu (length per volume) in space, any law of direction, fibre radius a, overlapping::

    P(a ball of radius r fits at a point) = exp(-pi nu (a + r)^2)            (Ogston)

Lines of length density tau (length per area) in the plane, directions uniform::

    open share exp(-2 tau a)          P(distance to the nearest fibre > r | open) = exp(-2 tau r)
    vertices tau^2/pi per area        cells as many: mean area pi/tau^2, standard deviation over mean (pi^2/2 - 1)^(1/2)

(the cell of *lines*, a = 0). Fibres of width w and open share eps, pores taken as polygons between random lines (Sampson): mean
radius ``(pi^(1/2)/4) (pi/(2 ln(1/eps)) - 1) w``, coefficient of variation ``(16 - pi^2)^(1/2)/pi``, radii gamma distributed.
A raster's pores have wider tails (1.09): do not fit it to them.

References
----------
Ogston, Trans. Faraday Soc. 54, 1754 (1958); Miles, PNAS 52, 901 (1964); Sampson, J. Mater. Sci. 38, 1617 (2003).
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from spinline.base.checks import FloatArray, computable, real

__all__ = [
    "CELL_VARIATION",
    "SAMPSON_VARIATION",
    "ball_probability",
    "mean_cell_area",
    "open_share",
    "plane_distance_survival",
    "sampson_mean_radius",
    "sampson_survival",
    "vertex_density",
]

CELL_VARIATION = float(np.sqrt(np.pi**2 / 2 - 1))  # 1.98363
SAMPSON_VARIATION = float(np.sqrt(16 - np.pi**2) / np.pi)  # 0.788124


@computable
def ball_probability(length_density: ArrayLike, radius: ArrayLike, ball: ArrayLike) -> FloatArray:
    """Ogston: share of the volume where a ball fits; nu >= 0 (1/m2), a >= 0, r >= 0 (m).

    Examples
    --------
    >>> [round(float(p), 4) for p in ball_probability(0.012, 2.0, [0, 1, 2, 4])]
    [0.86, 0.7123, 0.5471, 0.2574]
    """
    nu = real("length_density", length_density, least=0.0)
    a, r = real("radius", radius, least=0.0), real("ball", ball, least=0.0)
    return np.asarray(np.exp(-np.pi * nu * (a + r) ** 2))


def open_share(length_density: ArrayLike, radius: ArrayLike) -> FloatArray:
    """Share of the plane that lines of half width `radius` leave open, ``exp(-2 tau a)``; exp(-coverage)."""
    tau, a = real("length_density", length_density, least=0.0), real("radius", radius, least=0.0)
    return np.asarray(np.exp(-2 * tau * a))


def plane_distance_survival(length_density: ArrayLike, distance: ArrayLike) -> FloatArray:
    """Share of the open area farther than `distance` from the nearest fibre's edge, ``exp(-2 tau r)``."""
    tau, r = real("length_density", length_density, least=0.0), real("distance", distance, least=0.0)
    return np.asarray(np.exp(-2 * tau * r))


@computable
def vertex_density(length_density: ArrayLike) -> FloatArray:
    """Crossings per area, ``tau^2/pi``; also cells per area."""
    tau = real("length_density", length_density, least=0.0)
    return np.asarray(tau**2 / np.pi)


@computable
def mean_cell_area(length_density: ArrayLike) -> FloatArray:
    """Mean area of a cell between lines, ``pi/tau^2``."""
    tau = real("length_density", length_density, above=0.0)
    return np.asarray(np.pi / tau**2)


@computable
def sampson_mean_radius(open_share: ArrayLike, width: ArrayLike = 1.0) -> FloatArray:
    """Mean pore radius of a layer of open share eps in (0, 1), fibres of `width`.

    Examples
    --------
    >>> [round(float(r), 6) for r in sampson_mean_radius([0.8, 0.9, 0.95])]
    [2.676139, 6.163166, 13.126711]
    """
    eps, w = real("open_share", open_share, above=0.0, below=1.0), real("width", width, above=0.0)
    value = np.sqrt(np.pi) / 4 * (np.pi / (-2 * np.log(eps)) - 1) * w
    return np.where(value > 0, value, np.nan)


def sampson_survival(radius: ArrayLike, mean: ArrayLike) -> FloatArray:
    """Share of pores larger than `radius`: gamma law of that mean and of variation 0.788."""
    r, middle = real("radius", radius, least=0.0), real("mean", mean, above=0.0)
    shape = 1 / SAMPSON_VARIATION**2
    return np.asarray(stats.gamma.sf(r, shape, scale=middle / shape))
