"""Published fibres spun bead by bead: one experiment of each paper, with the constants that its paper has not seen.

    python benchmarks/spindb_lagrangian.py ../shared/data/spindb/experiments.csv --minutes 10

goes on where it stopped (`spindb_lagrangian.json`); `spindb_rungs.py` puts the rungs side by side on what is done. Each
costs 10 s to a minute of processor time. Which ones: the setting in the middle of each paper's, then the first of its
others; what cannot be spun keeps its reason.
"""

import argparse
import json
import time
from dataclasses import asdict
from pathlib import Path

import numpy as np
from spindb import central
from spindb_calibrate import load

from spinline.base.errors import InputError
from spinline.recipe.believe import believe
from spinline.recipe.constants import Calibrated
from spinline.recipe.lagrangian import laid

OUT = Path(__file__).with_suffix(".json")


def order(data):
    """Indices of the settings, the middle one of every paper first."""
    first = []
    for paper in np.unique(data.paper):
        mine = np.flatnonzero(data.paper == paper)
        first.append(int(mine[central(data, mine)]))
    return [*first, *(i for i in range(len(data.rows)) if i not in first)]


def main():
    """Spin until the time is up."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=Path)
    parser.add_argument("--minutes", type=float, default=10.0, help="of wall time")
    parser.add_argument("--most", type=int, default=60, help="experiments in all")
    parser.add_argument("--seconds", type=float, default=45.0, help="of processor time an experiment")
    asked = parser.parse_args()
    ends = time.monotonic() + 60 * asked.minutes
    folds = json.loads(Path(__file__).with_name("spindb.json").read_text(encoding="utf-8"))["folds"]
    done = json.loads(OUT.read_text(encoding="utf-8"))["experiments"] if OUT.exists() else {}
    data = load(asked.table)
    for index in order(data)[: asked.most]:
        if time.monotonic() > ends:
            break
        if str(index) in done:
            continue
        row, paper = data.rows[index], data.paper[index]
        constants = Calibrated(**folds[paper])
        mats = data.log_d[data.setting == index]
        one = {
            "paper": str(paper),
            "polymer": row["polymer"],
            "solvent": row["solvent"],
            "measured": float(np.exp(mats.mean())),
        }
        try:
            one |= asdict(laid(believe(data.recipes[index], constants)[0], constants, seconds=asked.seconds))
        except InputError as error:
            one["refused"] = str(error)
        done[str(index)] = one
        text = json.dumps({"experiments": done}, indent=1)
        OUT.write_text(text + "\n", encoding="utf-8")
        print(index, one, flush=True)


if __name__ == "__main__":
    main()
