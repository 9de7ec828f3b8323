"""Frames in, polymer concentration with error bars out.

The sum of all frames (or each of them) is turned into photons (`fields`), the jet is followed down the frame, the
attenuation is calibrated where the known fraction is in view (`experiment`), and every block of rows is reduced by one of
four methods:

==========  =========================================================  ==============
method      what it does                                               price
==========  =========================================================  ==============
`chord`     Eqs. (41)-(42), every chord on its own: the quick look     0.1 ms a row
`row`       Poisson likelihood of shells, radius, axis, beam, blur     0.7 to 2 ms a row
`map`       penalised likelihood of all rows, smooth in (r, z)         1 ms a row
`phase`     as `row`, of the wave with its fringes                     60 ms a block
==========  =========================================================  ==============

Work is kept beside the result while it goes on: interrupted, it goes on where it stopped, and ends in the same numbers.
"""

import os
import pickle
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from functools import lru_cache
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checkpoint import Checkpoint, fingerprint
from spinline.base.errors import InputError
from spinline.base.workers import start_worker
from spinline.images.flat_and_dark import open_counts
from spinline.images.formats.base import split_source
from spinline.images.stacks import Stack
from spinline.images.sums import FrameSum, one_frame, sum_frames
from spinline.radiography.experiment import Experiment, require_signal
from spinline.radiography.looks import FRINGES, fringes_in
from spinline.radiography.methods import Kept, require_method
from spinline.radiography.prepare import prepare
from spinline.scene.images_file import Images, Position
from spinline.xray.frame.blocks import FrameFit, blocks_of
from spinline.xray.frame.track import track_jet
from spinline.xray.map.result import MapState
from spinline.xray.row.chords import equal_shells

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["reduce_images"]

Progress = Callable[[str, int, int], None]  # what is done, how much of it, of how much

_PAUSE = 10.0  # seconds between two copies of a running sum, or of a fit of many blocks
_FIT, _MAP = "fit", "map"
_WORTH_PROCESSES = 8.0  # seconds of work: to start them takes three
_PER_BLOCK = 1e-3
_PER_PIXEL = 3e-7
_FRINGE_PLACES = 3  # in each of many frames; their sum is tested too


