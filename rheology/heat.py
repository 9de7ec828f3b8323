"""A drying jet that cools and takes up water: one balance of heat and of every liquid, uniform across the jet.

Per initial volume of solution, with ``dsigma = Lambda dt``, u_i the volume of liquid i, F = phi_0 + sum u_i what is
left::

    r_0^2 rho_i du_i/dsigma = -m_i
    r_0^2 [phi_0 rho_p c_p + sum u_i rho_i c_i] dT/dsigma = Nu k_a (T_a - T) A - sum m_i L_i(T)
    m_i = D_i Sh_i M_i/(R T_f) [a_i p_i(T) - p_i,inf] S                        kg/m/s over pi, either sign
    S = P ln[(P - sum p_inf)/(P - sum p)]/(sum p - sum p_inf)                   Stefan flow, on the total molar flux
    A = b/(e^b - 1),  b = sum m_i c_pv,i/(Nu k_a)                               Ackermann, on the heat

Air at the film temperature ``T_f = (T + T_a)/2``; activities of Flory and Huggins (or Raoult); transfer numbers of
`transfer`. Water is one of the liquids wherever there is any in the air: it dissolves, and below its dew point it
condenses. Vapours of formic and acetic acid are monomers and dimers at equilibrium: they carry up to 1.8 times the
mass. Liquid densities are held at their values at the nozzle; heats of mixing, radiation and ice are left out.

Uniform temperature: the internal Biot number ``Nu k_a/(2 k_liquid)`` is 0.01 to 0.05 on jets in still air, whatever
their radius; in a strong blow (Nu of 5) it passes 0.3, and the surface is then colder than the mean.

Numbers: Radau's method, order 5 (`_heat_kernels`), on logarithms of the volumes, errors a decade under `rtol`;
the state after a step is what a ledger of the mass and the enthalpy that pass the surface leaves: both are conserved to
rounding, whatever `rtol`. With Kase and Matsuo's or Yarin's transfer
and no floor the jet's profile drops out by ``J = int Re^(1/3) dsigma``. A few milliseconds.

References
----------
Bird, Stewart, Lightfoot, Transport Phenomena, 2nd ed. (2007), sections 19.4, 22.8; Ackermann, VDI-Forschungsheft 382
(1937); Flory, Principles of Polymer Chemistry (1953).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.base.kernels import plain
from spinline.rheology import thermal
from spinline.rheology._drying_kernels import NODES
from spinline.rheology._heat_kernels import activities, advance, rates, stride
from spinline.rheology.element_path import ElementPath
from spinline.rheology.evaporant import GRID, REFERENCE, Evaporant
from spinline.rheology.transfer import Transfer, law_index, transfer_number, transfer_range

__all__ = ["POLYMER_HEAT_CAPACITY", "HeatedJet", "dry_with_heat"]

POLYMER_HEAT_CAPACITY = 1450.0  # J/kg/K, of most amorphous polymers within a fifth
_SHORTEST = 1e-30  # step over the way
_AIR_MASS = 0.0289644
_UNBOOKED = 1e-12  # of the liquid at the start, that a step may lose from the ledger


@dataclass(frozen=True, eq=False)
class HeatedJet:
    """A drying jet at `position` (m); arrays (n,) unless said.

    Attributes
    ----------
    position, remaining, lost, polymer_fraction, radius, velocity : ndarray
        As of `evaporation.Evaporation`; `lost` is negative where the jet takes up more than it gives.
    solvent_volume : ndarray, (liquid, n)
        Volume of each liquid over the total volume at the start.
    temperature : ndarray
        K, uniform across the jet.
    reynolds, sherwood, nusselt : ndarray, (n,), (liquid, n), (n,)
        Of the air at the film temperature.
    mass_given_off, enthalpy_taken_up : ndarray
        Through the surface since the start: kg and J per m3 of solution at the start; enthalpy counted from the
        liquids and the polymer at the air's temperature.
    activity : ndarray, (liquid, n)
    notes : tuple of str
        What the correlations have to say.
    """

    position: FloatArray
    remaining: FloatArray
    lost: FloatArray
    solvent_volume: FloatArray
    polymer_fraction: FloatArray
    radius: FloatArray
    velocity: FloatArray
    temperature: FloatArray
    reynolds: FloatArray
    sherwood: FloatArray
    nusselt: FloatArray
    mass_given_off: FloatArray
    enthalpy_taken_up: FloatArray
    activity: FloatArray
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Inputs:
    """What the compiled loops take: see `_heat_kernels.surface`."""

    sub: FloatArray
    tables: FloatArray
    pairs: FloatArray
    air: FloatArray


def dry_with_heat(
    path: ElementPath,
    volume_fraction: float,
    evaporants: Sequence[Evaporant],
    shares: ArrayLike = 1.0,
    *,
    temperature: float,
    air_temperature: float | None = None,
    pressure: float = 101325.0,
    polymer_density: float = 1200.0,
    polymer_heat_capacity: float = POLYMER_HEAT_CAPACITY,
    transfer: Transfer = "kase-matsuo",
    sherwood_floor: float = 0.0,
    air_velocity: float = 0.0,
    polymer_molar_volume: float | None = None,
    pair_interactions: ArrayLike | None = None,
    stefan: bool = True,
    rtol: float = 1e-7,
) -> HeatedJet:
    """Composition, temperature and radius of a drying jet.

    Parameters
    ----------
    path : ElementPath
        From `straight_path` or `bead_path`.
    volume_fraction : float
        phi_0 of the polymer at the start, in (0, 1).
    evaporants : sequence of Evaporant
        Liquids; the air's water, where it is not one of the solvents, has the share 0.
    shares : array_like, (liquid,)
        Volume shares of the liquids at the start, sum 1.
    temperature, air_temperature : float
        Of the jet at the start and of the air, K, in [120, 480]; by default the same.
    pressure : float
        Of the air, Pa.
    polymer_density, polymer_heat_capacity : float
        kg/m3, J/kg/K.
    transfer : {"kase-matsuo", "churchill-bernstein", "yarin"}
    sherwood_floor : float
        Least Sherwood and Nusselt number.
    air_velocity : float
        Of the air along the jet, m/s.
    polymer_molar_volume : float, optional
        m3/mol of a repeat unit: Raoult's law in place of Flory and Huggins'.
    pair_interactions : array_like, (liquid, liquid), optional
        Flory-Huggins interaction of the liquids with one another, by volume (chi_ij/v_i, mol/m3), symmetric; 0 by
        default.
    stefan : bool
        Whether vapour drifts and heats up on its way out (S and A); False leaves both 1.
    rtol : float
        Of the integration, in [1e-12, 1e-3].

    Returns
    -------
    HeatedJet

    Raises
    ------
    InputError
        For values out of range; where the jet would boil (``sum p >= P``), or leaves 120 to 480 K.
    """
    phi0 = number("volume_fraction", volume_fraction, above=0.0, below=1.0)
    accuracy = number("rtol", rtol, least=1e-12, most=1e-3)
    given = gather(
        path,
        phi0,
        evaporants,
        shares,
        air_temperature if air_temperature is not None else temperature,
        pressure,
        positive("polymer_density", polymer_density, "kg/m3")
        * positive("polymer_heat_capacity", polymer_heat_capacity, "J/kg/K"),
        transfer,
        sherwood_floor,
        air_velocity,
        polymer_molar_volume,
        pair_interactions,
        stefan,
    )
    kelvin = number("temperature", temperature, least=GRID[0], most=GRID[-1], unit="K")
    y = np.append(np.zeros(len(evaporants)), kelvin)
    values, ledger = _solve(path, given, y, accuracy)
    return _result(path, evaporants, given, values, ledger, transfer)


def gather(
    path: ElementPath,
    phi0: float,
    evaporants: Sequence[Evaporant],
    shares: ArrayLike,
    air_temperature: float,
    pressure: float,
    polymer_heat: float,
    transfer: str,
    floor: float,
    wind: float,
    molar_volume: float | None,
    pairs: ArrayLike | None,
    stefan: bool,
) -> Inputs:
    """Check what a jet dries into, and lay it out for the compiled loops."""
    if not isinstance(evaporants, Sequence) or not all(isinstance(e, Evaporant) for e in evaporants):
        raise InputError("evaporants", "is not a sequence of Evaporant", value=evaporants)
    if not evaporants:
        raise InputError("evaporants", "is empty", remedy="give at least one solvent")
    share = np.atleast_1d(real("shares", shares, least=0.0, most=1.0))
    if share.shape != (len(evaporants),) or abs(float(share.sum()) - 1) > 1e-9:
        raise InputError("shares", "must be one per liquid and sum to 1", value=share.tolist(), remedy="scale them")
    start = (1 - phi0) * share / share.sum()
    p = number("pressure", pressure, least=1.0, most=1e9, unit="Pa")
    warm = number("air_temperature", air_temperature, least=GRID[0], most=GRID[-1], unit="K")
    far = sum(e.ambient_pressure for e in evaporants)
    if far >= p:
        raise InputError("ambient_pressure", "is all the air there is", value=far, allowed=f"[0, {p:g}) Pa")
    inside = start > 0
    origin = np.log(np.where(inside, start, 1.0))
    sub = np.array(
        [
            (
                e.density,
                e.molar_mass,
                e.heat_capacity,
                e.vapour_heat_capacity,
                e.diffusivity,
                e.chi,
                e.ambient_pressure,
                float(i),
                o,
                e.molar_mass / e.density,
            )
            for e, i, o in zip(evaporants, inside, origin, strict=True)
        ]
    )
    n = len(evaporants)
    mutual = np.zeros((n, n)) if pairs is None else real("pair_interactions", pairs, unit="mol/m3")
    if mutual.shape != (n, n) or not np.allclose(mutual, mutual.T):
        raise InputError("pair_interactions", "must be symmetric, one row per liquid", value=f"shape {mutual.shape}")
    unit = 0.0 if molar_volume is None else positive("polymer_molar_volume", molar_volume, "m3/mol")
    air = np.array(
        [
            p,
            warm,
            number("sherwood_floor", floor, least=0.0, most=1e12),
            phi0,
            path.initial_radius,
            number("air_velocity", wind, least=-1e20, most=1e20, unit="m/s"),
            float(path.given == "radius"),
            float(law_index(transfer)),
            number("polymer heat capacity by volume", polymer_heat, above=0.0, most=1e30),
            unit,
            float(stefan),
        ]
    )
    return Inputs(sub, np.ascontiguousarray(np.stack([e.laws for e in evaporants])), np.ascontiguousarray(mutual), air)


def _solve(path: ElementPath, given: Inputs, y: FloatArray, rtol: float) -> tuple[FloatArray, FloatArray]:
    """States (n, liquid + 1) and ledger (n, 2) at the path's positions."""
    air, r0 = given.air, path.initial_radius
    separable = air[2] == 0 and air[7] != 1 and not (air[6] > 0 and air[5] != 0)
    if separable:
        wind = 0.0 if air[6] > 0 else float(air[5])
        cross = 64.0 if air[7] == 0 else 0.0

        def speed(x: FloatArray) -> FloatArray:
            own = path.against(x, bool(air[7] == 2))
            past = np.sqrt((own - wind) ** 2 + cross * path.across(x) ** 2)
            value: FloatArray = path.exposure(x) * np.cbrt(2 * r0 / np.sqrt(path.stretch(x)) * past)
            return value

        marks = path.integral(speed)
        constant = np.tile([1.0, 0.5 / r0, 0.0, 1 / r0**2], (4, 1))
        still = air.copy()
        still[5] = 0.0
        inner = Inputs(given.sub, given.tables, given.pairs, still)
        return _march(0.0, marks, (), y, inner, None, constant, rtol)
    breaks = tuple(float(b) for b in np.unique(path.breaks) if path.start < b < path.position[-1])
    return _march(path.start, path.position, breaks, y, given, path, np.empty((4, 4)), rtol)


