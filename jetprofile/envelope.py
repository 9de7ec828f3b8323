"""How thin a bending jet becomes as the thread of its envelope: loops that widen as they drift, with inertia and air.

A steady envelope carries the flow through every plane: ``Q = pi A v_z dl/dz``, with A the undried cross-section over pi and
dl/dz the arc of a helix of radius R whose pitch drifts apart with ``v_z``. With ``x = v_z/v_0`` and ``y = k R`` (k the wave
number at the onset) the thread is ``l = (x^2 + y^2)^(1/2)`` times as long as there, and::

    rho dv/dt   = kappa (S - eta_E d(ln l)/dt) - eta_E W kappa'' v/4 - drag      v = dR/dt, kappa = k y/l^2
    S           = q^2 A^2 Lg/(4 eps0 W) - gamma/W^(1/2)                           as in `spinline.jetprofile.whipping`
    v_z dv_z/dz = (q E A/W - drag)/rho                                            held back by eta_E where it is straight
    dW/dt|drying = -k_ev                                                          as there, mixtures too

until it is solid or lands. Bending begins where the surface carries the whole current (`onset_radius`): conduction has
handed it over, ``a_0^2 = I/(pi K E)``, and the line charge I/v lies within what the voltage can put on a thread, ``2 pi
eps0 V/ln(2 H/a_0)``; with the fastest wave of a viscous charged thread, ``(k a)^6 = 8 rho a^2 S/eta_E^2`` (`fastest_wave`).
The limits:

* no inertia, no air, no field: ``eta_E d(ln l)/dt = S``, the march of `thinning` (race, terminal and flight);
* no charge: a straight jet that falls or is pulled.

Held: inertia, drag across the thread, the pull of the field, size and speed of the loops. Left out: bends upon bends, which
let a thread yield as if it had no inertia (`thinning` is that limit: the two are the bounds of a whipping jet), repulsion
between loops, elasticity.

References
----------
Yarin, Koombhongse, Reneker, J. Appl. Phys. 89, 3018 (2001) (bending growth of a viscous charged thread); the loops' equations
are derived here.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, positive, real
from spinline.base.constants import EPS0
from spinline.jetprofile._envelope_kernels import GIVEN, march_envelope
from spinline.jetprofile.whipping import Mixture, bending_liquid, leaving, log_term, solvents_of

__all__ = ["Envelope", "envelope", "fastest_wave", "held_radius", "onset_radius"]

_TRIALS = 4  # lengths of step


@dataclass(frozen=True, eq=False)
class Envelope:
    """How jets ended: arrays of the inputs' broadcast shape.

    Attributes
    ----------
    radius : ndarray
        a of the undried jet, m.
    volume_fraction, time, strain_rate, wet : ndarray
        As of `spinline.jetprofile.whipping.Thinning`.
    envelope_radius : ndarray
        Of the loops where it ended, m.
    axial_speed, loop_speed : ndarray
        dz/dt and dR/dt there, m/s.
    error : ndarray
        Of ln radius, from steps of twice the length.
    """

    radius: FloatArray
    volume_fraction: FloatArray
    time: FloatArray
    strain_rate: FloatArray
    wet: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
    envelope_radius: FloatArray
    axial_speed: FloatArray
    loop_speed: FloatArray
    error: FloatArray


def onset_radius(
    current: ArrayLike, conductivity: ArrayLike, flow_rate: ArrayLike, voltage: ArrayLike, gap: ArrayLike
) -> FloatArray:
    """Radius from which the surface carries the whole current.

    Parameters
    ----------
    current, conductivity, flow_rate, voltage, gap : array_like
        A, S/m, m3/s, V, m, > 0.

    Returns
    -------
    ndarray, m
        The smaller of ``(I/(pi K E))^(1/2)``, ``E = V/H``, where the surface carries as much as the liquid conducts, and ``(2
        eps0 V/(q ln(2 H/a)))^(1/2)``, where a straight thread with the charge q = I/Q in its volume has the voltage of the
        supply: on a thicker one there is not so much.

    Examples
    --------
    >>> round(float(onset_radius(100e-9, 1e-3, 2.8e-10, 15e3, 0.15)) * 1e6, 1)
    8.4
    """
    i = real("current", current, above=0.0, unit="A")
    k = real("conductivity", conductivity, above=0.0, unit="S/m")
    flow = real("flow_rate", flow_rate, above=0.0, unit="m3/s")
    v = real("voltage", voltage, above=0.0, unit="V")
    far = real("gap", gap, above=0.0, unit="m")
    conducted = np.sqrt(i * far / (np.pi * k * v))
    held = held_radius(i / flow, v, far)
    return np.asarray(np.minimum(conducted, held))


def held_radius(charge_density: ArrayLike, voltage: ArrayLike, gap: ArrayLike) -> FloatArray:
    """Radius at which a straight thread of a charge density (C/m3) in front of an earthed plate has the voltage (V)."""
    q, v, far = np.asarray(charge_density), np.asarray(voltage), np.asarray(gap)
    a = 1e-4 * far
    for _ in range(6):  # of a logarithm: each gains a digit
        a = np.sqrt(2 * EPS0 * v / (q * np.log(2 * np.maximum(far / a, 2.0))))
    return np.asarray(a)


def fastest_wave(
    stress: ArrayLike, radius: ArrayLike, extensional_viscosity: ArrayLike, density: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Wave number (1/m) and growth rate (1/s) of the bend that grows fastest on a viscous thread pushed by a stress.

    The largest root of ``w^2 + eta_E (k a)^4 w/(4 rho a^2) = S k^2/rho`` over k; never shorter than the jet's girth
    (``k a = 1``), 0 where nothing pushes.
    """
    s = np.maximum(real("stress", stress, unit="Pa"), 0.0)
    a = real("radius", radius, above=0.0, unit="m")
    eta = real("extensional_viscosity", extensional_viscosity, above=0.0, unit="Pa s")
    rho = real("density", density, above=0.0, unit="kg/m3")
    chi = np.minimum((8 * rho * a * a * s) ** (1 / 6) * eta ** (-1 / 3), 1.0)
    half = eta * chi**4 / (8 * rho * a * a)
    drive = s * chi * chi / (rho * a * a)
    root = half + np.sqrt(half * half + drive)
    growth = np.where(drive > 0, drive / np.where(root > 0, root, 1.0), 0.0)
    return np.asarray(chi / a), growth


