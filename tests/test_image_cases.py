"""Frames as acquisition leaves them: every kind of loss that public reports describe, told or refused by name.

Copies of the files that stand for a kind are in ``data/images`` (provenance there); the others are made here.
"""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from spinline.base.errors import InputError
from spinline.images.stacks import open_stack
from spinline.images.sums import sample_frames, sum_frames
from spinline.radiography.reduce import reduce_images

DATA = Path(__file__).parent / "data" / "images"
pytestmark = pytest.mark.usefixtures("quiet")


def reduced(frames_of, change, **keys):
    """A reduction of frames that were changed, and that of the frames as they were."""
    images, arrays = frames_of(photons=4e4, count=12, flats=30, block_rows=24, **keys)
    before = reduce_images(images)
    np.savez(images.folder / "a.npz", **{**arrays, "counts": change(arrays["counts"].copy())})
    return reduce_images(images), before


def close(result, before) -> bool:
    """Within four standard deviations, with errors that say fewer frames."""
    off = float(abs(result["mean_polymer_fraction"] - before["mean_polymer_fraction"]).max())
    return off < 4 * float(result["mean_polymer_fraction_std"].max())


@pytest.mark.parametrize("value", [0.0, 65535.0, 7.0, np.nan])
def test_dropped_frames_are_left_out_and_counted(frames_of, value) -> None:
    def drop(counts):
        counts[[3, 7]] = value
        return counts

    result, before = reduced(frames_of, drop)
    assert close(result, before)
    assert result.attrs["frames"] == 10
    assert result.attrs["frames_read"] == "10 of 12 frames of a.npz:counts"
    assert (
        "2 of 12 frames hold one number throughout (dropped frames) and are left out: 3, 7" in result.attrs["warnings"]
    )


def test_torn_frames_lose_their_rows_alone(frames_of) -> None:
    def tear(counts):
        counts[5, 10:] = 0.0
        return counts

    result, before = reduced(frames_of, tear)
    assert close(result, before)
    assert "1 of 12 frames have rows of one number throughout (torn frames)" in result.attrs["warnings"]


def test_a_copied_frame_counts_once(frames_of) -> None:
    def copy(counts):
        counts[4] = counts[3]
        return counts

    result, before = reduced(frames_of, copy)
    assert close(result, before)
    assert result.attrs["frames"] == 11
    assert "are copies of the frame before and are left out: 4" in result.attrs["warnings"]


def test_all_frames_lost_is_refused(frames_of) -> None:
    images, arrays = frames_of(photons=4e4, count=3, block_rows=24)
    np.savez(images.folder / "a.npz", **{**arrays, "counts": np.zeros_like(arrays["counts"])})
    with pytest.raises(InputError, match=r"no signal is left|holds no frame"):
        reduce_images(images)


def test_few_photons_are_no_lost_rows(frames_of) -> None:
    """Rows of zeros are data where there are a few photons in a frame."""
    images, arrays = frames_of(photons=0.02, count=400, offset=0.0, block_rows=24)
    total = sum_frames(open_stack("a.npz", "counts", images.folder))
    assert np.array_equal(total.total, arrays["counts"].sum(axis=0))
    assert total.lost == total.torn == total.copies == ()


@pytest.mark.parametrize("mark", [-1, -2])
def test_negative_marks_are_masked(frames_of, mark) -> None:
    def patch(counts):
        counts = counts.astype(np.int32)
        counts[:, 8:12, 40:44] = mark
        return counts

    result, before = reduced(frames_of, patch)
    assert close(result, before)
    assert result.attrs["invalid_pixels"] == 16
    assert "16 pixels are marked as invalid" in result.attrs["warnings"]


@pytest.mark.parametrize("kind", [np.uint32, np.uint16, np.int32])
def test_the_highest_number_of_a_type_is_a_mark_where_it_stands_alone(frames_of, kind) -> None:
    def patch(counts):
        counts = np.minimum(counts, 60000).astype(kind)
        counts[:, 8:12, 40:44] = np.iinfo(kind).max
        return counts

    images, arrays = frames_of(photons=2e4, count=12, flats=30, block_rows=24)
    before = reduce_images(images)
    np.savez(images.folder / "a.npz", **{**arrays, "counts": patch(arrays["counts"].copy())})
    result = reduce_images(images)
    assert close(result, before)
    assert result.attrs["invalid_pixels"] == 16
    assert result.attrs["saturated_pixels"] == 0


def test_a_clipped_beam_is_saturation_and_no_mark(frames_of) -> None:
    images, arrays = frames_of(photons=8e4, count=3, block_rows=24)
    np.savez(images.folder / "a.npz", **{**arrays, "counts": np.minimum(arrays["counts"], 65535).astype(np.uint16)})
    with pytest.raises(InputError, match=r"saturated|one number throughout"):
        reduce_images(images)


