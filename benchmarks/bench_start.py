"""What a start costs: CPU seconds of whole commands, as multiples of importing numpy in the same run.

    python benchmarks/bench_start.py [--runs N] [--json FILE]

Every command is run N times in turn with ``import numpy``; the smallest CPU time (user and system) of each counts. The
column `wanted` is what was asked for in seconds where importing numpy takes 0.074 s, as a multiple of that.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

NUMPY = 0.074  # CPU s of importing numpy on the machine of the wanted column
WANTED = {
    "run peo5-water --no-figure": 0.5,
    "run peo5-water": 1.3,
    "crossover peo5-water": 0.4,
    "check peo5-water": 0.4,
    "--help": 0.3,
    "run pmma10-drying --no-figure": 1.5,
}
FIRST = {"run pmma10-drying --no-figure": 8.0}  # compiled code thrown away before


def _installed(folder: Path) -> dict[str, str]:
    """The environment, with byte code kept as an installed package keeps it."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return {**kept, "PYTHONPYCACHEPREFIX": str(folder / "bytecode")}


def cpu(command: list[str], folder: Path, **environment: str) -> float:
    """CPU seconds of a process and its children."""
    code = (
        "import resource, subprocess, sys; "
        "done = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL); "
        "used = resource.getrusage(resource.RUSAGE_CHILDREN); print(done.returncode, used.ru_utime + used.ru_stime)"
    )
    ran = subprocess.run(
        [sys.executable, "-c", code, *command],
        cwd=folder,
        env={**_installed(folder), **environment},
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
    )
    status, seconds = ran.stdout.split()
    if status != "0":
        raise SystemExit(f"{command} ended with {status}")
    return float(seconds)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--runs", type=int, default=5)
    arguments.add_argument("--json", type=Path)
    asked = arguments.parse_args()
    spinline = [sys.executable, "-m", "spinline"]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        bare = [cpu([sys.executable, "-c", "import numpy"], folder) for _ in range(3)]
        rows = []
        for words, limit in WANTED.items():
            command = [*spinline, *words.split(), *(["--force"] if words.startswith("run") else [])]
            cpu(command, folder)  # compiled code and byte code are there
            times = []
            for _ in range(asked.runs):
                bare.append(cpu([sys.executable, "-c", "import numpy"], folder))
                times.append(cpu(command, folder))
            rows.append({"command": words, "start": "warm", "seconds": min(times), "wanted": limit / NUMPY})
        for words, limit in FIRST.items():
            command = [*spinline, *words.split(), "--force"]
            times = []
            for i in range(2):
                times.append(cpu(command, folder, NUMBA_CACHE_DIR=str(folder / f"cache{i}")))
                bare.append(cpu([sys.executable, "-c", "import numpy"], folder))
            rows.append({"command": words, "start": "first", "seconds": min(times), "wanted": limit / NUMPY})
    unit = min(bare)
    print(f"import numpy: {unit:.3f} CPU s")
    for row in rows:
        row["ratio"] = row["seconds"] / unit
        kept = "yes" if row["ratio"] <= row["wanted"] else "no"
        print(
            f"{row['command']:34s}{row['start']:6s}{row['seconds']:8.2f} s{row['ratio']:8.1f} x, "
            f"wanted {row['wanted']:.1f} x: {kept}"
        )
    if asked.json:
        asked.json.write_text(json.dumps({"import_numpy": unit, "rows": rows}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
