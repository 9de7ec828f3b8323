"""Every public law at its extremes: a number, or an `InputError`; no warning, no other error, no infinity without a word.

The names are those that the packages export, and the arguments are made from the annotations: a law that is new is swept
without anyone writing anything. What cannot be called so (it needs an object that has to be computed) is counted.
"""

import dataclasses
import importlib
import inspect
import os
import time
import types
import typing
import warnings
from typing import Any

import numpy as np
import pytest

from spinline.base.errors import InputError, SpinlineWarning

PACKAGES = (
    *("rheology", "rheology.constitutive", "network", "network.walk", "network.chain", "jetprofile", "jetprofile.ehd"),
    *("jetprofile.spun", "jetprofile.blown", "xray", "deposit", "recipe"),
)
EACH = float(
    os.environ.get("SPINLINE_EXTREMES_SECONDS", "0.03")
)  # processor time for a law; the first values matter most
VALUES = (
    *(0.0, 1e300, 5e-324, -1.0, np.nan, np.inf, 10**400, [], [0.5], "x", None, np.array([[1.0, 2.0], [3.0, 4.0]])),
    *(
        1e-300,
        1e12,
        -np.inf,
        -1e300,
        np.float32(0.5),
        np.array([0.5, np.nan]),
        2**70,
        np.arange(3),
        1 + 2j,
        True,
        1e-12,
    ),
)
TYPICAL = {
    **{"radius": 1e-4, "flow_rate": 1e-9, "k": 1.0, "beta": 0.47, "temperature": 293.15, "viscosity": 1.0},
    **{"volume_fraction": 0.05, "velocity_ratio": 5.0, "velocity": 1.0, "kuhn_length": 1e-9, "mesh_size": 1e-8},
    **{"relaxation_time": 1e-2, "conductivity": 1e-2, "electric_field": 1e5, "density": 1e3, "surface_tension": 0.05},
    **{
        "gap": 0.1,
        "voltage": 1e4,
        "photons": 1e4,
        "pixel": 1e-6,
        "contrast": 300.0,
        "molar_mass": 500.0,
        "pressure": 1e5,
    },
    **{
        "relative_humidity": 0.4,
        "length": 5e-3,
        "stretch": 3.0,
        "force": 1.0,
        "polymer_fraction": 0.05,
        "energy": 10.0,
    },
    **{"mass_fraction": 0.05, "strain_rate": 100.0, "permittivity": 80.0, "time": 1e-3, "distance": 0.1, "seed": 1},
    **{"z": np.array([1e-4, 1e-3, 2e-3]), "polymer": "PEO", "solvent": "water", "name": "water", "shells": 5},
}
# what a law says that it gives: infinity where that is the answer
INFINITE = {"extension_velocity_ratio", "fraction_eq40", "stretched_walk", "power_law_loss", "steady_jet"}
NOT_A_LAW = ("read_", "write_", "load_", "iter_", "Fibre")
MISSING = object()
MADE: dict[Any, Any] = {}


def laws() -> dict[str, Any]:
    """Functions, and classes that check what they are given."""
    found = {}
    for package in PACKAGES:
        module = importlib.import_module(f"spinline.{package}")
        for name in module.__all__:
            thing = getattr(module, name)
            if (
                not (inspect.isfunction(thing) or inspect.isclass(thing))
                or name.startswith(NOT_A_LAW)
                or getattr(thing, "_is_protocol", False)
            ):
                continue
            if inspect.isclass(thing) and (not hasattr(thing, "__post_init__") or issubclass(thing, BaseException)):
                continue
            found.setdefault(f"{thing.__module__}.{name}", thing)
    return found


def kinds(law: Any) -> dict[str, Any]:
    try:
        return typing.get_type_hints(law.__init__ if inspect.isclass(law) else law)
    except (NameError, AttributeError):
        return {}


def numeric(kind: Any) -> bool:
    text = str(kind)
    if any(word in text for word in ("Callable", "Mapping", "dict", "Sequence", "tuple[", "list[", "Literal")):
        return False
    return kind in (int, float) or any(word in text for word in ("float", "numpy", "ndarray", "int |"))


