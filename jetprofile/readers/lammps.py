"""LAMMPS dumps in text: ``ITEM: TIMESTEP`` ... ``ITEM: ATOMS id x y z radius``; beads in the order of their id."""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.text import read_text
from spinline.jetprofile.lagrangian import LagrangianJet
from spinline.jetprofile.readers.polyline import jet_of_points, length_scale

__all__ = ["LammpsDump"]

# docs.lammps.org, "units": length in m, velocity in m/s
_UNITS = {
    "si": (1.0, 1.0),
    "cgs": (1e-2, 1e-2),
    "micro": (1e-6, 1.0),
    "nano": (1e-9, 1.0),
    "real": (1e-10, 1e5),
    "metal": (1e-10, 1e2),
}
_PLACES = (("xu", "yu", "zu"), ("x", "y", "z"), ("xs", "ys", "zs"), ("xsu", "ysu", "zsu"))


class LammpsDump:
    """Reader of LAMMPS dumps; of several moments the last."""

    name = "LAMMPS dump (text)"

    def claims(self, path: Path, head: bytes) -> bool:
        """By its first item."""
        return head.lstrip().startswith(b"ITEM:")

    def read(self, path: Path, *, unit: str | None = None, initial_radius: float | None = None) -> LagrangianJet:
        """The last moment that is whole; `unit` unless the dump has ``ITEM: UNITS`` of a style that is not lj."""
        name, kind = str(path), self.name
        text, _ = read_text(path)
        last, system = None, None
        for items in _moments(text.splitlines(), name):
            system = items.get("UNITS", [system])[0]
            last = items
        if last is None:
            raise InputError(name, f"holds no moment that is whole ({kind})", remedy="write the dump again")
        columns = _columns(last, name, kind)
        order = (
            np.argsort(columns["id"], kind="stable")
            if "id" in columns
            else np.arange(len(next(iter(columns.values()))))
        )
        columns = {key: values[order] for key, values in columns.items()}
        if "id" not in columns:
            text = (
                f"{name}: atoms without an id are taken in the order of their rows, which LAMMPS changes: dump id too"
            )
            warnings.warn(text, SpinlineWarning, stacklevel=2)
        if "id" in columns and (np.diff(columns["id"]) == 0).any():
            raise InputError(name, f"has two atoms of one id ({kind})", remedy="dump one jet, each bead once")
        _one_jet(columns, name, kind)
        scale, speed = _scales(system, unit, name, kind)
        parts = [columns[key] for key in ("vx", "vy", "vz") if key in columns]
        data = {key: values for key, values in columns.items() if key not in ("vx", "vy", "vz")}
        if len(parts) == 3:
            data["velocity"] = np.column_stack(parts)
        time = float(last["TIME"][0]) if "TIME" in last else None
        return jet_of_points(
            _places(columns, last, name, kind),
            data,
            {},
            name=name,
            kind=kind,
            scale=scale,
            speed=speed,
            initial_radius=initial_radius,
            time=time,
        )


def _moments(lines: list[str], name: str) -> Iterator[dict[str, list[str]]]:
    """Items of every moment that is whole, by their names; the rest of an item's line stands first in ``ATOMS`` and ``BOX``."""
    items: dict[str, list[str]] = {}
    current = ""
    for line in lines:
        if line.startswith("ITEM:"):
            title = line[5:].strip()
            if title.startswith(("TIMESTEP", "UNITS")) and "ATOMS" in items:
                if _whole(items, name):
                    yield items
                items = {}
            current, rest = title, ""
            for known in ("TIMESTEP", "UNITS", "TIME", "NUMBER OF ATOMS", "BOX BOUNDS", "ATOMS"):
                if title == known or title.startswith(known + " "):
                    current, rest = known, title[len(known) :].strip()
                    break
            items[current] = [rest] if current in ("ATOMS", "BOX BOUNDS") else []
        elif current:
            items[current].append(line.strip())
    if "ATOMS" in items and _whole(items, name):
        yield items


def _whole(items: dict[str, list[str]], name: str) -> bool:
    try:
        count = int(items["NUMBER OF ATOMS"][0])
    except (KeyError, IndexError, ValueError):
        raise InputError(
            name, "has a moment without its number of atoms (LAMMPS dump)", remedy="write the dump again"
        ) from None
    return len([line for line in items["ATOMS"][1:] if line]) >= count


def _columns(items: dict[str, list[str]], name: str, kind: str) -> dict[str, FloatArray]:
    keys = items["ATOMS"][0].split()
    rows = [line.split() for line in items["ATOMS"][1:] if line][: int(items["NUMBER OF ATOMS"][0])]
    if not keys or any(len(row) != len(keys) for row in rows):
        raise InputError(
            name, f"has rows that do not fit its columns ({kind})", value=" ".join(keys), remedy="write it again"
        )
    columns: dict[str, FloatArray] = {}
    for j, key in enumerate(keys):
        try:
            columns[key.removeprefix("c_").removeprefix("v_")] = np.array([row[j] for row in rows], dtype=np.float64)
        except ValueError:
            continue  # names of elements and the like
    return columns


