"""Tables of experiments of other hands: the same experiments, or a refusal that names column and cell."""

import csv
import io

import pytest

from spinline.base.errors import InputError
from spinline.recipe.table import predict_table, read_experiments, recipes_of

HEAD = [
    "paper",
    "polymer",
    "solvent",
    "concentration_wt_percent",
    "needle_gauge",
    "voltage_kV",
    "flow_rate_mL_per_h",
    "distance_cm",
    "temperature_degC",
    "relative_humidity_percent",
]
ROWS = [
    ["a", "PAN", "DMF", "10", "21", "15", "1", "15", "23", "45"],
    ["a", "PAN", "DMF", "12.5", "22", "18.5", "0.5", "20", "", "40.5"],
    ["b", "PCL", "DCM-DMF", "9", "", "12", "2", "12.5", "25", ""],
]


def text(head=HEAD, rows=ROWS, mark=",", end="\n") -> str:
    stream = io.StringIO()
    csv.writer(stream, delimiter=mark, lineterminator=end).writerows([head, *rows])
    return stream.getvalue()


@pytest.fixture
def recipes(tmp_path):
    def of(data: str | bytes, name: str = "t.csv"):
        path = tmp_path / name
        path.write_bytes(data if isinstance(data, bytes) else data.encode())
        return recipes_of(read_experiments(path))

    return of


@pytest.fixture
def plain(recipes):
    return recipes(text())


def test_orders_marks_encodings_and_blank_lines(recipes, plain) -> None:
    turned = text(HEAD[::-1], [row[::-1] for row in ROWS])
    comma = [[cell.replace(".", ",") for cell in row] for row in ROWS]
    for data in (
        turned,
        text(mark=";"),
        text(rows=comma, mark=";"),
        text(rows=comma, mark="\t"),
        b"\xef\xbb\xbf" + text().encode(),
        text().encode("utf-16"),
        text(end="\r"),
        text().replace("\n", "\n\n"),
        text() + "," * 9 + "\n" + " ," * 9 + "\n",  # rows of nothing, as spreadsheets leave them
        text(end=",\n"),
        "sep=;\n" + text(mark=";"),
        "# of our laboratory\n\n" + text(),
        text([*HEAD, "note", "note", "", ""], [[*row, "x", "y", "", ""] for row in ROWS]),
        text([name.upper() for name in HEAD]),
    ):
        assert repr(recipes(data)) == repr(plain), data  # NaN is what is not known


def test_a_workbook(tmp_path, plain) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in [HEAD, *ROWS]:
        book.active.append([float(cell) if cell.replace(".", "").isdigit() else cell or None for cell in row])
    book.active.append([None] * len(HEAD))
    book.save(tmp_path / "t.xlsx")
    assert repr(recipes_of(read_experiments(tmp_path / "t.xlsx"))) == repr(plain)


def _close(found, wanted) -> None:
    for a, b in zip(found, wanted, strict=True):
        assert repr(a) == repr(b) or all(
            getattr(a, name) == pytest.approx(getattr(b, name), rel=1e-9, nan_ok=True)
            for name in (
                "voltage",
                "gap",
                "flow_rate",
                "mass_fraction",
                "temperature",
                "relative_humidity",
                "needle_radius",
            )
        )


def test_headers_with_units(recipes, plain) -> None:
    head = [
        "DOI",
        "Polymer",
        "Solvent",
        "Concentration (wt%)",
        "Gauge (G)",
        "Applied voltage [V]",
        "Feed rate (uL/min)",
    ]
    head += ["tip-to-collector distance (mm)", "Temp. (K)", "RH (%)"]
    factor = {5: 1000, 6: 1000 / 60, 7: 10}

    def cell(i: int, value: str) -> str:
        if value and i in factor:
            return repr(float(value) * factor[i])
        return repr(float(value) + 273.15) if value and i == 8 else value

    rows = [[cell(i, value) for i, value in enumerate(row)] for row in ROWS]
    found = recipes(text(head, rows))
    _close(found, recipes(text([name if name != "paper" else "DOI" for name in HEAD])))
    assert recipes(text([name.replace("distance_cm", "distance_mm") for name in HEAD]))[0].gap == pytest.approx(0.015)


