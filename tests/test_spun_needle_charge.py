"""What the charge of a whole jet sees: needle, plate and itself, against boundary elements."""

import math
from dataclasses import replace

import numpy as np
import pytest
from peo_needle import peo_needle
from test_spun_whole import _spun

from spinline.jetprofile.ehd import StraightEhdJet
from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun._chain_kernels import geometry
from spinline.jetprofile.spun._field_kernels import hyperboloid_level
from spinline.jetprofile.spun._potential_kernels import potential_matrix
from spinline.jetprofile.spun.chain import parameters
from spinline.jetprofile.spun.needle import rings
from spinline.jetprofile.spun.settings import tables_of
from spinline.jetprofile.spun.start import start_straight

# axisymmetric boundary elements on needle and jet with the plate's mirror (331 panels), the straight jet's radius and
# potential given: z in m, line charge in C/m
AT = np.array([3e-3, 5e-3, 10e-3, 20e-3, 40e-3])
ELEMENTS = np.array([25.468, 26.254, 26.662, 25.115, 19.807]) * 1e-9


def _line_charge(metal):
    """Line charge that has the straight jet's own potential, with the chain's matrix."""
    needle = peo_needle()
    jet = StraightEhdJet(needle, length=needle.gap)
    s = _spun(needle, element_length=5e-6)
    s = replace(s, grid=replace(s.grid, settle=0.0), loads=replace(s.loads, metal=metal))
    chain = start_straight(s, s.start)
    n, y = chain.n, chain.state
    p, k = parameters(s)
    w, matrix, outer = np.zeros((c.WORK, len(y))), np.zeros((n, n)), np.zeros(n)
    geometry(n, y, p, k, w)
    potential_matrix(n, y, p, k, tables_of(s), w, matrix, outer)
    z = np.concatenate(([0.0], np.geomspace(1e-7, needle.gap, 20000)))
    field = jet.field_inside(z)
    fall = np.concatenate(([0.0], np.cumsum(0.5 * (field[1:] + field[:-1]) * np.diff(z))))
    middle = 0.5 * (y[:n, c.X] + y[1 : n + 1, c.X])
    applied = [hyperboloid_level(x, 0.0, needle.voltage, needle.gap, needle.radius) for x in middle]
    charge = np.linalg.solve(matrix, needle.voltage - np.interp(middle, z, fall) - np.array(applied))
    return np.interp(AT, middle[::-1], (charge / w[c.LENGTH, :n])[::-1])


@pytest.mark.slow
def test_line_charge_against_boundary_elements():
    found = _line_charge(metal=True)
    assert found[1:] == pytest.approx(ELEMENTS[1:], rel=5e-3)
    assert found[0] == pytest.approx(ELEMENTS[0], rel=1e-2)  # 0.9 %: the cone's, of 1.25 mm
    bare = _line_charge(metal=False) / ELEMENTS  # what leaving the needle's own charge out costs
    assert 0.93 < bare[0] < 0.96
    assert bare[-1] > 0.985


def test_rings_of_a_needle():
    """Symmetric and positive; a charge far off induces nearly minus itself on a needle that reaches beyond it."""
    depth, radius, inverse = rings(0.1, 125e-6)
    assert inverse == pytest.approx(inverse.T, rel=1e-12)
    assert np.linalg.eigvalsh(inverse).min() > 0
    assert radius == pytest.approx(np.sqrt(125e-6 * depth * (2 + depth / 0.1)), rel=1e-12)
    near = 1 / np.hypot(1e-5 + depth, radius) - 1 / np.hypot(0.2 - 1e-5 + depth, radius)
    induced = -float(np.sum(inverse @ near))
    assert -1.0 < induced < -0.8
    assert math.isfinite(induced)
