"""Fraction across the jet: the skin that drying leaves joined with the core that the network draws together (Fig. 37).

Drying alone gives phi_d(r), highest at the surface. Its least value is the network that is everywhere; what exceeds it is the
skin, which stays where drying put it. The network contracts to ``c = (xi_perp/xi_0)/(xi_perp/xi_0 at rest)`` of the radius, as
Eq. (39) says of the whole, and there has the fraction ``phi/c^2``; where skin and core overlap and would be more than polymer
alone, the core is full and reaches farther out. Polymer is conserved in every cross-section to rounding, and the fraction is
at most 1.

What this leaves out: drying is solved without the contraction, so the solvent that the core squeezes out does not dry faster
than the solution did; and the core has an edge, where a real one is a mesh or more wide.
"""

from typing import TYPE_CHECKING

import numpy as np

from spinline.checks import FloatArray

if TYPE_CHECKING:
    from spinline.rheology.drying import RadialDrying

__all__ = ["contracted", "excess_depth", "on_shells"]


def on_shells(radial: "RadialDrying", shells: int) -> tuple[FloatArray, FloatArray]:
    """Fraction of drying alone in shells of equal width, (shells,) middles r/R and (n, shells); exact means of the cells."""
    edges = np.linspace(0.0, 1.0, shells + 1)
    area = (radial.edges / radial.edges[:, -1:]) ** 2
    inside = np.zeros(area.shape)  # polymer within an edge, over the cross-section
    inside[:, 1:] = np.cumsum(radial.polymer_fraction * np.diff(area, axis=1), axis=1)
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
    area = np.diff(np.linspace(0.0, 1.0, shells + 1) ** 2)
    network = dried.min(axis=1, keepdims=True)
    skin = dried - network
    share = np.minimum(contraction, 1.0)[:, np.newaxis]
    with np.errstate(over="ignore", divide="ignore"):  # a compact core is held by the room there is
        wanted = network / share**2
    room = np.minimum(wanted, 1.0 - skin) * area
    # from the axis outwards, until all of the network has found its place
    before = np.cumsum(room, axis=1) - room
    core = np.clip(network - before, 0.0, room)
    core[:, -1] += np.maximum(network[:, 0] - core.sum(axis=1), 0.0)  # rounding only
    value: FloatArray = np.minimum(skin + core / area, 1.0)
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
