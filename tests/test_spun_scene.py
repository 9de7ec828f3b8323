"""Drying, air, noise and several jets of a spun jet as a scene asks for them; JETSPIN's own set-ups; extremes from the command line."""

import math
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp
from spun_cases import pvp

from spinline.base.errors import InputError
from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun._air_kernels import air_at
from spinline.jetprofile.spun._neighbour_kernels import NEIGHBOURS, neighbour_forces
from spinline.jetprofile.spun.chain import parameters, start_cylinder
from spinline.jetprofile.spun.dataset import to_dataset
from spinline.jetprofile.spun.jetspin_input import translate
from spinline.jetprofile.spun.run import SpunRun, moments
from spinline.jetprofile.spun.settings import Air, tables_of
from spinline.jetprofile.spun.several import SpunJets, pattern, shifted
from spinline.scene.file import bundled_scenes, load_scene
from spinline.setup.build import build_solution
from spinline.setup.spun import spun_nozzles, spun_remarks, spun_settings

DATA = Path(__file__).parent / "data" / "jetspin"
DRY = ("jet.drying=true", "solution.solvent=ethanol", "solution.viscosity=0.3 Pa s")


def settings_of(*changes):
    scene = load_scene("pvp-spun", list(changes))
    return spun_settings(scene.jet, build_solution(scene), scene=scene)


@pytest.mark.parametrize("length", ["0.1 mm", "0.79 mm", "1 nm"])
def test_elements_are_not_split_as_they_enter(length):
    """Each half would be split again: the march stood still without a word."""
    with pytest.raises(InputError, match=r"jet.longest_element.*splits elements as they enter.*0.0008 m, twice"):
        settings_of(f'jet.longest_element="{length}"')
    assert settings_of('jet.longest_element="0.8 mm"').grid.longest == 0.8e-3
    with pytest.raises(InputError, match="largest_turn"):
        settings_of("jet.largest_turn=1e-9")


def test_a_scene_that_asks_for_nothing_gets_nothing():
    s = settings_of()
    assert s.air is None
    assert s.drying is None


def test_drying_of_a_scene_goes_to_the_wet_bulb():
    """Elements of a thread that flies straight through still air: volume and temperature against LSODA's, the temperature on its way to
    the wet bulb that the full balance (Stefan flow, library splines) has, to 0.6 K.
    """
    s = settings_of(
        *DRY, "jet.charge=none", "jet.voltage=0 V", "jet.gravity=0 m/s2", "jet.radius=5 um", "jet.flow_rate=0.5 mL/h"
    )
    d, air = s.drying, s.air
    assert air.xi == 0.0
    assert not air.lift
    assert d.cross_flow == 64.0
    s = replace(s, surface_tension=0.0, grid=replace(s.grid, element_length=2e-5))
    run = SpunRun.start(s)
    end = 2e-3
    run.advance(end)
    jet = to_dataset(run).isel(time=-1)
    speed = s.inlet.speed

    def rates(_, y):
        volume, kelvin = y
        radius = math.sqrt(volume / math.pi / 1.0)
        base = 0.495 * (2 * radius * speed / air.viscosity) ** (1 / 3)
        polymer = d.fraction * math.pi * s.inlet.radius**2 / volume
        activity = (1 - polymer) * math.exp(polymer + d.interaction * polymer**2)
        vapour = d.equilibrium * math.exp(d.latent_slope * (1 / d.temperature - 1 / kelvin))
        sherwood = base * math.sqrt(air.viscosity / d.vapour_diffusion)
        lost = -math.pi * d.vapour_diffusion * sherwood * (vapour * activity - d.far)
        warmed = math.pi * d.air_conductivity * base * math.sqrt(d.prandtl) * (d.air_temperature - kelvin)
        return [lost, (warmed + s.density * d.latent * lost) / (s.density * d.heat_capacity * volume)]

    # the front element is as old as the run and keeps its length
    found = solve_ivp(
        rates, (0, end), [math.pi * s.inlet.radius**2, d.temperature], method="LSODA", rtol=1e-9, atol=1e-30
    )
    front = int(jet["n_bead"]) - 2
    length = float(jet["element_length"][front])
    assert float(jet["volume"][front]) / length == pytest.approx(found.y[0, -1], rel=2e-3)
    assert float(jet["temperature"][front]) == pytest.approx(found.y[1, -1], abs=0.05)
    assert float(jet["polymer_fraction"][front]) > 1.04 * d.fraction
    coldest = float(np.nanmin(jet["temperature"]))
    from spinline.setup.heat import build_heated_air

    scene = load_scene("pvp-spun", list(DRY))
    bulb = build_heated_air(scene, build_solution(scene)).wet_bulb
    assert coldest > bulb - 0.6
    assert coldest < d.temperature - 5


