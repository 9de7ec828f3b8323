"""Sweeps: many scenes, one result. `load_sweep` reads the file, `run_sweep` computes it, `open_sweep` reads what was stored.

===============================  ==========================================================================================
scenes                           how, and what it costs on one core
===============================  ==========================================================================================
affine, straight, numbers only   closed forms on arrays: 2 us a scene
the same, "auto" or "manifold"   the plan by the array, 30 us; networks that slip by a compiled march, 0.1 ms
any other                        one by one: 1 ms a scene and what its model costs; in processes where it is worth it
a scheduler's address is given   the same through dask.distributed: tasks carry a few kilobytes, not arrays
===============================  ==========================================================================================

Row i follows from the design, its seed and i: results are the same bits for any number of workers, after a kill and a
second start, and wherever a worker died. What was stored is not computed again; chunks that were under way are.
"""

import os
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.workers import start_worker
from spinline.study.closed_forms import closed_forms, why_not
from spinline.study.design import Column
from spinline.study.rows import PENDING, SCALARS, Block, Task, evaluate_rows, numbers, solve_row
from spinline.study.store import Memory, Store, as_grid, open_sweep, peek
from spinline.study.sweep_file import Sweep, bundled_sweeps, load_sweep, sweep_from_dict

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Sweep", "as_grid", "bundled_sweeps", "load_sweep", "open_sweep", "run_sweep", "sweep_from_dict"]

Progress = Callable[[int, int], None]
_VECTOR_ROWS = 65_536
_VECTOR_PLACES = 2_000_000  # rows times points of a profile
_CHUNK_SECONDS = 2.0
_SERIAL_SECONDS = 4.0  # starting processes takes about that
_MOST_CHUNK = 1024
_DEATHS = 3  # of worker processes, before giving up
_AGREE = 1e-9
_SAMPLE = 512  # rows that are tried for closed forms
_CHEAP = 5e-5  # s a scene: hardly any is run by itself


def run_sweep(
    sweep: Sweep,
    out: str | Path | None = None,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    force: bool = False,
    vectorise: bool = True,
    progress: Progress | None = None,
) -> "xr.Dataset":
    """Compute the scenes of a sweep, or those that are still missing.

    Parameters
    ----------
    sweep : Sweep
        From `load_sweep` or `sweep_from_dict`.
    out : path, optional
        Store (zarr). It is gone on with if it holds a part of the same sweep. None: results in memory.
    workers : int, optional
        Processes; 1 computes in this one. None: as many as processors, if the sweep takes longer than starting them.
    scheduler : str, optional
        Address of a dask scheduler, "tcp://host:8786"; its workers need spinline and no shared disk.
    force : bool
        Start anew where `out` holds a sweep.
    vectorise : bool
        False sends affine scenes one by one, to compare.
    progress : callable, optional
        Called with (scenes done, scenes in all).

    Returns
    -------
    xarray.Dataset
        Along `scene`; see `open_sweep`.

    Raises
    ------
    InputError
        For an output that cannot be used, workers that cannot be reached or die. A scene that cannot be computed raises
        nothing: its row says why.

    Warns
    -----
    SpinlineWarning
        If the closed forms differ from single runs on the rows that are tried first; then all rows are single runs.
    """
    if workers is not None and not 1 <= workers <= 4096:
        raise InputError("workers", "is out of range", value=workers, allowed="1 to 4096", remedy="leave it out")
    path = None if out is None else Path(out)
    task, cost = _probe(sweep, vectorise)
    begun = None if path is None or force else peek(path)
    if begun is not None:  # numbers of the store, whatever was found this time
        task = replace(task, extra=tuple(str(begun.get("extra", "")).split()))
    chunk = sweep.chunk or _chunk(sweep, task, cost)
    attributes = _attributes(sweep, task)
    sink = (
        Memory(sweep, task, chunk, attributes)
        if path is None
        else Store(path, sweep, task, chunk, attributes, force=force)
    )
    size = sweep.design.size
    try:
        chunks = sink.pending()
        done = size - sum(_extent(sweep, sink.chunk, i)[1] for i in chunks)
        if progress:
            progress(done, size)
        for index, columns, block in _computed(sweep, task, sink.chunk, chunks, cost, workers, scheduler):
            sink.write(index, columns, block)
            done += len(block.status)
            if progress:
                progress(done, size)
    finally:
        sink.close()
    return sink.dataset()


def compute(task: Task, columns: Mapping[str, Column]) -> Block:
    """Rows of a sweep: by closed forms those that have them, one by one the others."""
    if not task.vectorise:
        return evaluate_rows(task, columns)
    block = closed_forms(task, columns)
    rest = np.flatnonzero(block.status == PENDING)
    return evaluate_rows(task, columns, rest.tolist(), block) if rest.size else block


