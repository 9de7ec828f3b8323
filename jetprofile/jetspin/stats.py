"""What JETSPIN prints beside the beads: statout.dat, statdat.dat, bead.dat, and the set-up as a Dataset."""

from collections.abc import Collection
from dataclasses import fields
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.errors import InputError
from spinline.base.named_arrays import NamedArrays
from spinline.jetprofile.jetspin.content import Content, content_of
from spinline.jetprofile.jetspin.detect import file_kind, kind_of
from spinline.jetprofile.jetspin.folder import Folder
from spinline.jetprofile.jetspin.frames import Floats, order_frames
from spinline.jetprofile.jetspin.header import find_parameters, is_log, parse_file, read_text
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.observables import BY_KEY, OBSERVABLES
from spinline.jetprofile.jetspin.units import floats_of, si_unit, to_floats

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["read_columns", "read_landed", "read_setup", "read_statistics", "read_table"]

Column = tuple[str, float, str, str]  # name, factor to SI, unit, meaning
_STEP: Column = ("step", 1.0, "1", "number of the time step")
_WIDTH = 20
_UNITS = {
    "system": "",
    "points": "",
    "maxnumber": "",
    "xyz_rescale": "",
    **dict.fromkeys(["nozzle_radius", "resolution", "initial_length", "collector_distance", "length_unit"], "m"),
    "perturbation_amplitude": "m",
    "density": "kg m-3",
    "charge_density": "C m-3",
    "viscosity": "Pa s",
    **dict.fromkeys(["elastic_modulus", "nozzle_stress", "yield_stress", "stress_unit"], "Pa"),
    "potential": "V",
    "surface_tension": "N m-1",
    **dict.fromkeys(["nozzle_velocity", "air_velocity"], "m s-1"),
    "perturbation_frequency": "s-1",
    **dict.fromkeys(["timestep", "final_time", "xyz_interval", "frame_interval", "time_unit"], "s"),
    "mass_unit": "kg",
    "charge_unit": "C",
}


def read_statistics(path: str | PathLike[str]) -> "xr.Dataset":
    """Read the observables of a run along its time, SI.

    Parameters
    ----------
    path : path
        ``statout.dat`` or ``statdat.dat``, or the run directory (the text file is preferred: more digits).

    Returns
    -------
    Dataset
        One variable per observable along `time`, with `step` the number of the time step.

    Raises
    ------
    InputError
        If there is no such file or no whole row in it.
    """
    path = Path(path)
    if path.is_dir():
        there = [path / name for name in ("statout.dat", "statdat.dat") if (path / name).is_file()]
        there = [file for file in there if file.stat().st_size > 0]
        if not there:
            raise InputError(
                str(path), "no statout.dat or statdat.dat with content in it", remedy="give the file itself"
            )
        path = there[0]
    elif file_kind(path) not in ("statout", "statdat"):
        raise InputError(str(path), "not a statout.dat or statdat.dat", remedy="read_jetspin reads the other files")
    notes = Notes(str(path))
    table = read_table(path, notes)
    notes.emit()
    return table.dataset()


def read_table(path: Path, notes: Notes) -> NamedArrays:
    """Observables of one file along time."""
    data: dict[str, Any] = {}
    found = read_columns(path, notes)
    dim = "time" if any(column[0] == "time" for column, _ in found) else "step"
    for (name, _, unit, text), values in found:
        data[name] = (dim, values, {"units": unit, "long_name": text})
    coords: dict[str, Any] = {name: data.pop(name) for name in ("time", "step") if name in data}
    attrs = {"source_files": path.name, "dropped": notes.dropped, "warnings": notes.warnings}
    return NamedArrays(data, coords, attrs)


def read_columns(path: Path, notes: Notes, wanted: Collection[str] = ()) -> list[tuple[Column, Floats]]:
    """Columns of one file in order of time; of a text nothing but time (or `step`) and the `wanted` ones, if any are named."""
    content = content_of(path)
    if kind_of(path, content) == "statdat":
        table, columns = _binary_table(content, notes)
    else:
        table, columns = _text_table(path, content, notes, wanted)
    if table.shape[1] == 0:
        raise InputError(str(path), "holds no whole row", remedy="read another file of the run")
    names = [name for name, _, _, _ in columns]
    keep = order_frames(table[names.index("time") if "time" in names else 0], notes)
    if len(keep) < table.shape[1]:
        table = table[:, keep]
    infinite = np.count_nonzero(np.isinf(table))
    notes.add("{n} values are infinite (radius of coincident beads), now NaN", infinite, warn=False)
    values = table * np.array([[factor] for _, factor, _, _ in columns])
    values[np.isinf(values)] = np.nan
    return list(zip(columns, values, strict=True))


