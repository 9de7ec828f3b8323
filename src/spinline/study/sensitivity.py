"""Which input moves an output: Sobol' indices of a sweep whose design is ``sensitivity``.

First order S_i: the share of the output's variance that goes when input i is known. Total S_Ti: the share that stays while all
others are known; S_Ti - S_i is what i does together with others. Estimators of Saltelli et al. (2010), by
`scipy.stats.sobol_indices`, from the rows A, B and A with column i of B; intervals by resampling the N samples (percentiles,
seeded). An index can come out slightly below 0 or above 1: its interval says how much that means.

References
----------
Saltelli, Annoni, Azzini, Campolongo, Ratto, Tarantola, Comput. Phys. Commun. 181, 259 (2010).
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray, number
from spinline.base.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["OUTPUTS", "indices", "sobol"]

OUTPUTS = ("crossover_radius", "crossover_position", "crossover_core_polymer_fraction")
_CONSTANT = 1e-12  # relative spread below which an output does not vary


def sobol(
    result: "xr.Dataset", outputs: Sequence[str] = OUTPUTS, *, resamples: int = 400, confidence: float = 0.95
) -> "xr.Dataset":
    """Sobol' indices of a sweep's outputs.

    Parameters
    ----------
    result : xarray.Dataset
        Of `run_sweep` or `open_sweep`, design ``sensitivity``, complete.
    outputs : sequence of str
        Numbers of the sweep.
    resamples : int
        Of the samples, for the intervals.
    confidence : float
        In (0, 1).

    Returns
    -------
    xarray.Dataset
        ``first_order``, ``total_order`` and their ``_low`` and ``_high`` along `output` and `parameter`; `mean` and `std` of
        each output. NaN where an output does not vary: its variance has no shares.

    Raises
    ------
    InputError
        For another design, an incomplete sweep, or rows without the output.
    """
    import xarray as xr

    if result.attrs.get("design") != "sensitivity":
        raise InputError(
            "design",
            "has no Sobol' indices",
            value=result.attrs.get("design"),
            allowed='"sensitivity"',
            remedy='make the sweep with --sobol, or design.kind = "sensitivity"',
        )
    keys, n = str(result.attrs["keys"]).split(), int(result.attrs["samples"])
    d = len(keys)
    status = result["status"].values
    values = []
    for name in outputs:
        if name not in result or result[name].dims != ("scene",) or name in keys:
            known = [str(v) for v in result.data_vars if result[v].dtype == np.float64 and v not in keys]
            raise InputError(
                "outputs",
                "is not a number of this sweep",
                value=name,
                allowed=", ".join(known),
                remedy="take one of those",
            )
        column = np.asarray(result[name].values, dtype=np.float64)
        bad = ~np.isfinite(column)
        if bad.any():
            first = int(np.argmax(bad))
            reason = "it is not computed yet" if status[first] == 255 else str(result["reason"].values[first])
            raise InputError(
                name,
                f"is missing in {bad.sum()} of {bad.size} scenes: indices need it in all. First: {reason}",
                remedy="narrow the ranges, lengthen the jet, or take other outputs",
            )
        values.append(column.reshape(d + 2, n))
    table = np.stack(values)  # output, block, sample
    found = indices(
        table[:, 0],
        table[:, 1],
        np.moveaxis(table[:, 2:], 1, 0),
        resamples=resamples,
        confidence=confidence,
        seed=int(result.attrs["seed"]),
    )
    data = {name: (("output", "parameter"), array) for name, array in found.items()}
    both = table[:, :2].reshape(len(outputs), -1)
    return xr.Dataset(
        {**data, "mean": ("output", both.mean(axis=1)), "std": ("output", both.std(axis=1))},
        {"output": list(outputs), "parameter": keys},
        {"samples": n, "confidence": confidence, "resamples": resamples, "title": str(result.attrs.get("title", ""))},
    )


def indices(
    at_a: FloatArray,
    at_b: FloatArray,
    at_ab: FloatArray,
    *,
    resamples: int = 400,
    confidence: float = 0.95,
    seed: int = 0,
) -> dict[str, FloatArray]:
    """First-order and total indices with intervals.

    Parameters
    ----------
    at_a, at_b : ndarray, (outputs, n)
        Outputs at the samples A and B; n is a power of two.
    at_ab : ndarray, (parameters, outputs, n)
        Outputs at A with one column of B.
    resamples : int
        At least 2.
    confidence : float
        In (0, 1).
    seed : int
        Of the resampling.

    Returns
    -------
    dict of str to ndarray, (outputs, parameters)
        ``first_order``, ``total_order`` and their ``_low`` and ``_high``; NaN for an output that does not vary.
    """
    level = number("confidence", confidence, above=0.0, below=1.0)
    if resamples < 2:
        raise InputError("resamples", "is too small", value=resamples, allowed=">= 2")
    n, rng = at_a.shape[1], np.random.default_rng(seed)
    first, total = _estimate(at_a, at_b, at_ab)
    drawn = []
    for _ in range(resamples):
        pick = rng.integers(n, size=n)
        drawn.append(_estimate(at_a[:, pick], at_b[:, pick], at_ab[..., pick]))
    low, high = np.quantile(np.array(drawn), [0.5 - level / 2, 0.5 + level / 2], axis=0)
    result = {
        "first_order": first,
        "first_order_low": low[0],
        "first_order_high": high[0],
        "total_order": total,
        "total_order_low": low[1],
        "total_order_high": high[1],
    }
    spread, size = np.ptp(np.hstack((at_a, at_b)), axis=1), np.abs(at_a).max(axis=1)
    constant = (spread <= _CONSTANT * size)[:, np.newaxis]
    return {name: np.where(constant, np.nan, values) for name, values in result.items()}


def _estimate(at_a: FloatArray, at_b: FloatArray, at_ab: FloatArray) -> tuple[FloatArray, FloatArray]:
    from scipy.stats import sobol_indices

    d, outputs = at_ab.shape[0], at_a.shape[0]
    # copies: older versions of scipy take the mean out of what they are given
    func: Any = {"f_A": at_a.copy(), "f_B": at_b.copy(), "f_AB": at_ab.copy()}
    found = sobol_indices(func=func, n=at_a.shape[1])
    return np.reshape(found.first_order, (outputs, d)), np.reshape(found.total_order, (outputs, d))
