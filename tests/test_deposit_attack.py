"""`spinline mat` on fibres that nobody lays: one, none, tiny, huge, out of range; a result or a refusal by name."""

import dataclasses
import os
import warnings

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from spinline.base.errors import InputError, SpinlineWarning
from spinline.deposit import FibreFile, FibreWriter, MatOptions, Segments, analyse_mat
from spinline.deposit.mat import first_stack, sample_mat
from spinline.deposit.passages import Window
from spinline.deposit.stack import lay_stack
from spinline.setup.mat import options_from_text

UM = 1e-6
LINES = {
    "tiny": [[[0, 0], [UM, 0]]],
    "tiny, of 50 segments": [np.column_stack([np.linspace(0, UM, 50), np.zeros(50)])],
    "along the width": [[[0, 0], [0, UM]]],
    "no length": [[[0, 0], [0, 0]]],
    "a metre": [[[0, 0], [1, 0]]],
    "huge": [[[0, 0], [1e6, 1e6]]],
    "twice the same": [[[0, 0], [1e-5, 0]]] * 2,
    "far away": [[[1e6, 1e6], [1e6 + 1e-5, 1e6]]],
    "none": [],
}
REFUSED = {"no length": "have no length", "a metre": "no window has a fibre", "huge": "no window", "none": "is empty"}


def write(path, segments, **attributes):
    with FibreWriter(path, attributes) as file:
        file.write(segments)


@pytest.mark.parametrize("drum", [False, True])
@pytest.mark.parametrize("name", LINES)
def test_one_fibre_is_a_mat_or_is_refused_by_name(name, drum, spinline, tmp_path) -> None:
    segments = Segments.from_paths(LINES[name], 3e-7) if LINES[name] else Segments.join([])
    write("f.h5", segments, **({"circumference": 3e-6} if drum else {}))
    exports = [word for end in ("vtp", "ply", "csv", "tif", "raw") for word in ("--export", f"a.{end}")]
    ran = spinline("mat", "f.h5", "--window", "2 um", "--realisations", "2", "--csv", "t.csv", *exports)
    if name in REFUSED:
        assert (ran.code, REFUSED[name] in ran.err) == (2, True), ran.err
        assert os.listdir(tmp_path) == ["f.h5"]
        return
    assert ran.code == 0, ran.err
    assert "nan" not in ran.out
    assert {"f.nc", "f.png", "t.csv", "a.vtp", "a.ply", "a.csv", "a.tif", "a.raw", "a.json"} < set(os.listdir(tmp_path))


@pytest.mark.parametrize(
    ("column", "value"),
    [("radius", v) for v in (0.0, -1e-7, np.nan, np.inf, 1e-50, 1e40)]
    + [("x", np.nan), ("y", np.inf), ("dx", -np.inf), ("dy", 1e40), ("touch_time", np.nan)]
    + [("length", -1.0), ("length", np.nan), ("polymer_fraction", 0.0), ("polymer_fraction", 1.5)],
)
def test_a_row_that_is_no_fibre_is_neither_written_nor_read(column, value, tmp_path) -> None:
    good = Segments.from_paths([np.cumsum(np.full((9, 2), 1e-5), axis=0)], 3e-7)
    odd = np.array(getattr(good, column))
    odd[5] = value
    bad = dataclasses.replace(good, **{column: odd})
    with pytest.raises(InputError, match=rf"f\.h5: {column} = .*cannot be, in row 5"):
        write(tmp_path / "f.h5", bad)
    assert os.listdir(tmp_path) == []
    if not abs(value) > 1e39 and value != 1e-50:  # what single precision alone does not hold is a fibre in memory
        with pytest.raises(InputError, match=f"fibres: {column}"):
            analyse_mat(bad)
    import h5py

    write(tmp_path / "f.h5", good)
    data = (tmp_path / "f.h5").read_bytes()
    (tmp_path / "f.h5").write_bytes(data[:-128])  # without its seal, as another program leaves it
    with h5py.File(tmp_path / "f.h5", "r+") as file, np.errstate(over="ignore"):
        file[column][5] = value
    with FibreFile(tmp_path / "f.h5") as file, pytest.raises(InputError, match=rf"{column} = .*in row 5"):
        file.read()


def test_windows_that_an_end_reaches_by_less_than_a_pixel_are_left_out() -> None:
    fibre = Segments.from_paths([[[0, 0], [UM, 0]]], 3e-7)
    touched = Window(2e-6, 2e-6, UM - 1e-9, -UM)
    assert not lay_stack(fibre, touched).height.any()
    assert np.isnan(lay_stack(fibre, touched).solidity())
    with pytest.raises(InputError, match="no window has a fibre"):
        sample_mat(fibre, touched, MatOptions())


