"""Frames that are not what they are taken for: more than a jet down the rows, darks that are not theirs, scales that are off.

Scenes are those of `test_odd_frames`: transmissions by chord, Poisson counts.
"""

import warnings

import numpy as np
import pytest
from test_odd_frames import COLUMNS, FRACTION, PIXEL, RADIUS, exposures, transmission

from spinline.base.errors import InputError, SpinlineWarning
from spinline.radiography.reduce import reduce_images
from spinline.scene.images_file import images_from_dict
from spinline.xray.frame.breaks import row_breaks
from spinline.xray.frame.hot_pixels import dark_share
from spinline.xray.frame.moved_beam import moved_beam

BEAM, TALL = 4e5, 60


SOLUTION = {"polymer": "PEO", "solvent": "water", "mass_fraction": 0.15}


@pytest.fixture
def reduced(tmp_path):
    def reduce(counts, flat, dark, **keys):
        np.savez(tmp_path / "a.npz", counts=counts, flat=flat, dark=dark)
        given = dict.fromkeys(("counts", "flat", "dark"), "a.npz") | {"gain": 1.0, "pixel_size": f"{PIXEL} m"}
        given |= {"energy": "10 keV", "block_rows": 12, "shells": 1, "solution": SOLUTION} | keys
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SpinlineWarning)
            result = reduce_images(images_from_dict({k: v for k, v in given.items() if v is not None}, folder=tmp_path))
        return result, str(result.attrs["warnings"])

    return reduce


def scene(shape, beam=BEAM, dark=100.0, seed=1, frames=8, response=1.0) -> np.ndarray:
    """Frames of a transmission (rows, columns), a dark or many pixels' darks."""
    rng = np.random.default_rng(seed)
    mean = np.broadcast_to(np.broadcast_to(shape, (TALL, COLUMNS)) * response, (frames, TALL, COLUMNS))
    return rng.poisson(beam * mean) + rng.poisson(np.broadcast_to(dark, mean.shape))


def off(found) -> float:
    return float(((found["mean_polymer_fraction"] - FRACTION) / found["mean_polymer_fraction_std"]).mean())


def nozzle(light: float) -> np.ndarray:
    rows = np.tile(transmission(), (TALL, 1))
    rows[:10] = np.where(np.abs(np.arange(COLUMNS) - 69.5) < 55, light, 1.0)
    return rows


@pytest.mark.parametrize(
    ("rows", "at", "rest"),
    [
        (nozzle(1e-4), 10, "12, 60"),  # had been said to be fringes, and phase to be the remedy
        (nozzle(0.3), 10, "12, 60"),
        (np.where(np.arange(TALL)[:, None] < 40, transmission(), 1.0), 40, "0, 38"),  # 425 standard deviations
    ],
)
def test_more_than_a_jet_down_the_rows_is_said_by_row(reduced, rows, at, rest) -> None:
    flat, dark = scene(1.0, seed=2), scene(0.0, seed=3)
    try:
        _, said = reduced(scene(rows), flat, dark)
    except InputError as error:
        said = str(error)
    assert f"pixels at row {at}: the nozzle's end, a drop, the end of the jet" in said
    assert f"roi = {{ rows = [{rest}] }}" in said
    part = [int(n) for n in rest.split(", ")]
    found, said = reduced(scene(rows), flat, dark, roi={"rows": part})
    assert "more than one jet" not in said
    assert abs(off(found)) < 2.5


def test_a_frame_that_cannot_be_followed_for_its_rows_is_refused_for_them(reduced) -> None:
    """A droplet on the window while the flat was taken: it had been an axis of 72 degrees."""
    x, z = np.meshgrid(np.arange(COLUMNS) - 60.0, np.arange(TALL) - 30.0)
    droplet = np.exp(-0.1 * np.exp(-(x**2 + z**2) / 128.0))
    with pytest.raises(InputError, match=r"more than one jet down the rows.*jumps.*roi = "):
        reduced(scene(transmission()), scene(droplet, seed=2), scene(0.0, seed=3))


@pytest.mark.parametrize("beam", [20.0, 4e3, 4e6])
def test_jets_that_thin_and_swell_have_no_breaks(beam) -> None:
    """Cones as steep as a jet's radius in its own length, beads, single rows that are off, noise."""
    z = np.arange(TALL)
    cone, bead = 0.3 + 0.7 * np.exp(-z / 8.0), 0.6 * (1.0 + 0.9 * np.exp(-(((z - 30) / 10.0) ** 2)))
    for seed, radii in enumerate((np.ones(TALL), cone, cone[::-1], bead)):
        seen = np.array([transmission(radius=RADIUS * r) for r in radii])
        seen[20] *= 0.5
        for depth in (1.0, 20.0):
            counts = np.random.default_rng(seed).poisson(beam * seen**depth)
            flat, zero = np.full(counts.shape, beam), np.zeros(counts.shape)
            assert row_breaks(counts.astype(float), flat, zero, np.ones(counts.shape, dtype=bool)) == []


