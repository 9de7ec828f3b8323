"""Jets of other programs: every format read to the same jet; every reader passes one suite; damage is one message."""

import base64
import re
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import spinline as sl
from spinline.base.errors import InputError
from spinline.jetprofile import LagrangianJet
from spinline.jetprofile.readers import choose, read_beads, readers, register_reader

RUN = Path(sl.__file__).parent / "data" / "scenes" / "pvp3d"
N = 30
S = np.linspace(0.0, 2.0, N)
POINTS = np.column_stack([S, 0.3 * np.sin(3 * S) * S, 0.3 * (1 - np.cos(3 * S)) * S])  # cm
RADIUS = 0.005 / (1 + 20 * S)  # cm, at beads
VELOCITY = np.column_stack([10 + 50 * S, 3 * S, -S])


def element(values):
    return 0.5 * (values[1:] + values[:-1])


@pytest.fixture
def reference():
    return LagrangianJet.from_arrays(
        *(POINTS.T * 1e-2), initial_radius=element(RADIUS)[0] * 1e-2, radius=element(RADIUS) * 1e-2
    )


def legacy(binary=False, version="3.0", order=None, diameter=False, cells="line"):
    order = np.arange(N) if order is None else order
    pts, rad = np.empty_like(POINTS), np.empty_like(RADIUS)
    pts[order], rad[order] = POINTS, RADIUS * (2 if diameter else 1)

    def block(values, kind):
        values = np.asarray(values)
        if binary:
            return values.astype({"double": ">f8", "int": ">i4", "vtktypeint64": ">i8"}[kind]).tobytes() + b"\n"
        return (" ".join(f"{v:.17g}" for v in values.ravel()) + "\n").encode()

    out = f"# vtk DataFile Version {version}\njet\n{'BINARY' if binary else 'ASCII'}\nDATASET POLYDATA\n".encode()
    out += f"POINTS {N} double\n".encode() + block(pts, "double")
    if version == "5.1":
        out += f"LINES 2 {N}\nOFFSETS vtktypeint64\n".encode() + block([0, N], "vtktypeint64")
        out += b"CONNECTIVITY vtktypeint64\n" + block(order, "vtktypeint64")
    elif cells == "line":
        out += f"LINES 1 {N + 1}\n".encode() + block([N, *order], "int")
    elif cells == "pairs":
        out += f"LINES {N - 1} {3 * (N - 1)}\n".encode()
        out += block(np.column_stack([np.full(N - 1, 2), order[:-1], order[1:]]), "int")
    out += f"POINT_DATA {N}\nSCALARS {'diameter' if diameter else 'radius'} double 1\nLOOKUP_TABLE default\n".encode()
    out += block(rad, "double")
    out += b"VECTORS velocity double\n" + block(VELOCITY, "double")
    return out


def xml(how="ascii", packed=False, order="LittleEndian", header="UInt32", split=False):
    mark = "<" if order == "LittleEndian" else ">"
    width = mark + ("u4" if header == "UInt32" else "u8")
    appended = b""

    def raw(values, kind):
        data = np.asarray(values).astype(mark + kind).tobytes()
        if not packed:
            return np.array([len(data)], width).tobytes(), data
        half = len(data) // 2 // 8 * 8
        blocks = [data[:half], data[half:]]
        sizes = [zlib.compress(b) for b in blocks]
        head = np.array([2, max(half, len(data) - half), len(data) - half, *map(len, sizes)], width).tobytes()
        return head, b"".join(sizes)

    def array(name, values, kind, parts=1):
        nonlocal appended
        vtk = {"f8": "Float64", "i4": "Int32"}[kind]
        tag = f'<DataArray type="{vtk}" Name="{name}" NumberOfComponents="{parts}" format="{how}"'
        if how == "ascii":
            return tag + ">" + " ".join(f"{v:.17g}" for v in np.ravel(values)) + "</DataArray>"
        head, body = raw(values, kind)
        text = base64.b64encode(head) + base64.b64encode(body) if packed or split else base64.b64encode(head + body)
        if how == "binary":
            return tag + ">\n  " + text.decode() + "\n</DataArray>"
        at = len(appended)
        appended += head + body if how == "appended" else b""
        return tag + f' offset="{at}"/>'

    zipper = ' compressor="vtkZLibDataCompressor"' if packed else ""
    text = f'<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="{order}" header_type="{header}"{zipper}>'
    text += f'<PolyData><Piece NumberOfPoints="{N}" NumberOfLines="1"><Points>{array("p", POINTS, "f8", 3)}</Points>'
    text += f"<PointData>{array('radius', RADIUS, 'f8')}{array('velocity', VELOCITY, 'f8', 3)}</PointData>"
    text += (
        f"<Lines>{array('connectivity', np.arange(N), 'i4')}{array('offsets', [N], 'i4')}</Lines></Piece></PolyData>"
    )
    if how == "appended":
        return text.encode() + b'<AppendedData encoding="raw">_' + appended + b"</AppendedData></VTKFile>"
    return text.encode() + b"</VTKFile>"


