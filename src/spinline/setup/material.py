"""What the solution of a scene becomes as it dries: viscosity, relaxation time, modulus, diffusivity against its fraction.

``rheology.law`` says how. "yarin" is Eq. (45) of the review, in mass fractions, with n = +1 unless `n` is given; "scaling" the
semidilute laws of the solvent's quality, in volume fractions; "martin" an intrinsic viscosity; "constant" nothing changes.
The relaxation time follows n, or the scaling law.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.rheology.constitutive import LAWS, Surroundings
from spinline.rheology.constitutive.fenep import LAW as FINITE_LAW
from spinline.rheology.constitutive.maxwell import LAW as LINEAR_LAW
from spinline.rheology.solution import Solution, mass_fraction
from spinline.scene.air_and_rheology import RheologySection
from spinline.scene.file import Scene
from spinline.setup.coupling import drag_of_solvent

if TYPE_CHECKING:
    from spinline.rheology.conformation import Model
    from spinline.rheology.diffusion_laws import DiffusionLaw

__all__ = ["Material", "build_material", "constitutive_model", "diffusion_law", "glass_fraction"]


@dataclass(frozen=True)
class Material:
    """Laws of one solution; `solvent_viscosity` (Pa s) where a law needs it, NaN otherwise.

    `viscosity` and `relaxation_time` take the polymer's volume fraction, from the solution's up to 1.
    """

    solution: Solution
    laws: RheologySection
    solvent_quality: str
    solvent_viscosity: float

    def concentration(self, volume_fraction: FloatArray) -> FloatArray:
        """Mass fraction C."""
        s = self.solution
        return np.minimum(mass_fraction(volume_fraction, s.polymer.density, s.solvent_density), 1.0)  # rounding only

    def viscosity(self, volume_fraction: FloatArray) -> FloatArray:
        """Zero-shear viscosity in Pa s.

        Raises
        ------
        InputError
            Where the solution's is not known.
        """
        from spinline.rheology import concentration_laws as laws

        s, r = self.solution, self.laws
        phi = np.asarray(volume_fraction, dtype=np.float64)
        if r.law == "martin":
            assert r.intrinsic_viscosity is not None
            assert r.martin_constant is not None
            return laws.martin_viscosity(
                phi * s.polymer.density, r.intrinsic_viscosity.value, r.martin_constant.value, self.solvent_viscosity
            )
        if s.viscosity is None:
            raise InputError("solution.viscosity", "is missing: the viscosity of the jet follows from it", remedy=_GIVE)
        if r.law == "constant":
            return np.full_like(phi, s.viscosity)
        if r.law == "scaling":
            power = laws.scaling_exponents(self.solvent_quality).viscosity
            return laws.scaled_viscosity(phi, s.volume_fraction, s.viscosity, self.solvent_viscosity, power)
        return laws.viscosity(self.concentration(phi), s.mass_fraction, s.viscosity, r.B.value, r.m.value)

    def relaxation_time(self, volume_fraction: FloatArray) -> FloatArray:
        """Relaxation time in s.

        Raises
        ------
        InputError
            Where the solution's is not known.
        """
        from spinline.rheology import concentration_laws as laws

        s, r = self.solution, self.laws
        phi = np.asarray(volume_fraction, dtype=np.float64)
        if s.relaxation_time is None:
            raise InputError("solution.relaxation_time", "is missing: relaxation needs it", remedy=_GIVE)
        if r.law == "scaling" and r.n is None:
            power = laws.scaling_exponents(self.solvent_quality).relaxation
            return laws.scaled(phi, s.volume_fraction, s.relaxation_time, power)
        if r.law == "constant" and r.n is None:
            return np.full_like(phi, s.relaxation_time)
        return laws.relaxation_time(self.concentration(phi), s.mass_fraction, s.relaxation_time, r.n)

    def stiffened(self, factor: FloatArray) -> "Material":
        """The same along samples (n,) at which temperature and glass multiply viscosity and relaxation time."""
        return StiffenedMaterial(self.solution, self.laws, self.solvent_quality, self.solvent_viscosity, factor)

    @property
    def words(self) -> str:
        """Which laws, with their parameters."""
        r = self.laws
        n = "" if r.n is None else f", n = {r.n:g}"
        if r.law == "yarin":
            return f"Eq. (45), B = {r.B.value:g}, m = {r.m.value:g}, n = {1.0 if r.n is None else r.n:g}"
        if r.law == "scaling":
            return f"semidilute scaling, {self.solvent_quality} solvent{n}"
        if r.law == "martin":
            assert r.intrinsic_viscosity is not None
            assert r.martin_constant is not None
            return (
                f"Martin, [eta] = {r.intrinsic_viscosity.value:g} m3/kg, K = {r.martin_constant.value:g}, "
                f"n = {1.0 if r.n is None else r.n:g}"
            )
        return f"constant{n}"


@dataclass(frozen=True)
class StiffenedMaterial(Material):
    """Laws at samples (n,), times a `factor` (n,); elsewhere, which is at the nozzle, as they are."""

    factor: FloatArray

    def viscosity(self, volume_fraction: FloatArray) -> FloatArray:
        """Pa s."""
        plain = super().viscosity(volume_fraction)
        return plain * self.factor if plain.shape == self.factor.shape else plain

    def relaxation_time(self, volume_fraction: FloatArray) -> FloatArray:
        """Seconds."""
        plain = super().relaxation_time(volume_fraction)
        return plain * self.factor if plain.shape == self.factor.shape else plain


_GIVE = "give it, for example --set solution.viscosity='2 Pa s' or solution.relaxation_time='10 ms'"


def build_material(scene: Scene, solution: Solution) -> Material:
    """Laws of a scene's solution.

    Raises
    ------
    InputError
        Where a law needs the viscosity of a solvent that is not built in.
    """
    laws = scene.rheology or RheologySection()
    needs = laws.law in ("scaling", "martin") or (laws.constitutive in LAWS and LAWS[laws.constitutive].needs_solvent)
    solvent = drag_of_solvent(scene, solution, "rheology")[0] if needs else float("nan")
    return Material(solution, laws, scene.network.solvent_quality, solvent)


def constitutive_model(scene: Scene, material: Material, full_stretch: float) -> "Model":
    """Constitutive model of a scene, V_S at rest given: by default Maxwell with closure "force", FENE-P with closure "stretch".

    A strand's finite length is in the walk of closure "force" already, and in nothing but the model with "stretch".
    """
    laws = material.laws
    name = laws.constitutive
    if name == "auto":
        finite = scene.network.closure_used != "force" or laws.parameters(FINITE_LAW)
        name = FINITE_LAW.name if finite else LINEAR_LAW.name
    law = LAWS[name]
    model: Model = law.make(laws.parameters(law), Surroundings(material.solvent_viscosity, full_stretch))
    return model


def diffusion_law(scene: Scene) -> "DiffusionLaw":
    """Diffusion of solvent in the jet.

    Raises
    ------
    InputError
        Where no diffusivity is given.
    """
    from spinline.rheology.diffusion_laws import ConstantDiffusion, ExponentialDiffusion, FreeVolumeDiffusion

    laws = scene.rheology or RheologySection()
    if laws.diffusivity is None:
        raise InputError(
            "rheology.diffusivity",
            "is missing: radial drying needs the diffusivity of the solvent in the solution",
            remedy='give it, for example "1e-9 m2/s"',
        )
    value = laws.diffusivity.value
    if laws.D_law == "constant":
        return ConstantDiffusion(value)
    if laws.D_law == "exponential":
        assert laws.D_decay is not None
        return ExponentialDiffusion(value, laws.D_decay.value)
    assert laws.D_gap is not None
    assert laws.D_growth is not None
    return FreeVolumeDiffusion(value, laws.D_gap.value, laws.D_growth.value)


def glass_fraction(scene: Scene, solution: Solution) -> tuple[float, str]:
    """Polymer fraction that turns to glass, and where it comes from; NaN and the reason where it is not known."""
    laws = scene.rheology or RheologySection()
    phi = solution.volume_fraction
    if laws.vitrification_fraction is not None:
        value = laws.vitrification_fraction.value
        if value <= phi:
            raise InputError(
                "rheology.vitrification_fraction",
                "is not above the solution's own fraction",
                value=value,
                allowed=f"({phi:.6g}, 1)",
                remedy="raise it",
            )
        return value, "given"
    name, dry = solution.polymer.name, solution.polymer.glass_transition
    if solution.temperature >= dry:
        return float("nan"), f"out of reach: dry {name} is no glass at {solution.temperature:g} K (T_g = {dry:g} K)"
    try:
        value = solution.vitrification_fraction()
    except InputError as error:
        return float("nan"), f"not known ({error.field}: {error.problem}): give rheology.vitrification_fraction"
    if value <= phi:
        words = f"below the solution's by Fox's equation ({value:.3g}): give rheology.vitrification_fraction"
        return float("nan"), words
    return value, "Fox's equation"
