"""A reduced X-ray map beside a scene's prediction: Figs. 36 and 37 of the review, and the likelihood.

* **Fig. 36**: polymer fraction of the core against r/r_0. In the affine theory it follows from V = (r_0/r)^2 alone, whatever
  k and beta are: the curve tests Eqs. (36)-(40) apart from the jet's kinematics. The crossover, Eq. (38), is marked.
* **Fig. 37**: relative change of the fraction across the jet, ``phi_p(r) / mean - 1``, at several z. The theory is a core of
  radius r_P in clear solvent, averaged over the same rings as the measurement.
* **Likelihood** of the scene given radius, mean and core of every row, normal errors, nothing fitted: two scenes may be
  compared by the difference. It takes the map's standard deviations at their word.

References
----------
Greenfeld, Fezzaa, Rafailovich, Zussman, Macromolecules 45, 3616 (2012); review Figs. 36, 37.
"""

import json
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError, SpinlineWarning
from spinline.fit.least_squares import log_likelihood
from spinline.fit.model import ForwardModel
from spinline.fit.observations import Kind, Observation
from spinline.fit.observed_map import read_map
from spinline.fit.scene_model import forward_model
from spinline.network.crossover import crossover_velocity_ratio, radius_ratio
from spinline.scene.file import Scene
from spinline.solve.bands import LEVELS, draw_scenes
from spinline.solve.spine import taken

__all__ = ["compare_theory", "theory_words"]

_KINDS: tuple[Kind, ...] = ("radius", "mean", "core")
_TREND = 3.0  # standard errors of a mean residual that are worth a word


def compare_theory(
    scene: Scene,
    reduced: "str | Path | xr.Dataset",
    *,
    core_within: float = 0.4,
    places: Sequence[float] | None = None,
    values: Mapping[str, float] | None = None,
    draws: Sequence[Mapping[str, float]] = (),
) -> xr.Dataset:
    """Compare a reduced map with a scene.

    Parameters
    ----------
    scene : Scene
        Power-law or hyperbolic jet; relaxation and evaporation as `spinline.run` would have them.
    reduced : path or xarray.Dataset
        See `spinline.fit.observed_map.read_map`.
    core_within : float
        Rings within this r/R make the core, in (0, 1].
    places : sequence of float, optional
        z of the sections of Fig. 37, m; default four, evenly over the rows.
    values : mapping, optional
        Parameters in place of the scene's (SI), ``fraction_scale`` from a fit for example.
    draws : sequence of mapping, optional
        Draws of the same parameters, for bands; without them those of the scene's inputs that carry ``+/-``.

    Returns
    -------
    xarray.Dataset
        Along ``kind``: ``log_likelihood``, ``chi_squared``, ``count``, ``mean_residual`` (in standard errors). Along ``row``:
        measured and predicted core. Along ``curve``: theory of Fig. 36. Along ``place`` and ``shell``: Fig. 37. ``_band``:
        2.5, 16, 50, 84 and 97.5 % of the theory over the draws, along ``quantile``.

    Warns
    -----
    SpinlineWarning
        Where the theory does not describe the data.
    """
    model = forward_model(scene, values=values)
    data = read_map(reduced, _KINDS, core_within=core_within)
    for part in data:
        if (part.z > model.length * (1 + 1e-9) + model.values["origin"]).any():
            raise InputError(
                f"{part.source}: z",
                "is beyond the jet",
                value=float(part.z.max()),
                allowed=f"up to {model.length:g} m",
                remedy="raise jet.length in the scene",
            )
    models = _drawn(model, values, draws)
    rows, notes = _judge(model, data)
    radius, _, core = data
    both, i, j = np.intersect1d(radius.z, core.z, return_indices=True)
    if not both.size:
        raise InputError(core.source, "has no row with both a radius and a core fraction")
    r0 = model.values["initial_radius"]
    unit = r0 * model.values["length_scale"]
    phi = model.values["volume_fraction"]
    seen = model.measured([radius, core])
    crossing = float(radius_ratio(crossover_velocity_ratio(phi, model.solvent_quality)))
    curve = np.geomspace(1.0, min(float(radius.value.min()) / r0, 0.9 * crossing), 201)
    reach = float(core.outer[0]) if core.outer is not None else 0.0
    data_vars: dict[str, Any] = rows | {
        "row_z": ("row", both, {"units": "m", "long_name": "distance from the nozzle, as measured"}),
        "radius_ratio": ("row", radius.value[i] / unit, {"units": "1", "long_name": "measured r/r_0"}),
        "radius_ratio_std": ("row", radius.std[i] / unit, {"units": "1"}),
        "core_measured": ("row", core.value[j], {"units": "1", "long_name": "measured polymer fraction of the core"}),
        "core_measured_std": ("row", core.std[j], {"units": "1"}),
        "core_predicted": ("row", seen[1][j], {"units": "1", "long_name": "predicted, at z"}),
        "radius_ratio_predicted": ("row", seen[0][i] / unit, {"units": "1"}),
        "curve_radius_ratio": ("curve", curve, {"units": "1", "long_name": "r/r_0"}),
        "curve_local": (
            "curve",
            _theory(model, curve, 0.0),
            {"units": "1", "long_name": "the same, of the network itself"},
        ),
        "curve_core": (
            "curve",
            _theory(model, curve, reach),
            {"units": "1", "long_name": "core, Eq. (40), V = (r_0/r)^2"},
        ),
    }
    data_vars |= _sections(model, reduced, places, radius, r0, models)
    if models:
        data_vars |= _bands(models, radius, core, j, curve, reach)
    attributes = {
        "title": f"{scene.title or scene.name}: measured and predicted",
        "scene": scene.text,
        "core_within": core_within,
        "effects_left_out": ", ".join(model.base.effects.left_out),
        "log_likelihood": float(np.sum(rows["log_likelihood"][1])),
        "crossover_radius_ratio": crossing,
        "volume_fraction": phi,
        "fraction_scale": model.values["fraction_scale"],
        "values": json.dumps(dict(values or {})),
        "bands": _of_what(models, draws),
        "warnings": "\n".join(notes),
        "references": "Greenfeld et al., Macromolecules 45, 3616 (2012); review Figs. 36, 37",
    }
    for note in notes:
        warnings.warn(note, SpinlineWarning, stacklevel=2)
    coordinates: dict[str, Any] = {"kind": list(_KINDS)} | ({"quantile": list(LEVELS)} if models else {})
    return xr.Dataset(data_vars, coordinates, attributes)


