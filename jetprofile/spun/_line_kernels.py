"""Energy of straight charged segments and its derivatives, compiled.

The charge of a thread is a line softened by its radius, ``1/sqrt(d^2 + a^2)`` (charge on the surface: a = r). Two
segments in line, of charges q_i, q_j and lengths L_i, L_j, g apart:

``U = e_i e_j [H(L_i+g+L_j) - H(L_i+g) - H(g+L_j) + H(g)]``, ``H(u) = u asinh(u/a) - sqrt(u^2 + a^2)``, ``e = q/L``;

one with itself: ``U = e^2 [L asinh(L/a) - sqrt(L^2 + a^2) + a]``. Energies are in units of ``1/(4 pi eps0)``; derivatives are
at fixed charges.
"""

import math

from spinline.base.kernels import njit

__all__ = ["far_rest", "feed_field", "point_pair", "ripple", "segment_pair", "segment_self"]


@njit(cache=True, error_model="numpy")
def _h(u: float, a: float) -> float:
    return u * math.asinh(u / a) - math.sqrt(u * u + a * a)


@njit(cache=True, error_model="numpy")
def segment_pair(
    qi: float, qj: float, li: float, lj: float, g: float, a2: float
) -> tuple[float, float, float, float, float]:
    """U, dU/dL_i, dU/dL_j, dU/dg, dU/d(a^2)."""
    a = math.sqrt(a2)
    u0, u1, u2, u3 = g, g + li, g + lj, g + li + lj
    e = qi * qj / (li * lj)
    s0, s1, s2, s3 = math.asinh(u0 / a), math.asinh(u1 / a), math.asinh(u2 / a), math.asinh(u3 / a)
    r0, r1 = math.sqrt(u0 * u0 + a2), math.sqrt(u1 * u1 + a2)
    r2, r3 = math.sqrt(u2 * u2 + a2), math.sqrt(u3 * u3 + a2)
    energy = e * ((u3 * s3 - u1 * s1 - u2 * s2 + u0 * s0) - (r3 - r1 - r2 + r0))
    by_i = e * (s3 - s1) - energy / li
    by_j = e * (s3 - s2) - energy / lj
    by_g = e * (s3 - s1 - s2 + s0)
    by_a = -e * (r3 - r1 - r2 + r0) / (2.0 * a2)
    return energy, by_i, by_j, by_g, by_a


@njit(cache=True, error_model="numpy")
def segment_self(q: float, length: float, a2: float) -> tuple[float, float, float]:
    """U, dU/dL, dU/d(a^2) of a segment with itself."""
    a = math.sqrt(a2)
    e = q / length
    root = math.sqrt(length * length + a2)
    arc = math.asinh(length / a)
    energy = e * e * (length * arc - root + a)
    by_l = e * e * arc - 2.0 * energy / length
    by_a = -e * e * (root - a) / (2.0 * a2)
    return energy, by_l, by_a


@njit(cache=True, error_model="numpy")
def point_pair(e: float, u: float, a2: float) -> tuple[float, float, float]:
    """U, dU/du, dU/d(a^2) of two softened points of product of charges e, u apart."""
    one = 1.0 / math.sqrt(u * u + a2)
    cube = one * one * one
    return e * one, -e * u * cube, -0.5 * e * cube


@njit(cache=True, error_model="numpy")
def ripple(li: float, lj: float, a2: float) -> tuple[float, float, float]:
    """C of the energy ``C (e_i - e_j)^2/2`` of neighbours whose line charges differ, and its slopes with L and a^2.

    A softened line hardly sees ripples shorter than its radius, ``K_0(k a)``, and would let them grow; the charge on a tube
    does, ``I_0(k a) K_0(k a) -> 1/(2 k a)``. ``C = L^2 exp(-L^2/a^2)/(4 pi a)`` gives the shortest ripple of short elements the
    energy of a tube's; elements twice as long as their radius have none of it. L is the harmonic mean: an
    element that vanishes where the jet lands takes its part with it.
    """
    long = 2.0 * li * lj / (li + lj)
    c = long * long * math.exp(-long * long / a2) / (4.0 * math.pi * math.sqrt(a2))
    by_l = 2.0 * c * (1.0 / long - long / a2)
    by_a = c / a2 * (long * long / a2 - 0.5)
    return c, by_l, by_a


@njit(cache=True, error_model="numpy")
def far_rest(length: float, reach: int, count: int, a2: float) -> tuple[float, float]:
    """What lumping costs between a segment and those beyond `reach` on one side of it, `count` in all: its half of it.

    U and dU/dL for unit charge. A pair of equal segments u apart differs from its lumped halves by ``-L^2 K''(u)/6`` with
    ``K = 1/sqrt(u^2 + a^2)``; the sum is taken as the integral from ``(reach + 1/2) L`` on.
    """
    if count <= reach:
        return 0.0, 0.0
    energy = slope = 0.0
    for side in range(2):
        u = (reach + 0.5 if side == 0 else count + 0.5) * length
        one = 1.0 / (u * u + a2)
        root = math.sqrt(one)
        first = -u * one * root
        second = (2.0 * u * u - a2) * one * one * root
        sign = 1.0 if side == 0 else -1.0
        energy += sign * length * first / 12.0
        slope += sign * (first + u * second) / 12.0
    return energy, slope


@njit(cache=True, error_model="numpy")
def feed_field(
    x: float, y: float, z: float, a2: float, length: float, start: float
) -> tuple[float, float, float, float, float, float]:
    """Field, potential and its derivative with a^2 of a uniform line from `start - length` to `start` on the axis."""
    u = x - start
    rho2 = y * y + z * z + a2
    near, far = math.sqrt(u * u + rho2), math.sqrt((u + length) ** 2 + rho2)
    ex = 1.0 / near - 1.0 / far
    # (u + L)/far - u/near over rho^2, without the difference where both are near 1
    if u > 0.0:
        across = ex * (1.0 / ((u + length) / far + u / near)) * (1.0 / near + 1.0 / far)
    else:
        across = ((u + length) / far - u / near) / rho2
    level = math.asinh((u + length) / math.sqrt(rho2)) - math.asinh(u / math.sqrt(rho2))
    return ex, across * y, across * z, level, -0.5 * across, across
