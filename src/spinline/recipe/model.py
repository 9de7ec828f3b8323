"""From a recipe and draws of what it does not say to fibres: the whole chain on arrays, one entry a draw.

    c/c_e, mu_s -> mu -> eta_E = Tr mu ;  V, Q, K -> I -> q = I/Q ;  solvent, air -> k_ev (with heat)
    q, gamma, eta_E, k_ev, phi_0, flight time -> thinning (`spinline.jetprofile.whipping`) -> d = 2 a phi_0^(1/2)

Every unknown is a median times ``exp(sd z)`` with z normal, so that the chain is a function of the normal draws z and of the
recipe's medians; shares of variance and a measured fibre act on the z's.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from spinline.base.checks import FloatArray
from spinline.jetprofile.whipping import Thinning, terminal_radius, thinning
from spinline.recipe.constants import GLOBAL

__all__ = ["UNKNOWNS", "Believed", "Fibres", "spun"]

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
    "laboratory": "what differs between laboratories and is in no recipe",
    "repeat": "what differs between two mats of one laboratory",
}
_EXPONENTS = 12.0  # of e, beyond which a draw is no jet


@dataclass(frozen=True)
class Believed:
    """What is believed of one recipe: medians in SI and standard deviations of their logarithms (0 where given).

    Attributes
    ----------
    coil : float
        c/c_e, concentration over that of entanglement.
    solvent_viscosity, surface_tension, conductivity, evaporation, flight_time, onset_radius : float
        SI; `evaporation` is k_ev, m2/s.
    voltage, flow_rate : float
        V, m3/s.
    volume_fraction, solid_fraction : float
        Polymer at the needle, and where it is solid.
    viscosity, current : float
        Pa s, A; NaN where they follow from the laws.
    sd : mapping
        Standard deviation of each unknown's logarithm.
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
    volume_fraction: float
    solid_fraction: float = GLOBAL["solid_fraction"]
    viscosity: float = float("nan")
    current: float = float("nan")
    sd: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Fibres:
    """What the draws became, arrays (draw,).

    Attributes
    ----------
    log_diameter : ndarray
        ln of the fibre's dry diameter in m, laboratory and repeat included.
    thinning : Thinning
    charge_density, viscosity, current, coil, terminal, terminal_radius : ndarray
        q (C/m3), mu (Pa s), I (A), c/c_e, the fibre's diameter by the terminal law alone (m), and the undried radius of that.
    """

    log_diameter: FloatArray
    thinning: Thinning
    charge_density: FloatArray
    viscosity: FloatArray
    current: FloatArray
    coil: FloatArray
    terminal: FloatArray
    terminal_radius: FloatArray


def spun(believed: Believed, normal: FloatArray, *, rung: str = "race", steps: int = 32) -> Fibres:
    """Fibres of a recipe.

    Parameters
    ----------
    believed : Believed
    normal : ndarray, (draw, unknown)
        Standard normal, columns in the order of `UNKNOWNS`.
    rung : {"race", "terminal"}
        The whole thinning, or the balance of charge and surface tension alone.
    steps : int
        Of the march.

    Returns
    -------
    Fibres
    """
    z = dict(zip(UNKNOWNS, np.asarray(normal, dtype=np.float64).T, strict=True))

    def factor(name: str) -> FloatArray:
        value: FloatArray = np.exp(np.clip(believed.sd.get(name, 0.0) * z[name], -_EXPONENTS, _EXPONENTS))
        return value

    g = GLOBAL
    coil = believed.coil / factor("entanglement_concentration")
    law = believed.solvent_viscosity * (1 + g["viscosity_at_entanglement"] * coil ** g["viscosity_power"])
    viscosity = (law if np.isnan(believed.viscosity) else np.full_like(law, believed.viscosity)) * factor("viscosity")
    conductivity = believed.conductivity * factor("conductivity")
    level = (
        g["current_level"]
        * (believed.voltage / 15e3) ** g["current_voltage"]
        * (believed.flow_rate / (1e-6 / 3600)) ** g["current_flow"]
        * (conductivity / 1e-3) ** g["current_conductivity"]
    )
    current = (level if np.isnan(believed.current) else np.full_like(level, believed.current)) * factor("current")
    q = current / believed.flow_rate
    gamma = believed.surface_tension * factor("surface_tension")
    terminal = terminal_radius(q, gamma, g["chi"])
    found = thinning(
        q,
        gamma,
        g["trouton"] * viscosity * factor("extensional_viscosity"),
        believed.evaporation * factor("evaporation"),
        believed.volume_fraction,
        believed.flight_time * factor("flight_time"),
        believed.onset_radius * factor("onset_radius"),
        power=g["viscosity_power"],
        solid_fraction=believed.solid_fraction,
        chi=g["chi"],
        steps=steps,
    )
    dry = 2 * np.sqrt(believed.volume_fraction)
    undried = terminal if rung == "terminal" else found.radius
    log_d = np.log(dry * undried)
    for name in ("laboratory", "repeat"):
        log_d = log_d + believed.sd.get(name, 0.0) * z[name]
    return Fibres(log_d, found, q, viscosity, current, coil, dry * terminal, terminal)
