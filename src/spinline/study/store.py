"""Where the rows of a sweep go: memory, or one chunked zarr store that survives being killed.

Why zarr and not netCDF: a chunk is a file of its own, written beside and renamed, so that a kill at any moment leaves every
finished chunk readable and the rest absent; a netCDF-4 (HDF5) file that is cut off while it grows cannot be relied on to open.
Chunks are independent, so nothing is locked, and the store can be read while it grows, with xarray, in parts larger than
memory.

Order: a chunk's parameters, numbers, profiles and reasons first, its ``status`` last. A chunk is done when its status is
written; any other is computed again, to the same bits. Only the process that was called writes; workers compute.
"""

import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.errors import InputError
from spinline.base.files import writable
from spinline.scene.keys import unit_of
from spinline.solve.results import VARIABLES
from spinline.study.design import Column
from spinline.study.rows import PENDING, SCALARS, STD_FLAG, Block, Task
from spinline.study.sweep_file import Sweep

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Memory", "Store", "as_grid", "open_sweep"]

_MARK = "spinline_sweep"
_UNREADABLE = (OSError, ValueError, RuntimeError)  # a chunk that was cut off while it was written
_STATUS = "0 ok, 1 incomplete, 2 refused, 3 failed, 255 not computed"
_REASON = "why a row has no numbers, or not all"


