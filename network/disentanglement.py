"""Entanglements that let go in a strong flow, and the conformation of strands between those that are left (Rolie-Poly).

Along a material element of strain rate edot, with ``lam_c = sqrt(tr A / 3)``::

    dA/dt  = kappa.A + A.kappa^T - (A - I)/tau_d - (2 k (1 - 1/lam_c)/tau_R) [A + beta lam_c^(2 delta) (A - I)],   delta = -1/2
    dnu/dt = (1 - nu)/tau_d - beta_c nu max(edot S - (dlam_c/dt)/lam_c, 0),   S = (A_zz - A_rr)/tr A
    k      = (m^2 - 1)/(m^2 - lam_c^2),   m^2 = N_s/(3 nu)

tau_d is the time in which a chain leaves its tube, tau_R the one in which it retracts in it (``tau_d/(3 Z)`` unless
given). What carries entanglements away is the part of the flow that stretches the tube and not the chain: retraction. In
terms of the first equation it is half the rate at which tr A is given back, so it is positive wherever chains are longer
than at rest, and nu stays in [0, 1] whatever the flow does; with the axial stretch in place of lam_c it would not.

What nu changes. The modulus is ``G_0 nu``. A strand between two entanglements that are left has ``N_s/nu`` segments: at
rest it is wider by ``nu^(-1/2)``, its contour longer by ``1/nu``, so full stretch is at ``V_S nu^(-1/2)``. A is the
conformation of the tube, over its own size at rest, and is *not* re-referenced when a strand joins its neighbour: the two
keep the stretch they have, and the strand of both has it over its own, larger size. At the same A strands are therefore
farther from their contour, by ``nu^(1/2)``. `strand_fraction` is the volume fraction whose strands at rest have that contour.

Z, entanglements a chain, is `spinline.rheology.entanglement`'s. Where ``nu Z < 1`` a chain has none left: there is no network.

beta is the convective release of constraints in the conformation (0: none, 1: full), beta_c that of the entanglements
themselves: 0.1 to 1, by simulations a property of the chain that goes with its Kuhn over its packing length and not with
its length (Dolata et al.); 0.3 by default. The docs show what they change. That simulations also see entanglements come
back in tau_R and not in tau_d does not matter while they are lost; it would once the jet is slow again.

Limits: tau_R -> 0 holds tr A at 3; beta = beta_c = 0, tau_R -> inf is the upper-convected Maxwell law at tau_d.

References
----------
Likhtman, Graham, J. Non-Newtonian Fluid Mech. 114, 1 (2003), for A; Ianniruberto, Marrucci, J. Rheol. 58, 89 (2014) and
McIlroy, Olmsted, Polymer 123, 376 (2017), for nu; Dolata et al., arXiv:2407.04886 (2024), for beta_c; Greenfeld, Zussman,
J. Polym. Sci. B 51, 1377 (2013), for jets.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, real
from spinline.base.errors import InputError
from spinline.network.mesh import Mesh, SolventQuality, check_quality, network_at_rest

__all__ = ["Disentangled", "disentangle", "rouse_time", "strand_fraction", "strands_at_rest"]

_EXPONENT = -0.5
_LARGEST = 1e100


@dataclass(frozen=True, eq=False)
class Disentangled:
    """An element at every sample (n,).

    Attributes
    ----------
    time : ndarray
        s.
    axial, radial : ndarray
        A_zz, A_rr; 1 at rest.
    entanglements_left : ndarray
        nu, in [0, 1].
    stiffening : ndarray
        k, 1 or more.
    """

    time: FloatArray
    axial: FloatArray
    radial: FloatArray
    entanglements_left: FloatArray
    stiffening: FloatArray

    @property
    def stretch(self) -> FloatArray:
        """``sqrt(A_zz)``, over the size at rest of the strands that are left."""
        return np.sqrt(self.axial)

    @property
    def contraction(self) -> FloatArray:
        """``sqrt(A_rr)``, over the same."""
        return np.sqrt(self.radial)

    @property
    def chain_stretch(self) -> FloatArray:
        """``lam_c = sqrt(tr A / 3)``."""
        return np.sqrt((self.axial + 2 * self.radial) / 3)

    def stress(self, modulus: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Axial and radial extra stress in Pa, ``G_0 nu k (A - I)``, for the modulus G_0 at rest (one, or one per sample)."""
        g = real("modulus", modulus, above=0.0, unit="Pa") * self.entanglements_left * self.stiffening
        return g * (self.axial - 1), g * (self.radial - 1)

    def lost(self, entanglements: float) -> int | None:
        """First sample at which chains of Z entanglements have fewer than one left; None if they keep theirs."""
        z = number("entanglements", entanglements, above=0.0)
        gone = np.flatnonzero(self.entanglements_left * z < 1)
        return int(gone[0]) if gone.size else None


def rouse_time(disengagement_time: ArrayLike, entanglements: ArrayLike) -> FloatArray:
    """``tau_R = tau_d/(3 Z)``, s: the tube model without fluctuations of the contour length (s; Z >= 1)."""
    tau, z = real("disengagement_time", disengagement_time, above=0.0), real("entanglements", entanglements, least=1.0)
    value: FloatArray = tau / (3 * z)
    return value


