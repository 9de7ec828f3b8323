"""Speed and error of the bead chain: whole network, growth with N, against scipy's stiff solvers.

Every ratio is measured in one run. Errors are of the local stretch, relative, the largest over stations or strands.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python benchmarks/bench_chain.py [whole] [growth] [scipy] [entering]

With more threads those of BLAS go on spinning after scipy's solvers, and are counted as ours.
"""

import resource
import sys
import time
from dataclasses import replace

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


def warm_up():
    flow = net.Flow.from_jet(JET, 4.0)
    for law in LAWS:
        net.run_chain(net.Chain(flow=flow, spacing=0.1, coupling=100.0, law=law, contour=20.0), 1.0)


def whole():
    """One transit of the PEO network from the empty jet, every bead, 1 core; error of 1e-4 against 1e-5 as rtol.

    rms and max are over 600 stations; the largest errors sit at the front of locking.
    """
    flow = net.Flow.from_jet(JET, LENGTH)
    transit = float(flow.residence_time(LENGTH))
    s = np.linspace(0.5, 30, 600)
    print(f"whole network: h = {SPACING:.6g}, transit {transit:.6g}, {transit / SPACING:.0f} beads")
    for law in LAWS:
        for alpha in (1e3, 2e4, 1e6) if law == "linear" else (2e4,):
            chain = net.Chain(flow=flow, spacing=SPACING, coupling=alpha, law=law, contour=1 / PHI)
            begin = time.process_time()
            run = net.run_chain(chain, transit, rtol=1e-4)
            seconds = time.process_time() - begin
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            state = run.state
            print(
                f"  {law:9s} alpha_v {alpha:7.0e}: {seconds:7.2f} s CPU, {state.steps:5d} steps, {state.rejected:3d} "
                f"rejected, {state.iterations:6d} iterations, {state.positions.size} beads, {memory:.0f} MB",
                flush=True,
            )
            tight = net.run_chain(chain, transit, rtol=1e-5)
            error = run.stretch_at(s) / tight.stretch_at(s) - 1
            error = error[np.isfinite(error)]
            print(f"      error: rms {np.sqrt(np.mean(error**2)):.1e}, max {np.abs(error).max():.1e}", flush=True)


def growth():
    """Cost against the number of beads at one tolerance."""
    flow = net.Flow.from_jet(JET, LENGTH)
    transit = float(flow.residence_time(LENGTH))
    numbers, cost = np.array([1e3, 1e4, 1e5, 1e6]), []
    for n in numbers:
        chain = net.Chain(flow=flow, spacing=transit / n, coupling=2e4)
        seconds = []
        for _ in range(3 if n < 1e6 else 1):
            begin = time.process_time()
            run = net.run_chain(chain, 1.0, start="affine", rtol=1e-4)
            seconds.append(time.process_time() - begin)
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


def misses(x, exact):
    """Error of the stretch, relative: root mean square over the strands, and largest."""
    error = np.abs((x[:-1] - x[1:]) / (exact[:-1] - exact[1:]) - 1)
    return float(np.sqrt(np.mean(error**2))), float(error.max())


def work_precision(solve, exact, tolerances):
    """Error in both norms and CPU time (best of three) at each tolerance."""
    points = []
    for rtol in tolerances:
        seconds = []
        for _ in range(3):
            begin = time.process_time()
            x = solve(rtol)
            seconds.append(time.process_time() - begin)
            if seconds[-1] > 2:
                break
        points.append((rtol, *misses(x, exact), min(seconds)))
        if points[-1][2] <= 0.5 * TARGET:
            break
    return points


def cheapest(points, norm):
    """Cheapest tolerance with an error below the target in that norm."""
    good = [p for p in points if p[norm] <= TARGET]
    return min(good, key=lambda p: p[3]) if good else (np.nan,) * 4


