"""Scene keys as a sweep sees them: where they live, which quantity they hold, and how a value gets into a scene.

A key is "section.name" ("jet.k"), as on the command line with ``--set``; "model" and "rtol" stand for "network.model" and
"accuracy.rtol". Its kind (length, number ...) and range are those of the scene file, found in the models of `scene`.
"""

import difflib
import typing
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

from pydantic import BaseModel
from pydantic_core import PydanticCustomError

from spinline.base.errors import InputError
from spinline.base.units import QUANTITIES, Measured
from spinline.rheology.constitutive import LAWS
from spinline.scene.file import JET_SECTIONS, Scene
from spinline.scene.quantities import Read

__all__ = ["full_key", "is_section", "placed", "read_value", "reader", "unit_of"]

_SHORT = {"model": "network.model", "rtol": "accuracy.rtol"}
_DISPLACED = {  # a varied key takes the place of these
    "solution.mass_fraction": ("solution.volume_fraction", "solution.concentration"),
    "solution.volume_fraction": ("solution.mass_fraction", "solution.concentration"),
    "solution.concentration": ("solution.mass_fraction", "solution.volume_fraction"),
    "jet.k": ("jet.electric_field", "jet.conductivity"),
    "jet.electric_field": ("jet.k",),
    "jet.conductivity": ("jet.k",),
}


def full_key(key: str, field: str) -> str:
    """The key of the scene file that is meant.

    Raises
    ------
    InputError
        For a key that no scene has, with the nearest that one has.
    """
    name = _SHORT.get(key.strip(), key.strip())
    if name in _known():
        return name
    near = difflib.get_close_matches(name, _known(), n=1)
    by_name = [known for known in _known() if known.endswith("." + name)]
    hint = (by_name or near or ["jet.k"])[0]
    raise InputError(
        field,
        "is not a key of a scene",
        value=key,
        allowed="section.key of the scene file",
        remedy=f'did you mean "{hint}"?',
    )


def is_section(name: str) -> bool:
    """Whether a name is that of a table of the scene file."""
    return name not in _known() and any(key.startswith(f"{name}.") for key in _known())


def reader(key: str) -> Read | type | None:
    """How a key's numbers are read: a quantity, a bare number, or None for words, switches and tables."""
    how: Read | type | None = _known()[key]
    return how


def unit_of(key: str) -> str:
    """SI unit of a key's numbers; empty for words."""
    how = _known()[key]
    if isinstance(how, Read):
        return QUANTITIES[how.kind].unit.replace("^", "").replace("*", " ") or "1"
    return "" if how is None else "1"


def read_value(key: str, value: Any, field: str, *, ranged: bool = True, exact: bool = False) -> Any:
    """A value of a key as a float in SI, or as it stands where the key holds words.

    Parameters
    ----------
    key : str
        Of the scene.
    value : object
        As in a scene file.
    field : str
        Name shown in errors.
    ranged : bool
        Refuse what is out of the key's range.
    exact : bool
        Refuse an uncertainty, which would be lost.

    Raises
    ------
    InputError
        For a quantity that cannot be read, or is out of range.
    """
    how = _known()[key]
    words = _words(key)
    if isinstance(value, str) and value in words:
        return value
    if how is None:
        if words and not isinstance(value, bool):
            allowed = ", ".join(f'"{word}"' for word in words)
            raise InputError(field, "is not known", value=value, allowed=allowed, remedy="take one of those")
        return value
    if isinstance(how, Read):
        try:
            measured = how(value)
        except PydanticCustomError as error:
            context = error.context or {}
            if error.type == "range" and not ranged:
                from spinline.base.units import parse

                return parse(value, how.kind, field).value
            raise InputError(
                field,
                error.message(),
                value=value,
                allowed=context.get("allowed", ""),
                remedy=context.get("remedy") or "change it in the sweep",
            ) from None
        if exact and measured.std > 0:
            raise InputError(
                field,
                "varies, and carries an uncertainty besides",
                value=value,
                remedy="drop the +/-; a key of the base scene that does not vary may carry one",
            )
        return measured.value
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(field, "is not a number", value=value, remedy="write it bare, without quotes")
    return value


def placed(data: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """The scene's tables with values put in; what they displace (``volume_fraction`` for ``mass_fraction``) is gone.

    Parameters
    ----------
    data : mapping
        Tables of the base scene; left as they are.
    values : mapping
        Key to value; floats of quantities are in SI.
    """
    result = dict(data)
    touched: set[str] = set()
    for key, value in values.items():
        section, _, name = key.partition(".")
        if not name:
            result[section] = value
            continue
        if section not in touched:
            result[section] = dict(result.get(section) or {})
            touched.add(section)
        table = result[section]
        for other in _DISPLACED.get(key, ()):
            if other not in values:
                table.pop(other.partition(".")[2], None)
        how = _known().get(key)
        if isinstance(how, Read) and isinstance(value, float):
            value = Measured(value, 0.0, repr(value))
        elif how is int and isinstance(value, float) and value.is_integer():
            value = int(value)
        table[name] = value
    return result


def _known() -> dict[str, Any]:
    """Every key of every form of a scene, and how it is read."""
    return _keys(tuple(JET_SECTIONS), tuple(LAWS))


@lru_cache(maxsize=4)
def _keys(profiles: tuple[str, ...], laws: tuple[str, ...]) -> dict[str, Any]:
    keys: dict[str, Any] = {}
    for section, field in Scene.model_fields.items():
        models = list(_models(field.annotation, field.metadata))
        if not models:
            keys[section] = None
        for model in models:
            for name, inner in model.model_fields.items():
                keys.setdefault(f"{section}.{name}", _how(inner.annotation, inner.metadata))
    return keys


def _models(annotation: Any, metadata: Any = ()) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in typing.get_args(annotation):
        yield from _models(part)


def _how(annotation: Any, metadata: Any = ()) -> Any:
    """The `Read` in an annotation; float where it holds bare numbers; None otherwise."""
    for note in metadata:
        if isinstance(note, Read):
            return note
    if annotation in (float, int):
        return annotation
    if typing.get_origin(annotation) is dict:
        return None
    for part in (*getattr(annotation, "__metadata__", ()), *typing.get_args(annotation)):
        found = part if isinstance(part, Read) else None if isinstance(part, str) else _how(part)
        if found is not None:
            return found
    return None


def _words(key: str) -> tuple[str, ...]:
    """Words that a key takes beside its quantity ("solvent" of network.drag_viscosity)."""
    section, _, name = key.partition(".")
    words: list[str] = []
    for model in _models(Scene.model_fields[section].annotation):
        if name in model.model_fields:
            words += _literals(model.model_fields[name].annotation)
    return tuple(words)


def _literals(annotation: Any) -> list[str]:
    if typing.get_origin(annotation) is typing.Literal:
        return [word for word in typing.get_args(annotation) if isinstance(word, str)]
    return [word for part in typing.get_args(annotation) for word in _literals(part)]
