"""Any TOML file of a user's: found, read, overrides applied, checked against its model."""

import difflib
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from spinline.base.errors import InputError
from spinline.base.text import parsed_toml, read_toml_text
from spinline.scene.kinds import bundled_elsewhere, is_meant
from spinline.scene.problems import explain
from spinline.scene.quantities import Sheet

__all__ = ["LONGEST", "apply_override", "checked", "given_file", "read_toml"]


_Sheet = TypeVar("_Sheet", bound=Sheet)


LONGEST = 1_000_000  # characters of a scene
_FEW = 3  # names that a message lists


def checked(model: type[_Sheet], data: Mapping[str, Any], text: str, folder: Path | None, name: str) -> _Sheet:
    """A sheet from nested dictionaries, or an error with every problem found."""
    try:
        sheet = model.model_validate(data)
    except ValidationError as error:
        raise explain(error, name, data, model) from None
    sheet._text, sheet._folder, sheet._name = text, folder or Path(), name
    return sheet


def read_toml(
    source: str | Path, bundled: Mapping[str, Path], overrides: Sequence[str], noun: str = "scene"
) -> tuple[dict[str, Any], str, Path]:
    """Content, text and path of a TOML file or of a bundled one of that name, overrides applied."""
    path = given_file(source, bundled)
    if not _there(path):
        bundled_elsewhere(str(source), noun)
    near = difflib.get_close_matches(str(source)[:200], bundled, n=1)
    some = f"bundled: {', '.join(bundled)}" if 0 < len(bundled) <= _FEW else "`spinline scenes` lists the bundled ones"
    if _there(path / "input.dat"):
        folder, own = (shlex.quote(str(name)) for name in (path, path / "input.dat"))
        near, some = (
            [],
            f"of a JETSPIN run: `spinline import-jet {folder}` reads its jet, `spinline spin {own}` spins it",
        )
    data, text = read_toml_text(path, noun, LONGEST, f"did you mean the bundled {near[0]!r}?" if near else some)
    is_meant(data, noun, str(source))
    for override in overrides:
        apply_override(data, override)
    if overrides:
        text = text.rstrip() + "\n" + "".join(f"# --set {override}\n" for override in overrides)
    return data, text, path


def given_file(source: str | Path, bundled: Mapping[str, Path]) -> Path:
    """The file of that name, else the bundled one."""
    return Path(source) if _there(source) else bundled.get(str(source), Path(source))


def _there(path: str | Path) -> bool:
    try:
        return Path(path).exists()
    except (OSError, ValueError):  # a name that no file can have
        return False


def apply_override(data: dict[str, Any], override: str) -> None:
    """Set one KEY=VALUE of nested dictionaries; text needs no quotes."""
    key, equals, value = override.partition("=")
    steps = [step.strip() for step in key.split(".")]
    if not equals or not all(steps) or "\n" in override:
        raise InputError("--set", "is not KEY=VALUE", value=override, remedy='for example --set "jet.radius=100 um"')
    try:
        parsed = parsed_toml(f"value = {value}", "--set", "value")["value"]
    except InputError:
        parsed = value.strip()
    for step in steps[:-1]:
        data = data.setdefault(step, {})
        if not isinstance(data, dict):
            raise InputError("--set", f"{step} is a value, not a section", value=override)
    data[steps[-1]] = parsed