def _computed(
    sweep: Sweep, task: Task, chunk: int, chunks: Sequence[int], cost: float, workers: int | None, scheduler: str | None
) -> Iterator[tuple[int, Mapping[str, Column], Block]]:
    if scheduler is not None:
        return _distributed(sweep, task, chunk, chunks, scheduler)
    if workers is None:
        rows = sum(_extent(sweep, chunk, i)[1] for i in chunks)
        workers = 1 if cost * rows < _SERIAL_SECONDS else len(os.sched_getaffinity(0))
    workers = min(workers, len(chunks))
    return _pooled(sweep, task, chunk, chunks, workers) if workers > 1 else _serial(sweep, task, chunk, chunks)


def _serial(
    sweep: Sweep, task: Task, chunk: int, chunks: Sequence[int]
) -> Iterator[tuple[int, Mapping[str, Column], Block]]:
    for i in chunks:
        columns = _rows(sweep, chunk, i)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SpinlineWarning)
            block = compute(task, columns)
        yield i, columns, block


def _pooled(
    sweep: Sweep, task: Task, chunk: int, chunks: Sequence[int], workers: int
) -> Iterator[tuple[int, Mapping[str, Column], Block]]:
    """Chunks in processes; when one dies the others' chunks are given out again."""
    left, deaths = list(chunks), 0
    while left:
        pool = ProcessPoolExecutor(workers, get_context("spawn"), initializer=start_worker, initargs=(os.getpid(),))
        waiting = iter(list(left))
        running: dict[Future[Block], int] = {}
        try:
            while True:
                for i in waiting:
                    running[pool.submit(compute, task, _rows(sweep, chunk, i))] = i
                    if len(running) >= 2 * workers:
                        break
                if not running:
                    break
                finished, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in finished:
                    i = running.pop(future)
                    block = future.result()
                    left.remove(i)
                    yield i, _rows(sweep, chunk, i), block
        except BrokenProcessPool:
            deaths += 1
            if deaths >= _DEATHS:
                raise InputError(
                    "workers",
                    f'died {deaths} times (out of memory, or started from a script without if __name__ == "__main__")',
                    value=workers,
                    remedy="take fewer, or workers = 1; what is done is kept",
                ) from None
        except BaseException:  # Ctrl-C, a full disk: the chunks under way are not waited for
            for process in list((getattr(pool, "_processes", None) or {}).values()):
                process.terminate()
            raise
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _distributed(
    sweep: Sweep, task: Task, chunk: int, chunks: Sequence[int], address: str
) -> Iterator[tuple[int, Mapping[str, Column], Block]]:
    """Chunks by a dask cluster; what a dead worker had is given to another by the scheduler."""
    try:
        from distributed import Client, as_completed
        from distributed.scheduler import KilledWorker
    except ImportError:
        raise InputError(
            "--scheduler",
            "needs dask.distributed, which is not installed",
            remedy='pip install "spinline[parallel]", or ".[parallel]" from the source',
        ) from None
    try:
        client = Client(address, timeout=10, set_as_default=False)
    except (OSError, ValueError, TypeError, TimeoutError) as error:
        raise InputError(
            "--scheduler",
            f"cannot be reached ({error})",
            value=address,
            remedy='give the address that `dask scheduler` prints, "tcp://host:8786"',
        ) from None
    with client:
        name = sweep.fingerprint()[:16]
        waiting = iter(chunks)
        running: dict[str, int] = {}

        def submit() -> Any:
            i = next(waiting, None)
            if i is None:
                return None
            future = client.submit(
                compute, task, _rows(sweep, chunk, i), key=f"spinline-{name}-{chunk}-{i}", pure=False
            )
            running[future.key] = i
            return future

        slots = max(1, sum(client.nthreads().values()))
        queue = as_completed(
            [future for future in (submit() for _ in range(4 * slots)) if future is not None], loop=client.loop
        )
        for future in queue:
            i = running.pop(future.key)
            try:
                block = future.result()
            except KilledWorker:
                raise InputError(
                    "--scheduler",
                    f"workers died again and again over rows {_extent(sweep, chunk, i)[0]} on",
                    value=address,
                    remedy="give them more memory, or a smaller chunk",
                ) from None
            except ModuleNotFoundError as error:
                raise InputError(
                    "--scheduler",
                    f"workers cannot import {error.name}",
                    value=address,
                    remedy="install the same spinline there",
                ) from None
            yield i, _rows(sweep, chunk, i), block
            future.release()
            more = submit()
            if more is not None:
                queue.add(more)