def _places(path: ElementPath, x: FloatArray, yarin: bool) -> FloatArray:
    pace = path.exposure(x) / path.initial_radius**2
    return np.column_stack((path.stretch(x), path.against(x, yarin), path.across(x), pace))


def _march(
    start: float,
    marks: FloatArray,
    breaks: tuple[float, ...],
    y: FloatArray,
    given: Inputs,
    path: ElementPath | None,
    places: FloatArray,
    rtol: float,
) -> tuple[FloatArray, FloatArray]:
    """Steps with error control from `start` to the last mark; `places` stay as they are without a path."""
    n = y.size
    values, ledgers = np.tile(y, (marks.size, 1)), np.zeros((marks.size, n))
    end = float(marks[-1])
    if not end > start:
        return values, ledgers
    y, ledger, stages = y.copy(), np.zeros(n), np.zeros((3, n))
    count = np.array([0, np.searchsorted(marks, start, side="right")])
    x, h, yarin = start, 0.0, bool(given.air[7] == 2)
    unbooked, shortest = _UNBOOKED * (1 - float(given.air[3])), _SHORTEST * (end - start)
    for stop in (*breaks, end):
        h, old = _first(x, stop, y, given, path, places) if h == 0 else min(h, stop - x), 0.0
        while x < stop:
            if path is not None:
                step, _ = stride(x, h, stop)
                places = _places(path, x + np.array([0.0, *NODES[:2], 1 - 1e-12]) * step, yarin)
            x, h, old = advance(
                x, h, stop, path is not None, shortest, rtol, unbooked, count, old, stages, y, ledger,
                given.sub, given.tables, given.pairs, given.air, places, marks, values, ledgers,
            )  # fmt: skip
            if h == 0:
                raise _cannot(y, given, x, path)
    return values, ledgers


