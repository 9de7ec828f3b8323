"""HDF5, and what is written in it: NeXus, NXtomo, Eiger masters, netCDF-4.

The library gives the fill value, mostly 0, for whatever it does not find: a virtual dataset's source that was not copied, a
frame that was allocated and never written, a source shorter than its master says. None of that is a count. So sources are
looked for before anything is read, frames whose chunks were never written are told by number, links are followed (soft and
external ones, which a walk over a file passes by) and broken ones named. Where no path is given, the dataset is the one named
as the key, or NeXus' default signal, or an Eiger's ``data_000001, data_000002, ...`` one after the other, or the only one. An
NXtomo file's `image_key` says which of its frames show the jet (0), no jet (1), or no beam (2). Packed integers
(scale_factor, add_offset, _FillValue) are unpacked.
"""

import re
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.base.file_format import HDF5_HEAD
from spinline.images.file_names import gaps
from spinline.images.formats.base import Account, Array, FrameReader, frames_shape, needs
from spinline.images.links import linked_file, stays_home
from spinline.images.packing import packing_of

__all__ = ["FORMAT"]

_KEV = 1.602176634e-16  # J
_DEPTH = 12  # of groups in groups
_NUMBERED = re.compile(r"(?P<stem>.*?)(?P<number>\d+)$")
_IMAGE_KEYS = {"counts": 0, "transmission": 0, "flat": 1, "flat_after": 1, "dark": 2}
_FILTERS = {
    32001: "blosc",
    32004: "lz4",
    32008: "bitshuffle",
    32015: "zstd",
    32013: "zfp",
    32026: "blosc2",
    307: "bzip2",
    305: "lzo",
}
_ENERGY = ("incident_energy", "energy", "photon_energy")
_PIXEL = ("x_pixel_size", "pixel_size", "y_pixel_size")
_LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "micron": 1e-6, "nm": 1e-9}
_ENERGIES = {"kev": _KEV, "ev": 1e-3 * _KEV, "j": 1.0}


class _Datasets:
    """Frames of one dataset, or of several in a row; some of them left out."""

    threads = False  # the library takes one caller at a time

    def __init__(self, datasets: list[Any], key: str, source: str, picked: list[int] | None, account: Account) -> None:
        shapes = [frames_shape(d.shape, key, source) for d in datasets]
        if len({shape[1:] for shape in shapes}) > 1:
            raise InputError(
                key,
                "has datasets of different frames",
                value=source,
                allowed=", ".join(map(str, shapes)),
                remedy="name one of them",
            )
        for dataset in datasets:
            if getattr(dataset, "external", None):  # raw bytes of any file on this machine
                raise InputError(
                    key, "keeps its data in a foreign file", value=source, remedy="store them in the HDF5 file"
                )
        self.datasets, self.bounds = datasets, np.cumsum([0, *(shape[0] for shape in shapes)])
        self.picked = picked
        self.packing = [packing_of(d.attrs.get, key, source) for d in datasets]
        packed = any(p is not None for p in self.packing)
        kinds = {d.dtype for d in datasets}
        self.dtype: np.dtype[Any] = np.dtype(np.float64) if packed else np.result_type(*kinds)
        frames = int(self.bounds[-1]) if picked is None else len(picked)
        self.shape = (frames, *shapes[0][1:])
        names = [str(d.name).rpartition("/")[2] for d in datasets]
        account = replace(
            account, remarks=(*account.remarks, *(gaps(names, key, "datasets") if len(names) > 1 else ()))
        )
        self.account = account

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        if self.picked is not None:
            which = self.picked[start:stop]
            if which == list(range(which[0], which[-1] + 1)):
                return self._span(which[0], which[-1] + 1)
            return np.concatenate([self._span(i, i + 1) for i in which])
        return self._span(start, stop)

    def _span(self, start: int, stop: int) -> Array:
        parts = []
        for dataset, packing, low, high in zip(
            self.datasets, self.packing, self.bounds[:-1].tolist(), self.bounds[1:].tolist(), strict=True
        ):
            a, b = max(start, low), min(stop, high)
            if a >= b:
                continue
            raw = dataset[...] if dataset.ndim < 3 else _leading(dataset, a - low, b - low)
            block = np.asarray(raw).reshape(-1, *self.shape[1:])
            parts.append(block if packing is None else packing.unpacked(block))
        return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _leading(dataset: Any, start: int, stop: int) -> Array:
    """Frames of a dataset along the one of its leading axes that is longer than 1."""
    axes: list[Any] = [slice(None)] * dataset.ndim
    long = next((i for i, n in enumerate(dataset.shape[:-2]) if n > 1), 0)
    axes[long] = slice(start, stop)
    return np.asarray(dataset[tuple(axes)])