def camera(seed=5, hot=0.004) -> tuple[np.ndarray, np.ndarray]:
    """Dark counts and sensitivity of a camera's pixels."""
    rng = np.random.default_rng(seed)
    shape = (TALL, COLUMNS)
    dark = 2000.0 + np.where(rng.random(shape) < hot, rng.exponential(20_000.0, shape), 0.0)
    return dark, 1.0 + 0.01 * rng.normal(size=shape)


@pytest.mark.parametrize(
    ("counts_off", "flat_off", "scale", "words"),
    [
        (1.0, 0.0, 1.0, ["counts by -"]),
        (1.0, 1.0, 1.0, ["counts by -", "flat by "]),
        (0.0, 0.0, 0.5, ["counts by 2", "flat by 2"]),
        (0.0, 0.0, 1.0, []),
    ],
)
def test_a_dark_that_is_not_that_of_the_frames_is_said(reduced, counts_off, flat_off, scale, words) -> None:
    """A dark of 0.5 % of the beam, taken off twice, had shifted the fraction by 7 standard deviations without a word."""
    dark, response = camera()
    counts = scene(transmission(), dark=dark, response=response) - counts_off * np.round(dark)
    flat = scene(1.0, dark=dark, seed=2, response=response) - flat_off * np.round(dark)
    _, said = reduced(counts, flat, scene(0.0, dark=scale * dark, seed=3), block_rows=30)
    lines = [line for line in said.splitlines() if "the dark's hot pixels" in line]
    assert len(lines) == len(words)
    for line, word in zip(lines, words, strict=True):
        assert f"stand out of the {word}" in line
        assert "dark = 0 where it is taken off counts and flat alike" in line


def test_the_remedy_for_a_dark_taken_off_already_is_one(reduced) -> None:
    dark, response = camera()
    counts = scene(transmission(), dark=dark, response=response) - np.round(dark)
    flat = scene(1.0, dark=dark, seed=2, response=response) - np.round(dark)
    found, said = reduced(counts, flat, np.zeros((TALL, COLUMNS)), block_rows=30)
    assert "hot pixels" not in said
    assert abs(off(found)) < 2.5


def test_the_share_of_the_dark_has_its_error() -> None:
    scores = []
    for seed in range(60):
        dark, response = camera(seed, hot=0.01)
        rng = np.random.default_rng(seed + 1000)
        image = rng.poisson(3e5 * response) + rng.poisson(0.7 * dark)
        told = dark_share(image.astype(float), dark, np.ones(dark.shape, dtype=bool))
        assert told is not None
        scores.append((told[0] - 0.7) / told[1])
    assert 0.7 < np.std(scores) < 1.4
    assert abs(np.mean(scores)) < 0.6
    even = np.random.default_rng(1).poisson(np.full((TALL, COLUMNS), 2000.0)).astype(float)
    assert dark_share(image.astype(float), even, np.ones(even.shape, dtype=bool)) is None


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"pixel_size": f"{0.5 * PIXEL} m"}, "1.99 times what its solution would, as if pixel_size were half"),
        ({"energy": "10.2 keV"}, "1.06 times what its solution would: it would hold less polymer than its solution"),
        ({"energy": "9 keV"}, "0.729 times what its solution would: it would hold no solvent"),
        ({}, ""),
    ],
)
def test_what_the_jet_absorbs_is_held_against_its_solution(reduced, keys, words) -> None:
    counts, flat = exposures(transmission(), beam=BEAM), exposures(np.ones(COLUMNS), beam=BEAM, seed=2)
    _, said = reduced(counts, flat, exposures(np.zeros(COLUMNS), seed=3), **keys)
    assert ("what its solution would" in said) == bool(words)
    assert f"the jet absorbs {words}" in said or not words


def test_absorbance_to_base_ten_is_named(tmp_path) -> None:
    light = exposures(transmission(), beam=BEAM, dark=0.0) / BEAM
    np.save(tmp_path / "a.npy", -np.log10(light))
    solution = {"polymer": "PEO", "solvent": "water", "mass_fraction": 0.15}
    given = {
        "absorbance": "a.npy",
        "pixel_size": f"{PIXEL} m",
        "energy": "10 keV",
        "block_rows": 12,
        "solution": solution,
    }
    with pytest.warns(SpinlineWarning, match="as of an absorbance to base 10: give ln"):
        reduce_images(images_from_dict(given, folder=tmp_path))


def test_frames_over_their_flat_are_no_counts_however_many(reduced) -> None:
    """Had been refused for want of photons: 7200 times as many."""
    counts, flat = exposures(transmission()) / 4e4, exposures(np.ones(COLUMNS), seed=2) / 4e4
    with pytest.raises(InputError, match=r"are no counts: at most 2, and not whole.*name them transmission"):
        reduced(counts, flat, exposures(np.zeros(COLUMNS), seed=3) / 4e4)


