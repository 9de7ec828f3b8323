"""Monte Carlo random walk of strands on the cubic lattice: the rung `walk` of the ladder.

=====================  ===========================================================  ==========================
what                   how                                                          cost (one core)
=====================  ===========================================================  ==========================
uniform force          multinomial, exact for N_s up to 1e12: nothing is walked     0.4 us a strand
forces that vary       every step walked, 32-bit thresholds, blocks of strands      6e9 steps/s (AVX2: 3e9)
pictures               `sample_paths`: the very walks of method "steps"             1e8 steps/s
no sampling            `walk_moments`, `exact_law`                                  see there
=====================  ===========================================================  ==========================

Strand number i of a seed is the same whatever the number of strands, threads or the chunk (Philox opens its stream
from (seed, i); see `_streams`). Weights of a step are multiples of 2^-32; the rounding is carried along the strand,
so that its mean is off by less than 5 x 2^-32 steps in all (and by 2^-32 a segment where a segment is certain to step
away from the strand's main direction). Means, laws and weights come from libm: another processor may move a weight by
2^-32, hence one strand of 400 segments in ten millions.

Means need no sampling: `walk_moments` has them. Sample for distributions, for functions of the whole vector, and for
pictures; `sample_average` then uses the exact moments as control variates.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network._objects import instance
from spinline.network.walk import _multinomial, _step_kernels
from spinline.network.walk.exact import WalkMoments, walk_moments
from spinline.network.walk.strand import MOST_VARYING, Strand, step_probabilities, whole

__all__ = ["StrandSample", "WalkMethod", "sample_paths", "sample_strands"]

WalkMethod = Literal["auto", "multinomial", "steps"]

MOST_STRANDS = 10**8  # 32 bytes each
MOST_STEPS = 10**13  # an hour of one core
MOST_PATH_POINTS = 2 * 10**8  # 24 bytes each
_MOST_INDEX = 2**63 - 1


@dataclass(frozen=True)
class StrandSample:
    """Strands walked; axes x, y (lateral), z (axial), lengths in b. Estimates: `sample_moments`, `sample_average`.

    Attributes
    ----------
    strand : Strand
        What was walked.
    end_to_end : ndarray of int64, shape (strands, 3)
        End-to-end vectors.
    axial_steps : ndarray of int64, shape (strands,)
        Steps along z in either sense.
    method : {"multinomial", "steps"}
        How.
    seed, first : int
        Row i is strand ``first + i`` of `seed`.
    """

    strand: Strand
    end_to_end: NDArray[np.int64]
    axial_steps: NDArray[np.int64]
    method: str
    seed: int
    first: int

    @property
    def orientation(self) -> FloatArray:
        """Hermans orientation of every strand, ``(3 n_z/N_s - 1)/2``."""
        value: FloatArray = (3 * self.axial_steps / self.strand.segments - 1) / 2
        return value

    @cached_property
    def exact(self) -> WalkMoments:
        """What the sample scatters about: `walk_moments` of the strand."""
        return walk_moments(self.strand)


def sample_strands(
    strand: Strand,
    strands: int,
    seed: int,
    *,
    first: int = 0,
    method: WalkMethod = "auto",
    threads: int = 1,
    chunk: int = 65_536,
) -> StrandSample:
    """Sample strands: end-to-end vectors and axial steps.

    Parameters
    ----------
    strand : Strand
        See `walk_strand`.
    strands : int
        How many, in [1, 1e8].
    seed : int
        In [0, 2^64).
    first : int, optional
        Number of the first strand: a sample continued from ``first = strands`` is one sample.
    method : {"auto", "multinomial", "steps"}
        "auto" walks only where the force varies. "steps" under a uniform force is for checks, and for the walks that
        `sample_paths` draws; its N_s is limited as if the force varied.
    threads : int, optional
        In [1, 256]; does not change the numbers.
    chunk : int, optional
        Strands a thread takes at a time, >= 1 (a multiple of 256 wastes nothing); does not change the numbers.

    Returns
    -------
    StrandSample

    Raises
    ------
    InputError
        For values out of range, "multinomial" under forces that vary, or more than 1e13 steps to walk.

    Examples
    --------
    >>> from spinline.network.walk.strand import affine_strand
    >>> sample_strands(affine_strand(20.0, 0.05), 3, seed=1).end_to_end[:, 2].mean() > 250
    np.True_
    """
    instance("strand", strand, Strand)
    count = whole("strands", strands, most=MOST_STRANDS)
    key = _seed(seed)
    begin = whole("first", first, least=0, most=_MOST_INDEX - MOST_STRANDS)
    workers = whole("threads", threads, most=256)
    size = whole("chunk", chunk, most=MOST_STRANDS)
    used = _method(strand, method)
    ends, axial = np.empty((count, 3), np.int64), np.empty(count, np.int64)
    fill = _multinomial_filler(strand) if used == "multinomial" else _step_filler(strand, count)

    def work(start: int) -> None:
        stop = min(start + size, count)
        fill(key, begin + start, ends[start:stop], axial[start:stop])

    starts = range(0, count, size)
    if workers == 1:
        for start in starts:
            work(start)
    else:
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(work, starts))
    return StrandSample(strand, ends, axial, used, int(key), begin)


def sample_paths(strand: Strand, strands: int, seed: int, *, first: int = 0) -> NDArray[np.int64]:
    """Positions along sampled strands, for pictures.

    Parameters
    ----------
    strand, strands, seed, first
        As for `sample_strands`; at most 2e8 positions.

    Returns
    -------
    ndarray of int64, shape (strands, N_s + 1, 3)
        In b, from the origin; the ends are those of ``sample_strands(..., method="steps")``.
    """
    instance("strand", strand, Strand)
    count = whole("strands", strands, most=MOST_STRANDS)
    key = _seed(seed)
    begin = whole("first", first, least=0, most=_MOST_INDEX - MOST_STRANDS)
    if count * (strand.segments + 1) > MOST_PATH_POINTS:
        raise InputError(
            "strands",
            "give more positions than memory holds",
            value=count,
            allowed=f"strands x (segments + 1) <= {MOST_PATH_POINTS}",
            remedy="draw fewer strands, or shorter ones",
        )
    order, table = _table(strand)
    out = np.empty((count, strand.segments + 1, 3), np.int64)
    _step_kernels.walk_paths(key, begin, strand.segments, table, order, out)
    return out


_Filler = Callable[[Any, int, NDArray[np.int64], NDArray[np.int64]], None]


def _multinomial_filler(strand: Strand) -> _Filler:
    p = step_probabilities(strand.forces)[0]
    axial, lateral = p[4] + p[5], p[:4].sum()
    pairs = [(axial, lateral), (p[0] + p[1], p[2] + p[3]), *((p[2 * a], p[2 * a + 1]) for a in range(3))]
    split = np.array([_shares(*pair) for pair in pairs])

    def fill(seed: Any, first: int, ends: NDArray[np.int64], axial: NDArray[np.int64]) -> None:
        _multinomial.sample_multinomial(seed, first, strand.segments, split, ends, axial)

    return fill


def _shares(one: float, other: float) -> tuple[float, float]:
    total = one + other
    return (one / total, other / total) if total else (0.5, 0.5)  # never reached: no steps are left to share


def _step_filler(strand: Strand, count: int) -> _Filler:
    if count * strand.segments > MOST_STEPS:
        raise InputError(
            "strands",
            f"of {strand.segments} segments are too many steps to walk",
            value=count,
            allowed=f"strands x segments <= {MOST_STEPS:.0e}",
            remedy="take `walk_moments` or `exact_law`, or fewer strands",
        )
    order, table = _table(strand)

    def fill(seed: Any, first: int, ends: NDArray[np.int64], axial: NDArray[np.int64]) -> None:
        _step_kernels.walk_strands(seed, first, strand.segments, table, order, ends, axial)

    return fill


def _table(strand: Strand) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Order of the directions, the likeliest last, and the thresholds of every segment."""
    if strand.segments > MOST_VARYING:
        raise InputError(
            "segments",
            "is too many to walk step by step",
            value=strand.segments,
            allowed=f"<= {MOST_VARYING}",
            remedy='method = "multinomial" (uniform force), or `walk_moments`',
        )
    p = step_probabilities(strand.forces)
    if strand.uniform:
        p = np.repeat(p, strand.segments, axis=0)
    order = np.argsort(p.sum(axis=0), kind="stable")
    rows = -(-strand.segments // _step_kernels.UNROLL) * _step_kernels.UNROLL
    table = np.empty((rows, 5), np.int32)
    _step_kernels.thresholds(p, order, table)
    return order, table


def _method(strand: Strand, method: str) -> str:
    if not isinstance(method, str) or method not in get_args(WalkMethod):
        raise InputError("method", "is not known", value=method, allowed='"auto", "multinomial", "steps"')
    if method == "multinomial" and not strand.uniform:
        raise InputError("method", "needs a uniform force", value=method, remedy='take "steps" or "auto"')
    if method == "auto":
        return "multinomial" if strand.uniform else "steps"
    return method


def _seed(seed: int) -> np.uint64:
    return np.uint64(whole("seed", seed, least=0, most=2**64 - 1))
