"""Text from outside, made harmless: control characters, terminal escapes and marks that turn the direction of text."""

import re

__all__ = ["clean", "label"]

# C0 and C1 controls but tab and newline, DEL, line and paragraph separators, marks of direction, lone surrogates
_BAD = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufeff]")


def clean(text: str) -> str:
    r"""The text with every control character shown as its escape, ``\u001b``.

    Tab and newline stay: they do nothing to a terminal.

    Examples
    --------
    >>> clean("5 wt% \x1b[2J")
    '5 wt% \\u001b[2J'
    """
    return _BAD.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def label(text: str, longest: int = 1000) -> str:
    """One line of harmless text, for titles and names: blanks joined, controls left out, cut at `longest`."""
    line = " ".join(_BAD.sub(" ", text).split())
    return line if len(line) <= longest else line[: longest - 3] + "..."
