"""A scene's jet as it dries: volume left, fraction, radius, and the fraction across it, at places along the jet.

What a profile was given as is kept: a jet given by its velocity becomes thinner, one given by its radius slower. Flat across
the jet by default; with `radial`, the diffusion equation is solved in it and its mean takes the place of the flat one.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.straight import StraightJet
from spinline.rheology.solution import Solution
from spinline.setup.air import Air

if TYPE_CHECKING:
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.rheology.diffusion_laws import DiffusionLaw
    from spinline.rheology.drying import RadialDrying
    from spinline.rheology.element_path import ElementPath
    from spinline.setup.heat import HeatedAir

__all__ = [
    "FARTHEST",
    "Dried",
    "biot_number",
    "check_radial",
    "dry",
    "dry_cooling",
    "element_path",
    "first_passage",
    "fourier_number",
    "peclet_number",
    "where_mean_reaches",
]

FARTHEST = 1e4  # lengths of the jet that a prediction looks beyond it


@dataclass(frozen=True, eq=False)
class Dried:
    """The jet at `position` (n,).

    Attributes
    ----------
    remaining, lost : ndarray
        Volume left over volume at the nozzle, and what has gone.
    reynolds, sherwood : ndarray
        Of the air at the surface; Sherwood of the first solvent.
    notes : tuple of str
        What the correlations have to say.
    radial : RadialDrying or None
        The fraction across the jet.
    temperature : ndarray or None
        K, of a jet that cools.
    liquid : ndarray or None, (liquid, n)
        Volume of each liquid over the total volume at the start, flat across the jet.
    cooling : ndarray or None
        Vapour concentration of the first solvent at the jet's temperature over that at the nozzle's.
    """

    path: "ElementPath"
    remaining: FloatArray
    lost: FloatArray
    reynolds: FloatArray
    sherwood: FloatArray
    notes: tuple[str, ...]
    radial: "RadialDrying | None"
    temperature: FloatArray | None = None
    liquid: FloatArray | None = None
    cooling: FloatArray | None = None

    @property
    def position(self) -> FloatArray:
        """Places, m along the jet."""
        return self.path.position


def element_path(
    jet: "StraightJet | LagrangianJet", position: FloatArray, residence_time: FloatArray | None = None
) -> "ElementPath":
    """Way of a material element; `residence_time` (element,) is that of the usable elements of a bead jet."""
    from spinline.rheology.element_path import bead_path, straight_path

    if isinstance(jet, StraightJet):
        return straight_path(jet, position)
    return bead_path(jet, residence_time=residence_time)


def dry(
    path: "ElementPath",
    solution: Solution,
    air: Air,
    diffusion: "DiffusionLaw | None" = None,
    *,
    glass: float = float("nan"),
    cells: int = 100,
    rtol: float = 1e-5,
) -> Dried:
    """Evaporation along a path, with the fraction across the jet where a diffusion law is given.

    Parameters
    ----------
    path : ElementPath
        Of the jet.
    solution, air
        Of the scene.
    diffusion : DiffusionLaw, optional
        Solves radial drying with it.
    glass : float
        Vitrification fraction; NaN where not known.
    cells : int
        Across the jet.
    rtol : float
        Of radial drying.

    Raises
    ------
    InputError
        For radial drying of a mixture, or with another activity than Flory and Huggins'.
    """
    phi = solution.volume_fraction
    flat = air.evaporate(path, phi)
    dried = Dried(
        path, flat.remaining, flat.lost, flat.reynolds, flat.sherwood[0], flat.notes, None, None, flat.solvent_volume
    )
    if diffusion is None:
        return dried
    check_radial(air)
    from spinline.rheology.drying import dry_radially

    radial = dry_radially(
        path,
        phi,
        air.volatiles[0],
        diffusion,
        air_viscosity=air.viscosity,
        air_velocity=air.velocity,
        sherwood_floor=air.floor,
        vitrification_fraction=None if np.isnan(glass) else glass,
        cells=cells,
        rtol=rtol,
    )
    radial = _not_below_dryness(radial, path, phi)
    return replace(dried, remaining=radial.remaining, lost=radial.lost, radial=radial)


def dry_cooling(
    path: "ElementPath",
    solution: Solution,
    air: "HeatedAir",
    diffusion: "DiffusionLaw | None" = None,
    *,
    cells: int = 100,
    rtol: float = 1e-5,
) -> Dried:
    """`dry` of a jet that cools and takes up water; radial drying is that of its solvent alone."""
    phi = solution.volume_fraction
    flat = air.dry(path, phi)
    dried = Dried(
        path,
        flat.remaining,
        flat.lost,
        flat.reynolds,
        flat.sherwood[0],
        flat.notes,
        None,
        flat.temperature,
        flat.solvent_volume,
        _cooling(air, flat.temperature),
    )
    if diffusion is None:
        return dried
    radial = _not_below_dryness(air.dry_radially(path, phi, diffusion, cells, rtol), path, phi)
    return replace(
        dried,
        remaining=radial.remaining,
        lost=radial.lost,
        radial=radial,
        temperature=radial.temperature,
        cooling=None if radial.temperature is None else _cooling(air, radial.temperature),
    )


def _cooling(air: "HeatedAir", temperature: FloatArray) -> FloatArray:
    first = air.evaporants[0]
    start = first.pressure(air.temperature) / air.temperature
    return first.pressures(temperature) / temperature / start


_UNDERSHOOT = 1e-5  # of the solvent there was


def _not_below_dryness(radial: "RadialDrying", path: "ElementPath", phi: float) -> "RadialDrying":
    """The same with cells that the integration left below dryness, by less than its error, dry.

    What they lack is taken from the wet ones, in proportion: what is left and what has gone stay as they are. Only where
    the whole cross-section is below dryness it ends dry, and what has gone is then all there was.

    Raises
    ------
    InputError
        Where they are farther below than that.
    """
    wet = 1 / radial.polymer_fraction - 1
    if wet.min() >= 0:
        return radial
    if wet.min() < -_UNDERSHOOT * (1 - phi) / phi:
        raise InputError(
            "accuracy.shells",
            "is too small: the jet dries beyond dryness",
            value=radial.polymer_share.size,
            remedy="raise it",
        )
    share = radial.polymer_share
    total, wet = np.maximum(wet @ share, 0.0), np.maximum(wet, 0.0)
    held = wet @ share
    wet *= np.divide(total, held, out=np.ones_like(held), where=held > 0)[:, np.newaxis]
    volume = np.concatenate((np.zeros((wet.shape[0], 1)), np.cumsum(share * (1 + wet), axis=1)), axis=1)
    left = phi * volume[:, -1]
    stretch = path.stretch(path.position) * (left if path.given == "radius" else 1.0)
    return replace(
        radial,
        polymer_fraction=1 / (1 + wet),
        mean_fraction=1 / volume[:, -1],
        remaining=left,
        lost=1 - left,
        edges=path.initial_radius * np.sqrt(phi * volume / stretch[:, np.newaxis]),
    )


def check_radial(air: Air) -> None:
    """Refuse what radial drying cannot do."""
    if np.count_nonzero(air.shares) > 1:
        raise InputError(
            "effects.radial", "takes one solvent, and this is a mixture", value=True, remedy="set it to false"
        )
    if air.activity != "flory-huggins":
        raise InputError(
            "effects.radial",
            "takes the activity of Flory and Huggins",
            value=air.activity,
            remedy='set rheology.activity = "flory-huggins", or effects.radial = false',
        )


def peclet_number(dried: Dried, air: Air, diffusion: "DiffusionLaw", volume_fraction: float) -> FloatArray:
    """Evaporation against diffusion in the jet, ``D_a Sh C_sat/(2 D)``, D at the mean fraction."""
    from spinline.rheology.drying import drying_peclet

    only = air.volatiles[0]
    mean = np.minimum(volume_fraction / dried.remaining, 1.0)
    saturation = only.saturation if dried.cooling is None else only.saturation * dried.cooling
    return drying_peclet(only.diffusivity, dried.sherwood, saturation, diffusion(mean))


def biot_number(peclet: FloatArray, dried: Dried, air: Air, volume_fraction: float) -> FloatArray:
    """Surface resistance: Peclet number times ``d(activity)/du``, u the solvent per polymer, at the mean fraction."""
    chi = air.volatiles[0].chi
    phi = np.minimum(volume_fraction / dried.remaining, 1.0)
    # a = (1 - phi) exp(phi + chi phi^2), phi = 1/(1 + u): da/du = -phi^2 da/dphi
    slope = phi**3 * (1 - 2 * chi * (1 - phi)) * np.exp(phi * (1 + chi * phi))
    value: FloatArray = peclet * slope
    return value


def fourier_number(dried: Dried, diffusion: "DiffusionLaw", volume_fraction: float) -> FloatArray:
    """Time for diffusion across the jet, ``int D/r^2 dt``, D at the mean fraction; ``pi D z/Q`` without evaporation."""
    path = dried.path
    mean = np.minimum(volume_fraction / dried.remaining, 1.0)
    pace = path.exposure(path.position) * diffusion(mean) / dried.remaining / path.initial_radius**2
    first = path.exposure(np.asarray([path.start])) * diffusion(np.asarray([volume_fraction])) / path.initial_radius**2
    x = np.concatenate(([path.start], path.position))
    y = np.concatenate((first, pace))
    value: FloatArray = np.cumsum(np.diff(x) * 0.5 * (y[1:] + y[:-1]))
    return value


def where_mean_reaches(
    dried: Dried,
    air: Air,
    solution: Solution,
    jet: "StraightJet | LagrangianJet",
    fraction: float,
    *,
    beyond: bool = True,
) -> tuple[float, float]:
    """Where the mean fraction reaches a value, m: within the jet, and as predicted if the profile went on.

    Returns
    -------
    position, predicted : float
        NaN where it does not, or cannot be said; `predicted` is that of flat drying beyond a straight jet of a law.
    """
    phi = solution.volume_fraction / dried.remaining
    x, straight = dried.position, isinstance(jet, StraightJet)
    place = first_passage(x, phi, fraction)
    if not np.isnan(place):
        if straight and dried.radial is None:
            place = _refined(air, solution, jet, x, place, fraction)
        return place, place
    if not isinstance(jet, StraightJet) or not beyond or not np.isinf(jet.end) or fraction >= air.equilibrium:
        return float("nan"), float("nan")
    farther = np.geomspace(x[-1], FARTHEST * x[-1], 801)
    try:
        flat = air.evaporate(element_path(jet, farther), solution.volume_fraction)
        predicted = first_passage(farther, flat.polymer_fraction, fraction)
        return float("nan"), _refined(air, solution, jet, farther, predicted, fraction)
    except InputError:
        return float("nan"), float("nan")


def _refined(
    air: Air, solution: Solution, jet: "StraightJet | LagrangianJet", x: FloatArray, place: float, fraction: float
) -> float:
    """The place again, between the two samples around it."""
    i = int(np.searchsorted(x, place))
    if np.isnan(place) or i == 0:
        return place
    inner = np.linspace(x[i - 1], x[i], 17)
    flat = air.evaporate(element_path(jet, inner), solution.volume_fraction)
    better = first_passage(inner, flat.polymer_fraction, fraction)
    return place if np.isnan(better) else better


def first_passage(position: FloatArray, value: FloatArray, level: float) -> float:
    """First place where a value rises past a level, by a monotone cubic between samples; NaN where it never does."""
    from scipy.interpolate import PchipInterpolator
    from scipy.optimize import brentq

    above = np.flatnonzero(value >= level)
    if not above.size:
        return float("nan")
    i = int(above[0])
    if i == 0:
        return float(position[0])
    lo, hi = max(i - 2, 0), min(i + 2, position.size)
    # in shares of the panel: positions may be 1e-9 m apart
    x = (position[lo:hi] - position[i - 1]) / (position[i] - position[i - 1])
    curve = PchipInterpolator(x, value[lo:hi] - level)
    share = float(brentq(lambda at: float(curve(at)), 0.0, 1.0, xtol=1e-15)) if value[i] > level else 1.0
    return float(position[i - 1] + share * (position[i] - position[i - 1]))
