"""Every number that the bundled scenes report, so that a change of the inside can be held against what was said before.

    python benchmarks/reference_numbers.py --full before.npz          # all numbers
    python benchmarks/reference_numbers.py --against before.npz       # the same again, and what differs by more than 1e-12
    python benchmarks/reference_numbers.py --out benchmarks/reference_numbers.json    # a few of the quick cases, for tests/

Runs of every bundled scene by every rung it can take, with both closures, with effects forced on and off, sweeps, windows,
fits and overlays. What is meant to change is listed with its reason in ``benchmarks/accepted_changes.toml``.
"""

import argparse
import importlib
import json
import sys
import tomllib
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import spinline as sl
from spinline.errors import InputError, SpinlineWarning

HERE = Path(__file__).parent
RTOL = 1e-12
SKIPPED = frozenset(
    {
        "scene",
        "plan",
        "source",
        "spinline_version",
        "references",
        "fingerprint",
        "sweep",
        "base_scene",
        "checks",
        "datum_source",
    }
)

PEO = "peo5-water"
RUNS: dict[str, tuple[str, list[str]]] = {
    **{
        name: (name, [])
        for name in (
            PEO,
            "peo3-water",
            "pcl9-dcm",
            "peo5-fig37",
            "extreme-stretch",
            "pmma10-acetone",
            "pmma10-drying",
            "pvp-jetspin",
        )
    },
    **{
        f"{name} {model}": (name, [f"network.model={model}", *more])
        for name in (PEO, "pcl9-dcm", "pmma10-acetone")
        for model, more in (("affine", []), ("manifold", []), ("walk", ["accuracy.strands=200", "accuracy.points=21"]))
    },
    f"{PEO} chain": (PEO, ["network.model=chain", "network.force_law=linear", "network.coarse_grain=4"]),
    f"{PEO} manifold linear 200": (PEO, ["network.model=manifold", "network.force_law=linear", "network.coupling=200"]),
    f"{PEO} auto 200": (PEO, ["network.coupling=200"]),
    f"{PEO} auto lattice": (PEO, ["network.force_law=lattice", "network.coupling=2000"]),
    f"{PEO} stretch": (PEO, ["network.closure=stretch"]),
    f"{PEO} lateral": (PEO, ["network.lateral=true"]),
    f"{PEO} conformation": (PEO, ["network.model=conformation", "solution.relaxation_time=10 ms"]),
    f"{PEO} relaxing auto": (PEO, ["solution.relaxation_time=3 ms"]),
    f"{PEO} fene-p": (PEO, ["network.model=conformation", "solution.relaxation_time=10 ms", "network.closure=stretch"]),
    f"{PEO} giesekus": (
        PEO,
        [
            "network.model=conformation",
            "solution.relaxation_time=10 ms",
            "rheology.constitutive=Giesekus",
            "rheology.mobility=0.3",
        ],
    ),
    f"{PEO} drying": (PEO, ["ambient.relative_humidity=0.4", "effects.evaporation=true"]),
    f"{PEO} drying manifold": (
        PEO,
        [
            "ambient.relative_humidity=0.4",
            "effects.evaporation=true",
            "network.model=manifold",
            "network.force_law=linear",
        ],
    ),
    "pmma10-drying flat": ("pmma10-drying", ["effects.radial=false"]),
    "pmma10-drying affine": ("pmma10-drying", ["network.model=affine"]),
    "pmma10-acetone dried": ("pmma10-acetone", ["ambient.temperature=25 degC", "effects.evaporation=true"]),
    "pmma10-acetone conformation": ("pmma10-acetone", ["solution.relaxation_time=5 ms", "network.model=conformation"]),
    "pvp-jetspin all": ("pvp-jetspin", ["jet.time=all"]),
    "pvp-jetspin conformation": ("pvp-jetspin", ["solution.relaxation_time=1 ms", "network.model=conformation"]),
    "pvp-jetspin drying": ("pvp-jetspin", ["ambient.relative_humidity=0.2", "effects.evaporation=true"]),
}


def module(*names: str) -> Any:
    """The first of some modules that there is: an older tree has them elsewhere."""
    for name in names:
        try:
            return importlib.import_module(name)
        except ModuleNotFoundError:
            continue
    raise ModuleNotFoundError(names)


def of_dataset(result: Any) -> Iterator[tuple[str, Any]]:
    for name in result.variables:
        if name not in SKIPPED:
            yield str(name), result[name].values
    for name, value in result.attrs.items():
        if name not in SKIPPED:
            yield f"attrs/{name}", value


