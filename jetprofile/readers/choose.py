"""Which reader a file of beads is for."""

from pathlib import Path
from typing import Protocol

from spinline.base.errors import InputError
from spinline.base.files import readable
from spinline.base.text import known_binary
from spinline.base.workbook import WORKBOOKS
from spinline.jetprofile.foreign import foreign_text
from spinline.jetprofile.lagrangian import LagrangianJet
from spinline.jetprofile.readers.jet_file import JetFile
from spinline.jetprofile.readers.jetspin_run import JetspinRun
from spinline.jetprofile.readers.lammps import LammpsDump
from spinline.jetprofile.readers.table import BeadTable
from spinline.jetprofile.readers.vtk_legacy import VtkLegacy
from spinline.jetprofile.readers.vtp import VtkXml

__all__ = ["BeadReader", "holds_beads", "read_beads", "readers", "register_reader"]

_HEAD = 4096  # bytes that a reader may look at


class BeadReader(Protocol):
    """What reads one format.

    Attributes
    ----------
    name : str
        The format in words, for messages.
    """

    name: str

    def claims(self, path: Path, head: bytes) -> bool:
        """Whether a file looks like this format: by its first bytes (none for a folder), its name where those cannot tell."""

    def read(self, path: Path, *, unit: str | None = None, initial_radius: float | None = None) -> LagrangianJet:
        """The jet, in SI; `unit` of length where the file has none, `initial_radius` r_0 in m where it does not say."""


_READERS: list[BeadReader] = [JetspinRun(), JetFile(), VtkLegacy(), VtkXml(), LammpsDump(), BeadTable()]


def readers() -> tuple[BeadReader, ...]:
    """The readers, in the order in which they are asked."""
    return tuple(_READERS)


def register_reader(reader: BeadReader) -> None:
    """Put a reader before the others, for the rest of the session; one of the same name is replaced."""
    _READERS[:] = [reader, *(other for other in _READERS if other.name != reader.name)]


def read_beads(
    path: str | Path, *, unit: str | None = None, initial_radius: float | None = None, reader: BeadReader | None = None
) -> LagrangianJet:
    """Jet from a file or folder of any known format.

    Parameters
    ----------
    path : path
        File, or folder of a JETSPIN run.
    unit : str, optional
        Length unit of the numbers ("cm"), for formats that carry none; never guessed.
    initial_radius : float, optional
        r_0, m: radius where the stretch is 1. Default: what the file says, else the radius of its first element.
    reader : BeadReader, optional
        Take this one, whatever the file looks like.

    Returns
    -------
    LagrangianJet

    Raises
    ------
    InputError
        If no reader knows the file, or the one that does finds it damaged; the format is named.
    """
    file = Path(path)
    if not file.exists():
        raise InputError(str(path), "does not exist", remedy="give a file, or the folder of a JETSPIN run")
    head = b""
    if not file.is_dir():
        with readable(file).open("rb") as stream:
            head = stream.read(_HEAD)
        if not head:
            raise InputError(str(path), "is empty", remedy="give a file that holds beads")
    chosen = reader or next((one for one in _READERS if one.claims(file, head)), None)
    if chosen is None or isinstance(chosen, BeadTable):
        _named(file, head)
    if chosen is None:
        remedy = "save the beads as a CSV table, one row a bead: x [cm], y [cm], z [cm], radius [cm]"
        known = ", ".join(one.name for one in _READERS)
        raise InputError(str(path), "is in no format that is known here", allowed=known, remedy=remedy)
    return chosen.read(file, unit=unit, initial_radius=initial_radius)


def holds_beads(path: Path) -> bool:
    """Whether a file holds beads in space in one of the formats, so no table of z and radius."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        head = file.read(_HEAD)
    return any(reader.claims(path, head) for reader in _READERS if not reader.name.startswith("table"))


def _named(file: Path, head: bytes) -> None:
    """Refuse a format that is known, and read nowhere here, by its name."""
    if file.suffix.lower() in WORKBOOKS:
        return  # zip archives, or refused there by name
    what = known_binary(head) or ("a MATLAB file (.mat)" if file.suffix.lower() == ".mat" else "")
    if what:
        packed = "compressed" in what
        remedy = "unpack it first" if packed else "save the beads as a CSV table: x [cm], y [cm], z [cm], radius [cm]"
        raise InputError(str(file), f"is {what}, which is not read here", remedy=remedy)
    foreign_text(head.decode("latin-1"), str(file))
