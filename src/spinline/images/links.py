"""Where the links of an HDF5 file of frames lead, looked at before the library follows them.

Eiger masters and virtual datasets are made of other files, so these are read, where they are regular files in the folder of the
file or below it. Elsewhere they are refused: a file of frames is not to make the program read what its user did not name, nor
wait at a pipe for ever.
"""

import os
from pathlib import Path
from typing import Any

from spinline.base.errors import InputError

__all__ = ["linked_file", "stays_home"]

_DEPTH = 12  # of links behind links


def linked_file(path: Path, name: str, here: str, key: str) -> None:
    """Refuse a file that a file of frames refers to, where it is there but not beside or below, or is no regular file.

    Raises
    ------
    InputError
    """
    home = Path(os.path.abspath(path)).parent
    target = Path(os.path.abspath(home / name))
    if not target.exists():
        return  # said where it is missed
    words = {
        "value": f"{path.name}:{here} -> {name}",
        "remedy": f"copy {target.name} beside {path.name}, or name it itself",
    }
    if not target.is_relative_to(home):
        raise InputError(key, "refers to a file outside its folder", allowed="files beside it or below", **words)
    if not target.is_file():
        raise InputError(key, "refers to what is no regular file", **words)


def stays_home(group: Any, inside: str, key: str, depth: int = 0) -> None:
    """Refuse a path of a group on whose way a link leads out of the folder; follows no external link itself.

    Raises
    ------
    InputError
        As `linked_file`.
    """
    import h5py

    for part in filter(None, inside.split("/")):
        if not isinstance(group, h5py.Group) or depth > _DEPTH:
            return
        try:
            kind: Any = group.id.links.get_info(part.encode()).type
            target: Any = None
            if kind != h5py.h5l.TYPE_HARD:
                target = group.id.links.get_val(part.encode())
        except (KeyError, OSError, RuntimeError):
            return
        if kind == h5py.h5l.TYPE_SOFT:
            path = os.fsdecode(target)
            stays_home(group.file if path.startswith("/") else group, path, key, depth + 1)
        elif kind == h5py.h5l.TYPE_EXTERNAL:
            name, path = (os.fsdecode(word) for word in target)
            master = Path(group.file.filename)
            linked_file(master, name, f"{group.name.rstrip('/')}/{part}", key)
            if (master.parent / name).is_file():
                with h5py.File(master.parent / name, "r") as other:
                    stays_home(other, path, key, depth + 1)
        try:
            group = group[part]
        except (KeyError, OSError, RuntimeError):
            return
