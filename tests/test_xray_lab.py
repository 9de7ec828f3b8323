"""Glare, leans, tilts, shapes of the beam: the model of a lab against counts of a generator that shares no code with it."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from beam_generator import CONTRAST, PHI, PIXEL, SOLVENT, Lab, shared_light, transmissions
from scipy.integrate import quad

from spinline import xray
from spinline.base.errors import InputError
from spinline.images import images_from_dict
from spinline.images.geometry import path_factor
from spinline.images.noise import pair_noise
from spinline.images.stacks import open_stack
from spinline.xray.frame.response import linear
from spinline.xray.frame.shared import row_shifts
from spinline.xray.row.forward import row_model
from spinline.xray.row.model import EXTRAS
from spinline.xray.row.tail import line_spread, spread_tail

WATER = xray.Absorber(SOLVENT, CONTRAST)
BEAM = ("radius", "axis", "amplitude", "slope")
MEASURED = json.loads((Path(__file__).parents[1] / "benchmarks/xray_lab.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("length", [1.5, 20.0, 300.0])
def test_the_tails_line_spread_is_that_of_the_exponential_around(length) -> None:
    """The integral of exp(-r/l)/(2 pi l^2) along a line beside the middle."""
    for x in (0.0, 0.3 * length, 2.0 * length, 6.0 * length):
        across, _ = quad(
            lambda y, x=x: np.exp(-np.hypot(x, y) / length), -60 * length, 60 * length, limit=400, points=[0.0]
        )
        assert float(line_spread(np.array(x), length)) == pytest.approx(across / (2 * np.pi * length**2), rel=1e-6)


@pytest.mark.parametrize("length", [1.5, 10.0, 100.0])
def test_recursion_spreads_as_the_sum_over_all_pixels(length) -> None:
    rows = -np.random.default_rng(1).uniform(0, 0.1, (3, 300))
    at = np.arange(-4000, 4001)
    kernel = line_spread(at.astype(float), length)
    kernel /= kernel.sum()
    expected = 0.9 * rows + 0.1 * np.stack([np.convolve(r, kernel, "full")[4000:4300] for r in rows])
    out = rows.copy()
    spread_tail(out, 0.1, length, np.empty(300), np.empty(300))
    assert out == pytest.approx(expected, abs=1e-6)


def test_every_derivative_of_the_model() -> None:
    detector = xray.Detector(np.full(300, 1e6), PIXEL, blur=0.5e-6, tail_share=0.05, tail_length=10e-6)
    model = row_model(WATER, detector, np.array([0, 0.5, 1]), 1.5e-6, EXTRAS)
    at = np.array([0.05, 0.06, 40.1e-6, 1.3e-6, 1.01, 0.01, 0.5e-6, 0.05, 10e-6, 0.002, 0.001, -0.003])
    _, jacobian = model.evaluate(at)
    for i, name in enumerate(model.names):
        step = 1e-6 * max(abs(at[i]), 0.0 if name in ("radius", "axis", "blur", "tail_length") else 1e-3)
        low, high = at.copy(), at.copy()
        low[i] -= step
        high[i] += step
        slope = (model.evaluate(high)[0] - model.evaluate(low)[0]) / (2 * step)
        assert np.abs(slope - jacobian[:, i]).max() < 2e-6 * np.abs(jacobian[:, i]).max(), name


@pytest.mark.parametrize("tail", [(0.02, 10.0), (0.05, 20.0), (0.01, 100.0)])
@pytest.mark.parametrize("radius", [75e-6, 30e-6, 15e-6])
def test_a_tail_that_is_known_leaves_no_bias(tail, radius) -> None:
    seen = transmissions(radius, 340, Lab(blur=0.7 * PIXEL, tail=(tail[0], tail[1] * PIXEL)))[0]
    given = xray.Detector(np.full(340, 1e7), PIXEL, blur=0.7 * PIXEL, tail_share=tail[0], tail_length=tail[1] * PIXEL)
    fit = xray.fit_row(1e7 * seen, WATER, given, shells=1)
    assert fit.mean_fraction == pytest.approx(PHI, abs=1e-3)
    left_out = xray.fit_row(1e7 * seen, WATER, replace(given, tail_share=0.0), shells=1)
    assert left_out.mean_fraction > PHI + 0.004


def test_a_tail_of_no_share_and_one_of_no_length() -> None:
    flat = np.full(200, 1e6)
    jet = xray.RoundJet(np.array([PHI]), 40e-6)
    plain = xray.expected_counts(jet, WATER, xray.Detector(flat, PIXEL))
    assert np.array_equal(plain, xray.expected_counts(jet, WATER, xray.Detector(flat, PIXEL, tail_length=1e-5)))
    with pytest.raises(InputError, match="tail_length"):
        xray.Detector(flat, PIXEL, tail_share=0.1)
    for wrong in (-0.1, 0.9, np.nan):
        with pytest.raises(InputError, match="tail_share"):
            xray.Detector(flat, PIXEL, tail_share=wrong, tail_length=1e-5)


def blocks_under_glare(share, length, seed, photons=2e6, radii=None, known=4):
    rng = np.random.default_rng(seed)
    radii = np.linspace(75, 15, 30) * 1e-6 if radii is None else radii
    seen = transmissions(radii, 358, Lab(blur=0.7 * PIXEL, tail=(share, length * PIXEL)))
    one = xray.Detector(np.full(358, photons), PIXEL, blur=PIXEL, tail_share=0.03, tail_length=15 * PIXEL)
    good = np.ones(358, dtype=bool)
    return [
        xray.Block(rng.poisson(photons * t).astype(float), good, one, r, 0.0, known=PHI if i < known else None)
        for i, (r, t) in enumerate(zip(radii, seen, strict=True))
    ]


def test_blur_share_length_and_attenuation_are_told_together() -> None:
    found = xray.fit_detector(
        blocks_under_glare(0.05, 20.0, 5), WATER, ("blur", "tail_share", "tail_length", "attenuation"), shells=1
    )
    assert found.converged
    assert found.vague == ()
    truth = {"blur": 0.7 * PIXEL, "tail_share": 0.05, "tail_length": 20 * PIXEL, "attenuation": 1.0}
    for name, value in truth.items():
        assert abs(found.values[name] - value) < 4 * found.std[name], name
    assert found.std["tail_share"] < 0.005


def test_a_tail_longer_than_the_air_asks_for_a_prior() -> None:
    blocks = blocks_under_glare(0.01, 100.0, 3)
    blocks = [replace(b, detector=replace(b.detector, tail_length=60 * PIXEL)) for b in blocks]
    unknown = ("blur", "tail_share", "attenuation")
    alone = xray.fit_detector(blocks, WATER, unknown, shells=1, prior={"tail_length": (67e-6, 7e-6)})
    told = xray.fit_detector(blocks, WATER, unknown, shells=1, prior={"tail_share": (0.01, 0.001)})
    assert told.std["tail_share"] < 0.0011 < alone.std["tail_share"]


def test_a_halo_that_nobody_declared_is_found_and_its_shift_said() -> None:
    blocks = blocks_under_glare(0.05, 20.0, 2, known=0)
    blocks = [
        replace(b, detector=replace(b.detector, blur=0.7 * PIXEL, tail_share=0.0, tail_length=0.0)) for b in blocks
    ]
    traces = xray.hidden_traces(blocks[:12], WATER, shells=1)
    label = max((name for name in traces if name.startswith("tail")), key=lambda name: traces[name][1])
    share, sigmas, shift = traces[label]
    assert sigmas > 8
    assert 0.01 < share < 0.2
    plain = [
        xray.fit_row(b.counts, WATER, b.detector, shells=1, radius=b.radius, axis=0.0).mean_fraction
        for b in blocks[:12]
    ]
    assert shift == pytest.approx(np.mean(plain) - PHI, abs=0.5 * abs(np.mean(plain) - PHI))
    clean = transmissions(np.linspace(75, 40, 12) * 1e-6, 358, Lab(blur=0.7 * PIXEL))
    rng = np.random.default_rng(4)
    quiet = [replace(b, counts=rng.poisson(2e6 * t).astype(float)) for b, t in zip(blocks[:12], clean, strict=True)]
    assert max(abs(trace[1]) for trace in xray.hidden_traces(quiet, WATER, shells=1).values()) < 4.5


def test_derivatives_with_what_is_shared_are_those_of_the_fit() -> None:
    seen = transmissions(40e-6, 300, Lab(blur=0.8 * PIXEL, tail=(0.03, 12 * PIXEL)))[0]
    one = xray.Detector(np.full(300, 1e8), PIXEL, blur=0.8 * PIXEL, tail_share=0.03, tail_length=12 * PIXEL)
    good = np.ones(300, dtype=bool)
    block = xray.Block(1e8 * seen, good, one, 40e-6, 0.0)
    names = ("blur", "tail_share", "tail_length", "attenuation")

    def fraction(detector, absorber=WATER):
        return xray.fit_row(block.counts, absorber, detector, shells=1, radius=40e-6, axis=0.0)

    turn = row_shifts(fraction(one), WATER, block, names, BEAM)[0]
    for name, slope, step in zip(names, turn, (2e-9, 1e-4, 5e-8, 1e-5), strict=True):
        if name == "attenuation":
            high, low = (fraction(one, WATER.along(1 + s)).mean_fraction for s in (step, -step))
        else:
            high, low = (fraction(replace(one, **{name: getattr(one, name) + s})).mean_fraction for s in (step, -step))
        assert (high - low) / (2 * step) == pytest.approx(slope, rel=0.02), name


@pytest.mark.parametrize("degrees", [0.0, 4.0, 10.0, 15.0])
@pytest.mark.parametrize("rows", [1, 8])
def test_a_leaning_jet_has_its_fraction_and_radius(degrees, rows) -> None:
    seen = transmissions(50e-6, 300, Lab(lean=np.radians(degrees)), rows=40, over=4, pad=60)
    flat, good, zero = np.full(seen.shape, 1e7), np.ones(seen.shape, dtype=bool), np.zeros(seen.shape)
    frame = xray.Frame(1e7 * seen, flat, zero, good, PIXEL)
    path = xray.track_jet(frame.counts, flat, zero, good)
    lean = xray.axis_lean(path)
    assert np.degrees(np.arctan(lean.slope)) == pytest.approx(np.full(40, degrees), abs=0.02)
    fit = xray.fit_frame(frame, WATER, shells=1, block_rows=rows, track=path, lean=lean.slope)
    inner = slice(1, -1) if rows > 1 else slice(None)
    assert fit.mean[inner] == pytest.approx(np.full(fit.mean[inner].size, PHI), abs=1e-3)
    assert fit.values["radius"] == pytest.approx(np.full(fit.mean.size, 50e-6), abs=0.02e-6)
    quick = xray.chord_frame(frame, WATER, shells=1, track=path, lean=lean.slope)
    assert np.median(quick.mean) == pytest.approx(PHI, abs=2e-3)


def test_a_map_of_a_leaning_jet() -> None:
    seen = transmissions(
        50e-6, 260, Lab(lean=np.radians(12.0), tail=(0.02, 10 * PIXEL), blur=0.6 * PIXEL), rows=24, over=4, pad=200
    )
    cosine = float(np.cos(np.radians(12.0)))
    one = xray.Detector(np.full(260, 1e7), PIXEL, blur=0.6 * PIXEL, tail_share=0.02, tail_length=10 * PIXEL).across(
        cosine
    )
    fit = xray.fit_map(1e7 * seen, WATER, one, path=cosine)
    assert fit.converged
    assert fit.mean_fraction == pytest.approx(np.full(24, PHI), abs=1e-3)
    assert fit.radius * cosine == pytest.approx(np.full(24, 50e-6), abs=0.02e-6)


def test_a_map_goes_on_where_it_stopped() -> None:
    rng = np.random.default_rng(3)
    counts = rng.poisson(1e5 * transmissions(50e-6, 220, rows=30, over=2, pad=20)).astype(float)
    one = xray.Detector(np.full(220, 1e5), PIXEL)
    states = []
    whole = xray.fit_map(counts, WATER, one, keep=states.append)
    assert len(states) == whole.iterations
    for state in (states[1], states[len(states) // 2], states[-1]):
        again = xray.fit_map(counts, WATER, one, begun=state)
        assert np.array_equal(again.fraction, whole.fraction)
        assert np.array_equal(again.fraction_std, whole.fraction_std)
        assert again.iterations == whole.iterations


def test_a_tilt_along_the_beam_is_even_and_one_sided() -> None:
    """Mean and spread of 1/cos over angles drawn; a given angle; a depth."""
    base = {
        "counts": "a.npz",
        "flat": "a.npz",
        "pixel_size": "1 um",
        "energy": "10 keV",
        "solution": {"polymer": "PEO", "solvent": "water", "mass_fraction": 0.05},
    }
    rng = np.random.default_rng(0)
    for text, middle, spread in (("0 +/- 3 deg", 0.0, 3.0), ("10 +/- 2 deg", 10.0, 2.0)):
        drawn = 1 / np.cos(np.radians(middle + spread * rng.normal(size=400_000)))
        factor, errors = path_factor(images_from_dict({**base, "tilt_out": text}))
        assert factor == pytest.approx(drawn.mean(), rel=2e-4)
        assert errors["tilt_out"] == pytest.approx(drawn.std() / drawn.mean(), rel=0.03)
    factor, errors = path_factor(images_from_dict({**base, "depth": "1.02 +/- 0.005"}))
    assert (factor, errors) == (pytest.approx(1.02), {"depth": pytest.approx(0.005 / 1.02)})
    assert path_factor(images_from_dict(base)) == (1.0, {})


def test_a_bend_of_the_beam_is_fitted_where_there_is_air_and_doubted_elsewhere() -> None:
    seen = transmissions(50e-6, 500, Lab(bend=1e-3), over=16, pad=20)[0]
    one = xray.Detector(np.full(500, 1e7), PIXEL)
    plain = xray.fit_row(1e7 * seen, WATER, one, shells=1)
    bent = xray.fit_row(1e7 * seen, WATER, one, shells=1, nuisances=(*BEAM, "shape2"))
    assert abs(plain.mean_fraction - PHI) > 0.01
    assert bent.mean_fraction == pytest.approx(PHI, abs=5e-4)
    assert bent.values["shape2"] == pytest.approx(1e-3, abs=2e-5)
    assert 1.0 < bent.mean_fraction_std / plain.mean_fraction_std < 1.5
    narrow = transmissions(50e-6, 156, Lab(bend=1e-3), over=16, pad=20)[0]
    tight = xray.fit_row(
        1e7 * narrow, WATER, xray.Detector(np.full(156, 1e7), PIXEL), shells=1, nuisances=(*BEAM, "shape2")
    )
    assert abs(tight.mean_fraction - PHI) < 2 * tight.mean_fraction_std
    assert tight.mean_fraction_std > 3 * bent.mean_fraction_std


@pytest.mark.parametrize("e", [0.01, -0.05, 0.0, 0.15])
def test_a_response_that_is_not_straight_is_undone(e) -> None:
    light = np.linspace(0.0, 1.3, 40) * 2e4
    measured = light * (1 - e * light / 2e4)
    assert linear(measured, e, 2e4 * (1 - e)) == pytest.approx(light, rel=1e-12)


@pytest.mark.parametrize(("blur", "bend"), [(0.0, 0.0), (0.8, 0.0), (1.2, 0.0), (1.2, 1e-3)])
def test_the_gain_is_found_though_pixels_share_light(tmp_path, blur, bend) -> None:
    """10 photons a count; a pixel's own variance says 79 at 0.8 pixels of blur and 178 at 1.2."""
    rng = np.random.default_rng(7)
    u = np.linspace(-1, 1, 180)
    frames = [
        shared_light(1e4 * (1 + 1e-3 * rng.normal() + bend * rng.normal() * u) * np.ones((160, 1)), blur, [7, i]) / 10.0
        for i in range(10)
    ]
    np.save(tmp_path / "f.npy", np.array(frames))
    noise = pair_noise(open_stack("f.npy", "flat", tmp_path))
    assert noise.level / noise.power == pytest.approx(10.0, rel=max(0.02, 3 * noise.power_std))
    assert noise.power_std < 0.05
    naive = noise.level / noise.variance
    assert naive > 60 if blur else naive == pytest.approx(10.0, rel=0.03)


