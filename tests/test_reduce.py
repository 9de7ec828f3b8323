"""Images reduced as a user does it: files of every kind, calibration, blocks, checkpoints, and what is refused."""

import json
import os
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from conftest import IMAGES as FILE
from conftest import IMAGES_PHI as PHI
from conftest import IMAGES_PIXEL as PIXEL
from conftest import score_of as score

from spinline.base.errors import InputError
from spinline.images import bundled_images, images_from_dict, load_images
from spinline.radiography.preview import preview_images
from spinline.radiography.reduce import reduce_images
from spinline.radiography.reduction_dataset import REDUCTION_VARIABLES, UNIDENTIFIABLE, lines, to_csv
from spinline.solve import results

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


pytestmark = pytest.mark.usefixtures("quiet")


@pytest.mark.parametrize("method", ["row", "chord"])
def test_the_fraction_comes_out_with_its_error(frames_of, method) -> None:
    images, _ = frames_of(method=method, photons=2e7)
    result = reduce_images(images)
    assert abs(score(result)) < 3
    assert 0.6 < float(((result["mean_polymer_fraction"] - PHI) / result["mean_polymer_fraction_std"]).std()) < 1.4
    assert result["jet_radius"].values == pytest.approx(
        np.full(24, 30e-6), abs=5 * float(result["jet_radius_std"].max())
    )
    assert result["jet_axis"].values == pytest.approx(
        np.full(24, 3 * PIXEL), abs=5 * float(result["jet_axis_std"].max())
    )
    assert result["beam_level"].values == pytest.approx(np.full(24, 1.01), abs=1e-3)
    assert 1.0 <= float(result["limit_ratio"].min()) <= float(result["limit_ratio"].max()) < 4.0
    assert result.sizes == {"row": 24, "shell": 1, "other_shell": 1, "bound": 2}


def test_names_units_and_provenance(frames_of, tmp_path) -> None:
    images, _ = frames_of(shells=3, block_rows=8)
    result = reduce_images(images)
    assert set(map(str, result.variables)) == set(REDUCTION_VARIABLES)
    for name, (unit, words) in REDUCTION_VARIABLES.items():
        assert result[name].attrs.get("units", "") == unit
        assert result[name].attrs["long_name"] == words
    assert result["relative_radius"].values == pytest.approx([1 / 6, 1 / 2, 5 / 6])
    weights = np.array([1, 3, 5]) / 9
    assert result["mean_polymer_fraction"].values == pytest.approx(result["polymer_fraction"].values @ weights)
    cov = result["polymer_fraction_covariance"].values
    assert result["mean_polymer_fraction_std"].values == pytest.approx(
        np.sqrt(np.einsum("i,rij,j->r", weights, cov, weights))
    )
    assert result["polymer_concentration"].values == pytest.approx(1130 * result["polymer_fraction"].values)
    w = result["polymer_mass_fraction"].values
    assert w * 998.16 / (w * 998.16 + (1 - w) * 1130) == pytest.approx(result["polymer_fraction"].values, rel=1e-4)
    assert result.attrs["not_told_apart"] == UNIDENTIFIABLE
    assert {"ellip", "density", "azimuth"} <= {w for w in ("ellip", "density", "azimuth") if w in UNIDENTIFIABLE}
    assert "not calibrated" in result.attrs["warnings"]
    assert "0.17" in result.attrs["warnings"]
    again = results.open_dataset(results.save(result, tmp_path / "r.nc"))
    assert again.equals(result)
    assert {k: str(v) for k, v in again.attrs.items()} == {k: str(v) for k, v in result.attrs.items()}
    table = to_csv(result, tmp_path / "r.csv").read_text("utf-8").splitlines()
    assert len(table) == 1 + 3
    assert "polymer_concentration(r/R=0.5) [g/cm3]" in table[0]
    assert any("g/cm3" in line for line in lines(result))


