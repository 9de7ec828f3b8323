"""A recipe's fibre: median, intervals, what the interval is made of, regime, orientation; one measured fibre sharpens it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.envelope import Envelope
from spinline.recipe.believe import Recipe, believe
from spinline.recipe.constants import CONSTANTS, TAKEN
from spinline.recipe.measured import Measurement, conditioned
from spinline.recipe.model import UNKNOWNS, Believed, Fibres, normals, spun
from spinline.recipe.outside import outside_remarks, size_remarks, watery
from spinline.recipe.regime import regime_of

__all__ = ["RUNGS", "Fibre", "predict"]

#: Ways to compute the diameter.
RUNGS = {
    "race": "stretching against drying, surface tension and the flight",
    "terminal": "charge against surface tension alone",
    "envelope": "the thread of the loops, with inertia, air and the speed of the flight",
    "lagrangian": "bead by bead to the collector, at the recipe's medians: a minute",
}
_DRAWS = 2048
_FEWEST = 100
_INERT = 0.2  # of ln d, between envelope and race, beyond which it is said
_QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)


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
        Which law, of `RUNGS`.
    decides : str
        What ended the thinning in most draws.
    variance_shares : mapping
        First-order share of the variance of ln d, by unknown; they add up to 1 less what unknowns do together.
    current, viscosity, charge_density : float
        Medians, SI.
    current_68, viscosity_68 : tuple of float
        What the recipe and the priors say of them; SI.
    trade : mapping
        Median diameter by the other rungs, m.
    borrowed : mapping
        What the recipe did not say and what was taken, by its key.
    remarks : tuple of str
    landing_fraction : float
        Polymer in the fibre where it lands or is solid, median; 0.7 and more is dry.
    laying_speed : float
        m/s at which one unbroken fibre of this diameter uses up the flow: length made a second.
    flight_time, envelope_radius : float
        Medians: s from the onset of bending; m, of the loops where the thread is solid or lands (rung "envelope", else None).
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
    current_68: tuple[float, float]
    viscosity_68: tuple[float, float]
    charge_density: float
    trade: Mapping[str, float]
    borrowed: Mapping[str, str]
    remarks: tuple[str, ...] = ()
    landing_fraction: float = float("nan")
    laying_speed: float = float("nan")
    flight_time: float = float("nan")
    envelope_radius: float | None = None


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
    rung : str
        One of `RUNGS`. "lagrangian" spins the medians and takes the interval of "race" about them.
    draws : int
        Of a fixed Latin hypercube: the same recipe gives the same answer.
    shares : bool
        With the variance shares.

    Returns
    -------
    Fibre

    Notes
    -----
    Some 0.05 s (0.15 s with "envelope"; "lagrangian" up to a minute and a half). The quantiles of 2048 such draws are good
    to about 1 %, the shares to 0.01.
    """
    known_rung(rung)
    if not draws >= _FEWEST:
        raise InputError("draws", "are too few for edges of 95 %", value=draws, allowed=f"{_FEWEST} or more")
    recipe, measured = one_laboratory(recipe, measured)
    believed, borrowed = believe(recipe)
    z = normals(draws)
    about: tuple[str, ...] = ()
    shift = doubt = 0.0
    if rung == "lagrangian":
        about, shift, doubt = _spun_by_beads(believed)
    law = "race" if rung == "lagrangian" else rung
    found = spun(believed, z, rung=law)
    log_d = found.log_diameter
    compared: tuple[str, ...] = ()
    if measured:
        log_d, compared = conditioned(log_d, z, recipe, measured, law, shift, doubt)
    log_d = log_d + shift
    low95, low68, median, high68, high95 = np.exp(np.quantile(log_d, _QUANTILES))
    orientation = _orientation(found, believed, z)
    regime = regime_of(believed, recipe, found)
    ended = _decides(found)
    trade = _trade(believed, z, found, rung, law, dear=shares)
    alone = 2 * np.sqrt(believed.volume_fraction) * float(np.median(found.thinning.radius))
    if rung == "race" and abs(np.log(trade.get("envelope", alone) / alone)) > _INERT:
        about += (
            f"inertia, air and the speed of the flight matter here: the envelope of loops gives {1e9 * trade['envelope']:.3g} "
            f"nm where the race gives {1e9 * alone:.3g}; --rung envelope follows them",
        )
    return Fibre(
        fibre_diameter=float(median),
        fibre_diameter_68=(float(low68), float(high68)),
        fibre_diameter_95=(float(low95), float(high95)),
        orientation=float(np.median(orientation)),
        orientation_68=_middle(orientation),
        regime=regime.name,
        regimes=regime.shares,
        rung=rung,
        decides=ended,
        variance_shares=_with_rest(shares_of(log_d, z), bool(measured)) if shares else {},
        current=float(np.median(found.current)),
        viscosity=float(np.median(found.viscosity)),
        current_68=_middle(found.current),
        viscosity_68=_middle(found.viscosity),
        charge_density=float(np.median(found.charge_density)),
        trade=trade,
        borrowed=borrowed,
        remarks=(
            *outside_remarks(recipe),
            *size_remarks(float(median)),
            *about,
            *regime.remarks,
            *compared,
            *_pores(recipe, believed),
        ),
        landing_fraction=float(np.median(found.thinning.volume_fraction)),
        laying_speed=float(recipe.flow_rate * believed.volume_fraction / (np.pi * (median / 2) ** 2)),
        flight_time=float(np.median(found.thinning.time)),
        envelope_radius=_loops(found),
    )


def known_rung(rung: str) -> None:
    """Refuse a way to compute the diameter that there is not."""
    if rung not in RUNGS:
        raise InputError("rung", "is not known", value=rung, allowed=", ".join(RUNGS))


