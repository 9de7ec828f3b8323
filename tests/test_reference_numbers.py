"""Numbers of the bundled scenes against those committed: what changes them on purpose is in accepted_changes.toml.

``python benchmarks/reference_numbers.py --out benchmarks/reference_numbers.json`` writes them anew; ``--full`` and ``--against``
compare every number of two trees to 1e-12 on one machine.
"""

import importlib.util
import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parent.parent / "benchmarks"


def module():
    spec = importlib.util.spec_from_file_location("reference_numbers", BENCHMARKS / "reference_numbers.py")
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


REFERENCE = module()
KNOWN = json.loads((BENCHMARKS / "reference_numbers.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("case", REFERENCE.QUICK)
def test_numbers_are_what_they_were(case):
    found = REFERENCE.collect(case, exact=True)
    known = {name: value for name, value in KNOWN.items() if name.startswith(f"{case}/")}
    assert known
    for name, value in known.items():
        here = np.array([np.nan if x is None else x for x in REFERENCE.sampled(found[name])])
        there = np.array([np.nan if x is None else x for x in value])
        # other processors round sines otherwise; what hangs on a difference of near numbers moves most
        np.testing.assert_allclose(
            here, there, rtol=1e-9, atol=1e-13 * np.nanmax(np.abs(there), initial=0.0), err_msg=name
        )


def test_every_accepted_change_has_its_bound_and_its_reason():
    changes = tomllib.loads((BENCHMARKS / "accepted_changes.toml").read_text(encoding="utf-8"))["change"]
    for change in changes:
        assert set(change) == {"numbers", "bound", "reason"}
        assert change["numbers"]
        assert change["bound"] > 0
        assert len(change["reason"]) > 40
