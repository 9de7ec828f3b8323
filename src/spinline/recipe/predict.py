"""A recipe's fibre: median, intervals, what the interval is made of, regime, orientation; one measured fibre sharpens it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.recipe.believe import Recipe, believe
from spinline.recipe.constants import GLOBAL
from spinline.recipe.model import UNKNOWNS, Believed, Fibres, spun
from spinline.recipe.regime import Regime, regime_of

__all__ = ["RUNGS", "Fibre", "Measurement", "predict"]

#: Ways to compute the diameter.
RUNGS = ("race", "terminal")
_DRAWS = 2048
_QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)


@dataclass(frozen=True)
class Measurement:
    """A fibre that was measured on the same rig: its recipe, its diameter in m, and the standard deviation of its logarithm."""

    recipe: Recipe
    diameter: float
    sd: float = 0.05


@dataclass(frozen=True)
class Fibre:
    """What a recipe gives.

    Attributes
    ----------
    fibre_diameter : float
        Median, m.
    fibre_diameter_68, fibre_diameter_95 : tuple of float
        m.
    orientation, orientation_68 : float, tuple
        Hermans orientation of the strands when the jet is solid, with what relaxes on the way.
    regime : str
        The likeliest of `spinline.recipe.regime.REGIMES`.
    regimes : mapping
        Share of the draws in each.
    rung : str
        Which law: "race" or "terminal".
    decides : str
        What ended the thinning in most draws.
    variance_shares : mapping
        First-order share of the variance of ln d, by unknown; they add up to 1 less what unknowns do together.
    current, viscosity, charge_density : float
        Medians, SI.
    trade : mapping
        Median diameter by the other rungs, m.
    borrowed : mapping
        What the recipe did not say and what was taken, by its key.
    remarks : tuple of str
    """

    fibre_diameter: float
    fibre_diameter_68: tuple[float, float]
    fibre_diameter_95: tuple[float, float]
    orientation: float
    orientation_68: tuple[float, float]
    regime: str
    regimes: Mapping[str, float]
    rung: str
    decides: str
    variance_shares: Mapping[str, float]
    current: float
    viscosity: float
    charge_density: float
    trade: Mapping[str, float]
    borrowed: Mapping[str, str]
    remarks: tuple[str, ...] = ()


def predict(
    recipe: Recipe,
    measured: Sequence[Measurement] = (),
    *,
    rung: str = "race",
    draws: int = _DRAWS,
    shares: bool = True,
) -> Fibre:
    """Fibre of a recipe.

    Parameters
    ----------
    recipe : Recipe
    measured : sequence of Measurement
        Fibres of the same rig and materials; what they say of the shared unknowns sharpens the answer.
    rung : {"race", "terminal"}
    draws : int
        Of a fixed scrambled Sobol' sequence: the same recipe gives the same answer.
    shares : bool
        Compute the variance shares too (13 times the draws).

    Returns
    -------
    Fibre

    Notes
    -----
    0.05 s, 0.3 s with the shares. The quantiles of 2048 such draws are good to about 1 %.
    """
    if rung not in RUNGS:
        raise InputError("rung", "is not known", value=rung, allowed=", ".join(RUNGS))
    believed, borrowed = believe(recipe)
    z = _normals(draws)
    found = spun(believed, z, rung=rung)
    log_d, weights = found.log_diameter, None
    if measured:
        log_d, weights = _conditioned(found.log_diameter, z, measured, rung)
    low95, low68, median, high68, high95 = np.exp(np.quantile(log_d, _QUANTILES))
    orientation = _orientation(found, believed, z)
    regime = regime_of(believed, recipe, found)
    ended = _decides(found)
    terminal = float(np.exp(np.median(np.log(found.terminal))))
    race = float(np.median(2 * np.sqrt(believed.volume_fraction) * found.thinning.radius))
    return Fibre(
        fibre_diameter=float(median),
        fibre_diameter_68=(float(low68), float(high68)),
        fibre_diameter_95=(float(low95), float(high95)),
        orientation=float(np.median(orientation)),
        orientation_68=tuple(float(v) for v in np.quantile(orientation, (0.16, 0.84))),  # type: ignore[arg-type]
        regime=regime.name,
        regimes=regime.shares,
        rung=rung,
        decides=ended,
        variance_shares=_shares(believed, rung) if shares else {},
        current=float(np.median(found.current)),
        viscosity=float(np.median(found.viscosity)),
        charge_density=float(np.median(found.charge_density)),
        trade={"terminal": terminal} if rung == "race" else {"race": race},
        borrowed=borrowed,
        remarks=_remarks(regime, weights),
    )


@lru_cache(maxsize=8)
def _normals(draws: int, seed: int = 1) -> FloatArray:
    from scipy.special import ndtri
    from scipy.stats import qmc

    points = qmc.Sobol(len(UNKNOWNS), seed=seed).random(draws)
    value: FloatArray = ndtri(np.clip(points, 1e-9, 1 - 1e-9))
    return value


def _conditioned(
    log_d: FloatArray, z: FloatArray, measured: Sequence[Measurement], rung: str
) -> tuple[FloatArray, FloatArray]:
    """Ln d of the draws, given what was measured: each draw moved by the gain that normal quantities have.

    The unknowns of the rig are shared, the repeat is not: every measurement has its own. Exact where ln d is linear in the
    unknowns, which it is nearly (exponents of powers).
    """
    seen, target = [], []
    for i, one in enumerate(measured):
        if not one.diameter > 0:
            raise InputError("measured.fibre_diameter", "is not above zero", value=one.diameter, allowed="> 0 m")
        own = z.copy()
        own[:, -1] = _normals(len(z), seed=100 + i)[:, -1]
        believed, _ = believe(one.recipe)
        seen.append(spun(believed, own, rung=rung).log_diameter + one.sd * _normals(len(z), seed=200 + i)[:, 0])
        target.append(np.log(one.diameter))
    y = np.array(seen)
    spread = y - y.mean(axis=1, keepdims=True)
    cross = spread @ (log_d - log_d.mean()) / len(z)
    gain = np.linalg.solve(spread @ spread.T / len(z) + 1e-12 * np.eye(len(y)), cross)
    return log_d + (np.array(target)[:, np.newaxis] - y).T @ gain, gain


def _orientation(found: Fibres, believed: Believed, z: FloatArray) -> FloatArray:
    """Hermans orientation of the strands in the solid fibre, to an order of magnitude.

    Strands follow the jet while their relaxation time ``theta = (mu/G) (phi/phi_0)^y`` is longer than the drying takes, and
    forget it while it is shorter; what is stretched after the fraction at which the two are equal stays. In a race that is
    ``(1 - (phi_0/phi)^p)^(-1/2)``, never more than the whole stretch. G is 2 MPa phi^2.3 (melts' plateau, diluted), y = 2.33;
    times in stretching are up to ten times those of shear, so theta has a spread of its own.
    """
    from spinline.network.lattice_walk import stretched_walk

    thin, p = found.thinning, GLOBAL["viscosity_power"]
    slower = np.exp(believed.sd.get("relaxation_time", 0.0) * z[:, list(UNKNOWNS).index("relaxation_time")])
    theta = 3 * slower * found.viscosity / (2e6 * believed.volume_fraction**2.3)
    thicker = np.maximum((thin.time / theta) ** (1 / 2.33), 1.0)  # phi at which the strands freeze over phi_0
    whole = believed.onset_radius**2 / thin.radius**2
    late = -np.expm1(-p * np.log(np.maximum(thicker, 1 + 1e-12)))
    stretch = np.clip(np.minimum(late**-0.5, whole), 1.0, 0.999 / believed.volume_fraction)
    value: FloatArray = np.maximum(stretched_walk(stretch, volume_fraction=believed.volume_fraction).orientation, 0.0)
    return value


def _decides(found: Fibres) -> str:
    thin = found.thinning
    if float(thin.wet.mean()) > 0.5:
        return "flight: it lands before it is solid"
    near = np.log(thin.radius / found.terminal_radius) < np.log(1.15)
    return (
        "terminal: charge against surface tension"
        if float(near.mean()) > 0.5
        else "race: it dries while it is stretched"
    )


def _shares(believed: Believed, rung: str) -> dict[str, float]:
    """First-order Sobol' shares of ln d by Saltelli's and Jansen's pairs."""
    n = 1024
    from scipy.special import ndtri
    from scipy.stats import qmc

    both = ndtri(np.clip(qmc.Sobol(2 * len(UNKNOWNS), seed=3).random(n), 1e-9, 1 - 1e-9))
    a, b = both[:, : len(UNKNOWNS)], both[:, len(UNKNOWNS) :]
    active = [i for i, name in enumerate(UNKNOWNS) if believed.sd.get(name, 0.0) > 0]
    stacked = [a, b]
    for i in active:
        mixed = a.copy()
        mixed[:, i] = b[:, i]
        stacked.append(mixed)
    values = spun(believed, np.concatenate(stacked), rung=rung, steps=16).log_diameter.reshape(len(stacked), n)
    fa, fb, total = values[0], values[1], float(np.var(values[:2]))
    if total <= 0:
        return {}
    first = {list(UNKNOWNS)[i]: float(np.mean(fb * (values[2 + j] - fa)) / total) for j, i in enumerate(active)}
    return dict(sorted(((name, share) for name, share in first.items() if share > 1e-4), key=lambda item: -item[1]))


def _remarks(regime: Regime, weights: FloatArray | None) -> tuple[str, ...]:
    said = list(regime.remarks)
    if weights is not None and float(np.sum(weights)) > 1.5:
        said.append("the measured fibres are far from what was expected of their recipes: check their units")
    return tuple(said)
