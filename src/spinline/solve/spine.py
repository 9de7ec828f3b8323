"""From a scene to a result: everything built once, rung and effects chosen, the stages in order, one Dataset.

Data goes one way. A `Context` holds what a scene needs; `plan` chooses the rung; `solve_stages` says what the jet shows; `run`
names everything as the design does.
"""

import logging
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.named_arrays import NamedArrays
from spinline.network_models.registry import cheapest, rung_in, simplest
from spinline.network_models.rung import Network
from spinline.plan.choice import Plan, plan_of, resolved
from spinline.plan.remarks import examine, remarks_of
from spinline.plan.switches import choose_effects
from spinline.scene.file import Scene
from spinline.setup.build import build_solution
from spinline.setup.context import Context
from spinline.setup.jet import build_jet
from spinline.solve.attributes import attributes_of, elsewhere
from spinline.solve.crossovers import Crossover, crossover, odd_places
from spinline.solve.missing import explain
from spinline.solve.solved import Solved
from spinline.solve.stages import solve_stages

if TYPE_CHECKING:
    import xarray as xr

    from spinline.jetprofile.jet import Jet

__all__ = [
    "Crossover",
    "Solved",
    "build_jet",
    "build_solution",
    "chosen",
    "crossover",
    "evaluate",
    "examine",
    "run",
    "solved",
    "taken",
]

_LOG = logging.getLogger("spinline")


def run(scene: Scene) -> "xr.Dataset":
    """Jet, network, concentration and crossover of a scene.

    Parameters
    ----------
    scene : Scene
        From `load_scene`.

    Returns
    -------
    xarray.Dataset
        Along `z`, or along `element` (and `time`) for bead jets; names, units and attributes as documented.

    Raises
    ------
    InputError
        For a scene that cannot be computed.

    Warns
    -----
    SpinlineWarning
        One for each remark of `examine`; they are in the attribute ``warnings`` too.

    Notes
    -----
    Closed forms: about 1 ms for 401 points. Errors against Eqs. (36)-(40) are of rounding; those of the affine model
    itself are estimated in the attribute ``model_reason``.
    """
    result = solved(scene)
    for remark in str(result.attrs["warnings"]).splitlines():
        warnings.warn(remark, SpinlineWarning, stacklevel=2)
    return result.dataset()


def solved(scene: Scene) -> NamedArrays:
    """`run` without Dataset and warnings: what the command line writes and words.

    Raises
    ------
    InputError
        As `run`.
    """
    from spinline.solve import results
    from spinline.solve.bands import banded
    from spinline.solve.uncertainty import propagated, uncertain_inputs

    result, same = _solved(scene)
    remarks = str(result.attrs["warnings"]).splitlines()
    uncertain = uncertain_inputs(scene)
    if uncertain and rung_in(same.network).sampled:
        remarks.append(f'uncertain inputs are not followed through model = "{same.network.model}": take another')
    elif uncertain:
        numbers, said = propagated(same, result, lambda moved: _solved(moved)[0])
        bands, more = banded(same, result, lambda drawn: evaluate(drawn, attributes=False))
        said += more
        result = results.with_bands(results.with_numbers(result, numbers), bands)
        if bands:
            result.attrs["bands"] = f"68 and 95 % of {same.accuracy.draws} draws of the uncertain inputs"
        result.attrs["uncertain_inputs"] = ", ".join(f"{key} = {value.text}" for key, value in uncertain.items())
        remarks += said
    remarks += explain(result, sampled=rung_in(same.network).sampled)
    result.attrs["warnings"] = "\n".join(remarks)
    return result


def _solved(scene: Scene) -> tuple[NamedArrays, Scene]:
    """Result of a scene, its remarks in its attribute, and the scene with the rung and the effects that were taken."""
    from spinline.solve import results
    from spinline.solve.summary import structure_summary

    found = evaluate(scene)
    result = results.assemble(found.fields, found.scalars, found.attributes, found.jet)
    return results.with_numbers(result, structure_summary(result)), found.scene


