"""The straight electrified jet against equations written anew for scipy's `solve_bvp`: random settings of all laws and fields.

State u = ln V, T, Psi, ln A_zz, ln A_rr and, where charge relaxation is resolved, q; the momentum with the slopes of charge and
field written out (Feng's form), FENE-P in its own variables, the current a parameter where it is predicted. Shared with what it
checks: the needle's and the table's field, and the jet itself, moved off by 1 % (or by 0.1, 0.01 %, where scipy does not come
back from 1 %), as scipy's start. Near the four reference jets: glycerol with its current given and predicted, Feng's set, PEO.

    python benchmarks/ehd_independent.py [number]        # goes on where ehd_independent.json ends, to so many
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp

from spinline.jetprofile.ehd import HyperboloidField, NeedleSettings, NoSteadyJet, StraightEhdJet, TableField

VACUUM = 8.8541878128e-12
LAWS = ("newtonian", "oldroyd-b", "giesekus", "fene-p")


def drawn(index: int) -> tuple[str, StraightEhdJet] | str:
    """A jet near one of the reference jets; or why there is none."""
    rng = np.random.default_rng([17, index])

    def about(value: float, factor: float = 1.4) -> float:
        return float(value * np.exp(rng.uniform(-np.log(factor), np.log(factor))))

    kind = ("A", "B", "C", "D")[index % 4]
    if kind in "AD":
        given = {
            "radius": about(0.8e-3),
            "flow_rate": about(1e-6 / 60),
            "voltage": about(4e4),
            "gap": 0.08,
            "conductivity": about(1e-6),
            "viscosity": about(1.88),
            "surface_tension": about(0.063),
            "density": 1260.0,
            "permittivity": about(46.0),
            "end": 0.045,
        }
    elif kind == "B":
        r, v = 1e-3, np.sqrt(0.1 * 9.81 * 1e-3)
        given = {
            "radius": r,
            "flow_rate": about(np.pi * r**2 * v),
            "voltage": about(0.07 * np.sqrt(1000 * v**2 / VACUUM)),
            "gap": 0.1,
            "conductivity": about(2 * VACUUM * v / (0.1 * r)),
            "viscosity": about(1000 * v * r / 2.5e-3),
            "surface_tension": about(1000 * v**2 * r / 0.1),
            "density": 1000.0,
            "permittivity": about(41.0),
            "end": 0.075,
        }
    else:
        given = {
            "radius": about(125e-6),
            "flow_rate": about(3.2e-6 / 3600),
            "voltage": about(6e3),
            "gap": 0.1,
            "conductivity": about(2e-3, 10),
            "viscosity": about(2.0),
            "surface_tension": about(0.061),
            "density": 1000.0,
            "permittivity": about(70.0),
            "end": about(0.02),
        }
    field: Any = ("hyperboloid", "needle", "uniform", "table")[int(rng.integers(4))]
    if field == "table":
        z = np.concatenate(([0.0], np.geomspace(1e-6, given["gap"], 60)))
        wavy = 1 + 0.1 * np.sin(40 * z / given["gap"])
        field = TableField(z, HyperboloidField(given["voltage"], given["gap"], given["radius"]).axial(z) * wavy)
    settings = NeedleSettings(
        **given,
        relaxation_time=about(1.2, 4) * np.pi * given["radius"] ** 3 / given["flow_rate"],
        law=LAWS[int(rng.integers(4))],
        log=("local", "constant")[int(rng.integers(2))],
        field=field,
        mobility=0.015,
        extensibility=about(200.0, 3),
        solvent_share=float(rng.uniform(0.08, 0.3)),
    )
    try:
        jet = StraightEhdJet(settings, length=settings.end_position)
        if kind in "AB":
            current = jet.current * float(np.exp(rng.uniform(-0.2, 1.0)))
            jet = jet.changed(current=current)
            jet = StraightEhdJet(jet.settings, length=settings.end_position)
    except NoSteadyJet as refused:
        return refused.reason
    return kind, jet


class Again:
    """The boundary-value problem of a jet's settings, for scipy."""

    def __init__(self, jet: StraightEhdJet) -> None:
        x = self.x = jet.settings
        self.jet, self.resolved = jet, jet.solved.problem.charge
        r, mu, rho = x.radius, x.viscosity, x.density
        v = x.flow_rate / np.pi / r**2
        self.scale = x.voltage / x.gap
        self.chi = (x.gap if x.end is None else x.end) / r
        self.re, self.we, self.fr = rho * v * r / mu, rho * v**2 * r / x.surface_tension, v**2 / (x.gravity * r)
        self.pe, self.el = 2 * VACUUM * v / (x.conductivity * r), VACUUM * self.scale**2 / (rho * v**2)
        self.de, self.force = x.relaxation_time * v / r, np.pi * r * mu * v
        self.plain = x.law == "newtonian"
        self.limit = x.extensibility if x.law == "fene-p" else np.inf
        self.unit = np.pi * r**2 * x.conductivity * self.scale
        self.given = None if x.current is None else x.current / self.unit

    def outside(self, s: Any) -> Any:
        x = self.x
        if x.field == "uniform":
            return np.ones_like(s)
        if x.field == "hyperboloid":
            tip = np.sqrt(x.gap / (x.gap + x.radius))
            a, lam = x.gap / tip, np.log((1 + tip) / (1 - tip))
            return 2 * x.voltage / (lam * a * (1 - ((x.gap - s * x.radius) / a) ** 2)) / self.scale
        return x.applied_field.axial(np.minimum(s * x.radius, x.end_position)) / self.scale

    def slopes(self, s: Any, y: Any, i: Any) -> tuple[Any, Any, Any]:
        x, u, t, psi = self.x, y[0], y[1], y[2]
        v, r, local = np.exp(u), np.exp(-u / 2), x.log == "local"
        ell = np.log(self.chi) + (u / 2 if local else 0 * u)
        line, polymer, du = psi / ell, [], t / 3
        if not self.plain:
            a, c, m = np.exp(y[3]), np.exp(y[4]), x.mobility if x.law == "giesekus" else 0.0
            f = (self.limit - 3) / (self.limit - a - 2 * c) if np.isfinite(self.limit) else 1.0
            du = (t * v - (1 - x.solvent_share) / self.de * f * (a - c)) / (3 * x.solvent_share * v)
            polymer = [
                (2 * v * du - (f * a - 1 + m * (a - 1) ** 2) / (self.de * a)) / v,
                (-v * du - (f * c - 1 + m * (c - 1) ** 2) / (self.de * c)) / v,
            ]
        beta = x.permittivity - 1
        q = y[-1] if self.resolved else 1 - self.pe * v * line / i
        e = i * q * v
        dpsi = self.outside(s) - e
        if self.resolved:
            dq = 2 / beta * ((1 - q) / (self.pe * v) - line / i)
        else:
            dline = dpsi / ell - (psi / ell**2 * du / 2 if local else 0)
            dq = -self.pe / i * v * (du * line + dline)
        dv, dr, sigma = v * du, -r * du / 2, i * (1 - q) * r / self.pe
        de, dsigma = i * (dq * v + q * dv), i / self.pe * ((1 - q) * dr - dq * r)
        electric = sigma * dsigma * r**2 + beta * e * de * r**2 + 2 * sigma * e * r
        dt = self.re * (dv - r**2 / self.fr - dr / self.we - self.el * electric)
        return np.array([du, dt, dpsi, *polymer, *([dq] if self.resolved else [])]), e, du

    def current(self, p: Any) -> Any:
        return self.given if self.given is not None else np.exp(p[0])

    def ends(self, a: Any, b: Any, p: Any = None) -> Any:
        last = np.array([self.chi])
        _, e, du = self.slopes(last, b[:, None], self.current(p))
        rows = [a[0], e[0] / self.outside(last)[0] - 1, du[0] - 1 / (2 * self.chi)]
        rows += [] if self.plain else [a[3], a[4]]
        rows += [a[-1] - 1] if self.resolved else []
        return np.array(rows + ([a[2]] if self.given is None else []))

    def solved(self) -> tuple[Any, float, float]:
        """Scipy's solution, the current (A), and how far off its start was."""
        jet, found = self.jet, self.jet.solved.discrete
        s = found.s[::2] if found.s.size % 2 else np.append(found.s[::2], found.s[-1])
        z = np.minimum(s * self.x.radius, jet.end)
        psi = np.interp(s, found.s, found.y[:, 2])
        for off in (1e-2, 1e-3, 1e-4):
            start = [
                np.log(jet.velocity_ratio(z)) * (1 + off),
                jet.tension(z) / self.force * (1 - 2 * off),
                psi * (1 + off),
            ]
            start += [] if self.plain else [np.log(a) for a in jet.conformation(z)]
            start += [jet.conduction_share(z)] if self.resolved else []
            p = None if self.given is not None else [np.log(jet.current / self.unit) + off]
            with np.errstate(over="ignore", divide="ignore", invalid="ignore"):  # of its trials, which may be anything
                done = solve_bvp(
                    lambda s, y, p=None: self.slopes(s, y, self.current(p))[0],
                    self.ends,
                    s,
                    np.array(start),
                    p=p,
                    tol=1e-6,
                    max_nodes=20000,
                )
            if done.success:
                break
        return done, float(self.current(done.p)) * self.unit, off


