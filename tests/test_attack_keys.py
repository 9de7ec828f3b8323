"""A sample of the keys and options of `deposit`, `mat`, `window` and `spin` made wrong: an answer, or one named refusal.

The whole (2,040 cases of keys) is `python benchmarks/attack.py keys`.
"""

import pytest
from hostile_keys import COMMANDS, PATIENCE, hostile, judged, stopped_after
from lay_text import lay_text


@pytest.mark.parametrize("name", COMMANDS)
def test_wrong_numbers_are_answered_or_refused_by_name(name, spinline, tmp_path) -> None:
    (tmp_path / "lay.toml").write_text(lay_text(), encoding="utf-8")
    command = COMMANDS[name]
    cases = list(hostile(command.sheet(), command.profile))
    assert len(cases) > 150
    for case in cases[3 :: 1 + len(cases) // 30]:  # of every command some thirty
        ran = stopped_after(PATIENCE, spinline, *command.words, "--set", f"{case.key}={case.value}")
        assert judged(ran.code, ran.err, case) in ("answered", "refused"), case


@pytest.mark.parametrize(
    ("words", "option"),
    [
        (("spin", "pvp-spun", "--seeds", "9" * 40), "--seeds"),
        (("spin", "pvp-spun", "--frames", "9" * 40), "--frames"),
        (("spin", "pan12-blown", "--frames", "0"), "--frames"),
        (("window", "pan-dmf", "--voltage", "10 kV .. 20 kV", "--k-factor", "as much"), "--k-factor"),
        (("mat", "l.h5", "--pixel-size", "5 nm"), "--pixel-size"),
        (("mat", "l.h5", "--measured-unit", "furlong"), "--measured-unit"),
    ],
)
def test_options_without_effect_or_bound_are_refused(words, option, spinline, tmp_path) -> None:
    ran = spinline(*words)
    assert ran.code == 2
    assert ran.err.startswith(f"error: {option}")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", ["run", "check", "fibre", "deposit"])
@pytest.mark.parametrize(
    "text",
    [
        "{name} = 1\n",
        "[jet]\n{name} = 1\n",
        '["{blanks}"]\nx = 1\n',
        '[jet]\nprofile = "{name}"\n',
        "[{name}]\nx = 1\n",
    ],
    ids=["section", "key", "blanks", "value", "table"],
)
def test_names_of_thousands_of_letters_are_shortened(command, text, spinline, tmp_path) -> None:
    (tmp_path / "long.toml").write_text(text.format(name="a" * 5000, blanks="a b " * 1500), encoding="utf-8")
    ran = spinline(command, "long.toml")
    assert ran.code == 2
    assert len(ran.err) < 1000