@pytest.mark.slow
def test_every_kind_of_file_gives_the_same_numbers(frames_of, tmp_path) -> None:
    import h5py
    import tifffile

    images, arrays = frames_of(block_rows=12)
    expected = reduce_images(images)["mean_polymer_fraction"].values
    np.savez_compressed(tmp_path / "b.npz", **arrays)
    np.savez(tmp_path / "f.npz", **{k: np.asfortranarray(v) for k, v in arrays.items()})
    turned = {k: np.swapaxes(v, -1, -2) for k, v in arrays.items()}
    np.savez(tmp_path / "t.npz", **turned)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for key, array in arrays.items():
            file[f"entry/{key}"] = array
    for key, array in arrays.items():
        np.save(tmp_path / f"{key}.npy", array)
        tifffile.imwrite(tmp_path / f"{key}.tif", array, photometric="minisblack")
        tifffile.imwrite(tmp_path / f"{key}-z.tif", array, compression="zlib", photometric="minisblack")
    for i, frame in enumerate(arrays["counts"]):
        tifffile.imwrite(tmp_path / f"one-{i}.tif", frame)
    kinds = [
        dict.fromkeys(arrays, "b.npz"),
        dict.fromkeys(arrays, "f.npz"),
        {**dict.fromkeys(arrays, "t.npz"), "transpose": True},
        dict.fromkeys(arrays, "a.h5"),
        {key: f"a.h5:/entry/{key}" for key in arrays},
        {key: f"{key}.npy" for key in arrays},
        {key: f"{key}.tif" for key in arrays},
        {key: f"{key}-z.tif" for key in arrays},
        {**{key: f"{key}.tif" for key in arrays}, "counts": "one-*.tif"},
    ]
    for kind in kinds:
        other = images_from_dict({**FILE, **kind, "block_rows": 12}, folder=tmp_path)
        assert reduce_images(other)["mean_polymer_fraction"].values == pytest.approx(expected, rel=1e-12), kind


def test_flat_and_dark_from_parts_of_the_frame(frames_of, round_frame) -> None:
    """Air beside the jet, rows beyond its end, and a row of the detector: the same fraction, as well as they allow."""
    images, arrays = frames_of(photons=2e7, flat={"columns": [0, 12]}, block_rows=24)
    assert abs(score(reduce_images(images))) < 3
    air = np.ones_like(round_frame) * 1.01 * (1 + 0.01 * np.linspace(-1, 1, round_frame.size))
    both = np.concatenate((np.tile(air, (24, 1)), np.tile(round_frame, (24, 1))))
    images, _ = frames_of(photons=2e7, mean=both, rows=48, flat={"rows": [0, 24]}, block_rows=24)
    result = reduce_images(images)
    assert abs(result["mean_polymer_fraction"].values[1] - PHI) < 3 * result["mean_polymer_fraction_std"].values[1]
    images, arrays = frames_of(photons=2e7, dark=20, block_rows=24, save=False)
    arrays["flat"] = arrays["flat"].mean(axis=(0, 1))
    np.savez(images.folder / "a.npz", **arrays)
    assert abs(score(reduce_images(images))) < 3


def test_gain_is_found_from_the_flats(frames_of) -> None:
    images, _ = frames_of(photons=1e5, per_count=2.5, block_rows=24, flats=12)
    known = reduce_images(images_from_dict({**FILE, "gain": 2.5, "block_rows": 24}, folder=images.folder))
    found = reduce_images(
        images_from_dict({**{k: v for k, v in FILE.items() if k != "gain"}, "block_rows": 24}, folder=images.folder)
    )
    said, std = found.attrs["gain_source"].split(" photons")[0].split(" +/- ")
    assert abs(float(said) - 2.5) < 4 * float(std)
    assert (
        float(std) < 0.04
    )  # eleven differences of twelve flats, of which neighbours share a frame: seven independent ones
    assert found["mean_polymer_fraction_std"].values == pytest.approx(
        known["mean_polymer_fraction_std"].values, rel=0.02
    )
    assert "gain = " in found.attrs["warnings"]


