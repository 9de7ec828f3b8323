"""What a reduction makes of errors that are given, and of what is not said: blur, clipping, few flats of one row."""

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError
from spinline.images import images_from_dict
from spinline.radiography.absorber import build_absorber
from spinline.radiography.given_quantities import relative_doubts
from spinline.radiography.preview import preview_images
from spinline.radiography.reduce import reduce_images
from spinline.radiography.reduction_dataset import lines, plausible
from spinline.report.images_figure import reduction_sheet
from spinline.setup.build import build_solution

PIXEL, PHI = 1e-6, 0.0444256
FILE = {
    "counts": "a.npz",
    "flat": "a.npz",
    "dark": 0,
    "gain": 1.0,
    "pixel_size": "1 um",
    "energy": "10 keV",
    "shells": 1,
    "block_rows": 12,
    "solution": {"polymer": "PEO", "solvent": "water", "mass_fraction": 0.05},
}
ROWS, COLUMNS = 24, 100

pytestmark = pytest.mark.filterwarnings("ignore::spinline.base.errors.SpinlineWarning")


@pytest.fixture(scope="module")
def transmission(request):
    """Of a round jet of 30 um by brute force, for a profile and a blur."""
    counts = request.getfixturevalue("brute_force")
    made = {}

    def make(profile=(PHI, 0.0), blur=0.0):
        if (profile, blur) not in made:
            made[profile, blur] = counts(
                lambda r: profile[0] + profile[1] * r**2,
                30e-6,
                flat=np.ones(COLUMNS),
                pixel=PIXEL,
                solvent=531.87,
                contrast=-137.44,
                air=0.6,
                axis=1.3 * PIXEL,
                blur=blur,
                parts=32,
                along=400,
            )
        return made[profile, blur]

    return make


@pytest.fixture
def images(tmp_path, transmission):
    """Write frames and flats; check an images file of them."""

    def make(photons=1e6, seed=3, flats=40, one_row=False, profile=(PHI, 0.0), blurred=0.0, change=None, **keys):
        rng = np.random.default_rng(seed)
        seen = rng.poisson(photons * transmission(profile, blurred), (ROWS, COLUMNS)).astype(float)
        flat = rng.poisson(photons, (flats, 1 if one_row else ROWS, COLUMNS)).astype(float)
        np.savez(tmp_path / "a.npz", counts=seen if change is None else change(seen), flat=flat)
        data = {key: value for key, value in {**FILE, **keys}.items() if value is not None}
        return images_from_dict(data, folder=tmp_path)

    return make


def test_errors_given_reach_the_fraction_by_the_derivative(images) -> None:
    """Each error alone against the change of the reduced fraction when its key is moved by that much."""
    cases = {
        "pixel_size": ("1 um", "1.01 um", "1 +/- 0.01 um"),
        "energy": ("10 keV", "10.02 keV", "10 +/- 0.02 keV"),
    }
    for key, (plain, moved, given) in cases.items():
        here = reduce_images(images(**{key: plain}))
        there = reduce_images(images(**{key: moved}))
        said = reduce_images(images(**{key: given}))
        shift = float((there["mean_polymer_fraction"] - here["mean_polymer_fraction"]).mean())
        assert (here["calibration_std"] == 0).all()
        assert said["calibration_std"].values == pytest.approx(abs(shift), rel=0.03)
        assert said["mean_polymer_fraction_std"].values == pytest.approx(
            np.hypot(here["mean_polymer_fraction_std"], said["calibration_std"]).values, rel=1e-6
        )
        assert key in said.attrs["shared_error_source"]
        assert key in said.attrs["warnings"]


def test_error_of_the_pixel_is_in_the_radius_and_a_calibration_takes_it_from_the_fraction(images) -> None:
    plain = reduce_images(images())
    doubtful = reduce_images(images(pixel_size="1 +/- 0.02 um"))
    radius = float(plain["jet_radius"][0])
    assert float(doubtful["jet_radius_std"][0]) == pytest.approx(
        float(np.hypot(plain["jet_radius_std"][0], 0.02 * radius)), rel=1e-6
    )
    calibrated = reduce_images(images(pixel_size="1 +/- 0.02 um", calibration_rows=[0, 12]))
    assert float(calibrated["calibration_std"].max()) < 0.3 * float(doubtful["calibration_std"].min())
    assert "shared_error_source" not in calibrated.attrs


