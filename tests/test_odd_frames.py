"""Frames that do not belong among the others: flats among counts, jets among flats; jets that move or change."""

import numpy as np
import pytest

from spinline.base.errors import InputError, SpinlineWarning
from spinline.images.frames import open_stack, sample_frames, sum_frames
from spinline.images.odd_frames import light_of, with_jet, without_light, without_shadow
from spinline.radiography.reduce import reduce_images
from spinline.scene.images_file import images_from_dict
from spinline.xray.frame import strips
from spinline.xray.frame.shadows import Shadows, shadows_of
from spinline.xray.matter.solution import solution_absorber

ROWS, COLUMNS, PIXEL, RADIUS, FRACTION = 24, 140, 0.67e-6, 30e-6, 0.15


def transmission(moved: float = 0.0, radius: float = RADIUS, depth: float | None = None) -> np.ndarray:
    """Of a round jet, as wide as a pixel is finely: the chord's mean over each pixel."""
    law = solution_absorber("PEO", "water", 10.0)
    x = PIXEL * ((np.arange(8 * COLUMNS) + 0.5) / 8.0 - 0.5 * COLUMNS - moved)
    chord = 2.0 * np.sqrt(np.clip(radius**2 - x**2, 0.0, None))
    mu = law.solvent + FRACTION * law.contrast - law.air if depth is None else depth / (2.0 * RADIUS)
    return np.exp(-mu * chord).reshape(COLUMNS, 8).mean(axis=1)


def exposures(shape, beam=40_000.0, dark=100.0, seed=1, frames=8) -> np.ndarray:
    """Frames of the light `shape`, one or one a frame."""
    rng = np.random.default_rng(seed)
    mean = np.broadcast_to(np.reshape(shape, (-1, 1, COLUMNS)), (frames, ROWS, COLUMNS))
    return (rng.poisson(beam * mean) + rng.poisson(dark, mean.shape)).astype(np.uint32)


@pytest.fixture
def reduced(tmp_path):
    def reduce(counts, flat, dark, **keys):
        np.savez(tmp_path / "a.npz", counts=counts, flat=flat, dark=dark)
        given = {
            "counts": "a.npz",
            "flat": "a.npz",
            "dark": "a.npz",
            "gain": 1.0,
            "pixel_size": f"{PIXEL} m",
            "energy": "10 keV",
            "block_rows": 12,
            "shells": 1,
            "solution": {"polymer": "PEO", "solvent": "water", "mass_fraction": 0.15},
        }
        with pytest.warns(SpinlineWarning):
            result = reduce_images(images_from_dict(given | keys, folder=tmp_path))
        return result, str(result.attrs["warnings"])

    return reduce


def summed(tmp_path, frames, key="counts"):
    np.save(tmp_path / f"{key}.npy", frames)
    stack = open_stack(f"{key}.npy", key, tmp_path)
    return stack, sum_frames(stack)


def shadows(stack, total, beam: float, dark: float) -> Shadows:
    bands = stack.bands
    even = np.full((len(bands.starts), bands.bins), beam)
    seen = shadows_of(*light_of(bands, total, np.full((ROWS, COLUMNS), dark), even, 1.0))
    assert seen is not None
    return seen


@pytest.mark.parametrize("which", [(3,), (0, 7), (2, 3, 4, 5, 6)])
def test_flats_among_the_counts_are_left_out(reduced, which) -> None:
    """One of eight had given 0.60 for a fraction of 0.15, three 1.54, without a word of the frames."""
    counts, flat = exposures(transmission()), exposures(1.0 + np.zeros(COLUMNS), seed=2)
    mixed = counts.copy()
    mixed[list(which)] = exposures(1.0 + np.zeros(COLUMNS), seed=4)[list(which)]
    dark = exposures(np.zeros(COLUMNS), seed=3)
    found, said = reduced(mixed, flat, dark)
    rest, _ = reduced(np.delete(counts, which, axis=0), flat, dark)
    assert f"{len(which)} of 8 frames show no jet where the others do" in said
    assert f"are left out: {', '.join(map(str, which))}" in said
    np.testing.assert_array_equal(found["mean_polymer_fraction"], rest["mean_polymer_fraction"])
    off = (found["mean_polymer_fraction"] - FRACTION) / found["mean_polymer_fraction_std"]
    assert float(np.abs(off.mean())) < 2.0


