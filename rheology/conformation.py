"""Stretch of the polymer along a material element: upper-convected Maxwell, Oldroyd-B, Giesekus, FENE-P.

::

    dA_zz/dt = 2 edot A_zz - g_zz/theta        dA_rr/dt = -edot A_rr - g_rr/theta
    Maxwell, Oldroyd-B   g = A - 1                           stress G (A - I), Oldroyd-B with 2 mu_s edot
    Giesekus             g = (A - 1) + alpha (A - 1)^2       stress G (A - I)
    FENE-P               g = f A - 1                         stress G (f A - I),  f = (L^2 - 3)/(L^2 - tr A)

A is 1 at rest. theta and G may vary along the jet: these are the equations of the *conformation*, then ``stress = G x strain``;
the same models written for the stress differ by (dG/dt)/G times the stress, and are not what is solved here. theta -> inf
gives the affine stretch, ``A_zz = Lambda^2``; theta -> 0 gives rest. ``stretch = sqrt(A_zz)``.

What to use when: Maxwell below a stretch of about a third of the contour, or for closed forms; FENE-P beyond (``L^2 = N_s``, so
that the largest stretch is 1/phi); Giesekus where entangled solutions soften.

Cost and error: linear models, exact for the interpolated history (`_element_history`), 3 us a sample, fourth order in the
spacing where strain rates are given and theta is constant, else second (half that where theta is far below the spacing: the
rate at the sample then decides, but its error counts times theta). The others by Radau's method in compiled loops
(`_conformation_kernels`), relative error 1e-9, a few us a sample; FENE-P in ln(f A), which makes every value possible,
Giesekus in ln A.

References
----------
Bird, Armstrong, Hassager, Dynamics of Polymeric Liquids, vol. 1 and 2 (1987); Giesekus, J. Non-Newtonian Fluid Mech. 11, 69
(1982); Peterlin, J. Polym. Sci. B 4, 287 (1966).
"""

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, real
from spinline.base.errors import InputError
from spinline.rheology._element_history import ElementHistory, propagate
from spinline.rheology._finite import finite_result

__all__ = [
    "FENEP",
    "ElementConformation",
    "Giesekus",
    "Maxwell",
    "Model",
    "OldroydB",
    "conformation",
    "maxwell_startup",
    "steady_fenep",
    "tensile_force",
]

_RTOL = 1e-10  # of the logarithms
Followed = tuple[FloatArray, FloatArray, FloatArray]  # A_zz, A_rr, f


@dataclass(frozen=True)
class Maxwell:
    """Upper-convected Maxwell."""

    solvent_viscosity: ClassVar[float] = 0.0

    def follow(self, history: ElementHistory, first: FloatArray, rtol: float) -> Followed:
        """Exact for the interpolated history."""
        return _linear(history, first)

    def stiffening(self, v: FloatArray) -> tuple[FloatArray, float]:
        """As Maxwell."""
        return np.ones_like(v), float("inf")


@dataclass(frozen=True)
class OldroydB:
    """Maxwell in a Newtonian solvent; `solvent_viscosity` in Pa s, >= 0."""

    solvent_viscosity: float

    def __post_init__(self) -> None:
        number("solvent_viscosity", self.solvent_viscosity, least=0.0, unit="Pa s")

    def follow(self, history: ElementHistory, first: FloatArray, rtol: float) -> Followed:
        """Strands as Maxwell's."""
        return _linear(history, first)

    def stiffening(self, v: FloatArray) -> tuple[FloatArray, float]:
        """As Maxwell."""
        return np.ones_like(v), float("inf")


@dataclass(frozen=True)
class Giesekus:
    """Anisotropic drag; `mobility` alpha in [0, 1], 1/2 at most for a monotone flow curve."""

    solvent_viscosity: ClassVar[float] = 0.0
    mobility: float

    def __post_init__(self) -> None:
        number("mobility", self.mobility, least=0.0, most=1.0)

    def follow(self, history: ElementHistory, first: FloatArray, rtol: float) -> Followed:
        """Radau's method in ln A."""
        _within_doubles(history, first)
        axial, radial = np.exp(_followed(history, 0, self.mobility, np.log(first), rtol))
        return axial, radial, np.ones(history.time.size)

    def stiffening(self, v: FloatArray) -> tuple[FloatArray, float]:
        """Faster by ``1 + alpha (v^2 - 1)``."""
        return 1 + self.mobility * np.maximum(v**2 - 1, 0.0), float("inf")