def _walk(file: Any, key: str) -> tuple[dict[str, Any], list[str]]:
    """Datasets by path, links followed; and the links that lead nowhere."""
    import h5py

    found: dict[str, Any] = {}
    broken: list[str] = []
    seen: set[tuple[int, int]] = set()  # groups: a link may lead back

    def into(group: Any, path: str, depth: int) -> None:
        state = h5py.h5o.get_info(group.id)
        if (state.fileno, state.addr) in seen:
            return
        seen.add((state.fileno, state.addr))
        for name in group:
            here = f"{path}/{name}"
            stays_home(group, name, key)
            link = group.get(name, getlink=True)
            try:
                thing = group[name]
            except (KeyError, OSError, RuntimeError):
                broken.append(_lost(link, here))
                continue
            if isinstance(thing, h5py.Dataset):
                if thing.ndim >= 1 and thing.dtype.kind in "uif":
                    found[here] = thing
            elif depth < _DEPTH and isinstance(thing, h5py.Group):
                into(thing, here, depth + 1)

    into(file, "", 0)
    return found, broken


def _lost(link: Any, here: str) -> str:
    """What a link that leads nowhere asks for."""
    name = getattr(link, "filename", None)
    return f"{here} -> {name}:{link.path}" if name else f"{here} -> {getattr(link, 'path', '?')}"


def _resolve(file: Any, path: Path, inside: str, key: str) -> list[Any]:
    """The datasets of a path inside: one, or an Eiger's group of many."""
    import h5py

    stays_home(file, inside, key)
    try:
        thing = file[inside]
        for name in thing if isinstance(thing, h5py.Group) else ():
            stays_home(thing, name, key)
    except (KeyError, OSError, ValueError, RuntimeError):
        found, broken = _walk(file, key)
        mine = [words for words in broken if words.startswith("/" + inside.strip("/") + " ") or inside in words]
        if mine:
            raise InputError(
                key,
                "is a link that leads nowhere",
                value=f"{path.name}: {mine[0]}",
                remedy="copy the file it names beside it, or name the dataset itself",
            ) from None
        raise InputError(
            key, f"is not a dataset of {path.name}", value=inside, allowed=", ".join(_large(found)) or "none"
        ) from None
    if isinstance(thing, h5py.Dataset):
        return [thing]
    many = _numbered({name: thing.get(name) for name in thing if isinstance(thing.get(name), h5py.Dataset)})
    _no_gap(thing, path, key)
    if many:
        return many
    signal = _signal(thing)
    if signal is not None:
        return [signal]
    inner = [d for d in map(thing.get, thing) if isinstance(d, h5py.Dataset) and d.ndim >= 2]
    if len(inner) == 1:
        return inner
    raise InputError(key, f"is a group of {path.name}, no dataset", value=inside, allowed=", ".join(thing) or "none")


def _no_gap(group: Any, path: Path, key: str) -> None:
    """Refuse a group in which a link to one of its numbered datasets leads nowhere."""
    for name in group:
        if _NUMBERED.match(name) and group.get(name) is None:
            link = group.get(name, getlink=True)
            raise InputError(
                key,
                "is a stack of several datasets, and one is not there",
                value=f"{path.name}: {_lost(link, group.name + '/' + name)}",
                remedy="copy the file it names beside the master",
            )


def _large(found: dict[str, Any]) -> list[str]:
    """Paths of what may be frames."""
    return [name for name, d in found.items() if d.ndim >= 2]


