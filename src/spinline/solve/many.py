"""The stages on many scenes at once, where they have closed forms: affine networks along straight jets.

The same functions as in `spinline.solve.stages`, with one row a scene: results are those of single runs to rounding.
"""

from collections.abc import Sequence

import numpy as np

from spinline.base.checks import FloatArray
from spinline.network.crossover import crossover_velocity_ratio, extension_velocity_ratio
from spinline.network_models.variables import network_variables
from spinline.setup.batch import Batch
from spinline.solve.crossovers import passages
from spinline.solve.summary import SUMMARISED

__all__ = ["AT_END", "batch_numbers", "batch_profiles", "batch_targets"]

AT_END = ("radius", "velocity_ratio", *SUMMARISED, "mean_polymer_fraction")


def batch_targets(batch: Batch) -> tuple[FloatArray, FloatArray]:
    """V of both criteria in every row."""
    n, phi = batch.scene.network, batch.volume_fraction
    reach = extension_velocity_ratio(
        batch.of("network.crossover_extension"), phi, closure=n.closure_used, solvent_quality=n.solvent_quality
    )
    return crossover_velocity_ratio(phi, n.solvent_quality), np.broadcast_to(reach, (batch.rows,))


def batch_numbers(batch: Batch) -> dict[str, FloatArray]:
    """Numbers of every row, by their names in a sweep."""
    phi, jets, length = batch.volume_fraction, batch.jets, batch.length
    found: dict[str, FloatArray] = {"volume_fraction": phi}
    for name, target in zip(("crossover", "crossover_extension"), batch_targets(batch), strict=True):
        place, radius, _ = passages(jets, target, length)
        found |= {
            f"{name}_position": place,
            f"{name}_radius": radius,
            f"{name}_radius_ratio": radius / jets.initial_radius,
            f"{name}_velocity_ratio": target,
        }
    place = found["crossover_position"]
    reached = np.isfinite(place)
    there = np.where(reached, jets.velocity_ratio(np.where(reached, place, 0.0)), 1.0)
    state = _network(batch, there)
    found |= {f"crossover_{name}": np.where(reached, state[name], np.nan) for name in SUMMARISED}
    state = _network(batch, batch.end_stretch)
    found |= {f"end_{name}": state[name] for name in AT_END}
    found["fibre_radius"] = state["radius"] * np.sqrt(state["mean_polymer_fraction"])
    found["fibre_diameter"] = 2 * found["fibre_radius"]
    return {name: np.broadcast_to(column, (batch.rows,)) for name, column in found.items()}


def batch_profiles(batch: Batch, names: Sequence[str], z: FloatArray) -> dict[str, FloatArray]:
    """Variables along the jets at places (rows, points), m."""
    jets = batch.jets
    ratio = jets.velocity_ratio(z)
    fields = {"z": z, **_network(batch, ratio), "stretch_ratio": ratio}
    for name, along in (
        ("velocity", jets.velocity),
        ("strain_rate", jets.strain_rate),
        ("residence_time", jets.residence_time),
    ):
        if name in names:
            fields[name] = along(z)
    return {name: fields[name] for name in names}


def _network(batch: Batch, stretch: FloatArray) -> dict[str, FloatArray]:
    """The network stage where the jets are stretched by V, (rows,) or (rows, points)."""
    n = batch.scene.network

    def tall(values: FloatArray) -> FloatArray:
        return np.reshape(values, (-1, 1)) if stretch.ndim == 2 else values

    radius = tall(batch.jets.initial_radius) / np.sqrt(stretch)
    found = network_variables(
        stretch,
        stretch,
        radius,
        tall(batch.volume_fraction),
        closure=n.closure_used,
        solvent_quality=n.solvent_quality,
        kuhn_length=tall(batch.of("solution.kuhn_length")),
        temperature=tall(batch.of("solution.temperature")),
    )
    return {**found, "radius": radius, "velocity_ratio": stretch}
