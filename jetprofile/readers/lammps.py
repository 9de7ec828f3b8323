"""LAMMPS dumps in text: ``ITEM: TIMESTEP`` ... ``ITEM: ATOMS id x y z radius``; beads in the order of their id."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
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
        if "id" in columns and (np.diff(columns["id"]) == 0).any():
            raise InputError(name, f"has two atoms of one id ({kind})", remedy="dump one jet, each bead once")
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


def _places(columns: dict[str, FloatArray], items: dict[str, list[str]], name: str, kind: str) -> FloatArray:
    for keys in _PLACES:
        if not all(key in columns for key in keys):
            continue
        points = np.column_stack([columns[key] for key in keys])
        if "s" not in keys[0]:
            return points
        try:
            bounds = np.array([line.split() for line in items["BOX BOUNDS"][1:4]], dtype=np.float64)
        except (KeyError, ValueError):
            bounds = np.empty((0, 0))
        if bounds.shape != (3, 2):
            raise InputError(
                name, f"has scaled places in a box that is not orthogonal, or no box ({kind})", remedy="dump x y z"
            )
        return bounds[:, 0] + points * np.diff(bounds, axis=1)[:, 0]
    raise InputError(
        name, f"has no places ({kind})", value=list(columns), allowed="x y z", remedy="dump id x y z radius"
    )


def _scales(system: str | None, unit: str | None, name: str, kind: str) -> tuple[float, float]:
    if unit is not None:
        return length_scale(unit, name, kind), float("nan")
    if system in _UNITS:
        return _UNITS[system]
    return length_scale(None, name, f"{kind}, units {system or 'not said'}"), float("nan")
