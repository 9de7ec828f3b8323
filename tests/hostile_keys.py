"""Every number that a file of input may hold, made wrong in every way; the keys come from the schema of the file.

cases = hostile(RecipeSheet, "recipe")       # "jet.gap": '"-1 cm"', and so on
verdict = judged(run(*words, "--set", f"{case.key}={case.value}"), case)
"""

import re
import signal
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Any

PATIENCE = 20.0  # s of processor time, after which a command is said to hang
CODES = {0: "answered", 2: "refused"}


@dataclass(frozen=True)
class Case:
    """One key with one value, as TOML; `how` is what is wrong with it."""

    key: str
    how: str
    value: str

    def __str__(self) -> str:
        return f"{self.key} {self.how}"


@dataclass(frozen=True)
class Command:
    """A command that takes ``--set``, and the sheet whose keys it takes: its module and name, the profile of its jet."""

    where: str
    profile: str
    words: tuple[str, ...]

    def sheet(self) -> Any:
        """The class of the checked file."""
        module, _, name = self.where.partition(":")
        return getattr(import_module(module), name)


_VOLTAGE = ("--voltage", "10 kV .. 20 kV", "--steps", "2", "--no-figure", "--force")
COMMANDS = {
    "deposit": Command("spinline.scene.mat_file:MatScene", "", ("deposit", "lay.toml", "--force")),
    "window of a recipe": Command("spinline.recipe.recipe_file:RecipeSheet", "", ("window", "pan-dmf", *_VOLTAGE)),
    "window of a scene": Command(
        "spinline.scene.sections:Scene",
        "power-law",
        ("window", "peo5-water", *_VOLTAGE, "--gap", "15 cm", "--conductivity", "0.01 S/m"),
    ),
    "spin": Command(
        "spinline.scene.sections:Scene",
        "spun",
        ("spin", "pvp-spun", "--time", "0.2 ms", "--quick", "--frames", "2", "--force"),
    ),
}


class Hang(BaseException):
    """No command catches it."""


def hostile(sheet: Any, profile: str) -> Iterator[Case]:
    """Cases of a checked file; of its jets those of one profile."""
    schema = sheet.model_json_schema()
    for key, unit in _numbers(schema, schema, profile, ()):
        name = ".".join(key)
        for number in ("-1", "0", "nan", "1e300"):
            yield Case(name, number, f'"{number} {unit}"' if unit else number)
        yield Case(name, "wrong unit", '"3 A2 K5"')
        yield Case(name, "text", '"as much as it takes"')
        yield Case(name, "list", "[1.0, 2.0]")
        # a letter twice: no key of any section is spelt so
        yield Case(f"{name}{name[-1]}", "misspelt", f'"1 {unit}"' if unit else "1")


def _numbers(
    node: dict[str, Any], schema: dict[str, Any], profile: str, key: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], str]]:
    """Keys that take a number, each with its unit ("" where it has none)."""
    if "$ref" in node:
        node = schema["$defs"][node["$ref"].rpartition("/")[2]]
    own = node.get("properties", {}).get("profile", {}).get("const")
    if own not in (None, profile):
        return
    for name, child in node.get("properties", {}).items():
        yield from _numbers(child, schema, profile, (*key, name))
    choices = [node, *node.get("anyOf", []), *node.get("oneOf", [])]
    found = [choice for choice in choices if "examples" in choice or choice.get("type") in ("number", "integer")]
    if found:
        example = str(found[0].get("examples", [""])[0])
        yield key, example.partition(" ")[2]
        return
    for choice in choices[1:]:
        yield from _numbers(choice, schema, profile, key)


def judged(code: int, said: str, case: Case) -> str:
    """ "answered", "refused" with the key's name, or what is wrong with what was said."""
    if "Traceback" in said or code not in CODES:
        return f"status {code}: {said.strip()[-200:]}"
    *section, named = case.key.rsplit(".", 1)
    if code == 2 and not re.search(rf"error: .*\b({re.escape(named)}\b|{re.escape(section[0])}\.)", said, re.DOTALL):
        return f"its refusal names neither key nor section: {said.strip()[-300:]}"
    return CODES[code]


def stopped_after(seconds: float, command: Any, *words: str) -> Any:
    """What a command did, or `Hang` after so much processor time."""

    def stop(*_: object) -> None:
        raise Hang(" ".join(words))

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        return command(*words)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)
