"""A sample of the attack (``benchmarks/attack.py`` is the whole): damage, odd places, hostile text, two processes at once."""

import json
import os
import re
import stat
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
from file_damage import GOOD, attack, same
from file_victims import NAMES, make_victims

from spinline.base import files
from spinline.base.checkpoint import Checkpoint
from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.netcdf import open_dataset
from spinline.base.seals import sealed, unsealed, verified
from spinline.base.units import parse
from spinline.base.words import clean
from spinline.scene.file import load_scene, scene_from_dict
from spinline.solve.spine import solved

ROOT = Path(__file__).parent.parent
DATA = Path(__file__).parent / "data"


@pytest.fixture(scope="module")
def victims(tmp_path_factory):
    return {victim.name: victim for victim in make_victims(tmp_path_factory.mktemp("victims"), DATA)}


@pytest.mark.parametrize("name", NAMES)
def test_damage_is_refused_redone_or_harmless(victims, name, tmp_path) -> None:
    victim = victims[name]
    verdicts, bad = attack(victim, tmp_path, range(12))
    assert set(verdicts) <= GOOD, bad
    if victim.ours:
        assert "read" not in verdicts


def test_every_bit_of_a_small_sealed_file_counts() -> None:
    whole = sealed(b"12 bytes, so")
    assert unsealed(whole) == b"12 bytes, so"
    for i in range(8 * len(whole)):
        flipped = bytearray(whole)
        flipped[i // 8] ^= 1 << (i % 8)
        assert unsealed(bytes(flipped)) is None


def test_one_place_opens_files_for_writing() -> None:
    """Nothing but `spinline.base` writes; the store's chunks, by zarr, are the exception that is made."""
    writes = re.compile(
        "|".join(
            (
                r"\.write_text\(",
                r"\.write_bytes\(",
                r"open\([^)]*[\"'](?:[wax]b?\+?|r\+b?|rb\+)[\"']",
                r"savefig\((?!buffer)",
                r"to_netcdf\(",
                r"\.to_zarr\(",
                r"(?:table|frame|\))\.to_csv\((?!None)",
                r"np\.save(?:z|txt|z_compressed)?\((?!file|stream|$)",
                r"imwrite\((?!buffer|made|file|$)",
                r"shutil\.(?:copy|move|rmtree)",
                r"os\.(?:replace|rename|remove|unlink)\(",
                r"\.(?:rename|touch|unlink|mkdir)\(",
            )
        )
    )
    allowed = {
        "src/spinline/radiography/reduce.py": "setup.write_bytes(pickle.dumps(",  # for its own processes, in a private folder
        "src/spinline/setup/collector.py": 'name.removeprefix("landing_")',  # variables, not files
        "src/spinline/study/store.py": "left.unlink(missing_ok=True)",  # what a killed process left inside a store
    }
    for folder in ("src/spinline", "jetprofile", "rheology", "network", "xray", "deposit"):
        for path in (ROOT / folder).rglob("*.py"):
            name = path.relative_to(ROOT).as_posix()
            if "/base/" in name:
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                found = writes.search(line) and not (name in allowed and allowed[name] in line)
                assert not found, f"{name}:{number} {line.strip()}"


def test_an_input_is_never_written_over(spinline, tmp_path) -> None:
    spinline("scenes", "--copy", "peo5-water")
    before = Path("peo5-water.toml").read_bytes()
    os.symlink("peo5-water.toml", "link.nc")
    os.link("peo5-water.toml", "hard.nc")
    for out in ("peo5-water.toml", "link.nc", "hard.nc", "./peo5-water.toml"):
        ran = spinline("run", "peo5-water.toml", "--no-figure", "-o", out, "--force")
        assert ran.code == 2
        assert "input" in ran.err
    assert Path("peo5-water.toml").read_bytes() == before
    ran = spinline("run", "peo5-water.toml", "--csv", "peo5-water.toml", "-o", "a.nc", "--no-figure", "--force")
    assert (ran.code, Path("a.nc").exists()) == (2, False)


def test_links_stay_and_devices_pipes_and_folders_are_refused(spinline, tmp_path) -> None:
    (tmp_path / "there").mkdir()
    os.symlink("there/real.nc", "link.nc")
    assert spinline("run", "peo5-water", "--no-figure", "-o", "link.nc").code == 0
    assert os.path.islink("link.nc")
    assert open_dataset("there/real.nc").sizes["z"] > 100
    mode = stat.S_IMODE(os.stat("there/real.nc").st_mode)
    os.chmod("there/real.nc", 0o640)
    assert spinline("run", "peo5-water", "--no-figure", "-o", "link.nc", "--force").code == 0
    assert (stat.S_IMODE(os.stat("there/real.nc").st_mode), mode & 0o600) == (0o640, 0o600)
    os.mkfifo("pipe")
    for out in ("pipe", "/dev/null", "/dev/full", "there", "no/such.nc"):
        ran = spinline("run", "peo5-water", "--no-figure", "-o", out, "--force")
        assert (ran.code, ran.err.count("\n")) == (2, 1)
    assert stat.S_ISFIFO(os.stat("pipe").st_mode)
    for words in (
        ["run", "pipe"],
        ["compare", "pipe", "pipe"],
        ["fit-jet", "pipe"],
        ["run", "/dev/zero"],
        ["sweep", "pipe"],
    ):
        assert spinline(*words).code == 2


def test_a_new_file_is_made_by_one_process_only(tmp_path) -> None:
    target = tmp_path / "out"

    def late() -> None:
        with files.streaming(target) as sink:
            sink.write(b"mine")
            target.write_text("of another")

    with pytest.raises(InputError, match="another process"):
        late()
    assert target.read_text() == "of another"
    assert os.listdir(tmp_path) == ["out"]


def test_a_store_keeps_the_files_of_others(spinline, tmp_path) -> None:
    assert spinline("sweep", "peo-crossover", "--workers", "1", "--json").code == 0
    mine = tmp_path / "peo-crossover.zarr" / "notes.txt"
    mine.write_text("mine")
    ran = spinline("sweep", "peo-crossover", "--workers", "1", "--force")
    assert (ran.code, mine.read_text()) == (2, "mine")
    assert "notes.txt" in ran.err


@pytest.mark.slow
def test_a_damaged_chunk_is_computed_again(tmp_path) -> None:
    from spinline.study.sweep import open_sweep, run_sweep, sweep_from_dict

    tables = {
        "scene": "peo5-water",
        "chunk": 30,
        "design": {"kind": "latin-hypercube", "samples": 90},
        "vary": {"jet.k": {"uniform": [0.5, 2.0]}},
    }
    sweep = sweep_from_dict(tables, ["network.model=affine"])
    whole = run_sweep(sweep, tmp_path / "s.zarr", workers=1).load()
    for damage in ("flip", "cut", "gone"):
        chunk = tmp_path / "s.zarr" / "crossover_position" / "c" / "1"
        data = bytearray(chunk.read_bytes())
        if damage == "gone":
            chunk.unlink()
        else:
            data[len(data) // 2] ^= 4
            chunk.write_bytes(bytes(data) if damage == "flip" else bytes(data[:-5]))
        with pytest.raises(InputError, match="damaged in chunks 1"):
            open_sweep(tmp_path / "s.zarr")
        with pytest.warns(SpinlineWarning, match="damaged in 1 of 3"):
            assert run_sweep(sweep, tmp_path / "s.zarr", workers=1).load().identical(whole)


def test_a_folder_has_one_writer(tmp_path) -> None:
    store = Checkpoint(tmp_path / "p", "job")
    code = (
        "from pathlib import Path\nfrom spinline.base.checkpoint import Checkpoint\n"
        f"Checkpoint(Path({str(tmp_path / 'p')!r}), 'job')"
    )
    other = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "another process" in other.stderr
    store.clear()
    assert not (tmp_path / "p").exists()


def test_checkpoints_that_are_damaged_are_made_again(tmp_path) -> None:
    for what in ("mark", "piece", "empty mark", "piece of a piece"):
        store = Checkpoint(tmp_path / "p", "job")
        store.save("sum", total=np.arange(5.0))
        file = tmp_path / "p" / ("spinline-job" if "mark" in what else "sum.npz")
        data = file.read_bytes()
        file.write_bytes(
            b"" if what == "empty mark" else data[: len(data) // 2] if " of " in what else data[:-1] + b"x"
        )
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            again = Checkpoint(tmp_path / "p", "job")
            assert again.load("sum") is None
        assert "mark" not in what or "damaged" in str(said[0].message)
        again.clear()


# --- a disk that takes no more, homes that cannot be written ---------------------------------------------------------


HOSTILE = [
    "$x_{",
    "a\x1b[2Jb",
    "\x00",
    "\u202egnp",
    "\n" * 50,
    "<script>alert(1)</script>",
    "\\frac{",
    "%n%s",
    "🧵" * 300,
    "\x9b31m",
]


@pytest.mark.parametrize("number", range(len(HOSTILE)))
def test_hostile_titles_are_drawn_as_text(number, spinline, tmp_path) -> None:
    text = HOSTILE[number]
    scene = load_scene("peo5-water")._text
    scene = re.sub(r"title = .*", lambda _: "title = " + json.dumps(text, ensure_ascii=False), scene, count=1)
    Path("s.toml").write_text(scene, encoding="utf-8")
    ran = spinline("run", "s.toml", "--report", "r.html")
    assert ran.code == 0, ran.err
    assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f]", ran.out + ran.err)
    assert "<script>alert" not in Path("r.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "text",
    [
        "1 m**9**9**9**9",
        "5 m**0",
        "1 " + "m " * 500,
        "1" * 100_000 + " m",
        "1 " + "(" * 300,
        "1 m" + " " * 100_000 + "x",
        "1e999 m",
        "1 m^-1^-1",
        "1 m/0",
        "1 kkkkm",
        "1 \x00m",
        "nan m",
        "1 m**1e9",
        "1 lambda:0",
        "1 m if 1 else 0",
        "1 [m]",
        "1 m\n2 s",
    ],
)
def test_no_text_runs_away_with_a_quantity(text) -> None:
    start = time.process_time()
    with pytest.raises(InputError):
        parse(text, "length", "jet.radius")
    assert time.process_time() - start < 2.0


def test_the_own_table_of_units_is_that_of_pint() -> None:
    import pint

    from spinline.base import unit_table

    registry = pint.UnitRegistry()
    axes = ("kg", "m", "s", "A", "K", "mol")
    names = [
        "um",
        "mm",
        "mL",
        "hour",
        "kPa",
        "cP",
        "mN",
        "dyn",
        "kV",
        "keV",
        "uS",
        "mmol",
        "kDa",
        "ms",
        "ug",
        "bar",
        "atm",
        "torr",
    ]
    for name in names:
        scale, dimension = unit_table._known(name)  # type: ignore[misc]
        target = "*".join(f"{axis}**{power}" for axis, power in zip(axes, dimension, strict=True) if power)
        assert float(scale) == pytest.approx(float(registry.Quantity(1.0, name).to(target).magnitude), rel=1e-9)


def test_text_that_is_deep_or_long_is_refused(spinline, tmp_path) -> None:
    for text in ("a = " + "[" * 5000 + "]" * 5000, "a = " + "9" * 10_000, "[" + "a." * 5000 + "b]\n", "a" * 2_000_000):
        Path("s.toml").write_text(text, encoding="utf-8")
        for command in ("run", "sweep", "fit"):
            ran = spinline(command, "s.toml")
            assert ran.code == 2
            assert len(ran.err) < 4000


@pytest.mark.parametrize("how", ["pipe", "folder", "deep", "zeros", "nothing", "long", "archive"])
def test_files_that_others_name_are_read_as_carefully(how, tmp_path) -> None:
    """What a scene or an images file names: materials, lines of a beam, measured sizes, beads. A pipe would wait for ever."""
    import gzip

    from spinline.deposit.measured import read_diameters
    from spinline.jetprofile.jetspin import read_jetspin
    from spinline.jetprofile.readers import read_beads
    from spinline.radiography.absorber import _spectrum
    from spinline.scene.materials_file import read_materials

    def spectrum(path: Path) -> object:
        return _spectrum(type("Images", (), {"spectrum": path.name, "folder": path.parent})())  # type: ignore[arg-type]

    ends = {
        read_diameters: ".csv",
        read_jetspin: ".xyz",
        read_beads: ".vtp",
        spectrum: ".csv.gz",
        read_materials: ".toml",
    }
    if how == "nothing":
        del ends[read_materials]  # no materials at all
    for number, (read, end) in enumerate(ends.items()):
        place = tmp_path / f"{number}{end}"
        if how == "pipe":
            os.mkfifo(place)
        elif how == "folder":
            place.mkdir()
        else:
            place.write_bytes(
                {
                    "deep": b"a = " + b"[" * 20_000 + b"]" * 20_000,
                    "zeros": bytes(5000),
                    "nothing": b"",
                    "long": b"1" * 1_500_000,
                    "archive": gzip.compress(bytes(30_000_000)),
                }[how]
            )
        with pytest.raises(InputError):
            read(place)  # type: ignore[operator]


def test_hdf5_that_reaches_outside_is_refused(tmp_path) -> None:
    import h5py

    (tmp_path / "secret").write_bytes(bytes(8000))
    with h5py.File(tmp_path / "a.nc", "w") as file:
        file.create_dataset("x", (1000,), "f8", external=[("secret", 0, 8000)])
    with h5py.File(tmp_path / "b.nc", "w") as file:
        file["x"] = h5py.ExternalLink("a.nc", "/x")
    with h5py.File(tmp_path / "c.nc", "w") as file:
        file.create_dataset("x", (10**6, 10**6), "f8", chunks=(1000, 1000))
    for name, words in (("a", "another file"), ("b", "another file"), ("c", "more data than")):
        with pytest.raises(InputError, match=words):
            open_dataset(tmp_path / f"{name}.nc")


@pytest.mark.parametrize("inside", ["", ":/e/counts", ":/e", ":/soft"])
@pytest.mark.parametrize("how", ["above", "absolute", "pipe", "chain"])
def test_frames_read_no_file_outside_their_folder(tmp_path, how, inside) -> None:
    """External links, virtual sources, a link behind a link: what is not beside the file, or no regular file, is not opened."""
    import h5py

    from spinline.images.stacks import open_stack

    (tmp_path / "scan").mkdir()
    with h5py.File(tmp_path / "secret.h5", "w") as file:
        file["x"] = np.ones((2, 4, 5))
    os.mkfifo(tmp_path / "scan" / "pipe.h5")
    target = {"above": "../secret.h5", "absolute": str(tmp_path / "secret.h5"), "pipe": "pipe.h5", "chain": "next.h5"}[
        how
    ]
    with h5py.File(tmp_path / "scan" / "next.h5", "w") as file:
        file["x"] = h5py.ExternalLink("../secret.h5", "/x")
    with h5py.File(tmp_path / "scan" / "m.h5", "w") as file:
        file["e/counts"] = h5py.ExternalLink(target, "/x")
        file["soft"] = h5py.SoftLink("/e/counts")
    with pytest.raises(InputError, match=r"outside its folder|no regular file"):
        open_stack(f"m.h5{inside}", "counts", tmp_path / "scan")
    layout = h5py.VirtualLayout((2, 4, 5), "f8")
    layout[...] = h5py.VirtualSource(target, "/x", (2, 4, 5))
    with h5py.File(tmp_path / "scan" / "v.h5", "w") as file:
        file.create_virtual_dataset("counts", layout)
    if how != "chain":
        with pytest.raises(InputError, match=r"outside its folder|no regular file"):
            open_stack("v.h5", "counts", tmp_path / "scan")


def test_terminals_are_spared() -> None:
    assert clean("a\x1b]0;owned\x07\x9b2J\u202e") == "a\\u001b]0;owned\\u0007\\u009b2J\\u202e"
    assert "\x1b" not in str(InputError("\x1b[2J", "is \x9b odd", value="\x1b"))


def test_a_changed_table_is_read_again(tmp_path) -> None:
    from spinline.study.rows import jet_of

    table = "z [mm],radius [um]\n0,100\n1,{}\n2,20\n"
    base = load_scene("peo5-water")
    data = {
        "solution": {"polymer": "PEO", "solvent": "water", "mass_fraction": 0.05},
        "jet": {"profile": "table", "path": "j.csv", "flow_rate": "1 mL/hour"},
    }
    radii = []
    for middle in (50, 60):
        (tmp_path / "j.csv").write_text(table.format(middle))
        radii.append(float(jet_of(scene_from_dict(data, folder=tmp_path), str(tmp_path)).radius(1e-3)))
    assert radii == pytest.approx([50e-6, 60e-6])
    assert base.name


def test_what_is_missing_says_why() -> None:
    result = solved(load_scene("peo5-water", ["jet.length=1 mm"]))
    gone = [name for name, v in result.variables.items() if v.dtype.kind == "f" and np.isnan(v.values).any()]
    assert "crossover_position" in gone
    assert all(result[name].attrs["missing"] != "not known" for name in gone)


def test_sampling_that_leaves_the_range_is_said() -> None:
    result = solved(load_scene("peo5-water", ["network.model=walk", "accuracy.strands=20", "accuracy.points=30"]))
    beyond = result["radial_contraction"].values.min() < 0 or result["radial_contraction"].values.max() > 1
    assert beyond == ("sampled: radial_contraction lies" in result.attrs["warnings"])
    assert beyond


def test_whole_files_after_the_checksum_of_their_own(tmp_path, spinline) -> None:
    spinline("run", "peo5-water", "--no-figure", "-o", "a.nc")
    assert verified("a.nc")
    import xarray as xr

    with xr.open_dataset("a.nc", engine="h5netcdf") as other:  # other readers do not mind the seal
        assert other["radius"].encoding["fletcher32"]
        assert same(np.asarray(other["radius"].values), np.asarray(open_dataset("a.nc")["radius"].values))


def test_a_long_command_says_that_it_is_at_work(tmp_path) -> None:
    code = (
        "import time, sys\nfrom spinline.base.progress import report, telling\n"
        "with telling():\n    report('draws', 3, 128)\n    time.sleep(2.4)\n"
    )
    quiet = {key: value for key, value in os.environ.items() if key != "SPINLINE_QUIET"}
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=quiet, check=True)
    assert re.fullmatch(r"draws, 3 of 128 \(2 s\)\n", ran.stderr)
