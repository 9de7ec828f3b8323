"""What a solution is likely to be like when nobody has measured it: viscosity and relaxation time, with bands.

::

    eta_sp = X exp(K X)                      X = c [eta], Martin, up to where its slope is the entangled power p
    eta_sp = eta_sp(X_t) (X/X_t)^p           X_t = (p - 1)/K, p = 3.93 good, 4.67 theta
    theta  = theta_Z (phi/phi*)^x            theta_Z = [eta] M mu_s/(zeta(3 nu) R T), phi* = 0.77/(rho_p [eta])
             (phi/phi_e)^y                   x, y = 0.31, 1.62 good; 1, 2.33 theta; phi_e from `entanglement`

K = 0.4 in a good solvent, 0.5 in a theta solvent: Huggins' constant. These are estimates: the band of the viscosity is
the spread found against the published viscosities of 26 aqueous solutions of PEO, PVP and PVA
(`benchmarks/published_viscosity.py`), a factor of 6 either way at two standard deviations, mostly too high; that of
the relaxation time is a factor of 10, what extensional and shear measurements of one solution differ by.
Polydispersity, association (PVA) and charge are not in them. A measurement always goes first.

References
----------
Martin's equation as in Rao, Rheology of Fluid and Semisolid Foods; Rubinstein, Colby, Polymer Physics (2003), chapters
8 and 9; Graessley, Polymer 21, 258 (1980) (phi*); Rodd, Scott, Cooper-White, McKinley, Appl. Rheol. 15, 12 (2005)
(Zimm's time in [eta]).
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, computable, number, positive, real
from spinline.base.errors import InputError
from spinline.rheology.concentration_laws import scaling_exponents
from spinline.rheology.entanglement import Quality
from spinline.rheology.intrinsic import Intrinsic, mixture_intrinsic_viscosity

if TYPE_CHECKING:
    from spinline.rheology.solution import Solution

__all__ = [
    "RELAXATION_FACTOR",
    "VISCOSITY_FACTOR",
    "Estimate",
    "estimated_relaxation_time",
    "estimated_viscosity",
    "specific_viscosity",
]

MARTIN = {"good": 0.4, "theta": 0.5}
VISCOSITY_FACTOR, RELAXATION_FACTOR = 6.0, 10.0  # two standard deviations of the logarithm
_OVERLAP = 0.77  # c* [eta]
_GAS = 8.31446261815324


@dataclass(frozen=True)
class Estimate:
    """An estimate: `value` in SI, within a factor of `factor` (two standard deviations of its logarithm), and how it
    was made.
    """

    value: float
    factor: float
    words: str

    @property
    def band(self) -> tuple[float, float]:
        """Low and high end."""
        return self.value / self.factor, self.value * self.factor


@computable
def specific_viscosity(
    coil_overlap: ArrayLike, solvent_quality: Quality = "good", martin_constant: float | None = None
) -> FloatArray:
    """``(mu - mu_s)/mu_s`` against ``X = c [eta]``: Martin's equation, and the entangled power law where it would be
    steeper.

    Parameters
    ----------
    coil_overlap : array_like
        X >= 0, up to 1e6.
    solvent_quality : {"good", "theta"}
    martin_constant : float, optional
        K in (0, 2].

    Returns
    -------
    ndarray. Continuous with its slope; ``X + K X^2`` for small X.
    """
    if solvent_quality not in MARTIN:
        raise InputError("solvent_quality", "is not known", value=solvent_quality, allowed='"good", "theta"')
    x = real("coil_overlap", coil_overlap, least=0.0, most=1e6)
    k = MARTIN[solvent_quality]
    if martin_constant is not None:
        k = number("martin_constant", martin_constant, above=0.0, most=2.0)
    power = scaling_exponents(solvent_quality).viscosity
    turn = (power - 1) / k
    low = np.minimum(x, turn)
    value: FloatArray = low * np.exp(k * low) * (np.maximum(x, turn) / turn) ** power
    return value


def estimated_viscosity(solution: "Solution", solvent_quality: Quality = "good") -> Estimate:
    """Zero-shear viscosity of a solution of known chains, Pa s.

    Raises
    ------
    InputError
        Where the molar mass, the chain or the solvent's viscosity is not known.

    Examples
    --------
    >>> from spinline.rheology import Solution
    >>> solution = Solution.build("PEO", "water", mass_fraction=0.05, molar_mass=600.0)
    >>> round(estimated_viscosity(solution).value, 1)
    7.3
    """
    found = _intrinsic(solution, solvent_quality)
    x = solution.concentration * found.value
    mu_s = solution.require("solvent_viscosity")
    value = mu_s * (1 + float(specific_viscosity(min(x, 1e6), solvent_quality)))
    factor = VISCOSITY_FACTOR * (found.factor / 1.3) ** 2  # a doubtful [eta] counts more than once
    words = f"estimate: c [eta] = {x:.3g} ({found.source}), Martin and entangled scaling, to a factor of {factor:.3g}"
    return Estimate(positive("viscosity", value, "Pa s"), factor, words)


def estimated_relaxation_time(solution: "Solution", solvent_quality: Quality = "good") -> Estimate:
    """Longest relaxation time of a solution of known chains, s; errors are those of `estimated_viscosity`.

    Zimm's in the dilute solution, Rouse's scaling from overlap, reptation's from the entanglement fraction on.
    """
    from scipy.special import zeta

    found = _intrinsic(solution, solvent_quality)
    chain, mu_s = solution.require("molar_mass"), solution.require("solvent_viscosity")
    flory = 0.588 if solvent_quality == "good" else 0.5
    zimm = found.value * chain * mu_s / (float(zeta(3 * flory)) * _GAS * solution.temperature)
    phi = solution.volume_fraction
    overlap = _OVERLAP / (found.value * solution.polymer.density)
    below, above = (scaling_exponents(solvent_quality, entangled=e).relaxation for e in (False, True))
    try:
        onset = solution.entanglement(solvent_quality).entanglement_fraction
    except InputError:
        onset = 10 * overlap  # M_e is not known: ten overlaps are usual
    onset = max(onset, overlap)
    grown = max(min(phi, onset) / overlap, 1.0) ** below * max(phi / onset, 1.0) ** above
    words = (
        f"estimate: Zimm {zimm:.3g} s, phi/phi* = {phi / overlap:.3g}, phi/phi_e = {phi / onset:.3g}, within a factor of "
        f"{RELAXATION_FACTOR:g}"
    )
    return Estimate(positive("relaxation_time", zimm * grown, "s"), RELAXATION_FACTOR, words)


def _intrinsic(solution: "Solution", solvent_quality: Quality) -> Intrinsic:
    chain = solution.require("molar_mass")
    return mixture_intrinsic_viscosity(
        solution.polymer, solution.solvent, chain, solvent_quality, temperature=solution.temperature
    )
