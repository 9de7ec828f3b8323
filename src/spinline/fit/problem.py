"""What a fit is asked: a model, data, and parameters with what is known of them beforehand.

Coordinates are logarithms of positive parameters, and beta and the origin as they are, in units of a change of order one
(`scale`). A prior ``value +/- std`` is normal in the coordinate, hence log-normal for what is positive, of relative width
std/value.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.fit.model import PARAMETERS, ForwardModel
from spinline.fit.observations import Observation

__all__ = ["FitProblem", "Loss", "Prior"]

Loss = Literal["gauss", "huber", "cauchy"]
_ROBUST = 1.5  # standard deviations, scale of the robust losses


@dataclass(frozen=True)
class Prior:
    """What is known of a parameter beforehand, SI.

    Attributes
    ----------
    value : float
        Where to start, and the prior's centre.
    std : float
        Standard deviation; inf for a parameter of which nothing is known.
    """

    value: float
    std: float = np.inf


@dataclass(frozen=True, eq=False)
class FitProblem:
    """Model, data, and what is fitted.

    Attributes
    ----------
    model : ForwardModel
    data : tuple of Observation
    free : mapping
        Parameter name to `Prior`, in the order of the results.
    loss : {"gauss", "huber", "cauchy"}
    title : str
    """

    model: ForwardModel
    data: tuple[Observation, ...]
    free: Mapping[str, Prior]
    loss: Loss = "gauss"
    title: str = ""

    def __post_init__(self) -> None:
        if not self.data:
            raise InputError("data", "is empty", remedy="add a [[data]] table with path and kind")
        if not self.free:
            raise InputError("parameters", "has nothing to fit", remedy='for example k = "free" in [parameters]')
        if self.loss not in get_args(Loss):
            raise InputError("loss", "is not known", value=self.loss, allowed=", ".join(get_args(Loss)))
        for name, prior in self.free.items():
            if name not in PARAMETERS:
                raise InputError(name, "is not a parameter", allowed=", ".join(PARAMETERS))
            if name not in self.model.names:
                raise InputError(
                    f"parameters.{name}",
                    "changes nothing in this model",
                    allowed=", ".join(self.model.names),
                    remedy="take it out",
                )
            kind = PARAMETERS[name]
            if not kind.low <= prior.value <= kind.high:
                raise InputError(
                    f"parameters.{name}", "is out of range", value=prior.value, allowed=f"[{kind.low:g}, {kind.high:g}]"
                )
            if not prior.std > 0:
                raise InputError(
                    f"parameters.{name}",
                    "has no usable uncertainty",
                    value=prior.std,
                    allowed="(0, inf)",
                    remedy="leave +/- out to hold it fixed",
                )
        known = sum(np.isfinite(prior.std) for prior in self.free.values())
        if self.size + known < len(self.free):
            raise InputError(
                "data",
                f"holds {self.size} value(s) and {known} prior(s) for {len(self.free)} free parameters",
                value=", ".join(self.free),
                remedy="fix parameters, give priors (value +/- std), or add data",
            )
        for part in self.data:
            _within_jet(part, self.model, self.free)

    @property
    def size(self) -> int:
        """Number of values."""
        return sum(part.size for part in self.data)

    @property
    def names(self) -> tuple[str, ...]:
        """Free parameters."""
        return tuple(self.free)

    @property
    def scale(self) -> FloatArray:
        """What is a change of order one of each coordinate."""
        r0 = self.model.values["initial_radius"]
        return np.array([r0 if name == "origin" else PARAMETERS[name].scale for name in self.free])

    def to_values(self, coordinates: FloatArray) -> dict[str, float]:
        """Parameters (SI) of coordinates."""
        pairs = zip(self.free, coordinates * self.scale, strict=True)
        return {name: float(np.exp(u)) if PARAMETERS[name].log else float(u) for name, u in pairs}

    def to_coordinates(self, values: Mapping[str, float]) -> FloatArray:
        """Coordinates, in units of `scale`, of parameters (SI)."""
        plain = [np.log(values[name]) if PARAMETERS[name].log else values[name] for name in self.free]
        return np.array(plain) / self.scale

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest coordinates."""
        return (
            self.to_coordinates({name: PARAMETERS[name].low for name in self.free}),
            self.to_coordinates({name: PARAMETERS[name].high for name in self.free}),
        )

    @property
    def prior_std(self) -> FloatArray:
        """Standard deviations of the priors in coordinates; inf where there is none."""
        widths = [p.std / p.value if PARAMETERS[name].log else p.std for name, p in self.free.items()]
        return np.array(widths) / self.scale

    @property
    def prior_mean(self) -> FloatArray:
        """Centres of the priors in coordinates."""
        return self.to_coordinates({name: prior.value for name, prior in self.free.items()})

    def data_residuals(self, coordinates: FloatArray) -> FloatArray:
        """Whitened residuals of the data, measured minus predicted."""
        shown = self.model.measured(self.data, self.to_values(coordinates))
        return np.concatenate([part.whiten(part.value - y) for part, y in zip(self.data, shown, strict=True)])

    def residuals(self, coordinates: FloatArray) -> FloatArray:
        """Those of the data, then one of each parameter's prior (0 where there is none)."""
        return np.concatenate((self.data_residuals(coordinates), (coordinates - self.prior_mean) / self.prior_std))

    def log_posterior(self, coordinates: FloatArray) -> float:
        """Unnormalised logarithm of the posterior density in coordinates; -inf out of range."""
        low, high = self.bounds
        if not ((coordinates >= low) & (coordinates <= high)).all():
            return -np.inf
        try:
            squares = self.residuals(coordinates) ** 2
        except InputError:  # a corner of the range that the model refuses has no probability
            return -np.inf
        return float(-0.5 * self.rho(squares)[0].sum())

    def simulate(self, values: Mapping[str, float], rng: np.random.Generator) -> "FitProblem":
        """The same problem with data drawn from the model at `values`, with the standard deviations of the data."""
        shown = self.model.measured(self.data, values)
        drawn = []
        for part, y in zip(self.data, shown, strict=True):
            noise = rng.standard_normal(part.size)
            if part.covariance is not None:
                factor = np.linalg.cholesky(part.covariance)
                noise = (factor @ noise.reshape(*factor.shape[:2], 1)).ravel()
            else:
                noise = noise * part.std
            drawn.append(replace(part, value=y + noise))
        return replace(self, data=tuple(drawn))

    def draw_prior(self, rng: np.random.Generator) -> dict[str, float]:
        """Parameters drawn from the priors, within their ranges; those without a prior at their start."""
        low, high = self.bounds
        width = np.where(np.isfinite(self.prior_std), self.prior_std, 0.0)
        for _ in range(10_000):
            u = self.prior_mean + width * rng.standard_normal(len(self.free))
            if ((u >= low) & (u <= high)).all():
                return self.to_values(u)
        raise InputError("parameters", "have priors that lie outside their ranges", remedy="check the priors")

    def rho(self, squares: FloatArray) -> FloatArray:
        """Loss of squared residuals and its two derivatives, (3, n): the robust one for the data, none for priors."""
        rho = np.stack((squares, np.ones_like(squares), np.zeros_like(squares)))
        if self.loss == "gauss":
            return rho
        z = squares[: self.size] / _ROBUST**2
        if self.loss == "huber":
            root = np.sqrt(np.maximum(z, 1.0))
            rho[0, : self.size] = _ROBUST**2 * np.where(z > 1, 2 * root - 1, z)
            rho[1, : self.size] = 1 / root
            rho[2, : self.size] = np.where(z > 1, -0.5 * root**-3, 0.0) / _ROBUST**2
        else:
            rho[0, : self.size] = _ROBUST**2 * np.log1p(z)
            rho[1, : self.size] = 1 / (1 + z)
            rho[2, : self.size] = -((1 + z) ** -2) / _ROBUST**2
        return rho


