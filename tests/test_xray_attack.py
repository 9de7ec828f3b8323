"""Facts of a lab that an outsider's generator of whole images brought up: jets that thin and lean, beams that move, stages that err."""

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError
from spinline.images.noise import pair_noise
from spinline.images.stacks import open_stack
from spinline.radiography.looks import require_one_jet
from spinline.radiography.stage import Seam, stage_shifts

PIXEL, PHI = 0.67e-6, 0.05
WATER = xray.Absorber(520.9, -136.9)


def thinning_jet(lean, rows=80, columns=260, over=4, radius=60e-6, length=3e-4):
    """Transmission of a jet in space: radius along its own axis, rays cut it where they pass; no rows, no chords of rows."""
    y = (np.arange(rows * over) + 0.5) * PIXEL / over
    x = (np.arange(columns * over) + 0.5) * PIXEL / over - 0.5 * columns * PIXEL
    x, y = np.meshgrid(x, y)
    along = x * np.sin(lean) + y * np.cos(lean)
    aside = x * np.cos(lean) - y * np.sin(lean) + 0.5 * rows * PIXEL * np.sin(lean)
    r = radius * (1 + np.maximum(along, -0.1 * length) / length) ** -0.4
    path = 2 * np.sqrt(np.maximum(r**2 - aside**2, 0.0))
    seen = np.exp(-path * (WATER.solvent + WATER.contrast * PHI))
    return seen.reshape(rows, over, columns, over).mean(axis=(1, 3))


@pytest.mark.parametrize("degrees", [0.0, 6.0, 12.0])
def test_a_jet_that_thins_and_leans_has_its_fraction(degrees) -> None:
    seen = thinning_jet(np.radians(degrees))
    flat, zero, good = np.full(seen.shape, 1e7), np.zeros(seen.shape), np.ones(seen.shape, dtype=bool)
    frame = xray.Frame(1e7 * seen, flat, zero, good, PIXEL)
    track = xray.track_jet(frame.counts, flat, zero, good)
    for rows in (1, 8):
        fit = xray.fit_frame(frame, WATER, shells=1, block_rows=rows, track=track, lean=xray.axis_lean(track).slope)
        assert abs(np.mean(fit.mean) - PHI) < 1e-3
    if degrees == 12.0:  # the middle of the sections is not the axis: that alone would be 0.003
        plain = np.polyfit(np.arange(80), track.axis, 1)[0]
        assert abs(plain - np.tan(np.radians(12.0))) > 1e-3


@pytest.mark.parametrize("frames", [2, 12])
def test_a_beam_that_moves_is_no_noise(tmp_path, frames) -> None:
    """Level and slope of every frame are its own; the gain is that of the photons, and no light seems shared."""
    rng, off = np.random.default_rng(3), []
    u = np.linspace(-1, 1, 150)
    for _ in range(12):
        beams = [(1 + 0.01 * rng.normal()) * (1 + 0.005 * rng.normal() * u) for _ in range(frames)]
        np.save(tmp_path / "f.npy", rng.poisson(2e4 * np.array(beams)[:, None] * np.ones((1, 40, 1))).astype(float))
        noise = pair_noise(open_stack("f.npy", "flat", tmp_path))
        assert noise.along == (1.0,)
        off.append((noise.power / noise.level - 1.0) / noise.power_std)
    assert 0.5 < np.sqrt(np.mean(np.square(off))) < 1.6


def test_stages_are_told_by_the_radii_of_overlaps() -> None:
    """Gaussian offsets and gaps: what is left has the error that is said, and is less than the stage's."""
    rng, scores, left = np.random.default_rng(1), [], []
    std, taper, noise = np.full(6, 1e-6), -0.06, 1.5e-8
    for _ in range(200):
        true = std * rng.normal(size=6)
        seams = [
            Seam(a, a + 1, 1.0, 1, 0.5, 0.0, taper * (true[a] - true[a + 1]) + noise * rng.normal(), noise, taper)
            for a in range(5)
        ]
        mean, covariance = stage_shifts(std, seams)
        scores.append((mean - true) @ np.linalg.solve(covariance, mean - true))
        left.append(np.sqrt(np.diagonal(covariance)))
    assert np.mean(scores) == pytest.approx(6.0, abs=5 * np.sqrt(12.0 / 200))
    assert np.max(left) < 0.5e-6
    held, covariance = stage_shifts(np.array([0.0, 1e-6]), [Seam(0, 1, 1.0, 1, 0.5, 0.0, 6e-8, 1e-12, taper)])
    assert held == pytest.approx([0.0, 1e-6], rel=1e-6)
    assert covariance[0, 0] == 0.0
    untold, covariance = stage_shifts(np.full(2, 1e-6), [Seam(0, 1, 1.0, 1, 0.5, 0.0, 0.0, noise, 0.0)])
    assert untold == pytest.approx([0.0, 0.0])
    assert np.diagonal(covariance) == pytest.approx([1e-12, 1e-12])


def test_an_axis_that_wanders_is_refused() -> None:
    require_one_jet(xray.Lean(np.full(40, np.tan(np.radians(20.0))), 1e-3, 1))
    with pytest.raises(InputError, match="no single jet"):
        require_one_jet(xray.Lean(np.linspace(0.0, 3.0, 40), 1e-3, 6))
    with pytest.raises(InputError, match="no single jet"):
        require_one_jet(xray.Lean(np.full(40, 0.3), 2.0, 6))
