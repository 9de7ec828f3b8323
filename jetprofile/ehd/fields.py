"""Electric field of a needle at a voltage over a grounded plate, without the jet.

The mean field V / H is never the field at the needle: there it is two hundred times larger.

===================  =================================================================================================
`UniformField`       V / H everywhere: plates, or a needle flush with one
`HyperboloidField`   the needle as a hyperboloid of tip radius r_c: closed form; it flares behind, which no needle does
`NeedleField`        a cylinder with a hemispherical end, its image in the plate: rings of charge on its surface
`TableField`         samples of a field solver along the axis
===================  =================================================================================================

Each has ``axial(z)``, E_z on the axis in V/m, z from the tip towards the plate; the first three also ``vector(z, r)``,
(E_z, E_r), and ``potential(z, r)`` in V, off the axis. All point towards the plate for a positive voltage.
"""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipe, ellipkm1

from spinline.base.checks import FloatArray, positive, real
from spinline.base.errors import InputError
from spinline.base.quadrature import gauss

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

__all__ = ["AppliedField", "HyperboloidField", "NeedleField", "TableField", "UniformField"]

_CAP = 40  # panels on the rounded end of a needle


class AppliedField(Protocol):
    """What a jet needs to know of the electrodes."""

    @property
    def gap(self) -> float:
        """Distance from the tip to the plate, m."""

    def axial(self, z: ArrayLike) -> FloatArray:
        """E_z on the axis in V/m at z (m) from the tip."""


def _checked(voltage: float, gap: float) -> None:
    positive("voltage", voltage, "V")
    positive("gap", gap, "m")