def test_few_flats_and_read_noise_widen_the_error(frames_of, tmp_path) -> None:
    """Scatter over 24 rows is what the error says, though one flat adds as much noise as the frames have."""
    images, arrays = frames_of(photons=1e6, count=1, flats=1, save=False)
    rng = np.random.default_rng(3)
    noise = 300.0
    for key in ("counts", "flat"):
        arrays[key] = arrays[key] + 5000 + noise * rng.standard_normal(arrays[key].shape)
    arrays["dark"] = 5020 + noise * rng.standard_normal((16, *arrays["dark"].shape))
    np.savez(tmp_path / "a.npz", **arrays)
    result = reduce_images(images, noisy=True)
    assert result.attrs["flat_noise"] == pytest.approx(2.0)
    assert (
        "variance of 9.0" in result.attrs["dark_noise_source"] or "variance of 8.9" in result.attrs["dark_noise_source"]
    )
    assert float(result["misfit"].mean()) == pytest.approx(0.0, abs=0.8)
    z = (result["mean_polymer_fraction"] - PHI) / result["mean_polymer_fraction_std"]
    assert 0.65 < float(z.std()) < 1.4


def test_flat_after_takes_out_a_drift_of_the_flat(frames_of, tmp_path, round_frame) -> None:
    """The flat changes shape while frames are taken: half way between both, the jet is what it is."""
    bump = 1 + 0.004 * np.cos(np.linspace(0, 9, 120))
    images, arrays = frames_of(photons=2e7, count=4, save=False, block_rows=24, mean=round_frame * bump)
    rng = np.random.default_rng(5)
    arrays["flat_after"] = rng.poisson(2e7 * bump**2, (8, 24, 120)) + 20
    np.savez(tmp_path / "a.npz", **arrays)
    wrong = reduce_images(images)
    right = reduce_images(images_from_dict({**FILE, "flat_after": "a.npz", "block_rows": 24}, folder=tmp_path))
    assert abs(score(right)) < 3
    assert float(wrong["misfit"].min()) > 4 > abs(float(right["misfit"].max()))


def test_calibration_takes_out_a_wrong_coefficient(frames_of) -> None:
    """Attenuation 4.5 % off moves the fraction by 0.17; the known one in rows 0 to 12 takes that out, and its error is said."""
    images, _ = frames_of(photons=2e7, coherent=False, block_rows=4)
    off = reduce_images(images, noisy=True)
    shift = float(off["mean_polymer_fraction"].mean()) - PHI
    assert abs(shift) == pytest.approx(0.17, abs=0.02)
    images = images_from_dict(
        {**FILE, "coherent": False, "block_rows": 4, "calibration_rows": [0, 12]}, folder=images.folder
    )
    right = reduce_images(images)
    rest = right.isel(row=slice(3, None))
    assert abs(score(rest)) < 3
    assert float(right["attenuation_scale"]) == pytest.approx(531.9 / 508, rel=0.02)
    assert (right["calibration_std"] > 0).all()
    statistical = right["limit_ratio"] * right["limit_std"]
    assert right["mean_polymer_fraction_std"].values == pytest.approx(
        np.hypot(statistical, right["calibration_std"]).values
    )


def test_given_attenuation(frames_of) -> None:
    """5.329 and 3.490 cm2/g: water and PEO at 10 keV."""
    images, _ = frames_of(
        photons=2e7, energy=None, block_rows=24, polymer_attenuation="3.4905 cm2/g", solvent_attenuation="5.3285 cm2/g"
    )
    assert abs(float(reduce_images(images)["mean_polymer_fraction"][0]) - PHI) < 0.01


def test_pixel_size_from_the_nozzle(frames_of, round_frame) -> None:
    """A nozzle of 41.3 pixels, edges anywhere within a pixel: to a fiftieth of a pixel."""
    left, right = 37.3, 37.3 + 41.3
    covered = np.clip(right - np.arange(120), 0, 1) - np.clip(left - np.arange(120), 0, 1)
    rows = np.concatenate((np.tile(1 - covered, (8, 1)), np.tile(round_frame, (24, 1))))
    images, _ = frames_of(
        photons=4e6,
        mean=rows,
        rows=32,
        pixel_size=None,
        nozzle_diameter=f"{41.3 * 0.67} um",
        nozzle_rows=[0, 8],
        block_rows=8,
    )
    result = reduce_images(images)
    assert float(result["pixel_size"]) == pytest.approx(PIXEL, rel=0.02 / 41.3)
    assert abs(float(result["mean_polymer_fraction"][1:].mean()) - PHI) < 3 * float(
        result["mean_polymer_fraction_std"][1:].mean()
    )


