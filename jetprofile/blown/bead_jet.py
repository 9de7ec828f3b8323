"""A blown jet that bends: beads from where bending is well posed to the collector.

Elements keep their volume exactly (polymer and solvent), their conformation A_zz, A_rr; beads their place and velocity. Per
element: tension ``f [G h (A_zz - A_rr) + 3 mu_s rate] + pi a sigma`` (h = 1, or FENE-P's where strands have an end), drag
along and across (`drag`), weight; vapour leaves with the jet's velocity, so drying changes masses and no velocity. The element
at the start grows by Q dt and mixes in the inflow.

Any bead that meets the collector sticks to its moving surface, where and when it does: the belly of a loop often lands before
what lies ahead of it. An element with one end down is slack below the length it had when that end met the collector, and drawn
like any other above; the longer of that and its last chord is its flight length, and longer ones are halved as in flight, so
that the drawing by the collector does not depend on the mesh. Landings are written in the fibre's order.

A free end, before it lands, is drawn back by capillarity into a drop that no chain of cylinders describes: the end element
takes in the next when it is shorter than a quarter of the mesh; volume and momentum are kept.

Time: SSP Runge-Kutta of third order, ``dt = CFL min l/(c + |rate| l)`` with the drag's rate in it. (Heun's method pumps
undamped waves at each step: at CFL 0.4 it gave fibres 22 % too thin.) Elements longer than `longest` are halved.

Start it at z* of the straight part (`straight`, `bending_onset`): upstream of it no mesh converges. The share of elements with
c_b^2 < 0 is reported of every run. With `lift` the air's lift on bends is in (linear in curvature: wrong for loops).

Left out: loops below the mesh, bending stiffness, air slowed by the jet, twist, jets that touch.

References
----------
Yarin, Sinha-Ray, Pourdeyhimi, J. Appl. Phys. 108, 034913 (2010); review Eqs. (43), (46), (47); Shu, Osher, J. Comput. Phys. 77,
439 (1988) (the scheme).
"""

import warnings
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray, number, positive
from spinline.base.errors import InputError, SpinlineWarning
from spinline.jetprofile.blown.air import Air, AirJet
from spinline.jetprofile.blown.drag import DRAG_LAWS, TangentialLaw
from spinline.jetprofile.blown.gusts import gust_field
from spinline.jetprofile.blown.straight import BlownSolution

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["BeadRun", "BeadStart", "BeadState", "BlownBeads", "blown_beads"]

_ROOM = 8192  # beads
_ROWS = 4096  # landings between two looks
_AIR_ROWS = 2001
_WORK = 1e9  # elements looked at, three times a step: some five minutes


@dataclass(frozen=True)
class BeadStart:
    """Where the beads begin.

    Attributes
    ----------
    z : float
        Along the axis, m.
    radius : float
        m; the velocity follows from Q.
    axial_conformation, radial_conformation : float
        A_zz, A_rr of the inflow; radial default ``A_zz^(-1/2)``.
    """

    z: float
    radius: float
    axial_conformation: float = 1.0
    radial_conformation: float | None = None


@dataclass(frozen=True)
class BlownBeads:
    """What a run of beads is asked for.

    Attributes
    ----------
    element : float
        Length of an element at the start, m; 30 to 100 radii.
    longest : float, optional
        Elements longer than this are halved, m. Default: 4 `element`.
    duration : float
        s.
    cfl : float
        In (0, 1].
    drag : str
    lift, gusts : bool
    modes, seed, index : int
        Of the gusts.
    amplitude, frequency : float
        Circle of the start, m and 1/s (in place of gusts, or beside them).
    gravity : float
        Along the axis, m/s2.
    polymer_fraction : float
        By volume, of what leaves the nozzle.
    drying : float
        ``pi D_a 0.495 Sc^(1/2) dC`` in m2/s of Eq. (44); 0: none.
    hardening : tuple
        B and m of Eq. (45a) as the jet dries; theta goes with the concentration.
    """

    element: float
    duration: float
    longest: float | None = None
    cfl: float = 0.3
    drag: TangentialLaw = "ziabicki-kawai"
    lift: bool = False
    gusts: bool = True
    modes: int = 32
    seed: int = 0
    index: int = 0
    amplitude: float = 0.0
    frequency: float = 0.0
    gravity: float = 9.81
    polymer_fraction: float = 1.0
    drying: float = 0.0
    hardening: tuple[float, float] = (0.0, 1.0)

    def __post_init__(self) -> None:
        positive("mesh", self.element, "m")
        positive("duration", self.duration, "s")
        number("cfl", self.cfl, above=0.0, most=1.0)
        number("amplitude", self.amplitude, least=0.0, unit="m")
        number("frequency", self.frequency, least=0.0, unit="1/s")
        number("gravity", self.gravity, unit="m/s2")
        number("polymer_fraction", self.polymer_fraction, above=0.0, most=1.0)
        number("drying", self.drying, least=0.0, unit="m2/s")
        if self.longest is not None and not positive("longest", self.longest, "m") >= 2 * self.element:
            raise InputError(
                "longest",
                "is below two elements: halves would be halved again",
                value=self.longest,
                allowed=f"[{2 * self.element:g}, inf) m",
            )
        if self.drag not in DRAG_LAWS:
            raise InputError("drag", "is not known", value=self.drag, allowed=", ".join(DRAG_LAWS))


