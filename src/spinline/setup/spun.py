"""Settings of a spun jet from a scene: ``[jet]`` with ``profile = "spun"`` and the solution."""

import math
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING

from spinline.base.errors import InputError, SpinlineWarning
from spinline.jetprofile.spun.laws import JetLaw
from spinline.jetprofile.spun.settings import Collector, Grid, Inlet, Loads, SpunSettings
from spinline.setup.values import given

if TYPE_CHECKING:
    from spinline.base.checks import FloatArray
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.rheology.solution import Solution
    from spinline.scene.file import Scene
    from spinline.scene.spun import SpunJet

__all__ = ["build_spun", "spun_nozzles", "spun_remarks", "spun_settings"]

_SMALL_CIRCLE = 0.2  # needle radii: what was tried against a straight jet (20 of 125 um), and a little more


def spun_settings(
    section: "SpunJet", solution: "Solution", *, scene: "Scene | None" = None, seed: int | None = None
) -> SpunSettings:
    """What the solver is given; air and drying come with the `scene`.

    Raises
    ------
    InputError
        For what the solution lacks, or a charge that cannot be.
    """
    radius, flow, gap = section.radius.value, section.flow_rate.value, section.gap.value
    law = _law(section, solution)
    frozen = section.charge == "frozen"
    area = math.pi * radius**2
    density = 0.0
    if frozen and section.charge_density is not None:
        density = section.charge_density.value
    elif frozen and section.current is not None:
        density = section.current.value / flow
    loads = _loads(section, gap, radius)
    step = given(section.element_length) or radius / (15 if section.charge == "conducting" else 5)
    amplitude = given(section.nozzle_amplitude) or 0.0
    if section.charge == "conducting" and amplitude > _SMALL_CIRCLE * radius:
        warnings.warn(
            f"jet.nozzle_amplitude: a circle of {amplitude / radius:.2g} needle radii takes the nozzle off the needle's axis, "
            "where its field is lower: at 0.8 radii the line charge is 8 to 11 % low, at 0.16 it is within 1 %; take a "
            "smaller circle",
            SpinlineWarning,
            stacklevel=2,
        )
    frequency = 2 * math.pi * (given(section.nozzle_frequency) or 0.0)
    given_stress = law.solvent_viscosity > 0.0 or section.inlet_stress == "given"
    inlet = Inlet(
        flow,
        radius,
        charge_density=density,
        stress="given" if given_stress else "free",
        length=2 * step,
        amplitude=amplitude,
        frequency=frequency,
        ramp=5 / frequency if frequency else 0.0,
    )
    longest = given(section.longest_element) or 0.0
    if 0.0 < longest < 2 * step:
        raise InputError(
            "jet.longest_element",
            "splits elements as they enter",
            value=f"{longest:g} m",
            allowed=f">= {2 * step:g} m, twice jet.element_length",
            remedy="raise it, or lower jet.element_length",
        )
    grid = Grid(
        step,
        tolerance=section.tolerance,
        repulsion="none" if section.charge == "none" else "hybrid",
        pressure=not frozen,
        feed_length=gap if frozen else 0.0,
        feed_charge=density * area if frozen else 0.0,
        log_length=gap,
        bending=section.bending,
        longest=longest,
        turn=section.largest_turn or 0.0,
    )
    settings = SpunSettings(
        density=solution.density,
        law=law,
        inlet=inlet,
        loads=loads,
        grid=grid,
        surface_tension=given(section.surface_tension) or 0.0,
        collector=Collector(
            section.collector, given(section.collector_speed) or 0.0, given(section.collector_radius) or 0.0
        ),
        seed=section.seed if seed is None else seed,
    )
    if scene is not None:
        from spinline.setup.spun_air import spun_air, spun_drying

        settings = replace(
            settings, air=spun_air(section, scene, solution), drying=spun_drying(section, scene, solution)
        )
    if section.charge == "conducting":
        return _conducting(section, solution, settings)
    if section.start == "straight-jet":
        raise InputError(
            "jet.start",
            "is the straight jet's, whose charge moves",
            value=section.start,
            remedy='charge = "conducting", or start = "needle"',
        )
    return settings


