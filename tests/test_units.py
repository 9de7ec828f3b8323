"""Every form of quantity that people type, and what bad ones get."""

import pytest

from spinline.base.errors import InputError
from spinline.base.units import QUANTITIES, parse

STATCOULOMB = 1 / 2.99792458e9  # C
GOOD = [
    ("25 degC", "temperature", 298.15),
    ("25 °C", "temperature", 298.15),
    ("77 degF", "temperature", 298.15),
    ("293.15 K", "temperature", 293.15),
    ("1.13 g/cm3", "density", 1130),
    ("1.13 g/cm^3", "density", 1130),
    ("1.13 g cm-3", "density", 1130),
    ("1130 kg/m³", "density", 1130),
    ("5 wt%", "mass fraction", 0.05),
    ("5 %", "mass fraction", 0.05),
    (0.05, "mass fraction", 0.05),
    ("4.4 vol%", "volume fraction", 0.044),
    ("600 kDa", "molar mass", 600),
    ("600 kg/mol", "molar mass", 600),
    ("6e5 g/mol", "molar mass", 600),
    ("270 1/s", "conductivity", 270 / 8.9875517873681764e9),
    ("270 s^-1", "conductivity", 270 / 8.9875517873681764e9),
    ("0.01 S/m", "conductivity", 0.01),
    ("44000 statC/cm3", "charge density", 44000e6 * STATCOULOMB),
    ("1 C/m3", "charge density", 1),
    ("30 statV", "potential", 30 * 299.792458),
    ("2 statV/cm", "electric field", 2 * 29979.2458),
    ("0.6 kV/cm", "electric field", 6e4),
    ("21.1 dyn/cm", "surface tension", 0.0211),
    ("125 um", "length", 125e-6),
    ("125 µm", "length", 125e-6),
    ("125 μm", "length", 125e-6),
    (".5 mm", "length", 5e-4),
    ("1e-9 m", "length", 1e-9),
    ("3.2 mL/hour", "flow rate", 3.2e-6 / 3600),
    ("3.2 mL/h", "flow rate", 3.2e-6 / 3600),
    ("20 g/cm/s", "viscosity", 2),
    ("20 P", "viscosity", 2),
    ("2 Pa s", "viscosity", 2),
    ("2 Pa.s", "viscosity", 2),
    ("2 Pa·s", "viscosity", 2),
    ("1 cP", "viscosity", 1e-3),
    ("2.5e-5 m2/s", "diffusivity", 2.5e-5),
    ("1 atm", "pressure", 101325),
    ("50000 g cm^-1 s^-2", "pressure", 5000),
    ("-10 cm/s", "velocity", -0.1),
    ("100 1/s", "rate", 100),
    ("1 pL", "volume", 1e-15),
    (3, "number", 3),
    ("1e3", "number", 1000),
    ("40 %", "fraction", 0.4),
]


@pytest.mark.parametrize(("text", "kind", "value"), GOOD)
def test_forms(text, kind: str, value: float) -> None:
    assert parse(text, kind, "field").value == pytest.approx(value, rel=1e-8)


def test_uncertainty() -> None:
    for text in ("125 +/- 3 um", "125+/-3 um", "125 ± 3 µm"):
        measured = parse(text, "length", "field")
        assert (measured.value, measured.std) == (pytest.approx(125e-6), pytest.approx(3e-6))
    warm = parse("25 +/- 1 degC", "temperature", "field")
    assert (warm.value, warm.std) == (pytest.approx(298.15), pytest.approx(1))


@pytest.mark.parametrize("kind", QUANTITIES)
def test_every_example_parses(kind: str) -> None:
    assert parse(QUANTITIES[kind].example, kind, "field").text == QUANTITIES[kind].example


@pytest.mark.parametrize(
    ("text", "kind", "words"),
    [
        (5, "length", "needs a unit"),
        (5.0, "temperature", "needs a unit"),
        ("5", "length", "needs a unit"),
        ("5 s", "length", "not a length"),
        ("5 foo", "length", "not known"),
        ("5 (((", "length", "not a length"),
        ("m", "length", "not a number"),
        ("", "length", "not a number"),
        ("nan m", "length", "finite"),
        ("inf m", "length", "finite"),
        ("1e400 m", "length", "finite"),
        (float("nan"), "number", "finite"),
        (True, "number", "is not a number"),
        (None, "length", "not a length"),
        ([1], "length", "not a length"),
        ("5 1 m", "length", "one number"),
        ("5 wt%", "volume fraction", "mass fraction, not"),
        ("5 vol%", "mass fraction", "volume fraction, not"),
        ("5 m", "number", "has none"),
        ("1 +/- -3 um", "length", "uncertainty"),
        ("1 +/- nan um", "length", "uncertainty"),
        ("5 kV", "electric field", "not an electric field"),
        ("5 m**9999999999", "length", "not a length"),
        ("5 __import__('os')", "length", "not known"),
        ("5 s", "conductivity", "not a conductivity"),
    ],
)
def test_refusals_name_field_value_and_example(text, kind: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        parse(text, kind, "jet.radius")
    assert "jet.radius" in str(caught.value)
    assert "for example" in str(caught.value)
