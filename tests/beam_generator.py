"""Counts of jets as a lab sees them, by ways that the package does not take: sampled chords, Fourier optics, no closed forms.

The glare is put in by its optical transfer function, that of ``exp(-r/l)/(2 pi l^2)`` along one axis, ``(1 + (2 pi f l)^2)^(-3/2)``;
a leaning jet, or one whose section is an ellipse, by the geometry of a cylinder in space.
"""

from dataclasses import dataclass

import numpy as np

PIXEL, PHI = 0.67e-6, 0.05
SOLVENT, CONTRAST = 520.9, -136.9  # 1/m, about PEO in water at 10 keV


@dataclass(frozen=True)
class Lab:
    """What a lab does to a jet; lengths in m, angles in rad."""

    blur: float = 0.0
    tail: tuple[float, float] = (0.0, 0.0)
    lean: float = 0.0
    tilt_out: float = 0.0
    depth: float = 1.0
    amplitude: float = 1.0
    slope: float = 0.0
    bend: float = 0.0
    axis: float = 0.0
    solvent: float = SOLVENT
    contrast: float = CONTRAST


def transmissions(radius, pixels, lab=None, *, rows=None, pixel=PIXEL, phi=PHI, over=8, pad=700):
    """Share of the beam that each pixel sees: one row for each radius (or `rows` rows of one radius)."""
    lab = lab or Lab()
    radii = np.atleast_1d(np.asarray(radius, dtype=float))
    radii = np.repeat(radii, rows) if rows else radii
    size = (pixels + 2 * pad) * over
    x = (np.arange(size) + 0.5) * pixel / over - (pixels / 2 + pad) * pixel
    f = np.fft.rfftfreq(size, pixel / over)
    share, length = lab.tail
    out = np.empty((radii.size, pixels))
    for i, r in enumerate(radii):
        middle = lab.axis + (i - 0.5 * (radii.size - 1)) * pixel * np.tan(lab.lean)
        across = (x - middle) * np.cos(lab.lean)  # distance of the ray from the axis, in the image
        path = 2 * np.sqrt(np.maximum(r**2 - across**2, 0.0)) * lab.depth / np.cos(lab.tilt_out)
        missing = np.exp(-path * (lab.solvent + lab.contrast * phi)) - 1.0
        cos = np.cos(lab.lean)
        transfer = np.exp(-2 * (np.pi * f * lab.blur / cos) ** 2)
        if share:
            transfer = transfer * (1 - share + share * (1 + (2 * np.pi * f * length / cos) ** 2) ** -1.5)
        seen = np.fft.irfft(np.fft.rfft(missing) * transfer, size)
        out[i] = 1.0 + seen.reshape(-1, over).mean(axis=1)[pad : pad + pixels]
    u = np.linspace(-1, 1, pixels)
    return out * lab.amplitude * (1 + lab.slope * u + lab.bend * (1.5 * u**2 - 0.5))


def shared_light(photons, blur, seed):
    """Poisson photons whose light falls on several pixels each: what a scintillator does to noise; blur in pixels."""
    from scipy.ndimage import gaussian_filter

    beyond = int(np.ceil(6 * blur)) + 1  # light comes in from beyond the frame, too
    counts = np.random.default_rng(seed).poisson(np.pad(photons, beyond, mode="edge")).astype(float)
    inside = slice(beyond, -beyond)
    return (gaussian_filter(counts, blur, truncate=6.0) if blur else counts)[inside, inside]


def stack(mean, frames, seed, dark=0.0):
    """Poisson frames of a mean, dark counts with them."""
    return np.random.default_rng(seed).poisson(np.asarray(mean) + dark, (frames, *np.shape(mean)))
