"""Speed and error of the bead chain: whole network, growth with N, against scipy's stiff solvers.

Every ratio is measured in one run. Errors are of the local stretch, relative, the largest over stations or strands.

    python benchmarks/bench_chain.py [whole] [growth] [scipy] [entering] [draws]
"""

import resource
import sys
import time

import numpy as np
from scipy.integrate import solve_ivp
from scipy.sparse import diags

from spinline import network as net
from spinline.jetprofile import PowerLaw

PHI, KUHN, RADIUS = 0.0444, 1e-9, 125e-6
JET = PowerLaw(radius=RADIUS, flow_rate=3.2e-6 / 3600, k=1.0, beta=0.47)
LENGTH = 40.0
SPACING = KUHN / (PHI * RADIUS)
LAWS = ("linear", "lattice", "langevin", "fene")


def timed(function, *arguments, **named):
    begin = time.perf_counter()
    value = function(*arguments, **named)
    return value, time.perf_counter() - begin


def largest_difference(a, b):
    """Largest relative difference where both are known."""
    both = np.isfinite(a) & np.isfinite(b)
    return float(np.max(np.abs(a[both] / b[both] - 1)))


def warm_up():
    flow = net.Flow.from_jet(JET, 4.0)
    for law in LAWS:
        net.run_chain(net.Chain(flow=flow, spacing=0.1, coupling=100.0, law=law, contour=20.0), 1.0)


def whole():
    """One transit of the PEO network, every bead, 1 core; error against rtol = 1e-5, linear springs."""
    flow = net.Flow.from_jet(JET, LENGTH)
    transit = float(flow.residence_time(LENGTH))
    s = np.linspace(0.5, 30, 600)
    print(f"whole network: h = {SPACING:.6g}, transit {transit:.6g}, {transit / SPACING:.0f} beads")
    for law in LAWS:
        for alpha in (1e3, 2e4, 1e6) if law == "linear" else (2e4,):
            chain = net.Chain(flow=flow, spacing=SPACING, coupling=alpha, law=law, contour=1 / PHI)
            run, seconds = timed(net.run_chain, chain, transit, rtol=1e-4)
            error = np.nan
            if law == "linear" and alpha > 1e3:  # at 1e3 the tighter run takes minutes
                tight = net.run_chain(chain, transit, rtol=1e-5)
                error = largest_difference(run.stretch_at(s), tight.stretch_at(s))
            state = run.state
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            print(
                f"  {law:9s} alpha_v {alpha:7.0e}: {seconds:7.2f} s, {state.steps:5d} steps, {state.rejected:3d} rejected, "
                f"{state.iterations:6d} iterations, {state.positions.size} beads, error {error:.1e}, {memory:.0f} MB",
                flush=True,
            )


def growth():
    """Cost against the number of beads at one tolerance."""
    flow = net.Flow.from_jet(JET, LENGTH)
    transit = float(flow.residence_time(LENGTH))
    numbers, cost = np.array([1e3, 1e4, 1e5, 1e6]), []
    for n in numbers:
        chain = net.Chain(flow=flow, spacing=transit / n, coupling=2e4)
        seconds = []
        for _ in range(3 if n < 1e6 else 1):
            run, took = timed(net.run_chain, chain, 1.0, start="affine", rtol=1e-4)
            seconds.append(took)
        cost.append(min(seconds))
        each = 1e9 * cost[-1] / run.state.steps / run.state.positions.size
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(
            f"  N = {n:.0e}: {cost[-1]:.3g} s, {run.state.steps} steps, {each:.0f} ns per bead and step, {memory:.0f} MB",
            flush=True,
        )
    print(f"  exponent 1e3-1e6: {np.polyfit(np.log(numbers), np.log(cost), 1)[0]:.3f}")


class Plain:
    """The same chain as a plain system of equations; x from the far end, both ends free or the near one dragged."""

    def __init__(self, h, alpha):
        self.h, self.pull = h, 1 / (alpha * h)

    def velocity(self, x):
        return np.maximum(x, 1.0) ** 0.94

    def rates(self, t, x):
        w = np.concatenate(([1.0], (x[:-1] - x[1:]) / self.h, [self.behind(t, x)]))
        return self.velocity(x) + self.pull * (w[:-1] - w[1:])

    def behind(self, t, x):
        return 1.0

    def bands(self, x):
        k = self.pull / self.h
        diagonal = np.where(x > 1, 0.94 * np.maximum(x, 1.0) ** -0.06, 0.0) - 2 * k
        diagonal[0] += k
        diagonal[-1] += self.last * k
        return k, diagonal

    last = 1.0

    def sparse(self, t, x):
        k, diagonal = self.bands(x)
        side = np.full(x.size - 1, k)
        return diags([side, diagonal, side], [-1, 0, 1], format="csc")

    def packed(self, t, x):
        k, diagonal = self.bands(x)
        return np.stack([np.full(x.size, k), diagonal, np.full(x.size, k)])


class Entering(Plain):
    """Between two entries: the bead behind is dragged at V = 1 to x = 0 at the time `next`."""

    last = 0.0
    next = 0.0

    def behind(self, t, x):
        return (x[-1] - (t - self.next)) / self.h


def cheapest(solve, exact, target):
    """Loosest tolerance whose error is below the target, and its time (best of two)."""
    for rtol in 10.0 ** -np.arange(1, 10.5, 0.5):
        x, seconds = timed(solve, rtol)
        w, ref = x[:-1] - x[1:], exact[:-1] - exact[1:]
        error = float(np.max(np.abs(w / ref - 1)))
        if error <= target:
            return rtol, error, min(seconds, timed(solve, rtol)[1])
    return np.nan, error, np.nan