class Memory:
    """Rows in memory."""

    def __init__(self, sweep: Sweep, task: Task, chunk: int, attributes: Mapping[str, Any]) -> None:
        self.sweep, self.task, self.chunk, self.attributes = sweep, task, chunk, dict(attributes)
        self._parts: dict[int, tuple[Mapping[str, Column], Block]] = {}

    def pending(self) -> list[int]:
        """Numbers of the chunks that are not done."""
        return [i for i in range(-(-self.sweep.design.size // self.chunk)) if i not in self._parts]

    def write(self, index: int, columns: Mapping[str, Column], block: Block) -> None:
        """Keep a chunk."""
        self._parts[index] = (columns, block)

    def dataset(self) -> "xr.Dataset":
        """All rows."""
        import xarray as xr

        parts = [self._parts[i] for i in sorted(self._parts)]
        data: dict[str, Any] = {}
        for name, (dims, attributes) in _layout(self.sweep, self.task).items():
            pieces = [_piece(name, *part) for part in parts]
            data[name] = (dims, pieces[0] if len(pieces) == 1 else np.concatenate(pieces), attributes)
        return xr.Dataset(data, attrs=self.attributes)


class Store:
    """Rows in a zarr store.

    Parameters
    ----------
    path : Path
        Folder of the store; made if it is not there, gone on with if it holds the same sweep.
    sweep : Sweep
    task : Task
    chunk : int
        Rows of a chunk; an existing store keeps its own.
    attributes : mapping
        Of the store.
    force : bool
        Start anew where there is a store.

    Raises
    ------
    InputError
        Where something else is at `path`, or nothing can be written there.
    """

    def __init__(
        self, path: Path, sweep: Sweep, task: Task, chunk: int, attributes: Mapping[str, Any], *, force: bool = False
    ) -> None:
        import zarr

        self.path, self.sweep, self.task = path, sweep, task
        present = peek(path)
        if force and present is not None:
            shutil.rmtree(path)
            present = None
        if present is None:
            if path.exists():
                raise InputError(str(path), "exists and is no sweep", remedy="choose another name")
            writable(path)
            self._create(zarr, chunk, attributes)
        elif present["fingerprint"] != attributes["fingerprint"]:
            raise InputError(str(path), "holds another sweep (or one of another version)",
                             remedy="choose another name, or --force to start anew")  # fmt: skip
        self._group: Any = zarr.open_group(str(path), mode="r+")
        self.attributes = dict(self._group.attrs)
        self.chunk = int(self.attributes["chunk"])

    def _create(self, zarr: Any, chunk: int, attributes: Mapping[str, Any]) -> None:
        """Make the store beside its place, then move it there whole."""
        size = self.sweep.design.size
        example = self.sweep.design.rows(0, 1)
        with tempfile.TemporaryDirectory(prefix=".spinline-", dir=self.path.parent) as scratch:
            place = Path(scratch) / "store"
            group = zarr.open_group(str(place), mode="w", zarr_format=3)
            for name, (dims, described) in _layout(self.sweep, self.task).items():
                text = name == "reason" or (name in example and example[name].dtype == object)
                kind: Any = str if text else np.uint8 if name == "status" else np.float64
                fill: Any = "" if text else PENDING if name == "status" else float("nan")
                wide = () if len(dims) == 1 else (self.task.points,)
                group.create_array(name, shape=(size, *wide), chunks=(min(chunk, size), *wide), dtype=kind,
                                   fill_value=fill, dimension_names=dims, attributes=described)  # fmt: skip
            group.attrs.update(
                {_MARK: 1, **attributes, "chunk": chunk, "variables": " ".join(_layout(self.sweep, self.task))}
            )
            place.rename(self.path)

    def pending(self) -> list[int]:
        """Numbers of the chunks that are not done."""
        count = -(-self.sweep.design.size // self.chunk)
        try:
            done = self._group["status"][:] != PENDING
        except _UNREADABLE:
            return [i for i in range(count) if not self._done(i)]
        return [i for i in range(count) if not done[self._rows(i)].all()]

    def _done(self, index: int) -> bool:
        try:
            return bool((self._group["status"][self._rows(index)] != PENDING).all())
        except _UNREADABLE:
            return False

    def _rows(self, index: int) -> slice:
        return slice(index * self.chunk, min((index + 1) * self.chunk, self.sweep.design.size))

    def write(self, index: int, columns: Mapping[str, Column], block: Block) -> None:
        """Write a chunk, its status last."""
        rows = self._rows(index)
        try:
            for name in _layout(self.sweep, self.task):
                if name != "status":
                    self._group[name][rows] = _piece(name, columns, block)
            self._group["status"][rows] = block.status
        except OSError as error:
            raise InputError(str(self.path), f"cannot be written ({error.strerror or error})",
                             remedy="make room; the same command goes on from here") from None  # fmt: skip

    def dataset(self) -> "xr.Dataset":
        """The store, read as needed."""
        return open_sweep(self.path)


def open_sweep(path: str | Path, *, grid: bool = False) -> "xr.Dataset":
    """A sweep's results, read from disk as they are needed.

    Parameters
    ----------
    path : path
        What ``spinline sweep`` wrote, complete or not.
    grid : bool
        For a grid: one dimension a key, in place of `scene`; read into memory.

    Returns
    -------
    xarray.Dataset
        Along `scene`: the keys that vary, numbers, profiles (also along `point`), ``status`` and ``reason``. Rows that are not
        computed yet have the status 255.

    Raises
    ------
    InputError
        If it is no sweep, or no grid.
    """
    import xarray as xr

    if peek(Path(path)) is None:
        raise InputError(str(path), "is not a sweep", remedy="make one with `spinline sweep`")
    data = xr.open_zarr(str(path), consolidated=False, chunks=None, mask_and_scale=False)
    data = data[str(data.attrs["variables"]).split()]
    return as_grid(data) if grid else data


def as_grid(data: "xr.Dataset") -> "xr.Dataset":
    """A grid's results with one dimension a key.

    Raises
    ------
    InputError
        If it is no grid.
    """
    import xarray as xr

    if data.attrs.get("design") != "grid":
        raise InputError(
            "grid", "is not the design of this sweep", value=data.attrs.get("design"), remedy="leave it out"
        )
    keys = str(data.attrs["keys"]).split()
    shape = [int(n) for n in str(data.attrs["shape"]).split()]
    coordinates = {}
    for axis, key in enumerate(keys):
        corner = np.moveaxis(data[key].values.reshape(shape), axis, 0).reshape(shape[axis], -1)[:, 0]
        coordinates[key] = (key, corner, data[key].attrs)
    variables = {
        str(name): ((*keys, *v.dims[1:]), v.values.reshape(*shape, *v.shape[1:]), v.attrs)
        for name, v in data.data_vars.items()
        if name not in keys
    }
    return xr.Dataset(variables, coordinates, data.attrs)


def peek(path: Path) -> Mapping[str, Any] | None:
    """Attributes of a sweep's store; None where there is none."""
    if not (path / "zarr.json").is_file():
        return None
    import zarr

    try:
        attributes = dict(zarr.open_group(str(path), mode="r").attrs)
    except (OSError, ValueError, KeyError):
        return None
    return attributes if _MARK in attributes else None


def _layout(sweep: Sweep, task: Task) -> dict[str, tuple[tuple[str, ...], dict[str, str]]]:
    """Every variable: its dimensions and attributes."""
    layout: dict[str, tuple[tuple[str, ...], dict[str, str]]] = {}
    for key in sweep.design.keys:
        layout[key] = (("scene",), {"long_name": f"{key} of the scene", **_unit(unit_of(key))})
    for name in task.numbers:
        plain = name.removesuffix("_std")
        unit, words = SCALARS.get(plain) or VARIABLES.get(plain, ("", name.replace("_", " ")))
        if name == STD_FLAG:
            words = "of the inputs: 0 followed, 1 in part or for some inputs, 2 not followed (chain, walk)"
        elif plain != name:
            words = f"standard uncertainty, from the inputs': {words}"
        layout[name] = (("scene",), {"long_name": words, **_unit(unit)})
    for name in task.profiles:
        layout[f"profile_{name}"] = (("scene", "point"), {"long_name": VARIABLES[name][1], **_unit(VARIABLES[name][0])})
    layout["reason"] = (("scene",), {"long_name": _REASON})
    layout["status"] = (("scene",), {"long_name": _STATUS})
    return layout


def _unit(unit: str) -> dict[str, str]:
    return {"units": unit} if unit else {}


def _piece(name: str, columns: Mapping[str, Column], block: Block) -> NDArray[Any]:
    if name in columns:
        values = columns[name]
        return values if values.dtype != object else np.array([str(value) for value in values], dtype=object)
    if name == "status":
        return block.status
    if name == "reason":
        return block.reason
    return block.numbers[name] if name in block.numbers else block.profiles[name.removeprefix("profile_")]
