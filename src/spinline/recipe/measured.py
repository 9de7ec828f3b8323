"""What fibres measured on a rig say of another fibre of it.

Ln d is nearly linear in the unknowns (exponents of powers) where a laboratory's unevenness is given, so each draw is moved
by the gain that normal quantities have,

    ln d -> ln d + C_01 C_11^-1 (ln d_measured - ln d_1) ,

ln d_1 being what the same draw says of the measured fibres; the unevenness is drawn from what they leave of it, by Bayes'
rule. The covariances C are sums over the unknowns of the mean changes of ln d (`sensitivities`; a normal quantity and any
function of it have the mean slope as covariance) times what the recipes share: everything of what belongs to the
laboratory; of the materials the cosine between the solvents' fractions, nothing where the polymer is another; of a setting
what its neighbours within a tenth share; of a mat nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any
from zlib import crc32

import numpy as np
from scipy.special import ndtr, ndtri

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.recipe.believe import Recipe, believe
from spinline.recipe.model import OF_MATERIALS, SCATTERED, UNKNOWNS, Believed, normals, scatter, sensitivities, spun
from spinline.recipe.outside import outside_remarks

__all__ = ["Known", "Measurement", "conditioned", "materials_in_common", "moved", "shared", "slopes"]

_CELLS = 200  # of the unevenness of laboratories
_ABOUT = 32  # draws about which the changes of ln d are taken
_NEAR = 0.1  # of a setting's logarithm, of a share: the settings that their scatter is calibrated on mostly lie farther apart
_KELVIN = 20.0  # over which drying changes as other settings do over an e-fold
_WIDEST = 100.0  # sd of a logarithm
_WIDE = 0.8  # the same, where it is as wide as its value
_FAR = 3.0  # standard deviations, beyond which it is said
_SETTINGS = (
    *("voltage", "gap", "flow_rate", "mass_fraction", "needle_radius", "molar_mass"),
    *("viscosity", "conductivity", "surface_tension", "current"),
)


@dataclass(frozen=True)
class Measurement:
    """A fibre that was measured on the same rig: its recipe, its diameter in m, and the standard deviation of its logarithm."""

    recipe: Recipe
    diameter: float
    sd: float = 0.05


@dataclass(frozen=True, eq=False)
class Directions:
    """Unit vectors (recipe, direction) whose products are the correlations of an unknown; a seed for each direction."""

    vectors: FloatArray
    seeds: tuple[int, ...]

    @property
    def correlations(self) -> FloatArray:
        """Between every two recipes, (recipe, recipe)."""
        value: FloatArray = self.vectors @ self.vectors.T
        return value

    def drawn(self, z: FloatArray, column: int) -> FloatArray:
        """Draws of an unknown for every recipe, (recipe, draw), where the first recipe's are `z`."""
        along = self.vectors @ self.vectors[0]
        across = self.vectors - np.outer(along, self.vectors[0])
        found: FloatArray = np.outer(along, z)
        for part, seed in zip(across.T, self.seeds, strict=True):
            if part.any():
                found += np.outer(part, normals(len(z), seed=seed)[:, column])
        return found


def _of_materials(recipes: Sequence[Recipe]) -> Directions:
    names = sorted({(recipe.polymer, name) for recipe in recipes for name in recipe.solvent})
    parts = np.array([[r.solvent.get(name, 0.0) * (r.polymer == kind) for kind, name in names] for r in recipes])
    # a direction's draws go by its name, so that they stay the same when another solvent comes in
    seeds = tuple(crc32(f"{kind} in {name}".encode()) for kind, name in names)
    return Directions(parts / np.linalg.norm(parts, axis=1, keepdims=True), seeds)


def _of_settings(recipes: Sequence[Recipe]) -> Directions:
    """Each by itself but for what near ones share: nothing jumps where a setting comes upon a measured one."""
    places = [_setting(recipe) for recipe in recipes]
    names = sorted(set().union(*places))
    x = np.array([[place.get(name, 0.0) for name in names] for place in places])
    # what one says and another does not keeps them apart; a solvent is there with a share of nothing
    kinds = [
        (r.polymer, r.ratio_known, *sorted(place.keys() - r.solvent.keys()))
        for r, place in zip(recipes, places, strict=True)
    ]
    alike = np.array([[one == other for other in kinds] for one in kinds])
    apart = np.square(x[:, np.newaxis] - x).sum(axis=-1) / _NEAR**2
    return _each(np.exp(-0.5 * apart) * alike)


