"""One row of a sweep: a scene's numbers, or the reason why it has none.

`evaluate_rows` takes scenes one by one through `spinline.solve.spine.evaluate`, whatever their model; a row that cannot be
computed becomes NaN with a status and a reason, never an exception. What it reads from files is read once a process.

======  ==============  ======================================================================
status  name            meaning
======  ==============  ======================================================================
0       ``ok``          computed
1       ``incomplete``  computed; a number is NaN because the jet does not reach it, see reason
2       ``refused``     not a scene that can be computed; the reason is what ``spinline run`` says
3       ``failed``      an error that was not foreseen; the reason names it
255                     not computed yet
======  ==============  ======================================================================
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.base.files import stamp
from spinline.jetprofile.straight import StraightJet
from spinline.network_models.registry import RUNGS, rung_in
from spinline.scene.file import Scene, scene_from_dict
from spinline.scene.keys import placed
from spinline.setup.build import build_solution
from spinline.setup.jet import build_jet, built_from_numbers
from spinline.solve.many import AT_END
from spinline.solve.results import VARIABLES
from spinline.solve.solved import Solved
from spinline.solve.spine import evaluate
from spinline.solve.summary import FIBRE, SUMMARISED, summarised
from spinline.solve.uncertainty import shares
from spinline.study.design import Column

__all__ = [
    "CLOSED_FORMS",
    "COMPILED",
    "FAILED",
    "INCOMPLETE",
    "OK",
    "PENDING",
    "REFUSED",
    "SCALARS",
    "SINGLE",
    "WAYS",
    "Block",
    "Task",
    "evaluate_rows",
    "numbers",
]

OK, INCOMPLETE, REFUSED, FAILED, PENDING = 0, 1, 2, 3, 255
CLOSED_FORMS, COMPILED, SINGLE = 0, 1, 2
WAYS = {
    CLOSED_FORMS: "by closed forms on arrays",
    COMPILED: "by the compiled march of slipping networks",
    SINGLE: "run by themselves",
}
STATUS_NAMES = {OK: "ok", INCOMPLETE: "incomplete", REFUSED: "refused", FAILED: "failed", PENDING: "pending"}

# along the jet; the flags and what only some models have are left to `spinline run`
PROFILES = (
    "z",
    "radius",
    "velocity",
    "velocity_ratio",
    "strain_rate",
    "residence_time",
    "stretch_ratio",
    "mean_polymer_fraction",
    "network_velocity_ratio",
    "axial_stretch",
    "relative_extension",
    "radial_contraction",
    "orientation",
    "network_radius",
    "network_radius_conservative",
    "core_polymer_fraction",
    "core_polymer_fraction_eq40",
    "core_polymer_fraction_conservative",
    "strand_force",
)
AT_CROSSOVER = SUMMARISED
STD_FLAG = "uncertainty"  # 0 followed, 1 for some inputs in part or not at all, 2 not followed
# name: (unit, what it is)
SCALARS: dict[str, tuple[str, str]] = (
    {
        name: VARIABLES[name]
        for name in (
            "volume_fraction",
            *(f"crossover_{what}" for what in ("position", "radius", "radius_ratio", "velocity_ratio")),
            *(f"crossover_extension_{what}" for what in ("position", "radius", "radius_ratio", "velocity_ratio")),
        )
    }
    | {f"crossover_{name}": (VARIABLES[name][0], f"at the crossover: {VARIABLES[name][1]}") for name in AT_CROSSOVER}
    | {f"end_{name}": (VARIABLES[name][0], f"at the end of the jet: {VARIABLES[name][1]}") for name in AT_END}
    | {name: VARIABLES[name] for name in FIBRE}
)
BEYOND = {  # reasons of status 1
    "crossover_position": "the crossover is not reached within the jet",
    "crossover_extension_position": "the extension of the criterion is not reached within the jet",
}
BOTH = "; ".join(BEYOND.values())
_NONE_IS_NEWS = "bending_onset"  # NaN says that the whole jet is straight, not that a number is missing
_LONGEST = 400  # characters of a reason


@dataclass(frozen=True)
class Task:
    """What is the same for all rows; small, and the same in every process.

    Attributes
    ----------
    base : mapping
        Tables of the base scene.
    folder : str
        Where its paths start.
    profiles : tuple of str
        Variables along the jet, at `points` places.
    points : int
    extra : tuple of str
        Numbers of a run beyond `SCALARS`, that other models have.
    vectorise : bool
        Try the closed forms of `sweep_affine` first.
    uncertain : tuple of str
        Keys of the base scene that carry ``+/-`` and do not vary: every number then has a ``_std`` beside it.
    """

    base: Mapping[str, Any]
    folder: str
    profiles: tuple[str, ...] = ()
    points: int = 101
    extra: tuple[str, ...] = ()
    vectorise: bool = False
    uncertain: tuple[str, ...] = ()

    @property
    def numbers(self) -> tuple[str, ...]:
        """Columns of numbers."""
        plain = (*SCALARS, *self.extra)
        return (*plain, *(f"{name}_std" for name in plain), STD_FLAG) if self.uncertain else plain

    def scene(self, values: Mapping[str, Any]) -> Scene:
        """The scene of one row."""
        return scene_from_dict(placed(self.base, values), folder=Path(self.folder), name="scene")


@dataclass(frozen=True, eq=False)
class Block:
    """Results of consecutive rows.

    Attributes
    ----------
    numbers : dict of str to ndarray, (rows,)
    profiles : dict of str to ndarray, (rows, points)
    status : ndarray of uint8, (rows,)
    way : ndarray of uint8, (rows,)
        How the row was computed: see `WAYS`.
    reason : ndarray of str, (rows,)
        Empty where the status is 0.
    """

    numbers: dict[str, FloatArray]
    profiles: dict[str, FloatArray]
    status: NDArray[np.uint8]
    way: NDArray[np.uint8]
    reason: NDArray[np.object_]

    @classmethod
    def empty(cls, task: Task, rows: int) -> "Block":
        """NaN everywhere, nothing computed."""
        return cls(
            {name: np.full(rows, np.nan) for name in task.numbers},
            {name: np.full((rows, task.points), np.nan) for name in task.profiles},
            np.full(rows, PENDING, dtype=np.uint8),
            np.full(rows, PENDING, dtype=np.uint8),
            np.full(rows, "", dtype=object),
        )


def evaluate_rows(
    task: Task, columns: Mapping[str, Column], rows: Sequence[int] | None = None, into: Block | None = None
) -> Block:
    """Scenes one by one.

    Parameters
    ----------
    task : Task
        Base scene and what to keep.
    columns : mapping
        Key to the values of every row.
    rows : sequence of int, optional
        Only these.
    into : Block, optional
        Where the results go; the others of its rows are left alone.

    Returns
    -------
    Block
    """
    size = len(next(iter(columns.values())))
    block = Block.empty(task, size) if into is None else into
    lists = {key: values.tolist() for key, values in columns.items()}
    for i in range(size) if rows is None else rows:
        block.way[i] = SINGLE
        try:
            scene = task.scene({key: values[i] for key, values in lists.items()})
            solved = solve_row(scene, task)
            found = numbers(solved)
            for name, value in (found | _uncertainties(solved, task, found)).items():
                if name in block.numbers:
                    block.numbers[name][i] = value
            for name, along in _profiles(solved, task).items():
                block.profiles[name][i] = along
            missing = _missing(block, i)
            block.status[i] = INCOMPLETE if missing else OK
            block.reason[i] = missing
        except InputError as error:
            _strike(block, i, REFUSED, str(error))
        except Exception as error:
            _strike(block, i, FAILED, f"{type(error).__name__}: {error}")
    return block


def numbers(solved: Solved) -> dict[str, float]:
    """Numbers of a solved scene: those of ``spinline run``, and the network at the crossover and at the end of the jet."""
    result = {name: float(value) for name, value in solved.scalars.items() if np.ndim(value) == 0}
    fields = solved.fields
    place = fields["arc_length" if "arc_length" in fields else "z"]
    known = np.flatnonzero(np.isfinite(fields["stretch_ratio"]))
    result |= summarised(place, fields, result.get("crossover_position", np.nan), result)
    if known.size:
        result |= {f"end_{name}": float(fields[name][known[-1]]) for name in AT_END}
    return result


def _uncertainties(solved: Solved, task: Task, found: Mapping[str, float]) -> dict[str, float]:
    """Standard uncertainties from the inputs', by the rung that was taken, and how far they were followed."""
    if not task.uncertain:
        return {}
    if rung_in(solved.scene.network).sampled:
        return {STD_FLAG: 2.0}

    def again(scene: Scene) -> dict[str, float]:
        jet = None if built_from_numbers(scene) else jet_of(scene, task.folder)
        return numbers(evaluate(scene, jet, attributes=False))

    stds, remarks = shares(solved.scene, found, again)
    return {**stds, STD_FLAG: 1.0 if remarks else 0.0}


