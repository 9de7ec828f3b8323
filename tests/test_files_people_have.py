"""Files as other programs write them, by their formats' specifications: the jet of the plain table, or a refusal that names them."""

import gzip
import lzma
import zipfile
from pathlib import Path

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import InputError, SpinlineWarning
from spinline.jetprofile import LagrangianJet, Table
from spinline.jetprofile.jetspin import write_jet
from spinline.jetprofile.readers import read_beads

N = 24
S = np.linspace(0.0, 2.0, N)
POINTS = np.column_stack([S, 0.3 * np.sin(3 * S) * S, 0.3 * (1 - np.cos(3 * S)) * S])  # cm
RADIUS = 0.0125 / (1 + 20 * S)  # cm, at beads
SHUFFLE = np.random.default_rng(3).permutation(N)


def element(values):
    return 0.5 * (values[1:] + values[:-1])


def said(values):
    return " ".join(f"{v:.17g}" for v in np.ravel(values)) + "\n"


def is_the_jet(jet):
    plain = LagrangianJet.from_arrays(
        *(POINTS.T * 1e-2), initial_radius=element(RADIUS)[0] * 1e-2, radius=element(RADIUS) * 1e-2
    )
    assert jet.arc_length == pytest.approx(plain.arc_length, rel=1e-9)
    assert jet.element_radius == pytest.approx(plain.element_radius, rel=1e-9)
    assert jet.initial_radius == pytest.approx(plain.initial_radius, rel=1e-9)


def put(folder, name, data):
    (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    return folder / name


# VTK, legacy format

LINE = f"LINES 1 {N + 1}\n{N} {said(range(N))}"
PAIRS = [f"2 {i} {i + 1}\n" for i in range(N - 1)]
RADII = f"SCALARS radius double 1\nLOOKUP_TABLE default\n{said(RADIUS)}"
INFORMATION = "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 2.2\n\n"
NAMES = "METADATA\nCOMPONENT_NAMES\nX\nY\nZ\nINFORMATION 0\n\n"


def legacy(cells=LINE, data=f"POINT_DATA {N}\n{RADII}", kind="POLYDATA", before=""):
    return (
        f"# vtk DataFile Version 4.2\nj\nASCII\nDATASET {kind}\n{before}POINTS {N} double\n{said(POINTS)}{cells}{data}"
    )


def pairs(order=range(N - 1)):
    return f"LINES {N - 1} {3 * (N - 1)}\n" + "".join(PAIRS[i] for i in order)


def field(behind):
    return (
        f"POINT_DATA {N}\nFIELD FieldData 2\nv 3 {N} double\n{said(np.ones(3 * N))}{behind}"
        f"radius 1 {N} double\n{said(RADIUS)}{behind}"
    )


CELL_RADII = "SCALARS radius double 1\nLOOKUP_TABLE default\n"
WITH_A_VERTEX = f"CELL_DATA {N}\n{CELL_RADII}{said([0.0125, *element(RADIUS)])}"  # the vertex's value stands first


@pytest.mark.parametrize(
    "text",
    [
        legacy(INFORMATION + LINE),
        legacy(data=field(INFORMATION)),
        legacy(data=field(NAMES)),
        legacy(pairs(np.random.default_rng(5).permutation(N - 1))),
        legacy("VERTICES 1 2\n1 0\n" + pairs(), WITH_A_VERTEX),
        legacy(pairs() + "VERTICES 1 2\n1 0\n", WITH_A_VERTEX),
        legacy(data=f"POINT_DATA {N}\nTENSORS t double\n{said(np.arange(9 * N))}{RADII}"),
        legacy(kind="STRUCTURED_GRID", before=f"DIMENSIONS {N} 1 1\n", cells=""),
        legacy(f"CELLS 1 {N + 1}\n{N} {said(range(N))}CELL_TYPES 1\n4\n", kind="UNSTRUCTURED_GRID"),
    ],
)
def test_polylines_of_vtk(tmp_path, text):
    is_the_jet(read_beads(put(tmp_path, "a.vtk", text), unit="cm"))


def test_binary_vtk_with_whatever_paraview_puts_between(tmp_path):
    def block(values, kind):
        return np.asarray(values).astype(kind).tobytes() + b"\n"

    tricky = np.frombuffer(b"POINTS 3 float\n\n" * 9 * N, ">f8")[: 9 * N]  # numbers that look like keywords
    data = b"# vtk DataFile Version 4.2\nj\nBINARY\nDATASET POLYDATA\n"
    data += b"FIELD FieldData 1\nTIME 1 1 double\n" + block(tricky[:1], ">f8")
    data += f"POINTS {N} double\n".encode() + block(POINTS, ">f8") + b"METADATA\nINFORMATION 0\n\n"
    data += f"LINES 1 {N + 1}\n".encode() + block([N, *range(N)], ">i4") + f"POINT_DATA {N}\n".encode()
    data += b"TENSORS t double\n" + block(tricky, ">f8") + b"COLOR_SCALARS c 3\n" + block(np.full(3 * N, 80), "u1")
    data += b"FIELD FieldData 2\nv 3 %d float\n" % N + block(np.ones(3 * N), ">f4") + b"METADATA\nINFORMATION 0\n\n"
    data += b"radius 1 %d double\n" % N + block(RADIUS, ">f8") + b"METADATA\nINFORMATION 0\n\n"
    is_the_jet(read_beads(put(tmp_path, "a.vtk", data), unit="cm"))
    little = data.replace(block(POINTS, ">f8"), block(POINTS, "<f8"))
    with pytest.raises(InputError, match=r"VTK legacy polyline: its binary numbers are no places.*big-endian"):
        read_beads(put(tmp_path, "b.vtk", little), unit="cm")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (legacy(f"POLYGONS 1 {N + 1}\n{N} {said(range(N))}"), r"a surface \(VTK legacy polyline, 1 polygons\)"),
        (legacy(f"TRIANGLE_STRIPS 1 {N + 1}\n{N} {said(range(N))}"), "a surface .*triangle strips"),
        (legacy(kind="STRUCTURED_GRID", before=f"DIMENSIONS 4 {N // 4} 1\n", cells=""), "a grid of 4 x 6 x 1 points"),
        (legacy("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n", kind="UNSTRUCTURED_GRID"), "a mesh .*tetrahedra"),
        (legacy("CELLS 1 4\n3 0 2 1\nCELL_TYPES 1\n21\n", kind="UNSTRUCTURED_GRID"), "a mesh .*quadratic edges"),
        (legacy("LINES 2 8\n3 0 1 2\n3 3 4 5\n"), "several lines"),
        (legacy(data=f"POINT_DATA {N}\n{RADII}{RADII.replace('radius', 'd')}"), "two radii of the jet that are not the same"),
    ],
)  # fmt: skip
def test_what_is_no_line_is_not_taken_for_one(tmp_path, text, words):
    with pytest.raises(InputError, match=words):
        read_beads(put(tmp_path, "a.vtk", text), unit="cm")


