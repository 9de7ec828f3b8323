"""A netCDF-4 file being written, straight on HDF5: dimensions, variables along them, attributes; every variable checksummed.

netCDF-4 is HDF5 with named axes ("NetCDF-4 File Format Specification", Unidata): a dimension is a dimension scale, that of
the variable of its name or of nothing; a variable has the scales of its dimensions attached. A general library asks the file
anew at every step, some 5 ms a variable; here each thing is written once. Signals wait for HDF5, which crashes where its
file raises.
"""

from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from typing import Any

import numpy as np

from spinline.base.held_signals import signals_held
from spinline.base.version import __version__

__all__ = ["OLD_READERS", "NetcdfFile", "attribute"]

OLD_READERS = ("v110", "v110")  # readable by every HDF5 since 2016; its metadata carry checksums of their own
_NO_VARIABLE = b"This is a netCDF dimension but not a netCDF variable.%10d"
_CHUNK = 1 << 20  # bytes: what HDF5 keeps while a chunk is filled in parts
_IN_ORDER = 3  # of creation, tracked and indexed, as netCDF-4 asks of variables


class NetcdfFile:
    """A new file, for a ``with``.

    Parameters
    ----------
    stream : binary file
        Any object with read, write, seek, tell, truncate and flush.
    sizes : mapping
        Dimensions, each with its present length.
    grows : iterable of str
        Those that `resize` may lengthen.
    """

    def __init__(self, stream: Any, sizes: Mapping[str, int], grows: Iterable[str] = ()) -> None:
        import h5py

        self._h5 = h5py
        self.sizes = dict(sizes)
        self._grows = frozenset(grows)
        self._made: dict[str, Any] = {}
        self._along: dict[str, tuple[str, ...]] = {}
        self._text = h5py.h5t.py_create(h5py.string_dtype(), logical=True)
        self._scalar = h5py.h5s.create(h5py.h5s.SCALAR)
        with ExitStack() as opened:  # closed again where a signal has waited
            with signals_held():
                self._file = h5py.File(stream, "w", libver=OLD_READERS, track_order=True)
                opened.push(self)
                self._describe(self._file.id, "_NCProperties", np.bytes_(f"version=2,spinline={__version__}"))
            opened.pop_all()

    def __enter__(self) -> "NetcdfFile":
        return self

    @signals_held()
    def __exit__(self, kind: Any, *_: object) -> None:
        if kind is None:
            self._name_dimensions()
        self._made.clear()
        self._file.close()

    @signals_held()
    def variable(
        self,
        name: str,
        dims: tuple[str, ...],
        dtype: Any,
        attributes: Mapping[str, Any],
        *,
        fill: Any = None,
        chunks: tuple[int, ...] | None = None,
    ) -> None:
        """Declare a variable; `write` gives it values.

        Parameters
        ----------
        name : str
        dims : tuple of str
        dtype : dtype
            Of numbers, or object for text.
        attributes : mapping
        fill : number, optional
            What is read where nothing was written.
        chunks : tuple of int, optional
            Values that are stored together. Default: a megabyte.
        """
        kind = np.dtype(dtype)
        made = self._create(name, dims, self._text if kind.kind == "O" else kind, fill, chunks)
        self._along[name] = dims
        if fill is not None:
            self._describe(made, "_FillValue", np.array([fill], kind))
        for key, value in attributes.items():
            self._describe(made, key, attribute(value))

    @signals_held()
    def attributes(self, attributes: Mapping[str, Any]) -> None:
        """Attributes of the file."""
        for key, value in attributes.items():
            self._describe(self._file.id, key, attribute(value))

    @signals_held()
    def write(self, name: str, values: Any, at: int = 0) -> None:
        """Values of a variable, from `at` on along its first dimension."""
        array = np.ascontiguousarray(values) if np.ndim(values) else np.asarray(values)
        if not array.size:
            return
        made = self._made[name]
        there = made.get_space()
        if array.dtype.kind == "O":
            array = array.astype(self._h5.string_dtype())
        if array.ndim:
            there.select_hyperslab((at, *(0,) * (array.ndim - 1)), array.shape)
        made.write(self._h5.h5s.create_simple(array.shape) if array.ndim else self._scalar, there, array)

    @signals_held()
    def resize(self, **sizes: int) -> None:
        """Lengthen dimensions."""
        for dim, size in sizes.items():
            if size > self.sizes[dim]:
                self.sizes[dim] = size
        for name, dims in self._along.items():
            if any(dim in sizes for dim in dims):
                self._made[name].set_extent(tuple(self.sizes[dim] for dim in dims))

    def _create(
        self,
        name: str,
        dims: tuple[str, ...],
        kind: Any,
        fill: Any = None,
        chunks: tuple[int, ...] | None = None,
        *,
        checked: bool = True,
    ) -> Any:
        h5 = self._h5
        plist = h5.h5p.create(h5.h5p.DATASET_CREATE)
        plist.set_attr_creation_order(_IN_ORDER)
        plist.set_obj_track_times(False)  # the same numbers are the same bytes, whenever they are written
        shape = tuple(self.sizes[dim] for dim in dims)
        growing = any(dim in self._grows for dim in dims)
        number = isinstance(kind, np.dtype)
        if growing or (checked and number and dims and 0 not in shape):
            plist.set_chunk(chunks or _chunks(shape, kind.itemsize if number else 16))
            if number and checked:
                plist.set_fletcher32()
        if fill is not None:
            plist.set_fill_value(np.array(fill, kind))
        most = tuple(h5.h5s.UNLIMITED if dim in self._grows else self.sizes[dim] for dim in dims)
        space = h5.h5s.create_simple(shape, most) if dims else self._scalar
        stored = h5.h5t.py_create(kind, logical=True) if number else kind
        made = self._made[name] = h5.h5d.create(self._file.id, name.encode(), stored, space, plist)
        return made

    def _describe(self, thing: Any, name: str, value: Any) -> None:
        h5 = self._h5
        if isinstance(value, str):
            made = h5.h5a.create(thing, name.encode(), self._text, self._scalar)
            made.write(np.array(value, dtype=h5.string_dtype()))
            return
        array = np.asarray(value)
        if array.dtype.kind in "UO":
            array = array.astype(h5.string_dtype())
        kind = self._text if array.dtype.kind == "O" else h5.h5t.py_create(array.dtype, logical=True)
        space = h5.h5s.create_simple(array.shape) if array.ndim else self._scalar
        h5.h5a.create(thing, name.encode(), kind, space).write(array)

    def _name_dimensions(self) -> None:
        """Scales of all dimensions, attached to what lies along them; in the end, when every length is known."""
        scale = self._h5.h5ds
        for number, (dim, size) in enumerate(self.sizes.items()):
            if dim in self._along:
                scale.set_scale(self._made[dim], dim.encode())
            else:
                scale.set_scale(self._create(dim, (dim,), np.dtype(">f4"), checked=False), _NO_VARIABLE % size)
            self._describe(self._made[dim], "_Netcdf4Dimid", np.int32(number))
        numbers = {dim: number for number, dim in enumerate(self.sizes)}
        for name, dims in self._along.items():
            if name in self.sizes or not dims:
                continue
            self._describe(self._made[name], "_Netcdf4Coordinates", np.array([numbers[dim] for dim in dims], np.int32))
            for axis, dim in enumerate(dims):
                scale.attach_scale(self._made[name], self._made[dim], axis)


def attribute(value: Any) -> Any:
    """An attribute as netCDF has it: no NUL in text, flags as numbers, numbers in arrays of one."""
    if isinstance(value, str):
        return value.replace("\x00", "\\u0000").encode("utf-8", "backslashreplace").decode()
    if isinstance(value, bytes):
        return value
    return np.atleast_1d(np.asarray(int(value) if isinstance(value, bool | np.bool_) else value))


def _chunks(shape: tuple[int, ...], itemsize: int) -> tuple[int, ...]:
    """One chunk, or slabs along the first dimension of a megabyte."""
    row = max(1, itemsize * int(np.prod([max(1, size) for size in shape[1:]])))
    return (max(1, min(shape[0], _CHUNK // row)), *(max(1, size) for size in shape[1:]))
