"""Runs that are zipped, as they come by mail: unpacked for as long as they are read."""

import stat
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath

from spinline.base.errors import InputError
from spinline.base.files import write_bytes

__all__ = ["of_a_run", "run_folder"]

_LARGEST = 20 * 2**30  # bytes that a zip may unpack to
_MOST = 100_000  # files
_FILES = ("traj.dat", "traj.xyz", "save.dat", "input.dat", "log.txt", "statout.dat", "statdat.dat", "bead.dat")


@contextmanager
def run_folder(path: Path) -> Iterator[Path]:
    """The folder of a zipped run, unpacked until the block ends; any other path as it is.

    Raises
    ------
    InputError
        For a zip that is damaged, holds no run, or several.
    """
    if not path.is_file() or path.suffix.lower() != ".zip":
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="spinline-") as folder:
        yield _unpacked(path, Path(folder))


def of_a_run(name: str) -> bool:
    """Whether a file has a name that JETSPIN gives."""
    return name in _FILES or (name.startswith("frame") and name.endswith((".xyz", ".pdb"))) or name.endswith(".xyz")


def _of_macos(name: str) -> bool:
    """Whether an entry holds only what macOS keeps beside a file of the same name."""
    path = PurePosixPath(name)
    return path.name.startswith("._") or "__MACOSX" in path.parts


def _unpacked(path: Path, folder: Path) -> Path:
    """The run's files out of a zip, flat: the folder inside it that holds them."""
    try:
        with zipfile.ZipFile(path) as archive:
            entries = [
                entry
                for entry in archive.infolist()
                if not entry.is_dir() and of_a_run(PurePosixPath(entry.filename).name) and not _of_macos(entry.filename)
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
