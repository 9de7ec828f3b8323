"""What a detector row counts some way behind a round jet: the Fresnel fringes of its edges.

Behind the jet the wave is ``u(x, 0) = exp(-(mu/2 + 2 pi i delta/lambda) L(x))``; a distance z on, its Fourier transform has
turned by ``exp(-i pi lambda z f^2)`` (paraxial, parallel beam; for a point source at a distance l give ``z l/(z + l)`` and the
pixel in the plane of the jet), and the detector counts

    counts = flat (A (1 + s u) B[sum_i w_i abs(u_i(x, z))^2] + veil) + dark

over the lines i of the beam. The jet varies so slowly along its axis that the wave spreads across it alone. B holds the
Gaussian blur of detector and source; without any, fringes of 0.2 to 2.5 times the beam stand at the edges of 100 um of water.

Sampling: the wave is averaged over cells of width h, a whole part of a pixel. The phase runs fastest in the cell at the jet's
edge, through ``(4 pi delta/lambda) sqrt(2 R h)``; h holds that under 0.35, and the curvature of the phase within
that cell is allowed for. Twice the row and more is propagated, and frequencies that land beyond it are left out, so that
nothing comes round. What would need more than 128 cells a pixel is refused. Counts are then right to 5e-4 of the beam in the
worst pixel at 10 keV, 0.67 um pixels and no blur (tests: against quadrature of the diffraction integral).

References
----------
Born, Wolf, Principles of Optics, 8.3; Paganin, Coherent X-Ray Optics (2006), 1.4.
"""

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray, computable, number, positive
from spinline.base.errors import InputError
from spinline.xray.matter.medium import Medium
from spinline.xray.phase.profiles import Profile, Shells
from spinline.xray.row.forward import Detector, RoundJet
from spinline.xray.row.model import NUISANCES, RowModel

__all__ = ["PHASE_NUISANCES", "WaveRowModel", "cells_per_pixel", "edge_fringe_width", "fresnel_counts", "wave_model"]

PHASE_NUISANCES = (*NUISANCES, "distance", "refraction")
_EDGE_PHASE = 0.35  # rad in the cell at the edge
_FEWEST, _MOST = 16, 128
_REACH = 5.5  # of the blur's kernel, in standard deviations
_WINDOW = 2.5  # widths of the row


@computable
def edge_fringe_width(energy_kev: float, distance: float) -> float:
    """Width ``sqrt(lambda z)`` of the first fringe at an edge, m; energy in keV, distance in m, both > 0."""
    wave = float(1.239841984332e-9 / positive("energy_kev", energy_kev, "keV"))
    return float(np.sqrt(wave * positive("distance", distance, "m")))


def cells_per_pixel(medium: Medium, radius: float, pixel: float, blur: float = 0.0) -> int:
    """Cells that a pixel is cut into, so that the wave at the edge of a jet is resolved.

    Parameters
    ----------
    medium : Medium
    radius, pixel : float
        m, > 0.
    blur : float
        Standard deviation of the blur, m, >= 0.

    Returns
    -------
    int, [16, 128]

    Raises
    ------
    InputError
        Where 128 are not enough.
    """
    r, p = positive("radius", radius, "m"), positive("pixel", pixel, "m")
    turn = 2.0 * np.pi * (medium.delta_solvent - medium.delta_air) / medium.wavelength
    strongest = float(np.max(np.hypot(turn, 0.5 * (medium.solvent - medium.air))))
    cell = (_EDGE_PHASE / (2.0 * strongest)) ** 2 / (2.0 * r)
    if blur > 0.0:
        cell = min(cell, blur / 1.5)
    parts = int(np.ceil(p / cell))
    if parts > _MOST:
        raise InputError(
            "pixel",
            f"is too coarse for the wave at the jet's edge: it takes {parts} cells a pixel",
            value=p,
            allowed=f"{_MOST} cells of {cell:.2g} m",
            remedy="a finer pixel, a higher energy or a thinner jet",
        )
    return max(parts, _FEWEST)


_Spread = tuple[FloatArray, FloatArray, FloatArray]
_Paths = tuple[FloatArray, FloatArray, FloatArray, _Spread]


