"""Images of whole jets, and frames made from the result of a run."""

import re
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest

import spinline as sl
from spinline import xray
from spinline.base.errors import InputError
from spinline.radiography.simulate import Camera, field_from_result, simulate
from spinline.scene.file import bundled_scenes

PIXEL = 1e-6
WATER = xray.solution_medium("PEO", "water", 10.0)


@pytest.fixture(scope="module")
def result():
    return sl.run(sl.load_scene("peo5-water"))


def cylinder(radius=40e-6, rows=30, fraction=0.05):
    return xray.JetField(PIXEL * (np.arange(rows) + 0.5), np.full(rows, radius), np.full((rows, 1), fraction))


def test_core_and_sheath_hold_the_polymer_exactly() -> None:
    ratio, core, mean = np.array([0.31, 0.77, 1.0]), np.array([0.4, 0.07, 0.05]), np.array([0.05, 0.05, 0.05])
    found = xray.core_and_sheath(ratio, core, mean, 37)
    assert found @ xray.shell_weights(xray.equal_shells(37)) == pytest.approx(mean, rel=1e-12)
    assert found[0, :11] == pytest.approx(0.4)
    assert found[0, 12:] == pytest.approx((0.05 - 0.4 * 0.31**2) / (1 - 0.31**2))
    with pytest.raises(InputError, match=r"core.*more polymer"):
        xray.core_and_sheath([0.9], [0.2], [0.05], 10)


def test_a_straight_cylinder_is_its_row() -> None:
    detector = xray.Detector(np.ones(120), PIXEL)
    row = xray.expected_counts(xray.RoundJet(np.array([0.05]), 40e-6, 3e-6), WATER.absorber, detector)
    image = xray.transmission_image(cylinder(), WATER, 120, PIXEL, axis=3e-6)
    assert image == pytest.approx(np.tile(row, (30, 1)), abs=1e-12)
    fringed = xray.transmission_image(cylinder(rows=3), WATER, 120, PIXEL, axis=3e-6, distance=0.1)
    wave = xray.fresnel_counts(xray.RoundJet(np.array([0.05]), 40e-6, 3e-6), WATER, detector, 0.1)
    assert fringed[1] == pytest.approx(wave, rel=1e-9)
    assert np.ptp(fringed) > 1.0


def test_tilts_by_tracing_rays_through_a_cylinder() -> None:
    """Paths of parallel rays through a cylinder whose axis leans by 10 degrees in the image and 15 out of it."""
    lean, out, radius = np.deg2rad(10.0), np.deg2rad(15.0), 40e-6
    for t, o in ((lean, 0.0), (0.0, out)):
        direction = np.array([np.sin(t) * np.cos(o), np.cos(t) * np.cos(o), np.sin(o)])  # x across, y along, z the beam
        beam = np.array([0.0, 0.0, 1.0])
        n = np.cross(direction, beam)
        x = PIXEL * (np.arange(130 * 20) - 0.5 * (130 * 20 - 1)) / 20
        points = np.stack((x, np.zeros_like(x), np.zeros_like(x)), axis=1)
        off = points @ n / np.linalg.norm(n)
        path = 2 * np.sqrt(np.maximum(radius**2 - off**2, 0)) / np.linalg.norm(n)
        mu = (WATER.solvent - WATER.air + 0.05 * WATER.contrast)[0]
        exact = np.exp(-mu * path).reshape(130, 20).mean(axis=1)
        image = xray.transmission_image(cylinder(rows=1), WATER, 130, PIXEL, tilt=t, tilt_out=o)
        assert image[0] == pytest.approx(exact, abs=2e-5)
    leaning = xray.transmission_image(cylinder(rows=100), WATER, 160, PIXEL, tilt=lean, axis=-10e-6)
    middle = ((1 - leaning) * PIXEL * (np.arange(160) - 79.5)).sum(axis=1) / (1 - leaning).sum(axis=1)
    assert np.polyfit(PIXEL * np.arange(100), middle, 1) == pytest.approx([np.tan(lean), -10e-6], rel=1e-3)


def test_fringes_of_a_tilted_jet_are_those_of_the_straight_one_seen_aslant() -> None:
    """Intensity depends on the distance from the axis, x cos(t), alone."""
    turn, n, pixel = np.deg2rad(20.0), 3000, 0.067e-6
    common = {"medium": WATER, "pixels": n, "pixel": pixel, "distance": 0.1}
    straight = xray.transmission_image(cylinder(rows=1), blur=1e-6 * np.cos(turn), **common)[0]
    leaning = xray.transmission_image(cylinder(rows=1), blur=1e-6, tilt=turn, **common)[0]
    x = pixel * (np.arange(n) - 0.5 * (n - 1))
    inside = np.abs(x) < 80e-6
    seen = np.interp(x * np.cos(turn), x, straight)
    assert np.ptp(seen) > 1.0
    assert np.abs(leaning - seen)[inside].max() < 1e-3
    wide = xray.JetField([0.5e-6], [40e-6 / np.cos(turn)], [[0.05]])
    upright = xray.transmission_image(wide, blur=1e-6, **common)[0]  # as wide, but not aslant
    assert np.abs(upright - seen)[inside].max() > 0.01


