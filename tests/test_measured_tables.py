"""Tables of measured diameters as other hands save them: the same diameters, or a refusal with what to write."""

import numpy as np
import pytest

from spinline.base.errors import InputError, SpinlineWarning
from spinline.deposit import read_diameters

SIZES = [500.5, 610.0, 720.25]
ROWS = "".join(f"{size}\n" for size in SIZES)


def read(tmp_path, data, **given):
    (tmp_path / "d.csv").write_bytes(data if isinstance(data, bytes) else data.encode())
    return read_diameters(tmp_path / "d.csv", **given)


@pytest.mark.parametrize(
    "data",
    [
        f"Diameter (nm)\n{ROWS}".encode("utf-16"),
        f"Diameter (nm)\r\n{ROWS}".encode("utf-16-le"),
        f"Diameter (nm)\n{ROWS}".encode("utf-8-sig"),
        f"Diameter\nnm\n{ROWS}",
        f"Diameter\n[nm]\n{ROWS}",
        f"# Diameter (nm)\n{ROWS}",
        f"# of image 3\n# Diameter (nm)\n{ROWS}",
        f"# of image 3\nDiameter (nm)\n{ROWS}",
        "sep=;\nid;Diameter (nm)\n1;500,5\n2;610,0\n3;720,25\n",
        "id\tDiameter\n\tnm\n1\t500.5\n2\t610\n3\t720.25\n",
    ],
)
def test_the_same_diameters(tmp_path, data):
    found = read(tmp_path, data)
    np.testing.assert_allclose(found.diameter, 1e-9 * np.array(SIZES), rtol=1e-12)
    assert found.dropped == 0


def test_a_workbook_of_diameters(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in [["Diameter (nm)"], *([size] for size in SIZES)]:
        book.active.append(row)
    book.save(tmp_path / "d.xlsx")
    np.testing.assert_allclose(read_diameters(tmp_path / "d.xlsx").diameter, 1e-9 * np.array(SIZES), rtol=1e-12)
    with pytest.raises(InputError, match=r"an Excel workbook.*name it \.xlsx"):
        read(tmp_path, (tmp_path / "d.xlsx").read_bytes())


@pytest.mark.parametrize(
    "rows",
    [
        '"1,234.5"\n900.5\n',
        '"1,234"\n900\n',
        "1.234\n900\n",
        "1'234.5\n900.5\n",
        "1.234,5\n900,5\n",
        "1\u202f234\n900\n",
    ],
)
def test_thousands_are_refused(tmp_path, rows):
    """1,234.5 nm had been left out without a word, and 1.234 beside 900 had been 1.234 nm."""
    with pytest.raises(InputError, match=r"marks between thousands in row 1.*write no marks"):
        read(tmp_path, "id;Diameter (nm)\n" + "".join(f"{i};{row}\n" for i, row in enumerate(rows.splitlines())))


def test_decimals_of_three_digits_stay_decimals(tmp_path):
    found = read(tmp_path, "Diameter (um)\n1.234\n0.900\n12\n")
    np.testing.assert_allclose(found.diameter, [1.234e-6, 0.9e-6, 12e-6], rtol=1e-12)


def test_rows_that_are_left_out_are_said(tmp_path):
    with pytest.warns(SpinlineWarning, match=r"2 of 4 rows are left out.*the first is row 2, 'blurred'"):
        found = read(tmp_path, "Diameter (nm)\n500\nblurred\n-3\n600\n")
    assert (found.diameter.size, found.dropped) == (2, 2)


def test_the_remedies_work(spinline, tmp_path):
    """ImageJ's lines across fibres: their column is named "Length", and the unit is the image's."""
    (tmp_path / "one.toml").write_text(
        '[laydown]\nspeed = "5 m/s"\nspread = "60 um"\nturning_length = "100 um"\ndiameter = "600 nm"\n'
        '[collector]\ndistance = "20 cm"\ntime = "40 ms"\n[mat]\nrealisations = 2\nwindow = "12 um"\n'
    )
    (tmp_path / "d.csv").write_text(" ,Area,Mean,Length\n1,0.1,200,5.12\n2,0.2,220,6.3\n3,0.2,220,6.1\n")
    assert spinline("deposit", "one.toml", "-o", "f.h5").code == 0
    mat = ("mat", "f.h5", "-o", "m.nc", "--no-figure", "--measured", "d.csv")
    asked = spinline(*mat)
    assert asked.code == 2
    assert "--measured-column" in asked.err
    asked = spinline(*mat, "--measured-column", "Length")
    assert asked.code == 2
    assert "--measured-unit" in asked.err
    asked = spinline(*mat, "--measured-column", "Length", "--measured-unit", "px")
    assert asked.code == 2
    assert '--pixel-size "0.1 um"' in asked.err
    done = spinline(*mat, "--measured-column", "Length", "--measured-unit", "px", "--pixel-size", "0.1 um")
    assert done.code == 0, done.err
    alone = spinline("mat", "f.h5", "--measured-column", "Length")
    assert alone.code == 2
    assert "--measured TABLE" in alone.err
