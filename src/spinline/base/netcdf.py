"""netCDF files in: one Dataset in memory, or one message."""

from pathlib import Path

import xarray as xr

from spinline.base.errors import InputError

__all__ = ["open_dataset"]


def open_dataset(path: str | Path) -> xr.Dataset:
    """Read a netCDF file into memory.

    Raises
    ------
    InputError
        If it cannot be read as netCDF-4.
    """
    if not Path(path).is_file():
        raise InputError(str(path), "is not a file", remedy="check the path")
    try:
        with xr.open_dataset(path, engine="h5netcdf") as dataset:
            return dataset.load()
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(str(path), f"cannot be read as netCDF-4 ({reason})", remedy="give a .nc file") from None
