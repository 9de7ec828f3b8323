"""A scene as a function of its parameters: the forward model of a fit, and where to start."""

from collections.abc import Mapping

from spinline.base.errors import InputError
from spinline.fit.model import ForwardModel
from spinline.jetprofile.hyperbolic import Hyperbolic
from spinline.jetprofile.power_law import PowerLaw
from spinline.jetprofile.straight import StraightJet
from spinline.scene.file import HyperbolicJet, PowerLawJet, Scene
from spinline.setup.build import build_jet, build_solution

__all__ = ["forward_model", "typical_relaxation_time"]


def forward_model(
    scene: Scene, *, relaxation: bool = False, evaporation: bool = False, values: Mapping[str, float] | None = None
) -> ForwardModel:
    """Forward model of a scene.

    Parameters
    ----------
    scene : Scene
        With a power-law or hyperbolic jet.
    relaxation, evaporation : bool
        Model them.
    values : mapping, optional
        Parameters in place of the scene's, SI.

    Returns
    -------
    ForwardModel

    Raises
    ------
    InputError
        For a jet without parameters, or what an effect needs and the scene does not say.
    """
    solution = build_solution(scene)
    if not isinstance(scene.jet, PowerLawJet | HyperbolicJet):
        raise InputError("jet.profile", "has no parameters to fit", value=scene.jet.profile,
                         allowed='"power-law", "hyperbolic"', remedy="fit-jet finds k and beta of a table")  # fmt: skip
    jet = build_jet(scene, solution)
    own = {
        "initial_radius": jet.initial_radius, "flow_rate": scene.jet.flow_rate.value,
        "volume_fraction": solution.volume_fraction, "evaporation": 1.0, "fraction_scale": 1.0, "fraction_offset": 0.0,
        "length_scale": 1.0, "origin": 0.0,
    }  # fmt: skip
    if isinstance(jet, PowerLaw):
        own |= {"k": jet.k, "beta": jet.beta}
    elif isinstance(jet, Hyperbolic):
        own |= {"p": jet.p}
    if solution.relaxation_time is not None:
        own["relaxation_time"] = solution.relaxation_time
    own |= dict(values or {})
    if relaxation and "relaxation_time" not in own:
        raise InputError("solution.relaxation_time", "is missing: relaxation needs it",
                         remedy='give it, or relaxation_time = "free" in the fit')  # fmt: skip
    exponent, by_mass = _relaxation_law(scene)
    notes: tuple[str, ...] = ()
    constitutive = "auto" if scene.rheology is None else scene.rheology.constitutive
    if relaxation and constitutive in ("Giesekus", "FENE-P"):
        notes = (f"the fit relaxes the strands by Maxwell's law; rheology.constitutive = {constitutive!r} is not used",)
    air = None
    if evaporation:
        from spinline.setup.air import build_air

        air = build_air(scene, solution)
    if scene.network.closure_used != "force" or scene.network.model not in ("auto", "affine", "conformation"):
        notes += (f"the fit uses the closed forms (affine force); network.model = {scene.network.model!r}, closure = "
                 f"{scene.network.closure_used!r} are not used",)  # fmt: skip
    return ForwardModel(
        profile=scene.jet.profile, values=own, length=scene.jet.length.value,
        solvent_quality=scene.network.solvent_quality, relaxation=relaxation, relaxation_exponent=exponent,
        density_ratio=solution.solvent_density / solution.polymer.density if by_mass else 1.0,
        drying=air, notes=notes,
    )  # fmt: skip


def typical_relaxation_time(scene: Scene) -> float:
    """Time in s over which the middle of a scene's jet is stretched by e: where a fit starts when nothing is known."""
    jet = build_jet(scene, build_solution(scene))
    if not isinstance(scene.jet, PowerLawJet | HyperbolicJet) or not isinstance(jet, StraightJet):
        raise InputError("jet.profile", "has no parameters to fit", value=scene.jet.profile)
    middle = 0.5 * scene.jet.length.value
    rate = float(jet.strain_rate(middle))
    return 1 / rate if rate > 0 else scene.jet.length.value / jet.initial_velocity


def _relaxation_law(scene: Scene) -> tuple[float, bool]:
    """Exponent of the relaxation time, and whether it is of the mass fraction; as `spinline.setup.material` has it."""
    from spinline.rheology.concentration_laws import scaling_exponents
    from spinline.scene.air_and_rheology import RheologySection

    laws = scene.rheology or RheologySection()
    if laws.n is not None:
        return laws.n, True
    if laws.law == "scaling":
        return scaling_exponents(scene.network.solvent_quality).relaxation, False
    return (0.0 if laws.law == "constant" else 1.0), True
