"""How smooth a map is, told by its own counts: restricted maximum likelihood.

Coefficients c with roughness ``c^T S_j c`` and weights lambda_j are the mode of a posterior whose prior has the precision
``S = sum_j lambda_j S_j``. The weights maximise the likelihood with the coefficients integrated out (Laplace's approximation,
exact for a quadratic one). Near a working point with curvature A and ``V = (A + S)^-1`` its slope vanishes where

    lambda_j c^T S_j c = lambda_j (tr(S^- S_j) - tr(V S_j)) = e_j,

the roughness that is there against the degrees of freedom e_j that the counts leave term j. One thing is added: a prior of
the weights, flat in the standard deviation ``lambda_j^(-1/2)`` of the differences (Gelman), for without it a term whose signal
is near the noise is often put to nothing (lambda_j -> infinity), and its errors with it. So ``lambda_j c^T S_j c + 1 = e_j``,
found by (Wood)

    lambda_j <- lambda_j e_j/(lambda_j c^T S_j c + 1)

whose steps in ln lambda are stretched by secants.

What the errors then hold. Noise alone gives ``V A V``, and V is that for a truth drawn from the prior. In a direction
where the counts know the share s the two are s^2 and s of the counts' own variance; with differences of order m,
``s = 1/(1 + (k/k0)^2m)`` at the wave number k, and a truth much smoother than the prior's draws has errors that scatter by

    (int s^2 dk/int s dk)^(1/2) = (1 - 1/(2m))^(1/2)

of V's: 0.87 for m = 2, 0.91 for m = 3. A truth rougher than the draws, or rough in one place only, makes it more than 1.
A prior flat in the variance 1/lambda instead (``+ 2``) takes it for ``(e - 1)/(e - 2)`` times as large: 1.06 at e = 20,
but 2 at the e = 3 that few counts leave, where the errors became too wide.

References
----------
Gelman, Bayesian Anal. 1, 515 (2006), on such priors.
Wood and Fasiolo, Biometrics 73, 1071 (2017), without it; Fellner, Technometrics 28, 51 (1986).
Nychka, J. Am. Statist. Assoc. 83, 1134 (1988), on what such errors hold.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.xray.map.band import factorised
from spinline.xray.map.basis import AxialBasis, RadialBasis

__all__ = ["Penalty"]

_LEAST_FREEDOM = 1.0  # from the prior, flat in 1/sqrt(lambda)
_GONE = 0.02  # degrees of freedom that do not matter
_CLOSE = 0.1  # of the error of ln lambda
_ACROSS = ("fraction across, core", "fraction across, rim")


@dataclass(frozen=True, eq=False)
class Penalty:
    """Roughness of a map: of the fraction across and along the jet, and of each nuisance along it.

    Attributes
    ----------
    radial, axial : RadialBasis, AxialBasis
    names : tuple of str
        Of the terms: "fraction across, core", "fraction across, rim", then, with more than one spline along z, "fraction
        along" and the nuisances.
    """

    radial: RadialBasis
    axial: AxialBasis
    names: tuple[str, ...]

    @classmethod
    def of(cls, radial: RadialBasis, axial: AxialBasis, nuisances: Sequence[str]) -> "Penalty":
        """Terms for these fitted nuisances."""
        return cls(radial, axial, (*_ACROSS, *(("fraction along", *nuisances) if axial.size > 1 else ())))

    def added(self, matrix: FloatArray, weights: FloatArray) -> FloatArray:
        """A band, as in `map_band.assembled`, with the roughness added."""
        out = matrix.copy()
        n = self.radial.size
        out[:, 0, :n, :n] += self._across(weights)
        for term, columns in self._along():
            out[:, :, columns, columns] += weights[term] * self.axial.penalty[:, :, None]
        return out

    def applied(self, coefficients: FloatArray, weights: FloatArray) -> FloatArray:
        """S c, shape (splines, n)."""
        out = np.zeros_like(coefficients)
        n = self.radial.size
        out[:, :n] = coefficients[:, :n] @ self._across(weights)
        for term, columns in self._along():
            c = coefficients[:, columns]
            out[:, columns] += weights[term] * self.axial.penalty[:, :1] * c
            for d in range(1, self.axial.order + 1):
                band = weights[term] * self.axial.penalty[:-d, d : d + 1]
                out[:-d, columns] += band * c[d:]
                out[d:, columns] += band * c[:-d]
        return out

    def roughness(self, coefficients: FloatArray) -> FloatArray:
        """``c^T S_j c`` of each term."""
        fraction = coefficients[:, : self.radial.size]
        across = self.radial.shares @ ((fraction @ self.radial.differences.T) ** 2).sum(axis=0)
        return np.array([*across, *(self.axial.quadratic(coefficients[:, c]).sum() for _, c in self._along())])

    def prior(self, weights: FloatArray) -> FloatArray:
        """``lambda_j tr(S^- S_j)`` of each term: its degrees of freedom before there are counts."""
        out = np.full(len(self.names), float(self.axial.size - self.axial.order))
        rough, axes = np.linalg.eigh(self._across(weights))
        rough[:2] = 0.0  # a constant and a parabola
        along = self.axial.roughness * (weights[2] if self.axial.size > 1 else 0.0)
        total = rough[:, None] + along
        inverse = np.divide(1.0, total, out=np.zeros_like(total), where=total > 0.0)
        turned = np.einsum("ji,qjk,ki->qi", axes, self.radial.penalties, axes, optimize=True)
        out[:2] = weights[:2] * (turned @ inverse.sum(axis=1))
        if self.axial.size > 1:
            out[2] = (inverse * along).sum()
        return out

    def traces(self, covariance: FloatArray) -> FloatArray:
        """``tr(V S_j)`` of each term, from the inverse within the band."""
        n = self.radial.size
        across = (covariance[:, 0, :n, :n].sum(axis=0) * self.radial.penalties).sum(axis=(1, 2))
        diagonal = np.diagonal(covariance, axis1=2, axis2=3).copy()
        diagonal[:, 1:] *= 2.0
        sums = (diagonal * self.axial.penalty[:, :, None]).sum(axis=(0, 1))
        return np.array([*across, *(sums[c].sum() for _, c in self._along())])

    def balance(self, matrix: FloatArray) -> FloatArray:
        """Weights at which each term is as stiff as the counts: traces of its part of the band over its own."""
        n = self.radial.size
        curvature = np.diagonal(matrix[:, 0], axis1=1, axis2=2).sum(axis=0)
        own = self.axial.size * np.trace(self.radial.penalties, axis1=1, axis2=2)
        along = float(self.axial.penalty[:, 0].sum())
        return np.array([*(curvature[:n].sum() / own), *(curvature[c].mean() / along for _, c in self._along())])

    def improved(
        self, matrix: FloatArray, right: FloatArray, coefficients: FloatArray, weights: FloatArray, sweeps: int
    ) -> tuple[FloatArray, FloatArray, bool]:
        """Better weights for a quadratic likelihood, by up to `sweeps` updates.

        Parameters
        ----------
        matrix, right : ndarray
            Curvature and slope of the log-likelihood at the coefficients.
        coefficients : ndarray, shape (splines, n)
        weights : ndarray, shape (terms,)
        sweeps : int
            0 leaves the weights as they are.

        Returns
        -------
        weights, proposed, settled
            With the mode for these weights.
        """
        weights = weights.copy()
        last_gap = last_step = None
        for sweep in range(sweeps + 1):
            factor = factorised(self.added(matrix, weights))
            proposed = coefficients + factor.solve(right - self.applied(coefficients, weights))
            if sweep == sweeps:
                break
            taken = weights * self.traces(factor.covariance())
            freedom = np.maximum(self.prior(weights) - taken, 0.0)
            rough = weights * self.roughness(proposed)
            close = np.abs(rough + _LEAST_FREEDOM - freedom) < _CLOSE * np.sqrt(freedom + _GONE)
            idle = (rough + _LEAST_FREEDOM > freedom) & (taken < _GONE)  # a smaller weight would change nothing
            if (close | idle).all():
                return weights, proposed, True
            gap = np.log((freedom + 1e-6) / (rough + _LEAST_FREEDOM))
            stretch = np.ones_like(gap)
            if last_gap is not None and last_step is not None:
                change = last_gap - gap
                ratio = np.divide(last_step, change, out=np.ones_like(gap), where=np.abs(change) > 1e-9)
                stretch = np.where(
                    (ratio > 0.0) & (gap * last_gap > 0.0), np.clip(ratio, 1.0, 5.0), np.clip(ratio, 0.3, 1.0)
                )
            last_gap, last_step = gap, np.where(idle, 0.0, np.clip(stretch * gap, -4.0, 4.0))
            weights *= np.exp(last_step)
        return weights, proposed, False

    def _across(self, weights: FloatArray) -> FloatArray:
        value: FloatArray = np.tensordot(weights[:2], self.radial.penalties, axes=1)
        return value

    def _along(self) -> list[tuple[int, FloatArray]]:
        n = self.radial.size
        if self.axial.size == 1:
            return []
        return [(2, np.arange(n)), *((t, np.array([n + t - 3])) for t in range(3, len(self.names)))]
