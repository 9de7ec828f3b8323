"""Tables as people's programs write them: each kind read to the same jet, or refused by the name of what it is."""

import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spinline.base.errors import InputError
from spinline.base.text import decoded
from spinline.jetprofile.columns import read_columns

TABLES = Path(__file__).parent / "data" / "tables"
KINDS = {"z": "length", "radius": "length", "radius_std": "length"}
Z = np.array([0.55, 0.95, 1.55, 2.05, 3.15, 4.25, 5.35, 6.45, 7.55, 8.65]) * 1e-3
R = np.array([62.2999, 48.1867, 38.2826, 33.5686, 27.4316, 23.8295, 21.3861, 19.5869, 18.1896, 17.0632]) * 1e-6


def read(tmp_path, text, encoding="utf-8", name="t.csv"):
    file = tmp_path / name
    file.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
    return read_columns(file, KINDS, required=("z", "radius"))


def same(columns):
    assert columns["z"] == pytest.approx(Z, rel=1e-12)
    assert columns["radius"] == pytest.approx(R, rel=1e-5)


@pytest.mark.parametrize(
    "name",
    [
        "plain.csv",
        "shifted.csv",
        "profile-cp1252.csv",
        "profile-utf16.csv",
        "comsol.txt",
        "savetxt.csv",
        "blanks.txt",
        "fortran.csv",
    ],
)
def test_one_jet_in_many_formats(name):
    same(read_columns(TABLES / name, KINDS, required=("z", "radius")))


def test_the_command_reads_them_too(spinline):
    for name in ("blanks.txt", "profile-utf16.csv"):
        ran = spinline("fit-jet", TABLES / name, "--radius", "125 um")
        assert ran.code == 0
        assert ran.out.startswith("k = 1 ")
    assert spinline("check", TABLES / "scene-bom.toml").code == 0


def test_decimal_commas_between_commas_are_refused():
    with pytest.raises(
        InputError, match=r"more fields in line 2 \(4\) than the header has names \(2; text table, UTF-8, commas"
    ) as told:
        read_columns(TABLES / "profile.csv", KINDS)
    assert "semicolons" in str(told.value)


def test_no_header_is_said():
    with pytest.raises(InputError, match="no header"):
        read_columns(TABLES / "noheader.csv", KINDS)


def written(
    separator=",", decimal=".", header="z [mm]{s}radius [um]", before="", number="{:.6f}", tail="", newline="\n"
):
    rows = [
        separator.join(number.format(x).replace(".", decimal) for x in (1e3 * z, 1e6 * r)) + tail
        for z, r in zip(Z, R, strict=True)
    ]
    return newline.join([before + header.format(s=separator), *rows]) + newline


@pytest.mark.parametrize(
    "text",
    [
        written(";", ","),
        written("\t", ","),
        written("   ", ","),
        written(";", ".", tail=";"),
        written(",", tail=",,"),
        written("; "),
        written(", ", number="{:.10E}"),
        written(newline="\r\n"),
        written(newline="\r"),
        written(before="sep=;\n", separator=";"),
        written(before="# measured by hand\n\n"),
        written(header="z (mm){s}radius (µm)"),
        written(header="z/mm{s}radius/um"),
        written(header='"z [mm]"{s}"radius [um]"'),
        written(header="z_mm{s}r_um"),
        written(header="Z [mm]{s}Radius [um]"),
        written(header="z{s}radius\nmm{s}um"),
        written(header="z{s}r\n[mm]{s}[um]"),
        written(header="% z (mm){s}radius (um)"),
        written(header="! z [mm]{s}radius [um]"),
        written(header="z [mm]{s}jet_radius [um]"),
    ],
    ids=[str(i) for i in range(21)],
)
def test_every_way_of_writing_it(tmp_path, text):
    same(read(tmp_path, text))