def _each(correlations: FloatArray) -> Directions:
    """A direction for each recipe, of which it has what those before leave of it (Cholesky; of one like them nothing)."""
    left, vectors = correlations.copy(), np.zeros_like(correlations)
    for i in range(len(left)):
        if left[i, i] > 1e-9:
            vectors[:, i] = left[:, i] / np.sqrt(left[i, i])
            vectors[:i, i] = 0.0
            left -= np.outer(vectors[:, i], vectors[:, i])
    return Directions(vectors, tuple(range(100, 100 + len(left))))


def shared(recipes: Sequence[Recipe]) -> list[Directions]:
    """What recipes of one laboratory share of each unknown, in the order of `UNKNOWNS`; a mat of its own each."""
    everything = Directions(np.ones((len(recipes), 1)), (0,))
    of = dict.fromkeys(OF_MATERIALS, _of_materials(recipes)) | {
        "setting": _of_settings(recipes),
        "repeat": _each(np.eye(len(recipes))),
    }
    return [of.get(name, everything) for name in UNKNOWNS]


def _setting(recipe: Recipe) -> dict[str, float]:
    """Where a recipe stands, by the name of what it says of how it is spun: logarithms, shares, and the like of them."""
    said = {name: float(np.log(value)) for name in _SETTINGS if (value := getattr(recipe, name)) == value}
    said |= {"temperature": recipe.temperature / _KELVIN, "humidity": recipe.relative_humidity}
    return {name: value for name, value in said.items() if value == value} | dict(recipe.solvent)


def materials_in_common(recipes: Sequence[Recipe]) -> FloatArray:
    """Correlations of what recipes do not know of their materials, (recipe, recipe)."""
    return _of_materials(recipes).correlations


def slopes(believed: Believed, **how: Any) -> FloatArray:
    """Mean change of ln d with each unknown, (unknown, recipe), where mats scatter as usual; `how` as of `sensitivities`."""
    about = normals(_ABOUT, seed=2).copy()
    about[:, list(UNKNOWNS).index("unevenness")] = 0.0
    return sensitivities(believed, about=about, step=0.5, **how)


@dataclass(frozen=True, eq=False)
class Known:
    """Covariances of ln d of some recipes, the first not measured and the others measured.

    Attributes
    ----------
    steady : ndarray, (recipe, recipe)
        Of what does not depend on how uneven the laboratory is, with the errors of measuring.
    scattered : ndarray, (recipe, recipe)
        Of settings and mats in a usual laboratory.
    unevenness : float
        Standard deviation of the logarithm of a laboratory's scatter.
    """

    steady: FloatArray
    scattered: FloatArray
    unevenness: float

    @classmethod
    def of(
        cls, change: FloatArray, common: Sequence[Directions], error: FloatArray | float, unevenness: float
    ) -> "Known":
        """From the changes of `sensitivities`, what the recipes share, and the sd of the measured logarithms."""
        parts = np.einsum("ij,ik,ijk->ijk", change, change, [part.correlations for part in common])
        apart = np.isin(list(UNKNOWNS), SCATTERED)
        measured = np.broadcast_to(np.square(error), change.shape[1] - 1)
        steady: FloatArray = parts[~apart].sum(axis=0) + np.diag([0.0, *measured])
        return cls(steady, parts[apart].sum(axis=0), unevenness)

    def gain(self, uneven: FloatArray) -> FloatArray:
        """What ln d gains for each ln of a measured diameter, (draw, measured), in laboratories of some unevenness (normal)."""
        every = self._at(uneven)
        return np.asarray(np.linalg.solve(every[:, 1:, 1:], every[:, 1:, :1])[..., 0], dtype=float)

    def uneven(self, drawn: FloatArray, off: FloatArray) -> FloatArray:
        """Unevenness (normal draws) of laboratories whose measured ln d lie `off` what was expected, rank by rank."""
        edges = np.linspace(0.0, 1.0, _CELLS + 1)
        every = self._at(ndtri(0.5 * (edges[1:] + edges[:-1])))[:, 1:, 1:]
        log_p = -0.5 * (off @ np.linalg.solve(every, off[:, np.newaxis])[..., 0].T + np.linalg.slogdet(every)[1])
        chance = np.append(0.0, np.cumsum(np.exp(log_p - log_p.max())))
        found: FloatArray = ndtri(np.interp(ndtr(drawn), chance / chance[-1], edges))
        return found

    def apart(self, off: FloatArray) -> float:
        """Standard deviations of the measured ln d that is farthest from what the other ones let expect; 0 of a single one."""
        if len(off) < 2:
            return 0.0
        precision = np.linalg.inv(self._at(np.array([self.unevenness]))[0, 1:, 1:])  # the mean of the scatter's square
        return float(np.max(np.abs(precision @ off) / np.sqrt(np.diag(precision))))

    def _at(self, uneven: FloatArray) -> FloatArray:
        larger = np.exp(2 * self.unevenness * uneven)[:, np.newaxis, np.newaxis]
        value: FloatArray = self.steady + larger * self.scattered + 1e-12 * np.eye(len(self.steady))
        return value