def test_bad_pixels_are_left_out(frames_of, tmp_path) -> None:
    _, arrays = frames_of(photons=2e7, save=False, block_rows=4)
    arrays["counts"][:, 3, 50] = 9e7  # hot
    arrays["counts"][1, 7, 61] = np.nan
    arrays["flat"][:, 10, 40] = 0.0  # dead
    arrays["counts"][:, 10, 40] = 20.0
    mask = np.zeros((24, 120), dtype=np.uint8)
    mask[20, 70:75] = 1
    arrays["counts"][:, 20, 70:75] *= 1.1
    np.savez(tmp_path / "a.npz", **arrays, bad_pixels=mask)
    result = reduce_images(images_from_dict({**FILE, "bad_pixels": "a.npz", "block_rows": 4}, folder=tmp_path))
    assert abs(score(result)) < 3
    assert result.attrs["outlying_pixels"] == 1
    assert result.attrs["bad_pixels"] == 7
    assert float(result["misfit"].max()) < 4


@pytest.mark.slow
@pytest.mark.parametrize("photons", [20, 5, 1])
def test_few_photons_and_zero_counts(frames_of, brute_force, photons) -> None:
    """2,000 rows of 20, 5 or 1 photons per pixel in one block: unbiased within 3 sd."""
    wide = brute_force(
        lambda r: np.full_like(r, PHI),
        50e-6,
        flat=np.ones(224),
        pixel=PIXEL,
        solvent=531.87,
        contrast=-137.44,
        air=0.6,
        axis=3 * PIXEL,
        amplitude=1.01,
        slope=0.01,
        along=400,
    )
    images, arrays = frames_of(
        photons=photons, count=1, rows=2000, flats=20, offset=0.0, dark=0, block_rows=2000, mean=wide, shells=3
    )
    assert (arrays["counts"] == 0).any() or photons == 20
    result = reduce_images(images, noisy=True)
    assert abs(score(result)) < 3


@pytest.mark.slow
def test_each_frame_and_resume_give_identical_arrays(frames_of, tmp_path) -> None:
    """Killed half way, run again: the same to the last bit as in one go, and as frame by frame."""
    _, arrays = frames_of(photons=4e6, count=6, block_rows=6)
    text = 'frames = "each"\ncounts = "a.npz"\nflat = "a.npz"\ndark = "a.npz"\ngain = 1\npixel_size = "0.67 um"\nenergy = "10 keV"\n'
    text += 'shells = 1\nblock_rows = 6\n[solution]\npolymer = "PEO"\nsolvent = "water"\nmass_fraction = 0.05\n'
    (tmp_path / "e.toml").write_text(text, encoding="utf-8")
    whole = reduce_images(load_images(tmp_path / "e.toml"))
    assert whole.sizes["frame"] == 6
    stop_after = "import os, signal, spinline.radiography.reduce as r\nkeep = r._keep\ndef killed(store, name, fit):\n    keep(store, name, fit)\n"
    stop_after += "    if name == 'frame-000003': os.kill(os.getpid(), signal.SIGKILL)\nr._keep = killed\n"
    stop_after += (
        "from spinline.images import load_images\nr.reduce_images(load_images('e.toml'), checkpoint='e.partial')\n"
    )
    ran = subprocess.run([sys.executable, "-W", "ignore", "-c", stop_after], cwd=tmp_path, env=os.environ, check=False)
    assert ran.returncode == -signal.SIGKILL
    kept = sorted(file.name for file in (tmp_path / "e.partial").glob("frame-*.npz"))
    assert kept == [f"frame-{i:06d}.npz" for i in range(4)]
    stamp = (tmp_path / "e.partial" / kept[0]).stat().st_mtime_ns
    seen = []

    def progress(what, done, total):
        if what == "frames reduced":
            seen.append((done, total))
            if done == 4:
                assert (tmp_path / "e.partial" / kept[0]).stat().st_mtime_ns == stamp

    resumed = reduce_images(load_images(tmp_path / "e.toml"), checkpoint=tmp_path / "e.partial", progress=progress)
    assert seen == [(4, 6), (5, 6), (6, 6)]
    assert resumed.identical(whole)
    assert not (tmp_path / "e.partial").exists()
    for i in range(6):
        np.savez(tmp_path / "one.npz", counts=arrays["counts"][i], flat=arrays["flat"], dark=arrays["dark"])
        alone = reduce_images(
            images_from_dict(
                {**FILE, **dict.fromkeys(("counts", "flat", "dark"), "one.npz"), "block_rows": 6}, folder=tmp_path
            )
        )
        apart = alone["mean_polymer_fraction"].values - whole["mean_polymer_fraction"].values[i]
        # but for the detector's blur, which all frames tell together and one alone does not see
        assert np.abs(apart).max() < 0.25 * float(alone["mean_polymer_fraction_std"].min())


