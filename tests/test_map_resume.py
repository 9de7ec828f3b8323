"""A map that is killed goes on where it was: a SIGKILL, another process, the same result to the last bit."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from spinline.base.files import write_text
from spinline.images import load_images
from spinline.radiography.reduce import reduce_images

KILLED = """
import os, signal, sys
from spinline.base.checkpoint import Checkpoint
save, seen = Checkpoint.save, []
def killed(store, name, **arrays):
    save(store, name, **arrays)
    seen.append(name)
    if seen.count("map") == int(sys.argv[2]): os.kill(os.getpid(), signal.SIGKILL)
Checkpoint.save = killed
from spinline.images import load_images
from spinline.radiography.reduce import reduce_images
reduce_images(load_images(sys.argv[1]), checkpoint=sys.argv[1] + ".partial")
"""


def killed_after(file, turns) -> None:
    ran = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", KILLED, file.name, str(turns)],
        cwd=file.parent,
        env=os.environ,
        check=False,
    )
    assert ran.returncode == -signal.SIGKILL
    assert list((file.parent / f"{file.name}.partial").glob("map*"))


@pytest.mark.slow
def test_a_map_goes_on_after_sigkill(frames_of, tmp_path, quiet, monkeypatch) -> None:
    frames_of(photons=4e5, count=2, rows=40)
    text = 'counts = "a.npz"\nflat = "a.npz"\ndark = "a.npz"\ngain = 1\npixel_size = "0.67 um"\nenergy = "10 keV"\nblock_rows = 1\n'
    text += 'method = "map"\n[solution]\npolymer = "PEO"\nsolvent = "water"\nmass_fraction = 0.05\n'
    file = tmp_path / "m.toml"
    write_text(file, text)
    whole = reduce_images(load_images(file))
    killed_after(file, 3)
    from spinline.xray.map.scoring import MapModel

    looks, look = [], MapModel.look
    monkeypatch.setattr(MapModel, "look", lambda self, *at: looks.append(1) or look(self, *at))
    resumed = reduce_images(load_images(file), checkpoint=tmp_path / "m.toml.partial")
    after = len(looks)
    looks.clear()
    assert reduce_images(load_images(file)).identical(whole)
    assert resumed.identical(whole)
    assert not (tmp_path / "m.toml.partial").exists()
    assert after < len(looks)  # the turns before the kill are not taken again


@pytest.mark.slow
def test_a_stitched_map_goes_on_after_sigkill(tmp_path, quiet) -> None:
    from position_generator import positions

    data = positions(tmp_path, count=2, rows=24, pixels=220, overlap=8, seed=5, keys={"method": "map", "block_rows": 4})
    places, solution = data.pop("positions"), data.pop("solution")
    text = "".join(f"{key} = {value!r}\n".replace("'", '"') for key, value in data.items())
    for place in places:
        text += "[[positions]]\n" + "".join(f'{key} = "{value}"\n' for key, value in place.items())
    text += f"[solution]\nvolume_fraction = {solution['volume_fraction']}\n"
    for kind in ("polymer", "solvent"):
        text += f"[solution.{kind}]\n" + "".join(f'{key} = "{value}"\n' for key, value in solution[kind].items())
    file = tmp_path / "p.toml"
    write_text(file, text)
    whole = reduce_images(load_images(file))
    killed_after(file, 2)
    resumed = reduce_images(load_images(file), checkpoint=tmp_path / "p.toml.partial")
    assert resumed.identical(whole)
    assert np.isfinite(resumed["mean_polymer_fraction"].values).all()
