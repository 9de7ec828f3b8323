"""The jet's own potential as that of the whole charged line, in place of a local logarithm: ``log = "slender"``.

A line of charge ``lambda(z)`` of radius r from the needle to the plate has at z the potential, over ``1 / (4 pi eps_0)``,

    phi = int lambda(z') dz' / sqrt((z - z')^2 + r^2)
        = lambda ln(4 z (L - z) / r^2) + int [lambda(z') - lambda(z)] / |z - z'| dz'      (r << z, L - z)

less that of its mirror behind the plate, and that of the charge which it induces on the earthed needle. So the length in the
logarithm is ``2 sqrt(z (L - z))``, not L: near the needle, where a jet's charge is decided, the local logarithm is too large by
a third and the charge too small. ``Psi = l F`` stays the unknown (l the local logarithm); what is missing,

    D = S (P F - l F) ,      P F = (1/2) int F(s') K(s, s') ds',

enters as a field of its own, ``Psi' = E_ext - D' - E``: the equations and their energy are those of the local logarithm
in another field. D, a third of Psi at most, is iterated: each round solves for the F that gives the whole line the last
round's potential, so that what is left to the rounds is the answer of the jet.

Near the needle the jet is as wide as long: a line's potential says nothing there, and the needle's own imposed on it is an
equation of the first kind. S lets D in over the first ten radii; with three or twenty in their place the line charge
beyond twice as many moves by 0.5 %. Near the plate the line and its mirror cancel: S lets D go over the last fifth of the gap.
The jet ends on the plate and has its potential, Psi = 0, so all of the current is conducted there: its own potential, a
third of the voltage, falls over the last centimetre, which pulls the whole jet by a tenth more than the applied field at
its end would. A jet may thicken there. The needle answers as a slender body: charge on its axis that keeps its surface
at no potential (uniform field: the plate at the tip, a mirror).
"""

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from spinline.base.checks import FloatArray
from spinline.jetprofile.ehd.boundary_value import Discrete, Problem, halved, interpolate, newton, remesh, spline
from spinline.jetprofile.ehd.fields import HyperboloidField, NeedleField, UniformField
from spinline.jetprofile.ehd.settings import NeedleSettings
from spinline.jetprofile.ehd.solver import PLATE, Solved, errors_of, thins

__all__ = ["needle_axis", "own_potential", "whole_line"]

CONE = 10.0  # radii over which the local logarithm gives way
_RINGS = 24
_ROUNDS = 100
_CLOSED = 1e-8  # of Psi: change of D in the last round
_EASED = (0.3, 0.5, 0.7)  # D comes in by parts
_NODES = 201  # and once halved
_END = 13  # of the parameters: the condition on the field at the end
_HELD, _LOWERED = 4, 16  # rounds before the end's own potential is let down, and in which


def _smooth(x: FloatArray) -> FloatArray:
    x = np.clip(x, 0.0, 1.0)
    value: FloatArray = x * x * x * (10 - 15 * x + 6 * x * x)
    return value


