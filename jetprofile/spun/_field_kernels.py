"""Applied electric and magnetic field at a point, and its force on the nodes, compiled.

Fields: uniform; the closed form of a hyperboloidal tip over a plate (`HYPERBOLOID`), on and off the axis; a table along
the axis, continued off it as an axisymmetric source-free field to first order. Beside it a transverse field, rotating
(Eq. 25) or switching, and a uniform magnetic field (Eq. 26).
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    AXIS_TABLE,
    B_X,
    CHARGE,
    FIELD,
    FIELD_KIND,
    GAP,
    HYPERBOLOID,
    LOAD_RAMP,
    NEEDLE_AT,
    NO_SIDE,
    ROTATING,
    SIDE_FIELD,
    SIDE_KIND,
    SIDE_OMEGA,
    TIP,
    VOLTAGE,
    VX,
    IntArray,
    X,
    Y,
    Z,
)
from spinline.jetprofile.spun._nozzle_kernels import smooth

__all__ = ["applied_field", "drop", "field_forces", "hyperboloid", "hyperboloid_level"]


@njit(cache=True, error_model="numpy")
def hyperboloid(x: float, rho: float, voltage: float, gap: float, tip: float) -> tuple[float, float]:
    """Axial and radial field of a hyperboloid of tip radius `tip` at x = 0 over a plate at x = gap."""
    xi0 = math.sqrt(gap / (gap + tip))
    a = gap / xi0
    scale = voltage / math.log((1.0 + xi0) / (1.0 - xi0))
    d = gap - x
    far = math.sqrt((d + a) ** 2 + rho * rho)
    near = math.sqrt((d - a) ** 2 + rho * rho)
    xi = (far - near) / (2.0 * a)
    slope = 2.0 * scale / (1.0 - xi * xi) / (2.0 * a)
    along = slope * ((d + a) / far - (d - a) / near)
    across = -slope * rho * (1.0 / far - 1.0 / near)
    return along, across


@njit(cache=True, error_model="numpy")
def hyperboloid_level(x: float, rho: float, voltage: float, gap: float, tip: float) -> float:
    """Potential of the hyperboloid, V: `voltage` at its tip, 0 at the plate."""
    xi0 = math.sqrt(gap / (gap + tip))
    a = gap / xi0
    d = gap - x
    xi = (math.sqrt((d + a) ** 2 + rho * rho) - math.sqrt((d - a) ** 2 + rho * rho)) / (2.0 * a)
    return voltage * math.atanh(xi) / math.atanh(xi0)


@njit(cache=True, error_model="numpy")
def drop(
    t: float,
    x0: float,
    y0: float,
    z0: float,
    x1: float,
    y1: float,
    z1: float,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
) -> float:
    """Fall of the applied potential from point 0 to point 1, V; from the closed form where there is one."""
    if k[FIELD_KIND] == HYPERBOLOID:
        share, _ = smooth(t, p[LOAD_RAMP])
        first, last = math.sqrt(y0 * y0 + z0 * z0), math.sqrt(y1 * y1 + z1 * z1)
        at, gap = p[NEEDLE_AT], p[GAP] - p[NEEDLE_AT]
        total = hyperboloid_level(x0 - at, first, p[VOLTAGE], gap, p[TIP])
        total -= hyperboloid_level(x1 - at, last, p[VOLTAGE], gap, p[TIP])
        ey, ez = _side(t, p, k)
        return share * (total + ey * (y1 - y0) + ez * (z1 - z0))
    total = 0.0
    for part in range(3):  # Simpson
        u = 0.5 * part
        weight = (4.0 if part == 1 else 1.0) / 6.0
        ex, ey, ez = applied_field(t, x0 + u * (x1 - x0), y0 + u * (y1 - y0), z0 + u * (z1 - z0), p, k, tables)
        total += weight * (ex * (x1 - x0) + ey * (y1 - y0) + ez * (z1 - z0))
    return total


@njit(cache=True, error_model="numpy")
def _side(t: float, p: FloatArray, k: IntArray) -> tuple[float, float]:
    """Transverse field, Eq. (25): rotating, or switching along y."""
    if k[SIDE_KIND] == NO_SIDE:
        return 0.0, 0.0
    turn = p[SIDE_OMEGA] * t
    if k[SIDE_KIND] == ROTATING:
        return p[SIDE_FIELD] * math.cos(turn), p[SIDE_FIELD] * math.sin(turn)
    return (p[SIDE_FIELD] if math.sin(turn) >= 0.0 else -p[SIDE_FIELD]), 0.0


@njit(cache=True, error_model="numpy")
def _from_table(x: float, rho: float, tables: FloatArray) -> tuple[float, float]:
    """Field between the samples of a table; constant beyond its ends."""
    count = int(tables[0, 1])
    axis, values = tables[4], tables[5]
    if x <= axis[0]:
        return values[0], 0.0
    if x >= axis[count - 1]:
        return values[count - 1], 0.0
    low, high = 0, count - 1
    while high - low > 1:
        mid = (low + high) // 2
        if axis[mid] <= x:
            low = mid
        else:
            high = mid
    slope = (values[high] - values[low]) / (axis[high] - axis[low])
    return values[low] + slope * (x - axis[low]), -0.5 * rho * slope


@njit(cache=True, error_model="numpy")
def applied_field(
    t: float, x: float, y: float, z: float, p: FloatArray, k: IntArray, tables: FloatArray
) -> tuple[float, float, float]:
    """Field at a point and a moment, V/m."""
    ex, ey, ez = p[FIELD], 0.0, 0.0
    if k[FIELD_KIND] == HYPERBOLOID or k[FIELD_KIND] == AXIS_TABLE:
        rho = math.sqrt(y * y + z * z)
        if k[FIELD_KIND] == HYPERBOLOID:
            ex, er = hyperboloid(x - p[NEEDLE_AT], rho, p[VOLTAGE], p[GAP] - p[NEEDLE_AT], p[TIP])
        else:
            ex, er = _from_table(x, rho, tables)
        if rho > 0.0:
            ey, ez = er * y / rho, er * z / rho
    side_y, side_z = _side(t, p, k)
    ey, ez = ey + side_y, ez + side_z
    share, _ = smooth(t, p[LOAD_RAMP])
    return share * ex, share * ey, share * ez


@njit(cache=True, error_model="numpy")
def field_forces(
    t: float, n: int, y: FloatArray, p: FloatArray, k: IntArray, tables: FloatArray, f: FloatArray
) -> None:
    """Electric and magnetic force on every moving node."""
    magnetic = p[B_X] != 0.0 or p[B_X + 1] != 0.0 or p[B_X + 2] != 0.0
    for i in range(n):
        charge = 0.5 * (y[i, CHARGE] + (y[i - 1, CHARGE] if i > 0 else 0.0))
        ex, ey, ez = applied_field(t, y[i, X], y[i, Y], y[i, Z], p, k, tables)
        if magnetic:
            vx, vy, vz = y[i, VX], y[i, VX + 1], y[i, VX + 2]
            ex += vy * p[B_X + 2] - vz * p[B_X + 1]
            ey += vz * p[B_X] - vx * p[B_X + 2]
            ez += vx * p[B_X + 1] - vy * p[B_X]
        f[i, 0] += charge * ex
        f[i, 1] += charge * ey
        f[i, 2] += charge * ez