def _one_jet(columns: dict[str, FloatArray], name: str, kind: str) -> None:
    """Refuse several molecules; say it where atoms of several types are taken for one jet."""
    several = {key: np.unique(columns[key]).astype(int) for key in ("mol", "type") if key in columns}
    if len(several.get("mol", ())) > 1:
        shown = ", ".join(map(str, several["mol"][:5]))
        raise InputError(name, f"has several molecules ({kind})", value=shown, remedy="dump one jet a file")
    if len(several.get("type", ())) > 1:
        shown = ", ".join(map(str, several["type"][:5]))
        text = f"{name}: atoms of types {shown} are taken for the beads of one jet, in the order of their id"
        warnings.warn(text, SpinlineWarning, stacklevel=4)


def _places(columns: dict[str, FloatArray], items: dict[str, list[str]], name: str, kind: str) -> FloatArray:
    """Places along the jet; atoms that were put back into a periodic box stand where they were before."""
    keys = next((keys for keys in _PLACES if all(key in columns for key in keys)), None)
    if keys is None:
        raise InputError(
            name, f"has no places ({kind})", value=list(columns), allowed="x y z", remedy="dump id x y z radius"
        )
    points = np.column_stack([columns[key] for key in keys])
    box = _box(items)
    if box is None and "s" in keys[0]:
        raise InputError(name, f"has scaled places and no box that is known ({kind})", remedy="dump xu yu zu")
    if box is not None and "s" in keys[0]:
        points = box.corner + points @ box.edges
    if "u" in keys[0] or box is None:
        return points
    flags = [columns[key] for key in ("ix", "iy", "iz") if key in columns]
    if len(flags) == 3:
        whole: FloatArray = points + np.column_stack(flags) @ box.edges
        return whole
    steps = np.abs(np.diff(points, axis=0) @ np.linalg.inv(box.edges))
    if (steps[:, box.periodic] > 0.5).any():
        problem = f"has a jet that leaves a periodic box and comes in again on the other side ({kind})"
        raise InputError(name, problem, remedy="dump xu yu zu, or ix iy iz beside x y z")
    return points


@dataclass(frozen=True)
class _Box:
    """Corner (3,), edges (3, 3) as rows, and which of them repeat."""

    corner: FloatArray
    edges: FloatArray
    periodic: np.ndarray


def _box(items: dict[str, list[str]]) -> _Box | None:
    """The box of a moment, orthogonal or tilted (docs.lammps.org, "Howto triclinic"); None where it is not known."""
    try:
        title, *lines = items["BOX BOUNDS"]
        rows = np.array([line.split() for line in lines[:3]], dtype=np.float64)
    except (KeyError, ValueError):
        return None
    words = title.split()
    marks = [word for word in words if len(word) == 2 and set(word) <= set("pfsm")]
    periodic = np.array([mark == "pp" for mark in marks]) if len(marks) == 3 else np.zeros(3, dtype=bool)
    if rows.shape == (3, 2):
        return _Box(rows[:, 0], np.diag(rows[:, 1] - rows[:, 0]), periodic) if (rows[:, 1] > rows[:, 0]).all() else None
    if rows.shape == (3, 4) and words[:1] == ["abc"]:  # general triclinic: edge and origin a line
        return _Box(rows[:, 3], rows[:, :3], periodic) if np.linalg.det(rows[:, :3]) else None
    if rows.shape != (3, 3) or words[:3] != ["xy", "xz", "yz"]:
        return None
    xy, xz, yz = rows[:, 2]
    low = rows[:, 0] - [min(0.0, xy, xz, xy + xz), min(0.0, yz), 0.0]
    high = rows[:, 1] - [max(0.0, xy, xz, xy + xz), max(0.0, yz), 0.0]
    x, y, z = high - low
    return _Box(low, np.array([[x, 0.0, 0.0], [xy, y, 0.0], [xz, yz, z]]), periodic) if min(x, y, z) > 0 else None


def _scales(system: str | None, unit: str | None, name: str, kind: str) -> tuple[float, float]:
    if unit is not None:
        said = length_scale(unit, name, kind)
        if system in _UNITS and not np.isclose(said, _UNITS[system][0], rtol=1e-9):
            problem = f"is not the one of the dump ({kind}, units {system})"
            raise InputError("unit", problem, value=unit, remedy="leave it out: the dump carries its units")
        return said, _UNITS[system][1] if system in _UNITS else float("nan")
    if system in _UNITS:
        return _UNITS[system]
    return length_scale(None, name, f"{kind}, units {system or 'not said'}"), float("nan")