@dataclass(frozen=True)
class FENEP:
    """Finitely extensible; `extensibility` L^2 > 3, N_s segments of a strand."""

    solvent_viscosity: ClassVar[float] = 0.0
    extensibility: float

    def __post_init__(self) -> None:
        number("extensibility", self.extensibility, above=3.0, most=1e12, remedy="L^2 = N_s, segments of a strand")

    def follow(self, history: ElementHistory, first: FloatArray, rtol: float) -> Followed:
        """Radau's method in ln(f A), which makes every value possible."""
        _within_doubles(history, first)
        limit, spread = self.extensibility, float(first[0] + 2 * first[1])
        if spread >= limit:
            raise InputError("start", "is beyond the contour", value=spread, allowed=f"A_zz + 2 A_rr < {limit:g}")
        scaled = first * (limit - 3) / (limit - spread)
        tensor = np.exp(_followed(history, 1, limit, np.log(scaled), rtol))
        stiffening = (tensor[0] + 2 * tensor[1] + limit - 3) / limit
        axial, radial = tensor / stiffening
        return axial, radial, stiffening

    def stiffening(self, v: FloatArray) -> tuple[FloatArray, float]:
        """Faster by f, up to L."""
        room = np.maximum(1 - v**2 / self.extensibility, 1e-6)
        return (1 - 3 / self.extensibility) / room, float(np.sqrt(self.extensibility))


class Model(Protocol):
    """A constitutive law with its parameters; `Maxwell`, `OldroydB`, `Giesekus`, `FENEP`, or any object that does as much."""

    @property
    def solvent_viscosity(self) -> float:
        """Of a Newtonian stress beside that of the strands, Pa s; 0 for none."""

    def follow(self, history: ElementHistory, first: FloatArray, rtol: float, /) -> Followed:
        """A_zz, A_rr and the stiffening f at every sample, from `first` on."""

    def stiffening(self, v: FloatArray, /) -> tuple[FloatArray, float]:
        """How much faster than Maxwell's it gives back an affine stretch, and its largest stretch; for estimates."""


