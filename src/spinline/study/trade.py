"""What each rung costs on a user's own scene, and how far it is from the finest.

Two branches leave the affine network, elastic coupling (manifold, chain) and relaxation (conformation), and meet in the
two-fluid network, the reference of a jet whose strands slip and relax. The reference of a
branch is its finest rung that can be afforded, at tolerances a hundred times below the scene's; what a rung of one branch says
against the reference of the other is the price of the effect it leaves out. Times are of this process, the best of a few,
compiled.
"""

import json
import time
import warnings
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from spinline.base.errors import InputError, SpinlineWarning
from spinline.network_models.registry import RUNGS, simplest
from spinline.network_models.rung import Rung
from spinline.scene.file import Scene
from spinline.setup.context import Context
from spinline.solve.uncertainty import certain
from spinline.study.difference import difference, largest

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Measured", "Trade", "trade", "variant"]

_PATIENCE = 2.0  # s; a rung slower than this is measured twice


@dataclass(frozen=True)
class Measured:
    """One rung at one setting.

    Attributes
    ----------
    model, setting : str
    seconds : float
        Processor time of a run, NaN where it was refused.
    errors : dict
        Branch ("elastic", "relaxation") to the largest error against its reference; NaN where there is none.
    worst : dict
        Branch to the reported quantity that errs most.
    refused : str
        Why it cannot be run, or empty.
    """

    model: str
    setting: str
    seconds: float
    errors: dict[str, float]
    worst: dict[str, str]
    refused: str = ""


@dataclass(frozen=True)
class Trade:
    """All rungs of a scene.

    Attributes
    ----------
    rungs : tuple of Measured
    references : dict
        Branch to what it was measured against, or why there is none.
    rtol : float
        Of the scene.
    recommendation : str
    """

    rungs: tuple[Measured, ...]
    references: dict[str, str]
    rtol: float
    recommendation: str

    def plain(self) -> dict[str, Any]:
        """For JSON: dictionaries and lists."""
        return asdict(self)

    def json(self) -> str:
        """`plain` as text, NaN as null; the attribute ``trade`` of a result."""
        from spinline.solve.results import plain

        def nested(value: Any) -> Any:
            if isinstance(value, dict):
                return {key: nested(item) for key, item in value.items()}
            if isinstance(value, list | tuple):
                return [nested(item) for item in value]
            return plain(value)

        return json.dumps(nested(self.plain()), ensure_ascii=False, allow_nan=False)

    @classmethod
    def from_json(cls, text: str) -> "Trade":
        """What `json` wrote."""
        data = json.loads(text)
        nan = float("nan")
        rungs = tuple(
            Measured(
                **{
                    **rung,
                    "seconds": nan if rung["seconds"] is None else rung["seconds"],
                    "errors": {branch: nan if error is None else error for branch, error in rung["errors"].items()},
                }
            )
            for rung in data["rungs"]
        )
        return cls(rungs, data["references"], data["rtol"], data["recommendation"])


def variant(scene: Scene, model: str, **changes: Any) -> Scene:
    """The scene by another rung; changes are of ``[network]`` or ``[accuracy]``, by the names of their keys."""
    network = {key: value for key, value in changes.items() if key in type(scene.network).model_fields}
    accuracy = {key: value for key, value in changes.items() if key not in network}
    return scene.model_copy(
        update={
            "network": scene.network.model_copy(update={"model": model, **network}),
            "accuracy": scene.accuracy.model_copy(update=accuracy),
        }
    )


