"""Polylines in VTK's XML format (``.vtp``, ``.vtu``): text, base64 or appended data, compressed by zlib or not."""

import base64
import binascii
import lzma
import re
import zlib
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.lagrangian import LagrangianJet
from spinline.jetprofile.readers.polyline import jet_of_points, length_scale
from spinline.jetprofile.readers.vtk_cells import LineCells, cells_of_types, grid_refused, poly_cells

__all__ = ["VtkXml"]

_TYPES = {"Float32": "f4", "Float64": "f8"}
_TYPES |= {f"Int{bits}": f"i{bits // 8}" for bits in (8, 16, 32, 64)}
_TYPES |= {f"UInt{bits}": f"u{bits // 8}" for bits in (8, 16, 32, 64)}
_LARGEST = 2**31  # bytes of one array
_TAGS = {"Verts": "VERTICES", "Lines": "LINES", "Polys": "POLYGONS", "Strips": "TRIANGLE_STRIPS"}
_PACKERS: dict[str, Callable[[], Any]] = {
    "vtkZLibDataCompressor": zlib.decompressobj,
    "vtkLZMADataCompressor": lzma.LZMADecompressor,
}
_NAMING = ("DataSet", "Piece")  # elements that name other files


class VtkXml:
    """Reader of VTK's XML files."""

    name = "VTK XML polyline"

    def claims(self, path: Path, head: bytes) -> bool:
        """By its root element."""
        return b"<VTKFile" in head

    def read(self, path: Path, *, unit: str | None = None, initial_radius: float | None = None) -> LagrangianJet:
        """VTK files carry no units: `unit` says that of places and radius alike."""
        scale = length_scale(unit, str(path), self.name)
        points, data, cells, found = _Xml(path.read_bytes(), str(path), self.name).parse()
        order, elements = found.order(len(points), str(path), self.name)
        return jet_of_points(
            points[order],
            {key: values[order] for key, values in data.items()},
            found.data(cells, elements),
            name=str(path),
            kind=self.name,
            scale=scale,
            initial_radius=initial_radius,
        )


