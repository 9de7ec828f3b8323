"""Exact chords of shells."""

import itertools

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spinline import xray
from spinline.base.errors import InputError
from spinline.xray.row.chords import disc_chords


@given(
    shells=st.integers(1, 12),
    radius=st.floats(5e-6, 2e-4),
    pixel=st.floats(2e-7, 5e-6),
    offset=st.floats(-1.0, 1.0),
)
def test_pixels_times_chords_are_the_areas_of_the_shells(shells, radius, pixel, offset) -> None:
    radii = radius * xray.equal_shells(shells)
    edges = np.arange(-np.ceil(radius / pixel) - 3, np.ceil(radius / pixel) + 4) * pixel
    chords = xray.shell_chords(radii, edges, axis=offset * pixel)
    assert chords.sum(axis=0) * pixel == pytest.approx(np.pi * np.diff(radii**2), rel=1e-12)
    assert chords.min() >= -1e-12 * radius


def test_one_pixel_against_high_precision() -> None:
    mpmath.mp.dps = 30
    radii, edges, axis = np.array([0.0, 0.3, 0.7, 1.0]), np.array([-1.2, -0.71, -0.29, 0.01, 0.33, 0.9, 1.5]), 0.05
    chords = xray.shell_chords(radii, edges, axis)

    def disc(r: float, x: float) -> mpmath.mpf:
        return 2 * mpmath.sqrt(mpmath.mpf(r) ** 2 - (x - axis) ** 2) if abs(x - axis) < r else mpmath.mpf(0)

    for i, (a, b) in enumerate(itertools.pairwise(edges)):
        for j, (inner, outer) in enumerate(itertools.pairwise(radii)):
            ends = sorted({a, b, *(x for r in (inner, outer) for x in (axis - r, axis + r) if a < x < b)})
            exact = mpmath.quad(lambda x: disc(outer, x) - disc(inner, x), ends) / (b - a)  # noqa: B023
            assert chords[i, j] == pytest.approx(float(exact), abs=1e-14)


def test_the_axis_moves_the_row() -> None:
    radii, edges = np.array([0.0, 20e-6, 50e-6]), np.arange(-80, 81) * 0.7e-6
    assert xray.shell_chords(radii, edges, 3 * 0.7e-6)[3:] == pytest.approx(
        xray.shell_chords(radii, edges)[:-3], abs=1e-17
    )


def test_derivatives_against_differences() -> None:
    radii, edges, h = np.array([0.41, 0.77, 1.03]), np.linspace(-1.5, 1.5, 31), 1e-6
    _, by_radius, by_axis = disc_chords(radii, edges, 0.013)
    up, down = disc_chords(radii + h, edges, 0.013)[0], disc_chords(radii - h, edges, 0.013)[0]
    assert by_radius == pytest.approx((up - down) / (2 * h), abs=1e-4)
    up, down = disc_chords(radii, edges, 0.013 + h)[0], disc_chords(radii, edges, 0.013 - h)[0]
    assert by_axis == pytest.approx((up - down) / (2 * h), abs=1e-4)


def test_a_narrow_pixel_is_the_local_chord() -> None:
    errors = []
    for width in (1e-2, 5e-3):
        chord = xray.shell_chords([0.0, 1.0], np.array([0.3 - width / 2, 0.3 + width / 2]))[0, 0]
        errors.append(abs(chord - 2 * np.sqrt(1 - 0.09)))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.01)


def test_weights_are_shares_of_the_section() -> None:
    assert xray.shell_weights([0.0, 0.5, 1.0]) == pytest.approx([0.25, 0.75], rel=1e-15)
    assert xray.shell_weights(xray.equal_shells(7)).sum() == pytest.approx(1.0, rel=1e-15)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: xray.shell_chords([0.1, 1.0], [0.0, 1.0]), "radii"),
        (lambda: xray.shell_chords([0.0, 1.0, 1.0], [0.0, 1.0]), "radii"),
        (lambda: xray.shell_chords([0.0, 1.0], [0.0, np.nan]), "pixel_edges"),
        (lambda: xray.shell_chords([0.0, 1.0], [1.0, 0.0]), "pixel_edges"),
        (lambda: xray.shell_chords([0.0, 1.0], [0.0, 1.0], [0.0, 0.0]), "axis"),
        (lambda: xray.equal_shells(0), "shells"),
        (lambda: xray.equal_shells(2.5), "shells"),
        (lambda: xray.shell_weights([0.0, 0.9]), "edges"),
    ],
)
def test_refusals(call, words) -> None:
    with pytest.raises(InputError, match=words):
        call()
