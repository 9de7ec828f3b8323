"""What a bead chain is made of: the parameters of Eq. (32a) and the flow that drags it."""

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spinline.base.checks import number, positive
from spinline.base.errors import InputError
from spinline.network.chain.flow import Flow
from spinline.network.force_laws import ForceLaw, force, law_code, stiffness

__all__ = ["Chain", "ChainError"]


class ChainError(ArithmeticError):
    """A chain that could not be followed in time; the message says when, why and what to change."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Chain:
    """Beads and springs along a jet, Eq. (32a); lengths by r_0, velocities by v_0, time by r_0 / v_0.

    Attributes
    ----------
    flow : Flow
        V(s, t).
    spacing : float
        ``h = xi_0 / r_0`` of the network, in [1e-9, 1].
    coupling : float
        alpha_v, in [1e-6, 1e18].
    spring : float
        c: 1 as printed, 3 for Gaussian strands; in [1e-3, 1e3].
    inertia : float
        I, in [0, 1e6]; 0 is the first-order system itself.
    law : {"linear", "lattice", "langevin", "fene"}
        Force law; the tension is ``T(w) = f(w / V_S) / f_0``, ``f_0 = 3 / V_S``.
    contour : float, optional
        ``V_S = xi_max / xi_0`` (1/phi in a theta solvent), in [1.01, 1e9]; all but "linear" need it.
    coarse_grain : float
        Strands joined into one, >= 1: the chain has beads every ``coarse_grain * spacing``. The coupling
        ``eps = c / alpha_v`` stays; the error is of second order in the spacing (see `coarse_graining_error`).
    entry : bool
        Whether beads enter at the nozzle; without, the near end is free too.

    Raises
    ------
    InputError
        For values out of range, naming the field.
    """

    flow: Flow
    spacing: float
    coupling: float
    spring: float = 1.0
    inertia: float = 0.0
    law: ForceLaw = "linear"
    contour: float | None = None
    coarse_grain: float = 1.0
    entry: bool = True

    def __post_init__(self) -> None:
        if not isinstance(self.flow, Flow):
            raise InputError("flow", "is not a Flow", value=type(self.flow).__name__, remedy="use Flow.from_jet")
        self._within("spacing", 1e-9, 1.0)
        self._within("coupling", 1e-6, 1e18)
        self._within("spring", 1e-3, 1e3)
        self._within("inertia", 0.0, 1e6)
        self._within("coarse_grain", 1.0, 1e9)
        if self.step > 0.25 * self.flow.length:
            remedy = "lower coarse_grain or spacing, or lengthen the jet"
            raise InputError("coarse_grain", "leaves fewer than four beads", value=self.coarse_grain, remedy=remedy)
        law_code(self.law)
        if self.contour is None:
            if self.law != "linear":
                remedy = "give xi_max / xi_0, 1 / phi in a theta solvent"
                raise InputError("contour", f'is needed by the "{self.law}" law', remedy=remedy)
        else:
            self._within("contour", 1.01, 1e9)

    def _within(self, field: str, least: float, most: float) -> None:
        """Check a parameter, and hold it as a float whatever it came as."""
        value = getattr(self, field)
        if least > 0:
            positive(field, value)
        object.__setattr__(self, field, number(field, value, least=least, most=most))

    @property
    def step(self) -> float:
        """Distance of the beads at rest, in initial radii; also the time between two entries."""
        return self.spacing * self.coarse_grain

    @property
    def elasticity(self) -> float:
        """``eps = c / alpha_v``."""
        return self.spring / self.coupling

    @property
    def rest_force(self) -> float:
        """``f_0 = 3 / V_S``; 3 where the contour is not given."""
        return 3.0 if self.contour is None else 3.0 / self.contour

    @cached_property
    def rest_tension(self) -> float:
        """T(1): the tension of a strand at rest, which a free end carries."""
        if self.contour is None or self.law == "linear":
            return 1.0
        return float(force(1 / self.contour, self.law, self.rest_force)) / self.rest_force

    @cached_property
    def rest_stiffness(self) -> float:
        """T'(1)."""
        if self.contour is None or self.law == "linear":
            return 1.0
        return float(stiffness(1 / self.contour, self.law, self.rest_force)) / 3

    def fingerprint(self) -> str:
        """Digest of every parameter and of the flow, to refuse a checkpoint of another chain."""
        digest = hashlib.sha256()
        numbers = (self.spacing, self.coupling, self.spring, self.inertia, self.contour, self.coarse_grain)
        digest.update(repr((*map(_plain, numbers), self.law, self.entry)).encode())
        for table in (self.flow.nodes, self.flow.times, self.flow.age, self.flow.slowness):
            digest.update(np.ascontiguousarray(table).tobytes())
        return digest.hexdigest()


def _plain(value: float | None) -> float | None:
    return None if value is None else float(value)