@pytest.mark.parametrize("which", [(4,), (1, 2, 5)])
def test_jets_among_the_flats_are_left_out(reduced, which) -> None:
    """One of eight had given 0.59 for a fraction of 0.15."""
    counts, flat = exposures(transmission()), exposures(1.0 + np.zeros(COLUMNS), seed=2)
    mixed = flat.copy()
    mixed[list(which)] = exposures(transmission(), seed=4)[list(which)]
    dark = exposures(np.zeros(COLUMNS), seed=3)
    found, said = reduced(counts, mixed, dark)
    rest, _ = reduced(counts, np.delete(flat, which, axis=0), dark)
    assert f"flat: {len(which)} of 8 frames show the jet and are left out: {', '.join(map(str, which))}" in said
    np.testing.assert_array_equal(found["mean_polymer_fraction"], rest["mean_polymer_fraction"])


@pytest.mark.parametrize("gone", [0, 1])
def test_of_two_frames_one_without_the_jet_is_left_out(reduced, gone) -> None:
    """Had given 2.02 for a fraction of 0.15: against one another, a jet and no jet look alike."""
    counts, flat = exposures(transmission(), frames=2), exposures(np.ones(COLUMNS), seed=2)
    counts[gone] = flat[gone]
    found, said = reduced(counts, flat, exposures(np.zeros(COLUMNS), seed=3))
    assert (
        f"1 of 2 frames show no jet where the others do (flats among them, or a jet that comes and goes) and are left out: {gone}"
        in said
    )
    off = (found["mean_polymer_fraction"] - FRACTION) / found["mean_polymer_fraction_std"]
    assert float(np.abs(off.mean())) < 2.0


@pytest.mark.parametrize("moved", [10.0, 20.0])
def test_a_beam_that_moves_is_no_jet_that_is_gone(tmp_path, moved) -> None:
    """A Gaussian beam that jumps by 20 pixels: half of the frames had been left out."""
    at = np.arange(COLUMNS) - 0.5 * COLUMNS
    beams = [np.exp(-((at - moved * (i > 7)) ** 2) / 2.0 / 80.0**2) for i in range(16)]
    flat = np.broadcast_to(4e5 * beams[0], (ROWS, COLUMNS)).copy()
    dark = np.full((ROWS, COLUMNS), 100.0)
    stack, total = summed(tmp_path, exposures([beam * transmission() for beam in beams], beam=4e5, frames=16))
    same, said = with_jet(stack, total, dark, flat, 1.0)
    assert (same.odd, said) == ((), [])


def test_a_beam_that_moves_is_no_jet_among_the_flats(tmp_path) -> None:
    """One flat of eight, the one that had moved most, had been left out as one with the jet."""
    rng = np.random.default_rng(9)
    at = np.arange(COLUMNS) - 0.5 * COLUMNS
    dark = np.full((ROWS, COLUMNS), 100.0)
    for seed in range(12):
        beams = [np.exp(-((at - m) ** 2) / 2.0 / 80.0**2) for m in 5.0 * rng.normal(size=8)]
        jets, _ = summed(tmp_path, exposures([beam * transmission() for beam in beams], beam=4e5, seed=seed))
        stack, total = summed(tmp_path, exposures(beams, beam=4e5, seed=seed + 20), "flat")
        same, said = without_shadow(stack, total, dark, sample_frames(jets, 16), 1.0)
        assert (same.odd, said) == ((), [])