def _within_jet(data: Observation, model: ForwardModel, free: Mapping[str, Prior]) -> None:
    """Refuse values beyond the jet; before the nozzle only as far as the origin is uncertain."""
    scale, origin = model.values["length_scale"], model.values["origin"]
    shift = free["origin"] if "origin" in free else Prior(origin, 0.0)
    stretch = free["length_scale"] if "length_scale" in free else Prior(scale, 0.0)
    centre = shift.value
    slack = 3 * (shift.std if np.isfinite(shift.std) else model.values["initial_radius"] * 10)
    slack += 3 * (stretch.std / stretch.value if np.isfinite(stretch.std) else 1.0) * model.length
    low, high = centre - slack, centre + stretch.value * model.length * (1 + 1e-9) + slack
    high = min(high, centre + stretch.value * model.reach)
    bad = (data.z < low) | (data.z > high)
    if bad.any():
        row = int(np.flatnonzero(bad)[0])
        more = f", and {int(bad.sum()) - 1} more" if bad.sum() > 1 else ""
        raise InputError(
            f"{data.source}: z",
            f"is beyond the jet at row {row + 1}{more}",
            value=float(data.z[row]),
            allowed=f"[{low:.4g}, {high:.4g}] m",
            remedy="raise jet.length in the scene, give origin, or leave rows out with z_range",
        )
