"""The three laws that an electrified jet tends to, in closed form, each a jet of its own.

==============  ================================================================  ============================================
`InertialJet`   ``rho v^2 / 2 = rho v_0^2 / 2 + rho g z + (I/Q) int E_ext dz``    far away; beta = 1/4 in a uniform field
`ViscousJet`    ``V = (1 + k s)^2``, ``k = (i A B / 6)^(1/2)``                    viscosity holds it back: **beta = 1**
`ElasticJet`    ``V = V1 + s / De``, ``V1 = F0 / (pi r_0^2 G)``                   ``theta edot > 1/2``, solutions: beta = 1/2
==============  ================================================================  ============================================

The elastic law holds where the polymer carries the load: the strain rate is then about 1 / theta whatever voltage,
conductivity and radius are, and what a fit from a distance on calls beta rises slowly towards 1/2. With a tension that
changes along the jet, `elastic_velocity_ratio`: ``V(z) = (F / F0) [V1 + int F0 dz / (theta v_0 F)]``.

`viscous_prefactor` is the k of Reznik and Zussman with the prefactor c_k that they leave open. It is not a constant. With
``V = (k s)^2``, the charge ``F = Psi / ln chi`` and ``Psi = E_ext z_t`` where the current passes from the bulk to the surface
(``q = 1/2``), the equations give ``z_t = r_0 (3 ln chi / A)^(1/3)``, ``i = 6^(1/2) (3 ln chi)^(-1/3) A^(-1/6) B^(-1/2)`` and::

    k = c_k A^(5/12) B^(1/4),   c_k = C 6^(-1/4) (3 ln chi)^(-1/6)

C is 1.15 to 1.56 by the full equations over A = 1e-4 ... 1, B = 1e3 ... 1e5 and either logarithm (it grows with the
logarithm of ``k z_t / r_0``, the distance to which the start is felt), and nearly free of chi: 2 % between 50 and 3000, where
c_k falls by a tenth. So c_k is 0.435 to 0.574 at chi = 1e4, and up to 0.66 at chi = 40.
"""

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.constants import EPS0
from spinline.base.errors import InputError
from spinline.base.quadrature import gauss
from spinline.jetprofile import hyperbolic
from spinline.jetprofile.ehd.fields import AppliedField
from spinline.jetprofile.straight import StraightJet

__all__ = [
    "VISCOUS_PREFACTOR",
    "ElasticJet",
    "InertialJet",
    "ViscousJet",
    "elastic_velocity_ratio",
    "initial_jump",
    "viscous_prefactor",
]

VISCOUS_PREFACTOR = (0.435, 0.66)  # c_k over A = 1e-4 ... 1, B = 1e3 ... 1e5, chi = 40 ... 1e4, uniform field
VISCOUS_CONSTANT = (1.15, 1.56)  # C over the same


def initial_jump(tension: ArrayLike, radius: ArrayLike, modulus: ArrayLike) -> FloatArray:
    """``V1 = F0 / (pi r_0^2 G)``: the jump of V within the first tenth of a millimetre, the cone."""
    value: FloatArray = np.asarray(tension) / (np.pi * np.asarray(radius) ** 2 * np.asarray(modulus))
    return value


def elastic_velocity_ratio(
    z: FloatArray,
    tension: FloatArray,
    *,
    radius: float,
    modulus: float,
    relaxation_time: float,
    initial_velocity: float,
) -> FloatArray:
    """V along a jet whose tension F(z) (N) is known: inertia, solvent and radial stress left out.

    Within 0.1 to 7.5 % of the full equations for a polymer solution; z from 0, increasing.
    """
    force = real("tension", tension, above=0.0, unit="N")
    jump = float(initial_jump(force[0], radius, modulus))
    inverse = force[0] / force / (relaxation_time * initial_velocity)
    total = np.concatenate(([0.0], np.cumsum(0.5 * (inverse[1:] + inverse[:-1]) * np.diff(z))))
    value: FloatArray = force / force[0] * (jump + total)
    return value


