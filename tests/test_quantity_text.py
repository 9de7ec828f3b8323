"""One grammar of quantities: every way of a notebook is the right number, or a refusal with what to write."""

import re

import pytest

from spinline.base.errors import InputError
from spinline.base.quantity_text import written
from spinline.base.units import parse

# text, kind, value, standard deviation: by hand
RIGHT = [
    ("(320 +/- 20) nm", "length", 320e-9, 20e-9),
    ("(320±20)nm", "length", 320e-9, 20e-9),
    ("320 nm +/- 6 %", "length", 320e-9, 19.2e-9),
    ("320nm ± 6%", "length", 320e-9, 19.2e-9),
    ("320 nm +/- 0.02 um", "length", 320e-9, 20e-9),
    ("-10 cm/s +/- 10 %", "velocity", -0.1, 0.01),
    ("0.9 Pa s ± 0.1 Pa s", "viscosity", 0.9, 0.1),
    ("900 mPa·s ± 10 %", "viscosity", 0.9, 0.09),
    ("3.2 mL h-1 ± 0.1 mL h-1", "flow rate", 3.2e-6 / 3600, 0.1e-6 / 3600),
    ("100 1/s ± 5 1/s", "rate", 100, 5),
    ("(1.5 ± 0.1)×10⁵ g/mol", "molar mass", 150, 10),
    ("1.5e5 g/mol +/- 5 %", "molar mass", 150, 7.5),
    ("1.5×10^5 g/mol", "molar mass", 150, 0),
    ("1.5 x 10^5 g/mol", "molar mass", 150, 0),
    ("1.5 × 10⁵ g mol⁻¹", "molar mass", 150, 0),
    ("3.2·10⁻⁷ m", "length", 3.2e-7, 0),
    ("10^-7 m", "length", 1e-7, 0),
    ("10⁻⁷ m", "length", 1e-7, 0),
    ("10 m", "length", 10, 0),
    ("23 °C ± 2 K", "temperature", 296.15, 2),
    ("(23 ± 2) °C", "temperature", 296.15, 2),
    ("23 ºC", "temperature", 296.15, 0),
    ("23 deg C", "temperature", 296.15, 0),
    ("73.4 degrees F", "temperature", 296.15, 0),
    ("296 K +/- 2 %", "temperature", 296, 5.92),
    ("1\u00a0mL\u202fh\u22121", "flow rate", 1e-6 / 3600, 0),
    ("1 mL per hour", "flow rate", 1e-6 / 3600, 0),
    ("20 µL∕min", "flow rate", 20e-9 / 60, 0),
    ("900 mPa•s", "viscosity", 0.9, 0),
    ("15 cm.", "length", 0.15, 0),
    ("100 /s", "rate", 100, 0),
    ("10wt%", "mass fraction", 0.1, 0),
    ("10 wt.-%", "mass fraction", 0.1, 0),
    ("10 % by weight", "mass fraction", 0.1, 0),
    ("10 weight percent", "mass fraction", 0.1, 0),
    ("10 W%", "mass fraction", 0.1, 0),
    ("(10 ± 0.5) wt%", "mass fraction", 0.1, 0.005),
    ("10 wt% ± 0.5 wt%", "mass fraction", 0.1, 0.005),
    ("4 % by volume", "volume fraction", 0.04, 0),
    ("45 % RH", "fraction", 0.45, 0),
    ("45 ± 5 %RH", "fraction", 0.45, 0.05),
    ("45 % ± 5 %", "fraction", 0.45, 0.05),
    ("10 % m/v", "concentration", 100, 0),
    ("10 g/100 mL", "concentration", 100, 0),
    ("(10 ± 1) % w/v", "concentration", 100, 10),
    ("1 +/- 5 %", "number", 1, 0.05),
    ("(1 ± 0.05)", "number", 1, 0.05),
]


@pytest.mark.parametrize(("text", "kind", "value", "std"), RIGHT)
def test_it_is_this_number(text, kind, value, std) -> None:
    found = parse(text, kind, "field")
    assert found.value == pytest.approx(value, rel=1e-12)
    assert found.std == pytest.approx(std, rel=1e-12)


