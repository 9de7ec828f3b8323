"""Constants of solvents against tables that others keep (those in the `chemicals` library), and of polymers against what
their sources say.
"""

import numpy as np
import pytest
from chemicals.heat_capacity import Cp_data_Poling, CRC_standard_data
from chemicals.phase_change import Hvap_data_CRC, Hvap_data_Gharagheizi

from spinline.rheology import thermal, vapour
from spinline.rheology.materials import _UNITS, POLYMERS, polymer_property, property_source
from spinline.rheology.solvents import SOLVENTS

ROOM = 298.15
# estimates, or where tables do not agree (NMP's liquid: 1680 by calorimetry, 3105 J/kg/K in the CRC table)
NO_LIQUID, NO_VAPOUR = {"HFIP", "TFA", "NMP", "TFE"}, {"DMF", "HFIP", "DMSO", "DMAc", "TFA", "NMP", "TFE"}


def tabled(name: str, key: str) -> list[float]:
    """J/kg/K near 298 K, of the CRC Handbook and of Poling, Prausnitz, O'Connell."""
    cas, mass = SOLVENTS[name][0], vapour.molar_mass(name)
    found = [float(t.loc[cas][key]) / mass for t in (CRC_standard_data, Cp_data_Poling) if cas in t.index]
    return [x for x in found if np.isfinite(x)]


@pytest.mark.parametrize("name", SOLVENTS)
def test_heat_capacities(name: str) -> None:
    for own, key, without in (
        (thermal.liquid_heat_capacity(name), "Cpl", NO_LIQUID),
        (thermal.vapour_heat_capacity(name), "Cpg", NO_VAPOUR),
    ):
        values = tabled(name, key)
        assert bool(values) or name in without
        if name not in without:
            assert all(own == pytest.approx(v, rel=0.02) for v in values)


# heats of vaporisation at 298 K within 2 % of the CRC's, but for the two whose own is the slope of their vapour pressure
@pytest.mark.parametrize("name", SOLVENTS)
def test_heats_of_vaporisation(name: str) -> None:
    cas = SOLVENTS[name][0]
    own = float(thermal.vaporisation_heat(name, ROOM)) * vapour.molar_mass(name)
    known = [
        float(table.loc[cas]["Hvap298"])
        for table in (Hvap_data_CRC, Hvap_data_Gharagheizi)
        if cas in table.index and np.isfinite(table.loc[cas]["Hvap298"])
    ]
    if name == "acetic acid":  # into dimers, or into monomers: twice
        known = known[:1]
    assert known or name in ("TFA", "TFE")
    allowed = {"DMAc": 0.08, "NMP": 0.12, "HFIP": 0.03, "TFE": 0.05, "isopropanol": 0.03}.get(name, 0.025)
    assert all(own == pytest.approx(v, rel=allowed) for v in known)


def test_every_constant_of_a_polymer_says_where_it_is_from_and_within_what() -> None:
    for name, data in POLYMERS.items():
        for key in _UNITS:
            if not getattr(data, key) > 0:
                continue
            words = property_source(name, key)
            assert any(w in words for w in ("within", "in print", "formula", "estimate", "up to", "about")), (name, key)
            assert polymer_property(name, key) == getattr(data, key)
    assert POLYMERS["PEO"].melting_enthalpy == 8660.0  # TA Instruments, TN048
    assert POLYMERS["nylon 6"].melting_enthalpy == 26000.0
