"""Range checks of numeric arguments: a clear error or a float64 array, never a clamp."""

import math
from collections.abc import Callable
from dataclasses import is_dataclass
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spinline.base.errors import InputError

__all__ = ["BoolArray", "FloatArray", "computable", "number", "positive", "real"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def real(
    field: str,
    value: ArrayLike,
    *,
    above: float | None = None,
    below: float | None = None,
    least: float | None = None,
    most: float | None = None,
    unit: str = "",
    remedy: str = "",
) -> FloatArray:
    """Convert to a float64 array and refuse what is not finite or out of range.

    Parameters
    ----------
    field : str
        Name shown in the error.
    value : array_like
        Real numbers of any shape and precision.
    above, below : float, optional
        Exclusive bounds.
    least, most : float, optional
        Inclusive bounds.
    unit, remedy : str, optional
        Shown in the error.

    Returns
    -------
    ndarray of float64, the shape of `value`.

    Raises
    ------
    InputError
        With the field, the first offending value, the range and the remedy.
    """
    if isinstance(value, float) and math.isfinite(value) and _inside(value, above, below, least, most):
        return np.array(value, dtype=np.float64)  # as many are, and at a sixth of the cost
    if type(value) is np.ndarray and value.dtype == np.float64 and value.size:
        low, high = float(np.minimum.reduce(value, axis=None)), float(np.maximum.reduce(value, axis=None))
        # high - low is not finite where one of the values is not
        if math.isfinite(high - low) and _inside(low, above, None, least) and _inside(high, None, below, None, most):
            return value.copy("K")
    try:
        raw = np.asarray(value)
        if raw.dtype.kind in "cbSUmM":  # "1" is text, not a number
            raise TypeError
        array = raw.astype(np.float64)
    except OverflowError:  # a whole number of hundreds of digits
        raise InputError(field, "is beyond what a double holds", remedy=remedy or "check its unit") from None
    except (TypeError, ValueError):
        raise InputError(field, "is not a real number", value=value, remedy=remedy) from None
    good = np.isfinite(array)
    if above is not None:
        good &= array > above
    if below is not None:
        good &= array < below
    if least is not None:
        good &= array >= least
    if most is not None:
        good &= array <= most
    if not good.all():
        first = float(array[~good].flat[0]) if array.ndim else float(array)
        problem = "is not finite" if not np.isfinite(first) else "is out of range"
        allowed = _interval(above, below, least, most)
        raise InputError(field, problem, value=first, allowed=f"{allowed} {unit}".strip(), remedy=remedy)
    return array


def number(field: str, value: Any, **bounds: Any) -> float:
    """Check one finite number, as `real` does arrays, and return it as a float."""
    if isinstance(value, float) and math.isfinite(value) and _inside(value, **bounds):
        return float(value)  # as most are: a row of an image checks fifteen of them
    array = real(field, value, **bounds)
    if array.ndim:
        raise InputError(field, "must be a single number", value=f"array of shape {array.shape}")
    return float(array)


def _inside(
    value: float,
    above: float | None = None,
    below: float | None = None,
    least: float | None = None,
    most: float | None = None,
    **_: str,
) -> bool:
    return (
        (above is None or value > above)
        and (below is None or value < below)
        and (least is None or value >= least)
        and (most is None or value <= most)
    )


P = ParamSpec("P")
T = TypeVar("T")


def computable(law: Callable[P, T]) -> Callable[P, T]:
    """Decorator of a law: where arguments in their range give numbers that no double holds, an `InputError`, no warning."""

    @wraps(law)
    def checked(*args: P.args, **kwargs: P.kwargs) -> T:
        try:
            with np.errstate(over="raise", divide="raise", invalid="raise"):
                value = law(*args, **kwargs)
            if _infinite(value):  # Python's own numbers overflow without a word
                raise OverflowError
        except (FloatingPointError, OverflowError, ZeroDivisionError, np.linalg.LinAlgError):
            raise InputError(
                law.__name__,
                "is beyond what a double holds for these arguments",
                remedy="check their units: one is far too small or too large",
            ) from None
        return value

    return checked


def _infinite(value: Any) -> bool:
    if isinstance(value, tuple):
        return any(map(_infinite, value))
    if is_dataclass(value):
        return any(map(_infinite, vars(value).values()))
    return isinstance(value, float | np.ndarray) and np.asarray(value).dtype.kind == "f" and bool(np.isinf(value).any())


def positive(field: str, value: Any, unit: str = "", remedy: str = "") -> float:
    """Check one finite number > 0 and return it as a float."""
    return number(field, value, above=0.0, unit=unit, remedy=remedy)


def _interval(above: float | None, below: float | None, least: float | None, most: float | None) -> str:
    low = f"[{least:g}" if least is not None else f"({above:g}" if above is not None else "(-inf"
    high = f"{most:g}]" if most is not None else f"{below:g})" if below is not None else "inf)"
    return f"{low}, {high}"
