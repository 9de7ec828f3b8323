"""A look at a set of images before anyone waits: edges, axis, saturation, and the error that the photons allow.

Up to 64 frames, spread over the stack, are summed; everything else is scaled to the whole.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.images.sums import sample_frames
from spinline.radiography.experiment import Experiment, expected_errors
from spinline.radiography.prepare import prepare
from spinline.scene.images_file import Images
from spinline.xray.frame.blocks import Frame
from spinline.xray.frame.track import Track

__all__ = ["Preview", "preview_images"]


@dataclass(frozen=True, eq=False)
class Preview:
    """What is in view, and what to expect of it.

    Attributes
    ----------
    experiment, frame, track
        As in `experiment.prepare`.
    facts : dict
        Masked and saturated pixels, noise of the flats, photons per pixel of the sample.
    sampled : int
        Frames that were looked at.
    row, expected_std : ndarray
        Standard deviation of the mean fraction to expect of a block, at some rows.
    rows_needed : int or None
        Rows to sum for a standard deviation of 0.01 at the worst of these; None where all rows together are too few.
    """

    experiment: Experiment
    frame: Frame
    track: Track
    facts: dict[str, float]
    sampled: int
    row: FloatArray
    expected_std: FloatArray
    rows_needed: int | None

    def numbers(self) -> dict[str, Any]:
        """All of it by name, SI."""
        p, t = self.experiment.pixel, self.track
        half = 0.5 * self.frame.counts.shape[1]
        return {
            "frames": self.experiment.stack.frames,
            "frames_sampled": self.sampled,
            "rows": self.frame.counts.shape[0],
            "columns": self.frame.counts.shape[1],
            "pixel_size": p,
            "photons_per_pixel": self.facts["photons"] / self.sampled * self.exposures,
            "bad_pixels": int(self.facts["bad_pixels"]),
            "saturated_pixels": int(self.facts["saturated_pixels"]),
            "jet_radius": [p * float(t.radius[0]), p * float(t.radius[-1])],
            "left_edge_pixel": [float((half + t.axis - t.radius)[i]) for i in (0, -1)],
            "right_edge_pixel": [float((half + t.axis + t.radius)[i]) for i in (0, -1)],
            "axis_tilt": float(np.polyfit(np.arange(t.axis.size), t.axis, 1)[0]) if t.axis.size > 1 else 0.0,
            "rows_with_jet": float(t.found.mean()),
            "block_rows": self.experiment.images.block_rows,
            "volume_fraction": self.experiment.solution.volume_fraction,
            "attenuation_scale": self.experiment.calibration.scale,
            "row": self.row.tolist(),
            "expected_std": self.expected_std.tolist(),
            "block_rows_for_0.01": self.rows_needed,
            "warnings": list(self.experiment.remarks),
            **{f"{key}_source": words for key, words in self.experiment.notes.items()},
        }

    @property
    def exposures(self) -> int:
        """Frames that go into one result."""
        return 1 if self.experiment.images.frames == "each" else self.experiment.stack.frames

    def lines(self) -> list[str]:
        """The same in sentences."""
        n = self.numbers()
        phi, std = n["volume_fraction"], self.expected_std
        worst, best = float(np.nanmax(std)), float(np.nanmin(std))
        height, width = n["rows"], n["columns"]
        said = [
            f"{n['frames']} frames of {height} x {width} ({n['frames_sampled']} looked at), pixels "
            f"{1e6 * n['pixel_size']:.4g} um, {n['photons_per_pixel']:.3g} photons per pixel in all.",
            f"Jet of radius {1e6 * n['jet_radius'][0]:.4g} um at the first row (edges at pixels "
            f"{n['left_edge_pixel'][0]:.2f} and {n['right_edge_pixel'][0]:.2f}), "
            f"{1e6 * n['jet_radius'][1]:.4g} um at the last ({n['left_edge_pixel'][1]:.2f}, "
            f"{n['right_edge_pixel'][1]:.2f}); its axis leans by {np.degrees(np.arctan(n['axis_tilt'])):.2g} degrees.",
            f"{n['bad_pixels']} pixels are left out, {n['saturated_pixels']} of them saturated.",
            f"Expected error of the mean fraction, a block of {n['block_rows']}: {best:.2g} to {worst:.2g}; the solution's "
            f"fraction is {phi:.3g}.",
        ]
        if self.rows_needed is None:
            said.append("All rows together do not reach 0.01: see `spinline exposure`.")
        elif worst > 0.01:
            said.append(f"For 0.01 everywhere, sum {self.rows_needed} rows (block_rows).")
        return said


def preview_images(images: Images) -> Preview:
    """Look at a set of images.

    Parameters
    ----------
    images : Images

    Returns
    -------
    Preview

    Raises
    ------
    InputError
        As a reduction would, but for an error expected to exceed the fraction.
    """
    experiment, frame, track, facts = prepare(images, sample_frames)
    sampled = experiment.used
    exposures = 1 if images.frames == "each" else experiment.stack.frames
    row, std = expected_errors(experiment, frame, track)
    if not np.isfinite(std).any():
        raise InputError("shells", "cannot be told apart in any block", value=images.shells, remedy="take fewer shells")
    more = experiment.fields.flat_noise(images, facts["level"] * exposures, frame.counts.shape[0]) / facts["flat_noise"]
    std = std * np.sqrt(sampled / exposures * more)
    rows = int(np.ceil(images.block_rows * (float(np.nanmax(std)) / 0.01) ** 2))
    return Preview(experiment, frame, track, facts, sampled, row, std, rows if rows <= frame.counts.shape[0] else None)
