"""The straight electrified jet from a needle's settings: closed forms, asymptotes, and the boundary-value problem.

========================  ==============================================================================================
name                      what it is, and when to take it
========================  ==============================================================================================
`StraightEhdJet`          the jet of a needle's settings: viscous or viscoelastic, current predicted or given; 0.1 to 1 s
`NeedleSettings`          what it needs; `NoSteadyJet` names why there is none, `Verdict` a number that decides
`ElasticJet`              ``V = V1 + s / De``: polymer solutions, in microseconds, once the pull is known
`ViscousJet`              ``V = (1 + k s)^2``: a Newtonian thread in a uniform field
`InertialJet`             the far end
`HyperboloidField` ...    fields of needle and plate (`fields`)
`taylor_half_angle` ...   cones (`cones`), `threshold_voltage`
`bending_onset` ...       where the straight part ends (`bending`), capillary waves (`capillary`)
`effective_charge` ...    the leaky-dielectric bead model of Carroll and Joo (`leaky_beads`)
========================  ==============================================================================================
"""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.jetprofile.ehd.asymptotes import ElasticJet, InertialJet, ViscousJet
    from spinline.jetprofile.ehd.bending import BendingOnset, bending_onset, earnshaw_growth, fastest_bending
    from spinline.jetprofile.ehd.capillary import axisymmetric_growth, fastest_capillary
    from spinline.jetprofile.ehd.cones import (
        cone_permittivity,
        dielectric_cone,
        hyperboloid_half_angle,
        taylor_half_angle,
    )
    from spinline.jetprofile.ehd.current import cone_jet_current, viscous_current
    from spinline.jetprofile.ehd.fields import HyperboloidField, NeedleField, TableField, UniformField
    from spinline.jetprofile.ehd.leaky_beads import LeakyBeads, effective_charge
    from spinline.jetprofile.ehd.settings import NeedleSettings
    from spinline.jetprofile.ehd.straight_jet import NoSteadyJet, StraightEhdJet
    from spinline.jetprofile.ehd.thresholds import critical_hyperboloid_voltage, threshold_voltage
    from spinline.jetprofile.ehd.verdicts import Verdict

_NAMES = {
    "BendingOnset": "bending",
    "ElasticJet": "asymptotes",
    "HyperboloidField": "fields",
    "InertialJet": "asymptotes",
    "LeakyBeads": "leaky_beads",
    "NeedleField": "fields",
    "NeedleSettings": "settings",
    "NoSteadyJet": "straight_jet",
    "StraightEhdJet": "straight_jet",
    "TableField": "fields",
    "UniformField": "fields",
    "Verdict": "verdicts",
    "ViscousJet": "asymptotes",
    "axisymmetric_growth": "capillary",
    "bending_onset": "bending",
    "cone_jet_current": "current",
    "cone_permittivity": "cones",
    "critical_hyperboloid_voltage": "thresholds",
    "dielectric_cone": "cones",
    "earnshaw_growth": "bending",
    "effective_charge": "leaky_beads",
    "fastest_bending": "bending",
    "fastest_capillary": "capillary",
    "hyperboloid_half_angle": "cones",
    "taylor_half_angle": "cones",
    "threshold_voltage": "thresholds",
    "viscous_current": "current",
}

__all__ = [
    "BendingOnset",
    "ElasticJet",
    "HyperboloidField",
    "InertialJet",
    "LeakyBeads",
    "NeedleField",
    "NeedleSettings",
    "NoSteadyJet",
    "StraightEhdJet",
    "TableField",
    "UniformField",
    "Verdict",
    "ViscousJet",
    "axisymmetric_growth",
    "bending_onset",
    "cone_jet_current",
    "cone_permittivity",
    "critical_hyperboloid_voltage",
    "dielectric_cone",
    "earnshaw_growth",
    "effective_charge",
    "fastest_bending",
    "fastest_capillary",
    "hyperboloid_half_angle",
    "taylor_half_angle",
    "threshold_voltage",
    "viscous_current",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
