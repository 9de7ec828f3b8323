"""One of every file that the program writes or reads, to be damaged (`file_damage`) by the attack tests and ``benchmarks/attack.py``."""

import functools
import shutil
import warnings
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from file_damage import Victim

import spinline


def _arrays(dataset: Any) -> dict[str, Any]:
    found: dict[str, Any] = {str(name): np.asarray(v.values) for name, v in dataset.variables.items()}
    found = {
        name: np.array(value.tolist(), dtype=str) if value.dtype.kind in "OT" else value
        for name, value in found.items()
    }
    return found | {f"@{key}": str(value) for key, value in dataset.attrs.items()}


def read_netcdf(path: Path) -> dict[str, Any]:
    """A result."""
    from spinline.base.netcdf import open_dataset

    return _arrays(open_dataset(path))


def read_store(path: Path) -> Any:
    """A sweep."""
    from spinline.study.rows import PENDING
    from spinline.study.store import open_sweep

    found = _arrays(open_sweep(path))
    # a chunk without its status counts as not computed: its rows say so, and the sweep computes them again
    return "redone" if (found["status"] == PENDING).any() else found


def read_piece(path: Path) -> Any:
    """A piece of a checkpoint."""
    from spinline.base.checkpoint import Checkpoint

    found = Checkpoint(path.parent, None).load(path.stem)
    return "redone" if found is None else found


def read_chain(path: Path) -> Any:
    """A checkpoint of a chain."""
    from spinline.network.chain.state import load_states

    (state,) = load_states(path, "print")
    return {name: np.asarray(getattr(state, name)) for name in ("positions", "tensions", "velocities", "time")}


def read_scene(path: Path) -> Any:
    """A scene, solved."""
    from spinline.scene.file import load_scene
    from spinline.solve.spine import solved

    found = solved(load_scene(path, ["accuracy.points=20", "network.model=affine"]))
    return {name: v.values for name, v in found.variables.items()}


def read_table(path: Path) -> Any:
    """Columns."""
    from spinline.jetprofile.columns import read_columns

    return read_columns(path, {"z": "length", "radius": "length", "radius_std": "length"})


def read_beads(path: Path) -> Any:
    """A run of JETSPIN."""
    from spinline.jetprofile.jetspin import read_jetspin

    return _arrays(read_jetspin(path))


def read_statistics_of(path: Path) -> Any:
    """The statistics of a run of JETSPIN."""
    from spinline.jetprofile.jetspin import read_statistics

    return _arrays(read_statistics(path))


def read_fibres(path: Path) -> Any:
    """A file of laid fibres, every row and what it says of itself."""
    from spinline.deposit import FibreFile

    with FibreFile(path) as file:
        rows = file.read()
        return {
            "attributes": dict(file.attributes),
            **{name: getattr(rows, name) for name in ("x", "dx", "radius", "fibre")},
        }


def read_line(path: Path) -> Any:
    """A jet of beads in a format of other programs."""
    from spinline.jetprofile.readers import read_beads as read

    jet = read(path, unit="cm" if path.suffix == ".vtk" else None)
    return {name: np.asarray(value) for name, value in vars(jet).items() if isinstance(value, np.ndarray)}


def read_sizes(path: Path) -> Any:
    """Measured diameters."""
    from spinline.deposit.measured import read_diameters

    return read_diameters(path).diameter


def read_frames(path: Path) -> Any:
    """A stack of frames, all of it."""
    from spinline.images.stacks import open_stack

    inside = ":/counts" if path.suffix == ".h5" else ""
    stack = open_stack(f"{path.name}{inside}", "counts", path.parent)
    found = stack.read(0, stack.frames)
    return np.asarray(found[0] if isinstance(found, tuple) else found)


def read_recipe(path: Path) -> Any:
    """A recipe, and the fibre it gives."""
    from spinline.recipe.recipe_file import fibre, load_recipe

    found = fibre(load_recipe(path))
    return {"diameter": found.fibre_diameter, "orientation": found.orientation, "regime": found.regime}


def read_experiments(path: Path) -> Any:
    """A table of experiments, and what is predicted of each."""
    from spinline.recipe.table import predict_table
    from spinline.recipe.table import read_experiments as read

    return predict_table(read(path))


def read_laydown(path: Path) -> Any:
    """A scene of laydown, and the fibres it lays."""
    from spinline.deposit import Segments
    from spinline.scene.mat_file import load_mat_scene
    from spinline.setup.mat import lay_scene

    laid = Segments.join(list(lay_scene(load_mat_scene(path))))
    return {name: getattr(laid, name) for name in ("x", "dx", "radius", "fibre")}


