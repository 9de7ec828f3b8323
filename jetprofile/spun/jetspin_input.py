"""A JETSPIN ``input.dat`` as settings of our own jet: every key translated, or named as one that is not.

What differs in physics is said: the flow rate (there an outcome of the length step, here given), the law (UCM with G/3
unless the linear one is asked for), charge on a line softened by the radius instead of points, surface tension as an energy.
"""

import math
import re
from dataclasses import dataclass, field

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin.units import CM, STATCOULOMB, STATVOLT, to_float
from spinline.jetprofile.spun.laws import JetLaw
from spinline.jetprofile.spun.settings import Air, Collector, Grid, Inlet, Loads, SpunSettings

__all__ = ["Translated", "translate"]

# key: factor to SI
_NUMBERS = {
    "timestep": 1.0,
    "print time": 1.0,
    "final time": 1.0,
    "seed": 1.0,
    "points": 1.0,
    "initial length": CM,
    "resolution": CM,
    "nozzle velocity": CM,
    "nozzle stress": 0.1,
    "yield stress": 0.1,
    "nozzle cross section": CM,
    "nozzle cross": CM,
    "density mass": 1e3,
    "density charge": STATCOULOMB * 1e6,
    "viscosity": 0.1,
    "elastic modulus": 0.1,
    "collector distance": CM,
    "external potential": STATVOLT,
    "surface tension": 1e-3,
    "perturbation frequency": 1.0,
    "perturbation amplitude": CM,
    "airdrag airdensity": 1e3,
    "airdrag airviscosity": 1e-4,
    "airdrag amplitude": 1.0,
    "airdrag airvelocity": CM,
    "dynamic refinement threshold": CM,
    "system": 1.0,
    "integrator": 1.0,
}
_SWITCHES = (
    "inserting",
    "removing",
    "gravity",
    "perturbation",
    "airdrag",
    "dynamic refinement",
    "multiple step",
    "kvfluid",
    "dragvel",
    "restart",
)
_OUTPUT = (
    "print list",
    "printstat binary",
    "printstat",
    "print xyz",
    "print pdb",
    "print binary",
    "print time",
    "finish",
    "primary cutoff",
    "maximum displacement",
    "maximum displ",
    "multiple step every",
    "dynamic refinement every",
)


@dataclass(frozen=True)
class Translated:
    """Settings, times and what was not, or not literally, taken over.

    `flow_rate` in m3/s is the nominal one of the nozzle's velocity; `ignored` are keys with no meaning here, `differs` what is
    physically another thing here.
    """

    settings: SpunSettings
    time: float
    interval: float
    ignored: tuple[str, ...] = ()
    differs: tuple[str, ...] = field(default=())


def translate(text: str, *, flow_rate: float | None = None, law: str = "ucm") -> Translated:
    """Read an ``input.dat``.

    Parameters
    ----------
    text : str
        Its content.
    flow_rate : float, optional
        Q, m3/s; default: nozzle velocity times cross-section, what the file says.
    law : {"ucm", "linear-maxwell"}
        Constitutive law.

    Raises
    ------
    InputError
        For a key that is not known, one that would change the physics and has no counterpart, or a value out of range.
    """
    values, on, ignored = _read(text)
    for key in ("kvfluid", "restart"):
        if on.get(key):
            raise InputError(
                f"input.dat: {key}", "has no counterpart here", remedy="drop the key, or run JETSPIN itself"
            )
    for key in ("initial length", "density mass", "viscosity", "elastic modulus", "collector distance"):
        if key not in values:
            raise InputError(f"input.dat: {key}", "is missing")
    radius = values.get("nozzle cross section", values.get("nozzle cross", math.nan))
    if not radius > 0:
        raise InputError("input.dat: nozzle cross", "is missing")
    area = math.pi * radius**2
    points = max(int(values.get("points", 1)), 1)
    step = values.get("resolution", values["initial length"] / points)
    nominal = values.get("nozzle velocity", 0.0) * area
    if on.get("inserting") is False and flow_rate is None:
        raise InputError(
            "input.dat: inserting",
            "is no: one bead that nothing follows; here material enters all the time",
            remedy="give --flow-rate to spin it all the same; the bead of Eqs. (13)-(16) is spinline.jetprofile.spun.two_bead",
        )
    flow = nominal if flow_rate is None else flow_rate
    if not flow > 0:
        raise InputError(
            "input.dat: nozzle velocity", "is missing: it sets the flow rate here", remedy="give --flow-rate"
        )
    gap, density = values["collector distance"], values.get("density charge", 0.0)
    three = int(values.get("system", 3)) not in (1, 2)
    air = None
    if on.get("airdrag"):
        air = Air(
            density=values.get("airdrag airdensity", 1.21),
            viscosity=values.get("airdrag airviscosity", 1.51e-5),
            velocity=(values.get("airdrag airvelocity", 0.0), 0.0, 0.0),
        )
    shaken = on.get("perturbation", False) and three
    settings = SpunSettings(
        density=values["density mass"],
        law=_law(law, values),
        inlet=Inlet(
            flow,
            radius,
            charge_density=density,
            length=2.0 * step if points == 1 else points * step,
            amplitude=values.get("perturbation amplitude", 0.0) if shaken else 0.0,
            frequency=values.get("perturbation frequency", 0.0) if shaken else 0.0,
            ramp=5 / values["perturbation frequency"] if shaken and values.get("perturbation frequency") else 0.0,
        ),
        loads=Loads(
            gap, field=values.get("external potential", 0.0) / gap, gravity=9.80665 if on.get("gravity") else 0.0
        ),
        grid=Grid(
            step,
            repulsion="hybrid" if density else "none",
            near=8,
            pressure=False,
            feed_length=gap,
            feed_charge=density * area,
            longest=values.get("dynamic refinement threshold", 0.0) if on.get("dynamic refinement") else 0.0,
        ),
        surface_tension=values.get("surface tension", 0.0),
        air=air,
        collector=Collector("plate" if on.get("removing") else "none"),
        seed=int(values.get("seed", 0)),
    )
    time = values.get("final time", 0.0)
    return Translated(
        settings,
        time,
        values.get("print time", time),
        tuple(ignored),
        _differences(settings, nominal, values, on, step),
    )


