"""Radial drying of a jet that cools: the diffusion equation of `drying`, with the surface flux of the balance of heat.

One solvent, one temperature of the cross-section: heat crosses a jet some hundred times faster than solvent. The
surface gives off ``m = D Sh M/(R T_f) [a(u_surface) p(T) - p_inf] S`` and the whole of it cools by ``m L(T)``; D
within the jet is that of the law given, at every temperature.

Cost and error: those of `dry_radially`, one more row. Volume and enthalpy are conserved to rounding, whatever `rtol`:
the temperature after a step is what the enthalpy that passed the surface leaves.
"""

import numpy as np

from spinline.base.checks import FloatArray, number, positive
from spinline.base.errors import InputError
from spinline.rheology._drying_march import march, tabulated
from spinline.rheology.diffusion_laws import DiffusionLaw
from spinline.rheology.drying import RadialDrying, check_cells, check_diffusion
from spinline.rheology.element_path import ElementPath
from spinline.rheology.evaporant import GRID, Evaporant
from spinline.rheology.heat import POLYMER_HEAT_CAPACITY, gather
from spinline.rheology.transfer import Transfer

__all__ = ["dry_radially_with_heat"]


def dry_radially_with_heat(
    path: ElementPath,
    volume_fraction: float,
    evaporant: Evaporant,
    diffusion: DiffusionLaw,
    *,
    temperature: float,
    air_temperature: float | None = None,
    pressure: float = 101325.0,
    polymer_density: float = 1200.0,
    polymer_heat_capacity: float = POLYMER_HEAT_CAPACITY,
    transfer: Transfer = "kase-matsuo",
    sherwood_floor: float = 0.0,
    air_velocity: float = 0.0,
    stefan: bool = True,
    vitrification_fraction: float | None = None,
    cells: int = 60,
    rtol: float = 1e-7,
) -> RadialDrying:
    """Fraction against radius, and temperature, along a drying jet of one solvent.

    Parameters
    ----------
    path, volume_fraction, diffusion, vitrification_fraction, cells, rtol
        As for `drying.dry_radially`.
    evaporant : Evaporant
        The solvent.
    temperature, air_temperature, pressure, polymer_density, polymer_heat_capacity : float
        As for `heat.dry_with_heat`.
    transfer, sherwood_floor, air_velocity, stefan
        As for `heat.dry_with_heat`.

    Returns
    -------
    RadialDrying
        With its `temperature`.

    Raises
    ------
    InputError
        For values out of range, or where the equations cannot be followed.
    """
    phi0 = number("volume_fraction", volume_fraction, least=1e-12, below=1.0)
    count = check_cells(cells)
    accuracy = number("rtol", rtol, least=1e-12, most=1e-2)
    kelvin = number("temperature", temperature, least=GRID[0], most=GRID[-1], unit="K")
    glass = np.nan
    if vitrification_fraction is not None:
        glass = number("vitrification_fraction", vitrification_fraction, above=phi0, below=1.0)
    given = gather(
        path,
        phi0,
        [evaporant],
        1.0,
        kelvin if air_temperature is None else air_temperature,
        pressure,
        positive("polymer_density", polymer_density, "kg/m3")
        * positive("polymer_heat_capacity", polymer_heat_capacity, "J/kg/K"),
        transfer,
        sherwood_floor,
        air_velocity,
        None,
        None,
        stefan,
    )
    if evaporant.pressure(kelvin) >= pressure:
        raise InputError(
            "temperature", f"is above the boiling point of {evaporant.name}", value=kelvin, remedy="lower it"
        )
    check_diffusion(diffusion)
    share = np.diff(np.sin(0.5 * np.pi * np.linspace(0, 1, count + 1)))
    first = (1 - phi0) / phi0
    kept = path.given == "radius"
    state = np.concatenate((np.full(count, first), [kelvin, 0.0]))
    # what the fluxes between cells need of the air: nothing; what the march does: phi_0, r_0, whether the radius is kept
    still = np.array([0.0, 1.0, 0.0, evaporant.chi, 0.0, 0.0, phi0, path.initial_radius, 0.0, 1.0, float(kept)])
    amount = phi0 * path.initial_radius**2

    whole = transfer == "yarin"

    def along(x: FloatArray) -> FloatArray:
        return np.column_stack((path.stretch(x), path.against(x, whole), path.exposure(x) / amount, path.across(x)))

    dry = 1 / glass - 1 if np.isfinite(glass) else -np.inf
    marched = march(
        path.start,
        path.position,
        path.breaks,
        state,
        share,
        tabulated(diffusion),
        still,
        along,
        accuracy,
        np.append(np.full(count + 1, 1e-3 * accuracy * first), 1e-3 * accuracy * first),
        ((count - 1, dry), (0, dry)),
        (given.sub, given.tables, given.air),
    )
    values = marched.values.T
    u = values[:count]
    volume = np.concatenate((np.zeros((1, u.shape[1])), np.cumsum(share[:, np.newaxis] * (1 + u), axis=0)))
    left = phi0 * volume[-1]
    stretch = path.stretch(path.position) * (left if kept else 1.0)
    return RadialDrying(
        path.position,
        marched.time,
        (1 / (1 + u)).T,
        path.initial_radius * np.sqrt(phi0 * volume / stretch).T,
        share,
        1 / volume[-1],
        left,
        phi0 * values[count + 1],
        (marched.events[0][0], marched.events[1][0]),
        (marched.events[0][1], marched.events[1][1]),
        values[count],
        phi0 * values[count + 1] * evaporant.density,
        marched.enthalpy,
    )
