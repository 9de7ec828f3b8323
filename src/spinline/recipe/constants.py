"""Every number of the fibre's chain that is not of one recipe, in one place: taken from theory, or calibrated.

Calibrated are those of `Calibrated`, by the procedure of `benchmarks/spindb_calibrate.py` (which writes them, and redoes it for
every paper that is left out): the largest posterior density of the published fibres under the chain, with the priors listed
there. `Taken` are not fitted, but they were not chosen blindly either: concentration at which people spin, Sherwood
number, speed of flight and solid fraction were first picked with these papers in view, and the chain's form was settled
after some 45 variants had been scored on them (medians 1.54 to 1.71, each with papers left out).
"""

from dataclasses import dataclass, field

__all__ = ["CONSTANTS", "TAKEN", "Calibrated", "Taken"]


@dataclass(frozen=True)
class Taken:
    """From theory, handbooks and habit.

    Attributes
    ----------
    current_voltage, current_flow, current_viscosity : float
        Exponents of the current of a viscous jet, `spinline.jetprofile.ehd.current.viscous_current`; as voltage counts
        ``V/ln(1 + 4 H/r)``, the field near a needle.
    spun_at, spun_at_sd : float
        Concentration over that of entanglement at which people spin, and the sd of its logarithm: 2.6 is the mean over 39
        pairs of paper and solution, whose sd, molar masses unknown, is 0.4, and 0.3 within those of one polymer.
    viscosity_at_entanglement : float
        Specific viscosity there.
    flight_speed : float
        m/s at which the bending jet approaches the collector.
    sherwood : float
        Of the bending jet, on its diameter.
    solid_fraction : float
        Polymer where the jet no longer gives way.
    chi : float
        Wavelength of the bending over the radius (Fridrikh et al. 2003).
    plateau, plateau_power : float
        Modulus of a melt's network, Pa, and its exponent in the volume fraction: relaxation times, and the chain of beads.
    """

    current_voltage: float = 2 / 3
    current_flow: float = 2 / 3
    current_viscosity: float = 1 / 6
    spun_at: float = 2.6
    spun_at_sd: float = 0.4
    viscosity_at_entanglement: float = 20.0
    flight_speed: float = 1.0
    sherwood: float = 0.5
    solid_fraction: float = 0.7
    chi: float = 100.0
    plateau: float = 2e6
    plateau_power: float = 2.3


@dataclass(frozen=True)
class Calibrated:
    """Calibrated on published fibres.

    Attributes
    ----------
    trouton : float
        Extensional over shear viscosity while the jet bends.
    current_level : float
        A at 15 kV over 15 cm, 1 mL/h, 1 mS/m, 1 Pa s.
    viscosity_power : float
        Of the viscosity in the concentration.
    current_conductivity : float
        Exponent of the current in the conductivity.
    concentration_beyond : float
        d ln d/d ln concentration within one laboratory that the laws leave out.
    sd : mapping
        Standard deviations of ln d that no recipe explains, by the names of `spinline.recipe.model.UNKNOWNS`.
    """

    trouton: float = 157.5  # posterior sd 1 of its logarithm
    current_level: float = 6.884e-07  # posterior sd 0.38 of its logarithm
    viscosity_power: float = 5.053  # posterior sd 0.64
    current_conductivity: float = 0.2721  # posterior sd 0.07
    concentration_beyond: float = 0.5195  # posterior sd 0.27
    sd: dict[str, float] = field(
        default_factory=lambda: {
            "laboratory": 0.2207,
            "setting": 0.09211,
            "repeat": 0.258,
            "concentration_response": 0.8244,
            "voltage_response": 0.2781,
            "flow_response": 0.1235,
            "gap_response": 0.1205,
            "unevenness": 0.6975,
        }
    )


TAKEN = Taken()
CONSTANTS = Calibrated()
