"""Forces on the nodes of the chain and rates of its elements, compiled (what they are stands in `chain`).

Node 0 is the free end, node n the nozzle; element i joins node i to node i + 1, so its tangent points downstream. The
last element grows: material enters it at the flow rate. Every loop is O(n); the charge's long reach is in
`_coulomb_kernels`.
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._air_kernels import air_forces
from spinline.jetprofile.spun._bend_kernels import moment_rates
from spinline.jetprofile.spun._codes import (
    AIR,
    AREA,
    ARR,
    ARR_IN,
    AZZ,
    AZZ_IN,
    BALANCE,
    CHARGE,
    CHARGE_DENSITY,
    COLUMNS,
    COMPLIANCE,
    CONE,
    COULOMB,
    COUPLING,
    DRYING,
    END,
    EXACT,
    EXPLICIT_SOLVENT,
    EXTRAPOLATED,
    FLOW,
    FROZEN,
    G_HERE,
    GRAVITY,
    HYBRID,
    INLET,
    LABEL,
    LAW,
    LENGTH,
    LOAD_RAMP,
    LOCAL,
    LOG_LENGTH,
    NEEDLE_AT,
    POLYMER,
    PRESSURE,
    RADIUS,
    RATE,
    REPULSION,
    RHO,
    SETTLE,
    SETTLED,
    SHARE,
    SOLVENT_HERE,
    SPIN,
    SURFACE,
    TEMP,
    TENSION,
    TENSION_IN,
    THETA_HERE,
    TRACTION,
    TX,
    TY,
    TZ,
    VOLUME,
    VX,
    VY,
    VZ,
    IntArray,
    X,
    Y,
    Z,
)
from spinline.jetprofile.spun._collector_kernels import surface_velocity
from spinline.jetprofile.spun._cone_kernels import cone_forces
from spinline.jetprofile.spun._coulomb_kernels import repulsion
from spinline.jetprofile.spun._dry_kernels import drying_rates, material
from spinline.jetprofile.spun._field_kernels import field_forces
from spinline.jetprofile.spun._law_kernels import inlet_stretch, law_rates, stress_ratio
from spinline.jetprofile.spun._needle_kernels import needle_forces
from spinline.jetprofile.spun._neighbour_kernels import neighbour_forces
from spinline.jetprofile.spun._nozzle_kernels import affine_inlet, nozzle, smooth

__all__ = ["explicit_rates", "geometry", "inlet_radius"]


@njit(cache=True, error_model="numpy")
def geometry(n: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray) -> bool:
    """Length, tangent, area, strain rate, stress of every element; False where one has collapsed or overstretched."""
    for i in range(n):
        dx, dy, dz = y[i, X] - y[i + 1, X], y[i, Y] - y[i + 1, Y], y[i, Z] - y[i + 1, Z]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        if not length > 0.0 or not y[i, VOLUME] > 0.0:
            return False
        w[LENGTH, i] = length
        w[TX, i], w[TY, i], w[TZ, i] = dx / length, dy / length, dz / length
        w[AREA, i] = y[i, VOLUME] / length
        along = (
            (y[i, VX] - y[i + 1, VX]) * dx + (y[i, VY] - y[i + 1, VY]) * dy + (y[i, VZ] - y[i + 1, VZ]) * dz
        ) / length
        w[RATE, i] = along / length
        w[SHARE, i] = p[SETTLED]
        if p[CONE] > 0.0:
            share, _ = smooth(0.5 * (y[i, X] + y[i + 1, X]) - p[NEEDLE_AT], p[CONE])
            w[SHARE, i] *= share
        material(i, y, p, k, w)
        ratio = stress_ratio(k[LAW], y[i, AZZ], y[i, ARR], p)
        if not abs(ratio) < 1e30:
            return False
        w[POLYMER, i] = w[AREA, i] * w[G_HERE, i] * ratio
    return True


@njit(cache=True, error_model="numpy")
def local_tension(n: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray) -> None:
    """Total tension that acts along each element and depends on that element alone."""
    for i in range(n):
        radius = math.sqrt(w[AREA, i] / math.pi)
        pull = w[POLYMER, i] + p[SURFACE] * math.pi * radius
        if k[EXPLICIT_SOLVENT] == 1:
            pull += 3.0 * w[SOLVENT_HERE, i] * w[RATE, i] * w[AREA, i]
        near = 1.0 if k[REPULSION] == LOCAL else 1.0 - w[SHARE, i] ** 2
        if near > 0.0:
            charge = y[i, CHARGE] / w[LENGTH, i]
            pull -= p[COUPLING] * near * charge * charge * (math.log(p[LOG_LENGTH] / radius) - 0.5 * k[PRESSURE])
        w[TENSION, i] = pull


@njit(cache=True, error_model="numpy")
def inlet_radius(n: int, y: FloatArray, p: FloatArray, w: FloatArray) -> float:
    """Radius where material enters: given, or yielding to the tension as the jet upstream does."""
    if p[COMPLIANCE] == 0.0:
        value: float = p[RADIUS]
        return value
    pull = _inlet_tension(n, y, w)
    if not pull > 0.0:
        value = p[RADIUS]
        return value
    value = p[RADIUS] * (pull / p[TENSION_IN]) ** (-p[COMPLIANCE])
    return value


@njit(cache=True, error_model="numpy")
def _inlet_tension(n: int, y: FloatArray, w: FloatArray) -> float:
    """Tension of the polymer carried on to the nozzle, linear in the label, bounded to half the last element's."""
    own = w[POLYMER, n - 1]
    if n < 2:
        value: float = own
        return value
    step = (w[POLYMER, n - 2] - own) * y[n - 1, VOLUME] / (y[n - 1, VOLUME] + y[n - 2, VOLUME])
    most = 0.5 * abs(own)
    value = own - min(max(step, -most), most)
    return value


