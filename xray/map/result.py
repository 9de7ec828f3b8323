"""What a fitted map says of the jet: fractions at any row and radius, with their errors."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spinline.base.checks import BoolArray, FloatArray, real
from spinline.base.errors import InputError
from spinline.xray.map.basis import AxialBasis, RadialBasis

if TYPE_CHECKING:
    from spinline.xray.map.band import Factor

__all__ = ["MapDraws", "MapFit", "MapState"]


@dataclass(frozen=True, eq=False)
class MapDraws:
    """Samples of a map's posterior.

    Attributes
    ----------
    fraction : ndarray, shape (draws, rows, shells)
    mean_fraction, radius, axis : ndarray, shape (draws, rows)
        m, for radius and axis.
    """

    fraction: FloatArray
    mean_fraction: FloatArray
    radius: FloatArray
    axis: FloatArray


@dataclass(frozen=True, eq=False)
class MapState:
    """Where the search for a map is, before a turn: all that the rest of it depends on.

    Attributes
    ----------
    coefficients, weights : ndarray
        Of the splines, and of the roughness.
    near, settled : bool
        The start is forgotten; the weights no longer change.
    turns, changes : int
        Turns taken, and those of them that changed the weights.
    """

    coefficients: FloatArray
    weights: FloatArray
    near: bool
    settled: bool
    turns: int
    changes: int


@dataclass(frozen=True, eq=False)
class MapFit:
    """What all rows together say of the jet.

    Attributes
    ----------
    z : ndarray, shape (rows,)
        Place of each row, m.
    edges : ndarray, shape (shells + 1,)
        r/R of the shells of `fraction`.
    fraction, fraction_std : ndarray, shape (rows, shells)
        Mean over each shell, and its standard deviation. `polymer_fraction` gives the fraction itself at any r/R.
    mean_fraction, mean_fraction_std : ndarray, shape (rows,)
        Mean over the cross-section.
    radius, radius_std, axis, axis_std : ndarray, shape (rows,)
        m; std 0 for what was held.
    values, std : dict
        All nuisances by name, shape (rows,).
    limit_std : ndarray, shape (rows,)
        Smallest standard deviation of the mean that the row alone allows an unbiased estimate, nothing else unknown. A map may
        be below it, for it takes neighbouring rows to be alike. NaN in rows without counts.
    smoothing : dict
        Weight of each term of the roughness, in units of the coefficients (fractions, pixels).
    term_freedom : dict
        Degrees of freedom that the counts left each term.
    effective_freedom : float
        Unknowns in effect.
    expected : ndarray, shape (rows, pixels)
        Mean counts of the fit.
    deviance, degrees_of_freedom : float
        Poisson deviance, and pixels less `effective_freedom`.
    misfit : float
        Pearson's chi-square less its expectation, in its standard deviations. Over 4 is a wrong model.
    excess : float
        Pearson's chi-square over the degrees of freedom: 1 for a good fit.
    used : ndarray of bool, shape (rows,)
        Rows that had a usable count; others are bridged by the splines.
    converged : bool
    iterations : int
    warnings : tuple of str
    """

    z: FloatArray
    edges: FloatArray
    fraction: FloatArray
    fraction_std: FloatArray
    mean_fraction: FloatArray
    mean_fraction_std: FloatArray
    radius: FloatArray
    radius_std: FloatArray
    axis: FloatArray
    axis_std: FloatArray
    values: dict[str, FloatArray]
    std: dict[str, FloatArray]
    limit_std: FloatArray
    smoothing: dict[str, float]
    term_freedom: dict[str, float]
    effective_freedom: float
    expected: FloatArray
    deviance: float
    degrees_of_freedom: float
    misfit: float
    excess: float
    used: BoolArray
    converged: bool
    iterations: int
    warnings: tuple[str, ...]
    posterior: "MapPosterior" = field(repr=False)

    def polymer_fraction(self, row: ArrayLike, radius_ratio: ArrayLike) -> FloatArray:
        """Polymer fraction at rows and r/R in [0, 1], broadcast against each other."""
        rows, basis = self._at(row, radius_ratio)
        value: FloatArray = np.einsum("...j,...j->...", basis, self.posterior.local[rows])
        return value

    def polymer_fraction_std(self, row: ArrayLike, radius_ratio: ArrayLike) -> FloatArray:
        """Standard deviation of `polymer_fraction`."""
        rows, basis = self._at(row, radius_ratio)
        variance = np.einsum("...j,...jk,...k->...", basis, self.posterior.covariance[rows], basis)
        value: FloatArray = np.sqrt(variance)
        return value

    def fraction_covariance(self, row: int) -> FloatArray:
        """Covariance of a row's shells, shape (shells, shells)."""
        rows, _ = self._at(row, 0.0)
        if rows.ndim:
            raise InputError("row", "must be a single row", value=row)
        shells = self.posterior.radial.shells(self.edges)
        value: FloatArray = shells @ self.posterior.covariance[int(rows)] @ shells.T
        return value

    def draws(self, count: int, seed: int = 0) -> MapDraws:
        """Samples of the posterior, the same for the same seed: for what is not linear in the fractions, or joins rows."""
        for name, value in (("count", count), ("seed", seed)):
            if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 0:
                raise InputError(name, "is not a non-negative integer", value=value)
        p = self.posterior
        generator = np.random.default_rng(int(seed))
        shells, size = p.radial.shells(self.edges), p.radial.size
        out = MapDraws(
            np.empty((count, *self.fraction.shape)),
            *(np.broadcast_to(v, (count, v.size)).copy() for v in (self.mean_fraction, self.radius, self.axis)),
        )
        for i in range(count):
            off = p.axial.along(p.factor.draw(generator))
            out.fraction[i] = self.fraction + off[:, :size] @ shells.T
            out.mean_fraction[i] += off[:, :size] @ p.radial.area
            for name, array in (("radius", out.radius), ("axis", out.axis)):
                if name in p.names:
                    array[i] += off[:, size + p.names.index(name)] * p.pixel
        return out

    def response(self, name: str, change: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What the fit makes of a change that rows have in a nuisance but its curve along z has not, such as of their places.

        Parameters
        ----------
        name : str
            A fitted nuisance.
        change : ndarray, shape (rows,)
            In its unit: m for the radius.

        Returns
        -------
        fraction, value : ndarray, shapes (rows, shells) and (rows,)
            Changes of the fractions and of the nuisance itself, to first order.
        """
        from spinline.xray.map.band import assembled  # compiled: loaded when first used

        p = self.posterior
        if name not in p.names:
            raise InputError("name", "is no fitted nuisance of this map", value=name, allowed=", ".join(p.names))
        size = p.radial.size
        at = size + p.names.index(name)
        unit = p.pixel if name in ("radius", "axis", "blur") else 1.0
        _, right = assembled(p.axial, p.fisher[:, :0, :0], p.fisher[:, :, at] * (np.asarray(change) / unit)[:, None])
        off = p.axial.along(p.factor.solve(right))
        fraction: FloatArray = off[:, :size] @ p.radial.shells(self.edges).T
        return fraction, off[:, at] * unit

    def _at(self, row: ArrayLike, radius_ratio: ArrayLike) -> tuple[NDArray[np.int64], FloatArray]:
        rho = real("radius_ratio", radius_ratio, least=0.0, most=1.0)
        rows = np.asarray(row)
        if rows.dtype.kind not in "iu" or (rows < -self.z.size).any() or (rows >= self.z.size).any():
            raise InputError("row", "is not a row of the map", value=row, allowed=f"an integer, 0 to {self.z.size - 1}")
        rows, rho = np.broadcast_arrays(rows, rho)
        return rows.astype(np.int64), self.posterior.radial(rho)


@dataclass(frozen=True, eq=False)
class MapPosterior:
    """Coefficients behind a `MapFit`, for `polymer_fraction` and `draws`.

    Attributes
    ----------
    radial, axial : RadialBasis, AxialBasis
    names : tuple of str
        Fitted nuisances.
    local, covariance : ndarray, shapes (rows, splines) and (rows, splines, splines)
        Coefficients across the jet at each row.
    factor : Factor
    pixel : float
    fisher : ndarray, shape (rows, n, n)
        Of each row's fractions and nuisances.
    """

    radial: RadialBasis
    axial: AxialBasis
    names: tuple[str, ...]
    local: FloatArray
    covariance: FloatArray
    factor: "Factor"
    pixel: float
    fisher: FloatArray
