"""How a quantity stands in a text: number, uncertainty, unit. One grammar for all places where ``+/-`` is read.

``320 +/- 20 nm``, ``(320 +/- 20) nm``, ``320 nm +/- 20 nm``, ``320 nm +/- 0.02 um``, ``320 nm +/- 6 %``; ``±`` and ``+-`` are
``+/-``. A number is ``1.5e5``, ``1.5 x 10^5``, ``1.5×10⁵`` or ``10^5``; its decimal mark is a point. What may mean two things
is no quantity, and `trouble` says what to write.
"""

import re
from dataclasses import dataclass
from functools import lru_cache

__all__ = ["PERCENT", "Written", "trouble", "written"]

PERCENT = "%"
_RAISED = str.maketrans("⁻⁺⁰¹²³⁴⁵⁶⁷⁸⁹", "-+0123456789")
_PRINTED = str.maketrans(
    {"−": "-", "﹣": "-", "－": "-", "％": "%", **dict.fromkeys("\u00a0\u202f\u2009\u2007\u2002\u2003\t", " ")}
)
_TEN = r"10\s*(?:(?:\^|\*\*)\s*[-+]?\d{1,3}|(?:\^|\*\*)\s*\([-+]?\d{1,3}\)|[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]{1,3})"
_TIMES = rf"\s*[×xX·⋅∙*]\s*{_TEN}"
_DIGITS = r"(?:\d++(?:\.\d*+)?|\.\d++)"
_NUMBER = rf"[-+]?(?:{_TEN}|{_DIGITS}(?:[eE][-+]?\d+|{_TIMES})?|inf(?:inity)?(?![a-z])|nan(?![a-z]))"
_PM = r"\s*(?:\+\s*/\s*-|\+-|±)\s*"
_FORMS = tuple(
    re.compile(form, re.IGNORECASE)
    for form in (
        rf"\(\s*(?P<value>{_NUMBER}){_PM}(?P<std>{_NUMBER})\s*\)(?P<times>{_TIMES})?\s*(?P<unit>[^±]*)",
        rf"(?P<value>{_NUMBER}){_PM}(?P<std>{_NUMBER})\s*(?P<unit>[^±]*)",
        rf"(?P<value>{_NUMBER})\s*(?P<unit>[^\s±][^±]*?){_PM}(?P<std>{_NUMBER})\s*(?P<again>[^±]*)",
        rf"(?P<value>{_NUMBER})\s*(?P<unit>[^±]*)",
    )
)


@dataclass(frozen=True)
class Written:
    """A quantity as it is written.

    Attributes
    ----------
    value, std : float
        Numbers as they stand; `std` is 0 where none is given.
    unit : str
        Of `value`.
    std_unit : str or None
        Of `std`, where it has one of its own; "" where `value` has one and `std` none; None where one unit is for both.
    """

    value: float
    std: float
    unit: str
    std_unit: str | None = None


@lru_cache(maxsize=512)
def written(text: str) -> Written | None:
    """Number, uncertainty and unit of a text; None where it is no quantity.

    Examples
    --------
    >>> written("(1.5 ± 0.1)×10⁵ g/mol")
    Written(value=150000.0, std=10000.0, unit='g/mol', std_unit=None)
    >>> written("320 nm +/- 6 %").std_unit, written("0,42 um")
    ('%', None)
    """
    plain = text.translate(_PRINTED).strip()
    for form in _FORMS:
        match = form.fullmatch(plain)
        if match is None:
            continue
        parts = match.groupdict()
        times = _number(f"1{parts['times']}") if parts.get("times") else 1.0
        value, std = _number(parts["value"]) * times, _number(parts.get("std") or "0") * times
        again = parts.get("again")
        found = Written(value, std, _unit(parts["unit"]), None if again is None else _unit(again))
        return None if _two_numbers(found.unit) or _two_numbers(found.std_unit or "") else found
    return None


def _unit(text: str) -> str:
    return text.strip().removesuffix(".").rstrip()  # the point of an abbreviation or of a sentence


def _two_numbers(unit: str) -> bool:
    """A unit does not go on with the number's digits, marks or signs; 1/s may."""
    goes_on = re.match(r"(?!1\s*/)\d|[.,'_^×+~–—-]+\s*\d|[xX·*]\s*\d|/\s*\d", unit)
    return goes_on is not None or re.search(r"\d,\d|\+/-|\+-|\b(?:to|bis)\s+\d|\s[-–—]\s+\d", unit) is not None


