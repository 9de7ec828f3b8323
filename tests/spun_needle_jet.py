"""The steady leaky jet of a needle (PEO reference case, local logarithm) by `scipy.solve_bvp`: an oracle for the hand-over.

Outer form of Feng's equations with FENE-P, current predicted from ``Psi(0) = 0``; it shares no code with the solver under
test. Dimensionless: radius r0, velocity v0, field V/H.
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.integrate import solve_bvp

EPS0 = 8.8541878128e-12
R0, Q, K, MU, GAMMA, RHO, V, H, G = 125e-6, 3.2e-6 / 3600, 0.01, 2.0, 0.061, 1000.0, 6000.0, 0.1, 9.81
THETA, L2, RS, LENGTH = 7e-3, 507.0, 0.1, 0.02
V0 = Q / (math.pi * R0**2)
ES = V / H
CHI = LENGTH / R0
XI0 = math.sqrt(H / (H + R0))
A = H / XI0
LAM = math.log((1 + XI0) / (1 - XI0))
RE, WE, FR = RHO * V0 * R0 / MU, RHO * V0**2 * R0 / GAMMA, V0**2 / (G * R0)
PE, EL, DE = 2 * EPS0 * V0 / (K * R0), EPS0 * ES**2 / (RHO * V0**2), THETA * V0 / R0


def applied(z):
    """Field of the hyperboloid on its axis, V/m."""
    return 2 * V / (LAM * A * (1 - ((H - z) / A) ** 2))


def _parts(y, i):
    u, t, psi, la, lr = y
    v, azz, arr = np.exp(u), np.exp(la), np.exp(lr)
    f = (L2 - 3) / (L2 - azz - 2 * arr)
    slope = (t * v - (1 - RS) / DE * f * (azz - arr)) / (3 * RS * v)
    logs = math.log(CHI) + u / 2
    line = psi / logs
    return u, v, azz, arr, f, slope, logs, line, 1 - PE * v * line / i


def _rates(s, y, p):
    i = np.exp(p[0])
    _u, v, azz, arr, f, up, logs, line, q = _parts(y, i)
    r = v**-0.5
    psi = applied(s * R0) / ES - i * q * v
    lp = (psi - line * up / 2) / logs
    qp = -(PE / i) * v * (up * line + lp)
    sigma, rp = line / r, -r * up / 2
    sp = lp / r - line / r**2 * rp
    ep = i * v * (qp + q * up)
    tp = (
        v * up
        - r**2 / FR
        - rp / WE
        - EL * (sigma * sp * r**2 + 79 * i * q * v * ep * r**2 + 2 * i * i * q * (1 - q) / PE)
    )
    return np.array(
        [up, RE * tp, psi, (2 * v * up - (f * azz - 1) / (DE * azz)) / v, (-v * up - (f * arr - 1) / (DE * arr)) / v]
    )


def _ends(ya, yb, p):
    i = math.exp(p[0])
    _u, v, _a, _b, _f, up, _l, _line, q = _parts(yb, i)
    return np.array([ya[0], ya[2], ya[3], ya[4], up - 1 / (2 * CHI), i * q * v - applied(LENGTH) / ES])


@dataclass(frozen=True)
class NeedleJet:
    """Radius, velocity, tension, line charge, conformation, conducted share and potential at z (m), SI; current in A."""

    solution: object
    current: float

    def at(self, z):
        y = self.solution.sol(np.asarray(z) / R0)
        i = math.exp(self.solution.p[0])
        _u, v, azz, arr, _f, _up, _logs, line, q = _parts(y, i)
        return {
            "r": R0 / np.sqrt(v),
            "v": v * V0,
            "P": math.pi * R0 * MU * V0 * y[1],
            "lam": 2 * math.pi * EPS0 * R0 * ES * line,
            "azz": azz,
            "arr": arr,
            "q": q,
            "psi": y[2] * ES * R0,
        }


@cache
def needle_jet() -> NeedleJet:
    """Solved from a rough elastic guess."""
    s = np.concatenate(([0], np.geomspace(1e-3, CHI, 400)))
    i0, t0 = 222e-9 / (math.pi * R0**2 * K * ES), 1.42
    u = np.log(1 + 2 * (1 - np.exp(-s)) + 0.9 * s / DE)
    v = np.exp(u)
    stress = t0 * v * DE / (1 - RS)
    azz = 1 + stress * L2 / (L2 - 3 + stress) * (1 - np.exp(-2 * s))
    share = np.interp(s, [0, 40, CHI], [1, 0.9, 0.7])
    psi = (1 - share) * i0 / (PE * v) * (math.log(CHI) + u / 2)
    guess = np.array([u, t0 + 0 * s, psi, np.log(azz), -0.5 * np.log(azz)])
    found = solve_bvp(_rates, _ends, s, guess, p=[math.log(i0)], tol=1e-6, max_nodes=60000)
    assert found.status == 0, found.message
    return NeedleJet(found, math.exp(found.p[0]) * math.pi * R0**2 * K * ES)
