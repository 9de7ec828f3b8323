"""What makes a solution of a scene solid: its glass, and its crystals, wherever its temperature and composition have
got to.

Each is a *margin* along the jet, in kelvin: T_g(phi) - T, and T_m(phi) less the supercooling - T. The jet is solid
where the first of them becomes positive. A vitrification fraction that the scene gives takes the place of the glass,
at every temperature. A solution that is under its melting point at the nozzle already shows that its crystals wait for
more than equilibrium: 30 K more are asked then (polymers that crystallise at all do so within seconds 30 to 60 K under
their melting points), and where even that holds at the nozzle (PVDF in DMF) it is a question of time alone: kinetics can
be given, and without them the jet counts as solid where all but a twentieth of it is polymer.

A chill below the nozzle's temperature counts for the glass and not for crystals: nuclei take seconds, a wet jet is cold
for milliseconds. PEO in water hardly minds (phi 0.763 against 0.710 at 17 degC, the fibre 512 against 514 nm); PCL in DCM
would be a solid of 12 % polymer within the first millimetre.
"""

from dataclasses import dataclass, replace

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.rheology import solvents
from spinline.rheology.crystal import Crystals, Nakamura
from spinline.rheology.glass import GlassLaw
from spinline.rheology.solution import Solution
from spinline.scene.air_and_rheology import RheologySection
from spinline.scene.file import Scene, SolventData
from spinline.setup.values import given

__all__ = ["DRY", "GEL", "Liquids", "Solid", "build_solid"]

NUCLEATION = 30.0  # K
DRY = 0.95  # polymer fraction of a solid, whose crystals are a question of time
GEL = 0.15  # of the crystallinity that it will have: from there on the crystals hold together


@dataclass(frozen=True, eq=False)
class Liquids:
    """What is in the jet along it: T (K), polymer fraction (n,), fractions of the liquids (liquid, n), their molar
    volumes and chi.
    """

    temperature: FloatArray
    polymer: FloatArray
    liquid: FloatArray
    molar_volume: FloatArray
    chi: FloatArray

    @property
    def mean_volume(self) -> FloatArray:
        """Molar volume of the liquid, m3/mol, (n,)."""
        whole = np.maximum(self.liquid.sum(axis=0), 1e-300)
        value = whole / np.maximum((self.liquid / self.molar_volume[:, np.newaxis]).sum(axis=0), 1e-300)
        found: FloatArray = np.where(self.liquid.sum(axis=0) > 1e-290, value, self.molar_volume[0])
        return found

    @property
    def mean_chi(self) -> FloatArray:
        """Chi of the liquid, by volume, (n,)."""
        whole = self.liquid.sum(axis=0)
        mean = (self.liquid * self.chi[:, np.newaxis]).sum(axis=0)
        value: FloatArray = np.divide(mean, whole, out=np.full_like(whole, float(self.chi[0])), where=whole > 1e-290)
        return value


@dataclass(frozen=True, eq=False)
class Solid:
    """How a solution solidifies.

    Attributes
    ----------
    glass : GlassLaw or None
        None where a glass transition is not known.
    crystals : Crystals or None
        None where the polymer has none, or they are switched off.
    kinetics : Nakamura or None
    supercooling : float
        K.
    words : str
        What is known of the crystals.
    nozzle : float
        Temperature of the solution there, K.
    when_dry : bool
        Crystals are judged by dryness alone.
    """

    glass: GlassLaw | None
    crystals: Crystals | None
    kinetics: Nakamura | None
    supercooling: float
    words: str
    nozzle: float
    when_dry: bool = False

    def glass_margin(self, here: Liquids) -> FloatArray:
        """``T_g - T`` in K; -inf where there is no glass."""
        if self.glass is None:
            return np.full_like(here.polymer, -np.inf)
        value: FloatArray = self.glass.transition(np.minimum(here.polymer, 1.0), here.liquid) - here.temperature
        return value

    def crystal_margin(self, here: Liquids) -> FloatArray:
        """``T_m - supercooling - T`` in K, T not under the nozzle's: a chill of milliseconds is too short for nuclei."""
        if self.crystals is None:
            return np.full_like(here.polymer, -np.inf)
        if self.when_dry:
            dryness: FloatArray = self.crystals.melting_temperature * (here.polymer / DRY - 1)
            return dryness
        inverse = self.crystals.inverse_melting_point(np.minimum(here.polymer, 1.0), here.mean_volume, here.mean_chi)
        kelvin = np.maximum(here.temperature, self.nozzle)
        # T (1 - (T + supercooling)/T_m): its sign, and near it its size; finite where crystals melt at no temperature
        value: FloatArray = kelvin * (1 - (kelvin + self.supercooling) * inverse)
        return value