def run_case(scene: str, overrides: list[str]) -> Iterator[tuple[str, Any]]:
    from spinline.scene import load_scene

    checked = load_scene(scene, overrides)
    result = sl.run(checked)
    yield from of_dataset(result)
    for effect in (
        json.loads(result.attrs["plan"])["effects_used"] + json.loads(result.attrs["plan"])["effects_left_out"]
    ):
        yield f"plan/{effect['name']}/number", np.nan if effect["number"] is None else effect["number"]
        error = effect["estimated_error"]
        yield f"plan/{effect['name']}/error", np.nan if error is None else error


def sweep_case(table: dict[str, Any] | str, **options: Any) -> Iterator[tuple[str, Any]]:
    sweep = sl.sweep
    asked = sweep.load_sweep(table) if isinstance(table, str) else sweep.sweep_from_dict(table)
    result = sweep.run_sweep(asked, workers=1, **options)
    for name in result.variables:
        yield str(name), result[name].values


def window_case(scene: str, **asked: Any) -> Iterator[tuple[str, Any]]:
    from spinline.scene import load_scene

    yield from of_dataset(sl.window.operating_window(load_scene(scene), workers=1, **asked))


def fit_case() -> Iterator[tuple[str, Any]]:
    load_fit = module("spinline.fit.file", "spinline.fit_file").load_fit
    fit = module("spinline.fit.inference", "spinline.fit.least_squares", "spinline.inference").fit
    fit_dataset = module("spinline.fit.output", "spinline.fit_output").fit_dataset
    asked = load_fit("peo5-simulated")
    yield from of_dataset(fit_dataset(fit(asked.problem), source=asked))


def model_case(scene: str, overrides: list[str], **options: bool) -> Iterator[tuple[str, Any]]:
    from spinline.scene import load_scene

    forward_model = module("spinline.fit.scene", "spinline.fit.model_of_scene", "spinline.fit_scene").forward_model
    model = forward_model(load_scene(scene, overrides), **options)
    seen = model.predict(np.linspace(-1e-5, 0.95 * model.length, 41))
    for name in ("radius", "mean", "core", "core_radius_ratio", "velocity_ratio", "stretch", "remaining"):
        yield name, getattr(seen, name)


VARY = {"jet.k": {"linspace": [0.8, 1.2, 4]}, "solution.mass_fraction": {"linspace": ["4 wt%", "7 wt%", 3]}}
CASES: dict[str, Callable[[], Iterator[tuple[str, Any]]]] = {
    **{f"run {name}": (lambda asked=asked: run_case(*asked)) for name, asked in RUNS.items()},
    "sweep peo-crossover": lambda: sweep_case("peo-crossover"),
    "sweep affine profiles": lambda: sweep_case(
        {
            "scene": PEO,
            "set": {"network.model": "affine"},
            "points": 21,
            "vary": VARY,
            "profiles": ["core_polymer_fraction", "strand_force", "residence_time"],
        }
    ),
    "sweep auto": lambda: sweep_case({"scene": PEO, "vary": VARY}),
    "sweep auto coupling": lambda: sweep_case(
        {
            "scene": PEO,
            "vary": {"network.coupling": {"logspace": [150, 1e5, 12]}, "jet.beta": {"linspace": [0.45, 0.5, 2]}},
        }
    ),
    "sweep relaxing": lambda: sweep_case(
        {
            "scene": PEO,
            "vary": {
                "solution.relaxation_time": {"values": ["1 ms", "10 ms", "100 ms", "1 s"]},
                "jet.k": {"linspace": [0.8, 1.2, 3]},
            },
        }
    ),
    "sweep drying": lambda: sweep_case(
        {"scene": "pmma10-drying", "set": {"effects.radial": False}, "vary": {"jet.k": {"linspace": [0.4, 0.6, 3]}}}
    ),
    "sweep uncertain": lambda: sweep_case(
        {"scene": "pmma10-acetone", "set": {"network.model": "affine"}, "vary": {"jet.p": {"linspace": [20, 26, 4]}}}
    ),
    "window": lambda: window_case("pcl9-dcm", voltage=[8e3, 12e3], gap=[0.1, 0.15], mass_fraction=[0.08, 0.1]),
    "window peo": lambda: window_case(PEO, voltage=[6e3, 12e3], gap=[0.1], conductivity=1e-2, relative_humidity=0.4),
    "fit peo5-simulated": fit_case,
    "model affine": lambda: model_case(PEO, []),
    "model relaxing": lambda: model_case(PEO, ["solution.relaxation_time=10 ms"], relaxation=True),
    "model drying": lambda: model_case(
        "pmma10-acetone", ["solution.relaxation_time=5 ms"], relaxation=True, evaporation=True
    ),
}


