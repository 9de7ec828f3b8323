"""What lies on the collector: landings, laid fibres, mats and their properties.

===================  ====================================================================================
module               what
===================  ====================================================================================
`collectors`         plate, belt, drum; the frame the fibres keep, Eqs. (46)-(47)
`touchdown`          touch-down located within a step
`landing`            what a jet hands over, and the fibres it becomes; `frames`: from stored frames
`segments`           fibres as segments; `fibres`: in a file, streamed
`footprint`          where one jet lays; `areal_density`: mass per area, exact
`surrogate`          kilometres of fibre from a fitted law; `trochoid`: its closed forms on a belt
`stack`              fibres on fibres: thickness, porosity (`passages`: what crosses a window)
`voxels`, `pores`    the mat as voxels; pores four ways; `poisson_lines`: random networks in closed form
`orientation`        order parameter, director, tensors; of images too
`diameters`          weights, lognormal law, comparison; `measured`: tables of image tools
`permeability`       laws with ranges, slip; `stokes`: computed on voxels
`mat`                all of it for a file of fibres (`whole`: sums over it, chunk by chunk)
`exports`            VTK, PLY, CSV, TIFF, raw
===================  ====================================================================================
"""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if __name__ != "spinline.deposit":
    raise ImportError("import spinline.deposit, not deposit")

if TYPE_CHECKING:
    from spinline.deposit.areal_density import DensityMap, density_map
    from spinline.deposit.collectors import Belt, Collector, Drum, Plate, collector
    from spinline.deposit.diameters import compare_diameters, lognormal
    from spinline.deposit.exports import write_csv, write_ply, write_raw, write_tiff, write_vtp
    from spinline.deposit.fibres import FibreFile, FibreWriter
    from spinline.deposit.footprint import Footprint, footprint_of
    from spinline.deposit.frames import BeadFrame, landings_from_frames, landings_from_table
    from spinline.deposit.landing import LandingRecord, laid_by, lay
    from spinline.deposit.mat import MatOptions, analyse_mat
    from spinline.deposit.measured import MeasuredDiameters, read_diameters
    from spinline.deposit.orientation import hermans, image_orientation, order_of
    from spinline.deposit.passages import Window
    from spinline.deposit.permeability import LAWS, permeability_of, pressure_drop, slip_permeability
    from spinline.deposit.poisson_lines import (
        ball_probability,
        mean_cell_area,
        open_share,
        sampson_mean_radius,
        vertex_density,
    )
    from spinline.deposit.pores import ball_fits, bubble_point, open_areas, pore_size
    from spinline.deposit.segments import Segments
    from spinline.deposit.stack import Stack, beam_slope, lay_stack
    from spinline.deposit.stokes import StokesResult, stokes_permeability
    from spinline.deposit.surrogate import Laydown, surrogate_fibre
    from spinline.deposit.touchdown import TouchDown, touch_down
    from spinline.deposit.trochoid import trochoid_length_rate, trochoid_order
    from spinline.deposit.voxels import stamp, voxelise

_NAMES = {
    "BeadFrame": "frames",
    "Belt": "collectors",
    "Collector": "collectors",
    "DensityMap": "areal_density",
    "Drum": "collectors",
    "FibreFile": "fibres",
    "FibreWriter": "fibres",
    "Footprint": "footprint",
    "LAWS": "permeability",
    "LandingRecord": "landing",
    "Laydown": "surrogate",
    "MatOptions": "mat",
    "MeasuredDiameters": "measured",
    "Plate": "collectors",
    "Segments": "segments",
    "Stack": "stack",
    "StokesResult": "stokes",
    "TouchDown": "touchdown",
    "Window": "passages",
    "analyse_mat": "mat",
    "ball_fits": "pores",
    "ball_probability": "poisson_lines",
    "beam_slope": "stack",
    "bubble_point": "pores",
    "collector": "collectors",
    "compare_diameters": "diameters",
    "density_map": "areal_density",
    "footprint_of": "footprint",
    "hermans": "orientation",
    "image_orientation": "orientation",
    "landings_from_frames": "frames",
    "landings_from_table": "frames",
    "laid_by": "landing",
    "lay": "landing",
    "lay_stack": "stack",
    "lognormal": "diameters",
    "mean_cell_area": "poisson_lines",
    "open_areas": "pores",
    "open_share": "poisson_lines",
    "order_of": "orientation",
    "permeability_of": "permeability",
    "pore_size": "pores",
    "pressure_drop": "permeability",
    "read_diameters": "measured",
    "sampson_mean_radius": "poisson_lines",
    "slip_permeability": "permeability",
    "stamp": "voxels",
    "stokes_permeability": "stokes",
    "surrogate_fibre": "surrogate",
    "touch_down": "touchdown",
    "trochoid_length_rate": "trochoid",
    "trochoid_order": "trochoid",
    "vertex_density": "poisson_lines",
    "voxelise": "voxels",
    "write_csv": "exports",
    "write_ply": "exports",
    "write_raw": "exports",
    "write_tiff": "exports",
    "write_vtp": "exports",
}

__all__ = [
    "LAWS",
    "BeadFrame",
    "Belt",
    "Collector",
    "DensityMap",
    "Drum",
    "FibreFile",
    "FibreWriter",
    "Footprint",
    "LandingRecord",
    "Laydown",
    "MatOptions",
    "MeasuredDiameters",
    "Plate",
    "Segments",
    "Stack",
    "StokesResult",
    "TouchDown",
    "Window",
    "analyse_mat",
    "ball_fits",
    "ball_probability",
    "beam_slope",
    "bubble_point",
    "collector",
    "compare_diameters",
    "density_map",
    "footprint_of",
    "hermans",
    "image_orientation",
    "laid_by",
    "landings_from_frames",
    "landings_from_table",
    "lay",
    "lay_stack",
    "lognormal",
    "mean_cell_area",
    "open_areas",
    "open_share",
    "order_of",
    "permeability_of",
    "pore_size",
    "pressure_drop",
    "read_diameters",
    "sampson_mean_radius",
    "slip_permeability",
    "stamp",
    "stokes_permeability",
    "surrogate_fibre",
    "touch_down",
    "trochoid_length_rate",
    "trochoid_order",
    "vertex_density",
    "voxelise",
    "write_csv",
    "write_ply",
    "write_raw",
    "write_tiff",
    "write_vtp",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
