"""Lagrangian jets of our own: chains of material elements whose flow rate and current are given, so that they converge.

===============  =================================================================================
module           what it is
===============  =================================================================================
`dumbbell`       Eqs. (13)-(16): two beads; Earnshaw's rate, Eq. (10)
`steady`         rung 0: the steady straight jet, through its wave speed
`settings`       what a spun jet is given
`laws`           constitutive laws of an element
`chain`          rungs 1 to 3: the chain and its march
`run`            frames, impulses of the air, what a checkpoint holds
`several`        jets side by side that repel one another
`noise`          the air's impulses, the same on every grid
`dataset`        the result
===============  =================================================================================
"""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.jetprofile.spun.chain import Chain, start_cylinder
    from spinline.jetprofile.spun.dataset import landings, to_dataset
    from spinline.jetprofile.spun.dumbbell import TwoBeadJet, earnshaw_rate, two_bead
    from spinline.jetprofile.spun.laws import JetLaw
    from spinline.jetprofile.spun.run import SpunRun
    from spinline.jetprofile.spun.settings import Air, Collector, Drying, Grid, Inlet, Loads, SpunSettings
    from spinline.jetprofile.spun.several import SpunJets, pattern, shifted
    from spinline.jetprofile.spun.steady import SteadyJet, steady_jet

_NAMES = {
    "Air": "settings",
    "Chain": "chain",
    "Collector": "settings",
    "Drying": "settings",
    "Grid": "settings",
    "Inlet": "settings",
    "JetLaw": "laws",
    "Loads": "settings",
    "SpunJets": "several",
    "SpunRun": "run",
    "SpunSettings": "settings",
    "SteadyJet": "steady",
    "TwoBeadJet": "dumbbell",
    "earnshaw_rate": "dumbbell",
    "landings": "dataset",
    "pattern": "several",
    "shifted": "several",
    "start_cylinder": "chain",
    "steady_jet": "steady",
    "to_dataset": "dataset",
    "two_bead": "dumbbell",
}

__all__ = [
    "Air",
    "Chain",
    "Collector",
    "Drying",
    "Grid",
    "Inlet",
    "JetLaw",
    "Loads",
    "SpunJets",
    "SpunRun",
    "SpunSettings",
    "SteadyJet",
    "TwoBeadJet",
    "earnshaw_rate",
    "landings",
    "pattern",
    "shifted",
    "start_cylinder",
    "steady_jet",
    "to_dataset",
    "two_bead",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
