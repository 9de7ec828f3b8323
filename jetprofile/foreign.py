"""Formats that are read nowhere here, known by how they begin, so that a refusal can name them and say what to do."""

import re

from spinline.base.errors import InputError

__all__ = ["foreign_text"]

_HEAD = 4096  # characters that tell it
_CSV = "save the jet as a CSV table with units in its header"
_BEADS = 'a scene takes it as beads: [jet] profile = "lagrangian", path, unit'
_XYZ = r"\A\s*\d+\s*\n(?!\s*frame at time).*\n\s*[A-Z][a-z]?\d*(\s+[-+.\deE]+){3}"
_KINDS: tuple[tuple[str, str, str], ...] = (
    (r"\A\s*# vtk DataFile|<VTKFile", "a VTK file, and no table", _BEADS),
    (r"\A\s*ITEM:", "a LAMMPS dump, and no table", _BEADS),
    (r"\ALAMMPS\b", "a LAMMPS data file", "write a dump: dump custom ... id x y z radius"),
    (r"^creator:\s*LAMMPS", "a LAMMPS dump in YAML", "dump it as text: dump custom ... id x y z radius"),
    (r"\bFoamFile\b", "an OpenFOAM file", f"sample the line with setFormat csv, then {_CSV}"),
    (
        r"\A\s*(TITLE|VARIABLES)\s*=",
        "a Tecplot file",
        "put one header, z [mm] radius [um], for its TITLE, VARIABLES and ZONE",
    ),
    (
        r"^# Curve \d+ of \d+, \d+ points",
        "what `set table` of gnuplot writes, with a letter behind each point",
        "take that column out (`plot ... with table` writes none), and put a line z [mm]  radius [um] above the numbers",
    ),
    (r"\A\s*IGOR\s*$", "an Igor text file", _CSV),
    (r"\A\s*solid\b[\s\S]*^\s*facet\b", "an STL surface", "give the axis of the jet with its radii, as a CSV table"),
    (r"\A(?-i:ATOM  |HETATM|CRYST1)", "a PDB file, which carries no radius", _CSV),
    (_XYZ, "an XYZ file of another program than JETSPIN", _CSV),
    (r"\A\s*<(!doctype html|html|table)", "a page in HTML", "open it in a spreadsheet and save it as CSV"),
    (r"\A\s*<\?xml\b", "an XML file", _CSV),
    (r"\A\s*[{\[]\s*[\"{\[\d}\]]", "JSON", _CSV),
    (r"\A\s*\|.*\|\s*$\n\s*\|[-:| ]+\|", "a table in Markdown", _CSV),
    (r"\A\s*\\begin\{", "LaTeX", _CSV),
    (r"\A\s*[\w.]+\s*=\s*\[.*;\s*$", "a MATLAB script", "save the table by writetable, with units in the names"),
)


def foreign_text(text: str, name: str) -> None:
    """Refuse a text whose beginning is that of a format that is read nowhere here.

    Parameters
    ----------
    text : str
        Some thousand characters from the beginning.
    name : str
        Of the file, for the error.

    Raises
    ------
    InputError
        It names the format.
    """
    head = text[:_HEAD].lstrip("\ufeff")
    for pattern, what, remedy in _KINDS:
        if re.search(pattern, head, re.IGNORECASE | re.MULTILINE):
            raise InputError(name, f"is {what}", remedy=remedy)
