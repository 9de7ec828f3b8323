"""What single keys of the images file may hold: sources of flat and dark, regions, parts of a stack, lengths in pixels."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from spinline.base.constants import KEV
from spinline.base.errors import InputError
from spinline.base.units import Measured, parse
from spinline.scene.quantities import Read

__all__ = ["Frames", "Reach", "Region", "Source"]

Energy = Annotated[Measured, Read("energy", 1.0 * KEV, 200.0 * KEV, closed=True, words="1 to 200 keV")]
MassAttenuation = Annotated[Measured, Read("mass attenuation", 0.0, 1e6)]
Distance = Annotated[Measured, Read("length", 0.0, 1e3, closed=True)]
Offset = Annotated[Measured, Read("length", -1e3, 1e3, closed=True)]
Tilt = Annotated[Measured, Read("angle", -np.pi / 3, np.pi / 3, closed=True, words="-60 to 60 deg")]
Depth = Annotated[Measured, Read("number", 0.5, 2.0, closed=True)]
Linearity = Annotated[Measured, Read("number", -0.2, 0.2, closed=True)]
Share = Annotated[Measured, Read("fraction", 0.0, 0.8, closed=True)]


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


@dataclass(frozen=True)
class Region:
    """A part of every frame: first row (column), and the one after the last; None: all.

    Attributes
    ----------
    rows, columns : (int, int) or None
    """

    rows: tuple[int, int] | None = None
    columns: tuple[int, int] | None = None

    @property
    def slices(self) -> tuple[slice, slice]:
        """The same for arrays."""
        rows, columns = (slice(*span) if span else slice(None) for span in (self.rows, self.columns))
        return rows, columns


class _ReadRegion:
    """Reads ``{ rows = [first, last], columns = [first, last] }``."""

    def __call__(self, value: Any) -> Region:
        if isinstance(value, Region):
            return value
        if not isinstance(value, Mapping) or not value or set(value) - {"rows", "columns"}:
            raise _words("is no part of a frame", "{ rows = [first, last], columns = [first, last] }")
        return Region(*(None if value.get(key) is None else _span(value[key]) for key in ("rows", "columns")))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"type": "object", "description": "{ rows = [first, last], columns = [first, last] }"}


@dataclass(frozen=True)
class Frames:
    """Which frames are reduced, and how.

    Attributes
    ----------
    each : bool
        One by one; else their sum.
    part : slice
        Of the stack.
    text : str
    """

    each: bool
    part: slice
    text: str

    def __eq__(self, other: object) -> bool:
        """Whether it is the same text: ``images.frames == "each"``."""
        return self.text == (other.text if isinstance(other, Frames) else other)

    def __hash__(self) -> int:
        return hash(self.text)


class _ReadFrames:
    """Reads "sum", "each", or a part of the frames as "10:30"."""

    def __call__(self, value: Any) -> Frames:
        if isinstance(value, Frames):
            return value
        words = _words("are neither all nor a part of them", '"sum", "each", or a part as "10:30" or "0:100:2"')
        if value in ("sum", "each"):
            return Frames(value == "each", slice(None), value)
        fields = str(value).split(":") if isinstance(value, str) else []
        try:
            numbers = [int(field) if field.strip() else None for field in fields]
        except ValueError:
            raise words from None
        if (
            len(numbers) not in (2, 3)
            or any(n is not None and n < 0 for n in numbers)
            or (numbers[2:] and numbers[2] == 0)
        ):
            raise words
        if numbers[0] is not None and numbers[1] is not None and numbers[1] <= numbers[0]:
            raise _words("leave no frame", "the second number is the frame after the last")
        return Frames(False, slice(*numbers), str(value))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"type": "string", "description": '"sum", "each", or a part of the frames as "10:30"', "default": "sum"}


@dataclass(frozen=True)
class Reach:
    """A length, in m or in pixels.

    Attributes
    ----------
    value, std : float
    pixels : bool
    text : str
    """

    value: float
    std: float
    pixels: bool
    text: str

    def metres(self, pixel: float) -> tuple[float, float]:
        """Value and standard deviation in m."""
        scale = pixel if self.pixels else 1.0
        return self.value * scale, self.std * scale


class _ReadReach:
    """Reads a length: text with a unit, or a number of pixels ("20", "20 +/- 2 px")."""

    def __call__(self, value: Any) -> Reach:
        if isinstance(value, Reach):
            return value
        text = str(value).strip()
        plain = re.sub(r"(?<![^\W\d])(?:pixels|px)\b", "", text).strip()
        for kind, words, pixels in (("number", plain, True), ("length", text, False)):
            try:
                measured = parse(words, kind, "")
            except InputError:
                continue
            if measured.value > 0.0 and not isinstance(value, bool):
                return Reach(measured.value, measured.std, pixels, text)
        raise _words("is no length", '> 0, such as "13 um", or a number of pixels, "20 +/- 2 px"; or "fit"')

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"type": ["string", "number"], "description": "length, or a number of pixels", "examples": ["20 px"]}


Field_ = Annotated[Source, _ReadSource()]
FieldOrNumber = Annotated[Source, _ReadSource(number=True)]
Rows = Annotated[tuple[int, int], _ReadSpan()]
FramesField = Annotated[Frames, _ReadFrames()]
RegionField = Annotated[Region, _ReadRegion()]
ReachField = Annotated[Reach, _ReadReach()]
Fit = Literal["fit"]