def theory_words(result: xr.Dataset) -> list[str]:
    """The comparison in lines."""
    lines = []
    for i, kind in enumerate(result["kind"].values.tolist()):
        one = result.isel(kind=i)
        lines.append(
            f"{kind:7s} chi-squared {float(one['chi_squared']):.4g} for {int(one['count'])} rows, measured minus predicted "
            f"{float(one['mean_residual']):+.2g} standard errors on average"
        )
    lines.append(
        f"log-likelihood {result.attrs['log_likelihood']:.6g}; crossover at r/r0 = {result.attrs['crossover_radius_ratio']:.4g}"
    )
    return lines


def _theory(model: ForwardModel, ratio: FloatArray, reach: float) -> FloatArray:
    """Core fraction as measured over r/R < reach, against r/r_0, affine."""
    phi, core = model.values["volume_fraction"], model.core_at(ratio**-2.0)
    inside = np.minimum(phi / core / reach**2, 1.0) if reach > 0 else 1.0
    value: FloatArray = model.values["fraction_scale"] * core * inside + model.values["fraction_offset"]
    return value


def _judge(model: ForwardModel, data: Sequence[Observation]) -> tuple[dict[str, Any], list[str]]:
    from scipy.stats import chi2

    shown = model.measured(data)
    notes = [note for part in data for note in part.notes]
    columns: dict[str, list[float]] = {"log_likelihood": [], "chi_squared": [], "count": [], "mean_residual": []}
    for part, y in zip(data, shown, strict=True):
        r = part.whiten(part.value - y)
        total, mean = float(r @ r), float(r.sum() / np.sqrt(r.size))
        columns["log_likelihood"].append(log_likelihood(model, [part]))
        columns["chi_squared"].append(total)
        columns["count"].append(part.size)
        columns["mean_residual"].append(mean)
        chance = float(chi2.sf(total, part.size))
        if chance < 0.003:
            notes.append(
                f"{part.kind}: the scene does not describe the map (chi-squared {total:.4g} for {part.size}, p = {chance:.2g})"
            )
        if abs(mean) > _TREND:
            side = "above" if mean > 0 else "below"
            notes.append(f"{part.kind}: measured lies {side} predicted, by {abs(mean):.1f} standard errors on average")
    words = {
        "log_likelihood": "logarithm of the likelihood",
        "chi_squared": "chi-squared, nothing fitted",
        "count": "rows",
        "mean_residual": "mean residual over its standard error",
    }
    return {name: ("kind", column, {"long_name": words[name]}) for name, column in columns.items()}, notes


