"""Names of the files of one stack: their order, what is missing between them, and what does not belong to them."""

import re
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from spinline.base.errors import InputError

__all__ = ["gaps", "in_order", "kinds", "natural", "no_file"]

_ANOTHER = re.compile(
    r"(?<![a-z])(?:flat|dark|white|bright|empty|open|background|bkg|bg|ref|reference|blank|mask)s?(?![a-z])"
)
_COUNTS = ("counts", "transmission", "absorbance")


def natural(name: str) -> list[tuple[int, int, str]]:
    """Key that sorts names by the numbers in them: frame_2 before frame_10."""
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in re.split(r"(\d+)", name) if part]


def in_order(files: Sequence[Path]) -> list[Path]:
    """Files by the numbers in their names, capitals as small letters: "fr.tif", "fr (1).tif", "FR (2).tif"."""
    return sorted(files, key=lambda file: (natural(str(file.with_suffix("")).casefold()), str(file)))


def kinds(names: Sequence[str], key: str, pattern: str) -> list[str]:
    """What is said where names differ by more than their numbers.

    Raises
    ------
    InputError
        Where a few of the jet's frames are named as another kind of frame: part_flat.tif among part_0.tif, part_1.tif.
    """
    bare = [re.sub(r"\d+", "#", Path(name).stem.casefold()) for name in names]
    found = Counter(bare)
    if len(found) < 2:
        return []
    usual, most = found.most_common(1)[0]
    for name, kind in zip(names, bare, strict=True):
        word = _ANOTHER.search(kind)
        if key in _COUNTS and kind != usual and 2 * most > len(names) and word and not _ANOTHER.search(usual):
            raise InputError(
                key,
                f"matches {name} too, whose name says {word[0]}",
                value=pattern,
                remedy=f'name the frames more closely, as "{_closer(names[bare.index(usual)])}", or move that file',
            )
    if len(found) == len(names):  # every one has its own name: that is how they are called
        return []
    shown = ", ".join(f"{names[bare.index(kind)]} ({number})" for kind, number in found.most_common(4))
    return [f"{key}: {pattern} matches names of {len(found)} forms, all of them taken: {shown}"]


def _closer(name: str) -> str:
    return re.sub(r"\d+(?=\D*$)", "[0-9]*", name)


def gaps(names: Sequence[str], key: str, what: str = "files") -> list[str]:
    """What is said where names count up by ones, and a few of their numbers are not there."""
    split = [re.split(r"(\d+)", name) for name in names]
    first, last = split[0], split[-1]
    apart = [i for i in range(1, len(first), 2) if i < len(last) and int(first[i]) != int(last[i])]
    if len(apart) != 1 or any(len(parts) != len(first) for parts in split):
        return []
    numbers = [int(parts[apart[0]]) for parts in split]
    steps = np.diff(np.asarray(numbers, dtype=np.float64))
    gone = int((steps - 1.0).clip(0.0).sum())
    by_ones = 2 * int((steps == 1.0).sum()) >= steps.size and gone <= len(names)
    few = numbers[0] in (0, 1) and steps.size == 1 and gone == 1  # part_0, part_2
    if gone == 0 or not (by_ones or few):
        return []
    lost = next(a + 1 for a, b in pairwise(numbers) if b > a + 1)
    return [
        f"{key}: names of the {what} count from {numbers[0]} to {numbers[-1]}, and {gone} are not there, the first {lost}"
    ]


def no_file(name: str, source: str) -> str:
    """What to write for what is no file."""
    if "\\" in name:
        return f'write "/" between folders: "{source.replace(chr(92), "/")}"'
    if re.search(r"[{,]", name):
        return 'several files are one pattern, such as "part_*.tif" or "part_[0-9].tif"'
    return "paths start from the images file's folder"
