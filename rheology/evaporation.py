"""Loss of solvent along the jet, Eqs. (43a)-(44).

Steady, an element with the part F of its volume left (``f = pi r^2``, ``F = f v / Q``)::

    d(f v)/dz = -pi D_a Sh [C_eq - C_inf]      Sh = 0.495 Re^(1/3) Sc^(1/2)
    Re = 2 r |v - v_air| / nu_air              Sc = nu_air / D_a

For both sides to agree C is the vapour's *mass concentration over the liquid's density* (1.73e-5 for water at 293 K);
that is the default. The 2001 paper and simulators that follow it put in the mole ratio p_v/p (0.023), 1300 times as
much: it is there as ``convention="yarin2001"``. Above a solution C_eq is the saturated value times the activity, so
that drying slows down and ends where the activity meets the humidity. Solvents of a mixture leave one by one, volumes
additive; jet, vapour and air share one temperature (evaporative cooling is left out).

Range: the correlation is that of threads in melt spinning, 0.5 < Re < 50. On electrospinning jets Re is near 0.3 at
the nozzle and the correlation, which vanishes with Re, is then on the low side: outside the range a warning is given
and kept in the result. `sherwood_floor` sets a least Sh.

Cost: one quadrature along the jet and one autonomous stiff equation (LSODA on log volumes), a few milliseconds;
relative error 1e-10 of what is lost. With a floor, or a measured radius in moving air, the equation is not autonomous
and takes ten times as long; relative error 1e-8.

References
----------
Yarin, Koombhongse, Reneker, J. Appl. Phys. 89, 3018 (2001); Ziabicki, Fundamentals of Fibre Formation (1976); Kase,
Matsuo, J. Polym. Sci. A 3, 2541 (1965); review Eqs. (43a), (44).
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, real
from spinline.base.errors import InputError, SpinlineWarning
from spinline.rheology._evaporation_balance import Activity, Balance
from spinline.rheology.element_path import ElementPath, Given
from spinline.rheology.transfer import RE_RANGE, Transfer, transfer_range
from spinline.rheology.volatile import Volatile

__all__ = ["RE_RANGE", "Activity", "Evaporation", "evaporate", "power_law_loss", "sherwood"]


@dataclass(frozen=True, eq=False)
class Evaporation:
    """A drying jet, at `position` (m); arrays (n,) unless said.

    Attributes
    ----------
    position : ndarray
        m along the jet.
    remaining : ndarray
        F, volume left over volume at the start.
    lost : ndarray
        1 - F, without cancellation.
    solvent_volume : ndarray, (solvent, n)
        Volume of each solvent over the total volume at the start.
    polymer_fraction : ndarray
        phi = phi_0 / F.
    radius, velocity : ndarray
        m, m/s; ``pi r^2 v phi`` is the polymer flux, the same everywhere.
    reynolds, sherwood : ndarray, (n,) and (solvent, n)
    notes : tuple of str
        Warnings given.
    """

    position: FloatArray
    remaining: FloatArray
    lost: FloatArray
    solvent_volume: FloatArray
    polymer_fraction: FloatArray
    radius: FloatArray
    velocity: FloatArray
    reynolds: FloatArray
    sherwood: FloatArray
    notes: tuple[str, ...]


def sherwood(reynolds: ArrayLike, schmidt: ArrayLike, floor: float = 0.0) -> FloatArray:
    """Sherwood number ``max(0.495 Re^(1/3) Sc^(1/2), floor)`` of Eq. (44); Re >= 0, Sc > 0, floor >= 0."""
    re, sc = real("reynolds", reynolds, least=0.0), real("schmidt", schmidt, above=0.0)
    least = number("sherwood_floor", floor, least=0.0)
    return np.maximum(0.495 * np.cbrt(re) * np.sqrt(sc), least)


def power_law_loss(
    distance: ArrayLike,
    k: ArrayLike,
    beta: ArrayLike,
    rate: ArrayLike,
    given: Literal["velocity", "radius"] = "velocity",
) -> FloatArray:
    """Closed form: part of the volume lost on a power-law jet in still air, constant properties and C.

    Parameters
    ----------
    distance : array_like
        s = z/r_0, >= 0.
    k, beta : array_like
        ``V = k^2 s^(2 beta)`` beyond ``s_0 = k^(-1/beta)``, V = 1 before; k > 0, beta in [1e-6, 1e6].
    rate : array_like
        ``a = pi D_a Sh_0 dC r_0 / Q``.
    given : {"velocity", "radius"}
        ``1 - (1 - 5 a J/6)^(6/5)``, or ``1 - (1 - 2 a J/3)^(3/2)`` where the radius is kept; ``J = int V^(1/6) ds``.

    Returns
    -------
    ndarray, broadcast shape; NaN where nothing is left.
    """
    s = real("distance", distance, least=0.0)
    log_k = np.log(real("k", k, above=0.0))
    exponent = real("beta", beta, least=1e-6, most=1e6)
    log_rate = np.log(real("rate", rate, above=0.0))
    if not isinstance(given, str) or given not in get_args(Given):
        raise InputError("given", "is not known", value=given, allowed='"velocity", "radius"')
    q = 6 / 5 if given == "velocity" else 3 / 2
    # in logarithms, since J spans more than a double: beyond s_0, J = k^(1/3) s^p/p + s_0 (1 - 1/p), p = 1 + beta/3
    power = 1 + exponent / 3
    log_s = np.log(np.where(s > 0, s, 1.0))
    beyond = power * (log_s + log_k / exponent)
    shorter = np.log1p(exponent / 3 * np.exp(-np.maximum(beyond, 0.0)))
    path = np.where(beyond > 0, log_k / 3 + power * log_s - np.log(power) + shorter, log_s)
    gone = np.where(s > 0, np.exp(np.minimum(log_rate + path - np.log(q), 1.0)), 0.0)
    return -np.expm1(q * np.log1p(-np.where(gone < 1, gone, np.nan)))


def evaporate(
    path: ElementPath,
    volume_fraction: float,
    volatiles: Sequence[Volatile],
    shares: ArrayLike = 1.0,
    *,
    air_viscosity: float,
    air_velocity: float = 0.0,
    activity: Activity = "flory-huggins",
    polymer_molar_volume: float | None = None,
    sherwood_floor: float = 0.0,
    transfer: Transfer = "kase-matsuo",
) -> Evaporation:
    """Volume, composition and radius of a drying jet.

    Parameters
    ----------
    path : ElementPath
        From `straight_path` or `bead_path`.
    volume_fraction : float
        phi_0 of the polymer at the start, in (0, 1).
    volatiles : sequence of Volatile
        Solvents; one that is only in the air has the share 0.
    shares : array_like, (solvent,)
        Volume shares of the solvents at the start, sum 1.
    air_viscosity : float
        nu_air, kinematic, m2/s.
    air_velocity : float
        Of the air along the jet, m/s.
    activity : {"flory-huggins", "raoult", "unit"}
        "unit" keeps the activity at 1 until the solvent is gone (one solvent only).
    polymer_molar_volume : float, optional
        m3/mol of a repeat unit, for Raoult's law.
    sherwood_floor : float, optional
        Least Sherwood number.
    transfer : {"kase-matsuo", "churchill-bernstein", "yarin"}
        How vapour passes into the air (`transfer`): the same for the first and the last along a straight jet.

    Returns
    -------
    Evaporation

    Raises
    ------
    InputError
        For values out of range.

    Warns
    -----
    SpinlineWarning
        Where Re leaves the range of the correlation.
    """
    phi0 = number("volume_fraction", volume_fraction, above=0.0, below=1.0)
    if not isinstance(volatiles, Sequence) or not all(isinstance(v, Volatile) for v in volatiles):
        raise InputError("volatiles", "is not a sequence of Volatile", value=volatiles)
    if not volatiles:
        raise InputError("volatiles", "is empty", remedy="give at least one solvent")
    share = np.atleast_1d(real("shares", shares, least=0.0, most=1.0))
    if share.shape != (len(volatiles),) or abs(float(share.sum()) - 1) > 1e-9:
        raise InputError("shares", "must be one per solvent and sum to 1", value=share.tolist(), remedy="scale them")
    balance = Balance(path, phi0, volatiles, (1 - phi0) * share / share.sum(), activity, polymer_molar_volume)
    balance.set_air(air_viscosity, air_velocity, sherwood_floor, transfer)
    return _result(balance, balance.autonomous() if balance.separable else balance.along())


def _result(balance: Balance, y: FloatArray) -> Evaporation:
    path, u = balance.path, balance.volumes(y)
    left = balance.phi0 + u.sum(axis=0)
    change = np.where(balance.inside[:, np.newaxis], balance.start[:, np.newaxis] * -np.expm1(y), -y)
    stretch, speed = path.stretch(path.position), path.speed(path.position)
    number = balance.reynolds(path.position, left)
    notes: tuple[str, ...] = ()
    every = np.concatenate((balance.reynolds(np.asarray([path.start]), 1.0), number))
    text = transfer_range(balance.law, every, float(balance.schmidt.min()))
    if text:
        warnings.warn(text, SpinlineWarning, stacklevel=3)
        notes = (text,)
    radius = path.initial_radius * np.sqrt((1.0 if balance.kept else left) / stretch)
    return Evaporation(
        position=path.position,
        remaining=left,
        lost=change.sum(axis=0),
        solvent_volume=u,
        polymer_fraction=balance.phi0 / left,
        radius=radius,
        velocity=speed * (left if balance.kept else 1.0),
        reynolds=number,
        sherwood=balance.sherwood(path.position, left),
        notes=notes,
    )