def read_laid(path: Path) -> Any:
    """The fibres of a jet that landed."""
    from spinline.setup.mat import laid_file

    laid = laid_file(path)
    return None if laid is None else {name: getattr(laid, name) for name in ("x", "dx", "radius", "touch_time")}


def read_landings(path: Path) -> Any:
    """Landings: of a file of them, or of JETSPIN's table."""
    from spinline.setup.mat import landings_of

    record = landings_of(path)
    return {name: getattr(record, name) for name in ("touch_time", "position", "volume", "flight_length", "fibre")}


def read_input(path: Path) -> Any:
    """JETSPIN's input."""
    from spinline.jetprofile.spun.jetspin_input import translate

    return repr(translate(path.read_text(encoding="utf-8", errors="replace")))


def read_rolled(path: Path) -> Any:
    """The layers of a drum, and what is summed over them."""
    from spinline.deposit import FibreFile
    from spinline.deposit.whole import Rolled, survey

    with FibreFile(path) as file:
        whole = survey(Rolled(file, float(file.attributes["circumference"])))
    return {"bounds": whole.bounds, "length": whole.length, "angles": whole.angles, "volume": whole.dry_volume}


def resumed(settings: Any, times: Any, path: Path) -> Any:
    """A run that goes on from its checkpoint, or is made again: the same numbers in either case."""
    from spinline.base.checkpoint import Checkpoint
    from spinline.base.naming import unlock_folder
    from spinline.jetprofile.spun.run import SpunRun

    kept = Checkpoint(path, "job")
    held = kept.load("run")
    unlock_folder(path)
    run = SpunRun.start(settings) if held is None else SpunRun.unpack(settings, held)
    for _ in run.to(times):
        pass
    return run.pack()


def make_victims(folder: Path, data: Path) -> list[Victim]:
    """All of them.

    Parameters
    ----------
    folder : Path
        Where they are made.
    data : Path
        ``tests/data``.
    """
    makers = (_results, _work_in_hand, _fibres, _jets, _text, _frames, _of_other_programs)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        victims = [victim for make in makers for victim in make(folder, data)]
    assert [victim.name for victim in victims] == list(NAMES)
    return victims


NAMES = (
    "result",
    "window",
    "fibre window",
    "store",
    "checkpoint",
    "chain",
    "spin under way",
    "fibres",
    "fibres of a drum",
    "mat",
    "jet",
    "spun jet",
    "spun jet's fibres",
    "blown jet",
    "scene",
    "laydown",
    "recipe",
    "experiments",
    "predicted",
    "table",
    "diameters",
    "frames npz",
    "frames npy",
    "frames tif",
    "frames h5",
    "line vtk",
    "line csv",
    "beads",
    "statistics",
    "landed beads",
    "input",
    "zip",
)


def _results(folder: Path, data: Path) -> list[Victim]:
    from spinline.recipe.recipe_file import load_recipe
    from spinline.recipe.window import fibre_window
    from spinline.scene.file import load_scene
    from spinline.solve import results
    from spinline.solve.spine import solved
    from spinline.study.sweep import run_sweep, sweep_from_dict
    from spinline.study.window import operating_window

    results.save(solved(load_scene("peo5-water", ["accuracy.points=60"])), folder / "run.nc")
    affine = load_scene("peo5-water", ["network.model=affine", "accuracy.points=20"])
    results.save(
        operating_window(affine, voltage=[5e3, 2e4], gap=[0.15, 0.2], conductivity=0.01, workers=1),
        folder / "window.nc",
    )
    results.save(fibre_window(load_recipe("pan-dmf"), voltage=[1e4, 2e4]), folder / "fibres.nc")
    sweep = sweep_from_dict(
        {
            "scene": "peo5-water",
            "chunk": 40,
            "profiles": ["radius"],
            "points": 5,
            "design": {"kind": "latin-hypercube", "samples": 120},
            "vary": {"jet.k": {"uniform": [0.5, 2.0]}},
        },
        ["network.model=affine"],
    )
    run_sweep(sweep, folder / "sweep.zarr", workers=1)
    return [
        Victim("result", folder / "run.nc", read_netcdf),
        Victim("window", folder / "window.nc", read_netcdf),
        Victim("fibre window", folder / "fibres.nc", read_netcdf),
        Victim("store", folder / "sweep.zarr", read_store),
    ]