def _numbered(found: dict[str, Any]) -> list[Any]:
    """Datasets whose names are a word and a number, in the order of the numbers; none where there is one."""
    groups: dict[str, list[tuple[int, Any]]] = {}
    for name, dataset in found.items():
        match = _NUMBERED.match(name)
        if match and dataset.ndim >= 2:
            groups.setdefault(match["stem"], []).append((int(match["number"]), dataset))
    many = [part for part in groups.values() if len(part) > 1]
    return [dataset for _, dataset in sorted(many[0], key=lambda pair: pair[0])] if len(many) == 1 else []


def _signal(group: Any, depth: int = 0) -> Any | None:
    """NeXus' default: the attribute `default` from group to group, then `signal`."""
    import h5py

    for name in (group.attrs.get("default"), group.attrs.get("signal")):
        word = name.decode() if isinstance(name, bytes) else name
        if isinstance(word, str):
            stays_home(group, word, "counts")
        if not isinstance(word, str) or word not in group:
            continue
        thing = group.get(word)
        if isinstance(thing, h5py.Dataset):
            return thing if thing.ndim >= 2 else None
        if isinstance(thing, h5py.Group) and depth < _DEPTH:
            return _signal(thing, depth + 1)
    return None


def _chosen(file: Any, path: Path, key: str) -> list[Any]:
    """The datasets that are meant where no path is given."""
    found, broken = _walk(file, key)
    if broken and not [name for name in _large(found) if name.rpartition("/")[2] == key]:
        raise InputError(
            key,
            "has a link that leads nowhere",
            value=f"{path.name}: {broken[0]}",
            remedy=f'copy the file it names beside it, or write "{path.name}:/path/inside"',
        )
    named = {d.id: d for name, d in found.items() if d.ndim >= 2 and name.rpartition("/")[2] == key}
    if len(named) == 1:
        return list(named.values())
    signal = _signal(file)
    if not named and signal is not None:
        return [signal]
    many = {} if named else {name: d for name, d in found.items() if d.ndim >= 2}
    if many:
        by_group: dict[str, dict[str, Any]] = {}
        for name, d in many.items():
            by_group.setdefault(name.rpartition("/")[0], {})[name.rpartition("/")[2]] = d
        stacks = [stack for part in by_group.values() if (stack := _numbered(part))]
        if len(stacks) == 1:
            return stacks[0]
        keyed = {d.id: d for d in many.values() if _image_key(file, d) is not None}
        stacked = keyed or {d.id: d for d in many.values() if d.ndim >= 3}
        if len(stacked) == 1:
            return list(stacked.values())
        only = {d.id: d for d in many.values()}
        if len(only) == 1:
            return list(only.values())
    names = _large(found) or list(found)
    raise InputError(
        key,
        f"does not say which dataset of {path.name}",
        allowed=", ".join(names) or "none",
        remedy=f'write "{path.name}:/path/inside"',
    )


def _image_key(file: Any, dataset: Any) -> Array | None:
    """NXtomo's `image_key` of a dataset: beside it, or anywhere in the file with as many numbers as it has frames."""
    import h5py

    frames = dataset.shape[0] if dataset.ndim >= 3 else 0
    fits: list[Array] = []

    def look(name: str, thing: Any) -> None:
        if isinstance(thing, h5py.Dataset) and name.endswith("image_key") and thing.shape == (frames,):
            fits.append(np.asarray(thing[...]))

    if frames:
        stays_home(dataset.parent, "image_key", "counts")
        beside = dataset.parent.get("image_key")
        if isinstance(beside, h5py.Dataset) and beside.shape == (frames,):
            return np.asarray(beside[...])
        file.visititems(look)
    return fits[0] if fits else None