def spun_nozzles(section: "SpunJet") -> "FloatArray":
    """Places of the nozzles across the axis, (jet, 2), m."""
    from spinline.jetprofile.spun.several import pattern

    return pattern(section.jet_pattern, section.jets, given(section.jet_spacing) or 0.0)


def _loads(section: "SpunJet", gap: float, radius: float) -> Loads:
    """Fields on the jet."""
    strength = given(section.magnetic_field) or 0.0
    return Loads(
        gap,
        kind=section.field,
        voltage=section.voltage.value,
        field=section.voltage.value / gap,
        tip=radius,
        gravity=section.gravity.value,
        image=section.image,
        side=section.side_kind if section.side_field is not None else "none",
        side_field=given(section.side_field) or 0.0,
        side_frequency=2 * math.pi * (given(section.side_frequency) or 0.0),
        magnetic=tuple(strength if axis == section.magnetic_direction else 0.0 for axis in "xyz"),  # type: ignore[arg-type]
    )


def _conducting(section: "SpunJet", solution: "Solution", settings: SpunSettings) -> SpunSettings:
    """With charge that moves, on the straight jet of the same bench."""
    from spinline.jetprofile.ehd import NeedleSettings
    from spinline.setup.spun_start import conducting

    law = settings.law
    if law.name not in ("fene-p", "oldroyd-b", "giesekus"):
        raise InputError(
            "jet.law",
            f"is {law.name}, which has no solvent's viscosity: its jet has no steady start at a needle",
            value=section.law,
            allowed="fene-p, oldroyd-b, giesekus",
            remedy='another law, or charge = "frozen" by name, with charge_density or current',
        )
    missing = [n for n in ("conductivity", "surface_tension") if getattr(section, n) is None]
    if missing:
        raise InputError(
            f"jet.{missing[0]}",
            "is missing: charge moves in the liquid (the default), from a needle",
            remedy='give it, or charge = "frozen" by name, with charge_density or current',
        )
    assert section.conductivity is not None
    assert section.surface_tension is not None
    assert solution.viscosity is not None
    assert solution.relaxation_time is not None
    try:
        needle = NeedleSettings(
            radius=section.radius.value,
            flow_rate=section.flow_rate.value,
            voltage=section.voltage.value,
            gap=section.gap.value,
            conductivity=section.conductivity.value,
            surface_tension=section.surface_tension.value,
            viscosity=solution.viscosity,
            density=solution.density,
            permittivity=section.permittivity.value,
            relaxation_time=solution.relaxation_time,
            law=law.name,  # type: ignore[arg-type]
            solvent_share=section.solvent_share,
            extensibility=law.extensibility if math.isfinite(law.extensibility) else None,
            mobility=law.mobility,
            field=section.field,
            log="slender",
            current=given(section.current),
            gravity=section.gravity.value,
        )
    except InputError as error:
        raise InputError(
            f"jet.{error.field}", error.problem, value=error.value, allowed=error.allowed, remedy=error.remedy
        ) from None
    place = None
    if section.start == "straight-jet":
        place = given(section.start_position) or 24 * section.radius.value
    return conducting(settings, needle, place)


def spun_remarks(section: "SpunJet", solution: "Solution", scene: "Scene | None" = None) -> tuple[str, ...]:
    """What is odd about a jet to be spun: the numbers that decide, before anything runs."""
    s = spun_settings(section, solution, scene=scene)
    r0, v0 = s.inlet.radius, s.inlet.speed
    wave = math.sqrt(3 * s.law.modulus / s.density)
    said = [
        f"De = theta v0/r0 = {s.law.relaxation_time * v0 / r0:.3g}; v0/c = {v0 / wave:.3g}; element/radius = "
        f"{s.grid.element_length / r0:.3g} at the nozzle"
    ]
    if s.inlet.charge_density:
        line = s.inlet.charge_density * math.pi * r0**2
        surface = line / (2 * math.pi * r0 * 8.8541878188e-12)
        said.append(
            f"charge frozen: e^2/(G A0) = {8.9875517873681764e9 * line**2 / (s.law.modulus * math.pi * r0**2):.3g}"
        )
        if section.conductivity is not None:
            share = _conducted(section, v0, r0)
            said.append(f"charge frozen, but about {share:.0%} of the current is still conducted at a tenth of the gap")
        if surface > 3e6:
            said.append(f"charge frozen: {surface / 1e6:.3g} MV/m at the surface, over the breakdown of air (3)")
    return tuple(said) + _air_remarks(s)


