"""Drying and relaxing jets as runs: references, limits with their rates, conservation, extremes, bead jets."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from isothermal_runs import ACROSS, HUMID, LONG, RELAXING, WET, quiet

import spinline as sl
from spinline.rheology import equilibrium_fraction
from spinline.rheology.evaporation import power_law_loss

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
