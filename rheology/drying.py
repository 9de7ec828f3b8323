"""Radial drying of a stretching, shrinking jet: who dries first, surface or centre, and when it turns to glass.

In the polymer coordinate ``y = 2 Lambda int phi_p r dr``, in [0, phi_0 r_0^2], with ``u = phi_s/phi_p`` and
``X = Lambda r^2 = int (1 + u) dy`` (volumes additive, no axial diffusion)::

    u_t = d/dy (4 Lambda D phi_p^2 X u_y)          surface: 4 D phi_p^2 X u_y = -D_a Sh dC

In ``dsigma = Lambda dt`` the stretch drops out of the equation and stays in Sh alone; along a steady jet ``dsigma = dx/v_0``.

Finite volumes: polymer does not leave its cell, solvent leaves one cell for the next or for the air, and the loss is
integrated with them, so that both masses are conserved to rounding. Cells shrink towards the surface as the square of their
number; the outermost one (1.2e-4 of the polymer, of 100 cells) is taken as the surface. Face diffusivities are Simpson means
over phi. In time Radau, order 5, implicit.

Two numbers: ``drying_peclet = D_a Sh C_sat/(2 D)``, evaporation against diffusion (below 0.1: flat profiles, use
`evaporate`; above 10: a skin), and the Fourier number ``pi D z/Q``.

Cost and error: second order in 1/cells; 60 cells give 1e-4 to 1e-3 of the fraction in a fraction of a second.

References
----------
Crank, The Mathematics of Diffusion (1975), sections 5.3 and 10; review Eqs. (43a), (44).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp
from scipy.sparse import csc_matrix

from spinline.checks import FloatArray, positive, real
from spinline.errors import InputError
from spinline.rheology import vapour
from spinline.rheology._evaporation_balance import Balance
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
        Cross-section mean of phi_p, volume left over volume at the start, and volume lost by integrating the surface flux.
    vitrified_at : tuple of float
        Positions (m) where the surface and the centre reach the vitrification fraction; NaN where they do not.
    vitrified_after : tuple of float
        The times (s) of the same.
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

    def skin_thickness(self, volume_fraction: float) -> FloatArray:
        """Depth in m, from the surface, down to which phi_p is at least a value; 0 where the surface is below it."""
        level = float(real("volume_fraction", volume_fraction, above=0.0, most=1.0))
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


def drying_peclet(
    vapour_diffusivity: ArrayLike, sherwood: ArrayLike, saturation: ArrayLike, diffusivity: ArrayLike
) -> FloatArray:
    """``D_a Sh C_sat/(2 D)``: evaporation against diffusion in the jet (m2/s, -, -, m2/s), dimensionless."""
    air = real("vapour_diffusivity", vapour_diffusivity, above=0.0, unit="m2/s")
    number, c = real("sherwood", sherwood, least=0.0), real("saturation", saturation, least=0.0)
    value: FloatArray = air * number * c / (2 * real("diffusivity", diffusivity, above=0.0, unit="m2/s"))
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
        phi_0, in (0, 1), the same at every radius.
    volatile : Volatile
        The solvent; its activity is Flory-Huggins'.
    diffusion : DiffusionLaw
        D against phi, in (0, inf) on [0, 1].
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
    phi0 = float(real("volume_fraction", volume_fraction, above=0.0, below=1.0))
    if isinstance(cells, bool) or not isinstance(cells, int | np.integer) or not 8 <= cells <= 1000:
        raise InputError("cells", "is out of range", value=cells, allowed="integers, 8 to 1000")
    accuracy = float(real("rtol", rtol, least=1e-12, most=1e-2))
    glass = np.nan
    if vitrification_fraction is not None:
        glass = float(real("vitrification_fraction", vitrification_fraction, above=phi0, below=1.0))
    balance = Balance(path, phi0, [volatile], np.array([1 - phi0]), "flory-huggins", None)
    balance.set_air(
        positive("air_viscosity", air_viscosity, "m2/s"), float(real("air_velocity", air_velocity, unit="m/s"))
    )
    balance.floor = float(real("sherwood_floor", sherwood_floor, least=0.0))
    sample = np.asarray(diffusion(np.linspace(0.0, 1.0, 11)), dtype=np.float64)
    real("diffusion", sample, above=0.0, unit="m2/s", remedy="D must be positive from phi = 0 to 1")
    edges = np.sin(0.5 * np.pi * np.linspace(0, 1, cells + 1))
    share = np.diff(edges)
    system = _Cells(balance, volatile, diffusion, share, phi0)
    first = (1 - phi0) / phi0
    state = np.concatenate((np.full(cells, first), [0.0, 0.0]))
    pace = float(path.exposure(np.asarray([path.start]))[0])
    # the time is for information: it follows from the path, and must not set the step
    atol = np.concatenate((np.full(cells + 1, 1e-3 * accuracy * first), [1e-6 * pace * path.position[-1]]))
    after = path.position > path.start
    values = np.tile(state[:, np.newaxis], path.position.size)
    where, when = [np.nan, np.nan], [np.nan, np.nan]
    if after.any():
        events = [_reaches(cells - 1, glass), _reaches(0, glass)] if np.isfinite(glass) else None
        with np.errstate(divide="ignore"):  # Radau divides by an error of exactly 0 where nothing happens
            found = solve_ivp(
                system.slope, (path.start, path.position[-1]), state, method="Radau", t_eval=path.position[after],
                rtol=accuracy, atol=atol, jac=system.jacobian, events=events,
            )  # fmt: skip
        if not found.success:
            raise InputError("jet", f"cannot be dried: {found.message}", remedy="more cells, or a smoother D(phi)")
        values[:, after] = found.y
        if found.t_events is not None and found.y_events is not None:
            for i, (places, states) in enumerate(zip(found.t_events, found.y_events, strict=True)):
                if places.size:
                    where[i], when[i] = float(places[0]), float(states[0][-1])
    u = values[:cells]
    volume = np.concatenate(
        (np.zeros((1, u.shape[1])), np.cumsum(share[:, np.newaxis] * (1 + u), axis=0))
    )  # X over phi0 r0^2
    left = phi0 * volume[-1]
    stretch = path.stretch(path.position) * (left if balance.kept else 1.0)
    return RadialDrying(
        path.position, values[-1], (1 / (1 + u)).T, path.initial_radius * np.sqrt(phi0 * volume / stretch).T, share,
        1 / volume[-1], left, phi0 * values[cells], (where[0], where[1]), (when[0], when[1]),
    )  # fmt: skip


def cylinder_series(radius_ratio: ArrayLike, fourier: ArrayLike, biot: float, terms: int = 200) -> FloatArray:
    """Closed form: what is left in a cylinder of constant radius and D, surface flux proportional to what is left there.

    Parameters
    ----------
    radius_ratio, fourier : array_like
        r/R in [0, 1]; D t/R^2 > 0.
    biot : float
        Bi > 0; ``drying_peclet`` times d(activity)/du.
    terms : int
        Roots taken; with 200, exact to 1e-13 beyond D t/R^2 = 1e-4.

    Returns
    -------
    ndarray
        u/u_0 = sum 2 Bi J_0(q r/R) exp(-q^2 Fo)/[(q^2 + Bi^2) J_0(q)], q J_1(q) = Bi J_0(q) (Crank, Eq. 5.46).
    """
    from scipy.optimize import brentq
    from scipy.special import j0, j1, jn_zeros

    number = positive("biot", biot)
    x = real("radius_ratio", radius_ratio, least=0.0, most=1.0)
    fo = real("fourier", fourier, above=0.0)
    lows = np.concatenate(([0.0], jn_zeros(1, terms - 1)))
    roots = np.array(
        [
            brentq(lambda q: q * j1(q) - number * j0(q), low, high, xtol=1e-14, rtol=1e-15)
            for low, high in zip(lows, jn_zeros(0, terms), strict=True)
        ]
    )
    # at a root J_0(q) = q J_1(q)/Bi, which does not vanish as Bi grows
    weight = 2 * number**2 / ((roots**2 + number**2) * roots * j1(roots))
    value: FloatArray = np.sum(
        weight * j0(x[..., np.newaxis] * roots) * np.exp(-(roots**2) * fo[..., np.newaxis]), axis=-1
    )
    return value


class _Cells:
    """Right-hand side: u in the cells, what has left (over the polymer), and the time; columns are states."""

    def __init__(
        self, balance: Balance, volatile: Volatile, diffusion: DiffusionLaw, share: FloatArray, phi0: float
    ) -> None:
        self.balance, self.volatile, self.diffusion, self.phi0 = balance, volatile, diffusion, phi0
        self.share, self.width = share, share[:, np.newaxis]
        self.gaps = 0.5 * (self.width[1:] + self.width[:-1])
        self.amount = phi0 * balance.path.initial_radius**2
        self.size, self.chi = np.array([volatile.molar_volume]), np.array([volatile.chi])

    def flux(self, x: float, u: FloatArray, volume: FloatArray | None = None) -> FloatArray:
        """Flux outwards through the upper edge of every cell, times -1; (cells, columns). X of u, if not given."""
        volatile, diffusion = self.volatile, self.diffusion
        phi = 1 / (1 + u)
        if volume is None:
            volume = np.cumsum(self.width * (1 + u), axis=0)
        middle = 0.5 * (phi[1:] + phi[:-1])
        mean = (diffusion(phi[1:]) + 4 * diffusion(middle) + diffusion(phi[:-1])) / 6
        inward = 4 * mean * volume[:-1] * phi[1:] * phi[:-1] * (u[1:] - u[:-1]) / self.gaps  # D phi^2 u_y = -D phi_y
        solvent = (u[-1] * phi[-1])[np.newaxis]
        activity = (vapour.flory_huggins_coefficient(solvent, self.size, self.chi) * solvent)[0]
        reynolds = self.balance.reynolds(np.asarray([x]), self.phi0 * volume[-1])
        number = np.cbrt(reynolds) * 0.495 * np.sqrt(self.balance.schmidt[0])
        pull = volatile.saturation * (activity - volatile.ambient)
        loss = volatile.diffusivity * np.maximum(number, self.balance.floor) * pull
        return np.concatenate((inward, -loss[np.newaxis]))

    def change(self, x: float, flux: FloatArray) -> FloatArray:
        """Rates of u and of what has left; linear in the flux, and their sum over the polymer is 0."""
        rate = float(self.balance.path.exposure(np.asarray([x]))[0]) / self.amount
        inner = np.diff(flux, axis=0, prepend=np.zeros((1, flux.shape[1]))) / self.width
        return rate * np.concatenate((inner, -flux[-1:]))

    def slope(self, x: float, state: FloatArray) -> FloatArray:
        """Rates of u, of what has left and of the time; NaN, which shortens the step, for a trial far below dryness."""
        if float(state[:-2].min()) < -0.3:
            return np.full_like(state, np.nan)
        u, at = state[:-2, np.newaxis], np.asarray([x])
        path = self.balance.path
        left = self.phi0 * float(self.share @ (1 + state[:-2]))
        stretch = path.stretch(at) * (left if self.balance.kept else 1.0)
        return np.concatenate((self.change(x, self.flux(x, u))[:, 0], path.exposure(at) / stretch))

    def jacobian(self, x: float, state: FloatArray) -> Any:
        """Sparse: differences of the fluxes at the X there is, so that the columns conserve both masses to rounding.

        A flux depends on the fractions on its two sides, and weakly, left out here, on all volume within. The time stays out.
        """
        u, count = state[:-2], self.share.size
        step = 1.5e-8 * np.maximum(np.abs(u), 1e-6 * float(np.abs(u).max()))
        even = np.arange(count) % 2 == 0
        moved = np.stack((u, np.where(even, u + step, u), np.where(even, u, u + step)), axis=1)
        step = np.where(even, moved[:, 1], moved[:, 2]) - u
        flux = self.flux(x, moved, np.cumsum(self.width * (1 + u[:, np.newaxis]), axis=0))
        change = flux[:, 1:] - flux[:, :1]
        inner = np.where(even, change[:, 0], change[:, 1]) / step  # by the cell's own u
        outer = np.where(even, change[:, 1], change[:, 0])[:-1] / step[1:]  # by its outer neighbour's
        rate = float(self.balance.path.exposure(np.asarray([x]))[0]) / self.amount
        own = inner.copy()
        own[1:] -= outer
        i = np.arange(count)
        rows = np.concatenate((i, i[:-1], i[1:], [count]))
        columns = np.concatenate((i, i[1:], i[:-1], [count - 1]))
        width = self.share
        values = rate * np.concatenate((own / width, outer / width[:-1], -inner[:-1] / width[1:], [-inner[-1]]))
        return csc_matrix((values, (rows, columns)), shape=(count + 2, count + 2))


def _reaches(cell: int, fraction: float) -> Callable[[float, FloatArray], float]:
    return lambda _, state: 1 / (1 + float(state[cell])) - fraction
