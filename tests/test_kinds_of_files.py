"""A file of another kind than a command takes, or such a bundled name, leads on to the command that takes it."""

from importlib import resources
from pathlib import Path

import pytest

from spinline.base.text import parsed_toml
from spinline.scene.kinds import _KINDS, kind_of

DATA = Path(str(resources.files("spinline") / "data"))
BUNDLED = [(kind, path) for kind, where in _KINDS.items() for path in sorted(DATA.glob(where.bundled))]
ONE = dict(BUNDLED)  # the last of each
ASKED = {
    "run": "scene",
    "crossover": "scene",
    "fibre": "recipe",
    "preview": "file of images",
    "sweep": "sweep",
    "fit": "fit",
}


@pytest.mark.parametrize(("kind", "path"), BUNDLED, ids=str)
def test_every_bundled_file_is_of_its_kind(kind, path):
    assert kind_of(parsed_toml(path.read_text(encoding="utf-8"), path.name, kind)) == kind


@pytest.mark.parametrize("data", [{}, {"jet": 1}, {"jet": {}}, {"title": "x"}, {"collector": {}, "mat": {}}])
def test_of_others_nothing_is_said(data):
    assert kind_of(data) is None


@pytest.mark.parametrize(
    ("command", "kind"), [(command, kind) for command, asked in ASKED.items() for kind in ONE if kind != asked]
)
def test_another_kind_leads_on(spinline, tmp_path, command, kind):
    path = ONE[kind]
    name = path.parent.name if path.stem == "fit" else path.stem
    (tmp_path / "mine.toml").write_text(path.read_text(encoding="utf-8"), encoding="utf-8")
    for given, word in ((name, "bundled "), ("mine.toml", "")):
        ran = spinline(command, given)
        assert ran.code == 2
        assert f"{given}: is a {word}{kind}, not a {ASKED[command]}; `{_KINDS[kind].command} {given}`" in ran.err


def test_a_file_goes_before_a_bundled_name(spinline, tmp_path):
    (tmp_path / "pan-dmf").write_text(
        (DATA / "scenes" / "peo5-water.toml").read_text(encoding="utf-8"), encoding="utf-8"
    )
    assert spinline("crossover", "pan-dmf").code == 0


def test_what_takes_both_takes_both(spinline):
    assert spinline("exposure", "peo5-images").code == 0
    assert spinline("exposure", "peo5-positions").code == 0
    assert spinline("exposure", "peo5-water").code == 0


def test_a_file_of_laydown_leads_on_to_deposit(spinline, tmp_path):
    """It had been three problems of a scene, one of them "laydown: take it out"."""
    (tmp_path / "mat.toml").write_text(
        '[laydown]\nspeed = "5 m/s"\nspread = "60 um"\nturning_length = "100 um"\ndiameter = "600 nm"\n'
        '[collector]\ndistance = "20 cm"\ntime = "40 ms"\n'
    )
    for command, kind in ASKED.items():
        ran = spinline(command, "mat.toml")
        assert ran.code == 2
        assert f"is a file of laydown, not a {kind}; `spinline deposit mat.toml`" in ran.err
    assert spinline("deposit", "mat.toml", "--plan").code == 0
    (tmp_path / "sweep.toml").write_text('scene = "peo5-water"\n[vary]\n"jet.k" = { values = [0.5, 1.0] }\n')
    assert "not a file of laydown; `spinline sweep sweep.toml`" in spinline("deposit", "sweep.toml").err
