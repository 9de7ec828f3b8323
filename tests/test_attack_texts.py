"""Hostile titles, names of files and cells on the commands of fibres: what is printed, drawn and written is harmless text.

One title and one name hold everything at once, so that each command runs once.
"""

import csv
import io
import json
import os
import re
import shutil
import xml.dom.minidom
from pathlib import Path

import pytest
from lay_text import lay_text

from spinline.base.errors import InputError
from spinline.base.text import csv_rows
from spinline.base.words import cell, page
from spinline.fit.fit_file import bundled_fits
from spinline.recipe.recipe_file import bundled_recipes
from spinline.recipe.table import predict_table, read_experiments, written
from spinline.scene.file import bundled_scenes
from spinline.scene.images_file import bundled_images
from spinline.study.sweep_file import bundled_sweeps

EVERYTHING = "=cmd|x!A1 \x1b[2J\x9b31m \u202eb\u2066 <script>alert(1)</script>\"'&]]>--> @data@ @rests@ $x_{$ l1\r\nl2 \u2028\ufeff %n%s"
NAME = os.fsdecode(b"_a\xff\x1b[2J\xc2\x9b\n$x_{$ @data@ <script>alert(1)< \"' =1")
BAD = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufeff]")
RANGE = ("--voltage", "10 kV .. 20 kV", "--steps", "2")
SHORT = ("--time", "0.2 ms", "--quick", "--frames", "2")