# VTK, XML format


def array(name, values, kind="Float64", parts=1, first="", last=""):
    tag = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{parts}" format="ascii">'
    return f"{tag}{first}\n{said(values)}{last}</DataArray>"


KEY = '<InformationKey name="L2_NORM_RANGE" length="2"><Value index="0">0</Value><Value index="1">2</Value></InformationKey>'
JOINED = f"<Lines>{array('connectivity', range(N), 'Int64')}{array('offsets', [N], 'Int64')}</Lines>"
NO_LINES = f"<Lines>{array('connectivity', [], 'Int64')}{array('offsets', [], 'Int64')}</Lines>"
PAIRED = f"<Lines>{array('connectivity', np.column_stack([range(N - 1), range(1, N)]), 'Int64')}"
PAIRED += f"{array('offsets', range(2, 2 * N, 2), 'Int64')}</Lines>"


def cells(tag, joined, ends, types=None):
    inside = array("connectivity", joined, "Int64") + array("offsets", ends, "Int64")
    return f"<{tag}>{inside}{'' if types is None else array('types', types, 'UInt8')}</{tag}>"


AT_POINTS = array("radius", RADIUS)


def xml(lines=JOINED, data=AT_POINTS, kind="PolyData", points=None, after="", piece=""):
    points = points or array("Points", POINTS, parts=3)
    body = f'<Piece NumberOfPoints="{N}"{piece}><PointData>{data}</PointData><Points>{points}</Points>{lines}</Piece>'
    return f'<VTKFile type="{kind}" byte_order="LittleEndian"><{kind}>{body}{after}</{kind}></VTKFile>'


@pytest.mark.parametrize(
    "text",
    [
        xml(points=array("Points", POINTS, parts=3, first=KEY)),
        xml(points=array("Points", POINTS, parts=3, last=KEY)),
        xml(data=array("radius", RADIUS) + '<DataArray type="String" Name="s" format="ascii">65 0</DataArray>'),
        xml(NO_LINES),
        xml(cells("Verts", range(N), range(1, N + 1)) + NO_LINES),
        xml(after='<Piece NumberOfPoints="0"><Points/></Piece>'),
        xml(f"<CellData>{array('radius', [0.0125, *element(RADIUS)])}</CellData>{cells('Verts', [0], [1])}{PAIRED}", ""),
        xml(cells("Cells", range(N), [N], [4]), kind="UnstructuredGrid"),
    ],
)  # fmt: skip
def test_polylines_of_vtk_in_xml(tmp_path, text):
    is_the_jet(read_beads(put(tmp_path, "a.vtp", text), unit="cm"))


