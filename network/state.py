"""The network where the jet has been stretched by V, the network moves at ``w = u / v_0`` and its strands are stretched by lam.

lam is w unless strands relax (`conformation`, `two_fluid`). A closure turns lam into the strands' conformation: ``"force"``
(f_z = f_0 [1 + A (lam - 1)], as published) or ``"stretch"`` (xi_par / xi_0 = lam, held at the contour). They agree only for
phi V << 1: 0.4867 against 0.5 of the contour at phi V = 1/2.

The polymer flux is carried at a velocity that is the network's only where strands are as long as the network has drawn them:
w under the "stretch" closure, ``w xi_par/(lam xi_par(1))`` under "force" (`flux_velocity_ratio`; ``xi_par/xi_par(1)`` in the
affine network). With it ``phi_p u (r_P/r)^2 = phi V`` exactly, r_P/r and xi_par(1) being those of the closure's own rest.

The affine rung is ``w = V``, Eqs. (36)-(40) in closed form: about 1 us per point. Its error against the finite coupling of
Eq. (32a) is about ``c V' / alpha_v`` relative in w (see `manifold`); against relaxation, about ``1 / De``.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, number, real
from spinline.network.concentration import (
    flux_fraction,
    flux_radius_ratio,
    fraction_eq40,
    fraction_walk,
    saturate,
)
from spinline.network.crossover import Closure, check_closure
from spinline.network.disentanglement import strand_fraction
from spinline.network.lattice_walk import Conformation, random_walk, stretched_walk
from spinline.network.mesh import SolventQuality, rest_force

__all__ = ["NetworkState", "affine_network", "dried_state", "network_state"]


@dataclass(frozen=True)
class NetworkState:
    """Network at given w and V; arrays of the broadcast shape of the inputs.

    Attributes
    ----------
    conformation : Conformation
        Strands: stretch, extension, contraction, orientation, force.
    network_velocity_ratio : ndarray
        ``w = u / v_0``.
    strand_stretch : ndarray
        lam, stretch of the strands that goes into the closure.
    flux_velocity_ratio : ndarray
        Velocity over v_0 at which `core_polymer_fraction_conservative` carries the polymer flux.
    rest_contraction : ndarray
        ``xi_perp / xi_0`` of the closure at lam = 1.
    mean_polymer_fraction : ndarray
        Polymer fraction of the cross-section that carries the flux, ``phi V / w``, held at 1.
    core_polymer_fraction, compacted : ndarray
        Exact walk, Eq. (40) left, held at 1 where `compacted`.
    core_polymer_fraction_eq40, compacted_eq40 : ndarray
        Eq. (40) right, as printed, held at 1 likewise.
    core_polymer_fraction_conservative, compacted_conservative : ndarray
        Flux-conserving form, held at 1 likewise.
    network_radius_ratio : ndarray
        ``r_P / r``, Eq. (39); ``phi^(1/2)`` once compacted.
    network_radius_ratio_conservative : ndarray
        The same for the flux-conserving form.
    flux_exceeded : ndarray of bool
        The compacted network would have to be wider than the jet: no steady network carries this flux.
    contour_reached : ndarray of bool
        The closure asks for more than the contour (``"stretch"`` only); the force is infinite there.
    """

    conformation: Conformation
    network_velocity_ratio: FloatArray
    strand_stretch: FloatArray
    flux_velocity_ratio: FloatArray
    rest_contraction: FloatArray
    mean_polymer_fraction: FloatArray
    core_polymer_fraction: FloatArray
    compacted: BoolArray
    core_polymer_fraction_eq40: FloatArray
    compacted_eq40: BoolArray
    core_polymer_fraction_conservative: FloatArray
    compacted_conservative: BoolArray
    network_radius_ratio: FloatArray
    network_radius_ratio_conservative: FloatArray
    flux_exceeded: BoolArray
    contour_reached: BoolArray


def affine_network(
    velocity_ratio: ArrayLike,
    volume_fraction: ArrayLike,
    *,
    closure: Closure = "force",
    affinity: float = 1.0,
    solvent_quality: SolventQuality = "theta",
) -> NetworkState:
    """Everything the closed forms say of a network that moves with the solution, ``w = V``.

    Parameters
    ----------
    velocity_ratio : array_like
        V > 0, or the material stretch ratio along a Lagrangian jet.
    volume_fraction, closure, affinity, solvent_quality
        As for `network_state`.

    Returns
    -------
    NetworkState

    Examples
    --------
    >>> network = affine_network([1.0, 5.0, 20.0], 0.05)
    >>> network.core_polymer_fraction_conservative.round(9).tolist()
    [0.05, 0.059838121, 0.951212137]
    """
    return network_state(
        velocity_ratio,
        velocity_ratio,
        volume_fraction,
        closure=closure,
        affinity=affinity,
        solvent_quality=solvent_quality,
    )


def network_state(
    network_velocity_ratio: ArrayLike,
    velocity_ratio: ArrayLike,
    volume_fraction: ArrayLike,
    *,
    strand_stretch: ArrayLike | None = None,
    entanglements_left: ArrayLike | None = None,
    closure: Closure = "force",
    affinity: float = 1.0,
    solvent_quality: SolventQuality = "theta",
) -> NetworkState:
    """Strands, network radius and concentration from the network's velocity and the solution's.

    Parameters
    ----------
    network_velocity_ratio : array_like
        ``w = u / v_0`` > 0, from any rung.
    velocity_ratio : array_like
        V > 0 of the solution at the same places.
    volume_fraction : array_like
        phi of the solution, in (0, 1); broadcast with the others.
    strand_stretch : array_like, optional
        lam > 0 where strands relax; default w.
    entanglements_left : array_like, optional
        nu in (0, 1]: strands that have joined (`disentanglement`), over their own size at rest; default 1.
    closure : {"force", "stretch"}
        How w becomes a conformation.
    affinity : float, optional
        A of the force closure.
    solvent_quality : {"theta", "good"}
        Strand statistics.

    Returns
    -------
    NetworkState

    Raises
    ------
    InputError
        For values out of range, not finite or unknown.
    """
    w = real("network_velocity_ratio", network_velocity_ratio, least=1e-100)
    v = real("velocity_ratio", velocity_ratio, least=1e-100)
    phi = real("volume_fraction", volume_fraction, least=1e-100, below=1.0)
    lam = w if strand_stretch is None else real("strand_stretch", strand_stretch, least=1e-100)
    strands = phi if entanglements_left is None else strand_fraction(phi, entanglements_left, solvent_quality)
    if check_closure(closure) == "force":
        walk = random_walk(lam, strands, affinity=affinity, solvent_quality=solvent_quality)
        at_rest, _ = rest_force(strands, solvent_quality)
        contraction = np.tanh(at_rest) / at_rest
        flux = w * (walk.axial_stretch / (contraction * lam))  # at rest a walk is as long as it is wide
    else:
        walk = stretched_walk(lam, strands, solvent_quality=solvent_quality)
        contraction = stretched_walk(1.0, strands, solvent_quality=solvent_quality).radial_contraction
        flux = w + np.zeros(walk.force.shape)
    core, compacted = saturate(fraction_walk(walk, phi))
    eq40, compacted_eq40 = saturate(fraction_eq40(lam, strands, solvent_quality) * (phi / strands))
    conservative, compacted_conservative = saturate(flux_fraction(walk, v, phi, contraction, flux))
    ratio, needed = flux_radius_ratio(walk, v, phi, contraction, flux)
    return NetworkState(
        conformation=walk,
        network_velocity_ratio=w.copy(),
        strand_stretch=lam.copy(),
        flux_velocity_ratio=flux,
        rest_contraction=np.broadcast_to(contraction, flux.shape).copy(),
        mean_polymer_fraction=np.minimum(phi * v / w, 1.0),
        core_polymer_fraction=core,
        compacted=compacted,
        core_polymer_fraction_eq40=eq40,
        compacted_eq40=compacted_eq40,
        core_polymer_fraction_conservative=conservative,
        compacted_conservative=compacted_conservative,
        network_radius_ratio=np.where(compacted, np.sqrt(phi), walk.radial_contraction),
        network_radius_ratio_conservative=ratio,
        flux_exceeded=compacted_conservative & (needed > 1),
        contour_reached=~np.isfinite(walk.force),
    )


def dried_state(
    state: NetworkState,
    velocity_ratio: ArrayLike,
    volume_fraction: float,
    remaining: ArrayLike,
    solvent_quality: SolventQuality = "theta",
) -> NetworkState:
    """The same strands in a jet that has lost volume: fractions and radii over what is left.

    Parameters
    ----------
    state : NetworkState
        From `network_state`, without loss.
    velocity_ratio, volume_fraction, solvent_quality
        What it was made with.
    remaining : array_like
        Volume left over volume at the start, phi or more (above 1: the jet has taken up vapour); 1 gives `state`.

    Returns
    -------
    NetworkState
        Every fraction over `remaining`, held at 1 likewise; a compacted network has the radius of its polymer.
    """
    phi = number("volume_fraction", volume_fraction, least=1e-100, below=1.0)
    left = real("remaining", remaining, least=phi * (1 - 1e-12))
    v, w = real("velocity_ratio", velocity_ratio, least=1e-100), state.network_velocity_ratio
    walk, flux, rest = state.conformation, state.flux_velocity_ratio, state.rest_contraction
    with np.errstate(over="ignore"):  # inf is the answer there, held at 1
        core, compacted = saturate(fraction_walk(walk, phi) / left)
        eq40, compacted_eq40 = saturate(fraction_eq40(state.strand_stretch, phi, solvent_quality) / left)
        conservative, compacted_conservative = saturate(flux_fraction(walk, v, phi, rest, flux) / left)
    needed = np.sqrt(phi * v / flux) / np.sqrt(left)
    free = walk.radial_contraction / rest
    return replace(
        state,
        mean_polymer_fraction=np.minimum(phi * v / (w * left), 1.0),
        core_polymer_fraction=core,
        compacted=compacted,
        core_polymer_fraction_eq40=eq40,
        compacted_eq40=compacted_eq40,
        core_polymer_fraction_conservative=conservative,
        compacted_conservative=compacted_conservative,
        network_radius_ratio=np.where(compacted, np.sqrt(np.minimum(phi / left, 1.0)), walk.radial_contraction),
        network_radius_ratio_conservative=np.maximum(free, needed),
        flux_exceeded=compacted_conservative & (needed > 1),
    )