def test_doubts_of_attenuation_and_density_by_hand(images) -> None:
    """phi (s_p rho_p) and (1 - phi) (s_s rho_s), each over mu, times the relative error."""
    solution = {**FILE["solution"], "polymer_density": "1.13 +/- 0.01 g/cm3", "solvent_density": "1 +/- 0.001 g/cm3"}
    file = images(
        polymer_attenuation="3.49 +/- 0.1 cm2/g", solvent_attenuation="5.33 +/- 0.05 cm2/g", solution=solution
    )
    made = build_solution(file)
    absorber, medium, words = build_absorber(file, made)
    assert medium is not None
    assert absorber.air == pytest.approx(0.6, abs=0.05)
    assert "air at 10 keV" in words
    phi = made.volume_fraction
    heavy, light = 0.349 * 1130.0, 0.533 * 1000.0
    mu = phi * heavy + (1 - phi) * light - absorber.air
    doubts = relative_doubts(file, made, absorber, 1e-6, 0.0)
    assert doubts == pytest.approx(
        {
            "polymer_attenuation": phi * heavy / mu * 0.1 / 3.49,
            "solvent_attenuation": (1 - phi) * light / mu * 0.05 / 5.33,
            "solution.polymer_density": phi * heavy / mu * 0.01 / 1.13,
            "solution.solvent_density": (1 - phi) * light / mu * 0.001,
        },
        rel=1e-9,
    )


def test_a_blur_that_is_not_given_is_told_with_its_size_and_its_bias(images) -> None:
    said = reduce_images(images(photons=1e7, blurred=1.5e-6)).attrs["warnings"]
    assert "edges are blurred by 1.5 um (1.5 pixels)" in said
    assert "it is fitted; left out, it would shift the mean fraction by +0.0" in said
    assert "fringes" not in said.split("blur", 1)[0]
    for quiet in ({}, {"blurred": 1.5e-6, "blur": "1.5 um"}):
        assert "edges are blurred" not in reduce_images(images(photons=1e7, **quiet)).attrs["warnings"]


@pytest.mark.parametrize("blurred", [0.0, 1.5e-6])
def test_a_profile_that_no_shell_follows_is_not_taken_for_fringes(images, blurred) -> None:
    """24 rows of 1e8 photons of a parabolic profile: one shell misfits, three nearly fit, and none of it is refraction."""
    file = images(photons=1e8, profile=(0.09, -0.09), blurred=blurred)
    assert "meets fringes" not in reduce_images(file).attrs["warnings"]


@pytest.mark.slow
def test_the_noise_of_a_flat_of_one_row_adds_up_over_a_block(images) -> None:
    """12 rows against 6 flats of one row: variance 1 + 12/6; the scatter over replicates bears it out."""
    z, narrow = [], []
    for seed in range(40):
        result = reduce_images(images(seed=seed, flats=6, one_row=True), noisy=True).isel(row=0)
        error = float(result["mean_polymer_fraction"]) - PHI
        z.append(error / float(result["mean_polymer_fraction_std"]))
        narrow.append(z[-1] * np.sqrt(3.0 / (1.0 + 1.0 / 6.0)))
    assert result.attrs["flat_noise"] == pytest.approx(3.0)
    assert 0.7 < np.std(z) < 1.35  # 4 standard deviations of the deviation of 40
    assert np.std(narrow) > 1.35
    seen = preview_images(images(flats=6, one_row=True))
    assert seen.facts["flat_noise"] == pytest.approx(3.0)


def test_a_detector_that_clips_anywhere_is_told(images) -> None:
    def clip(counts):
        return np.minimum(counts, 9.95e5)

    said = reduce_images(images(change=clip), noisy=True).attrs["warnings"]
    assert "hold exactly the highest count, 995000" in said
    assert "saturation = 995000" in said
    assert "highest count" not in reduce_images(images()).attrs["warnings"]
    low = reduce_images(images(photons=300.0, block_rows=24), noisy=True)
    assert "highest count" not in low.attrs["warnings"]
    with pytest.raises(InputError, match="saturated"):
        reduce_images(images(change=clip, saturation=9.95e5))


def test_counts_beyond_counting_and_flats_without_light_are_refused(images, tmp_path) -> None:
    for factor in (1e300, 1e11):
        with pytest.raises(InputError, match=r"gain = .*photons.*allowed: up to 1e\+15"):
            reduce_images(images(change=lambda counts, factor=factor: counts * factor))
    file = images()
    np.savez(tmp_path / "a.npz", counts=np.full((ROWS, COLUMNS), 9.0), flat=np.zeros((3, ROWS, COLUMNS)))
    with pytest.raises(InputError, match=r"flat = 0\.0: holds no light"):
        reduce_images(file)