@dataclass(frozen=True, eq=False)
class BeadState:
    """One moment: beads (n, 6) of place and velocity from the far end on, elements (n - 1, 4) of volume, A_zz, A_rr and
    volume of polymer, and which beads lie on the collector.
    """

    time: float
    beads: FloatArray
    elements: FloatArray
    landed: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class BeadRun:
    """A run: the jet at its end, and what has landed.

    Attributes
    ----------
    time : float
        s.
    position, velocity : ndarray, (bead, 3)
        m, m/s; from the far end to the start.
    volume, polymer_volume, axial_conformation, radial_conformation : ndarray, (bead - 1,)
        Of the elements, m3 and 1.
    landings : ndarray, (landing, 10)
        time, x, y, z, vx, vy, vz, volume, flight length, polymer volume: the last three of the element between the landing
        before and this one. Time does not run back: what touched before its predecessor is carried on till that one touches.
    landed : ndarray of bool, (bead,)
        What lies on the collector at the end of the run, and is not among the landings yet or the last of them.
    fed, polymer_fed : float
        m3.
    evaporated : float
        m3.
    below_zero : float
        Share of the elements, over all steps, with c_b^2 < 0.
    states : list of BeadState
        Stored moments.
    """

    time: float
    position: FloatArray
    velocity: FloatArray
    volume: FloatArray
    polymer_volume: FloatArray
    axial_conformation: FloatArray
    radial_conformation: FloatArray
    landings: FloatArray
    landed: NDArray[np.bool_]
    fed: float
    polymer_fed: float
    evaporated: float
    below_zero: float
    states: "list[BeadState]" = field(default_factory=list)
    attributes: dict[str, Any] = field(default_factory=dict)

    @property
    def frames(self) -> list[tuple[float, FloatArray]]:
        """(time, position) of the stored moments."""
        return [(one.time, one.beads[:, :3]) for one in self.states]

    @property
    def radius(self) -> FloatArray:
        """Of the elements with both ends in flight, m."""
        free = ~(self.landed[1:] | self.landed[:-1])
        length = np.linalg.norm(np.diff(self.position, axis=0), axis=1)[free]
        return np.asarray(np.sqrt(self.volume[free] / (np.pi * length)))

    @property
    def landed_radius(self) -> FloatArray:
        """Flight radius of what has landed, m."""
        rows = self.landings[self.landings[:, 7] > 0]
        return np.asarray(np.sqrt(rows[:, 7] / (np.pi * rows[:, 8])))

    def imbalance(self) -> float:
        """Polymer fed less in flight less landed, over what was fed: 0 to rounding."""
        laid = float(np.nansum(self.landings[:, 9]))
        return (self.polymer_fed - float(self.polymer_volume.sum()) - laid) / self.polymer_fed

    def envelope(self, z: float, since: float = 0.0) -> float:
        """Diameter within which 95 % of the beads near z lay, over the stored frames, m; NaN without any."""
        out = []
        for time, place in self.frames:
            near = np.abs(place[:, 0] - z) < 0.1 * z
            if time >= since and near.any():
                out.append(np.hypot(place[near, 1], place[near, 2]))
        return 2 * float(np.quantile(np.concatenate(out), 0.95)) if out else float("nan")

    def to_dataset(self) -> "xr.Dataset":
        """Deposit record along `landing`, as `spinline.deposit.LandingRecord` reads it."""
        import xarray as xr

        rows = self.landings
        names = (
            ("touch_time", 0, "s"),
            ("x", 1, "m"),
            ("y", 2, "m"),
            ("z", 3, "m"),
            ("vx", 4, "m/s"),
            ("vy", 5, "m/s"),
            ("vz", 6, "m/s"),
            ("volume", 7, "m3"),
            ("flight_length", 8, "m"),
        )
        data: dict[str, Any] = {name: ("landing", rows[:, k], {"units": unit}) for name, k, unit in names}
        with np.errstate(invalid="ignore", divide="ignore"):
            data["polymer_fraction"] = (
                "landing",
                np.where(rows[:, 7] > 0, rows[:, 9] / rows[:, 7], np.nan),
                {"units": "1"},
            )
        data["jet"] = ("landing", np.full(len(rows), self.attributes.get("jet", 0)))
        data["fibre"] = ("landing", np.full(len(rows), self.attributes.get("jet", 0)))
        balance = {
            "volume_fed": self.fed,
            "volume_in_flight": float(self.volume.sum()),
            "volume_evaporated": self.evaporated,
        }
        return xr.Dataset(data, attrs={**balance, **self.attributes, "below_zero_wave_speed": self.below_zero})