def evaluate(scene: Scene, jet: "Jet | None" = None, *, attributes: bool = True) -> Solved:
    """`run` without Dataset and warnings, for many scenes in a row: half the cost for closed forms.

    Parameters
    ----------
    scene : Scene
        From `load_scene`.
    jet : Jet, optional
        Anything that is one; its own is built otherwise (given where it has been built before, it saves reading files).
    attributes : bool
        False leaves the attributes empty, and the plan unmade where the scene names its model.

    Returns
    -------
    Solved

    Raises
    ------
    InputError
        For a scene that cannot be computed.
    """
    context, plan = chosen(Context(scene, jet=jet), planned=attributes)
    remarks = remarks_of(context, plan)
    if plan is not None:
        _LOG.info("%s: %s", scene.name, plan.reason)
    context, network, fallen = _network(context, plan)
    remarks += fallen
    answer = solve_stages(context, network=network)
    _LOG.debug("%s: solved by %s, %d remarks", scene.name, context.scene.network.model, len(remarks))
    remarks += answer.remarks
    remarks += odd_places(context, answer.found)
    for name, places in answer.found.items():
        if len(places) == 1 and np.isnan(places[0].position):
            remarks.append(f"{name.replace('_', ' by ')} is not reached: {elsewhere(places[0])}")
    described: dict[str, Any] = {}
    if attributes and plan is not None:
        described = attributes_of(context, answer.found, remarks, answer.network, plan)
        described |= {} if answer.moments is None else answer.moments.attributes
    return Solved(answer.fields, answer.scalars, described, remarks, context.jet, taken(context))


def chosen(context: Context, *, planned: bool = False) -> tuple[Context, Plan | None]:
    """The context with its rung and its effects chosen, and the plan where one was made (always where `planned`).

    Raises
    ------
    InputError
        For a scene that cannot be planned.
    """
    plan = plan_of(context) if planned or context.scene.network.model == "auto" else None
    if plan is not None:
        context = context.taking(resolved(context.scene, plan))
    return context.taking(effects=choose_effects(context, None if plan is None else plan.numbers)), plan


def taken(context: Context) -> Scene:
    """The scene with the rung and the effects that were chosen, so that a repetition takes the same."""
    effects = context.scene.effects
    switches = {key: context.effects[key] for key in type(effects).model_fields}
    return context.scene.model_copy(update={"effects": effects.model_copy(update=switches)})


def _network(context: Context, plan: Plan | None) -> tuple[Context, Network | None, list[str]]:
    """The network of a rung that slips, with a way out where "auto" took one that has none here.

    Where strands slip and relax and no such network is found, they relax alone, and the remark says so.
    """
    rung = rung_in(context.scene.network)
    if not rung.slips:
        return context, None, []
    try:
        return context, rung.solve(context), []
    except InputError as error:
        if plan is None or plan.forced:
            raise
        relaxing = cheapest(["relaxation"])
        if rung.relaxes and relaxing is not None:
            network = context.scene.network.model_copy(update={"model": relaxing.name, "force_law": "lattice"})
            other = context.taking(context.scene.model_copy(update={"network": network}))
            other = other.taking(effects=choose_effects(other, plan.numbers))
            return (
                other,
                None,
                [
                    f"no {rung.name} network is found here ({error.problem}): strands relax ({relaxing.name}) and do not slip, "
                    f"which errs by about {plan.effect('elastic coupling').error:.2g}"
                ],
            )
        remedy = f"{error.remedy}; or" if error.remedy else "take"
        raise InputError(
            error.field,
            f"{error.problem} (the rung that rtol = {plan.rtol:g} needs)",
            value=error.value,
            allowed=error.allowed,
            remedy=f'{remedy} model = "{simplest().name}"',
        ) from None
