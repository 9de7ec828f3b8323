"""Steady network at finite coupling: error against cost, and against scipy's solvers on the same problem.

Run: ``python benchmarks/bench_manifold.py``. The jet is ``V = max(s, 1)^0.94`` over 40 radii. Errors are the largest relative
ones of w at 200 places away from the free end, against the same march at rtol = 1e-13.
"""

import time

import numpy as np
from scipy.integrate import solve_ivp

from spinline.network import Tension, eq33, steady_network

LENGTH, BETA = 40.0, 0.47
PLACES = np.linspace(1.0, 30.0, 200)


def profile(s: np.ndarray) -> np.ndarray:
    """V(s)."""
    return np.maximum(s, 1.0) ** (2 * BETA)


def scipy_march(alpha: float, method: str, rtol: float) -> np.ndarray:
    """The same march by scipy, upstream, in ln w; dense output at the places."""
    march = solve_ivp(
        lambda x, y: [alpha * (float(profile(LENGTH - x)) * np.exp(-2 * y[0]) - np.exp(-y[0]))],
        (0, LENGTH - 1.0),
        [0.0],
        method=method,
        rtol=rtol,
        atol=rtol,
        dense_output=True,
    )
    return np.exp(march.sol(LENGTH - PLACES)[0])


def best(function, repeats: int = 3):
    """Result and the shortest of several times, s."""
    shortest, result = np.inf, None
    for _ in range(repeats):
        start = time.process_time()
        result = function()
        shortest = min(shortest, time.process_time() - start)
    return result, shortest


def at_equal_error() -> None:
    """The march (both of them: the far end is judged too) against LSODA at the loosest tolerance that is no less exact."""
    print("processor time of LSODA over that of the march, LSODA no less exact; over 1: the march is faster")
    for alpha in (1e2, 1e4, 1e8, 1e12):
        exact = steady_network(profile, LENGTH, coupling=alpha, spring=1.0, breaks=[1.0], rtol=1e-13).stretch(PLACES)
        for rtol in (1e-4, 1e-7, 1e-10):
            network, cost = best(
                lambda a=alpha, r=rtol: steady_network(profile, LENGTH, coupling=a, spring=1.0, breaks=[1.0], rtol=r), 9
            )
            error = np.abs(network.stretch(PLACES) / exact - 1).max()
            for other in (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13):
                found, price = best(lambda a=alpha, r=other: scipy_march(a, "LSODA", r), 5)
                apart = np.abs(found / exact - 1).max()
                if apart <= error:
                    break
            reached = "" if apart <= error else f", LSODA reaches {apart:.1e} at best"
            print(f"  alpha_v = {alpha:7.0e}, error {error:8.1e}: {price / cost:5.2f}{reached}")


def main() -> None:
    at_equal_error()
    for alpha in (1e2, 1e4, 1e8, 1e12):
        reference = steady_network(profile, LENGTH, coupling=alpha, spring=1.0, breaks=[1.0], rtol=1e-13).stretch(
            PLACES
        )
        print(f"alpha_v = {alpha:g}, linear springs")
        for rtol in (1e-4, 1e-7, 1e-10, 1e-12):
            network, cost = best(
                lambda a=alpha, r=rtol: steady_network(profile, LENGTH, coupling=a, spring=1.0, breaks=[1.0], rtol=r)
            )
            error = np.abs(network.stretch(PLACES) / reference - 1).max()
            print(
                f"  march, rtol {rtol:7.0e}: error {error:8.1e}  {1e3 * cost:7.1f} ms  {len(network.edges) - 1} panels"
            )
        for method in ("Radau", "LSODA", "BDF"):
            for rtol in (1e-7, 1e-10):
                other, cost = best(lambda a=alpha, m=method, r=rtol: scipy_march(a, m, r), 1)
                error = np.abs(other / reference - 1).max()
                print(f"  scipy {method}, rtol {rtol:7.0e}: error {error:8.1e}  {1e3 * cost:7.1f} ms")
        slope = 2 * BETA * PLACES ** (2 * BETA - 1)
        error = np.abs(eq33(profile(PLACES), slope, 1 / alpha) / reference - 1).max()
        print(f"  Eq. (33): error {error:8.1e};  affine: error {np.abs(profile(PLACES) / reference - 1).max():8.1e}")
    print("locked networks, V_S = 20")
    for law in ("lattice", "langevin", "fene"):
        for alpha in (1e4, 1e12):
            tension = Tension.of(law, 20.0)
            network, cost = best(
                lambda a=alpha, t=tension: steady_network(profile, LENGTH, coupling=a, spring=1.0, law=t, breaks=[1.0])
            )
            print(f"  {law:9s} alpha_v = {alpha:7.0e}: {1e3 * cost:6.1f} ms, locked from s = {network.locked_from:.7f}")


if __name__ == "__main__":
    main()
