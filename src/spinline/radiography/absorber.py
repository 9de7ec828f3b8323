"""What absorbs and refracts in a set of images: solution, solvent, air and beam, from tables or as given."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.errors import InputError
from spinline.base.text import read_text
from spinline.base.units import parse
from spinline.scene.images_file import KEV, Images
from spinline.xray.matter.absorption import contrast
from spinline.xray.matter.attenuation import Composition, Material, mass_attenuation
from spinline.xray.matter.energy import usable_contrast
from spinline.xray.matter.medium import Medium, solution_medium
from spinline.xray.matter.spectrum import Spectrum
from spinline.xray.row.forward import Absorber
from spinline.xray.row.limit import require_contrast

if TYPE_CHECKING:
    from spinline.rheology.solution import Solution

__all__ = ["build_absorber", "given_medium", "uncalibrated"]

_LONGEST = 10_000_000  # bytes of a table of lines


def build_absorber(images: Images, solution: "Solution") -> tuple[Absorber, "Medium | None", str]:
    """Attenuation of the solution, and in words where it comes from.

    Raises
    ------
    InputError
        Near zero contrast, or for a polymer or solvent without a formula.
    """
    energy = None if images.energy is None else images.energy.value / KEV
    polymer = solution.polymer
    if images.polymer_attenuation is not None and images.solvent_attenuation is not None:
        s_p, s_s = images.polymer_attenuation, images.solvent_attenuation
        d = float(contrast(s_p.value, polymer.density, s_s.value, solution.solvent_density))
        absorber = Absorber(s_s.value * solution.solvent_density, d)
        _require_given_contrast(absorber)
        words = f"given: polymer {s_p.text}, solvent {s_s.text}"
        medium = None if energy is None else _refracting(images, solution, energy, absorber)
        if medium is None:
            return absorber, None, f"{words}; air neglected"
        return medium.absorber, medium, f"{words}; air at {energy:.6g} keV"
    beam = energy if energy is not None else _spectrum(images)
    heavy = _matter("solution.polymer", polymer.repeat_unit or polymer.name, polymer.density)
    light = _matter("solution.solvent", solution.solvent, solution.solvent_density)
    try:
        if energy is not None and images.method != "phase":
            usable_contrast(heavy, light, energy, coherent=images.coherent, temperature=solution.temperature)
        medium = solution_medium(heavy, light, beam, coherent=images.coherent, temperature=solution.temperature)
        absorber = medium.absorber
    except InputError as error:
        if error.field != "energy_kev" or energy is None:
            raise
        raise InputError(
            "energy", error.problem, value=f"{energy:g} keV", allowed=error.allowed, remedy=error.remedy
        ) from None
    part = "total" if images.coherent else "without coherent scatter"
    light_of = f"{energy:.6g} keV" if energy is not None else f"{medium.energy_kev.size} lines"
    words = f"xraylib at {light_of}, {part}: solvent {absorber.solvent:.5g} 1/m, contrast {absorber.contrast:.5g} 1/m"
    return absorber, medium, words


def given_medium(images: Images, solution: "Solution", absorber: Absorber) -> "Medium | None":
    """Refraction where attenuation was given without an energy: of that at which the tables have the solvent's."""
    given = images.solvent_attenuation
    assert given is not None
    energies = np.geomspace(2.0, 150.0, 400)
    try:
        off = np.log(mass_attenuation(solution.solvent, energies, coherent=images.coherent) / given.value)
    except InputError:
        return None
    return _refracting(images, solution, float(energies[int(np.argmin(np.abs(off)))]), absorber)


def uncalibrated(images: Images, solution: "Solution", absorber: Absorber) -> str:
    """What the choice of coefficient is worth."""
    assert images.energy is not None
    other = float(mass_attenuation(solution.solvent, images.energy.value / KEV, coherent=not images.coherent))
    shift = (other * solution.solvent_density - absorber.solvent) / absorber.contrast
    word = "without coherent scatter" if images.coherent else "total"
    return (
        f"the attenuation is not calibrated: with coefficients {word} the fraction would be {abs(shift):.2g} "
        f"{'lower' if shift > 0 else 'higher'}; give calibration_rows if the nozzle's end is in view"
    )


def _require_given_contrast(absorber: Absorber) -> None:
    """Refuse attenuations given alike."""
    try:
        require_contrast(absorber)
    except InputError as error:
        raise InputError(
            "polymer_attenuation",
            "times its density is within 1 % of the solvent's: absorption does not tell them apart",
            value=f"contrast {absorber.contrast:.4g} 1/m",
            allowed=error.allowed,
            remedy="take another photon energy, with the attenuations there",
        ) from None


def _refracting(images: Images, solution: "Solution", energy: float, absorber: Absorber) -> "Medium | None":
    """Refraction, and air, from the tables beside an attenuation that is given; None for matter without a formula."""
    polymer = solution.polymer
    try:
        heavy = Material(polymer.repeat_unit or polymer.name, polymer.density)
        light = Material(solution.solvent, solution.solvent_density)
        medium = solution_medium(heavy, light, energy, coherent=images.coherent, temperature=solution.temperature)
    except InputError:
        return None
    return medium.with_absorber(replace(absorber, air=medium.absorber.air))


def _spectrum(images: Images) -> Spectrum:
    """Lines of the beam: a table of energy = share, or a file of two columns, keV and share."""
    given = images.spectrum
    if isinstance(given, str):
        try:
            text, _ = read_text(images.folder / given, most=_LONGEST)
            rows = [line for line in text.splitlines() if line.partition("#")[0].strip()]
            if not rows:
                raise ValueError("it holds no numbers")
            lines = np.loadtxt(rows, delimiter=",", ndmin=2, comments="#")
        except (InputError, ValueError) as error:
            raise InputError(
                "spectrum", f"cannot be read ({error})", value=given, remedy="two columns: keV, share of the signal"
            ) from None
        energy, weight = lines[:, 0], lines[:, -1]
    else:
        assert given is not None
        pairs = sorted((parse(key, "energy", "spectrum").value / KEV, share) for key, share in given.items())
        energy, weight = np.array([e for e, _ in pairs]), np.array([w for _, w in pairs])
    try:
        return Spectrum(energy, weight)
    except InputError as error:
        raise InputError("spectrum", error.problem, value=error.value, allowed=error.allowed) from None


def _matter(key: str, what: Composition, density: float) -> Material:
    try:
        return Material(what, density)
    except InputError as error:
        raise InputError(
            key,
            "has no chemical formula, so that its attenuation is not known",
            value=error.value,
            remedy="name it by its formula, or give polymer_attenuation and solvent_attenuation",
        ) from None