@pytest.mark.parametrize(("moved", "flats"), [(23.0, ()), (25.0, ()), (20.0, (4,))])
def test_a_jet_with_air_on_one_side_is_steady(tmp_path, moved, flats) -> None:
    """The noise of the level by few pixels of air, and flats that are left out, had been taken for shadows that differ by 11 to 38 %."""
    shapes = [np.ones(COLUMNS) if i in flats else transmission(moved) for i in range(8)]
    stack, total = summed(tmp_path, exposures(shapes, beam=4e5))
    same, said = with_jet(stack, total, np.full((ROWS, COLUMNS), 100.0), np.full((ROWS, COLUMNS), 4e5), 1.0)
    assert same.odd == flats
    assert [line for line in said if "shadows that differ" in line] == []


def test_every_frame_on_its_own_is_left_alone(reduced) -> None:
    counts, flat = exposures(transmission(), beam=4e5), exposures(1.0 + np.zeros(COLUMNS), beam=4e5, seed=2)
    counts[3] = flat[3]
    found, said = reduced(counts, flat, exposures(np.zeros(COLUMNS), seed=3), frames="each")
    seen = np.isfinite(found["mean_polymer_fraction"]).any("row").values
    assert seen.sum() >= 7
    assert "show no jet" not in said


def test_a_jet_that_moves_or_changes_is_said(tmp_path) -> None:
    flat = np.full((ROWS, COLUMNS), 40_000.0)
    dark = np.full((ROWS, COLUMNS), 100.0)
    still = [transmission()] * 8
    moving = [transmission(moved) for moved in (0, 3, 6, 9, 12, 15, 18, 21)]
    beads = [transmission(radius=RADIUS * (1.6 if i == 3 else 1.0)) for i in range(8)]
    for shapes, words in ((still, []), (moving, ["moves by 6.9 pixels"]), (beads, ["shadows that differ by"])):
        stack, total = summed(tmp_path, exposures(shapes))
        same, said = with_jet(stack, total, dark, flat, 1.0)
        assert same.odd == ()
        assert len(said) == len(words)
        assert all(word in line for word, line in zip(words, said, strict=True)), said


def test_shifts_and_depths_are_those_of_the_frames(tmp_path) -> None:
    moved = np.array([0.0, 4.0, -7.5, 2.0, 1.0, -3.0])
    shapes = [1.0 - share * (1.0 - transmission(m)) for m, share in zip(moved, (1, 1, 0.5, 1, 1, 1), strict=True)]
    stack, total = summed(tmp_path, exposures(shapes, beam=4e6, frames=6))
    seen = shadows(stack, total, 4e6, 100.0)
    assert seen.shift - seen.shift.mean() == pytest.approx(moved - moved.mean(), abs=0.7)
    assert seen.depth[2] / seen.depth[[0, 1, 3, 4, 5]].mean() == pytest.approx(0.5, abs=0.05)
    assert seen.radius == pytest.approx(RADIUS / PIXEL, rel=0.1)


def test_errors_of_the_depth_are_its_scatter(tmp_path) -> None:
    found = []
    for seed in range(12):
        shapes = [transmission(depth=0.3)] * 24
        stack, total = summed(tmp_path, exposures(shapes, beam=60.0, dark=40.0, seed=seed, frames=24))
        seen = shadows(stack, total, 60.0, 40.0)
        found.append(float(np.std(seen.depth) / np.median(seen.depth_std)))
    assert np.mean(found) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize("beam", [1.0, 5.0, 50.0, 1e3, 1e5])
@pytest.mark.parametrize("dark", [0.0, 500.0])
def test_noise_is_no_odd_frame(tmp_path, beam, dark) -> None:
    """Steady jets from hardly seen to black, few frames and many: nothing is left out, nothing said."""
    below, even = np.full((ROWS, COLUMNS), dark), np.full((ROWS, COLUMNS), beam)
    for seed, (depth, frames) in enumerate((d, n) for d in (1e-3, 0.02, 0.2, 1.5, 8.0) for n in (2, 4, 30)):
        stack, total = summed(tmp_path, exposures(transmission(depth=depth), beam, dark, seed, frames))
        same, said = with_jet(stack, total, below, even, 1.0)
        assert (same.odd, said) == ((), []), (depth, frames)
        flats = exposures(np.ones(COLUMNS), beam, dark, seed + 100, frames)
        of_flats, sum_of_flats = summed(tmp_path, flats, "flat")
        same, said = without_shadow(of_flats, sum_of_flats, below, sample_frames(stack, 16), 1.0)
        assert (same.odd, said) == ((), []), (depth, frames)