@dataclass(frozen=True, eq=False)
class ElementConformation:
    """Conformation of the polymer at every sample (n,).

    Attributes
    ----------
    time : ndarray
        s.
    axial, radial : ndarray
        A_zz, A_rr.
    stiffening : ndarray
        f of FENE-P, 1 otherwise.
    weissenberg : ndarray
        ``edot theta``; the mean of both sides at a sample.
    strain_rate : ndarray
        edot that goes with it, 1/s.
    model : Model
    """

    time: FloatArray
    axial: FloatArray
    radial: FloatArray
    stiffening: FloatArray
    weissenberg: FloatArray
    strain_rate: FloatArray
    model: Model

    @property
    def stretch(self) -> FloatArray:
        """``sqrt(A_zz)``, over the size at rest."""
        return np.sqrt(self.axial)

    @property
    def contraction(self) -> FloatArray:
        """``sqrt(A_rr)``, over the size at rest."""
        return np.sqrt(self.radial)

    def stress(self, modulus: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Axial and radial extra stress in Pa, for a modulus G in Pa (one, or one per sample)."""
        g = real("modulus", modulus, above=0.0, unit="Pa")
        if g.ndim and g.shape != self.time.shape:
            raise InputError("modulus", "must be one, or one per sample", value=f"{g.shape} against {self.time.shape}")
        solvent = self.model.solvent_viscosity * self.strain_rate
        return g * (self.stiffening * self.axial - 1) + 2 * solvent, g * (self.stiffening * self.radial - 1) - solvent


def conformation(
    time: ArrayLike,
    stretch_ratio: ArrayLike,
    relaxation_time: ArrayLike,
    model: Model | None = None,
    *,
    strain_rate: ArrayLike | None = None,
    start: tuple[float, float] = (1.0, 1.0),
    rtol: float = _RTOL,
) -> ElementConformation:
    """Conformation along a material element.

    Parameters
    ----------
    time : array_like, (n,)
        s, strictly increasing; the element's own (residence) time.
    stretch_ratio : array_like, (n,)
        Lambda, material stretch since any reference, > 0.
    relaxation_time : array_like, scalar or (n,)
        theta, s, > 0; its logarithm is taken as linear between samples.
    model : Model, optional
        Default `Maxwell()`.
    strain_rate : array_like, (n,), optional
        edot, 1/s, at the samples: raises the order from 2 to 4.
    start : (float, float)
        A_zz and A_rr at the first sample, > 0 (Giesekus and FENE-P: 1e-100 to 1e100).
    rtol : float, optional
        Of each step of the nonlinear models, in [1e-12, 1e-3]; the error of A is about ten times that.

    Returns
    -------
    ElementConformation

    Raises
    ------
    InputError
        For values out of range, shapes that do not fit, or a start beyond the contour.

    Examples
    --------
    >>> state = conformation([0.0, 3.0], np.exp([0.0, 0.75 * 3]), 1.0)
    >>> round(float(state.axial[-1]), 9), round(float(state.radial[-1]), 12)
    (11.445067211, 0.573677507885)
    """
    history = ElementHistory.build(time, stretch_ratio, relaxation_time, strain_rate)
    chosen = Maxwell() if model is None else model
    first = real("start", start, above=0.0)
    if first.shape != (2,):
        raise InputError("start", "must be A_zz and A_rr", value=start)
    accuracy = float(real("rtol", rtol, least=1e-12, most=1e-3))
    if not callable(getattr(chosen, "follow", None)):
        raise InputError("model", "is not one of Maxwell, OldroydB, Giesekus, FENEP", value=chosen)
    axial, radial, stiffening = chosen.follow(history, first, accuracy)
    rate = 0.5 * (
        np.append(history.first_rate, history.last_rate[-1]) + np.insert(history.last_rate, 0, history.first_rate[0])
    )
    return ElementConformation(history.time, axial, radial, stiffening, rate * history.relaxation_time, rate, chosen)


@finite_result("tensile force", "N")
def tensile_force(axial_stress: ArrayLike, radial_stress: ArrayLike, radius: ArrayLike) -> FloatArray:
    """Tensile force of the network in the jet's cross-section, ``pi r^2 (tau_zz - tau_rr)`` in N (Pa, Pa, m)."""
    along, across = real("axial_stress", axial_stress, unit="Pa"), real("radial_stress", radial_stress, unit="Pa")
    r = real("radius", radius, above=0.0, unit="m")
    value: FloatArray = np.pi * r * (r * along - r * across)
    return value


def maxwell_startup(weissenberg: ArrayLike, reduced_time: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Closed form: A_zz and A_rr of a Maxwell element at constant ``De = edot theta``, a time ``t/theta`` after rest.

    Parameters
    ----------
    weissenberg, reduced_time : array_like
        De (any sign), t/theta >= 0; the strain (2 De - 1) t/theta at most 700.

    Returns
    -------
    axial, radial : ndarray
        ``exp(a) + (t/theta)(exp(a) - 1)/a`` with ``a = (2 De - 1) t/theta``, and with -De for 2 De.
    """
    de, t = real("weissenberg", weissenberg), real("reduced_time", reduced_time, least=0.0)

    def one(power: float) -> FloatArray:
        with np.errstate(over="ignore"):
            a = real("strain", (power * de - 1) * t, most=700.0, remedy="shorten the time")
            near = a == 0
            safe = np.where(near, 1.0, a)
            value: FloatArray = np.exp(a) + t * np.where(near, 1.0, np.expm1(safe) / safe)
        return real("conformation", value, remedy="shorten the time")

    return one(2.0), one(-1.0)


def steady_fenep(weissenberg: float, extensibility: float) -> tuple[float, float]:
    """Steady A_zz and A_rr of FENE-P at constant De > 0, to 1e-13: one root of ``tr A(f) = L^2 - (L^2 - 3)/f``.

    Examples
    --------
    >>> [round(value, 9) for value in steady_fenep(1.0, 400.0)]
    [201.326195055, 0.33278235]
    """
    from scipy.optimize import brentq

    de = number("weissenberg", weissenberg, above=0.0, most=1e300)
    limit = FENEP(extensibility).extensibility

    def excess(gap: float) -> float:  # gap = f - 2 De
        f = gap + 2 * de  # and f - 1 without cancellation at De = 1/2
        return 1 / gap + 2 / (gap + 3 * de) - limit * ((gap + (2 * de - 1)) / f) - 3 / f

    low = 1 / limit
    high = max(2.0, 4 / limit + 1 / low)
    gap = float(brentq(excess, 0.5 * low, high, xtol=1e-300, rtol=1e-14))
    return 1 / gap, 1 / (gap + 3 * de)


def _linear(history: ElementHistory, first: FloatArray) -> Followed:
    """A linear model: A_zz with twice the strain, A_rr with minus once."""
    axial, radial = propagate(history, 2.0, float(first[0])), propagate(history, -1.0, float(first[1]))
    return axial, radial, np.ones(history.time.size)


def _within_doubles(history: ElementHistory, first: FloatArray) -> None:
    """What is integrated step by step must be within what a double can square."""
    real("start", first, least=1e-100, most=1e100)
    real("relaxation_time", history.relaxation_time, least=1e-100, most=1e100, unit="s")


def _followed(history: ElementHistory, kind: int, parameter: float, first: FloatArray, rtol: float) -> FloatArray:
    """Logarithms at the samples, (2, n)."""
    from spinline.rheology._conformation_kernels import follow

    h, rise = np.diff(history.time), np.diff(history.log_stretch)
    secant, start, end = rise / h, history.first_rate, history.last_rate
    bend = start + end - 2 * secant  # ln Lambda is a cubic: its rate is start + u (end - start - 3 bend) + 3 u^2 bend
    rates = np.stack((start, end - start - 3 * bend, 3 * bend), axis=1)
    reached, values = follow(
        kind, parameter, first, history.time, rates, -np.log(history.relaxation_time), rtol, 0.01 * rtol
    )
    if reached < history.time.size:
        raise InputError(
            "time",
            f"cannot be followed beyond sample {reached - 1}",
            value=float(history.time[reached - 1]),
            remedy="sample the history more finely",
        )
    value: FloatArray = values.T
    return value
