"""The thread's bending moment: what it resists and what it does not, its rate, its waves, and the march that can be stopped."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun._bend_kernels import bent_stage
from spinline.jetprofile.spun._chain_kernels import geometry
from spinline.jetprofile.spun.chain import parameters, start_cylinder
from spinline.jetprofile.spun.laws import JetLaw
from spinline.jetprofile.spun.settings import Collector, Grid, Inlet, Loads, SpunSettings

R0, STEP, RHO, MU = 1e-4, 2e-4, 1000.0, 2.0


def _settings(bending="viscous", law=None, speed=1e-9):
    return SpunSettings(
        density=RHO,
        law=law or JetLaw("oldroyd-b", 0.9 * MU / 1e-2, 1e-2, solvent_viscosity=0.1 * MU),
        inlet=Inlet(math.pi * R0**2 * speed, R0, stress="given"),
        loads=Loads(gap=1.0, gravity=0.0),
        grid=Grid(STEP, repulsion="none", bending=bending, bend_viscosity=MU),
        collector=Collector("none"),
    )


def _thread(n, bent, rng=None):
    """A thread in space, `bent` per length, its radius not even."""
    s = STEP * np.arange(n, -1, -1.0)
    y = np.zeros((n + 4, c.COLUMNS))
    y[: n + 1, c.X] = s
    if bent:
        y[: n + 1, c.Y], y[: n + 1, c.Z] = np.cos(bent * s) / bent, np.sin(0.7 * bent * s) / bent
    y[:n, c.AZZ], y[:n, c.ARR] = 3.0, 0.6
    y[:n, c.VOLUME] = y[:n, c.LABEL] = math.pi * R0**2 * STEP * (1.0 if rng is None else rng.uniform(0.5, 1.5, n))
    return y


def _stage(s, n, y, gh, held=None):
    p, k = parameters(s)
    w, push = np.zeros((c.WORK, n + 4)), np.zeros((n + 4, 6))
    assert geometry(n, y, p, k, w)
    held = np.zeros(n + 4, dtype=np.int64) if held is None else held
    assert bent_stage(n, gh, y, held, p, k, w, push)
    return w, push


@pytest.mark.parametrize("bending", ["viscous", "elastic"])
def test_a_thread_that_turns_as_a_whole_is_not_resisted(bending):
    n, rng = 14, np.random.default_rng(3)
    y = _thread(n, 500.0, rng)
    spin, drift = np.array([300.0, -200.0, 500.0]), np.array([1.0, 2.0, -0.5])
    y[: n + 1, c.VX : c.VX + 3] = drift + np.cross(spin, y[: n + 1, :3])
    w, push = _stage(_settings(bending), n, y, 1e-4)
    scale = np.abs(y[:n, c.VX : c.VX + 3]).max()
    assert np.abs(push[:n, :3]).max() * 1e-4 < 1e-9 * scale
    assert y[:n, c.SPIN] == pytest.approx(spin @ w[c.TX : c.TX + 3, :n], rel=1e-5)
    assert np.abs(push[:n, 3:]).max() < 1e-5 * 500.0 * 500.0  # of the bend times its turning
    bent = _thread(n, 500.0, rng)  # and one that bends is
    bent[: n + 1, c.VX] = 1e4 * (bent[: n + 1, c.Y] - bent[0, c.Y])
    before = bent.copy()
    _stage(_settings(bending), n, bent, 1e-4)
    assert np.abs(bent - before)[:n, c.VX].max() > 0.02 * np.abs(before[:n, c.VX]).max()


@pytest.mark.parametrize("bending", ["viscous", "elastic"])
def test_momentum_and_angular_momentum_are_kept(bending):
    """The two elements at the nozzle, which is held, are so thin that they pass on nothing."""
    n, rng = 14, np.random.default_rng(4)
    y = _thread(n, 500.0, rng)
    y[n - 2 : n, c.VOLUME] *= 1e-7
    y[: n + 1, c.VX : c.VX + 3] = rng.normal(size=(n + 1, 3))
    y[1 : n - 1, c.MX : c.MX + 3] = rng.normal(size=(n - 2, 3)) * 100.0 if bending == "elastic" else 0.0
    y[n - 3 :, c.MX : c.MX + 3] = 0.0
    mass = 0.5 * RHO * (y[:n, c.VOLUME] + np.append(0.0, y[: n - 1, c.VOLUME]))
    _, push = _stage(_settings(bending), n, y, 1e-5)
    force = mass[:, None] * push[:n, :3]
    assert np.abs(force.sum(axis=0)).max() < 1e-6 * np.abs(force).max()
    torque = np.cross(y[:n, :3], force)
    assert np.abs(torque.sum(axis=0)).max() < 1e-6 * np.abs(torque).max()


def test_rate_of_a_bent_thread():
    """Hinged at both ends: a sine dies at ``(3 mu r^2/4 rho) K^4``, ``K = (2/l) sin(k l/2)``."""
    n = 24
    y = _thread(n, 0.0)
    held = np.zeros(n + 4, dtype=np.int64)
    held[0] = 1
    k = math.pi * 3 / (n * STEP)
    wave = np.sin(k * y[: n + 1, c.X])
    y[: n + 1, c.VX + 1], y[: n + 1, c.VX + 2] = wave, -2.0 * wave
    gh = 3e-3
    _stage(_settings(), n, y, gh, held)
    rate = 3 * MU * R0**2 / (4 * RHO) * (2 / STEP * math.sin(k * STEP / 2)) ** 4
    assert y[1:n, c.VX + 1] == pytest.approx(wave[1:n] / (1 + gh * rate), rel=1e-7)
    assert y[1:n, c.VX + 2] == pytest.approx(-2 * wave[1:n] / (1 + gh * rate), rel=1e-7)
    assert gh * rate > 0.5


def test_waves_of_an_elastic_thread():
    """A rubber at rest, hinged: ``omega^2 = (3 G r^2/4 rho) K^4``, by the whole march at steps far beyond an explicit one's."""
    n, modulus = 24, 2e4
    s = _settings("elastic", JetLaw("ucm", modulus, math.inf))
    s = replace(s, inlet=replace(s.inlet, length=n * STEP))
    chain = start_cylinder(s)
    n = chain.n
    y, k = chain.state, math.pi / chain.state[0, c.X]
    wave = np.sin(k * y[: n + 1, c.X])
    y[: n + 1, c.VX + 1] = 1e-6 * wave
    chain.held[0] = 1
    y[0, c.VX] = 0.0
    omega = math.sqrt(3 * modulus * R0**2 / (4 * RHO)) * (2 / STEP * math.sin(k * STEP / 2)) ** 2
    period = 2 * math.pi / omega
    found = []
    for part in (0.25, 0.5, 1.0):
        chain.march(part * period)
        found.append(float(chain.nodes[:, c.VX + 1] @ wave / (wave @ wave)) / 1e-6)
    assert found == pytest.approx([0.0, -1.0, 1.0], abs=0.01)


def test_march_comes_back_and_can_be_stopped():
    """Thousands of steps: the compiled march returns on its way, so that an interrupt is heard; the result is the same."""

    class Stop(Exception):
        pass

    def stop(time):
        raise Stop

    s = _settings("viscous", speed=1e-3)
    s = replace(s, inlet=replace(s.inlet, length=60 * STEP), grid=replace(s.grid, fixed_step=1e-6))
    whole, seen = start_cylinder(s), []
    whole.march(4e-3, progress=seen.append)
    assert len(seen) > 2
    assert seen[-1] == 4e-3
    stopped = start_cylinder(s)
    with pytest.raises(Stop):
        stopped.march(4e-3, progress=stop)
    assert 0 < stopped.time < 4e-3
    stopped.march(4e-3)
    assert np.array_equal(stopped.nodes, whole.nodes)