def profile_grid(span: FloatArray, scale: FloatArray, points: int) -> FloatArray:
    """Places of a profile in initial radii from the start, (..., points): `spinline.setup.grid.jet_grid` without kinks."""
    share = np.linspace(0.0, 1.0, points)
    length = np.asarray(scale)[..., np.newaxis]
    grid = length * np.expm1(share * np.log1p(np.asarray(span)[..., np.newaxis] / length))
    grid[..., -1] = span
    return grid


def solve_row(scene: Scene, task: Task) -> Solved:
    """`spinline.solve.spine.evaluate` with no more points than needed, and a jet from files read once a process."""
    rung = RUNGS.get(
        scene.network.model
    )  # of the rungs that "auto" takes numbers do not depend on how many points are written
    if task.profiles or rung is None or rung.lean:
        points = task.points if task.profiles else 2
        scene = scene.model_copy(update={"accuracy": scene.accuracy.model_copy(update={"points": points})})
        scene._folder = Path(task.folder)
    if built_from_numbers(scene):
        return evaluate(scene, attributes=False)
    return evaluate(scene, jet_of(scene, task.folder), attributes=False)


def _profiles(solved: Solved, task: Task) -> dict[str, FloatArray]:
    if not task.profiles:
        return {}
    jet, z = solved.jet, solved.fields["z"]
    if not isinstance(jet, StraightJet):
        raise InputError("profiles", "needs a straight jet", remedy="take them out of the sweep")
    r0 = jet.initial_radius
    scale = np.asarray(min([1.0, *(kink for kink in jet.kinks() if kink > 0)]))
    grid = jet.start + r0 * profile_grid(np.asarray((z[-1] - jet.start) / r0), scale, task.points)
    nearest = np.clip(np.searchsorted(z, grid), 1, z.size - 1)
    nearest -= grid - z[nearest - 1] < z[nearest] - grid
    return {name: np.asarray(solved.fields[name], dtype=np.float64)[nearest] for name in task.profiles}


