"""What a file of a JETSPIN run is: by its content, by its name where the content is damaged."""

import re
from pathlib import Path

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin.content import Content, head_of
from spinline.jetprofile.jetspin.fortran import record_sizes

__all__ = ["file_kind", "kind_of"]

_HEAD = 1 << 16  # bytes that tell it
_NAMES = (
    (re.compile(r"(traj.*|frame\d+)\.xyz", re.I), "xyz"),
    (re.compile(r"(traj|save|restart).*\.dat", re.I), "beads"),
    (re.compile(r"statdat.*\.dat", re.I), "statdat"),
    (re.compile(r"statout.*\.dat", re.I), "statout"),
    (re.compile(r"bead.*\.dat", re.I), "landed"),
    (re.compile(r"(log.*\.txt|.*\.log)", re.I), "setup"),
    (re.compile(r"input.*\.dat", re.I), "setup"),
)
_DIRECTIVES = re.compile(
    rb"^\s*(system|integrator|timestep|final time|points|initial length|nozzle cross|viscosity|elastic mod"
    rb"|collector dist|external potential|print (xyz|time|list)|printstat)\b",
    re.M | re.I,
)


def file_kind(path: Path) -> str:
    """Kind of a file: "xyz", "beads", "statdat", "landed", "statout" or "setup".

    Raises
    ------
    InputError
        If it cannot be opened, is empty, is none of them, or is a PDB or PSF file.
    """
    return kind_of(path, head_of(path, _HEAD))


def kind_of(path: Path, content: Content) -> str:
    """`file_kind` of a file that has been opened."""
    head = bytes(content[:_HEAD])
    if not head:
        raise InputError(
            str(path),
            "is empty (0 bytes)",
            remedy="JETSPIN writes late; read another file of the run, e.g. traj.xyz",
        )
    kind = _by_content(head)
    if kind is None:
        kind = next((kind for pattern, kind in _NAMES if pattern.fullmatch(path.name)), None)
    if kind in ("pdb", "psf") or (kind is None and path.suffix.lower() in (".pdb", ".psf")):
        raise InputError(
            str(path),
            "a PDB or PSF file: it holds no time, and no radius can be had from its 0.01 cm",
            remedy="read the frame*.xyz, traj.xyz, traj.dat or save.dat of the run",
        )
    if kind is None:
        raise InputError(
            str(path),
            "not a file of a JETSPIN run",
            remedy="give traj.xyz, frame*.xyz, traj.dat, save.dat, statout.dat, statdat.dat, bead.dat, "
            "log.txt, input.dat or the directory of the run; a table, a jet file or beads of another program need no "
            'import, a scene names them: [jet] profile = "table" or "lagrangian", path',
        )
    return kind


def _by_content(head: bytes) -> str | None:
    sizes = record_sizes(head, 3)
    if sizes[:1] == [188]:
        return "statdat"
    if sizes[:2] == [4, 52]:
        return "landed"
    if sizes[:2] == [4, 24]:
        return "beads"
    if re.match(rb"[ 0-9]{1,12}\r?\nframe at time", head):
        return "xyz"
    if head.startswith(b"#*****"):
        return "statout"
    if head.startswith(b"ATOM ") or head.startswith(b"HEADER") or head.startswith(b"REMARK"):
        return "pdb"
    if re.match(rb"\s{0,3}PSF", head):
        return "psf"
    if b"frame at time" in head and b"\nC     " in head:
        return "xyz"
    if any(mark in head for mark in (b"Start printing input file", b"Internal units:", b"JETSPIN:")):
        return "setup"
    if b"\0" not in head and len(_DIRECTIVES.findall(head)) >= 2:
        return "setup"
    return None
