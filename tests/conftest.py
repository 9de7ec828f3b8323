"""Fixtures shared by all tests."""

import contextlib
import io
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest


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