def _air_remarks(s: SpunSettings) -> tuple[str, ...]:
    """What dries, and what the drying along beads leaves out."""
    said = []
    if s.drying is not None:
        d = s.drying
        least = max(d.least_sherwood, 0.1)
        time = s.inlet.radius**2 / (d.vapour_diffusion * least * max(d.equilibrium - d.far, 1e-300))
        words = "with heat" if d.heat_capacity > 0 else "at the jet's temperature"
        said.append(
            f"dries along the beads, {words}: {time:.3g} s at the nozzle's radius (it goes as the radius squared); its "
            "conductivity stays that of the solution, and no water of the air enters"
        )
    if s.air is not None and s.air.noise > 0:
        piece = s.density * s.air.grain
        said.append(
            f"noise: D_v = {s.air.noise / piece:.3g} m2/s3 of a piece of {s.air.grain:.3g} m3, every {s.air.interval:.3g} s"
        )
    return tuple(said)


def _conducted(section: "SpunJet", v0: float, r0: float) -> float:
    """Share of the current that is conducted, a tenth of the gap along a jet of the nozzle's radius and speed.

    ``q = 1/(1 + 2 Pe_z^0.65)``, ``Pe_z = 2 eps0 v s/(K r^2 ln(L/r))``: within 20 % along computed jets.
    """
    assert section.conductivity is not None
    gap = section.gap.value
    peclet = 2 * 8.8541878188e-12 * v0 * 0.1 * gap / (section.conductivity.value * r0**2 * math.log(gap / r0))
    share: float = 1 / (1 + 2 * peclet**0.65)
    return share


def _law(section: "SpunJet", solution: "Solution") -> JetLaw:
    if solution.viscosity is None:
        raise InputError("solution.viscosity", "is missing: the jet's law needs it")
    if solution.relaxation_time is None:
        raise InputError("solution.relaxation_time", "is missing: the jet's law needs it")
    share = 0.0 if section.law in ("ucm", "linear-maxwell") else section.solvent_share
    numbers: dict[str, float] = {}
    if section.law == "fene-p":
        numbers["extensibility"] = section.extensibility or solution.volume_fraction**-2
    if section.law == "giesekus":
        numbers["mobility"] = section.mobility
    if section.law == "herschel-bulkley":
        numbers |= {
            "yield_stress": given(section.yield_stress) or 0.0,
            "consistency": solution.viscosity,
            "index": section.index,
        }
    return JetLaw.from_viscosity(
        section.law, solution.viscosity, solution.relaxation_time, solvent_ratio=share, **numbers
    )


def build_spun(section: "SpunJet", scene: "Scene", solution: "Solution") -> "LagrangianJet":
    """The last moment of the spun jet of a scene: computed here, which may take minutes; ``spinline spin`` keeps it."""
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.jetprofile.spun.dataset import to_dataset
    from spinline.jetprofile.spun.run import SpunRun, moments

    if section.jets > 1:
        raise InputError(
            "jet.jets",
            "are several, and a network is followed along one",
            value=section.jets,
            remedy='`spinline spin` them, and take one file with profile = "lagrangian"',
        )
    run = SpunRun.start(spun_settings(section, solution, scene=scene))
    for _ in run.to(moments(section.time.value, 4)):
        pass
    return LagrangianJet.from_dataset(to_dataset(run)).at(None)
