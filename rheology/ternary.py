"""Does a drying solution stay one phase: ternary Flory-Huggins, spinodal and binodal along the path of its composition.

Per volume and RT, of liquids i (molar volumes v_i, fractions phi_i) and a polymer (v_p, phi_p)::

    f = sum_i (phi_i/v_i) ln phi_i + (phi_p/v_p) ln phi_p + sum_{i<j} g_ij phi_i phi_j + phi_p sum_i g_ip phi_i
    g_ip = chi_ip/v_i,  g_ij = chi_ij/v_i

Inside the *spinodal* (the Hessian of f is not positive) a solution separates at once: a jet whose path goes there
becomes porous unless it solidifies first. Between *binodal* and spinodal it needs nuclei, and a jet's milliseconds may
pass without any: said, not flagged as porous. The binodal is found by the tangent plane: a composition is outside it
where no other lies under its tangent.

References
----------
Flory, Principles of Polymer Chemistry (1953), chapter XIII; Altena, Smolders, Macromolecules 15, 1491 (1982);
Michelsen, Fluid Phase Equilib. 9, 1 (1982).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, real
from spinline.base.errors import InputError

__all__ = ["PathVerdict", "Ternary"]

_LEAST = 1e-12
_LOOKED_AT = 24  # samples of a path that meets no spinodal


@dataclass(frozen=True)
class PathVerdict:
    """What becomes of a composition's path.

    Attributes
    ----------
    spinodal, binodal : int
        First sample inside, -1 where none is.
    """

    spinodal: int
    binodal: int


@dataclass(frozen=True)
class Ternary:
    """A polymer with two liquids, water (or another non-solvent) first.

    Attributes
    ----------
    water_volume, solvent_volume, polymer_volume : float
        Molar volumes, m3/mol; of the polymer that of a chain.
    water_solvent, water_polymer, solvent_polymer : float
        chi, each by the molar volume of the first named.
    """

    water_volume: float
    solvent_volume: float
    polymer_volume: float
    water_solvent: float
    water_polymer: float
    solvent_polymer: float

    def __post_init__(self) -> None:
        for name in ("water_volume", "solvent_volume", "polymer_volume"):
            number(name, getattr(self, name), least=1e-9, most=1e9, unit="m3/mol")
        for name in ("water_solvent", "water_polymer", "solvent_polymer"):
            number(name, getattr(self, name), least=-10.0, most=20.0)

    def stability(self, water: ArrayLike, polymer: ArrayLike) -> FloatArray:
        """Least eigenvalue's sign of the Hessian, scaled: > 0 in one phase, < 0 inside the spinodal.

        Parameters
        ----------
        water, polymer : array_like
            Volume fractions, in [0, 1], together at most 1; the rest is solvent.

        Returns
        -------
        ndarray, ``det H`` times ``v_1 phi_1 v_2 phi_2`` where both minors allow it: 1 in an ideal mixture of liquids.
        """
        one, p = self._fractions(water, polymer)
        two = np.maximum(1 - one - p, 0.0)
        v1, v2, v3 = self.water_volume, self.solvent_volume, self.polymer_volume
        g12, g13, g23 = self._g
        # rows scaled by v phi: finite at the edges
        a, b = v1 * one, v2 * two
        chain = 1 / (v3 * np.maximum(p, _LEAST))
        h11, h22 = 1 + a * (chain - 2 * g13), 1 + b * (chain - 2 * g23)
        h12 = chain + g12 - g13 - g23
        det = h11 * h22 - a * b * h12**2
        value: FloatArray = np.where((h11 > 0) & (h22 > 0), det, np.minimum(det, np.minimum(h11, h22)))
        return value

    def potentials(self, water: FloatArray, polymer: FloatArray) -> FloatArray:
        """``mu_i/(v_i RT)`` of water, solvent and polymer, (3, ...), from the pure liquids; each per volume of its
        own.
        """
        one, p = np.maximum(water, _LEAST), np.maximum(polymer, _LEAST)
        two = np.maximum(1 - water - polymer, _LEAST)
        v1, v2, v3 = self.water_volume, self.solvent_volume, self.polymer_volume
        g12, g13, g23 = self._g
        number_density = one / v1 + two / v2 + p / v3
        pairs = g12 * one * two + g13 * one * p + g23 * two * p
        return np.stack(
            [
                (np.log(one) + 1) / v1 - number_density + g12 * two + g13 * p - pairs,
                (np.log(two) + 1) / v2 - number_density + g12 * one + g23 * p - pairs,
                (np.log(p) + 1) / v3 - number_density + g13 * one + g23 * two - pairs,
            ]
        )

    def tangent_distance(self, water: float, polymer: float, points: int = 60) -> float:
        """Least distance of the free energy from the tangent plane at a composition: < 0 where it can lower it by
        separating.

        Searched on a grid of `points` a side, fine at the edges, with one refinement; in units of 1/v_1.
        """
        at = self.potentials(np.asarray(water), np.asarray(polymer))
        best, where = self._least(at, *_everywhere(self, points))
        width = 3.0 / points
        for _ in range(3):
            spread = np.linspace(-width, width, 21)
            dx, dy = (a.ravel() for a in np.meshgrid(spread, spread))
            x = np.clip(where[0] + dx, 0.0, 1.0)
            y = np.clip(where[1] + dy, 0.0, 1.0)
            kept = x + y <= 1
            found, place = self._least(at, x[kept], y[kept], self._energy(x[kept], y[kept]))
            if found < best:
                best, where = found, place
            width /= 8
        return best * self.water_volume

    def follow(self, water: ArrayLike, polymer: ArrayLike) -> PathVerdict:
        """First samples of a path inside spinodal and binodal.

        Parameters
        ----------
        water, polymer : array_like, (n,)
            Volume fractions along the jet.
        """
        one, p = self._fractions(water, polymer)
        inside = np.flatnonzero(self.stability(one, p) < 0)
        first = int(inside[0]) if inside.size else -1
        if self._splits(one[0], p[0]):
            return PathVerdict(first, 0)
        low, high = 0, first
        if first < 0:  # no spinodal: is there a place between binodal and spinodal?
            some = np.unique(np.linspace(0, one.size - 1, _LOOKED_AT).astype(int))
            high = next((int(k) for k in some if self._splits(one[k], p[k])), -1)
            if high < 0:
                return PathVerdict(-1, -1)
            low = int(some[np.searchsorted(some, high) - 1])
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if self._splits(one[middle], p[middle]) else (middle, high)
        return PathVerdict(first, high)

    def _splits(self, water: float, polymer: float) -> bool:
        return self.tangent_distance(float(water), float(polymer)) < -1e-9

    def _least(
        self, at: FloatArray, one: FloatArray, p: FloatArray, energy: FloatArray
    ) -> tuple[float, tuple[float, float]]:
        """Least distance of some compositions' free energy from the tangent plane with the potentials `at`, and where."""
        distance = energy - (one * at[0] + (1 - one - p) * at[1] + p * at[2])
        k = int(np.argmin(distance))
        return float(distance[k]), (float(one[k]), float(p[k]))

    def _energy(self, one: FloatArray, p: FloatArray) -> FloatArray:
        """Free energy of mixing by volume, from the pure liquids."""
        water, solvent, polymer = self.potentials(one, p)
        value: FloatArray = one * water + (1 - one - p) * solvent + p * polymer
        return value

    @property
    def _g(self) -> tuple[float, float, float]:
        return (
            self.water_solvent / self.water_volume,
            self.water_polymer / self.water_volume,
            self.solvent_polymer / self.solvent_volume,
        )

    @staticmethod
    def _fractions(water: ArrayLike, polymer: ArrayLike) -> tuple[FloatArray, FloatArray]:
        one, p = real("water", water, least=-1e-9, most=1 + 1e-9), real("polymer", polymer, least=0.0, most=1 + 1e-9)
        if (one + p > 1 + 1e-9).any():
            raise InputError(
                "water", "and polymer are more than the whole", value=float((one + p).max()), allowed="[0, 1]"
            )
        return np.clip(one, 0.0, 1.0), np.clip(p, 0.0, 1.0)


@lru_cache(maxsize=4)
def _everywhere(mixture: Ternary, points: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Water, polymer and free energy all over the triangle, fine at the edges: one surface for all tangents."""
    side = 0.5 * (1 - np.cos(np.pi * np.linspace(0, 1, points)))
    side = np.unique(np.concatenate((side, np.geomspace(1e-8, 0.1, points // 2))))
    one, share = (a.ravel() for a in np.meshgrid(side, side))
    polymer = (1 - one) * share
    return one, polymer, mixture._energy(one, polymer)