def moved(
    core: FloatArray, normal: FloatArray, believed: Sequence[Believed], off: FloatArray, known: Known
) -> FloatArray:
    """Draws of ln d of a recipe, given the measured ones.

    Parameters
    ----------
    core : ndarray, (recipe, draw)
        Ln d without `scatter`; the recipe's own first.
    normal : ndarray, (recipe, draw, unknown)
        Draws of the unknowns of each.
    believed : sequence of Believed
    off : ndarray, (measured, draw)
        Measured ln d, with an error drawn.
    known : Known

    Returns
    -------
    ndarray, (draw,)
    """
    column = list(UNKNOWNS).index("unevenness")
    normal = normal.copy()
    normal[:, :, column] = known.uneven(normal[0, :, column], off.mean(axis=1) - core[1:].mean(axis=1))
    log_d = core + [scatter(b, z) for b, z in zip(believed, normal, strict=True)]
    found: FloatArray = log_d[0] + np.sum(known.gain(normal[0, :, column]) * (off - log_d[1:]).T, axis=1)
    return found


def conditioned(
    log_d: FloatArray,
    z: FloatArray,
    recipe: Recipe,
    measured: Sequence[Measurement],
    rung: str,
    shift: float,
    doubt: float = 0.0,
) -> tuple[FloatArray, tuple[str, ...]]:
    """Ln d of the draws, given what was measured, and what is to be said of that.

    Parameters
    ----------
    log_d, z : ndarray, (draw,) and (draw, unknown)
        Of the recipe.
    recipe : Recipe
    measured : sequence of Measurement
    rung : str
    shift : float
        What `log_d` lacks, of the recipe and the measured ones alike.
    doubt : float
        Standard deviation of that.

    Returns
    -------
    tuple of ndarray, (draw,), and tuple of str
    """
    for one in measured:
        if not 0 < one.diameter < np.inf:
            raise InputError(
                "measured.fibre_diameter", "is no size of a fibre", value=one.diameter, allowed="> 0 m, finite"
            )
        if not 0 <= one.sd <= _WIDEST:
            raise InputError(
                "measured.fibre_diameter",
                "has no such spread of its logarithm",
                value=one.sd,
                allowed=f"0 to {_WIDEST:g}",
            )
    recipes = [recipe, *(one.recipe for one in measured)]
    believed = [believe(one)[0] for one in recipes]
    common = shared(recipes)
    normal = np.stack([part.drawn(z[:, i], i) for i, part in enumerate(common)], axis=-1)
    seen = [spun(b, own, rung=rung).log_diameter for b, own in zip(believed[1:], normal[1:], strict=True)]
    core = np.array([log_d, *seen]) - [scatter(b, own) for b, own in zip(believed, normal, strict=True)]
    core += doubt * normals(len(z), seed=300)[:, 0]
    change = slopes(Believed.of(believed), rung=rung)
    error = np.array([one.sd for one in measured])
    known = Known.of(change, common, error, believed[0].sd.get("unevenness", 0.0))
    known = replace(known, steady=known.steady + doubt**2)
    target = np.array([np.log(one.diameter) for one in measured]) - shift
    off = target - np.median(seen, axis=1)
    far = float(np.max(np.abs(off) / np.sqrt(np.var(seen, axis=1) + error**2 + doubt**2)))
    drawn = np.array([sd * normals(len(z), seed=200 + i)[:, 0] for i, sd in enumerate(error)])
    found = moved(core, normal, believed, target[:, np.newaxis] - drawn, known)
    return found, (*_settings_remarks(recipe, measured), *_far_remarks(far, known.apart(off)))


def _far_remarks(far: float, apart: float) -> tuple[str, ...]:
    said: tuple[str, ...] = ()
    for size, by in ((far, "its recipe lets"), (apart, "the other measured ones let")):
        if size > _FAR:
            said += (
                f"a measured fibre is {size:.1f} standard deviations from what {by} expect: check its units and settings",
            )
    return said


def _settings_remarks(recipe: Recipe, measured: Sequence[Measurement]) -> tuple[str, ...]:
    """What of the measured fibres' own settings lies outside anything that is spun, and of spreads that leave nothing known."""
    own = outside_remarks(recipe)
    said = [
        f"a measured fibre's settings: {words}"
        for one in measured
        for words in outside_remarks(one.recipe)
        if words not in own
    ]
    if any(one.sd > _WIDE for one in measured):
        said.append("a measured fibre is given with a spread wider than itself: it says little")
    return tuple(dict.fromkeys(said))
