"""What the documents promise: commands, notebooks, citation, scenes, packages, and pages that keep up with the code."""

import ast
import contextlib
import json
import re
import tomllib
from pathlib import Path

import pytest

import spinline
from spinline.images import bundled_images
from spinline.recipe.recipe_file import bundled_recipes
from spinline.scene import bundled_scenes, json_schema

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
PAGES = sorted((ROOT / "docs").rglob("*.md"))
TEXTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *PAGES]
COMMANDS = {
    "run",
    "crossover",
    "check",
    "cite",
    "plan",
    "trade",
    "scenes",
    "schema",
    "fit-jet",
    "import-jet",
    "sweep",
    "window",
    "compare",
    "fit",
    "compare-theory",
    "preview",
    "reduce",
    "exposure",
    "simulate-image",
    "fibre",
    "jet",
    "spin",
    "deposit",
    "mat",
}


def blocks(path, language):
    text = path.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize(
    "command",
    [
        "python3 -m venv .venv && .venv/bin/pip install . && .venv/bin/spinline run peo5-water",
        'python3 -m venv .venv && .venv/bin/pip install ".[test]" && .venv/bin/pytest',
    ],
)
def test_readme_has_the_command_on_a_line_of_its_own(command):
    assert README.splitlines().count(command) == 1


def test_readme_picture_is_small_and_there():
    (picture,) = re.findall(r"!\[.*?\]\((.*?)\)", README)
    assert picture == "docs/images/peo5-water.png"
    content = (ROOT / picture).read_bytes()
    assert content.startswith(b"\x89PNG")
    assert len(content) < 150_000


def test_scenes_in_the_documents_are_bundled():
    named = {
        name
        for path in TEXTS
        for name in re.findall(
            r"spinline (?:run|crossover|check|preview|reduce|exposure|scenes --copy) ([\w-]+)(?![\w.-])",
            path.read_text("utf-8"),
        )
    }
    assert {"peo5-water", "pvp-jetspin"} <= named
    assert named <= set(bundled_scenes()) | set(bundled_images()) | set(bundled_recipes())


def test_commands_in_the_documents_exist():
    named = {
        name for path in TEXTS for name in re.findall(r"^\$ spinline ([a-z-]+)", path.read_text("utf-8"), re.MULTILINE)
    }
    assert "run" in named
    assert {word for word in named if not word.startswith("--")} <= COMMANDS


def test_every_command_has_its_help_on_the_page():
    typer = pytest.importorskip("typer.main")
    from spinline.cli import app

    assert set(typer.get_command(app).commands) == COMMANDS
    assert set(re.findall(r"```\{command-help\} (.+)", (ROOT / "docs/cli.md").read_text("utf-8"))) == COMMANDS


def test_every_key_of_an_images_file_is_on_the_page():
    from spinline.images import Images

    page = (ROOT / "docs/howto/reduce.md").read_text("utf-8")
    rows = {key for line in re.findall(r"^\| (`.*?) \|", page, re.MULTILINE) for key in re.findall(r"`(\w+)`", line)}
    assert set(Images.model_fields) <= rows


def test_every_section_of_a_scene_is_on_the_page():
    shown = re.findall(r"```\{scene-keys\} (\w+)", (ROOT / "docs/scene.md").read_text("utf-8"))
    assert sorted(shown) == sorted(["Scene", *json_schema()["$defs"]])


def test_scene_of_the_readme_is_valid():
    (text,) = blocks(ROOT / "README.md", "toml")
    scene = spinline.scene.scene_from_dict(tomllib.loads(text))
    assert scene.solution.mass_fraction.value == 0.05


def test_python_of_the_readme_prints_what_it_says(capsys):
    (code,) = blocks(ROOT / "README.md", "python")
    exec(compile(code, "README.md", "exec"), {})
    printed = capsys.readouterr().out.splitlines()
    said = re.findall(r"^print\(.*\)  # (.*)$", code, re.MULTILINE)
    assert printed == said
    assert len(said) == 2


