"""The report in a real browser: no error on its console, no request that leaves the page, every picture drawn."""

import html
import json
import re
import shutil
import subprocess
import warnings

import pytest

from spinline.base.errors import SpinlineWarning
from spinline.report import save_report
from spinline.scene import load_scene
from spinline.solve import run
from spinline.study.trade import trade

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
PROBE = """<script>addEventListener("load", () => {
  const seen = {
    pictures: [...document.images].map(i => [i.complete, i.naturalWidth, i.naturalHeight]),
    requests: performance.getEntriesByType("resource").map(e => e.name).filter(n => !n.startsWith("data:")),
    wider: document.documentElement.scrollWidth - document.documentElement.clientWidth,
  };
  const note = document.createElement("pre"); note.id = "probe"; note.textContent = JSON.stringify(seen);
  document.body.append(note);
});</script></body>"""


needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")


def opened(page, folder, *more):
    """Console lines, and what the probe saw."""
    done = subprocess.run(
        [
            str(CHROMIUM),
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--disable-background-networking",
            f"--user-data-dir={folder / 'profile'}",
            "--enable-logging=stderr",
            "--window-size=1200,900",
            "--virtual-time-budget=5000",
            *more,
            "--dump-dom",
            page.as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    found = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found is not None, done.stderr[-2000:]
    return [line for line in done.stderr.splitlines() if "CONSOLE" in line], json.loads(html.unescape(found[1]))


@pytest.mark.slow
@needs_browser
@pytest.mark.parametrize("scene", ["peo5-water", "pvp-jetspin", "pcl9-dcm"])
def test_report_opens_in_a_browser(scene, tmp_path):
    """The last with a trade and uncertain inputs."""
    full = scene == "pcl9-dcm"
    loaded = load_scene(scene, ['jet.radius="100 +/- 2 um"', "accuracy.draws=8"] if full else [])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)  # said by the bundled scenes; other tests read them
        result = run(loaded)
    if full:
        result.attrs["trade"] = trade(loaded, quick=True).json()
    page = save_report(result, tmp_path / "report.html")
    text = page.read_text(encoding="utf-8")
    assert text.count("</body>") == 1
    page.write_text(text.replace("</body>", PROBE), encoding="utf-8")
    console, seen = opened(page, tmp_path)
    assert console == []
    assert seen["requests"] == []
    assert len(seen["pictures"]) == 1 + full
    assert all(complete and width > 100 and height > 100 for complete, width, height in seen["pictures"])
    assert seen["wider"] <= 0


@needs_browser
def test_the_probe_sees_a_broken_page(tmp_path):
    """A picture that is asked for elsewhere and missing, a script that fails: the test above can fail."""
    page = tmp_path / "broken.html"
    page.write_text(
        f'<!DOCTYPE html><body><img src="http://127.0.0.1:9/none.png"><script>nothing()</script>{PROBE}',
        encoding="utf-8",
    )
    console, seen = opened(page, tmp_path)
    assert console
    assert seen["pictures"][0][1] == 0
    assert any("none.png" in name for name in seen["requests"])
