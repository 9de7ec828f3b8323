"""The house: how many files and lines a room may have, and which functions are long for a reason."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "spinline"
PHYSICS = sorted(path.name for path in PACKAGE.iterdir() if path.is_symlink())
ROOMS = sorted(path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists() and not path.is_symlink())
FILES = sorted(
    file for top in (*PHYSICS, "src") for file in (ROOT / top).rglob("*.py") if "__pycache__" not in file.parts
)
LOOP = "one compiled loop: its state would be passed through every part"
LIST = "options of one command, or settings of one call, in one place"
STAGES = "the stages of one march, in their order"
STEPS = 45  # statements: a function of fewer is only tall, one argument a line as the formatter sets them
LONG = {
    "_land": LOOP, "_solve": LOOP, "_uniform_part": LOOP, "advance": LOOP, "assemble": LOOP, "attempt": LOOP, "attempt_heat": LOOP,
    "march": LOOP, "march_explicit": LOOP, "march_implicit": LOOP, "parse_rows": LOOP, "rates": LOOP,
    "row_curvature": LOOP, "step": LOOP, "deposit": LIST, "fit_frame": LIST, "fit_row_phase": LIST, "follow": STAGES,
    "stokes_permeability": STAGES,
}  # fmt: skip


def test_the_package_itself_holds_few_files():
    assert len([path for path in PACKAGE.iterdir() if path.is_file()]) <= 6


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_is_no_larger_than_one_can_know(room):
    lines = sum(len(file.read_text("utf-8").splitlines()) for file in (PACKAGE / room).rglob("*.py"))
    assert lines <= 4000


@pytest.mark.parametrize("room", [*ROOMS, *PHYSICS])
def test_a_room_says_what_lives_there(room):
    tree = ast.parse((PACKAGE / room / "__init__.py").read_text("utf-8"))
    assert len(ast.get_docstring(tree) or "") > 30


def test_no_file_is_over_500_lines():
    assert [str(file.relative_to(ROOT)) for file in FILES if len(file.read_text("utf-8").splitlines()) > 500] == []


def test_long_functions_are_long_for_a_reason():
    found = {}
    for file in FILES:
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.FunctionDef):
                words = len((ast.get_docstring(node, clean=False) or "").splitlines())
                steps = sum(isinstance(part, ast.stmt) for part in ast.walk(node))
                if node.end_lineno - node.lineno + 1 - words > 60 and steps > STEPS:
                    found[node.name] = f"{file.relative_to(ROOT)}:{node.lineno}"
    assert {name: place for name, place in found.items() if name not in LONG} == {}
    assert set(LONG) <= set(found), "no longer long"


def test_formatting_is_left_to_the_formatter():
    skipped = sum(text.count("# fmt: " + "skip") for text in (file.read_text("utf-8") for file in FILES))
    assert skipped < 30
