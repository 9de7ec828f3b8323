"""Frames that are over their flat already: transmissions, or absorbances, their negative logarithms."""

from dataclasses import replace

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import Array
from spinline.images.stacks import Stack

__all__ = ["as_transmission"]

_MOST = 200.0  # of a transmission in percent, noise and a bright beam included
_DEEPEST = 46.0  # 1e20 photons would leave one
_FILL = 700.0  # beyond, the exponential of a float overflows: fill values
_MARKS = (-1.0, -2.0)  # no noise hits them exactly


def as_transmission(stack: Stack) -> Stack:
    """A stack of transmissions or absorbances (by its key) as transmissions; what marks a pixel as invalid as NaN.

    Raises
    ------
    InputError
        For a first frame whose numbers can be neither.
    """
    raw = np.asarray(stack.read(0, 1), dtype=np.float64)
    usual = raw[np.isfinite(raw) & (np.abs(raw) < _FILL)] if stack.key == "absorbance" else raw[np.isfinite(raw)]
    high = float(np.quantile(usual if usual.size else raw[np.isfinite(raw)], 0.95)) if np.isfinite(raw).any() else 0.0
    most = _DEEPEST if stack.key == "absorbance" else _MOST
    if high > most or (not usual.size and np.isfinite(raw).any()):
        raise InputError(
            stack.key,
            f"holds no {stack.key}s: a twentieth of its numbers are over {most:g}",
            value=high,
            allowed="ln(I0/I), about 0 in air"
            if stack.key == "absorbance"
            else "I/I0, about 1 in air (100 in percent)",
            remedy="name raw frames counts, with their flat and dark",
        )
    return replace(stack, turned=_transmission) if stack.key == "absorbance" else stack


def _transmission(block: Array) -> Array:
    """Transmissions of absorbances; an infinite one is no light."""
    absorbed = np.asarray(block, dtype=np.float64)
    fill = ((np.abs(absorbed) > _FILL) & np.isfinite(absorbed)) | np.isin(absorbed, _MARKS) | (absorbed == -np.inf)
    return np.where(fill, np.nan, np.exp(-np.where(fill, 0.0, absorbed)))
