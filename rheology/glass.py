"""How a solution stiffens on its way to the glass: Fox's glass transition against composition, WLF above it.

::

    1/T_g = w_p/T_gp + sum_i w_i/T_gi                               Fox, mass fractions
    log10 a = -C_1 (T - T_g)/(C_2 + T - T_g)                        WLF, C_1 = 17.44, C_2 = 51.6 K; a = 1 at T_g
    f(phi, T) = [mu_s(T)/mu_s(T_0)] a[T - T_g(phi)]/a[T - T_g(phi_0)]

f multiplies viscosity and relaxation time of the concentration laws, which hold at one temperature and leave the
friction of the segments as it is: at the solution's own fraction temperature enters by the solvent's viscosity alone,
towards the glass by WLF, twelve to fourteen decades of it. Below T_g the line of WLF at T_g goes on (C_1/C_2 = 0.34
decades a kelvin): the glass creeps, it does not flow. Universal constants: within a decade or two at a given distance
from T_g, within a few kelvin of where the jet arrests.

References
----------
Fox, Bull. Am. Phys. Soc. 1, 123 (1956); Williams, Landel, Ferry, J. Am. Chem. Soc. 77, 3701 (1955); Ferry,
Viscoelastic Properties of Polymers, 3rd ed. (1980), chapters 11 and 17.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError

__all__ = ["WLF_C1", "WLF_C2", "GlassLaw", "wlf_decades"]

WLF_C1, WLF_C2 = 17.44, 51.6


def wlf_decades(above_glass: ArrayLike) -> FloatArray:
    """``log10`` of the shift factor against ``T - T_g`` (K, in [-1000, 1000]): 0 at T_g, -12.0 a hundred kelvin above.

    Examples
    --------
    >>> round(float(wlf_decades(100.0)), 2), float(wlf_decades(0.0)) == 0
    (-11.5, True)
    """
    x = real("temperature above the glass transition", above_glass, least=-1000.0, most=1000.0, unit="K")
    up = np.maximum(x, 0.0)
    value: FloatArray = -WLF_C1 * up / (WLF_C2 + up) - WLF_C1 / WLF_C2 * np.minimum(x, 0.0)
    return value


@dataclass(frozen=True)
class GlassLaw:
    """Glass of a polymer with its liquids.

    Attributes
    ----------
    polymer_glass, polymer_density : float
        K, kg/m3.
    liquid_glass, liquid_density : tuple of float
        Of every liquid.
    """

    polymer_glass: float
    polymer_density: float
    liquid_glass: tuple[float, ...]
    liquid_density: tuple[float, ...]

    def __post_init__(self) -> None:
        positive("glass_transition", self.polymer_glass, "K")
        positive("polymer_density", self.polymer_density, "kg/m3")
        if len(self.liquid_glass) != len(self.liquid_density) or not self.liquid_glass:
            raise InputError("liquid_glass", "must be one per liquid", value=len(self.liquid_glass))
        for glass, density in zip(self.liquid_glass, self.liquid_density, strict=True):
            positive("solvent_glass_transition", glass, "K")
            positive("solvent_density", density, "kg/m3")

    def transition(self, polymer_fraction: ArrayLike, liquid_fractions: ArrayLike) -> FloatArray:
        """T_g in K of compositions.

        Parameters
        ----------
        polymer_fraction : array_like, (...)
            Volume fraction, in [0, 1].
        liquid_fractions : array_like, (liquid, ...)
            Volume fractions, >= 0; together 1 (they are taken in proportion).
        """
        phi = real("polymer_fraction", polymer_fraction, least=0.0, most=1.0)
        rest = real("liquid_fractions", liquid_fractions, least=-1e-9, most=1.0 + 1e-9)
        shape = (-1,) + (1,) * (rest.ndim - 1)
        masses = np.maximum(rest, 0.0) * np.reshape(self.liquid_density, shape)
        own = phi * self.polymer_density
        total = own + masses.sum(axis=0)
        value: FloatArray = total / (
            own / self.polymer_glass + (masses / np.reshape(self.liquid_glass, shape)).sum(axis=0)
        )
        return value

    def vitrification_fraction(self, temperature: float, shares: ArrayLike = 1.0) -> float:
        """Polymer volume fraction that is a glass at a temperature; NaN where the dry polymer is none, 0 where the
        liquids are.

        Parameters
        ----------
        temperature : float
            K.
        shares : array_like, (liquid,)
            Volume shares of the liquids among themselves.
        """
        kelvin = positive("temperature", temperature, "K")
        share = np.atleast_1d(real("shares", shares, least=0.0, most=1.0))
        if kelvin >= self.polymer_glass:
            return float("nan")
        mass = share * np.array(self.liquid_density)
        low = float(mass.sum() / (mass / np.array(self.liquid_glass)).sum())
        if kelvin <= low:
            return 0.0
        w = (1 - low / kelvin) / (1 - low / self.polymer_glass)
        density = float(mass.sum() / share.sum())
        volume = w / self.polymer_density
        return volume / (volume + (1 - w) / density)

    def stiffening_decades(
        self,
        polymer_fraction: ArrayLike,
        liquid_fractions: ArrayLike,
        temperature: ArrayLike,
        initial_glass: float,
    ) -> FloatArray:
        """``log10`` of ``a[T - T_g(phi)]/a[T - T_g(phi_0)]``: what the glass to come adds to viscosity and relaxation
        time.

        Parameters
        ----------
        polymer_fraction, liquid_fractions
            As for `transition`.
        temperature : array_like
            K.
        initial_glass : float
            T_g of the solution at the nozzle, K.
        """
        t = real("temperature", temperature, above=0.0, most=1000.0, unit="K")
        first = number("initial_glass", initial_glass, above=0.0, most=1000.0, unit="K")
        return wlf_decades(t - self.transition(polymer_fraction, liquid_fractions)) - wlf_decades(t - first)
