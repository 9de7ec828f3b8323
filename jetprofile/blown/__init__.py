"""Jets drawn by fast air: the air, its forces, the straight part, and the bending one.

====================  =========================================================================
`gas_nozzle`          the gas: isentropic nozzle, choking
`air`                 round turbulent jet, wind, a table; `gusts`: one random field for all beads
`drag`                forces along and across a thin jet
`straight`            straight part as a two-point problem: newton, ucm, oldroyd-b, with verdicts
`bending_onset`       where bending is well posed (c_b^2), growth where it is not
`bead_jet`            beads from there to the collector
`vapour_loss`         drying along a given straight jet, Eq. (43a)
====================  =========================================================================
"""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.jetprofile.blown.air import AirJet, AirTable, Wind
    from spinline.jetprofile.blown.bead_jet import BeadRun, BeadStart, BlownBeads, blown_beads
    from spinline.jetprofile.blown.bending_onset import bending_growth, fastest_bend, mesh_growth, wave_speed_squared
    from spinline.jetprofile.blown.drag import normal_coefficient, normal_drag, tangential_coefficient, tangential_drag
    from spinline.jetprofile.blown.gas_nozzle import NozzleExit, nozzle_exit
    from spinline.jetprofile.blown.gusts import gust_field
    from spinline.jetprofile.blown.straight import BlownSolution, StraightBlownJet, straight_blown_jet
    from spinline.jetprofile.blown.vapour_loss import remaining_volume

_NAMES = {
    "AirJet": "air",
    "AirTable": "air",
    "BeadRun": "bead_jet",
    "BeadStart": "bead_jet",
    "BlownBeads": "bead_jet",
    "BlownSolution": "straight",
    "NozzleExit": "gas_nozzle",
    "StraightBlownJet": "straight",
    "Wind": "air",
    "bending_growth": "bending_onset",
    "blown_beads": "bead_jet",
    "fastest_bend": "bending_onset",
    "nozzle_exit": "gas_nozzle",
    "gust_field": "gusts",
    "mesh_growth": "bending_onset",
    "normal_coefficient": "drag",
    "normal_drag": "drag",
    "remaining_volume": "vapour_loss",
    "straight_blown_jet": "straight",
    "tangential_coefficient": "drag",
    "tangential_drag": "drag",
    "wave_speed_squared": "bending_onset",
}

__all__ = [
    "AirJet",
    "AirTable",
    "BeadRun",
    "BeadStart",
    "BlownBeads",
    "BlownSolution",
    "NozzleExit",
    "StraightBlownJet",
    "Wind",
    "bending_growth",
    "blown_beads",
    "fastest_bend",
    "gust_field",
    "mesh_growth",
    "normal_coefficient",
    "normal_drag",
    "nozzle_exit",
    "remaining_volume",
    "straight_blown_jet",
    "tangential_coefficient",
    "tangential_drag",
    "wave_speed_squared",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
