"""Compiled loops in a numba whose insides have changed: they are compiled as numba does it, and give the same numbers."""

import os
import subprocess
import sys

import pytest

CODE = """
import types, warnings
warnings.simplefilter("error")
import numba
from numba.core import caching, codegen, compiler, event

def changed(*_):
    raise AttributeError("changed")

def other(module, leave=(), **have):
    kept = {{name: value for name, value in vars(module).items() if name not in leave}}
    setattr(numba.core, module.__name__.rpartition(".")[2], types.SimpleNamespace(**{{**kept, **have}}))

{change}
from spinline.base import kernels

for module in (caching, codegen, compiler, event):
    setattr(numba.core, module.__name__.rpartition(".")[2], module)

@kernels.njit(cache=True)
def square(x):
    return x * x

@kernels.njit(cache=True)
def fall(n):
    return 0 if n <= 0 else n + fall(n - 1)

@kernels.njit(cache=True, error_model="numpy")
def total(n):
    t = 0.0
    for i in range(n):
        t += square(float(i))
    return t + fall(3) + 1 / square(2.0)

print(total(4), square(3), fall(4), len(kernels._parted), kernels._CACHE is not None, sum(total.stats.cache_hits.values()))
"""

# what is another thing in this numba, and whether loops still come in parts, and sealed
CHANGES = {
    "nothing": ("", True, True),
    "no library": ("other(codegen, leave=['JITCodeLibrary'])", False, True),
    "another library": ("other(codegen, JITCodeLibrary=codegen.CodeLibrary)", False, True),
    "a library that fails": (
        "other(codegen, JITCodeLibrary=type('L', (codegen.JITCodeLibrary,), {{'_verify_declare_only_symbols': changed}}))",
        False,
        True,
    ),
    "a library that takes other arguments": (
        "other(codegen, JITCodeLibrary=type('L', (codegen.JITCodeLibrary,), {{'__init__': changed}}))",
        False,
        True,
    ),
    "no compiler": ("other(compiler, leave=['Compiler'])", False, True),
    "a compiler that fails": (
        "other(compiler, Compiler=type('C', (compiler.Compiler,), {{'__init__': changed}}))",
        False,
        True,
    ),
    "no cache file": ("other(caching, leave=['IndexDataCacheFile'])", True, False),
    "another cache file": ("other(caching, IndexDataCacheFile=type('F', (), {{'_dump': changed}}))", True, False),
    "another cache": ("other(caching, FunctionCache=type('C', (), {{'load_overload': changed}}))", True, False),
    "a cache that fails": (
        "other(caching, FunctionCache=type('C', (caching.FunctionCache,), {{'__init__': changed}}))",
        True,
        True,
    ),
    "no events": ("other(event, leave=['register', 'Listener'])", True, True),
}


@pytest.mark.parametrize("name", CHANGES)
def test_another_numba_compiles_in_its_own_way(name, tmp_path) -> None:
    change, parts, seals = CHANGES[name]
    (tmp_path / "loops.py").write_text(CODE.format(change=change.format()), encoding="utf-8")
    seen = []
    for _ in range(2):  # compiled, and as it was kept
        ran = subprocess.run(
            [sys.executable, "loops.py"],
            cwd=tmp_path,
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "kept")},
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        assert ran.returncode == 0, ran.stderr
        seen.append(ran.stdout.split())
    assert [words[:3] for words in seen] == [["20.25", "9", "10"]] * 2
    assert [int(words[3]) > 0 for words in seen] == [parts] * 2
    assert seen[0][4] == str(seals)
    # numba's own cache serves where the sealed one does not fit; without parts nothing is kept
    assert [int(words[5]) for words in seen] == [0, int(parts)]