# replayed by tests/test_reference_numbers.py: quick, and of every rung that is
QUICK = (
    *(
        f"run {name}"
        for name in (
            PEO,
            "peo3-water",
            "pcl9-dcm",
            "extreme-stretch",
            f"{PEO} manifold",
            f"{PEO} manifold linear 200",
            f"{PEO} stretch",
            f"{PEO} lateral",
            f"{PEO} conformation",
            f"{PEO} fene-p",
            f"{PEO} giesekus",
            "pmma10-acetone affine",
            "pvp-jetspin",
        )
    ),
    "sweep affine profiles",
    "sweep auto coupling",
    "model affine",
    "model relaxing",
)
KEPT = (
    "crossover_position",
    "crossover_radius",
    "crossover_extension_position",
    "end_orientation",
    "end_relative_extension",
    "end_core_polymer_fraction",
    "fibre_radius",
    "radius",
    "orientation",
    "core_polymer_fraction",
    "network_radius",
    "residence_time",
    "strand_force",
    "stress",
    "lateral_network_radius",
    "profile_strand_force",
    "stretch",
    "core",
    "elastic coupling/error",
    "relaxation/error",
    "radius_band",
)


def small() -> dict[str, Any]:
    """What the committed file holds: a few numbers of the quick cases."""
    found: dict[str, Any] = {}
    for case in QUICK:
        for name, value in collect(case, exact=True).items():
            if name.endswith(tuple(f"/{kept}" for kept in KEPT)) and np.asarray(value).dtype.kind == "f":
                found[name] = sampled(value)
    return found


def collect(only: str = "", *, exact: bool = False) -> dict[str, Any]:
    """All numbers and words: "case/variable" to an array or text."""
    found: dict[str, Any] = {}
    for case, make in CASES.items():
        if case != only if exact else only not in case:
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SpinlineWarning)
            try:
                for name, value in make():
                    found[f"{case}/{name}"] = value
            except InputError as error:
                found[f"{case}/refused"] = str(error)
    return found


def sampled(value: Any) -> Any:
    """A few numbers of an array and their sum, enough to notice any change along it; NaN as null."""
    flat = np.asarray(value, dtype=np.float64).ravel()
    picked = flat if flat.size <= 4 else np.append(flat[np.linspace(0, flat.size - 1, 3).astype(int)], np.nansum(flat))
    return [float(x) if np.isfinite(x) else None for x in picked]


def accepted() -> list[dict[str, Any]]:
    """Changes that are meant, from ``accepted_changes.toml``."""
    return list(tomllib.loads((HERE / "accepted_changes.toml").read_text(encoding="utf-8")).get("change", []))


def allowed(name: str, changes: list[dict[str, Any]]) -> float:
    """Largest relative difference that is meant for a number: infinity where it is another quantity now."""
    return max((float(c["bound"]) for c in changes if any(part in name for part in c["numbers"])), default=RTOL)


def differs(old: Any, new: Any) -> float:
    """Largest relative difference of two arrays, element by element; inf for words, and for numbers that are not there."""
    one, other = np.asarray(old), np.asarray(new)
    if one.shape != other.shape or one.dtype.kind not in "fiub" or other.dtype.kind not in "fiub":
        return 0.0 if np.array_equal(one.astype(str), other.astype(str)) else float("inf")
    a, b = one.astype(np.float64), other.astype(np.float64)
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    if same.all():
        return 0.0
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        gap = np.where(same, 0.0, np.abs(a - b) / np.maximum(np.abs(a), np.abs(b)))
    return float("inf") if np.isnan(gap).any() else float(gap.max())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--full", type=Path, help="write all numbers (.npz)")
    parser.add_argument("--against", type=Path, help="compare with such a file")
    parser.add_argument("--out", type=Path, help="write a few of each (.json)")
    parser.add_argument("--only", default="", help="cases whose name holds this")
    options = parser.parse_args()
    if options.out:
        text = ",\n".join(f"{json.dumps(name)}: {json.dumps(value)}" for name, value in small().items())
        options.out.write_text("{\n" + text + "\n}\n", encoding="utf-8")
    if not (options.full or options.against):
        return 0
    found = collect(options.only)
    if options.full:
        np.savez_compressed(options.full, **{name.replace("/", "|"): np.asarray(v) for name, v in found.items()})
    if not options.against:
        return 0
    old = {name.replace("|", "/"): value for name, value in np.load(options.against, allow_pickle=True).items()}
    changes, wrong = accepted(), 0
    for name in sorted(set(old) | set(found)):
        if options.only not in name.split("/")[0] or name.rsplit("/", 1)[-1] in SKIPPED:
            continue
        if name not in old or name not in found:
            gap, what = float("inf"), "only before" if name in old else "only now"
        else:
            gap, what = differs(old[name], found[name]), ""
        if gap > allowed(name, changes):
            wrong += 1
            if gap == float("inf") and not what:
                what = f"{str(old[name])[:150]} -> {str(found[name])[:150]}"
            print(f"{gap:9.2g}  {name}  {what}")
    print(f"{len(found)} numbers and words, {wrong} differ")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