def _law(law: str, values: dict[str, float]) -> JetLaw:
    modulus, mu = values["elastic modulus"], values["viscosity"]
    if values.get("yield stress"):
        return JetLaw(
            "herschel-bulkley", modulus, mu / modulus, yield_stress=values["yield stress"], consistency=mu, index=1.0
        )
    return JetLaw.from_extensional(mu, modulus, law)


def _read(text: str) -> tuple[dict[str, float], dict[str, bool], list[str]]:
    """Numbers in SI, switches, and the keys of output and method."""
    values: dict[str, float] = {}
    on: dict[str, bool] = {}
    ignored: list[str] = []
    for number, raw in enumerate(text.splitlines(), 1):
        line = " ".join(re.sub(r"[#!].*", "", raw).split()).lower()
        if not line:
            continue
        if any(line.startswith(key) for key in _OUTPUT) and not line.startswith("print time "):
            ignored.append(next(key for key in _OUTPUT if line.startswith(key)))
            continue
        key, _, value = line.rpartition(" ")
        if value in ("yes", "no") and key in _SWITCHES:
            on[key] = value == "yes"
        elif key in _NUMBERS:
            found = to_float(value)
            if not math.isfinite(found):
                raise InputError(f"input.dat: {key}", "is not a number", value=value)
            values[key] = found * _NUMBERS[key]
        else:
            raise InputError(f"input.dat, line {number}", "is not a key that is known here", value=line)
    method = {key for key in ("timestep", "integrator", "system") if key in values}
    return values, on, sorted(set(ignored) | method | {key for key in ("multiple step",) if key in on})


def _differences(
    s: SpunSettings, nominal: float, values: dict[str, float], on: dict[str, bool], step: float
) -> tuple[str, ...]:
    said = [
        f"flow rate: given here, {s.inlet.flow_rate:.4g} m3/s, {100 * s.inlet.speed:.4g} cm/s at the nozzle (the file's nozzle "
        f"velocity means {nominal:.4g} m3/s); JETSPIN's is an outcome of its length step and has no limit: where its PVP "
        "example says 0.283 cm/s, 175 pass at a step of 0.02 cm and 108 at 0.0025",
        f"law: {s.law.name}, G = {s.law.modulus:.4g} Pa at the same relaxation time {s.law.relaxation_time:.4g} s",
        "charge: a line softened by the radius, with a feed line upstream, not points",
    ]
    if s.surface_tension:
        said.append("surface tension: from the surface's energy, not per bead")
    if s.inlet.charge_density:
        surface = 2 * math.pi * 8.9875517873681764e9 * s.inlet.charge_density * s.inlet.radius
        if abs(surface) > 3e6:
            said.append(
                f"charge frozen at the nozzle: surface field {surface / 1e6:.3g} MV/m, over the breakdown of air (3)"
            )
    if values.get("nozzle stress"):
        said.append("nozzle stress: not set here; the tension at the nozzle comes from inside the jet")
    if on.get("dragvel"):
        said.append("dragvel: no meaning here, the speed at the nozzle is the flow rate's")
    if on.get("inserting") is False:
        said.append("inserting no: material enters all the time here, at the flow rate")
    if values.get("system") in (1.0, 2.0):
        said.append("one dimension: nothing here moves off the axis while nothing shakes it")
    if on.get("airdrag") and values.get("airdrag amplitude"):
        said.append("random force of the air: left out (JETSPIN's depends on the length step); ask for noise by name")
    if on.get("dynamic refinement"):
        said.append(f"refinement: an element longer than {s.grid.longest:.4g} m is halved; the others keep their nodes")
    return tuple(said)
