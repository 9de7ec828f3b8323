"""The chain of material elements that a jet is computed as, and its march in time.

Per node position and velocity, per element conformation, charge, volume; the label is cumulative volume, counted from the
front. An element enters per ``V_step/Q``, so **flow rate and current are given**, not an outcome of the grid:

``rho v_t = d/dq [(P + alpha pi r + P_charge) t] + rho_q E + rho g + air``, ``P = A (tau_zz - tau_rr)``, ``A = 1/|R_q|``

with node masses ``rho (V_(i-1) + V_i)/2`` at fixed label and forces that are minus gradients of energies. With frozen
charge the march is Dormand-Prince 5(4) with error control; with conduction, a solvent's viscosity or a bending moment it is
ARS(2,2,2), those implicit. The compiled march comes back every second or so, so that a program can be stopped.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun._explicit_kernels import march_explicit
from spinline.jetprofile.spun._implicit_kernels import march_implicit
from spinline.jetprofile.spun._neighbour_kernels import NEIGHBOURS
from spinline.jetprofile.spun.settings import SpunSettings, tables_of

__all__ = ["Chain", "parameters", "start_cylinder"]


def parameters(s: SpunSettings) -> tuple[FloatArray, c.IntArray]:
    """Parameters and switches as the kernels take them."""
    p, k = np.zeros(c.PARAMETERS), np.zeros(c.SWITCHES, dtype=np.int64)
    law, inlet, loads, grid = s.law, s.inlet, s.loads, s.grid
    p[[c.RHO, c.SURFACE, c.MODULUS, c.THETA, c.SOLVENT]] = (
        s.density,
        s.surface_tension,
        law.modulus,
        law.relaxation_time,
        law.solvent_viscosity,
    )
    p[[c.EXTENT, c.MOBILITY, c.YIELD, c.CONSISTENCY, c.INDEX]] = (
        law.extensibility,
        law.mobility,
        law.yield_stress,
        law.consistency,
        law.index,
    )
    p[[c.FLOW, c.RADIUS, c.AZZ_IN, c.ARR_IN]] = inlet.flow_rate, inlet.radius, inlet.axial, inlet.radial
    p[[c.COMPLIANCE, c.TENSION_IN, c.CHARGE_DENSITY]] = inlet.compliance, inlet.tension, inlet.charge_density
    p[[c.AMPLITUDE, c.OMEGA, c.PHASE, c.RAMP]] = inlet.amplitude, inlet.frequency, inlet.phase, inlet.ramp
    p[[c.GRAVITY, c.FIELD, c.VOLTAGE, c.GAP, c.TIP]] = (
        loads.gravity,
        loads.field,
        loads.voltage,
        loads.gap,
        loads.tip,
    )
    p[[c.SIDE_FIELD, c.SIDE_OMEGA, c.LOAD_RAMP]] = loads.side_field, loads.side_frequency, loads.ramp
    p[c.B_X : c.B_X + 3] = loads.magnetic
    p[c.LOG_LENGTH] = grid.log_length
    feed = [(a, b) for a, b in ((grid.feed_length, grid.feed_charge), *grid.feed_lines) if a > 0.0 and b != 0.0]
    p[c.FEED_COUNT] = len(feed)
    p[c.FEED_FIRST : c.FEED_FIRST + 2 * len(feed)] = np.ravel(feed)
    total = law.modulus * law.relaxation_time if math.isfinite(law.relaxation_time) else 0.0
    p[c.BEND_VISCOSITY] = grid.bend_viscosity or total + law.solvent_viscosity
    p[[c.CONDUCTIVITY, c.POTENTIAL_IN]] = s.conductivity, s.potential
    p[c.CURRENT] = 0.0 if s.current is None else s.current
    p[[c.NEEDLE_AT, c.CONE]] = loads.needle_at, grid.cone
    p[[c.SETTLE, c.SETTLED]] = grid.settle, 1.0
    p[[c.COLLECTOR_SPEED, c.DRUM_RADIUS, c.OUTFLOW]] = s.collector.speed, s.collector.radius, s.outflow
    p[c.COUPLING], p[c.LONGEST], p[c.TURN] = c.COULOMB, grid.longest, grid.turn
    _air_and_drying(s, p, k)
    k[c.LAW] = law.code
    k[c.REPULSION] = {"none": c.NO_REPULSION, "local": c.LOCAL, "exact": c.EXACT, "hybrid": c.HYBRID}[grid.repulsion]
    k[c.PRESSURE], k[c.NEAR], k[c.TREE] = int(grid.pressure), grid.near, grid.tree
    k[c.BALANCE] = c.FROZEN
    if s.conductivity > 0.0:
        k[c.BALANCE] = c.GIVEN_POTENTIAL if s.current is None else c.GIVEN_CURRENT
    k[c.INLET] = c.EXTRAPOLATED if inlet.stress == "free" else c.PRESCRIBED
    k[c.FIELD_KIND] = {"uniform": c.UNIFORM, "hyperboloid": c.HYPERBOLOID, "table": c.AXIS_TABLE}[loads.kind]
    k[c.SIDE_KIND] = {"none": c.NO_SIDE, "rotating": c.ROTATING, "square": c.SQUARE}[loads.side]
    k[c.IMAGE] = int(loads.image)
    k[c.BENDING] = {"none": c.NO_BENDING, "viscous": c.VISCOUS, "elastic": c.ELASTIC}[grid.bending]
    k[c.COLLECTOR] = {"none": c.NO_COLLECTOR, "plate": c.PLATE, "belt": c.BELT, "drum": c.DRUM}[s.collector.kind]
    k[c.END] = c.TRACTION if s.end_axis else c.FREE_END
    return p, k


def _air_and_drying(s: SpunSettings, p: FloatArray, k: c.IntArray) -> None:
    air = s.air
    p[c.AIR_VISCOSITY] = 1.51e-5
    if air is not None:
        k[c.AIR], k[c.LIFT] = 1, int(air.lift)
        p[[c.AIR_DENSITY, c.AIR_VISCOSITY, c.DRAG_XI, c.DRAG_ZETA, c.DRAG_ETA]] = (
            air.density,
            air.viscosity,
            air.xi,
            air.zeta,
            air.eta,
        )
        p[c.AIR_X : c.AIR_X + 3] = air.velocity
        p[c.NOISE] = air.noise
    p[c.START_TEMPERATURE] = p[c.AIR_TEMPERATURE] = 293.15
    d = s.drying
    if d is None:
        p[c.FRACTION] = 1.0
        return
    k[c.DRYING] = 1
    p[[c.FRACTION, c.VAPOUR_DIFFUSION, c.VAPOUR_EQ, c.VAPOUR_FAR]] = (
        d.fraction,
        d.vapour_diffusion,
        d.equilibrium,
        d.far,
    )
    p[[c.INTERACTION, c.SHERWOOD_LEAST, c.DRY_B, c.DRY_M, c.DRY_N]] = (
        d.interaction,
        d.least_sherwood,
        d.viscosity_factor,
        d.viscosity_power,
        d.time_power,
    )
    p[[c.HEAT_CAPACITY, c.LATENT, c.LATENT_SLOPE, c.ACTIVATION]] = (
        d.heat_capacity,
        d.latent,
        d.latent_slope,
        d.activation,
    )
    p[c.CROSS] = d.cross_flow
    p[[c.AIR_CONDUCTIVITY, c.PRANDTL, c.AIR_TEMPERATURE, c.START_TEMPERATURE]] = (
        d.air_conductivity,
        d.prandtl,
        d.air_temperature,
        d.temperature,
    )


@dataclass
class Chain:
    """A jet at one moment, and everything needed to march it on.

    Attributes
    ----------
    settings : SpunSettings
    time : float
        s.
    n : int
        Elements in the chain.
    state : ndarray, (capacity, COLUMNS)
        Rows 0 (front) to n (nozzle).
    clock : ndarray
        Element volume, entries so far, time of the first, label of the front, landed rows, steps, refused steps; current in and
        out by conduction, charge that came and went so far, and what a step needs.
    landed : ndarray
        Record of the elements that have landed.
    """

    settings: SpunSettings
    time: float
    n: int
    state: FloatArray
    held: c.IntArray
    marks: FloatArray
    clock: FloatArray
    landed: FloatArray
    step: float
    origin: FloatArray = field(default_factory=lambda: np.zeros(4))

    def march(
        self,
        end: float,
        progress: Callable[[float], None] | None = None,
        others: tuple[float, FloatArray] | None = None,
    ) -> None:
        """March to the time `end` in s.

        `progress` is called now and then with the time so far; `others` are charges beside it: a moment, and rows of their
        place, velocity and charge then.
        """
        p, k = parameters(self.settings)
        tables = tables_of(self.settings)
        if others is not None and others[1].size:
            count = others[1].shape[1]
            wide = np.zeros((max(NEIGHBOURS + 7, tables.shape[0]), max(tables.shape[1], count)))
            wide[: tables.shape[0], : tables.shape[1]] = tables
            wide[NEIGHBOURS : NEIGHBOURS + 7, :count] = others[1]
            wide[0, 3], wide[0, 4] = count, others[0]
            tables = wide
        grid = self.settings.grid
        while self.time < end:
            status, self.time, self.n, self.step = self._kernel(end, p, k, tables, grid)
            if progress is not None:
                progress(self.time)
            if status == c.FULL:
                self._grow()
            elif status in (c.BROKEN, c.STALLED):
                raise InputError(
                    "jet",
                    f"cannot be followed beyond {self.time:.6g} s: an element collapses or its chains overstretch",
                    remedy="refine the elements, look at the charge (a frozen charge may be impossible), or at the law",
                )

    def _kernel(
        self, end: float, p: FloatArray, k: c.IntArray, tables: FloatArray, grid: object
    ) -> tuple[int, float, int, float]:
        g = self.settings.grid
        most = max(4, 4_000_000 // (self.n * self.n))
        # two explicit stages let undamped waves grow by (w h)^4/8 a step: a solvent's viscosity is what damps short ones
        cfl = g.cfl if self.settings.law.solvent_viscosity > 0.0 else min(g.cfl, 0.1)
        if self.settings.implicit:
            return march_implicit(
                self.time,
                end,
                self.n,
                self.step,
                g.fixed_step,
                cfl,
                most,
                self.clock,
                self.state,
                self.held,
                self.marks,
                self.landed,
                p,
                k,
                tables,
            )
        return march_explicit(
            self.time,
            end,
            self.n,
            self.step,
            g.fixed_step,
            g.tolerance,
            self.reach,
            most,
            self.clock,
            self.state,
            self.held,
            self.marks,
            self.landed,
            p,
            k,
            tables,
        )

    def _grow(self) -> None:
        """Twice the room."""
        rows = 2 * self.state.shape[0]
        for name in ("state", "marks", "held"):
            old = getattr(self, name)
            wider = np.zeros((rows, *old.shape[1:]), dtype=old.dtype)
            wider[: old.shape[0]] = old
            setattr(self, name, wider)
        if int(self.clock[4]) + self.n + 2 >= self.landed.shape[0]:
            more = np.zeros((2 * self.landed.shape[0] + rows, self.landed.shape[1]))
            more[: self.landed.shape[0]] = self.landed
            self.landed = more

    @property
    def reach(self) -> float:
        """Length that errors of position are measured by, m: a sixteenth of the gap."""
        return self.settings.loads.gap / 16.0

    @property
    def nodes(self) -> FloatArray:
        """The state from the front to the nozzle, (n + 1, COLUMNS)."""
        return self.state[: self.n + 1]

    @property
    def deposited(self) -> FloatArray:
        """Landed elements in the order of landing."""
        return self.landed[: int(self.clock[4])]


def start_cylinder(settings: SpunSettings, capacity: int = 512) -> Chain:
    """A cylinder of the inlet's radius and speed in front of the nozzle, at rest in itself.

    Its length is a whole number of half elements, so that all grids that divide it start alike.
    """
    inlet, step = settings.inlet, settings.grid.element_length
    area = math.pi * inlet.radius**2
    length = inlet.length or 2.5 * step
    count = max(round(length / step - 0.5), 1)
    pieces = np.full(count + 1, step)
    pieces[-1] = length - count * step
    if pieces[-1] < 0.5 * step * (1 - 1e-9):
        pieces[-1] += step
        pieces = np.delete(pieces, 0)
    n = pieces.size
    rows = max(capacity, 2 * n + 8)
    state = np.zeros((rows, c.COLUMNS))
    state[: n + 1, c.X] = np.concatenate((np.cumsum(pieces[::-1])[::-1], [0.0]))
    state[: n + 1, c.VX] = inlet.speed
    state[:n, c.AZZ], state[:n, c.ARR] = inlet.axial if inlet.stress == "given" else 1.0, inlet.radial
    state[:n, c.VOLUME] = state[:n, c.LABEL] = area * pieces
    state[:n, c.CHARGE] = inlet.charge_density * area * pieces
    state[:, c.TEMP] = settings.drying.temperature if settings.drying else 293.15
    clock = np.zeros(c.CLOCK)
    clock[0] = area * step
    clock[2] = (1.5 * step - pieces[-1]) / inlet.speed
    return Chain(
        settings,
        0.0,
        n,
        state,
        np.zeros(rows, dtype=np.int64),
        np.zeros((rows, 9)),
        clock,
        np.zeros((rows, c.DEPOSITS)),
        0.01 * step / inlet.speed,
    )
