"""Drying, relaxing and freezing jets as runs: references, limits with their rates, conservation, extremes, refusals."""

import warnings

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import spinline as sl
from spinline.base.errors import InputError, SpinlineWarning
from spinline.plan.governing_numbers import effect_numbers
from spinline.rheology import equilibrium_fraction
from spinline.rheology.evaporation import power_law_loss
from spinline.setup.build import build_jet, build_solution
from spinline.solve.results import VARIABLES
from spinline.study.difference import difference, largest

# one temperature, a theta solvent, no crystals: heat, library interactions and solids are in test_heat_run.py
ISOTHERMAL = ("effects.heat=false", "rheology.chi=0.5", "rheology.crystallisation=none")
HUMID = "ambient.relative_humidity=0.4"
WET = (HUMID, "effects.evaporation=true")
LONG = "jet.length=10 mm"
RELAXING = ("solution.relaxation_time=10 ms", "network.model=conformation")
ACROSS = (*WET, "effects.radial=true", "rheology.diffusivity=1e-10 m2/s")


def quiet(name: str, *overrides: str) -> xr.Dataset:
    """Run without remarks; anything numpy has to say is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", SpinlineWarning)
        warnings.filterwarnings("ignore", module="chemicals")
        return sl.run(sl.load_scene(name, (*ISOTHERMAL, *overrides)))


# --- evaporation -----------------------------------------------------------------------------------------------------


def test_peo_in_water_with_given_properties_is_the_closed_form() -> None:
    given_ = (
        "ambient.vapour_diffusivity=2.5e-5 m2/s",
        "ambient.air_viscosity=1.5e-5 m2/s",
        "ambient.saturation=1.73e-5",
    )
    result = quiet("peo5-water", *WET, LONG, *given_, "rheology.activity=unit")
    lost = result["evaporated_fraction"].values
    assert 100 * lost[-1] == pytest.approx(0.405433374, abs=5e-10)
    r0, q = 125e-6, 3.2e-6 / 3600
    first = 0.495 * np.cbrt(2 * q / (np.pi * r0) / 1.5e-5) * np.sqrt(1.5 / 2.5)
    rate = np.pi * 2.5e-5 * first * 1.73e-5 * 0.6 * r0 / q
    exact = power_law_loss(result["z"].values / r0, 1.0, 0.47, rate)
    np.testing.assert_allclose(lost[1:], exact[1:], rtol=1e-9)


def test_library_properties_and_the_convention_of_2001() -> None:
    mass = quiet("peo5-water", *WET, LONG)
    assert 0.36 < 100 * float(mass["evaporated_fraction"][-1]) < 0.45
    # the velocity is kept: the crossover stays where it is, in a thinner jet
    plain = quiet("peo5-water", LONG)
    assert float(mass["crossover_position"]) == pytest.approx(float(plain["crossover_position"]), rel=1e-12)
    left = 1 - np.interp(float(mass["crossover_position"]), mass["z"], mass["evaporated_fraction"])
    assert float(mass["crossover_radius"] / plain["crossover_radius"]) == pytest.approx(np.sqrt(left), rel=1e-6)
    mole = quiet("peo5-water", *WET, LONG, "rheology.convention=yarin2001")
    assert float(mole["mean_polymer_fraction"][-1]) == pytest.approx(equilibrium_fraction(0.4, 0.5), abs=2e-3)
    # initial rates: rho R T / (p M), 1300 for water
    near = [float(run["evaporated_fraction"][1]) for run in (mass, mole)]
    assert near[1] / near[0] == pytest.approx(998.2 * 8.314462618 * 293.15 / (101325 * 18.015e-3), rel=2e-3)


@settings(max_examples=8, deadline=None)
@given(
    st.floats(0.002, 0.6),
    st.floats(0.3, 3.0),
    st.floats(0.25, 1.0),
    st.floats(0.001, 0.9) | st.just(0.0),
    st.floats(-3, 2.5),
    st.sampled_from(["power-law", "hyperbolic"]),
)
def test_polymer_is_conserved_for_any_jet_and_drying(phi, k, beta, humidity, decades, profile) -> None:
    jet = f"jet={{profile='{profile}', radius='50 um', flow_rate='1 mL/hour', length='20 mm', "
    jet += f"k={k}, beta={beta}}}" if profile == "power-law" else f"p={10 * k}}}"
    result = quiet(
        "peo5-water",
        f"solution={{polymer='PEO', solvent='water', volume_fraction={phi}}}",
        jet,
        f"ambient.relative_humidity={humidity}",
        "effects.evaporation=true",
        "accuracy.points=60",
        "network.model=affine",
        f"ambient.saturation={1.73e-5 * 10**decades}",
    )
    flux = np.pi * result["radius"] ** 2 * result["velocity"] * result["mean_polymer_fraction"]
    np.testing.assert_allclose(flux, phi * 1e-6 / 3600, rtol=1e-12)
    mean = result["mean_polymer_fraction"].values
    assert (np.diff(mean) * np.sign(equilibrium_fraction(humidity, 0.5) - phi) >= -1e-12).all()
    assert (mean <= 1).all()


def test_polymer_is_conserved_across_the_jet() -> None:
    result = quiet("peo5-water", *ACROSS, "rheology.convention=yarin2001", "accuracy.points=40")
    area = np.diff(np.linspace(0, 1, 101) ** 2)
    for name in ("polymer_fraction", "drying_polymer_fraction"):
        whole = result[name].values @ area
        np.testing.assert_allclose(whole, result["mean_polymer_fraction"], rtol=1e-12)
        assert (result[name] <= 1).all()
        assert (result[name] >= 0).all()
    flux = np.pi * result["radius"] ** 2 * result["velocity"] * result["mean_polymer_fraction"]
    np.testing.assert_allclose(flux, flux[0], rtol=1e-12)


def test_a_measured_radius_is_kept_and_the_jet_is_slower(tmp_path) -> None:
    jet = sl.jetprofile.PowerLaw(radius=125e-6, flow_rate=3.2e-6 / 3600, k=1.0, beta=0.47)
    z = np.linspace(0, 5e-3, 300)
    rows = "\n".join(f"{1e3 * a!r},{1e6 * float(jet.radius(a))!r}" for a in z.tolist())
    (tmp_path / "jet.csv").write_text("z [mm],radius [um]\n" + rows)
    head = sl.load_scene("peo5-water").text.split("[jet]")[0]
    (tmp_path / "s.toml").write_text(head + '[jet]\nprofile="table"\npath="jet.csv"\nflow_rate="3.2 mL/h"\n')
    dry = ("rheology.convention=yarin2001", *WET, "solution.relaxation_time=0.1 s")
    plain, result = quiet(str(tmp_path / "s.toml")), quiet(str(tmp_path / "s.toml"), *dry)
    at = result["z"].values
    np.testing.assert_allclose(result["radius"], np.interp(at, plain["z"], plain["radius"]), rtol=1e-3)
    left = 1 - result["evaporated_fraction"].values
    np.testing.assert_allclose(result["velocity"], np.pi**-1 * 3.2e-6 / 3600 * left / result["radius"] ** 2, rtol=1e-12)
    time = np.concatenate(
        ([0], np.cumsum(np.diff(at) * 0.5 * (1 / result["velocity"].values[1:] + 1 / result["velocity"].values[:-1])))
    )
    assert float(result["residence_time"][-1]) == pytest.approx(time[-1], rel=2e-4)
    stiff = quiet(
        str(tmp_path / "s.toml"), *dry[:2], HUMID, "solution.relaxation_time=1e9 s", "network.model=conformation"
    )
    np.testing.assert_allclose(stiff["strand_stretch"], stiff["velocity"] / stiff["velocity"][0], rtol=1e-6)


# --- relaxation ------------------------------------------------------------------------------------------------------


def test_conformation_is_affine_where_nothing_relaxes_and_rest_where_all_does() -> None:
    """Rate 1 in 1/De and in De: the rung meets the one below it, and the network at rest."""
    affine = quiet("peo5-water")
    names = ("strand_stretch", "relative_extension", "orientation", "core_polymer_fraction_conservative")
    gaps = {name: [] for name in names}
    for theta in ("1e3 s", "1e4 s", "1e5 s"):
        result = quiet("peo5-water", f"solution.relaxation_time={theta}", "network.model=conformation")
        assert result.attrs["model"] == "conformation"
        for name in names:
            gaps[name].append(float(np.abs(result[name] - affine[name]).max()))
    for name, gap in gaps.items():
        rates = np.log10(np.divide(gap[:-1], gap[1:]))
        np.testing.assert_allclose(rates, 1.0, atol=0.02, err_msg=name)
    assert float(result["crossover_position"]) == pytest.approx(float(affine["crossover_position"]), rel=1e-5)
    rest = []
    for theta in ("1e-7 s", "1e-8 s", "1e-9 s"):
        result = quiet("peo5-water", f"solution.relaxation_time={theta}", "network.model=conformation")
        rest.append(float((result["strand_stretch"] - 1).max()))
        np.testing.assert_allclose(result["mean_polymer_fraction"], result["volume_fraction"], rtol=1e-12)
    np.testing.assert_allclose(np.log10(np.divide(rest[:-1], rest[1:])), 1.0, atol=0.02)
    # sqrt(1 + 2 De) - 1 = De
    assert rest[-1] == pytest.approx(1e-9 * float(affine["strain_rate"].max()), rel=1e-2)
    assert np.isnan(float(result["crossover_position"]))
    assert "as it relaxes" in result.attrs["crossover"]


@pytest.mark.parametrize("model", ["UCM", "Oldroyd-B", "FENE-P", "Giesekus"])
def test_conformation_against_an_independent_integration(model: str) -> None:
    from scipy.integrate import solve_ivp

    extra = ("rheology.mobility=0.2",) if model == "Giesekus" else ()
    result = quiet("peo5-water", *RELAXING, f"rheology.constitutive={model}", *extra, "accuracy.points=801")
    jet = sl.jetprofile.PowerLaw(radius=125e-6, flow_rate=3.2e-6 / 3600, k=1.0, beta=0.47)
    theta, limit = 0.01, float(result["volume_fraction"]) ** -2

    def slope(z, a):
        v, rate = float(jet.velocity(z)), float(jet.strain_rate(z))
        f = (limit - 3) / (limit - a[0] - 2 * a[1]) if model == "FENE-P" else 1.0
        g = f * a - 1
        if model == "Giesekus":
            g = (a - 1) + 0.2 * (a - 1) ** 2
        return (np.array([2.0, -1.0]) * rate * a - g / theta) / v

    exact = solve_ivp(slope, (125e-6, 5e-3), [1.0, 1.0], method="LSODA", rtol=1e-11, atol=1e-13).y[:, -1]
    assert float(result["strand_stretch"][-1]) == pytest.approx(np.sqrt(exact[0]), rel=2e-6)
    f = (limit - 3) / (limit - exact[0] - 2 * exact[1]) if model == "FENE-P" else 1.0
    solvent = 1.0016e-3 if model == "Oldroyd-B" else 0.0
    stress = (2.0 - solvent) / theta * (f * exact - 1) + solvent * np.array([2, -1]) * float(jet.strain_rate(5e-3))
    assert float(result["stress"][-1]) == pytest.approx(stress[0], rel=1e-5)
    assert float(result["radial_stress"][-1]) == pytest.approx(stress[1], rel=1e-5)
    force = np.pi * float(jet.radius(5e-3)) ** 2 * (stress[0] - stress[1])
    assert float(result["tensile_force"][-1]) == pytest.approx(force, rel=1e-5)
    smooth = np.abs(result["z"].values - 125e-6) > 1e-9  # the rate jumps at the onset
    np.testing.assert_allclose(
        result["weissenberg_number"][smooth], theta * result["strain_rate"][smooth], rtol=1e-3, atol=1e-12
    )


def test_closure_stretch_takes_strands_that_end() -> None:
    result = quiet(
        "peo5-water", "solution.relaxation_time=1 s", "network.model=conformation", "network.closure=stretch"
    )
    assert "FENEP" in result.attrs["constitutive_model"]
    full = float(result["crossover_velocity_ratio"])
    assert float(result["strand_stretch"].max()) < full
    assert np.isfinite(result["strand_force"]).all()


def test_drying_slows_relaxation() -> None:
    """Concentrating by evaporation raises theta and mu, Eq. (45), and the strands keep more of their stretch."""
    wet = quiet("peo5-water", *RELAXING, HUMID, "effects.evaporation=false")
    dry = quiet("peo5-water", *RELAXING, *WET, "rheology.convention=yarin2001")
    c = (
        dry["mean_polymer_fraction"]
        * 1130
        / (dry["mean_polymer_fraction"] * 1130 + (1 - dry["mean_polymer_fraction"]) * dry.attrs["solvent_density"])
    )
    np.testing.assert_allclose(dry["relaxation_time"], 0.01 * c / c[0], rtol=1e-9)
    np.testing.assert_allclose(dry["viscosity"], 2.0 * 10 ** (7 * (c**0.1 - c[0] ** 0.1)), rtol=1e-9)
    assert float(dry["strand_stretch"][-1]) > 1.2 * float(wet["strand_stretch"][-1])
    assert (np.diff(dry["relaxation_time"]) >= -1e-12).all()


@pytest.mark.parametrize(
    ("law", "theta", "mu"),
    [
        (("rheology.law=constant",), 0.0, 0.0),
        (("rheology.law=scaling",), 7 / 3, 14 / 3),
        (("rheology.law=scaling", "network.solvent_quality=good"), 3 * 0.412 / 0.764, 3 / 0.764),
        (("rheology.law=constant", "rheology.n=-1"), None, 0.0),
    ],
)
def test_laws_of_concentration_act(law: tuple[str, ...], theta: float | None, mu: float) -> None:
    result = quiet("peo5-water", *RELAXING, *WET, "rheology.convention=yarin2001", "rheology.chi=0.45", *law)
    phi = result["mean_polymer_fraction"]
    ratio = phi / phi[0]
    if theta is None:  # as printed: in mass fractions
        mass = phi * 1130 / (phi * 1130 + (1 - phi) * result.attrs["solvent_density"])
        np.testing.assert_allclose(result["relaxation_time"], 0.01 * mass[0] / mass, rtol=1e-9)
    else:
        np.testing.assert_allclose(result["relaxation_time"], 0.01 * ratio**theta, rtol=1e-9)
    solvent = 1.0016e-3 if mu else 0.0
    np.testing.assert_allclose(result["viscosity"], solvent + (2 - solvent) * ratio**mu, rtol=1e-5)
    assert result.attrs["concentration_laws"]


def test_martin_and_free_volume_act() -> None:
    martin = ("rheology.law=martin", "rheology.intrinsic_viscosity=0.3 m3/kg", "rheology.martin_constant=0.2")
    result = quiet("peo5-water", *WET, *martin)
    x = 0.3 * 1130 * result["mean_polymer_fraction"]
    np.testing.assert_allclose(result["viscosity"], 1.0016e-3 * (1 + x * np.exp(0.2 * x)), rtol=1e-4)
    law = (
        "rheology.D_law=free-volume",
        "rheology.D_gap=0.1",
        "rheology.D_growth=0.2",
        "rheology.diffusivity=1e-13 m2/s",
    )
    across = quiet("peo5-water", *WET, "effects.radial=true", *law, "accuracy.points=50", "accuracy.shells=30")
    mean = across["mean_polymer_fraction"].values
    diffusivity = 1e-13 * np.exp((1 - mean) / (0.1 + 0.2 * (1 - mean)))
    shape = across["drying_peclet"] * diffusivity / across["sherwood_number"]
    np.testing.assert_allclose(shape, shape[0], rtol=1e-9)


def test_extremes_are_finite_and_ordered() -> None:
    """phi from 1e-4 to dryness, viscosity over 12 decades in one jet, De from 1e-8 to 1e12."""
    thin = (
        "solution={polymer='PEO', solvent='water', volume_fraction=1e-4, viscosity='1 mPa s', relaxation_time='1 s'}",
        "jet={profile='power-law', radius='5 um', flow_rate='0.05 mL/hour', k=0.3, beta=0.5, length='100 mm'}",
        "ambient.relative_humidity=0",
        "effects.evaporation=true",
        "rheology.convention=yarin2001",
        "rheology.B=21",
        "network.model=conformation",
    )
    result = quiet("peo5-water", *thin)
    mean = result["mean_polymer_fraction"].values
    assert mean[0] == pytest.approx(1e-4, rel=1e-9)
    assert 0.999 < mean[-1] <= 1
    assert (np.diff(mean) >= 0).all()
    assert np.log10(float(result["viscosity"][-1] / result["viscosity"][0])) > 12
    assert (result["viscosity"].diff("z") >= 0).all()
    rate = float(quiet("peo5-water")["strain_rate"].max())
    stretches = []
    for decade in range(-8, 13, 4):
        run = quiet("peo5-water", f"solution.relaxation_time={10.0**decade / rate!r} s", "network.model=conformation")
        for name, variable in run.data_vars.items():
            if "z" in variable.dims:
                assert np.isfinite(variable).all(), name
        assert (run["core_polymer_fraction"] <= 1).all()
        assert (run["relative_extension"] <= 1).all()
        stretches.append(run["strand_stretch"].values)
    for slower, faster in zip(stretches[1:], stretches, strict=False):
        assert (slower >= faster * (1 - 1e-9)).all()
    for name, variable in result.data_vars.items():
        if "z" in variable.dims and name != "strand_force":
            assert np.isfinite(variable).all(), name


# --- bead jets -------------------------------------------------------------------------------------------------------


def test_the_material_stretch_drives_the_network_along_a_bent_jet() -> None:
    """Integrated strain = 2 ln(r_a/r_b): of the rates over the age of the elements, and of strands that do not relax."""
    plain = quiet("pvp-jetspin")
    known = np.isfinite(plain["stretch_ratio"].values)
    rate, time, radius = (plain[name].values[known] for name in ("strain_rate", "residence_time", "radius"))
    strain = np.concatenate(([0], np.cumsum(np.diff(time) * 0.5 * (rate[1:] + rate[:-1]))))
    for a, b in ((5, 110), (10, 50), (50, 110)):  # beyond the nozzle, where rates make no sense
        assert (strain[b] - strain[a]) / (2 * np.log(radius[a] / radius[b])) == pytest.approx(1, abs=0.02)
    # the jet is 25 ms old, and settled after 15
    assert 0.01 < time[-1] < 0.015
    assert plain.attrs["flow_rate"] / (np.pi * 50e-6**2) == pytest.approx(1.76, abs=0.02)  # m/s, physics.md section 7
    stiff = quiet("pvp-jetspin", "solution.relaxation_time=1e6 s", "network.model=conformation")
    w = stiff["strand_stretch"].values[known]
    np.testing.assert_allclose(np.log(w[110] / w[10]), 2 * np.log(radius[10] / radius[110]), rtol=1e-6)
    lab = np.abs(np.gradient(plain["x"].values[1:][known], time))  # what the spinning axis sees of it
    assert not np.allclose(np.log(lab[100] / lab[10]), np.log(w[100] / w[10]), rtol=0.3)
    relaxed = quiet("pvp-jetspin", "solution.relaxation_time=5 ms", "network.model=conformation")
    assert float(relaxed["strand_stretch"].values[known][-1]) < 0.8 * w[-1]


def test_a_bead_jet_dries_at_all_its_times() -> None:
    overrides = ("solution.relaxation_time=20 ms", HUMID, "jet.time=all", "rheology.vitrification_fraction=0.025")
    result = quiet("pvp-jetspin", *overrides)
    assert result["evaporated_fraction"].dims == ("time", "element")
    assert result["frozen_position"].dims == ("time",)
    last = quiet("pvp-jetspin", *overrides[:2], overrides[3])
    known = np.isfinite(last["stretch_ratio"].values)
    for name in ("evaporated_fraction", "strand_stretch", "radius", "viscosity"):
        np.testing.assert_allclose(result[name].values[-1][known], last[name].values[known], rtol=1e-9)
    flux = (result["radius"] ** 2 * result["stretch_ratio"] * result["mean_polymer_fraction"]).values
    np.testing.assert_allclose(flux[np.isfinite(flux)], 2.5e-9 * float(result["volume_fraction"]), rtol=1e-12)
    assert float(result["frozen_position"][-1]) == float(last["frozen_position"])


# --- across the jet, and what stays ----------------------------------------------------------------------------------


GLASS = (
    "solution={polymer='PMMA', solvent='acetone', mass_fraction=0.1, viscosity='0.5 Pa s', relaxation_time='20 ms'}",
    "jet={profile='power-law', radius='100 um', flow_rate='2 mL/hour', k=1.0, beta=0.47, length='60 mm'}",
    "effects.evaporation=true",
    "rheology.vitrification_fraction=0.75",
)


def test_two_rises_of_fig_37() -> None:
    """A dense core by contraction, a skin by drying, and less than the mean between them; each alone has its own."""
    result = quiet("peo5-water", *GLASS, "effects.radial=true", "rheology.diffusivity=2e-10 m2/s", "jet.length=6 mm")
    last, phi0 = result.sel(z=6e-3), float(result["volume_fraction"])
    phi, mean = last["polymer_fraction"].values, float(last["mean_polymer_fraction"])
    assert phi[0] > 5 * mean
    assert phi[-1] > 1.4 * mean
    assert phi[40:80].min() < 0.1 * mean
    drying = last["drying_polymer_fraction"].values
    assert drying[0] == pytest.approx(phi0, rel=1e-3)
    assert (np.diff(drying) >= -1e-12).all()
    skin = (drying[-1] - drying[0]) / (1 - drying[0])  # left where it was
    assert phi[-1] == pytest.approx(skin, rel=1e-6)
    np.testing.assert_allclose(result["polymer_fraction"].values[0], phi0, rtol=1e-9)
    inner = result["r"].values < 0.9 * float(last["network_radius"] / last["radius"])
    np.testing.assert_allclose(phi[inner], float(last["core_polymer_fraction"]), rtol=0.02)
    assert (result["fourier_number"].diff("z") > 0).all()
    # diffusion alone, nothing lost: pi D z/Q
    slow = quiet(
        "peo5-water", *GLASS, "effects.radial=true", "rheology.diffusivity=2e-10 m2/s", "ambient.saturation=1e-12"
    )
    assert float(slow["fourier_number"][-1]) == pytest.approx(np.pi * 2e-10 * 60e-3 / (2e-6 / 3600), rel=1e-8)


def test_what_freezes_stays() -> None:
    result = quiet("peo5-water", *GLASS)
    place = float(result["frozen_position"])
    z = result["z"].values
    assert 0 < place < 60e-3
    assert np.interp(place, z, result["mean_polymer_fraction"]) == pytest.approx(0.75, abs=2e-3)
    beyond = z > place
    np.testing.assert_array_equal(result["frozen"], beyond)
    for name in ("orientation", "strand_stretch", "relative_extension", "axial_stretch"):
        assert np.ptp(result[name].values[beyond]) == 0
    assert float(result["orientation"][-1]) == pytest.approx(float(result["frozen_orientation"]), rel=1e-12)
    assert float(result["frozen_stretch"]) == float(result["strand_stretch"][-1])
    affine = np.interp(place, z, result["stretch_ratio"])
    assert float(result["frozen_relaxed"]) == pytest.approx(1 - float(result["frozen_stretch"]) / affine, abs=1e-3)
    assert np.isnan(result["stress"].values[beyond]).all()
    assert np.isfinite(result["stress"].values[~beyond]).all()
    assert float(result["frozen_radius"]) == pytest.approx(np.interp(place, z, result["radius"]), rel=1e-3)
    assert float(result["frozen_time"]) == pytest.approx(np.interp(place, z, result["residence_time"]), rel=1e-3)
    assert "turns to glass" in " ".join(sl.report.words(result))
    assert "reaches phi = 0.75" in result.attrs["frozen_structure"]
    assert "frozen_orientation" in sl.report.html(result)


def test_skin_before_mean_before_core() -> None:
    result = quiet("peo5-water", *GLASS, "effects.radial=true", "rheology.diffusivity=2e-9 m2/s", "accuracy.shells=60")
    skin, mean, core = (float(result[f"{name}_position"]) for name in ("skin", "frozen", "core"))
    assert skin < mean
    assert not core <= mean
    assert float(result["skin_stretch"]) < float(result["frozen_stretch"])
    at = result["z"].values > skin * 1.02
    assert (result["skin_thickness"].values[at] > 0).all()
    assert (result["skin_thickness"].values[result["z"].values < skin * 0.98] == 0).all()
    flat = quiet("peo5-water", *GLASS)
    assert mean > float(flat["frozen_position"])  # a skin slows drying


def test_what_does_not_freeze_says_why() -> None:
    short = quiet("peo5-water", *GLASS, "jet.length=10 mm")
    assert np.isnan(float(short["frozen_position"]))
    assert np.isnan(float(short["frozen_orientation"]))
    long = quiet("peo5-water", *GLASS)
    predicted = float(short.attrs["frozen_structure"].split("about ")[1].split(" m ")[0])
    assert predicted == pytest.approx(float(long["frozen_position"]), rel=2e-4)  # it is written with four digits
    few = quiet("peo5-water", *GLASS, "accuracy.points=11")
    assert float(few["frozen_position"]) == pytest.approx(float(long["frozen_position"]), rel=1e-6)
    never = quiet("peo5-water", *WET, "rheology.vitrification_fraction=0.95")
    assert f"drying ends at phi = {equilibrium_fraction(0.4, 0.5):.4g}" in never.attrs["frozen_structure"]
    rubber = quiet("peo5-water", *WET)
    assert "not known" in rubber.attrs["frozen_structure"]
    assert "No structure is frozen in" in " ".join(sl.report.words(rubber))


def test_to_complete_dryness_across_the_jet() -> None:
    """The integration may undershoot dryness by its error: what is dry is dry, and no more."""
    thin = (
        "solution={polymer='PCL', solvent='DCM', volume_fraction=0.0836, relaxation_time='1 ms'}",
        "jet={profile='hyperbolic', radius='11 um', flow_rate='1e-11 m3/s', length='2 mm', p=300}",
        "effects.evaporation=true",
        "effects.radial=true",
        "rheology.diffusivity=6e-8 m2/s",
        "rheology.convention=yarin2001",
        "accuracy.shells=8",
        "rheology.vitrification_fraction=0.9",
    )
    result = quiet("peo5-water", *thin)
    assert float(result["mean_polymer_fraction"][-1]) == pytest.approx(1, abs=1e-6)
    for name in ("mean_polymer_fraction", "polymer_fraction", "drying_polymer_fraction", "surface_polymer_fraction"):
        assert (result[name] <= 1).all()
    flux = np.pi * result["radius"] ** 2 * result["velocity"] * result["mean_polymer_fraction"]
    np.testing.assert_allclose(flux, 0.0836e-11, rtol=1e-12)


def test_a_jet_may_take_up_vapour() -> None:
    wet = quiet(
        "peo5-water",
        "solution={polymer='PEO', solvent='water', volume_fraction=0.5}",
        "ambient.relative_humidity=0.999",
        "effects.evaporation=true",
        "rheology.convention=yarin2001",
    )
    assert float(wet["evaporated_fraction"][-1]) < -0.01
    assert float(wet["mean_polymer_fraction"][-1]) < 0.5
    assert "takes up" in " ".join(sl.report.words(wet))


# --- what is asked for, and what is refused --------------------------------------------------------------------------


def test_auto_takes_what_matters_and_says_so() -> None:
    plain = quiet("peo5-water")
    assert plain.attrs["evaporation_reason"] == "off: there is no [ambient]"
    assert "evaporated_fraction" not in plain
    small = quiet("peo5-water", HUMID)
    assert small.attrs["evaporation_reason"].startswith("off: leaving it out errs by about 0.0018, rtol = 0.01")
    fine = quiet("peo5-water", HUMID, "accuracy.rtol=1e-3")
    assert fine.attrs["evaporation_reason"].startswith("on: leaving it out errs by about 0.0018")
    slow = quiet("peo5-water", "solution.relaxation_time=10 s")
    assert (slow.attrs["model"], slow.attrs["relaxation_reason"][:4]) == ("affine", "off:")
    fast = quiet("peo5-water", "solution.relaxation_time=10 ms")
    assert (fast.attrs["model"], fast.attrs["relaxation_reason"][:3]) == ("conformation", "on:")
    assert "relaxation" not in fast.attrs["effects_left_out"]
    kept = quiet("peo5-water", "solution.relaxation_time=10 ms", "network.model=affine")
    assert "it would matter" in kept.attrs["relaxation_reason"]
    assert "relaxation is left out" in kept.attrs["warnings"]
    flat = quiet("peo5-water", *WET, "rheology.diffusivity=1e-8 m2/s")
    assert flat.attrs["radial_reason"].startswith("off: leaving it out errs")
    drier = quiet("peo5-water", "solution.relaxation_time=10 s", HUMID, "rheology.convention=yarin2001")
    assert (drier.attrs["model"], drier.attrs["relaxation_reason"][:3]) == ("conformation", "on:")
    both = quiet("peo5-water", "solution.relaxation_time=10 ms", "network.coupling=100")
    assert both.attrs["model"] == "two-fluid"
    assert "relaxation" not in both.attrs["effects_left_out"]


@pytest.mark.parametrize("model", ["manifold", "walk"])
def test_other_rungs_dry_too(model: str) -> None:
    few = (
        "accuracy.points=11",
        "accuracy.strands=10",
        "network.closure=" + ("stretch" if model == "manifold" else "force"),
    )
    drying = ("rheology.convention=yarin2001", "jet.length=2 mm", *WET)
    result = quiet("peo5-water", f"network.model={model}", *few, *drying)
    flux = np.pi * result["radius"] ** 2 * result["velocity"] * result["mean_polymer_fraction"]
    moved = flux * result["strand_stretch"] / result["velocity_ratio"]
    free = result["mean_polymer_fraction"].values < 1
    np.testing.assert_allclose(moved.values[free], moved.values[0], rtol=1e-10)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["effects.relaxation=true"], "solution.relaxation_time: is missing.*relaxation_time = "),
        (["effects.evaporation=true"], "ambient.relative_humidity: is missing.*40 %"),
        ([*WET, "effects.radial=true"], "rheology.diffusivity: is missing.*m2/s"),
        (["effects.radial=true", "effects.evaporation=false", HUMID], "effects.radial.*needs evaporation"),
        ([*RELAXING, "effects.relaxation=false"], "effects.relaxation"),
        (["solution.relaxation_time=1 s", "effects.relaxation=true", "network.model=manifold"], "effects.relaxation"),
        ([*ACROSS, "rheology.activity=raoult"], "effects.radial.*Flory"),
        (
            [*WET, "ambient.relative_humidity=0.99", "ambient.temperature=40 degC"],
            "ambient.relative_humidity.*condense",
        ),
        ([*WET, "solution.temperature=100.5 degC"], "solution.temperature.*boiling"),
        ([*WET, "rheology.vitrification_fraction=0.01"], "rheology.vitrification_fraction"),
        (["rheology.law=martin"], "rheology.intrinsic_viscosity: is missing"),
        (["rheology.mobility=0.3"], "rheology.mobility.*Giesekus"),
        (["rheology.constitutive=giesekus"], "rheology.constitutive"),
        (["rheology.D_law=free-volume"], "rheology.D_gap"),
        (["rheology.diffusivty=1e-9 m2/s"], "diffusivity"),
        (["ambient.humidity=0.4"], "relative_humidity"),
        ([*RELAXING, "solution.solvent_viscosity=3 Pa s", "rheology.constitutive=Oldroyd-B"], "Oldroyd-B"),
    ],
)
def test_what_cannot_be_done_is_refused(overrides: list[str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        quiet("peo5-water", *overrides)


def test_own_solvent_needs_its_properties_one_by_one() -> None:
    own = [
        "solution={polymer='PS', solvent={name='mine', density='0.9 g/cm3'}, mass_fraction=0.1}",
        "effects.evaporation=true",
    ]
    for missing, fix in (
        ("ambient.vapour_diffusivity", "ambient.vapour_diffusivity=1e-5 m2/s"),
        ("solution.solvent.molar_mass", "solution.solvent.molar_mass=80 g/mol"),
        ("solution.solvent.vapour_pressure", "solution.solvent.vapour_pressure=20 kPa"),
    ):
        with pytest.raises(InputError, match=missing):
            quiet("peo5-water", *own)
        own.append(fix)
    assert float(quiet("peo5-water", *own)["evaporated_fraction"][-1]) > 0.01
    mixture = "solution={polymer='PVP', solvent={ethanol=0.8, water=0.2}, mass_fraction=0.1}"
    with pytest.raises(InputError, match="one number, and the solvent is a mixture"):
        quiet("peo5-water", mixture, *WET, "ambient.saturation=1e-5")
    assert "ethanol" in quiet("peo5-water", mixture, *WET).attrs["evaporation"]


def test_check_finds_what_is_missing_before_it_runs(spinline) -> None:
    for overrides, words in (
        (["effects.evaporation=true"], "ambient.relative_humidity"),
        ([HUMID, "effects.radial=true"], "rheology.diffusivity"),
        (["effects.relaxation=true"], "solution.relaxation_time"),
    ):
        ran = spinline("check", "peo5-water", *(part for key in overrides for part in ("--set", key)))
        assert (ran.code, words in ran.err) == (2, True)
    assert spinline("check", "pmma10-drying").code == 0


def test_numbers_that_decide() -> None:
    scene = sl.load_scene(
        "peo5-water", [*ISOTHERMAL, "solution.relaxation_time=10 ms", HUMID, "rheology.diffusivity=1e-9 m2/s"]
    )
    solution = build_solution(scene)
    numbers = effect_numbers(scene, solution, build_jet(scene, solution))
    assert numbers.missing == {"heat": "set so"}
    result = quiet("peo5-water", *ACROSS, "rheology.diffusivity=1e-9 m2/s", "solution.relaxation_time=10 ms")
    assert numbers.evaporated_fraction == pytest.approx(float(result["evaporated_fraction"][-1]), rel=0.01)
    assert numbers.drying_peclet == pytest.approx(float(result["drying_peclet"].max()), rel=0.01)
    assert numbers.fourier == pytest.approx(float(result["fourier_number"][-1]), rel=0.01)
    uneven = float((result["surface_polymer_fraction"] / result["mean_polymer_fraction"]).max() - 1)
    assert numbers.errors["radial"] == pytest.approx(uneven, rel=0.7)  # an estimate
    assert numbers.errors["relaxation"] == numbers.relaxation.error
    assert numbers.deborah == numbers.relaxation.number
    slow = sl.load_scene("peo5-water", ["solution.relaxation_time=5 s"])
    estimate = effect_numbers(slow, solution := build_solution(slow), build_jet(slow, solution)).errors["relaxation"]
    relaxed, affine = (
        quiet("peo5-water", "solution.relaxation_time=5 s", f"network.model={m}") for m in ("conformation", "affine")
    )
    assert estimate == pytest.approx(largest(difference(affine, relaxed)), rel=0.15)
    assert 1e-12 < numbers.inertia < 1e-7
    bare = sl.load_scene("peo5-water")
    less = effect_numbers(bare, build_solution(bare), build_jet(bare, build_solution(bare)))
    assert set(less.missing) == {"relaxation", "evaporation", "radial", "heat"}
    assert np.isnan(less.deborah)
    assert less.errors["slip"] == pytest.approx(quiet("peo5-water").attrs["coupling_error"])


def test_everything_is_written_and_drawn(tmp_path) -> None:
    result = quiet("peo5-water", *GLASS, "effects.radial=true", "rheology.diffusivity=2e-9 m2/s", "accuracy.points=50")
    assert set(map(str, result.variables)) <= set(VARIABLES)
    assert result["polymer_fraction"].dims == ("z", "r")
    assert result["r"].attrs["units"] == "1"
    sl.results.save(result, tmp_path / "a.nc")
    assert sl.open_result(tmp_path / "a.nc").identical(result)
    table = sl.results.to_csv(result, tmp_path / "a.csv").read_text().splitlines()
    assert len(table) == result.sizes["z"] + 1
    assert len(sl.figures.png(result)) > 10_000
    text = " ".join(sl.report.words(result))
    assert "The jet loses" in text
    assert "at the surface against" in text
    assert len(sl.figures.png(quiet("pvp-jetspin", *RELAXING))) > 10_000
