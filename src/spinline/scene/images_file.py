"""The images file: what an experimentalist writes beside the frames, checked, with every quantity in SI.

An images file is TOML, in the manner of a scene: quantities are text with their unit, unknown keys are refused and the nearest
known one is suggested, paths start from the file's folder. `load_images` reads a path or the name of a bundled set.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import (
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    model_validator,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from spinline.base.constants import KEV
from spinline.base.units import Measured
from spinline.scene.air_and_rheology import refusal
from spinline.scene.file import SolutionSection, checked, read_toml
from spinline.scene.quantities import Label, Length, Read, Sheet

__all__ = ["KEV", "Images", "Source", "bundled_images", "images_from_dict", "images_schema", "load_images"]


Energy = Annotated[Measured, Read("energy", 1.0 * KEV, 200.0 * KEV, closed=True, words="1 to 200 keV")]
MassAttenuation = Annotated[Measured, Read("mass attenuation", 0.0, 1e6)]
Distance = Annotated[Measured, Read("length", 0.0, 1e3, closed=True)]


@dataclass(frozen=True)
class Source:
    """Where a flat or dark field comes from: a file, a part of the frames (or of a file), or a number.

    Attributes
    ----------
    file : str or None
        None: the frames themselves.
    rows, columns : (int, int) or None
        First, and the one after the last; None: all.
    level : float or None
        A number for every pixel.
    """

    file: str | None = None
    rows: tuple[int, int] | None = None
    columns: tuple[int, int] | None = None
    level: float | None = None


@dataclass(frozen=True)
class _ReadSource:
    """Reads a `Source`: text (a file), a table (file, rows, columns), or a number where that makes sense."""

    number: bool = False

    def __call__(self, value: Any) -> Source:
        if isinstance(value, Source):
            return value
        if isinstance(value, str) and value.strip():
            return Source(file=value)
        if self.number and isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value < float("inf"):
            return Source(level=float(value))
        if isinstance(value, Mapping):
            return self._region(value)
        allowed = "a file name, { rows = [first, last] }, { columns = [first, last] }"
        raise _words("is not a file or a part of one", allowed + (", or a number" if self.number else ""))

    def _region(self, value: Mapping[str, Any]) -> Source:
        unknown = sorted(set(value) - {"file", "rows", "columns"})
        if unknown:
            raise _words(f"has an unknown key {unknown[0]!r}", "file, rows, columns")
        if "rows" not in value and "columns" not in value:
            raise _words("names no part of the frame", "rows = [first, last], columns = [first, last]")
        spans: dict[str, tuple[int, int]] = {}
        for key in ("rows", "columns"):
            span = value.get(key)
            if span is not None:
                if not (isinstance(span, list | tuple) and len(span) == 2 and all(type(i) is int for i in span)):
                    raise _words(f"{key} is not [first, last]", "two whole numbers, the second one after the last")
                if not 0 <= span[0] < span[1]:
                    raise _words(f"{key} is empty or starts before 0", "0 <= first < last")
                spans[key] = (int(span[0]), int(span[1]))
        file = value.get("file")
        if file is not None and not isinstance(file, str):
            raise _words("file is not text", "a file name")
        return Source(file=file, rows=spans.get("rows"), columns=spans.get("columns"))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        kinds = ["string", "object", *(["number"] if self.number else [])]
        words = "file, or part of the frame as { rows = [first, last], columns = [first, last] }"
        return {"type": kinds, "description": words + (", or a number" if self.number else "")}


def _words(problem: str, allowed: str) -> PydanticCustomError:
    return PydanticCustomError("range", "{problem}", {"problem": problem, "allowed": allowed, "remedy": ""})


def _span(value: Any) -> tuple[int, int]:
    if not (isinstance(value, list | tuple) and len(value) == 2 and all(type(i) is int for i in value)):
        raise _words("is not [first, last]", "two whole numbers, the second one after the last row")
    if not 0 <= value[0] < value[1]:
        raise _words("is empty or starts before 0", "0 <= first < last")
    return int(value[0]), int(value[1])


class _ReadSpan:
    """Reads a range of rows."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(_span)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"type": "array", "description": "[first row, row after the last]"}


Field_ = Annotated[Source, _ReadSource()]
FieldOrNumber = Annotated[Source, _ReadSource(number=True)]
Rows = Annotated[tuple[int, int], _ReadSpan()]


class Images(Sheet):
    """A checked images file. `text` and `folder` say where it came from."""

    title: Label = ""
    counts: str
    flat: Field_
    flat_after: Field_ | None = None
    dark: FieldOrNumber | None = None
    gain: Annotated[float, Field(gt=0)] | None = None
    saturation: Annotated[float, Field(gt=0)] | None = None
    bad_pixels: str | None = None
    transpose: bool = False
    pixel_size: Length | None = None
    nozzle_diameter: Length | None = None
    nozzle_rows: Rows | None = None
    energy: Energy | None = None
    spectrum: str | dict[str, float] | None = None
    coherent: bool = True
    polymer_attenuation: MassAttenuation | None = None
    solvent_attenuation: MassAttenuation | None = None
    propagation_distance: Distance | None = None
    blur: Annotated[Length | Literal["fit"], Field(union_mode="left_to_right")] | None = None
    calibration_rows: Rows | None = None
    frames: Literal["sum", "each"] = "sum"
    method: Literal["chord", "row", "map", "phase"] = "row"
    shells: Annotated[int, Field(ge=1, le=200)] = 5
    block_rows: Annotated[int, Field(ge=1)] = 1
    solution: SolutionSection

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if (self.pixel_size is None) == (self.nozzle_diameter is None):
            raise refusal("pixel_size", "give one of pixel_size and nozzle_diameter (with nozzle_rows)")
        if (self.nozzle_diameter is None) != (self.nozzle_rows is None):
            raise refusal("nozzle_rows", "goes with nozzle_diameter: the rows in which the nozzle is in view")
        given = self.polymer_attenuation is not None, self.solvent_attenuation is not None
        if given[0] != given[1]:
            raise refusal("polymer_attenuation", "goes with solvent_attenuation: give both or none")
        if not any(given) and (self.energy is None) == (self.spectrum is None):
            raise refusal("energy", "give one of energy and spectrum, or polymer_attenuation and solvent_attenuation")
        return self


def images_from_dict(
    data: Mapping[str, Any], *, text: str = "", folder: Path | None = None, name: str = "images"
) -> Images:
    """Check an images file given as nested dictionaries.

    Raises
    ------
    InputError
        With every problem found, one to a line.
    """
    return checked(Images, data, text, folder, name)


def load_images(source: str | Path, overrides: Sequence[str] = ()) -> Images:
    """Read an images file, or a bundled set by its name.

    Parameters
    ----------
    source : path or str
        A TOML file, or a name that `bundled_images` lists. A file of that name goes first.
    overrides : sequence of str
        ``"block_rows=10"``: TOML values that replace the file's; text needs no quotes.

    Returns
    -------
    Images

    Raises
    ------
    InputError
        For an unreadable file, TOML that does not parse, or any key or value that cannot be right.
    """
    data, text, path = read_toml(source, bundled_images(), overrides, "file of images")
    return images_from_dict(data, text=text, folder=path.resolve().parent, name=path.stem)


def bundled_images() -> dict[str, Path]:
    """Names of the bundled sets of images and their files."""
    folder = Path(str(resources.files("spinline") / "data" / "images"))
    return {file.stem: file for file in sorted(folder.glob("*.toml"))}


def images_schema() -> dict[str, Any]:
    """JSON Schema of the images file, for editors."""
    schema = Images.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "spinline images"}
