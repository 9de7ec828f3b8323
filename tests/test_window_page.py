"""The page of an operating window, in a real browser: values under the pointer, keyboard, sliders, print, no request."""

import base64
import json
import re
import subprocess

import numpy as np
import pytest
from test_report_browser import CHROMIUM, needs_browser, opened

from spinline.base.errors import InputError
from spinline.report.window_page import Point, save_window_page, window_page
from spinline.scene import load_scene
from spinline.study.window import operating_window

AXES = ("voltage", "gap", "flow_rate", "mass_fraction")
PROBE = """<script>addEventListener("load", () => {
  const read = () => ({
    at: Object.fromEntries(D.axes.map(a => [a.name, document.getElementById("axis-" + a.name).dataset.value])),
    values: Object.fromEntries(D.variables.map(v => [v.name, document.getElementById("value-" + v.name).dataset.values])),
    kind: document.getElementById("kind").textContent,
  });
  const svg = () => document.querySelector("#plot svg"), seen = {pointer: [], keys: [], slider: []};
  const point = (i, j) => {
    const s = svg(), box = s.getBoundingClientRect(), [X, Y] = s.cells;
    const x = (X[i] + X[i + 1]) / 2, y = (Y[j] + Y[j + 1]) / 2;
    s.dispatchEvent(new PointerEvent("pointermove", {clientX: box.left + x * box.width / W, clientY: box.top + y * box.height / H}));
  };
  for (let i = 0; i < N[state.x]; i++) for (let j = 0; j < N[state.y]; j++) { point(i, j); seen.pointer.push(read()); }
  const plot = document.getElementById("plot"); plot.focus();
  seen.focused = document.activeElement === plot;
  point(0, 0);
  for (const key of ["ArrowRight", "ArrowUp", "End", "ArrowRight", "PageUp", "ArrowLeft", "Home", "PageDown"]) {
    plot.dispatchEvent(new KeyboardEvent("keydown", {key, cancelable: true, bubbles: true})); seen.keys.push(read().at);
  }
  const slider = document.querySelector("input[type=range]");
  for (let i = 0; i <= slider.max; i++) { slider.value = i; slider.dispatchEvent(new Event("input")); seen.slider.push(read()); }
  const choose = document.querySelectorAll("select")[1]; choose.value = 3; choose.dispatchEvent(new Event("change"));
  seen.swapped = [D.axes[state.x].name, D.axes[state.y].name, document.querySelectorAll("select").length];
  seen.marks = [...document.querySelectorAll(".measured title")].map(t => t.textContent);
  seen.boundaries = document.querySelectorAll(".boundary").length;
  seen.requests = performance.getEntriesByType("resource").map(e => e.name).filter(n => !n.startsWith("data:"));
  seen.wider = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  seen.labelled = [...document.querySelectorAll("select, input")].every(c => c.labels.length === 1);
  const note = document.createElement("pre"); note.id = "probe"; note.textContent = JSON.stringify(seen);
  document.body.append(note);
});</script></body>"""


@pytest.fixture(scope="module")
def window():
    ranges = {"voltage": [6e3, 12e3, 25e3], "gap": [0.1, 0.15], "mass_fraction": [0.045, 0.05, 0.06, 0.07]}
    return operating_window(load_scene("peo5-water"), conductivity=0.01, relative_humidity=0.4, **ranges)


@pytest.fixture(scope="module")
def page(window, tmp_path_factory):
    here = Point({"voltage": 12e3, "gap": 0.12, "mass_fraction": 0.06}, "crossover_radius", 21.5e-6)
    return save_window_page(window, tmp_path_factory.mktemp("page") / "window.html", [here])


def stored(window, seen):
    """What the store holds where the page says that it is."""
    at = {name: float(seen["at"][name]) for name in AXES}
    cell = window.sel(at)  # exactly: a place that the store does not hold fails
    return {name: cell[name].values for name in seen["values"]}, cell


@pytest.fixture(scope="module")
def seen(page):
    text = page.read_text("utf-8")
    probed = page.with_name("probed.html")
    probed.write_text(text.replace("</body>", PROBE), encoding="utf-8")
    return opened(probed, page.parent)


