"""What a jet is: anything that says how it moves along its arc, and what is made of an object that says no more than that.

An object with the members of `Jet` is a jet; a run takes it as it is (`given_jet.complete` finds out the rest). What else a
jet may say of itself, and saves or sharpens a computation where it does:

====================  ==================================================================================================
``initial_radius``    r_0, m; else the radius at its start
``initial_velocity``  v_0, m/s; else from the residence time and V
``flow_rate``         Q, m3/s; else pi r_0^2 v_0
``position_of(V)``    first place where V is reached, NaN where never; else searched for
``kinks()``           places where the profile is not smooth, in initial radii from its start
``given``             "velocity" or "radius": what stays as it is when the jet dries
``time``              moments (s) that `at` picks from; none for a steady jet
``fields(place)``     further variables along it, by their names in a result
====================  ==================================================================================================
"""

from typing import Protocol, Self, runtime_checkable

from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray

__all__ = ["METHODS", "Jet"]

METHODS = ("radius", "velocity_ratio", "strain_rate", "residence_time", "stretch_ratio", "at")


@runtime_checkable
class Jet(Protocol):
    """A jet along its arc (the axis, of a straight one): arc length in m, arrays in, arrays out."""

    @property
    def start(self) -> float:
        """Where it begins, m."""

    @property
    def end(self) -> float:
        """Where it is no longer known, m; inf for a law."""

    def radius(self, z: ArrayLike, /) -> FloatArray:
        """Jet radius, m."""

    def velocity_ratio(self, z: ArrayLike, /) -> FloatArray:
        """``V = v / v_0``."""

    def strain_rate(self, z: ArrayLike, /) -> FloatArray:
        """Rate at which an element is stretched, 1/s."""

    def residence_time(self, z: ArrayLike, /) -> FloatArray:
        """Time since the start of the jet, s."""

    def stretch_ratio(self, z: ArrayLike, /) -> FloatArray:
        """Material stretch since the start of the jet."""

    def at(self, time: float | None = None) -> Self:
        """One moment of it; itself, where it is steady."""
