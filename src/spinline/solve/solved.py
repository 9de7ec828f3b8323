"""What a scene gives, as plain arrays: before it is a Dataset."""

from typing import Any, NamedTuple

from spinline.base.checks import FloatArray
from spinline.scene.file import Scene

__all__ = ["Solved"]


class Solved(NamedTuple):
    """What `run` puts into a Dataset, as plain arrays.

    Attributes
    ----------
    fields : dict of str to ndarray
        Variables along the jet.
    scalars : dict of str to float
        Numbers (arrays along time for a bead jet of many times).
    attributes : dict
        Models, reasons, inputs.
    remarks : list of str
        What is odd about the scene.
    jet : Jet
    scene : Scene
        With the rung and the effects that were taken.
    """

    fields: dict[str, FloatArray]
    scalars: dict[str, Any]
    attributes: dict[str, Any]
    remarks: list[str]
    jet: Any
    scene: Scene