def test_what_was_measured() -> None:
    """The committed campaign holds what is promised of it."""
    tilt = MEASURED["tilt"]["results"]
    for name in ("tilt_out 0 +/- 4 deg", "depth 1 +/- 0.01", "both"):
        assert 0.93 <= tilt[name]["covers_95"] <= 0.975, name
    for angle, found in MEASURED["lean"]["results"].items():
        assert abs(found["bias_1_rows"]) < 1e-3, angle
        assert 0.8 < found["rms_z"] < 1.2, angle
    for name, found in MEASURED["glare"]["results"].items():
        if "rms_z" in found:
            assert 0.8 < found["rms_z"] < 1.2, name
            assert abs(found["weighted_bias"]) < 0.002, name
    for kind, found in MEASURED["alarms"]["results"].items():
        assert found["alarms"] == (found["of"] if kind.startswith("true") else 0), kind
    for name, found in MEASURED["flats"]["results"].items():
        assert 0.8 < found["rms_z"] < 1.2, name
    for name in ("fraction", "radius"):
        assert 0.93 <= MEASURED["positions"]["results"][name]["covers_95"] <= 0.97, name
    assert MEASURED["positions"]["results"]["seams_probability"] > 0.01


def test_ten_bundled_positions_are_one_jet() -> None:
    """The images file alone: every position with its own flat and offset, one detector."""
    from spinline.images import load_images

    images = load_images("peo5-positions")
    assert len(images.positions) == 10
    assert [place.offset.std for place in images.positions] == pytest.approx([5e-6] * 10)
    first = images.at(0)
    assert first.calibration_rows == (0, 40)
    assert first.counts == "peo5-positions.npz:jet_0"
    assert images.at(3).calibration_rows is None
    assert images.at(3).tail_share.std == pytest.approx(0.003)


