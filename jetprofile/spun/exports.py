"""A spun jet for other programs: VTK (ParaView), one file a moment, and extended XYZ (VMD, OVITO), one file in all."""

from typing import TYPE_CHECKING

import numpy as np

from spinline.base.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["vtk_text", "xyz_text"]


def vtk_text(dataset: "xr.Dataset", index: int = -1) -> str:
    """Legacy VTK of one moment: the centre-line as a polyline, radius, stretch, speed and charge per length at its points.

    Parameters
    ----------
    dataset : Dataset
        Result of a spun jet.
    index : int
        Which moment.
    """
    frame = dataset.isel(time=index)
    there = np.isfinite(frame["x"].values)
    points = np.stack([frame[name].values[there] for name in "xyz"], axis=-1)
    if len(points) < 2:
        raise InputError("time", "holds no jet", value=index)
    lines = [
        "# vtk DataFile Version 3.0",
        f"spun jet at {float(frame['time']):.9g} s, SI units",
        "ASCII",
        "DATASET POLYDATA",
        f"POINTS {len(points)} double",
        *(f"{x:.9g} {y:.9g} {z:.9g}" for x, y, z in points),
        f"LINES 1 {len(points) + 1}",
        " ".join(map(str, [len(points), *range(len(points))])),
        f"POINT_DATA {len(points)}",
    ]
    length = frame["element_length"].values[: len(points) - 1]
    fields = {
        "radius": frame["radius"].values,
        "stretch_ratio": frame["stretch_ratio"].values,
        "line_charge": frame["charge"].values[: len(points) - 1] / length,
    }
    for name, values in fields.items():
        own = values[: len(points) - 1]
        at = np.concatenate((own[:1], 0.5 * (own[1:] + own[:-1]), own[-1:]))
        lines += [f"SCALARS {name} double 1", "LOOKUP_TABLE default", *(f"{v:.9g}" for v in at)]
    lines += ["SCALARS speed double 1", "LOOKUP_TABLE default", *(f"{v:.9g}" for v in frame["velocity"].values[there])]
    return "\n".join(lines) + "\n"


def xyz_text(dataset: "xr.Dataset") -> str:
    """Extended XYZ of all moments: beads from the nozzle on, positions in m, radius of the element behind each bead."""
    parts = []
    for index in range(dataset.sizes["time"]):
        frame = dataset.isel(time=index)
        there = np.isfinite(frame["x"].values)
        x = np.stack([frame[name].values[there] for name in "xyz"], axis=-1)
        radius = np.concatenate((frame["radius"].values[: len(x) - 1], frame["radius"].values[len(x) - 2 : len(x) - 1]))
        parts.append(str(len(x)))
        parts.append(f"Properties=species:S:1:pos:R:3:radius:R:1 Time={float(frame['time']):.9g} unit=m")
        parts += [f"C {a:.9e} {b:.9e} {c:.9e} {r:.9e}" for (a, b, c), r in zip(x, radius, strict=True)]
    return "\n".join(parts) + "\n"