def blown_beads(
    solution: BlownSolution, air: Air, start: BeadStart, collector: Any, run: BlownBeads, *, frames: int = 0
) -> BeadRun:
    """Run a blown jet of beads until `run.duration`.

    Parameters
    ----------
    solution : BlownSolution
        Its solvent viscosity is the Newtonian part; without relaxation time all of its viscosity is.
    air : Air
    start : BeadStart
    collector : Plate, Belt or Drum of `spinline.deposit`, or any object of their `kind`, `distance` and speeds
    run : BlownBeads
    frames : int
        Moments to store.

    Returns
    -------
    BeadRun

    Raises
    ------
    InputError
        For a start beyond the collector, or more beads than there is room for (8192).
    """
    surface = _surface(collector)
    z0, a0 = number("start", start.z, least=0.0, unit="m"), positive("start radius", start.radius, "m")
    if not z0 < surface[1]:
        raise InputError("start", "is not before the collector", value=z0, allowed=f"[0, {surface[1]:g}) m")
    speed = solution.flow_rate / (np.pi * a0**2)
    grown = np.pi * a0**2 * run.element  # volume of an element
    elastic = solution.relaxation_time > 0
    azz = positive("axial_conformation", start.axial_conformation)
    arr = azz**-0.5 if start.radial_conformation is None else positive("radial_conformation", start.radial_conformation)
    table, far_gaussian = _air_table(air, z0, surface)
    p = np.array(
        [
            solution.density,
            solution.modulus if elastic else 0.0,
            solution.relaxation_time if elastic else 0.0,
            solution.solvent_viscosity if elastic else solution.viscosity,
            solution.surface_tension,
            air.density,
            air.kinematic_viscosity,
            *DRAG_LAWS[run.drag],
            run.gravity,
            float(run.lift),
            solution.flow_rate,
            run.drying,
            run.polymer_fraction,
            1 / solution.extensibility if elastic and solution.extensibility else 0.0,
            far_gaussian,
            *run.hardening,
            0.0,
        ]
    )
    gusts = gust_field(air, table[:, 0], modes=run.modes, seed=run.seed, index=run.index)
    if not run.gusts:
        table[:, 4] = 0.0
    table = np.ascontiguousarray(np.column_stack([table, gusts.carried, gusts.length, gusts.weights]))
    modes = np.ascontiguousarray(gusts.modes)
    longest = 4 * run.element if run.longest is None else run.longest
    place = np.array(
        [z0, 0, 0, speed, 0, 0, grown, longest, run.cfl, run.amplitude, 2 * np.pi * run.frequency, run.element]
    )
    q, e, flight, touch = np.zeros((_ROOM, 6)), np.ones((_ROOM, 4)), np.full(_ROOM, np.nan), np.full((_ROOM, 7), np.nan)
    n = 3
    q[:n, 0] = z0 + run.element * np.array([1.5, 0.5, 0.0])
    q[:n, 3] = speed
    e[: n - 1, 0] = grown * np.array([1.0, 0.5])
    e[: n - 1, 1], e[: n - 1, 2] = azz, arr
    e[: n - 1, 3] = e[: n - 1, 0] * run.polymer_fraction
    began = float(e[: n - 1, 0].sum())
    t, n, landings, stored, counts = _drive(
        run, n, q, e, flight, touch, p, table, modes, place, np.array([azz, arr]), surface, frames
    )
    below = float(counts[1] / counts[0])
    fed = began + solution.flow_rate * t
    laid = float(landings[:, 7].sum())
    inside = float(e[: n - 1, 0].sum())
    if below > 0.2:
        warnings.warn(
            f"{below:.0%} of the elements have c_b^2 < 0, where bending grows with the mesh: begin farther down, or "
            "take this run's bending as not converged",
            SpinlineWarning,
            stacklevel=2,
        )
    return BeadRun(
        t,
        q[:n, :3].copy(),
        q[:n, 3:].copy(),
        e[: n - 1, 0].copy(),
        e[: n - 1, 3].copy(),
        e[: n - 1, 1].copy(),
        e[: n - 1, 2].copy(),
        landings,
        np.isfinite(touch[:n, 0]),
        fed,
        fed * run.polymer_fraction,
        fed - laid - inside if run.drying else 0.0,
        below,
        stored,
        {"seed": run.seed, "jet": run.index, "collector_kind": str(collector.kind)},
    )