def against_scipy():
    """Fixed beads, N = 1e4 of a settled chain let loose at the nozzle: cheapest run of each solver with error <= 1e-4."""
    flow = net.Flow.from_jet(JET, LENGTH)
    n, until, target = 10_000, 0.3, 1e-4
    h = float(flow.residence_time(20.0)) / n
    for alpha in (200.0, 2e3, 2e4):
        entering = net.Chain(flow=flow, spacing=h, coupling=alpha)
        begin = net.run_chain(entering, n * h, rtol=1e-5).state.positions[:-2]
        plain = Plain(h, alpha)
        chain = net.Chain(flow=flow, spacing=h, coupling=alpha, entry=False)
        start = net.start_from(chain, begin)

        def ours(rtol, chain=chain, start=start):
            return net.run_chain(chain, until, start=start, rtol=rtol, accurate_to=LENGTH).state.positions

        def bdf(rtol, plain=plain, begin=begin):
            out = solve_ivp(plain.rates, (0, until), begin, "BDF", rtol=rtol, atol=rtol * h, jac=plain.sparse)
            return out.y[:, -1]

        def lsoda(rtol, plain=plain, begin=begin):
            out = solve_ivp(
                plain.rates, (0, until), begin, "LSODA", rtol=rtol, atol=rtol * h, lband=1, uband=1, jac=plain.packed
            )
            return out.y[:, -1]

        exact = ours(3e-9)
        check = bdf(1e-9)
        agree = float(np.max(np.abs((check[:-1] - check[1:]) / (exact[:-1] - exact[1:]) - 1)))
        mine = cheapest(ours, exact, target)
        print(
            f"  fixed, alpha_v {alpha:g}: spinline {mine[2]:.3g} s at rtol {mine[0]:.0e}, error {mine[1]:.1e}; "
            f"exact agrees with BDF to {agree:.1e}"
        )
        for name, solve in (("BDF", bdf), ("LSODA", lsoda)):
            other = cheapest(solve, exact, target)
            print(
                f"    {name:5s} {other[2]:.3g} s at rtol {other[0]:.0e}, error {other[1]:.1e}: "
                f"{other[2] / mine[2]:.1f} times",
                flush=True,
            )


def entering():
    """Beads entering, N about 1e4: BDF and LSODA started anew at each of 400 entries."""
    flow = net.Flow.from_jet(JET, LENGTH)
    n, entries, target, alpha = 10_000, 400, 1e-4, 2e3
    h = float(flow.residence_time(20.0)) / n
    chain = net.Chain(flow=flow, spacing=h, coupling=alpha)
    settled = net.run_chain(chain, n * h, rtol=1e-5).state
    until = settled.time + entries * h
    first = settled.positions[:-1].size

    def ours(rtol):
        begin = net.ChainState(
            **{k: v for k, v in vars(settled).items() if k not in ("next_step", "span")}, span=-1, next_step=0.0
        )
        return net.run_chain(chain, until, start=begin, rtol=rtol).state.positions[:first]

    def restarted(method):
        def solve(rtol):
            x, system = settled.positions[:-1].copy(), Entering(h, alpha)
            named = {"jac": system.sparse} if method == "BDF" else {"jac": system.packed, "lband": 1, "uband": 1}
            for i in range(entries):
                span = (settled.time + i * h, settled.time + (i + 1) * h)
                system.next = span[1]
                x = solve_ivp(system.rates, span, x, method, rtol=rtol, atol=rtol * h, **named).y[:, -1]
                x = np.append(x, 0.0)
            return x[:first]

        return solve

    exact = ours(1e-8)
    mine = cheapest(ours, exact, target)
    print(f"  entering, alpha_v {alpha:g}: spinline {mine[2]:.3g} s at rtol {mine[0]:.0e}, error {mine[1]:.1e}")
    for name in ("BDF", "LSODA"):
        other = cheapest(restarted(name), exact, target)
        print(
            f"    {name:5s} {other[2]:.3g} s at rtol {other[0]:.0e}, error {other[1]:.1e}: {other[2] / mine[2]:.1f} times",
            flush=True,
        )


def draws(number=2000):
    """Random chains: how many end in a named error."""
    rng = np.random.default_rng(5)
    failed = 0
    begin = time.perf_counter()
    for i in range(number):
        jet = PowerLaw(radius=RADIUS, flow_rate=1e-9, k=float(rng.uniform(0.6, 1.5)), beta=float(rng.uniform(0.3, 0.7)))
        chain = net.Chain(
            flow=net.Flow.from_jet(jet, float(rng.uniform(3, 30)), rtol=1e-5),
            spacing=float(10 ** rng.uniform(-1.7, -0.5)),
            coupling=float(10 ** rng.uniform(-3, 15)),
            inertia=float(rng.choice([0.0, 10 ** rng.uniform(-12, 3)])),
            law=LAWS[i % 4],
            contour=float(10 ** rng.uniform(0.3, 2)),
        )
        try:
            state = net.run_chain(chain, float(rng.uniform(1, 6)), rtol=1e-2, most_steps=20_000).state
        except net.ChainError as error:
            failed += 1
            print(f"    {chain.law} alpha_v {chain.coupling:.1e} I {chain.inertia:.1e}: {str(error)[:90]}")
            continue
        if not (np.isfinite(state.positions).all() and np.isfinite(state.velocities).all()):
            raise SystemExit(f"draw {i} is not finite")
    print(f"  {number} random draws: {failed} named errors, {time.perf_counter() - begin:.0f} s")


PARTS = {"whole": whole, "growth": growth, "scipy": against_scipy, "entering": entering, "draws": draws}

if __name__ == "__main__":
    warm_up()
    for part in sys.argv[1:] or PARTS:
        print(f"{part}: {PARTS[part].__doc__}")
        PARTS[part]()
