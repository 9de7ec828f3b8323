"""Where the rows of a sweep go: memory, or one chunked zarr store that survives being killed.

Why zarr and not netCDF: a chunk is a file of its own, written beside and renamed, so that a kill at any moment leaves every
finished chunk readable and the rest absent; a netCDF-4 (HDF5) file that is cut off while it grows cannot be relied on to open.
Chunks are independent, so nothing is locked, and the store can be read while it grows, with xarray, in parts larger than
memory.

Order: a chunk's parameters, numbers, profiles and reasons first, its ``status`` last. A chunk is done when its status is
written and every one of its files is there with a checksum that fits (crc32c, looked at on every start and on opening);
any other is computed again, to the same bits. Only the process that was called writes, one at a time; workers compute.
"""

import json
import re
import warnings
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.file_format import FORMAT, require_format
from spinline.base.files import discard, new_folder
from spinline.base.held_signals import signals_held
from spinline.base.naming import clear_leavings, lock_folder, unlock_folder
from spinline.scene.keys import unit_of
from spinline.solve.results import VARIABLES
from spinline.study.design import Column
from spinline.study.rows import PENDING, SCALARS, STD_FLAG, WAYS, Block, Task
from spinline.study.sweep_file import Sweep

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Memory", "Store", "as_grid", "open_sweep"]

_MARK = "spinline_sweep"
_OWN = re.compile(r"(?:[^/]+/)?zarr\.json|[^/]+/c(?:/\d+)+|(?:[^/]+/)*[^/]*\.partial")
_STATUS = "0 ok, 1 incomplete, 2 refused, 3 failed, 255 not computed"
_WAY = "how a row was computed: " + ", ".join(f"{code} {words}" for code, words in WAYS.items())
_BYTES = ("status", "computed_by")
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

    def close(self) -> None:
        """Nothing is held."""

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
        if force and _looks_ours(path):
            lock_folder(path)
            unlock_folder(path)
            discard(path, lambda name: _OWN.fullmatch(name) is not None)
        present = peek(path)
        if present is None:
            if path.exists():
                raise InputError(str(path), "exists and is no sweep", remedy="choose another name")
            self._create(zarr, chunk, attributes)
        elif present["fingerprint"] != attributes["fingerprint"]:
            raise InputError(
                str(path),
                "holds another sweep (or one of another version)",
                remedy="choose another name, or --force to start anew",
            )
        lock_folder(path)
        clear_leavings(path.parent)  # killed between the store's move to its place and the end of what it was made in
        for left in path.rglob("*.partial"):  # of a process that was killed
            left.unlink(missing_ok=True)
        self._group: Any = zarr.open_group(str(path), mode="r+")
        self.attributes = dict(self._group.attrs)
        self.chunk = int(self.attributes["chunk"])

    @signals_held()  # zarr writes in threads: a folder that is given up is not still
    def _create(self, zarr: Any, chunk: int, attributes: Mapping[str, Any]) -> None:
        """Make the store beside its place, then move it there whole."""
        from zarr.codecs import Crc32cCodec, ZstdCodec

        size = self.sweep.design.size
        example = self.sweep.design.rows(0, 1)
        with new_folder(self.path) as place:
            group = zarr.open_group(str(place), mode="w", zarr_format=3)
            for name, (dims, described) in _layout(self.sweep, self.task).items():
                text = name == "reason" or (name in example and example[name].dtype == object)
                kind: Any = str if text else np.uint8 if name in _BYTES else np.float64
                fill: Any = "" if text else PENDING if name in _BYTES else float("nan")
                wide = () if len(dims) == 1 else (self.task.points,)
                group.create_array(
                    name,
                    shape=(size, *wide),
                    chunks=(min(chunk, size), *wide),
                    dtype=kind,
                    fill_value=fill,
                    dimension_names=dims,
                    attributes=described,
                    compressors=[ZstdCodec(level=0), Crc32cCodec()],
                )
            told = {_MARK: FORMAT, **attributes, "chunk": chunk, "variables": " ".join(_layout(self.sweep, self.task))}
            group.attrs.update(told | {"checksum": _checksum(place, told)})

    def pending(self) -> list[int]:
        """Numbers of the chunks that are not done."""
        done, damaged = examine(self._group, self.path)
        if damaged:
            warnings.warn(
                f"{self.path} is damaged in {len(damaged)} of {len(done)} chunks: their scenes are computed again",
                SpinlineWarning,
                stacklevel=3,
            )
        return [i for i, whole in enumerate(done) if not whole]

    def close(self) -> None:
        """Let another process have the store."""
        unlock_folder(self.path)

    def _rows(self, index: int) -> slice:
        return slice(index * self.chunk, min((index + 1) * self.chunk, self.sweep.design.size))

    def write(self, index: int, columns: Mapping[str, Column], block: Block) -> None:
        """Write a chunk, its status last; all its files, for one that is missing must be seen to be."""
        import zarr

        rows = self._rows(index)
        try:
            with zarr.config.set({"array.write_empty_chunks": True}):
                for name in _layout(self.sweep, self.task):
                    if name != "status":
                        self._group[name][rows] = _piece(name, columns, block)
                self._group["status"][rows] = block.status
        except OSError as error:
            raise InputError(
                str(self.path),
                f"cannot be written ({error.strerror or error})",
                remedy="make room; the same command goes on from here",
            ) from None

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
    import zarr

    _, damaged = examine(zarr.open_group(str(path), mode="r"), Path(path))
    if damaged:
        raise InputError(
            str(path),
            f"is damaged in chunks {', '.join(map(str, damaged[:5]))}",
            remedy="the command that made it computes them again",
        )
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
    """Attributes of a sweep's store; None where there is none.

    Raises
    ------
    InputError
        If there is one, but what it says of itself is damaged.
    """
    if not _looks_ours(path):
        return None
    broken = InputError(
        str(path),
        "is damaged: what it says of itself has changed",
        remedy="choose another name, or --force to start anew",
    )
    try:
        attributes = dict(json.loads((path / "zarr.json").read_bytes())["attributes"])
        told = {key: value for key, value in attributes.items() if key != "checksum"}
        if attributes["checksum"] != _checksum(path, told):
            raise broken
        require_format(str(path), attributes[_MARK])
    except InputError:
        raise
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise broken from None
    return attributes


