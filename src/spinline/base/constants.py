"""Constants of physics, once each: SI (2019) exact where said, else CODATA 2022."""

__all__ = ["AVOGADRO", "BOLTZMANN", "ELEMENTARY_CHARGE", "EPS0", "GAS_CONSTANT", "KEV"]

AVOGADRO = 6.02214076e23  # 1/mol, exact
BOLTZMANN = 1.380649e-23  # J/K, exact
GAS_CONSTANT = 8.31446261815324  # J/(mol K), exact: AVOGADRO * BOLTZMANN
ELEMENTARY_CHARGE = 1.602176634e-19  # C, exact
KEV = 1.602176634e-16  # J, exact
EPS0 = 8.8541878188e-12  # F/m, electric constant