def trade(scene: Scene, *, quick: bool = False, progress: Callable[[str], None] | None = None) -> Trade:
    """Measure every rung on a scene.

    Parameters
    ----------
    scene : Scene
        From `load_scene`; its `network.model` is not looked at.
    quick : bool
        Only the rung next to the affine network in each branch.
    progress : callable, optional
        Told what is being measured.

    Returns
    -------
    Trade

    Raises
    ------
    InputError
        For a scene that cannot be computed at all, or holds many times.
    """
    scene = certain(scene)  # a rung costs what one run of it does
    context = Context(scene)
    if context.jet.time is not None:
        raise InputError("jet.time", "holds many times", remedy="take one")
    rtol = scene.accuracy.rtol
    say = progress or (lambda _: None)
    references: dict[str, xr.Dataset] = {}
    words: dict[str, str] = {}
    for rung in RUNGS.values():
        if not rung.branch:
            continue
        setting, why = rung.finest(context), _impossible(context, rung)
        if setting is None or why:
            words[rung.branch] = f"none: {why}"
            continue
        say(f"reference of the {rung.branch} branch: {rung.name}")
        try:
            references[rung.branch] = _run(variant(scene, rung.name, **setting.changes))
            listed = ", ".join(f"{key} = {value}" for key, value in setting.changes.items())
            words[rung.branch] = f"{rung.name}, {listed}"
        except InputError as error:
            words[rung.branch] = f"none: {error}"
    rungs = [(rung.name, one) for rung in _by_branch() for one in rung.settings(context, quick)]
    measured = []
    for model, setting in rungs:
        say(f"{model}, {setting.label}")
        measured.append(_measure(variant(scene, model, **setting.changes), model, setting.label, references))
    return Trade(tuple(measured), words, rtol, _recommendation(measured, rtol, words))


def _impossible(context: Context, rung: Rung) -> str:
    """Why a scene has no reference by a rung; empty where it may have."""
    if "straight jet" in rung.needs and not context.straight:
        return "the jet is not straight"
    if "relaxation time" in rung.needs and context.solution.relaxation_time is None:
        return "solution.relaxation_time is not given"
    return ""


def _by_branch() -> list[Rung]:
    """The rungs as a trade lists them: the simplest, those that slip, those that relax, the others."""

    def order(rung: Rung) -> int:
        return 0 if rung is simplest() else 1 if rung.slips else 2 if rung.relaxes else 3

    return sorted(RUNGS.values(), key=order)


def _run(scene: Scene) -> "xr.Dataset":
    from spinline.solve.spine import run

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)  # of a rung that is only measured
        return run(scene)


def _measure(scene: Scene, model: str, setting: str, references: "dict[str, xr.Dataset]") -> Measured:
    nan = float("nan")
    try:
        began = time.process_time()
        result = _run(scene)
        first = time.process_time() - began
        again = []
        for _ in range(3):  # the first run may have compiled: one more at least
            began = time.process_time()
            result = _run(scene)
            again.append(time.process_time() - began)
            if again[-1] > _PATIENCE:
                break
    except InputError as error:
        return Measured(model, setting, nan, dict.fromkeys(references, nan), {}, str(error))
    errors = {branch: difference(result, reference) for branch, reference in references.items()}
    return Measured(
        model,
        setting,
        min([first, *again]),
        {branch: largest(found) for branch, found in errors.items()},
        {branch: max(found, key=lambda name: found[name]) for branch, found in errors.items() if found},
    )


def _recommendation(measured: list[Measured], rtol: float, words: dict[str, str]) -> str:
    """The cheapest rung within rtol of every reference, or what stands against it."""
    branches = [branch for branch, reference in words.items() if not reference.startswith("none")]
    if not branches:
        return (
            f"{simplest().name}, unchecked: no finer rung gives a result on this scene, for the reasons named with the "
            "references"
        )
    good = [rung for rung in measured if not rung.refused and all(rung.errors[branch] <= rtol for branch in branches)]
    if good:
        best = min(good, key=lambda rung: rung.seconds)
        return f"{best.model}, {best.setting}: {1e3 * best.seconds:.3g} ms, within rtol = {rtol:g} of " + " and ".join(
            f"the {branch} reference" for branch in branches
        )
    affine = measured[0].errors
    matters = max(branches, key=lambda branch: affine[branch])
    both = [branch for branch in branches if affine[branch] > rtol]
    rest = " Both effects matter: see the rung that holds both." if len(both) > 1 else ""
    fit = [rung for rung in measured if not rung.refused and rung.errors[matters] <= rtol]
    if not fit:
        return f"no rung is within rtol = {rtol:g} of the {matters} reference: raise rtol.{rest}"
    best = min(fit, key=lambda rung: rung.seconds)
    return (
        f"{best.model}, {best.setting}: {1e3 * best.seconds:.3g} ms; it holds {matters}, the larger effect "
        f"(the affine network errs by {affine[matters]:.2g}).{rest}"
    )
