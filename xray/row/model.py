"""The counts of a detector row and their derivatives with everything that may be unknown.

Parameters, in this order: the polymer fraction of each shell, radius, axis, amplitude, slope, blur (the model: `forward`), and
of `EXTRAS` those that are asked for: share and length of the detector's tail (`tail`), and Legendre polynomials of the second
to the fourth order by which the beam changed its shape since the flat, ``A (1 + s u + c_2 P_2(u) + ...)``.
All derivatives are closed forms: of the exact chords, of the exponential, and of the kernels of blur and tail.

The blur acts on transmissions averaged over pixels (over up to 8 parts of them, where the blur is narrower than a pixel, or
where the solution absorbs so much that the exponential of a mean chord is not the mean of the exponential), on a row that goes
on beyond the detector's ends. Its kernel is the sampled Gaussian, normalised; sampled no coarser than 2/3 of its standard
deviation, it is exact to 2e-5 of the counts. A blur under an eighth of a pixel tends to none.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray

__all__ = ["EXTRAS", "NUISANCES", "RowModel", "beam_shape"]

NUISANCES = ("radius", "axis", "amplitude", "slope", "blur")
EXTRAS = ("tail_share", "tail_length", "shape2", "shape3", "shape4")
SHAPE_STD = 0.01  # of the beam's shape against the flat's, before anything is seen of it
_LARGEST_SHARE = 0.8
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
    tail : (float, float)
        Share and length, m, of the detector's tail, where they are no parameters.
    extras : tuple of str
        Which of `EXTRAS` are parameters, in that order.

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
        tail: tuple[float, float] = (0.0, 0.0),
        extras: tuple[str, ...] = (),
    ) -> None:
        self.tail, self.extras = tail, extras
        self.scatter = 1.0  # variance of a pixel over that of its photons
        self.flat, self.dark, self.veil, self.pixel_edges = flat, dark, veil, pixel_edges
        self.edges, self.base, self.contrast = edges, base, contrast
        self.shells = edges.size - 1
        self.names = (*(f"fraction[{j}]" for j in range(self.shells)), *NUISANCES, *extras)
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
        self._no_extras: tuple[float, float, list[tuple[int, float]]] = (*tail, [])

    def known_before(self) -> FloatArray | None:
        """1/variance of the parameters before anything is seen: of the shapes of the beam; None in a model without them."""
        if not any(name.startswith("shape") for name in self.extras):
            return None
        return np.array([SHAPE_STD**-2 if name.startswith("shape") else 0.0 for name in self.names])

    def scale_exposure(self, rows: FloatArray) -> None:
        """Take `rows` exposures of each pixel, shape (pixels,), 0 for a pixel left out, for one."""
        self.flat, self.dark = self.flat * rows, self.dark * rows
        self._background = self.flat * self.veil + self.dark

    def allows(self, parameters: FloatArray) -> bool:
        """Whether parameters are such that the model has a meaning: a jet within the row, a beam that shines on all of it."""
        values = parameters.tolist()
        radius, axis, amplitude, slope, blur = values[self.shells : self.shells + 5]
        half = 0.5 * self.pixel * self.flat.size
        inside = 0.2 * self.pixel < radius < 4.0 * half and abs(axis) < half
        sharp = blur == 0.0 or 0.1 * self._step < blur < self._reach * self._step / _REACH * 1.001
        share, length, bends = self._extra(parameters)
        bent = abs(slope) + sum(abs(value) for _, value in bends)
        lit = all(map(math.isfinite, values)) and amplitude > 0.0 and bent < 1.0
        near = abs(share) < _LARGEST_SHARE and (share == 0.0 or 0.5 * self.pixel < length < 40.0 * half)
        thinnest = min(self.base + self.contrast * fraction for fraction in values[: self.shells])
        return inside and sharp and lit and near and thinnest * 2.0 * radius > -20.0

    def evaluate(self, parameters: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mean counts, and their derivatives.

        Parameters
        ----------
        parameters : ndarray, shape (shells + 5 + extras,)
            In the order of `names`; radius > 0; blur > 0 unless the model has none.

        Returns
        -------
        counts : ndarray, shape (pixels,)
        jacobian : ndarray, shape (pixels, shells + 5 + extras)
            The column of the blur is 0 in a model without blur.
        """
        from spinline.xray.row.kernel import absorbed_columns  # loads the compiler

        k = self.shells
        radius, axis, _, _, blur = parameters[k : k + 5].tolist()
        columns = np.empty((k + 3, self._x.size - 1))
        first, last = absorbed_columns(
            self._x, parameters[:k], radius, axis, self.edges, self.base, self.contrast, columns
        )
        return self.counts(*self._through(columns, first, last, blur, parameters), parameters)

    def counts(self, seen: FloatArray, by_tail: FloatArray, parameters: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mean counts and their derivatives, as `evaluate`, from the transmission less 1 of each pixel and its derivatives.

        Parameters
        ----------
        seen : ndarray, shape (shells + 4, pixels)
            Transmission less 1; its derivatives with fractions, radius, axis; with the blur.
        by_tail : ndarray, shape (2, pixels)
            Its derivatives with share and length of the tail.
        parameters : ndarray
            As in `evaluate`.
        """
        from spinline.xray.row.kernel import beam_counts  # loads the compiler

        k = self.shells
        amplitude, slope = parameters[k + 2 : k + 4].tolist()
        bend = 1.0 + slope * self.u
        for order, value in self._extra(parameters)[2]:
            bend = bend + value * _legendre(order, self.u)
        mean, jacobian = np.empty(self.flat.size), np.empty((k + 5 + len(self.extras), self.flat.size))
        beam_counts(seen, self.flat, self.u, self._background, amplitude, bend, mean, jacobian)
        for i, name in enumerate(self.extras, start=k + 5):
            if name.startswith("shape"):
                jacobian[i] = amplitude * self.flat * _legendre(int(name[5:]), self.u) * (1.0 + seen[0])
            else:
                jacobian[i] = amplitude * self.flat * bend * by_tail[EXTRAS.index(name)]
        return mean, jacobian.T

    def _extra(self, parameters: FloatArray) -> tuple[float, float, list[tuple[int, float]]]:
        """Share and length of the tail, and orders and sizes of the shapes."""
        if not self.extras:
            return self._no_extras
        share, length = self.tail
        bends = []
        for name, value in zip(self.extras, parameters[self.shells + 5 :].tolist(), strict=False):
            if name == "tail_share":
                share = value
            elif name == "tail_length":
                length = value
            else:
                bends.append((int(name[5:]), value))
        return share, length, bends

    def _through(
        self, columns: FloatArray, first: int, last: int, blur: float, parameters: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Columns, shape (columns, cells), blurred, binned and spread, with the derivative of the first with the blur; and
        its derivatives with share and length of the tail.
        """
        from spinline.xray.row.kernel import blurred_columns  # loads the compiler

        out = np.empty((columns.shape[0] + 1, self.flat.size))
        sigma = blur / self._step if self._reach else 1.0
        blurred_columns(columns, first, last, self._parts, self._reach, _REACH, sigma, out)
        out[-1] /= self._step
        by_tail = np.zeros((2, self.flat.size))
        share, length, _ = (*self.tail, None) if parameters is None else self._extra(parameters)
        if length > 0.0 and (share != 0.0 or "tail_share" in self.extras):
            from spinline.xray.row.tail import spread_tail

            spread_tail(out, share, length / self.pixel, by_tail[0], by_tail[1])
            by_tail[1] /= self.pixel
        return out, by_tail

    def _blurred(self, columns: FloatArray, blur: float) -> tuple[FloatArray, FloatArray]:
        """Blurred and binned columns, shape (cells, columns), and the derivative of the first with the blur."""
        out, _ = self._through(np.ascontiguousarray(columns.T), 0, columns.shape[0], blur)
        return out[:-1].T, out[-1]


def beam_shape(shapes: dict[str, float], pixels: int) -> FloatArray:
    """``1 + c_2 P_2(u) + ...`` of a row of pixels, for coefficients by name ("shape2" and so on)."""
    u = np.linspace(-1.0, 1.0, pixels)
    return np.asarray(
        1.0 + sum((value * _legendre(int(name[5:]), u) for name, value in shapes.items()), np.zeros(pixels))
    )


def _legendre(order: int, u: FloatArray) -> FloatArray:
    if order == 2:
        return np.asarray(1.5 * u**2 - 0.5)
    if order == 3:
        return np.asarray(2.5 * u**3 - 1.5 * u)
    return np.asarray(4.375 * u**4 - 3.75 * u**2 + 0.375)