@pytest.mark.parametrize(
    "header", ["z [mm],diameter [um]", "z [mm],d [um]", "z_mm,diameter_um", "distance [mm],D [um]"]
)
def test_a_diameter_is_twice_the_radius(tmp_path, header):
    columns = read(tmp_path, written(header=header))
    assert columns["radius"] == pytest.approx(0.5 * R, rel=1e-5)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"])
def test_encodings(tmp_path, encoding):
    same(read(tmp_path, written(header="z [mm]{s}radius [µm]"), encoding))


def test_fortran_exponents(tmp_path):
    text = "z [mm], radius [um]\n1.0D-103, 2.0D+00\n1.0-103, 0.2E+01\n-1.5d0, 3.\n"
    columns = read(tmp_path, text)
    assert columns["z"].tolist() == pytest.approx([1e-106, 1e-106, -1.5e-3], rel=1e-12)
    assert columns["radius"].tolist() == pytest.approx([2e-6, 2e-6, 3e-6], rel=1e-12)


def test_a_workbook(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append(["z [mm]", "radius [um]", None])
    for z, r in zip(Z, R, strict=True):
        sheet.append([1e3 * z, 1e6 * r])
    book.save(tmp_path / "t.xlsx")
    same(read_columns(tmp_path / "t.xlsx", KINDS, required=("z", "radius")))


def test_a_workbook_without_its_library_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    (tmp_path / "t.xlsx").write_bytes(b"PK")
    with pytest.raises(InputError, match="Excel workbook, and openpyxl is not installed"):
        read_columns(tmp_path / "t.xlsx", KINDS)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"", "is not a CSV table"),
        (b"# only words\n", "no line but comments"),
        (b"z [mm],radius [um]\n", "holds no numbers"),
        (b"z [mm],radius [um]\n1,2,3\n", r"more fields in line 2 \(3\).*give every column a name"),
        (b"z [mm],radius [um]\n1,2\n1\n", "fewer fields in line 3"),
        (b"z [mm],radius [um]\n1,two\n", r"text among its numbers.*line 2, column radius"),
        (b"z [mm];radius [um]\n1,5;2.5\n", "which is the decimal"),
        (b"z [mm];radius [um]\n1.234,5;2,5\n", "which is the decimal"),
        (b"z [mm],radius [um]\n1,*****\n", "text among its numbers"),
        (b"z [mm],radius\n1,2\n", "needs a unit"),
        (b"z [mm],radius [um],colour\n1,2,3\n", "not known.*commas between 3 columns"),
        (b"z [mm],radius [um],r [um]\n1,2,3\n", "two columns that mean radius"),
        (b"z [mm],width [um]\n1,2\n", "not known"),
        (b"z [mm],radius [s]\n1,2\n", "radius"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00\x0d", "is a PNG picture, and no text.*give a text file"),
        (b"PK\x03\x04\x01\x02", "is a zip archive"),
        (b"1,2\x00\n", "zero bytes"),
        (b"\xff\xfe\x00", "not text"),
        (b"z [mm],radius [um]\n\x01\x02,\xff\n", "is not text"),
    ],
)
def test_refusals_name_what_was_seen(tmp_path, text, words):
    with pytest.raises(InputError, match=f"(?s){words}"):
        read(tmp_path, text)


def test_old_workbooks_are_named(tmp_path):
    (tmp_path / "t.xls").write_bytes(b"\xd0\xcf\x11\xe0")
    with pytest.raises(InputError, match="old Excel"):
        read_columns(tmp_path / "t.xls", KINDS)
    (tmp_path / "bad.xlsx").write_bytes(b"not a zip")
    with pytest.raises(InputError, match="not a readable Excel workbook"):
        read_columns(tmp_path / "bad.xlsx", KINDS)


def test_empty_fields_are_nan(tmp_path):
    columns = read(tmp_path, "z [mm],radius [um],radius_std [um]\n1,2,\n2,,0.1\n3,NA,0.1\n")
    assert np.isnan(columns["radius_std"]).tolist() == [True, False, False]
    assert np.isnan(columns["radius"]).tolist() == [False, True, True]


