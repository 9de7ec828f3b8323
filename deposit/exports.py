"""Mats for other programs: ParaView, GeoDict, PoreSpy, OpenFOAM, spreadsheets.

==================  ==========================================================================================
`write_vtp`         VTK XML poly-data: centre lines with radius and fibre number (ParaView: filter *Tube* by radius)
`write_ply`         PLY, ASCII: vertices with radius, edges between them
`write_csv`         x, y, z, radius in m, and fibre
`write_tiff`        stack of planes from the bottom up, uint8: 0 in fibre, 1 in pores; resolution tag
`write_raw`         the same as raw bytes (x fastest) with a JSON file that says shape and voxel
==================  ==========================================================================================
"""

import io
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray, positive
from spinline.base.errors import InputError
from spinline.base.files import streaming, write_bytes, write_text
from spinline.deposit.stack import Stack

__all__ = ["write_csv", "write_ply", "write_raw", "write_tiff", "write_vtp"]


def write_vtp(path: str | Path, stack: Stack, *, force: bool = True) -> None:
    """Centre lines of a stack as VTK XML poly-data with data appended raw."""
    points, offsets = _points(stack), stack.passages.offsets
    fibre = np.repeat(stack.passages.fibre, np.diff(offsets)).astype("<i4")
    arrays: list[NDArray[np.generic]] = [
        stack.passages.radius.astype("<f4"),
        fibre,
        points.astype("<f4"),
        np.arange(len(points), dtype="<i8"),
        offsets[1:].astype("<i8"),
    ]
    starts = np.cumsum([0] + [8 + array.nbytes for array in arrays])
    kinds = ("Float32", "Int32", "Float32", "Int64", "Int64")
    names = ("radius", "fibre", "points", "connectivity", "offsets")

    def entry(k: int, components: int = 1) -> str:
        return (
            f'<DataArray type="{kinds[k]}" Name="{names[k]}" NumberOfComponents="{components}" '
            f'format="appended" offset="{starts[k]}"/>'
        )

    head = (
        '<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
        f'<PolyData><Piece NumberOfPoints="{len(points)}" NumberOfVerts="0" NumberOfLines="{offsets.size - 1}" '
        'NumberOfStrips="0" NumberOfPolys="0">\n'
        f'<PointData Scalars="radius">{entry(0)}{entry(1)}</PointData>\n<Points>{entry(2, 3)}</Points>\n'
        f'<Lines>{entry(3)}{entry(4)}</Lines>\n</Piece></PolyData>\n<AppendedData encoding="raw">\n_'
    )
    with streaming(path, force=force) as file:
        file.write(head.encode("ascii"))
        for array in arrays:
            file.write(np.uint64(array.nbytes).astype("<u8").tobytes())
            file.write(np.ascontiguousarray(array).tobytes())
        file.write(b"\n</AppendedData>\n</VTKFile>\n")


def write_ply(path: str | Path, stack: Stack, *, force: bool = True) -> None:
    """Centre lines of a stack as ASCII PLY: vertices (x, y, z, radius, fibre) and edges."""
    points, edges, fibre = _points(stack), _edges(stack), _fibres(stack)
    head = "ply\nformat ascii 1.0\ncomment lengths in m\n" + f"element vertex {len(points)}\n"
    head += "".join(f"property float {name}\n" for name in ("x", "y", "z", "radius"))
    head += f"property int fibre\nelement edge {len(edges)}\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    with streaming(path, force=force) as file:
        file.write(head.encode("ascii"))
        table = np.column_stack([points, stack.passages.radius, fibre])
        np.savetxt(file, table, fmt=["%.9g"] * 4 + ["%d"])
        np.savetxt(file, edges, fmt="%d")


def write_csv(path: str | Path, stack: Stack, *, force: bool = True) -> None:
    """Centre lines of a stack as a table with units in its header."""
    table = np.column_stack([_points(stack), stack.passages.radius, _fibres(stack)])
    with streaming(path, force=force) as file:
        np.savetxt(
            file,
            table,
            fmt=["%.9g"] * 4 + ["%d"],
            delimiter=",",
            header="x (m),y (m),z (m),radius (m),fibre",
            comments="",
        )


def write_tiff(path: str | Path, solid: BoolArray, voxel: float, *, force: bool = True) -> None:
    """Voxels as a TIFF stack, planes from the bottom up; pixels per centimetre in the resolution tag."""
    import tifffile

    size = positive("voxel", voxel, "m")
    planes = np.ascontiguousarray(np.transpose(_voxels(solid), (2, 1, 0)))
    per_cm = 0.01 / size
    file = io.BytesIO()
    tifffile.imwrite(
        file,
        (~planes).astype(np.uint8),
        photometric="minisblack",
        resolution=(per_cm, per_cm),
        resolutionunit="CENTIMETER",
        metadata={"spacing": size * 1e6, "unit": "um", "axes": "ZYX"},
    )
    write_bytes(path, file.getbuffer(), force=force)


def write_raw(path: str | Path, solid: BoolArray, voxel: float, *, force: bool = True) -> None:
    """Voxels as bytes, x fastest, 1 in pores, and beside them a JSON file with shape and voxel."""
    box = _voxels(solid)
    target = Path(path)
    write_bytes(target, np.transpose(~box, (2, 1, 0)).astype(np.uint8).tobytes(), force=force)
    about = {
        "shape": list(box.shape),
        "order": "x fastest",
        "type": "uint8",
        "fibre": 0,
        "pore": 1,
        "voxel_m": positive("voxel", voxel, "m"),
    }
    write_text(target.with_suffix(".json"), json.dumps(about, indent=1) + "\n", force=force)


def _points(stack: Stack) -> FloatArray:
    return np.column_stack([stack.passages.x, stack.passages.y, stack.axis_height])


def _fibres(stack: Stack) -> NDArray[np.int64]:
    return np.repeat(stack.passages.fibre, np.diff(stack.passages.offsets))


def _edges(stack: Stack) -> NDArray[np.int64]:
    joined = np.ones(stack.passages.x.size, dtype=bool)
    joined[stack.passages.offsets[1:] - 1] = False
    first = np.flatnonzero(joined)
    return np.column_stack([first, first + 1])


def _voxels(solid: BoolArray) -> BoolArray:
    box = np.asarray(solid)
    if box.dtype != np.bool_ or box.ndim != 3 or not box.size:
        raise InputError("solid", "must be voxels (x, y, z), True in fibre", value=f"{box.dtype}, shape {box.shape}")
    return box
