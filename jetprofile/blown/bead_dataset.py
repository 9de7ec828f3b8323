"""Beads of a blown jet, the straight part before them, as a Dataset that `LagrangianJet.from_dataset` takes.

The straight part is a chain of beads at equal steps of ln v; elements have their volume and the radius that follows. Speeds
against the air are against its mean, without gusts.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.jetprofile.blown.bead_jet import BeadRun, BeadState
from spinline.jetprofile.blown.straight_jet import BlownJet

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["bead_frames"]

_STRAIGHT = 60  # elements of the straight part
_BEAD = {
    "x": ("m", "position along the spinning axis, nozzle at 0"),
    "y": ("m", "position along the collector's motion"),
    "z": ("m", "position across it"),
    "arc_length": ("m", "distance from the nozzle along the jet"),
    "velocity_x": ("m s-1", "velocity along the spinning axis"),
    "velocity_y": ("m s-1", "velocity along the collector's motion"),
    "velocity_z": ("m s-1", "velocity across it"),
    "velocity": ("m s-1", "speed"),
}
_ELEMENT = {
    "element_length": ("m", "length of the element between bead i and bead i + 1"),
    "element_arc_length": ("m", "distance of the element's middle from the nozzle along the jet"),
    "radius": ("m", "radius of the jet"),
    "stretch_ratio": ("1", "length of the element over its length at the nozzle radius"),
    "strain_rate": ("s-1", "rate of elongation of the element"),
    "volume": ("m3", "volume of the element"),
    "axial_conformation": ("1", "A_zz of the polymer"),
    "radial_conformation": ("1", "A_rr of the polymer"),
    "air_slip": ("m s-1", "speed along the jet against the mean air"),
    "air_cross_slip": ("m s-1", "speed across the jet against the mean air"),
    "valid_element": ("", "element is whole and in flight"),
}


def bead_frames(jet: BlownJet, run: BeadRun) -> "xr.Dataset":
    """Every stored moment of a run behind its straight part, from the nozzle on, padded."""
    import xarray as xr

    ahead = _ahead(jet, float(run.position[-1, 0]))
    tables = [_moment(jet, ahead, state) for state in run.states]
    width = max(bead["x"].size for bead, _ in tables)
    data: dict[str, Any] = {}
    for names, pick, dim, wide in ((_BEAD, 0, "bead", width), (_ELEMENT, 1, "element", width - 1)):
        for name, (unit, words) in names.items():
            block = np.full((len(tables), wide), np.nan)
            for row, pair in enumerate(tables):
                block[row, : pair[pick][name].size] = pair[pick][name]
            about = {"long_name": words} | ({"units": unit} if unit else {})
            data[name] = (("time", dim), block == 1.0 if name == "valid_element" else block, about)
    data["n_bead"] = ("time", np.array([bead["x"].size for bead, _ in tables], dtype=np.int32), {"units": "1"})
    time = ("time", np.array([state.time for state in run.states]), {"units": "s", "long_name": "time"})
    whole: dict[str, Any] = {
        "nozzle_radius": jet.initial_radius,
        "bending_start": jet.solved.bending_start,
        "model": jet.model,
    }
    return xr.Dataset(data, coords={"time": time}, attrs=whole)


def _ahead(jet: BlownJet, start: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Places, velocities, element volumes and conformations (element, 2) of the straight part."""
    z = jet.solved.z[jet.solved.z < start]
    z = np.append(z, start)
    v = jet.velocity(z)
    rise = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(np.log(v))) + np.diff(z) / start)))
    places = np.interp(np.linspace(0.0, rise[-1], _STRAIGHT + 1), rise, z)
    volume = jet.flow_rate * np.diff(jet.residence_time(places))
    middle = 0.5 * (places[1:] + places[:-1])
    drawn = [
        np.interp(middle, jet.solved.z, getattr(jet.solved, f"{name}_conformation")) for name in ("axial", "radial")
    ]
    return places, jet.velocity(places), volume, np.stack(drawn, -1)


def _moment(
    jet: BlownJet, ahead: tuple[FloatArray, FloatArray, FloatArray, FloatArray], state: BeadState
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Beads and elements of one moment."""
    places, speeds, volume, drawn = ahead
    beads, elements = state.beads[::-1], state.elements[::-1]
    straight = np.zeros((places.size - 1, 6))
    straight[:, 0], straight[:, 3] = places[:-1], speeds[:-1]
    q = np.concatenate((straight, beads))
    volume = np.concatenate((volume, elements[:, 0]))
    drawn = np.concatenate((drawn, elements[:, 1:3]))
    step = np.diff(q[:, :3], axis=0)
    length = np.linalg.norm(step, axis=1)
    along = step / length[:, None]
    radius = np.sqrt(volume / (np.pi * length))
    middle, pace = 0.5 * (q[1:, :3] + q[:-1, :3]), 0.5 * (q[1:, 3:] + q[:-1, 3:])
    wind = np.zeros_like(pace)
    across = np.hypot(middle[:, 1], middle[:, 2])
    wind[:, 0] = jet.settings.air.velocity(np.maximum(middle[:, 0], 0.0), across)
    past = pace - wind
    slip = np.sum(past * along, axis=1)
    arc = np.concatenate(([0.0], np.cumsum(length)))
    whole = np.ones(length.size)
    down = state.landed[::-1]
    whole[places.size - 1 :][down[1:] | down[:-1]] = 0.0
    bead = dict(zip(("x", "y", "z", "velocity_x", "velocity_y", "velocity_z"), q.T, strict=True))
    bead |= {"arc_length": arc, "velocity": np.linalg.norm(q[:, 3:], axis=1)}
    element = {
        "element_length": length,
        "element_arc_length": arc[:-1] + 0.5 * length,
        "radius": radius,
        "stretch_ratio": (jet.initial_radius / radius) ** 2,
        "strain_rate": np.sum(np.diff(q[:, 3:], axis=0) * along, axis=1) / length,
        "volume": volume,
        "axial_conformation": drawn[:, 0],
        "radial_conformation": drawn[:, 1],
        "air_slip": slip,
        "air_cross_slip": np.linalg.norm(past - slip[:, None] * along, axis=1),
        "valid_element": whole,
    }
    return bead, element
