"""Which settings of a window are drawn, and where the others are held."""

from collections.abc import Collection

import xarray as xr

from spinline.base.errors import InputError

__all__ = ["drawn_axes"]


def drawn_axes(window: xr.Dataset, names: Collection[str]) -> tuple[list[str], dict[str, int]]:
    """The first two of `names` that vary, and the middle index of every other one.

    Raises
    ------
    InputError
        Where none varies.
    """
    varied = [name for name in names if window.sizes[name] > 1]
    if not varied:
        raise InputError("window", "is one point: nothing to draw", remedy="give a range, voltage 5 kV .. 20 kV")
    shown = varied[:2]
    return shown, {name: window.sizes[name] // 2 for name in names if name not in shown}
