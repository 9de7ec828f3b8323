"""The counts of a detector row and their derivatives with everything that may be unknown.

Parameters, in this order: the polymer fraction of each shell, radius, axis, amplitude, slope, blur (the model: `forward`).
All derivatives are closed forms: of the exact chords, of the exponential, and of the kernel of the blur.

The blur acts on transmissions averaged over pixels (over up to 8 parts of them, where the blur is narrower than a pixel, or
where the solution absorbs so much that the exponential of a mean chord is not the mean of the exponential), on a row that goes
on beyond the detector's ends. Its kernel is the sampled Gaussian, normalised; sampled no coarser than 2/3 of its standard
deviation, it is exact to 2e-5 of the counts. A blur under an eighth of a pixel tends to none.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray

__all__ = ["NUISANCES", "RowModel"]

NUISANCES = ("radius", "axis", "amplitude", "slope", "blur")
_REACH = 5.5  # of the kernel, in standard deviations: 4e-8 is cut off
_FINEST = 8
_EDGE_ERROR = 1e-5  # of the counts in the pixel at the jet's edge, from averaging the chord before the exponential


class RowModel:
    """Counts of one row; built by `forward.row_model`, arguments checked there.

    Parameters
    ----------
    flat, dark, veil : ndarray, shape (pixels,)
    pixel_edges : ndarray, shape (pixels + 1,)
        m, evenly spaced.
    edges : ndarray, shape (shells + 1,)
        r/R.
    base, contrast : float
        Attenuation of the solvent less that of air, and D, 1/m.
    blur, widest_blur : float
        Standard deviations in m: the nominal one, and the widest that will be asked for (None: the nominal).

    Attributes
    ----------
    names : tuple of str
        The parameters.
    u : ndarray, shape (pixels,)
        Position along the row, from -1 to 1.
    """

    def __init__(
        self,
        flat: FloatArray,
        dark: FloatArray,
        veil: FloatArray,
        pixel_edges: FloatArray,
        edges: FloatArray,
        base: float,
        contrast: float,
        blur: float = 0.0,
        widest_blur: float | None = None,
    ) -> None:
        self.flat, self.dark, self.veil, self.pixel_edges = flat, dark, veil, pixel_edges
        self.edges, self.base, self.contrast = edges, base, contrast
        self.shells = edges.size - 1
        self.names = (*(f"fraction[{j}]" for j in range(self.shells)), *NUISANCES)
        n = flat.size
        self.u = (2.0 * np.arange(n) - (n - 1)) / (n - 1)
        self.pixel = float(pixel_edges[-1] - pixel_edges[0]) / n
        widest = max(blur, widest_blur or 0.0) if blur > 0.0 else 0.0
        dense = max(abs(base), abs(base + contrast))
        fine = dense * np.sqrt(0.05 * self.pixel**2 * n / _EDGE_ERROR)
        if blur > 0.0:
            fine = max(fine, 1.5 * self.pixel / blur)
        self._parts = int(min(max(np.ceil(fine), 1), _FINEST))
        self._step = self.pixel / self._parts
        self._reach = int(np.ceil(_REACH * widest / self._step))
        self._x = pixel_edges[0] + self._step * (np.arange(n * self._parts + 2 * self._reach + 1) - self._reach)
        self._background = flat * veil + dark

    def scale_exposure(self, rows: FloatArray) -> None:
        """Take `rows` exposures of each pixel, shape (pixels,), 0 for a pixel left out, for one."""
        self.flat, self.dark = self.flat * rows, self.dark * rows
        self._background = self.flat * self.veil + self.dark

    def allows(self, parameters: FloatArray) -> bool:
        """Whether parameters are such that the model has a meaning: a jet within the row, a beam that shines on all of it."""
        values = parameters.tolist()
        radius, axis, amplitude, slope, blur = values[self.shells :]
        half = 0.5 * self.pixel * self.flat.size
        inside = 0.2 * self.pixel < radius < 4.0 * half and abs(axis) < half
        sharp = blur == 0.0 or 0.1 * self._step < blur < self._reach * self._step / _REACH * 1.001
        lit = all(map(math.isfinite, values)) and amplitude > 0.0 and abs(slope) < 1.0
        thinnest = min(self.base + self.contrast * fraction for fraction in values[: self.shells])
        return inside and sharp and lit and thinnest * 2.0 * radius > -20.0

    def evaluate(self, parameters: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mean counts, and their derivatives.

        Parameters
        ----------
        parameters : ndarray, shape (shells + 5,)
            In the order of `names`; radius > 0; blur > 0 unless the model has none.

        Returns
        -------
        counts : ndarray, shape (pixels,)
        jacobian : ndarray, shape (pixels, shells + 5)
            Its last column is 0 in a model without blur.
        """
        from spinline.xray.row.kernel import absorbed_columns  # loads the compiler

        k = self.shells
        radius, axis, amplitude, slope, blur = parameters[k:].tolist()
        columns = np.empty((k + 3, self._x.size - 1))
        first, last = absorbed_columns(
            self._x, parameters[:k], radius, axis, self.edges, self.base, self.contrast, columns
        )
        seen = self._through(columns, first, last, blur)
        return self.counts(seen, amplitude, slope)

    def counts(self, seen: FloatArray, amplitude: float, slope: float) -> tuple[FloatArray, FloatArray]:
        """Mean counts and their derivatives, as `evaluate`, from the transmission less 1 of each pixel and its derivatives.

        Parameters
        ----------
        seen : ndarray, shape (shells + 4, pixels)
            Transmission less 1; its derivatives with fractions, radius, axis; with the blur.
        amplitude, slope : float
        """
        from spinline.xray.row.kernel import beam_counts  # loads the compiler

        mean, jacobian = np.empty(self.flat.size), np.empty((self.shells + 5, self.flat.size))
        beam_counts(seen, self.flat, self.u, self._background, amplitude, slope, mean, jacobian)
        return mean, jacobian.T

    def _through(self, columns: FloatArray, first: int, last: int, blur: float) -> FloatArray:
        """Columns, shape (columns, cells), blurred and binned, and the derivative of the first with the blur."""
        from spinline.xray.row.kernel import blurred_columns  # loads the compiler

        out = np.empty((columns.shape[0] + 1, self.flat.size))
        sigma = blur / self._step if self._reach else 1.0
        blurred_columns(columns, first, last, self._parts, self._reach, _REACH, sigma, out)
        out[-1] /= self._step
        return out

    def _blurred(self, columns: FloatArray, blur: float) -> tuple[FloatArray, FloatArray]:
        """Blurred and binned columns, shape (cells, columns), and the derivative of the first with the blur."""
        out = self._through(np.ascontiguousarray(columns.T), 0, columns.shape[0], blur)
        return out[:-1].T, out[-1]
