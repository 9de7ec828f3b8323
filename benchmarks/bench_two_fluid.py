"""Cost of the two-fluid network, in processor time: 401 stations along a straight jet, and a bead jet of 112 elements.

    python benchmarks/bench_two_fluid.py

Asserted: 50 ms for 401 stations of `peo5-water` by every force law and end, 1 s along the bundled JETSPIN run (V to 210, eps
to 6e-6), whatever the law and the relaxation time; endless relaxation is the manifold there. The least of five, compiled, by
the solver as a run calls it. Writes bench_two_fluid.json.
"""

import json
import time
import warnings
from pathlib import Path

import numpy as np

import spinline as sl
from spinline.base.errors import SpinlineWarning
from spinline.network.tension import Tension
from spinline.network.two_fluid import two_fluid_network
from spinline.network_models.steady import course_of
from spinline.setup.context import Context

LAWS = ("linear", "lattice", "langevin", "fene")
ENDS = ("take-up", "extended", "free")
TIMES = (1e-3, 0.02, 0.2)  # s
STRAIGHT, BEADS = 50.0, 1000.0  # ms


def course(name, law, end="take-up"):
    scene = sl.load_scene(
        name, ["network.model=two-fluid", f"network.force_law={law}", "solution.relaxation_time=20 ms"]
    )
    context = Context(scene)
    return course_of(context), Tension.of(law, context.rest.full_stretch)


def spent(seen, law, theta, end):
    """Processor time of one network, ms, the least of five."""
    times = []
    for _ in range(6):  # the first may compile
        began = time.process_time()
        two_fluid_network(
            seen.profile,
            seen.length,
            coupling=seen.coupling,
            relaxation_time=theta * seen.pace if np.isfinite(theta) else np.inf,
            law=law,
            end=end,
            stations=seen.stations,
            breaks=seen.breaks,
            known_to=seen.known_to,
            rtol=1e-5,
        )
        times.append(1e3 * (time.process_time() - began))
    return float(min(times[1:]))


def main():
    warnings.simplefilter("ignore", SpinlineWarning)
    found = {"straight": {}, "beads": {}}
    for law in LAWS:
        seen, tension = course("peo5-water", law)
        assert seen.stations.size >= 401
        for end in ENDS:
            worst = max(spent(seen, tension, theta, end) for theta in TIMES)
            found["straight"][f"{law}, {end}"] = round(worst, 1)
    for law in LAWS:
        seen, tension = course("pvp-jetspin", law)
        for theta in (*TIMES, float("inf")):
            found["beads"][f"{law}, theta = {theta:g} s"] = round(spent(seen, tension, theta, "take-up"), 1)
    for kind in found:
        slowest = max(found[kind], key=found[kind].get)
        print(f"{kind}: at most {found[kind][slowest]:.1f} ms ({slowest})", flush=True)
    Path(__file__).with_suffix(".json").write_text(json.dumps(found, indent=1) + "\n")
    for kind, most in (("straight", STRAIGHT), ("beads", BEADS)):
        over = {name: value for name, value in found[kind].items() if value > most}
        assert not over, f"{kind}: {over}"


if __name__ == "__main__":
    main()