def _middle(values: FloatArray) -> tuple[float, float]:
    low, high = np.quantile(values, (0.16, 0.84)).tolist()
    return low, high


def _loops(found: Fibres) -> float | None:
    return float(np.median(found.thinning.envelope_radius)) if isinstance(found.thinning, Envelope) else None


def _trade(believed: Believed, z: FloatArray, found: Fibres, rung: str, law: str, dear: bool) -> dict[str, float]:
    """Median diameters by the other rungs, m; the envelope only where it is worth its time."""
    dry = 2 * np.sqrt(believed.volume_fraction)
    by = {"terminal": found.terminal_radius, law: found.thinning.radius}
    for other in ("race", "envelope"):
        if other not in by and (dear or other == "race"):
            by[other] = spun(believed, z, rung=other).thinning.radius
    if law == "terminal":
        by["race"] = found.thinning.radius
    return {name: float(dry * np.median(by[name])) for name in RUNGS if name in by and name != rung}


def _spun_by_beads(believed: Believed) -> tuple[tuple[str, ...], float, float]:
    """What a chain of the medians laid, in words; ln of its fibre over the race's there, and how much that may miss."""
    from spinline.recipe.lagrangian import TOO_THICK, laid

    chain = laid(believed)
    alone = spun(believed, np.zeros((1, len(UNKNOWNS))), rung="race").thinning.radius[0]
    words = (
        f"bead by bead: {1e9 * chain.fibre_diameter:.3g} nm within a factor of {np.exp(chain.spread):.2g} along the fibre, "
        f"landing at {chain.impact_speed:.2g} m/s within {1e3 * chain.spot_radius:.2g} mm of the axis with "
        f"{100 * chain.landing_fraction:.0f} % of polymer; its charge is {100 * chain.carried:.2g} % of what the current "
        f"would bring, a bound from the thick side (published fibres came out {TOO_THICK} times too thick); interval, "
        "regime and orientation are those of the race"
    )
    alone *= 2 * np.sqrt(believed.volume_fraction)
    return (words,), float(np.log(chain.fibre_diameter / alone)), float(np.log(TOO_THICK))


def one_laboratory(recipe: Recipe, measured: Sequence[Measurement]) -> tuple[Recipe, list[Measurement]]:
    """The recipes with the fraction about which they are spun in common: the recipe's, else the mean of all."""
    alike = [one.recipe for one in measured if one.recipe.polymer == recipe.polymer]
    if not alike:
        return recipe, list(measured)
    usual = recipe.usual_fraction
    if usual != usual:
        given = [r.mass_fraction for r in (recipe, *alike) if 0 < r.mass_fraction < 1]
        usual = float(np.exp(np.mean(np.log(given)))) if given else float("nan")
    shared = [
        replace(one, recipe=replace(one.recipe, usual_fraction=usual)) if one.recipe.polymer == recipe.polymer else one
        for one in measured
    ]
    return replace(recipe, usual_fraction=usual), shared


def _orientation(found: Fibres, believed: Believed, z: FloatArray) -> FloatArray:
    """Hermans orientation of the strands in the solid fibre, to an order of magnitude.

    Strands follow the jet while their relaxation time ``theta = (mu/G) (phi/phi_0)^y`` is longer than the drying takes, and
    forget it while it is shorter; what is stretched after the fraction at which the two are equal stays. In a race that is
    ``(1 - (phi_0/phi)^p)^(-1/2)``, never more than the whole stretch. G is 2 MPa phi^2.3 (melts' plateau, diluted), y = 2.33;
    times in stretching are up to ten times those of shear, so theta has a spread of its own.
    """
    from spinline.network.lattice_walk import stretched_walk

    thin, p = found.thinning, CONSTANTS.viscosity_power
    slower = np.exp(believed.sd.get("relaxation_time", 0.0) * z[:, list(UNKNOWNS).index("relaxation_time")])
    theta = 3 * slower * found.viscosity / (TAKEN.plateau * believed.volume_fraction**TAKEN.plateau_power)
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


def shares_of(log_d: FloatArray, z: FloatArray) -> dict[str, float]:
    """First-order Sobol' shares of the variance of ln d, by unknown, from the draws themselves.

    The mean of ln d over all but one unknown is a series of Hermite polynomials of that one, to the third; what chance
    alone would give them (3 in the number of draws) is taken off.
    """
    y = log_d - log_d.mean()
    total, found = float(y @ y) / y.size, {}
    if total <= 0:
        return {}
    for i, name in enumerate(UNKNOWNS):
        x = z[:, i]
        series = (x, (x * x - 1) / 2**0.5, (x**3 - 3 * x) / 6**0.5)
        share = sum(float(y @ h / y.size) ** 2 for h in series) / total - 3 / y.size
        if share > 1e-3:
            found[name] = share
    return dict(sorted(found.items(), key=lambda item: -item[1]))


# breath figures: pores on fibres from volatile solvents in air of more than 30 % RH (Casper et al., Macromolecules 37, 573
# (2004))
_VOLATILE, _HUMID = 4e-10, 0.3  # k_ev in m2/s: tetrahydrofuran, chloroform, acetone and dichloromethane are above


def _with_rest(shares: dict[str, float], measured: bool) -> dict[str, float]:
    """What is left where fibres were measured is their own scatter, which `shares_of` does not see."""
    rest = 1.0 - sum(shares.values())
    return {**shares, "measured": rest} if measured and rest > 0 else shares


def _pores(recipe: Recipe, believed: Believed) -> tuple[str, ...]:
    humid = recipe.relative_humidity > _HUMID or recipe.relative_humidity != recipe.relative_humidity
    if believed.evaporation > _VOLATILE and humid and not watery(recipe):
        return ("pores on the fibres are likely: a volatile solvent, in air of more than 30 % relative humidity",)
    return ()
