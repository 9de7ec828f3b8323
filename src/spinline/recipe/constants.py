"""Every number of the fibre's chain that is not of one recipe, in one place: taken from theory, or calibrated.

Calibrated are those of `Calibrated`, by the procedure of `benchmarks/spindb_calibrate.py` (which writes them, and redoes it for
every paper that is left out): the largest posterior density of the published fibres under the chain, with the priors listed
there. `Taken` are not fitted, but they were not chosen blindly either: concentration at which people spin, Sherwood
number, speed of flight and solid fraction were first picked with these papers in view, and the chain's form was settled
after some 50 variants had been scored on them (medians 1.54 to 1.73, each with papers left out).
"""

from dataclasses import dataclass, field

__all__ = ["CONSTANTS", "TAKEN", "Calibrated", "Taken"]


@dataclass(frozen=True)
class Taken:
    """From theory, handbooks and habit.

    Attributes
    ----------
    current_voltage, current_flow : float
        Exponents of the current of a viscous jet, `spinline.jetprofile.ehd.current.viscous_current`; as voltage counts
        ``V/ln(1 + 4 H/r)``, the field near a needle. They suit the fibres; measured currents and straight jets from a needle
        have V to about 1 and Q to 0.4. That law's viscosity to the 1/6 is left out: measured currents do not follow the
        viscosity, and straight jets at published settings have it to -0.03 to -0.17 (`benchmarks/current_exponents.py`).
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
        A at 15 kV over 15 cm, 1 mL/h, 1 mS/m.
    viscosity_power : float
        Of the viscosity in the concentration.
    current_conductivity : float
        Exponent of the current in the conductivity.
    sd : mapping
        Standard deviations of ln d that no recipe explains, by the names of `spinline.recipe.model.UNKNOWNS`.
    """

    trouton: float = 144.6  # posterior sd 1 of its logarithm
    current_level: float = 6.656e-07  # posterior sd 0.35 of its logarithm
    viscosity_power: float = 4.984  # posterior sd 0.56
    current_conductivity: float = 0.2995  # posterior sd 0.075
    sd: dict[str, float] = field(
        default_factory=lambda: {
            "laboratory": 0.1774,
            "setting": 0.09083,
            "repeat": 0.2572,
            "concentration_response": 0.865,
            "voltage_response": 0.2864,
            "flow_response": 0.1246,
            "gap_response": 0.1206,
            "unevenness": 0.7001,
        }
    )


TAKEN = Taken()
CONSTANTS = Calibrated()