@pytest.mark.slow
def test_blocks_of_a_sum_killed_half_way_give_identical_arrays(frames_of, tmp_path) -> None:
    """A SIGKILL among the blocks of one frame; those that were kept are not fitted again."""
    frames_of(photons=4e6, count=2)
    text = 'counts = "a.npz"\nflat = "a.npz"\ndark = "a.npz"\ngain = 1\npixel_size = "0.67 um"\nenergy = "10 keV"\nshells = 1\n'
    text += 'block_rows = 2\n[solution]\npolymer = "PEO"\nsolvent = "water"\nmass_fraction = 0.05\n'
    (tmp_path / "s.toml").write_text(text, encoding="utf-8")
    whole = reduce_images(load_images(tmp_path / "s.toml"))
    script = (
        "import os, signal, numpy as np, spinline.radiography.reduce as r\nr._PAUSE = 0.0\nkeep = r._keep\n"
        "def killed(store, name, fit):\n    keep(store, name, fit)\n"
        "    if np.isfinite(fit.mean).sum() == 7: os.kill(os.getpid(), signal.SIGKILL)\nr._keep = killed\n"
        "from spinline.images import load_images\nr.reduce_images(load_images('s.toml'), checkpoint='s.partial')\n"
    )
    ran = subprocess.run([sys.executable, "-W", "ignore", "-c", script], cwd=tmp_path, env=os.environ, check=False)
    assert ran.returncode == -signal.SIGKILL
    assert (tmp_path / "s.partial" / "fit.npz").is_file()
    seen = []
    resumed = reduce_images(
        load_images(tmp_path / "s.toml"),
        checkpoint=tmp_path / "s.partial",
        progress=lambda what, done, total: seen.append(done) if what == "blocks" else None,
    )
    assert seen == [8, 9, 10, 11, 12]
    assert resumed.identical(whole)


@pytest.mark.slow
def test_processes_give_what_one_gives(frames_of, monkeypatch) -> None:
    import spinline.radiography.reduce

    images, _ = frames_of(photons=4e6, count=4, block_rows=12)
    images = images.model_copy(update={"frames": "each"})
    one = reduce_images(images)
    monkeypatch.setattr(spinline.radiography.reduce, "_WORTH_PROCESSES", 0.0)
    assert reduce_images(images, workers=2).identical(one)


def test_a_checkpoint_of_other_data_is_not_used(frames_of, tmp_path) -> None:
    from spinline.base.checkpoint import Checkpoint

    images, _ = frames_of(block_rows=12)
    store = Checkpoint(tmp_path / "p", "another job")
    store.save(
        "sum", total=np.zeros((24, 120)), exposures=np.ones((24, 120)), highest=np.zeros((24, 120)), frames=np.array(3)
    )
    fresh = reduce_images(images, checkpoint=tmp_path / "p")
    assert fresh.identical(reduce_images(images))
    (tmp_path / "q").mkdir()  # empty: left by a kill, nothing to lose
    (tmp_path / "r").mkdir()
    (tmp_path / "r" / "notes.txt").write_text("mine")
    assert fresh.identical(reduce_images(images, checkpoint=tmp_path / "q"))
    with pytest.raises(InputError, match=r"in the way.*notes\.txt|notes\.txt.*in the way"):
        reduce_images(images, checkpoint=tmp_path / "r")
    assert (tmp_path / "r" / "notes.txt").read_text() == "mine"


