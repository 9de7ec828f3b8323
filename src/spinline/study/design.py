"""Where in the space of its parameters a sweep computes: grids, samples, tables, and the design of Sobol' indices.

Row i of a design follows from its definition and its seed alone: any part can be computed anywhere, in any order, again.

===================  ============================================================  ====================================
kind                 rows                                                          use
===================  ============================================================  ====================================
``grid``             every combination, last key fastest                           maps, few parameters
``latin-hypercube``  `samples`, each parameter in as many equal strata             many parameters, any number of rows
``sobol``            `samples`, scrambled Sobol' points; best for powers of two    many parameters, smoothest coverage
``table``            those of a CSV file                                           measured or chosen conditions
``sensitivity``      `samples` (d + 2): A, B, and A with a column of B (Saltelli)  `spinline.study.sensitivity`
===================  ============================================================  ====================================
"""

import hashlib
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError, SpinlineWarning

__all__ = ["KINDS", "Axis", "Column", "Design", "Kind"]

Kind = Literal["grid", "latin-hypercube", "sobol", "table", "sensitivity"]
KINDS: tuple[Kind, ...] = ("grid", "latin-hypercube", "sobol", "table", "sensitivity")
Column = FloatArray | NDArray[np.object_]
MOST_ROWS = 10**9
_MOST_SAMPLED = 10**8  # numbers of a design held in memory


@dataclass(frozen=True, eq=False)
class Axis:
    """Values of one key.

    Attributes
    ----------
    key : str
        Of the scene.
    values : ndarray
        Floats in SI, or words and tables as objects; the two ends of a range.
    scale : {"list", "linear", "log"}
        A list of values, or a range in which samples are uniform in the value or in its logarithm.
    """

    key: str
    values: Column
    scale: Literal["list", "linear", "log"] = "list"

    def at(self, u: FloatArray) -> Column:
        """Values at u in [0, 1)."""
        if self.scale == "list":
            chosen: Column = self.values[np.minimum((u * len(self.values)).astype(int), len(self.values) - 1)]
            return chosen
        low, high = (float(end) for end in self.values)
        if self.scale == "linear":
            return low + (high - low) * u
        return low * (high / low) ** u


class Design:
    """Rows of a sweep.

    Parameters
    ----------
    kind : {"grid", "latin-hypercube", "sobol", "table", "sensitivity"}
        See the module's text.
    axes : sequence of Axis
        One for each key that is varied.
    samples : int
        For the sampled kinds: rows, or N of ``sensitivity``.
    seed : int
        Of the samples.

    Raises
    ------
    InputError
        For axes or numbers that do not make a design.
    """

    def __init__(self, kind: Kind, axes: Sequence[Axis], samples: int = 0, seed: int = 0) -> None:
        self.kind, self.axes, self.samples, self.seed = kind, tuple(axes), samples, seed
        self._unit: FloatArray | None = None
        d = len(self.axes)
        if kind == "grid":
            for axis in self.axes:
                if axis.scale != "list":
                    raise InputError(
                        f"vary.{axis.key}",
                        "is a range, and a grid needs steps",
                        allowed="values, linspace, logspace",
                        remedy='or [design] kind = "latin-hypercube"',
                    )
            self.shape = tuple(len(axis.values) for axis in self.axes)
            self.size = int(np.prod([float(n) for n in self.shape]))
        elif kind == "table":
            self.size = len(self.axes[0].values)
            self.shape = (self.size,)
        else:
            if kind != "latin-hypercube" and samples & (samples - 1):
                if kind == "sensitivity":
                    raise InputError(
                        "design.samples",
                        "is not a power of two",
                        value=samples,
                        allowed="2, 4, 8 ...",
                        remedy=f"take {1 << samples.bit_length()}",
                    )
                warnings.warn(
                    f"design.samples = {samples} is not a power of two: Sobol' points are balanced only there",
                    SpinlineWarning,
                    stacklevel=2,
                )
            self._check_sensitivity()
            self.size = samples * (d + 2) if kind == "sensitivity" else samples
            self.shape = (self.size,)
            if samples * d * (2 if kind == "sensitivity" else 1) > _MOST_SAMPLED:
                raise InputError(
                    "design.samples",
                    "makes a design too large to hold",
                    value=samples,
                    allowed=f"up to {_MOST_SAMPLED // max(d, 1)} here",
                    remedy="split the sweep",
                )
        if self.size > MOST_ROWS:
            raise InputError(
                "vary",
                f"makes {self.size:.3g} scenes",
                allowed=f"up to {MOST_ROWS:.0e}",
                remedy="take fewer steps, or samples",
            )

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys that are varied."""
        return tuple(axis.key for axis in self.axes)

    def rows(self, start: int, stop: int) -> dict[str, Column]:
        """Values of every key in rows start to stop."""
        if self.kind == "table":
            return {axis.key: axis.values[start:stop] for axis in self.axes}
        if self.kind == "grid":
            index = np.unravel_index(np.arange(start, stop), self.shape)
            return {axis.key: axis.values[i] for axis, i in zip(self.axes, index, strict=True)}
        unit = self._sample()
        if self.kind != "sensitivity":
            return {axis.key: axis.at(unit[start:stop, j]) for j, axis in enumerate(self.axes)}
        d, n = len(self.axes), self.samples
        block, row = np.divmod(np.arange(start, stop), n)
        # blocks: A, B, then A with column j of B
        return {
            axis.key: axis.at(np.where((block == 1) | (block == 2 + j), unit[row, d + j], unit[row, j]))
            for j, axis in enumerate(self.axes)
        }

    def digest(self) -> str:
        """Fingerprint of all rows."""
        h = hashlib.sha256(repr((self.kind, self.keys, self.samples, self.seed, self.size)).encode())
        for axis in self.axes:
            h.update(axis.scale.encode())
            h.update(repr(axis.values.tolist()).encode())
        if self.kind not in ("grid", "table"):
            h.update(self._sample().tobytes())
        return h.hexdigest()

    def _sample(self) -> FloatArray:
        """Points of the unit cube, (samples, d), twice as many columns for ``sensitivity``."""
        if self._unit is None:
            from scipy.stats import qmc

            rng, d = np.random.default_rng(self.seed), len(self.axes)
            if self.kind == "latin-hypercube":
                self._unit = np.asarray(qmc.LatinHypercube(d, seed=rng).random(self.samples))
            else:
                sampler = qmc.Sobol(2 * d if self.kind == "sensitivity" else d, seed=rng, bits=62)
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore", UserWarning)  # of scipy's, on powers of two: said above
                    self._unit = np.asarray(sampler.random(self.samples))
        return self._unit

    def _check_sensitivity(self) -> None:
        if self.kind != "sensitivity":
            return
        if len(self.axes) < 2:
            raise InputError("vary", "holds one key: it carries all the variance", remedy="vary two or more")
        for axis in self.axes:
            if axis.scale == "list":
                raise InputError(
                    f"vary.{axis.key}",
                    "is a list, and Sobol' indices need a range",
                    remedy="give uniform = [low, high] or loguniform = [low, high]",
                )