def test_blur_and_motion_along_the_jet() -> None:
    rows = 200
    z = PIXEL * (np.arange(rows) + 0.5)
    jet = xray.JetField(z, np.where(np.arange(rows) < 100, 40e-6, 30e-6), np.full((rows, 1), 0.05))
    sharp = 1 - xray.transmission_image(jet, WATER, 120, PIXEL)
    moved = 1 - xray.transmission_image(jet, WATER, 120, PIXEL, motion=20e-6)
    assert moved.sum() == pytest.approx(sharp.sum(), rel=1e-12)
    step = (moved[:, 60] - sharp[-1, 60]) / (sharp[0, 60] - sharp[-1, 60])
    assert step[90:110] == pytest.approx((109.5 - np.arange(90, 110)) / 20, abs=1e-9)  # a ramp 20 rows long
    soft = 1 - xray.transmission_image(jet, WATER, 120, PIXEL, blur=3e-6)
    across = np.diff(soft[:, 60])
    at = np.arange(199) - 99
    assert np.sqrt((across * at**2).sum() / across.sum()) == pytest.approx(3.0, rel=0.01)


def test_expected_image_has_drift_slope_veil_and_dark() -> None:
    seen = xray.expected_image(np.ones((2, 5)), 100.0, dark=7.0, veil=0.1, amplitude=1.1, slope=0.2)
    assert seen[0] == pytest.approx(100 * (1.1 * (1 + 0.2 * np.linspace(-1, 1, 5)) + 0.1) + 7)


def test_field_of_a_result_holds_its_polymer(result) -> None:
    field = field_from_result(result)
    assert field.mean_fraction == pytest.approx(result["mean_polymer_fraction"].values, rel=1e-6)
    assert field.radius == pytest.approx(result["radius"].values)
    shells = xr_with_map(result)
    assert field_from_result(shells).fraction[3] == pytest.approx(np.linspace(0.1, 0.2, 8))
    with pytest.raises(InputError, match="straight jet"):
        field_from_result(result.rename(z="element"))
    with pytest.raises(InputError, match="core_polymer_fraction"):
        field_from_result(result.drop_vars("core_polymer_fraction"))


def xr_with_map(result):
    r = (np.arange(8) + 0.5) / 8
    columns = np.tile(np.linspace(0.1, 0.2, 8), (result.sizes["z"], 1))
    return result.assign_coords(r=r).assign(polymer_fraction=(("z", "r"), columns))


def test_frames_are_reproducible_and_reduce_to_what_was_put_in(result) -> None:
    camera = Camera(pixel=PIXEL, photons=2e4, frames=25, drift=0.01, dark=30.0, flat_structure=0.02, seed=3)
    made = simulate(result, camera, start=0.2e-3, stop=0.22e-3)
    again = simulate(result, camera, start=0.2e-3, stop=0.22e-3)
    assert np.array_equal(made.counts, again.counts)
    assert not np.array_equal(made.counts[0], made.counts[1])
    flat = made.flat.mean(axis=0) - 30.0
    row = made.counts.sum(axis=0)[10].astype(float)
    detector = xray.Detector(25 * flat[10], PIXEL, np.array(25 * 30.0))
    fit = xray.fit_row(row, xray.solution_absorber("PEO", "water", 10.0), detector, shells=1)
    assert fit.jet.radius == pytest.approx(made.jet.radius[10], abs=4 * fit.std["radius"])
    assert abs(fit.mean_fraction - made.jet.mean_fraction[10]) < 6 * fit.mean_fraction_std  # the flat is noisy too
    assert made.counts.mean() == pytest.approx((made.transmission * flat).mean() + 30.0, rel=0.01)


def test_the_command_writes_frames_and_the_file_that_reduces_them(spinline, tmp_path) -> None:
    ran = spinline(
        "simulate-image",
        "peo5-water",
        "-o",
        "frames.npz",
        "--from",
        "0.2 mm",
        "--to",
        "0.21 mm",
        "--pixel",
        "1 um",
        "--frames",
        2,
        "--reference-frames",
        3,
        "--dark",
        10,
        "--blur",
        "1 um",
    )
    assert ran.code == 0, ran.err
    assert "2 frames of 10 x" in ran.out
    data = tomllib.loads((tmp_path / "frames.toml").read_text())
    assert (data["counts"], data["flat"], data["dark"]) == ("frames.npz",) * 3
    assert (data["pixel_size"], data["energy"], data["blur"], data["gain"]) == ("1 um", "10 keV", "1 um", 1.0)
    assert data["solution"]["polymer"] == "PEO"
    stored = np.load(tmp_path / "frames.npz")
    assert stored["counts"].shape[0] == 2
    assert stored["flat"].shape[0] == stored["dark"].shape[0] == 3
    assert stored["truth_radius"].shape == (10,)
    assert spinline("simulate-image", "peo5-water", "-o", "frames.npz").code == 2
    assert "exists" in spinline("simulate-image", "peo5-water", "-o", "frames.npz").err