def compare(title, ours, others, exact, tolerances):
    """Cheapest run of each solver with error <= 1e-4, in the same norm for all."""
    mine = work_precision(ours, exact, 10.0 ** -np.arange(1, 8.5, 0.5))
    found = {name: work_precision(solve, exact, tolerances) for name, solve in others.items()}
    for norm, label in ((1, "rms"), (2, "max")):
        rtol, *errors, seconds = cheapest(mine, norm)
        text = f"  {title}, {label}: spinline {1e3 * seconds:.1f} ms at rtol {rtol:.0e} (error {errors[norm - 1]:.1e})"
        for name, points in found.items():
            rtol, *errors, took = cheapest(points, norm)
            text += f"; {name} {1e3 * took:.1f} ms at {rtol:.1e} ({errors[norm - 1]:.1e}): {took / seconds:.1f} times"
        print(text, flush=True)


TARGET = 1e-4


def against_scipy():
    """Fixed beads, N = 1e4: a settled chain let loose at the nozzle, and one that a weaker jet has settled (k = 0.9).

    Exact: scipy's Radau at rtol 1e-9. Spinline's time includes its reference speed, scipy's has the analytic Jacobian.
    """
    flow = net.Flow.from_jet(JET, LENGTH)
    weak = net.Flow.from_jet(PowerLaw(radius=RADIUS, flow_rate=3.2e-6 / 3600, k=0.9, beta=0.47), LENGTH)
    n, until = 10_000, 0.3
    h = float(flow.residence_time(20.0)) / n
    for settled, jet in (("settled", flow), ("unsettled", weak)):
        for alpha in (200.0, 2e3, 2e4):
            entering = net.Chain(flow=jet, spacing=h, coupling=alpha)
            begin = net.run_chain(entering, n * h, rtol=1e-6).state.positions[:-2]
            plain = Plain(h, alpha)
            chain = net.Chain(flow=flow, spacing=h, coupling=alpha, entry=False)
            start = net.start_from(chain, begin)

            def ours(rtol, chain=chain, start=start):
                return net.run_chain(chain, until, start=start, rtol=rtol, accurate_to=LENGTH).state.positions

            def scipys(method, rtol, plain=plain, begin=begin, **named):
                out = solve_ivp(plain.rates, (0, until), begin, method, rtol=rtol, atol=rtol * h, **named)
                return out.y[:, -1]

            exact = solve_ivp(plain.rates, (0, until), begin, "Radau", rtol=1e-9, atol=1e-10 * h, jac=plain.sparse).y[
                :, -1
            ]
            others = {
                "BDF": lambda rtol, f=scipys, p=plain: f("BDF", rtol, jac=p.sparse),
                "LSODA": lambda rtol, f=scipys, p=plain: f("LSODA", rtol, jac=p.packed, lband=1, uband=1),
            }
            compare(f"{settled}, alpha_v {alpha:g}", ours, others, exact, 10.0 ** -np.arange(3, 9.1, 0.25))


def entering():
    """Beads entering, N about 1e4: BDF and LSODA started anew at each of 400 entries."""
    flow = net.Flow.from_jet(JET, LENGTH)
    n, entries, alpha = 10_000, 400, 2e3
    h = float(flow.residence_time(20.0)) / n
    chain = net.Chain(flow=flow, spacing=h, coupling=alpha)
    settled = net.run_chain(chain, n * h, rtol=1e-6).state
    until = settled.time + entries * h
    first = settled.positions[:-1].size

    def ours(rtol):
        begin = replace(settled, span=-1, next_step=0.0)
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

    exact = restarted("LSODA")(1e-8)
    others = {"BDF": restarted("BDF"), "LSODA": restarted("LSODA")}
    compare(f"alpha_v {alpha:g}", ours, others, exact, 10.0 ** -np.arange(1, 6.1, 0.5))


PARTS = {"whole": whole, "growth": growth, "scipy": against_scipy, "entering": entering}

if __name__ == "__main__":
    warm_up()
    for part in sys.argv[1:] or PARTS:
        print(f"{part}: {PARTS[part].__doc__}")
        PARTS[part]()
