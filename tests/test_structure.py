"""The house: how many files and lines a room may have, and which functions are long for a reason."""

import ast
from functools import cache
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
    "_solve": LOOP, "_uniform_part": LOOP, "advance": LOOP, "_assemble": LOOP, "_attempt": LOOP, "attempt": LOOP,
    "march": LOOP, "march_envelope": LOOP, "march_explicit": LOOP, "march_implicit": LOOP, "rates": LOOP,
    "row_curvature": LOOP, "step": LOOP, "deposit": LIST, "fit_frame": LIST, "fit_row_phase": LIST, "follow": STAGES,
    "stokes_permeability": STAGES,
}  # fmt: skip


@cache
def parsed(file: Path) -> ast.Module:
    return ast.parse(file.read_text("utf-8"))


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


@pytest.mark.slow
def test_long_functions_are_long_for_a_reason():
    found = {}
    for file in FILES:
        for node in ast.walk(parsed(file)):
            if isinstance(node, ast.FunctionDef):
                words = len((ast.get_docstring(node, clean=False) or "").splitlines())
                steps = sum(isinstance(part, ast.stmt) for part in ast.walk(node))
                if node.end_lineno - node.lineno + 1 - words > 60 and steps > STEPS:
                    found[node.name] = f"{file.relative_to(ROOT)}:{node.lineno}"
    assert {name: place for name, place in found.items() if name not in LONG} == {}
    assert set(LONG) <= set(found), "no longer long"


def test_compiled_loops_set_slices_to_constants_only():
    """Of ``a[:] = b`` numba compiles the message for shapes that do not fit, too: 3 to 9 s at the first start."""
    found = []
    for file in FILES:
        for loop in ast.walk(parsed(file)):
            if isinstance(loop, ast.FunctionDef) and any("njit" in ast.dump(mark) for mark in loop.decorator_list):
                for part in ast.walk(loop):
                    targets = part.targets if isinstance(part, ast.Assign) else [getattr(part, "target", None)]
                    slices = any(isinstance(t, ast.Subscript) and "Slice(" in ast.dump(t.slice) for t in targets)
                    if slices and not isinstance(part.value, ast.Constant | ast.Attribute):  # 0.0, np.nan
                        found.append(f"{file.relative_to(ROOT)}:{part.lineno}")
    assert found == []


def test_formatting_is_left_to_the_formatter():
    skipped = sum(text.count("# fmt: " + "skip") for text in (file.read_text("utf-8") for file in FILES))
    assert skipped < 30


def imports(file: Path, name: str, names: set[str]) -> set[str]:
    """Modules of this project that one imports, wherever in it."""
    base = name.split(".") if file.name == "__init__.py" else name.split(".")[:-1]
    found = set()
    for node in ast.walk(parsed(file)):
        if isinstance(node, ast.ImportFrom):
            above = base[: len(base) - node.level + 1] if node.level else []
            source = ".".join([*above, *([node.module] if node.module else [])])
            found |= {f"{source}.{item.name}" if f"{source}.{item.name}" in names else source for item in node.names}
        elif isinstance(node, ast.Import):
            found |= {item.name for item in node.names}
    return (found & names) - {name}


def test_no_modules_import_each_other_in_a_ring():
    """Nor through others, nor within functions, nor for types alone: what no other imports is taken out until none is left."""
    files = {}
    for top in (*PHYSICS, "src/spinline"):
        for file in (ROOT / top).rglob("*.py"):
            steps = file.relative_to(ROOT if top in PHYSICS else ROOT / "src").with_suffix("").parts
            steps = ("spinline", *steps) if top in PHYSICS else steps
            files[".".join(steps[:-1] if steps[-1] == "__init__" else steps)] = file
    graph = {name: imports(file, name, set(files)) for name, file in files.items()}
    assert sum(map(len, graph.values())) > 1000
    while free := [name for name, below in graph.items() if not below]:
        for name in free:
            del graph[name]
        graph = {name: below - set(free) for name, below in graph.items()}
    assert sorted(graph) == []
