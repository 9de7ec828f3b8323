"""A fit as a Dataset, as JSON and in sentences."""

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from spinline.base.errors import InputError
from spinline.base.units import QUANTITIES
from spinline.fit.diagnostics import compare_with_prior, curvature, open_directions, open_parameters, residual_checks
from spinline.fit.model import PARAMETERS
from spinline.fit.posterior import bands, gaussian_draws, predictive
from spinline.solve.results import plain

if TYPE_CHECKING:
    from spinline.fit.fit_file import FitFile
    from spinline.fit.fitted import Fit
    from spinline.fit.posterior import Posterior

__all__ = ["fit_dataset", "fit_json", "fit_words", "handy"]

_FROM = {"least-squares": "", "emcee": "sampled_"}


def fit_dataset(fit: "Fit", posterior: "Posterior | None" = None, *, source: "FitFile | None" = None) -> xr.Dataset:
    """Everything a fit found.

    Parameters
    ----------
    fit : Fit
    posterior : Posterior, optional
        Adds ``sampled_`` medians and intervals, and the draws; the bands are then made from them.
    source : FitFile, optional
        Its text, and its scene's, go into the attributes.

    Returns
    -------
    xarray.Dataset
        Along ``parameter``: ``best``, ``std``, ``low68`` ... ``high95``, priors; NaN where neither data nor prior identify it.
        ``covariance(parameter, other)`` of the coordinates; the data with prediction and residual along ``datum``;
        bands along ``z`` (see `spinline.fit.posterior.bands`).
    """
    problem, names = fit.problem, list(fit.problem.free)
    lost = open_parameters(fit)
    known = np.array([name not in lost for name in names])

    def column(values: dict[str, float]) -> Any:
        return np.where(known, [values[name] for name in names], np.nan)

    data: dict[str, Any] = {
        "best": ("parameter", column(fit.values), {"long_name": "best value, SI"}),
        "std": ("parameter", column(fit.std), {"long_name": "standard deviation to first order, SI"}),
        "identified": ("parameter", known, {"long_name": "determined by data or prior"}),
        "parameter_unit": ("parameter", [QUANTITIES[PARAMETERS[name].kind].unit or "1" for name in names]),
        "logarithmic": ("parameter", [PARAMETERS[name].log for name in names], {"long_name": "fitted as a logarithm"}),
        "coordinate_scale": ("parameter", problem.scale, {"long_name": "unit of the coordinate"}),
        "prior_value": ("parameter", [p.value for p in problem.free.values()], {"long_name": "prior or start, SI"}),
        "prior_std": ("parameter", [p.std for p in problem.free.values()], {"long_name": "inf: no prior, SI"}),
        "covariance": (("parameter", "other"), fit.covariance, {"long_name": "covariance of the coordinates"}),
        "correlation": (("parameter", "other"), fit.correlation, {"long_name": "correlation of the coordinates"}),
        "curvature": ("parameter", list(curvature(fit).values()), {"long_name": "1 where the posterior is Gaussian"}),
    }
    for percent, interval in ((68, fit.interval68), (95, fit.interval95)):
        for side, word in enumerate(("low", "high")):
            ends = {name: interval[name][side] for name in names}
            data[f"{word}{percent}"] = (
                "parameter",
                column(ends),
                {"long_name": f"{word} end of the {percent} % interval, SI"},
            )
    shares = compare_with_prior(fit)
    for key, words in (
        ("pull", "from the prior, in prior standard deviations"),
        ("shrinkage", "share of the prior's variance that the data took away"),
    ):
        data[f"prior_{key}"] = (
            "parameter",
            [shares.get(name, {}).get(key, np.nan) for name in names],
            {"long_name": words},
        )
    data |= _data(fit)
    if posterior is not None:
        data |= _sampled(fit, posterior)
    result = xr.Dataset(data, {"parameter": names, "other": names}, _attributes(fit, posterior, source))
    draws = _draws(fit, posterior)
    if draws is None:
        result.attrs["bands"] = "none: parameters are not identified"
        return result
    found = bands(fit, draws)
    words = "of the prediction at the data, as measured, SI: quantiles"
    for name, rows, noise in zip(
        ("datum_band", "datum_predictive"), predictive(fit, draws), ("without", "with"), strict=True
    ):
        found[name] = (("quantile", "datum"), rows, {"long_name": f"{words}, {noise} the noise of a new measurement"})
    result.attrs["bands"] = f"credible bands of {found.attrs['draws']} draws; without the noise of a measurement"
    return result.merge(found, combine_attrs="override")