def lammps(places="x y z", units=None, moments=1, shuffled=True):
    rng = np.random.default_rng(1)
    out = f"ITEM: UNITS\n{units}\n" if units else ""
    for moment in range(moments):
        rows = rng.permutation(N) if shuffled else np.arange(N)
        low, high = POINTS.min(axis=0) - 1, POINTS.max(axis=0) + 1
        shown = (POINTS - low) / (high - low) if places.startswith("xs") else POINTS
        factor = 1 if moment == moments - 1 else 3
        out += f"ITEM: TIMESTEP\n{100 * moment}\nITEM: NUMBER OF ATOMS\n{N}\nITEM: BOX BOUNDS pp pp pp\n"
        out += "".join(f"{a:.17g} {b:.17g}\n" for a, b in zip(low, high, strict=True))
        out += f"ITEM: ATOMS id type {places} radius vx vy vz\n"
        for i in rows:
            out += f"{i + 1} 1 {' '.join(f'{v:.17g}' for v in shown[i])} {factor * RADIUS[i]:.17g} 1 2 3\n"
    return out.encode()


def table():
    rows = [
        f"{x:.17g};{y:.17g};{z:.17g};{r}"
        for (x, y, z), r in zip(POINTS, [f"{v:.17g}" for v in element(RADIUS)] + [""], strict=True)
    ]
    return ("x [cm];y [cm];z [cm];radius [cm]\n" + "\n".join(rows) + "\n").encode()


SHUFFLE = np.random.default_rng(0).permutation(N)
FORMATS = {
    "vtk text": ("a.vtk", legacy()),
    "vtk binary": ("a.vtk", legacy(binary=True)),
    "vtk 5.1": ("a.vtk", legacy(version="5.1")),
    "vtk 5.1 binary": ("a.vtk", legacy(binary=True, version="5.1")),
    "vtk in another order": ("a.vtk", legacy(order=SHUFFLE)),
    "vtk pairs": ("a.vtk", legacy(cells="pairs", order=SHUFFLE)),
    "vtk without lines": ("a.vtk", legacy(cells="none")),
    "vtk diameter": ("a.vtk", legacy(diameter=True)),
    "vtp text": ("a.vtp", xml()),
    "vtp binary": ("a.vtp", xml("binary")),
    "vtp binary, header apart": ("a.vtp", xml("binary", split=True)),
    "vtp binary, 64-bit header": ("a.vtp", xml("binary", header="UInt64")),
    "vtp binary, big endian": ("a.vtp", xml("binary", order="BigEndian")),
    "vtp zlib": ("a.vtp", xml("binary", packed=True)),
    "vtp zlib, 64-bit header": ("a.vtp", xml("binary", packed=True, header="UInt64")),
    "vtp appended": ("a.vtp", xml("appended")),
    "vtp appended zlib": ("a.vtp", xml("appended", packed=True)),
    "lammps": ("dump.lammpstrj", lammps()),
    "lammps unwrapped": ("dump.1", lammps("xu yu zu")),
    "lammps scaled": ("dump.1", lammps("xs ys zs")),
    "lammps, last of three": ("dump.1", lammps(moments=3)),
    "table": ("a.csv", table()),
}