def _number(text: str) -> float:
    """Value of a number of the grammar."""
    text = re.sub(r"\s+", "", text)
    power = re.fullmatch(
        r"(?P<sign>[-+]?)(?:(?P<front>.*)[×xX·⋅∙*])?10(?:\^|\*\*)?(?P<power>\(?[-+⁻⁺]?[\d⁰¹²³⁴⁵⁶⁷⁸⁹]+\)?)", text
    )
    if power is None or not re.search(r"[\^*⁰¹²³⁴⁵⁶⁷⁸⁹]", text):
        return float(text)
    raised = power["power"].strip("()").translate(_RAISED)
    return float(f"{power['sign']}{power['front'] or 1}e{raised}")


def trouble(text: str) -> tuple[str, str] | None:
    """What is wrong with a text that is no quantity, and what to write; None where that is not known."""
    plain = " ".join(text.translate(_PRINTED).split())
    for look in (_commas, _thousands, _lost_power, _asymmetric, _range, _about):
        found = look(plain)
        if found:
            return found
    return None


def _commas(text: str) -> tuple[str, str] | None:
    if not re.search(r"\d,\d", text):
        return None
    if re.search(r"\d,\d{3}(?:,\d{3})*\.\d", text) or re.search(r"\d,\d{3},\d{3}(?!\d)", text):
        return "has commas between its thousands", f'write "{re.sub(r"(?<=[0-9]),(?=[0-9])", "", text)}"'
    if re.search(r"\d\.\d{3}(?:\.\d{3})*,\d", text):
        bare = re.sub(r"(?<=\d)\.(?=\d{3})", "", text)
        return "has a decimal comma", f'write a point: "{re.sub(r"(?<=[0-9]),(?=[0-9])", ".", bare)}"'
    point = re.sub(r"(?<=\d),(?=\d)", ".", text)
    if re.search(r"(?<![\d,])[1-9]\d{0,2},\d{3}(?![\d,])", text):
        none = re.sub(r"(?<=\d),(?=\d)", "", text)
        return "has a comma in its number, for decimals or for thousands", f'write "{none}", or "{point}"'
    return "has a decimal comma", f'write a point: "{point}"'


def _thousands(text: str) -> tuple[str, str] | None:
    joined = re.sub(r"(?<=\d)[ '’_](?=\d{3}(?!\d))", "", text)
    return None if joined == text else ("has marks between its thousands", f'write "{joined}"')


def _lost_power(text: str) -> tuple[str, str] | None:
    found = re.search(rf"({_DIGITS})\s*[×xX·*]\s*10\s*(-?\d{{1,2}})(?!\d)", text)
    if found is None:
        return None
    meant = f"{text[: found.start()]}{found[1]}e{found[2]}{text[found.end() :]}"
    return "has a power of ten whose raised digits are lost", f'write "{meant}", if that is meant'


def _asymmetric(text: str) -> tuple[str, str] | None:
    found = re.fullmatch(rf"({_DIGITS})\s*\S*?\s*\+\s*({_DIGITS})\s*/?\s*-\s*({_DIGITS})\s*(\D.*)?", text)
    if found is None:
        return None
    mean = (float(found[2]) + float(found[3])) / 2
    return "has an uncertainty of two sides", f'write one, "{found[1]} +/- {mean:g} {found[4] or ""}'.rstrip() + '"'


def _range(text: str) -> tuple[str, str] | None:
    found = re.fullmatch(rf"({_DIGITS})\s*([^\d\s]*)\s*(?:-|–|—|\.\.+|to|bis|…)\s*({_DIGITS})\s*(\D.*)?", text)
    if found is None or not float(found[1]) < float(found[3]):
        return None
    low, high, unit = float(found[1]), float(found[3]), found[4] or found[2]
    meant = f"{(low + high) / 2:g} +/- {(high - low) / 2:g} {unit}".rstrip()
    return "is a range", f'write its middle and half its width, "{meant}"'


def _about(text: str) -> tuple[str, str] | None:
    found = re.fullmatch(
        r"(?:~|≈|≃|∼|[<>≤≥]=?|ca\.?|c\.|circa|about|approx\.?|around|up to)\s*(\d.*)", text, re.IGNORECASE
    )
    return ("is no plain quantity", f'write "{found[1]}", with +/- where it is not well known') if found else None
