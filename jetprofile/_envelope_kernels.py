"""The march of `spinline.jetprofile.envelope.envelope`, compiled: one jet after another."""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile._solvents_kernels import leave

__all__ = ["GIVEN", "march_envelope"]

#: What a jet is given, column by column.
GIVEN = (
    "electric",
    "surface_tension",
    "extensional_viscosity",
    "start",
    "power",
    "left",
    "body_force",
    "density",
    "flow_rate",
    "distance",
    "air_density",
    "air_viscosity",
    "wave_number",
    "growth",
)
_MOST = 200_000


@njit(cache=True, error_model="numpy")
def _drag(radius: float, speed: float, density: float, air_density: float, air_viscosity: float) -> float:
    """Deceleration over speed of a thread that moves across itself, 1/s: `normal_drag` over its mass per length."""
    re = 2.0 * radius * speed / air_viscosity
    if re <= 0.0:
        return 0.0
    c = 1.18 + 6.8 * re**-0.89 + 1.96 / math.sqrt(re) - 0.0004 * re / (1.0 + 3.64e-7 * re * re)
    value: float = c * air_density * speed / (density * math.pi * radius)
    return value


@njit(cache=True, error_model="numpy")
def _axial(net: float, vz: float, rho: float, eta: float, straight: float) -> float:
    """Acceleration along the axis: driven against inertia, and against viscosity where the jet is straight."""
    if net <= 0.0:
        return net / rho
    slow = rho * vz / net + math.sqrt(eta / (2.0 * net * vz)) * straight  # 1/(dv/dz)
    return vz / slow


@njit(cache=True, error_model="numpy")
def march_envelope(
    given: FloatArray, solvents: FloatArray, rates: FloatArray, fraction: float, out: FloatArray
) -> None:
    """March jets: `given` (jet, `GIVEN`); a step moves nothing by more than `fraction`.

    `solvents` (jet, solvent) are the parts of the undried volume at the start, and are used up; `rates` theirs.

    `out` (jet, 8) holds ``A = a^2`` undried, the share left of the liquid, the time, the mean rate of stretching, 1 where
    it landed wet, the envelope's radius, the speed along the axis and that of the loops where it ended. NaN where no end
    was reached.
    """
    for i in range(given.shape[0]):
        g = given[i]
        electric, gamma, eta0, start, p, last = g[0], g[1], g[2], g[3], g[4], g[5]
        body, rho, distance, air, nu, wave = g[6], g[7], g[9], g[10], g[11], g[12]
        a0 = start * start
        v0 = g[8] / (math.pi * a0)
        vz, z, time, u = v0, 0.0, 0.0, 1.0
        r = start
        v = g[13] * r
        stretch0 = math.hypot(1.0, wave * r)
        length, strain, weighted, landed, done = stretch0, 0.0, 0.0, 0.0, False
        for _ in range(_MOST):
            area = a0 * stretch0 / length
            thick = math.sqrt(area * u)
            eta = eta0 * u**-p
            x, y = vz / v0, wave * r
            l2 = x * x + y * y
            bend = wave * y / l2
            d = _drag(thick, math.hypot(v, vz), rho, air, nu)
            net = body / u - rho * d * vz
            push = _axial(net, vz, rho, eta, x * x / l2)
            free = min(push * rho / net, 1.0) if net > 0.0 else 1.0
            stress = electric * area / u - gamma / thick
            stiff = 0.25 * eta * (thick * wave * wave / l2) ** 2
            hold = (eta * bend * bend + stiff) / rho + d
            firm = bend * bend * (electric * area / u + 0.5 * gamma / thick) / rho
            k = (solvents[i] * rates[i]).sum() / solvents[i].sum()
            rate = abs(v) / (r + start) + abs(push) / (vz + abs(v)) + k / (area * u) + vz / distance
            dt = min(fraction / rate, (u - last) * area / k)
            most = 2.0 * fraction * (r + start)
            for _ in range(2):
                gain = push / (1.0 + 2.0 * dt * free * d)  # drag grows up to the square of the speed
                along = x * gain / v0 / l2
                new = v + dt * (bend * (stress - eta * along) / rho + d * v)
                new /= 1.0 + dt * (hold + d + dt * firm)
                if abs(new) * dt <= most:
                    break
                dt *= most / (abs(new) * dt)
            vz1 = max(vz + dt * gain, 1e-6 * vz)
            forward = 0.5 * dt * (vz + vz1)
            part = 1.0
            if z + forward >= distance:
                part, landed = (distance - z) / forward, 1.0
            r1, vz1 = r + part * dt * new, vz + part * (vz1 - vz)
            if r1 < 1e-3 * start:  # pulled straight: what is left is noise, not a string's vibration
                r1, new = 1e-3 * start, 0.0
            longer = math.hypot(vz1 / v0, wave * r1)
            gained = math.log(longer / length)
            strain += gained
            if part * dt > 0.0:
                weighted += gained * gained / (part * dt)
            dried = part * dt * k / area
            leave(solvents[i], rates[i], dried)
            u -= dried
            r, v, vz, z, length = r1, new, vz1, z + part * forward, longer
            time += part * dt
            if landed > 0.0 or u <= last * (1.0 + 1e-12):
                done = True
                break
        out[i, 0] = a0 * stretch0 / length if done else math.nan
        out[i, 1], out[i, 2], out[i, 4] = u, time, landed
        out[i, 3] = weighted / strain if strain > 0.0 else 0.0
        out[i, 5], out[i, 6], out[i, 7] = r, vz, v