def _work_in_hand(folder: Path, data: Path) -> list[Victim]:
    """What is kept of work that is not done."""
    from dataclasses import replace

    from spun_cases import pvp

    from spinline.base.checkpoint import Checkpoint
    from spinline.base.naming import unlock_folder
    from spinline.jetprofile.spun.run import SpunRun, moments
    from spinline.network.chain.state import ChainState, save_states

    rng = np.random.default_rng(0)
    (folder / "job").mkdir()
    Checkpoint(folder / "job", None).save("piece", total=rng.random((20, 30)), frames=np.array(3))
    x = np.linspace(5.0, 0.0, 40)
    save_states(folder / "chain.npz", [ChainState(1.0, x, x[1:], x, 3, x, x)], "print")
    settings, times = replace(pvp(1e-3), seed=3), moments(1e-3, 4)
    run = SpunRun.start(settings)
    steps = run.to(times)
    next(steps), next(steps)
    kept = Checkpoint(folder / "spin", "job")
    kept.save("run", **run.pack())
    unlock_folder(folder / "spin")
    return [
        Victim("checkpoint", folder / "job" / "piece.npz", read_piece),
        Victim("chain", folder / "chain.npz", read_chain),
        Victim("spin under way", folder / "spin", functools.partial(resumed, settings, times)),
    ]


def _fibres(folder: Path, data: Path) -> list[Victim]:
    from spinline.base.netcdf import save_dataset
    from spinline.deposit import FibreWriter, MatOptions, Segments, analyse_mat

    rng = np.random.default_rng(0)
    laid = Segments.from_paths([np.cumsum(rng.normal(scale=1e-5, size=(400, 2)), axis=0)], 3e-7)
    for name, more in (("fibres.h5", {}), ("drum.h5", {"circumference": 2e-4, "collector_kind": "drum"})):
        with FibreWriter(folder / name, {"mat": "a text", "seed": 3, **more}) as file:
            file.write(laid)
    save_dataset(analyse_mat(laid, MatOptions(realisations=1, window=5e-5)), folder / "mat.nc")
    return [
        Victim("fibres", folder / "fibres.h5", read_fibres),
        Victim("fibres of a drum", folder / "drum.h5", read_rolled),
        Victim("mat", folder / "mat.nc", read_netcdf),
    ]


def _jets(folder: Path, data: Path) -> list[Victim]:
    from dataclasses import replace

    from spun_cases import pvp

    from spinline.base.netcdf import save_dataset
    from spinline.jetprofile.jetspin import write_jet
    from spinline.jetprofile.spun.dataset import to_dataset
    from spinline.jetprofile.spun.run import SpunRun, moments
    from spinline.jetprofile.spun.settings import Collector
    from spinline.scene.file import load_scene
    from spinline.setup.blown import blown_dataset
    from spinline.setup.build import build_solution

    write_jet(data / "jetspin" / "ex2_1d_insert", folder / "jet.nc")
    near = pvp(0.5e-3)
    run = SpunRun.start(replace(near, loads=replace(near.loads, gap=0.02), collector=Collector("plate")))
    for _ in run.to(moments(16e-3, 4)):
        pass
    spun = to_dataset(run, attributes={"title": "near"})
    assert spun.sizes["deposit"] > 3
    save_dataset(spun, folder / "spun.nc")
    blown = load_scene("pan12-blown", ['collector.distance="2 cm"', 'jet.time="1 ms"'])
    save_dataset(blown_dataset(blown, build_solution(blown), frames=3), folder / "blown.nc")
    return [
        Victim("jet", folder / "jet.nc", read_netcdf),
        Victim("spun jet", folder / "spun.nc", read_netcdf),
        Victim("spun jet's fibres", folder / "spun.nc", read_laid),
        Victim("blown jet", folder / "blown.nc", read_landings),
    ]


