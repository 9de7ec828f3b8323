"""netCDF files that this package writes: imported runs, and jets of its own solver."""

from pathlib import Path

from spinline.base.errors import InputError
from spinline.base.file_format import HDF5_HEAD
from spinline.base.netcdf import open_dataset
from spinline.jetprofile.lagrangian import LagrangianJet

__all__ = ["JetFile"]


class JetFile:
    """Reader of jet files."""

    name = "jet file (netCDF-4)"

    def claims(self, path: Path, head: bytes) -> bool:
        """By HDF5's signature."""
        return head.startswith(HDF5_HEAD)

    def read(self, path: Path, *, unit: str | None = None, initial_radius: float | None = None) -> LagrangianJet:
        """Its units are in it."""
        if unit is not None:
            raise InputError(
                "unit", f"is not asked for: a {self.name} carries its units", value=unit, remedy="leave it out"
            )
        if initial_radius is not None:
            raise InputError(
                "initial_radius",
                f"is not asked for: a {self.name} carries it",
                value=initial_radius,
                remedy="leave it out",
            )
        return LagrangianJet.from_dataset(open_dataset(path))