def _sections(
    model: ForwardModel,
    reduced: "str | Path | xr.Dataset",
    places: Sequence[float] | None,
    radius: Observation,
    r0: float,
    models: "Sequence[ForwardModel]",
) -> dict[str, Any]:
    """Relative change across the jet at several z: rows within a twentieth of the length, weighted."""
    (rings,) = read_map(reduced, ("shell",))
    assert rings.inner is not None
    assert rings.outer is not None
    count = int(np.unique(rings.inner).size)
    z = rings.z.reshape(-1, count)[:, 0]
    inner, outer = rings.inner[:count], rings.outer[:count]
    if places is None:
        chosen = np.linspace(z.min(), z.max(), min(4, z.size))
    else:
        chosen = np.atleast_1d(real("places", np.asarray(places), least=float(z.min()), most=float(z.max()), unit="m"))
    half = 0.025 * float(np.ptp(z))
    area = outer**2 - inner**2
    values, spreads, theory, at, size = [], [], [], [], []
    predicted = model.measured([rings])[0].reshape(-1, count)
    drawn = np.array([one.measured([rings])[0].reshape(-1, count) for one in models])
    drawn_theory = []
    measured, std = rings.value.reshape(-1, count), rings.std.reshape(-1, count)
    for place in chosen:
        near = np.abs(z - place) <= half
        near[int(np.argmin(np.abs(z - place)))] = True
        weight = std[near] ** -2.0
        profile = (weight * measured[near]).sum(axis=0) / weight.sum(axis=0)
        error = weight.sum(axis=0) ** -0.5
        mean = float(profile @ area / area.sum())
        if mean <= 0:
            profile, error, mean = np.full(count, np.nan), np.full(count, np.nan), 1.0
        expected = predicted[near].mean(axis=0)
        values.append(profile / mean - 1)
        spreads.append(error / mean)
        theory.append(expected / float(expected @ area / area.sum()) - 1)
        if models:
            ones = drawn[:, near].mean(axis=1)
            drawn_theory.append(ones / (ones @ area / area.sum())[:, np.newaxis] - 1)
        at.append(float(z[near].mean()))
        size.append(float(np.interp(at[-1], radius.z, radius.value)) / (r0 * model.values["length_scale"]))
    centre = 0.5 * (inner + outer)
    bands: dict[str, Any] = {}
    if models:
        rows = np.quantile(np.array(drawn_theory), LEVELS, axis=1)
        bands["relative_change_band"] = (("quantile", "place", "shell"), rows, {"units": "1"})
    return bands | {
        "place_z": ("place", at, {"units": "m", "long_name": "mean z of the rows of a section"}),
        "place_radius_ratio": ("place", size, {"units": "1", "long_name": "r/r_0 of the jet there"}),
        "shell_centre": ("shell", centre, {"units": "1", "long_name": "r/R at the centre of a ring"}),
        "shell_inner": ("shell", inner, {"units": "1"}),
        "shell_outer": ("shell", outer, {"units": "1"}),
        "relative_change": (("place", "shell"), values, {"units": "1", "long_name": "measured over its mean, minus 1"}),
        "relative_change_std": (("place", "shell"), spreads, {"units": "1"}),
        "relative_change_predicted": (("place", "shell"), theory, {"units": "1", "long_name": "predicted, same rings"}),
    }


def _drawn(
    model: ForwardModel, values: Mapping[str, float] | None, draws: Sequence[Mapping[str, float]]
) -> list[ForwardModel]:
    """Models of the draws; of the scene's uncertain inputs where none are given, by the same rung and effects."""
    if draws:
        return [replace(model, values={**model.values, **draw}) for draw in draws]
    found = []
    for drawn in draw_scenes(taken(model.base)):
        try:
            found.append(forward_model(drawn, values=values))
        except InputError:
            continue
    return found


def _bands(
    models: Sequence[ForwardModel], radius: Observation, core: Observation, rows: Any, curve: FloatArray, reach: float
) -> dict[str, Any]:
    """Quantiles of the theory of Fig. 36 over the draws."""
    found: dict[str, list[Any]] = {"core_predicted": [], "curve_core": [], "curve_local": [], "crossover": []}
    for one in models:
        found["core_predicted"].append(one.measured([radius, core])[1][rows])
        found["curve_core"].append(_theory(one, curve, reach))
        found["curve_local"].append(_theory(one, curve, 0.0))
        phi = one.values["volume_fraction"]
        found["crossover"].append(float(radius_ratio(crossover_velocity_ratio(phi, one.solvent_quality))))
    along = {"core_predicted": ("row",), "curve_core": ("curve",), "curve_local": ("curve",), "crossover": ()}
    names = {"crossover": "crossover_radius_ratio_band"}
    return {
        names.get(name, f"{name}_band"): (
            ("quantile", *along[name]),
            np.quantile(np.array(values), LEVELS, axis=0),
            {"units": "1"},
        )
        for name, values in found.items()
    }


def _of_what(models: Sequence[ForwardModel], draws: Sequence[Any]) -> str:
    if not models:
        return "none: no input carries an uncertainty, no fit is given"
    return f"68 and 95 % of {len(models)} draws of " + ("the fit" if draws else "the scene's uncertain inputs")