def _drive(
    run: BlownBeads,
    n: int,
    q: FloatArray,
    e: FloatArray,
    flight: FloatArray,
    touch: FloatArray,
    p: FloatArray,
    table: FloatArray,
    modes: FloatArray,
    place: FloatArray,
    inlet: FloatArray,
    surface: FloatArray,
    frames: int,
) -> tuple[float, int, FloatArray, list[BeadState], FloatArray]:
    """The loop over stored moments and full tables of landings."""
    from spinline.jetprofile.blown._bead_kernels import advance

    counts, rows, parts = np.array([0.0, 0.0, _WORK]), np.empty((_ROWS, 10)), []
    stored: list[BeadState] = []
    t, landed = 0.0, 0
    for moment in np.linspace(0, run.duration, max(frames, 1) + 1)[1:]:
        while t < moment:
            n, t, landed, filled, full = advance(
                n,
                t,
                float(moment),
                q,
                e,
                flight,
                touch,
                landed,
                p,
                table,
                modes,
                place,
                inlet,
                surface,
                rows,
                0,
                counts,
            )
            parts.append(rows[:filled].copy())
            if full == 2:
                raise InputError(
                    "mesh",
                    f"asks for steps so short that only {t:.4g} s are done within the work allowed",
                    value=run.element,
                    remedy="take longer elements, less solvent viscosity or longer strands, or begin farther down",
                )
            if full or n < 2:
                raise InputError(
                    "mesh",
                    f"asks for more than {_ROOM} beads at {t:.4g} s",
                    value=run.element,
                    remedy="take longer elements, a nearer collector or a shorter time",
                )
            if float(np.linalg.norm(q[n - 1, :3] - q[n - 2, :3])) > 2 * place[7]:
                raise InputError(
                    "mesh",
                    f"is too coarse for the stretching at the start, at {t:.4g} s",
                    value=run.element,
                    remedy="take shorter elements, or begin farther down",
                )
            if not np.isfinite(q[:n]).all():
                raise InputError(
                    "cfl", f"lets the run diverge at {t:.4g} s", value=run.cfl, remedy="take a smaller one"
                )
        if frames:
            stored.append(BeadState(t, q[:n].copy(), e[: n - 1].copy(), np.isfinite(touch[:n, 0])))
    return t, n, np.concatenate(parts) if parts else np.empty((0, 10)), stored, counts


def _surface(collector: Any) -> FloatArray:
    if collector.kind == "drum":
        return np.array([1.0, collector.distance, collector.surface_speed, collector.radius, collector.offset])
    return np.array([0.0, collector.distance, collector.surface_speed, 0.0, 0.0])


def _air_table(air: Air, z0: float, surface: FloatArray) -> tuple[FloatArray, float]:
    """Rows of x, centre speed, core radius, half width, fluctuation; and 1 for Schlichting's profile."""
    end = surface[1] + 2 * surface[3] if surface[0] == 1 else surface[1]
    x = np.linspace(max(z0 * 0.5, 1e-6), end * 1.05, _AIR_ROWS)
    core, half = np.zeros_like(x), np.full_like(x, np.inf)
    kind = 0.0
    if isinstance(air, AirJet):
        core, half = air.core_radius(x), np.maximum(air.spread * x, 1e-12)
        kind = float(air.profile == "schlichting")
    elif getattr(air, "half_width", None) is not None:
        half = np.maximum(float(air.half_width) * x, 1e-12)  # type: ignore[attr-defined]
    return np.ascontiguousarray(np.column_stack([x, air.velocity(x), core, half, air.fluctuation(x)])), kind