class _Xml:
    """An XML file of VTK and its appended bytes."""

    def __init__(self, data: bytes, name: str, kind: str) -> None:
        self.name, self.kind = name, kind
        if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
            raise self._damaged("it declares entities")
        match = re.search(rb"<AppendedData\s+encoding=\"(\w+)\"\s*>\s*_", data)
        self.appended, self.encoding = b"", ""
        if match:
            end = data.rfind(b"</AppendedData>")
            self.appended, self.encoding = data[match.end() : end if end > 0 else len(data)], match[1].decode()
            data = data[: match.start()] + b"</VTKFile>"
        try:
            self.root = ElementTree.fromstring(data)
        except ElementTree.ParseError as error:
            raise self._damaged(str(error)) from None
        self.order = ">" if self.root.get("byte_order") == "BigEndian" else "<"
        self.header = np.dtype(self.order + _TYPES.get(self.root.get("header_type", "UInt32"), "u4"))
        packer = self.root.get("compressor", "")
        if packer not in ("", *_PACKERS):
            raise InputError(
                name,
                f"is compressed by {packer[:40]} ({kind})",
                allowed=", ".join(_PACKERS),
                remedy="write it with one of these, or without",
            )
        self.packed, self.engine = bool(packer), _PACKERS.get(packer, zlib.decompressobj)

    def parse(self) -> tuple[FloatArray, dict[str, FloatArray], dict[str, FloatArray], LineCells]:
        """Points, point data, cell data and lines of its only piece."""
        kind = self.root.get("type", "")
        if kind == "Collection" or (kind.startswith("P") and kind != "PolyData"):
            files = [one.get("file") or one.get("Source") or "" for one in self.root.iter() if one.tag in _NAMING]
            what = "a list of files" if kind == "Collection" else "the heading of a file in pieces"
            raise InputError(
                self.name,
                f"is {what} and holds no points ({self.kind}, {kind[:40]})",
                value=files[:3],
                remedy="give the file that holds the jet",
            )
        pieces = [one for one in self.root.iter("Piece") if one.get("NumberOfPoints") != "0"]
        if len(pieces) != 1:
            raise self._damaged(f"it has {len(pieces)} pieces with points")
        piece = pieces[0]
        holder = piece.find("Points")
        array = None if holder is None else holder.find("DataArray")
        if array is None:
            raise self._damaged("it has no points")
        points = self._values(array).astype(np.float64)
        if points.size % 3:
            raise self._damaged("its points have not three coordinates each")
        count = points.size // 3
        data = self._table(piece.find("PointData"), count)
        return points.reshape(-1, 3), data, self._table(piece.find("CellData"), None), self._lines(piece)

    def _lines(self, piece: "ElementTree.Element") -> LineCells:
        extent = piece.get("Extent")
        if extent is not None:
            edges = [int(word) for word in extent.split()]
            grid_refused([b - a + 1 for a, b in zip(edges[::2], edges[1::2], strict=False)], self.name, self.kind)
        found = {title: self._cells(piece.find(tag)) for tag, title in _TAGS.items()}
        holder = piece.find("Cells")
        if holder is None:
            return poly_cells(found, self.name, self.kind)
        types = next((array for array in holder.iter("DataArray") if array.get("Name") == "types"), None)
        if types is None:
            raise self._damaged("its cells have no types")
        return cells_of_types(self._cells(holder), self._values(types).astype(int).tolist(), self.name, self.kind)

    def _cells(self, holder: "ElementTree.Element | None") -> list[list[int]]:
        arrays = {} if holder is None else {array.get("Name"): array for array in holder.iter("DataArray")}
        if "connectivity" not in arrays or "offsets" not in arrays:
            return []
        joined = self._values(arrays["connectivity"]).astype(int).tolist()
        ends = self._values(arrays["offsets"]).astype(int).tolist()
        return [joined[a:b] for a, b in pairwise([0, *ends])]

    def _table(self, holder: "ElementTree.Element | None", count: int | None) -> dict[str, FloatArray]:
        table: dict[str, FloatArray] = {}
        for array in () if holder is None else holder.iter("DataArray"):
            if array.get("type") == "String":
                continue
            values, parts = self._values(array).astype(np.float64), int(array.get("NumberOfComponents", "1"))
            values = values if parts == 1 else values.reshape(-1, parts)
            if count is not None and len(values) != count:
                raise self._damaged(f"{array.get('Name')} has {len(values)} values for {count} points")
            table[str(array.get("Name"))] = values
        return table

    def _values(self, array: "ElementTree.Element") -> np.ndarray:
        code = _TYPES.get(array.get("type", ""))
        if code is None:
            raise self._damaged(f"an array of type {array.get('type')}")
        dtype = np.dtype(self.order + code)
        how = array.get("format", "ascii")
        try:
            if how == "ascii":
                return np.array(_text(array).split(), dtype=np.float64)
            if how == "appended":
                at = int(array.get("offset", "0"))
                raw = self.appended[at:] if self.encoding == "raw" else b""
                return np.frombuffer(self._unpacked(raw or self.appended[at:], self.encoding != "raw"), dtype)
            return np.frombuffer(self._unpacked(_text(array).strip().encode("ascii"), True), dtype)
        except (ValueError, binascii.Error, zlib.error, lzma.LZMAError, UnicodeEncodeError, IndexError) as error:
            raise self._damaged(f"{array.get('Name') or 'an array'} cannot be read ({error})") from None

    def _unpacked(self, data: bytes, text: bool) -> bytes:
        """Bytes of an array behind its header: a size, or block sizes of compressed data."""
        width = self.header.itemsize
        if not self.packed:
            if text:  # one stream with its header; some writers code the header for itself, so that it ends in "="
                first = 4 * -(-width // 3)
                apart = data[:first].endswith(b"=")
                data = base64.b64decode(data[:first]) + _decoded(data[first:]) if apart else _decoded(data)
            size = int(np.frombuffer(data[:width], self.header)[0])
            if size > min(_LARGEST, len(data) - width):
                raise ValueError("it is cut short")
            return data[width : width + size]
        if not text:
            blocks, whole, _ = (int(n) for n in np.frombuffer(data[: 3 * width], self.header))
            if blocks * width > len(data) or blocks * whole > _LARGEST:
                raise ValueError("its block sizes cannot be")
            sizes = np.frombuffer(data[3 * width : (3 + blocks) * width], self.header).astype(int)
            body = data[(3 + blocks) * width :]
        else:
            first = 4 * -(-3 * width // 3)
            blocks, whole, _ = (int(n) for n in np.frombuffer(base64.b64decode(data[:first]), self.header))
            if blocks * width > len(data) or blocks * whole > _LARGEST:
                raise ValueError("its block sizes cannot be")
            head = 4 * -(-(3 + blocks) * width // 3)
            sizes = np.frombuffer(base64.b64decode(data[:head]), self.header)[3:].astype(int)
            body = _decoded(data[head:])
        out, at = [], 0
        for size in sizes:
            if at + size > len(body):
                raise ValueError("it is cut short")
            out.append(self.engine().decompress(body[at : at + size], whole + 1))
            at += size
        return b"".join(out)

    def _damaged(self, why: str) -> InputError:
        return InputError(self.name, f"is damaged, or no {self.kind}: {why}", remedy="write the file again")


def _text(array: "ElementTree.Element") -> str:
    """What stands in an array, beside the keys of information that VTK puts into it."""
    return " ".join([array.text or "", *(child.tail or "" for child in array)])


def _decoded(data: bytes) -> bytes:
    """Base64 text up to the next array, which appended data has right behind."""
    ends = re.match(rb"[A-Za-z0-9+/\s]*={0,2}", data)
    text = re.sub(rb"\s", b"", ends[0] if ends else b"")
    return base64.b64decode(text[: len(text) // 4 * 4])
