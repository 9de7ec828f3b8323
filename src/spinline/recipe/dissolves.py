"""Solvents that do not dissolve a polymer, and what of air's water and of the cold that means: remarks, for the laws go on.

Nonsolvents at room temperature: Fuchs, "Solvents and non-solvents for polymers", Polymer Handbook (4th ed.), those that are
beyond doubt. Air's water that a solvent takes up sets a polymer that it does not dissolve: De Vrieze et al., J. Mater. Sci. 44,
1357 (2009); Pai et al., Macromolecules 42, 2102 (2009); Huang et al., J. Polym. Sci. B 49, 1734 (2011).
"""

from spinline.recipe.believe import USUAL_TEMPERATURE, Recipe

__all__ = ["solution_remarks"]

_NOT_IN = {
    "water": ("PAN", "PCL", "PLA", "PS", "PVDF", "nylon 6", "PMMA", "PET", "cellulose acetate", "PVB"),
    "ethanol": ("PAN", "PCL", "PLA", "PS", "PVDF", "PET", "PVA", "gelatin"),
    "toluene": ("PAN", "PVA", "PVP", "PVDF", "nylon 6", "PET", "gelatin"),
    "chloroform": ("PAN", "PVA", "PVDF", "nylon 6", "gelatin"),
    "DCM": ("PAN", "PVA", "PVDF", "nylon 6", "gelatin"),
    "acetone": ("PAN", "PVA", "nylon 6", "PET", "gelatin"),
    "THF": ("PAN", "PVA", "nylon 6", "gelatin"),
    "methanol": ("PAN", "PCL", "PLA", "PS", "PVDF", "PET", "PVA", "gelatin"),
    "isopropanol": ("PAN", "PCL", "PLA", "PS", "PVDF", "PET", "PVA", "gelatin"),
    "ethyl acetate": ("PAN", "PVA", "PVP", "nylon 6", "PET", "gelatin"),
    "DCE": ("PAN", "PVA", "nylon 6", "gelatin"),
    "MEK": ("PAN", "PVA", "nylon 6", "PET", "gelatin"),
    "acetonitrile": ("PAN", "PVA", "nylon 6", "PET", "gelatin"),
    "dioxane": ("PAN", "PVA", "nylon 6", "gelatin"),
    "chlorobenzene": ("PAN", "PVA", "PVDF", "nylon 6", "gelatin"),
}
_MIXES = (
    *("DMF", "DMAc", "DMSO", "NMP", "acetone", "THF", "formic acid", "acetic acid", "ethanol"),
    *("methanol", "isopropanol", "acetonitrile", "dioxane", "TFE"),
)
_MOST = 0.5  # of the solvent, by mass
_HUMID = 0.6  # relative humidity; earlier for some
_GELS = 303.0  # K, below which gelatin in water is a gel


def solution_remarks(recipe: Recipe) -> tuple[str, ...]:
    """What to say of a polymer that its solvent, or air's water in it, does not dissolve.

    Parameters
    ----------
    recipe : Recipe

    Returns
    -------
    tuple of str
    """
    said = []
    bad = [name for name in recipe.solvent if recipe.polymer in _NOT_IN.get(name, ())]
    if _share(recipe, bad) > _MOST:
        said.append(
            f"{recipe.polymer} does not dissolve in {' or '.join(sorted(bad))}: there is no such solution to spin"
        )
    elif recipe.relative_humidity >= _HUMID and recipe.polymer in _NOT_IN["water"] and _share(recipe, _MIXES) > _MOST:
        said.append(
            f"air of {100 * recipe.relative_humidity:.0f} % relative humidity brings water into the jet, which sets "
            f"{recipe.polymer} early: not computed; fibres are rough or porous, and often thicker than said here"
        )
    kelvin = recipe.temperature if recipe.temperature == recipe.temperature else USUAL_TEMPERATURE
    if recipe.polymer == "gelatin" and _share(recipe, ["water"]) > _MOST and kelvin < _GELS:
        said.append(f"gelatin in water is a gel at {kelvin - 273.15:.0f} degC: it is spun warm, from 30 to 40")
    return tuple(said)


def _share(recipe: Recipe, names: list[str] | tuple[str, ...]) -> float:
    return sum(recipe.solvent.get(name, 0.0) for name in names)
