"""The sweep file: a base scene, the keys that vary, and the design. TOML, checked before anything runs.

::

    scene = "peo5-water"                       # bundled name, or path from this file; or a whole [scene]
    set = { "jet.length" = "3 cm" }            # optional: keys of it that are otherwise
    profiles = ["core_polymer_fraction"]       # optional: along the jet, not only numbers
    points = 101                               # of a profile

    [design]                                   # optional; "grid" without it
    kind = "latin-hypercube"                   # "grid", "sobol", "table", "sensitivity"
    samples = 1000
    seed = 0

    [vary]
    "jet.k" = { loguniform = [0.5, 2.0] }      # linspace, logspace = [from, to, number]; values = [...]
    "solution.mass_fraction" = { uniform = ["3 wt%", "8 wt%"] }
"""

import difflib
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spinline.base.errors import InputError
from spinline.base.text import parsed_toml, read_toml_text
from spinline.base.words import label
from spinline.scene.file import LONGEST, Scene, apply_override, bundled_scenes, read_toml, scene_from_dict
from spinline.scene.keys import full_key, is_section, placed, read_value
from spinline.study.axes import axes_of, column, not_both
from spinline.study.design import KINDS, Axis, Design
from spinline.study.table import read_table

__all__ = ["Sweep", "bundled_sweeps", "load_sweep", "scene_tables", "sweep_from_dict"]

_TOP = ("title", "scene", "set", "profiles", "points", "chunk", "design", "vary")
_DESIGN = ("kind", "samples", "seed", "path")
_LAYOUT = 2  # of stores: one of another is another sweep


@dataclass(frozen=True, eq=False)
class Sweep:
    """A checked sweep.

    Attributes
    ----------
    title, text : str
        What it is, and the TOML it was made from.
    base : dict
        Tables of the base scene.
    folder : Path
        Where relative paths of the scene start.
    design : Design
        The rows.
    profiles : tuple of str
        Variables kept along the jet.
    points : int
        Of a profile.
    chunk : int or None
        Rows that are computed and stored together; None: chosen from the cost.
    """

    title: str
    text: str
    base: Mapping[str, Any]
    folder: Path
    design: Design
    profiles: tuple[str, ...] = ()
    points: int = 101
    chunk: int | None = None

    def scene(self, values: Mapping[str, Any]) -> Scene:
        """The scene of one row.

        Raises
        ------
        InputError
            Where it is none.
        """
        return scene_from_dict(placed(self.base, values), folder=self.folder, name="scene")

    def fingerprint(self) -> str:
        """Says whether two sweeps are the same: scene, files it reads, design, profiles, version."""
        from spinline.base.version import __version__

        parts = [
            __version__,
            _LAYOUT,
            self.base,
            self.design.digest(),
            self.profiles,
            self.points,
            _files(self.base, self.folder),
        ]
        return hashlib.sha256(json.dumps(parts, sort_keys=True, default=repr).encode()).hexdigest()


def scene_tables(text: str) -> dict[str, Any]:
    """Tables of a scene from its text, overrides (``# --set`` at its end) put in."""
    data = parsed_toml(text, "scene", "scene")
    for line in text.splitlines():
        if line.startswith("# --set "):
            apply_override(data, line.removeprefix("# --set "))
    return data


def bundled_sweeps() -> dict[str, Path]:
    """Names of the bundled sweeps and their files."""
    folder = next(iter(bundled_scenes().values())).parent.parent / "sweeps"
    return {file.stem: file for file in sorted(folder.glob("*.toml"))}


def load_sweep(source: str | Path, overrides: Sequence[str] = (), *, sensitivity: bool = False) -> Sweep:
    """Read a sweep file, or a bundled sweep by its name.

    Parameters
    ----------
    source : path or str
        TOML file, or a name that `bundled_sweeps` lists.
    overrides : sequence of str
        ``"jet.beta=0.5"``: replaces a key of the base scene.
    sensitivity : bool
        Take the design of Sobol' indices, whatever the file's.

    Raises
    ------
    InputError
        For a file that cannot be read, and every key or value that cannot be right.
    """
    data, text, path = read_toml(source, bundled_sweeps(), (), "sweep")
    if sensitivity:
        design = data.get("design")
        data["design"] = {**(design if isinstance(design, dict) else {}), "kind": "sensitivity"}
    return sweep_from_dict(data, overrides, text=text, folder=path.resolve().parent)


