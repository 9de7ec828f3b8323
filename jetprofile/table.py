"""A jet given by samples (z, r) or (z, v): monotone, no overshoot, and a bounded strain rate.

V(z) is a cubic Hermite spline whose slope at each sample is the harmonic mean of the two secants, held to 3/2 of the
smaller one. It is then monotone between samples, and its strain rate is nowhere above 3/2 of the secant's: a
monotone cubic without that bound shows up to 3 times the secant, which a network would feel.

Error for smooth data: second order in the spacing, in V; first order in the strain rate at the worst point.
"""

from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, positive, real
from spinline.base.errors import InputError
from spinline.base.quadrature import gauss
from spinline.jetprofile.columns import read_columns
from spinline.jetprofile.straight import StraightJet

__all__ = ["Table"]


class Table(StraightJet):
    """Jet through measured or computed samples.

    Parameters
    ----------
    z : array_like
        Positions, m, strictly increasing, at least two, >= 0.
    radius : array_like, optional
        Jet radius at z, m, > 0, never increasing.
    velocity : array_like, optional
        Axial velocity at z, m/s, > 0, never decreasing; in place of `radius`.
    flow_rate : float
        Q, m3/s, > 0.
    initial_radius : float, optional
        r_0, m: where V = 1. Default: the radius at the first sample.

    Raises
    ------
    InputError
        For samples out of order, not monotone or not finite.

    Notes
    -----
    `start` and `end` are the first and last sample; nothing is extrapolated.
    """

    def __init__(
        self,
        *,
        z: ArrayLike,
        radius: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        flow_rate: float,
        initial_radius: float | None = None,
    ) -> None:
        position = real("z", z, least=0.0, unit="m")
        if position.ndim != 1 or position.size < 2:
            raise InputError("z", "needs at least two samples in one column", value=f"shape {position.shape}")
        _ordered("z", position, strictly=True)
        q = positive("flow_rate", flow_rate, "m3/s")
        if (radius is None) == (velocity is None):
            raise InputError("table", "needs one of radius and velocity", remedy="give one column, not both")
        if radius is not None:
            r = _sampled("radius", radius, position, "m")
            _ordered("radius", -r, remedy="smooth it, or fit it with `spinline fit-jet`")
        else:
            v = _sampled("velocity", velocity, position, "m/s")
            _ordered("velocity", v, remedy="smooth it, or fit it with `spinline fit-jet`")
            r = np.sqrt(q / (np.pi * v))
        self.given = "velocity" if radius is None else "radius"
        super().__init__(float(r[0]) if initial_radius is None else initial_radius, q)
        self.start, self.end = float(position[0]), float(position[-1])
        self._s = position / self.initial_radius
        self._v = (self.initial_radius / r) ** 2
        self._m = _bounded_slopes(self._s, self._v)
        self._t = np.concatenate(([0.0], np.cumsum(self._panel_times())))

    @classmethod
    def from_csv(cls, path: str | Path, *, flow_rate: float, initial_radius: float | None = None) -> Self:
        """Read columns ``z [unit]`` and ``radius [unit]`` or ``velocity [unit]`` from a table, z rising or falling.

        Of a table that has both, as those that are written here, the radius is taken; the velocity has to agree with it and the
        flow rate. Other columns are left out, with a warning.
        """
        kinds = {"z": "length", "radius": "length", "velocity": "velocity"}
        columns = read_columns(path, kinds, required=("z", ("radius", "velocity")), others=True)
        _rows(str(path), columns)
        if columns["z"].size > 1 and (np.diff(columns["z"]) < 0).all():  # written from the far end to the nozzle
            columns = {name: values[::-1] for name, values in columns.items()}
        if "radius" in columns and "velocity" in columns:
            _agree(str(path), columns["radius"], columns.pop("velocity"), positive("flow_rate", flow_rate, "m3/s"))
        return cls(
            z=columns["z"],
            radius=columns.get("radius"),
            velocity=columns.get("velocity"),
            flow_rate=flow_rate,
            initial_radius=initial_radius,
        )

    def kinks(self) -> tuple[float, ...]:
        """The samples: the curvature jumps there."""
        return tuple((self._s[1:-1] - self._s[0]).tolist())

    def _parameters(self) -> dict[str, object]:
        return {
            "z": (self._s * self.initial_radius).tolist(),
            "radius": (self.initial_radius / np.sqrt(self._v)).tolist(),
            "flow_rate": self.flow_rate,
            "initial_radius": self.initial_radius,
        }

    def _panel(self, s: FloatArray) -> tuple[Any, FloatArray, FloatArray]:
        i = np.clip(np.searchsorted(self._s, s, side="right") - 1, 0, self._s.size - 2)
        h = self._s[i + 1] - self._s[i]
        return i, np.clip((s - self._s[i]) / h, 0.0, 1.0), h

    def _ratio(self, s: FloatArray) -> FloatArray:
        i, t, h = self._panel(s)
        rise = self._v[i + 1] - self._v[i]
        a, b = h * self._m[i], h * self._m[i + 1]
        value: FloatArray = self._v[i] + t * (a + t * ((3 * rise - 2 * a - b) + t * (a + b - 2 * rise)))
        return value

    def _slope(self, s: FloatArray) -> FloatArray:
        i, t, h = self._panel(s)
        rise = self._v[i + 1] - self._v[i]
        a, b = h * self._m[i], h * self._m[i + 1]
        value: FloatArray = (a + t * (2 * (3 * rise - 2 * a - b) + 3 * t * (a + b - 2 * rise))) / h
        return np.maximum(value, 0.0)  # rounding only: the spline is monotone

    def _time(self, s: FloatArray) -> FloatArray:
        i, _, _ = self._panel(s)
        value: FloatArray = self._t[i] + self._quadrature(self._s[i], s)
        return value

    def _inverse(self, ratio: FloatArray) -> FloatArray:
        reached = (ratio >= self._v[0]) & (ratio <= self._v[-1])
        target = np.where(reached, ratio, self._v[0])
        i = np.clip(np.searchsorted(self._v, target, side="left") - 1, 0, self._s.size - 2)
        low, high = self._s[i], self._s[i + 1]
        for _ in range(60):  # bisection on a monotone panel
            middle = 0.5 * (low + high)
            below = self._ratio(middle) < target
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.where(reached, high, np.nan)

    def _panel_times(self) -> FloatArray:
        return self._quadrature(self._s[:-1], self._s[1:])

    def _quadrature(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """Integral of ds / V inside one panel, 16-point Gauss-Legendre."""
        nodes, weights = gauss(16)
        half = 0.5 * (np.asarray(high) - low)[..., np.newaxis]
        points = np.asarray(low)[..., np.newaxis] + half * (1 + nodes)
        value: FloatArray = np.sum(half * weights / self._ratio(points), axis=-1)
        return value


def _rows(file: str, columns: dict[str, FloatArray]) -> None:
    """Refuse rows that lack a number or stand in no order, by the row: what a spreadsheet or a merged file brings."""
    for name, values in columns.items():
        empty = np.flatnonzero(~np.isfinite(values))
        if empty.size:
            problem = f"has no finite {name} in row {int(empty[0]) + 1} below the header ({empty.size} such rows)"
            raise InputError(file, problem, remedy="drop those rows, or write the numbers")
    z = columns["z"]
    if (z < 0).any():
        row = int(np.argmax(z < 0)) + 1
        remedy = "z is the distance from the nozzle: turn its sign, or shift it"
        raise InputError(
            file, f"has a negative z in row {row} below the header", value=f"{1e3 * z[row - 1]:g} mm", remedy=remedy
        )
    step = np.diff(z)
    if (step < 0).all():
        return
    bad = np.flatnonzero(step <= 0)
    if bad.size:
        row, shown = int(bad[0]) + 1, f"{1e3 * z[bad[0]]:g} mm, {1e3 * z[bad[0] + 1]:g} mm"
        twice = step[bad[0]] == 0
        what = "stands twice" if twice else "falls"
        problem = f"z must strictly increase along the jet; it {what} in rows {row} and {row + 1}"
        remedy = "keep one of the rows, or their mean" if twice else "sort the rows by z, and give one jet a file"
        raise InputError(file, problem, value=shown, remedy=remedy)


_AGREEMENT = 0.02  # of pi r^2 v with the flow rate, in a table of both; r and v of four digits round to less


def _agree(file: str, radius: FloatArray, velocity: FloatArray, flow_rate: float) -> None:
    """Refuse radii and velocities that are not those of one liquid at this flow rate."""
    carried = np.pi * radius**2 * velocity
    off = np.flatnonzero(~(np.abs(carried - flow_rate) <= _AGREEMENT * flow_rate))
    if off.size:
        row = int(off[0])
        raise InputError(
            file,
            f"has radii and velocities that do not carry the flow rate (pi r^2 v of row {row + 1})",
            value=f"{carried[row]:.4g} m3/s",
            allowed=f"within {100 * _AGREEMENT:g} % of {flow_rate:.4g} m3/s",
            remedy="set flow_rate to that of the table, or leave one of the two columns out",
        )


def _sampled(field: str, values: ArrayLike | None, z: FloatArray, unit: str) -> FloatArray:
    array = real(field, 0.0 if values is None else values, above=0.0, unit=unit)
    if array.shape != z.shape:
        raise InputError(field, "must have one value for each z", value=f"{array.shape} against {z.shape}")
    return array


def _ordered(field: str, array: FloatArray, *, strictly: bool = False, remedy: str = "") -> None:
    step = np.diff(array)
    bad = np.flatnonzero(step <= 0 if strictly else step < 0)
    if bad.size:
        which = "strictly increase" if strictly else "be monotone"
        where = int(bad[0]) + 1
        shown = f"{abs(array[where - 1]):g}, {abs(array[where]):g}"
        raise InputError(field, f"must {which} along the jet; sample {where} does not", value=shown, remedy=remedy)


def _bounded_slopes(s: FloatArray, v: FloatArray) -> FloatArray:
    secant = np.diff(v) / np.diff(s)
    if secant.size == 1:
        return np.repeat(secant, 2)
    left, right = secant[:-1], secant[1:]
    smaller, larger = np.minimum(left, right), np.maximum(left, right)
    share = np.divide(smaller, larger, out=np.zeros_like(larger), where=larger > 0)
    inner = np.minimum(2 * smaller / (1 + share), 1.5 * smaller)
    first = np.clip(2 * secant[0] - inner[0], 0.0, 1.5 * secant[0])
    last = np.clip(2 * secant[-1] - inner[-1], 0.0, 1.5 * secant[-1])
    return np.concatenate(([first], inner, [last]))
