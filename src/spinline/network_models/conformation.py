"""Rung ``conformation``: how far the strands are stretched while they relax, and the stress they carry.

The material stretch drives the conformation tensor along every element, straight or bent; relaxation time and modulus follow
the local concentration. The stretch ``w = sqrt(A_zz)`` then goes through the closure as the affine ``w = V`` does: theta -> inf
gives the affine rung, theta -> 0 the network at rest. What relaxes flows with the solution: it does not slip.

Strands keep the length they had at the nozzle, ``N_s = phi_0^-2`` in a theta solvent: drying makes no new entanglements.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network_models.rung import Relaxed, Rung, Setting
from spinline.setup.history import History
from spinline.setup.material import Material, constitutive_model

if TYPE_CHECKING:
    from spinline.rheology.conformation import Model
    from spinline.setup.context import Context

_RTOL = 1e-8  # far below what the closures differ by

__all__ = ["RUNG", "RelaxingStrands", "Stretching", "stretch_strands"]


@dataclass(frozen=True, eq=False)
class Stretching:
    """Strands at every sample (n,).

    Attributes
    ----------
    stretch, contraction : ndarray
        ``sqrt(A_zz)`` and ``sqrt(A_rr)``, over the size at rest.
    relaxation_time : ndarray
        theta at the local concentration, s.
    weissenberg : ndarray
        theta times the strain rate, both local.
    stress, radial_stress, tensile_force : ndarray or None
        Axial and radial extra stress (Pa), and the force on the cross-section (N); None where the viscosity is not known.
    model : Model
        Constitutive model.
    """

    stretch: FloatArray
    contraction: FloatArray
    relaxation_time: FloatArray
    weissenberg: FloatArray
    stress: FloatArray | None
    radial_stress: FloatArray | None
    tensile_force: FloatArray | None
    model: "Model"


def stretch_strands(
    material: Material,
    model: "Model",
    time: FloatArray,
    stretch_ratio: FloatArray,
    fraction: FloatArray,
    radius: FloatArray,
    strain_rate: FloatArray | None = None,
) -> Stretching:
    """Conformation and stress along an element that sets out at rest.

    Parameters
    ----------
    material, model
        Of the scene.
    time, stretch_ratio, fraction, radius : ndarray, (n,)
        Age of the element (s, increasing), material stretch, local polymer fraction, jet radius (m).
    strain_rate : ndarray, (n,), optional
        1/s; raises the order of the integration.

    Raises
    ------
    InputError
        For a missing property, or a history that a linear model cannot hold.
    """
    from spinline.rheology.conformation import conformation, tensile_force
    from spinline.rheology.constitutive import fenep, maxwell

    theta = material.relaxation_time(fraction)
    late = time[0] > 0
    if late:  # from the nozzle, where everything is at rest, to the first element of a bead jet
        start = float(material.relaxation_time(np.asarray([material.solution.volume_fraction]))[0])
        along = [
            np.concatenate(([first], values)) for first, values in ((0.0, time), (1.0, stretch_ratio), (start, theta))
        ]
        rate = None
    else:
        along, rate = [time, stretch_ratio, theta], strain_rate
    try:
        state = conformation(along[0], along[1], along[2], model, strain_rate=rate, rtol=_RTOL)
    except InputError as error:
        finite = np.isfinite(model.stiffening(np.ones(1))[1])
        other = (maxwell if finite else fenep).LAW.name
        remedy = f'{error.remedy or "see the jet"}; or rheology.constitutive = "{other}"'
        raise InputError(
            f"jet: {error.field}", error.problem, value=error.value, allowed=error.allowed, remedy=remedy
        ) from None
    cut = slice(1, None) if late else slice(None)
    stress = radial = force = None
    if material.solution.viscosity is not None or material.laws.law == "martin":
        viscosity = material.viscosity(fraction)
        if model.solvent_viscosity:
            viscosity = viscosity - model.solvent_viscosity
            if (viscosity <= 0).any():
                raise InputError(
                    "solution.viscosity",
                    "is not above the solvent's, as Oldroyd-B needs",
                    value=float(viscosity.min()) + model.solvent_viscosity,
                    remedy="raise it",
                )
        modulus = viscosity / theta
        every = np.concatenate((modulus[:1], modulus)) if late else modulus
        both = state.stress(every)
        stress, radial = both[0][cut], both[1][cut]
        force = tensile_force(stress, radial, radius)
    return Stretching(
        state.stretch[cut], state.contraction[cut], theta, state.weissenberg[cut], stress, radial, force, model
    )


class RelaxingStrands(Rung):
    """Strands that move with the solution and relax; see `spinline.rheology.conformation`."""

    name = "conformation"
    words = "strands that relax as the jet stretches and dries: Maxwell, Oldroyd-B, Giesekus, FENE-P"
    holds = ("relaxation",)
    needs = ("relaxation time",)
    relaxes = True
    automatic = True
    branch = "relaxation"
    cost = "5 to 20 ms"

    def relax(self, context: "Context", history: History) -> Relaxed:
        """Stretch w along a material element, Weissenberg and Deborah numbers, stress where the viscosity is known."""
        material = context.material
        if context.effects["disentanglement"]:
            return _disentangled(context, history)
        if history.stiffening is not None:
            material = material.stiffened(history.stiffening)
        model = constitutive_model(context.scene, material, context.rest.full_stretch)
        state = stretch_strands(
            material, model, history.time, history.stretch, history.fraction, history.radius, history.strain_rate
        )
        assert material.solution.relaxation_time is not None
        found = {
            "weissenberg_number": state.weissenberg,
            "deborah_number": state.weissenberg / state.relaxation_time * material.solution.relaxation_time,
        }
        if state.stress is not None and state.radial_stress is not None and state.tensile_force is not None:
            found |= {
                "stress": state.stress,
                "radial_stress": state.radial_stress,
                "tensile_force": state.tensile_force,
            }
        return Relaxed(state.stretch, found, repr(model))

    def settings(self, context: "Context", quick: bool) -> list[Setting]:
        """By samples along the jet."""
        if context.solution.relaxation_time is None:
            return []
        return [Setting(f"{n} points", {"points": n}) for n in ((401,) if quick else (101, 401, 1601))]

    def finest(self, context: "Context") -> Setting | None:
        """Many samples."""
        return Setting("", {"points": 6401})


def _disentangled(context: "Context", history: History) -> Relaxed:
    """Rolie-Poly strands between the entanglements that are left."""
    from spinline.network.disentanglement import disentangle
    from spinline.rheology.conformation import tensile_force

    material, strands = context.material, context.strands
    theta = material.relaxation_time(history.fraction)
    time, stretch, slow = history.time, history.stretch, theta
    late = time[0] > 0
    if late:
        start = float(material.relaxation_time(np.asarray([material.solution.volume_fraction]))[0])
        time, stretch = np.concatenate(([0.0], time)), np.concatenate(([1.0], stretch))
        slow = np.concatenate(([start], slow))
    state = disentangle(
        time,
        stretch,
        slow,
        strands.rouse_time(slow),
        segments=context.rest.segments,
        release=strands.release,
        entanglement_release=strands.entanglement_release,
        strain_rate=None if late else history.strain_rate,
        rtol=1e-8,
    )
    cut = slice(1, None) if late else slice(None)
    left = state.entanglements_left[cut]
    found = {"entanglements_left": left}
    if history.strain_rate is not None:
        found |= {
            "weissenberg_number": theta * history.strain_rate,
            "deborah_number": float(context.solution.relaxation_time or 0.0) * history.strain_rate,
        }
    if material.solution.viscosity is not None or material.laws.law == "martin":
        modulus = material.viscosity(history.fraction) / theta
        every = np.concatenate((modulus[:1], modulus)) if late else modulus
        stress, radial = (part[cut] for part in state.stress(every))
        found |= {
            "stress": stress,
            "radial_stress": radial,
            "tensile_force": tensile_force(stress, radial, history.radius),
        }
    words = (
        f"Rolie-Poly, Z = {strands.entanglements:.3g}, tau_R = {float(np.ravel(strands.rouse_time(slow))[0]):.3g} s, "
        f"beta = {strands.release:g}, beta_c = {strands.entanglement_release:g}"
    )
    gone = np.flatnonzero(left * strands.entanglements < 1)
    remarks: tuple[str, ...] = ()
    if gone.size:
        at = 1e3 * float(history.position[gone[0]])
        remarks = (
            f"the network is lost at {at:.4g} mm: chains of Z = {strands.entanglements:.3g} entanglements have none left",
        )
    return Relaxed(state.stretch[cut], found, words, remarks)


RUNG = RelaxingStrands()
