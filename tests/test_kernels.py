"""Compiled loops in a numba whose insides have changed: they are compiled as numba does it, and give the same numbers."""

import os
import subprocess
import sys
import time

import pytest

from spinline.base.taking_turns import one_at_a_time

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
    "a library that cannot be kept": (
        "other(codegen, JITCodeLibrary=type('L', (codegen.JITCodeLibrary,), {{'enable_object_caching': changed}}))",
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


# every case twice, compiled and as it was kept: in children of one process, for which numba's own start is one
EACH = """
import os, runpy, sys, traceback
import numba
from numba.core import caching, codegen, compiler, event

numba.njit(lambda x: x * x)(1.0)
for folder in sys.argv[1:]:
    for turn in "12":
        child = os.fork()
        if not child:
            os.dup2(os.open(f"{folder}/said{turn}", os.O_WRONLY | os.O_CREAT), 1)
            os.dup2(1, 2)
            code = 1
            try:
                runpy.run_path(f"{folder}/loops.py")
                code = 0
            except BaseException:
                traceback.print_exc()
            sys.stdout.flush()
            os._exit(code)
        _, status = os.waitpid(child, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)
"""


@pytest.fixture(scope="module")
def started(tmp_path_factory) -> dict[str, tuple[list[str], list[str]]]:
    """Exit codes and words of the two starts of each case."""
    top = tmp_path_factory.mktemp("numbas")
    folders = {name: top / name.replace(" ", "-") for name in CHANGES}
    for name, folder in folders.items():
        folder.mkdir()
        (folder / "loops.py").write_text(CODE.format(change=CHANGES[name][0].format()), encoding="utf-8")
    codes = python(EACH, *folders.values(), kept=top / "kept").split()
    turns = {name: codes[2 * k : 2 * k + 2] for k, name in enumerate(CHANGES)}
    return {name: (turns[name], [(folders[name] / f"said{n}").read_text() for n in "12"]) for name in CHANGES}


def python(code, *arguments, kept) -> str:
    ran = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        env={**os.environ, "NUMBA_CACHE_DIR": str(kept)},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


@pytest.mark.slow
@pytest.mark.parametrize("name", CHANGES)
def test_another_numba_compiles_in_its_own_way(name, started) -> None:
    _, parts, seals = CHANGES[name]
    codes, said = started[name]
    assert codes == ["0", "0"], said
    seen = [text.split() for text in said]
    assert [words[:3] for words in seen] == [["20.25", "9", "10"]] * 2
    assert [int(words[3]) > 0 for words in seen] == [parts] * 2
    assert seen[0][4] == str(seals)
    # numba's own cache serves where the sealed one does not fit; without parts nothing is kept
    assert [int(words[5]) for words in seen] == [0, int(parts)]


@pytest.mark.slow
def test_what_is_kept_is_compiled_again_when_a_part_or_a_number_from_elsewhere_changes(tmp_path) -> None:
    """Stamped by its own file alone, a loop went on with the old version of what it calls."""
    files = {
        "numbers.py": "import numpy as np\nTABLE = np.array([1.0, 2.0])\nWEIGHT = {weight}\n",
        "inner.py": "from spinline.base.kernels import njit\n@njit(cache=True)\ndef inner(x):\n    return {factor} * x\n",
        "outer.py": (
            "from kept_numbers import TABLE, WEIGHT\nfrom kept_inner import inner\nfrom spinline.base.kernels import njit\n"
            "@njit(cache=True)\ndef outer(x):\n    return middle(x) + TABLE[1]\n"
            "@njit(cache=True)\ndef middle(x):\n    return WEIGHT * inner(x)\n"
        ),
    }

    def start(weight: float = 1.0, factor: float = 10.0) -> list[str]:
        for name, text in files.items():
            file, now = tmp_path / f"kept_{name}", text.format(weight=weight, factor=factor)
            if not file.exists() or file.read_text(encoding="utf-8") != now:  # numba 0.60 looks at its date
                file.write_text(now, encoding="utf-8")
        code = "import sys; sys.path.insert(0, sys.argv[1]); sys.dont_write_bytecode = True\n"
        code += "from kept_outer import outer; print(outer(1.0), sum(outer.stats.cache_hits.values()))"
        return python(code, tmp_path, kept=tmp_path / "kept").split()

    assert start() == ["12.0", "0"]
    assert start() == ["12.0", "1"]
    assert start(factor=20.0) == ["22.0", "0"]
    assert start(factor=20.0, weight=2.0) == ["42.0", "0"]
    assert start(factor=20.0, weight=2.0) == ["42.0", "1"]


TWO = """
import os, sys
sys.path.insert(0, sys.argv[1])
from kept_slow import slow
children = []
for _ in range(2):
    child = os.fork()
    if not child:
        slow(1.0)
        os.write(1, f"{sum(slow.stats.cache_hits.values())} ".encode())
        os._exit(0)
    children.append(child)
for child in children:
    os.waitpid(child, 0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no locks of files, and no forks")
def test_of_processes_that_start_together_one_compiles(tmp_path) -> None:
    steps = "".join(f"    x = math.sin(x * {k}.5) + x\n" for k in range(40))
    text = (
        f"import math\nfrom spinline.base.kernels import njit\n@njit(cache=True)\ndef slow(x):\n{steps}    return x\n"
    )
    (tmp_path / "kept_slow.py").write_text(text, encoding="utf-8")
    assert sorted(python(TWO, tmp_path, kept=tmp_path / "kept").split()) == ["0", "1"]


def test_whoever_waits_for_long_goes_on_and_nothing_is_left(tmp_path) -> None:
    file = tmp_path / "a.py"
    file.write_text("", encoding="utf-8")
    with one_at_a_time(file, 60.0):
        begin = time.monotonic()
        with one_at_a_time(file, 0.2):
            assert time.monotonic() - begin < 30.0
        with one_at_a_time(tmp_path / "none.py", 60.0):
            assert time.monotonic() - begin < 30.0
    assert [path.name for path in tmp_path.iterdir()] == ["a.py"]