def fit_json(result: xr.Dataset) -> str:
    """JSON of a fit: parameters by name, checks, data left out; NaN and inf as null."""
    per = [str(n) for n in result.data_vars if result[n].dims == ("parameter",)]
    names = result["parameter"].values.tolist()
    found: dict[str, Any] = {
        "title": result.attrs["title"],
        "parameters": {n: {key: plain(result[key].values[i]) for key in per} for i, n in enumerate(names)},
        "correlation": plain(result["correlation"].values),
        "checks": json.loads(result.attrs["checks"]),
        "warnings": [line for line in result.attrs["warnings"].split("\n") if line],
    }
    keep = ("chi_squared", "degrees_of_freedom", "loss", "sampler", "seed", "evaluations", "spinline_version")
    found |= {key: plain(result.attrs[key]) for key in keep}
    return json.dumps(found, allow_nan=False, ensure_ascii=False, indent=1)


def fit_words(result: xr.Dataset) -> list[str]:
    """A fit in lines: each parameter with its interval, then whether it fits."""
    lines = []
    for i, name in enumerate(result["parameter"].values.tolist()):
        one = result.isel(parameter=i)
        if not bool(one["identified"]):
            lines.append(f"{name:16s} not identified")
            continue
        head = _FROM[result.attrs["sampler"]]
        best = float(one["sampled_median" if head else "best"])
        ends = [float(one[f"{head}{word}{percent}"]) for percent in (68, 95) for word in ("low", "high")]
        unit, factor = handy(name, best)
        text = [f"{factor * x:.4g}" for x in (best, *ends)]
        value = f"{text[0]} {unit}".strip()
        line = f"{name:16s} {value:12s} 68 %: {text[1]} to {text[2]}   95 %: {text[3]} to {text[4]}"
        pull = float(one["prior_pull"])
        if np.isfinite(pull):
            line += f"   prior {pull:+.1f} sd, narrowed {100 * float(one['prior_shrinkage']):.0f} %"
        lines.append(line)
    lines += _crossover_words(result)
    checks = json.loads(result.attrs["checks"])
    lines.append(
        f"chi-squared {result.attrs['chi_squared']:.4g} for {result.attrs['values']} values and "
        f"{len(result['parameter'])} parameters (p = {_number(checks['p_value'])})"
    )
    return lines


def _crossover_words(result: xr.Dataset) -> list[str]:
    """Where the fitted jet is fully stretched, with intervals."""
    if "crossover_position" not in result:
        return []
    reached = float(result["crossover_reached"])
    if not reached:
        return ["crossover        not reached within the jet"]
    lines = []
    for name, unit, factor in (("crossover_position", "mm", 1e3), ("crossover_radius", "um", 1e6)):
        low95, low68, middle, high68, high95 = factor * result[name].values
        lines.append(
            f"{name.replace('_', ' '):18s} {_end(middle)} {unit}   68 %: {_end(low68)} to {_end(high68)}   "
            f"95 %: {_end(low95)} to {_end(high95)}"
            + ("" if reached == 1 else f"   in {100 * reached:.3g} % of the draws")
        )
    return lines


def _end(value: float) -> str:
    return f"{value:.4g}" if np.isfinite(value) else "beyond the end"


_HANDY = {
    "flow rate": ("mL/h", 3.6e9),
    "viscosity": ("Pa s", 1.0),
    "conductivity": ("S/m", 1.0),
    "surface tension": ("mN/m", 1e3),
    "potential": ("kV", 1e-3),
    "current": ("nA", 1e9),
}


def handy(name: str, value: float) -> tuple[str, float]:
    """Unit and factor that print well."""
    kind = PARAMETERS[name].kind
    if kind == "length":
        return ("um", 1e6)
    if kind == "time":
        return ("ms", 1e3) if value < 1 else ("s", 1.0)
    return _HANDY.get(kind, ("", 1.0))


def _number(value: float | None) -> str:
    return "not known" if value is None else f"{value:.2g}"


def _draws(fit: "Fit", posterior: "Posterior | None") -> Any:
    if posterior is not None:
        return posterior.draws
    if open_parameters(fit):
        return None
    try:
        return gaussian_draws(fit)
    except InputError:
        return None