def refused(file):
    try:
        read_columns(file, KINDS)
    except InputError as error:
        return str(error)
    return None


@given(data=st.binary(max_size=200))
@settings(max_examples=300, deadline=None)
def test_any_bytes_are_a_table_or_one_refusal(tmp_path_factory, data):
    file = tmp_path_factory.mktemp("t") / "t.csv"
    file.write_bytes(data)
    refusal = refused(file)
    assert refusal is None or "t.csv" in refusal


@given(st.text(alphabet='z[]m ,;\tr0123456789.eED+-\n#%"()µ', max_size=120))
@settings(max_examples=500, deadline=None)
def test_any_text_is_a_table_or_one_refusal(tmp_path_factory, text):
    file = tmp_path_factory.mktemp("t") / "t.csv"
    file.write_text("z [mm],radius [um]\n" + text, encoding="utf-8", newline="")
    refusal = refused(file)
    assert refusal is None or "t.csv" in refusal


def test_decoding_says_the_encoding():
    assert decoded(b"abc", "x") == ("abc", "UTF-8")
    assert decoded("µ".encode("cp1252"), "x") == ("µ", "Windows-1252")
    assert decoded("abcµ".encode("utf-16"), "x") == ("abcµ", "UTF-16")
    assert decoded(b"", "x") == ("", "UTF-8")


@pytest.mark.slow
def test_a_million_rows(tmp_path):
    file = tmp_path / "long.csv"
    z = np.linspace(1e-3, 10.0, 1_000_000)
    with file.open("w") as out:
        out.write("z [mm],radius [um]\n")
        np.savetxt(out, np.column_stack([z, 100 / z]), delimiter=",", fmt="%.9g")
    columns = read_columns(file, KINDS)
    assert columns["z"].size == 1_000_000
    assert columns["z"][-1] == pytest.approx(0.01)


def test_a_profile_written_from_its_far_end(tmp_path):
    from spinline.jetprofile import Table

    (tmp_path / "a.csv").write_text(written())
    (tmp_path / "b.csv").write_text("\n".join([written().splitlines()[0], *written().splitlines()[:0:-1]]) + "\n")
    one, two = (Table.from_csv(tmp_path / name, flow_rate=1e-9) for name in ("a.csv", "b.csv"))
    assert one == two or one.velocity_ratio(2e-3) == two.velocity_ratio(2e-3)
    (tmp_path / "c.csv").write_text("z [mm],radius [um]\n1,3\n0.5,2\n2,1\n")
    with pytest.raises(InputError, match="strictly increase"):
        Table.from_csv(tmp_path / "c.csv", flow_rate=1e-9)


def test_x_is_the_axis_where_it_is_no_coordinate(tmp_path):
    file = tmp_path / "jet.csv"
    file.write_text("x_mm,d_um\n0,250\n1,100\n2,70\n3,60\n", "utf-8")
    found = read_columns(file, {"z": "length", "radius": "length"})
    np.testing.assert_allclose(found["z"], [0, 1e-3, 2e-3, 3e-3])
    np.testing.assert_allclose(found["radius"], [125e-6, 50e-6, 35e-6, 30e-6])
    file.write_text("z [mm],radius\n1,2\n2,1\n", "utf-8")
    with pytest.raises(InputError, match="commas between 2 columns"):
        read_columns(file, {"z": "length", "radius": "length"})


def rows(header, line="{},{}\n", zs=Z * 1e3, rs=R * 1e6):
    return header + "\n" + "".join(line.format(a, b) for a, b in zip(zs, rs, strict=True))