def viscous_prefactor(
    *,
    radius: ArrayLike,
    initial_velocity: ArrayLike,
    conductivity: ArrayLike,
    viscosity: ArrayLike,
    electric_field: ArrayLike,
    slenderness: ArrayLike | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Lower and upper k of the viscous law in a uniform field: ``c_k A^(5/12) B^(1/4)``, it belongs to beta = 1.

    With `slenderness` (chi = L / r_0, > e) c_k is that of this chi; without, any between 40 and 1e4.
    """
    velocity = np.asarray(initial_velocity)
    pull = EPS0 * np.asarray(electric_field) ** 2 * np.asarray(radius) / (np.asarray(viscosity) * velocity)
    conduction = np.asarray(conductivity) * np.asarray(radius) / (EPS0 * velocity)
    k = pull ** (5 / 12) * conduction**0.25
    if slenderness is None:
        return VISCOUS_PREFACTOR[0] * k, VISCOUS_PREFACTOR[1] * k
    chi = real("slenderness", slenderness, above=float(np.e), remedy="length over radius: the jet must be slender")
    scaled = k * 6**-0.25 * (3 * np.log(chi)) ** (-1 / 6)
    return VISCOUS_CONSTANT[0] * scaled, VISCOUS_CONSTANT[1] * scaled


class InertialJet(StraightJet):
    """Jet whose speed is what the field and gravity have worked on it.

    Parameters
    ----------
    radius, flow_rate : float
        r_0 (m), Q (m3/s).
    current : float
        I in A, > 0: all of it carried by the surface.
    density : float
        rho in kg/m3.
    field : AppliedField
        Field of the electrodes; the jet ends at its gap.
    gravity : float
        m/s2 along the jet.
    """

    def __init__(
        self,
        *,
        radius: float,
        flow_rate: float,
        current: float,
        density: float,
        field: AppliedField,
        gravity: float = 9.81,
    ) -> None:
        super().__init__(radius, flow_rate)
        self.current, self.density = positive("current", current, "A"), positive("density", density, "kg/m3")
        self.gravity, self.field = number("gravity", gravity, least=0.0, unit="m/s2"), field
        self.end = field.gap

    def _parameters(self) -> dict[str, object]:
        return {
            "radius": self.initial_radius,
            "flow_rate": self.flow_rate,
            "current": self.current,
            "density": self.density,
            "field": self.field,
            "gravity": self.gravity,
        }

    @cached_property
    def _work(self) -> CubicHermiteSpline:
        """Work over rho v_0^2 / 2 along s."""
        reach, first = self.end / self.initial_radius, float(self._pull(np.zeros(1))[0])
        s = np.expm1(np.linspace(0, np.log1p(first * reach), 801)) / first
        s[-1] = reach
        nodes, weights = gauss(8)
        half = 0.5 * np.diff(s)[:, np.newaxis]
        at = s[:-1, np.newaxis] + half * (1 + nodes)
        panels = np.sum(half * weights * self._pull(at), axis=1)
        return CubicHermiteSpline(s, np.concatenate(([0.0], np.cumsum(panels))), self._pull(s))

    def _pull(self, s: FloatArray) -> FloatArray:
        z = np.minimum(s * self.initial_radius, self.end)
        force = self.density * self.gravity + self.current / self.flow_rate * self.field.axial(z)
        value: FloatArray = 2 * force * self.initial_radius / (self.density * self.initial_velocity**2)
        return value

    def _ratio(self, s: FloatArray) -> FloatArray:
        value: FloatArray = np.sqrt(1 + self._work(s))
        return value

    def _slope(self, s: FloatArray) -> FloatArray:
        return 0.5 * self._pull(s) / self._ratio(s)

    @cached_property
    def _times(self) -> FloatArray:
        x = self._work.x
        return np.concatenate(([0.0], np.cumsum(self._passage(x[:-1], x[1:]))))

    def _passage(self, low: FloatArray, high: FloatArray) -> FloatArray:
        nodes, weights = gauss(8)
        half = 0.5 * (high - low)[..., np.newaxis]
        value: FloatArray = np.sum(half * weights / self._ratio(low[..., np.newaxis] + half * (1 + nodes)), axis=-1)
        return value

    def _time(self, s: FloatArray) -> FloatArray:
        x, at = self._work.x, np.asarray(s)
        i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, x.size - 2)
        value: FloatArray = self._times[i] + self._passage(x[i], at)
        return value

    def _inverse(self, ratio: FloatArray) -> FloatArray:
        target = np.asarray(ratio) ** 2 - 1
        s = self._work.x
        total = self._work(s)
        reached = (target >= 0) & (target <= total[-1])
        wanted = np.where(reached, target, 0.0)
        i = np.clip(np.searchsorted(total, wanted, side="left") - 1, 0, s.size - 2)
        low, high = s[i], s[i + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = self._work(middle) < wanted
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.where(reached, np.where(wanted == 0, 0.0, high), np.nan)


class ViscousJet(StraightJet):
    """Viscous jet under a constant pull per volume: ``V = (1 + k s)^2``, an exact solution; ``T(0) = 6 k``.

    Parameters
    ----------
    radius, flow_rate : float
        r_0 (m), Q (m3/s).
    current, electric_field, viscosity : float
        I (A), E (V/m), mu (Pa s): ``k^2 = I E r_0^2 / (6 mu Q v_0)``.

    Examples
    --------
    >>> jet = ViscousJet(radius=125e-6, flow_rate=8.9e-10, current=2e-7, electric_field=6e4, viscosity=2.0)
    >>> bool(abs(jet.velocity_ratio(0.01) / (1 + jet.k * 80) ** 2 - 1) < 1e-12)
    True
    """

    def __init__(
        self, *, radius: float, flow_rate: float, current: float, electric_field: float, viscosity: float
    ) -> None:
        super().__init__(radius, flow_rate)
        self.current = positive("current", current, "A")
        self.electric_field = positive("electric_field", electric_field, "V/m")
        self.viscosity = positive("viscosity", viscosity, "Pa s")
        force = self.current * self.electric_field / self.flow_rate
        self.k = float(np.sqrt(force * self.initial_radius**2 / (6 * self.viscosity * self.initial_velocity)))

    def _parameters(self) -> dict[str, object]:
        return {
            "radius": self.initial_radius,
            "flow_rate": self.flow_rate,
            "current": self.current,
            "electric_field": self.electric_field,
            "viscosity": self.viscosity,
        }

    def _ratio(self, s: FloatArray) -> FloatArray:
        return hyperbolic.ratio(s, 1 / self.k)

    def _slope(self, s: FloatArray) -> FloatArray:
        return hyperbolic.slope(s, 1 / self.k)

    def _time(self, s: FloatArray) -> FloatArray:
        return hyperbolic.time(s, 1 / self.k)

    def _inverse(self, ratio: FloatArray) -> FloatArray:
        return hyperbolic.inverse(ratio, 1 / self.k)


class ElasticJet(StraightJet):
    """Jet of a polymer solution whose elasticity rules: ``V = V1 + s / De``.

    Parameters
    ----------
    radius, flow_rate : float
        r_0 (m), Q (m3/s).
    relaxation_time : float
        theta in s, > 0.
    jump : float
        V1 = F0 / (pi r_0^2 G), >= 1 (`initial_jump`): below, the thread is not pulled out.

    Notes
    -----
    V starts from V1, the cone left out. Cost: a few us.

    Examples
    --------
    >>> jet = ElasticJet(radius=125e-6, flow_rate=8.9e-10, relaxation_time=7e-3, jump=2.0)
    >>> round(float(jet.strain_rate(0.01)) * 7e-3, 12)
    1.0
    """

    def __init__(self, *, radius: float, flow_rate: float, relaxation_time: float, jump: float) -> None:
        super().__init__(radius, flow_rate)
        self.relaxation_time = positive("relaxation_time", relaxation_time, "s")
        self.jump = number("jump", jump)
        if self.jump < 1:
            raise InputError(
                "jump",
                "is below 1: the pull does not draw a thread from the needle",
                value=self.jump,
                allowed="[1, inf)",
                remedy="a higher voltage; or the boundary-value problem",
            )
        self._deborah = self.relaxation_time * self.initial_velocity / self.initial_radius

    def _parameters(self) -> dict[str, object]:
        return {
            "radius": self.initial_radius,
            "flow_rate": self.flow_rate,
            "relaxation_time": self.relaxation_time,
            "jump": self.jump,
        }

    def _ratio(self, s: FloatArray) -> FloatArray:
        value: FloatArray = self.jump + s / self._deborah
        return value

    def _slope(self, s: FloatArray) -> FloatArray:
        return np.full(np.shape(s), 1 / self._deborah)

    def _time(self, s: FloatArray) -> FloatArray:
        value: FloatArray = self._deborah * np.log1p(s / (self._deborah * self.jump))
        return value

    def _inverse(self, ratio: FloatArray) -> FloatArray:
        return np.where(ratio >= self.jump, self._deborah * (ratio - self.jump), np.nan)