def _binary_table(content: Content, notes: Notes) -> tuple[Floats, list[Column]]:
    count, rest = divmod(len(content), 196)
    if rest:
        notes.add("the last record is cut off and left out", dropped=True)
    words = np.frombuffer(content, "<u4", count * 49).reshape(count, 49)
    sound = (words[:, 0] == 188) & (words[:, -1] == 188) & (words[:, 2] == 45)
    notes.add("{n} damaged records left out", int((~sound).sum()), dropped=True)
    words = words[sound]
    numbers = words[:, 3:48].copy()
    broken = (numbers & 0x7F800000) == 0x7F800000
    known = np.zeros(45, dtype=np.bool_)
    known[[17, 18, 19, 20]] = True  # radius of coincident beads
    notes.add("{n} values are not finite, now NaN", int((broken & ~known).sum()))
    numbers[broken] = 0
    values = numbers.view("<f4").astype(np.float64)
    values[broken] = np.nan
    _check_record(values, notes)
    table = np.vstack([words[:, 1].view("<i4").astype(np.float64), values.T])
    columns = [_STEP] + [(name, *si_unit(unit), text) for _, name, unit, text in OBSERVABLES]
    return table, columns


def _check_record(values: Floats, notes: Notes) -> None:
    """Compare the observables that a record holds twice, in CGS and in internal units."""
    wrong = np.zeros(len(values), dtype=np.bool_)
    for plain, internal in [(0, 23), (1, 24), (2, 25), (3, 26), (4, 27), (5, 28), (6, 29), (7, 30), (8, 31)]:
        one, two = values[:, plain], values[:, internal]
        both = np.isfinite(one) & np.isfinite(two) & (np.abs(two) > 1e-30) & (np.abs(one) > 1e-30)
        if both.sum() > 2:
            factor = float(np.median(one[both] / two[both]))
            wrong |= both & (np.abs(one - factor * two) > 1e-5 * np.abs(one))
        wrong |= np.isfinite(one) & np.isfinite(two) & ((one == 0) != (two == 0))
    notes.add("{n} records contradict themselves (one observable in two units)", int(wrong.sum()))


def _text_table(path: Path, content: Content, notes: Notes, wanted: Collection[str]) -> tuple[Floats, list[Column]]:
    """Numbers (column, row) of a text, and what its columns are."""
    columns: list[Column] | None = None
    rows: list[str] = []
    even: NDArray[np.uint8] | None = None
    at = width = torn = 0
    for raw in BytesIO(content):
        at += len(raw)
        if raw.startswith(b"#***") or raw.isspace():
            continue
        line = raw[:4096].decode("utf-8", errors="replace").rstrip()
        if line.lstrip().startswith("#"):
            header = _columns(line)
            if columns is None:
                columns, width = header, 10 + _WIDTH * (len(header) - 1)
            elif [column[0] for column in header] != [column[0] for column in columns]:
                notes.add("a later header names other columns; rows behind it are left out", dropped=True)
                break
            continue
        if columns is None:
            raise InputError(str(path), "its header is missing or damaged", remedy="read statdat.dat instead")
        if not rows and not torn:
            even = _even_rows(content, at - len(raw), len(raw), width)
            if even is not None:
                break
        if width - 5 <= len(line) <= width and raw.endswith(b"\n"):
            rows.append(line)
        else:
            torn += 1
    notes.add("{n} cut or damaged rows left out", torn, dropped=True)
    if columns is None:
        raise InputError(str(path), "has no header", remedy="read statdat.dat instead")
    needed = (*wanted, "time" if any(one[0] == "time" for one in columns) else "step")
    stops = range(10, width + 1, _WIDTH)
    taken = [(one, stop) for one, stop in zip(columns, stops, strict=True) if not wanted or one[0] in needed]
    table = np.empty((len(taken), len(rows if even is None else even)))
    for number, (_, stop) in enumerate(taken):
        begin = max(stop - _WIDTH, 0)
        table[number] = to_floats([row[begin:stop] for row in rows]) if even is None else floats_of(even[:, begin:stop])
    notes.add("{n} values cannot be read and are NaN", np.count_nonzero(np.isnan(table)))
    return table, [one for one, _ in taken]


def _even_rows(content: Content, start: int, length: int, width: int) -> NDArray[np.uint8] | None:
    """Characters (row, column) from `start` to the end if all are rows of one length, plain and whole; else None."""
    count, rest = divmod(len(content) - start, length)
    if rest or not width < length <= 4096 or content.find(b"#", start) >= 0 or content.find(b"_", start) >= 0:
        return None
    rows = np.frombuffer(content, np.uint8, offset=start).reshape(count, length)
    text, blank = rows[:, :-1], ord(" ")
    if (
        (rows[:, -1] != ord("\n")).any()
        or text.min() < blank
        or text.max() > ord("~")
        or (text[:, width:] != blank).any()
    ):
        return None
    return text if (text[:, width - 6 : width] != blank).any(axis=1).all() else None