def test_vtp_compressed_by_lzma(tmp_path):
    import base64

    def packed(values, kind):
        data = np.asarray(values).astype(kind).tobytes()
        body = lzma.compress(data)
        head = np.array([1, len(data), 0, len(body)], "<u4").tobytes()
        return (base64.b64encode(head) + base64.b64encode(body)).decode()

    text = xml().replace("byte_order", 'compressor="vtkLZMADataCompressor" byte_order').replace('"ascii"', '"binary"')
    for values, kind in ((POINTS, "<f8"), (RADIUS, "<f8"), (range(N), "<i8"), ([N], "<i8")):
        text = text.replace("\n" + said(values), packed(values, kind))
    is_the_jet(read_beads(put(tmp_path, "a.vtp", text), unit="cm"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (xml(cells("Polys", range(N), [N]) + NO_LINES), r"a surface \(VTK XML polyline, 1 polygons\)"),
        (xml(cells("Cells", [0, 1, 2, 3], [4], [10]), kind="UnstructuredGrid"), "a mesh .*tetrahedra"),
        (xml("", kind="StructuredGrid", piece=' Extent="0 3 0 5 0 0"'), "a grid of 4 x 6 x 1 points"),
        ('<VTKFile type="Collection"><Collection><DataSet file="a.vtp"/></Collection></VTKFile>', "a.vtp.*a list of files"),
        ('<VTKFile type="PPolyData"><PPolyData><Piece Source="b.vtp"/></PPolyData></VTKFile>', "b.vtp.*in pieces"),
        (xml().replace("byte_order", 'compressor="vtkLZ4DataCompressor" byte_order'), "compressed by vtkLZ4DataCompressor"),
    ],
)  # fmt: skip
def test_refusals_of_vtk_in_xml(tmp_path, text, words):
    with pytest.raises(InputError, match=words):
        read_beads(put(tmp_path, "a.vtp", text), unit="cm")


# LAMMPS

LOW, SIDE = np.array([-0.05, -0.3, -0.3]), 0.6
TURNS = np.floor((POINTS - LOW) / SIDE).astype(int)
WRAPPED = POINTS - TURNS * SIDE
CUBE = [f"{low} {low + SIDE}" for low in LOW]


def dump(places, names="x y z", box=CUBE, kind="pp pp pp", more="", extra=None, units=""):
    text = f"{units}ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n{N}\nITEM: BOX BOUNDS {kind}\n" + "\n".join(box)
    text += f"\nITEM: ATOMS id type {names} radius {more}\n"
    for i in SHUFFLE:
        behind = "" if extra is None else " ".join(map(str, np.atleast_1d(extra[i])))
        text += f"{i + 1} 1 {said(places[i]).strip()} {RADIUS[i]:.17g} {behind}\n"
    return text


def tilted():
    edges, origin = np.array([[3.0, 0, 0], [0.4, 2.0, 0], [-0.3, 0.2, 2.0]]), np.array([-0.5, -1.0, -1.0])
    (x, _, _), (xy, y, _), (xz, yz, z) = edges
    box = [
        f"{origin[0] + min(0, xy, xz, xy + xz)} {origin[0] + x + max(0, xy, xz, xy + xz)} {xy}",
        f"{origin[1] + min(0, yz)} {origin[1] + y + max(0, yz)} {xz}",
        f"{origin[2]} {origin[2] + z} {yz}",
    ]
    return dump((POINTS - origin) @ np.linalg.inv(edges), "xs ys zs", box, "xy xz yz pp pp pp")


def general():
    edges, origin = np.array([[1.0, 2.0, 0.5], [-2.0, 1.0, 0.3], [0.1, 0.2, 3.0]]), np.array([-0.5, -1.0, -1.0])
    box = [f"{said(row).strip()} {low}" for row, low in zip(edges, origin, strict=True)]
    return dump((POINTS - origin) @ np.linalg.inv(edges), "xsu ysu zsu", box, "abc origin pp pp pp")


