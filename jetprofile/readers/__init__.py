"""Jets of other programs: one reader a file format, all with the same two methods.

=====================  ============================================================
module                 reads
=====================  ============================================================
`jetspin_run`          a JETSPIN run directory, a file of it, or a zip of it
`jet_file`             netCDF of ``spinline import-jet`` and ``spinline spin``
`vtk_legacy`           polylines in VTK's legacy format, text or binary
`vtp`                  polylines in VTK's XML format
`lammps`               LAMMPS dumps (text)
`table`                CSV tables and workbooks, one row a bead
=====================  ============================================================

`read_beads` asks them in turn. A reader of one's own is any object with the methods of `BeadReader`; `register_reader` puts
it before the others.
"""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.jetprofile.readers.choose import BeadReader, holds_beads, read_beads, readers, register_reader

_NAMES = dict.fromkeys(("BeadReader", "holds_beads", "read_beads", "readers", "register_reader"), "choose")

__all__ = ["BeadReader", "holds_beads", "read_beads", "readers", "register_reader"]

__getattr__, __dir__ = lazily(__name__, _NAMES)
