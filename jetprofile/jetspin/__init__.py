"""JETSPIN runs as datasets: bead positions, radii, stretch ratios and stresses along the jet, in SI.

`read_jetspin` reads a file or a run directory; `iter_jetspin` does so in pieces of bounded size, and
`write_jet` streams them into one netCDF file. `read_statistics` reads the tables JETSPIN prints beside the
beads, and `read_parameters` what the run was set up with. One file per concern: `xyz` (text frames),
`fortran` and `binary` (unformatted frames), `stats`, `header`, `scale` (which length unit a text file is
in), `dataset` (beads to variables), `run` (which file of a run is read).
"""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.jetprofile.jetspin.header import read_parameters
    from spinline.jetprofile.jetspin.netcdf import write_jet
    from spinline.jetprofile.jetspin.parameters import RunParameters
    from spinline.jetprofile.jetspin.run import iter_jetspin, read_jetspin
    from spinline.jetprofile.jetspin.stats import read_statistics

_NAMES = {
    "RunParameters": "parameters",
    "iter_jetspin": "run",
    "read_jetspin": "run",
    "read_parameters": "header",
    "read_statistics": "stats",
    "write_jet": "netcdf",
}

__all__ = ["RunParameters", "iter_jetspin", "read_jetspin", "read_parameters", "read_statistics", "write_jet"]

__getattr__, __dir__ = lazily(__name__, _NAMES)