def sweep_from_dict(
    data: Mapping[str, Any], overrides: Sequence[str] = (), *, text: str = "", folder: Path | None = None
) -> Sweep:
    """Check a sweep given as nested dictionaries; relative paths start from `folder`.

    Raises
    ------
    InputError
        With the key, the value, what is allowed and what to do.
    """
    home = folder or Path()
    _known(data, _TOP, "")
    base, at = _base(data.get("scene"), home)
    _set(base, _table(data, "set"))
    for override in overrides:
        apply_override(base, override)
    design = _table(data, "design")
    _known(design, _DESIGN, "design.")
    kind = design.get("kind", "grid")
    if kind not in KINDS:
        raise InputError(
            "design.kind",
            "is not known",
            value=kind,
            allowed=", ".join(f'"{k}"' for k in KINDS),
            remedy="take one of those",
        )
    vary = {} if kind == "table" and "vary" not in data else _table(data, "vary")
    axes = axes_of(vary)
    if kind == "table":
        axes = _from_table(design, axes, home)
    elif "path" in design:
        raise InputError(
            "design.path", "is only for a table", value=design["path"], remedy='add kind = "table", or drop it'
        )
    if not axes:
        raise InputError(
            "vary", "is missing or empty", remedy='add [vary] with, for example, "jet.k" = {values = [1, 2]}'
        )
    not_both([axis.key for axis in axes])
    sampled = kind not in ("grid", "table")
    if sampled and "samples" not in design:
        raise InputError("design.samples", "is missing", remedy="say how many scenes, for example samples = 1024")
    sweep = Sweep(
        title=label(_string(data, "title")),
        text=text,
        base=base,
        folder=at,
        design=Design(
            kind,
            axes,
            _whole(design, "samples", 1, 10**8, "design.") if sampled else 0,
            _whole(design, "seed", 0, 2**63 - 1, "design.", 0),
        ),
        profiles=_profiles(data.get("profiles", [])),
        points=_whole(data, "points", 2, 100_000, "", 101),
        chunk=_whole(data, "chunk", 1, 10**7, "") if "chunk" in data else None,
    )
    _sound(sweep)
    return sweep


def _base(scene: Any, home: Path) -> tuple[dict[str, Any], Path]:
    """Tables of the base scene and the folder of its paths."""
    if isinstance(scene, Mapping):
        data: dict[str, Any] = json.loads(json.dumps(scene, default=str))
        at = home
    elif isinstance(scene, str):
        path = home / scene if (home / scene).exists() else bundled_scenes().get(scene, Path(scene))
        if not path.is_file():
            near = difflib.get_close_matches(scene, bundled_scenes(), n=1)
            raise InputError(
                "scene",
                "is not a scene",
                value=scene,
                allowed="a path from the sweep file, or a bundled name",
                remedy=f"did you mean {near[0]!r}?" if near else "`spinline scenes` lists them",
            )
        data, _ = read_toml_text(path, "scene", LONGEST, "give a TOML scene")
        at = path.resolve().parent
    else:
        problem = "is missing" if scene is None else "is neither a name nor a scene"
        raise InputError("scene", problem, value=scene, remedy='add scene = "peo5-water", a path, or a table [scene]')
    return data, at


def _set(data: dict[str, Any], changes: Mapping[str, Any], before: str = "") -> None:
    """Put fixed values into the base scene; ``jet.length`` with and without quotes is one key."""
    for key, value in changes.items():
        name = f"{before}{key}"
        if isinstance(value, Mapping) and is_section(name):
            _set(data, value, f"{name}.")
            continue
        known = full_key(name, f"set.{name}")
        read_value(known, value, f"set.{name}")
        data.update(placed(data, {known: value}))


