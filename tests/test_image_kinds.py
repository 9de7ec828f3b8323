"""Kinds of loss in frames, beyond the files given for each: other types, marks, orders of bytes, keys and layouts.

Every one must give the number of frames without the loss, within its error, or one refusal that names it.
"""

import gzip

import h5py
import numpy as np
import pytest
import tifffile

from spinline.base.errors import InputError
from spinline.images.noise import pair_noise
from spinline.images.stacks import open_stack
from spinline.images.sums import sum_frames
from spinline.radiography.reduce import reduce_images

pytestmark = pytest.mark.usefixtures("quiet")
PATCH = (slice(None), slice(8, 12), slice(40, 44))
BEFORE = []  # of frames without a loss, the same in every test


@pytest.fixture
def reduced(frames_of):
    """Reduce frames, flats or darks that were changed; and as they were."""

    def run(key, change):
        images, arrays = frames_of(photons=2e4, count=6, flats=10, offset=300.0, block_rows=24)
        arrays["dark"] = np.random.default_rng(5).poisson(300.0, (6, *arrays["dark"].shape)).astype(np.float64)
        if not BEFORE:
            np.savez(images.folder / "a.npz", **arrays)
            BEFORE.append(reduce_images(images))
        np.savez(images.folder / "a.npz", **{**arrays, key: change(arrays[key].copy())})
        return reduce_images(images), BEFORE[0]

    return run


def close(result, before) -> bool:
    """Within a standard deviation: the frames are the same but for what was lost."""
    off = float(abs(result["mean_polymer_fraction"] - before["mean_polymer_fraction"]).max())
    wider = float((result["mean_polymer_fraction_std"] / before["mean_polymer_fraction_std"]).max())
    return off < float(result["mean_polymer_fraction_std"].max()) and wider < 1.3


@pytest.mark.parametrize(
    ("key", "kind", "mark"),
    [
        ("counts", "u4", 2**32 - 2),
        ("counts", "u4", 65535),
        ("counts", ">u2", 65534),
        ("counts", "f4", 2.0**32 - 1),
        ("counts", "f8", 9.969209968386869e36),
        ("counts", "i4", 2**31 - 2),
        ("counts", "u2", 0),
        ("flat", "u4", 2**32 - 2),
        ("flat", "f4", 65535.0),
        ("flat", "i4", -2),
    ],
)
def test_marks_of_one_type_in_another_are_masked(reduced, key, kind, mark) -> None:
    def patch(frames):
        frames = frames.astype(kind)
        frames[PATCH] = mark
        return frames

    result, before = reduced(key, patch)
    assert close(result, before)
    if key == "counts":
        assert result.attrs["invalid_pixels"] == 16


@pytest.mark.parametrize(("kind", "mark"), [("u4", 2**32 - 1), ("f4", -1.0), ("i4", -2)])
def test_marks_in_some_frames_lose_those_alone(reduced, kind, mark) -> None:
    def patch(frames):
        frames = frames.astype(kind)
        frames[:2, 8:12, 40:44] = mark
        return frames

    result, before = reduced("counts", patch)
    assert close(result, before)
    assert result.attrs["invalid_pixels"] == 0


@pytest.mark.parametrize("value", [0.0, 65535.0])
def test_dropped_darks_are_no_dark(reduced, value) -> None:
    """Two of six at 0 would make the dark 200 for 300, and the fraction 0.01 too large."""

    def drop(frames):
        frames[[1, 4]] = value
        return frames

    result, before = reduced("dark", drop)
    assert close(result, before)
    assert "dark: 2 of 6 frames hold one number throughout (dropped frames)" in result.attrs["warnings"]


def test_a_part_of_a_frame_that_was_lost(reduced) -> None:
    def lose(frames):
        frames[3, 4:20, 30:] = 0.0
        return frames

    result, before = reduced("counts", lose)
    assert close(result, before)
    assert "or patches of zeros, which are left out: 3" in result.attrs["warnings"]


def test_noise_about_a_dark_that_was_taken_off_is_kept(tmp_path) -> None:
    """Whole numbers below 0 that are noise: a mean without them would be 4 counts too high."""
    frames = np.random.default_rng(8).normal(2.0, 12.0, (40, 20, 60)).round().astype(np.int32)
    frames[:, :, 30:] += 400
    np.save(tmp_path / "a.npy", frames)
    total = sum_frames(open_stack("a.npy", "counts", tmp_path))
    assert np.array_equal(total.total, frames.sum(axis=0))