@pytest.mark.parametrize(
    ("command", "scene"),
    [("crossover", "peo5-water"), ("run", "pvp-jetspin"), ("run", "pmma10-drying"), ("fibre", "pan-dmf")],
)
def test_output_in_the_readme_is_that_of_the_command(command, scene, spinline):
    shown = README.split(f"$ spinline {command} {scene}\n", 1)[1].split("```", 1)[0]
    assert spinline(command, scene).out == shown


def test_the_voltage_step_of_the_page_prints_what_it_says(capsys):
    page = ROOT / "docs/physics/network.md"
    (code,) = blocks(page, "python")
    exec(compile(code, str(page), "exec"), {})
    said = capsys.readouterr().out
    assert said in blocks(page, "text")
    assert [float(line.split()[2]) for line in said.splitlines()][-1] > 10.2


def test_jets_of_the_how_to_page_run(spinline, tmp_path):
    page = ROOT / "docs/howto/own-jet.md"
    profile, beads = blocks(page, "text")
    (tmp_path / "profile.csv").write_text(profile, encoding="utf-8")
    (tmp_path / "beads.csv").write_text(beads, encoding="utf-8")
    for number, jet in enumerate(blocks(page, "toml")):
        solution = '[solution]\npolymer = "PEO"\nsolvent = "water"\nmass_fraction = 0.05\n'
        (tmp_path / f"{number}.toml").write_text(solution + jet, encoding="utf-8")
        ran = spinline("crossover", f"{number}.toml")
        assert ran.code == 0
        assert ran.out.startswith("fully stretched at")


def test_the_notebooks_are_those_of_the_index():
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    assert len(NOTEBOOKS) >= 2
    assert all(f"notebooks/{path.stem}" in index for path in NOTEBOOKS)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_holds_no_outputs(path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    assert notebook["metadata"]["kernelspec"]["name"] == "python3"
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells)
    code = "\n".join("".join(cell["source"]) for cell in cells)
    assert sum(isinstance(node, ast.Assert) for node in ast.walk(ast.parse(code))) >= 5


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs_from_any_folder(path, tmp_path, monkeypatch):
    pytest.importorskip("IPython")
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.chdir(tmp_path)
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    import matplotlib.pyplot as plt

    with pytest.warns(spinline.SpinlineWarning) if "pvp-jetspin" in code else contextlib.nullcontext():
        exec(compile(code, path.name, "exec"), {})
    plt.close("all")


def test_versions_agree():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    version = spinline.__version__
    assert f"\nversion: {version}\n" in citation
    assert f"## [{version}] - " in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    date = re.search(rf"## \[{re.escape(version)}\] - (.*)", (ROOT / "CHANGELOG.md").read_text("utf-8"))[1]
    assert f"\ndate-released: {date}\n" in citation
    assert tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"] == version


def test_citation_has_what_the_format_requires():
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    try:
        import yaml
    except ImportError:
        for line in ("cff-version: 1.2.0", "message: ", "title: ", "authors:", '  - name: "The spinline developers"'):
            assert f"\n{line}" in f"\n{text}"
        return
    data = yaml.safe_load(text)
    assert str(data["cff-version"]) == "1.2.0"
    assert data["authors"] == [{"name": "The spinline developers"}]
    assert {"message", "title", "version", "date-released", "license"} <= set(data)


def test_packages_in_the_project_file_are_those_of_the_tree():
    tool = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
    found = {"spinline": "src/spinline"}
    for top in ("network", "xray", "rheology", "jetprofile", "deposit"):
        for file in sorted((ROOT / top).rglob("__init__.py")):
            folder = file.parent.relative_to(ROOT).as_posix()
            found[f"spinline.{folder.replace('/', '.')}"] = folder
    source = ROOT / "src" / "spinline"
    for file in sorted((*source.glob("*/__init__.py"), *source.glob("*/*/__init__.py"))):
        folder = file.parent.relative_to(source)
        if not (source / folder.parts[0]).is_symlink():
            found[f"spinline.{'.'.join(folder.parts)}"] = f"src/spinline/{folder.as_posix()}"
    assert tool["package-dir"] == found
    assert sorted(tool["packages"]) == sorted(found)
