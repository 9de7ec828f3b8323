"""The images file: what an experimentalist writes beside the frames, checked, with every quantity in SI.

An images file is TOML, in the manner of a scene: quantities are text with their unit, unknown keys are refused and the nearest
known one is suggested, paths start from the file's folder. `load_images` reads a path or the name of a bundled set.
"""

from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from spinline.base.constants import KEV
from spinline.scene.air_and_rheology import refusal
from spinline.scene.file import SolutionSection, checked, read_toml
from spinline.scene.images_keys import (
    Depth,
    Distance,
    Energy,
    Field_,
    FieldOrNumber,
    Fit,
    Frames,
    FramesField,
    Linearity,
    MassAttenuation,
    Offset,
    ReachField,
    RegionField,
    Rows,
    Share,
    Source,
    Tilt,
)
from spinline.scene.quantities import Label, Length, Section, Sheet

__all__ = [
    "KEV",
    "Images",
    "Position",
    "Source",
    "bundled_images",
    "images_from_dict",
    "images_schema",
    "load_images",
]


class Position(Section):
    """One of the places along the jet that images were taken at."""

    counts: str
    flat: Field_ | None = None
    flat_after: Field_ | None = None
    dark: FieldOrNumber | None = None
    offset: Offset
    calibration_rows: Rows | None = None
    nozzle_rows: Rows | None = None

    @field_validator("counts")
    @classmethod
    def _named(cls, value: str) -> str:
        if not value.strip():
            raise refusal("counts", "names no file")
        return value


class Images(Sheet):
    """A checked images file. `text` and `folder` say where it came from."""

    title: Label = ""
    counts: str | None = None
    transmission: str | None = None
    absorbance: str | None = None
    i0: Annotated[float, Field(gt=0)] | None = None
    flat: Field_ | None = None
    flat_after: Field_ | None = None
    dark: FieldOrNumber | None = None
    gain: Annotated[float, Field(gt=0)] | None = None
    flat_frames: Annotated[int, Field(ge=1)] = 1
    flat_shape: Annotated[int, Field(ge=1, le=4)] | None = None
    linearity: Linearity | None = None
    saturation: Annotated[float, Field(gt=0)] | None = None
    bad_pixels: str | None = None
    transpose: bool = False
    roi: RegionField | None = None
    pixel_size: Length | None = None
    nozzle_diameter: Length | None = None
    nozzle_rows: Rows | None = None
    energy: Energy | None = None
    spectrum: str | dict[str, float] | None = None
    coherent: bool = True
    polymer_attenuation: MassAttenuation | None = None
    solvent_attenuation: MassAttenuation | None = None
    propagation_distance: Distance | None = None
    magnification: Annotated[float, Field(gt=0)] = 1.0
    blur: Annotated[Length | Fit, Field(union_mode="left_to_right")] | None = None
    tail_share: Annotated[Fit | Share, Field(union_mode="left_to_right")] | None = None
    tail_length: Annotated[Fit | ReachField, Field(union_mode="left_to_right")] | None = None
    tilt_out: Tilt | None = None
    depth: Depth | None = None
    calibration_rows: Rows | None = None
    frames: FramesField = Field(default_factory=lambda: Frames(False, slice(None), "sum"))
    method: Literal["chord", "row", "map", "phase"] = "row"
    shells: Annotated[int, Field(ge=1, le=200)] = 5
    block_rows: Annotated[int, Field(ge=1)] = 1
    positions: Annotated[tuple[Position, ...], Field(strict=False)] = ()
    solution: SolutionSection

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        given = [key for key in ("counts", "transmission", "absorbance") if getattr(self, key) is not None]
        if self.positions and given:
            raise refusal("positions", f"go with {given[0]} in each position, not at the top")
        if not self.positions and len(given) != 1:
            raise refusal("counts" if not given else given[-1], "give one of counts, transmission and absorbance")
        if given == ["counts"] and self.flat is None:
            raise refusal("flat", "is missing: frames without a jet, or the part of the frames that shows none")
        if given and given != ["counts"] and (self.flat is not None or self.dark is not None):
            raise refusal("flat", f"goes with counts: {given[0]} is over its flat already")
        if self.pixel_size is not None and self.nozzle_diameter is not None:
            raise refusal("pixel_size", "give one of pixel_size and nozzle_diameter (with nozzle_rows)")
        if (self.nozzle_diameter is None) != (self.nozzle_rows is None):
            raise refusal("nozzle_rows", "goes with nozzle_diameter: the rows in which the nozzle is in view")
        attenuations = self.polymer_attenuation is not None, self.solvent_attenuation is not None
        if attenuations[0] != attenuations[1]:
            raise refusal("polymer_attenuation", "goes with solvent_attenuation: give both or none")
        if not any(attenuations) and self.energy is not None and self.spectrum is not None:
            raise refusal("energy", "give one of energy and spectrum, or polymer_attenuation and solvent_attenuation")
        if self.tail_length is not None and self.tail_share is None:
            raise refusal("tail_share", 'goes with tail_length: the share of the light in the tail, or "fit"')
        if self.tail_share is not None and self.tail_share != "fit" and self.tail_length is None:
            raise refusal("tail_length", 'goes with tail_share: how far the tail reaches, or "fit"')
        if self.positions and self.each:
            raise refusal("frames", 'are summed at each position: take "sum", or one position')
        if self.positions and self.method in ("chord", "phase"):
            raise refusal("method", 'takes one position: take "map" or "row" for several')
        return self

    @property
    def each(self) -> bool:
        """Frames are reduced one by one."""
        return self.frames == "each"

    @property
    def part(self) -> slice:
        """Frames of the stack that are read."""
        return self.frames.part if isinstance(self.frames, Frames) else slice(None)

    @property
    def source(self) -> tuple[str, str]:
        """Key and file of the frames with the jet."""
        for key in ("counts", "transmission", "absorbance"):
            value = getattr(self, key)
            if value is not None:
                return key, value
        return "counts", self.positions[0].counts

    def at(self, index: int) -> "Images":
        """The file of one position: the common keys with its own."""
        place = self.positions[index]
        own = {
            "counts": place.counts,
            "flat": place.flat or self.flat,
            "dark": place.dark or self.dark,
            "positions": (),
        }
        own |= {
            key: getattr(place, key) or getattr(self, key) for key in ("flat_after", "calibration_rows", "nozzle_rows")
        }
        one = self.model_copy(update=own)
        one._text, one._folder, one._name = self._text, self._folder, f"{self._name}, position {index}"
        return one


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
