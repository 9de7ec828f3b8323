"""What the photons allow: the Cramer-Rao bound of a polymer fraction, before anything is reduced.

Counts of mean lambda are Poisson, so the Fisher matrix is ``F = J^T diag(1/lambda) J`` with J the derivatives of lambda with
all unknowns; for the fractions alone and a thin jet, ``F = D^2 L^T W L`` with chords L and photons W. No unbiased estimate has
a smaller covariance than its inverse. Unknown radius, axis, beam level, slope and blur (nuisances) cost precision: they
belong in.

In the thin limit, with N photons per pixel in all (rows, frames, exposure) and p the pixel's width, for a uniform jet::

    sigma(mean phi) = 1/(|D| sqrt(16 N R^3/(3 p))),    sigma(centre chord) = 1/(2 R |D| sqrt(N)).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, real
from spinline.base.errors import InputError
from spinline.xray.matter.energy import SMALLEST_CONTRAST
from spinline.xray.row.chords import shell_weights
from spinline.xray.row.forward import Absorber, Detector, RoundJet, row_model
from spinline.xray.row.model import EXTRAS, NUISANCES

__all__ = ["Limit", "covariance_bound", "error_limit", "photons_needed", "thin_centre_limit", "thin_mean_limit"]


@dataclass(frozen=True, eq=False)
class Limit:
    """Smallest standard deviations that the counts allow.

    Attributes
    ----------
    fraction : ndarray, shape (shells,)
        Of each shell's polymer fraction.
    mean : float
        Of the mean over the cross-section.
    nuisances : dict
        Of each nuisance that was free, by name: radius, axis, blur in m; amplitude and slope are pure numbers.
    names : tuple of str
        Rows of `covariance`.
    covariance : ndarray
        Inverse of the Fisher matrix.
    """

    fraction: FloatArray
    mean: float
    nuisances: dict[str, float]
    names: tuple[str, ...]
    covariance: FloatArray


def error_limit(
    jet: RoundJet,
    absorber: Absorber,
    detector: Detector,
    *,
    nuisances: Sequence[str] = (),
    amplitude: float = 1.0,
    slope: float = 0.0,
    good: ArrayLike | None = None,
) -> Limit:
    """Cramer-Rao bound for the shells and their mean.

    Parameters
    ----------
    jet, absorber, detector, amplitude, slope
        The jet that is expected, as in `forward.expected_counts`; one shell is the uniform jet. For many rows and frames, sum
        `flat` and `dark`.
    nuisances : sequence of str
        What else is unknown: any of "radius", "axis", "amplitude", "slope", "blur", "tail_share", "tail_length", "shape2",
        "shape3", "shape4".
    good : array_like of bool, optional
        False for pixels left out.

    Returns
    -------
    Limit

    Raises
    ------
    InputError
        For ``|D|`` under 1 % of the solvent's attenuation, an unknown nuisance, or unknowns that the row cannot tell apart.
    """
    require_contrast(absorber)
    level = float(real("amplitude", amplitude, above=0.0))
    tilt = float(real("slope", slope, above=-1.0, below=1.0))
    blur_free = "blur" in nuisances
    if blur_free and detector.blur == 0.0:
        raise InputError("blur", "cannot be unknown about 0", value=0.0, remedy="give Detector a blur > 0")
    extras = extra_parameters(nuisances, detector)
    free = free_parameters(jet.fraction.size, nuisances)
    model = row_model(absorber, detector, jet.shell_edges, extras=extras)
    tail = {"tail_share": detector.tail_share, "tail_length": detector.tail_length}
    more = [tail.get(name, 0.0) for name in extras]
    parameters = np.concatenate((jet.fraction, [jet.radius, jet.axis, level, tilt, detector.blur], more))
    counts, jacobian = model.evaluate(parameters)
    mask = good_pixels(good, counts.size)
    names = tuple(model.names[i] for i in free)
    covariance = covariance_bound(counts[mask], jacobian[mask][:, free], names)
    sd = np.sqrt(np.diag(covariance))
    shells = jet.fraction.size
    weights = shell_weights(jet.shell_edges)
    mean = float(np.sqrt(weights @ covariance[:shells, :shells] @ weights))
    return Limit(sd[:shells], mean, dict(zip(names[shells:], sd[shells:].tolist(), strict=True)), names, covariance)


def covariance_bound(
    counts: FloatArray, jacobian: FloatArray, names: Sequence[str], prior: FloatArray | None = None
) -> FloatArray:
    """Inverse Fisher matrix of Poisson means > 0, shape (pixels,), with derivatives, shape (pixels, unknowns), and with what is
    known of the unknowns beforehand, 1/variance, shape (unknowns,).

    Raises
    ------
    InputError
        Where the unknowns cannot be told apart: an eigenvalue of the matrix, scaled to unit diagonal, under 1e-12.
    """
    if counts.size >= jacobian.shape[1] and (counts <= 0).any():
        raise InputError(
            "energy_kev",
            f"lets no photon through to {int((counts <= 0).sum())} of {counts.size} pixels: the jet is black there",
            remedy="a higher energy, or leave dark pixels out",
        )
    if counts.size < jacobian.shape[1]:
        raise InputError(
            "flat",
            "has fewer lit pixels than there are unknowns",
            value=int((counts > 0).sum()),
            allowed=f"at least {jacobian.shape[1]}",
            remedy="fewer shells, or a wider row",
        )
    fisher = jacobian.T @ (jacobian / counts[:, None])
    if prior is not None:
        fisher[np.diag_indices_from(fisher)] += prior
    scale = np.sqrt(np.diag(fisher))
    if not (scale > 0).all():
        blind = ", ".join(name for name, s in zip(names, scale, strict=True) if not s > 0)
        raise InputError(
            "jet", f"leaves no trace of {blind} in the row", remedy="check radius and axis against the row"
        )
    values, vectors = np.linalg.eigh(fisher / np.outer(scale, scale))
    if values[0] < 1e-12:
        worst = np.argsort(-np.abs(vectors[:, 0]))[:2]
        raise InputError(
            "shells",
            "the row cannot tell apart " + " and ".join(names[i] for i in worst),
            remedy="fewer shells or nuisances, or air on both sides of the jet",
        )
    scaled = vectors / np.sqrt(values) / scale[:, None]
    return np.asarray(scaled @ scaled.T)


def thin_mean_limit(radius: ArrayLike, contrast: ArrayLike, photons: ArrayLike, pixel: ArrayLike) -> FloatArray:
    """Thin limit of sigma(mean phi), nothing else unknown: ``1/(|D| sqrt(16 N R^3/(3 p)))``.

    Parameters
    ----------
    radius, pixel : array_like
        m, > 0.
    contrast : array_like
        D, 1/m, not 0.
    photons : array_like
        Per pixel in all, > 0.

    Returns
    -------
    ndarray
        Low by about ``mu R`` of itself (4 % for 50 um of water at 10 keV): transmission is left out.
    """
    r, d, n = real("radius", radius, above=0.0, unit="m"), _contrast(contrast), real("photons", photons, above=0.0)
    p = real("pixel", pixel, above=0.0, unit="m")
    with np.errstate(over="ignore"):
        value: FloatArray = np.sqrt(3.0) / 4.0 * (np.sqrt(p) / np.sqrt(n)) / r / np.sqrt(r) / np.abs(d)
    return real("limit", value, remedy="it is beyond what a double holds")


def thin_centre_limit(radius: ArrayLike, contrast: ArrayLike, photons: ArrayLike) -> FloatArray:
    """Thin limit of the mean along the centre chord alone, ``1/(2 R |D| sqrt(N))``; arguments as in `thin_mean_limit`."""
    r, n = real("radius", radius, above=0.0, unit="m"), real("photons", photons, above=0.0)
    d = _contrast(contrast)
    with np.errstate(over="ignore"):
        value: FloatArray = 0.5 / np.sqrt(n) / r / np.abs(d)
    return real("limit", value, remedy="it is beyond what a double holds")


def photons_needed(
    sigma: float,
    jet: RoundJet,
    absorber: Absorber,
    pixel: float,
    *,
    nuisances: Sequence[str] = (),
    blur: float = 0.0,
    tail: tuple[float, float] = (0.0, 0.0),
) -> float:
    """Photons per pixel, in all, for a standard deviation `sigma` of the mean fraction.

    Parameters
    ----------
    sigma : float
        > 0.
    jet : RoundJet
        The jet that is expected; its shells are unknown one by one, so give one shell for the mean alone.
    absorber, pixel, nuisances
        As in `error_limit`. The row is taken twice as wide as the jet, without dark counts or veil.
    blur, tail : float, (float, float)
        Of the detector: standard deviation, and share and length of its far tail, m.

    Returns
    -------
    float
    """
    wanted = float(real("sigma", sigma, above=0.0))
    p = float(real("pixel", pixel, above=0.0, unit="m"))
    pixels = int(np.ceil(4.0 * jet.radius / p)) + 2
    centred = RoundJet(jet.fraction, jet.radius, 0.0, jet.shell_edges)
    detector = Detector(np.ones(pixels), p, blur=blur, tail_share=tail[0], tail_length=tail[1])
    found = error_limit(centred, absorber, detector, nuisances=nuisances)
    return (found.mean / wanted) ** 2


def require_contrast(absorber: Absorber) -> None:
    """Refuse a contrast that cannot tell polymer from solvent."""
    if abs(absorber.contrast) < SMALLEST_CONTRAST * absorber.solvent:
        raise InputError(
            "contrast",
            "is under 1 % of the solvent's attenuation: absorption does not tell polymer from solvent here",
            value=absorber.contrast,
            allowed=f"|D| >= {SMALLEST_CONTRAST * absorber.solvent:.3g} 1/m",
            remedy="choose another photon energy (xray.usable_contrast names one)",
        )


def free_parameters(shells: int, nuisances: Sequence[str]) -> list[int]:
    """Indices of the free parameters of a `model.RowModel` whose extras are the `extra_parameters` of the same nuisances."""
    known = (*NUISANCES, *EXTRAS)
    unknown = [name for name in nuisances if name not in known]
    if isinstance(nuisances, str) or unknown:
        raise InputError("nuisances", "are not known", value=unknown or nuisances, allowed=", ".join(known))
    names = (*NUISANCES, *(name for name in EXTRAS if name in nuisances))
    return [*range(shells), *(shells + i for i, name in enumerate(names) if name in nuisances)]


def extra_parameters(nuisances: Sequence[str], detector: Detector) -> tuple[str, ...]:
    """Those of `model.EXTRAS` that are fitted; a tail is refused where the detector gives no first guess of its length."""
    extras = tuple(name for name in EXTRAS if name in nuisances)
    if any(name.startswith("tail") for name in extras) and detector.tail_length == 0.0:
        raise InputError(
            "tail_length",
            "cannot be fitted from 0",
            value=0.0,
            remedy="give Detector a first guess of the tail's length",
        )
    if "tail_length" in extras and detector.tail_share == 0.0:
        raise InputError(
            "tail_length",
            "says nothing where the tail has no light",
            value=0.0,
            remedy="give Detector a tail_share > 0",
        )
    return extras


def good_pixels(good: ArrayLike | None, pixels: int) -> BoolArray:
    """Mask of shape (pixels,); all True where left out."""
    if good is None:
        return np.ones(pixels, dtype=np.bool_)
    mask = np.asarray(good)
    if mask.dtype != np.bool_ or mask.shape != (pixels,):
        raise InputError(
            "good",
            "is not a mask of the row",
            value=f"{mask.dtype} of shape {mask.shape}",
            allowed=f"bool, ({pixels},)",
        )
    return mask


def _contrast(contrast: ArrayLike) -> FloatArray:
    value = real("contrast", contrast, unit="1/m")
    if (value == 0).any():
        raise InputError("contrast", "is zero", value=0.0, remedy="choose another photon energy")
    return value
