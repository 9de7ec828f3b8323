"""When a drying solution crystallises: Flory's melting-point depression, and Nakamura's kinetics where their constants
are known.

::

    1/T_m - 1/T_m0 = (R/dH_u) (V_u/V_1) [phi_1 - chi phi_1^2]         phi_1 = 1 - phi
    X = X_max [1 - exp(-(int K dt)^n)],   K = (ln 2)^(1/n)/t_half [1 + k (w^2 - 1)]   while T < T_m(phi)

The first says where crystals can exist, without the supercooling that nuclei need: the earliest place of arrest. The
second needs a half time of the quiescent melt or solution at the jet's temperature, which few know; k makes drawn
chains (stretch w) crystallise sooner. A degree of crystallinity is reported from it alone.

PEO in water at 25 degC: phi = 0.768 with T_m0 = 342 K, dH_u = 8.66 kJ/mol, chi = 0.45; other constants in print give
0.73 to 0.79.

References
----------
Flory, Principles of Polymer Chemistry (1953), Eq. XIII-14; Nakamura, Katayama, Amano, J. Appl. Polym. Sci. 17, 1031
(1973); Ziabicki, Fundamentals of Fibre Formation (1976).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError

__all__ = ["Crystals", "Nakamura"]

_GAS = 8.31446261815324


@dataclass(frozen=True)
class Crystals:
    """Equilibrium between crystals of a polymer and its solution.

    Attributes
    ----------
    melting_temperature : float
        T_m0, K.
    melting_enthalpy : float
        dH_u, J per mole of repeat units.
    unit_volume : float
        V_u of a repeat unit, m3/mol.
    """

    melting_temperature: float
    melting_enthalpy: float
    unit_volume: float

    def __post_init__(self) -> None:
        positive("melting_temperature", self.melting_temperature, "K")
        positive("melting_enthalpy", self.melting_enthalpy, "J/mol")
        positive("unit_volume", self.unit_volume, "m3/mol")

    def melting_point(self, volume_fraction: ArrayLike, solvent_volume: ArrayLike, chi: ArrayLike) -> FloatArray:
        """T_m in K of a solution.

        Parameters
        ----------
        volume_fraction : array_like
            phi of the polymer, in [0, 1].
        solvent_volume : array_like
            V_1, m3/mol; of a mixture the mean by mole.
        chi : array_like
            In [-5, 5].

        Raises
        ------
        InputError
            Where chi is so large that the solvent would raise the melting point beyond all bounds.
        """
        inverse = self.inverse_melting_point(volume_fraction, solvent_volume, chi)
        return 1 / real("1/T_m", inverse, above=0.0, unit="1/K", remedy="check chi and the heat of fusion")

    def inverse_melting_point(
        self, volume_fraction: ArrayLike, solvent_volume: ArrayLike, chi: ArrayLike
    ) -> FloatArray:
        """``1/T_m`` in 1/K: 0 or less where the solvent is so poor that crystals melt at no temperature."""
        phi = real("volume_fraction", volume_fraction, least=0.0, most=1.0)
        v, x = real("solvent_volume", solvent_volume, above=0.0, unit="m3/mol"), real("chi", chi, least=-5.0, most=5.0)
        solvent = 1 - phi
        slope = _GAS * self.unit_volume / (self.melting_enthalpy * v)
        value: FloatArray = 1 / self.melting_temperature + slope * solvent * (1 - x * solvent)
        return value

    def crystallisation_fraction(self, temperature: float, solvent_volume: float, chi: float) -> float:
        """Least polymer fraction whose crystals do not melt at a temperature: NaN where even the dry polymer's do.

        Examples
        --------
        >>> peo = Crystals(342.0, 8660.0, 0.04405256 / 1130.0)
        >>> round(peo.crystallisation_fraction(298.15, 18.07e-6, 0.45), 3)
        0.768
        """
        kelvin = positive("temperature", temperature, "K")
        v = positive("solvent_volume", solvent_volume, "m3/mol")
        x = number("chi", chi, least=-5.0, most=5.0)
        if kelvin >= self.melting_temperature:
            return float("nan")
        need = (1 / kelvin - 1 / self.melting_temperature) * self.melting_enthalpy * v / (_GAS * self.unit_volume)
        # x s^2 - s + need = 0, the root that grows from 0
        room = 1 - 4 * x * need
        if room < 0:
            return 0.0
        solvent = 2 * need / (1 + np.sqrt(room))
        return float(max(1 - solvent, 0.0))


@dataclass(frozen=True)
class Nakamura:
    """Kinetics of crystallisation.

    Attributes
    ----------
    half_time : float
        Of quiescent crystallisation at the jet's temperature, s.
    exponent : float
        Avrami's n, in [1, 4].
    flow_enhancement : float
        k >= 0.
    maximum : float
        X_max, in (0, 1].
    """

    half_time: float
    exponent: float = 3.0
    flow_enhancement: float = 0.0
    maximum: float = 1.0

    def __post_init__(self) -> None:
        positive("crystallisation_half_time", self.half_time, "s")
        number("avrami_exponent", self.exponent, least=1.0, most=4.0)
        number("flow_enhancement", self.flow_enhancement, least=0.0, most=1e6)
        number("maximum_crystallinity", self.maximum, above=0.0, most=1.0)

    def crystallinity(self, time: ArrayLike, undercooled: ArrayLike, stretch: ArrayLike = 1.0) -> FloatArray:
        """X along an element.

        Parameters
        ----------
        time : array_like, (n,)
            s, increasing.
        undercooled : array_like of bool, (n,)
            Where ``T < T_m(phi)``.
        stretch : array_like, (n,)
            w of the strands, > 0.

        Returns
        -------
        ndarray, (n,), in [0, X_max]; the trapezium rule on K.
        """
        t = real("time", time, unit="s")
        if t.ndim != 1 or t.size < 2 or (np.diff(t) < 0).any():
            raise InputError("time", "must be two samples or more that increase", value=f"shape {t.shape}")
        w = np.broadcast_to(real("stretch", stretch, above=0.0, most=1e100), t.shape)
        below = np.broadcast_to(np.asarray(undercooled, dtype=bool), t.shape)
        rate = np.log(2.0) ** (1 / self.exponent) / self.half_time * below
        rate = rate * (1 + self.flow_enhancement * np.maximum(w**2 - 1, 0.0))
        spent = np.concatenate(([0.0], np.cumsum(np.diff(t) * 0.5 * (rate[1:] + rate[:-1]))))
        value: FloatArray = self.maximum * -np.expm1(-(np.minimum(spent, 1e50) ** self.exponent))
        return value
