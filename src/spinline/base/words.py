"""Text from outside, made harmless: control characters, terminal escapes and marks that turn the direction of text."""

import re
from contextlib import suppress

__all__ = ["cell", "clean", "label", "one_line", "page", "shortened"]

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


def one_line(text: str) -> str:
    """A name with its line ends and tabs shown as escapes: what follows them is no line of ours."""
    return text.replace("\n", "\\n").replace("\t", "\\t")


def shortened(text: str, longest: int = 400) -> str:
    """The text without its middle where it is longer than `longest`: keys and names can be megabytes.

    Examples
    --------
    >>> shortened("jet." + "a" * 5000, 20)
    'jet.aaaaaa...aaaaaaa'
    """
    tail = longest - longest // 2 - 3
    return text if len(text) <= longest else f"{text[: longest // 2]}...{text[-tail:]}"


def label(text: str, longest: int = 1000) -> str:
    """One line of harmless text, for titles and names: blanks joined, controls left out, cut at `longest`."""
    line = " ".join(_BAD.sub(" ", text).split())
    return line if len(line) <= longest else line[: longest - 3] + "..."


def page(text: str) -> str:
    """Text of an HTML page: lines end alike, and nothing in it is a control character or turns the direction of reading."""
    return clean(text.replace("\r\n", "\n").replace("\r", "\n"))


def cell(text: str) -> str:
    """A cell of a table, which no spreadsheet takes for a formula: one that begins as such gets an apostrophe before it.

    Examples
    --------
    >>> cell("=1+1"), cell("-2.5"), cell("PEO")
    ("'=1+1", '-2.5', 'PEO')
    """
    if not text.startswith(("=", "+", "-", "@", "\t", "\r", "\n")):
        return clean(text)
    if text[0] in "+-":
        with suppress(ValueError):
            float(text)
            return text.strip()
    return "'" + clean(text)