@pytest.mark.parametrize("kind", FORMATS)
def test_one_jet_in_many_formats(tmp_path, reference, kind):
    name, data = FORMATS[kind]
    (tmp_path / name).write_bytes(data)
    jet = read_beads(tmp_path / name, unit=None if kind == "table" else "cm")
    assert jet.arc_length == pytest.approx(reference.arc_length, rel=1e-12)
    assert jet.element_radius == pytest.approx(reference.element_radius, rel=1e-12)
    assert jet.initial_radius == pytest.approx(reference.initial_radius, rel=1e-12)


def test_units_in_a_dump(tmp_path, reference):
    (tmp_path / "d").write_bytes(lammps(units="cgs"))
    assert read_beads(tmp_path / "d").arc_length == pytest.approx(reference.arc_length, rel=1e-12)
    (tmp_path / "d").write_bytes(lammps(units="lj"))
    with pytest.raises(InputError, match=r"no unit of length \(LAMMPS dump \(text\), units lj\)"):
        read_beads(tmp_path / "d")


@pytest.mark.parametrize("kind", ["vtk text", "vtp binary", "lammps"])
def test_a_unit_is_never_guessed(tmp_path, kind):
    name, data = FORMATS[kind]
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match="has no unit of length"):
        read_beads(tmp_path / name)


def test_a_scene_runs_along_them(tmp_path):
    (tmp_path / "a.vtp").write_bytes(xml("binary", packed=True))
    (tmp_path / "s.toml").write_text(
        '[solution]\npolymer = "PEO"\nmolar_mass = "600 kg/mol"\nsolvent = "water"\nmass_fraction = 0.05\n'
        '[jet]\nprofile = "lagrangian"\npath = "a.vtp"\nunit = "cm"\n[network]\nmodel = "affine"\n'
    )
    result = sl.run(sl.load_scene(tmp_path / "s.toml"))
    assert result.sizes["element"] == N - 1
    assert np.isfinite(result["crossover_radius"])


def test_fit_jet_takes_them(spinline, tmp_path):
    (tmp_path / "a.vtk").write_bytes(legacy(binary=True))
    ran = spinline("fit-jet", tmp_path / "a.vtk", "--unit", "cm")
    assert ran.code == 0
    assert ran.out.startswith("k = ")


