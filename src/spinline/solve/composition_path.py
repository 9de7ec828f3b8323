"""Does the jet stay one phase as it dries in humid air: what can be said of it, in a sentence.

Needs one solvent, water (in the jet or from the air), and three interaction parameters, the ones of the jet's balance: given in
``[rheology]`` (chi, chi_water, chi_water_solvent) or known to the library; of a single liquid one. Where one is not known,
that is said, and nothing is guessed. Inside the spinodal before it is solid the jet separates at once: porous.
"""

import numpy as np

from spinline.base.checks import FloatArray
from spinline.rheology.ternary import Ternary
from spinline.setup.air import known_interaction, water_with
from spinline.setup.context import Context
from spinline.setup.solid import Liquids

__all__ = ["composition_path"]

_CHAIN = 100.0  # kg/mol, where the molar mass is not known: it hardly matters to the spinodal of a long chain
_TRACE = 1e-6  # volume fraction of water under which there is none


def composition_path(context: Context, position: FloatArray, here: Liquids, names: list[str], arrest: float) -> str:
    """The attribute ``composition_path``."""
    dry = "water" not in names or float(here.liquid[names.index("water")].max()) < _TRACE
    if names == ["water"] or (dry and len(names) - ("water" in names) == 1):
        said = "no water in the jet or in its air" if dry else "water is the only liquid"
        return f"{said}: {_alone(context, position, here, names, arrest)}"
    if dry:
        return "no water in the jet or in its air: not judged among several solvents"
    if len(names) > 2:
        return "not judged: more than one solvent beside water"
    water, solvent = names.index("water"), 1 - names.index("water")
    name, polymer = names[solvent], context.solution.polymer.name
    keys = (
        f"rheology.chi ({polymer} with {name})",
        f"rheology.chi_water ({polymer} with water)",
        f"rheology.chi_water_solvent (water with {name})",
    )
    s = context.solution
    found = [known_interaction(context.scene, s, liquid) for liquid in (name, "water")]
    found.append(water_with(context.scene, name))
    missing = [key for key, value in zip(keys, found, strict=True) if value is None]
    values = [value for value in found if value is not None]
    if missing:
        return f"not judged, for want of {' and '.join(missing)}: give what is known of it"
    chain = (s.molar_mass or _CHAIN) / s.polymer.density
    path = Ternary(
        float(here.molar_volume[water]), float(here.molar_volume[solvent]), chain, values[2], values[1], values[0]
    )
    before = np.isnan(arrest) | (position <= arrest)
    some = np.unique(np.linspace(0, int(before.sum()) - 1, 201).astype(int))
    one, p = here.liquid[water][before][some], here.polymer[before][some]
    verdict = path.follow(one, p)
    said = ", ".join(f"chi {v:.3g}" for v in values)

    def at(k: int) -> str:
        rest = max(1 - one[k] - p[k], 0.0)
        return f"{position[before][some][k]:.4g} m (water {one[k]:.3g}, {name} {rest:.3g}, {polymer} {p[k]:.3g})"

    if verdict.spinodal >= 0:
        return f"porous: crosses the spinodal at {at(verdict.spinodal)}, the binodal at {at(max(verdict.binodal, 0))} ({said})"
    if verdict.binodal >= 0:
        return f"one phase if nothing nucleates: crosses the binodal at {at(verdict.binodal)}, no spinodal ({said})"
    return f"one phase up to {position[before][some][-1]:.4g} m ({said})"


def _alone(context: Context, position: FloatArray, here: Liquids, names: list[str], arrest: float) -> str:
    """Of one liquid: Flory and Huggins' binary spinodal, ``1/(1 - phi) + v/(V phi) = 2 chi``."""
    name = next((n for n in names if n != "water"), "water")
    polymer = context.solution.polymer
    chi = known_interaction(context.scene, context.solution, name)
    if chi is None:
        return f"not judged, for want of rheology.chi ({polymer.name} with {name}): give what is known of it"
    chain = (context.solution.molar_mass or _CHAIN) / polymer.density
    phi = here.polymer[np.isnan(arrest) | (position <= arrest)]
    inside = 1 / np.maximum(1 - phi, 1e-300) + here.molar_volume[names.index(name)] / (chain * phi) < 2 * chi
    if not inside.any():
        return f"one phase (chi {chi:.3g})"
    k = int(np.argmax(inside))
    return f"porous: inside the spinodal from {position[k]:.4g} m, {polymer.name} {phi[k]:.3g} (chi {chi:.3g})"
