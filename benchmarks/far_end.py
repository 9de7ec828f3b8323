"""The two marches of random elastic jets against the same jets a thousand times longer.

    python benchmarks/far_end.py [jets]

V = s^(2 beta), linear springs. Where the jet has a slow root at its end the marches from a free end and from the root must
bracket the answer; where it has none, the answer must be flagged. Writes far_end.json.
"""

import json
import sys
from pathlib import Path

import numpy as np

from spinline.network import far_end, steady_network
from spinline.network.tension import Tension


def judge(rng):
    """Outcome of one jet."""
    beta, eps, length = rng.uniform(0.25, 0.49), 10 ** rng.uniform(-3, 0), 10 ** rng.uniform(1, 2.5)

    def profile(s):
        return np.maximum(s, 1.0) ** (2 * beta)

    s = np.linspace(0, length, 40)
    more = {"coupling": 1 / eps, "spring": 1.0, "breaks": [1.0], "stations": s}
    free = steady_network(profile, length, **more)
    step = 1e-5 * length
    v, ahead = profile(np.array([length, length + step]))
    root = far_end.slow_root(float(v), float(ahead - v) / step, eps, Tension.linear())
    if np.isnan(root):
        return "no root, flagged" if free.far_end_effect > 0.01 else "no root, not flagged"
    truth = steady_network(profile, 1000 * length, **more).stretch(s)
    low = free.stretch(s)
    # the march from the root itself: by the effect, the farthest that it lies from the first anywhere
    reach, far_end.elastic_reach = far_end.elastic_reach, lambda profile, length, eps, law: length
    try:
        high = steady_network(profile, length, end="take-up", known_to=np.inf, **more).stretch(s)
    finally:
        far_end.elastic_reach = reach
    inside = (low <= truth * (1 + 1e-8)).all() and (truth <= high * (1 + 1e-8)).all()
    return "bracketed" if inside else "not bracketed"


def main():
    jets = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    rng, outcomes = np.random.default_rng(5), {}
    for _ in range(jets):
        outcome = judge(rng)
        outcomes[outcome] = outcomes.get(outcome, 0) + 1
    print(outcomes)
    Path(__file__).with_suffix(".json").write_text(json.dumps({"jets": jets, "outcomes": outcomes}, indent=1) + "\n")


if __name__ == "__main__":
    main()
