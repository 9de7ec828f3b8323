"""The six real runs: units, numbering, radii against the volumes JETSPIN keeps."""

import os
import shutil
import warnings
from collections import Counter
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from spinline.base.errors import InputError, SpinlineWarning
from spinline.jetprofile import iter_jetspin, read_jetspin
from spinline.jetprofile.jetspin import read_parameters, read_statistics, sources, stats, write_jet, xyz
from spinline.jetprofile.jetspin.detect import file_kind
from spinline.jetprofile.jetspin.folder import Folder
from spinline.jetprofile.jetspin.notes import Notes

DATA = Path(__file__).parent / "data" / "jetspin"
BUNDLED = Path(str(files("spinline"))) / "data" / "scenes" / "pvp3d"
RUNS = [
    "airdrag_counterflow",
    "dynamic_refinement",
    "ex1_1d_single",
    "ex2_1d_insert",
    "pvp3d",
    "quasi_newtonian_kv",
]


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """All runs in one place, the bundled files beside the others."""
    root = tmp_path_factory.mktemp("runs")
    for name in RUNS:
        shutil.copytree(DATA / name, root / name)
    for path in BUNDLED.iterdir():
        shutil.copy(path, root / "pvp3d")
    return root


def quiet(*args, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        return read_jetspin(*args, **options)


# frame*.xyz, traj.xyz: metres per printed unit by the formats' definition, L0 as log.txt prints it
@pytest.mark.parametrize(
    ("run", "source", "metres"),
    [
        ("pvp3d", "traj.xyz", 0.03487728022e-2),
        ("pvp3d", "frame*.xyz", 0.01),
        ("airdrag_counterflow", "traj.xyz", 0.001),
        ("airdrag_counterflow", "frame*.xyz", 0.01 / (10 * 0.03487728022)),
        ("quasi_newtonian_kv", "traj.xyz", 0.01),
        ("quasi_newtonian_kv", "frame*.xyz", 0.01 / 155.9759389),
        ("dynamic_refinement", "traj.xyz", 0.03487728022e-2),
        ("dynamic_refinement", "frame*.xyz", 0.01),
        ("ex1_1d_single", "traj.xyz", 0.319e-2),
        ("ex1_1d_single", "frame*.xyz", 0.01),
        ("ex2_1d_insert", "traj.xyz", 0.1e-2),
        ("ex2_1d_insert", "frame*.xyz", 0.01),
    ],
)
def test_every_file_in_metres(runs, run, source, metres):
    data = quiet(runs / run, source=source)
    path = runs / run / data.attrs["source_files"].split(" to ")[0]
    printed = float(path.read_text().splitlines()[2][8:18])
    frame = data.isel(time=0)
    assert float(frame.x[int(frame.n_bead) - 1]) == pytest.approx(printed * metres, rel=1e-9)


@pytest.mark.parametrize(
    ("run", "source", "time"),
    [
        ("pvp3d", "frame*.xyz", 0.005),
        ("pvp3d", "frame*.xyz", 0.010),
        ("pvp3d", "frame*.xyz", 0.015),
        ("pvp3d", "frame*.xyz", 0.020),
        ("pvp3d", "frame*.xyz", 0.025),
        ("pvp3d", "traj.xyz", 0.025),
        ("ex2_1d_insert", "frame*.xyz", 0.1),
        ("ex2_1d_insert", "traj.dat", 0.3),
    ],
)
def test_radius_from_positions_against_volumes(runs, run, source, time):
    """Same instant, radius from equal volumes and rounded positions against the binary file."""
    truth = quiet(runs / run, source="traj.dat", time=time).isel(time=0)
    data = quiet(runs / run, source=source, time=time).isel(time=0)
    valid = data.valid_element.values
    np.testing.assert_array_equal(valid, truth.valid_element)
    error = np.abs(data.radius.values / truth_radius(runs / run, truth) - 1)[valid]
    assert error[1:].max() < 1e-4  # away from the nozzle element
    assert error[0] < 5e-3  # text has the nozzle point at 0, 0, 0
    digit = 1e-7 if source == "frame*.xyz" else 1e-5 * data.attrs["internal_length_unit"]
    rounding = np.sqrt(3) * digit / data.element_length.values[valid] / 2  # of two ends, half a digit each
    assert (error <= rounding + 3e-7)[1:].all()
    if source != "frame*.xyz" or time == 0.025:
        assert np.median(error) < 1e-6


def truth_radius(run, truth):
    """Radius from the volumes of the binary file, or, where its style has none, from those of save.dat."""
    if "volume" in truth:
        return np.sqrt(truth.volume.values / (np.pi * truth.element_length.values))
    volume = float(quiet(run, source="save.dat").volume[0, 0])
    return np.sqrt(volume / (np.pi * truth.element_length.values))


@pytest.mark.parametrize("run", ["pvp3d", "airdrag_counterflow", "quasi_newtonian_kv"])
@pytest.mark.parametrize("source", ["traj.xyz", "frame*.xyz"])
def test_radius_against_the_save_one_step_later(runs, run, source):
    """save.dat is one time step later: its beads, moved back by their velocity, and its volumes."""
    data = quiet(runs / run, source=source, time="last").isel(time=0)
    save = quiet(runs / run, source="save.dat").isel(time=0)
    step = float(save.time - data.time)
    assert 0 < step < 3e-7
    back = np.array([(save[axis] - step * save[f"velocity_{axis}"]).values for axis in "xyz"])
    length = np.sqrt((np.diff(back, axis=1) ** 2).sum(axis=0))
    valid = data.valid_element.values
    error = np.abs(data.radius.values / np.sqrt(save.volume.values / (np.pi * length)) - 1)[valid]
    assert np.median(error) < 5e-6
    assert error[1:].max() < 2.1e-4


def test_radius_by_the_definition(runs):
    """Volumes in save.dat, against pi r^2 l computed here from the raw records."""
    data = quiet(runs / "dynamic_refinement", source="save.dat").isel(time=0)
    inside = data.valid_element.values
    volume = np.pi * data.radius.values**2 * data.element_length.values
    np.testing.assert_allclose(volume[inside], data.volume.values[inside], rtol=1e-12)
    p = read_parameters(runs / "dynamic_refinement")
    rest = data.volume.values / (np.pi * p.nozzle_radius**2)
    np.testing.assert_allclose(
        (data.stretch_ratio.values * rest)[inside], data.element_length.values[inside], rtol=1e-12
    )
    share = data.volume.values[inside] / p.element_volume
    assert share.min() == pytest.approx(0.063, abs=0.001)
    assert share.max() == pytest.approx(1, abs=1e-6)


def test_refinement_is_not_guessed_from_positions(runs):
    with pytest.warns(SpinlineWarning, match="dynamic refinement"):
        data = read_jetspin(runs / "dynamic_refinement", source="frame*.xyz")
    assert np.isnan(data.radius).all()
    assert np.isnan(data.stretch_ratio).all()
    assert np.isfinite(data.element_length.values[data.valid_element.values]).all()
    assert data.attrs["refinement"] == "yes"
    assert "save.dat" in data.attrs["warnings"]


def test_a_refined_run_is_read_from_its_volumes(runs):
    with pytest.warns(SpinlineWarning, match="save.dat is read"):
        data = read_jetspin(runs / "dynamic_refinement")
    assert data.attrs["source_files"] == "save.dat"
    assert np.isfinite(data.radius.values[data.valid_element.values]).all()


def test_refinement_known_from_the_statistics_alone(runs, tmp_path):
    for name in ("frame000013.xyz", "statout.dat"):
        shutil.copy(runs / "dynamic_refinement" / name, tmp_path)
    data = quiet(tmp_path / "frame000013.xyz", unit="cm")
    assert data.attrs["refinement"] == "yes"


@pytest.mark.parametrize(
    ("run", "source"),
    [(run, source) for run in RUNS for source in (None, "frame*.xyz", "traj.xyz", "save.dat")]
    + [("pvp3d", "traj.dat"), ("ex2_1d_insert", "traj.dat")],
)
def test_bead_zero_is_the_nozzle_and_arcs_grow(runs, run, source):
    data = quiet(runs / run, source=source)
    whole = ~data.nozzle_missing.values
    assert (data.x.values[whole, 0] == 0).all()
    assert (np.abs(data.arc_length.values[whole, 0]) == 0).all()
    assert np.isnan(data.arc_length.values[~whole]).all()
    steps = np.diff(data.arc_length.values[whole], axis=1)
    np.testing.assert_allclose(steps, data.element_length.values[whole], rtol=1e-9, atol=1e-15)
    assert (np.diff(data.time) > 0).all()
    count = np.isfinite(data.x.values).sum(axis=1)
    np.testing.assert_array_equal(count, data.n_bead)
    known = data.valid_element.values & (np.array(data.attrs["radius_source"] != "not known"))
    assert np.isfinite(data.radius.values[known]).all()
    assert "far off the line" not in data.attrs["warnings"]
    h = data.attrs["collector_distance"]
    laid = data.deposited.values
    np.testing.assert_allclose(data.x.values[laid], h, rtol=3e-5)
    assert (data.x.values[~laid & np.isfinite(data.x.values)] < h).all() or run == "ex1_1d_single"


def test_text_and_binary_hold_the_same_beads(runs):
    """frame000025.xyz and the last frame of traj.dat are one state, place holder or not."""
    for time in (0.005, 0.010, 0.015, 0.020, 0.025):
        text = quiet(runs / "pvp3d", source="frame*.xyz", time=time).isel(time=0)
        binary = quiet(runs / "pvp3d", source="traj.dat", time=time).isel(time=0)
        assert int(text.n_bead) == int(binary.n_bead)
        for axis in "xyz":
            error = np.abs(text[axis].values - binary[axis].values)[1:]
            assert np.nanmax(error) < 6e-8  # half of 1e-5 cm, and float32


def test_place_holder_is_dropped_and_said(runs):
    data = quiet(runs / "pvp3d")
    np.testing.assert_array_equal(data.inserted, [False, True, True, True, True])
    np.testing.assert_array_equal(data.n_bead, [46, 90, 111, 112, 113])
    assert "1 place-holder" in data.attrs["dropped"]
    assert data.attrs["warnings"] == ""


def test_velocity_and_strain_rate(runs):
    data = quiet(runs / "pvp3d", time="last").isel(time=0)
    np.testing.assert_allclose(
        data.velocity, np.sqrt(data.velocity_x**2 + data.velocity_y**2 + data.velocity_z**2), rtol=1e-14
    )
    i = 40
    tangent = np.array([float(data[a][i + 1] - data[a][i]) for a in "xyz"])
    dv = np.array([float(data[f"velocity_{a}"][i + 1] - data[f"velocity_{a}"][i]) for a in "xyz"])
    length = np.linalg.norm(tangent)
    assert float(data.strain_rate[i]) == pytest.approx(dv @ tangent / length**2, rel=1e-12)
    assert float(data.strain_rate[i]) > 0
    # nozzle velocity 87.19 cm/s * 0.003245 = 0.2829 cm/s
    assert float(data.velocity_x[0]) == pytest.approx(0.282942121e-2, rel=1e-6)


def test_stress_lies_with_its_element(runs):
    """A bead's stress is that of the element towards the nozzle: the last row, the nozzle point, has none."""
    modulus = read_parameters(runs / "ex1_1d_single").elastic_modulus
    data = quiet(runs / "ex1_1d_single", source="save.dat").isel(time=0)
    assert data.stress.dims == ("element",)
    assert float(data.stress[0]) == pytest.approx(0.21721353 * modulus, rel=1e-6)
    raw = (runs / "pvp3d" / "save.dat").read_bytes()
    assert np.frombuffer(raw[-44:-4], "<f4")[3] == 0  # nozzle point
    jet = quiet(runs / "pvp3d", source="save.dat").isel(time=0)
    table = read_statistics(runs / "pvp3d")
    outermost = int(jet.n_bead) - 2  # the element of the first row
    assert float(jet.stress[outermost]) == pytest.approx(float(table.stress[-1]), rel=1e-3)


def test_whole_run_prefers_volumes(runs):
    assert quiet(runs / "pvp3d").attrs["source_files"] == "traj.dat"
    assert quiet(runs / "airdrag_counterflow").attrs["source_files"].startswith("frame")
    assert quiet(runs / "pvp3d").attrs["radius_source"] == "volumes in the file"


def test_time_selection(runs):
    run = runs / "pvp3d"
    whole = quiet(run, source="traj.xyz")
    xr.testing.assert_equal(quiet(run, source="traj.xyz", time="last"), whole.isel(time=[-1]).pipe(trim))
    near = quiet(run, source="traj.xyz", time=0.01024)
    assert float(near.time[0]) == pytest.approx(0.010)
    part = quiet(run, source="traj.xyz", time=slice(0.01, 0.0151))
    assert part.sizes["time"] == 11
    with pytest.raises(InputError, match=r"outside .* 0\.0005 to 0\.025 s"):
        read_jetspin(run, source="traj.xyz", time=0.03)
    for wrong in ("first", [1], slice(0.1, 0.2), slice(0, 1, 2), slice("a")):
        with pytest.raises(InputError, match="time"):
            read_jetspin(run, source="traj.xyz", time=wrong)


def trim(data):
    count = int(data.n_bead.max())
    return data.isel(bead=slice(0, count), element=slice(0, count - 1))


@pytest.mark.parametrize("run", ["pvp3d", "quasi_newtonian_kv", "ex2_1d_insert"])
@pytest.mark.parametrize("source", ["traj.xyz", "frame*.xyz"])
def test_pieces_make_the_whole(runs, run, source):
    whole = quiet(runs / run, source=source)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        pieces = list(iter_jetspin(runs / run, source=source, chunk_frames=7))
    at = 0
    for piece in pieces:
        assert piece.sizes["time"] <= 7
        same = whole.isel(time=slice(at, at + piece.sizes["time"])).pipe(trim)
        xr.testing.assert_equal(piece, same)
        at += piece.sizes["time"]
    assert at == whole.sizes["time"]


@pytest.mark.parametrize(("run", "source"), [("pvp3d", None), ("ex2_1d_insert", "traj.xyz"), ("ex1_1d_single", None)])
def test_netcdf_is_what_was_read(runs, tmp_path, monkeypatch, run, source):
    monkeypatch.setattr("spinline.jetprofile.jetspin.reading._ROWS", 300)
    seen = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        out = write_jet(runs / run, tmp_path / "jet.nc", source=source, progress=lambda a, b: seen.append((a, b)))
    whole = quiet(runs / run, source=source)
    with xr.open_dataset(out) as stored:
        xr.testing.assert_equal(stored.load(), whole)
        assert stored.radius.attrs["units"] == "m"
        for name, value in whole.attrs.items():
            assert stored.attrs[name] == value or np.isnan(value), name
    assert seen[-1] == (whole.sizes["time"], whole.sizes["time"])
    assert len(seen) > 1 or run == "ex1_1d_single"
    assert not list(tmp_path.glob("*.part"))


def test_netcdf_refusals_leave_nothing_behind(runs, tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        write_jet(tmp_path / "no", tmp_path / "jet.nc")
    with pytest.raises(InputError, match="cannot be written"):
        write_jet(runs / "ex1_1d_single", tmp_path / "no" / "jet.nc")
    assert list(tmp_path.iterdir()) == []


def test_statistics_text_and_binary_agree(runs):
    text, binary = (
        read_statistics(runs / "pvp3d" / "statout.dat"),
        read_statistics(runs / "pvp3d" / "statdat.dat"),
    )
    np.testing.assert_array_equal(text.step, binary.step)
    for name in set(text.data_vars) & set(binary.data_vars) - {"cpu_time"}:
        np.testing.assert_allclose(text[name], binary[name], rtol=2e-6, atol=1e-30, err_msg=name)
    assert len(text.data_vars) == 28  # 29 columns, one of them the time
    assert text.stress.attrs["units"] == "Pa"
    assert float(text.potential[0]) == pytest.approx(30.02076857 * 299.792458)
    assert float(text.aperture_angle[1]) == pytest.approx(np.radians(4.396971345), rel=1e-9)
    assert float(text.nozzle_current[1]) == pytest.approx(552.9203070 * 3.33564095e-10, rel=1e-8)


def test_landed_beads(runs):
    data = quiet(runs / "pvp3d" / "bead.dat")
    assert data.sizes["landing"] == 109
    np.testing.assert_allclose(data.x, 0.16, rtol=1e-6)
    np.testing.assert_allclose(data.radius, np.sqrt(data.volume / (np.pi * data.element_length)), rtol=1e-5)
    assert float(data.time[0]) == pytest.approx(26.914249 * 4e-4, rel=1e-6)


@pytest.mark.parametrize("run", [name for name in RUNS if name != "ex1_1d_single"])
def test_log_input_and_block_tell_the_same(runs, run):
    log, given = quiet(runs / run / "log.txt"), quiet(runs / run / "input.dat")
    assert log.attrs["warnings"] == given.attrs["warnings"] == ""
    for name in set(log.data_vars) & set(given.data_vars):
        assert float(log[name]) == pytest.approx(float(given[name]), rel=2e-9), name
    assert {"nozzle_radius", "resolution", "length_unit", "collector_distance", "charge_density"} <= set(
        given.data_vars
    )
    jet = quiet(runs / run, source="save.dat")
    assert "disagree" not in jet.attrs["warnings"]
    assert jet.attrs["jetspin_version"] == "1.21"
    assert jet.attrs["nozzle_radius"] == pytest.approx(float(log.nozzle_radius), rel=1e-12)


def test_parameters_of_the_quasi_newtonian_run(runs):
    p = read_parameters(runs / "quasi_newtonian_kv")
    assert p.length_unit == pytest.approx(1.559759389, rel=1e-9)
    assert p.time_unit == pytest.approx(1000)
    assert (p.xyz_rescale, p.refinement, p.dimension, p.removing) == (1.0, False, 3, True)


def asked_of_the_system(function, monkeypatch):
    """What is opened, listed and asked after while a function runs: names of files by kind."""
    asked = {kind: Counter() for kind in ("open", "scandir", "listdir", "stat")}
    for kind, counted in asked.items():
        plain = getattr(os, kind)

        def spy(path=".", *args, plain=plain, counted=counted, **options):
            counted[Path(path).name] += 1
            return plain(path, *args, **options)

        monkeypatch.setattr(os, kind, spy)
    monkeypatch.setattr("builtins.open", lambda *args, **options: pytest.fail(f"opened as a file object: {args}"))
    try:
        function()
    finally:
        monkeypatch.undo()
    return asked


@pytest.mark.parametrize("source", [None, "traj.dat", "traj.xyz", "frame*.xyz", "save.dat"])
def test_of_a_run_each_file_is_opened_once_and_the_folder_listed_once(runs, source, monkeypatch):
    """Each file of beads, the set-up and the table that tells the unit."""
    run = runs / "pvp3d"
    beads = {path.name for path in run.glob(source or "traj.dat")}
    quiet(run, source=source)  # the imports look for files, too
    asked = asked_of_the_system(lambda: quiet(run, source=source), monkeypatch)
    read = dict.fromkeys({"log.txt", "input.dat", "statout.dat", *beads}, 1)
    assert asked["open"] == read
    assert asked["scandir"] == {"pvp3d": 1}
    assert asked["listdir"] == {}
    # every file just before it is opened, the path itself twice at most, and what was named as source
    named = {source: 1} if source in ("traj.dat", "traj.xyz", "save.dat") else {}
    assert asked["stat"] - Counter(read) - Counter(named) <= Counter({"pvp3d": 2})


def test_beside_a_single_file_three_names_are_asked_after_and_no_folder_is_listed(runs, monkeypatch):
    path = runs / "pvp3d" / "traj.xyz"
    quiet(path)
    asked = asked_of_the_system(lambda: quiet(path), monkeypatch)
    assert asked["open"] == dict.fromkeys(("traj.xyz", "log.txt", "input.dat", "statout.dat"), 1)
    assert asked["scandir"] == asked["listdir"] == {}
    assert asked["stat"] <= Counter({"traj.xyz": 2, "log.txt": 2, "input.dat": 2, "statout.dat": 2})


def test_the_kind_of_a_large_file_is_told_by_its_head(runs, tmp_path, monkeypatch):
    (tmp_path / "traj.xyz").write_bytes((runs / "pvp3d" / "traj.xyz").read_bytes() * 10)
    sizes, plain = [], os.read
    monkeypatch.setattr(os, "read", lambda file, size: sizes.append(size) or plain(file, size))
    assert file_kind(tmp_path / "traj.xyz") == "xyz"
    assert sizes == [1 << 16]


def test_a_folder_that_cannot_be_listed_still_gives_the_file_that_is_named(runs, tmp_path, monkeypatch):
    whole = quiet(runs / "quasi_newtonian_kv", source="traj.xyz")

    def closed(path):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(os, "scandir", closed)
    xr.testing.assert_identical(quiet(runs / "quasi_newtonian_kv", source="traj.xyz"), whole)
    with pytest.raises(InputError, match="cannot be listed"):
        quiet(runs / "quasi_newtonian_kv")


@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
@pytest.mark.parametrize("name", ["ex1_1d_single", "ex2_1d_insert", "pvp3d"])
def test_frames_alike_are_found_at_once_as_one_by_one(runs, name, end, monkeypatch):
    """Whatever stands in one of them."""
    content = (runs / name / "traj.xyz").read_bytes() * 2
    at = content.index(b"frame at time", len(content) // 3)
    damaged = [
        content[: at + k] + new + content[at + k + len(new) :]
        for k in (-12, -1, 12, 20, 33, 42, 43)
        for new in (b"*", b"\n", b"C")
    ]
    damaged += [content[:at] + content[at + 1 :], content[: at + 100], content[:-1]]
    for text in [content, *damaged]:
        text, notes = text.replace(b"\n", end), (Notes(""), Notes(""))
        monkeypatch.setattr(xyz, "_MANY", 0)
        many = xyz.scan_frames(text, notes[0])
        monkeypatch.setattr(xyz, "_MANY", 1 << 30)
        single = xyz.scan_frames(text, notes[1])
        np.testing.assert_array_equal(np.array(many.time), np.array(single.time))
        assert (many.offset, many.rows, many.extra) == (single.offset, single.rows, single.extra)
        assert (notes[0].warnings, notes[0].dropped) == (notes[1].warnings, notes[1].dropped)


@pytest.mark.parametrize(
    "change",
    [
        (b"E-03", b"D-03"),
        (b"0.2", b"0_2"),
        (b"\n      4000", b"\n     #4000"),
        (b"0.2", b"***"),
        (b" \n", b"\n"),
        (b"", b""),
    ],
)
def test_rows_of_one_length_are_read_as_any_others(runs, change, tmp_path, monkeypatch):
    path = tmp_path / "statout.dat"
    path.write_bytes((runs / "ex2_1d_insert" / "statout.dat").read_bytes().replace(*change, 1 if change[0] else 0))
    evenly = stats.read_columns(path, at_once := Notes(""))
    monkeypatch.setattr(stats, "_even_rows", lambda *_: None)
    singly = stats.read_columns(path, one_by_one := Notes(""))
    assert [column for column, _ in evenly] == [column for column, _ in singly]
    for (_, values), (_, others) in zip(evenly, singly, strict=True):
        np.testing.assert_array_equal(values, others)
    assert (at_once.warnings, at_once.dropped) == (one_by_one.warnings, one_by_one.dropped)


@pytest.mark.parametrize("name", [name for name in RUNS if name != "ex1_1d_single"])  # of which no table is kept here
def test_the_way_of_the_first_bead_is_that_of_the_whole_table(runs, name):
    track, table = (
        sources.statistics_track(Folder(runs / name, listed=True)),
        read_statistics(runs / name / "statout.dat"),
    )
    np.testing.assert_array_equal(track.time, table.time)
    np.testing.assert_array_equal(track.x, table.x)
    assert track.refined == bool("refinements" in table and (table.refinements > 0).any())


@pytest.mark.parametrize("name", RUNS)
def test_few_rows_are_read_once_and_say_the_same_as_a_sample(runs, name, monkeypatch):
    """The length unit is looked for in 16 frames, whether all have been read for it or those alone."""
    calls, plain = [], xyz.parse_rows
    monkeypatch.setattr(xyz, "parse_rows", lambda *given: calls.append(given) or plain(*given))
    once = quiet(runs / name / "traj.xyz")
    many, rows = once.sizes["time"] > 32, (runs / name / "traj.xyz").read_bytes().count(b"\nC ")
    assert len(calls) == (2 if many and rows > sources._FEW else 1)
    calls.clear()
    monkeypatch.setattr(sources, "_FEW", 0)
    xr.testing.assert_identical(quiet(runs / name / "traj.xyz"), once)
    assert len(calls) == (2 if many else 1)