def envelope(
    charge_density: ArrayLike,
    surface_tension: ArrayLike,
    extensional_viscosity: ArrayLike,
    evaporation: ArrayLike,
    volume_fraction: ArrayLike,
    flow_rate: ArrayLike,
    gap: ArrayLike,
    start: ArrayLike,
    field: ArrayLike,
    *,
    density: ArrayLike = 1000.0,
    power: ArrayLike = 4.67,
    solid_fraction: ArrayLike = 1.0,
    chi: float = 100.0,
    air_density: float = 1.2,
    air_viscosity: float = 1.51e-5,
    fraction: float = 0.1,
    accuracy: float = 0.02,
    mixture: Mixture | None = None,
) -> Envelope:
    """Envelopes of bending jets, from the onset until the thread is solid or lands.

    Parameters
    ----------
    charge_density, surface_tension, extensional_viscosity, evaporation, volume_fraction, power, solid_fraction, chi, mixture
        As for `spinline.jetprofile.whipping.thinning`.
    flow_rate, gap : array_like
        Q, m3/s; from the onset to the collector, m; > 0.
    start : array_like
        Radius at the onset, m, > 0.
    field : array_like
        Along the axis, V/m, >= 0.
    density : array_like
        Of the solution, kg/m3.
    air_density, air_viscosity : float
        kg/m3 (0: no air) and m2/s (kinematic).
    fraction : float
        By which a step may change anything; in (0, 0.5].
    accuracy : float
        Of ln radius, > 0: jets that two lengths of step leave further apart are marched again with steps of a quarter, thrice
        at most.

    Returns
    -------
    Envelope

    Raises
    ------
    InputError
        For inputs out of range.

    Notes
    -----
    Linearly implicit steps, extrapolated from `fraction` and half of it: ln radius within 0.02 of `fraction` on a usual jet;
    some 25 us a jet at 0.2, of which a few in a hundred are marched again. A jet that comes to no end in 200,000 steps has NaN.
    """
    e = real("field", field, least=0.0, unit="V/m")
    given = {"flow_rate": (flow_rate, "m3/s"), "gap": (gap, "m"), "density": (density, "kg/m3")}
    own = [real(name, value, above=0.0, unit=unit) for name, (value, unit) in given.items()]
    air, nu = float(real("air_density", air_density, least=0.0)), positive("air_viscosity", air_viscosity, "m2/s")
    step, within = float(real("fraction", fraction, above=0.0, most=0.5)), positive("accuracy", accuracy)
    q, gamma, eta, k, phi0, begin, p, solid, flow, far, rho, e, *solvents = bending_liquid(
        charge_density,
        surface_tension,
        extensional_viscosity,
        evaporation,
        volume_fraction,
        start,
        power,
        solid_fraction,
        *own,
        e,
        *solvents_of(mixture),
    )
    electric = q * q * log_term(chi) / (4 * EPS0)
    wave, growth = fastest_wave(electric * begin**2 - gamma / begin, begin, eta, rho)
    columns = {
        "electric": electric,
        "surface_tension": gamma,
        "extensional_viscosity": eta,
        "start": begin,
        "power": p,
        "left": phi0 / solid,
        "body_force": q * e,
        "density": rho,
        "flow_rate": flow,
        "distance": far,
        "air_density": np.full(q.shape, air),
        "air_viscosity": np.full(q.shape, nu),
        "wave_number": wave,
        "growth": growth,
    }
    jets = np.ascontiguousarray(np.stack([columns[name] for name in GIVEN], axis=-1).reshape(-1, len(GIVEN)))
    found = _marched(jets, *leaving(solvents, k, phi0), step, within)
    area, left, time, rate, landed, wide, axial, loop, error = (column.reshape(q.shape) for column in found.T)
    radius = np.sqrt(area) * np.exp(error)
    return Envelope(radius, phi0 / left, time, rate, landed > 0, wide, axial, loop, np.abs(error))


def _marched(jets: FloatArray, volumes: FloatArray, rates: FloatArray, step: float, within: float) -> FloatArray:
    """Ends of jets, (jet, 9): those of `march_envelope`, and the change of ln radius from steps twice as long."""
    found, rough = np.full((len(jets), 9), np.nan), np.arange(len(jets))
    for _ in range(_TRIALS):
        ends = []
        for length in (step, 0.5 * step):
            out = np.empty((len(rough), 8))
            march_envelope(jets[rough], volumes[rough], rates[rough], length, out)  # uses the volumes up
            ends.append(out)
        change = 0.5 * np.log(ends[1][:, 0] / ends[0][:, 0])
        ended = np.isfinite(change)  # shorter steps may be too many
        found[rough[ended]] = np.column_stack([ends[1], change])[ended]
        rough, step = rough[np.abs(change) > within], 0.25 * step
    return found