@pytest.mark.parametrize(
    "text",
    [
        dump(WRAPPED, more="ix iy iz", extra=TURNS),
        dump((WRAPPED - LOW) / SIDE, "xs ys zs", more="ix iy iz", extra=TURNS),
        dump((POINTS - LOW) / SIDE, "xsu ysu zsu"),
        tilted(),
        general(),
    ],
)
def test_dumps_of_every_box(tmp_path, text):
    is_the_jet(read_beads(put(tmp_path, "d.dump", text), unit="cm"))


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        (dump(WRAPPED), "cm", "leaves a periodic box and comes in again"),
        (dump(POINTS, more="mol", extra=np.arange(N) // 12), "cm", "'0, 1': has several molecules"),
        (dump(POINTS, units="ITEM: UNITS\ncgs\n"), "mm", "unit = 'mm': is not the one of the dump .*units cgs"),
    ],
)
def test_dumps_that_would_be_another_jet(tmp_path, text, unit, words):
    with pytest.raises(InputError, match=words):
        read_beads(put(tmp_path, "d.dump", text), unit=unit)


def test_a_wall_that_does_not_repeat_is_no_cut(tmp_path):
    is_the_jet(read_beads(put(tmp_path, "d.dump", dump(POINTS, box=CUBE, kind="ff ff ff")), unit="cm"))


def test_dumps_without_ids_and_of_several_types_are_said(tmp_path):
    text = dump(POINTS, kind="ff ff ff")
    bare = "\n".join(
        line.partition(" ")[2] if line[:1].isdigit() and line.count(" ") > 4 else line for line in text.split("\n")
    )
    with pytest.warns(SpinlineWarning, match="atoms without an id"):
        read_beads(put(tmp_path, "a.dump", bare.replace("ATOMS id ", "ATOMS ")), unit="cm")
    with pytest.warns(SpinlineWarning, match="atoms of types 1, 2 are taken"):
        read_beads(put(tmp_path, "b.dump", text.replace("\n3 1 ", "\n3 2 ")), unit="cm")


def test_beads_in_no_order_are_noticed(spinline, tmp_path):
    rows = [f"{x},{y},{z},{r}\n" for (x, y, z), r in zip(POINTS, RADIUS, strict=True)]
    put(tmp_path, "s.toml", '[solution]\npolymer = "PEO"\nmolar_mass = "600 kg/mol"\nsolvent = "water"\nmass_fraction = 0.05\n'
        '[jet]\nprofile = "lagrangian"\npath = "b.csv"\n[network]\nmodel = "affine"\n')  # fmt: skip
    for order, noticed in ((range(N), False), (SHUFFLE, True)):
        put(tmp_path, "b.csv", "x [cm],y [cm],z [cm],radius [cm]\n" + "".join(rows[i] for i in order))
        ran = spinline("check", "s.toml")
        assert ("turns back by more than 120 degrees" in ran.out + ran.err) is noticed


# zips


def test_zips_of_a_mac_and_of_any_depth(spinline, tmp_path, quiet):
    run = Path(sl.__file__).parent / "data" / "scenes" / "pvp3d"
    with zipfile.ZipFile(tmp_path / "mail.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for file in run.iterdir():
            if file.suffix in (".dat", ".txt", ".xyz"):
                archive.write(file, f"My runs/run 1/{file.name}")
        archive.writestr("__MACOSX/My runs/run 1/._traj.xyz", b"\0\5\x16\7" + b"\0" * 50)
        archive.writestr("My runs/._other.xyz", b"\0\5\x16\7")
    write_jet(run, tmp_path / "plain.nc")
    ran = spinline("import-jet", "mail.zip")
    assert (ran.code, ran.err) == (0, "")
    plain, mailed = (sl.base.netcdf.open_dataset(tmp_path / name) for name in ("plain.nc", "mail.nc"))
    for name in ("x", "radius"):
        assert np.array_equal(plain[name].values, mailed[name].values, equal_nan=True)
    assert not [key for key, value in mailed.attrs.items() if "/tmp" in str(value)]


# what is read nowhere here


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("a.mat", b"MATLAB 5.0 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\1IM" + b"\0" * 99, "a MATLAB file"),
        ("a.mat", b"MATLAB 7.3 MAT-file, Platform".ljust(124) + b"\0\2IM" + b"\0" * 384 + b"\x89HDF\r\n\x1a\n", "MATLAB file .*7.3"),
        ("a.mat", b"\0\0\0\0\x08\0\0\0" + b"\0" * 99, "a MATLAB file"),
        ("a.csv.gz", gzip.compress(b"x [cm],radius [cm]\n0,1\n"), "compressed by gzip.*unpack it"),
        ("a.npy", b"\x93NUMPY\1\0v\0", "an array of numpy.save"),
        ("a.lmp", f"LAMMPS data file via write_data\n\n{N} atoms\n", "a LAMMPS data file.*write a dump"),
        ("a.yaml", "---\ncreator: LAMMPS\ntimestep: 0\n", "a LAMMPS dump in YAML"),
        ("a.stl", "solid jet\n facet normal 0 0 1\n", "an STL surface"),
        ("a.pdb", "ATOM      1  C   JET A   1       0.0\n", "a PDB file"),
        ("a.xyz", "2\njet\nC 0 0 0\nC 1 0 0\n", "an XYZ file of another program than JETSPIN"),
        ("a.dat", 'TITLE = "jet"\nVARIABLES = "z"\n', "a Tecplot file"),
        ("a.json", '{"z": [0, 1]}', "JSON"),
        ("a.dat", "FoamFile\n{\n version 2.0;\n}\n", "an OpenFOAM file"),
    ],
)  # fmt: skip
def test_formats_that_are_not_read_are_named(tmp_path, name, data, words):
    with pytest.raises(InputError, match=words) as refused:
        read_beads(put(tmp_path, name, data), unit="cm")
    assert "leave it out" not in str(refused.value)  # the unit is not what is wrong