def test_fringes_tiff_and_overrides(spinline, tmp_path) -> None:
    tifffile = pytest.importorskip("tifffile")
    assert (
        spinline("run", "peo5-water", "--set", "solution.mass_fraction=4 wt%", "--no-figure", "-o", "four.nc").code == 0
    )
    ran = spinline(
        "simulate-image",
        "four.nc",
        "-o",
        "f.tif",
        "--from",
        "1.000 mm",
        "--to",
        "1.003 mm",
        "--distance",
        "10 cm",
        "--frames",
        2,
        "--reference-frames",
        2,
        "--harmonic",
        0.01,
    )
    assert ran.code == 0, ran.err
    data = tomllib.loads((tmp_path / "f.toml").read_text())
    assert data["solution"]["mass_fraction"] == "4 wt%"
    assert (data["propagation_distance"], data["method"]) == ("10 cm", "phase")
    assert data["spectrum"] == {"10 keV": 0.99, "30 keV": 0.01}
    counts = tifffile.imread(tmp_path / data["counts"])
    assert counts.shape[:2] == (2, 4)
    assert tifffile.imread(tmp_path / data["flat"]).shape == counts.shape
    assert counts.max() > 1.5e4


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--energy", "10"], "energy.*unit"),
        (["--energy", "10 eV"], r"--energy = 0.01: is out of range; allowed: \[1, 200\] keV"),
        (["--tilt", "90"], "--tilt = 90.*-60 to 60 degrees"),
        (["--width", "3"], "--width = 3.*4"),
        (["--photons", "-1"], "photons"),
        (["--from", "4 mm", "--to", "3 mm"], "--to = 0.003: leaves no row"),
        (["--to", "1 m"], r"--to = 1.0: is out of range; allowed: .* m"),
        (["--frames", "0"], "frames"),
        (["--frames", "100000"], "frames.*pixels in all"),
        (["--width", "20", "--to", "5 um"], "--width = 20.*hold the jet"),
        (["--tilt", "80", "--to", "5 um"], "tilt"),
        (["-o", "x.png"], "npz"),
    ],
)
def test_refusals(spinline, arguments, words) -> None:
    ran = spinline("simulate-image", "peo5-water", *arguments)
    assert ran.code == 2
    assert re.search(words, ran.err), ran.err


def test_frames_never_stand_in_the_way_of_their_scene(spinline, tmp_path) -> None:
    """The images file had been NAME.toml, the scene itself: the remedy, --force, wrote over it or was refused."""
    scene = (Path(bundled_scenes()["peo5-water"])).read_text("utf-8")
    (tmp_path / "mine.toml").write_text(scene, "utf-8")
    ran = spinline("simulate-image", "mine.toml", "--from", "0.2 mm", "--to", "0.21 mm", "--pixel", "2 um")
    assert ran.code == 0, ran.err
    assert "mine-frames.npz, mine-frames.toml" in ran.out
    assert (tmp_path / "mine.toml").read_text("utf-8") == scene


def test_a_jet_of_a_few_pixels_is_said(spinline) -> None:
    ran = spinline("simulate-image", "peo5-water", "--pixel", "0.1 mm", "-o", "f.npz")
    assert ran.code == 0
    assert "pixels wide: no reduction tells its fraction" in ran.err
    ran = spinline(
        "simulate-image", "peo5-water", "--from", "0.2 mm", "--to", "0.21 mm", "--pixel", "2 um", "-o", "g.npz"
    )
    assert "pixels wide" not in ran.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--sigma", "5"], r"--sigma = 5.0.*allowed: \(0, 1\); a share: 0.05 for 5 %"),
        (["--shells", "0"], "--shells = 0.*at least 1"),
        (["--energy", "1 keV"], "--energy: lets no photon through.*a higher energy"),
    ],
)
def test_exposures_that_cannot_be(spinline, arguments, words) -> None:
    ran = spinline("exposure", "peo5-water", *arguments)
    assert ran.code == 2
    assert re.search(words, ran.err), ran.err


def test_the_page_shows_what_the_command_says(spinline) -> None:
    page = (Path(__file__).parents[1] / "docs/howto/simulate-image.md").read_text(encoding="utf-8")
    command, *shown = re.search(r"```console\n\$ spinline (.*?)```", page, re.DOTALL)[1].strip().splitlines()
    assert spinline(*shlex.split(command)).out.splitlines() == shown
