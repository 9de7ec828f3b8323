"""A fitted problem: values, covariance, intervals."""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.fit.model import PARAMETERS
from spinline.fit.problem import FitProblem

__all__ = ["Fit"]


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted problem; arrays over the free parameters (p,), in their order.

    Attributes
    ----------
    problem : FitProblem
    coordinates, covariance : ndarray, (p,) and (p, p)
        Best coordinates and their covariance (inf along directions that nothing determines).
    values : dict
        Best parameters, SI.
    interval68, interval95 : dict
        Parameter name to (low, high), SI.
    jacobian : ndarray, (n, p)
        Of the whitened data residuals.
    residuals : ndarray, (n,)
        Of the data, whitened.
    chi_squared : float
        Sum of their squares.
    degrees_of_freedom : int
        Values plus priors minus parameters.
    evaluations : int
        Of the model.
    notes : tuple of str
        Warnings, also given as such.
    """

    problem: FitProblem
    coordinates: FloatArray
    covariance: FloatArray
    values: dict[str, float]
    interval68: dict[str, tuple[float, float]]
    interval95: dict[str, tuple[float, float]]
    jacobian: FloatArray
    residuals: FloatArray
    chi_squared: float
    degrees_of_freedom: int
    evaluations: int
    notes: tuple[str, ...] = ()

    @property
    def std(self) -> dict[str, float]:
        """Standard deviation of each parameter, SI, to first order."""
        spread = np.sqrt(np.diag(self.covariance)) * self.problem.scale
        return {
            name: float(s * (self.values[name] if PARAMETERS[name].log else 1.0))
            for name, s in zip(self.problem.free, spread, strict=True)
        }

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the coordinates, (p, p); NaN where a variance is infinite."""
        sd = np.sqrt(np.diag(self.covariance))
        with np.errstate(invalid="ignore"):
            value: FloatArray = self.covariance / np.outer(sd, sd)
        return value