def test_a_sum_goes_on_where_it_stopped(tmp_path) -> None:
    from spinline.images.frames import open_stack, sum_frames

    rng = np.random.default_rng(0)
    np.save(tmp_path / "c.npy", rng.normal(100, 3, (50, 40, 3000)))
    stack = open_stack("c.npy", "counts", tmp_path)
    assert 1 < stack.at_once < 50
    copies = []
    whole = sum_frames(
        stack, pause=lambda s: copies.append((s.frames, s.total.copy(), s.exposures.copy(), s.highest.copy()))
    )
    frames, total, exposures, highest = copies[1]
    from spinline.images.frames import FrameSum

    rest = sum_frames(stack, begun=FrameSum(total, exposures, highest, frames))
    assert np.array_equal(rest.total, whole.total)
    assert np.array_equal(rest.highest, whole.highest)
    assert (whole.exposures == 50).all()
    assert whole.total == pytest.approx(np.load(tmp_path / "c.npy").sum(axis=0), rel=1e-12)


def test_blocks_that_smear_are_flagged_and_half_blocks_are_kept_together(frames_of) -> None:
    images, _ = frames_of(block_rows=5)
    assert reduce_images(images)["row"].values.tolist() == [2.0, 7.0, 12.0, 17.0, 21.5]
    images, _ = frames_of(block_rows=7)
    assert reduce_images(images)["row"].values.tolist() == [3.0, 10.0, 17.0]


def test_preview_says_what_the_reduction_finds(frames_of) -> None:
    images, _ = frames_of(photons=4e6, block_rows=4)
    seen, result = preview_images(images), reduce_images(images)
    numbers = seen.numbers()
    assert np.nanmedian(seen.expected_std) == pytest.approx(
        float(result["mean_polymer_fraction_std"].median()), rel=0.03
    )
    assert numbers["jet_radius"] == pytest.approx([30e-6, 30e-6], rel=0.02)
    assert numbers["left_edge_pixel"][0] == pytest.approx(60 + 3 - 30 / 0.67, abs=0.5)
    assert json.dumps(numbers)
    wanted = numbers["block_rows_for_0.01"]
    assert wanted == pytest.approx(4 * (float(np.nanmax(seen.expected_std)) / 0.01) ** 2, abs=1)


REFUSED = [
    ({"energy": "38.5 keV"}, {}, r"energy = .*38.5.*absorb alike.*use .* keV"),
    ({"flat": None}, {}, "flat: is missing"),
    ({"falt": "a.npz"}, {}, "falt.*did you mean 'flat'"),
    ({"counts": "b.npz"}, {}, "counts.*not a file"),
    ({"counts": "a.bmp"}, {}, "counts"),
    ({"counts": "*.png"}, {}, "counts.*matches no file"),
    ({}, {"counts": None}, "counts.*not an array of a.npz.*flat, dark"),
    ({}, {"counts": np.zeros(5)}, "counts"),
    ({}, {"counts": np.zeros((2, 2, 24, 120))}, r"counts.*\(frame, z, x\)"),
    ({}, {"counts": np.full((24, 120), "a")}, "counts.*no real numbers"),
    ({}, {"counts": np.full((24, 120), np.nan)}, "counts.*frame without a finite"),
    ({}, {"flat": np.ones((24, 60))}, r"flat.*another shape.*\(24, 120\)"),
    ({}, {"dark": np.ones((12, 120))}, "dark.*another shape"),
    ({}, {"dark": np.full((24, 120), 1e7)}, "dark.*at or over"),
    ({"transpose": True}, {}, "flat|transpose"),
    ({"saturation": 3.9e6}, {}, "counts.*saturated|flat.*saturated"),
    ({"gain": None}, {"flat": np.full((24, 120), 4e6)}, "gain.*missing.*one flat frame"),
    ({"gain": None}, {"dark": np.full((24, 120), 1e7)}, "dark.*at or over the flat"),
    ({}, {"counts": np.zeros((24, 120, 3))}, "counts.*colour image"),
    ({}, {"flat": np.ones((120, 24))}, "flat.*another shape.*on its side"),
    ({"gain": None}, {"flat": np.full((4, 24, 120), 4e6)}, "gain.*scatter no more"),
    ({"method": "phase"}, {}, "propagation_distance.*missing"),
    ({"method": "abel"}, {}, "method.*chord"),
    ({"energy": None, "spectrum": "s.csv"}, {}, "spectrum.*cannot be read"),
    ({"energy": None, "spectrum": {"10 keV": -1.0}}, {}, "spectrum"),
    ({"block_rows": 99}, {}, "block_rows.*24"),
    ({"calibration_rows": [0, 99]}, {}, "calibration_rows.*beyond"),
    ({"flat": {"columns": [0, 500]}}, {}, "flat.columns.*beyond"),
    ({"flat": {"columns": [5, 5]}}, {}, "flat.*columns is empty"),
    ({"nozzle_diameter": "60 um", "nozzle_rows": [0, 8], "pixel_size": None}, {}, "nozzle_rows.*no nozzle"),
    (
        {"solution": {"polymer": {"name": "Goo", "density": "1.1 g/cm3"}, "solvent": "water", "mass_fraction": 0.05}},
        {},
        "solution.polymer.*formula",
    ),
]