@dataclass(frozen=True)
class UniformField:
    """The mean field everywhere: ``E = V / H``.

    Parameters
    ----------
    voltage : float
        V, > 0.
    gap : float
        Distance H between the needle's tip and the plate, m, > 0.
    """

    voltage: float
    gap: float

    def __post_init__(self) -> None:
        _checked(self.voltage, self.gap)

    def axial(self, z: ArrayLike) -> FloatArray:
        """E_z in V/m."""
        return np.full(np.shape(z), self.voltage / self.gap)

    def vector(self, z: ArrayLike, r: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """E_z and E_r in V/m at z and distance r from the axis, m."""
        shape = np.broadcast_shapes(np.shape(z), np.shape(r))
        return np.full(shape, self.voltage / self.gap), np.zeros(shape)

    def potential(self, z: ArrayLike, r: ArrayLike) -> FloatArray:
        """Potential over the plate's in V."""
        shape = np.broadcast_shapes(np.shape(z), np.shape(r))
        value: FloatArray = np.broadcast_to(self.voltage * (1 - np.asarray(z, dtype=float) / self.gap), shape)
        return value


@dataclass(frozen=True)
class HyperboloidField:
    """Field of a hyperboloid of revolution over a plate, in closed form.

    ``xi_0 = sqrt(H / (H + r_c))``, ``a = H / xi_0``, ``Phi = (V / Lam) ln((1 + xi) / (1 - xi))`` with
    ``Lam = ln((1 + xi_0) / (1 - xi_0))`` and ``xi = (r_+ - r_-) / (2 a)``, r_+- the distances to the foci +-a about the plate.

    Parameters
    ----------
    voltage, gap : float
        V (V) and H (m), > 0.
    radius : float
        Radius of curvature r_c of the tip, m, > 0: the needle's radius.

    Examples
    --------
    >>> field = HyperboloidField(voltage=6e3, gap=0.1, radius=125e-6)
    >>> round(float(field.axial(1e-3)) / 1e5, 4)
    7.0337
    """

    voltage: float
    gap: float
    radius: float

    def __post_init__(self) -> None:
        _checked(self.voltage, self.gap)
        positive("radius", self.radius, "m")
        real("radius", self.radius / self.gap, least=1e-12, most=1e3, remedy="the radius over the gap")

    @cached_property
    def _shape(self) -> tuple[float, float]:
        """Half the distance between the foci, and Lam."""
        share = self.radius / self.gap
        xi = 1 / np.sqrt(1 + share)
        # 1 - xi without the difference of near numbers
        return self.gap / xi, float(np.log((1 + xi) ** 2 * (1 + share) / share))

    def axial(self, z: ArrayLike) -> FloatArray:
        """E_z on the axis in V/m, 0 <= z <= gap."""
        at = real("z", z, least=0.0, most=self.gap * (1 + 1e-12), unit="m")
        a, lam = self._shape
        # 1 - (H - z)^2 / a^2 = [(a - H) + z] [(a + H) - z] / a^2,  a - H = H r_c / (a + H)
        nearer = self.gap * self.radius / (a + self.gap) + at
        value: FloatArray = 2 * self.voltage * a / (lam * nearer * (a + self.gap - at))
        return value

    def vector(self, z: ArrayLike, r: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """E_z and E_r in V/m at z and distance r from the axis, m; outside the hyperboloid."""
        a, lam = self._shape
        height = self.gap - np.asarray(z, dtype=float)
        across = np.asarray(r, dtype=float)
        far, near = np.hypot(height + a, across), np.hypot(height - a, across)
        xi, slope = (far - near) / (2 * a), 2 * self.voltage / lam
        pull = slope / (1 - xi**2) / (2 * a)
        up = pull * ((height + a) / far - (height - a) / near)
        out = -pull * (across / far - across / near)
        return up, out

    def potential(self, z: ArrayLike, r: ArrayLike) -> FloatArray:
        """Potential over the plate's in V."""
        a, lam = self._shape
        height = self.gap - np.asarray(z, dtype=float)
        across = np.asarray(r, dtype=float)
        xi = (np.hypot(height + a, across) - np.hypot(height - a, across)) / (2 * a)
        value: FloatArray = 2 * self.voltage / lam * np.arctanh(xi)
        return value


@dataclass(frozen=True)
class NeedleField:
    """Field of a needle with a hemispherical end over a plate.

    Rings of charge on the needle's surface and their images in the plate (a boundary-element solution, 12 ms). Off the axis it
    is good from a twentieth of a radius from the surface on.

    Parameters
    ----------
    voltage, gap, radius : float
        V (V), H (m) and the needle's outer radius (m), > 0.
    length : float
        Length of the needle in m, > radius. 25.4 mm (1 inch) by default.
    """

    voltage: float
    gap: float
    radius: float
    length: float = 25.4e-3

    def __post_init__(self) -> None:
        _checked(self.voltage, self.gap)
        positive("radius", self.radius, "m")
        positive("length", self.length, "m")
        real("length", self.length / self.radius, least=3.0, most=1e5, remedy="the needle's length over its radius")
        real("gap", self.gap / self.radius, least=0.1, most=1e6, remedy="the gap over the needle's radius")

    @cached_property
    def _charges(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Height over the plate, radius and charge (over 4 pi eps_0, V m) of rings of charge; one row a panel."""
        return _solve_rings(self.voltage, self.gap, self.radius, self.length)

    @property
    def _rings(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        height, radius, charge = self._charges
        return height.ravel(), radius.ravel(), charge.ravel()

    @cached_property
    def _spline(self) -> "CubicSpline":
        reach = np.log1p(self.gap / self.radius * 4)
        z = self.radius / 4 * np.expm1(np.linspace(0, reach, 400))
        z[0], z[-1] = 0.0, self.gap
        from scipy.interpolate import CubicSpline

        return CubicSpline(np.log1p(4 * z / self.radius), np.log(self._axial(z)))

    def _axial(self, z: FloatArray) -> FloatArray:
        """From the rings, but the panels of the end, on which the tip lies, in closed form (zones of a sphere)."""
        height, radius, charge = self._charges
        here = (self.gap - z)[:, np.newaxis]
        image = (height.ravel() + here) / ((here + height.ravel()) ** 2 + radius.ravel() ** 2) ** 1.5 @ charge.ravel()
        up, across, q = (part[_CAP:].ravel() for part in (height, radius, charge))
        shaft = (up - here) / ((here - up) ** 2 + across**2) ** 1.5 @ q
        cosine = np.cos(np.linspace(0, np.pi / 2, _CAP + 1))
        density = charge[:_CAP].sum(axis=1) / -np.diff(cosine)  # 2 pi r^2 times the charge per area
        far = (self.radius + z)[:, np.newaxis]
        edge = np.sqrt((z[:, np.newaxis]) ** 2 + 2 * self.radius * far * (1 - cosine))
        slope = np.where(edge > 0, (far - self.radius * cosine) / np.where(edge > 0, edge, 1.0), 1.0)
        end = (np.diff(edge, axis=1) / far - np.diff(slope, axis=1)) / (self.radius * far) @ density
        value: FloatArray = image + shaft + end
        return value

    def axial(self, z: ArrayLike) -> FloatArray:
        """E_z on the axis in V/m, 0 <= z <= gap; a spline through 400 places, within 1e-6 of the rings."""
        at = real("z", z, least=0.0, most=self.gap * (1 + 1e-12), unit="m")
        value: FloatArray = np.exp(self._spline(np.log1p(4 * at / self.radius)))
        return value

    def vector(self, z: ArrayLike, r: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """E_z and E_r in V/m at z and distance r from the axis, m; outside the needle."""
        height, radius, charge = self._rings
        shape = np.broadcast_shapes(np.shape(z), np.shape(r))
        here = np.broadcast_to(self.gap - np.asarray(z, dtype=float), shape).reshape(-1, 1)
        across = np.broadcast_to(np.asarray(r, dtype=float), shape).reshape(-1, 1)
        up, out = _ring_field(here - height, across, radius)
        mirrored, away = _ring_field(here + height, across, radius)
        return (-(up - mirrored) @ charge).reshape(shape), ((out - away) @ charge).reshape(shape)

    def potential(self, z: ArrayLike, r: ArrayLike) -> FloatArray:
        """Potential over the plate's in V."""
        height, radius, charge = self._rings
        shape = np.broadcast_shapes(np.shape(z), np.shape(r))
        here = np.broadcast_to(self.gap - np.asarray(z, dtype=float), shape).reshape(-1, 1)
        across = np.broadcast_to(np.asarray(r, dtype=float), shape).reshape(-1, 1)
        value: FloatArray = _ring_potential(here - height, across, radius) - _ring_potential(
            here + height, across, radius
        )
        return (value @ charge).reshape(shape)


class TableField:
    """Field along the axis from samples (a field solver's): monotone cubics in ln E, nothing extrapolated.

    Parameters
    ----------
    z : array_like
        Distance from the tip, m, strictly increasing, from 0 to the gap; at least 2.
    field : array_like
        E_z in V/m, > 0.
    """

    def __init__(self, z: ArrayLike, field: ArrayLike) -> None:
        at, e = real("z", z, least=0.0, unit="m"), real("field", field, above=0.0, unit="V/m")
        if at.ndim != 1 or at.size < 2 or at.shape != e.shape:
            raise InputError("field", "needs one value for each of at least two places")
        if not (np.diff(at) > 0).all():
            raise InputError("z", "must strictly increase from the tip on")
        if at[0] > 0:
            raise InputError("z", "must start at the tip", value=float(at[0]), allowed="0 m")
        self.gap = float(at[-1])
        from scipy.interpolate import PchipInterpolator

        self._curve = PchipInterpolator(at, np.log(e))

    @classmethod
    def from_csv(cls, path: str | Path) -> Self:
        """Read columns ``z [unit]`` and ``field [unit]`` from a CSV file."""
        from spinline.jetprofile.columns import read_columns

        columns = read_columns(path, {"z": "length", "field": "electric field"}, required=("z", "field"))
        return cls(columns["z"], columns["field"])

    def axial(self, z: ArrayLike) -> FloatArray:
        """E_z on the axis in V/m."""
        at = real("z", z, least=0.0, most=self.gap * (1 + 1e-12), unit="m", remedy="the table ends there")
        value: FloatArray = np.exp(self._curve(np.minimum(at, self.gap)))
        return value

    @property
    def voltage(self) -> float:
        """Potential difference between the ends of the table, V."""
        z = self._curve.x
        nodes, weights = gauss(8)
        half = 0.5 * np.diff(z)[:, np.newaxis]
        at = z[:-1, np.newaxis] + half * (1 + nodes)
        return float(np.sum(half * weights * np.exp(self._curve(at))))


def _ring_potential(up: FloatArray, across: FloatArray, radius: FloatArray) -> FloatArray:
    """Potential of a unit ring (over q / 4 pi eps_0) at height `up` over its plane."""
    far, near = (across + radius) ** 2 + up**2, (across - radius) ** 2 + up**2
    value: FloatArray = 2 / np.pi * ellipkm1(near / far) / np.sqrt(far)
    return value


def _ring_field(up: FloatArray, across: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Field of a unit ring along its axis and away from it."""
    far, near = (across + radius) ** 2 + up**2, (across - radius) ** 2 + up**2
    k, e = ellipkm1(near / far), ellipe(1 - near / far)
    axial = 2 / np.pi * up * e / (near * np.sqrt(far))
    safe = np.where(across > 0, across, 1.0)
    radial = (k - e * (radius**2 - across**2 + up**2) / near) / (np.pi * safe * np.sqrt(far))
    return axial, np.where(across > 0, radial, 0.0)


def _solve_rings(voltage: float, gap: float, radius: float, length: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Charges on panels of the needle's surface, as Gauss points, for a constant potential at the panels' middles."""
    cap = np.linspace(0, np.pi / 2, _CAP + 1) * radius  # along the meridian
    shaft = length - 2 * radius
    steps = 40
    growth = radius / 26 * np.expm1(np.linspace(0, np.log1p(26 * 0.5 * shaft / radius), steps + 1))
    edges = np.concatenate(
        (
            cap,
            cap[-1] + growth[1:],
            cap[-1] + shaft - growth[-2::-1][:-1],
            cap[-1] + shaft + cap,
        )
    )
    edges = np.unique(edges)
    total = edges[-1]

    def place(at: FloatArray) -> tuple[FloatArray, FloatArray]:
        low, high = at < cap[-1], at > total - cap[-1]
        first, last = np.minimum(at, cap[-1]) / radius, np.minimum(total - at, cap[-1]) / radius
        z = np.where(low, radius * (1 - np.cos(first)), np.where(high, length - radius * (1 - np.cos(last)), 0.0))
        z = np.where(low | high, z, radius + at - cap[-1])
        rho = np.where(low, radius * np.sin(first), np.where(high, radius * np.sin(last), radius))
        return gap + z, rho

    half = 0.5 * np.diff(edges)
    centre = edges[:-1] + half
    high, rho = place(centre)
    nodes, weights = gauss(12)
    # t -> t^3 on either half of a panel: the logarithm of a ring at its own middle is integrated to 1e-10
    fine = np.concatenate((-(((1 + nodes[::-1]) / 2) ** 3), ((1 + nodes) / 2) ** 3))
    fine_weights = np.concatenate(
        (weights[::-1] * 1.5 * ((1 + nodes[::-1]) / 2) ** 2, weights * 1.5 * ((1 + nodes) / 2) ** 2)
    )
    at = centre[:, np.newaxis] + half[:, np.newaxis] * fine
    points, radii = place(at)
    share = half[:, np.newaxis] * fine_weights * 2 * np.pi * radii  # area
    kernel = _ring_potential(high[:, None, None] - points, rho[:, None, None], radii)
    kernel -= _ring_potential(high[:, None, None] + points, rho[:, None, None], radii)
    density = np.linalg.solve(np.sum(kernel * share, axis=2), np.full(centre.size, voltage))
    return points, radii, share * density[:, np.newaxis]
