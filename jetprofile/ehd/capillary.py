"""Capillary waves of a slender thread, neutral or charged and leaky.

Neutral and viscous, lengths by r and rates by ``sqrt(gamma / (rho r^3))``, ``Oh = mu / sqrt(rho gamma r)``::

    w^2 + 3 Oh x^2 w = (1 - x^2) x^2 / 2,   fastest x* = 1 / [sqrt2 (1 + 3 Oh / sqrt2)^(1/2)],  w* = x*^2 / sqrt2

(without the -x^4 of the curvature along the thread: the long-wave form whose fastest mode is in print). The review's
``omega_c^max`` is this wavenumber, not the growth rate; its ``S sqrt(Ca)`` stands for Oh.

`axisymmetric_growth` linearises the jet's own equations (Eqs. 5-8) about a uniform thread of surface charge S in a field
E0: mass, charge, momentum and the field, the logarithm replaced by ``K0(x) / (x K1(x))``. S and E0 by ``sqrt(gamma /
(eps_0 r))``.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import kv

from spinline.base.checks import FloatArray, computable, number, positive, real

__all__ = ["axisymmetric_growth", "capillary_growth", "fastest_capillary", "ohnesorge"]


def ohnesorge(viscosity: ArrayLike, density: ArrayLike, surface_tension: ArrayLike, radius: ArrayLike) -> FloatArray:
    """Oh = mu / sqrt(rho gamma r)."""
    value: FloatArray = np.asarray(viscosity) / np.sqrt(np.asarray(density) * surface_tension * np.asarray(radius))
    return value


def fastest_capillary(oh: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Wavenumber k r and growth rate over ``sqrt(gamma / (rho r^3))`` of the fastest capillary wave.

    Examples
    --------
    >>> x, growth = fastest_capillary(1.0)
    >>> round(float(x), 6), round(float(growth), 6)
    (0.400236, 0.11327)
    """
    number = real("oh", oh, least=0.0)
    x = 1 / np.sqrt(2 * (1 + 3 * number / np.sqrt(2)))
    growth: FloatArray = x**2 / np.sqrt(2)
    return x, growth


def capillary_growth(radius: ArrayLike, *, viscosity: float, density: float, surface_tension: float) -> FloatArray:
    """Growth rate in 1/s of the fastest capillary wave of a thread of this radius (m)."""
    r = np.asarray(radius, dtype=float)
    _, growth = fastest_capillary(ohnesorge(viscosity, density, surface_tension, r))
    value: FloatArray = growth * np.sqrt(surface_tension / (density * r**3))
    return value


@computable
def axisymmetric_growth(
    x: float,
    *,
    oh: float,
    charge: float = 0.0,
    field: float = 0.0,
    conductivity: float = np.inf,
    permittivity: float = 1.0,
    log: str = "local",
) -> complex:
    """Growth rate (the fastest of three) of an axisymmetric wave of a charged leaky thread.

    Parameters
    ----------
    x : float
        Wavenumber k r, > 0.
    oh : float
        Ohnesorge number, >= 0.
    charge, field : float
        S = sigma sqrt(r / (eps_0 gamma)) and E0, the same of the axial field.
    conductivity : float
        ``K sqrt(rho r^3 / gamma) / eps_0``; infinite for a conductor, 0 for frozen charge.
    permittivity : float
        Relative, >= 1.
    log : {"local", "constant"}
        "local": the potential is taken at the moving surface, Hohman's Eq. (8), and a conductor follows Basset's law for
        long waves; "constant" leaves that term out (Feng): a conductor is then unstable only for ``x^2 < 1 - S^2``.

    Returns
    -------
    complex
        Rate over ``sqrt(gamma / (rho r^3))``.
    """
    x = positive("x", x)
    beta = number("permittivity", permittivity, least=1.0) - 1
    charge, field, oh = number("charge", charge), number("field", field), number("oh", oh, least=0.0)
    if not (isinstance(conductivity, float) and conductivity == np.inf):
        conductivity = number("conductivity", conductivity, least=0.0, remedy="inf is a perfect conductor")
    shape = float(kv(0, x) / (x * kv(1, x)))
    moving = charge if log == "local" else 0.0
    # unknowns (r, v, sigma) ~ exp(i x z + w t); the field e = -i x Phi, Phi = shape n - moving r,
    # n = S r + sigma - (beta / 2) i x (2 E0 r + e)
    bottom = 1 + 0.5 * beta * x**2 * shape
    e_r = (-1j * x * (shape * charge - moving) - beta * field * x**2 * shape) / bottom
    e_s = -1j * x * shape / bottom
    if np.isinf(conductivity):  # e = -2 E0 r: no current; sigma follows
        e_r_fixed = -2 * field
        s_r = (e_r_fixed - e_r) / e_s
        p_r = x**2 - 1 - beta * field * e_r_fixed - charge * s_r
        pull = 2 * (s_r * field + charge * e_r_fixed - charge * field)
        matrix = np.array([[0, -0.5j * x], [-1j * x * p_r + pull, -3 * oh * x**2]])
    else:
        p_r, p_s = x**2 - 1 - beta * field * e_r, -charge - beta * field * e_s
        k = 0.5 * conductivity
        s_r = -1j * x * k * (2 * field + e_r)
        s_v = -1j * x * charge + 0.5j * x * charge
        s_s = -1j * x * k * e_s
        pull_r, pull_s = 2 * charge * (e_r - field), 2 * (field + charge * e_s)
        matrix = np.array(
            [
                [0, -0.5j * x, 0],
                [-1j * x * p_r + pull_r, -3 * oh * x**2, -1j * x * p_s + pull_s],
                [s_r, s_v, s_s],
            ]
        )
    rates = np.linalg.eigvals(matrix)
    return complex(rates[np.argmax(rates.real)])
