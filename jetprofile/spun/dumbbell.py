"""A jet of two beads, Eqs. (13)-(16): the first moments of a straight jet between a held and a free bead.

Dimensionless with Table 2's scales, and its misprints put right: stress pulls back, and repulsion is ``Q/l^2``:

``dv/dt = V + Q/l^2 - F sigma/l``, ``dl/dt = v``, ``dsigma/dt = v/l - sigma`` (Eq. 14, the linear law);

with the upper-convected law ``sigma = (A_zz - A_rr)/3`` at the same time scale. Stress holds for a while (t up to about 2),
then repulsion and field win. With Q = 0 and V = 0 a jet that is pulled comes to rest; with F = 0 it falls freely.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from spinline.base.checks import FloatArray, computable, number, positive, real
from spinline.base.errors import InputError

__all__ = ["TwoBeadJet", "earnshaw_rate", "two_bead"]


@dataclass(frozen=True)
class TwoBeadJet:
    """Length, velocity, stress and viscoelastic force ``F sigma/l`` of the free bead at `time`, dimensionless.

    `conformation` is (A_zz, A_rr) of the upper-convected law, None of the linear one.
    """

    time: FloatArray
    length: FloatArray
    velocity: FloatArray
    stress: FloatArray
    force: FloatArray
    conformation: tuple[FloatArray, FloatArray] | None


@computable
def two_bead(
    time: ArrayLike,
    *,
    repulsion: float = 12.0,
    viscoelastic: float = 12.0,
    field: float = 2.0,
    length: float = 1.0,
    velocity: float = 0.0,
    law: str = "linear-maxwell",
    rtol: float = 1e-10,
) -> TwoBeadJet:
    """Solve Eqs. (13)-(16).

    Parameters
    ----------
    time : array_like
        Increasing times >= 0, in units of mu/G.
    repulsion, viscoelastic, field : float
        Q_e, F_ve and V of Table 2, >= 0.
    length, velocity : float
        At t = 0; length > 0.
    law : {"linear-maxwell", "ucm"}
        Eq. (14) as published, or the upper-convected law with G/3.
    rtol : float
        Of the integration.

    Returns
    -------
    TwoBeadJet

    Raises
    ------
    InputError
        For values out of range, or beads that meet.
    """
    t = np.atleast_1d(real("time", time, least=0.0))
    if t.ndim != 1 or not t.size or (np.diff(t) <= 0).any():
        raise InputError("time", "must increase and hold one moment or more")
    q = number("repulsion", repulsion, least=0.0)
    f = number("viscoelastic", viscoelastic, least=0.0)
    pull = number("field", field, least=0.0)
    start = positive("length", length)
    if law not in ("linear-maxwell", "ucm"):
        raise InputError("law", "is not one of this model's", value=law, allowed="linear-maxwell, ucm")
    linear = law == "linear-maxwell"

    def rates(_: float, y: FloatArray) -> list[float]:
        v, stretch = y[1], y[1] / y[0]
        if linear:
            return [v, pull + q / y[0] ** 2 - f * y[2] / y[0], stretch - y[2]]
        sigma = (y[2] - y[3]) / 3.0
        return [v, pull + q / y[0] ** 2 - f * sigma / y[0], 2 * stretch * y[2] - (y[2] - 1), -stretch * y[3] - y[3] + 1]

    def meet(_: float, y: FloatArray) -> float:
        return float(y[0] - 1e-9 * start)

    meet.terminal = True  # type: ignore[attr-defined]
    begin = [start, number("velocity", velocity), *([0.0] if linear else [1.0, 1.0])]
    end = float(t[-1]) or 1.0
    rtol = number("rtol", rtol, least=3e-14, most=1e-2)
    found = solve_ivp(rates, (0.0, end), begin, method="DOP853", t_eval=t, rtol=rtol, atol=1e-3 * rtol, events=meet)
    if len(found.t) < t.size:
        raise InputError("velocity", "brings the beads together", value=velocity)
    y = found.y
    stress = y[2] if linear else (y[2] - y[3]) / 3.0
    return TwoBeadJet(t, y[0], y[1], stress, f * stress / y[0], None if linear else (y[2], y[3]))


@computable
def earnshaw_rate(charge: ArrayLike, mass: ArrayLike, length: ArrayLike) -> FloatArray:
    """Growth rate in 1/s of three equal charges in line (Eq. 10), in SI: ``sqrt(2 q^2/(4 pi eps0 m l^3))``."""
    from spinline.jetprofile.spun._codes import COULOMB

    q, m, gap = real("charge", charge), real("mass", mass, above=0.0), real("length", length, above=0.0)
    value: FloatArray = np.sqrt(2 * COULOMB / m) * np.abs(q) / (gap * np.sqrt(gap))
    return value if value.ndim else np.float64(value)  # type: ignore[return-value]