@njit(cache=True, error_model="numpy")
def _forces(
    t: float,
    n: int,
    held: IntArray,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    f: FloatArray,
) -> None:
    """Sum of all forces on the nodes but the solvent's (which the implicit stage adds)."""
    for i in range(n + 1):
        f[i, 0] = f[i, 1] = f[i, 2] = 0.0
    share, _ = smooth(t, p[LOAD_RAMP])
    p[COUPLING] = COULOMB * share
    local_tension(n, y, p, k, w)
    repulsion(n, y, p, k, w, f)
    if k[REPULSION] == HYBRID:
        needle_forces(n, y, p, k, tables, w, f)
    if k[REPULSION] == HYBRID or k[REPULSION] == EXACT:
        cone_forces(n, y, p, k, tables, w, f)
    for i in range(n):
        pull = w[TENSION, i]
        if held[i] == 1 and (pull < 0.0 or w[RATE, i] <= 0.0):
            pull = 0.0
        for c in range(3):
            f[i, c] -= pull * w[TX + c, i]
            f[i + 1, c] += pull * w[TX + c, i]
    field_forces(t, n, y, p, k, tables, f)
    if tables[0, 3] > 0.0:
        neighbour_forces(t, n, y, p, tables, w, f)
    if k[AIR] == 1:
        air_forces(n, y, p, k, tables, w, f)
    for i in range(n):
        mass = 0.5 * p[RHO] * (y[i, VOLUME] + (y[i - 1, VOLUME] if i > 0 else 0.0))
        f[i, 0] += share * mass * p[GRAVITY]
    if k[END] == TRACTION:
        pull = end_value(y[0, X], tables, 1)
        for c in range(3):
            f[0, c] += pull * w[TX + c, 0]


@njit(cache=True, error_model="numpy")
def end_value(x: float, tables: FloatArray, row: int) -> float:
    """A quantity of the straight jet at the end node: row 1 the tension, 2 the conducted share of the current."""
    count = int(tables[0, 0])
    axis = tables[3]
    if x <= axis[0]:
        value: float = tables[row, 0]
        return value
    for j in range(1, count):
        if x <= axis[j]:
            part = (x - axis[j - 1]) / (axis[j] - axis[j - 1])
            value = tables[row, j - 1] * (1.0 - part) + tables[row, j] * part
            return value
    value = tables[row, count - 1]
    return value


