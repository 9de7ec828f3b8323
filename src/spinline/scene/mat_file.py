"""A file of laydown and mat alone."""

from collections.abc import Sequence
from pathlib import Path

from spinline.scene.mat_sections import CollectorSection, JetsSection, LaydownSection, MatSection
from spinline.scene.quantities import Label, Sheet
from spinline.scene.sheets import checked, read_toml

__all__ = ["MatScene", "load_mat_scene"]


class MatScene(Sheet):
    """A file of laydown and mat alone."""

    title: Label = ""
    laydown: LaydownSection
    collector: CollectorSection
    jets: JetsSection = JetsSection()
    mat: MatSection = MatSection()


def load_mat_scene(source: str | Path, overrides: Sequence[str] = ()) -> MatScene:
    """Read a file of ``[laydown]``, ``[collector]``, ``[jets]`` and ``[mat]``."""
    data, text, path = read_toml(source, {}, overrides, "file of laydown")
    return checked(MatScene, data, text, path.resolve().parent, path.stem)
