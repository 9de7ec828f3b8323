"""What the tests of damaged JETSPIN runs share: copies to damage, editing, reading with every warning kept."""

import shutil
import warnings
from importlib.resources import files
from pathlib import Path

from spinline.base.errors import SpinlineWarning
from spinline.jetprofile import read_jetspin

DATA = Path(__file__).parent / "data" / "jetspin"
BUNDLED = Path(str(files("spinline"))) / "data" / "scenes" / "pvp3d"
L0 = 0.03487728022e-2


def copied_run(folder):
    """An own copy of the PVP run, to be damaged."""
    shutil.copytree(DATA / "pvp3d", folder)
    for path in BUNDLED.iterdir():
        shutil.copy(path, folder)
    return folder


def read(*args, **options):
    """Dataset and warnings of a reading."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        data = read_jetspin(*args, **options)
    assert all(issubclass(item.category, SpinlineWarning) for item in caught)
    messages = [str(item.message) for item in caught]
    for text in data.attrs["warnings"].splitlines():
        assert any(text in message for message in messages)
    return data, messages


def edit(path, old, new, count=1):
    content = path.read_bytes()
    assert old in content
    path.write_bytes(content.replace(old, new, count))


def row(x, y, z):
    return f"C       {x:10.5f}{y:10.5f}{z:10.5f}\n".encode()


def xyz(frames, maxnumber=None):
    """An XYZ text of (time, rows), padded if `maxnumber` is given."""
    out = b""
    for number, (time, rows) in enumerate(frames, 1):
        count = maxnumber or len(rows)
        padding = [(0.0, 0.0, 0.0)] * (count - len(rows))
        out += f"{count:10d}\nframe at time{time:20.10E}{number:10d}\n".encode()
        out += b"".join(row(*beads) for beads in [*rows[:count], *padding])
    return out
