"""Many scenes that differ in numbers only, as columns: solution, straight jets and coupling with a leading axis.

The `Context` of a million scenes at once, for the stages that have closed forms. Rows outside the formulas' ranges are marked,
not refused: they are left to be run one by one, which says what is wrong with them.
"""

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile import hyperbolic, power_law
from spinline.jetprofile.k_estimate import estimate_k
from spinline.jetprofile.many import StraightJets
from spinline.network.coupling import elastic_coupling
from spinline.network.mesh import network_at_rest
from spinline.rheology.solution import Solution
from spinline.rheology.solution import volume_fraction as fraction_by_volume
from spinline.scene.file import HyperbolicJet, PowerLawJet, Scene, SolventData
from spinline.setup.coupling import drag_of_solvent
from spinline.setup.densities import densities

__all__ = ["Batch", "has_jets"]

_MOST_STRETCH = 1e100


def has_jets(scene: Scene) -> bool:
    """Whether the scene's jet has a law that serves many at once."""
    return isinstance(scene.jet, PowerLawJet | HyperbolicJet)


class Batch:
    """Rows of scenes.

    Parameters
    ----------
    scene, solution
        One of them: what does not vary.
    values : mapping
        Key of the scene to a column (rows,), SI.
    rows : int

    Attributes
    ----------
    volume_fraction : ndarray, (rows,)
        phi; 1/2 where the row is not usable.
    jets : StraightJets
    length : ndarray
        m; of every row, or of all.
    end_stretch : ndarray, (rows,)
        V at the end; 1 where the row is not usable.
    usable : ndarray of bool, (rows,)
        Rows within the ranges of the formulas.
    """

    def __init__(self, scene: Scene, solution: Solution, values: Mapping[str, FloatArray], rows: int) -> None:
        self.scene, self.solution, self.values, self.rows = scene, solution, values, rows
        phi = self._fraction()
        self.jets = self._jets()
        self.length: FloatArray = np.asarray(self.of("jet.length"))
        stretch = self.jets.velocity_ratio(np.atleast_1d(self.length))
        good = (phi > 1e-9) & (phi < 1 - 1e-9) & self.jets.usable & (stretch < _MOST_STRETCH) & np.isfinite(stretch)
        self.usable: BoolArray = np.broadcast_to(good, (rows,))
        self.volume_fraction: FloatArray = np.where(self.usable, phi, 0.5)
        self.end_stretch: FloatArray = np.where(self.usable, np.broadcast_to(stretch, (rows,)), 1.0)

    def taking(self, rows: Any, scene: Scene | None = None) -> "Batch":
        """Some of the rows; of a scene with another rung."""
        values = {key: column[rows] for key, column in self.values.items()}
        return Batch(scene or self.scene, self.solution, values, int(np.arange(self.rows)[rows].size))

    def all(self, key: str) -> FloatArray:
        """Values of a key in every row, (rows,)."""
        return np.broadcast_to(np.asarray(self.of(key), dtype=np.float64), (self.rows,))

    def of(self, key: str) -> Any:
        """Values of a key: the column where it varies, the scene's own elsewhere, None where it has none."""
        if key in self.values:
            return self.values[key]
        if key == "solution.kuhn_length":  # the library's, where the scene gives none
            return np.asarray(self.solution.kuhn_length)
        section, _, name = key.partition(".")
        measured = getattr(getattr(self.scene, section), name)
        return None if measured is None else np.asarray(getattr(measured, "value", measured))

    @cached_property
    def full_stretch(self) -> FloatArray:
        """V_S, the stretch at which a strand is its contour, (rows,)."""
        return network_at_rest(self.volume_fraction, self.scene.network.solvent_quality).full_stretch

    @cached_property
    def coupling(self) -> FloatArray | None:
        """alpha_v of Eq. (33); None where the viscosity is not known."""
        given = self.of("network.coupling")
        if given is not None:
            return np.asarray(given)
        viscosity = self._drag()
        if viscosity is None:
            return None
        xi = network_at_rest(self.volume_fraction, self.scene.network.solvent_quality).size * self.of(
            "solution.kuhn_length"
        )
        jets = self.jets
        return elastic_coupling(
            xi, jets.initial_velocity, viscosity, jets.initial_radius, self.of("solution.temperature")
        )

    def _drag(self) -> Any:
        drag = self.scene.network.drag_viscosity
        if drag == "solution":
            return self.of("solution.viscosity")
        own = self.of("solution.solvent_viscosity") if drag == "solvent" else np.asarray(getattr(drag, "value", None))
        if own is not None:
            return own
        try:
            return drag_of_solvent(self.scene, self.solution, "alpha_v")[0]
        except InputError:
            return None

    def _jets(self) -> StraightJets:
        radius, flow_rate = self.of("jet.radius"), self.of("jet.flow_rate")
        if isinstance(self.scene.jet, HyperbolicJet):
            return StraightJets(hyperbolic, (self.of("jet.p"),), radius, flow_rate, 0.0, True)
        k, beta = self.of("jet.k"), self.of("jet.beta")
        if k is None:
            k = estimate_k(
                radius=radius,
                flow_rate=flow_rate,
                conductivity=self.of("jet.conductivity"),
                viscosity=self.of("solution.viscosity"),
                electric_field=self.of("jet.electric_field"),
            )
        onset = _powers(np.asarray(k), np.asarray(-1 / beta))
        return StraightJets(power_law, (onset, beta), radius, flow_rate, onset, (k > 1e-9) & (k < 1e9))

    def _fraction(self) -> FloatArray:
        """Phi of every row; NaN where the solvent is no liquid."""
        s = self.scene.solution
        if s.mass_fraction is None:
            return np.asarray(self.of("solution.volume_fraction"))
        polymer, solvent = self.of("solution.polymer_density"), self.of("solution.solvent_density")
        polymer = self.solution.polymer.density if polymer is None else polymer
        if solvent is None:
            solvent = np.asarray(self.solution.solvent_density)
            if "solution.temperature" in self.values and not isinstance(s.solvent, SolventData):
                solvent = densities(self.solution.solvent, self.values["solution.temperature"])
        known = np.isfinite(solvent)
        phi = fraction_by_volume(self.of("solution.mass_fraction"), polymer, np.where(known, solvent, 1.0))
        return np.where(known, phi, np.nan)


def _powers(base: FloatArray, exponent: FloatArray) -> FloatArray:
    """Powers by the very function that a single jet uses: numpy's own for arrays may differ in the last digit."""
    both = np.broadcast_arrays(base, exponent)
    flat = (one.ravel().tolist() for one in both)
    found: FloatArray = np.reshape([_power(x, y) for x, y in zip(*flat, strict=True)], both[0].shape)
    return found


def _power(x: float, y: float) -> float:
    try:
        return x**y if x > 0 else float("nan")
    except OverflowError:
        return float("nan")