@pytest.mark.parametrize(("keys", "replaced", "words"), REFUSED)
def test_refusals_name_the_key(frames_of, tmp_path, keys, replaced, words) -> None:
    def attempt():
        images, arrays = frames_of(**keys)
        arrays = {k: v for k, v in {**arrays, **replaced}.items() if v is not None}
        np.savez(tmp_path / "a.npz", **arrays)
        reduce_images(images)

    with pytest.raises(InputError, match=words):
        attempt()


def test_damaged_files_are_named(frames_of, tmp_path) -> None:
    import tifffile

    images, arrays = frames_of()
    tifffile.imwrite(tmp_path / "whole.tif", arrays["counts"].astype(np.uint16), photometric="minisblack")
    whole = (tmp_path / "whole.tif").read_bytes()
    (tmp_path / "cut.tif").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "junk.tif").write_bytes(b"II*\0junk")
    (tmp_path / "empty.npy").touch()
    (tmp_path / "junk.h5").write_bytes(b"junk")
    for name, words in (
        ("cut.tif", "ends early"),
        ("junk.tif", "damaged"),
        ("empty.npy", "is an empty file"),
        ("junk.h5", "cannot be read"),
    ):
        with pytest.raises(InputError, match=rf"counts = '{name}'.*{words}"):
            reduce_images(images.model_copy(update={"counts": name}))


def test_counts_and_flat_that_changed_places(frames_of, tmp_path) -> None:
    images, arrays = frames_of(photons=2e7)
    np.savez(tmp_path / "a.npz", counts=arrays["flat"], flat=arrays["counts"], dark=arrays["dark"])
    with pytest.raises(InputError, match="flat: seems to have changed places with counts"):
        reduce_images(images)
    np.save(tmp_path / "c.npy", arrays["counts"])
    with pytest.raises(InputError, match=r"flat = 'c.npy': is the file of the frames"):
        reduce_images(images_from_dict({**FILE, "counts": "c.npy", "flat": "c.npy"}, folder=tmp_path))


def test_noise_over_the_signal_is_refused_with_a_remedy(frames_of) -> None:
    images, _ = frames_of(photons=3e4)
    with pytest.raises(InputError, match=r"block_rows = 1: the error expected, .* exceeds.*photons.*--noisy"):
        reduce_images(images)
    assert np.isfinite(reduce_images(images, noisy=True)["mean_polymer_fraction"]).any()


def test_a_jet_along_the_rows_is_told(frames_of, tmp_path, round_frame) -> None:
    images, arrays = frames_of(rows=120, save=False)
    np.savez(tmp_path / "a.npz", **{k: np.swapaxes(v, -1, -2) for k, v in arrays.items()})
    with pytest.raises(InputError, match=r"transpose: seems wrong.*transpose = true"):
        reduce_images(images)
    assert (
        abs(score(reduce_images(images_from_dict({**FILE, "transpose": True, "block_rows": 20}, folder=tmp_path)))) < 3
    )


def test_clipped_counts_are_refused_though_no_limit_was_given(frames_of, tmp_path) -> None:
    images, arrays = frames_of(photons=60000, count=2, save=False)
    arrays["counts"] = np.minimum(arrays["counts"] * 1.08, 65535).astype(np.uint16)
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(InputError, match=r"counts = 65535.*saturated"):
        reduce_images(images)


