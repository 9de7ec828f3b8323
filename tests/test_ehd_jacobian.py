"""Derivatives of the straight electrified jet's equations, which are written out by hand."""

from itertools import product

import numpy as np
import pytest

from spinline.jetprofile.ehd.equations import PARAMETERS, jacobian, residual, slopes, tilts

SWITCHES = list(product((False, True), repeat=3))


def some(polymer: bool, charge: bool, nodes: int, seed: int = 3):
    """Unknowns of a jet that thins, and parameters of which every term has its share."""
    rng = np.random.default_rng(seed)
    y = rng.normal(0.0, 0.3, (nodes, 4 + 2 * polymer + charge))
    y[:, 0] += np.linspace(0.0, 2.0, nodes)
    y[:, 2] = -rng.random(nodes)
    if charge:
        y[:, -1] = rng.random(nodes)
    p = rng.uniform(0.2, 1.2, len(PARAMETERS))
    p[PARAMETERS.index("extensibility")], p[PARAMETERS.index("mobility")] = 0.01, 0.2
    p[PARAMETERS.index("log_chi")] = 4.0
    return y, p


@pytest.mark.parametrize(("polymer", "charge", "local"), SWITCHES)
def test_derivatives_at_a_place_are_those_of_complex_steps(polymer, charge, local) -> None:
    for seed in range(20):
        (y,), p = some(polymer, charge, 1, seed)
        value, found = np.empty(y.size), np.empty((y.size, y.size))
        tilts(y, 0.7, p, np.array([polymer, charge, local, False]), value, found)
        plain = np.empty(y.size)
        slopes(y, 0.7, p, polymer, charge, local, plain)
        np.testing.assert_array_equal(value, plain)
        for k in range(y.size):
            z, moved = y.astype(complex), np.empty(y.size, complex)
            z[k] += 1e-30j
            slopes.py_func(z, 0.7, p, polymer, charge, local, moved)
            np.testing.assert_allclose(found[:, k], moved.imag * 1e30, rtol=1e-12, atol=1e-13 * np.abs(found).max())


@pytest.mark.parametrize("upwind", [False, True])
@pytest.mark.parametrize(("polymer", "charge", "local"), SWITCHES)
def test_the_band_is_the_derivative_of_the_residual(polymer, charge, local, upwind) -> None:
    n = 5
    y, p = some(polymer, charge, n)
    m = y.shape[1]
    s, flags = np.array([0.0, 0.3, 0.7, 1.2, 1.5]), np.array([polymer, charge, local, upwind])
    ends = [0, *([m - 1] if charge else []), 2, *([4, 5] if polymer else [])]
    left = np.array([[k, 0.1] for k in ends], dtype=float)
    args = np.linspace(0.5, 0.9, n), np.linspace(0.55, 0.85, n - 1), p, flags, left
    low, high = len(ends) + m - 1, 2 * m - 1 - len(ends)
    band = np.empty((2 * low + high + 1, n * m), order="F")
    jacobian(s, y, *args, band)
    for column in range(n * m):
        sides, h = [], 1e-5
        for side in (-h, h):
            z, out = y.copy(), np.empty(n * m)
            z.flat[column] += side
            residual(s, z, *args, out)
            sides.append(out)
        slope = (sides[1] - sides[0]) / (2 * h)
        rows = np.arange(max(0, column - high), min(n * m, column + low + 1))
        scale = np.abs(slope).max()
        np.testing.assert_allclose(band[low + high + rows - column, column], slope[rows], atol=1e-8 * scale)
        assert np.abs(np.delete(slope, rows)).max(initial=0.0) < 1e-8 * scale  # nothing beside the band
