"""Closed forms of the affine network: error and time, against the formulas as printed.

Run: ``python benchmarks/bench_closed_forms.py``. Prints, for each quantity, the largest relative error against 50 digits
over random points (phi in [1e-6, 0.9], V in [1, 1e9]) and the time per point, for this package and for the printed
formulas in plain numpy, measured in one run.
"""

import time

import mpmath as mp
import numpy as np

from spinline import network as net

mp.mp.dps = 50


def printed(v: np.ndarray, phi: np.ndarray) -> dict[str, np.ndarray]:
    """Eqs. (34)-(40) as one would type them."""
    with np.errstate(over="ignore", invalid="ignore"):
        f0 = 3 * phi
        fz = f0 * v
        z = np.cosh(fz) + 2 * np.cosh(f0)
        return {
            "relative_extension": np.sinh(fz) / z,
            "radial_contraction": np.sinh(f0) / z / phi,
            "orientation": (3 * np.cosh(fz) / z - 1) / 2,
        }


def exact(v: float, phi: float) -> dict[str, mp.mpf]:
    """The same in 50 digits."""
    f0 = 3 * mp.mpf(phi)
    fz = f0 * mp.mpf(v)
    z = mp.cosh(fz) + 2 * mp.cosh(f0)
    return {
        "relative_extension": mp.sinh(fz) / z,
        "radial_contraction": mp.sinh(f0) / z / mp.mpf(phi),
        "orientation": (mp.cosh(fz) - mp.cosh(f0)) / z,
    }


def best(function, repeats: int = 5) -> float:
    """Shortest of several runs, s."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def main() -> None:
    rng = np.random.default_rng(1)
    n = 2000
    phi = np.exp(rng.uniform(np.log(1e-6), np.log(0.9), n))
    v = np.exp(rng.uniform(0, np.log(1e9), n))
    ours, theirs = net.random_walk(v, phi), printed(v, phi)
    print(f"{'quantity':22s}{'error':>12s}{'as printed':>14s}{'printed fails':>16s}")
    for name in theirs:
        worst, worst_printed, failed = 0.0, 0.0, 0
        for i in range(n):
            truth = exact(v[i], phi[i])[name]
            if truth < mp.mpf("1e-300"):
                continue
            worst = max(worst, float(abs(mp.mpf(float(ours[name][i])) / truth - 1)))
            other = theirs[name][i]
            if np.isfinite(other):
                worst_printed = max(worst_printed, float(abs(mp.mpf(float(other)) / truth - 1)))
            else:
                failed += 1
        print(f"{name:22s}{worst:12.1e}{worst_printed:14.1e}{failed:10d}/{n}")
    big_v, big_phi = np.resize(v, 1_000_000), np.resize(phi, 1_000_000)
    a = best(lambda: net.random_walk(big_v, big_phi))
    b = best(lambda: printed(big_v, big_phi))
    c = best(lambda: net.affine_network(big_v, 0.05))
    print(f"random_walk {1e9 * a / 1e6:.0f} ns a point, as printed {1e9 * b / 1e6:.0f} ns (ratio {a / b:.1f})")
    print(f"affine_network, everything at once: {1e9 * c / 1e6:.0f} ns a point")


if __name__ == "__main__":
    main()
