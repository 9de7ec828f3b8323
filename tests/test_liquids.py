"""The library's own rows and series of liquids against what they were taken from."""

import importlib

import numpy as np
import pytest

from spinline.rheology import solvent_density, solvent_viscosity
from spinline.rheology._liquid_rows import MELTING, ROWS
from spinline.rheology._water import HIGHEST, LOWEST
from spinline.rheology.solvents import _GLASS, SOLVENTS

_MODULES = {
    "rho_data_Perry_8E_105_l": "chemicals.volume",
    "mu_data_Perrys_8E_2_313": "chemicals.viscosity",
    "Psat_data_Perrys2_8": "chemicals.vapor_pressure",
    "phase_change_data_Perrys2_150": "chemicals.phase_change",
}


@pytest.mark.parametrize("table", ROWS)
def test_rows_are_those_of_the_tables_and_none_lacks(table):
    names, rows = ROWS[table]
    source = getattr(importlib.import_module(_MODULES[table]), table)
    assert set(rows) == {cas for cas, _, _ in SOLVENTS.values() if cas in source.index}
    for cas, row in rows.items():
        assert row == tuple(float(source.loc[cas][name]) for name in names), cas


def test_water_is_that_of_the_formulations():
    from chemicals.iapws import iapws95_rhol_sat
    from chemicals.viscosity import mu_IAPWS

    for kelvin in np.linspace(LOWEST, HIGHEST, 257).tolist():
        density = iapws95_rhol_sat(kelvin)
        assert solvent_density("water", kelvin) == pytest.approx(density, rel=2e-14)
        assert solvent_viscosity("water", kelvin) == pytest.approx(mu_IAPWS(kelvin, density), rel=3e-13)
    assert solvent_density("water", HIGHEST + 1e-6) == pytest.approx(solvent_density("water", HIGHEST), rel=1e-8)


def test_melting_points_are_those_of_the_library():
    from chemicals.phase_change import Tm

    assert {cas: Tm(cas) for cas in MELTING} == MELTING
    assert {cas for name, (cas, _, _) in SOLVENTS.items() if name not in _GLASS} == set(MELTING)
