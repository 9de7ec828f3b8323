"""How figures look, once: colours, bands, legends, sheets of axes, and how they are written.

Readable in grey: every curve has its own line style. Colours are those of Okabe and Ito, told apart by the colour-blind.
"""

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from spinline.base.errors import InputError
from spinline.base.files import write_bytes
from spinline.base.words import clean

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike

    from spinline.base.named_arrays import NamedArrays

__all__ = [
    "BANDS",
    "DPI",
    "LEGEND",
    "QUICK",
    "SheetAxes",
    "check_format",
    "drawn",
    "grid",
    "plain_text",
    "save_sheet",
    "shade",
    "shade_between",
    "sheet_of",
    "titled",
]

BLUE, ORANGE, GREEN, RED, PURPLE, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#555555"
BANDS = ((0, 4, 0.15), (1, 3, 0.26))  # of the quantiles: 95 and 68 %, with their opacity
LEGEND: dict[str, Any] = {"fontsize": 8, "framealpha": 0.9, "edgecolor": "none"}
DPI = 130
SheetAxes = Any  # one Axes, or an array or list of them
_FORMATS = {".png", ".pdf", ".svg"}
QUICK = {"compress_level": 3}  # of PNG: half the time, a tenth more bytes


def sheet_of(
    axes: SheetAxes, rows: int, columns: int, size: tuple[float, float], *, sharex: bool = False, **layout: Any
) -> tuple[Figure, np.ndarray[tuple[int, int], np.dtype[np.object_]]]:
    """The axes to draw into: those given, or those of a new sheet.

    Parameters
    ----------
    axes : Axes, array or list of Axes, or None
        Where a caller wants the panels: rows * columns of them, in reading order. None makes a sheet.
    rows, columns : int
        Panels.
    size : tuple of float
        Inches, of a new sheet.
    sharex : bool
        Of a new sheet.
    **layout
        For the new Figure (``layout="constrained"``).

    Returns
    -------
    figure, axes
        The Figure that holds the axes, and the axes with shape (rows, columns).

    Raises
    ------
    InputError
        For another number of axes.
    """
    if axes is None:
        sheet = Figure(figsize=size, **layout)
        FigureCanvasAgg(sheet)
        return sheet, sheet.subplots(rows, columns, sharex=sharex, squeeze=False)
    given = np.atleast_1d(np.asarray(axes, dtype=object)).ravel()
    if given.size != rows * columns or not all(isinstance(axis, Axes) for axis in given):
        raise InputError(
            "axes",
            f"has {given.size} where the figure has {rows} x {columns} panels",
            remedy=f"give {rows * columns} matplotlib axes",
        )
    figure = given[0].get_figure(root=True)
    assert isinstance(figure, Figure)
    return figure, given.reshape(rows, columns)


def titled(sheet: Figure, own: bool, text: str, **style: Any) -> None:
    """Title of a sheet of ours; a sheet that the caller made keeps its own."""
    if own:
        sheet.suptitle(plain_text(text), **style)


def plain_text(text: str) -> str:
    """Text from a file or a file's name, to be drawn as it is: a dollar is a dollar, and no legend drops an underscore."""
    drawn_as = clean(text).replace("$", r"\$")
    return f" {drawn_as}" if drawn_as.startswith("_") else drawn_as


def drawn(sheet: Figure, kind: str = "png", **options: Any) -> bytes:
    """A sheet as the bytes of a picture: png, pdf or svg. No text in it holds what no letter can be, wherever it came from."""
    for text in sheet.findobj(Text):
        words = str(text.get_text())
        if words != clean(words):
            text.set_text(clean(words))
    buffer = io.BytesIO()
    sheet.savefig(buffer, format=kind, **options)
    return buffer.getvalue()


def grid(axis: Axes) -> None:
    """Light lines below the curves."""
    axis.grid(visible=True, which="major", color="0.9", linewidth=0.6)
    axis.set_axisbelow(True)


def shade_between(axis: Axes, place: "ArrayLike", rows: Any, colour: str) -> None:
    """Bands of 95 and 68 % from five rows of quantiles."""
    for low, high, alpha in BANDS:
        axis.fill_between(place, rows[low], rows[high], color=colour, alpha=alpha, linewidth=0)


def shade(
    axis: "Axes",
    place: Any,
    result: "xr.Dataset | NamedArrays",
    name: str,
    colour: str,
    factor: float = 1.0,
    *,
    positive: bool = False,
) -> None:
    """Bands of 68 and 95 % of a variable, where the inputs carry an uncertainty; `positive` leaves zeros out (logarithms)."""
    if f"{name}_band" not in result:
        return
    rows = factor * result[f"{name}_band"].values
    if positive:
        rows = np.where(rows > 0, rows, np.nan)
    shade_between(axis, place, rows, colour)


def check_format(path: str | Path) -> Path:
    """Return the path if its ending is a picture format, refuse it otherwise."""
    file = Path(path)
    if file.suffix.lower() not in _FORMATS:
        raise InputError(
            str(path), "has no known picture format", value=file.suffix, allowed=", ".join(sorted(_FORMATS))
        )
    return file


def save_sheet(sheet: Figure, path: str | Path, *, force: bool = False, dpi: int = DPI) -> Path:
    """Write a figure; the file's ending says the format (.png, .pdf, .svg).

    Raises
    ------
    InputError
        For another ending, or a file that cannot be written.
    """
    file = check_format(path)
    kind = file.suffix[1:].lower()
    options: dict[str, Any] = {"dpi": dpi, "pil_kwargs": QUICK} if kind == "png" else {}
    return write_bytes(file, drawn(sheet, kind, **options), force=force)