def _first(x: float, stop: float, y: FloatArray, given: Inputs, path: ElementPath | None, places: FloatArray) -> float:
    """A step over which nothing changes by more than a thousandth of its scale."""
    if path is not None:
        places = _places(path, np.array([x + 1e-9 * (stop - x)] * 4), given.air[7] == 2)
    slope, ledger = np.empty(y.size), np.empty(y.size)
    if not plain(rates)(y, given.sub, given.tables, given.pairs, given.air, places[0], slope, ledger):
        raise _cannot(y, given, x, path)
    pace = float(np.max(np.abs(slope) / np.append(np.ones(y.size - 1), 100.0)))
    return min(stop - x, 1e-3 / pace) if pace > 0 else stop - x


def _cannot(y: FloatArray, given: Inputs, x: float, path: ElementPath | None) -> InputError:
    where = f" beyond {x:.4g} m" if path is not None else ""
    kelvin = float(y[-1])
    inside = given.sub[:, 7] > 0
    volumes = np.where(inside, np.exp(np.where(inside, given.sub[:, 8] + y[:-1], 0.0)), y[:-1])
    activity, at, rest = np.empty(volumes.size), min(int((kelvin - GRID[0]) / 3), GRID.size - 2), (kelvin - GRID[0]) % 3
    plain(activities)(volumes, float(given.air[3]), given.sub, given.pairs, float(given.air[9]), activity)
    pure = np.array([np.exp(np.polyval(t[0, :, at], rest)) for t in given.tables])
    # a poor solvent's activity passes 1: the solution boils below its liquids
    boils = max(float(pure.max()), float(pure @ activity))
    if boils >= given.air[0] and not y[:-1].any():  # still as it set out
        what = "a solvent" if float(pure.max()) >= given.air[0] else "the solution: its chi is that of a poor solvent"
        return InputError("temperature", f"is above the boiling point of {what}", value=kelvin, remedy="lower it")
    if boils >= given.air[0]:
        return InputError(
            "jet",
            f"is warmed past the boiling point of a solvent{where}",
            value=kelvin,
            remedy="lower the temperature of the air, or its humidity",
        )
    return InputError(
        "jet",
        f"cannot be dried{where}: its temperature or composition changes too fast, or leaves 120 to 480 K",
        value=kelvin,
        remedy="check the temperatures, and the properties of the solvents",
    )