@pytest.mark.parametrize(
    ("kind", "value", "frames"),
    [
        (np.uint16, 60_000, 80_000),
        (np.uint8, 255, 70_000),
        (np.uint32, 4_000_000_000, 3000),
        (np.int64, 2**52 // 2000, 2000),
    ],
)
def test_sums_do_not_wrap(tmp_path, kind, value, frames) -> None:
    np.save(tmp_path / "line.npy", np.full((frames, 1, 20), value, kind))
    for total in (sum_frames(open_stack("line.npy", "counts", tmp_path)).total,):
        assert (total == float(value) * frames).all()


def test_numbers_beyond_a_double_are_summed_as_well_as_it_can(tmp_path) -> None:
    np.save(tmp_path / "line.npy", np.full((9, 1, 20), 2**63 + 2**40, np.uint64))
    total = sum_frames(open_stack("line.npy", "counts", tmp_path)).total
    assert total == pytest.approx(9 * (2.0**63 + 2.0**40), rel=1e-15)


def test_pages_appended_one_by_one_are_all_read() -> None:
    stack = open_stack("appended.tif", "counts", DATA)
    assert (stack.frames, stack.rows, stack.columns) == (12, 40, 96)
    assert stack.account.parts == "12 pages"
    assert sum_frames(stack).used == 12


def test_a_preview_among_the_pages_is_no_frame(tmp_path) -> None:
    import tifffile

    frames = np.random.default_rng(1).integers(0, 999, (4, 30, 40)).astype(np.uint16)
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        file.write(frames[0, ::4, ::4], subfiletype=1, photometric="minisblack")
        for frame in frames:
            file.write(frame, photometric="minisblack")
    stack = open_stack("a.tif", "counts", tmp_path)
    assert np.array_equal(stack.read(0, 4), frames)
    assert stack.account.remarks == ("a.tif holds 1 more page of shape 8 x 10: not read",)


def test_planes_of_a_page_are_frames_and_colours_are_not(tmp_path) -> None:
    import tifffile

    assert open_stack("part_0.tif", "counts", DATA).frames == 3
    tifffile.imwrite(tmp_path / "rgb.tif", np.zeros((20, 30, 3), np.uint8), photometric="rgb")
    with pytest.raises(InputError, match="colour image"):
        open_stack("rgb.tif", "counts", tmp_path)


def test_numbers_in_names_are_numbers(tmp_path) -> None:
    for name in ("fr_10.tif", "fr_2.tif"):
        shutil.copy(DATA / name, tmp_path / name)
    stack = open_stack("fr_*.tif", "counts", tmp_path)
    assert [stack.source(i) for i in range(2)] == ["fr_2.tif", "fr_10.tif"]


def test_each_frame_says_where_it_is_from(frames_of) -> None:
    import tifffile

    images, arrays = frames_of(photons=4e6, count=11, block_rows=24, frames="each")
    for i, frame in enumerate(arrays["counts"]):
        tifffile.imwrite(images.folder / f"f_{i}.tif", frame, photometric="minisblack")
    other = images.model_copy(update={"counts": "f_*.tif"})
    other._folder, other._text = images.folder, images.text
    result = reduce_images(other)
    assert result["frame_source"].values.tolist() == [f"f_{i}.tif" for i in range(11)]
    assert np.array_equal(result["frame"].values, np.arange(11))


def test_a_source_that_was_not_copied_is_named() -> None:
    with pytest.raises(InputError, match=r"scan_data_000001\.h5.*copy scan_data_000001\.h5 beside virtual_master\.h5"):
        open_stack("virtual_master.h5:/counts", "counts", DATA)


@pytest.fixture
def virtual(tmp_path):
    """A virtual dataset of three files of four frames: a function that writes it, some of them changed."""
    import h5py

    frames = np.random.default_rng(2).integers(10, 99, (12, 6, 20)).astype(np.uint16)

    def write(lengths=(4, 4, 4), written=(4, 4, 4), name="counts"):
        layout = h5py.VirtualLayout((12, 6, 20), np.uint16)
        for i, (length, done) in enumerate(zip(lengths, written, strict=True)):
            with h5py.File(tmp_path / f"s{i}.h5", "w") as file:
                part = file.create_dataset(name, (length, 6, 20), np.uint16, chunks=(1, 6, 20))
                part[:done] = frames[4 * i : 4 * i + done]
            layout[4 * i : 4 * i + 4] = h5py.VirtualSource(f"s{i}.h5", "counts", (4, 6, 20))
        with h5py.File(tmp_path / "m.h5", "w") as file:
            file.create_virtual_dataset("counts", layout, fillvalue=0)
        return frames

    return write


def test_a_virtual_dataset_is_read_through(tmp_path, virtual) -> None:
    frames = virtual()
    stack = open_stack("m.h5", "counts", tmp_path)
    assert np.array_equal(stack.read(0, 12), frames)
    assert stack.account.missing == ()


def test_a_source_shorter_than_its_master_says_is_named(tmp_path, virtual) -> None:
    virtual((4, 2, 4), (4, 2, 4))
    with pytest.raises(InputError, match=r"s1\.h5:counts, 2 of 4.*holds fewer frames than it says"):
        open_stack("m.h5", "counts", tmp_path)


def test_a_source_that_was_not_written_to_its_end(tmp_path, virtual) -> None:
    frames = virtual(written=(4, 2, 4))
    stack = open_stack("m.h5", "counts", tmp_path)
    assert stack.frames == 10
    assert np.array_equal(stack.read(0, 10), np.delete(frames, [6, 7], axis=0))
    assert stack.account.missing == (6, 7)
    assert "2 of 12 frames were never written" in sum_frames(stack).remarks(stack)[0]


def test_a_dataset_missing_in_a_source_is_named(tmp_path, virtual) -> None:
    virtual(name="other")
    with pytest.raises(InputError, match=r"m\.h5 -> s0\.h5:counts"):
        open_stack("m.h5", "counts", tmp_path)


def test_frames_that_were_allocated_and_not_written() -> None:
    stack = open_stack("allocated.h5:/counts", "counts", DATA)
    assert stack.frames == 12
    assert stack.account.missing == tuple(range(12, 20))
    assert sum_frames(stack).used == sample_frames(stack).used == 12


@pytest.mark.parametrize("chunks", [None, (1, 6, 20), (4, 3, 20)])
def test_nothing_written_at_all_is_refused(tmp_path, chunks) -> None:
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("counts", (8, 6, 20), np.uint16, chunks=chunks, fillvalue=0)
    with pytest.raises(InputError, match="holds no frame that was written"):
        open_stack("a.h5", "counts", tmp_path)


def test_a_frame_half_written_is_left_out(tmp_path) -> None:
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        data = file.create_dataset("counts", (5, 6, 20), np.uint16, chunks=(1, 3, 20))
        data[:3] = 7
        data[3, :3] = 7
    assert open_stack("a.h5", "counts", tmp_path).account.missing == (3, 4)


def test_soft_links_are_followed() -> None:
    for key in ("counts", "flat", "dark"):
        assert open_stack(f"links.h5:/entry/data/{key}", key, DATA).columns == 96
    assert (
        open_stack("links.h5", "counts", DATA).frames
        == open_stack("links.h5:/entry/data/counts", "counts", DATA).frames
    )


def test_external_links_are_followed_and_broken_ones_named(tmp_path) -> None:
    import h5py

    frames = np.arange(240, dtype=np.uint16).reshape(2, 6, 20)
    with h5py.File(tmp_path / "raw.h5", "w") as file:
        file["d/frames"] = frames
    with h5py.File(tmp_path / "m.h5", "w") as file:
        file["e/counts"] = h5py.ExternalLink("raw.h5", "/d/frames")
        file["loop"] = h5py.SoftLink("/")
        file["hard"] = file["e"]
    for source in ("m.h5:/e/counts", "m.h5:e/counts", "m.h5"):
        assert np.array_equal(open_stack(source, "counts", tmp_path).read(0, 2), frames)
    (tmp_path / "raw.h5").unlink()
    for source in ("m.h5:/e/counts", "m.h5"):
        with pytest.raises(InputError, match=r"/e/counts -> raw\.h5:/d/frames.*leads nowhere"):
            open_stack(source, "counts", tmp_path)


def test_eigers_datasets_are_one_stack_in_the_order_of_their_numbers(tmp_path) -> None:
    import h5py

    frames = np.random.default_rng(4).integers(0, 99, (33, 6, 20)).astype(np.uint32)
    with h5py.File(tmp_path / "master.h5", "w") as file:
        for i in (10, 2, 1):
            with h5py.File(tmp_path / f"data_{i}.h5", "w") as part:
                part["entry/data/data"] = frames[3 * i : 3 * i + 3]
            file[f"entry/data/data_{i:0{2 if i > 1 else 1}d}"] = h5py.ExternalLink(f"data_{i}.h5", "/entry/data/data")
    for source in ("master.h5", "master.h5:/entry/data"):
        stack = open_stack(source, "counts", tmp_path)
        assert np.array_equal(stack.read(0, 9), np.concatenate([frames[3:6], frames[6:9], frames[30:33]]))
        assert "3 datasets" in stack.account.parts
    (tmp_path / "data_2.h5").unlink()
    for source in ("master.h5", "master.h5:/entry/data"):
        with pytest.raises(InputError, match=r"data_2\.h5"):
            open_stack(source, "counts", tmp_path)


@pytest.fixture
def nxtomo(tmp_path):
    """An NXtomo file: two darks, three flats, five frames, one flat."""
    import h5py

    frames = np.random.default_rng(5).integers(10, 99, (11, 6, 20)).astype(np.uint16)
    with h5py.File(tmp_path / "t.nxs", "w") as file:
        entry = file.create_group("entry")
        entry["instrument/detector/data"] = frames
        entry["instrument/detector/image_key"] = np.array([2, 2, 1, 1, 1, 0, 0, 0, 0, 0, 1])
        for name, value, unit in (("x_pixel_size", 0.65, "um"), ("distance", 12.0, "cm")):
            entry[f"instrument/detector/{name}"] = value
            entry[f"instrument/detector/{name}"].attrs["units"] = unit
        entry["beam/incident_energy"] = 8.0
        entry["beam/incident_energy"].attrs["units"] = "keV"
    return frames


def test_nxtomo_keeps_jet_flat_and_dark_apart(tmp_path, nxtomo) -> None:
    for key, kept in (("counts", slice(5, 10)), ("dark", slice(0, 2)), ("flat_after", slice(10, 11))):
        stack = open_stack("t.nxs", key, tmp_path)
        assert np.array_equal(stack.read(0, stack.frames), nxtomo[kept])
    flat = open_stack("t.nxs:/entry/instrument/detector/data", "flat", tmp_path)
    assert np.array_equal(flat.read(0, 4), nxtomo[[2, 3, 4, 10]])
    found = flat.account.metadata
    assert found == {
        "energy": pytest.approx(8e3 * 1.602176634e-19),
        "pixel_size": pytest.approx(0.65e-6),
        "propagation_distance": pytest.approx(0.12),
    }


@pytest.mark.parametrize("form", ["netCDF4", "netCDF3"])
def test_packed_numbers_are_unpacked(tmp_path, form) -> None:
    truth = np.random.default_rng(6).integers(400, 4000, (3, 6, 20)) * 0.25 + 10.0
    raw = ((truth - 10.0) / 0.25).astype(np.int16)
    raw[1, 2, 3] = -999
    if form == "netCDF4":
        import h5py

        with h5py.File(tmp_path / "a.nc", "w") as file:
            file["counts"] = raw
            file["counts"].attrs.update({"scale_factor": 0.25, "add_offset": 10.0, "_FillValue": np.int16(-999)})
    else:
        from scipy.io import netcdf_file

        with netcdf_file(tmp_path / "a.nc", "w") as file:
            for name, size in zip("tzx", raw.shape, strict=True):
                file.createDimension(name, size)
            v = file.createVariable("counts", "i2", tuple("tzx"))
            v[:] = raw
            v.scale_factor, v.add_offset, v._FillValue = 0.25, 10.0, np.int16(-999)
    read = open_stack("a.nc:/counts", "counts", tmp_path).read(0, 3)
    assert np.isnan(read[1, 2, 3])
    truth[1, 2, 3] = np.nan
    assert np.array_equal(read, truth, equal_nan=True)
    assert np.isfinite(sum_frames(open_stack("a.nc", "counts", tmp_path)).total).all()


def test_a_copy_of_packed_netcdf_is_unpacked() -> None:
    stack = open_stack("packed.nc:/counts", "counts", DATA)
    assert stack.dtype == np.float64
    assert float(np.median(stack.read(0, 1)) * 4) % 1 == 0


@pytest.mark.parametrize(("file", "package"), [("bitshuffle.h5:/counts", "hdf5plugin"), ("zstd.tif", "imagecodecs")])
def test_compressed_frames_are_read_or_refused_by_the_package(file, package) -> None:
    """With the decoder, and in a process where it is not to be had."""
    try:
        __import__(package)
    except ImportError:
        pass
    else:
        assert sum_frames(open_stack(file, "counts", DATA)).used == 6
    code = (
        f"import sys; sys.modules[{package!r}] = None; sys.modules['compression'] = None; sys.modules['zstandard'] = None\n"
        "from pathlib import Path\nfrom spinline.base.errors import InputError\n"
        "from spinline.images.stacks import open_stack\n"
        f"try:\n    open_stack({file!r}, 'counts', Path({str(DATA)!r})).read(0, 1)\n"
        "except InputError as error:\n    print(error)\n"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert f"needs the package {package}" in ran.stdout, ran.stderr
    assert "Traceback" not in ran.stderr