@needs_browser
def test_values_under_the_pointer_are_those_of_the_store(window, seen):
    console, found = seen
    assert console == []
    assert found["requests"] == []
    assert len(found["pointer"]) == 3 * 2
    assert len({tuple(one["at"].values()) for one in found["pointer"]}) == 6
    for one in found["pointer"] + found["slider"]:
        values, cell = stored(window, one)
        for name, text in one["values"].items():
            np.testing.assert_array_equal([float(value) for value in text.split()], values[name])
        within = np.isfinite(cell["crossover_position"].values[1])
        assert ("fully stretched within it" in one["kind"]) == within
        assert str(cell["reason"].values[1]) in one["kind"]
    assert len(found["pointer"][0]["values"]) >= 8


@needs_browser
def test_it_works_by_keyboard_and_by_its_controls(window, seen):
    _, found = seen
    assert found["focused"]
    assert found["labelled"]
    u, g = window["voltage"].values, window["gap"].values
    walked = [(float(at["voltage"]), float(at["gap"])) for at in found["keys"]]
    places = [(1, 0), (1, 1), (2, 1), (2, 1), (2, 1), (1, 1), (0, 1), (0, 0)]
    assert walked == [(u[i], g[j]) for i, j in places]
    assert [float(one["at"]["mass_fraction"]) for one in found["slider"]] == window["mass_fraction"].values.tolist()
    assert found["swapped"] == ["mass_fraction", "gap", 3]
    assert found["marks"] == ["21.5 µm measured"]
    assert found["boundaries"] >= 1
    assert found["wider"] <= 0


@needs_browser
def test_it_prints_on_a_page(page):
    """The map and the values, not the controls; one or two sheets."""
    target = page.with_name("page.pdf")
    subprocess.run(
        [
            str(CHROMIUM),
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--disable-background-networking",
            f"--user-data-dir={page.parent / 'print'}",
            "--virtual-time-budget=5000",
            f"--print-to-pdf={target}",
            page.as_uri(),
        ],
        check=True,
        capture_output=True,
        timeout=120,
    )
    data = target.read_bytes()
    assert data.startswith(b"%PDF")
    assert 1 <= len(re.findall(rb"/Type\s*/Page\b", data)) <= 3
    assert "@media print { form, .hint { display: none; }" in page.read_text("utf-8")


def test_the_page_holds_the_stores_numbers_and_nothing_that_could_act(window, page):
    text = page.read_text("utf-8")
    data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)[1])
    for one in data["variables"]:
        held = np.frombuffer(base64.b64decode(one["data"]), "<f8")
        np.testing.assert_array_equal(held, window[one["name"]].transpose("k_factor", *AXES).values.ravel())
    assert "default-src 'none'" in text
    assert "://" not in re.sub(r"http://www\.w3\.org/(2000/svg|1999/xhtml)", "", text)


def test_titles_are_text(window):
    bad = window.assign_attrs(title="</script><b>&", scene="<img src=x onerror=alert(1)>", air="</script>")
    text = window_page(bad)
    assert text.count("<script") == 2
    assert text.count("</script>") == 2
    assert "<img" not in text
    assert "<title>&lt;/script&gt;&lt;b&gt;&amp;</title>" in text


def test_what_is_no_map_is_refused(window):
    with pytest.raises(InputError, match="one point"):
        window_page(window.isel(voltage=[0], gap=[0], mass_fraction=[0]))
    with pytest.raises(InputError, match=r"--html.*fewer --steps"):
        window_page(window.isel(voltage=np.zeros(70_000, dtype=int)))
    nothing = window.map(lambda values: values * np.nan if values.dtype.kind == "f" else values)
    with pytest.raises(InputError, match="no point could be computed"):
        window_page(nothing.assign_attrs(window.attrs))


def test_the_command_writes_it_and_says_so(spinline, tmp_path):
    given = ("window", "peo5-water", "--voltage", "5 kV .. 20 kV", "--gap", "15 cm", "--conductivity", "0.01 S/m")
    ran = spinline(*given, "--steps", 3, "--no-figure", "--html", "w.html")
    assert ran.code == 0
    assert "w.html" in ran.out
    assert (tmp_path / "w.html").stat().st_size > 10_000
    again = spinline(*given, "--steps", 3, "--no-figure", "--html", "w.html", "-o", "b.nc")
    assert again.code == 2
    assert "w.html" in again.err
