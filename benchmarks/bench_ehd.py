"""Straight electrified jet: error and time against scipy's collocation on the same equations, in one run.

    python benchmarks/bench_ehd.py        # writes bench_ehd.json

The problem is Feng's set (Newtonian, current given, charge relaxation resolved) and the glycerol jet; truth is this
solver at a tolerance of 1e-10. scipy's `solve_bvp` gets the same start, a vectorised right-hand side, and tolerances of
1e-3 to 1e-7; it is charged for the solution alone, ours for the whole way from a thread without forces as well as for
the last step from the same start. Also timed: the closed elastic law, a warm and a cold solution of the PEO jet.
"""

import json
import time
from pathlib import Path

import numpy as np
from peo_needle_settings import peo_needle
from scipy.integrate import solve_bvp

from spinline.base.constants import EPS0
from spinline.jetprofile.ehd import ElasticJet, NeedleSettings, StraightEhdJet
from spinline.jetprofile.ehd.boundary_value import interpolate, newton, remesh, spline
from spinline.jetprofile.ehd.solver import solve

GLYCEROL = NeedleSettings(
    radius=0.8e-3,
    flow_rate=1e-6 / 60,
    voltage=4e4,
    gap=0.08,
    conductivity=1e-6,
    viscosity=14.9e-4 * 1260,
    surface_tension=0.063,
    density=1260.0,
    permittivity=46.5,
    law="newtonian",
    field="uniform",
    end=0.06,
    log="constant",
    current=170e-9,
)
PEO = peo_needle(end=0.02)


def feng() -> NeedleSettings:
    r, rho = 1e-3, 1000.0
    v = np.sqrt(0.1 * 9.81 * r)
    k, e0 = 2 * EPS0 * v / (0.1 * r), np.sqrt(rho * v**2 / EPS0)
    return NeedleSettings(
        radius=r,
        flow_rate=np.pi * r**2 * v,
        voltage=0.7 * e0 * 0.1,
        gap=0.1,
        conductivity=k,
        density=rho,
        permittivity=41.0,
        viscosity=rho * v * r / 2.5e-3,
        surface_tension=rho * v**2 * r / 0.1,
        end=75 * r,
        field="uniform",
        log="constant",
        current=np.pi * r**2 * k * e0,
        law="newtonian",
    )


def best(call, repeats: int = 5) -> float:
    took = []
    for _ in range(repeats):
        began = time.process_time()
        call()
        took.append(time.process_time() - began)
    return min(took)


def against_scipy(settings: NeedleSettings) -> list[dict[str, object]]:
    n = settings.numbers
    p = settings.problem(charge=True, predicted=False)
    i = float(np.exp(p.left[p.left[:, 0] == 3, 1][0]))
    re, we, beta, pe, el, chi = n["reynolds"], n["weber"], p.parameters[5], n["peclet"], n["euler"], n["slenderness"]
    fr, log, outside = n["inverse_froude"], np.log(n["slenderness"]), p.parameters[13]

    def rate(s, y):
        u, t, q, psi = y
        v, r = np.exp(u), np.exp(-u / 2)
        du, dq = t / 3, 2 / beta * ((1 - q) / (pe * v) - psi / log / i)
        e, sigma = i * q * v, i * (1 - q) * r / pe
        dr, de = -r * du / 2, i * v * (dq + q * du)
        dsigma = i * ((1 - q) * dr - dq * r) / pe
        force = sigma * dsigma * r**2 + beta * e * de * r**2 + 2 * i**2 * q * (1 - q) / pe
        return np.array([du, re * (v * du - r**2 * fr - dr / we - el * force), dq, outside - e])

    def ends(a, b):
        return np.array([a[0], a[2] - 1, i * b[2] * np.exp(b[0]) / outside - 1, b[1] / 3 - 1 / (2 * chi)])

    exact = StraightEhdJet(settings, length=settings.end_position, tolerance=1e-10)
    z = np.linspace(0, settings.end_position, 2001)
    s, true = z / settings.radius, exact.radius(z)
    found = solve(settings, tolerance=1e-3).discrete
    start = np.array(
        [found.y[:, 0], exact.tension(found.s * settings.radius) / settings.force_scale, found.y[:, 4], found.y[:, 2]]
    )
    rows: list[dict[str, object]] = []
    mesh = remesh(found.s, found.y, 101)
    first = interpolate(found.s, start.T, mesh).T * np.array([[0.97], [1.05], [1.0], [1.02]])
    for tol in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7):
        call = lambda tol=tol: solve_bvp(rate, ends, mesh, first, tol=tol, max_nodes=50000)  # noqa: E731
        done = call()
        error = float(np.abs(np.exp(-done.sol(s)[0] / 2) * settings.radius / true - 1).max())
        rows.append(
            {
                "solver": "scipy solve_bvp",
                "tol": tol,
                "nodes": done.x.size,
                "ok": done.success,
                "error": error,
                "seconds": best(call, 3),
            }
        )
    guess = interpolate(found.s, found.y, mesh) * np.array([0.97, 1.05, 1.02, 1.0, 1.0])
    guess[:, 3] = np.log(i)
    for nodes in (51, 101, 201, 401, 801):
        grid = remesh(mesh, guess, nodes)
        begin = interpolate(mesh, guess, grid)
        made = newton(p, grid, begin)
        curve, _ = spline(p, made)
        error = float(np.abs(np.exp(-curve(s)[:, 0] / 2) * settings.radius / true - 1).max())
        rows.append(
            {
                "solver": "spinline, same start",
                "nodes": nodes,
                "ok": made.converged,
                "error": error,
                "seconds": best(lambda g=grid, b=begin: newton(p, g, b)),
            }
        )
    for tol in (1e-4, 1e-6, 1e-8):
        jet = StraightEhdJet(settings, length=settings.end_position, tolerance=tol)
        error = float(np.abs(jet.radius(z) / true - 1).max())
        rows.append(
            {
                "solver": "spinline, from nothing",
                "tol": tol,
                "nodes": jet.solved.discrete.s.size,
                "ok": True,
                "error": error,
                "seconds": best(lambda tol=tol: solve(settings, tolerance=tol), 3),
            }
        )
    return rows


def main() -> None:
    result = {"feng": against_scipy(feng()), "glycerol": against_scipy(GLYCEROL)}
    cold = StraightEhdJet(PEO)
    law = ElasticJet(radius=125e-6, flow_rate=3.2e-6 / 3600, relaxation_time=7e-3, jump=2.0)
    z = np.linspace(0, 5e-3, 401)
    result["peo_seconds"] = {
        "closed elastic law, 401 places": best(lambda: law.radius(z), 20),
        "warm": best(lambda: cold.changed(voltage=6.2e3), 3),
        "cold": best(lambda: StraightEhdJet(PEO), 3),
    }
    Path(__file__).with_suffix(".json").write_text(json.dumps(result, indent=1) + "\n")
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