def _segments(at: FloatArray, radius: FloatArray, nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Integrals of ``1 / sqrt(t^2 + R^2)`` and ``t / sqrt(t^2 + R^2)``, t = s' - s, over the pieces between nodes."""
    t = nodes[np.newaxis, :] - at[:, np.newaxis]
    wide = radius[:, np.newaxis]
    return np.diff(np.arcsinh(t / wide), axis=1), np.diff(np.hypot(t, wide), axis=1)


def _of_line(at: FloatArray, radius: FloatArray, nodes: FloatArray, gap: float) -> FloatArray:
    """Half the potential at places of F linear between nodes and constant from the last to the plate, and of its mirror."""
    total = np.zeros((at.size, nodes.size))
    h = np.diff(nodes)
    for side in (1.0, -1.0):
        here = at if side > 0 else 2 * gap - at
        zeroth, first = _segments(here, radius, nodes)
        t = nodes[np.newaxis, :] - here[:, np.newaxis]
        total[:, :-1] += side * (t[:, 1:] * zeroth - first) / h
        total[:, 1:] += side * (first - t[:, :-1] * zeroth) / h
        if gap > nodes[-1]:
            total[:, -1] += side * _segments(here, radius, np.array([nodes[-1], gap]))[0][:, 0]
    return 0.5 * total


def needle_axis(settings: NeedleSettings) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Ends of the pieces of axis that carry the needle's charge, their middles and the needle's radius there, in radii.

    Depths are counted from the tip away from the plate; None where the field is that of no needle.
    """
    gap = settings.gap / settings.radius
    shape = settings.applied_field
    if isinstance(shape, HyperboloidField):
        edges = np.concatenate(([0.5], np.geomspace(1.0, 3 * gap, _RINGS)))
    elif isinstance(shape, NeedleField):
        edges = np.concatenate(([0.5], np.geomspace(1.0, shape.length / settings.radius, _RINGS)))
    else:
        return None
    depth = 0.5 * (edges[1:] + edges[:-1])
    if isinstance(shape, HyperboloidField):
        return edges, depth, np.sqrt(depth * (2 * gap + depth) / gap)
    return edges, depth, np.where(depth < 1, np.sqrt(depth * (2 - np.minimum(depth, 1))), 1.0)


def own_potential(settings: NeedleSettings, s: FloatArray, radius: FloatArray) -> FloatArray:
    """Matrix P: Psi at the nodes s (radii R there) of line charges F at the nodes, the needle's and plate's answers in it."""
    gap = settings.applied_field.gap / settings.radius
    matrix = _of_line(s, radius, s, gap)
    if isinstance(settings.applied_field, UniformField):
        return matrix - _of_line(-s, radius, s, gap)
    needle = needle_axis(settings)
    if needle is None:
        return matrix
    edges, depth, wide = needle

    def of_axis(at: FloatArray, soft: FloatArray) -> FloatArray:
        """Half the potential at heights `at` over the tip of unit charges on the pieces, less their mirrors'."""
        near = -_segments(at, soft, -edges)[0]
        return 0.5 * (near + _segments(2 * gap - at, soft, -edges)[0])

    answer = np.linalg.solve(of_axis(-depth, wide), _of_line(-depth, wide, s, gap))
    less: FloatArray = matrix - of_axis(s, radius) @ answer
    return less


def _missing(settings: NeedleSettings, problem: Problem, found: Discrete, missing: FloatArray) -> FloatArray:
    """D of the charges whose whole potential is that of `found`, in whose field is `missing`."""
    s, u = found.s, found.y[:, 0]
    log = problem.parameters[6] + 0.5 * u
    gap = settings.applied_field.gap / settings.radius
    kept = _smooth(s / CONE) * (1 - _smooth((s / gap - PLATE) / (1 - PLATE)))
    matrix = kept[:, np.newaxis] * own_potential(settings, s, np.exp(-0.5 * u))
    matrix[np.diag_indices(s.size)] += (1 - kept) * log
    whole = found.y[:, 2] + missing
    value: FloatArray = whole - log * np.linalg.solve(matrix, whole)
    return value


def _in_field(problem: Problem, s: FloatArray, missing: FloatArray, level: float | None) -> Problem:
    """With the field of `missing`, and the own potential `level` at the plate (None: the applied field there)."""
    slope = CubicSpline(s, missing).derivative()
    before, parameters = problem.field, problem.parameters.copy()
    if level is not None:
        parameters[_END] = -level

    def field(at: FloatArray) -> FloatArray:
        value: FloatArray = before(at) - slope(at)
        return value

    return replace(problem, field=field, parameters=parameters)


def _closed(
    settings: NeedleSettings, problem: Problem, found: Discrete, missing: FloatArray, earthed: bool
) -> tuple[Problem, Discrete, FloatArray] | None:
    """Jet and D on one mesh, each the other's; None where they do not close.

    Where the start is not `earthed`, the potential at its end is let down to the plate's once D has all but settled.
    """
    first = last = stride = 0.0
    for step in range(_ROUNDS):
        ease = _EASED[step] if step < len(_EASED) else 1.0
        held = not earthed and step < _HELD
        if not earthed and step == _HELD:
            first = last = float(found.y[-1, 2])
            stride = first / _LOWERED
        level = max(last - stride, 0.0) if last > 0.0 else 0.0
        made = newton(_in_field(problem, found.s, missing, None if held else level), found.s, found.y)
        if not made.converged:
            stride *= 0.5
            if held or last == 0.0 or stride < 1e-3 * first:
                return None
            continue
        change = _missing(settings, problem, made, missing) - missing
        found, last = made, level
        if np.abs(change).max() < _CLOSED * np.abs(found.y[:, 2]).max() and level == 0.0 and not held:
            return _in_field(problem, found.s, missing, 0.0), found, missing
        missing = missing + ease * change
    return None


def whole_line(settings: NeedleSettings, local: Solved) -> Solved:
    """The jet whose potential is that of the whole line, from the one of the local logarithm.

    Parameters
    ----------
    settings : NeedleSettings
        With ``log = "slender"``.
    local : Solved
        Solution of the same settings with the local logarithm.

    Returns
    -------
    Solved
        ``why`` is "lost" where the iteration does not close. Its `problem` has the line's own field in the applied one;
        errors are those of the mesh and of the line cut into straight pieces of charge.
    """
    problem = replace(local.problem, work=None)
    s = remesh(local.discrete.s, local.discrete.y, _NODES)
    start = Discrete(s, interpolate(local.discrete.s, local.discrete.y, s))
    made = _closed(settings, problem, start, np.zeros(_NODES), earthed=False)
    if made is None:
        return replace(local, why="lost")
    now, before, missing = made
    s = halved(s)
    made = _closed(
        settings, problem, Discrete(s, spline(now, before)[0](s)), CubicSpline(before.s, missing)(s), earthed=True
    )
    if made is None:
        return replace(local, why="lost")
    now, found, _ = made
    error = errors_of(now, found)
    if error is None:
        return replace(local, why="mesh")
    change = np.abs(interpolate(before.s, before.y, s) - found.y) / 3  # order 2
    error["radius"] = max(error["radius"], 0.5 * float(change[:, 0].max()))
    error["current"] = max(error["current"], float(change[0, 3]))
    why = "" if error["radius"] < 0.005 and thins(now, found) else "mesh"
    return Solved(now, found, error, why, local.pull, local.time_share, local.direct)
