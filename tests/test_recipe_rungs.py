"""Rungs of a recipe side by side: no jump where a setting sweeps, the chain of beads refused by name, what nobody spins said."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pan_recipe import PAN

import spinline as sl
from spinline.base.errors import InputError
from spinline.recipe import Measurement
from spinline.recipe import lagrangian as beads
from spinline.recipe.believe import believe
from spinline.recipe.predict import RUNGS, predict
from spinline.recipe.window import fibre_window

COMMITTED = json.loads((Path(__file__).parents[1] / "benchmarks" / "spindb_rungs.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("rung", ["terminal", "envelope"])
def test_no_jump_where_a_setting_sweeps(rung):
    """Within a rung, and between it and the race: neither leaves the other suddenly."""
    for name, values in (
        ("voltage", np.geomspace(5e3, 4e4, 9)),
        ("mass_fraction", np.linspace(0.04, 0.25, 9)),
        ("gap", np.geomspace(0.02, 0.5, 17)),
        ("flow_rate", np.geomspace(1e-11, 1e-8, 9)),
    ):
        both = [
            [predict(replace(PAN, **{name: v}), rung=r, draws=256, shares=False).fibre_diameter for v in values]
            for r in (rung, "race")
        ]
        logs = np.log(both)
        assert np.abs(np.diff(logs[0])).max() < 0.9
        assert np.abs(np.diff(logs[0], 2)).max() < 0.3
        if rung == "envelope":
            assert np.abs(np.diff(logs[0] - logs[1])).max() < 0.15
            assert np.abs(np.diff(logs[0] - logs[1], 2)).max() < 0.1


def test_the_envelope_and_the_race_are_near_where_the_flight_is_long():
    found = predict(PAN, rung="envelope", shares=False)
    assert abs(np.log(found.fibre_diameter / found.trade["race"])) < 0.15
    assert 1e-4 < found.envelope_radius < 1e-2
    assert 1e-3 < found.flight_time < 0.5
    race = predict(PAN)
    assert set(race.trade) == {"terminal", "envelope"}
    assert race.envelope_radius is None
    # over 2 cm the flight is as short as the race's
    near = predict(replace(PAN, gap=0.02))
    assert any("--rung envelope" in words for words in near.remarks)
    assert near.trade["envelope"] > 1.2 * near.fibre_diameter
    assert not any("--rung envelope" in words for words in race.remarks)


def test_a_chain_holds_no_more_charge_than_the_voltage():
    believed, _ = believe(PAN)
    settings, carried = beads.settings_of(believed)
    inlet = settings.inlet
    line = inlet.charge_density * np.pi * inlet.radius**2
    volts = line * np.log(2 * 0.15 / inlet.radius) / (2 * np.pi * 8.8541878188e-12)
    assert volts == pytest.approx(15e3, rel=1e-6)
    assert 0 < carried < 1
    weak, all_of_it = beads.settings_of(believe(replace(PAN, current=1e-10))[0])
    assert all_of_it == 1
    assert weak.inlet.charge_density == pytest.approx(1e-10 / PAN.flow_rate, rel=1e-9)


def test_a_chain_that_cannot_be_is_refused_by_name():
    with pytest.raises(InputError, match="lagrangian cannot spin this recipe") as refusal:
        beads.laid(believe(PAN)[0], seconds=0.01)
    assert "race" in str(refusal.value)
    with pytest.raises(InputError, match="no longer than a jet is wide"):
        beads.laid(believe(replace(PAN, gap=1e-4))[0])


def test_a_chain_whose_tick_never_ends_is_given_up(monkeypatch):
    """One of many short elements computed for ten minutes within a tick, and looked at no clock."""
    from spinline.jetprofile.spun import SpunRun

    began = SpunRun.start(beads.settings_of(believe(PAN)[0])[0])

    def endless(end, progress):
        for _ in range(10_000_000):
            progress(0.0)

    monkeypatch.setattr(began.chain, "march", endless)
    monkeypatch.setattr(SpunRun, "start", lambda settings: began)
    with pytest.raises(InputError, match=r"does not reach the collector within 0\.2 s"):
        beads.laid(believe(PAN)[0], seconds=0.2)


def test_the_interval_stands_about_what_the_chain_laid(monkeypatch):
    chain = beads.Laid(1e-6, 0.1, 5e-3, 0.3, 4.0, 0.1, 100, 1.0)
    monkeypatch.setattr(beads, "laid", lambda believed: chain)
    race, found = predict(PAN, shares=False), predict(PAN, rung="lagrangian", shares=False)
    assert found.rung == "lagrangian"
    ratio = found.fibre_diameter / race.fibre_diameter
    assert found.fibre_diameter_95[1] / race.fibre_diameter_95[1] == pytest.approx(ratio)
    assert found.fibre_diameter == pytest.approx(1e-6, rel=0.2)
    assert any("bead by bead" in words and f"{beads.TOO_THICK} times too thick" in words for words in found.remarks)
    known = predict(PAN, [Measurement(PAN, 5e-7, 0.02)], rung="lagrangian", shares=False)
    # what is measured outweighs a chain that may be 16 times too thick: as the race says of it
    alone = predict(PAN, [Measurement(PAN, 5e-7, 0.02)], shares=False)
    assert known.fibre_diameter == pytest.approx(alone.fibre_diameter, rel=0.1)
    assert known.fibre_diameter < 0.6 * found.fibre_diameter


def test_rungs_are_named(spinline):
    done = spinline("fibre", "pan-dmf", "--rung", "envelop")
    assert done.code != 0
    assert all(rung in done.err for rung in RUNGS)
    answer = spinline("fibre", "pan-dmf", "--rung", "envelope", "--json").json
    assert answer["rung"] == "envelope"
    assert answer["envelope_radius"] > 0


def test_the_committed_rungs_stand_side_by_side():
    """`benchmarks/spindb_rungs.py`, with the constants of the folds of `benchmarks/spindb.py`."""
    rungs = COMMITTED["rungs"]
    assert set(rungs) == {"terminal", "race", "envelope"}
    assert abs(np.log(rungs["envelope"]["factor"] / rungs["race"]["factor"])) < 0.1
    assert rungs["race"]["factor"] < rungs["terminal"]["factor"]
    ratio = COMMITTED["envelope over race, 5 25 50 75 95 %"]
    assert 0.8 < ratio[0] < ratio[4] < 1.25
    bias = COMMITTED["by beads"]["lagrangian"]["bias"]
    assert abs(beads.TOO_THICK / bias - 1) < 0.03


def test_a_mixture_dries_as_the_thread_that_is_integrated(monkeypatch):
    """`benchmarks/mixed_solvents.py`: its first thread as committed; the march is nearer to both laws than one rate is."""
    import sys

    folder = Path(__file__).parents[1] / "benchmarks"
    monkeypatch.setattr(sys, "path", [*sys.path, str(folder)])
    import mixed_solvents

    monkeypatch.setattr(mixed_solvents, "THREADS", mixed_solvents.THREADS[:1])
    monkeypatch.setattr(mixed_solvents, "DAMP", mixed_solvents.DAMP[:1])
    made, committed = mixed_solvents.judge(), json.loads((folder / "mixed_solvents.json").read_text(encoding="utf-8"))
    (now,), (kept, *_) = made["threads"], committed["threads"]
    assert made["damp air"][0]["ln a by humidity"] == pytest.approx(
        committed["damp air"][0]["ln a by humidity"], rel=1e-3
    )
    assert set(now) == set(kept)
    for name in set(now) - {"polymer", "solvent"}:
        assert now[name] == pytest.approx(kept[name], rel=1e-3, abs=2e-4)
    for law in ("ideal", "as straight jets"):
        beside, alone = (np.abs(now[f"{form}, {law}"]) for form in ("side by side", "until all are gone"))
        assert (beside < 0.5 * alone).all()
    assert max(map(abs, now["side by side, ideal"])) < 1e-3


def test_points_that_nobody_spins_say_so():
    sheet = sl.recipe.load_recipe("pan-dmf")
    found = fibre_window(sheet, voltage=[15e3, 9e5])
    words = found["remark"].isel(interval=1).values.ravel()
    assert words[0] == ""
    assert "air breaks down" in words[1]
    assert (found["status"] == 0).all()
    from spinline.report.window_page import window_page

    assert "air breaks down" in window_page(found)


def test_percent_without_a_sign_are_recognised(spinline):
    done = spinline("fibre", "pan-dmf", "--set", "solution.concentration=10")
    assert '"10 wt%"' in done.err
    assert '"45 %"' in spinline("fibre", "pan-dmf", "--set", "ambient.relative_humidity=45").err
    assert "wt%" not in spinline("fibre", "pan-dmf", "--set", "solution.concentration=-1").err


# what nobody spins, and where a recipe's own words are wrong: a remark or a named answer, never a bare number


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (["solution.conductivity=1e3 S/m"], "1e+03 S/m is out of"),
        (["solution.viscosity=1e-6 Pa s"], "1e-06 Pa s is out of"),
        (["solution.surface_tension=1 mN/m"], "0.001 N/m is out of"),
        (["jet.current=1e-14 A"], "1e-14 A is out of"),
        (["ambient.temperature=-10 degC"], "263.1 K is out of"),
        (["jet.flow_rate=1e-15 mL/hour"], "a few chains side by side"),
        (["measured.fibre_diameter=1 m"], "standard deviations from what its recipe lets expect: check its units"),
        (["solution.viscosity=1 +/- 100 Pa s"], "a spread wider than itself"),
        (["solution.solvent=water", "solution.polymer=PEO", "ambient.relative_humidity=99 %"], "computed as at 97 %"),
    ],
)
def test_what_nobody_spins_is_said(changes, words):
    found = sl.fibre(sl.recipe.load_recipe("pan-dmf", changes), shares=False)
    assert np.isfinite(found.fibre_diameter)
    assert any(words in remark for remark in found.remarks)
    assert not any(words in remark for remark in sl.fibre("pan-dmf", shares=False).remarks)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("solution.solvent={DMF=0.5,acetone=nan}", "solution.solvent.acetone = nan: should be a finite number"),
        ("solution.solvent={DMF=0.5,acetone=0.4}", "do not add up to 1"),
        ("measured.fibre_diameter=nan nm", "measured.fibre_diameter = 'nan nm': is not finite"),
        ("jet.voltage=0 V", "jet.voltage = '0 V': is out of range"),
        ("jet.flow_rate=0 mL/hour", "jet.flow_rate = '0 mL/hour': is out of range"),
        ("solution.concentration=100 wt%", "solution.concentration = '100 wt%': is out of range"),
    ],
)
def test_refusals_name_the_key_of_the_file(spinline, change, words):
    done = spinline("fibre", "pan-dmf", "--set", change)
    assert done.code == 2
    assert words in done.err
    assert "problems" not in done.err
    assert "OfRecipe" not in done.err


def test_a_spread_is_that_of_a_log_normal():
    wide = sl.recipe.load_recipe("pan-dmf", ["solution.viscosity=1 +/- 0.5 Pa s"]).recipe()
    assert wide.spread["viscosity"] == pytest.approx(np.log(1.25) ** 0.5)
    shares = sl.recipe.load_recipe("pan-dmf", ["solution.solvent={DMF=0.5,acetone=0.49}"]).recipe().solvent
    assert sum(shares.values()) == pytest.approx(1, abs=1e-15)