def _unwritten(dataset: Any, path: Path, key: str, depth: int = 0) -> set[int]:
    """Frames of a dataset that were never written; sources of virtual ones are looked for first.

    Raises
    ------
    InputError
        For a source that is not there.
    """
    frames = dataset.shape[0] if dataset.ndim >= 3 else 1
    if dataset.is_virtual:
        return _unmapped(dataset, path, key, frames, depth)
    if dataset.chunks is None:
        return set(range(frames)) if dataset.id.get_storage_size() == 0 and dataset.external is None else set()
    tiles = int(np.prod([-(-n // c) for n, c in zip(dataset.shape[1:], dataset.chunks[1:], strict=True)]))
    whole = tiles * -(-dataset.shape[0] // dataset.chunks[0])
    if dataset.id.get_num_chunks() == whole:
        return set()
    seen = np.zeros(-(-dataset.shape[0] // dataset.chunks[0]), dtype=np.int64)
    for i in range(dataset.id.get_num_chunks()):
        seen[dataset.id.get_chunk_info(i).chunk_offset[0] // dataset.chunks[0]] += 1
    if dataset.ndim < 3:
        return {0}
    gone: set[int] = set()
    for i in np.flatnonzero(seen < tiles).tolist():
        gone.update(range(i * dataset.chunks[0], min((i + 1) * dataset.chunks[0], frames)))
    return gone


def _unmapped(dataset: Any, path: Path, key: str, frames: int, depth: int) -> set[int]:
    """Frames of a virtual dataset that no source gives."""
    import h5py

    given = np.zeros(frames, dtype=np.bool_)
    path = Path(dataset.file.filename)  # that of a link's target, where its sources are looked for
    for source in dataset.virtual_sources():
        here = source.file_name in (".", "")
        name = Path(dataset.file.filename) if here else path.parent / source.file_name
        linked_file(path, str(name), str(dataset.name), key)
        if "%" in source.file_name:
            name = path.parent / (source.file_name.replace("%b", "0"))
        if not name.is_file():
            raise InputError(
                key,
                "is a virtual dataset, and a file that it refers to is not there",
                value=f"{path.name} -> {source.file_name}",
                remedy=f"copy {Path(source.file_name).name} beside {path.name}",
            )
        try:
            file = dataset.file if here else h5py.File(name, "r")
        except OSError:
            raise InputError(
                key,
                "is a virtual dataset, and a file that it refers to is damaged or cut short",
                value=f"{path.name} -> {source.file_name}",
                remedy=f"copy {Path(source.file_name).name} again",
            ) from None
        part = file.get(source.dset_name)
        if not isinstance(part, h5py.Dataset):
            raise InputError(
                key,
                "is a virtual dataset, and a dataset that it refers to is not there",
                value=f"{path.name} -> {source.file_name}:{source.dset_name}",
                remedy="copy the source again, or write the master anew",
            )
        lost = _unwritten(part, name, key, depth + 1) if depth < _DEPTH else set()
        low, high = _bounds(source.vspace, dataset)
        first, last = _bounds(source.src_space, part)
        if dataset.ndim < 3:
            given[:] = not lost
            continue
        has = part.shape[0] if part.ndim >= 3 else 1
        each = int(np.prod([b - a + 1 for a, b in zip(low[1:], high[1:], strict=True)]))
        number = max(int(source.vspace.get_select_npoints()) // each, 1) if dataset.ndim >= 3 else 1
        wanted = max(last[0] + 1, number if first[0] == 0 else 0)
        if part.ndim >= 3 and has < wanted:
            raise InputError(
                key,
                "is a virtual dataset, and a dataset that it refers to holds fewer frames than it says",
                value=f"{path.name} -> {source.file_name}:{source.dset_name}, {has} of {wanted}",
                remedy="copy the source again, or name the sources themselves by a pattern",
            )
        step = max((high[0] - low[0]) // max(number - 1, 1), 1)
        at = first[0] if part.ndim >= 3 else 0
        for offset, frame in enumerate(range(low[0], min(high[0] + 1, frames), step)):
            given[frame] |= at + offset < has and at + offset not in lost
    return set(np.flatnonzero(~given).tolist())


def _bounds(space: Any, dataset: Any) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """First and last corner of a selection; of all of a dataset where all of it is selected."""
    try:
        low, high = space.get_select_bounds()
    except ValueError:
        return (0,) * dataset.ndim, tuple(n - 1 for n in dataset.shape)
    return low, high


def _require_filters(dataset: Any, path: Path, key: str) -> None:
    """Refuse what no decoder is installed for, by the package to install."""
    import h5py

    plist = dataset.id.get_create_plist()
    for i in range(plist.get_nfilters()):
        number = plist.get_filter(i)[0]
        if h5py.h5z.filter_avail(number):
            continue
        with suppress(ImportError):
            import hdf5plugin  # noqa: F401 - brings the decoders
        if not h5py.h5z.filter_avail(number):
            what = f"compression {_FILTERS.get(number, f'filter {number}')}"
            raise needs("hdf5plugin", key, path.name, what)


def _metadata(file: Any, dataset: Any) -> dict[str, float]:
    """Energy, size of a pixel and distance, where a NeXus file gives them with their units."""
    import h5py

    found: dict[str, float] = {}

    def look(name: str, thing: Any) -> None:
        if not isinstance(thing, h5py.Dataset) or thing.size != 1 or thing.dtype.kind not in "uif":
            return
        word, group = name.rpartition("/")[2], name.rpartition("/")[0].rpartition("/")[2]
        unit = thing.attrs.get("units", "")
        unit = (unit.decode() if isinstance(unit, bytes) else str(unit)).strip()
        value = float(np.ravel(thing[...])[0])
        if not np.isfinite(value) or value <= 0.0:
            return
        if word in _ENERGY and unit.lower() in _ENERGIES:
            found.setdefault("energy", value * _ENERGIES[unit.lower()])
        elif word in _PIXEL and unit in _LENGTHS:
            found.setdefault("pixel_size", value * _LENGTHS[unit])
        elif word == "distance" and group == "detector" and unit in _LENGTHS:
            found.setdefault("propagation_distance", value * _LENGTHS[unit])

    file.visititems(look)
    return found


class _Hdf5:
    name = "hdf5"
    suffixes = (".h5", ".hdf5", ".hdf", ".he5", ".nxs", ".nx", ".nc", ".mat", ".cxi")
    inside = True

    def owns(self, head: bytes) -> bool:
        """Whether a file begins as HDF5 does."""
        return head.startswith(HDF5_HEAD)

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open the datasets that are meant, and see which of their frames were written."""
        import h5py

        file = h5py.File(path, "r")
        datasets = _resolve(file, path, inside, key) if inside else _chosen(file, path, key)
        names = [str(d.name) for d in datasets]
        missing: list[int] = []
        at = 0
        for dataset in datasets:
            if dataset.dtype.kind not in "uif":
                raise InputError(key, "holds no real numbers", value=str(dataset.dtype), allowed="integers or floats")
            linked_file(path, dataset.file.filename, names[0], key)  # however HDF5 came to it
            _require_filters(dataset, path, key)
            frames = frames_shape(dataset.shape, key, path.name)[0]
            missing += sorted(at + i for i in _unwritten(dataset, path, key))
            at += frames
        picked, words = _picked(file, datasets, key, at, missing)
        if picked is not None:
            missing = [i for i, frame in enumerate(picked) if frame in set(missing)]
        parts = f"{len(datasets)} datasets, {names[0]} to {names[-1]}" if len(datasets) > 1 else words
        account = Account(f"{path.name}:{names[0]}", parts, tuple(missing), metadata=_metadata(file, datasets[0]))
        return _Datasets(datasets, key, path.name, picked, account)


def _picked(file: Any, datasets: list[Any], key: str, frames: int, missing: list[int]) -> tuple[list[int] | None, str]:
    """Frames of the kind that the key asks for, where the file says which these are."""
    keys = _image_key(file, datasets[0]) if len(datasets) == 1 and key in _IMAGE_KEYS else None
    if keys is None:
        return None, ""
    wanted = _IMAGE_KEYS[key]
    if len(set(keys.tolist())) == 1 and keys[0] == 0:
        return None, ""
    picked = np.flatnonzero(keys == wanted).tolist()
    if key == "flat_after":  # those after the last frame of the jet
        last = int(np.flatnonzero(keys == 0).max(initial=-1))
        picked = [i for i in picked if i > last]
    if not picked:
        raise InputError(
            key,
            f"has no frame of its kind: none of {frames} has image_key {wanted}",
            allowed=", ".join(f"{int((keys == k).sum())} of {k}" for k in sorted(set(keys.tolist()))),
            remedy="name another file",
        )
    return picked, f"{len(picked)} of {frames} frames, by image_key {wanted}"


FORMAT = _Hdf5()
