"""One row's problem: its counts, the model that is held against them, and what of the model is unknown."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray
from spinline.xray.row.block import summed_counts
from spinline.xray.row.chords import checked_edges, equal_shells
from spinline.xray.row.forward import Detector
from spinline.xray.row.limit import extra_parameters, free_parameters
from spinline.xray.row.model import RowModel
from spinline.xray.row.outcome import FLAGS, RowFit, row_outcome
from spinline.xray.row.scoring import largest_likelihood

__all__ = ["Best", "RowProblem", "row_problem"]

#: Parameters, converged, iterations and deviance of a maximum, as `scoring.largest_likelihood` returns them.
Best = tuple[FloatArray, bool, int, float]
_WIDEST = 3.0  # times the first guess that a fitted blur may reach


class RowProblem(NamedTuple):
    """Counts, model and unknowns of a row, or of a block of rows of one jet.

    Attributes
    ----------
    model : RowModel
        For the exposures of the block.
    data, lit : ndarray, shape (pixels,)
        Counts, summed, and which of them are used.
    free : list of int
        Which parameters are fitted.
    """

    model: RowModel
    data: FloatArray
    lit: BoolArray
    free: list[int]

    def best(self, start: FloatArray, known: Best | None = None) -> Best:
        """The largest likelihood near a start; `known` is a maximum found from elsewhere."""
        prior = self.model.known_before()
        return largest_likelihood(self.model, start, self.free, self.data, self.lit, known=known, prior=prior)

    def outcome(self, best: Best, misfit: str = FLAGS["misfit"]) -> RowFit:
        """What a maximum says of the jet."""
        return row_outcome(self.model, best, self.free, self.data, self.lit, misfit=misfit)


def row_problem(
    counts: ArrayLike,
    detector: Detector,
    shells: int | ArrayLike,
    nuisances: Sequence[str],
    good: ArrayLike | None,
    saturation: float,
    model: Callable[[FloatArray, float | None, tuple[str, ...]], RowModel],
) -> RowProblem:
    """Check counts and unknowns, and set the model up for them.

    Parameters
    ----------
    counts, detector, shells, nuisances, good, saturation
        As in `fit.fit_row`.
    model : callable
        Of the shells' edges, the widest blur that is fitted (or None) and the nuisances beyond the usual five.
    """
    edges = equal_shells(shells) if isinstance(shells, int) else checked_edges(shells)
    free = free_parameters(edges.size - 1, nuisances)
    extras = extra_parameters(nuisances, detector)
    data, rows = summed_counts(counts, detector, good, saturation)
    made = model(edges, _WIDEST * detector.blur if "blur" in nuisances else None, extras)
    made.scale_exposure(rows)
    made.scatter = detector.scatter
    return RowProblem(made, data, rows > 0, free)
