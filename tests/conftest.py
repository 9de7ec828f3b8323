"""Fixtures shared by all tests."""

import contextlib
import gc
import io
import json
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

# Processes share the cores already: threads of linear algebra, which wait by spinning, would cost ten times the work. Read when
# numpy is first imported, so it stands above that.
os.environ["OPENBLAS_NUM_THREADS"] = os.environ.get("OPENBLAS_NUM_THREADS", "1")
os.environ["OMP_NUM_THREADS"] = os.environ.get("OMP_NUM_THREADS", "1")
os.environ["MKL_NUM_THREADS"] = os.environ.get("MKL_NUM_THREADS", "1")

import mpmath
import numpy as np
import pytest

# Half a million objects of the tests and of what they import stay to the end: looking through them for garbage, over and over,
# was a quarter of collecting and a tenth of the rest.
gc.disable()


def pytest_collection_finish() -> None:
    """From here on only what the tests make is looked through."""
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)
    gc.enable()


def pytest_make_parametrize_id(val: object, argname: str) -> str | None:
    """Name a test not by bytes that it reads: a compressed file holds the second it was made in, and the processes that share
    the tests would each know them under another name."""
    return argname if isinstance(val, bytes) else None


os.environ["SPINLINE_QUIET"] = "1"  # how far a command is would depend on the machine; tests of it take this away

IMAGES_PIXEL, IMAGES_PHI = 0.67e-6, 0.0444256
IMAGES = {
    "counts": "a.npz",
    "flat": "a.npz",
    "dark": "a.npz",
    "gain": 1.0,
    "pixel_size": "0.67 um",
    "energy": "10 keV",
    "shells": 1,
    "solution": {"polymer": "PEO", "solvent": "water", "mass_fraction": 0.05},
}


@pytest.fixture(autouse=True)
def fifty_digits():
    """Exact values do not depend on which test file was read last."""
    with mpmath.workdps(50):
        yield


@dataclass(frozen=True)
class Ran:
    """What a command did."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


@pytest.fixture
def spinline(tmp_path, monkeypatch) -> Callable[..., Ran]:
    """Run the command line in an empty folder; an exception that escapes it fails the test."""
    from spinline.cli import main

    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> Ran:
        monkeypatch.setattr(sys, "argv", ["spinline", *map(str, arguments)])
        out, err = io.StringIO(), io.StringIO()
        code = 0
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                main()
            except SystemExit as end:
                code = int(end.code or 0)
        return Ran(code, out.getvalue(), err.getvalue())

    return run


@pytest.fixture
def phantom() -> Callable[..., Any]:
    """Counts of a round jet by brute force."""
    return round_jet_counts


@pytest.fixture(scope="session")
def brute_force() -> Callable[..., Any]:
    """The same for a whole session."""
    return round_jet_counts


def round_jet_counts(
    fraction: Callable[[Any], Any],
    radius: float,
    *,
    flat: Any,
    pixel: float,
    solvent: float,
    contrast: float,
    axis: float = 0.0,
    air: float = 0.0,
    dark: Any = 0.0,
    veil: Any = 0.0,
    blur: float = 0.0,
    amplitude: float = 1.0,
    slope: float = 0.0,
    parts: int = 16,
    along: int = 2000,
) -> Any:
    """Counts of a round jet by brute force: sampled depths, blur by Fourier transform. Shares no code with the package."""
    n, pad = len(flat), 64
    x = (np.arange((n + 2 * pad) * parts) + 0.5) * pixel / parts - pixel * (n / 2 + pad) - axis
    half = np.sqrt(np.maximum(radius**2 - x**2, 0.0))
    depth = np.zeros_like(x)
    hit = half > 0
    y = (np.arange(along) + 0.5) / along
    r = np.hypot(x[hit, None], y * half[hit, None]) / radius
    depth[hit] = 2 * half[hit] * (solvent - air + contrast * fraction(r)).mean(axis=1)
    transmission = np.exp(-depth)
    frequency = np.fft.rfftfreq(x.size, pixel / parts)
    damp = np.exp(-2 * (np.pi * blur * frequency) ** 2)
    seen = 1 + np.fft.irfft(np.fft.rfft(transmission - 1) * damp, x.size)
    seen = seen.reshape(-1, parts).mean(axis=1)[pad:-pad]
    u = np.linspace(-1, 1, n)
    return flat * (amplitude * (1 + slope * u) * seen + veil) + dark


@pytest.fixture(scope="session")
def round_frame():
    """Mean counts of a jet of 30 um, from brute force: 24 rows of 120 pixels, off centre, drifted, tilted beam."""
    return round_jet_counts(
        lambda r: np.full_like(r, IMAGES_PHI),
        30e-6,
        flat=np.ones(120),
        pixel=IMAGES_PIXEL,
        solvent=531.87,
        contrast=-137.44,
        air=0.6,
        axis=3 * IMAGES_PIXEL,
        amplitude=1.01,
        slope=0.01,
        along=400,
    )


@pytest.fixture
def frames_of(tmp_path, round_frame):
    """Write frames, flats and darks, and check an images file of them."""
    from spinline.images import images_from_dict

    def make(photons=4e6, count=3, flats=8, per_count=1.0, offset=20.0, rows=24, save=True, mean=None, **keys):
        rng = np.random.default_rng(7)
        one = round_frame if mean is None else mean
        arrays = {
            "counts": rng.poisson(photons * one, (count, rows, one.shape[-1])) / per_count + offset,
            "flat": rng.poisson(photons, (flats, rows, one.shape[-1])) / per_count + offset,
            "dark": np.full((rows, one.shape[-1]), offset),
        }
        if save:
            np.savez(tmp_path / "a.npz", **arrays)
        data = {key: value for key, value in {**IMAGES, **keys}.items() if value is not None}
        return images_from_dict(data, folder=tmp_path), arrays

    return make


@pytest.fixture
def quiet():
    """Warnings of the package are not looked at."""
    import warnings

    from spinline.base.errors import SpinlineWarning

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        yield


def score_of(result):
    """Mean over blocks of the fraction's error, in its standard deviations."""
    z = (result["mean_polymer_fraction"] - IMAGES_PHI) / result["mean_polymer_fraction_std"]
    return float(z.mean()) * np.sqrt(z.size)
