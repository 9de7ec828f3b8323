"""Named arrays with dimensions and attributes: a result before Python asks for a Dataset.

The command line computes, writes and words a result without xarray (0.3 s, with pandas and what it looks for). `NamedArrays`
answers the few questions that are asked there as a Dataset does; `dataset` makes one.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["NamedArray", "NamedArrays"]


class NamedArray(NDArrayOperatorsMixin):
    """Values along named dimensions; in arithmetic, its values.

    Attributes
    ----------
    dims : tuple of str
    values : ndarray
    attrs : dict
    """

    def __init__(self, dims: str | Iterable[str], values: Any, attrs: Mapping[str, Any] | None = None) -> None:
        self.dims = (dims,) if isinstance(dims, str) else tuple(dims)
        self.values = np.asarray(values)
        self.attrs = dict(attrs or {})
        if self.values.ndim != len(self.dims):
            raise ValueError(f"{self.values.ndim} dimensions, {len(self.dims)} names")

    @property
    def ndim(self) -> int:
        """Number of dimensions."""
        return len(self.dims)

    @property
    def dtype(self) -> "np.dtype[Any]":
        """Of the values."""
        return self.values.dtype

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> "np.ndarray[Any, Any]":
        return np.asarray(self.values, dtype=dtype)

    def __array_ufunc__(self, ufunc: Callable[..., Any], method: str, *inputs: Any, **options: Any) -> Any:
        plain = [one.values if isinstance(one, NamedArray) else one for one in inputs]
        return getattr(ufunc, method)(*plain, **options)

    def __float__(self) -> float:
        return float(self.values)

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, index: Any) -> Any:
        return self.values[index]


class NamedArrays:
    """Variables by name, some of them coordinates, and attributes of all.

    Parameters
    ----------
    data, coordinates : mapping
        Name to (dimensions, values, attributes), or to a `NamedArray`.
    attrs : mapping
    """

    def __init__(
        self,
        data: Mapping[str, Any],
        coordinates: Mapping[str, Any] | None = None,
        attrs: Mapping[str, Any] | None = None,
    ) -> None:
        given = {**(coordinates or {}), **data}
        self.variables = {name: one if isinstance(one, NamedArray) else NamedArray(*one) for name, one in given.items()}
        self.coords = list(coordinates or {})
        self.attrs = dict(attrs or {})

    @property
    def data_vars(self) -> dict[str, NamedArray]:
        """Variables that are no coordinates."""
        return {name: one for name, one in self.variables.items() if name not in self.coords}

    @property
    def sizes(self) -> dict[str, int]:
        """Length of every dimension."""
        sizes: dict[str, int] = {}
        for name, one in self.variables.items():
            for dim, size in zip(one.dims, one.values.shape, strict=True):
                if sizes.setdefault(dim, size) != size:
                    raise ValueError(f"conflicting sizes: {name} has {size} along {dim}, others have {sizes[dim]}")
        return sizes

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return tuple(self.sizes)

    def __contains__(self, name: object) -> bool:
        return name in self.variables

    def __getitem__(self, name: str) -> NamedArray:
        return self.variables[name]

    def isel(self, **places: Any) -> "NamedArrays":
        """Part of everything along some dimensions, by number or by array of numbers."""
        taken = {}
        for name, one in self.variables.items():
            values, dims = one.values, list(one.dims)
            for dim, place in places.items():
                if dim in dims:
                    values = np.take(values, place, axis=dims.index(dim))
                    if np.ndim(place) == 0:
                        dims.remove(dim)
            taken[name] = NamedArray(dims, values, one.attrs)
        return self._like(taken)

    def assign(self, new: Mapping[str, Any]) -> "NamedArrays":
        """With further variables."""
        return self._like({**self.variables, **new})

    def assign_coords(self, **new: Any) -> "NamedArrays":
        """With further coordinates, each along itself."""
        made = {name: NamedArray(name, values) for name, values in new.items()}
        return NamedArrays(self.data_vars, {**{name: self.variables[name] for name in self.coords}, **made}, self.attrs)

    def dataset(self) -> "xr.Dataset":
        """The same as a Dataset."""
        import xarray as xr

        plain = all(one.dtype.kind in "biuf" for one in self.variables.values())
        if plain and hasattr(xr.Dataset, "_construct_direct"):
            return self._dataset_of_numbers()
        tuples = {name: (one.dims, one.values, one.attrs) for name, one in self.variables.items()}
        coordinates = {name: tuples.pop(name) for name in self.coords}
        return xr.Dataset(tuples, coordinates, self.attrs)

    def _dataset_of_numbers(self) -> "xr.Dataset":
        """The same without looking for what is to be converted, aligned or merged: a quarter of the time."""
        import pandas as pd
        import xarray as xr
        from xarray.indexes import Index, PandasIndex

        made = {}
        for name, one in self.variables.items():
            made[name] = xr.Variable(one.dims, one.values, one.attrs, fastpath=True)
        indexes: dict[Any, Index] = {}
        for name in [name for name, one in self.variables.items() if one.dims == (name,)]:
            values = self.variables[name].values
            # as `from_variables` does it, which first makes two copies to name them
            indexes[name] = index = PandasIndex(pd.Index(values, name=name), name, values.dtype, fastpath=True)
            made[name] = index.create_variables({name: made[name]})[name]
        names = {*self.coords, *indexes}
        return xr.Dataset._construct_direct(made, names, self.sizes, dict(self.attrs), indexes)

    def _like(self, variables: Mapping[str, Any]) -> "NamedArrays":
        data = {name: one for name, one in variables.items() if name not in self.coords}
        return NamedArrays(data, {name: variables[name] for name in self.coords}, self.attrs)
