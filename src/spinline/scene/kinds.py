"""Which of the files that spinline reads one is, so that another kind than asked for leads on to its command."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from spinline.base.errors import InputError

__all__ = ["bundled_elsewhere", "is_meant", "kind_of"]


@dataclass(frozen=True)
class _Kind:
    """Where the bundled ones are, and the command that takes them."""

    bundled: str
    command: str


_KINDS: Mapping[str, _Kind] = {
    "scene": _Kind("scenes/*.toml", "spinline run"),
    "recipe": _Kind("recipes/*.toml", "spinline fibre"),
    "file of images": _Kind("images/*.toml", "spinline reduce"),
    "sweep": _Kind("sweeps/*.toml", "spinline sweep"),
    "fit": _Kind("fits/*/fit.toml", "spinline fit"),
    "file of laydown": _Kind("laydowns/*.toml", "spinline deposit"),  # none is bundled
}


def kind_of(data: Mapping[str, Any]) -> str | None:
    """The kind of file that has such tables, by keys that no other has; None where they do not tell."""
    if "vary" in data:
        return "sweep"
    if {"counts", "positions"} & data.keys():
        return "file of images"
    if "data" in data and "scene" in data:
        return "fit"
    if "laydown" in data and "jet" not in data:
        return "file of laydown"
    jet = data.get("jet")
    if not isinstance(jet, Mapping):
        return None
    if "profile" in jet:
        return "scene"
    return "recipe" if "voltage" in jet else None


def is_meant(data: Mapping[str, Any], noun: str, name: str) -> None:
    """Refuse tables of another kind than `noun`, with the command that takes them."""
    kind = kind_of(data)
    if noun in _KINDS and kind not in (None, noun):
        raise _other(name, str(kind), noun)


def bundled_elsewhere(name: str, noun: str) -> None:
    """Refuse a name that is a bundled one of another kind than `noun`, with the command that takes it."""
    folder = Path(str(resources.files("spinline") / "data"))
    for kind, where in _KINDS.items():
        found = folder.glob(where.bundled)
        if kind != noun and name in {path.parent.name if path.stem == "fit" else path.stem for path in found}:
            raise _other(name, f"bundled {kind}", noun)


def _other(name: str, kind: str, noun: str) -> InputError:
    command = _KINDS[kind.removeprefix("bundled ")].command
    profile = '; the jet of a scene has a profile, for example "needle"' if (kind, noun) == ("recipe", "scene") else ""
    return InputError(name, f"is a {kind}, not a {noun}", remedy=f"`{command} {name}`{profile}")
