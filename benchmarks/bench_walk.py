"""Speed of the random walk against its own generator, plain Python and numpy, and what its numbers are worth.

Everything runs on one core, in one process, on the same strand: forces that vary from segment to segment. Each rate is
the best of a few repeats. numpy appears twice: as one would write it, and with 32-bit numbers and blocks that stay in
cache.

    python benchmarks/bench_walk.py [--segments 400] [--strands 1000000] [--statistics]

--statistics adds the chi-squared of 20 seeds of 1e6 strands against the exact law, and the coverage of the stated 95 %
intervals over 1,000 replicates.
"""

import argparse
import random
import time

import numpy as np
from scipy import stats

import spinline.network as net
from spinline.network import _step_kernels
from spinline.network.walk.strand import step_probabilities


def best(function, repeats=5):
    function()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def varying(segments):
    """Tension that rises from 0.5 to 3 along the strand."""
    forces = np.full((segments, 3), 0.15)
    forces[:, 2] = np.linspace(0.5, 3.0, segments)
    return net.varying_strand(forces)


def plain_python(cumulative, strands):
    ends = []
    for _ in range(strands):
        place = [0, 0, 0]
        for row in cumulative:
            u = random.random()
            direction = 0
            while u >= row[direction] and direction < 5:
                direction += 1
            place[direction // 2] += 1 - 2 * (direction % 2)
        ends.append(place)
    return ends


def numpy_usual(cumulative, strands, rng):
    """One monomer at a time for all strands, a table of directions."""
    moves = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    place = np.zeros((strands, 3), dtype=np.int64)
    for row in cumulative:
        place += moves[np.searchsorted(row[:5], rng.random(strands), side="right")]
    return place


def numpy_tuned(cumulative, strands, rng, block=16_384):
    """32-bit numbers, counters instead of directions, in-place, blocks in cache."""
    table = np.round(cumulative[:, :5] * 2**32).clip(0, 2**32 - 1).astype(np.uint32)
    out = np.zeros((5, strands), dtype=np.int32)
    for start in range(0, strands, block):
        part = out[:, start : start + block]
        below = np.empty(part.shape[1], dtype=bool)
        for row in table:
            u = rng.integers(0, 2**32, part.shape[1], dtype=np.uint32)
            for k in range(5):
                np.less(u, row[k], out=below)
                part[k] += below
    return out


def speed(segments, strands):
    strand = varying(segments)
    steps = strands * segments
    p = step_probabilities(strand.forces)
    cumulative = np.cumsum(p, axis=1)
    bare = np.empty(strands, np.int64)
    rows = [
        ("bare generator", steps / best(lambda: _step_kernels.generator_alone(np.uint64(1), segments, bare))),
        ("walk (32-bit thresholds)", steps / best(lambda: net.sample_strands(strand, strands, 1))),
    ]
    few = max(1, 200_000 // segments)
    rows.append(("plain Python", few * segments / best(lambda: plain_python(cumulative.tolist(), few), 3)))
    rng = np.random.default_rng(1)
    some = max(16_384, 8_000_000 // segments)
    rows.append(("numpy, as usual", some * segments / best(lambda: numpy_usual(cumulative, some, rng), 3)))
    fast = np.random.Generator(np.random.SFC64(1))
    rows.append(("numpy, tuned (SFC64)", some * segments / best(lambda: numpy_tuned(cumulative, some, fast), 3)))
    walk = rows[1][1]
    print(f"\n{segments} segments, {strands} strands, forces that vary, one core")
    print(f"{'':28s}{'steps/s':>12s}{'walk over it':>15s}")
    for name, rate in rows:
        print(f"{name:28s}{rate:12.3g}{walk / rate:15.3g}")
    uniform = net.affine_strand(20.0, 0.05)
    own = best(lambda: net.sample_strands(uniform, strands, 1), 3)
    weights = step_probabilities(uniform.forces)[0]
    theirs = best(lambda: rng.multinomial(uniform.segments, weights, size=strands), 3)
    print(
        f"\nuniform force, multinomial: {strands / own:.3g} strands/s; numpy's Generator.multinomial {strands / theirs:.3g}"
    )
    for count in (1, 2):
        seconds = best(lambda n=count: net.sample_strands(strand, strands, 1, threads=n), 3)
        print(f"{count} thread(s): {steps / seconds:.3g} steps/s")
    seconds = best(lambda: net.exact_law(uniform), 5)
    print(f"exact axial law of 400 segments: {1e3 * seconds:.3g} ms")


def gains(strands):
    functions = {
        "length |R|": lambda r: np.sqrt((r**2).sum(axis=1)),
        "cos^2 of R to the axis": lambda r: r[:, 2] ** 2 / np.maximum((r**2).sum(axis=1), 1),
        "mean + 2 sigma passed": None,
    }
    print(f"\ncontrol variates, phi = 0.05, {strands} strands: variance of the plain mean over that with controls")
    print(f"{'':28s}" + "".join(f"{f'V = {v:g}':>12s}" for v in (1.0, 5.0, 20.0)))
    for name, function in functions.items():
        row = []
        for v in (1.0, 5.0, 20.0):
            strand = net.affine_strand(v, 0.05)
            moments = net.walk_moments(strand)
            level = moments.mean[2] + 2 * np.sqrt(moments.covariance[2, 2])
            chosen = function or (lambda r, level=level: (r[:, 2] > level).astype(float))
            row.append(net.sample_average(net.sample_strands(strand, strands, 1), chosen).gain)
        print(f"{name:28s}" + "".join(f"{gain:12.3g}" for gain in row))


def chi_squared(counts, probability, total):
    """Of bins merged from both tails until each expects ten."""
    expected = probability * total
    good = expected >= 10
    low, high = good.argmax(), good.size - good[::-1].argmax()
    seen = np.concatenate([[counts[:low].sum()], counts[low:high], [counts[high:].sum()]])
    due = np.concatenate([[expected[:low].sum()], expected[low:high], [expected[high:].sum()]])
    keep = due > 1
    return stats.chi2.sf(((seen - due)[keep] ** 2 / due[keep]).sum(), keep.sum() - 1)


def statistics():
    print("\nchi-squared against the exact law, 20 seeds x 1e6 strands: smallest p (axis x, axis z)")
    cases = {
        "multinomial, phi = 0.05, V = 20": (net.affine_strand(20.0, 0.05), "auto"),
        "steps, phi = 0.05, V = 20": (net.affine_strand(20.0, 0.05), "steps"),
        "multinomial, phi = 0.05, V = 1": (net.affine_strand(1.0, 0.05), "auto"),
        "steps, forces that vary": (varying(400), "auto"),
    }
    for name, (strand, method) in cases.items():
        smallest = []
        for axis, column in (("x", 0), ("z", 2)):
            law = net.exact_law(strand, (axis,))
            ps = []
            for seed in range(20):
                ends = net.sample_strands(strand, 1_000_000, seed, method=method).end_to_end[:, column]
                counts = np.bincount(ends - law.values[0][0], minlength=law.probability.size)
                ps.append(chi_squared(counts, law.probability, ends.size))
            smallest.append((min(ps), stats.kstest(ps, "uniform").pvalue))
        print(f"{name:36s}" + "   ".join(f"{p:.3g} (uniform: {u:.2g})" for p, u in smallest))
    print("\ncoverage of the 95 % intervals, 1,000 replicates of 2,000 strands (95 +- 1.4 expected)")
    for name, (strand, method) in cases.items():
        print(f"{name:36s}" + "  ".join(f"{k} {v:.1%}" for k, v in coverage(strand, method).items()))


def coverage(strand, method, replicates=1000, size=2000):
    exact = net.walk_moments(strand)
    truth = {}
    hits = dict.fromkeys(("x", "z", "var x", "var z", "O", "|R|, controls"), 0)
    big = net.sample_strands(strand, 4_000_000, 10**6, method=method)

    def length(r):
        return np.sqrt((r**2).sum(axis=1))

    truth["length"] = net.sample_average(big, length).value
    everything = net.sample_strands(strand, replicates * size, 77, method=method)
    for i in range(replicates):
        rows = slice(i * size, (i + 1) * size)
        part = net.StrandSample(
            strand, everything.end_to_end[rows], everything.axial_steps[rows], everything.method, 77, i * size
        )
        m = net.sample_moments(part)
        average = net.sample_average(part, length)
        for key, got, error, true in (
            ("x", m.mean[0], m.mean_error[0], exact.mean[0]),
            ("z", m.mean[2], m.mean_error[2], exact.mean[2]),
            ("var x", m.covariance[0, 0], m.covariance_error[0, 0], exact.covariance[0, 0]),
            ("var z", m.covariance[2, 2], m.covariance_error[2, 2], exact.covariance[2, 2]),
            ("O", m.orientation, m.orientation_error, exact.orientation),
            ("|R|, controls", average.value, average.error, truth["length"]),
        ):
            hits[key] += abs(got - true) <= 1.959964 * error
    return {key: value / replicates for key, value in hits.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--segments", type=int, default=400)
    parser.add_argument("--strands", type=int, default=1_000_000)
    parser.add_argument("--statistics", action="store_true")
    arguments = parser.parse_args()
    speed(arguments.segments, arguments.strands)
    gains(arguments.strands)
    if arguments.statistics:
        statistics()


if __name__ == "__main__":
    main()