def test_an_export_is_of_the_first_window_that_has_fibre() -> None:
    fibre = Segments.from_paths([[[0, 0], [1e-4, 0]]], 3e-7)
    for seed in range(40):  # a window of 0.4 um misses the line that its cell of 1 um holds, more often than not
        options = MatOptions(window=4e-7, realisations=6, seed=seed)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            try:
                result = analyse_mat(fibre, options)
            except InputError as error:
                assert "no window has a fibre" in str(error)  # noqa: PT017
                continue
        if any("left out" in str(note.message) for note in said):
            assert_array_equal(first_stack(fibre, options).height, result["height"].values)
            return
    pytest.fail("no seed left a window out")


def test_an_envelope_of_no_height_has_no_porosity_and_says_so() -> None:
    fibre = Segments.from_paths([[[0, 0], [UM, 0]]], 1e-7)
    with pytest.warns(SpinlineWarning, match="1 windows have no percentile envelope: fibre covers less than 1 %"):
        result = analyse_mat(fibre, MatOptions(window=1e-5, realisations=1, envelope="percentile"))
    assert np.isnan(float(result["porosity"]))
    assert np.isnan(result["permeability"].values).all()


@pytest.mark.slow
def test_a_mat_without_porosity_is_drawn(spinline) -> None:
    write("f.h5", Segments.from_paths([[[0, 0], [UM, 0]]], 1e-7))
    words = ("--window", "10 um", "--realisations", "1", "--envelope", "percentile", "--report", "m.html")
    ran = spinline("mat", "f.h5", *words, "--picture", "top.png")
    assert ran.code == 0, ran.err
    assert "none (percentile)" in ran.out
    assert spinline("mat", "f.h5", *words, "--force", "--no-figure", "--json").json["porosity"] is None


def test_a_solidity_beyond_one_is_said_and_has_no_permeability() -> None:
    """A fibre that turns back on itself lies twice in one place."""
    there_and_back = [[[0, 0], [4e-6, 0]] if k % 2 == 0 else [[4e-6, 0], [0, 0]] for k in range(2)]
    corners = np.concatenate([np.array(path) for path in there_and_back * 4])
    fibre = Segments.from_paths([corners], 3e-7)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        result = analyse_mat(fibre, MatOptions(window=3e-6, realisations=1, flatten=0.9))
    assert float(result["solidity"]) > 1
    assert any("is 1 or more" in str(note.message) for note in said)
    assert np.isnan(result["permeability"].values).all()


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ('{"window": "wide"}', "window"),
        ('{"permeability": 5}', "permeability"),
        ('{"permeability": [["davies"]]}', "permeability"),
        ('{"permeability": "davies"}', "permeability"),
        ('{"seed": -1}', "seed"),
        ('{"seed": 1.5}', "seed"),
        ('{"realisations": 2.5}', "realisations"),
        ('{"cells": 0}', "cells"),
        ('{"slope": NaN}', "slope"),
        ('{"flatten": 1.0}', "flatten"),
        ('{"face_velocity": 0}', "face_velocity"),
        ('{"envelope": ["mean-top"]}', "envelope"),
    ],
)
def test_options_in_a_file_are_checked(text, field) -> None:
    with pytest.raises(InputError, match=f"mat.{field}"):
        options_from_text(text, {})


@pytest.mark.parametrize("text", ["a text", "[]", "3", "null", "[" * 5000, "{"])
def test_what_are_no_options_is_left(text) -> None:
    assert options_from_text(text, {}) == MatOptions()


@pytest.mark.parametrize("told", ["round", -1.0, np.nan, np.array([1.0, 2.0])])
def test_a_circumference_that_is_no_length_is_refused(told, spinline) -> None:
    write("f.h5", Segments.from_paths(LINES["tiny"], 3e-7), circumference=told)
    ran = spinline("mat", "f.h5", "--no-figure")
    assert (ran.code, "circumference" in ran.err) == (2, True), ran.err


@pytest.mark.parametrize(
    "words", [("--seed", "-1"), ("--realisations", "0"), ("--slope", "nan"), ("--law", "ergun"), ("--window", "0 um")]
)
def test_options_of_the_command_are_checked(words, spinline) -> None:
    write("f.h5", Segments.from_paths(LINES["tiny"], 3e-7))
    ran = spinline("mat", "f.h5", "--no-figure", *words)
    assert (ran.code, ran.err.count("\n")) == (2, 1), ran.err
