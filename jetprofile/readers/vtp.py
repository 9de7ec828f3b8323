"""Polylines in VTK's XML format (``.vtp``, ``.vtu``): text, base64 or appended data, compressed by zlib or not."""

import base64
import binascii
import re
import zlib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.lagrangian import LagrangianJet
from spinline.jetprofile.readers.polyline import jet_of_points, length_scale
from spinline.jetprofile.readers.vtk_legacy import line_order

__all__ = ["VtkXml"]

_TYPES = {"Float32": "f4", "Float64": "f8"}
_TYPES |= {f"Int{bits}": f"i{bits // 8}" for bits in (8, 16, 32, 64)}
_TYPES |= {f"UInt{bits}": f"u{bits // 8}" for bits in (8, 16, 32, 64)}
_LARGEST = 2**31  # bytes of one array


class VtkXml:
    """Reader of VTK's XML files."""

    name = "VTK XML polyline"

    def claims(self, path: Path, head: bytes) -> bool:
        """By its root element."""
        return b"<VTKFile" in head

    def read(self, path: Path, *, unit: str | None = None, initial_radius: float | None = None) -> LagrangianJet:
        """VTK files carry no units: `unit` says that of places and radius alike."""
        scale = length_scale(unit, str(path), self.name)
        points, data, cells, lines = _Xml(path.read_bytes(), str(path), self.name).parse()
        order, elements = line_order(lines, len(points), str(path), self.name)
        return jet_of_points(
            points[order],
            {key: values[order] for key, values in data.items()},
            {
                key: values[elements]
                for key, values in cells.items()
                if elements is not None and len(values) > elements.max()
            },
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
        if packer not in ("", "vtkZLibDataCompressor"):
            raise self._damaged(f"it is compressed by {packer}; write it with zlib, or without")
        self.packed = bool(packer)

    def parse(self) -> tuple[FloatArray, dict[str, FloatArray], dict[str, FloatArray], list[list[int]]]:
        """Points, point data, cell data and lines of its only piece."""
        pieces = list(self.root.iter("Piece"))
        if len(pieces) != 1:
            raise self._damaged(f"it has {len(pieces)} pieces")
        piece = pieces[0]
        holder = piece.find("Points")
        array = None if holder is None else holder.find("DataArray")
        if array is None:
            raise self._damaged("it has no points")
        points = self._values(array).astype(np.float64)
        if points.size % 3:
            raise self._damaged("its points have not three coordinates each")
        lines: list[list[int]] = []
        for tag in ("Lines", "Cells"):
            found = piece.find(tag)
            arrays = {} if found is None else {a.get("Name"): a for a in found.iter("DataArray")}
            if "connectivity" in arrays and "offsets" in arrays:
                joined = self._values(arrays["connectivity"]).astype(int).tolist()
                ends = self._values(arrays["offsets"]).astype(int).tolist()
                lines += [joined[a:b] for a, b in zip([0, *ends[:-1]], ends, strict=True)]
        count = points.size // 3
        data = self._table(piece.find("PointData"), count)
        return points.reshape(-1, 3), data, self._table(piece.find("CellData"), None), lines

    def _table(self, holder: "ElementTree.Element | None", count: int | None) -> dict[str, FloatArray]:
        table: dict[str, FloatArray] = {}
        for array in () if holder is None else holder.iter("DataArray"):
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
                return np.array((array.text or "").split(), dtype=np.float64)
            if how == "appended":
                at = int(array.get("offset", "0"))
                raw = self.appended[at:] if self.encoding == "raw" else b""
                return np.frombuffer(self._unpacked(raw or self.appended[at:], self.encoding != "raw"), dtype)
            return np.frombuffer(self._unpacked((array.text or "").strip().encode("ascii"), True), dtype)
        except (ValueError, binascii.Error, zlib.error, UnicodeEncodeError, IndexError) as error:
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
            engine = zlib.decompressobj()
            out.append(engine.decompress(body[at : at + size], whole + 1))
            at += size
        return b"".join(out)

    def _damaged(self, why: str) -> InputError:
        return InputError(self.name, f"is damaged, or no {self.kind}: {why}", remedy="write the file again")


def _decoded(data: bytes) -> bytes:
    """Base64 text up to the next array, which appended data has right behind."""
    ends = re.match(rb"[A-Za-z0-9+/\s]*={0,2}", data)
    text = re.sub(rb"\s", b"", ends[0] if ends else b"")
    return base64.b64decode(text[: len(text) // 4 * 4])
