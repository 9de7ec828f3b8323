"""Compiled loops against numba's own compiler: the same bits, and no array forgotten."""

from typing import Any

import numba
import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from spinline.base import compiling
from spinline.base.kernels import njit, plain
from spinline.rheology._elimination import eliminate
from spinline.rheology._heat_kernels import _number, activities

NAN, INF = float("nan"), float("inf")


def sums(a, b, i, j):  # type: ignore[no-untyped-def]
    return a + b, a - b, a * b, a / b, i + j, i - j, i * j, i / j, i // j, i % j, a + i, i * a, a**2, a**b, -a, a // b


def orders(a, b, i, j):  # type: ignore[no-untyped-def]
    return a < b, a <= b, a > b, a >= b, a == b, a != b, i < j, i <= j, i > j, i >= j, i == j, i != j, a < i, i != b


def elements(x, table, flags, turns, whole):  # type: ignore[no-untyped-def]
    last = table.shape[1] - 1
    x[-1] = table[0, -2] + x[0]
    table[-1, 1], table[1, 0] = table[1, 0], table[-1, 1]
    table[0, last] += 3
    flags[1], flags[-1] = x[0] > 0, flags[0]
    turns[-2] = turns[0] * turns[1] + 1j
    whole[1] = 7.9
    whole[np.uint8(2)] = whole[-1] + np.int32(5)
    return x[1], table[np.int8(-1), -1], turns[-1].real, whole[0]


def ranges(first, last, step):  # type: ignore[no-untyped-def]
    total, seen = 0, 0
    for i in range(last):
        for j in range(first, i):
            total += 3 * i - j
        seen += 1
    for i in range(last, first, step):
        total -= i * i
    for k in range(np.int32(3)):
        total += k
    for _ in range(2**62, -(2**62)):
        total += 1000000
        break
    return total, seen, len(range(first, last)), len(range(last, first, step))


def views(table):  # type: ignore[no-untyped-def]
    part, row, turned = table[:, 1:], table[1], table.T
    part[0, 0] = 8.0
    row[0] = part[1, -1] + turned[-1, 0]
    for line in table:
        line[1] *= 2
    pair = (row, part)
    return row.sum() + pair[1][1, 0] + table[::2, ::-1][0, 0]


def new(table):  # type: ignore[no-untyped-def]
    made = np.zeros(4)
    made[1:] += table[0, 0] * np.arange(3.0)
    kept = [made[i] for i in range(4) if i != 2]
    shares = made / made.sum()
    held = (made, table)
    return made, shares[::-1].copy(), held, np.array([1.0, kept[0], 3.0]), table[1]


def raises(x, i):  # type: ignore[no-untyped-def]
    if x[i] < 0:
        raise ValueError("below")
    return x[i]


_TABLE = np.arange(12.0).reshape(3, 4)
CASES: list[tuple[Any, list[tuple[Any, ...]]]] = [
    (sums, [(0.1, 0.3, 7, -2), (-2.5, INF, -7, 3), (NAN, 1e-320, 2**62, 2**62)]),
    (orders, [(0.1, 0.3, 7, -2), (NAN, 0.3, 0, 0), (INF, INF, -1, 2**62), (0.0, -0.0, 5, 5)]),
    (
        elements,
        [
            (np.array([1.0, 2.0, 3.0]), table, np.zeros(3, bool), np.arange(3) * 1j, np.arange(4))
            for table in (
                _TABLE,
                np.asfortranarray(_TABLE),
                np.tile(_TABLE, (2, 2))[::2, ::2],
                _TABLE.astype(np.float32),
            )
        ],
    ),
    (ranges, [(0, 5, -1), (3, 2, 2), (-4, 4, -3), (5, -5, 1)]),
    (views, [(_TABLE,), (np.asfortranarray(_TABLE),)]),
    (new, [(_TABLE,)]),
]