def row(index: int) -> dict[str, Any]:
    made = drawn(index)
    if isinstance(made, str):
        return {"index": index, "verdict": made}
    kind, jet = made
    x = jet.settings
    field = x.field if isinstance(x.field, str) else "table"
    told: dict[str, Any] = {"index": index, "near": kind, "law": x.law, "log": x.log, "field": field}
    done, current, off = Again(jet).solved()
    if not done.success:
        return {**told, "verdict": "scipy does not converge"}
    z = np.concatenate((np.geomspace(0.05 * x.radius, x.end_position, 200)[:-1], np.linspace(0, x.end_position, 200)))
    radius = x.radius * np.exp(-done.sol(z / x.radius)[0] / 2)
    return {
        **told,
        "verdict": "jet",
        "start_off_by": off,
        "radius_apart": float(np.abs(radius / jet.radius(z) - 1).max()),
        "current_apart": abs(current / jet.current - 1),
        "tension_apart": abs(float(done.y[1, 0]) * x.force_scale / float(jet.tension(0.0)) - 1),
    }


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    jets = [one for one in rows if one["verdict"] == "jet"]
    result: dict[str, Any] = {"settings": len(rows), "compared": len(jets)}
    result["not_compared"] = [one for one in rows if one["verdict"] != "jet"]
    for name in ("radius_apart", "current_apart", "tension_apart"):
        result[f"largest {name}"] = max((one[name] for one in jets), default=None)
    return result | {"rows": rows}


def main() -> None:
    path = Path(__file__).with_suffix(".json")
    rows = json.loads(path.read_text())["rows"] if path.exists() else []
    for index in range(len(rows), int(sys.argv[1]) if len(sys.argv) > 1 else 60):
        rows.append(row(index))
        print(rows[-1], flush=True)
        path.write_text(json.dumps(summary(rows), indent=1) + "\n")


if __name__ == "__main__":
    main()
