"""netCDF files in and out: one Dataset in memory, or one message; files whole, sealed, with a checksum on every variable.

Written into memory, so that a full disk is met by `spinline.base.files` and not by HDF5; read only after the seal
fits. HDF5 that points outside its file (external and virtual storage, external links), or that declares more than it can
hold, is refused before anything is read.
"""

import io
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.errors import InputError
from spinline.base.file_format import FORMAT, FORMAT_NAME, require_format
from spinline.base.files import readable, write_bytes
from spinline.base.netcdf_file import NetcdfFile, attribute
from spinline.base.seals import sealed, verified
from spinline.base.words import clean

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["examine_hdf5", "open_dataset", "save_dataset", "sizes_in", "write_variables"]

Variable = tuple[tuple[str, ...], Any, Mapping[str, Any]]  # dimensions, values, attributes

_MOST_PACKED = 1100  # deflate makes no more of a byte
_SPARE = 1 << 26


def open_dataset(path: str | Path) -> "xr.Dataset":
    """Read a netCDF file into memory.

    Raises
    ------
    InputError
        If it is damaged, cannot be read as netCDF-4, or reaches outside itself.
    """
    import h5py
    import xarray as xr

    file = readable(path)
    verified(file)
    try:
        with h5py.File(file, "r") as inside:
            examine_hdf5(inside, str(path))
        with xr.open_dataset(file, engine="h5netcdf", decode_times=False) as dataset:
            loaded = dataset.load()
    except InputError:
        raise
    except Exception as error:  # a library that reads bytes from anywhere may raise anything
        reason = clean(str(error).splitlines()[0]) if str(error) else type(error).__name__
        raise InputError(str(path), f"cannot be read as netCDF-4 ({reason})", remedy="give a .nc file") from None
    loaded.attrs = _harmless(loaded.attrs)
    require_format(str(path), loaded.attrs.pop(FORMAT_NAME, None))
    for variable in loaded.variables.values():
        variable.attrs = _harmless(variable.attrs)
    return loaded


def sizes_in(path: str | Path) -> dict[str, int]:
    """Dimensions of a netCDF file that this program has just written, without reading it."""
    import h5py

    with h5py.File(path, "r") as file:
        return {name: int(thing.shape[0]) for name, thing in file.items() if thing.is_scale}


def examine_hdf5(file: Any, name: str) -> None:
    """Refuse an open HDF5 file that points outside itself, or declares more than it can hold.

    Parameters
    ----------
    file : h5py.File
    name : str
        Shown in the error.

    Raises
    ------
    InputError
    """
    import h5py

    room = _SPARE + _MOST_PACKED * int(file.id.get_filesize())
    seen: set[Any] = set()

    def look(group: Any) -> None:
        nonlocal room
        for key in group:
            link = group.get(key, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise InputError(name, "has a link to another file", value=key, remedy="store the data in one file")
            if isinstance(link, h5py.SoftLink):  # of this file: met under its own name
                continue
            thing = group.get(key)
            if isinstance(thing, h5py.Dataset):
                if thing.external or thing.is_virtual:
                    raise InputError(name, "keeps data in another file", value=key, remedy="store the data in one file")
                room -= int(np.prod(thing.shape or (1,), dtype=object)) * max(1, int(thing.dtype.itemsize))
                if room < 0:
                    raise InputError(name, "declares more data than it can hold", value=key, remedy="make it again")
            elif isinstance(thing, h5py.Group) and thing.id not in seen:
                seen.add(thing.id)
                look(thing)

    look(file)


def save_dataset(dataset: "xr.Dataset", path: str | Path, *, force: bool = False) -> Path:
    """Write a Dataset as netCDF-4, whole or not at all, sealed, every variable with a checksum.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    variables: dict[str, Variable] = {
        str(name): (tuple(map(str, v.dims)), v.values, v.attrs) for name, v in dataset.variables.items()
    }
    return write_variables(variables, dataset.attrs, path, coordinates=map(str, dataset.coords), force=force)


def write_variables(
    variables: Mapping[str, Variable],
    attributes: Mapping[str, Any],
    path: str | Path,
    *,
    coordinates: Iterable[str] = (),
    force: bool = False,
) -> Path:
    """Write variables as netCDF-4; see `save_dataset`.

    Parameters
    ----------
    variables : mapping
        Name to dimensions, values (numbers, flags, text) and attributes.
    attributes : mapping
        Of the file.
    path : path
    coordinates : iterable of str
        Variables that are coordinates.
    force : bool
        Overwrite.
    """
    return write_bytes(path, sealed(_packed(variables, attributes, list(coordinates))), force=force)


def _packed(variables: Mapping[str, Variable], attributes: Mapping[str, Any], coordinates: list[str]) -> bytes:
    sizes: dict[str, int] = {}
    for dims, values, _ in variables.values():
        sizes |= dict(zip(dims, np.shape(values), strict=True))
    stream = io.BytesIO()
    with NetcdfFile(stream, sizes) as file:
        for name, (dims, values, described) in variables.items():
            array, more = _plain(np.asarray(values))
            along = [
                key for key in coordinates if key not in sizes and key != name and set(variables[key][0]) <= set(dims)
            ]
            if along and name not in coordinates:
                more["coordinates"] = " ".join(along)
            file.variable(name, dims, array.dtype, {**described, **more})
            file.write(name, array)
        file.attributes({**attributes, FORMAT_NAME: FORMAT})
    return stream.getvalue()


def _plain(array: "np.ndarray[Any, Any]") -> "tuple[np.ndarray[Any, Any], dict[str, Any]]":
    """Values as netCDF has them: flags as bytes, text as objects."""
    if array.dtype.kind == "b":
        return array.astype(np.int8), {"dtype": "bool"}
    if array.dtype.kind in "UO":
        return np.array([attribute(str(text)) for text in array.ravel()], dtype=object).reshape(array.shape), {}
    return array, {}


def _harmless(attributes: Mapping[Any, Any]) -> dict[Any, Any]:
    return {key: clean(value) if isinstance(value, str) else value for key, value in attributes.items()}
