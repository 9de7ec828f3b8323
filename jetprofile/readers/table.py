"""CSV tables and workbooks of beads, one row a bead."""

from pathlib import Path

from spinline.base.errors import InputError
from spinline.jetprofile.lagrangian import LagrangianJet

__all__ = ["BeadTable"]


class BeadTable:
    """Reader of tables."""

    name = "table (CSV, text, Excel)"

    def claims(self, path: Path, head: bytes) -> bool:
        """By the file's ending; text of any name."""
        return (
            path.suffix.lower() in (".csv", ".txt", ".dat", ".tsv", ".xlsx", ".xlsm", ".xls", ".ods")
            or b"\0" not in head
        )

    def read(self, path: Path, *, unit: str | None = None, initial_radius: float | None = None) -> LagrangianJet:
        """Units are in the header."""
        if unit is not None:
            raise InputError(
                "unit", "is not asked for: a table has its units in the header", value=unit, remedy="leave it out"
            )
        return LagrangianJet.from_csv(path, initial_radius=initial_radius)