def test_laws_of_the_scene_reach_the_beads():
    plain = settings_of(*DRY).drying
    assert (plain.viscosity_factor, plain.viscosity_power, plain.time_power) == (7.0, 0.1, 1.0)
    held = settings_of(*DRY, "rheology.law=constant", "effects.heat=false").drying
    assert (held.viscosity_factor, held.time_power, held.heat_capacity) == (0.0, 0.0, 0.0)
    straight = settings_of(*DRY, "rheology.transfer=yarin").drying
    assert straight.cross_flow == 0.0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (("jet.drying=true",), "mixture"),
        ((*DRY, "ambient.relative_humidity=40 %"), "water"),
        ((*DRY, "effects.evaporation=false"), "false"),
        ((*DRY, "rheology.law=scaling"), "not along beads"),
        ((*DRY, "rheology.activity=unit"), "Flory"),
        (("jet.air_field=nowhere.csv",), "does not exist"),
        (("jet.noise_length=1 um",), "noise"),
        (("jet.noise=10 m2/s",), "velocity diffusivity"),
        (("jet.jets=3",), "jet_spacing"),
        (("jet.jets=3", "jet.jet_spacing=1 cm", "jet.jet_pattern=square"), "square"),
    ],
)
def test_what_beads_cannot_do_is_named(changes, words):
    with pytest.raises(InputError, match=words):
        settings_of(*changes)


def test_air_of_a_scene(tmp_path):
    (tmp_path / "air.csv").write_text("x [mm],velocity [m/s],half_width [mm]\n0,20,1\n50,10,5\n100,4,10\n")
    own = tmp_path / "own.toml"
    own.write_text((Path(bundled_scenes()["pvp-spun"])).read_text())
    scene = load_scene(own, ["jet.air_drag=true", "jet.air_field=air.csv", "ambient.air_velocity=1 m/s"])
    scene = (
        scene.model_copy(update={"folder": tmp_path})
        if hasattr(scene, "model_copy")
        else replace(scene, folder=tmp_path)
    )
    s = spun_settings(scene.jet, build_solution(scene), scene=scene)
    p, k = parameters(s)
    assert k[c.AIR] == 1
    assert k[c.LIFT] == 0
    tables = tables_of(s)
    for x, speed, half in ((0.0, 20, 1e-3), (25e-3, 15, 3e-3), (75e-3, 7, 7.5e-3), (0.3, 4, 10e-3)):
        assert air_at(x, 0.0, 0.0, p, tables) == pytest.approx((1 + speed, 0, 0))
        assert air_at(x, half, 0.0, p, tables)[0] == pytest.approx(1 + speed / 2)
    with pytest.raises(InputError, match="air axis"):
        Air(axis=(0.0, 0.0), speeds=(1.0, 2.0))


def test_noise_of_a_scene_is_a_piece_of_jet():
    """D_v is given for a piece of the jet; a finer grid has the same impulses, another seed others."""
    s = settings_of("jet.noise=40 m2/s3", "jet.noise_length=0.1 mm")
    piece = s.density * s.air.grain
    assert s.air.noise / piece == pytest.approx(40)
    assert s.air.grain == pytest.approx(math.pi * s.inlet.radius**2 * 1e-4)
    fine = settings_of("jet.noise=40 m2/s3", "jet.noise_length=0.1 mm", "jet.element_length=0.2 mm")
    assert fine.air == s.air
    scene = load_scene("pvp-spun", ["jet.noise=40 m2/s3"])
    assert any("noise" in words for words in spun_remarks(scene.jet, build_solution(scene), scene))


