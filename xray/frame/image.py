"""What a detector counts in front of a whole jet: radius and polymer fraction along it, to frames.

Each row z of the image is a round section of radius R(z) with a fraction phi(r, z) in shells, seen by the model of `spectral`
(absorption) or `fresnel` (at a distance), row by row:

    counts = flat (A (1 + s u) S[T(z, x)] + veil) + dark

with S the blur of the detector both ways, and, along the jet, the average over the way that the image moved while it was
exposed. A jet tilted in the plane of the image by t has its axis at ``x_0 + z tan(t)`` and is cut ``1/cos(t)`` wider by a row;
tilted out of it by o, all paths are ``1/cos(o)`` longer and z is seen shortened by ``cos(o)``. The wave spreads at right angles
to the edges: in a row, which cuts them aslant, as over the distance ``z (1 + tan(t)^2 + R'^2)`` (exact for a tilt or a taper).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.xray.matter.medium import Medium
from spinline.xray.phase.fresnel import WaveRowModel
from spinline.xray.row.chords import equal_shells, shell_weights
from spinline.xray.row.forward import Detector
from spinline.xray.row.spectral import SpectralRowModel

__all__ = ["STEEPEST", "JetField", "core_and_sheath", "expected_image", "transmission_image"]

#: Tilt of a jet, rad, up to which a row is a section across it.
STEEPEST = np.deg2rad(60.0)


@dataclass(frozen=True, eq=False)
class JetField:
    """Radius and polymer fraction of a jet, row by row.

    Attributes
    ----------
    position : ndarray, shape (rows,)
        Along the jet, m, rising.
    radius : ndarray, shape (rows,)
        m, > 0.
    fraction : ndarray, shape (rows, shells)
        Mean polymer fraction of each of the shells of equal width in r/R.
    """

    position: FloatArray
    radius: FloatArray
    fraction: FloatArray

    def __post_init__(self) -> None:
        z = np.atleast_1d(real("position", self.position, unit="m"))
        radius = np.atleast_1d(real("radius", self.radius, above=0.0, unit="m"))
        fraction = np.atleast_2d(real("fraction", self.fraction))
        if z.ndim != 1 or radius.shape != z.shape or fraction.ndim != 2 or fraction.shape[0] != z.size:
            raise InputError(
                "fraction",
                "does not fit position and radius",
                value=f"array of shape {fraction.shape}",
                allowed=f"({z.size}, shells)",
            )
        if z.size > 1 and (np.diff(z) <= 0).any():
            raise InputError("position", "does not rise", remedy="sort the rows along the jet")
        for name, array in (("position", z), ("radius", radius), ("fraction", fraction)):
            object.__setattr__(self, name, array)

    def at(self, position: ArrayLike) -> "JetField":
        """The field at other places, interpolated; refused outside."""
        z = real("position", position, least=float(self.position[0]), most=float(self.position[-1]), unit="m")
        columns = [np.interp(z, self.position, column) for column in self.fraction.T]
        return JetField(z, np.interp(z, self.position, self.radius), np.stack(columns, axis=1))

    @property
    def mean_fraction(self) -> FloatArray:
        """Mean over the section of each row."""
        return np.asarray(self.fraction @ shell_weights(equal_shells(self.fraction.shape[1])))


def core_and_sheath(core_radius: ArrayLike, core: ArrayLike, mean: ArrayLike, shells: int) -> FloatArray:
    """Fractions in shells of equal width of a jet with a uniform core, the rest of the polymer spread in its sheath.

    Parameters
    ----------
    core_radius : array_like, shape (rows,)
        Over the jet's radius, (0, 1].
    core, mean : array_like, shape (rows,)
        Fraction in the core, and mean over the section, [0, 1].
    shells : int

    Returns
    -------
    ndarray, shape (rows, shells)
        Means over each shell's section: ``weights @ fraction`` is `mean` exactly.

    Raises
    ------
    InputError
        Where the core holds more polymer than the jet, by more than 1e-6 of it.
    """
    for name, values in (("core_radius", core_radius), ("core", core), ("mean", mean)):
        if np.ndim(values) != 1:
            raise InputError(name, "must be a list along the rows", value=f"{np.ndim(values)} dimensions")
    share = real("core_radius", core_radius, above=0.0, most=1.0 + 1e-12)[:, None] ** 2
    inner = real("core", core, least=0.0, most=1.0)[:, None]
    whole = real("mean", mean, least=0.0, most=1.0)[:, None]
    rest = whole - inner * share
    if (rest < -1e-6 * np.maximum(whole, 1e-12)).any():
        raise InputError("core", "holds more polymer than the jet", value=float((inner * share / whole).max()))
    outer = np.where(share < 1.0 - 1e-12, np.maximum(rest, 0.0) / np.maximum(1.0 - share, 1e-12), inner)
    edges = equal_shells(shells) ** 2
    within = np.clip((share - edges[:-1]) / np.diff(edges), 0.0, 1.0)
    return np.asarray(within * inner + (1.0 - within) * outer)


def transmission_image(
    jet: JetField,
    medium: Medium,
    pixels: int,
    pixel: float,
    *,
    distance: float = 0.0,
    axis: float = 0.0,
    tilt: float = 0.0,
    tilt_out: float = 0.0,
    blur: float = 0.0,
    motion: float = 0.0,
    tail: tuple[float, float] = (0.0, 0.0),
    depth: float = 1.0,
) -> FloatArray:
    """Share of the beam that each pixel sees, without drift, veil, dark and noise.

    Parameters
    ----------
    jet : JetField
        At the middle of each row of the image; rows a pixel apart (`tilt_out` aside).
    medium : Medium
    pixels, pixel : int, float
        Of a row, and their width in m (rows are as high).
    distance : float
        From jet to detector, m; 0: absorption alone.
    axis : float
        Position of the jet's axis in the first row, from the middle, m.
    tilt, tilt_out : float
        In the plane of the image and out of it, rad, within +-60 degrees.
    blur : float
        Standard deviation of the Gaussian blur, both ways, m.
    motion : float
        Way along the jet that the image moved during the exposure, m.
    tail : (float, float)
        Share and length, m, of the far tail of the point spread (`tail`), across the jet: along it the tail sees the jet go on.
    depth : float
        Of the section along the beam over its width.

    Returns
    -------
    ndarray, shape (rows, pixels)

    Raises
    ------
    InputError
        For a jet outside the image, or as `fresnel_counts`.
    """
    z = number("distance", distance, least=0.0, unit="m")
    turn = number("tilt", tilt, least=-STEEPEST, most=STEEPEST, unit="rad")
    out = number("tilt_out", tilt_out, least=-STEEPEST, most=STEEPEST, unit="rad")
    spread = number("blur", blur, least=0.0, unit="m")
    way = number("motion", motion, least=0.0, unit="m")
    p = positive("pixel", pixel, "m")
    seen = _scaled(medium, np.cos(turn) / np.cos(out) * positive("depth", depth))
    detector = Detector(np.ones(pixels), p, blur=spread, tail_share=tail[0], tail_length=tail[1] / np.cos(turn))
    edges = equal_shells(jet.fraction.shape[1])
    radius = jet.radius / np.cos(turn)
    axes = axis + np.tan(turn) * p * np.arange(radius.size)
    half = 0.5 * p * pixels
    worst = int(np.argmax(np.abs(axes) + radius))
    if abs(axes[worst]) + radius[worst] > half:
        raise InputError(
            "pixels",
            f"do not hold the jet in row {worst}",
            value=pixels,
            allowed=f"at least {int(np.ceil(2 * (abs(axes[worst]) + radius[worst]) / p)) + 1}",
            remedy="a wider image, another axis or tilt",
        )
    image = np.empty((radius.size, pixels))
    if z > 0.0:
        wave = WaveRowModel(detector, edges, seen, float(radius.max()))
        aslant = np.tan(turn) ** 2 + _taper(jet, out) ** 2
        for i in range(radius.size):
            far = z * (1.0 + aslant[i])
            image[i] = wave.mean(np.array([*jet.fraction[i], radius[i], axes[i], 1.0, 0.0, spread, far, 1.0]))
    else:
        plain = SpectralRowModel(detector, edges, seen)
        for i in range(radius.size):
            image[i] = plain.evaluate(np.array([*jet.fraction[i], radius[i], axes[i], 1.0, 0.0, spread]))[0]
    return _along(image, spread / p, way / p)


def expected_image(
    transmission: ArrayLike,
    flat: ArrayLike,
    *,
    dark: ArrayLike = 0.0,
    veil: ArrayLike = 0.0,
    amplitude: float = 1.0,
    slope: float = 0.0,
) -> FloatArray:
    """Mean counts of a frame: ``flat (A (1 + s u) T + veil) + dark``.

    Parameters
    ----------
    transmission : array_like, shape (rows, pixels)
        Of `transmission_image`.
    flat, dark, veil : array_like
        Photons without a jet above dark, dark counts, and stray light as a share of the flat; broadcast.
    amplitude, slope : float
        Level of the beam, > 0, and its relative change from the middle of a row to its end, (-1, 1).

    Returns
    -------
    ndarray, shape (rows, pixels)
    """
    t = real("transmission", transmission, least=0.0)
    if t.ndim != 2:
        raise InputError("transmission", "must be a frame (rows, pixels)", value=f"shape {t.shape}")
    level, tilt = positive("amplitude", amplitude), number("slope", slope, above=-1.0, below=1.0)
    u = np.linspace(-1.0, 1.0, t.shape[-1])
    bright = real("flat", flat, least=0.0, unit="photons")
    seen = bright * (level * (1.0 + tilt * u) * t + real("veil", veil, least=0.0))
    return np.asarray(seen + real("dark", dark, least=0.0))


def _taper(jet: JetField, out: float) -> FloatArray:
    """Change of the radius along the jet as the image shows it."""
    if jet.position.size < 2:
        return np.zeros(1)
    return np.asarray(np.gradient(jet.radius, jet.position) / np.cos(out))


def _scaled(medium: Medium, factor: float) -> Medium:
    """A medium through which all paths are longer by a factor."""
    names = ("solvent", "contrast", "air", "delta_solvent", "delta_contrast", "delta_air")
    return replace(medium, **{name: getattr(medium, name) * factor for name in names})


def _along(image: FloatArray, blur: float, way: float) -> FloatArray:
    """Blur and motion along the jet, in rows; at its ends the image goes on as it ends."""
    if blur == 0.0 and way == 0.0:
        return image
    reach = int(np.ceil(5.5 * blur + 0.5 * way)) + 1
    offsets = np.arange(-reach, reach + 1)
    if way > 0.0:  # the box, averaged over a row
        kernel = np.diff(np.clip(np.arange(-reach, reach + 2) - 0.5, -0.5 * way, 0.5 * way)) / way
    else:
        kernel = (offsets == 0).astype(np.float64)
    if blur > 0.0:
        gauss = np.exp(-0.5 * (offsets / blur) ** 2)
        kernel = np.convolve(kernel, gauss / gauss.sum(), mode="same")
    from scipy.ndimage import convolve1d

    return np.asarray(convolve1d(image, kernel / kernel.sum(), axis=0, mode="nearest"))