def value_for(name: str, kind: Any, depth: int = 0) -> Any:
    """A typical value of an argument; MISSING where none can be made."""
    if kind is bool:
        return False
    if typing.get_origin(kind) is typing.Literal:
        return typing.get_args(kind)[0]
    if numeric(kind):
        near = [key for key in TYPICAL if key in name and not isinstance(TYPICAL[key], str | np.ndarray)]
        return TYPICAL.get(name, TYPICAL[near[0]] if near else 3 if kind is int else 0.5)
    if kind is str:
        return TYPICAL.get(name, "x")
    if inspect.isclass(kind) and depth < 4:
        return instance(kind, depth + 1)
    if isinstance(kind, types.UnionType) or typing.get_origin(kind) is typing.Union:
        made = (value_for(name, part, depth + 1) for part in typing.get_args(kind) if part is not type(None))
        return next((one for one in made if one is not MISSING), MISSING)
    return MISSING


def instance(kind: Any, depth: int) -> Any:
    """An object, if its class checks what it is made of: containers of results cannot be made of typical numbers."""
    if kind not in MADE:
        MADE[kind] = MISSING
        if hasattr(kind, "__post_init__"):
            given = arguments(kind, depth)
            if given is not None:
                try:
                    MADE[kind] = kind(**given)
                except InputError:
                    MADE[kind] = MISSING
    return MADE[kind]


def arguments(law: Any, depth: int = 0) -> dict[str, Any] | None:
    """Typical values of all arguments that have to be given."""
    hints, given = kinds(law), {}
    for name, one in inspect.signature(law).parameters.items():
        if one.default is one.empty and one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD):
            given[name] = value_for(name, hints.get(name), depth)
    return None if any(value is MISSING for value in given.values()) else given


def infinite(result: Any) -> bool:
    if isinstance(result, tuple):
        return any(map(infinite, result))
    if isinstance(result, float | np.ndarray) and np.asarray(result).dtype.kind == "f":
        return bool(np.isinf(result).any())
    return False


def finite(values: Any) -> bool:
    numbers = [np.asarray(value) for value in values if isinstance(value, int | float | np.ndarray)]
    return all(one.dtype.kind not in "fc" or bool(np.isfinite(one).all()) for one in numbers)


def faults(name: str, law: Any) -> list[str]:
    """What goes wrong at the extremes, each with the arguments that show it."""
    given = arguments(law)
    if given is None:
        return []
    hints = kinds(law)
    numbers = [key for key in inspect.signature(law).parameters if numeric(hints.get(key))]
    found: dict[str, str] = {}
    until = time.process_time() + EACH
    tries = [({key: value}, key) for value in VALUES for key in numbers]
    tries[len(numbers) : len(numbers)] = [(dict.fromkeys(numbers, value), "all") for value in VALUES[:3]]
    for changed, key in tries:
        if time.process_time() > until and key != "all":
            break
        values = {**given, **changed}
        try:
            result = law(**values)
        except InputError:
            continue
        except Exception as error:
            word = f"{type(error).__name__}: {error}"
            found.setdefault(f"{key} {type(error).__name__}", f"{name} with {key} = {changed}: {word}"[:200])
            continue
        if name.rpartition(".")[2] not in INFINITE and finite(values.values()) and infinite(result):
            found.setdefault(f"{key} infinite", f"{name} with {key} = {changed}: infinite"[:200])
    return list(found.values())


@pytest.mark.slow
def test_every_law_answers_or_refuses_by_name() -> None:
    every = laws()
    callable_ = [name for name, law in every.items() if arguments(law) is not None]
    assert len(callable_) > 0.6 * len(every)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", SpinlineWarning)
        found = [fault for name in callable_ for fault in faults(name, every[name])]
    assert found == []


def test_the_sweep_sees_what_it_should() -> None:
    def bare(radius: float) -> float:
        return float(np.sqrt(np.float64(radius)) / np.float64(radius))

    def silent(radius: float) -> float:
        return radius * 1e10

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert any("RuntimeWarning" in fault for fault in faults("bare", bare))
        assert any("infinite" in fault for fault in faults("silent", silent))


@pytest.mark.parametrize("value", [10**400, "1", None, 1j])
def test_what_is_no_number_is_refused_by_the_checks(value) -> None:
    from spinline.base.checks import number, positive, real

    for check in (real, number, positive):
        with pytest.raises(InputError, match="radius"):
            check("radius", value)


def test_a_result_that_no_double_holds_is_refused() -> None:
    from spinline.base.checks import computable

    @dataclasses.dataclass
    class Two:
        one: float
        two: float

    def law(x: float) -> Two:
        return Two(1.0, x * 1e200)

    assert computable(law)(1.0) == law(1.0)
    for x in (1e200, np.float64(1e200)):
        with pytest.raises(InputError, match="law"):
            computable(law)(x)