class _Key:
    """A jet section, its folder and the state of its files; the scene rides along and does not count."""

    def __init__(self, section: Any, folder: str, scene: Scene) -> None:
        file = Path(folder) / getattr(section, "path", "")
        files = sorted(file.iterdir()) if file.is_dir() else [file] if file.exists() else []
        files = files if hasattr(section, "path") else []
        self.identity, self.scene = (section, folder, tuple((str(f), stamp(f)) for f in files)), scene

    def __hash__(self) -> int:
        return hash(self.identity)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and self.identity == other.identity


def jet_of(scene: Scene, folder: str) -> Any:
    """The jet of a scene; one that is read from files is kept, since it does not depend on the solution."""
    if built_from_numbers(scene):
        return build_jet(scene, build_solution(scene))
    return _built(_Key(scene.jet, folder, scene))


@lru_cache(maxsize=16)
def _built(key: _Key) -> Any:
    return build_jet(key.scene, build_solution(key.scene))


def _missing(block: Block, i: int) -> str:
    """Why numbers of a computed row are NaN; empty where none is."""
    absent = [
        name
        for name, values in block.numbers.items()
        if np.isnan(values[i]) and name != STD_FLAG and not name.endswith("_std") and not name.startswith(_NONE_IS_NEWS)
    ]
    words = [text for name, text in BEYOND.items() if name in absent]
    others = [name for name in absent if not (name.startswith("crossover") and words)]
    return "; ".join([*words, *([f"does not happen in this jet: {', '.join(others)}"] if others else [])])


def _strike(block: Block, i: int, status: int, reason: str) -> None:
    for values in block.numbers.values():
        values[i] = np.nan
    for along in block.profiles.values():
        along[i] = np.nan
    block.status[i] = status
    text = " ".join(reason.split())
    block.reason[i] = text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
