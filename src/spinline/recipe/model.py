"""From a recipe and draws of what it does not say to fibres: the whole chain on arrays, one entry a draw.

    c/c_e, mu_s -> mu -> eta_E = Tr mu ;  V, H, Q, K -> I -> q = I/Q ;  solvent, air -> k_ev (with heat)
    q, gamma, eta_E, k_ev, phi_0, flight time -> thinning (`spinline.jetprofile.whipping`) -> d = 2 a phi_0^(1/2)

or, by rung, the terminal law, or the thread of its envelope (`spinline.jetprofile.envelope`) in place of the thinning.

Every unknown is a median times ``exp(sd z)`` with z normal, so that the chain is a function of the normal draws z and of the
recipe's medians; shares of variance and a measured fibre act on the z's. What the laws do not know is in it too: how a
laboratory differs from the next, how its fibres answer a setting beyond the laws, how one setting and one mat differ.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import lru_cache
from typing import Any

import numpy as np

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.jetprofile.envelope import Envelope, envelope, onset_radius
from spinline.jetprofile.whipping import Thinning, terminal_radius, thinning
from spinline.recipe.constants import CONSTANTS, TAKEN, Calibrated

__all__ = [
    "OF_MATERIALS",
    "RESPONSES",
    "SCATTERED",
    "UNKNOWNS",
    "Believed",
    "Fibres",
    "normals",
    "scatter",
    "sensitivities",
    "spun",
]

#: What is uncertain of a recipe, by its name, in words.
UNKNOWNS = {
    "entanglement_concentration": "concentration of entanglement (molar mass, solvent quality)",
    "viscosity": "viscosity at that concentration",
    "extensional_viscosity": "extensional over shear viscosity",
    "conductivity": "conductivity",
    "current": "current at that conductivity",
    "evaporation": "rate of drying",
    "surface_tension": "surface tension",
    "flight_time": "time of flight",
    "onset_radius": "radius where bending sets in",
    "relaxation_time": "relaxation time of the strands",
    "concentration_response": "how a laboratory's fibres follow the concentration beyond the laws",
    "voltage_response": "how they follow the voltage beyond the laws",
    "flow_response": "how they follow the flow rate beyond the laws",
    "gap_response": "how they follow the gap beyond the laws",
    "laboratory": "what differs between laboratories and is in no recipe",
    "unevenness": "how much a laboratory's fibres scatter",
    "setting": "what the laws miss at one setting",
    "repeat": "what differs between two mats of one setting",
}
#: Ways in which a laboratory's fibres follow its settings.
RESPONSES = ("concentration_response", "voltage_response", "flow_response", "gap_response")
#: Unknowns that two recipes share where the polymer is the same, as far as the solvents are.
OF_MATERIALS = (
    "entanglement_concentration",
    "viscosity",
    "extensional_viscosity",
    "conductivity",
    "evaporation",
    "surface_tension",
    "relaxation_time",
)
#: What no other setting, and no other mat, tells of.
SCATTERED = ("setting", "repeat")
_EXPONENTS = 12.0  # of e, beyond which a draw is no jet


@dataclass(frozen=True)
class Believed:
    """What is believed of one recipe: medians in SI and standard deviations of their logarithms (0 where given).

    Of several at once (`Believed.of`) each number is an array (recipe, 1).

    Attributes
    ----------
    coil : float
        c/c_e, concentration over that of entanglement.
    solvent_viscosity, surface_tension, conductivity, evaporation, flight_time, onset_radius : float
        SI; `evaporation` is k_ev, m2/s: until all solvents are gone.
    voltage, flow_rate, gap, needle_radius : float
        V, m3/s, m, m.
    volume_fraction, solid_fraction : float
        Polymer at the needle, and where it is solid.
    density : float
        Of the solution, kg/m3.
    shares, ratios : tuple of float
        Of the solvents: by volume, and rates of drying over `evaporation`. Of several recipes arrays (recipe, 1, solvent).
    viscosity, current : float
        Pa s, A; NaN where they follow from the laws.
    sd : mapping
        Standard deviation of each unknown's logarithm.
    away : mapping
        Logarithm of a setting over the usual one (of its laboratory for the concentration), by the names of `RESPONSES`.
    """

    coil: float
    solvent_viscosity: float
    surface_tension: float
    conductivity: float
    evaporation: float
    flight_time: float
    onset_radius: float
    voltage: float
    flow_rate: float
    gap: float
    needle_radius: float
    volume_fraction: float
    solid_fraction: float = TAKEN.solid_fraction
    density: float = 1000.0
    shares: Any = (1.0,)
    ratios: Any = (1.0,)
    viscosity: float = float("nan")
    current: float = float("nan")
    sd: Mapping[str, Any] = field(default_factory=dict)
    away: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, many: Sequence["Believed"]) -> "Believed":
        """Several as one."""

        def column(values: Any) -> Any:
            return np.array([list(values)]).T

        apart = ("sd", "away", "shares", "ratios")
        plain = {f.name: column(getattr(one, f.name) for one in many) for f in fields(cls) if f.name not in apart}
        most = max(len(one.shares) for one in many)

        def padded(values: Any, with_: float) -> Any:
            return np.array([[(*v, *(with_,) * (most - len(v)))] for v in values])

        return cls(
            **plain,
            shares=padded((one.shares for one in many), 0.0),
            ratios=padded((one.ratios for one in many), 1.0),
            sd={name: column(one.sd.get(name, 0.0) for one in many) for name in UNKNOWNS},
            away={name: column(one.away.get(name, 0.0) for one in many) for name in RESPONSES},
        )


@dataclass(frozen=True, eq=False)
class Fibres:
    """What the draws became, arrays (draw,), or (recipe, draw) of several recipes.

    Attributes
    ----------
    log_diameter : ndarray
        ln of the fibre's dry diameter in m, laboratory, setting and repeat included.
    thinning : Thinning or Envelope
    charge_density, viscosity, current, coil, terminal, terminal_radius : ndarray
        q (C/m3), mu (Pa s), I (A), c/c_e, the fibre's diameter by the terminal law alone (m), and the undried radius of that.
    """

    log_diameter: FloatArray
    thinning: "Thinning | Envelope"
    charge_density: FloatArray
    viscosity: FloatArray
    current: FloatArray
    coil: FloatArray
    terminal: FloatArray
    terminal_radius: FloatArray


def spun(
    believed: Believed,
    normal: FloatArray,
    *,
    rung: str = "race",
    steps: int = 32,
    constants: Calibrated = CONSTANTS,
) -> Fibres:
    """Fibres of a recipe, or of several.

    Parameters
    ----------
    believed : Believed
    normal : ndarray, (draw, unknown)
        Standard normal, columns in the order of `UNKNOWNS`.
    rung : {"race", "terminal", "envelope"}
        The whole thinning, the balance of charge and surface tension alone, or the thread of the envelope.
    steps : int
        Of the march of the thinning.
    constants : Calibrated

    Returns
    -------
    Fibres
    """
    drawn = real("normal", normal)
    if drawn.ndim != 2 or drawn.shape[1] != len(UNKNOWNS):
        raise InputError(
            "normal", "must be draws (n, unknown)", value=f"shape {drawn.shape}", allowed=f"(n, {len(UNKNOWNS)})"
        )
    z = dict(zip(UNKNOWNS, drawn.T, strict=True))

    def factor(name: str) -> FloatArray:
        value: FloatArray = np.exp(np.clip(believed.sd.get(name, 0.0) * z[name], -_EXPONENTS, _EXPONENTS))
        return value

    coil = believed.coil / factor("entanglement_concentration")
    law = believed.solvent_viscosity * (1 + TAKEN.viscosity_at_entanglement * coil**constants.viscosity_power)
    viscosity = np.where(np.isnan(believed.viscosity), law, believed.viscosity) * factor("viscosity")
    level = constants.current_level * (
        (_field(believed.voltage, believed.gap, believed.needle_radius) / _USUAL_FIELD) ** TAKEN.current_voltage
        * (believed.flow_rate / _USUAL_FLOW) ** TAKEN.current_flow
        * (believed.conductivity * factor("conductivity") / 1e-3) ** constants.current_conductivity
    )
    current = np.where(np.isnan(believed.current), level, believed.current) * factor("current")
    q = current / believed.flow_rate
    gamma = believed.surface_tension * factor("surface_tension")
    terminal = terminal_radius(q, gamma, TAKEN.chi)
    eta = constants.trouton * viscosity * factor("extensional_viscosity")
    drying = believed.evaporation * factor("evaporation")
    if rung == "envelope":
        found: Thinning | Envelope = _enveloped(
            believed, factor, current, gamma, eta, drying, constants.viscosity_power
        )
    else:
        found = thinning(
            q,
            gamma,
            eta,
            drying,
            believed.volume_fraction,
            believed.flight_time * factor("flight_time"),
            believed.onset_radius * factor("onset_radius"),
            power=constants.viscosity_power,
            solid_fraction=believed.solid_fraction,
            chi=TAKEN.chi,
            steps=steps,
            mixture=(believed.shares, believed.ratios),
        )
    dry = 2 * np.sqrt(believed.volume_fraction)
    log_d = np.log(dry * (terminal if rung == "terminal" else found.radius))
    for name in RESPONSES:
        log_d = log_d + believed.sd.get(name, 0.0) * believed.away.get(name, 0.0) * z[name]
    log_d = log_d + believed.sd.get("laboratory", 0.0) * z["laboratory"]
    log_d = log_d + scatter(believed, drawn)
    return Fibres(log_d, found, q, viscosity, current, coil, dry * terminal, terminal)


@lru_cache(maxsize=16)
def normals(draws: int, seed: int = 1) -> FloatArray:
    """Standard normal draws (draw, unknown), evenly spread in each unknown (a Latin hypercube)."""
    from scipy.special import ndtri

    rng = np.random.default_rng(seed)
    ranks = rng.permuted(np.tile(np.arange(draws), (len(UNKNOWNS), 1)), axis=1).T
    value: FloatArray = ndtri((ranks + rng.random(ranks.shape)) / draws)
    return value


def scatter(believed: Believed, normal: FloatArray) -> FloatArray:
    """What settings and mats add to ln d by themselves, (draw,), or (recipe, draw): more of it in an uneven laboratory."""
    z = dict(zip(UNKNOWNS, normal.T, strict=True))
    uneven = np.exp(np.clip(believed.sd.get("unevenness", 0.0) * z["unevenness"], -_EXPONENTS, _EXPONENTS))
    found: FloatArray = uneven * sum(believed.sd.get(name, 0.0) * z[name] for name in SCATTERED)
    return found


def sensitivities(
    believed: Believed,
    *,
    about: FloatArray | None = None,
    step: float = 1.0,
    rung: str = "race",
    steps: int = 32,
    constants: Calibrated = CONSTANTS,
) -> FloatArray:
    """Change of ln d with each unknown, for one standard deviation.

    Parameters
    ----------
    believed : Believed
        Of several recipes.
    about : ndarray, (draw, unknown), optional
        Draws about which it is taken; their mean is given. Else the medians.
    step : float
        Standard deviations up and down over which the change is taken.
    rung, steps, constants
        As of `spun`.

    Returns
    -------
    ndarray, (unknown, recipe)
        In the order of `UNKNOWNS`.
    """
    middle = np.zeros((1, len(UNKNOWNS))) if about is None else about
    up = step * np.eye(len(UNKNOWNS))[:, np.newaxis]
    normal = np.concatenate([middle + up, middle - up]).reshape(-1, len(UNKNOWNS))
    log_d = spun(believed, normal, rung=rung, steps=steps, constants=constants).log_diameter
    high, low = log_d.reshape(-1, 2, len(UNKNOWNS), len(middle)).mean(axis=3).transpose(1, 2, 0)
    change: FloatArray = (high - low) / (2 * step)
    return change


def _enveloped(
    believed: Believed, factor: Any, current: Any, gamma: Any, eta: Any, drying: Any, power: float
) -> Envelope:
    """The thread of the envelope, from where the current is carried by the surface; never thicker than the needle."""
    conductivity = believed.conductivity * factor("conductivity")
    rides = onset_radius(current, conductivity, believed.flow_rate, believed.voltage, believed.gap)
    begin = np.minimum(rides * factor("onset_radius"), believed.needle_radius)
    return envelope(
        current / believed.flow_rate,
        gamma,
        eta,
        drying,
        believed.volume_fraction,
        believed.flow_rate,
        believed.gap,
        begin,
        believed.voltage / believed.gap,
        density=believed.density,
        power=power,
        solid_fraction=believed.solid_fraction,
        chi=TAKEN.chi,
        fraction=0.2,
        mixture=(believed.shares, believed.ratios),
    )


def _field(voltage: Any, gap: Any, radius: Any) -> Any:
    """Voltage as the tip of a needle sees it."""
    return voltage / np.log1p(4 * gap / radius)


_USUAL_FLOW = 1e-6 / 3600
_USUAL_FIELD = _field(15e3, 0.15, 0.2e-3)
