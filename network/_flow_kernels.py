"""Compiled look-ups in the tables of `flow`, for beads in order: each search goes on from the last.

Tables hold the age and the slowness 1/V at the nodes; where they have two rows, the second is the reference in which
ages are counted and the first the profile from which the flow is changing.
"""

from numba import njit

from spinline.checks import FloatArray

__all__ = ["ages_of", "cell", "lookup_now", "positions_of", "stage_rates"]


@njit(cache=True, error_model="numpy")
def cell(nodes: FloatArray, x: float, j: int) -> int:
    """Cell of the table that holds x, walking from cell j: beads come in order."""
    last = nodes.size - 2
    while j < last and x >= nodes[j + 1]:
        j += 1
    while j > 0 and x < nodes[j]:
        j -= 1
    return j


@njit(cache=True, error_model="numpy")
def lookup(nodes: FloatArray, age: FloatArray, slow: FloatArray, x: float, j: int) -> tuple[float, float, float]:
    """Age a(x), V = 1/a' and V'; straight outside the table."""
    last = nodes.size - 1
    if x <= nodes[0]:
        return age[0] + (x - nodes[0]) * slow[0], 1 / slow[0], 0.0
    if x >= nodes[last]:
        return age[last] + (x - nodes[last]) * slow[last], 1 / slow[last], 0.0
    width = nodes[j + 1] - nodes[j]
    t = (x - nodes[j]) / width
    p = slow[j]
    q = slow[j + 1]
    mean = (age[j + 1] - age[j]) / width
    b = 3 * mean - 2 * p - q
    c = p + q - 2 * mean
    slope = p + t * (2 * b + 3 * t * c)
    curve = (2 * b + 6 * t * c) / width
    return age[j] + width * t * (p + t * (b + t * c)), 1 / slope, -curve / (slope * slope)


@njit(cache=True, error_model="numpy")
def lookup_now(
    nodes: FloatArray, age: FloatArray, slow: FloatArray, share: float, x: float, j: int
) -> tuple[float, float, float, float, float]:
    """Age, reference V and V', and V and V' now; tables of shape (2, nodes), the second is the reference."""
    a, v, dv = lookup(nodes, age[1], slow[1], x, j)
    if share >= 1.0:
        return a, v, dv, v, dv
    _, u, du = lookup(nodes, age[0], slow[0], x, j)
    return a, v, dv, share * v + (1 - share) * u, share * dv + (1 - share) * du


@njit(cache=True, error_model="numpy")
def ages_of(nodes: FloatArray, age: FloatArray, slow: FloatArray, x: FloatArray, out: FloatArray) -> None:
    """Reference age of each bead."""
    j = nodes.size - 2
    for i in range(x.size):
        j = cell(nodes, x[i], j)
        out[i] = lookup(nodes, age[1], slow[1], x[i], j)[0]


@njit(cache=True, error_model="numpy")
def stage_rates(
    nodes: FloatArray,
    age: FloatArray,
    slow: FloatArray,
    x: FloatArray,
    known_age: FloatArray,
    push: FloatArray,
    free: int,
    g: float,
    inertia: float,
    now: FloatArray,
    rate: FloatArray,
    velocity: FloatArray,
    surplus: FloatArray,
    speed: FloatArray,
) -> None:
    """Age, rate of age, velocity, ``I x''`` and reference V of each bead, read off the equation of a solved stage."""
    j = nodes.size - 2
    for i in range(x.size):
        j = cell(nodes, x[i], j)
        a, v, _ = lookup(nodes, age[1], slow[1], x[i], j)
        now[i] = a
        speed[i] = v
        if i < free:
            rate[i] = (a - known_age[i]) / g
            velocity[i] = rate[i] * v
            surplus[i] = (inertia * velocity[i] - push[i]) / g
        else:
            rate[i] = 1 / v
            velocity[i] = 1.0
            surplus[i] = 0.0


@njit(cache=True, error_model="numpy")
def positions_of(nodes: FloatArray, age: FloatArray, slow: FloatArray, a: FloatArray, out: FloatArray) -> None:
    """Position of each reference age, to rounding of a first guess: the inverse of `ages_of`."""
    table = age[1]
    last = nodes.size - 1
    j = last - 1
    for i in range(a.size):
        if a[i] <= table[0]:
            out[i] = nodes[0] + (a[i] - table[0]) / slow[1, 0]
        elif a[i] >= table[last]:
            out[i] = nodes[last] + (a[i] - table[last]) / slow[1, last]
        else:
            j = cell(table, a[i], j)
            x = nodes[j] + (nodes[j + 1] - nodes[j]) * (a[i] - table[j]) / (table[j + 1] - table[j])
            width = nodes[j + 1] - nodes[j]
            for _ in range(4):
                now, v, _ = lookup(nodes, table, slow[1], x, j)
                step = (a[i] - now) * v
                x = min(max(x + step, nodes[j]), nodes[j + 1])
                if abs(step) < 1e-6 * width:
                    break
            out[i] = x