def test_a_blur_that_is_none_is_fitted_as_none(images) -> None:
    """The likelihood is largest at the edge, no blur: found, not given up."""
    result = reduce_images(images(photons=1e7, block_rows=1, blur="fit"))
    z = (result["mean_polymer_fraction"] - PHI) / result["mean_polymer_fraction_std"]
    assert (result["flags"] & 1 == 0).all()
    assert float(result["blur"].max()) < 0.6 * PIXEL
    assert float(result["blur"].std()) < 1e-12  # the detector's: one for all rows
    assert abs(float(z.mean())) * ROWS**0.5 < 4
    assert 0.55 < float(z.std()) < 1.45


def test_a_block_that_cannot_be_does_not_set_the_headline_nor_the_scale(images) -> None:
    """The nozzle's end in the first rows: that block says nonsense, flagged; the answer and the figure are those of the rest."""

    def shadowed(counts):
        counts[:6, 12:92] *= 0.01
        return counts

    result = reduce_images(images(change=shadowed, photons=4e6, block_rows=6))
    assert abs(float(result["mean_polymer_fraction"][0])) > 1
    can = plausible(result)
    assert can.tolist() == [False, True, True, True]
    said = lines(result)
    first = float(result["mean_polymer_fraction"][1])
    assert f"Mean polymer fraction {first:.4f} +/-" in said[1]
    assert "Left out of these numbers, not of the file: 1 whose fraction cannot be." in said
    panel = reduction_sheet(result).axes[1]
    assert max(abs(edge) for edge in panel.get_ylim()) < 0.2
    result["flags"][:] = result["flags"] | 8
    assert plausible(result).all()


def test_a_map_of_a_spectrum_says_what_its_mean_attenuation_is_worth(images, request) -> None:
    """5 % of the signal at 30 keV, hardened by brute force: the warning's shift is the one that is there."""
    counts = request.getfixturevalue("brute_force")
    line = xray.solution_medium(
        xray.Material("C2H4O", 1130.0),
        xray.Material("H2O", 998.2),
        xray.Spectrum(np.array([10.0, 30.0]), np.array([0.95, 0.05])),
    )
    shape = {"flat": np.ones(220), "pixel": PIXEL, "axis": 1.3 * PIXEL, "parts": 16, "along": 400}
    seen = sum(
        share * counts(lambda r: PHI + 0 * r, 80e-6, solvent=mu, contrast=d, air=air, **shape)
        for share, mu, d, air in zip(line.weight, line.solvent, line.contrast, line.air, strict=True)
    )
    rng = np.random.default_rng(2)
    keys = {"spectrum": {"10 keV": 0.95, "30 keV": 0.05}, "energy": None, "block_rows": 1, "method": "chord"}
    file = images(**keys)
    np.savez(
        file.folder / "a.npz",
        counts=rng.poisson(1e8 * seen, (ROWS, 220)),
        flat=np.full((1, ROWS, 220), 1e10) / 100,
        dark=0,
    )
    result = reduce_images(file)
    words = next(w for w in result.attrs["warnings"].splitlines() if "mean attenuation of the spectrum" in w)
    shift = float(result["mean_polymer_fraction"].mean()) - PHI
    said = float(words.split("about ")[1].split(";")[0])
    assert said == pytest.approx(shift, rel=0.25)
    row = reduce_images(file.model_copy(update={"method": "row"}))
    assert "mean attenuation" not in row.attrs["warnings"]
    assert abs(float(row["mean_polymer_fraction"].mean()) - PHI) < 0.3 * abs(shift)


def test_averages_and_transmissions_are_not_taken_for_counts(images, transmission) -> None:
    """A mean of ten frames scatters by a third of what counts do; a transmission is at most about 1."""

    def averaged(counts):
        rng = np.random.default_rng(8)
        return np.mean([rng.poisson(1e6 * transmission(), counts.shape) for _ in range(10)], axis=0)

    assert "scatter less than Poisson: averaged frames" in reduce_images(images(change=averaged)).attrs["warnings"]
    assert "scatter less" not in reduce_images(images()).attrs["warnings"]
    for wrong in (lambda counts: counts / 1e6, lambda counts: -np.log(counts / 1.1e6)):
        with pytest.raises(InputError, match=r"counts = .*transmission, or absorbance"):
            reduce_images(images(change=wrong))


