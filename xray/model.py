"""The counts of a detector row and their derivatives with everything that may be unknown.

Parameters, in this order: the polymer fraction of each shell, radius, axis, amplitude, slope, blur (the model: `forward`).
All derivatives are closed forms: of the exact chords, of the exponential, and of the kernel of the blur.

The blur acts on transmissions averaged over pixels (over up to 8 parts of them, where the blur is narrower than a pixel, or
where the solution absorbs so much that the exponential of a mean chord is not the mean of the exponential), on a row that goes
on beyond the detector's ends. Its kernel is the sampled Gaussian, normalised; sampled no coarser than 2/3 of its standard
deviation, it is exact to 2e-5 of the counts. A blur under an eighth of a pixel tends to none.
"""

import numpy as np

from spinline.checks import FloatArray
from spinline.xray.chords import disc_chords

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
        radius, axis, amplitude, slope, blur = parameters[self.shells :].tolist()
        half = 0.5 * self.pixel * self.flat.size
        inside = 0.2 * self.pixel < radius < 4.0 * half and abs(axis) < half
        sharp = blur == 0.0 or 0.1 * self._step < blur < self._reach * self._step / _REACH * 1.001
        lit = bool(np.isfinite(parameters).all()) and amplitude > 0.0 and abs(slope) < 1.0
        depth = float((self.base + self.contrast * parameters[: self.shells]).min()) * 2.0 * radius
        return inside and sharp and lit and depth > -20.0

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
        k = self.shells
        radius, axis, amplitude, slope, blur = parameters[k:].tolist()
        chords, by_radius, by_axis = disc_chords(radius * self.edges[1:], self._x, axis)
        mu = self.base + self.contrast * parameters[:k]
        step = mu.copy()  # what each disc adds to the shell outside it
        step[:-1] -= mu[1:]
        transmission = np.exp(-(chords @ step))
        columns = np.empty((transmission.size, k + 3))
        columns[:, 0] = transmission
        columns[:, 1] = chords[:, 0]
        columns[:, 2 : k + 1] = np.diff(chords, axis=1)
        columns[:, 1 : k + 1] *= -self.contrast * transmission[:, None]
        columns[:, k + 1] = -transmission * (by_radius @ (step * self.edges[1:]))
        columns[:, k + 2] = -transmission * (by_axis @ step)
        blurred, by_blur = self._blurred(columns, blur)
        beam = self.flat * (amplitude * (1.0 + slope * self.u))
        jacobian = np.empty((self.flat.size, k + 5))
        jacobian[:, : k + 2] = beam[:, None] * blurred[:, 1:]
        seen = self.flat * blurred[:, 0]
        jacobian[:, k + 2] = (1.0 + slope * self.u) * seen
        jacobian[:, k + 3] = amplitude * self.u * seen
        jacobian[:, k + 4] = beam * by_blur
        return beam * blurred[:, 0] + self._background, jacobian

    def _blurred(self, columns: FloatArray, blur: float) -> tuple[FloatArray, FloatArray]:
        """Blurred and binned columns, and the derivative of the first with the blur."""
        m, n = self._reach, self.flat.size
        if m == 0:
            if self._parts > 1:
                columns = columns.reshape(n, self._parts, -1).mean(axis=1)
            return columns, np.zeros(n)
        k = np.arange(m + 1) * (self._step / blur)
        kernel = np.exp(-0.5 * k**2)
        kernel /= kernel[0] + 2.0 * kernel[1:].sum()
        variance = 2.0 * (kernel * k**2).sum()
        change = kernel * (k**2 - variance) / blur
        length = columns.shape[0] - 2 * m
        out = kernel[0] * columns[m : m + length]
        first = change[0] * columns[m : m + length, 0]
        for i in range(1, m + 1):
            pair = columns[m - i : m - i + length] + columns[m + i : m + i + length]
            first += change[i] * pair[:, 0]
            pair *= kernel[i]
            out += pair
        if self._parts > 1:
            out = out.reshape(n, self._parts, -1).mean(axis=1)
            first = first.reshape(n, self._parts).mean(axis=1)
        return out, first