def build_solid(scene: Scene, solution: Solution, names: list[str], first: Liquids) -> Solid:
    """Glass and crystals of a scene; `names` of the liquids and `first`, what is in the jet at the nozzle (n = 1)."""
    laws = scene.rheology or RheologySection()
    kinetics = None
    if laws.crystallisation == "nakamura":
        kinetics = Nakamura(
            half_time=given(laws.crystallisation_half_time),
            exponent=laws.avrami_exponent or 3.0,
            flow_enhancement=given(laws.flow_enhancement, 0.0),
            maximum=given(laws.maximum_crystallinity, 1.0),
        )
    glass = _glass(scene, solution, names)
    crystals, words = _crystals(laws, solution)
    found = Solid(glass, crystals, kinetics, laws.supercooling.value, words, solution.temperature)
    if crystals is None or kinetics is not None or float(found.crystal_margin(first)[0]) <= 0:
        return found
    least = max(NUCLEATION, laws.supercooling.value)
    later = replace(
        found,
        supercooling=least,
        words=words.rpartition("supercooling ")[0]
        + (f"supercooling {least:g} K, since the solution is under its melting point at the nozzle already"),
    )
    if float(later.crystal_margin(first)[0]) <= 0:
        return later
    time = (
        "the solution is under its melting point at the nozzle already: crystals are a question of time, not of equilibrium; "
        'give rheology.crystallisation = "nakamura" and a half time'
    )
    return Solid(
        glass, crystals, None, laws.supercooling.value, f"solid when dry: {time}", solution.temperature, when_dry=True
    )


def _crystals(laws: RheologySection, solution: Solution) -> tuple[Crystals | None, str]:
    p = solution.polymer
    if laws.crystallisation == "none":
        return None, "crystallisation is off"
    known = (p.melting_temperature, p.melting_enthalpy, p.repeat_unit_molar_mass)
    if not all(value > 0 for value in known):
        if laws.crystallisation == "nakamura":
            raise InputError(
                "rheology.crystallisation",
                f"needs melting_temperature, melting_enthalpy and repeat_unit_molar_mass of {p.name}",
                value="nakamura",
                remedy="give them in solution.polymer, or in a file of materials",
            )
        return None, f"{p.name} is not known to crystallise"
    return Crystals(known[0], known[1], known[2] / p.density), (
        f"Flory's melting-point depression, T_m0 = {known[0]:g} K, {known[1] * 1e-3:g} kJ/mol, supercooling "
        f"{laws.supercooling.value:g} K"
    )


def _glass(scene: Scene, solution: Solution, names: list[str]) -> GlassLaw | None:
    own = scene.solution.solvent if isinstance(scene.solution.solvent, SolventData) else None
    glass, density = [], []
    if not solution.polymer.glass_transition > 0:
        return None
    for name in names:
        if own is not None and name == own.name:
            if own.glass_transition is None:
                return None
            glass.append(own.glass_transition.value)
            density.append(solution.solvent_density)
            continue
        try:
            glass.append(solvents.solvent_glass_transition(name))
            alone = len(solution.solvent) == 1 and name in solution.solvent
            density.append(solution.solvent_density if alone else solvents.solvent_density(name, solution.temperature))
        except InputError:
            return None
    return GlassLaw(solution.polymer.glass_transition, solution.polymer.density, tuple(glass), tuple(density))
