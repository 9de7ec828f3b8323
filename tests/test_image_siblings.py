"""Siblings of the reported cases of frames: names of one stack's files, and numbers that other conventions pack."""

import h5py
import numpy as np
import pytest

from spinline.base.errors import InputError
from spinline.images.file_names import in_order, kinds
from spinline.images.stacks import open_stack

FRAMES = np.random.default_rng(5).poisson(1000.0, (4, 6, 24)).astype(np.uint16)


def _parts(folder, *names):
    for i, name in enumerate(names):
        np.save(folder / name, FRAMES + i)


@pytest.mark.parametrize(
    "names",
    [
        ["fr_0.npy", "Fr_1.npy", "fr_2.npy", "FR_10.npy"],
        ["fr.npy", "fr (1).npy", "fr (2).npy", "fr (10).npy"],
        ["t0.5s.npy", "t1.0s.npy", "t9.5s.npy", "t10.0s.npy"],
    ],
)
def test_files_in_the_order_of_their_numbers(tmp_path, names) -> None:
    files = [tmp_path / name for name in names]
    assert in_order(files[::-1]) == files
    assert in_order([files[i] for i in (2, 0, 3, 1)]) == files


@pytest.mark.parametrize("stray", ["part_flat.npy", "part_dark_1.npy", "part_2_bg.npy", "part_Flats.npy"])
def test_a_flat_among_the_jets_files_is_refused(tmp_path, stray) -> None:
    """It had been added to the counts without a word: a fraction of 0.64 for 0.15."""
    _parts(tmp_path, "part_0.npy", "part_1.npy", "part_2.npy", stray)
    with pytest.raises(InputError, match=rf'matches {stray} too.*"part_\[0-9\]\*\.npy"'):
        open_stack("part_*.npy", "counts", folder=tmp_path)
    assert open_stack("part_[0-9].npy", "counts", folder=tmp_path).frames == 12


def test_names_of_several_forms_are_said(tmp_path) -> None:
    _parts(tmp_path, "jet_0.npy", "jet_1.npy", "test_0.npy")
    said = open_stack("*.npy", "counts", folder=tmp_path).account.remarks
    assert list(said) == ["counts: *.npy matches names of 2 forms, all of them taken: jet_0.npy (2), test_0.npy (1)"]


@pytest.mark.parametrize(
    ("names", "key"),
    [
        (["flat_0.npy", "flat_1.npy"], "counts"),  # of one form: a set of flats reduced as counts
        (["a.npy", "b.npy", "c.npy"], "counts"),
        (["flat_0.npy", "flat_1.npy", "flat_2b.npy"], "flat"),
        (["reflection_1.npy", "reflection_2.npy", "darkroom.npy"], "counts"),
    ],
)
def test_names_that_are_no_fault(names, key) -> None:
    kinds(names, key, "*")  # no refusal


@pytest.mark.parametrize(("numbers", "lost"), [((0, 2), 1), ((1, 3), 2), ((0, 1, 3, 4), 2)])
def test_a_missing_part_is_said(tmp_path, numbers, lost) -> None:
    _parts(tmp_path, *(f"part_{i}.npy" for i in numbers))
    assert any(
        f"the first {lost}" in one for one in open_stack("part_*.npy", "counts", folder=tmp_path).account.remarks
    )
    with h5py.File(tmp_path / "master.h5", "w") as file:
        for i in numbers:
            file[f"entry/data/data_{i:06d}"] = FRAMES
    for source in ("master.h5", "master.h5:/entry/data"):
        said = open_stack(source, "counts", folder=tmp_path).account.remarks
        assert any("names of the datasets" in one and f"the first {lost}" in one for one in said)


@pytest.mark.parametrize("numbers", [(0, 5), (5, 10), (2, 4), (0, 10, 20)])
def test_other_steps_are_no_gap(tmp_path, numbers) -> None:
    _parts(tmp_path, *(f"t{i}ms.npy" for i in numbers))
    assert not open_stack("t*.npy", "counts", folder=tmp_path).account.remarks


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("part_{0,1}.npy", "one pattern"),
        ("part_0.npy, part_1.npy", "one pattern"),
        ("sub\\part_*.npy", 'write "/" between folders: "sub/part_'),
    ],
)
def test_what_is_no_file_says_how_to_write_it(tmp_path, source, words) -> None:
    _parts(tmp_path, "part_0.npy", "part_1.npy")
    with pytest.raises(InputError, match=words):
        open_stack(source, "counts", folder=tmp_path)


@pytest.mark.parametrize(
    ("name", "value"),
    [("offset", 1000.0), ("scaling_factor", 0.25), ("Slope", np.array([0.5])), ("BZERO", 32768), ("intercept", 3)],
)
def test_packing_of_other_conventions_is_refused_by_name(tmp_path, name, value) -> None:
    """`offset` had been passed over: 0.12 for a fraction of 0.15."""
    with h5py.File(tmp_path / "packed.h5", "w") as file:
        file.create_dataset("d", data=FRAMES).attrs[name] = value
    with pytest.raises(InputError, match=f"attribute {name}, which may pack.*scale_factor and add_offset"):
        open_stack("packed.h5:/d", "counts", folder=tmp_path)


@pytest.mark.parametrize(
    ("name", "value"),
    [("offset", 0.0), ("slope", 1), ("offset", [0.0, 1.0, 2.0]), ("offset", "none"), ("bscale", "1.0")],
)
def test_attributes_that_do_nothing_are_no_packing(tmp_path, name, value) -> None:
    with h5py.File(tmp_path / "plain.h5", "w") as file:
        file.create_dataset("d", data=FRAMES).attrs[name] = value
    stack = open_stack("plain.h5:/d", "counts", folder=tmp_path)
    assert (stack.read(0, 4) == FRAMES).all()


@pytest.mark.parametrize("lit", [(2,), (0, 11), ()])
def test_light_in_a_dark_is_left_out(tmp_path, lit) -> None:
    """One open shutter in twelve darks had given 0.05 for a fraction of 0.15 with no word of the dark."""
    from spinline.images.odd_frames import without_light
    from spinline.images.sums import sum_frames

    rng = np.random.default_rng(3)
    darks = rng.poisson(300.0, (12, 20, 96)).astype(np.uint16)
    for i in lit:
        darks[i] = rng.poisson(4300.0, (20, 96))
    darks[:, 3, 5] = 60_000  # a hot pixel is no light
    darks[7] += 40  # nor is a dark that drifts
    np.save(tmp_path / "dark.npy", darks)
    stack = open_stack("dark.npy", "dark", folder=tmp_path)
    total, said = without_light(stack, sum_frames(stack))
    rest = np.delete(darks, lit, axis=0)
    assert (total.total == rest.sum(axis=0, dtype=np.int64)).all()
    assert ((total.exposures == len(rest)).all(), total.used) == (True, len(rest))
    assert len(said) == (1 if lit else 0)
    if lit:
        assert f"{len(lit)} of 12 frames" in said[0]
        assert f"are left out: {', '.join(map(str, lit))}. Was the shutter open?" in said[0]
