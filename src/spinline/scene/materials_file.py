"""A user's own polymers and solvents: a TOML file that a scene names, in the words of the scene's own tables.

::

    [polymers.PEOX]                      # solution.polymer = "PEOX"
    density = "1.14 g/cm3"
    repeat_unit_molar_mass = "99.13 g/mol"
    backbone_bonds = 3
    kuhn_length = "1.2 nm"
    glass_transition = "60 degC"
    source = "Smith et al. (2020)"

    [solvents.limonene]
    density = "0.84 g/cm3"
    vapour_pressure = "200 Pa"
"""

import difflib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

from pydantic import Field, ValidationError

from spinline.base.errors import InputError
from spinline.base.text import read_toml_text
from spinline.scene.problems import explain
from spinline.scene.quantities import Section
from spinline.scene.sections import PolymerData, Scene, SolventData

__all__ = ["MaterialsFile", "own_materials", "read_materials"]

_LONGEST = 1_000_000


class OwnPolymer(PolymerData):
    """``[polymers.NAME]``."""

    source: str = "given by the user"


class OwnSolvent(SolventData):
    """``[solvents.NAME]``."""

    source: str = "given by the user"


class MaterialsFile(Section):
    """A materials file."""

    polymers: Annotated[dict[str, OwnPolymer], Field(default_factory=dict)]
    solvents: Annotated[dict[str, OwnSolvent], Field(default_factory=dict)]


def read_materials(path: str | Path) -> MaterialsFile:
    """Read a file of materials.

    Raises
    ------
    InputError
        For a file that cannot be read, and for any key or value that cannot be right.
    """
    place = Path(path)
    data, _ = read_toml_text(
        path, "file of materials", _LONGEST, remedy="it is TOML: [polymers.NAME] and [solvents.NAME]"
    )
    try:
        found = MaterialsFile.model_validate(data)
    except ValidationError as error:
        raise explain(error, place.name, data, MaterialsFile) from None
    for kind in (found.polymers, found.solvents):
        for name, own in kind.items():
            if "name" not in own.model_fields_set:
                kind[name] = own.model_copy(update={"name": name})  # type: ignore[assignment]
    return found


def own_materials(scene: Scene) -> Scene:
    """The scene with the polymer and the solvent that its materials file has in place of their names.

    A mixture may not hold a solvent of one's own: its parts come from the library.
    """
    s = scene.solution
    if s.materials is None:
        return scene
    from spinline.rheology.materials import POLYMERS, SOLVENTS

    found = read_materials(scene.folder / s.materials)
    update: dict[str, object] = {"materials": None}
    _known("polymer", s.polymer, found.polymers, POLYMERS)
    _known("solvent", s.solvent, found.solvents, SOLVENTS)
    if isinstance(s.polymer, str) and s.polymer in found.polymers:
        update["polymer"] = found.polymers[s.polymer]
    if isinstance(s.solvent, str) and s.solvent in found.solvents:
        update["solvent"] = found.solvents[s.solvent]
    if isinstance(s.solvent, dict):
        own = sorted(set(s.solvent) & set(found.solvents))
        if own:
            raise InputError(
                "solution.solvent",
                "is a mixture with a solvent of your own",
                value=own[0],
                remedy="give solvent_density and saturation, or one solvent",
            )
    copy = scene.model_copy(update={"solution": s.model_copy(update=update)})
    copy._text, copy._folder, copy._name = scene.text, scene.folder, scene.name
    return copy


def _known(key: str, name: object, own: Mapping[str, object], library: Mapping[str, object]) -> None:
    """Refuse a name that is neither in the file nor in the library, with the nearest of both."""
    from spinline.rheology.names import known_as

    if not isinstance(name, str) or name in own or known_as(name, library) is not None:
        return
    every = [*own, *library]
    near = difflib.get_close_matches(name, every, n=1)
    raise InputError(
        f"solution.{key}",
        "is neither in the file of materials nor built in",
        value=name,
        allowed=", ".join(every),
        remedy=f"did you mean {near[0]!r}?" if near else "add it to the file",
    )
