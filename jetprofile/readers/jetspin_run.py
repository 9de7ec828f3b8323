"""JETSPIN runs: a folder, a file of it, or the folder zipped."""

import stat
import tempfile
import zipfile
from pathlib import Path, PurePosixPath

from spinline.base.errors import InputError
from spinline.base.files import write_bytes
from spinline.jetprofile.jetspin import read_jetspin
from spinline.jetprofile.lagrangian import LagrangianJet

__all__ = ["JetspinRun"]

_LARGEST = 20 * 2**30  # bytes that a zip may unpack to
_MOST = 100_000  # files
_FILES = ("traj.dat", "traj.xyz", "save.dat", "input.dat", "log.txt", "statout.dat", "statdat.dat", "bead.dat")


class JetspinRun:
    """Reader of JETSPIN runs."""

    name = "JETSPIN run"

    def claims(self, path: Path, head: bytes) -> bool:
        """Folders, zips, and files named as JETSPIN names them."""
        return path.is_dir() or path.suffix.lower() == ".zip" or _ours(path.name)

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
        if path.is_file() and zipfile.is_zipfile(path):
            with tempfile.TemporaryDirectory(prefix="spinline-") as folder:
                return LagrangianJet.from_dataset(read_jetspin(_unpacked(path, Path(folder)), source=source, unit=unit))
        return LagrangianJet.from_dataset(read_jetspin(path, source=source, unit=unit))


def _ours(name: str) -> bool:
    return name in _FILES or (name.startswith("frame") and name.endswith((".xyz", ".pdb"))) or name.endswith(".xyz")


def _unpacked(path: Path, folder: Path) -> Path:
    """The run's files out of a zip, flat: the folder inside it that holds them."""
    try:
        with zipfile.ZipFile(path) as archive:
            entries = [
                entry
                for entry in archive.infolist()
                if not entry.is_dir() and _ours(PurePosixPath(entry.filename).name)
            ]
            if not entries:
                raise InputError(
                    str(path),
                    "is a zip that holds no file of a JETSPIN run",
                    allowed=", ".join(_FILES),
                    remedy="zip the folder that JETSPIN ran in",
                )
            if len(entries) > _MOST or sum(entry.file_size for entry in entries) > _LARGEST:
                raise InputError(str(path), "unpacks to more than 20 GiB or 100,000 files", remedy="unpack it yourself")
            homes = {PurePosixPath(entry.filename).parent for entry in entries}
            if len(homes) > 1:
                raise InputError(
                    str(path), "holds several runs", value=sorted(map(str, homes))[:5], remedy="zip one run"
                )
            for entry in entries:
                if stat.S_ISLNK(entry.external_attr >> 16):
                    raise InputError(str(path), "holds a symbolic link", value=entry.filename, remedy="zip the files")
                write_bytes(folder / PurePosixPath(entry.filename).name, archive.read(entry))
    except (InputError, MemoryError):
        raise
    except Exception as error:
        # zipfile's own, and those of what unpacks for it: BadZipFile, NotImplementedError for a compression it does not know,
        # RuntimeError for a password, zlib.error and others for bytes that are damaged
        raise InputError(str(path), f"is a zip that cannot be read ({error})", remedy="zip the run again") from None
    return folder
