"""A run as a Dataset that `LagrangianJet.from_dataset` takes: numbered from the nozzle, padded, SI."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun._chain_kernels import geometry
from spinline.jetprofile.spun.chain import parameters
from spinline.jetprofile.spun.run import SpunRun

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["landings", "to_dataset"]

_BEAD = {
    "x": ("m", "position along the spinning axis, nozzle at 0"),
    "y": ("m", "first lateral position"),
    "z": ("m", "second lateral position"),
    "arc_length": ("m", "distance from the nozzle along the jet"),
    "velocity_x": ("m s-1", "velocity along the spinning axis"),
    "velocity_y": ("m s-1", "first lateral velocity"),
    "velocity_z": ("m s-1", "second lateral velocity"),
    "velocity": ("m s-1", "speed"),
    "deposited": ("", "bead lies on the collector"),
}
_ELEMENT = {
    "element_length": ("m", "length of the element between bead i and bead i + 1"),
    "element_arc_length": ("m", "distance of the element's middle from the nozzle along the jet"),
    "radius": ("m", "radius of the jet"),
    "stretch_ratio": ("1", "length of the element over its length at the nozzle radius"),
    "strain_rate": ("s-1", "rate of elongation of the element, (dv . t)/l"),
    "stress": ("Pa", "first normal stress difference, with the solvent's"),
    "tension": ("N", "stress over the cross-section"),
    "axial_conformation": ("1", "A_zz of the polymer"),
    "radial_conformation": ("1", "A_rr of the polymer"),
    "volume": ("m3", "volume of the element"),
    "charge": ("C", "charge of the element"),
    "temperature": ("K", "temperature of the element"),
    "polymer_fraction": ("1", "volume fraction of polymer in the element"),
    "valid_element": ("", "element is whole and in flight"),
}
_DEPOSIT = {
    "deposit_time": ("s", "touch-down of the element's second end"),
    "deposit_time_front": ("s", "touch-down of its first end"),
    "deposit_x": ("m", "middle of the laid element along the spinning axis"),
    "deposit_y": ("m", "middle along the collector's motion, fixed in the collector"),
    "deposit_z": ("m", "middle across the collector"),
    "deposit_y0": ("m", "leading end, y"),
    "deposit_z0": ("m", "leading end, z"),
    "deposit_y1": ("m", "trailing end, y"),
    "deposit_z1": ("m", "trailing end, z"),
    "deposit_radius": ("m", "radius from the length in flight when the first end touched"),
    "deposit_stretch": ("1", "that length over the length at the nozzle radius"),
    "deposit_volume": ("m3", "volume"),
    "deposit_polymer_volume": ("m3", "volume of polymer"),
    "deposit_charge": ("C", "charge carried at landing"),
    "deposit_length": ("m", "chord laid on the collector"),
    "deposit_flight_length": ("m", "length in flight when the first end touched"),
    "deposit_speed": ("m s-1", "speed of the second end at touch-down"),
    "deposit_label": ("m3", "volume label of the trailing end, from the front"),
    "deposit_jet": ("1", "number of the jet"),
}


def to_dataset(
    run: SpunRun, *, reference_radius: float | None = None, attributes: dict[str, Any] | None = None
) -> "xr.Dataset":
    """Frames and landings of a run.

    Parameters
    ----------
    run : SpunRun
        With a frame or more.
    reference_radius : float, optional
        Radius where the stretch is 1, m; default: the inlet's. A jet handed over from a needle has the needle's.
    attributes : dict, optional
        Added to the result's.
    """
    import xarray as xr

    settings = run.chain.settings
    r0 = settings.inlet.radius if reference_radius is None else reference_radius
    p, k = parameters(settings)
    width = max(f.shape[0] for f in run.frames)
    bead = {name: np.full((len(run.frames), width), np.nan) for name in _BEAD}
    dry = settings.drying
    held = [name for name in _ELEMENT if dry is not None or name not in ("temperature", "polymer_fraction")]
    element = {name: np.full((len(run.frames), width - 1), np.nan) for name in held}
    for row, stored in enumerate(run.frames):
        _fill(row, stored, r0, p, k, bead, element)
    bead["deposited"] = bead["deposited"] == 1.0
    element["valid_element"] = element["valid_element"] == 1.0
    data: dict[str, Any] = {n: (("time", "bead"), v, _about(_BEAD[n])) for n, v in bead.items()}
    data |= {n: (("time", "element"), v, _about(_ELEMENT[n])) for n, v in element.items()}
    data["n_bead"] = ("time", np.array([f.shape[0] for f in run.frames], dtype=np.int32), {"units": "1"})
    data |= {n: (("deposit",), v, _about(_DEPOSIT[n])) for n, v in _landings(run, r0).items()}
    time = ("time", np.array(run.times), {"units": "s", "long_name": "time"})
    about = {"nozzle_radius": r0, "collector_distance": settings.loads.gap, "seed": settings.seed} | _balance(run)
    return xr.Dataset(data, coords={"time": time}, attrs=about | (attributes or {}))


def _about(words: tuple[str, str]) -> dict[str, str]:
    return {"long_name": words[1]} | ({"units": words[0]} if words[0] else {})


def _fill(
    row: int,
    stored: FloatArray,
    r0: float,
    p: FloatArray,
    k: c.IntArray,
    bead: dict[str, FloatArray],
    element: dict[str, FloatArray],
) -> None:
    """One frame, from the nozzle on."""
    n = stored.shape[0] - 1
    work = np.zeros((c.WORK, n + 1))
    state = np.ascontiguousarray(stored[:, : c.COLUMNS])
    geometry(n, state, p, k, work)
    back = slice(None, None, -1)
    length = work[c.LENGTH, :n][back]
    arc = np.concatenate(([0.0], np.cumsum(length)))
    speed = np.linalg.norm(state[:, c.VX : c.VX + 3], axis=1)
    nodes = dict(zip(("x", "y", "z", "velocity_x", "velocity_y", "velocity_z"), state[:, :6].T, strict=True))
    nodes |= {"velocity": speed, "deposited": stored[:, c.COLUMNS]}
    for name, values in nodes.items():
        bead[name][row, : n + 1] = values[back]
    bead["arc_length"][row, : n + 1] = arc
    area = work[c.AREA, :n]
    pull = work[c.POLYMER, :n] + 3 * work[c.SOLVENT_HERE, :n] * work[c.RATE, :n] * area
    held = stored[:, c.COLUMNS] == 1.0
    own = {
        "element_length": work[c.LENGTH, :n],
        "radius": np.sqrt(area / math.pi),
        "stretch_ratio": work[c.LENGTH, :n] * math.pi * r0**2 / state[:n, c.LABEL],
        "strain_rate": work[c.RATE, :n],
        "stress": pull / area,
        "tension": pull,
        "axial_conformation": state[:n, c.AZZ],
        "radial_conformation": state[:n, c.ARR],
        "volume": state[:n, c.VOLUME],
        "charge": state[:n, c.CHARGE],
        "temperature": state[:n, c.TEMP],
        "polymer_fraction": p[c.FRACTION] * state[:n, c.LABEL] / state[:n, c.VOLUME],
        "valid_element": (~held[1:] & ~held[:-1]).astype(float),
    }
    for name, values in own.items():
        if name in element:
            element[name][row, :n] = values[back]
    element["element_arc_length"][row, :n] = 0.5 * (arc[1:] + arc[:-1])


def _landings(run: SpunRun, r0: float) -> dict[str, FloatArray]:
    rows = run.chain.deposited if run.chain.settings.collector.kind != "none" else run.chain.landed[:0]
    middle = 0.5 * (rows[:, c.D_X0 : c.D_Z0 + 1] + rows[:, c.D_X1 : c.D_Z1 + 1])
    chord = np.linalg.norm(rows[:, c.D_X1 : c.D_Z1 + 1] - rows[:, c.D_X0 : c.D_Z0 + 1], axis=1)
    flight, volume, label = rows[:, c.D_FLIGHT], rows[:, c.D_VOLUME], rows[:, c.D_LABEL_VOLUME]
    drying = run.chain.settings.drying
    return {
        "deposit_time": rows[:, c.D_TIME],
        "deposit_time_front": rows[:, c.D_FRONT],
        "deposit_x": middle[:, 0],
        "deposit_y": middle[:, 1],
        "deposit_z": middle[:, 2],
        "deposit_y0": rows[:, c.D_Y0],
        "deposit_z0": rows[:, c.D_Z0],
        "deposit_y1": rows[:, c.D_Y1],
        "deposit_z1": rows[:, c.D_Z1],
        "deposit_radius": np.sqrt(volume / (math.pi * flight)),
        "deposit_stretch": flight * math.pi * r0**2 / label,
        "deposit_volume": volume,
        "deposit_polymer_volume": label * (drying.fraction if drying else 1.0),
        "deposit_charge": rows[:, c.D_CHARGE],
        "deposit_length": chord,
        "deposit_flight_length": flight,
        "deposit_speed": np.linalg.norm(rows[:, c.D_VX : c.D_VZ + 1], axis=1),
        "deposit_label": rows[:, c.D_LABEL],
        "deposit_jet": np.zeros(len(rows), dtype=np.int64),
    }


def _balance(run: SpunRun) -> dict[str, float]:
    """What came in against what is there, of volume at the nozzle; and the current where charge moves."""
    chain = run.chain
    inlet = chain.settings.inlet
    there = chain.state[: chain.n, c.LABEL].sum() + chain.deposited[:, c.D_LABEL_VOLUME].sum()
    out = {"flow_rate": inlet.flow_rate, "volume_now": float(there)}
    if chain.settings.conductivity > 0.0:
        out["current"] = float(chain.clock[7])
    elif inlet.charge_density:
        out["current"] = inlet.charge_density * inlet.flow_rate
    return out


def landings(run: SpunRun) -> "xr.Dataset":
    """What has landed, as `spinline.deposit.LandingRecord.from_dataset` takes it: one row per node, laboratory frame.

    The first row is the leading end of the first element; its velocity was not kept (NaN).
    """
    import xarray as xr

    chain, s = run.chain, run.chain.settings
    rows = chain.deposited
    first = rows[:1]
    time = np.concatenate((first[:, c.D_FRONT], rows[:, c.D_TIME]))
    place = np.concatenate((first[:, c.D_X0 : c.D_Z0 + 1], rows[:, c.D_X1 : c.D_Z1 + 1]))
    if s.collector.kind == "belt":
        place[:, 1] += s.collector.speed * time
    unknown = np.full(len(first), np.nan)
    dry = s.drying.fraction if s.drying else 1.0
    richer = rows[:, c.D_LABEL_VOLUME] / rows[:, c.D_VOLUME] if s.drying else np.ones(len(rows))
    data = {
        "touch_time": time,
        "x": place[:, 0],
        "y": place[:, 1],
        "z": place[:, 2],
        "volume": np.concatenate((0 * unknown, rows[:, c.D_VOLUME])),
        "polymer_fraction": np.concatenate((unknown, dry * richer)),
        "flight_length": np.concatenate((unknown, rows[:, c.D_FLIGHT])),
        "charge": np.concatenate((0 * unknown, rows[:, c.D_CHARGE])),
    }
    data["volume"][: len(first)] = data["charge"][: len(first)] = 0.0
    for axis in range(3):
        data["v" + "xyz"[axis]] = np.concatenate((unknown, rows[:, c.D_VX + axis]))
    out: dict[str, Any] = {name: (("landing",), values) for name, values in data.items()}
    out |= {name: (("landing",), np.zeros(len(time), dtype=np.int64)) for name in ("jet", "fibre")}
    y, n = chain.state, chain.n
    flying = float(y[:n, c.VOLUME].sum())
    fed = float(y[:n, c.LABEL].sum() + rows[:, c.D_LABEL_VOLUME].sum())
    about = {
        "collector_kind": s.collector.kind,
        "collector_distance": s.loads.gap,
        "nozzle_radius": s.inlet.radius,
        "liquid_density": s.density,
        "volume_fed": fed,
        "volume_in_flight": flying,
        "volume_evaporated": fed - flying - float(rows[:, c.D_VOLUME].sum()),
        "charge_in_flight": float(y[:n, c.CHARGE].sum()),
    }
    return xr.Dataset(out, attrs=about)