@pytest.mark.parametrize(
    "text",
    [
        rows('"z [mm]","radius [um]"', '"{}","{}"\n').replace(".", ","),  # decimal commas in quotes
        ",z [mm],radius [um]\n"
        + "".join(f"{i},{1e3 * a},{1e6 * b}\n" for i, (a, b) in enumerate(zip(Z, R, strict=True))),
        " ,z [mm],radius [um]\n"
        + "".join(f"{i},{1e3 * a},{1e6 * b}\n" for i, (a, b) in enumerate(zip(Z, R, strict=True), 1)),
        rows("distance from nozzle [mm],jet radius [um]"),
        rows("% Arc length (mm)    radius (um)", "{}   {}\n"),
        rows("Distance\tRadius\nmm\tum\nalong the jet\tmean of three", "{}\t{}\n"),  # Origin: name, unit, comment
        rows("z [mm],radius [um]") + "\x1a",
        rows("z [mm];Ø [um]", "{};{}\n", rs=2e6 * R),
    ],
)
def test_other_hands(tmp_path, text):
    same(read(tmp_path, text))


@pytest.mark.parametrize("encoding", ["gb18030", "shift_jis"])
def test_the_micro_sign_of_east_asian_code_pages(tmp_path, encoding):
    same(read(tmp_path, rows("z [mm];radius [μm]", "{};{}\n"), encoding))


@pytest.mark.parametrize("cell", ["#N/A", "#DIV/0!", "#VALUE!", "--", "---", "?", "NA", "null", ""])
def test_what_spreadsheets_write_for_nothing(tmp_path, cell):
    found = read(tmp_path, rows("z [mm],radius [um]") + f"9,{cell}\n")
    assert np.isnan(found["radius"][-1])
    first = read(tmp_path, rows("radius [um],z [mm]", zs=R * 1e6, rs=Z * 1e3) + f"{cell or '-'},9\n")
    assert first["z"].size == 11  # no comment, though it begins as one


@pytest.mark.parametrize(
    ("zs", "rs"),
    [
        (
            ["550", "950", "1.550", "2.050"],
            ["62.299", "48.186", "38.282", "33.568"],
        ),  # nm and um with points for thousands
        (["550", "950", "1,550", "2,050"], ["62,299", "48,186", "38,282", "33,568"]),
        (["950", "1.050", "999", "1.000.100"], ["4", "3", "2", "1"]),
    ],
)
def test_marks_between_thousands_are_no_decimals(tmp_path, zs, rs):
    """They had been read as decimals without a word: 1.550 um behind 950 um."""
    with pytest.raises(InputError, match=r"marks between their thousands.*column z"):
        read(tmp_path, rows("z [um];radius [nm]", "{};{}\n", zs, rs))


def test_decimals_of_three_digits_stay_decimals(tmp_path):
    for zs in (
        ["0.550", "0.950", "1.550"],
        ["550.000", "950.500", "1.550"],
        ["1", "2", "3.550"],
        ["550", "950", "1.555"],
    ):
        found = read(tmp_path, rows("z [um];radius [nm]", "{};{}\n", zs, ["3", "2", "1"]))
        assert found["z"] == pytest.approx([1e-6 * float(z) for z in zs], rel=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("z [mm],radius [um]\n1,48,19\n", "if its decimals are commas"),
        ("z,radius\n0.55 mm,62 um\n0.95,48\n", "line 2, column z"),  # no row of units
        ("z [mm];radius [um]\n0.55,62.3\n", "part rows as the header, by semicolons"),
        ("# of May\nz [mm];radius [um]\n0.55,62.3\n", "part rows as the header, by semicolons"),
        ("z [mm],,radius [um]\n1,7,3\n2,7,2\n", "no name over column 2"),
        ("z [mm],radius [um]\n1,62.3 ± 0.5\n", "into radius_std"),
        ("Jet of 5 wt% PEO\nz [mm],radius [um]\n1,2\n", "begin others with #"),
        ("z [um];radius [um]\n0;125\n1,234.5;60\n", "write no marks between thousands"),
        ("z [um];radius [um]\n0;125\n1 234.5;60\n", "write no marks between thousands"),
        ("z [um];radius [um]\n0;125\n1'234.5;60\n", "write no marks between thousands"),
        ("z [um];radius [um]\n0;125\n1\u202f234;60\n", "write no marks between thousands"),
        ('z [um],radius [um]\n"1,250",125\n"2,250",60\n', "may have marks between their thousands"),
        ("z [um];radius [um]\n0;125\n1.000;60\n2.000;50\n", "may have marks between their thousands"),
        ("z [mm],radius [um]\n1,2\nz [mm],radius [um]\n1,2\n", "second header"),
        ("\n# Curve 0 of 1, 2 points\n# x y type\n 0 125  i\n 1 60  i\n", "`set table` of gnuplot"),
        ("PEO jet\nz [mm],radius [um]\n1,2\n", "begin lines above the names of the columns with #"),
    ],
)
def test_refusals_say_what_to_write(tmp_path, text, words):
    with pytest.raises(InputError, match=words):
        read(tmp_path, text)