def test_too_many_frames_to_look_at_each_are_refused_with_what_to_do(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(strips, "_FRAMES", 10)
    counts = exposures(transmission(), frames=30)
    counts[::9] = exposures(np.ones(COLUMNS), seed=5)[0]
    stack, total = summed(tmp_path, counts)
    assert total.kept == tuple(range(0, 30, 3))
    with pytest.raises(InputError, match=r'4 of 30 frames show no jet.*of 10 .*looked at.*frames = "each"'):
        with_jet(stack, total, np.full((ROWS, COLUMNS), 100.0), np.full((ROWS, COLUMNS), 4e4), 1.0)


def test_flats_and_darks_that_were_not_all_looked_at_are_refused_too(tmp_path, monkeypatch) -> None:
    """Of 4,096 darks half would have been left out, and the other half not, without a word."""
    monkeypatch.setattr(strips, "_FRAMES", 10)
    below = np.full((ROWS, COLUMNS), 100.0)
    jet, _ = summed(tmp_path, exposures(transmission(), frames=4))
    flats = exposures(np.ones(COLUMNS), seed=2, frames=30)
    flats[::9] = exposures(transmission(), seed=5)[0]
    stack, total = summed(tmp_path, flats, "flat")
    with pytest.raises(InputError, match=r"flat = .frames 0, 9, 18, 27.: 4 of 30 frames show the jet, of 10"):
        without_shadow(stack, total, below, sample_frames(jet, 16), 1.0)
    darks = exposures(np.zeros(COLUMNS), seed=3, frames=30)
    darks[3] = flats[1]
    with pytest.raises(InputError, match=r"dark = .frames 3.: 1 of 30 frames are far brighter.*of 10"):
        without_light(*summed(tmp_path, darks, "dark"))


def test_strips_of_a_sum_that_goes_on_are_those_of_one_go(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("spinline.images.stacks._AT_ONCE", ROWS * COLUMNS * 4 * 3)
    counts = exposures(transmission(), frames=10)
    counts[4] = 7  # dropped
    np.save(tmp_path / "c.npy", counts)
    stack = open_stack("c.npy", "counts", tmp_path)
    copies = []

    def pause(so_far) -> None:
        copies.append((so_far.kept, so_far.strips.copy(), so_far.total.copy(), so_far.exposures.copy(), so_far))

    whole = sum_frames(stack, pause=pause)
    assert whole.kept == (0, 1, 2, 3, 5, 6, 7, 8, 9)
    kept, found, total, seen, first = copies[1]
    from dataclasses import replace

    again = sum_frames(stack, begun=replace(first, kept=kept, strips=found, total=total, exposures=seen))
    assert again.kept == whole.kept
    np.testing.assert_array_equal(again.strips, whole.strips)
    rows = counts[[0, 9], :8].astype(float).mean(axis=1)
    np.testing.assert_allclose(whole.strips[[0, -1], 0], rows, rtol=1e-7)


def test_another_exposure_than_the_flats_is_said(reduced) -> None:
    """Counts over four, flat and dark as they were, had given 0.013 for 0.15 with no word of the scale."""
    counts, flat = exposures(transmission()), exposures(1.0 + np.zeros(COLUMNS), seed=2)
    dark = exposures(np.zeros(COLUMNS), seed=3)
    _, said = reduced(np.round(counts / 4.0), flat, dark)
    assert "beside the jet the counts are 0.248 of the flat" in said
    _, said = reduced(counts, flat, dark)
    assert "of the flat:" not in said