def prepare(stem: str, title: str | None) -> None:
    """A recipe, a scene to spin, a laydown and measured sizes, whose title (none: their name) and name are hostile."""
    told = "" if title is None else "title = " + json.dumps(title, ensure_ascii=False) + "\n"
    for source, end in (
        (bundled_recipes()["pan-dmf"].read_text(encoding="utf-8"), "r"),
        (bundled_scenes()["pvp-spun"].read_text(encoding="utf-8"), "s"),
        (lay_text(), "l"),
    ):
        text = re.sub(r"(?m)^title = .*\n", lambda _: told, source, count=1)
        # as text from elsewhere has it: carriage returns, and controls that TOML lets stand in a comment
        Path(f"{stem}{end}.toml").write_bytes(
            f"{text}# \x9b31m \u202e @data@ <script>alert(1)\n".encode().replace(b"\n", b"\r\n")
        )
    Path(f"{stem}d.csv").write_text("Diameter (nm)\n" + "\n".join(map(str, range(400, 700, 3))), encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize(("stem", "title"), [("a", EVERYTHING), (f"./{NAME}", None)], ids=["title", "name"])
def test_nothing_hostile_is_said_drawn_or_written(stem, title, spinline, tmp_path) -> None:
    prepare(stem, title)
    commands = [
        ("fibre", f"{stem}r.toml"),
        ("window", f"{stem}r.toml", *RANGE, "-o", "w.nc", "--html", "w.html", "--figure", "w.svg"),
        ("deposit", f"{stem}l.toml"),
        ("mat", f"{stem}l.h5", "--report", "m.html", "--measured", f"{stem}d.csv", "--figure", "m.svg"),
        ("spin", f"{stem}s.toml", *SHORT, "--json", "--figure", "s.svg", "--vtk", "s.vtk"),
    ]
    for words in commands:
        ran = spinline(*words)
        assert ran.code == 0, (words, ran.err)
        assert not BAD.search(ran.out + ran.err), words
        if "--json" in words:
            json.loads(ran.out)
    for written_ in (f"{stem}l.nc", f"{stem}s.nc", "w.nc"):
        ran = spinline("cite", written_)
        assert (ran.code, BAD.search(ran.out), "script" in ran.out) == (0, None, False), ran.err
    for file in tmp_path.iterdir():
        if file.suffix not in (".html", ".svg", ".vtk"):
            continue
        text = file.read_bytes().decode("utf-8")
        assert not BAD.search(text), file
        assert "<script>alert" not in text, file
        if file.suffix == ".svg":
            xml.dom.minidom.parseString(text)
    assert Path("w.html").read_text(encoding="utf-8").count('{"axes":') == 1
    assert Path("s.vtk").read_text(encoding="utf-8").splitlines()[2] == "ASCII"


def test_a_title_in_a_file_of_fibres_is_cleaned(spinline) -> None:
    import numpy as np

    from spinline.deposit import FibreFile, FibreWriter, Segments

    with FibreWriter("f.h5", {"title": EVERYTHING, "seed": 3}) as file:
        file.write(Segments.from_paths([np.cumsum(np.full((40, 2), 1e-5), axis=0)], 3e-7))
    with FibreFile("f.h5") as read:
        assert not BAD.search(read.attributes["title"])
        assert read.attributes["seed"] == 3


def test_a_name_in_a_message_stays_in_its_line() -> None:
    assert str(InputError("a\nwrote out.nc", "is\nnot there")) == "a\\nwrote out.nc: is\nnot there"


def test_a_page_has_no_carriage_returns_and_no_escapes() -> None:
    assert page("a\r\nb\rc\x9b\u202e\t") == "a\nb\nc\\u009b\\u202e\t"


HEAD = "paper,polymer,solvent,concentration_wt_percent,voltage_kV,flow_rate_mL_per_h,distance_cm"
ROW = "PAN,DMF,10,15,1,15"


def test_no_cell_of_a_table_is_a_formula(tmp_path) -> None:
    hostile = ["=1+1", "+x", "-2+3", "@SUM(A1)", EVERYTHING, "-2.5", "a\nb", "c\x0bd\u2028e", "-"]
    stream = io.StringIO()
    rows = csv.writer(stream)
    rows.writerow([*HEAD.split(","), '=HYPERLINK("x")'])
    rows.writerows([text, *ROW.split(","), text] for text in hostile)
    (tmp_path / "t.csv").write_text(stream.getvalue(), encoding="utf-8", newline="")
    given = read_experiments(tmp_path / "t.csv")
    assert [row["paper"] for row in given if "\n" not in row["paper"]] == [
        "=1+1",
        "+x",
        "-2+3",
        "@SUM(A1)",
        "-2.5",
        "c\x0bd\u2028e",
        "",
    ]
    assert len(given) == len(hostile)
    named, *cells = csv.reader(
        io.StringIO(written(predict_table([row | {"polymer": ""} for row in given])), newline="")
    )
    assert len(cells) == len(hostile)
    for text in (*named, *(one for row in cells for one in row)):
        assert not BAD.search(text)
        assert not text.startswith(("=", "+", "@", "\t", "\r")), text
        assert not text.startswith("-") or float(text) < 0
    assert [cells[0][0], cells[5][0]] == ["'=1+1", "-2.5"]
    assert cell(cell("=1")) == cell("=1")
    assert [cell("\r1"), cell("+1\n")] == ["'\\u000d1", "+1"]  # numbers to Python, not to a spreadsheet


@pytest.mark.parametrize(
    ("text", "words"),
    [('"never closed', "unexpected end"), ("x" * 200_000, "field larger"), ('"a"b', "expected after")],
)
def test_a_table_whose_cells_do_not_end_is_refused(text, words, spinline) -> None:
    """The rest of a table after an open quote was one cell, and its rows were gone without a word."""
    Path("t.csv").write_text(f"{HEAD}\n{text},{ROW}\nx,{ROW}\n", encoding="utf-8")
    ran = spinline("fibre", "--table", "t.csv")
    assert (ran.code, words in ran.err, os.listdir()) == (2, True, ["t.csv"]), ran.err
    Path("d.csv").write_text('jet.k\n"1\n', encoding="utf-8")
    with pytest.raises(InputError, match="close every quote"):
        csv_rows(["a,b\n", f"{text},1\n", "2,3\n"], ",", "t.csv")


@pytest.mark.slow
@pytest.mark.parametrize("title", [EVERYTHING, None], ids=["title", "name"])
def test_fits_sweeps_and_images_say_nothing_hostile(title, spinline, tmp_path) -> None:
    stem = "a" if title else f"./{NAME}"
    told = f"title = {json.dumps(title, ensure_ascii=False)}\n" if title else ""
    fit, images = bundled_fits()["peo5-simulated"], bundled_images()["peo5-images"]
    for source, end in ((bundled_sweeps()["peo-crossover"], "w"), (fit, "f"), (images, "i")):
        text = re.sub(r"(?m)^title = .*\n", lambda _: told, source.read_text(encoding="utf-8"), count=1)
        text = text.replace("samples = 1024", "samples = 4")
        Path(f"{stem}{end}.toml").write_text(f"{text}# \x9b31m \u202e @data@ <script>alert(1)\n", encoding="utf-8")
    for file in (*fit.parent.glob("*.csv"), fit.parent / "scene.toml", *images.parent.glob("*.npz")):
        shutil.copy(file, tmp_path)
    for words in (("sweep", f"{stem}w.toml"), ("fit", f"{stem}f.toml"), ("reduce", f"{stem}i.toml")):
        ran = spinline(*words)
        assert ran.code == 0, (words, ran.err)
        assert not BAD.search(ran.out + ran.err), words
    for result in (f"{stem}f.nc", f"{stem}i.nc"):
        ran = spinline("cite", result)
        assert (ran.code, BAD.search(ran.out)) == (0, None), ran.err
    table = (tmp_path / "radius.csv").read_text(encoding="utf-8")
    for name in ("=cmd|x!A1", "\x1b[2J", "a\u202eb", "$x_{$", "radius\x00"):
        (tmp_path / "radius.csv").write_text(table.replace("radius", name, 1), encoding="utf-8")
        ran = spinline("fit", f"{stem}f.toml", "--force")
        assert (ran.code, BAD.search(ran.err), "radius.csv" in ran.err) == (2, None, True), name