def _probe(sweep: Sweep, vectorise: bool) -> tuple[Task, float]:
    """What a row holds and costs, by trying some; and whether the closed forms say the same."""
    task = Task(
        base=sweep.base,
        folder=str(sweep.folder),
        profiles=sweep.profiles,
        points=sweep.points,
        uncertain=_uncertain(sweep),
    )
    size = sweep.design.size
    trial = sorted({0, size // 2, size - 1})
    affine = vectorise and _has_closed_forms(sweep, trial)
    extra: list[str] = []
    cost = 0.0
    if affine:
        return _checked(sweep, replace(task, vectorise=True), trial)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        for i in (trial[len(trial) // 2], *trial):
            start = time.perf_counter()
            try:
                solved = solve_row(task.scene(_values(sweep, i)), task)
            except Exception:  # the row itself will say it
                continue
            extra += [name for name in numbers(solved) if name not in SCALARS and name not in extra]
            cost = (1 + 2 * len(task.uncertain)) * (time.perf_counter() - start)
            if cost > 1.0:
                break
    return replace(task, extra=tuple(extra)), max(cost, 2e-4)


def _uncertain(sweep: Sweep) -> tuple[str, ...]:
    """Keys of the base scene that carry ``+/-``, of those that do not vary; of a scene that is one."""
    from spinline.solve.uncertainty import uncertain_inputs

    size = sweep.design.size
    for i in sorted({0, size // 2, size - 1}):
        try:
            return tuple(uncertain_inputs(sweep.scene(_values(sweep, i))))
        except InputError:
            continue
    return ()


def _has_closed_forms(sweep: Sweep, trial: Sequence[int]) -> bool:
    numeric = tuple(key for key, values in sweep.design.rows(0, 1).items() if values.dtype != object)
    if {"network.model", "jet.profile"} & set(sweep.design.keys):
        return False
    for i in trial:
        try:
            return not why_not(sweep.scene(_values(sweep, i)), numeric)
        except InputError:
            continue
    return False


def _checked(sweep: Sweep, task: Task, trial: Sequence[int]) -> tuple[Task, float]:
    """The closed forms against single runs on a few rows."""
    for i in trial:
        columns = sweep.design.rows(i, i + 1)
        fast, slow = compute(task, columns), evaluate_rows(task, columns)
        for name, value in slow.numbers.items():
            size = np.abs(
                slow.numbers[name.removesuffix("_std")]
            )  # a difference of two runs is no better than they are
            room = _AGREE * float(np.nan_to_num(size).max()) if name.endswith("_std") else 0.0
            if not np.allclose(fast.numbers[name], value, rtol=_AGREE, atol=room, equal_nan=True):
                warnings.warn(
                    f"closed forms and single runs differ in {name}: every scene is run by itself",
                    SpinlineWarning,
                    stacklevel=4,
                )
                return replace(task, vectorise=False), 2e-3
    return task, _mixed_cost(sweep, task)


def _mixed_cost(sweep: Sweep, task: Task) -> float:
    """Seconds a scene, of which some have closed forms and the others do not."""
    columns = sweep.design.rows(0, min(_SAMPLE, sweep.design.size))
    rest = np.flatnonzero(closed_forms(task, columns).status == PENDING)
    if not rest.size:
        return 3e-6
    start = time.perf_counter()
    some = rest[:: max(1, rest.size // 3)][:3]
    evaluate_rows(task, columns, some.tolist())
    share = rest.size / len(next(iter(columns.values())))
    return 3e-6 + share * (time.perf_counter() - start) / some.size


def _chunk(sweep: Sweep, task: Task, cost: float) -> int:
    """Rows of a chunk: a few seconds of work, and enough chunks for all workers."""
    if task.vectorise and cost < _CHEAP:
        return max(1, min(_VECTOR_ROWS, _VECTOR_PLACES // task.points if task.profiles else _VECTOR_ROWS))
    share = -(-sweep.design.size // (4 * len(os.sched_getaffinity(0))))
    return int(np.clip(_CHUNK_SECONDS / cost, 1, min(_MOST_CHUNK, max(1, share))))


def _extent(sweep: Sweep, chunk: int, index: int) -> tuple[int, int]:
    start = index * chunk
    return start, min(chunk, sweep.design.size - start)


def _rows(sweep: Sweep, chunk: int, index: int) -> dict[str, Column]:
    start, count = _extent(sweep, chunk, index)
    return sweep.design.rows(start, start + count)


def _values(sweep: Sweep, i: int) -> dict[str, Any]:
    return {key: values.tolist()[0] for key, values in sweep.design.rows(i, i + 1).items()}


def _attributes(sweep: Sweep, task: Task) -> dict[str, Any]:
    import json

    from spinline.base.version import __version__

    design = sweep.design
    return {
        "title": sweep.title or "sweep",
        "Conventions": "CF-1.11",
        "source": f"spinline {__version__}",
        "spinline_version": __version__,
        "sweep": sweep.text,
        "base_scene": json.dumps(sweep.base, default=str, sort_keys=True),
        "design": design.kind,
        "keys": " ".join(design.keys),
        "shape": " ".join(map(str, design.shape)),
        "samples": design.samples,
        "seed": design.seed,
        "points": task.points,
        "extra": " ".join(task.extra),
        "uncertain_inputs": ", ".join(task.uncertain),
        "computed_by": "closed forms on arrays, single runs where there is none: see the variable computed_by"
        if task.vectorise
        else "one scene at a time",
        "fingerprint": sweep.fingerprint(),
    }