class WaveRowModel(RowModel):
    """Counts of one row behind a jet at a distance, with their derivatives; parameters as `RowModel`, then the distance and a
    factor on the refraction (1 as tabulated).

    Parameters
    ----------
    detector : Detector
    edges : ndarray, shape (shells + 1,)
        r/R.
    medium : Medium
    radius : float
        About that of the jet, m: decides the cells.
    widest_blur : float, optional
        m, where the blur is fitted.
    cells : int, optional
        A pixel's, where `cells_per_pixel` shall not decide.
    profile : Profile, optional
        What the fractions are the coefficients of; left out, shells with these edges.
    sections : ndarray, shape (sections, 2)
        Radius and axis of the sections that a block of rows is the mean of, less those of the parameters, m; left out, one.
    """

    def __init__(
        self,
        detector: Detector,
        edges: FloatArray,
        medium: Medium,
        radius: float,
        widest_blur: float | None = None,
        cells: int | None = None,
        profile: Profile | None = None,
        sections: FloatArray | None = None,
    ) -> None:
        thin = medium.absorber
        super().__init__(
            detector.flat,
            detector.dark,
            detector.veil,
            detector.pixel_edges,
            edges,
            thin.solvent - thin.air,
            thin.contrast,
            detector.blur,
            widest_blur,
            (detector.tail_share, detector.tail_length),
        )
        self.profile = Shells(edges) if profile is None else profile
        self.shells = self.profile.size
        self.sections = np.zeros((1, 2)) if sections is None else sections
        self.names = (*(f"fraction[{j}]" for j in range(self.shells)), *PHASE_NUISANCES)
        self.medium = medium
        n = self.flat.size
        widest = max(detector.blur, widest_blur or 0.0) if detector.blur > 0.0 else 0.0
        self._parts = cells or cells_per_pixel(medium, radius, self.pixel, detector.blur)
        self._step = self.pixel / self._parts
        self._reach = int(np.ceil(_REACH * widest / self._step))
        seen = n * self._parts + 2 * self._reach
        from scipy.fft import fftfreq, next_fast_len

        size = next_fast_len(int(np.ceil(_WINDOW * seen)))
        self._skip = (size - seen) // 2
        self._seen = seen
        self._x = detector.pixel_edges[0] + self._step * (np.arange(size + 1) - self._reach - self._skip)
        self._frequency: FloatArray = fftfreq(size, self._step)

    def allows(self, parameters: FloatArray) -> bool:
        """Whether parameters have a meaning: as `RowModel.allows`, a jet inside the window, a distance >= 0."""
        radius = parameters[self.shells] + self.sections[:, 0]
        axis = parameters[self.shells + 1] + self.sections[:, 1]
        inside = bool((np.abs(axis) + radius < 0.24 * self._x.size * self._step).all())  # 1.2 times half the row
        bends = bool(parameters[-2] >= 0.0) and bool(0.2 < parameters[-1] < 5.0)
        return inside and bool((radius > 0.0).all()) and bends and super().allows(parameters[:-2])

    def evaluate(self, parameters: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mean counts, shape (pixels,), and their derivatives, shape (pixels, shells + 7); as `RowModel.evaluate`."""
        k = self.shells
        radius, axis, amplitude, slope, blur, distance, bend = parameters[k:].tolist()
        at = slice(self._skip, self._skip + self._seen)
        columns = np.zeros((self._seen, k + 5))
        wave = np.zeros((k + 4, self._x.size - 1), dtype=np.complex128)
        turned = np.empty((k + 5, wave.shape[1]), dtype=np.complex128)
        wide = self._seen * self._step  # light of frequency f lands lambda z f aside
        shares = self.medium.weight / self.sections.shape[0]
        for more, aside in self.sections.tolist():
            within, x = self._within(radius + more, axis + aside)
            paths = self._paths(radius + more, x, axis + aside)
            for i, share in enumerate(shares):
                wave[:] = 0.0
                by_phase = self._wave(i, parameters[:k], bend, paths, wave[:, within])
                lam = self.medium.wavelength[i]
                np.multiply(_fft(wave), self._transfer(lam, distance, wide), out=turned[:-1])
                np.multiply(turned[0], -1j * np.pi * lam * self._frequency**2, out=turned[-1])
                later = _ifft(turned)[:, at]
                u = 1.0 + later[0]
                columns[:, 0] += share * (u.real**2 + u.imag**2)
                # twice the real part of conj(u) d, and of conj(u) by_phase d
                changes = u.real * later[1:].real + u.imag * later[1:].imag
                towards = u * np.conj(by_phase)
                changes[:k] = towards.real * later[1 : k + 1].real + towards.imag * later[1 : k + 1].imag
                columns[:, 1:] += 2.0 * share * changes.T
        blurred, by_blur = self._blurred(columns, blur)
        beam = self.flat * (amplitude * (1.0 + slope * self.u))
        jacobian = np.empty((self.flat.size, k + 7))
        jacobian[:, : k + 2] = beam[:, None] * blurred[:, 1 : k + 3]
        seen = self.flat * blurred[:, 0]
        jacobian[:, k + 2] = (1.0 + slope * self.u) * seen
        jacobian[:, k + 3] = amplitude * self.u * seen
        jacobian[:, k + 4] = beam * by_blur
        jacobian[:, k + 5] = beam * blurred[:, k + 4]
        jacobian[:, k + 6] = beam * blurred[:, k + 3]
        return beam * blurred[:, 0] + self._background, jacobian

    def mean(self, parameters: FloatArray) -> FloatArray:
        """Mean counts alone, shape (pixels,), at a fraction of the price of `evaluate`."""
        k = self.shells
        radius, axis, amplitude, slope, blur, distance, bend = parameters[k:].tolist()
        at = slice(self._skip, self._skip + self._seen)
        seen = np.zeros((self._seen, 1))
        m = self.medium
        for more, aside in self.sections.tolist():
            within, x = self._within(radius + more, axis + aside)
            depth, _, _, (variance, _, _) = self._paths(radius + more, x, axis + aside)
            for i, share in enumerate(m.weight / self.sections.shape[0]):
                rate, _, _ = self._rates(i, parameters[:k], bend)
                wave = np.zeros(self._x.size - 1, dtype=np.complex128)
                wave[within] = np.exp(-_along(depth, rate)) * (1.0 + 0.5 * rate[-1] ** 2 * variance) - 1.0
                later = _ifft(_fft(wave) * self._transfer(m.wavelength[i], distance, self._seen * self._step))[at]
                seen[:, 0] += share * np.abs(1.0 + later) ** 2
        blurred, _ = self._blurred(seen, blur)
        beam = self.flat * (amplitude * (1.0 + slope * self.u))
        return np.asarray(beam * blurred[:, 0] + self._background)

    def _within(self, radius: float, axis: float) -> tuple[slice, FloatArray]:
        """The cells that the jet touches, and their edges."""
        first = max(int(np.searchsorted(self._x, axis - radius)) - 1, 0)
        last = min(int(np.searchsorted(self._x, axis + radius)) + 1, self._x.size - 1)
        return slice(first, last), self._x[first : last + 1]

    def _paths(self, radius: float, x: FloatArray, axis: float) -> _Paths:
        """Depths of the profile in cells of edges x, their derivatives, and the spread of the whole chord within a cell."""
        depth, by_radius, by_axis = self.profile.depths(radius, x, axis)
        whole = (array.sum(axis=1) for array in (depth, by_radius, by_axis))
        return depth, by_radius, by_axis, _chord_spread(x - axis, radius, *whole)

    def _rates(
        self, line: int, fraction: FloatArray, bend: float
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128], complex]:
        """What a metre of each part does to the wave: all of it, the refraction's for a factor of 1, and its slope with the
        fraction.
        """
        m = self.medium
        turn = 2j * np.pi / m.wavelength[line]
        delta = turn * (m.delta_solvent[line] - m.delta_air[line] + m.delta_contrast[line] * fraction)
        mu = 0.5 * (m.solvent[line] - m.air[line] + m.contrast[line] * fraction)
        return mu + bend * delta, delta, complex(0.5 * m.contrast[line] + bend * turn * m.delta_contrast[line])

    def _wave(
        self, line: int, fraction: FloatArray, bend: float, paths: _Paths, out: NDArray[np.complex128]
    ) -> complex:
        """The wave less 1 and its derivatives (fractions, short of the factor returned, radius, axis, bend) into `out`."""
        rate, delta, slope = self._rates(line, fraction, bend)
        depth, by_radius, by_axis, (variance, variance_by_radius, variance_by_axis) = paths
        k, edge = self.shells, rate[-1]
        plain = np.exp(-_along(depth, rate))
        half = 0.5 * edge**2
        u = plain * (1.0 + half * variance)
        out[0] = u - 1.0
        np.multiply(-u, depth.T, out=out[1 : k + 1])
        out[k] += plain * (edge * variance)
        out[k + 1] = -u * _along(by_radius, rate) + plain * (half * variance_by_radius)
        out[k + 2] = -u * _along(by_axis, rate) + plain * (half * variance_by_axis)
        out[k + 3] = -u * _along(depth, delta) + plain * (edge * variance * delta[-1])
        return slope

    def _transfer(self, wave: float, distance: float, wide: float) -> NDArray[np.complex128]:
        """Propagator, with the average over cells undone, and without the frequencies that leave the window."""
        f = self._frequency
        turn = np.exp(-1j * np.pi * wave * distance * f**2) / np.sinc(f * self._step)
        lands = wave * distance * np.abs(f) / wide
        fade = np.clip((1.4 - lands) / 0.4, 0.0, 1.0)
        return np.asarray(turn * (fade * fade * (3.0 - 2.0 * fade)))


def wave_model(
    medium: Medium, detector: Detector, edges: FloatArray, radius: float, widest_blur: float | None = None
) -> WaveRowModel:
    """The model of one row at a distance, of uniform shells, ready to evaluate."""
    return WaveRowModel(detector, edges, medium, radius, widest_blur)


def fresnel_counts(
    jet: RoundJet, medium: Medium, detector: Detector, distance: float, *, amplitude: float = 1.0, slope: float = 0.0
) -> FloatArray:
    """Mean counts of each pixel of a row at a distance behind a jet.

    Parameters
    ----------
    jet : RoundJet
        Inside the row, or little outside it.
    medium : Medium
        Attenuation and refraction (`solution_medium`).
    detector : Detector
        `blur` holds detector and source.
    distance : float
        From jet to detector, m, >= 0; 0 is absorption alone.
    amplitude, slope : float
        As in `forward.expected_counts`.

    Returns
    -------
    ndarray, shape (pixels,), counts.

    Raises
    ------
    InputError
        For a wave that 128 cells a pixel do not resolve, or a jet outside the row.

    Notes
    -----
    2 ms for 220 pixels of 30 cells, one line; in proportion to cells and lines.
    """
    z = number("distance", distance, least=0.0, unit="m")
    a, s = positive("amplitude", amplitude), number("slope", slope, above=-1.0, below=1.0)
    model = wave_model(medium, detector, jet.shell_edges, jet.radius)
    parameters = np.concatenate((jet.fraction, [jet.radius, jet.axis, a, s, detector.blur, z, 1.0]))
    if not model.allows(parameters):
        raise InputError("jet", "does not lie in the row", value=jet.axis, remedy="a wider row, or another axis")
    return model.mean(parameters)


def _chord_spread(
    x: FloatArray, radius: float, chord: FloatArray, by_radius: FloatArray, by_axis: FloatArray
) -> _Spread:
    """Variance of the disc's chord within each cell of edges x, and its derivatives with radius and axis."""
    inside = np.clip(x, -radius, radius)
    over = 4.0 / (x[1] - x[0])
    variance = over * np.diff(radius**2 * inside - inside**3 / 3.0) - chord**2
    turned = 2.0 * radius * over * np.diff(inside) - 2.0 * chord * by_radius
    moved = -over * np.diff(radius**2 - inside**2) - 2.0 * chord * by_axis
    return variance, turned, moved


def _along(depth: FloatArray, rate: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """``depth @ rate``, without a complex copy of the depths."""
    parts: FloatArray = depth @ np.stack((rate.real, rate.imag), axis=1)
    return parts.view(np.complex128)[:, 0]


def _fft(wave: NDArray[np.complex128]) -> NDArray[np.complex128]:
    from scipy.fft import fft

    return np.asarray(fft(wave, axis=-1))


def _ifft(wave: NDArray[np.complex128]) -> NDArray[np.complex128]:
    from scipy.fft import ifft

    return np.asarray(ifft(wave, axis=-1, overwrite_x=True))