def _data(fit: "Fit") -> dict[str, Any]:
    parts = fit.problem.data
    shown = fit.problem.model.measured(parts, fit.values)
    joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in ("z", "value", "std")}
    return {
        "datum_z": ("datum", joined["z"], {"units": "m", "long_name": "distance as measured"}),
        "datum_value": ("datum", joined["value"], {"long_name": "measured value, SI"}),
        "datum_std": ("datum", joined["std"], {"long_name": "its standard deviation, SI"}),
        "datum_predicted": ("datum", np.concatenate(shown), {"long_name": "prediction at the best parameters, SI"}),
        "datum_residual": ("datum", fit.residuals, {"long_name": "measured minus predicted, whitened"}),
        "datum_kind": ("datum", [part.kind for part in parts for _ in range(part.size)]),
        "datum_source": ("datum", [part.source for part in parts for _ in range(part.size)]),
    }


def _sampled(fit: "Fit", posterior: "Posterior") -> dict[str, Any]:
    problem = fit.problem
    columns = posterior.draws * problem.scale
    logs = [PARAMETERS[name].log for name in problem.free]
    columns = np.where(logs, np.exp(np.where(logs, columns, 0.0)), columns)
    data: dict[str, Any] = {
        "sampled_median": ("parameter", np.median(columns, axis=0), {"long_name": "median of the draws, SI"}),
        "autocorrelation": ("parameter", posterior.autocorrelation, {"long_name": "steps"}),
        "draws": (
            ("draw", "parameter"),
            columns[:: max(1, len(columns) // 5000)],
            {"long_name": "posterior draws, SI"},
        ),
    }
    for percent in (68, 95):
        for word, share in (("low", 0.5 - percent / 200), ("high", 0.5 + percent / 200)):
            values = np.quantile(columns, share, axis=0)
            data[f"sampled_{word}{percent}"] = (
                "parameter",
                values,
                {"long_name": f"of the draws' {percent} % interval, SI"},
            )
    return data


def _attributes(fit: "Fit", posterior: "Posterior | None", source: "FitFile | None") -> dict[str, Any]:
    from scipy.stats import chi2

    from spinline.base.version import __version__

    problem = fit.problem
    pull = (fit.coordinates - problem.prior_mean) / problem.prior_std
    total = fit.chi_squared + float(pull @ pull)
    dof = fit.degrees_of_freedom
    checks: dict[str, Any] = {
        "p_value": float(chi2.sf(total, dof)) if dof > 0 and problem.loss == "gauss" else None,
        "not_identified": open_parameters(fit),
        "open_directions": [plain_items(direction.__dict__) for direction in open_directions(fit)],
        "residuals": [plain_items(part.__dict__) for part in residual_checks(fit)],
    }
    notes = list(fit.notes)
    attributes: dict[str, Any] = {
        "title": problem.title,
        "source": f"spinline {__version__}",
        "spinline_version": __version__,
        "model": problem.model.model,
        "evaporation": int(problem.model.drying is not None),
        "profile": problem.model.profile,
        "fixed": json.dumps({n: problem.model.values[n] for n in problem.model.names if n not in problem.free}),
        "chi_squared": fit.chi_squared,
        "values": problem.size,
        "degrees_of_freedom": dof,
        "loss": problem.loss,
        "evaluations": fit.evaluations,
        "sampler": "least-squares" if posterior is None else "emcee",
        "seed": 0,
        "references": "Greenfeld et al., Phys. Rev. E 84, 041806 (2011); Eqs. (31), (36)-(40), (43a)-(45) of the review",
    }
    if posterior is not None:
        notes += posterior.notes
        checks["sampler"] = plain_items({k: v for k, v in posterior.__dict__.items() if k not in ("draws", "notes")})
        attributes["seed"] = posterior.seed
    if source is not None:
        attributes |= {"fit": source.text, "scene": source.scene.text, "seed": source.seed}
    return attributes | {"checks": json.dumps(checks, allow_nan=False), "warnings": "\n".join(notes)}


def plain_items(items: dict[str, Any]) -> dict[str, Any]:
    """A dictionary ready for JSON."""
    return {key: plain_items(v) if isinstance(v, dict) else plain(v) for key, v in items.items()}
