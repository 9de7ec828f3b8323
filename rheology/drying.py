"""Radial drying of a stretching, shrinking jet: who dries first, surface or centre, and when it turns to glass.

In the polymer coordinate ``y = 2 Lambda int phi_p r dr``, in [0, phi_0 r_0^2], with ``u = phi_s/phi_p`` and
``X = Lambda r^2 = int (1 + u) dy`` (volumes additive, no axial diffusion)::

    u_t = d/dy (4 Lambda D phi_p^2 X u_y)          surface: 4 D phi_p^2 X u_y = -D_a Sh dC

In ``dsigma = Lambda dt`` the stretch drops out of the equation and stays in Sh alone; along a steady jet ``dsigma =
dx/v_0``.

Finite volumes: polymer does not leave its cell, solvent leaves one cell for the next or for the air, and the loss is
integrated with them, so that both masses are conserved to rounding. Cells shrink towards the surface as the square of
their number; the outermost one (1.2e-4 of the polymer, of 100 cells) is taken as the surface. Face diffusivities are
Simpson means over phi. Along the jet Radau's method, order 5, in compiled loops (`_drying_kernels`).

Two numbers: ``drying_peclet = D_a Sh C_sat/(2 D)``, evaporation against diffusion (below 0.1: flat profiles, use
`evaporate`; above 10: a skin), and the Fourier number ``pi D z/Q``.

Cost and error: second order in 1/cells; 60 cells give 1e-4 to 1e-3 of the fraction in a fraction of a second.

References
----------
Crank, The Mathematics of Diffusion (1975), sections 5.3 and 10; review Eqs. (43a), (44).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, real
from spinline.base.errors import InputError
from spinline.rheology._drying_march import march, tabulated
from spinline.rheology._evaporation_balance import Balance
from spinline.rheology._finite import finite_result
from spinline.rheology.cylinder import cylinder_series
from spinline.rheology.diffusion_laws import DiffusionLaw
from spinline.rheology.element_path import ElementPath
from spinline.rheology.volatile import Volatile

__all__ = ["RadialDrying", "cylinder_series", "dry_radially", "drying_peclet"]


@dataclass(frozen=True, eq=False)
class RadialDrying:
    """phi(r, z) of a drying jet: n positions, m cells from the axis outwards.

    Attributes
    ----------
    position, time : ndarray, (n,)
        m along the jet, s since the start.
    polymer_fraction : ndarray, (n, m)
        phi_p in the cells.
    edges : ndarray, (n, m + 1)
        Radii between the cells, m; the last is the jet's.
    polymer_share : ndarray, (m,)
        Share of the polymer in each cell.
    mean_fraction, remaining, lost : ndarray, (n,)
        Cross-section mean of phi_p, volume left over volume at the start, and volume lost by integrating the surface
        flux.
    vitrified_at : tuple of float
        Positions (m) where the surface and the centre reach the vitrification fraction; NaN where they do not.
    vitrified_after : tuple of float
        The times (s) of the same.
    temperature : ndarray, (n,), or None
        K, uniform across the jet; None where it is held.
    mass_given_off, enthalpy_taken_up : ndarray, (n,), or None
        As of `heat.HeatedJet`, where there is heat.
    """

    position: FloatArray
    time: FloatArray
    polymer_fraction: FloatArray
    edges: FloatArray
    polymer_share: FloatArray
    mean_fraction: FloatArray
    remaining: FloatArray
    lost: FloatArray
    vitrified_at: tuple[float, float]
    vitrified_after: tuple[float, float]
    temperature: FloatArray | None = None
    mass_given_off: FloatArray | None = None
    enthalpy_taken_up: FloatArray | None = None

    @property
    def axis_fraction(self) -> FloatArray:
        """phi_p on the axis, (n,): a parabola in r through the means of the two innermost cells, second order in their
        width.
        """
        area = self.edges[:, :3] ** 2
        inner, outer = 0.5 * (area[:, 0] + area[:, 1]), 0.5 * (area[:, 1] + area[:, 2])
        rise = (self.polymer_fraction[:, 1] - self.polymer_fraction[:, 0]) / (outer - inner)
        value: FloatArray = np.clip(self.polymer_fraction[:, 0] - rise * inner, 0.0, 1.0)  # rounding only
        return value

    def skin_thickness(self, volume_fraction: float) -> FloatArray:
        """Depth in m, from the surface, down to which phi_p is at least a value; 0 where the surface is below it."""
        level = number("volume_fraction", volume_fraction, above=0.0, most=1.0)
        middles = 0.5 * (self.edges[:, 1:] + self.edges[:, :-1])
        depth = np.zeros(self.position.size)
        for i, (phi, r) in enumerate(zip(self.polymer_fraction, middles, strict=True)):
            below = np.flatnonzero(phi < level)
            if not below.size:
                depth[i] = self.edges[i, -1]
            elif below[-1] < phi.size - 1:
                j = int(below[-1])
                inner = r[j] + (r[j + 1] - r[j]) * (level - phi[j]) / (phi[j + 1] - phi[j])
                depth[i] = self.edges[i, -1] - inner
        return depth


@finite_result("drying Peclet number")
def drying_peclet(
    vapour_diffusivity: ArrayLike, sherwood: ArrayLike, saturation: ArrayLike, diffusivity: ArrayLike
) -> FloatArray:
    """``D_a Sh C_sat/(2 D)``: evaporation against diffusion in the jet (m2/s, -, -, m2/s), dimensionless."""
    air = real("vapour_diffusivity", vapour_diffusivity, above=0.0, unit="m2/s")
    sh, c = real("sherwood", sherwood, least=0.0), real("saturation", saturation, least=0.0)
    value: FloatArray = (air / real("diffusivity", diffusivity, above=0.0, unit="m2/s")) * (0.5 * sh * c)
    return value


def dry_radially(
    path: ElementPath,
    volume_fraction: float,
    volatile: Volatile,
    diffusion: DiffusionLaw,
    *,
    air_viscosity: float,
    air_velocity: float = 0.0,
    sherwood_floor: float = 0.0,
    vitrification_fraction: float | None = None,
    cells: int = 60,
    rtol: float = 1e-7,
) -> RadialDrying:
    """Fraction against radius along a drying jet of one solvent.

    Parameters
    ----------
    path : ElementPath
        From `straight_path` or `bead_path`.
    volume_fraction : float
        phi_0, in [1e-12, 1), the same at every radius.
    volatile : Volatile
        The solvent; its activity is Flory-Huggins'.
    diffusion : DiffusionLaw
        D against phi, in (0, 1000] m2/s on [0, 1].
    air_viscosity, air_velocity, sherwood_floor
        As for `evaporate`.
    vitrification_fraction : float, optional
        phi_p of the glass at the jet's temperature, in (phi_0, 1).
    cells : int
        8 to 1000.
    rtol : float
        Of the integration along the jet, in [1e-12, 1e-2].

    Returns
    -------
    RadialDrying

    Raises
    ------
    InputError
        For values out of range, or where the equations cannot be followed.
    """
    phi0 = number("volume_fraction", volume_fraction, least=1e-12, below=1.0)
    cells = check_cells(cells)
    accuracy = number("rtol", rtol, least=1e-12, most=1e-2)
    glass = np.nan
    if vitrification_fraction is not None:
        glass = number("vitrification_fraction", vitrification_fraction, above=phi0, below=1.0)
    balance = Balance(path, phi0, [volatile], np.array([1 - phi0]), "flory-huggins", None)
    balance.set_air(air_viscosity, air_velocity, sherwood_floor)
    check_diffusion(diffusion)
    edges = np.sin(0.5 * np.pi * np.linspace(0, 1, cells + 1))
    share = np.diff(edges)
    first = (1 - phi0) / phi0
    state = np.concatenate((np.full(cells, first), [0.0]))
    amount = phi0 * path.initial_radius**2
    air = np.array(
        [
            volatile.diffusivity,
            volatile.saturation,
            volatile.ambient,
            volatile.chi,
            0.495 * np.sqrt(balance.schmidt[0]),
            balance.floor,
            phi0,
            path.initial_radius,
            balance.wind,
            balance.nu,
            float(balance.kept),
        ]
    )

    def along(x: FloatArray) -> FloatArray:
        # a cross-flow counts as so much more speed along the jet, as Kase and Matsuo have it
        own, wind = path.axial(x), balance.wind
        speed = own if path.cross_flow is None else wind + np.hypot(own - wind, 8 * path.across(x))
        return np.column_stack((path.stretch(x), speed, path.exposure(x) / amount))

    dry = 1 / glass - 1 if np.isfinite(glass) else -np.inf
    marched = march(
        path.start,
        path.position,
        path.breaks,
        state,
        share,
        tabulated(diffusion),
        air,
        along,
        accuracy,
        np.full(cells + 1, 1e-3 * accuracy * first),
        ((cells - 1, dry), (0, dry)),
    )
    values = marched.values.T
    u = values[:cells]
    volume = np.concatenate(
        (np.zeros((1, u.shape[1])), np.cumsum(share[:, np.newaxis] * (1 + u), axis=0))
    )  # X over phi0 r0^2
    left = phi0 * volume[-1]
    stretch = path.stretch(path.position) * (left if balance.kept else 1.0)
    return RadialDrying(
        path.position,
        marched.time,
        (1 / (1 + u)).T,
        path.initial_radius * np.sqrt(phi0 * volume / stretch).T,
        share,
        1 / volume[-1],
        left,
        phi0 * values[cells],
        (marched.events[0][0], marched.events[1][0]),
        (marched.events[0][1], marched.events[1][1]),
    )


def check_cells(cells: int) -> int:
    """Refuse a number of cells that is none."""
    if isinstance(cells, bool) or not isinstance(cells, int | np.integer) or not 8 <= cells <= 1000:
        raise InputError("cells", "is out of range", value=cells, allowed="integers, 8 to 1000")
    return int(cells)


def check_diffusion(diffusion: DiffusionLaw) -> None:
    """Refuse a law that is not positive on [0, 1]."""
    sample = np.asarray(diffusion(np.linspace(0.0, 1.0, 11)), dtype=np.float64)
    real("diffusion", sample, above=0.0, most=1e3, unit="m2/s", remedy="D must be positive from phi = 0 to 1")