@pytest.mark.parametrize("loss", ["lost", "copied", "marked"])
def test_the_gain_is_told_by_what_was_measured(tmp_path, loss) -> None:
    flats = np.random.default_rng(9).poisson(6000.0, (10, 40, 90)).astype(np.uint32) + 300
    if loss == "lost":
        flats = np.concatenate([flats, np.zeros_like(flats[:6])])
    elif loss == "copied":
        flats = np.repeat(flats, 2, axis=0)
    else:
        flats[:, 5:25, 40:50] = 2**32 - 1
    np.save(tmp_path / "flat.npy", flats)
    dark = np.random.default_rng(1).normal(300.0, 5.0, flats.shape[1:])
    noise = pair_noise(open_stack("flat.npy", "flat", tmp_path), dark=dark)
    assert noise is not None
    assert noise.level / noise.power == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / noise.samples))


FRAMES = np.random.default_rng(2).integers(10, 99, (12, 6, 20)).astype(np.uint16)


def virtual(folder, name, parts, ways):
    """A virtual dataset of parts, each a file, laid out where `ways` says."""
    layout = h5py.VirtualLayout(FRAMES.shape, np.uint16)
    for i, (part, way) in enumerate(zip(parts, ways, strict=True)):
        with h5py.File(folder / f"s{i}.h5", "w") as file:
            file["counts"] = part
        layout[way] = h5py.VirtualSource(f"s{i}.h5", "counts", part.shape)
    with h5py.File(folder / name, "w") as file:
        file.create_virtual_dataset("counts", layout, fillvalue=0)


@pytest.mark.parametrize("way", ["interleaved", "tiled", "linked"])
def test_virtual_datasets_of_other_layouts(tmp_path, way) -> None:
    ways = {
        "interleaved": [np.s_[0::2], np.s_[1::2]],
        "tiled": [np.s_[:, :, :10], np.s_[:, :, 10:]],
        "linked": [np.s_[:4], np.s_[4:]],
    }[way]
    folder = tmp_path / "raw"
    folder.mkdir()
    virtual(folder, "v.h5", [FRAMES[w] for w in ways], ways)
    with h5py.File(tmp_path / "m.h5", "w") as file:  # sources are beside what the link leads to
        file["entry/counts"] = h5py.ExternalLink("raw/v.h5", "/counts")
    source = "m.h5" if way == "linked" else "raw/v.h5"
    assert np.array_equal(open_stack(source, "counts", tmp_path).read(0, 12), FRAMES)


@pytest.mark.parametrize("left", [0, 900])
def test_a_source_cut_short_is_named(tmp_path, left) -> None:
    virtual(tmp_path, "v.h5", [FRAMES[:4], FRAMES[4:]], [np.s_[:4], np.s_[4:]])
    (tmp_path / "s1.h5").write_bytes((tmp_path / "s1.h5").read_bytes()[:left])
    with pytest.raises(InputError, match=r"v\.h5 -> s1\.h5.*damaged or cut short; copy s1\.h5 again"):
        open_stack("v.h5", "counts", tmp_path)


def test_numbered_datasets_of_two_shapes_are_refused(tmp_path) -> None:
    with h5py.File(tmp_path / "m.h5", "w") as file:
        file["entry/data/data_1"], file["entry/data/data_2"] = FRAMES[:6], FRAMES[6:]
        file["entry/data/data_3"] = FRAMES[:, :, :10]
    for source in ("m.h5", "m.h5:/entry/data"):
        with pytest.raises(InputError, match="datasets of different frames"):
            open_stack(source, "counts", tmp_path)


def test_links_in_a_ring_and_to_a_group(tmp_path) -> None:
    with h5py.File(tmp_path / "m.h5", "w") as file:
        file["a"], file["b"] = h5py.SoftLink("/b"), h5py.SoftLink("/a")
        file["detector/data"] = FRAMES
        file["jet"] = h5py.SoftLink("/detector")
    assert open_stack("m.h5:/jet", "counts", tmp_path).frames == 12
    with pytest.raises(InputError, match=r"/a -> /b.*leads nowhere"):
        open_stack("m.h5:/a", "counts", tmp_path)