@pytest.mark.parametrize(("amplitude", "said"), [("20 um", False), ("100 um", True)])
def test_a_circle_off_the_needles_axis_is_said(amplitude, said):
    """The field of a conducting jet's needle does not follow its nozzle."""
    scene = load_scene("peo5-spun", [f"jet.nozzle_amplitude={amplitude}", "jet.nozzle_frequency=100 1/s"])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        spun_settings(scene.jet, build_solution(scene), scene=scene)
    told = [str(one.message) for one in caught if "nozzle_amplitude" in str(one.message)]
    assert [f"{float(amplitude[:3]) / 125:.2g} needle radii" in words for words in told] == [True] * said


def test_nozzles():
    line = pattern("line", 3, 0.01)
    assert line[:, 0] == pytest.approx([-0.01, 0, 0.01])
    square = pattern("square", 9, 0.01)
    assert square.mean(axis=0) == pytest.approx([0, 0], abs=1e-15)
    assert len({tuple(np.round(row, 9)) for row in square}) == 9
    ring = pattern("ring", 6, 0.01)
    assert np.linalg.norm(ring[0] - ring[1]) == pytest.approx(0.01)
    scene = load_scene("pvp-spun", ["jet.jets=4", "jet.jet_spacing=5 mm", "jet.jet_pattern=square"])
    assert spun_nozzles(scene.jet).shape == (4, 2)


def test_forces_of_neighbours():
    """Against the plain sum, at a later moment."""
    s = pvp(4e-4, repulsion="hybrid", start=4e-3)
    chain = start_cylinder(s)
    n, y = chain.n, chain.state
    rng = np.random.default_rng(3)
    others = rng.normal(size=(7, 30)) * np.array([1e-2, 1e-2, 1e-2, 5, 5, 5, 1e-12])[:, None]
    tables = np.zeros((NEIGHBOURS + 7, 30))
    tables[NEIGHBOURS:], tables[0, 3], tables[0, 4] = others, 30, 1e-3
    p, _ = parameters(s)
    w, f = np.zeros((c.WORK, len(y))), np.zeros((len(y), 3))
    w[c.AREA, :n] = math.pi * s.inlet.radius**2
    neighbour_forces(1.5e-3, n, y, p, tables, w, f)
    at = others[:3] + 0.5e-3 * others[3:6]
    charge = 0.5 * (y[:n, c.CHARGE] + np.concatenate(([0.0], y[: n - 1, c.CHARGE])))
    apart = y[:n, :3, None] - at[None]
    far = (apart**2).sum(axis=1) + s.inlet.radius**2
    true = c.COULOMB * charge[:, None] * (others[6] * apart / far[:, None] ** 1.5).sum(axis=2)
    assert f[:n] == pytest.approx(true, rel=1e-12)
    assert not f[n:].any()


def test_two_jets_bend_apart_as_mirror_images(tmp_path):
    """And hardly know of one another ten metres apart."""
    s = pvp(4e-4, charge=8800.0, repulsion="hybrid", start=8e-4)
    pair = SpunJets.start(s, pattern("line", 2, 5e-3))
    far = SpunJets.start(s, pattern("line", 2, 10.0))
    alone = SpunRun.start(s)
    times = moments(4e-3, 2)
    for _ in pair.to(times):
        pass
    far.advance(4e-3)
    alone.advance(4e-3)
    left, right = (run.chain.nodes for run in pair.runs)
    assert left[:, c.Y] == pytest.approx(-right[:, c.Y], abs=1e-9)
    assert left[:, c.X] == pytest.approx(right[:, c.X], rel=1e-7)
    assert right[0, c.Y] > 1e-5
    assert far.runs[0].chain.nodes[:, c.X] == pytest.approx(alone.chain.nodes[:, c.X], rel=1e-5, abs=1e-9)
    again = SpunJets.unpack(s, pair.offsets, pair.pack())
    for jets in (pair, again):
        jets.advance(5e-3)
    assert np.array_equal(again.runs[1].chain.nodes, pair.runs[1].chain.nodes)
    jet = shifted(to_dataset(pair.runs[1]), pair.offsets[1], 1)
    assert float(jet["y"][-1, 0]) == pytest.approx(2.5e-3, abs=1e-4)
    assert jet.attrs["nozzle_y"] == pytest.approx(2.5e-3)