def test_the_default_shells_follow_a_profile_that_vanishes_at_the_rim(tmp_path, brute_force) -> None:
    """Noise-free rows, drifted, sloping, 3 pixels off, blurred: the mean is off by less than half its error at 1e7 photons."""
    pixel = 0.67e-6
    seen = brute_force(
        lambda r: 2 * PHI * (1 - r**2),
        50e-6,
        flat=np.ones(216),
        pixel=pixel,
        solvent=531.87,
        contrast=-137.44,
        air=0.6,
        axis=3.3 * pixel,
        blur=1.2e-6,
        amplitude=1.01,
        slope=0.01,
        along=1000,
    )
    np.savez(tmp_path / "a.npz", counts=1e7 * np.tile(seen, (4, 1)), flat=np.full((1000, 4, 216), 1e7))
    keys = {key: value for key, value in FILE.items() if key != "shells"} | {"pixel_size": "0.67 um", "block_rows": 1}
    for blur in ("1.2 um", "fit"):
        result = reduce_images(images_from_dict(keys | {"blur": blur}, folder=tmp_path))
        z = (result["mean_polymer_fraction"] - PHI) / result["mean_polymer_fraction_std"]
        assert 0.05 < abs(float(z[0])) < 0.5
    coarse = reduce_images(images_from_dict(keys | {"blur": "fit", "shells": 3}, folder=tmp_path))
    assert float(((coarse["mean_polymer_fraction"] - PHI) / coarse["mean_polymer_fraction_std"])[0]) > 0.5


def test_the_density_of_a_mixture_is_said_to_be_ideal(images) -> None:
    """Ethanol and water, half and half: 914 kg/m3 at 20 degC (CRC Handbook), 882 if nothing shrank."""
    mixed = {"polymer": "PVP", "solvent": {"ethanol": 0.5, "water": 0.5}, "mass_fraction": 0.3}
    said = reduce_images(images(solution=mixed), noisy=True).attrs["warnings"]
    assert "882.2 kg/m3, is that of an ideal mixture" in said
    for quiet in (
        {"solution": {**mixed, "solvent_density": "0.914 g/cm3"}},
        {"solution": mixed, "calibration_rows": [0, 12]},
    ):
        assert "ideal mixture" not in reduce_images(images(**quiet), noisy=True).attrs["warnings"]


def test_energy_is_refused_in_the_unit_it_is_given_in() -> None:
    with pytest.raises(InputError, match="allowed: 1 to 200 keV"):
        images_from_dict({**FILE, "energy": "0.1 keV"})


def test_one_file_of_another_shape_is_named_once(images, tmp_path) -> None:
    (tmp_path / "frames").mkdir()
    np.save(tmp_path / "frames" / "a.npy", np.ones((ROWS, COLUMNS)))
    np.save(tmp_path / "frames" / "b.npy", np.ones((ROWS, 50)))
    with pytest.raises(InputError, match=r"^counts = \(24, 50\): b.npy has another shape"):
        reduce_images(images(counts="frames/*.npy"))


def test_exposure_names_its_options(spinline) -> None:
    for option, value in (("--energy", "38.5 keV"), ("--sigma", "0"), ("--photons", "-1"), ("--highest", "4 keV")):
        ran = spinline("exposure", "peo5-water", option, value)
        assert ran.code == 2
        assert f"error: {option} = " in ran.err


def test_the_figure_does_not_average_away_what_blocks_share(images) -> None:
    """Error bars of the profiles: the calibration's stays, and a map's rows are no replicates."""
    result = reduce_images(images(pixel_size="1 +/- 0.02 um", block_rows=1), noisy=True)
    shared = float(result["calibration_std"].median())
    sheet = reduction_sheet(result)
    assert min(_bars(sheet)) > shared
    result.attrs["method"] = "map"
    assert min(_bars(reduction_sheet(result))) > 0.9 * float(result["polymer_fraction_std"].min())


def _bars(sheet):
    """Half the heights of the error bars in the profiles' panel."""
    panel = next(axis for axis in sheet.axes if axis.get_xlabel() == "r/R")
    return [0.5 * float(np.ptp(s[:, 1])) for bar in panel.containers for s in bar.lines[2][0].get_segments()]
