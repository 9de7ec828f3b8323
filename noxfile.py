"""Checks in fresh environments: `nox` runs the tests with the lowest and the highest versions allowed."""

import re
import tomllib
from pathlib import Path

import nox

nox.options.sessions = ["lowest", "highest", "lint"]
PROJECT = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]


def lowest_versions() -> list[str]:
    """Every ">=" of the dependencies turned into "=="."""
    wanted = [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["test"]]
    return [re.sub(r">=", "==", requirement) for requirement in wanted]


@nox.session
def lowest(session: nox.Session) -> None:
    """Tests with the lowest versions that pyproject.toml allows."""
    session.install(*lowest_versions())
    session.install(".[test]", *lowest_versions())
    session.run("pytest", "-m", "", *session.posargs)


@nox.session
def highest(session: nox.Session) -> None:
    """Tests with the newest versions there are."""
    session.install("--upgrade", ".[test]")
    session.run("pytest", "-m", "", *session.posargs)


@nox.session
def lint(session: nox.Session) -> None:
    """Form and types."""
    session.install(".[dev]")
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")
    session.run("mypy")


@nox.session
def docs(session: nox.Session) -> None:
    """Documentation, notebooks included; a warning is an error."""
    session.install(".[docs]")
    session.run("python", "-m", "sphinx", "-W", "--keep-going", "-b", "html", "docs", "docs/_build/html")