@pytest.mark.parametrize(
    ("attributes", "raw"),
    [
        ({"_Unsigned": "true"}, (FRAMES * 600).view(np.int16)),
        ({"_Unsigned": "true", "_FillValue": np.int16(-1)}, (FRAMES * 600).view(np.int16)),
        ({"scale_factor": np.array([600.0], ">f4")}, FRAMES.astype(">i4")),
        ({"scale_factor": "600"}, FRAMES),
        ({"scale_factor": -1.0, "add_offset": 65535.0}, 65535 - FRAMES * 600),
        ({"missing_value": np.array([7, 65000], np.uint16)}, FRAMES * 600),
        ({"valid_range": np.array([0, 60000], np.uint16)}, FRAMES * 600),
        ({"valid_max": np.uint16(60000)}, FRAMES * 600),
    ],
)
def test_packing_by_other_attributes(tmp_path, attributes, raw) -> None:
    raw = raw.copy()
    lossy = {"missing_value", "valid_range", "valid_max", "_FillValue"} & set(attributes)
    if lossy:
        raw[:, 2, 3] = -1 if "_FillValue" in attributes else 65000
    with h5py.File(tmp_path / "a.nc", "w") as file:
        file["counts"] = raw
        file["counts"].attrs.update(attributes)
    read = open_stack("a.nc", "counts", tmp_path).read(0, 12)
    truth = FRAMES * 600.0
    truth[:, 2, 3] = np.nan if lossy else truth[:, 2, 3]
    assert np.array_equal(read, truth, equal_nan=True)


@pytest.mark.parametrize("scale", ["a quarter", np.nan, 0.0])
def test_packing_that_says_nothing_is_refused(tmp_path, scale) -> None:
    with h5py.File(tmp_path / "a.nc", "w") as file:
        file["counts"] = FRAMES
        file["counts"].attrs["scale_factor"] = scale
    with pytest.raises(InputError, match=r"scale_factor.*mend or remove"):
        open_stack("a.nc", "counts", tmp_path)


def test_names_with_other_digits_and_gaps(tmp_path) -> None:
    for name in ("f_2.tif", "f_1.tif", "f_4.tif", "f_5.tif", "x²_10.tif", "x²_9.tif"):
        tifffile.imwrite(tmp_path / name, FRAMES[0])
    stack = open_stack("x*.tif", "counts", tmp_path)
    assert [stack.source(i) for i in range(2)] == ["x²_9.tif", "x²_10.tif"]
    assert stack.account.remarks == ()
    (said,) = open_stack("f_*.tif", "counts", tmp_path).account.remarks
    assert said == "counts: names of the files count from 1 to 5, and 1 are not there, the first 3"


def test_pages_of_two_types_are_told_apart(tmp_path) -> None:
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        for i, frame in enumerate(FRAMES):
            file.write(frame if i < 8 else frame.astype(np.uint32), contiguous=False, photometric="minisblack")
    stack = open_stack("a.tif", "counts", tmp_path)
    assert stack.frames == 8
    assert stack.account.remarks == ("a.tif holds 4 more pages of shape 6 x 20, uint32: not read",)


def test_compressed_files_are_refused_by_name_and_masks_may_be_true_and_false(tmp_path) -> None:
    tifffile.imwrite(tmp_path / "a.tif", FRAMES)
    (tmp_path / "a.tif.gz").write_bytes(gzip.compress((tmp_path / "a.tif").read_bytes()))
    with pytest.raises(InputError, match="it is compressed: unpack it"):
        open_stack("a.tif.gz", "counts", tmp_path)
    (tmp_path / "b.nc").write_bytes(b"CDF\x05" + bytes(100))
    with pytest.raises(InputError, match=r"CDF-5.*nccopy -k nc4"):
        open_stack("b.nc", "counts", tmp_path)
    np.save(tmp_path / "mask.npy", FRAMES[0] > 50)
    assert np.array_equal(open_stack("mask.npy", "bad_pixels", tmp_path).read(0, 1)[0], FRAMES[0] > 50)
    with pytest.raises(InputError, match="no real numbers"):
        open_stack("mask.npy", "counts", tmp_path)
