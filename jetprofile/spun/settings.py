"""What a spun jet is given: nozzle, field, charge, air, drying, collector and grid, each a frozen dataclass in SI."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun._codes import FEEDS
from spinline.jetprofile.spun.laws import JetLaw
from spinline.jetprofile.spun.needle import COUNT, rings
from spinline.jetprofile.spun.straight import StraightStart

__all__ = ["Air", "Collector", "Drying", "Grid", "Inlet", "Loads", "SpunSettings"]


@dataclass(frozen=True)
class Inlet:
    """Where and how the jet starts.

    Parameters
    ----------
    flow_rate, radius : float
        Q in m3/s and the radius there in m, both prescribed.
    charge_density : float
        Charge per volume that enters, C/m3, where charge is frozen into the material.
    axial, radial : float
        A_zz and A_rr of the entering material; A_zz only where `stress` is "given".
    stress : {"free", "given"}
        "free": the tension at the nozzle comes from inside the jet (right while v0 is below the elastic wave speed);
        "given": the material enters with `axial` (faster jets, or with a solvent's viscosity).
    compliance, tension : float
        a and P_C of ``r = radius (P/P_C)^(-a)``: how the jet upstream yields to the pull; 0 holds the radius.
    amplitude, frequency, phase : float
        Circle of the nozzle: m, *angular* frequency in rad/s, rad.
    ramp : float
        Time over which the circle grows smoothly from nothing, s.
    length : float
        Length of the cylinder that the jet starts as, m; 0: two elements.
    """

    flow_rate: float
    radius: float
    charge_density: float = 0.0
    axial: float = 1.0
    radial: float = 1.0
    stress: str = "free"
    compliance: float = 0.0
    tension: float = 0.0
    amplitude: float = 0.0
    frequency: float = 0.0
    phase: float = 0.0
    ramp: float = 0.0
    length: float = 0.0

    def __post_init__(self) -> None:
        positive("flow_rate", self.flow_rate, "m3/s")
        positive("radius", self.radius, "m")
        number("charge_density", self.charge_density, unit="C/m3")
        positive("axial", self.axial)
        positive("radial", self.radial)
        if self.stress not in ("free", "given"):
            raise InputError("stress", "is not a known inlet condition", value=self.stress, allowed="free, given")
        for name in ("compliance", "amplitude", "ramp", "length", "tension"):
            number(name, getattr(self, name), least=0.0)
        number("frequency", self.frequency)
        number("phase", self.phase)
        if self.compliance > 0.0:
            positive("tension", self.tension, "N", remedy="a compliance needs the tension it is measured from")

    @property
    def speed(self) -> float:
        """v0, m/s."""
        return self.flow_rate / (math.pi * self.radius**2)


@dataclass(frozen=True)
class Loads:
    """Fields that act on the jet.

    Parameters
    ----------
    gap : float
        Distance from the nozzle to the collector, m.
    field : float
        Uniform field, V/m (`kind` "uniform").
    kind : {"uniform", "hyperboloid", "table"}
        Applied field: uniform, the closed form of a tip of radius `tip` at `voltage`, or samples on the axis.
    voltage, tip : float
        V and m.
    axis, values : array_like
        Samples of "table": x in m, increasing, and E_x in V/m; continued off the axis without sources.
    gravity : float
        Along the spinning axis, m/s2.
    side, side_field, side_frequency
        "none", "rotating" (Eq. 25) or "square": transverse field, V/m, angular frequency, rad/s.
    magnetic : tuple of float
        Uniform magnetic field, T (Eq. 26; in Gaussian units that equation lacks a 1/c).
    image : bool
        Mirror charges behind an earthed plate at the gap.
    metal : bool
        The charge that the jet induces on its metal needle ("hyperboloid", "table"; with `tip`).
    needle_at : float
        x of the needle's tip, m: 0, or negative where the chain starts downstream of it.
    ramp : float
        Time over which the field grows smoothly from nothing, s.
    """

    gap: float
    field: float = 0.0
    kind: str = "uniform"
    voltage: float = 0.0
    tip: float = 0.0
    axis: tuple[float, ...] = ()
    values: tuple[float, ...] = ()
    gravity: float = 9.80665
    side: str = "none"
    side_field: float = 0.0
    side_frequency: float = 0.0
    magnetic: tuple[float, float, float] = (0.0, 0.0, 0.0)
    image: bool = False
    metal: bool = False
    needle_at: float = 0.0
    ramp: float = 0.0

    def __post_init__(self) -> None:
        positive("gap", self.gap, "m")
        for name in ("field", "voltage", "gravity", "side_field", "side_frequency"):
            number(name, getattr(self, name))
        real("magnetic", self.magnetic, unit="T")
        if len(self.magnetic) != 3:
            raise InputError("magnetic", "needs three components", value=self.magnetic)
        if self.kind not in ("uniform", "hyperboloid", "table"):
            raise InputError("kind", "is not a known field", value=self.kind, allowed="uniform, hyperboloid, table")
        number("needle_at", self.needle_at, most=0.0, unit="m")
        if self.kind == "hyperboloid" or self.metal:
            positive("tip", self.tip, "m")
        if self.kind == "table":
            axis = real("axis", self.axis, unit="m")
            real("values", self.values, unit="V/m")
            if axis.ndim != 1 or axis.size < 2 or axis.size != len(self.values) or not (np.diff(axis) > 0).all():
                raise InputError("axis", "needs two or more increasing positions, one for each value")
        if self.side not in ("none", "rotating", "square"):
            raise InputError(
                "side", "is not a known transverse field", value=self.side, allowed="none, rotating, square"
            )


@dataclass(frozen=True)
class Air:
    """Air around the jet; Eqs. (20)-(24). `velocity` in m/s; `lift` on or off.

    `noise`: D_v m of Eq. (23), kg m2/s3: the velocity of a piece of mass m diffuses with D_v = noise/m, so that the force on
    a piece does not depend on how finely the jet is cut. It acts as impulses `interval` seconds apart, the same for any
    grid, by seed, label and time; `grain` is the volume of material (m3) that feels one impulse as a whole.

    A field of air: `axis` (m, increasing) and `speeds` along the jet (m/s, added to `velocity`), and where they are given
    `widths`, the distances off the axis at which half of it is left (m; 0: it is the same across).
    """

    density: float = 1.205
    viscosity: float = 1.51e-5
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    xi: float = 0.65
    zeta: float = 0.8
    eta: float = 0.2
    lift: bool = True
    noise: float = 0.0
    interval: float = 1e-6
    grain: float = 0.0
    axis: tuple[float, ...] = ()
    speeds: tuple[float, ...] = ()
    widths: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        positive("air density", self.density, "kg/m3")
        positive("air viscosity", self.viscosity, "m2/s")
        real("air velocity", self.velocity, unit="m/s")
        for name in ("xi", "zeta", "eta", "noise", "grain"):
            number(name, getattr(self, name), least=0.0)
        positive("interval", self.interval, "s")
        if self.noise > 0.0:
            positive("grain", self.grain, "m3", remedy="noise needs the volume that moves as one")
        if self.axis or self.speeds or self.widths:
            axis = real("air axis", self.axis, unit="m")
            real("air speeds", self.speeds, unit="m/s")
            real("air widths", self.widths, least=0.0, unit="m")
            if axis.size < 2 or len(self.speeds) != axis.size or not (np.diff(axis) > 0).all():
                raise InputError("air axis", "needs two or more increasing positions, one for each speed")
            if self.widths and len(self.widths) != axis.size:
                raise InputError("air widths", "needs one for each position", value=len(self.widths))


@dataclass(frozen=True)
class Drying:
    """Evaporation along the beads and what it does to the liquid, Eqs. (43a)-(45), with heat where `heat_capacity` > 0.

    `equilibrium` is the vapour's mass concentration at the pure solvent's surface over the liquid's density, at `temperature`;
    it goes as ``exp[latent_slope (1/temperature - 1/T)]``; `far` that in the air. `cross_flow`: weight of the flow across the
    thread in the transfer: 64 by Kase and Matsuo, 0 without, 1 for the total speed.
    """

    fraction: float
    vapour_diffusion: float
    equilibrium: float
    far: float = 0.0
    interaction: float = 0.45
    least_sherwood: float = 0.0
    viscosity_factor: float = 0.0
    viscosity_power: float = 0.1
    time_power: float = 1.0
    heat_capacity: float = 0.0
    latent: float = 0.0
    latent_slope: float = 0.0
    activation: float = 0.0
    air_conductivity: float = 0.026
    prandtl: float = 0.71
    air_temperature: float = 293.15
    temperature: float = 293.15
    cross_flow: float = 1.0

    def __post_init__(self) -> None:
        number("fraction", self.fraction, above=0.0, below=1.0)
        positive("vapour_diffusion", self.vapour_diffusion, "m2/s")
        number("equilibrium", self.equilibrium, least=0.0)
        number("far", self.far, least=0.0)
        for name in ("least_sherwood", "heat_capacity", "latent", "viscosity_factor", "cross_flow"):
            number(name, getattr(self, name), least=0.0)
        positive("air_temperature", self.air_temperature, "K")
        positive("temperature", self.temperature, "K")


@dataclass(frozen=True)
class Collector:
    """What the jet lands on: "plate", "belt" or "drum"; "none" lets it fly on. `speed` of the surface along +y, m/s."""

    kind: str = "plate"
    speed: float = 0.0
    radius: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in ("none", "plate", "belt", "drum"):
            raise InputError(
                "collector", "is not a known collector", value=self.kind, allowed="plate, belt, drum, none"
            )
        number("collector speed", self.speed, unit="m/s")
        if self.kind == "drum":
            positive("collector radius", self.radius, "m")


@dataclass(frozen=True)
class Grid:
    """How finely, and with which model of the charge, the jet is computed.

    Parameters
    ----------
    element_length : float
        Length of an element at the nozzle's radius, m.
    tolerance : float
        Of a step, relative (explicit scheme).
    repulsion : {"hybrid", "exact", "local", "none"}
        Rung 3; all straight pairs (straight jets); the local logarithm; no charge on charge.
    near : int
        Neighbours along the arc that are computed as segments (hybrid).
    pressure : bool
        Maxwell's radial pressure, from the energy.
    log_length : float
        L of the local logarithm, m.
    feed_length, feed_charge : float
        Straight line of charge upstream of the nozzle: m, C/m.
    feed_lines : tuple of (float, float)
        Further ones, all ending at the nozzle, so that nested lines make a charge that varies along the feed; 11 at most.
    cone : float
        Length from the needle, m, over which the charge's own potential goes from the local logarithm (`log_length`), which the
        needle's straight jet has, to that of the whole thread: a line of charge means nothing where the jet is as wide as
        long. 0: the whole thread everywhere.
    settle : float
        Time, s, over which it does so everywhere: a chain that starts as a straight jet of the local logarithm would be pulled
        anew, and its start would run down the jet as a step of its radius. 0: at once.
    bending : {"none", "viscous", "elastic"}
        Bending moment of the thread.
    tree : int
        Number of nodes above which the tree takes the sums.
    cfl : float
        Step of the implicit scheme over l/c.
    fixed_step : float
        Equal steps, s, for orders of convergence; 0: error control.
    longest : float
        Length beyond which an element is split in two, m; 0: never.
    turn : float
        Angle between neighbours, rad, beyond which the longer of them is split, while it is longer than `element_length`: k l
        for the curvature k of a bend; 0: never.
    """

    element_length: float
    tolerance: float = 1e-5
    repulsion: str = "hybrid"
    near: int = 8
    pressure: bool = True
    log_length: float = 0.0
    feed_length: float = 0.0
    feed_charge: float = 0.0
    feed_lines: tuple[tuple[float, float], ...] = ()
    bending: str = "none"
    bend_viscosity: float = 0.0
    tree: int = 1000
    cfl: float = 0.3
    fixed_step: float = 0.0
    longest: float = 0.0
    turn: float = 0.0
    cone: float = 0.0
    settle: float = 0.0

    def __post_init__(self) -> None:
        positive("element_length", self.element_length, "m")
        number("tolerance", self.tolerance, above=0.0, most=0.1)
        if self.repulsion not in ("hybrid", "exact", "local", "none"):
            raise InputError(
                "repulsion", "is not a known model", value=self.repulsion, allowed="hybrid, exact, local, none"
            )
        number("cone", self.cone, least=0.0, unit="m")
        if self.repulsion == "local" or self.cone > 0.0:
            positive("log_length", self.log_length, "m", remedy="the local logarithm needs its length")
        if self.bending not in ("none", "viscous", "elastic"):
            raise InputError("bending", "is not known", value=self.bending, allowed="none, viscous, elastic")
        number("near", self.near, least=0)
        number("cfl", self.cfl, above=0.0, most=1.0)
        number("fixed_step", self.fixed_step, least=0.0)
        number("longest", self.longest, least=0.0, unit="m")
        number("turn", self.turn, least=0.0, most=math.pi, unit="rad")
        number("feed_length", self.feed_length, least=0.0, unit="m")
        number("feed_charge", self.feed_charge, unit="C/m")
        if len(self.feed_lines) >= FEEDS:
            raise InputError("feed_lines", "are too many", value=len(self.feed_lines), allowed=f"up to {FEEDS - 1}")
        for length, charge in self.feed_lines:
            number("feed_lines", length, least=0.0, unit="m")
            number("feed_lines", charge, unit="C/m")


@dataclass(frozen=True)
class SpunSettings:
    """All of a spun jet.

    `conductivity` > 0 lets charge move in the jet (implicit balance); then `current` (A) or, where it is None, `potential` (V,
    relative to the field's) is given at the start. Such a jet needs an end that is known: the plate, where it starts as a whole
    straight jet (`start`), or a cut; a free charged front ran away in every trial. `conductivity` = 0 freezes the charge
    into the material.

    A jet may be cut: at positions `end_axis` (m) its front is pulled by `end_tension` (N; all that acts across the cut:
    polymer, solvent, surface and charge) and loses `end_share` of the current by conduction; elements that pass `outflow`
    (m) leave.
    """

    density: float
    law: JetLaw
    inlet: Inlet
    loads: Loads
    grid: Grid
    surface_tension: float = 0.0
    conductivity: float = 0.0
    current: float | None = None
    potential: float = 0.0
    air: Air | None = None
    drying: Drying | None = None
    collector: Collector = field(default_factory=Collector)
    end_axis: tuple[float, ...] = ()
    end_tension: tuple[float, ...] = ()
    end_share: tuple[float, ...] = ()
    outflow: float = 0.0
    seed: int = 0
    start: StraightStart | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        positive("density", self.density, "kg/m3")
        number("surface_tension", self.surface_tension, least=0.0, unit="N/m")
        number("conductivity", self.conductivity, least=0.0, unit="S/m")
        if self.current is not None:
            number("current", self.current, unit="A")
        if self.conductivity > 0.0 and not self.end_axis and self.start is None:
            raise InputError(
                "conductivity",
                "lets charge move, and a free charged front runs away: the jet's end must be known",
                value=self.conductivity,
                remedy="start as a straight jet that reaches the plate, or give end_axis, end_tension, end_share of a cut",
            )
        first = self.inlet.length or 2.5 * self.grid.element_length
        if self.collector.kind != "none" and self.start is None and not first < self.loads.gap:
            raise InputError(
                "element_length",
                "is too long: the jet starts with two elements, and they reach the collector",
                value=self.grid.element_length,
                allowed=f"< {0.4 * self.loads.gap:.3g} m with this gap",
            )
        sizes = {len(self.end_axis), len(self.end_tension), len(self.end_share)}
        if len(sizes) != 1:
            raise InputError("end_axis", "needs as many positions as tensions and shares")

    @property
    def implicit(self) -> bool:
        """Whether the march is the implicit one: charge that moves, a solvent's viscosity, a bending moment."""
        return self.conductivity > 0.0 or self.law.solvent_viscosity > 0.0 or self.grid.bending != "none"


def tables_of(settings: SpunSettings) -> FloatArray:
    """Samples the kernels look up: rows 1-3 of the end, 4 and 5 of the field on the axis, the needle's rings and the air's
    motion (`_codes` has their first rows); other jets' charges come with `Chain.march`.
    """
    air, loads = settings.air or Air(), settings.loads
    ends, fields, winds = len(settings.end_axis), len(loads.axis), len(air.axis)
    count = COUNT if loads.metal else 0
    total = c.AIR_FIRST + 3 if winds else c.RINGS_FIRST + (2 + count if count else 0)
    tables = np.zeros((total, max(ends, fields, count, winds, 6)))
    tables[0, [0, 1, 2, 5]] = ends, fields, count, winds
    if count:
        depth, wide, inverse = rings(loads.gap - loads.needle_at, loads.tip)
        tables[c.RINGS_FIRST, :count], tables[c.RINGS_FIRST + 1, :count] = loads.needle_at - depth, wide
        tables[c.RINGS_FIRST + 2 : c.RINGS_FIRST + 2 + count, :count] = inverse
    rows: dict[int, ArrayLike] = {1: settings.end_tension, 2: settings.end_share, 3: settings.end_axis}
    rows |= {4: loads.axis, 5: loads.values}
    if winds:
        rows |= {c.AIR_FIRST: air.axis, c.AIR_FIRST + 1: air.speeds, c.AIR_FIRST + 2: air.widths}
    for row, values in rows.items():
        tables[row, : len(np.atleast_1d(values))] = values
    return tables
