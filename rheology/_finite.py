"""What a law returns is a number: where a result is beyond what a double holds, an error that names it."""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec

import numpy as np

from spinline.base.checks import FloatArray, real

__all__ = ["finite_result"]

P = ParamSpec("P")


def finite_result(
    name: str, unit: str = "", *, positive: bool = False
) -> Callable[[Callable[P, FloatArray]], Callable[P, FloatArray]]:
    """Decorator of a law: refuse, by `name`, a result that overflows (or underflows to 0, where it is `positive`)."""

    def decorate(law: Callable[P, FloatArray]) -> Callable[P, FloatArray]:
        @wraps(law)
        def checked(*args: P.args, **kwargs: P.kwargs) -> FloatArray:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                value = law(*args, **kwargs)
            least = 0.0 if positive else None
            return real(name, value, above=least, unit=unit, remedy="the result is beyond what a double holds")

        return checked

    return decorate
