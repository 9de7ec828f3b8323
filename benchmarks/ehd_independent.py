import sys
import time
import warnings

import numpy as np
from scipy.integrate import solve_bvp

from spinline.jetprofile.ehd import NeedleSettings, NoSteadyJet, StraightEhdJet, TableField

eps0 = 8.8541878128e-12
rng = np.random.default_rng(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
N = int(sys.argv[2]) if len(sys.argv) > 2 else 20


def solve(x, jet, full, tol=1e-6, d=0.01):
    """all from scratch in nondim"""
    r0 = x.radius
    v0 = x.flow_rate / np.pi / r0**2
    mu = x.viscosity
    rho = x.density
    g = x.gravity
    K = x.conductivity
    Es = x.voltage / x.gap
    L = x.gap if x.end is None else x.end
    chi = L / r0
    Re = rho * v0 * r0 / mu
    We = rho * v0**2 * r0 / x.surface_tension
    Fr = v0**2 / (g * r0)
    Pe = 2 * eps0 * v0 / (K * r0)
    El = eps0 * Es**2 / (rho * v0**2)
    De = x.relaxation_time * v0 / r0
    be = x.permittivity - 1
    rs = x.solvent_share
    newt = x.law == "newtonian" or De == 0
    a = x.mobility if x.law == "giesekus" else 0.0
    L2 = x.extensibility if x.law == "fene-p" else np.inf
    local = x.log == "local"
    if x.field == "uniform":
        Eext = lambda s: np.ones_like(s)
    elif x.field == "hyperboloid":
        xi0 = np.sqrt(x.gap / (x.gap + r0))
        aa = x.gap / xi0
        Lam = np.log((1 + xi0) / (1 - xi0))

        def Eext(s):
            h = x.gap - s * r0
            return 2 * x.voltage / (Lam * aa * (1 - (h / aa) ** 2)) / Es
    else:
        f = x.applied_field
        Eext = lambda s: f.axial(np.minimum(s * r0, L)) / Es
    given = x.current is not None
    iscale = np.pi * r0**2 * K * Es

    def parts(s, y, i):
        u, T = y[0], y[1]
        v = np.exp(u)
        R = np.exp(-u / 2)
        Psi = y[2]
        ell = np.log(chi) + (u / 2 if local else 0 * u)
        F = Psi / ell
        if newt:
            du = T / 3
        else:
            A, B = np.exp(y[3]), np.exp(y[4])
            fac = (L2 - 3) / (L2 - A - 2 * B) if np.isfinite(L2) else 1.0
            du = (T * v - (1 - rs) / De * fac * (A - B)) / (3 * rs * v)
        q = y[-1] if full else 1 - Pe * v * F / i
        E = i * q * v
        dPsi = Eext(s) - E
        if full:
            dq = 2 / be * ((1 - q) / (Pe * v) - F / i)
        else:
            dF = dPsi / ell - (Psi / ell**2 * du / 2 if local else 0)
            dq = -Pe / i * (v * du * F + v * dF)
        dv = v * du
        dE = i * (dq * v + q * dv)
        sig = i * (1 - q) * R / Pe
        dR = -R * du / 2
        dsig = i / Pe * ((1 - q) * dR - dq * R)
        dT = Re * (v * du - R**2 / Fr - dR / We - El * (sig * dsig * R**2 + be * E * dE * R**2 + 2 * sig * E * R))
        out = [du, dT, dPsi]
        if not newt:
            out += [
                (2 * dv - (fac * A - 1 + a * (A - 1) ** 2) / (De * A)) / v,
                (-dv - (fac * B - 1 + a * (B - 1) ** 2) / (De * B)) / v,
            ]
        if full:
            out.append(dq)
        return np.array(out), E, du

    def rhs(s, y, p=None):
        i = ig if given else np.exp(p[0])
        return parts(s, y, i)[0]

    def bc(ya, yb, p=None):
        i = ig if given else np.exp(p[0])
        _, E, du = parts(np.array([chi]), yb[:, None], i)
        res = [ya[0], E[0] / Eext(np.array([chi]))[0] - 1, du[0] - 1 / (2 * chi) * x.end_factor]
        if not newt:
            res += [ya[3], ya[4]]
        if full:
            res.append(ya[-1] - 1)
        if not given:
            res.append(ya[2])
        return np.array(res)

    ig = x.current / iscale if given else None
    # start: the jet's own on a coarse mesh, disturbed
    s = jet._s[::2] if jet._s[::2][-1] == jet._s[-1] else np.append(jet._s[::2], jet._s[-1])
    z = s * r0
    z = np.minimum(z, jet.end)
    cols = [
        np.log(jet.velocity_ratio(z)) * (1 + d),
        jet.tension(z) / (np.pi * r0 * mu * v0) * (1 - 2 * d),
        jet._curve(s)[:, 2] * (1 + d),
    ]
    if not newt:
        A, B = jet.conformation(z)
        cols += [np.log(A), np.log(B)]
    if full:
        cols.append(jet.conduction_share(z))
    y0 = np.array(cols)
    p0 = None if given else np.array([np.log(jet.current / iscale) + d])
    sol = solve_bvp(rhs, bc, s, y0, p=p0, tol=tol, max_nodes=30000)
    I = x.current if given else np.exp(sol.p[0]) * iscale
    return sol, I


def draw():
    ln = lambda a, b: float(np.exp(rng.uniform(np.log(a), np.log(b))))
    kind = rng.choice(["A", "B", "C", "D"])
    law = str(rng.choice(["newtonian", "oldroyd-b", "giesekus", "fene-p"]))
    log = str(rng.choice(["local", "constant"]))
    field = str(rng.choice(["hyperboloid", "needle", "uniform", "table"]))
    given = bool(rng.random() < 0.4)
    c = lambda v: v * ln(0.7, 1.4)
    if kind in "AD":
        d = dict(
            radius=c(0.8e-3),
            flow_rate=c(1e-6 / 60),
            voltage=c(4e4),
            gap=0.08,
            conductivity=c(1e-6),
            viscosity=c(1.88),
            surface_tension=c(0.063),
            density=c(1260.0),
            permittivity=c(46.0),
            end=c(0.06) * 0.75,
        )
    elif kind == "B":
        r = 1e-3
        rho = 1000.0
        v = np.sqrt(0.1 * 9.81 * r)
        e0 = np.sqrt(rho * v**2 / eps0)
        d = dict(
            radius=r,
            flow_rate=c(np.pi * r**2 * v),
            voltage=c(0.7 * e0 * 0.1),
            gap=0.1,
            conductivity=c(2 * eps0 * v / (0.1 * r)),
            density=rho,
            permittivity=c(41.0),
            viscosity=c(rho * v * r / 2.5e-3),
            surface_tension=c(rho * v**2 * r / 0.1),
            end=75 * r,
        )
    else:
        d = dict(
            radius=c(125e-6),
            flow_rate=c(3.2e-6 / 3600),
            voltage=c(6e3),
            gap=0.1,
            conductivity=ln(1e-4, 0.02),
            viscosity=c(2.0),
            surface_tension=c(0.061),
            density=1000.0,
            permittivity=c(70.0),
            end=c(0.02),
        )
    de = ln(0.3, 4)
    v0 = d["flow_rate"] / np.pi / d["radius"] ** 2
    d.update(
        relaxation_time=de * d["radius"] / v0,
        law=law,
        log=log,
        field=field,
        mobility=0.015,
        extensibility=ln(60, 800),
        solvent_share=rng.uniform(0.08, 0.3),
    )
    if field == "table":
        z = np.concatenate(([0.0], np.geomspace(1e-6, 0.1, 60)))
        z = z * d["gap"] / z[-1]
        from spinline.jetprofile.ehd import HyperboloidField

        d["field"] = TableField(
            z, HyperboloidField(d["voltage"], d["gap"], d["radius"]).axial(z) * (1 + 0.1 * np.sin(40 * z / d["gap"]))
        )
    return kind, given, d


worst = []
k = 0
while k < N:
    kind, given, d = draw()
    try:
        x = NeedleSettings(**d)
    except Exception as e:
        print("bad", e)
        continue
    try:
        jet = StraightEhdJet(x, length=x.end_position)
    except NoSteadyJet as e:
        print(kind, x.law, "no jet", e.reason)
        continue
    if given:
        f = float(np.exp(rng.uniform(-0.2, 1.2)))
        d["current"] = jet.current * f
        x = NeedleSettings(**d)
        try:
            jet = StraightEhdJet(x, length=x.end_position)
        except NoSteadyJet as e:
            print(kind, x.law, "no jet given", f, e.reason)
            continue
    k += 1
    full = jet.solved.problem.charge
    t = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for dd in (0.01, 0.001, 1e-4, 0):
            sol, I = solve(x, jet, full, d=dd)
            if sol.success:
                break
    z = np.linspace(0, x.end_position, 401)[1:]
    z = np.concatenate((np.geomspace(x.radius * 0.05, x.end_position, 200)[:-1], z))
    r = np.exp(-sol.sol(z / x.radius)[0] / 2) * x.radius
    dr = np.abs(r / jet.radius(z) - 1).max()
    dI = abs(I / jet.current - 1)
    dT = abs(sol.y[1, 0] * x.force_scale / float(jet.tension(0)) - 1)
    worst.append(max(dr, dI))
    print(
        f"{k:2d} {kind} {x.law:10s} {x.log:8s} {x.field if isinstance(x.field, str) else 'table':11s} given={given!s:5} full={full!s:5} ok={sol.success} nodes={sol.x.size} dr={dr:.1e} dI={dI:.1e} dT={dT:.1e} est={jet.error['radius']:.0e} {time.process_time() - t:.1f}s start off by {dd}",
        flush=True,
    )
print("worst", max(worst))