def copied(given: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(a.copy(order="K") if isinstance(a, np.ndarray) else a for a in given)


def flat(value: Any) -> list[bytes]:
    if isinstance(value, tuple):
        return [piece for one in value for piece in flat(one)]
    return [np.asarray(value).tobytes(), str(np.asarray(value).dtype).encode()]


@pytest.mark.parametrize(("function", "every"), CASES, ids=[case[0].__name__ for case in CASES])
def test_the_same_bits_as_numba(function: Any, every: list[tuple[Any, ...]]) -> None:
    ours, theirs = njit(error_model="numpy")(function), numba.njit(error_model="numpy")(function)

    @njit(error_model="numpy")  # type: ignore[untyped-decorator]
    def within(*given):  # type: ignore[no-untyped-def]
        return ours(*given)

    for given in every:
        expected = copied(given)
        want = theirs(*expected)
        for loop in (ours, within):
            found = copied(given)
            value = loop(*found)
            assert flat(value) == flat(want)
            assert flat(found) == flat(expected)


def test_division_by_zero_is_an_error_where_python_is_meant() -> None:
    def ratio(a, b):  # type: ignore[no-untyped-def]
        return a / b

    with pytest.raises(ZeroDivisionError, match="zero"):
        njit()(ratio)(1.0, 0.0)
    assert njit(error_model="numpy")(ratio)(1.0, 0.0) == INF


def test_a_range_that_stands_still_is_an_error() -> None:
    with pytest.raises(ValueError, match="zero"):
        njit()(ranges)(0, 3, 0)


def test_errors_arrive_from_within() -> None:
    inner = njit()(raises)

    @njit()  # type: ignore[untyped-decorator]
    def outer(x, i):  # type: ignore[no-untyped-def]
        return inner(x, i) + 1

    assert outer(np.array([1.0, -1.0]), 0) == 2
    with pytest.raises(ValueError, match="below"):
        outer(np.array([1.0, -1.0]), 1)


def test_bounds_are_checked_where_asked() -> None:
    @njit(boundscheck=True)  # type: ignore[untyped-decorator]
    def at(x, i):  # type: ignore[no-untyped-def]
        return x[i]

    assert at(np.arange(3.0), -1) == 2
    with pytest.raises(IndexError):
        at(np.arange(3.0), 3)


def test_every_array_is_given_back() -> None:
    made, looked = njit()(new), njit()(views)

    @njit()  # type: ignore[untyped-decorator]
    def both(table):  # type: ignore[no-untyped-def]
        first, second, _, third, row = made(table)
        return first, looked(table) + second[0] + third[2] + row[0]

    table = _TABLE.copy()
    both(table)
    _nrt_python.memsys_enable_stats()
    before = rtsys.get_allocation_stats()
    for _ in range(50):
        assert both(table)[0].size == 4
    after = rtsys.get_allocation_stats()
    assert after.alloc > before.alloc
    assert after.alloc - before.alloc == after.free - before.free
    assert after.mi_alloc - before.mi_alloc == after.mi_free - before.mi_free


def test_only_loops_that_make_no_arrays_go_uncounted(monkeypatch: pytest.MonkeyPatch) -> None:
    seen, judge = {}, compiling._only_borrows

    def note(lower: Any) -> bool:
        seen[lower.fndesc.qualname.rpartition(".")[2]] = judge(lower)
        return seen[lower.fndesc.qualname.rpartition(".")[2]]

    monkeypatch.setattr(compiling, "_only_borrows", note)

    def gives(x):  # type: ignore[no-untyped-def]
        return x

    def sets(x, y):  # type: ignore[no-untyped-def]
        x[1:] = y[:-1]

    def takes(x):  # type: ignore[no-untyped-def]
        x[0] = x[1:].sum()

    def counts(x):  # type: ignore[no-untyped-def]
        for i in range(x.shape[0]):
            x[i, 0] += x[i][1] * x[0, 1:][0]

    njit()(gives)(np.ones(2))
    njit()(sets)(np.ones(2), np.ones(2))
    njit()(takes)(np.ones(2))
    njit()(counts)(np.ones((2, 2)))
    assert seen == {"gives": False, "sets": False, "takes": False, "counts": True}


def test_a_loop_in_plain_python() -> None:
    assert plain(_number)(1, 0.3, 0.1, 2.0, 0.0) == pytest.approx(_number(1, 0.3, 0.1, 2.0, 0.0), rel=1e-15)
    matrix, right = np.array([[0.0, 2.0], [1.0, 1.0]]), np.array([2.0, 3.0])
    assert plain(eliminate)(matrix, right)
    assert right.tolist() == [2.0, 1.0]
    assert not plain(eliminate)(np.zeros((2, 2)), right)


@pytest.mark.parametrize("unit", [0.0, 1e-4])
def test_activities_at_many_places_are_those_at_each(unit: float) -> None:
    chance = np.random.default_rng(3)
    sub, pairs, volumes = chance.uniform(0.1, 1, (3, 10)), chance.uniform(0, 1, (3, 3)), chance.uniform(0, 0.3, (3, 7))
    every, one = np.empty_like(volumes), np.empty(3)
    left = plain(activities)(volumes, 0.1, sub, pairs, unit, every)
    for k in range(7):
        assert activities(volumes[:, k].copy(), 0.1, sub, pairs, unit, one) == pytest.approx(left[k], rel=1e-15)
        np.testing.assert_allclose(every[:, k], one, rtol=1e-14)
