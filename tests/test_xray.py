"""Absorption of a solution: what a change of attenuation says."""

import numpy as np
import pytest

from spinline import xray
from spinline.errors import InputError


def test_change_of_fraction_inverts_the_attenuation() -> None:
    d = xray.contrast(0.4, 1130.0, 0.53, 998.0)
    mu = xray.linear_attenuation(np.array([0.05, 0.2]), 0.53 * 998, d)
    chord = 50e-6
    ratio = np.exp(-(mu[1] - mu[0]) * chord)
    assert float(xray.fraction_change(ratio, chord, d)) == pytest.approx(0.15, rel=1e-12)


def test_pure_polymer_and_pure_solvent() -> None:
    d = xray.contrast(0.4, 1130.0, 0.53, 998.0)
    assert xray.linear_attenuation(0.0, 0.53 * 998, d) == 0.53 * 998
    assert float(xray.linear_attenuation(1.0, 0.53 * 998, d)) == pytest.approx(0.4 * 1130)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((0.0, 1e-4, 1.0), "transmission"),
        ((1.0, 0.0, 1.0), "chord"),
        ((1.0, 1e-4, 0.0), "energy"),
        ((np.nan, 1e-4, 1.0), "transmission"),
    ],
)
def test_refusals(arguments: tuple, words: str) -> None:
    with pytest.raises(InputError, match=words):
        xray.fraction_change(*arguments)
