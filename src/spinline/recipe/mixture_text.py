"""What to write for a mixture of solvents that stands as a notebook has it: "DMF/acetone 4:6", "60 % DMF, 40 % acetone"."""

import re
from collections.abc import Callable, Mapping, Sequence

from spinline.rheology.names import known_as
from spinline.rheology.solvents import SOLVENTS, solvent_density

__all__ = ["in_toml", "mixture_remedy", "parted"]

_NUMBER = r"\d+(?:[.,]\d+)?"
_RATIO = re.compile(rf"{_NUMBER}(?:\s*[:/]\s*{_NUMBER})+(?!\s*%)")
_PERCENT = re.compile(rf"({_NUMBER})\s*%")
_BY = re.compile(
    r"\(?\b(?:v/v|w/w|wt/wt|vol/vol|m/m|by (?:volume|mass|weight)|vol(?:ume)?|wt|weight|mass|ratio|parts?)\b\)?", re.I
)
_SALT = re.compile(r"\b(?:NaCl|LiCl|KCl|CaCl2|MgCl2|LiBr|TBAB|TEAB|BTEAC|CTAB|SDS|salt)\b", re.IGNORECASE)
_MOST_WORDS = 25  # of one name, and what stands between them: 1,1,1,3,3,3-hexafluoro-2-propanol has 17
_ROOM = 298.15  # K: at which parts by volume are measured out


def in_toml(shares: Mapping[str, float]) -> str:
    """Shares as an inline table that adds up to 1.

    Examples
    --------
    >>> in_toml({"formic acid": 3, "water": 1})
    '{ "formic acid" = 0.75, water = 0.25 }'
    """
    total = sum(shares.values())
    keys = {name: name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else f'"{name}"' for name in shares}
    return "{ " + ", ".join(f"{keys[name]} = {share / total:.3g}" for name, share in shares.items()) + " }"


def mixture_remedy(text: str) -> str:
    """What to write for a text that is a mixture, a diluted solvent or one with salt; "" for any other."""
    if _SALT.search(text):
        return "name the solvent alone and give `conductivity`: that is what a salt changes here"
    names, parts = _names_of(text), _parts_of(text)
    if len(names) == 1 and len(parts) == 1 and 0 < parts[0] < 100:
        other = {"water": parts[0]} if names[0] == "water" else {names[0]: parts[0], "water": 100 - parts[0]}
        return (
            f"if the rest is water and the percent are by mass, write solvent = {in_toml(other)}"
            if len(other) > 1
            else ""
        )
    if len(names) < 2:
        return ""
    if len(parts) != len(names) or not all(part > 0 for part in parts):
        return f"a mixture is written by mass, for example solvent = {in_toml(dict.fromkeys(names, 1.0))}"
    by_mass = dict(zip(names, parts, strict=True))
    by_volume = {name: part * solvent_density(name, _ROOM) for name, part in by_mass.items()}
    mass, volume = in_toml(by_mass), in_toml(by_volume)
    if re.search(r"\bv/v|\bvol", text, re.IGNORECASE):
        return f"a mixture is written by mass: these parts by volume are solvent = {volume}"
    if re.search(r"\bw/w|\bm/m|\bwt|\bmass|\bweight", text, re.IGNORECASE):
        return f"write solvent = {mass}"
    return f"a mixture is written by mass: solvent = {mass}, or, of these parts by volume, {volume}"


def parted(text: str, known: Callable[[str], str | None]) -> tuple[list[str], str]:
    """Names that a text strings together, as the library has them, and what of it is none.

    Hyphens, commas and digits may part names or stand within one: the longest name that is known is taken.

    Examples
    --------
    >>> parted("N,N-dimethylformamide-acetone", lambda name: known_as(name, SOLVENTS))
    (['DMF', 'acetone'], '')
    """
    words = re.split(r"(\s*[-–/:;+&|_,]\s*|\s+and\s+)", text.strip())  # words, and what stands between, in turn
    found, at = [], 0
    while at < len(words):
        for stop in range(min(len(words), at + _MOST_WORDS), at, -2):
            name = known("".join(words[at:stop]))
            if name is not None:
                found.append(name)
                at = stop + 1
                break
        else:
            if words[at].strip():
                return found, "".join(words[at:]) if found else text.strip()
            at += 2
    return found, ""


def _parts_of(text: str) -> list[float]:
    """Parts or percent, in the order of the text."""
    percents = _PERCENT.findall(text)
    if percents:
        return [float(one.replace(",", ".")) for one in percents]
    ratio = _RATIO.search(text)
    return [float(one.replace(",", ".")) for one in re.split(r"\s*[:/]\s*", ratio[0])] if ratio else []


def _names_of(text: str) -> list[str]:
    """Solvents of the library in a text, where nothing else is named in it."""
    bare = _BY.sub(" ", _RATIO.sub(" ", _PERCENT.sub(" ", text)))
    for separator in (r"[/:+;&|]|\band\b|\bin\b|\bwith\b", r"[,/:+;&|]|\band\b", r"[-–/:+]|\s{2,}"):
        found = _known([piece.strip(" ()[]=,\t") for piece in re.split(separator, bare)])
        if found:
            return found
    return []


def _known(pieces: Sequence[str]) -> list[str]:
    names = [known_as(piece, SOLVENTS) for piece in pieces if piece]
    found = [name for name in names if name is not None]
    return found if len(found) == len(names) == len(set(found)) else []
