"""A recipe spun bead by bead: `spinline.jetprofile.spun` at the recipe's medians, from the onset to the collector.

The chain starts as wide as conduction lets the surface take the current over, ``a_0^2 = I H/(pi K V)``, with the charge that
the current brings, frozen in, but no more than a straight thread of that width holds at the supply's voltage, ``q <= 2 eps0
V/(a_0^2 ln(2 H/a_0))``. On most recipes that is a tenth of I/Q and less: what conduction adds downstream, where the jet is
thinner, is not in it, so that these jets bend later and lie thicker than the other rungs' (a bound from that side).
The liquid is FENE-P with ten times the viscosity of shear (a Trouton ratio of 30, less than the race's, whose hardening the
springs bring themselves), a plateau modulus ``2 MPa phi^2.3/3`` and ``L^2 = phi^-2``; it dries at the recipe's rate (a
mixture as one solvent that is gone as late as all of it) and thickens as its viscosity does. Air drags along the thread.
"""

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.constants import EPS0
from spinline.base.errors import InputError
from spinline.recipe.constants import CONSTANTS, TAKEN, Calibrated
from spinline.recipe.model import UNKNOWNS, Believed, spun

if TYPE_CHECKING:
    from spinline.jetprofile.spun.settings import SpunSettings

__all__ = ["TOO_THICK", "Laid", "laid", "settings_of"]

#: Times by which such chains lay published fibres too thick, median (`benchmarks/spindb_rungs.py`, "by beads").
TOO_THICK = 15.8

# Before the springs harden: the median of the prior of `Calibrated.trouton`, which has what they add in it.
_TROUTON = 30.0
_ELEMENT, _LONGEST = 4.0, 2e-3  # radii at the start; m in flight
_CIRCLE = 0.2  # of the radius: what bends has something to grow from


@dataclass(frozen=True)
class Laid:
    """What a chain laid on the collector.

    Attributes
    ----------
    fibre_diameter, spread : float
        Dry, mean over length, m; and the standard deviation of its logarithm along the fibre.
    spot_radius : float
        Within which nine tenths of the length lie, m.
    landing_fraction, impact_speed : float
        Polymer where it lands, median; m/s.
    carried : float
        Share of the recipe's current that the chain's frozen charge is.
    elements, cpu_seconds : float
    """

    fibre_diameter: float
    spread: float
    spot_radius: float
    landing_fraction: float
    impact_speed: float
    carried: float
    elements: int
    cpu_seconds: float


class _Late(Exception):
    """The time of computing is over within a tick of the chain's own."""


def settings_of(believed: Believed, constants: Calibrated = CONSTANTS) -> tuple["SpunSettings", float]:
    """Settings of the chain of a recipe's medians, and the share of the recipe's current that its charge is.

    Raises
    ------
    InputError
        For a jet that cannot be made: more of the polymer than flows, no onset before the collector.
    """
    from spinline.jetprofile.envelope import fastest_wave
    from spinline.jetprofile.spun import Air, Collector, Drying, Grid, Inlet, JetLaw, Loads, SpunSettings
    from spinline.jetprofile.whipping import log_term

    middle = spun(believed, np.zeros((1, len(UNKNOWNS))), constants=constants)
    current, mu = float(middle.current[0]), _TROUTON / 3 * float(middle.viscosity[0])
    flow, gap, volts, phi = believed.flow_rate, believed.gap, believed.voltage, believed.volume_fraction
    a0 = min(math.sqrt(current * gap / (math.pi * believed.conductivity * volts)), believed.needle_radius)
    if a0 > 0.01 * gap:
        raise InputError("jet.gap", "is no longer than a jet is wide", value=gap, allowed=f"> {100 * a0:.2g} m")
    whole = current / flow
    q = min(whole, 2 * EPS0 * volts / (a0 * a0 * math.log(2 * gap / a0)))
    modulus = TAKEN.plateau * phi**TAKEN.plateau_power / 3
    push = q * q * a0 * a0 * log_term(TAKEN.chi) / (4 * EPS0) - believed.surface_tension / a0
    wave = float(fastest_wave(push, a0, 3 * mu, believed.density)[0])
    speed = flow / (math.pi * a0 * a0)
    power, mean = 0.1, math.sqrt(phi * believed.solid_fraction)
    diffusion = 1e-5
    step = _ELEMENT * a0
    return SpunSettings(
        density=believed.density,
        law=JetLaw("fene-p", modulus, mu / modulus, extensibility=max(phi**-2, 4.0)),
        inlet=Inlet(
            flow,
            a0,
            charge_density=q,
            length=2 * step,
            amplitude=_CIRCLE * a0,
            frequency=max(wave, 2 * math.pi / gap) * speed,
        ),
        loads=Loads(gap, field=volts / gap),
        grid=Grid(
            step,
            tolerance=1e-3,
            pressure=False,
            feed_length=gap,
            feed_charge=q * math.pi * a0 * a0,
            log_length=gap,
            longest=max(_LONGEST, 2 * step),
        ),
        surface_tension=believed.surface_tension,
        air=Air(),
        drying=Drying(
            phi,
            diffusion,
            believed.evaporation / diffusion / TAKEN.sherwood,
            least_sherwood=TAKEN.sherwood,
            viscosity_factor=constants.viscosity_power / (math.log(10) * power * mean**power),
            viscosity_power=power,
        ),
        collector=Collector("plate"),
    ), q / whole