def _text(folder: Path, data: Path) -> list[Victim]:
    """What users write."""
    from spinline.recipe.recipe_file import bundled_recipes
    from spinline.recipe.table import predict_table, written
    from spinline.recipe.table import read_experiments as read
    from spinline.scene.file import bundled_scenes

    shutil.copyfile(bundled_scenes()["peo5-water"], folder / "scene.toml")
    shutil.copyfile(bundled_recipes()["pan-dmf"], folder / "recipe.toml")
    (folder / "lay.toml").write_text(
        'title = "One jet"\n[laydown]\nspeed = "5 m/s"\nspread = "60 um"\nturning_length = "100 um"\n'
        'diameter = "600 nm"\n[collector]\nkind = "drum"\ndistance = "20 cm"\nradius = "5 cm"\nspeed = "1 m/s"\n'
        'time = "1 ms"\n[mat]\nwindow = "12 um"\n',
        encoding="utf-8",
    )
    sample = (data / "spindb" / "experiments-sample.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (folder / "experiments.csv").write_text("".join(sample[:4]), encoding="utf-8")
    (folder / "predicted.csv").write_text(written(predict_table(read(folder / "experiments.csv"))), encoding="utf-8")
    z = np.linspace(0, 5, 60)
    rows = "".join(f"{a:.6g},{100 / (1 + a):.6g},{1 + 0.1 * a:.3g}\n" for a in z)
    (folder / "table.csv").write_text("z [mm],radius [um],radius_std [um]\n" + rows, encoding="utf-8")
    (folder / "sizes.csv").write_text("Diameter (nm)\n" + "\n".join(str(d) for d in range(400, 700, 3)) + "\n")
    return [
        Victim("scene", folder / "scene.toml", read_scene, ours=False),
        Victim("laydown", folder / "lay.toml", read_laydown, ours=False),
        Victim("recipe", folder / "recipe.toml", read_recipe, ours=False),
        Victim("experiments", folder / "experiments.csv", read_experiments, ours=False),
        Victim("predicted", folder / "predicted.csv", read_experiments, ours=False),
        Victim("table", folder / "table.csv", read_table, ours=False),
        Victim("diameters", folder / "sizes.csv", read_sizes, ours=False),
    ]


def _frames(folder: Path, data: Path) -> list[Victim]:
    import h5py
    import tifffile

    counts = np.random.default_rng(0).poisson(200.0, (3, 24, 40)).astype(np.uint16)
    np.savez_compressed(folder / "frames.npz", counts=counts)
    np.save(folder / "frames.npy", counts)
    tifffile.imwrite(folder / "frames.tif", counts, photometric="minisblack")
    with h5py.File(folder / "frames.h5", "w") as file:
        file.create_dataset("counts", data=counts, chunks=(1, 24, 40), compression="gzip")
    kinds = ("npz", "npy", "tif", "h5")
    return [Victim(f"frames {kind}", folder / f"frames.{kind}", read_frames, ours=False) for kind in kinds]


def _of_other_programs(folder: Path, data: Path) -> list[Victim]:
    line = np.column_stack([np.linspace(0, 5, 30), np.sin(np.arange(30.0)), np.cos(np.arange(30.0))])
    points = "\n".join(f"{a:.6g} {b:.6g} {c:.6g}" for a, b, c in line)
    cells, radii = " ".join(map(str, range(30))), " ".join(f"{0.01 / (1 + i):.6g}" for i in range(30))
    (folder / "line.vtk").write_text(
        f"# vtk DataFile Version 3.0\njet\nASCII\nDATASET POLYDATA\nPOINTS 30 double\n{points}\n"
        f"LINES 1 31\n30 {cells}\nPOINT_DATA 30\nSCALARS radius double 1\nLOOKUP_TABLE default\n{radii}\n"
    )
    table = "\n".join(f"{a:.6g},{b:.6g},{c:.6g},{0.01:.3g}" for a, b, c in line)
    (folder / "line.csv").write_text(f"x [cm],y [cm],z [cm],radius [cm]\n{table}\n")

    def smallest(name: str) -> Path:
        return min((data / "jetspin").glob(f"*/{name}"), key=lambda file: file.stat().st_size)

    landed = folder / "landed"  # its units stand beside the table
    landed.mkdir()
    bundled = Path(spinline.__file__).parent / "data" / "scenes" / "pvp3d"
    for file in (data / "jetspin" / "pvp3d" / "bead.dat", bundled / "log.txt", bundled / "input.dat"):
        shutil.copyfile(file, landed / file.name)
    zipped = folder / "run.zip"
    with zipfile.ZipFile(zipped, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted((data / "jetspin" / "ex2_1d_insert").iterdir()):
            archive.write(file, f"run/{file.name}")
    return [
        Victim("line vtk", folder / "line.vtk", read_line, ours=False),
        Victim("line csv", folder / "line.csv", read_line, ours=False),
        Victim("beads", smallest("traj.xyz"), read_beads, ours=False),
        Victim("statistics", smallest("statout.dat"), read_statistics_of, ours=False),
        Victim("landed beads", landed, read_landings, ours=False),
        Victim("input", bundled / "input.dat", read_input, ours=False),
        Victim("zip", zipped, read_line, ours=False),
    ]