def test_frames_rounded_to_8_bits_are_said_to_be(reduced) -> None:
    """Had been told to give flat_frames = 4284406434282577097969827119104, or that the counts make 1e37 photons."""
    frames = [
        np.round(255.0 * exposures(s, beam=BEAM, seed=i) / 4.2e5).astype(np.uint8)
        for i, s in enumerate((transmission(), np.ones(COLUMNS), np.zeros(COLUMNS)))
    ]
    _, said = reduced(*frames, gain=1647.0)
    assert "the flats hardly scatter" in said
    assert "flat_frames" not in said
    with pytest.raises(InputError, match=r"most of their pixels do not scatter at all.*rounded \(to 8 bits\?\)"):
        reduced(*frames, gain=None)


def test_a_bend_of_the_beam_that_is_not_sure_is_said(reduced) -> None:
    """At 4 standard deviations of the bend the fraction was off by 8 of its own, without a word."""
    bend = 1.0 - 2.4e-4 * np.polynomial.legendre.legval(np.linspace(-1, 1, COLUMNS), [0, 0, 1])
    counts = exposures(transmission() * bend, beam=BEAM, frames=16)
    flat = exposures(np.ones(COLUMNS), beam=BEAM, seed=20, frames=8)
    found, said = reduced(counts, flat, exposures(np.zeros(COLUMNS), seed=3))
    assert off(found) > 3.0
    assert "the beam's shape may have changed since the flat" in said
    assert "flat_shape = 2 fits it" in said
    found, said = reduced(counts, flat, exposures(np.zeros(COLUMNS), seed=3), flat_shape=2)
    assert abs(off(found)) < 2.5
    assert "may have changed" not in said


def stripes(moved: float) -> np.ndarray:
    """A beam with stripes of a few per cent, as a multilayer makes them, moved to the right."""
    rough = np.convolve(np.random.default_rng(7).normal(size=COLUMNS + 40), np.ones(5) / 5.0, "same")
    return np.interp(20.0 + np.arange(COLUMNS) - moved, np.arange(COLUMNS + 40), 1.0 + 0.066 * rough)


def slit(moved: float, edge: float = 1.5) -> np.ndarray:
    at = np.arange(COLUMNS) - moved
    return 1.0 / (1.0 + np.exp((8.0 - at) / edge)) / (1.0 + np.exp((at - 132.0) / edge)) + 1e-4


@pytest.mark.parametrize(("beam", "moved"), [(stripes, 0.5), (stripes, -1.0), (slit, 0.5), (slit, 2.0)])
def test_a_beam_that_moved_since_the_flat_is_named(reduced, beam, moved) -> None:
    """Had been Fresnel fringes of 20 to 300 standard deviations, with phase as the remedy, or no jet."""
    counts, flat = exposures(transmission() * beam(moved), beam=BEAM), exposures(beam(0.0), beam=BEAM, seed=2)
    words = rf"structure \(stripes, the edge of a slit\) moved by \{moved:+.1f}"[:-2]
    with pytest.raises(InputError, match=words):
        reduced(counts, flat, exposures(np.zeros(COLUMNS), seed=3))
    same = exposures(beam(moved), beam=BEAM, seed=2)
    found, said = reduced(counts, same, exposures(np.zeros(COLUMNS), seed=3))
    assert "structure" not in said
    assert abs(off(found)) < 2.5


@pytest.mark.parametrize("beam", [30.0, 4e3, 4e6])
def test_a_beam_that_stays_has_not_moved(beam) -> None:
    """Even and striped beams, pixels of their own sensitivity, noise of flats, jets deep and shallow."""
    for seed in range(4):
        rng = np.random.default_rng(seed)
        shape = (stripes(0.0) if seed % 2 else 1.0) * (1.0 + 0.02 * rng.normal(size=(40, COLUMNS)))
        for depth in (1.0, 10.0, 60.0):
            flat = rng.poisson(beam * shape, (40, COLUMNS)) + 1e-9
            counts = rng.poisson(beam * shape * transmission(3.0) ** depth)
            assert moved_beam(counts / flat, flat, flat > 0.5) is None


@pytest.mark.parametrize("moved", [0.6, -0.8, 1.5])
def test_the_shift_is_that_of_the_beam(moved) -> None:
    from scipy.ndimage import gaussian_filter, shift

    rng = np.random.default_rng(3)
    rough = gaussian_filter(rng.normal(size=(100, COLUMNS)), 2.0)
    shape = 1.0 + 0.03 * rough / rough.std()
    for axis in (0, 1):
        by = np.eye(2)[axis] * moved
        flat = rng.poisson(BEAM * shape).astype(float)
        counts = rng.poisson(BEAM * shift(shape, by, mode="nearest") * transmission())
        found = moved_beam(counts / flat, flat, np.ones(flat.shape, dtype=bool))
        assert found is not None
        assert (found.down, found.across)[axis] == pytest.approx(moved, abs=0.15)
        assert (found.across, found.down)[axis] == 0.0