def _from_table(design: Mapping[str, Any], axes: list[Axis], home: Path) -> list[Axis]:
    if axes:
        raise InputError("vary", "is given beside a table", remedy="put its keys into the table's columns, or drop it")
    path = design.get("path")
    if not isinstance(path, str):
        raise InputError(
            "design.path",
            "is missing" if path is None else "is not a path",
            value=path,
            remedy='give the CSV file: path = "conditions.csv"',
        )
    return [Axis(key, column(values)) for key, values in read_table(home / path).items()]


def _profiles(names: Any) -> tuple[str, ...]:
    from spinline.study.rows import PROFILES

    if not isinstance(names, list):
        raise InputError("profiles", "is not a list", value=names, remedy='for example ["radius"]')
    for name in names:
        if name not in PROFILES:
            near = difflib.get_close_matches(str(name), PROFILES, n=1)
            raise InputError(
                "profiles",
                "is not a variable along a jet",
                value=name,
                allowed=", ".join(PROFILES),
                remedy=f"did you mean {near[0]!r}?" if near else "take one of those",
            )
    return tuple(dict.fromkeys(names))


def _sound(sweep: Sweep) -> None:
    """Refuse a sweep of which no scene can be right for a reason outside the keys that vary."""
    from spinline.setup.build import build_solution
    from spinline.solve.spine import examine
    from spinline.study.rows import jet_of

    errors = []
    for i in sorted({0, sweep.design.size // 2, sweep.design.size - 1}):
        values = {key: values.tolist()[0] for key, values in sweep.design.rows(i, i + 1).items()}
        try:
            scene = sweep.scene(values)
            solution = build_solution(scene)
            examine(scene, solution, jet_of(scene, str(sweep.folder)))
        except InputError as error:
            errors.append(error)
            continue
        if sweep.profiles and scene.jet.profile in ("jetspin", "lagrangian"):
            raise InputError("profiles", "needs a straight jet", value=list(sweep.profiles), remedy="drop it")
        if getattr(scene.jet, "time", "") == "all":
            raise InputError(
                "scene.jet.time",
                "is all of them, and a row of a sweep is one",
                value="all",
                remedy="give a time, or vary it",
            )
        return
    first = errors[0]
    same = all(str(error) == str(first) for error in errors)
    varied = any(key in first.field or first.field in key for key in sweep.design.keys)
    if same and (not varied or first.problem == "is not a known key"):
        field = first.field if varied or first.field == "scene" else f"scene.{first.field}"
        raise InputError(
            field,
            first.problem,
            value=first.value,
            allowed=first.allowed,
            remedy=first.remedy.replace("in the scene", "in the base scene"),
        )


def _files(base: Mapping[str, Any], folder: Path) -> list[Any]:
    """Names, sizes and times of the files that the base scene reads."""
    jet = base.get("jet")
    path = jet.get("path") if isinstance(jet, Mapping) else None
    if not isinstance(path, str):
        return []
    place = folder / path
    files = sorted(place.iterdir()) if place.is_dir() else [place]
    return [(file.name, file.stat().st_size, file.stat().st_mtime_ns) for file in files if file.is_file()]


def _known(data: Mapping[str, Any], allowed: Sequence[str], before: str) -> None:
    for key in data:
        if key not in allowed:
            near = difflib.get_close_matches(key, allowed, n=1)
            raise InputError(
                f"{before}{key}",
                "is not a known key",
                value=data[key],
                allowed=", ".join(allowed),
                remedy=f"did you mean {near[0]!r}?" if near else "take it out",
            )


def _table(data: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = data.get(key, {})
    if not isinstance(value, Mapping):
        raise InputError(key, "is not a table", value=value, remedy=f"write it as [{key}]")
    return value


def _string(data: Mapping[str, Any], key: str) -> str:
    value = data.get(key, "")
    if not isinstance(value, str):
        raise InputError(key, "is not text", value=value, remedy="put it in quotes")
    return value


def _whole(data: Mapping[str, Any], key: str, low: int, high: int, before: str, default: int | None = None) -> int:
    value = data.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InputError(
            f"{before}{key}",
            "is not a whole number in range",
            value=value,
            allowed=f"{low} to {high}",
            remedy="change it in the sweep file",
        )
    return value