REFUSED = [
    ("0,42 um", "length", 'decimal comma; write a point: "0.42 um"'),
    ("0,42 +/- 0,02 um", "length", 'decimal comma; write a point: "0.42 +/- 0.02 um"'),
    ("12,5 wt%", "mass fraction", 'decimal comma; write a point: "12.5 wt%"'),
    ("0,125 mm", "length", 'decimal comma; write a point: "0.125 mm"'),
    ("1.234,5 um", "length", '"1234.5 um"'),
    ("1,234.5 um", "length", 'commas between its thousands; write "1234.5 um"'),
    ("15,000 V", "potential", 'write "15000 V", or "15.000 V"'),
    ("15 000 V", "potential", 'write "15000 V"'),
    ("15'000 V", "potential", 'write "15000 V"'),
    ("1.5×105 g/mol", "molar mass", 'raised digits are lost; write "1.5e5 g/mol"'),
    ("1.5 x 10-5 S/m", "conductivity", 'raised digits are lost; write "1.5e-5 S/m"'),
    ("320-400 nm", "length", 'range; write its middle and half its width, "360 +/- 40 nm"'),
    ("320 nm to 400 nm", "length", '"360 +/- 40 nm"'),
    ("20–25 °C", "temperature", '"22.5 +/- 2.5 °C"'),
    ("320 +20/-30 nm", "length", '"320 +/- 25 nm"'),
    ("~320 nm", "length", 'write "320 nm"'),
    ("320 nm ± 20", "length", 'without a unit; write "320 +/- 20 nm"'),
    ("320 +/- 6 %", "length", "needs a unit before its +/-"),
    ("320 +/- 6 % nm", "length", "unit is not known"),  # pint has per cent of nanometres
    ("320 % nm", "length", "unit is not known"),
    ("23 °C ± 5 %", "temperature", 'write degrees, for example "23 +/- 1.2'),
    ("10 wt% ± 5 %", "mass fraction", 'write "10 +/- 5 wt%", or "10 +/- 0.5 wt%"'),
    ("0.45 +/- 5 %", "fraction", 'write "45 +/- 5 %", or "0.45 % +/- 5 %"'),
    ("15 KV", "potential", "capitals and small letters apart: write kV"),
    ("8 KeV", "energy", "write keV"),
    ("15 CM", "length", "write cm"),
    ("40 us/cm", "conductivity", "write uS/cm"),
    ("23 C", "temperature", "write degC"),
    ("45 % RH", "mass fraction", "a mass fraction has none"),
    ("5 % by volume", "mass fraction", "volume fraction, not a mass fraction"),
]


@pytest.mark.parametrize(("text", "kind", "words"), REFUSED)
def test_it_is_refused_with_what_to_write(text, kind, words) -> None:
    with pytest.raises(InputError, match=re.escape(words)):
        parse(text, kind, "field")


@pytest.mark.parametrize(("text", "kind", "words"), REFUSED)
def test_what_it_says_to_write_is_read(text, kind, words) -> None:
    """Every remedy in quotes is itself a quantity of the kind."""
    with pytest.raises(InputError) as caught:
        parse(text, kind, "field")
    meant = re.findall(r'write[^"]*"([^"]+)"(?:, or "([^"]+)")?', caught.value.remedy)
    for one in filter(None, (part for pair in meant for part in pair)):
        assert parse(one, kind, "field").text == one


@pytest.mark.parametrize(
    "text", ["", " ", "+/-", "()", "(1 +/- 2", "1 +/- nm", "± 2 nm", "nm", "1 ± 2 ± 3 nm", "x10^5 m"]
)
def test_no_quantity(text) -> None:
    assert written(text) is None


def test_reading_is_fast_for_hostile_text() -> None:
    """Two hundred characters of what every form begins with take no more than a millisecond or so each."""
    import time

    texts = [sign * 100 for sign in ("1 ", "+-", "± ", "(1", "10^", "×1", " .", "1,", "nm", "-1")]
    start = time.process_time()
    for text in texts:
        with pytest.raises(InputError):
            parse(text, "length", "field")
    assert time.process_time() - start < 0.5


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("125 um +/- 3 um", "0.125 +/- 0.003 mm", True),
        ("(125 ± 3) um", "125 +/- 3 um", True),
        ("125 ± 3 um", "125 um", False),
        ("125 ± 3 um", "125 ± 4 um", False),
        ("125 um", "0.125 mm", True),
    ],
)
def test_results_compare_uncertainties_of_any_form(one, other, same) -> None:
    from spinline.study.compare import _texts

    assert (not _texts({"jet.radius": one}, {"jet.radius": other})) == same


@pytest.mark.parametrize(
    "text", ["20 +/- 2 px", "(20 ± 2) px", "20 px +/- 2 px", "20 px ± 10 %", "20 pixels +/- 2 pixels"]
)
def test_a_number_of_pixels(text) -> None:
    from spinline.scene.images_keys import _ReadReach

    found = _ReadReach()(text)
    assert (found.value, found.std, found.pixels) == (20, 2, True)