def test_no_jet_in_view(frames_of, round_frame) -> None:
    images, _ = frames_of(mean=np.ones_like(round_frame))
    with pytest.raises(InputError, match="show no jet"):
        reduce_images(images)


@pytest.mark.slow
def test_the_bundled_images_on_the_command_line(spinline, tmp_path) -> None:
    assert "peo5-images" in bundled_images()
    assert "peo5-images" in spinline("scenes").out
    looked = spinline("preview", "peo5-images")
    assert looked.code == 0
    assert "Jet of radius 12" in looked.out
    ran = spinline("reduce", "peo5-images", "--csv", "a.csv")
    assert ran.code == 0
    shown = README.split("$ spinline reduce peo5-images\n", 1)[1].split("```", 1)[0]
    assert ran.out == shown.replace("images.png", "images.png, a.csv")
    assert {file.name for file in tmp_path.iterdir()} == {
        "peo5-images.nc",
        "peo5-images.png",
        "a.csv",
        "peo5-images-preview.png",
    }
    result = results.open_result(tmp_path / "peo5-images.nc")
    z = (result["mean_polymer_fraction"] - 0.044426) / result["mean_polymer_fraction_std"]
    assert abs(float(z.mean())) < 0.8
    assert 0.6 < float(z.std()) < 1.4
    assert tomllib.loads(result.attrs["images"])["method"] == "row"
    again = spinline("reduce", "peo5-images")
    assert (again.code, "exists" in again.err) == (2, True)
    quick = spinline("reduce", "peo5-images", "--method", "chord", "--json", "--no-figure", "-o", "q.nc")
    assert quick.code == 0
    assert quick.json["attributes"]["method"] == "chord"
    assert spinline("scenes", "--copy", "peo5-images", "--to", ".").code == 0
    assert spinline("preview", "peo5-images.toml", "--json", "--no-figure").json["rows"] == 240
    wrong = spinline("reduce", "peo5-image")
    assert wrong.code == 2
    assert "did you mean the bundled 'peo5-images'" in wrong.err
    assert spinline("reduce", "peo5-images", "--method", "abel", "-o", "m.nc").code == 2
    assert not (tmp_path / "m.nc").exists()


def test_the_map_of_the_bundled_images() -> None:
    """All rows at once: half the error of blocks of six rows, and it holds."""
    result = reduce_images(load_images("peo5-images", ["method=map", "block_rows=1"]))
    z = (result["mean_polymer_fraction"] - 0.044426) / result["mean_polymer_fraction_std"]
    assert abs(float(z.mean())) < 1.5
    assert float(result["mean_polymer_fraction_std"].median()) < 0.005
    assert result.attrs["method"] == "map"


def test_exposure(spinline) -> None:
    """Photons for 0.01 of a jet that is known: the table of the limits, 7.4e4, 5.6e5, 4.4e6, 6.8e7."""
    plans = spinline("exposure", "peo5-water", "--energy", "10 keV", "--json").json
    assert [p["radius"] for p in plans] == pytest.approx([100e-6, 50e-6, 25e-6, 10e-6])
    assert [p["photons_known"] for p in plans] == pytest.approx([7.4e4, 5.6e5, 4.4e6, 6.8e7], rel=0.03)
    assert all(1.5 < p["photons"] / p["photons_known"] < 3 for p in plans)
    best = spinline(
        "exposure", "peo5-water", "--radius", "25 um", "--photons", "1e4", "--sigma", "0.005", "--json"
    ).json
    (one,) = best
    assert one["exposures"] == np.ceil(one["photons"] / 1e4)
    assert one["energy_kev"] < 10
    spoken = spinline("exposure", "peo5-images", "--photons", "1e5")
    assert spoken.code == 0
    assert "rows x frames" in spoken.out
    for bad in (
        ["--sigma", "0"],
        ["--radius", "1"],
        ["--energy", "38.5 keV"],
        ["--pixel", "1 mm", "--radius", "25 um"],
        ["--photons", "-1"],
    ):
        ran = spinline("exposure", "peo5-water", *bad)
        assert (ran.code, ran.out) == (2, "")
        assert ran.err.startswith("error: ")
