"""JETSPIN runs: a folder, a file of it, or the folder zipped."""

import re
from pathlib import Path

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin import read_jetspin
from spinline.jetprofile.jetspin.zipped import of_a_run, run_folder
from spinline.jetprofile.lagrangian import LagrangianJet

__all__ = ["JetspinRun"]

_STRANGE = re.compile(rb"\s*\d+\s*\r?\n(?!\s*frame at time)")  # XYZ that JETSPIN did not write


class JetspinRun:
    """Reader of JETSPIN runs."""

    name = "JETSPIN run"

    def claims(self, path: Path, head: bytes) -> bool:
        """Folders, zips, and files named as JETSPIN names them."""
        if path.suffix.lower() == ".xyz" and not path.name.startswith(("traj", "frame")) and _STRANGE.match(head):
            return False
        return path.is_dir() or path.suffix.lower() == ".zip" or of_a_run(path.name)

    def read(
        self, path: Path, *, unit: str | None = None, initial_radius: float | None = None, source: str | None = None
    ) -> LagrangianJet:
        """`source` names the file of the run to read."""
        if initial_radius is not None:
            raise InputError(
                "initial_radius",
                f"is not asked for: a {self.name} carries it",
                value=initial_radius,
                remedy="leave it out",
            )
        with run_folder(path) as run:
            return LagrangianJet.from_dataset(read_jetspin(run, source=source, unit=unit))
