"""The format of the files that are written, by number: a file of a newer one is refused, not guessed at.

The number rises when a name, a unit or a dimension changes its meaning, not when some are added.
"""

from typing import Any

import numpy as np

from spinline.base.errors import InputError

__all__ = ["FORMAT", "FORMAT_NAME", "HDF5_HEAD", "require_format"]

FORMAT = 1
FORMAT_NAME = "spinline_format"
HDF5_HEAD = b"\x89HDF\r\n\x1a\n"  # the first bytes of a file, netCDF-4 too


def require_format(name: str, found: Any) -> None:
    """Refuse a file of a newer format than this version knows.

    Parameters
    ----------
    name : str
        Of the file, shown in the error.
    found : object
        Its number; None of a file that has none (of others, or of version 0.1's first days).

    Raises
    ------
    InputError
    """
    said = np.ravel(FORMAT if found is None else found)  # HDF5 may hold a number as an array of one
    if said.size != 1 or said.dtype.kind not in "iu" or not 1 <= said[0] <= FORMAT:
        shown = said[0] if said.size == 1 else found
        raise InputError(
            name,
            f"was written in format {shown}, which this version of spinline does not know",
            allowed=f"format 1 to {FORMAT}",
            remedy="read it with the version that wrote it, or install a newer one",
        )
