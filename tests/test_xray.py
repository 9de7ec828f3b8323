"""Absorption of a solution: what a change of attenuation says."""

import subprocess
import sys

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError


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


def test_cheap_to_import() -> None:
    """Neither tables nor solvers are loaded before they are needed, and the network never."""
    code = (
        "import sys; from spinline import xray; assert 'numpy' not in sys.modules; "
        "[getattr(xray, n) for n in xray.__all__]; "
        "print([m for m in ('xraylib', 'chemicals', 'numba', 'spinline.network') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_name_is_there_and_unknown_ones_are_not() -> None:
    assert set(dir(xray)) == set(xray.__all__)
    with pytest.raises(AttributeError, match="nothing_such"):
        _ = xray.nothing_such