PLAIN = "".join(f"{1e3 * a} {1e6 * b}\n" for a, b in zip(Z, R, strict=True))


@pytest.mark.parametrize("between", ["\n", "\n\n", "\n\n# t = 2 ms\n", "\n\n# z [mm]  radius [um]\n"])
def test_blocks_that_blank_lines_part_are_no_one_jet(tmp_path, between):
    """Two curves of gnuplot had been strung together wherever z went on to rise."""
    second = "".join(f"{1e3 * a + 50} {1e6 * b}\n" for a, b in zip(Z, R, strict=True))
    with pytest.raises(
        InputError, match=rf"2 blocks that blank lines part.*lines 2, {Z.size + 2 + between.count(chr(10))}"
    ):
        read(tmp_path, "# z [mm]  radius [um]\n" + PLAIN + between + second)


@pytest.mark.parametrize("of", ["\n{}\n\n\n", "{}", "doubled"])
def test_blank_lines_about_a_table_or_behind_each_row_are_nothing(tmp_path, of):
    body = PLAIN.replace("\n", "\n\n") if of == "doubled" else of.format(PLAIN)
    same(read(tmp_path, "# z [mm]  radius [um]\n" + body))


@pytest.mark.parametrize(
    "above",
    [
        "# z [mm]  radius [um]\nz radius\n",
        "z radius\n# z [mm]  radius [um]\n",
        "# Z (mm), Radius (um)\nz radius\n",
        "# units: mm, um\nz radius\n",
        "# [mm] [um]\nz radius\n",
        "z radius\n# mm um\n",
        "# z radius\n# mm um\n",
        "# mm um\n# z radius\n",
        "# z in mm, radius in um\n",
        "# z [mm]  radius [um]\n# made by the high-speed camera\n",
        "# z [mm]  radius [um]\n# of 3 May, 2 runs\n",
        "z radius\nmm um\n-- ----\n",
        "z [mm]   radius [um]\n--------------------\n",
    ],
)
def test_units_that_stand_in_a_comment_or_over_a_line(tmp_path, above):
    same(read(tmp_path, above + PLAIN))


def test_units_of_a_comment_do_not_change_those_of_the_header(tmp_path):
    found = read(tmp_path, "# z [m], radius [m]\nz [mm],radius [um]\n1,2\n2,1\n")
    assert found["z"].tolist() == pytest.approx([1e-3, 2e-3], rel=1e-12)
    with pytest.raises(InputError, match="needs a unit"):
        read(tmp_path, "# z [mm], width [um]\nz,radius\n1,2\n2,1\n")  # of other names


@pytest.mark.parametrize("name", ["t.csv", "t.txt", "t.dat"])
def test_a_workbook_under_another_name_is_told_its_own(tmp_path, name):
    """It had been "a zip archive"."""
    openpyxl = pytest.importorskip("openpyxl")
    from spinline.recipe.table import read_experiments

    openpyxl.Workbook().save(tmp_path / "t.xlsx")
    (tmp_path / "t.xlsx").rename(tmp_path / name)
    for reader in (lambda path: read_columns(path, KINDS), read_experiments):
        with pytest.raises(InputError, match=r"an Excel workbook.*name it \.xlsx, or save its sheet as CSV"):
            reader(tmp_path / name)
