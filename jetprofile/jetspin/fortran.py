"""Unformatted sequential records of Fortran: four bytes of length before and after each, little endian."""

import mmap
import struct
from collections.abc import Sequence

__all__ = ["read_record", "record_sizes", "skip_records"]

_INT = struct.Struct("<i")


def read_record(content: mmap.mmap | bytes, at: int, size: int) -> bytes | None:
    """Body of the record of `size` bytes at `at`; None if it is cut off or its markers do not say `size`."""
    stop = at + 4 + size
    if at < 0 or stop + 4 > len(content):
        return None
    mark = size.to_bytes(4, "little")
    if content[at : at + 4] != mark or content[stop : stop + 4] != mark:
        return None
    return bytes(content[at + 4 : stop])


def skip_records(content: mmap.mmap | bytes, at: int, sizes: Sequence[int]) -> list[bytes] | None:
    """Bodies of consecutive records of these sizes, or None."""
    found = []
    for size in sizes:
        body = read_record(content, at, size)
        if body is None:
            return None
        found.append(body)
        at += size + 8
    return found


def record_sizes(content: mmap.mmap | bytes, count: int) -> list[int]:
    """Sizes of the first records, as far as their markers agree."""
    sizes: list[int] = []
    at = 0
    while len(sizes) < count and at + 8 <= len(content):
        (size,) = _INT.unpack(content[at : at + 4])
        if size < 0 or read_record(content, at, size) is None:
            break
        sizes.append(size)
        at += size + 8
    return sizes