@njit(cache=True, error_model="numpy")
def explicit_rates(
    t: float,
    n: int,
    held: IntArray,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    f: FloatArray,
    dy: FloatArray,
) -> bool:
    """Time derivative of the state at t; the nozzle's row of `y` is set to where the nozzle is at t."""
    p[SETTLED], _ = smooth(t, p[SETTLE])
    if not geometry(n, y, p, k, w):
        return False
    radius = inlet_radius(n, y, p, w)
    speed = p[FLOW] / (math.pi * radius * radius)
    nozzle(t, n, speed, y, p)
    if not geometry(n, y, p, k, w):
        return False
    for i in range(n):
        if held[i] == 1 and w[RATE, i] < 0.0:  # a laid thread is pushed without resistance: it coils
            w[RATE, i] = 0.0
    _forces(t, n, held, y, p, k, tables, w, f)
    for i in range(n):
        mass = 0.5 * p[RHO] * (y[i, VOLUME] + (y[i - 1, VOLUME] if i > 0 else 0.0))
        for c in range(3):
            dy[i, X + c] = y[i, VX + c]
            dy[i, VX + c] = f[i, c] / mass
        dy[i, AZZ], dy[i, ARR] = law_rates(k[LAW], w[RATE, i], y[i, AZZ], y[i, ARR], w[G_HERE, i], w[THETA_HERE, i], p)
        dy[i, CHARGE] = dy[i, VOLUME] = dy[i, TEMP] = dy[i, LABEL] = dy[i, SPIN] = 0.0
    moment_rates(n, y, k, w, dy)
    if k[DRYING] == 1:
        drying_rates(n, y, p, tables, w, dy)
    for i in range(n):
        if held[i] == 1:  # on the collector, whose surface it moves with
            for c in range(3):
                dy[i, X + c] = 0.0
                dy[i, VX + c] = 0.0
            dy[i, X], dy[i, Y] = surface_velocity(y[i, X], y[i, Y], p, k)
    for c in range(COLUMNS):
        dy[n, c] = 0.0
    _inflow(n, radius, y, p, k, w, dy)
    return True


@njit(cache=True, error_model="numpy")
def _inflow(n: int, radius: float, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, dy: FloatArray) -> None:
    """What the material that enters brings into the growing element."""
    i = n - 1
    flow, volume = p[FLOW], y[i, VOLUME]
    dy[i, VOLUME] += flow
    dy[i, LABEL] = flow
    if k[BALANCE] == FROZEN:
        dy[i, CHARGE] = p[CHARGE_DENSITY] * flow
    azz = p[AZZ_IN]
    if k[INLET] == EXTRAPOLATED and w[G_HERE, i] > 0.0:
        area = math.pi * radius * radius
        azz = inlet_stretch(k[LAW], _inlet_tension(n, y, w) / (area * w[G_HERE, i]), p[ARR_IN], p)
    if not affine_inlet(p, k):
        dy[i, AZZ] += flow / volume * (azz - y[i, AZZ])
        dy[i, ARR] += flow / volume * (p[ARR_IN] - y[i, ARR])
        return
    # what enters takes the element's area at once, and the element is stretched by what its area says: without relaxation
    # A_zz A^2 and A_rr/A stay what they are at the nozzle, however little of the first stretch one element resolves
    area = y[i, LABEL] / w[LENGTH, i]
    thinner = math.pi * radius * radius / area
    more = (y[n, VX] * w[TX, i] - flow / area) / w[LENGTH, i]
    dy[i, AZZ] += 2.0 * more * y[i, AZZ] + flow / y[i, LABEL] * (azz * thinner * thinner - y[i, AZZ])
    dy[i, ARR] += -more * y[i, ARR] + flow / y[i, LABEL] * (p[ARR_IN] / thinner - y[i, ARR])
