"""The effects of a run put together: one moment of the jet, or each of many, in the shape of the result."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.drying.along_jet import biot_number, fourier_number, peclet_number
from spinline.drying.radial_map import contracted, excess_depth, on_shells
from spinline.network.state import network_state
from spinline.setup.context import Context
from spinline.solve.crossovers import Crossover
from spinline.solve.element import Followed, follow, spread

__all__ = ["Moments", "follow_moments"]


@dataclass(frozen=True, eq=False)
class Moments:
    """What the effects add to a run, arrays in the shape of its profile.

    Attributes
    ----------
    context : Context
        Of the run.
    moments : list of Followed
        One, or one per time.
    lead : bool
        There is a time axis.
    profile : dict
        Jet variables in place of those without the effects, and new ones.
    stretch, remaining : ndarray
        Stretch w of the network, and volume left.
    scalars : dict
        What freezes; arrays along time where there are times.
    remarks : list of str
    attributes : dict
    """

    context: Context
    moments: list[Followed]
    lead: bool
    profile: dict[str, FloatArray]
    stretch: FloatArray
    remaining: FloatArray
    scalars: dict[str, Any]
    remarks: list[str]
    attributes: dict[str, Any]

    @property
    def dries(self) -> bool:
        """The jet loses volume."""
        return self.context.effects.evaporation

    def across(self, contraction: FloatArray) -> dict[str, FloatArray]:
        """Map of the fraction, skin, and the numbers of radial drying; nothing where it is off.

        Parameters
        ----------
        contraction : ndarray
            Radial contraction of the strands, in the shape of the profile.
        """
        if not self.context.effects.radial:
            return {}
        rows = contraction if self.lead else contraction[np.newaxis]
        each = [self._one(moment, row) for moment, row in zip(self.moments, rows, strict=True)]
        fields = {name: np.stack([one[name] for one in each]) if self.lead else each[0][name] for name in each[0]}
        edges = np.linspace(0.0, 1.0, self.context.scene.accuracy.shells + 1)
        return {"r": 0.5 * (edges[1:] + edges[:-1]), **fields}

    def _one(self, moment: Followed, contraction: FloatArray) -> dict[str, FloatArray]:
        assert moment.dried is not None
        assert moment.dried.radial is not None
        radial, at, phi = moment.dried.radial, moment.at, self.context.solution.volume_fraction
        n, air, law = self.context.scene.network, self.context.air, self.context.diffusion
        rest = network_state(1.0, 1.0, phi, closure=n.closure_used, solvent_quality=n.solvent_quality)
        here = replace(
            radial,
            position=radial.position[at],
            polymer_fraction=radial.polymer_fraction[at],
            edges=radial.edges[at],
            mean_fraction=radial.mean_fraction[at],
        )
        _, dried = on_shells(here, self.context.scene.accuracy.shells)
        joined = contracted(dried, contraction[moment.known] / float(rest.conformation.radial_contraction))
        glass = moment.frozen.scalars["vitrification_fraction"] if moment.frozen is not None else float("nan")
        skin = excess_depth(here) if np.isnan(glass) else here.skin_thickness(glass)
        peclet = peclet_number(moment.dried, air, law, phi)
        fields = {
            "polymer_fraction": joined,
            "drying_polymer_fraction": dried,
            "surface_polymer_fraction": here.polymer_fraction[:, -1],
            "axis_polymer_fraction": here.axis_fraction,
            "skin_thickness": skin,
            "drying_peclet": peclet[at],
            "drying_biot": biot_number(peclet, moment.dried, air, phi)[at],
            "fourier_number": fourier_number(moment.dried, law, phi)[at],
        }
        return {name: spread(values, moment.known) for name, values in fields.items()}


def follow_moments(
    context: Context,
    profile: dict[str, FloatArray],
    slipping: tuple[FloatArray, FloatArray] | None,
    found: dict[str, list[Crossover]],
    *,
    bare: bool = False,
) -> Moments:
    """Follow every moment of a jet, and put the crossovers of `found` where the network passes them.

    Parameters
    ----------
    context : Context
        Rung and effects chosen.
    profile : dict
        Jet variables without the effects.
    slipping : tuple of ndarray or None
        Stretch and velocity w at the profile's places of a network that slips.
    found : dict
        Crossovers without the effects, one a moment; replaced in place.
    bare : bool
        Say nothing of what lies beyond the jet.

    Raises
    ------
    InputError
        For missing properties, or a jet that cannot be followed.
    """
    frames, lead = context.frames, context.jet.time is not None
    moments = [
        follow(
            frame,
            {name: values[i] for name, values in profile.items()} if lead else profile,
            (slipping[0][i], slipping[1][i]) if lead and slipping is not None else slipping,
            bare=bare,
        )
        for i, frame in enumerate(frames)
    ]

    def gather(values: list[FloatArray]) -> FloatArray:
        return np.stack(values) if lead else values[0]

    if slipping is None:
        for name, places in found.items():
            found[name] = [
                _crossover(moment, frame, place) for moment, frame, place in zip(moments, frames, places, strict=True)
            ]
    else:
        for name, places in found.items():
            if not all(np.isnan(place.position) for place in places):
                found[name] = [_dried(moment, context, place) for moment, place in zip(moments, places, strict=True)]
    names = set.intersection(*(set(moment.fields) for moment in moments))
    new = {name: gather([moment.fields[name] for moment in moments]) for name in moments[0].fields if name in names}
    return Moments(
        context=context,
        moments=moments,
        lead=lead,
        profile=new,
        stretch=gather([moment.stretch for moment in moments]),
        remaining=gather([moment.remaining for moment in moments]),
        scalars=_frozen_scalars(moments, lead),
        remarks=list(dict.fromkeys(remark for moment in moments for remark in moment.remarks)),
        attributes=_attributes(context, moments),
    )


def _frozen_scalars(moments: list[Followed], lead: bool) -> dict[str, Any]:
    """What freezes, one a moment."""
    scalars: dict[str, Any] = {}
    if moments[0].frozen is not None:
        for name in moments[0].frozen.scalars:
            values = [moment.frozen.scalars[name] for moment in moments if moment.frozen is not None]
            scalars[name] = np.array(values) if lead and name != "vitrification_fraction" else values[0]
    return scalars


def _attributes(context: Context, moments: list[Followed]) -> dict[str, Any]:
    """What a result says of the last moment, and of the solution."""
    solution, first = context.solution, moments[0]
    attributes: dict[str, Any] = dict(moments[-1].attributes)
    for name, value in (
        ("zero_shear_viscosity", solution.viscosity),
        ("relaxation_time_at_rest", solution.relaxation_time),
    ):
        if value is not None:
            attributes[name] = value
    if context.effects.radial:
        known = first.frozen is not None and not np.isnan(first.frozen.scalars["vitrification_fraction"])
        attributes["skin_criterion"] = (
            "depth at which the fraction of drying is that of vitrification"
            if known
            else "depth at which the fraction of drying is half way between axis and surface"
        )
    return attributes


def _dried(moment: Followed, context: Context, place: Crossover) -> Crossover:
    """The same place in the jet as it has dried."""
    if np.isnan(place.position):
        return place
    radius = moment.along.at(place.position)["radius"]
    return replace(place, radius=radius, radius_ratio=radius / context.jet.initial_radius)


def _crossover(moment: Followed, context: Context, affine: Crossover) -> Crossover:
    """Where the stretch of the strands passes what the velocity passes in the affine jet."""
    target, along = affine.velocity_ratio, moment.along
    nan = float("nan")
    if not target > 0:
        return affine
    place = moment.passage(target)
    if not np.isnan(place):
        radius = along.at(place)["radius"]
        return Crossover(target, place, radius, radius / context.jet.initial_radius, place)
    end = context.length if context.straight else float(along.position[-1])
    if moment.frozen is not None and not np.isnan(moment.frozen.position):
        solid = "becomes solid" if "crystals" in moment.frozen.words["frozen"] else "turns to glass"
        words = f"the network {solid} before, at {moment.frozen.position:.6g} m, stretched w = {along.stretch[-1]:.6g}"
        return Crossover(target, nan, nan, nan, nan, words)
    if context.effects.relaxation:
        i = int(np.argmax(along.stretch))
        words = (
            f"the network, as it relaxes, is stretched w = {along.stretch[i]:.6g} at most, at {along.position[i]:.6g} m; "
            f"it takes {target:.6g}"
        )
        return Crossover(target, nan, nan, nan, nan, words)
    return Crossover(target, nan, nan, nan, affine.predicted if affine.predicted > end else nan)
