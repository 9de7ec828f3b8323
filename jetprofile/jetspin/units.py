"""Gaussian CGS to SI, as JETSPIN needs it, and numbers as Fortran writes them."""

import math
import re
from collections.abc import Sequence
from contextlib import suppress
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["CM", "STATCOULOMB", "STATVOLT", "floats_of", "si_unit", "to_float", "to_floats"]

CM = 0.01
STATCOULOMB = 3.3356409519815204e-10  # C; 1/(10 c) with c in m/s
STATVOLT = 299.792458  # V

# factor and powers of (kg, m, s, C)
_BASE: dict[str, tuple[float, tuple[int, int, int, int]]] = {
    "g": (1e-3, (1, 0, 0, 0)),
    "cm": (CM, (0, 1, 0, 0)),
    "s": (1.0, (0, 0, 1, 0)),
    "statC": (STATCOULOMB, (0, 0, 0, 1)),
    "statV": (STATVOLT, (1, 2, -2, -1)),
    "dyne": (1e-5, (1, 1, -2, 0)),
    "dyn": (1e-5, (1, 1, -2, 0)),
    "°": (math.pi / 180, (0, 0, 0, 0)),
}
_NAMED = {
    (1, -1, -2, 0): "Pa",
    (1, -1, -1, 0): "Pa s",
    (1, 1, -2, 0): "N",
    (1, 0, -2, 0): "N m-1",
    (1, 2, -2, -1): "V",
    (0, 0, -1, 1): "A",
    (0, 0, 0, 0): "1",
}
_TOKEN = re.compile(r"([A-Za-z°]+)(?:\^?(-?\d+))?$")
_SHORT_EXPONENT = re.compile(r"([+-]?(?:\d+\.\d*|\.\d+|\d+))([+-]\d{1,4})$")


@lru_cache(maxsize=256)
def si_unit(text: str) -> tuple[float, str]:
    """Factor to SI and SI unit of a unit as JETSPIN prints it, e.g. ``g cm^-1 s^-2``.

    An unknown unit returns the factor 1 and the text itself.
    """
    factor, powers = 1.0, [0, 0, 0, 0]
    for token in text.split():
        match = _TOKEN.match(token)
        if match is None or match[1] not in _BASE:
            return 1.0, text
        power = int(match[2] or 1)
        if abs(power) > 9:
            return 1.0, text
        base, dims = _BASE[match[1]]
        factor *= base**power
        powers = [p + power * d for p, d in zip(powers, dims, strict=True)]
    if text.strip() == "°":
        return factor, "rad"
    named = _NAMED.get((powers[0], powers[1], powers[2], powers[3]))
    if named is not None:
        return factor, named
    names = zip(("kg", "m", "s", "C"), powers, strict=True)
    return factor, " ".join(name if p == 1 else f"{name}{p}" for name, p in names if p)


def to_float(text: str) -> float:
    """Read a number as Fortran writes or reads it; NaN where it is none.

    Knows ``1.d-7``, the three-digit exponent without its letter (``0.5520854571-127``), ``Infinity`` and
    fields of asterisks (NaN).
    """
    text = text.strip()
    if not text.isascii() or "_" in text:
        return math.nan
    if "d" not in text and "D" not in text:  # with one, neither of these is a number
        try:
            return float(text)
        except ValueError:
            pass
        match = _SHORT_EXPONENT.match(text)
        if match is not None:
            return float(f"{match[1]}e{match[2]}")
    if text[-1:] in ("d", "D", "e", "E"):
        text = text[:-1]
    try:
        return float(text.replace("D", "d").replace("d", "e", 1))
    except ValueError:
        return math.nan


def to_floats(texts: Sequence[str]) -> list[float]:
    """`to_float` of each; at once where all are plain."""
    together = "".join(texts)
    if together.isascii() and "_" not in together:
        with suppress(ValueError):
            return list(map(float, texts))
    return [to_float(text) for text in texts]


def floats_of(characters: NDArray[np.uint8]) -> NDArray[np.float64]:
    """`to_float` of every row of characters, which are plain ones without underscores."""
    words = np.ascontiguousarray(characters).view(f"S{characters.shape[1]}")[:, 0]
    try:
        return words.astype(np.float64)
    except ValueError:  # some are not written as in C
        return np.array([to_float(word.decode()) for word in words.tolist()], dtype=np.float64)
