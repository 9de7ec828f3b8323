"""Examples in docstrings print what they say."""

import doctest
import importlib
import pkgutil

import pytest

import spinline

MODULES = sorted(
    module.name
    for module in pkgutil.walk_packages(spinline.__path__, "spinline.")
    if not module.name.endswith("__main__") and "kernel" not in module.name
)


def test_there_are_modules_to_look_into():
    assert len(MODULES) > 200


@pytest.mark.parametrize("part", sorted({name.split(".")[1] for name in MODULES}))
def test_examples(part):
    """Every example of one room."""
    wrong = []
    for name in MODULES:
        if name.split(".")[1] != part:
            continue
        module = importlib.import_module(name)
        runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE, verbose=False)
        for test in doctest.DocTestFinder(exclude_empty=True).find(module, name):
            lines: list[str] = []
            if test.examples and runner.run(test, out=lines.append).failed:
                wrong.append("".join(lines))
    assert not wrong, "\n".join(wrong)
