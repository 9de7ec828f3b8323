"""`spinline cite`: every key has an entry, every model that is named its paper; completion knows the bundled names."""

import re
from importlib import resources

import pytest

from spinline.cli.options import bundled
from spinline.report import cite
from spinline.report.cite import bibtex, cited

FILE = resources.files("spinline").joinpath("data", "references", "references.bib").read_text("utf-8")
KEYS = re.findall(r"^@\w+\{(\w+),$", FILE, re.MULTILINE)


def test_every_entry_is_whole_and_every_rule_has_one():
    named = {key for *_, keys in (*cite._SAID, *cite._HELD) for key in keys} | set(cite._ALWAYS)
    assert named <= set(KEYS)
    assert len(KEYS) == len(set(KEYS)) > 20
    for entry in FILE.strip().split("\n\n"):
        assert entry.count("{") == entry.count("}")
        assert {"author", "title", "year"} <= set(re.findall(r"(\w+) = \{", entry))
    assert bibtex(KEYS).count("\n@") == len(KEYS) - 1


@pytest.mark.parametrize(
    ("attributes", "variables", "keys"),
    [
        ({}, set(), []),
        ({"crossover_extension_criterion": 0.83, "jet": "PowerLaw(...)"}, set(), ["greenfeld2011", "greenfeld2012"]),
        ({"constitutive_model": "Giesekus(mobility=0.1)"}, set(), ["giesekus1982"]),
        ({"attenuation_source": "given: 1546 1/m"}, set(), ["greenfeld2012"]),
        ({"model": "Lagrangian chain, ucm"}, set(), ["reneker2000", "yarin2001"]),
        ({"sampler": "off"}, {"entanglements_left"}, ["likhtman2003", "greenfeld2013"]),
        ({"sampler": "emcee 3.1"}, set(), ["foremanmackey2013"]),
    ],
)
def test_what_is_used_is_cited(attributes, variables, keys):
    assert cited(attributes, frozenset(variables)) == ["spinline", "lauricella2020", *keys]


def test_from_the_command_line(spinline, tmp_path):
    assert spinline("run", "peo5-water", "--no-figure", "-o", "a.nc").code == 0
    told = spinline("cite", "a.nc")
    assert told.code == 0
    assert re.findall(r"@\w+\{(\w+),", told.out) == ["spinline", "lauricella2020", "greenfeld2011", "greenfeld2012"]
    assert "@version@" not in told.out
    as_json = spinline("cite", "a.nc", "--json").json
    assert as_json["keys"][0] == "spinline"
    assert as_json["bibtex"] == told.out.rstrip("\n")
    (tmp_path / "s.toml").write_text('scene = "peo5-water"\n[vary]\njet.k = [1, 2]\n', "utf-8")
    assert spinline("sweep", "s.toml").code == 0
    assert "lauricella2020" in spinline("cite", "s.zarr").out


def test_what_is_no_result_is_refused(spinline, tmp_path):
    import h5py

    with h5py.File(tmp_path / "other.nc", "w") as file:
        file["x"] = [1.0]
    for name, words in {"other.nc": "not a result", "none.nc": "check the path", ".": "not a sweep"}.items():
        ran = spinline("cite", name)
        assert ran.code == 2
        assert words in ran.err


def test_names_of_what_is_bundled(spinline):
    assert "peo5-water" in bundled("scenes")("peo5")
    assert bundled("scenes")("nothing") == []
    assert bundled("recipes")("") == ["pan-dmf", "pcl-dcm-dmf"]
    assert "--install-completion" in spinline("--help").out


def test_the_program_completes(monkeypatch, spinline):
    """As a shell asks it, by typer's protocol."""
    monkeypatch.setenv("_SPINLINE_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "spinline run peo5-n")
    monkeypatch.setenv("COMP_CWORD", "2")
    assert spinline().out.split() == ["peo5-needle"]
    monkeypatch.setenv("COMP_WORDS", "spinline cro")
    monkeypatch.setenv("COMP_CWORD", "1")
    assert spinline().out.split() == ["crossover"]
