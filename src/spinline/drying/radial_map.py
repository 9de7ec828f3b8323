"""Fraction across the jet: the skin that drying leaves joined with the core that the network draws together (Fig. 37).

Drying alone gives phi_d(r), highest at the surface. What is dry cannot contract: of phi_d the skin, ``(phi_d - phi_a)/(1 -
phi_a)``, stays where drying put it, phi_a being the least fraction, that of the axis; the rest, in proportion to the solvent
there, is network that is drawn together. Its radii shrink to ``c = (xi_perp/xi_0)/(xi_perp/xi_0 at rest)`` of themselves, as
Eq. (39) says of the whole, and its fraction grows by ``1/c^2``; where skin and core together would be more than polymer alone,
the core is compact and reaches farther out. Polymer is conserved in every cross-section to rounding, and the fraction is at
most 1. No contraction gives phi_d, no drying the core of Eq. (39) in clear solvent.

The division into skin and core is a model: one number, the stretch, cannot say more. What it leaves out: drying is solved
without the contraction, so the solvent that the core squeezes out does not dry faster than the solution did; and the core
has an edge, where a real one is a mesh or more wide.
"""

from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray

if TYPE_CHECKING:
    from spinline.rheology.drying import RadialDrying

__all__ = ["contracted", "excess_depth", "on_shells"]


def on_shells(radial: "RadialDrying", shells: int) -> tuple[FloatArray, FloatArray]:
    """Fraction of drying alone in shells of equal width, (shells,) middles r/R and (n, shells); exact means of the cells."""
    edges = np.linspace(0.0, 1.0, shells + 1)
    area = (radial.edges / radial.edges[:, -1:]) ** 2
    inside = np.zeros(area.shape)  # polymer within an edge, over the cross-section
    inside[:, 1:] = np.cumsum(radial.polymer_share) / radial.polymer_share.sum() * radial.mean_fraction[:, np.newaxis]
    held = np.array([np.interp(edges**2, a, p) for a, p in zip(area, inside, strict=True)])
    fraction = np.diff(held, axis=1) / np.diff(edges**2)
    return 0.5 * (edges[1:] + edges[:-1]), np.minimum(fraction, 1.0)  # rounding only


def contracted(dried: FloatArray, contraction: FloatArray) -> FloatArray:
    """Join drying and contraction.

    Parameters
    ----------
    dried : ndarray, (n, shells)
        phi of drying alone in shells of equal width, in (0, 1].
    contraction : ndarray, (n,)
        c > 0; a network that would be wider than the jet (c > 1) fills it.

    Returns
    -------
    ndarray, (n, shells)
    """
    shells = dried.shape[1]
    inside = np.linspace(0.0, 1.0, shells + 1) ** 2
    area = np.diff(inside)
    axis = dried.min(axis=1, keepdims=True)
    share = np.divide(dried - axis, 1 - axis, out=np.zeros_like(dried), where=axis < 1)
    skin = np.where(axis < 1, share, dried)
    mobile = np.concatenate((np.zeros((dried.shape[0], 1)), np.cumsum((dried - skin) * area, axis=1)), axis=1)
    squeeze = np.clip(contraction, 1e-150, 1.0) ** 2  # an area; below any that matters a core is compact anyway
    drawn = np.array([np.interp(inside, s * inside, held) for s, held in zip(squeeze, mobile, strict=True)])
    wanted, room = np.diff(drawn, axis=1), (1 - skin) * area
    core, over = np.empty_like(wanted), np.zeros(dried.shape[0])
    for j in range(shells):  # what finds no room goes farther out
        over = over + wanted[:, j]
        core[:, j] = np.minimum(over, room[:, j])
        over = over - core[:, j]
    value: FloatArray = np.minimum(skin + core / area, 1.0)  # rounding only
    return value


def excess_depth(radial: "RadialDrying") -> FloatArray:
    """Depth in m, from the surface, at which drying's fraction is half way from that of the axis; 0 without a skin."""
    phi = radial.polymer_fraction
    middles = 0.5 * (radial.edges[:, 1:] + radial.edges[:, :-1])
    level = 0.5 * (phi[:, 0] + phi[:, -1])
    depth = np.zeros(phi.shape[0])
    for i in np.flatnonzero(phi[:, -1] > phi[:, 0] * (1 + 1e-9)):
        depth[i] = radial.edges[i, -1] - float(np.interp(level[i], phi[i], middles[i]))
    return depth
