"""Advice that leads on: every command, option and scene key that a message names exists."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest
import typer.main

from spinline.cli import app
from spinline.recipe.recipe_file import RecipeSheet
from spinline.scene.file import JET_SECTIONS, Scene
from spinline.scene.images_file import Images

ROOT = Path(__file__).parents[1]
FOLDERS = ("src/spinline", "network", "xray", "rheology", "jetprofile", "deposit")
COMMANDS = typer.main.get_command(app).commands
OPTIONS = {option for command in COMMANDS.values() for param in command.params for option in param.opts} | {
    "--help",
    "--version",
    "--install-completion",
    "--show-completion",
}
OTHERS = {"--force-reinstall"}


@cache
def said():
    """Text in the code that is no docstring: file and literal."""
    found = []
    for folder in FOLDERS:
        for file in sorted((ROOT / folder).rglob("*.py")):
            if "__pycache__" in file.parts or file.name == "moved.py":  # a table of modules
                continue
            docs = set()
            for node in ast.walk(ast.parse(file.read_text("utf-8"))):  # what stands around a text comes before it
                if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                    if node.body and isinstance(node.body[0], ast.Expr):
                        docs.add(node.body[0].value)
                elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in docs:
                    found.append((file.relative_to(ROOT), node.value))
    return found


@pytest.mark.slow
def test_commands_that_are_named_exist():
    named = {(file, name) for file, text in said() for name in re.findall(r"`spinline ([a-z][a-z-]+)", text)}
    assert len(named) > 10
    assert [(str(file), name) for file, name in sorted(named) if name not in COMMANDS] == []


def test_options_that_are_named_exist():
    named = {(file, name) for file, text in said() for name in re.findall(r"(?<![\w-])--[a-z][a-z-]+", text)}
    assert len(named) > 10
    assert [(str(file), name) for file, name in sorted(named) if name not in OPTIONS | OTHERS] == []


def keys_of(model, prefix=""):
    """Dotted keys of a sheet of sections."""
    for name, field in model.model_fields.items():
        yield prefix + name
        kinds = [field.annotation, *getattr(field.annotation, "__args__", ())]
        for kind in kinds:
            if hasattr(kind, "model_fields"):
                yield from keys_of(kind, f"{prefix}{name}.")


def test_keys_that_are_named_exist():
    keys = {*keys_of(Scene), *keys_of(Images), *keys_of(RecipeSheet)}
    keys |= {key for section in JET_SECTIONS.values() for key in keys_of(section, "jet.")}
    sections = "solution|network|accuracy|effects|rheology|ambient"
    named = {
        (file, name)
        for file, text in said()
        for name in re.findall(rf"(?<![\w.\[])((?:{sections})\.[a-z_]+)(?![\w.(])", text)
    }
    assert len(named) > 10
    assert [(str(file), name) for file, name in sorted(named) if name not in keys] == []
