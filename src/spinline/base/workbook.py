"""Cells of an Excel workbook's first sheet, as text."""

from pathlib import Path

from spinline.base.errors import InputError
from spinline.base.text import read_text

__all__ = ["WORKBOOKS", "sheet_rows", "table_text"]

WORKBOOKS = (".xlsx", ".xlsm", ".xls", ".ods")  # the last two are refused by name


def table_text(path: str | Path) -> tuple[str, str]:
    """Text of a table and its encoding, as `read_text`; a workbook under another name is told its own.

    Raises
    ------
    InputError
        As `read_text`.
    """
    try:
        return read_text(path)
    except InputError as error:
        if not error.problem.startswith("is an Excel workbook"):
            raise
        raise InputError(error.field, error.problem, remedy=f"name it .xlsx, or {error.remedy}") from None


def sheet_rows(path: str | Path) -> list[list[str]]:
    """Rows of the first sheet; an empty cell is "".

    Raises
    ------
    InputError
        For an old or damaged workbook, a missing file, or without openpyxl.
    """
    name = str(path)
    if Path(path).suffix.lower() in (".xls", ".ods"):
        raise InputError(
            name, "is an old Excel or an OpenDocument workbook", remedy="save it as .xlsx or as CSV (UTF-8)"
        )
    try:
        import openpyxl
    except ImportError:
        raise InputError(
            name,
            "is an Excel workbook, and openpyxl is not installed",
            remedy="pip install openpyxl, or save the sheet as CSV (UTF-8)",
        ) from None
    if not Path(path).is_file():
        raise InputError(name, "cannot be read (No such file or directory)", remedy="check the path")
    try:
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        rows = [list(row) for row in book.worksheets[0].iter_rows(values_only=True)]
        book.close()
    except Exception as error:  # of a damaged archive: whatever its parts raise
        raise InputError(
            name, f"is not a readable Excel workbook ({type(error).__name__})", remedy="save it again"
        ) from None
    return [["" if cell is None else str(cell) for cell in row] for row in rows]