def reduce_images(
    images: Images,
    *,
    checkpoint: str | Path | None = None,
    workers: int = 1,
    noisy: bool = False,
    progress: Progress | None = None,
) -> "xr.Dataset":
    """Reduce a set of images.

    Parameters
    ----------
    images : Images
        From `load_images`.
    checkpoint : path, optional
        Folder that holds what is done so far; removed at the end. Left out, interrupted work starts again.
    workers : int
        Processes for ``frames = "each"`` (a script that asks for more than one needs ``if __name__ == "__main__":``).
    noisy : bool
        Go on although the error expected exceeds the polymer fraction everywhere.
    progress : callable, optional
        Called with what is done, how much of it and of how much.

    Returns
    -------
    xarray.Dataset
        Dimensions `row` and `shell` (and `frame`), names as documented.

    Raises
    ------
    InputError
        For files, keys or data that cannot be reduced, each with the key that would change it.

    Warns
    -----
    SpinlineWarning
        One for each remark; they are in the attribute ``warnings`` too.
    """
    from spinline.radiography.reduction_dataset import assemble

    said = progress or (lambda *_: None)
    method = require_method(images.method)
    job = None if checkpoint is None else Checkpoint(Path(checkpoint), _job(images))
    if images.positions:
        result = _of_positions(images, job, said)
        return _ended(result, job)
    experiment, frame, track, facts = prepare(images, lambda stack: _summed(stack, job, said))
    if not noisy:
        require_signal(experiment, frame, track)
    if images.method == "map" and images.block_rows > 1:  # smoothing joins the rows; blocks would blunt the jet's kinks
        images = images.model_copy(update={"block_rows": 1})
        said_so = f"a map takes every row: block_rows = {experiment.images.block_rows} serves the expected error alone"
        experiment = replace(experiment, images=images, remarks=(*experiment.remarks, said_so))
    if not images.each or experiment.stack.frames == 1:
        blocks = -(-frame.counts.shape[0] // images.block_rows)
        kept = None if job is None else Kept(_begun(job, images.method), _pause(job), map_begun(job), map_keep(job))
        fit = method.reduce(experiment, frame, track, lambda done: said("blocks", done, blocks), kept)
        fits = [_flagged(fit, experiment.fringes)]
    else:
        fits = _each(experiment, job, workers, said)
    result = assemble(experiment, fits, facts, each=images.each)
    return _ended(result, job)


def _ended(result: "xr.Dataset", job: Checkpoint | None) -> "xr.Dataset":
    """The result, its remarks said, what was kept of the work thrown away."""
    import warnings

    from spinline.base.errors import SpinlineWarning

    for remark in str(result.attrs["warnings"]).splitlines():
        warnings.warn(remark, SpinlineWarning, stacklevel=3)
    if job is not None:
        job.clear()
    return result


def _of_positions(images: Images, job: Checkpoint | None, said: Progress) -> "xr.Dataset":
    """Several positions along a jet."""
    from spinline.radiography.positions import prepare_positions, reduce_positions
    from spinline.radiography.stitched import assemble_positions

    count = len(images.positions)
    at = iter(range(count))
    places, remarks = prepare_positions(images, lambda stack: _summed(stack, job, said, f"sum-{next(at)}"))
    places, fits, joint, z, found = reduce_positions(
        places,
        done=lambda done, of: said("positions", done, of),
        begun=None if job is None else map_begun(job),
        keep=None if job is None else map_keep(job),
    )
    return assemble_positions(images, places, fits, joint, z, found, remarks)


def _flagged(fit: FrameFit, fringes: float) -> FrameFit:
    """The fit with the significance of fringes, and its blocks flagged where they are seen: they fill the whole frame."""
    if fringes >= FRINGES:
        for block in range(fit.rows.shape[0]):
            fit.flag(block, "fringes")
    return replace(fit, fringes=fringes)


def _summed(stack: Stack, job: Checkpoint | None, said: Progress, name: str = "sum") -> FrameSum:
    begun = None
    if job is not None and (kept := job.load(name)) is not None:
        lost, copies, torn, of_strips = (tuple(kept[which].tolist()) for which in _FRAMES_OF_SUM)
        begun = FrameSum(kept["total"], kept["exposures"], kept["highest"], int(kept["frames"]), lost, copies, torn)
        begun = replace(begun, strips=kept["strips"], kept=of_strips)
    last = time.monotonic()

    def pause(so_far: FrameSum) -> None:
        nonlocal last
        said("frames", so_far.frames, stack.frames)
        if job is not None and (time.monotonic() - last > _PAUSE or so_far.frames == stack.frames):
            job.save(
                name,
                total=so_far.total,
                exposures=so_far.exposures,
                highest=so_far.highest,
                strips=so_far.strips,
                frames=np.array(so_far.frames),
                **{which: np.array(getattr(so_far, which), dtype=np.int64) for which in _FRAMES_OF_SUM},
            )
            last = time.monotonic()

    return sum_frames(stack, begun=begun, pause=pause)


_FRAMES_OF_SUM = ("lost", "copies", "torn", "kept")


def _begun(job: Checkpoint, method: str) -> FrameFit | None:
    return _kept(job, _FIT, method) if job.has(_FIT) else None


def _pause(job: Checkpoint) -> Callable[[FrameFit], None]:
    """Stores a fit that goes on, not too often."""
    last = time.monotonic()

    def keep(fit: FrameFit) -> None:
        nonlocal last
        if time.monotonic() - last > _PAUSE:
            _keep(job, _FIT, fit)
            last = time.monotonic()

    return keep


def map_begun(job: Checkpoint) -> MapState | None:
    """Where an interrupted map stopped."""
    kept = job.load(_MAP)
    if kept is None:
        return None
    near, settled, turns, changes = (int(n) for n in kept["numbers"])
    return MapState(kept["coefficients"], kept["weights"], bool(near), bool(settled), turns, changes)


def map_keep(job: Checkpoint) -> Callable[[MapState], None]:
    """Stores where a map is, turn by turn."""

    def keep(state: MapState) -> None:
        numbers = np.array([state.near, state.settled, state.turns, state.changes], dtype=np.int64)
        job.save(_MAP, coefficients=state.coefficients, weights=state.weights, numbers=numbers)

    return keep


def _each(experiment: Experiment, job: Checkpoint | None, workers: int, said: Progress) -> list[FrameFit]:
    """Every frame on its own: here, or in processes."""
    count = experiment.stack.frames
    with tempfile.TemporaryDirectory(prefix="spinline-") as scratch:
        store = job or Checkpoint(Path(scratch) / "job", "each")
        todo = [i for i in range(count) if not store.has(_name(i))]
        said("frames reduced", count - len(todo), count)
        rows, columns = experiment.stack.rows, experiment.stack.columns
        seconds = len(todo) * rows * (_PER_BLOCK / experiment.images.block_rows + _PER_PIXEL * columns)
        if workers > 1 and seconds > _WORTH_PROCESSES:
            setup = Path(scratch) / "experiment.pickle"
            setup.write_bytes(pickle.dumps(_portable(experiment)))
            _in_processes(
                setup, store.folder, todo, workers, lambda done: said("frames reduced", count - len(todo) + done, count)
            )
        else:
            for done, i in enumerate(todo):
                _keep(store, _name(i), _one(experiment, i))
                said("frames reduced", count - len(todo) + done + 1, count)
        fits = [_kept(store, _name(i), experiment.images.method) for i in range(count)]
    if not any(np.isfinite(fit.mean).any() for fit in fits):
        raise InputError(
            "frames",
            "no single frame can be reduced: " + next(iter(fits[0].reasons.values())),
            value="each",
            remedy='take frames = "sum"',
        )
    return fits


def _in_processes(setup: Path, folder: Path, todo: list[int], workers: int, said: Callable[[int], None]) -> None:
    count = min(workers, len(todo))
    pool = ProcessPoolExecutor(count, get_context("spawn"), initializer=start_worker, initargs=(os.getpid(),))
    with _OneThreadEach(), pool:
        running = [pool.submit(_task, str(setup), str(folder), i) for i in todo]
        try:
            for done, one in enumerate(as_completed(running)):
                one.result()
                said(done + 1)
        except BrokenProcessPool:
            raise InputError(
                "--workers",
                'died (out of memory, or started from a script without if __name__ == "__main__")',
                value=workers,
                remedy="take fewer; what is done is kept with a checkpoint",
            ) from None
        except BaseException:  # Ctrl-C, a full disk: the frames under way are not waited for
            pool.shutdown(wait=False, cancel_futures=True)
            raise


class _OneThreadEach:
    """Processes that each use one thread for linear algebra: their matrices are small, and the cores are taken."""

    _NAMES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

    def __enter__(self) -> None:
        self.before = {name: os.environ.get(name) for name in self._NAMES}
        os.environ.update(dict.fromkeys(self._NAMES, "1"))

    def __exit__(self, *_: object) -> None:
        for name, value in self.before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@lru_cache(maxsize=1)
def _loaded(setup: str) -> Experiment:
    """The experiment in a process of its own; the frames are opened there."""
    experiment: Experiment = pickle.loads(Path(setup).read_bytes())
    object.__setattr__(experiment, "stack", open_counts(experiment.images))
    return experiment


def _portable(experiment: Experiment) -> Experiment:
    """The experiment without its open files."""

    return replace(experiment, stack=None)  # type: ignore[arg-type]


def _task(setup: str, folder: str, index: int) -> int:
    experiment = _loaded(setup)
    _keep(Checkpoint(Path(folder), None), _name(index), _one(experiment, index))
    return index


def _one(experiment: Experiment, index: int) -> FrameFit:
    """One frame of the stack; NaN where it shows no jet."""
    stack = experiment.stack
    images = experiment.images
    try:
        frame, _ = experiment.frame(one_frame(stack, index), (index + 0.5) / stack.frames)
        fit = require_method(images.method).reduce(experiment, frame, None, None, None)
        if images.method == "phase":
            return fit
        path = track_jet(frame.counts, frame.flat, frame.dark, frame.good)
        own, _ = fringes_in(frame, experiment.wave_medium, path, _FRINGE_PLACES)
        return _flagged(fit, float(np.fmax(own, experiment.fringes)))
    except InputError as error:
        rows = blocks_of(stack.rows, images.block_rows)
        fit = FrameFit.empty(images.method, equal_shells(images.shells), rows)
        for block, start in enumerate(rows[:, 0].tolist()):
            fit.flag(block, "not_fitted")
            fit.reasons[start] = f"frame {index}: {error}"
        return fit


def _name(index: int) -> str:
    return f"frame-{index:06d}"


def _keep(store: Checkpoint, name: str, fit: FrameFit) -> None:
    arrays = {name: getattr(fit, name) for name in _ARRAYS}
    values = {f"value_{k}": v for k, v in fit.values.items()} | {f"std_{k}": v for k, v in fit.std.items()}
    store.save(name, **arrays, **values, reasons=np.array([f"{k} {v}" for k, v in fit.reasons.items()], dtype=np.str_))


_ARRAYS = (
    "shell_edges",
    "rows",
    "fraction",
    "covariance",
    "mean",
    "mean_std",
    "limit_std",
    "misfit",
    "flags",
    "shifts",
    "excess",
    "fringes",
)


def _kept(store: Checkpoint, name: str, method: str) -> FrameFit:
    data = store.load(name)
    if data is None:
        raise InputError(str(store.folder), f"lost {name} while the frames were reduced", remedy="run it again")
    values, std = ({k.removeprefix(p): v for k, v in data.items() if k.startswith(p)} for p in ("value_", "std_"))
    reasons = {int(line.split(" ", 1)[0]): line.split(" ", 1)[1] for line in data["reasons"].tolist()}
    arrays = {name: data[name] for name in _ARRAYS if name != "fringes"}
    return FrameFit(method=method, values=values, std=std, reasons=reasons, fringes=float(data["fringes"]), **arrays)


def _job(images: Images) -> str:
    """Name of the job: the text, the version, and the files' sizes and times."""
    from spinline.base.version import __version__

    files = []
    places: list[Images | Position] = [images, *images.positions]
    for place in places:
        sources = (place.flat, place.flat_after, place.dark)
        names = [getattr(place, key, None) for key in ("counts", "transmission", "absorbance", "bad_pixels")]
        for name in (*names, *(source.file for source in sources if source is not None)):
            if not name:
                continue
            path = images.folder / split_source(name)[0]
            files += [path] if path.is_file() else sorted(images.folder.glob(path.name)) if "*" in name else []
    return fingerprint(f"{__version__}\n{images.text}\n{images.model_dump()!r}", files)