def test_a_zipped_run_is_the_run(tmp_path, quiet):
    with zipfile.ZipFile(tmp_path / "run.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for file in RUN.iterdir():
            if file.suffix in (".dat", ".txt", ".xyz"):
                archive.write(file, f"some/folder/{file.name}")
    whole, packed = read_beads(RUN), read_beads(tmp_path / "run.zip")
    assert np.array_equal(whole.x, packed.x, equal_nan=True)
    assert np.array_equal(whole.element_radius, packed.element_radius, equal_nan=True)


def test_zips_that_bite(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("../../traj.dat", b"x")
        archive.writestr("other/traj.xyz", b"x")
    with pytest.raises(InputError, match="several runs"):
        read_beads(tmp_path / "a.zip")
    with zipfile.ZipFile(tmp_path / "b.zip", "w") as archive:
        archive.writestr("readme.md", b"x")
    with pytest.raises(InputError, match="no file of a JETSPIN run"):
        read_beads(tmp_path / "b.zip")
    (tmp_path / "c.zip").write_bytes(b"PK\x03\x04 no zip")
    with pytest.raises(InputError, match=r"c\.zip"):
        read_beads(tmp_path / "c.zip")


@pytest.mark.parametrize("packing", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_zip_of_every_packing_is_the_folder(tmp_path, packing, quiet):
    packed = _zipped(tmp_path, packing)
    whole = read_beads(RUN)
    for name, values in vars(read_beads(packed)).items():
        if isinstance(values, np.ndarray):
            assert np.array_equal(values, getattr(whole, name), equal_nan=True), name


@pytest.mark.parametrize(
    ("at", "value", "words"),
    [
        (8, 97, "compression method"),  # of WavPack; what zipfile says of it is a NotImplementedError
        (6, 1, "password"),
    ],
)
def test_a_zip_that_nothing_here_unpacks_is_refused(tmp_path, at, value, words):
    data = bytearray(_zipped(tmp_path, zipfile.ZIP_STORED).read_bytes())
    for head, place in (
        (b"PK\x03\x04", at),
        (b"PK\x01\x02", at + 2),
    ):  # said before the file, and in the list at the end
        start = data.find(head)
        while start >= 0:
            data[start + place] = value
            start = data.find(head, start + 1)
    (tmp_path / "odd.zip").write_bytes(data)
    with pytest.raises(InputError, match=rf"odd\.zip: is a zip that cannot be read .*{words}"):
        read_beads(tmp_path / "odd.zip")


@pytest.mark.parametrize("packing", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_zip_whose_packed_bytes_are_damaged_is_refused(tmp_path, packing):
    """Each unpacker raises an error of its own."""
    packed = _zipped(tmp_path, packing)
    with zipfile.ZipFile(packed) as archive:
        entry = max(archive.infolist(), key=lambda entry: entry.compress_size)
    data = bytearray(packed.read_bytes())
    for share in (0.1, 0.3, 0.5, 0.9):
        hurt = bytearray(data)
        start = entry.header_offset + 30 + len(entry.filename) + int(share * entry.compress_size)
        hurt[start : start + 20] = b"\xff" * 20
        (tmp_path / "hurt.zip").write_bytes(hurt)
        with pytest.raises(InputError, match=r"hurt\.zip: is a zip that cannot be read"):
            read_beads(tmp_path / "hurt.zip")


def _zipped(folder, packing):
    with zipfile.ZipFile(folder / "run.zip", "w", packing) as archive:
        for file in sorted(RUN.iterdir()):
            if file.suffix in (".dat", ".txt", ".xyz"):
                archive.write(file, f"run/{file.name}")
    return folder / "run.zip"


@pytest.mark.parametrize(
    "kind",
    [
        "vtk text",
        "vtk binary",
        "vtk 5.1 binary",
        "vtp text",
        "vtp binary",
        "vtp zlib",
        "vtp appended",
        "lammps",
        "table",
    ],
)
def test_damage_is_a_jet_or_one_message(tmp_path, kind):
    """Cut anywhere, one byte changed anywhere: never anything but a jet or an InputError that names the file."""
    name, data = FORMATS[kind]
    rng = np.random.default_rng(5)
    outcomes = set()
    for i in range(150):
        bad = bytearray(data[: rng.integers(1, len(data))] if i % 2 else data)
        if i % 2 == 0:
            bad[rng.integers(len(bad))] = rng.integers(256)
        (tmp_path / name).write_bytes(bytes(bad))
        try:
            read_beads(tmp_path / name, unit=None if kind == "table" else "cm")
            outcomes.add("jet")
        except InputError:
            outcomes.add("refused")
    assert "refused" in outcomes


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "is empty"),
        (b"\0\1\2\3", "in no format that is known"),
        (b"# vtk DataFile Version 3.0\njet\nASCII\nDATASET POLYDATA\nPOINTS 0 float\n", "no POINTS"),
        (legacy().replace(b"SCALARS radius", b"SCALARS colour"), r"no radius of the jet \(VTK legacy polyline\)"),
        (xml().replace(b'Name="radius"', b'Name="colour"'), r"no radius of the jet \(VTK XML polyline\)"),
        (b'<VTKFile><!DOCTYPE a [<!ENTITY b "c">]></VTKFile>', "declares entities"),
        (
            legacy().replace(f"LINES 1 {N + 1}\n{N} 0".encode(), f"LINES 1 {N + 1}\n{N} 99".encode()),
            "points that are not there",
        ),
        (lammps().replace(b"radius", b"colour"), r"no radius of the jet \(LAMMPS dump"),
        (lammps("a b c"), r"no places \(LAMMPS dump"),
        (b"ITEM: TIMESTEP\n0\n", "no moment that is whole"),
    ],
)
def test_refusals_name_the_format(tmp_path, data, words):
    (tmp_path / "f").write_bytes(data)
    with pytest.raises(InputError, match=words):
        read_beads(tmp_path / "f", unit="cm")


@given(
    st.binary(min_size=1, max_size=300),
    st.sampled_from([b"# vtk DataFile Version 3.0\n", b"<VTKFile>", b"ITEM: TIMESTEP\n", b""]),
)
@settings(max_examples=200, deadline=None)
def test_any_bytes(tmp_path_factory, data, head):
    file = tmp_path_factory.mktemp("f") / "f"
    file.write_bytes(head + data)
    with pytest.raises(InputError):
        read_beads(file, unit="cm")


class TestEveryReader:
    """The suite that every reader passes, those of users too."""

    @pytest.fixture(params=[reader.name for reader in readers()])
    def reader(self, request):
        return next(one for one in readers() if one.name == request.param)

    @pytest.fixture
    def example(self, reader, tmp_path, quiet):
        examples = {
            "JETSPIN run": (RUN, None),
            "VTK legacy polyline": ("vtk binary", "cm"),
            "VTK XML polyline": ("vtp zlib", "cm"),
            "LAMMPS dump (text)": ("lammps", "cm"),
            "table (CSV, text, Excel)": ("table", None),
        }
        if reader.name.startswith("jet file"):
            from spinline.jetprofile.jetspin import write_jet

            write_jet(RUN, tmp_path / "jet.nc")
            return tmp_path / "jet.nc", None
        what, unit = examples[reader.name]
        if isinstance(what, Path):
            return what, unit
        name, data = FORMATS[what]
        (tmp_path / name).write_bytes(data)
        return tmp_path / name, unit

    def test_it_claims_its_own_and_no_other_does_before(self, reader, example):
        path, _ = example
        head = path.read_bytes()[:4096] if path.is_file() else b""
        first = next(one for one in readers() if one.claims(path, head))
        assert first is reader

    def test_it_gives_a_jet_in_si(self, reader, example):
        path, unit = example
        jet = reader.read(path, unit=unit)
        assert isinstance(jet, LagrangianJet)
        usable = jet.usable
        assert 1e-9 < np.nanmin(jet.element_radius[usable]) <= np.nanmax(jet.element_radius[usable]) < 1e-2
        assert (np.diff(jet.arc_length[usable]) > 0).mean() > 0.9
        assert jet.initial_radius > 0

    def test_reading_twice_is_the_same(self, reader, example):
        path, unit = example
        one, two = reader.read(path, unit=unit), reader.read(path, unit=unit)
        assert np.array_equal(one.stretch, two.stretch, equal_nan=True)

    def test_a_missing_file_is_refused(self, tmp_path):
        with pytest.raises(InputError, match="does not exist"):
            read_beads(tmp_path / "none")

    def test_its_name_is_in_the_refusal_of_others(self, reader, tmp_path):
        (tmp_path / "f.bin").write_bytes(b"\0\0\0\0")
        with pytest.raises(InputError, match=re.escape(reader.name)):
            read_beads(tmp_path / "f.bin")


def test_a_reader_of_ones_own(tmp_path, monkeypatch):
    """One object with two methods, registered once; a scene runs with it."""

    class Toy:
        name = "toy"

        def claims(self, path, head):
            return head.startswith(b"TOY")

        def read(self, path, *, unit=None, initial_radius=None):
            r = np.array([float(v) for v in path.read_text().split()[1:]])
            return LagrangianJet.from_arrays(
                np.linspace(0, 0.01, r.size + 1), initial_radius=initial_radius or r[0], radius=r
            )

    monkeypatch.setattr(choose, "_READERS", list(readers()))
    register_reader(Toy())
    (tmp_path / "a.toy").write_text("TOY 1e-4 5e-5 2e-5 1e-5")
    (tmp_path / "s.toml").write_text(
        '[solution]\npolymer = "PEO"\nmolar_mass = "600 kg/mol"\nsolvent = "water"\nmass_fraction = 0.05\n'
        '[jet]\nprofile = "lagrangian"\npath = "a.toy"\n[network]\nmodel = "affine"\n'
    )
    result = sl.run(sl.load_scene(tmp_path / "s.toml"))
    assert result["radius"].values == pytest.approx([1e-4, 5e-5, 2e-5, 1e-5])