def _columns(line: str) -> list[Column]:
    """Names and units from a header line, in fields of 20 characters behind the step number."""
    found = [_STEP]
    for at in range(10, len(line), _WIDTH):
        label = line[at : at + _WIDTH].strip()
        key, _, unit = label.partition("(")
        key, unit = key.strip(), unit.rstrip(") ")
        name, printed, text = BY_KEY.get(key, (key, unit, f"observable {key}"))
        if not name or any(name == column[0] for column in found):
            name, text = f"column_{len(found)}", f"column {len(found)}, whose header is damaged"
        found.append((name, *si_unit(printed), text))
    return found


def read_landed(path: Path, notes: Notes) -> NamedArrays:
    """Beads that reached the collector (``bead.dat``), in the order of their landing."""
    p = find_parameters(Folder(path.parent, listed=False), notes)
    needed = (
        "length_unit",
        "time_unit",
        "stress_unit",
        "mass_unit",
        "charge_unit",
    )
    if p is None or any(getattr(p, name) is None for name in needed):
        raise InputError(
            str(path),
            "is in internal units, which are not known",
            remedy="put log.txt or input.dat of the run beside it",
        )
    length, tau, stress, mass, charge = (float(getattr(p, name)) for name in needed)
    content = path.read_bytes()
    count, rest = divmod(len(content), 72)
    if rest:
        notes.add("the last record is cut off and left out", dropped=True)
    words = np.frombuffer(content, "<u4", count * 18).reshape(count, 18)
    sound = (words[:, [0, 2]] == 4).all(axis=1) & (words[:, [3, 17]] == 52).all(axis=1)
    notes.add("{n} damaged records left out", int((~sound).sum()), dropped=True)
    numbers: NDArray[np.uint32] = words[sound][:, 4:17].copy()
    broken = (numbers & 0x7F800000) == 0x7F800000
    notes.add("{n} values are not finite, now NaN", int(broken.sum()))
    numbers[broken] = 0
    values = numbers.view("<f4").astype(np.float64)
    values[broken] = np.nan
    if len(values) == 0:
        raise InputError(str(path), "holds no whole record", remedy="read another file of the run")
    speed = length / tau
    table = (
        ("time", tau, "s", "time of landing"),
        ("x", length, "m", "x at landing"),
        ("y", length, "m", "y at landing"),
        ("z", length, "m", "z at landing"),
        ("stress", stress, "Pa", "stress at landing"),
        ("velocity_x", speed, "m s-1", "velocity along x"),
        ("velocity_y", speed, "m s-1", "velocity along y"),
        ("velocity_z", speed, "m s-1", "velocity along z"),
        ("mass", mass, "kg", "mass of the bead"),
        ("charge", charge, "C", "charge of the bead"),
        ("volume", length**3, "m3", "volume of the element"),
        ("radius", length, "m", "radius of the element"),
        ("element_length", length, "m", "length of the element"),
    )
    data = {
        name: ("landing", values[:, number] * factor, {"units": unit, "long_name": text})
        for number, (name, factor, unit, text) in enumerate(table)
    }
    _check_landed(values, p.collector_distance, length, notes)
    attrs = {"source_files": path.name, "parameter_source": p.source}
    attrs |= {"dropped": notes.dropped, "warnings": notes.warnings}
    return NamedArrays(data, attrs=attrs)


def _check_landed(values: Floats, collector: float | None, length: float, notes: Notes) -> None:
    late = np.diff(values[:, 0]) < 0
    notes.add("{n} landings are earlier than the one before (a restart, or damage)", int(late.sum()))
    if collector is not None:
        off = np.abs(values[:, 1] * length - collector) > 1e-4 * collector
        notes.add("{n} beads did not land at the collector distance", int(off.sum()))
    strange = (values[:, 10] <= 0) | (values[:, 11] <= 0) | (values[:, 12] < 0)
    notes.add("{n} beads have a volume, radius or length that cannot be", int(strange.sum()))


def read_setup(path: Path, notes: Notes) -> NamedArrays:
    """Parameters of ``log.txt`` or ``input.dat`` as scalar variables."""
    p = parse_file(path, notes)
    data: dict[str, Any] = {}
    attrs: dict[str, Any] = {"source_files": p.source, "jetspin_version": p.version or "unknown"}
    for field in fields(p):
        value = getattr(p, field.name)
        if field.name in ("source", "complete", "version") or value is None:
            continue
        if isinstance(value, bool):
            attrs[field.name] = "yes" if value else "no"
            continue
        unit = _UNITS.get(field.name, "")
        about = {"long_name": field.name.replace("_", " ")} | ({"units": unit} if unit else {})
        data[field.name] = ((), value, about)
    if not data:
        raise InputError(str(path), "holds no parameter of a JETSPIN run", remedy="give its log.txt or input.dat")
    if not p.complete:
        notes.add("its end is missing: what the run was not told cannot be known")
    text = read_text(path, limit=1 << 30)
    if is_log(text) and "Program closed correctly" not in text:
        notes.add("it does not say that the run ended")
    attrs["dropped"], attrs["warnings"] = notes.dropped, notes.warnings
    return NamedArrays(data, attrs=attrs)