@pytest.mark.parametrize(
    ("column", "cell", "field", "value"),
    [
        ("concentration_wt_percent", "10 wt%", "mass_fraction", 0.10),
        ("concentration_wt_percent", "12 ± 1", "mass_fraction", 0.12),
        ("voltage_kV", "15 kV", "voltage", 15e3),
        ("voltage_kV", "15000 V", "voltage", 15e3),
        ("flow_rate_mL_per_h", "20 µL/min", "flow_rate", 20e-9 / 60),
        ("distance_cm", "150 mm", "gap", 0.15),
        ("needle_gauge", "22G", "needle_radius", 0.21e-3),
        ("needle_gauge", "33", "needle_radius", 0.054e-3),
        ("temperature_degC", "25 °C", "temperature", 298.15),
        ("temperature_degC", "298.15 K", "temperature", 298.15),
        ("relative_humidity_percent", "45 % RH", "relative_humidity", 0.45),
        ("temperature_degC", "RT", "temperature", float("nan")),
        ("temperature_degC", "not reported", "temperature", float("nan")),
        ("relative_humidity_percent", "ambient", "relative_humidity", float("nan")),
        ("needle_gauge", "n.d.", "needle_radius", float("nan")),
        ("needle_gauge", "22.5", "needle_radius", float("nan")),
    ],
)
def test_cells_with_units_and_without_anything(recipes, column, cell, field, value) -> None:
    row = list(ROWS[0])
    row[HEAD.index(column)] = cell
    assert getattr(recipes(text(rows=[row]))[0], field) == pytest.approx(value, rel=1e-9, nan_ok=True)


@pytest.mark.parametrize(
    ("column", "cell", "words"),
    [
        ("voltage_kV", "15 cm", "voltage_kV.*not a potential"),
        ("voltage_kV", "10-15", "is a range"),
        ("concentration_wt_percent", "12,5", 'decimal comma; write a point: "12.5"'),
        ("concentration_wt_percent", "0.12", "looks like a share: percent, 12 and not 0.12"),
        ("concentration_wt_percent", "12 % w/v", "volume of solution"),
        ("needle_gauge", "0.41 mm", "needle_gauge.*leave it empty"),
    ],
)
def test_rows_that_are_not_predicted_say_why(recipes, column, cell, words) -> None:
    import re

    row = list(ROWS[0])
    row[HEAD.index(column)] = cell
    (why,) = recipes(text(rows=[row]))
    assert isinstance(why, str)
    assert re.search(words, why)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("voltage_kV", "voltage", "column voltage without a unit.*voltage_kV, or voltage \\[kV\\]"),
        ("relative_humidity_percent", "humidity", "without a unit"),
        ("concentration_wt_percent", "concentration (g/mL)", "unknown unit"),
        ("needle_gauge", "voltage [kV]", "names a column twice \\(voltage_kV\\)"),
        ("polymer", "chain", "no column polymer"),
    ],
)
def test_headers_that_cannot_be_are_refused(recipes, old, new, words) -> None:
    """A column that looks like a setting and is not understood had been passed over: the setting was taken as usual."""
    with pytest.raises(InputError, match=words):
        recipes(text([new if name == old else name for name in HEAD]))


@pytest.mark.parametrize("data", ["", "\n\n", text(rows=[]), text(rows=[[""] * 10])])
def test_nothing_in_it(recipes, data) -> None:
    with pytest.raises(InputError, match=r"is empty|has no rows"):
        recipes(data)


def test_what_is_not_taken_is_said(tmp_path) -> None:
    path = tmp_path / "t.csv"
    row = dict(zip(HEAD, ROWS[0], strict=True)) | {"voltage_kV": "15 ± 1", "solvent_parts": "water", "drum_rpm": "fast"}
    path.write_text(text(list(row), [list(row.values())]))
    (found,) = predict_table(read_experiments(path))
    assert "the +/- of voltage_kV is not in the interval" in str(found["remark"])
    assert "solvent says DMF, solvent_parts water: the latter is taken" in str(found["remark"])
    assert float(found["predicted_nm"]) > 0  # a column that no law uses keeps no row from its answer


def test_equal_experiments_are_predicted_once(monkeypatch, tmp_path) -> None:
    import spinline.recipe.predict as module

    calls = []
    real = module.predict
    monkeypatch.setattr(module, "predict", lambda *given, **options: calls.append(1) or real(*given, **options))
    (tmp_path / "t.csv").write_text(text(rows=[ROWS[0]] * 50))
    found = predict_table(read_experiments(tmp_path / "t.csv"))
    assert len(calls) == 1
    assert [row["predicted_nm"] for row in found] == [found[0]["predicted_nm"]] * 50


@pytest.mark.parametrize("measured", ["d (nm)", "d [nm]", "D/nm", "diameter (nm)"])
def test_a_column_of_diameters_is_no_distance(recipes, measured) -> None:
    """The d of a fibre in nanometres had been read as the distance to the collector."""
    (plain,) = recipes(text(rows=[ROWS[0]]))
    (beside,) = recipes(text([*HEAD, measured], [[*ROWS[0], "320"]]))
    assert beside == plain


def test_a_rung_that_there_is_not_is_refused_before_any_row(spinline, tmp_path) -> None:
    """It had been written into each row as the reason why it is not predicted, with status 0."""
    (tmp_path / "t.csv").write_text(text())
    ran = spinline("fibre", "--table", "t.csv", "--rung", "rase")
    assert ran.code == 2
    assert "rung = 'rase': is not known" in ran.err
    assert not (tmp_path / "t-fibres.csv").exists()
