"""How the jet moves: analytic profiles, tables, fits, and imported Lagrangian jets.

=================  ============================================================================
name               what it is, and when to take it
=================  ============================================================================
`PowerLaw`         Eq. (31): the asymptote far from the nozzle; what published jets are fitted with
`Hyperbolic`       Fig. 35: smooth from the nozzle on; exponent 1 far away
`Table`            measured or computed samples; monotone, bounded strain rate
`LagrangianJet`    beads of any simulator, bent or not
`bead_flow_rate`   flow rate of a bead jet from its own motion; `element_age` with it
`read_jetspin`     the output of a JETSPIN run
`spun`             jets of our own, bead by bead, flow rate and current given
`fit_power_law`    k and beta of a measured profile, and where a power law holds
`estimate_k`       k of a viscous jet from the process conditions, for beta = 1
`ehd`              the electrified jet from a needle's voltage, gap, conductivity (`StraightEhdJet`)
=================  ============================================================================
"""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if __name__ != "spinline.jetprofile":
    raise ImportError("import spinline.jetprofile, not jetprofile")

if TYPE_CHECKING:
    from spinline.jetprofile import ehd, spun
    from spinline.jetprofile.bead_age import bead_flow_rate, element_age
    from spinline.jetprofile.ehd import NeedleSettings, NoSteadyJet, StraightEhdJet
    from spinline.jetprofile.fit import PowerLawFit, fit_power_law
    from spinline.jetprofile.hyperbolic import Hyperbolic
    from spinline.jetprofile.jet import Jet
    from spinline.jetprofile.jetspin import iter_jetspin, read_jetspin, write_jet
    from spinline.jetprofile.k_estimate import estimate_k
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.jetprofile.power_law import PowerLaw
    from spinline.jetprofile.straight import StraightJet
    from spinline.jetprofile.table import Table

# name: module; loaded when first asked for, since the readers are heavier than the laws
_NAMES = {
    "Hyperbolic": "hyperbolic",
    "Jet": "jet",
    "LagrangianJet": "lagrangian",
    "PowerLaw": "power_law",
    "PowerLawFit": "fit",
    "StraightJet": "straight",
    "Table": "table",
    "bead_flow_rate": "bead_age",
    "element_age": "bead_age",
    "NeedleSettings": "ehd",
    "NoSteadyJet": "ehd",
    "StraightEhdJet": "ehd",
    "ehd": "ehd",
    "estimate_k": "k_estimate",
    "fit_power_law": "fit",
    "iter_jetspin": "jetspin",
    "read_jetspin": "jetspin",
    "spun": "spun:",
    "write_jet": "jetspin",
}

__all__ = [
    "Hyperbolic",
    "Jet",
    "LagrangianJet",
    "NeedleSettings",
    "NoSteadyJet",
    "PowerLaw",
    "PowerLawFit",
    "StraightEhdJet",
    "StraightJet",
    "Table",
    "bead_flow_rate",
    "ehd",
    "element_age",
    "estimate_k",
    "fit_power_law",
    "iter_jetspin",
    "read_jetspin",
    "spun",
    "write_jet",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