def strand_fraction(
    volume_fraction: ArrayLike, entanglements_left: ArrayLike, solvent_quality: SolventQuality = "theta"
) -> FloatArray:
    """Volume fraction whose strands at rest have ``V_S nu^(-1/2)``: ``phi nu^(1/2)`` (theta) or ``phi nu`` (good solvent)."""
    phi = real("volume_fraction", volume_fraction, least=1e-100, below=1.0)
    nu = real("entanglements_left", entanglements_left, above=0.0, most=1.0)
    value: FloatArray = phi * (np.sqrt(nu) if check_quality(solvent_quality) == "theta" else nu)
    return value


def strands_at_rest(
    volume_fraction: ArrayLike, entanglements_left: ArrayLike, solvent_quality: SolventQuality = "theta"
) -> Mesh:
    """Strands that have joined, at rest: their mesh, segments and full stretch."""
    return network_at_rest(strand_fraction(volume_fraction, entanglements_left, solvent_quality), solvent_quality)


def disentangle(
    time: ArrayLike,
    stretch_ratio: ArrayLike,
    disengagement_time: ArrayLike,
    rouse_time: ArrayLike,
    *,
    segments: float = np.inf,
    release: float = 1.0,
    entanglement_release: float = 0.3,
    strain_rate: ArrayLike | None = None,
    rtol: float = 1e-9,
) -> Disentangled:
    """Conformation and entanglements along a material element that sets out at rest.

    Parameters
    ----------
    time : array_like, (n,)
        s, strictly increasing; the element's own (residence) time.
    stretch_ratio : array_like, (n,)
        Lambda > 0, material stretch since any reference; it may fall.
    disengagement_time, rouse_time : array_like, scalar or (n,)
        tau_d and tau_R, s, > 0; their logarithms are taken as linear between samples.
    segments : float, optional
        N_s, Kuhn segments of a strand at rest, > 3; inf for strands without a contour.
    release : float, optional
        beta, in [0, 1].
    entanglement_release : float, optional
        beta_c >= 0; 0 keeps every entanglement.
    strain_rate : array_like, (n,), optional
        edot at the samples, 1/s: raises the order in their spacing from 2 to 4.
    rtol : float, optional
        Of each step, in [1e-12, 1e-3].

    Returns
    -------
    Disentangled

    Raises
    ------
    InputError
        For values out of range, or a history that cannot be followed.

    Notes
    -----
    In the logarithms of A_zz, A_rr and nu, by LSODA: 10 to 50 ms.

    Examples
    --------
    >>> state = disentangle([0.0, 3.0], np.exp([0.0, 6.0]), 1.0, 0.1, release=0.0, entanglement_release=0.0)
    >>> round(float(state.axial[-1]), 6), round(float(state.radial[-1]), 6)
    (3.958589, 0.159934)
    """
    from scipy.integrate import solve_ivp

    from spinline.rheology._element_history import ElementHistory

    history = ElementHistory.build(time, stretch_ratio, disengagement_time, strain_rate)
    t = history.time
    given = real("rouse_time", rouse_time, above=0.0, unit="s")
    if given.ndim and given.shape != t.shape:
        raise InputError("rouse_time", "must be one, or one per sample", value=f"{given.shape} against {t.shape}")
    slow = real("disengagement_time", history.relaxation_time, least=1e-100, most=_LARGEST, unit="s")
    fast = np.broadcast_to(real("rouse_time", given, least=1e-100, most=_LARGEST, unit="s"), t.shape)
    if not (isinstance(segments, float) and segments == np.inf):
        segments = number("segments", segments, above=3.0, remedy="N_s, the Kuhn segments of a strand")
    beta = number("release", release, least=0.0, most=1.0)
    loss = number("entanglement_release", entanglement_release, least=0.0, most=1e3)
    tolerance = number("rtol", rtol, least=1e-12, most=1e-3)
    h = np.diff(t)
    secant = np.diff(history.log_stretch) / h
    bend = history.first_rate + history.last_rate - 2 * secant
    rates = np.stack((history.first_rate, history.last_rate - history.first_rate - 3 * bend, 3 * bend), axis=1)
    from spinline.network._disentangle_kernels import slopes

    tables = (t, rates, -np.log(slow), -np.log(fast), 1 / segments, beta, loss)
    last = t.size - 2

    def along(sample: float, y: FloatArray) -> FloatArray:
        i = min(max(int(sample), 0), last)
        value: FloatArray = h[i] * slopes(t[i] + (sample - i) * h[i], y, *tables)
        return value

    # over the samples' number and not over time: no step passes a sample, or a flow that follows a rest would not be seen
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of a march that fails, which is refused by name below
        found = solve_ivp(
            along,
            (0.0, float(t.size - 1)),
            np.zeros(3),
            method="LSODA",
            t_eval=np.arange(t.size, dtype=np.float64),
            rtol=tolerance,
            atol=tolerance,
            first_step=min(1.0, 1e-3 * float(np.min(fast)) / float(h[0])),
            max_step=1.0,
        )
    room = np.full(1, np.nan)
    if found.success and np.isfinite(found.y).all():
        axial, radial, nu = np.exp(found.y)
        nu = np.minimum(nu, 1.0)  # above by the tolerance only
        room = 1 - (axial + 2 * radial) / segments * nu
    if not (room > 0).all():
        raise InputError(
            "time",
            "cannot be followed: the strands of this history are not resolved",
            value=float(t[len(found.t) - 1]),
            remedy="sample the history more finely, or raise rouse_time",
        )
    return Disentangled(t, axial, radial, nu, (1 - 3 * nu / segments) / room)
