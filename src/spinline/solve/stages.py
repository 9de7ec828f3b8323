"""The forward model, stage by stage: jet -> drying -> relaxation -> network -> fields.

Everything that says what a jet with given properties shows goes through `solve_stages`: runs, rows of a sweep, operating
windows, fits, overlays, trades and draws of uncertain inputs. It is a pure function of a `Context` whose rung and effects are
chosen, and of the places where the answer is wanted.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.sorting import ascending
from spinline.network_models.registry import rung_in
from spinline.network_models.rung import Network
from spinline.network_models.slipping import BOND_STRENGTH
from spinline.network_models.variables import lateral_variables, network_motion, network_variables
from spinline.setup.context import Context
from spinline.setup.grid import jet_grid
from spinline.solve.crossovers import Crossover, crossover_scalars, passage, slipping_passages, targets

if TYPE_CHECKING:
    from spinline.solve.moments import Moments

__all__ = ["Answer", "jet_stage", "network_stage", "solve_stages"]


@dataclass(frozen=True, eq=False)
class Answer:
    """What the stages say.

    Attributes
    ----------
    fields : dict of str to ndarray
        Variables along the jet, by their names in a result.
    scalars : dict
        Numbers; arrays along time for a bead jet of many moments.
    found : dict of str to list of Crossover
        Where the network is fully stretched, by both criteria, one a moment.
    network : Network or None
        Of a rung that slips.
    moments : Moments or None
        What drying, relaxation and the glass did.
    remarks : list of str
    """

    fields: dict[str, FloatArray]
    scalars: dict[str, Any]
    found: dict[str, list[Crossover]]
    network: Network | None
    moments: "Moments | None"
    remarks: list[str]

    @property
    def stretch(self) -> FloatArray:
        """Stretch of the strands along the jet."""
        return self.fields["strand_stretch"]

    @property
    def remaining(self) -> FloatArray:
        """Volume left over that at the nozzle."""
        if self.moments is None:
            return np.ones_like(self.fields["stretch_ratio"])
        return self.moments.remaining


def solve_stages(
    context: Context, places: FloatArray | None = None, network: Network | None = None, *, bare: bool = False
) -> Answer:
    """All stages of one scene.

    Parameters
    ----------
    context : Context
        Rung and effects chosen.
    places : ndarray, (n,), optional
        Along a straight jet, m, increasing, from its start; by default those of the scene's ``accuracy.points``, with the
        crossovers among them.
    network : Network, optional
        Of a rung that slips, where it has been solved.
    bare : bool
        Fields alone: no crossovers, no word of what lies beyond the jet. For models that are called thousands of times.

    Returns
    -------
    Answer

    Raises
    ------
    InputError
        Where a stage cannot be computed.
    """
    rung = rung_in(context.scene.network)
    wanted = {} if bare else targets(context)
    found = {name: [passage(frame, target) for frame in context.frames] for name, target in wanted.items()}
    network = rung.solve(context) if rung.slips and network is None else network
    remarks: list[str] = []
    if network is not None and not bare:
        remarks += rung.solved_remarks(context, network)
        for name in wanted:
            found[name] = slipping_passages(context, network, wanted[name])
    if places is None and context.straight:
        places = default_places(context, [moments[0].position for moments in found.values()])
    profile = jet_stage(context, places)
    slipping = None if network is None else network_motion(context, rung, network, profile)
    moments: Moments | None = None
    if context.effects.any:
        from spinline.solve.moments import follow_moments  # drying, heat and crystals: what a plain run does without

        moments = follow_moments(context, profile, slipping, found, bare=bare)
        profile |= moments.profile
        remarks += moments.remarks
    fields = profile | network_stage(context, profile, slipping, moments)
    fields |= rung.fields(context, fields, network)
    if context.scene.network.lateral:
        fields |= lateral_variables(context, fields)
    scalars: dict[str, Any] = {"volume_fraction": context.solution.volume_fraction}
    if context.straight and not bare:
        scalars |= context.line.numbers()
    if moments is not None:
        fields |= moments.across(fields["radial_contraction"])
        scalars |= moments.scalars
    if not bare:
        scalars |= rung.scalars(context, network)
        if context.straight and np.isfinite(context.lateral_time):
            scalars["lateral_time"] = context.lateral_time
    scalars |= crossover_scalars(found, single=context.jet.time is None)
    forces = fields["strand_force"]
    if np.nanmax(forces, initial=0.0) > BOND_STRENGTH:
        remarks.append(
            f"the strand force reaches {np.nanmax(forces):.2g} N, more than a covalent bond holds ({BOND_STRENGTH:g} N): "
            "chains break or slip before"
        )
    return Answer(fields, scalars, found, network, moments, remarks)


def default_places(context: Context, special: list[float]) -> FloatArray:
    """Places of a result along a straight jet: fine at the nozzle, the special ones exactly among them."""
    jet, length = context.line, context.length
    inside = [place for place in special if jet.start <= place <= length]
    return ascending(np.concatenate((jet_grid(jet, length, context.scene.accuracy.points), inside)))


def jet_stage(context: Context, places: FloatArray | None) -> dict[str, FloatArray]:
    """Jet variables at places along a straight jet, or on the elements of a bead jet, before anything dries."""
    if not context.straight:
        return _bead_profile(context)
    jet = context.line
    assert places is not None
    return {
        "z": places,
        "radius": jet.radius(places),
        "velocity": jet.velocity(places),
        "velocity_ratio": jet.velocity_ratio(places),
        "strain_rate": jet.strain_rate(places),
        "residence_time": jet.residence_time(places),
        "stretch_ratio": jet.stretch_ratio(places),
        **jet.fields(places),
    }


def _bead_profile(context: Context) -> dict[str, FloatArray]:
    jet = context.beads
    between = 0.5 * (jet.bead_velocity[..., 1:] + jet.bead_velocity[..., :-1])
    return {
        "arc_length": jet.arc_length,
        "radius": jet.element_radius,
        "velocity": between,
        "velocity_ratio": jet.stretch,
        "strain_rate": jet.element_strain_rate,
        "residence_time": context.ages,
        "stretch_ratio": jet.stretch,
        "x": jet.x,
        "y": jet.y,
        "z": jet.z,
        **jet.fields(jet.arc_length),
    }


def network_stage(
    context: Context,
    profile: dict[str, FloatArray],
    slipping: tuple[FloatArray, FloatArray] | None,
    moments: "Moments | None",
) -> dict[str, FloatArray]:
    """Network variables wherever the stretch is known, NaN (or False) elsewhere.

    Where the jet loses volume, the strands are those of the solution at the nozzle and every fraction is over what is left.
    What relaxes and does not slip moves with the solution.
    """
    n, solution, stretch = context.scene.network, context.solution, profile["stretch_ratio"]
    known = np.isfinite(stretch)
    flow = stretch[known]
    moved, velocity = (flow, None) if slipping is None else (slipping[0][known], slipping[1][known])
    left: FloatArray | None = None
    if moments is not None:
        moved = moments.stretch[known]
        left = moments.remaining[known] if moments.dries else None
        velocity = flow if velocity is None else velocity
    entangled = profile.get("entanglements_left")
    flat = network_variables(
        moved,
        flow,
        profile["radius"][known],
        solution.volume_fraction,
        closure=n.closure_used,
        solvent_quality=n.solvent_quality,
        kuhn_length=solution.kuhn_length,
        temperature=solution.temperature,
        remaining=left,
        velocity=velocity,
        entanglements_left=None if entangled is None else entangled[known],
    )
    return {name: _spread(values, known) for name, values in flat.items()}


def _spread(values: FloatArray, known: Any) -> FloatArray:
    if known.all():
        return values.reshape(known.shape)
    full = np.full(known.shape, False if values.dtype == bool else np.nan, dtype=values.dtype)
    full[known] = values
    return full
