"""The straight part of a blown jet: a boundary-value problem, solved by collocation and continuation in the drag.

Steady, Q fixed, f = pi a^2 = Q/v::

    rho Q v' = F' + rho g f + q_t           F = f (tau_zz - tau_rr + 3 mu_s v') + pi a sigma
    newton     tau = 0, mu_s = mu
    ucm        v A_zz' = 2 v' A_zz - (A_zz - 1)/theta     v A_rr' = -v' A_rr - (A_rr - 1)/theta     tau = G (A - 1), mu_s = 0
    oldroyd-b  the same with mu_s > 0
    fene-p     the same with ``v A' = ... - (h A - 1)/theta``, tau = G (h A - 1), h = (L^2 - 3)/(L^2 - tr A)

The far end pulls with `end_tension` beyond capillarity (0: a free end). That condition, not the inlet, decides: while the jet
is slower than its elastic waves one characteristic runs upstream, so velocity *and* inlet stress cannot both be chosen. For
`ucm` the entry is an elastic jump (A_rr = A_zz^(-1/2) at the nozzle); eliminating F::

    v' [3 G + tau_zz + 2 tau_rr - sigma/(2 a) - rho v^2] = (tau_zz - tau_rr)/theta - v (rho g + q_t/f)

whose bracket is ``rho (c^2 - v^2)``. Where it vanishes the end has no say any more, and no jet meets its condition: verdict
*critical*. With a solvent's viscosity there is no such place, and velocity and stress may both be given: the jet leaves the
nozzle relaxed, A = 1, and is drawn at once (a layer of ``3 mu_s f/F`` in time). `oldroyd-b` and `fene-p` are the laws to take:
they have a solution for every relaxation time, and pass smoothly to where the jet outruns its elastic waves.

Shooting from the nozzle fails: a Newtonian jet forgets its inlet by more e-folds than a double has. Collocation (scipy's
`solve_bvp`) from a crude guess fails for some gas velocities; here the drag is raised from 1e-4 of itself, the step halved
where a solve fails, and only a solution whose momentum closes to 1e-6 is handed out. With a solvent, `viscous_profile`. A
`ucm` jet that shooting does not find is the limit of jets with ever less solvent: raising the drag alone may meet a critical
jet on the way to one that is not.

**Bound.** A strongly stretched UCM jet whose tension falls downstream has ``v' <= 1/theta``: ``v <= v_0 + z/theta``, whatever
the air does. A relaxation time of 5 ms forbids more than 2.01 m/s after 10 mm; do not tune the drag to hide it.

Verdicts: *converged*; *compressed* (axial stress below 0 somewhere: air slower than the jet; a straight jet does not exist
there); *critical*; *slack* (no tension at the nozzle gives that pull). Only the first two hold a profile.

References
----------
Yarin, Sinha-Ray, Pourdeyhimi, J. Appl. Phys. 108, 034913 (2010); Sinha-Ray, Sinha-Ray, Yarin, Pourdeyhimi, Polymer 56, 452
(2015); review Eqs. (43), with the error of (43b) put right: vapour leaves with the jet's velocity.
"""

from typing import get_args

from spinline.base.checks import number, positive
from spinline.base.errors import InputError
from spinline.jetprofile.blown.air import Air
from spinline.jetprofile.blown.drag import DRAG_LAWS, TangentialLaw
from spinline.jetprofile.blown.straight_results import BlownSolution, Law, StraightBlownJet, Verdict
from spinline.jetprofile.blown.two_point import TwoPoint

__all__ = ["BlownSolution", "Law", "StraightBlownJet", "Verdict", "straight_blown_jet"]


def straight_blown_jet(
    solution: BlownSolution,
    air: Air,
    length: float,
    *,
    law: Law | None = None,
    drag: TangentialLaw = "ziabicki-kawai",
    end_tension: float = 0.0,
    gravity: float = 9.81,
    inlet_stretch: float | None = None,
    rtol: float = 1e-8,
) -> StraightBlownJet:
    """Straight blown jet from the nozzle to `length`.

    Parameters
    ----------
    solution : BlownSolution
    air : Air
    length : float
        m.
    law : {"newton", "ucm", "oldroyd-b", "fene-p"}, optional
        Default: newton without relaxation; with a solvent's viscosity fene-p where strands have an end, else oldroyd-b; ucm.
    drag : str
    end_tension : float
        Pull beyond capillarity at the end, N.
    gravity : float
        Along the jet, m/s2.
    inlet_stretch : float, optional
        ``ucm``: A_zz at the nozzle, *marched* from there without a condition at the end.
    rtol : float
        In [1e-12, 1e-4].

    Returns
    -------
    StraightBlownJet
        See its verdict; a profile is only ever a converged one.

    Raises
    ------
    InputError
        For a law that the solution does not have the properties for.
    """
    problem = TwoPoint(
        solution,
        air,
        positive("length", length, "m"),
        _law(solution, law),
        DRAG_LAWS[_drag(drag)],
        gravity,
        number("rtol", rtol, least=1e-12, most=1e-4),
    )
    pull = number("end_tension", end_tension, unit="N")
    if inlet_stretch is not None:
        if problem.law != "ucm":
            raise InputError("inlet_stretch", "is for law ucm alone", value=inlet_stretch)
        return problem.march(number("inlet_stretch", inlet_stretch, above=0.0))
    return problem.solve(pull)


def _law(solution: BlownSolution, law: Law | None) -> Law:
    elastic, solvent = solution.relaxation_time > 0, solution.solvent_viscosity > 0
    if law is None:
        if not elastic:
            return "newton"
        return "ucm" if not solvent else "fene-p" if solution.extensibility else "oldroyd-b"
    if law not in get_args(Law):
        raise InputError("law", "is not known", value=law, allowed=", ".join(f'"{name}"' for name in get_args(Law)))
    if law != "newton" and not elastic:
        raise InputError("relaxation_time", f"is needed by the law {law}", value=0.0, allowed="(0, inf) s")
    if law in ("oldroyd-b", "fene-p") and not solvent:
        raise InputError("solvent_viscosity", f"is needed by the law {law}", value=0.0, allowed="(0, viscosity) Pa s")
    if law == "fene-p" and not solution.extensibility:
        raise InputError("extensibility", "is needed by the law fene-p", value=0.0, allowed="(3, inf)")
    return law


def _drag(drag: str) -> str:
    if drag not in DRAG_LAWS:
        raise InputError("drag", "is not known", value=drag, allowed='"ziabicki-kawai", "matsui"')
    return drag
