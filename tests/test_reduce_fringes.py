"""Images with Fresnel fringes, and of beams with harmonics, reduced: refused, flagged, or told apart."""

import numpy as np
import pytest
from conftest import IMAGES as FILE
from conftest import IMAGES_PHI as PHI
from conftest import IMAGES_PIXEL as PIXEL
from conftest import score_of as score

from spinline.base.errors import InputError, SpinlineWarning
from spinline.images import images_from_dict
from spinline.radiography.reduce import reduce_images
from spinline.solve import results

pytestmark = pytest.mark.usefixtures("quiet")


@pytest.mark.slow
def test_fringes_are_refused_as_absorption_and_reduced_as_fringes(spinline, tmp_path) -> None:
    """Frames 5 cm behind the jet, as `simulate-image` makes them."""
    where = ("--from", "0.05 mm", "--to", "0.06 mm", "--distance", "5 cm", "--blur", "0.8 um")
    made = spinline("simulate-image", "peo5-water", *where, "--photons", "1e6", "--frames", "2", "-o", "f.npz")
    assert made.code == 0
    refused = spinline("reduce", "f.toml", "--method", "row", "--set", "shells=1", "-o", "r.nc")
    assert "fringes" in refused.err
    ran = spinline("reduce", "f.toml", "--set", "shells=1", "--set", "block_rows=5", "-o", "p.nc", "--no-figure")
    assert ran.code == 0
    result = results.open_result(tmp_path / "p.nc")
    assert result.attrs["method"] == "phase"
    z = (result["mean_polymer_fraction"] - PHI) / result["mean_polymer_fraction_std"]
    assert abs(float(z.mean())) < 2.5


def test_a_harmonic_that_is_known_is_taken_out(frames_of, brute_force) -> None:
    """5 % of the signal at 30 keV: left out, a fraction 0.18 too large; with the spectrum, none."""
    from spinline.xray import solution_absorber

    third = solution_absorber("PEO", "water", 30.0)
    soft = {"flat": np.ones(120), "pixel": PIXEL, "axis": 3 * PIXEL, "amplitude": 1.01, "slope": 0.01, "along": 400}
    one, three = (
        brute_force(lambda r: np.full_like(r, PHI), 30e-6, solvent=a, contrast=d, air=air, **soft)
        for a, d, air in ((531.87, -137.44, 0.6), (third.solvent, third.contrast, third.air))
    )
    images, _ = frames_of(photons=2e7, mean=0.95 * one + 0.05 * three, block_rows=24)
    left_out = reduce_images(images)
    lines_of = {key: value for key, value in FILE.items() if key != "energy"}
    lines_of |= {"spectrum": {"10 keV": 0.95, "30 keV": 0.05}, "block_rows": 24}
    known = reduce_images(images_from_dict(lines_of, folder=images.folder))
    assert float(left_out["mean_polymer_fraction"][0]) - PHI == pytest.approx(0.18, abs=0.03)
    assert abs(score(known)) < 3


@pytest.fixture(scope="module")
def fringed():
    """Mean counts of rows 1 and 10 cm behind a jet of 30 um, with the air's edge fringes."""
    from spinline import xray

    medium = xray.solution_medium("PEO", "water", 10.0)
    jet = xray.RoundJet(np.array([PHI]), 30e-6, 3 * PIXEL)
    detector = xray.Detector(np.ones(120), PIXEL, blur=1.2e-6)
    return {z: xray.fresnel_counts(jet, medium, detector, z) for z in (0.01, 0.1)}


def outcome(images):
    """The result and what was warned of, or the refusal."""
    import warnings

    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", SpinlineWarning)
        try:
            return reduce_images(images, noisy=True), [str(w.message) for w in said]
        except InputError as error:
            return error, []


def is_flagged(result):
    names, masks = result["flags"].attrs["flag_meanings"].split(), result["flags"].attrs["flag_masks"]
    bit = masks[names.index("fringes")]
    return bool(((result["flags"].values & bit) > 0).all())


@pytest.mark.parametrize("distance", [0.01, 0.1])
@pytest.mark.parametrize(
    "keys",
    [
        {"method": "chord"},
        {"method": "row", "blur": "1.2 um", "propagation_distance": "5 cm"},
        {"method": "map", "blur": "1.2 um"},
        {"method": "row", "energy": None, "spectrum": {"10 keV": 0.99, "30 keV": 0.01}},
        {"method": "row", "energy": None, "polymer_attenuation": "3.49 cm2/g", "solvent_attenuation": "5.33 cm2/g"},
        {"method": "chord", "frames": "each"},
    ],
)
def test_fringes_are_refused_or_flagged_as_data(frames_of, fringed, keys, distance) -> None:
    images, _ = frames_of(photons=2e4, mean=fringed[distance], rows=6, **keys)
    result, said = outcome(images)
    if isinstance(result, InputError):
        assert result.field == "method"
        assert "fringes" in result.problem
        return
    assert any("fringes" in words for words in said)
    assert is_flagged(result)
    assert (result["fringe_significance"].values > 5).all()
    assert result.attrs["fringes"].startswith("meets Fresnel fringes")
    assert "fringes" in result.attrs["warnings"]


def test_no_fringes_are_said_so(frames_of) -> None:
    result = reduce_images(frames_of(photons=4e6)[0])
    assert not is_flagged(result)
    assert float(result["fringe_significance"]) < 5
    assert result.attrs["fringes"].startswith("none seen")


def test_what_cannot_be_tested_is_said(frames_of) -> None:
    given = {"energy": None, "polymer_attenuation": "3.49 cm2/g", "solvent_attenuation": "5.33 cm2/g"}
    solution = {
        "polymer": {"name": "mine", "density": "1.13 g/cm3"},
        "solvent": "water",
        "mass_fraction": 0.05,
    }
    images, _ = frames_of(photons=4e6, solution=solution, **given)
    result = reduce_images(images)
    assert np.isnan(float(result["fringe_significance"]))
    assert "not looked for" in result.attrs["fringes"]
    assert "not looked for" in result.attrs["warnings"]


def test_a_spectrum_with_fringes_is_reduced(frames_of) -> None:
    """10 keV with 5 % of the signal at 30 keV, 10 cm: waves summed by their shares; the harmonic left out shows as misfit."""
    from spinline import xray

    beam = xray.Spectrum(np.array([10.0, 30.0]), np.array([0.95, 0.05]))
    medium = xray.solution_medium("PEO", "water", beam)
    jet = xray.RoundJet(np.array([PHI]), 30e-6, 3 * PIXEL)
    mean = xray.fresnel_counts(jet, medium, xray.Detector(np.ones(120), PIXEL, blur=0.8e-6), 0.1)
    keys = {"method": "phase", "blur": "0.8 um", "propagation_distance": "10 cm", "block_rows": 6}
    images, _ = frames_of(
        photons=2e6, mean=mean, rows=12, energy=None, spectrum={"10 keV": 0.95, "30 keV": 0.05}, **keys
    )
    result = reduce_images(images)
    assert abs(score(result)) < 3
    assert float(result["misfit"].max()) < 4
    assert result.attrs["fringes"] == "fitted"
    one, _ = frames_of(photons=2e6, mean=mean, rows=12, **keys)
    assert float(reduce_images(one)["misfit"].min()) > 4