def _result(
    path: ElementPath,
    evaporants: Sequence[Evaporant],
    given: Inputs,
    values: FloatArray,
    ledger: FloatArray,
    transfer: Transfer,
) -> HeatedJet:
    sub, air, phi0 = given.sub, given.air, float(given.air[3])
    y, kelvin = values[:, :-1].T, values[:, -1]
    inside, origin = sub[:, 7:8] > 0, sub[:, 8:9]
    start = np.where(inside, np.exp(origin), 0.0)
    u = np.where(inside, np.exp(np.where(inside, origin + y, 0.0)), y)
    left = phi0 + u.sum(axis=0)
    lost = np.where(inside, start * -np.expm1(np.where(inside, y, 0.0)), -y).sum(axis=0)
    stretch, speed, across = path.stretch(path.position), path.speed(path.position), path.across(path.position)
    kept = air[6] > 0
    radius = path.initial_radius * np.sqrt((1.0 if kept else left) / stretch)
    velocity = speed * (left if kept else 1.0)
    film = 0.5 * (kelvin + air[1])
    density = air[0] * _AIR_MASS / (8.31446261815324 * film)
    nu = thermal.air_viscosity(film) / density
    own = velocity if transfer == "yarin" and path.slip is None else path.axial(path.position) * (left if kept else 1.0)
    along, side = 2 * radius * np.abs(own - air[5]) / nu, 2 * radius * across / nu
    schmidt = nu / (sub[:, 4:5] * (film / REFERENCE) ** 1.75)
    prandtl = thermal.air_viscosity(film) * thermal.AIR_HEAT_CAPACITY / thermal.air_conductivity(film)
    numbers = [transfer_number(along, sc, side, transfer, air[2]) for sc in (*schmidt, prandtl)]
    total = np.hypot(along, side) if transfer == "churchill-bernstein" else along
    note = transfer_range(transfer, total, float(schmidt[0].min()))
    return HeatedJet(
        position=path.position,
        remaining=left,
        lost=lost,
        solvent_volume=u,
        polymer_fraction=phi0 / left,
        radius=radius,
        velocity=velocity,
        temperature=kelvin,
        reynolds=total,
        sherwood=np.array(numbers[:-1]),
        nusselt=numbers[-1],
        mass_given_off=ledger[:, :-1].sum(axis=1),
        enthalpy_taken_up=ledger[:, -1],
        activity=_activity(given, u),
        notes=(note,) if note else (),
    )


def _activity(given: Inputs, u: FloatArray) -> FloatArray:
    out = np.empty_like(u)
    plain(activities)(u, float(given.air[3]), given.sub, given.pairs, float(given.air[9]), out)  # at all places at once
    return out
