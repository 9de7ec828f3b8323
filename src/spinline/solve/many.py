"""The stages on many scenes at once: networks along straight jets that are formulas, affine or of a rung that has `rows`.

The same functions as in `spinline.solve.stages`, with one row a scene: results are those of single runs to rounding.
"""

from collections.abc import Sequence

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.network.crossover import crossover_velocity_ratio, extension_velocity_ratio
from spinline.network_models.registry import RUNGS, rung_of, simplest
from spinline.network_models.rung import Rung
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
    """Numbers of every row, by their names in a sweep; NaN at the end of a row that has to be run by itself."""
    rung = rung_of(batch.scene.network.model) if batch.scene.network.model in RUNGS else simplest()
    return _slipping_numbers(batch, rung) if rung.slips else _moving_numbers(batch)


def _moving_numbers(batch: Batch) -> dict[str, FloatArray]:
    """Of networks that move with the solution."""
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
    return _summary(batch, found, reached, _network(batch, there), _network(batch, batch.end_stretch))


def _slipping_numbers(batch: Batch, rung: Rung) -> dict[str, FloatArray]:
    """Of networks of their own velocity: both criteria are asked of their strands."""
    jets, length = batch.jets, np.broadcast_to(batch.length, (batch.rows,))
    wanted = np.stack([np.broadcast_to(v, (batch.rows,)) for v in batch_targets(batch)], axis=1)
    solved = rung.rows(batch, np.stack((np.zeros(batch.rows), length), axis=1), wanted)
    stretch, passed = (np.full((batch.rows, 2), np.nan) for _ in range(2)) if solved is None else solved
    found: dict[str, FloatArray] = {"volume_fraction": batch.volume_fraction}
    late = np.isnan(passed)
    for i, name in enumerate(("crossover", "crossover_extension")):
        place = np.minimum(passed[:, i] * jets.initial_radius, jets.end)
        ratio = jets.velocity_ratio(np.where(late[:, i], 0.0, place))
        radius = np.where(late[:, i], np.nan, jets.initial_radius / np.sqrt(ratio))
        found |= {
            f"{name}_position": place,
            f"{name}_radius": radius,
            f"{name}_radius_ratio": radius / jets.initial_radius,
            f"{name}_velocity_ratio": wanted[:, i],
        }
    reached = ~late[:, 0]
    there = np.where(reached, jets.velocity_ratio(np.where(reached, found["crossover_position"], 0.0)), 1.0)
    usable = stretch[:, 1] > 0
    middle = np.where(
        passed[:, 0] > 0, wanted[:, 0], stretch[:, 0]
    )  # no contour: stretched by the target, or more at the nozzle
    middle = np.where(usable & reached, middle, 1.0)
    at_end = _network(batch, batch.end_stretch, np.where(usable, stretch[:, 1], 1.0))
    found = _summary(batch, found, reached, _network(batch, there, middle), at_end)
    return {name: np.where(usable, column, np.nan) for name, column in found.items()}


def _summary(
    batch: Batch,
    found: dict[str, FloatArray],
    reached: BoolArray,
    middle: dict[str, FloatArray],
    state: dict[str, FloatArray],
) -> dict[str, FloatArray]:
    """`found` with the network at the crossover and at the end."""
    found |= {f"crossover_{name}": np.where(reached, middle[name], np.nan) for name in SUMMARISED}
    found |= {f"end_{name}": state[name] for name in AT_END}
    found["fibre_radius"] = state["radius"] * np.sqrt(state["mean_polymer_fraction"])
    found["fibre_diameter"] = 2 * found["fibre_radius"]
    return {name: np.broadcast_to(column, (batch.rows,)) for name, column in found.items()}


def batch_profiles(batch: Batch, names: Sequence[str], z: FloatArray) -> dict[str, FloatArray]:
    """Variables along the jets at places (rows, points), m."""
    jets = batch.jets
    ratio = jets.velocity_ratio(z)
    rung = rung_of(batch.scene.network.model) if batch.scene.network.model in RUNGS else simplest()
    moved = None
    if rung.slips:
        solved = rung.rows(batch, z, np.full((batch.rows, 0), np.nan))
        moved = np.full(z.shape, np.nan) if solved is None else solved[0]
        moved = np.where(moved > 0, moved, 1.0)  # of rows that are not used
    fields = {"z": z, **_network(batch, ratio, moved), "stretch_ratio": ratio}
    for name, along in (
        ("velocity", jets.velocity),
        ("strain_rate", jets.strain_rate),
        ("residence_time", jets.residence_time),
    ):
        if name in names:
            fields[name] = along(z)
    return {name: fields[name] for name in names}


def _network(batch: Batch, stretch: FloatArray, moved: FloatArray | None = None) -> dict[str, FloatArray]:
    """The network stage where the jets are stretched by V, (rows,) or (rows, points), and a network that slips by w."""
    n = batch.scene.network

    def tall(values: FloatArray) -> FloatArray:
        return np.reshape(values, (-1, 1)) if stretch.ndim == 2 else values

    radius = tall(batch.jets.initial_radius) / np.sqrt(stretch)
    found = network_variables(
        stretch if moved is None else moved,
        stretch,
        radius,
        tall(batch.volume_fraction),
        closure=n.closure_used,
        solvent_quality=n.solvent_quality,
        kuhn_length=tall(batch.of("solution.kuhn_length")),
        temperature=tall(batch.of("solution.temperature")),
        velocity=moved,
    )
    return {**found, "radius": radius, "velocity_ratio": stretch}
