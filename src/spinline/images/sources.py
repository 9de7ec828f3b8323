"""What an images file names as a source: a file, or a part of it, opened and checked against the frames."""

from spinline.base.errors import InputError
from spinline.images.stacks import Stack, open_stack
from spinline.scene.images_file import Images, Source

__all__ = ["opened", "part_of", "slices", "spoken", "stack_of"]


def stack_of(images: Images, source: str, key: str, frames: slice | None = None) -> Stack:
    """A source of the images file, opened."""
    return open_stack(
        source,
        key,
        images.folder,
        transpose=images.transpose,
        roi=None if images.roi is None else images.roi.slices,
        frames=frames,
    )


def opened(source: Source, key: str, images: Images, counts: Stack) -> Stack:
    """The stack of a flat or a dark, of the shape of the frames or a part of it."""
    assert source.file is not None
    whole = source.rows is None and source.columns is None
    one = source.file.lower().endswith((".tif", ".tiff", ".npy")) or ":" in source.file  # not a file of many arrays
    if (
        whole
        and one
        and source.file == images.counts
        and ".nx" not in source.file.lower()
        and ".h5" not in source.file.lower()
    ):
        raise InputError(
            key,
            "is the file of the frames with the jet",
            value=source.file,
            remedy=f"name the {key}'s own file, or a part of the frames, {{ columns = [first, last] }}",
        )
    stack = stack_of(images, source.file, key)
    part_of(source, stack, key)
    rows_fit = stack.rows in (1, counts.rows) or source.rows is not None
    columns_fit = stack.columns == counts.columns or source.columns is not None
    if not (rows_fit and columns_fit):
        turned = (stack.columns, stack.rows) == (counts.rows, counts.columns)
        raise InputError(
            key,
            "has another shape than the frames",
            value=(stack.rows, stack.columns),
            allowed=f"({counts.rows}, {counts.columns}), or one row of {counts.columns}",
            remedy=f"counts or {key} lies on its side: store both alike" if turned else "",
        )
    return stack


def part_of(source: Source, stack: Stack, key: str) -> None:
    """Refuse a part that goes beyond the frame."""
    for name, span, size in (("rows", source.rows, stack.rows), ("columns", source.columns, stack.columns)):
        if span is not None and span[1] > size:
            raise InputError(f"{key}.{name}", "goes beyond the frame", value=list(span), allowed=f"0 to {size}")


def slices(source: Source) -> tuple[slice, slice]:
    """Rows and columns of a source."""
    rows, columns = (slice(*span) if span else slice(None) for span in (source.rows, source.columns))
    return rows, columns


def spoken(source: Source) -> str:
    """The part in words."""
    parts = [
        f"{name} {span[0]} to {span[1]}" for name, span in (("rows", source.rows), ("columns", source.columns)) if span
    ]
    return ", ".join(parts)