@pytest.mark.parametrize("method", ["row", "map"])
def test_positions_are_stitched(tmp_path, method, quiet) -> None:
    """Three overlapping images with their own beams and axes: one fraction, one radius, seams that agree."""
    from position_generator import fraction_of, positions, radius_of

    from spinline.radiography.reduce import reduce_images

    data = positions(
        tmp_path, count=3, rows=24, pixels=220, overlap=8, seed=5, keys={"method": method, "block_rows": 4}
    )
    result = reduce_images(images_from_dict(data, folder=tmp_path), checkpoint=tmp_path / "part")
    assert not (tmp_path / "part").exists()
    z = result["z"].values
    assert (np.diff(z) >= 0).all()
    assert set(result["position"].values.tolist()) == {0, 1, 2}
    score = (result["mean_polymer_fraction"].values - fraction_of(z)) / result["mean_polymer_fraction_std"].values
    assert np.sqrt(np.mean(score**2)) < 1.8
    pull = (result["jet_radius"].values - radius_of(z)) / result["jet_radius_std"].values
    assert np.sqrt(np.mean(pull**2)) < 2.0
    assert (result["seam_probability"].values > 1e-3).all()
    assert result.attrs["positions"] == 3
    assert result.attrs["frames_read"].count("2 of p") == 3


def test_positions_that_cannot_be_one_jet_are_refused(tmp_path, quiet) -> None:
    from position_generator import positions

    from spinline.radiography.reduce import reduce_images

    data = positions(tmp_path, count=2, rows=24, pixels=220, overlap=8, seed=5)
    for change, words in (
        ({"method": "phase"}, "method"),
        ({"frames": "each"}, "frames"),
        ({"counts": "p0.npz"}, "positions"),
        ({"positions": [{**data["positions"][0], "offset": "1"}]}, "offset"),
    ):
        with pytest.raises(InputError, match=words):
            images_from_dict({**data, **change}, folder=tmp_path)
    data["positions"][1]["counts"] = "gone.npz"
    with pytest.raises(InputError, match=r"positions\.1\.counts"):
        reduce_images(images_from_dict(data, folder=tmp_path))
