"""A checksum of a whole file, in 128 bytes behind its end.

Readers of HDF5 and zip do not mind what follows, and damage is found before a library has to make sense of it. A file that
another program has written anew, or changed in place, carries no seal and is read as any other.
"""

import hashlib
import os
from pathlib import Path
from typing import IO, Any

from spinline.base.errors import InputError

__all__ = ["digest_of", "sealed", "trailer", "unsealed", "verified"]

_MARK = b"\nspinline seal blake2b "
_SIZE = 128
_BLOCK = 1 << 20


def sealed(data: bytes) -> bytes:
    """The data with its seal behind it."""
    return data + trailer(hashlib.blake2b(data, digest_size=32))


def unsealed(data: bytes) -> bytes | None:
    """What was sealed; None where there is no seal, or one that does not fit."""
    body, tail = data[:-_SIZE], data[-_SIZE:]
    return body if tail == trailer(hashlib.blake2b(body, digest_size=32)) else None


def verified(path: str | Path) -> bool:
    """Whether a file carries a seal that fits; False where it carries none.

    Raises
    ------
    InputError
        If its seal does not fit: the file is damaged.
    """
    try:
        with Path(path).open("rb") as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - _SIZE))
            tail = file.read(_SIZE)
            if not (len(tail) == _SIZE and tail.startswith(_MARK)):
                return False
            file.seek(0)
            if trailer(digest_of(file, size - _SIZE)) == tail:
                return True
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror})", remedy="check the path") from None
    raise InputError(str(path), "is damaged: its checksum does not fit", remedy="make it again, or take a copy")


def digest_of(file: IO[bytes], size: int | None = None) -> Any:
    """Digest of a file from where it stands, of all of it or of so many bytes."""
    digest = hashlib.blake2b(digest_size=32)
    left = size
    while block := file.read(_BLOCK if left is None else min(_BLOCK, left)):
        digest.update(block)
        left = None if left is None else left - len(block)
    return digest


def trailer(digest: Any) -> bytes:
    """The seal itself."""
    text: bytes = _MARK + digest.hexdigest().encode("ascii")
    return text + b" " * (_SIZE - 1 - len(text)) + b"\n"