def _looks_ours(path: Path) -> bool:
    try:
        return f'"{_MARK}"'.encode() in (path / "zarr.json").read_bytes()
    except OSError:
        return False


def _checksum(path: Path, told: Mapping[str, Any]) -> str:
    """Of the attributes and of what every array says of itself."""
    total = zlib.crc32(json.dumps(told, sort_keys=True).encode())
    for name in str(told["variables"]).split():
        total = zlib.crc32((path / name / "zarr.json").read_bytes(), total)
    return f"{total:08x}"


def examine(group: Any, path: Path) -> tuple[list[bool], list[int]]:
    """Which chunks of a store are done and whole, and which are done but damaged.

    Parameters
    ----------
    group : zarr.Group
    path : Path

    Returns
    -------
    done : list of bool
        For every chunk.
    damaged : list of int
        Chunks that should be whole and are not.
    """
    chunk, names = int(group.attrs["chunk"]), str(group.attrs["variables"]).split()
    size = int(group["status"].shape[0])
    done, damaged = [], []
    for i in range(-(-size // chunk)):
        rows = slice(i * chunk, min((i + 1) * chunk, size))
        if not _there(path / "status", i):
            done.append(False)
            continue
        try:
            begun = bool((group["status"][rows] != PENDING).all())
            whole = begun and all(_there(path / name, i) and group[name][rows] is not None for name in names)
        except Exception:  # a codec may raise anything of bytes that are not its own
            begun, whole = True, False
        done.append(whole)
        if begun and not whole:
            damaged.append(i)
    return done, damaged


def _there(array: Path, index: int) -> bool:
    place = array / "c" / str(index)
    return place.is_file() or (place / "0").is_file()


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
    layout["computed_by"] = (("scene",), {"long_name": _WAY})
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
    if name == "computed_by":
        return block.way
    return block.numbers[name] if name in block.numbers else block.profiles[name.removeprefix("profile_")]