def laid(believed: Believed, constants: Calibrated = CONSTANTS, *, seconds: float = 90.0) -> Laid:
    """The fibre that the chain of a recipe's medians lays.

    Parameters
    ----------
    believed : Believed
    constants : Calibrated
    seconds : float
        Of computing, after which it is given up.

    Returns
    -------
    Laid

    Raises
    ------
    InputError
        Where the chain breaks, or lays nothing steady within its time: by name.

    Notes
    -----
    10 to 60 s. Measured is the second half of what is laid until it holds three times what was in flight when the first of it
    landed. One grid, one seed: with elements of half the length the bundled PAN recipe's diameter moved by 2 %.
    """
    from spinline.jetprofile.spun import SpunRun
    from spinline.jetprofile.spun import _codes as c

    settings, carried = settings_of(believed, constants)
    run, began = SpunRun.start(settings), time.process_time()
    tick, first, most = settings.loads.gap / 3000.0, 0.0, 0

    def look(_: float) -> None:
        if time.process_time() - began > seconds:
            raise _Late

    while True:
        try:
            run.chain.march(run.chain.time + tick, look)
        except _Late:
            pass  # said below
        except InputError as error:
            raise _refused(f"its chain breaks after {1e3 * run.chain.time:.3g} ms") from error
        chain = run.chain
        most = max(most, chain.n)
        rows = chain.deposited
        flying = float(chain.state[: chain.n, c.LABEL].sum())
        landed = float(rows[:, c.D_LABEL_VOLUME].sum())
        if first == 0.0 and len(rows):
            first = flying + landed
        if first > 0.0 and landed > 3 * first:
            break
        if time.process_time() - began > seconds:
            words = "lays nothing steady" if first > 0.0 else "does not reach the collector"
            raise _refused(f"it {words} within {seconds:g} s of computing ({1e3 * chain.time:.3g} ms of flight)")
    late = np.cumsum(rows[:, c.D_LABEL_VOLUME]) > 0.5 * landed
    rows = rows[late]
    label, length = rows[:, c.D_LABEL_VOLUME], rows[:, c.D_FLIGHT]
    d = 2 * np.sqrt(label * believed.volume_fraction / (np.pi * length))
    mean = float(np.average(d, weights=length))
    log_d = np.log(d)
    spread = float(np.sqrt(np.average((log_d - np.average(log_d, weights=length)) ** 2, weights=length)))
    far = np.hypot(rows[:, c.D_Y1], rows[:, c.D_Z1])
    order = np.argsort(far)
    inside = np.searchsorted(np.cumsum(length[order]), 0.9 * length.sum())
    return Laid(
        fibre_diameter=mean,
        spread=spread,
        spot_radius=float(far[order][min(inside, far.size - 1)]),
        landing_fraction=float(np.median(believed.volume_fraction * label / rows[:, c.D_VOLUME])),
        impact_speed=float(np.median(np.linalg.norm(rows[:, c.D_VX : c.D_VZ + 1], axis=1))),
        carried=carried,
        elements=most,
        cpu_seconds=time.process_time() - began,
    )


def _refused(words: str) -> InputError:
    return InputError(
        "rung",
        f"lagrangian cannot spin this recipe: {words}",
        value="lagrangian",
        remedy="another rung: race, envelope or terminal",
    )