def test_several_from_the_command_line(spinline, tmp_path):
    changes = [f"jet.{k}" for k in ("jets=3", "jet_spacing=1 cm", "jet_pattern=ring")]
    ran = spinline(
        "spin",
        "pvp-spun",
        "-o",
        "j.nc",
        "--quick",
        "--time",
        "1 ms",
        "--frames",
        "2",
        *(a for x in changes for a in ("--set", x)),
    )
    assert ran.code == 0, ran.err
    assert sorted(p.name for p in tmp_path.glob("*.nc")) == ["j-0.nc", "j-1.nc", "j-2.nc"]
    with xr.open_dataset(tmp_path / "j-2.nc") as jet:
        assert jet.attrs["jets"] == 3
        assert math.hypot(jet.attrs["nozzle_y"], jet.attrs["nozzle_z"]) == pytest.approx(1e-2 / math.sqrt(3))
    assert (
        spinline("spin", "pvp-spun", "--seeds", "2", "--set", "jet.jets=2", "--set", "jet.jet_spacing=1 cm").code == 2
    )


@pytest.mark.parametrize("name", sorted(path.parent.name for path in DATA.glob("*/input.dat")))
def test_real_set_ups(name):
    """Every key of real input files is translated, listed, or refused by its name."""
    text = (DATA / name / "input.dat").read_text()
    if "kvfluid yes" in text:
        with pytest.raises(InputError, match="kvfluid"):
            translate(text, flow_rate=1e-8)
        return
    if "inserting no" in text:
        with pytest.raises(InputError, match="two_bead"):
            translate(text)
    found = translate(text, flow_rate=1e-8)
    assert any("175 pass" in words for words in found.differs)
    assert "timestep" in found.ignored
    refined = "dynamic refinement yes" in text
    assert refined == any("refinement" in words for words in found.differs)
    assert ("airdrag yes" in text) == (found.settings.air is not None)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (("jet.voltage=0 V",), ""),
        (("jet.charge=none",), ""),
        (("jet.charge=none", "jet.voltage=0 V", "jet.gravity=0 m/s2"), ""),
        (("solution.viscosity=0 Pa s",), "solution.viscosity"),
        (("solution.viscosity=1 uPa s", "jet.charge=none"), ""),
        (("solution.relaxation_time=0 s",), "relaxation_time"),
        (("solution.relaxation_time=1e5 s", "solution.viscosity=1e8 Pa s"), ""),
        (("jet.element_length=10 cm",), "element_length"),
        (("jet.element_length=3 cm",), ""),
        (("jet.gap=1 mm", "jet.voltage=50 V", "jet.element_length=20 um"), ""),
        (("jet.gap=1 m",), ""),
        (("jet.gap=0 m",), "jet.gap"),
        (("jet.element_length=0 m",), "element_length"),
        (("jet.element_length=1 nm", "--time", "20 ms"), "element_length"),
        (("jet.charge=none", "jet.voltage=0 V", "jet.gravity=-9000 m/s2", "--time", "3 ms"), "collapses"),
    ],
    ids=lambda value: " ".join(value)[:60] if isinstance(value, tuple) else "",
)
def test_extremes_from_the_command_line(spinline, changes, words):
    """A result, or a refusal by name."""
    sets = [a for x in changes if x.startswith(("jet.", "solution.")) for a in ("--set", x)]
    time = changes[changes.index("--time") + 1] if "--time" in changes else "0.5 ms"
    ran = spinline("spin", "pvp-spun", "-o", "x.nc", "--quick", "--frames", "1", "--time", time, *sets)
    if words:
        assert ran.code == 2, ran.out
        assert words in ran.err
    else:
        assert ran.code == 0, ran.err
        assert "elements in flight" in ran.out
    assert "Traceback" not in ran.err