# tables

Z = np.array([0, 0.5, 1, 1.5, 2, 3, 4, 5])
R = np.array([125, 65, 47, 39, 34, 28, 24.5, 22])
ROWS = "".join(f"{z} {r}\n" for z, r in zip(Z, R, strict=True))
COMSOL = "% Model:              jet.mph\n% Version:            COMSOL 6.1.0.252\n% Length unit:        mm\n"


@pytest.mark.parametrize(
    "text",
    [
        COMSOL + "% z                 r (um) @ t=0.1\n" + ROWS,
        COMSOL + "% z (mm)            r (um) @ 3: t=0.1\n" + ROWS,
        "z [mm];radius [um]\n" + ROWS.replace(" ", ";") + ";\n;\n",
        "z [mm],dia [um]\n" + "".join(f"{z},{2 * r}\n" for z, r in zip(Z, R, strict=True)),
        '"Points:0 [mm]","radius [um]"\n' + ROWS.replace(" ", ","),
    ],
)
def test_tables_of_other_programs(tmp_path, text):
    jet = Table.from_csv(put(tmp_path, "p.csv", text), flow_rate=1e-9)
    assert jet.radius(Z * 1e-3) == pytest.approx(R * 1e-6, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("z [mm] radius [um]\n" + ROWS + "6 nan\n", r"no finite radius in row 9 below the header \(1 such rows\); drop"),
        ("z [mm] radius [um]\n" + ROWS + "5 22\n", "stands twice in rows 8 and 9; keep one"),
        ("z [mm] radius [um]\n" + ROWS + "1 22\n", "falls in rows 8 and 9; sort the rows"),
        ("z [mm] radius [um]\n-1 130\n" + ROWS, "negative z in row 1 .*distance from the nozzle"),
        ("x [mm],z [mm],radius [um]\n0,0,1\n", 'beads in space .*profile = "lagrangian"'),
        (COMSOL + "% z   r (um) @ t=0   r (um) @ t=1\n0 1 2\n", r"two columns that mean radius \(.*COMSOL"),
        ('"Points:0","Points:1","radius"\n0,0,1\n', r"x: needs a unit .*ParaView, whose Points:0, 1, 2 are x, y, z"),
        ("# vtk DataFile Version 3.0\n", 'a VTK file.*profile = "lagrangian"'),
        ("ITEM: TIMESTEP\n", 'a LAMMPS dump.*profile = "lagrangian"'),
    ],
)  # fmt: skip
def test_refusals_of_tables_say_the_row_and_what_to_do(tmp_path, text, words):
    with pytest.raises(InputError, match=words):
        Table.from_csv(put(tmp_path, "p.csv", text), flow_rate=1e-9)


def test_a_straight_table_among_beads_is_told_its_profile(tmp_path):
    with pytest.raises(InputError, match='profile = "table"'):
        read_beads(put(tmp_path, "p.csv", "z [mm] radius [um]\n" + ROWS))


def test_a_workbook_says_which_sheet_was_read(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["my notes"])
    for row in (["z [mm]", "radius [um]"], [0, 125], [1, 60]):
        book.create_sheet("data").append(row)
    book.save(tmp_path / "p.xlsx")
    with pytest.raises(InputError, match=r"Excel workbook, its first sheet.*; the table stands on the first sheet"):
        Table.from_csv(tmp_path / "p.xlsx", flow_rate=1e-9)
