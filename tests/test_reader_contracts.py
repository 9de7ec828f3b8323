"""Readers of a run: any part of its columns, and any part of its files, gives data or a named refusal."""

import contextlib
import itertools
import random
import shutil
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin import read_jetspin, read_statistics
from spinline.jetprofile.lagrangian import LagrangianJet

RUN = Path(__file__).parent / "data" / "jetspin" / "ex2_1d_insert"
WIDTH = 20  # of a column of the table


def _table() -> tuple[list[str], list[list[str]]]:
    """Headers and rows of the table of statistics."""
    lines = (RUN / "statout.dat").read_text(encoding="utf-8").splitlines()
    cells = [[line[1:][max(0, i) : i + WIDTH].strip() for i in range(-10, len(line) - 1, WIDTH)] for line in lines]
    heads = next(cells[i] for i, line in enumerate(lines) if line.startswith("#") and "nstep" in line)
    rows = [line.split() for line in lines if line.strip() and not line.startswith("#")]
    return heads, rows[:6]


def _written(path: Path, heads: list[str], rows: list[list[str]], chosen: tuple[int, ...]) -> None:
    """The table with the step and the chosen columns: the step in 10 characters, each other in 20."""
    bar = "#" + "*" * 9 + "".join(" " + "*" * (WIDTH - 1) for _ in chosen)
    head = "#" + heads[0].rjust(9) + "".join(heads[i].rjust(WIDTH) for i in chosen)
    body = [row[0].rjust(10) + "".join(row[i].rjust(WIDTH) for i in chosen) for row in rows]
    path.write_text("\n".join([bar, head, bar, *body]) + "\n", encoding="utf-8")


def _subsets(count: int) -> list[tuple[int, ...]]:
    rng = random.Random(7)
    ones = [(i,) for i in range(1, count)]
    pairs = list(itertools.combinations(range(1, count), 2))
    others = [tuple(sorted(rng.sample(range(1, count), rng.randint(3, count - 1)))) for _ in range(60)]
    return [*ones, *pairs, *others]


def _or_refusal(read: Callable[..., Any], *arguments: Any) -> Any:
    """What a reader gives; None where it refuses by name."""
    with warnings.catch_warnings(), contextlib.suppress(InputError):
        warnings.simplefilter("ignore")
        return read(*arguments)
    return None


def test_every_part_of_the_columns_of_statistics(tmp_path) -> None:
    heads, rows = _table()
    assert len(heads) == len(rows[0])
    read = 0
    for chosen in _subsets(len(heads)):
        _written(tmp_path / "statout.dat", heads, rows, chosen)
        found = _or_refusal(read_statistics, tmp_path / "statout.dat")
        if found is None:
            continue
        read += 1
        _or_refusal(read_jetspin, tmp_path)  # other readers get the same table, and may want what it lacks
        _or_refusal(lambda table: LagrangianJet.from_dataset(table).at(), found)
        for variable in found.variables.values():
            assert np.asarray(variable.values).size == len(rows)
    assert read > 20


@pytest.mark.parametrize("number", range(1, 5))
def test_every_part_of_the_files_of_a_run(number, tmp_path) -> None:
    names = ("input.dat", "log.txt", "statout.dat", "save.dat", "traj.xyz", "traj.dat", "frame000002.xyz")
    read = 0
    for i, chosen in enumerate(itertools.combinations(names, number)):
        folder = tmp_path / str(i)
        folder.mkdir()
        for name in chosen:
            shutil.copyfile(RUN / name, folder / name)
        for reader in (read_jetspin, read_statistics):
            found = _or_refusal(reader, folder)
            read += found is not None
            assert found is None or found.sizes
    assert read >= number
