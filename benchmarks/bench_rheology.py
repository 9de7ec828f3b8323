"""Rheology: error and time of each law against independent references, and of a coupled run.

Run: ``OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python benchmarks/bench_rheology.py``. Times are processor seconds, the shortest
of several. Conformation and evaporation against scipy's LSODA at rtol 1e-12 on the plain equations; radial drying against
itself at twice the cells and a hundredth of the tolerance, and against the cylinder series; drying with heat against the
isothermal one; the coupled run is the design's: evaporation, conformation and radial drying, a map of 200 x 100, warm.
"""

import time
import warnings
from collections import Counter
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

import spinline as sl
from spinline.rheology.conformation import FENEP, Giesekus, Maxwell, conformation
from spinline.rheology.diffusion_laws import ConstantDiffusion
from spinline.rheology.drying import cylinder_series, dry_radially
from spinline.rheology.element_path import straight_path
from spinline.rheology.evaporant import Evaporant
from spinline.rheology.evaporation import evaporate
from spinline.rheology.heat import dry_with_heat
from spinline.rheology.heat_map import dry_radially_with_heat
from spinline.rheology.vapour import solvent_activity
from spinline.rheology.volatile import Volatile

JET = sl.jetprofile.PowerLaw(radius=125e-6, flow_rate=3.2e-6 / 3600, k=1.0, beta=0.47)
NU = 1.5e-5


def best(function: Callable[[], object], repeats: int = 5) -> float:
    """Shortest of several runs, processor seconds, after one that is not counted."""
    function()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return min(times)


def conformations() -> None:
    """Stretch at the end of 5 mm of the PEO jet."""
    z = np.unique(np.append(125e-6 * np.expm1(np.linspace(0, np.log1p(40.0), 400)), [125e-6, 5e-3]))
    t, stretch, rate = JET.residence_time(z), JET.stretch_ratio(z), JET.strain_rate(z)
    print(f"{'conformation':34s}{'error':>10s}{'s':>10s}{'LSODA, s':>10s}")
    for model in (Maxwell(), FENEP(500.0), Giesekus(0.2)):
        for theta in (1e-3, 1e-2, 1e-1, 10.0):

            def slope(at: float, a: np.ndarray, theta: float = theta, model: object = model) -> np.ndarray:
                v, edot = float(JET.velocity(at)), float(JET.strain_rate(at))
                if isinstance(model, FENEP):
                    g = (model.extensibility - 3) / (model.extensibility - a[0] - 2 * a[1]) * a - 1
                elif isinstance(model, Giesekus):
                    g = (a - 1) * (1 + model.mobility * (a - 1))
                else:
                    g = a - 1
                return (np.array([2.0, -1.0]) * edot * a - g / theta) / v

            def reference(slope: Callable[..., np.ndarray] = slope) -> float:
                found = solve_ivp(slope, (125e-6, 5e-3), [1.0, 1.0], method="LSODA", rtol=1e-12, atol=1e-14)
                return float(found.y[0, -1])

            def ours(theta: float = theta, model: object = model) -> float:
                return float(conformation(t, stretch, theta, model, strain_rate=rate).axial[-1])  # type: ignore[arg-type]

            name = f"{type(model).__name__}, theta = {theta:g} s"
            print(f"{name:34s}{abs(ours() / reference() - 1):10.1e}{best(ours, 3):10.4f}{best(reference, 2):10.4f}")


def evaporation() -> None:
    """Volume left at the end of 10 mm."""
    z = np.linspace(1e-5, 10e-3, 400)
    path = straight_path(JET, z)
    print(f"\n{'evaporation':34s}{'error':>10s}{'s':>10s}{'LSODA, s':>10s}")
    for saturation in (1.73e-5, 1e-3, 0.023):
        water = Volatile("water", saturation, 2.5e-5, ambient=0.4, chi=0.45)

        def ours(water: Volatile = water) -> float:
            return float(evaporate(path, 0.0444, [water], air_viscosity=NU).remaining[-1])

        def reference(water: Volatile = water) -> float:
            def slope(at: float, left: np.ndarray) -> np.ndarray:
                v = float(JET.velocity(at))
                r = JET.initial_radius * np.sqrt(left[0] * JET.initial_velocity / v)
                sh = 0.495 * np.cbrt(2 * r * v / NU) * np.sqrt(NU / water.diffusivity)
                drop = float(solvent_activity(0.0444 / left[0], water.chi)) - water.ambient
                return np.array([-np.pi * water.diffusivity * sh * water.saturation * drop / JET.flow_rate])

            ends = (0.0, 125e-6, 10e-3)
            left = np.array([1.0])
            for a, b in pairwise(ends):
                left = solve_ivp(slope, (a, b), left, method="LSODA", rtol=1e-12, atol=1e-14).y[:, -1]
            return float(left[0])

        lost = abs((1 - ours()) / (1 - reference()) - 1)
        print(f"{f'C = {saturation:g}':34s}{lost:10.1e}{best(ours):10.4f}{best(reference, 2):10.4f}")


def drying() -> None:
    """Error of phi across the jet after 10 mm, 100 cells."""
    z = np.linspace(1e-5, 10e-3, 200)
    path = straight_path(JET, z)
    print(f"\n{'radial drying, 100 cells':34s}{'error':>10s}{'s':>10s}{'Peclet':>10s}")
    solvent = Volatile("x", 1e-3, 1e-5, chi=0.45)
    for diffusivity in (1e-8, 1e-10, 1e-12):

        def ours(cells: int = 100, rtol: float = 1e-5, diffusivity: float = diffusivity) -> np.ndarray:
            law = ConstantDiffusion(diffusivity)
            done = dry_radially(path, 0.1, solvent, law, air_viscosity=NU, cells=cells, rtol=rtol)
            share = np.cumsum(done.polymer_share)
            return np.interp(np.linspace(0.05, 0.95, 19), share - 0.5 * done.polymer_share, done.polymer_fraction[-1])

        error = np.abs(ours() / ours(200, 1e-7) - 1).max()
        print(
            f"{f'D = {diffusivity:g} m2/s':34s}{error:10.1e}{best(ours, 3):10.4f}{1e-5 * 0.3e-3 / (2 * diffusivity):10.2g}"
        )
    r0, d, biot = 1e-4, 1e-6, 1.0
    still = sl.jetprofile.PowerLaw(radius=r0, flow_rate=np.pi * r0**2, k=1e-6, beta=1.0)
    phi = 1 - 2.0**-36
    there = Volatile("x", 2 * d * biot / (2.5e-5 * 2.0 * np.e), 2.5e-5)
    fourier = np.array([0.05, 0.2, 0.5])
    done = dry_radially(
        straight_path(still, fourier * r0**2 / d),
        phi,
        there,
        ConstantDiffusion(d),
        air_viscosity=NU,
        sherwood_floor=2.0,
        cells=100,
        rtol=1e-10,
    )
    left = (1 / done.polymer_fraction - 1)[:, 0] / ((1 - phi) / phi)
    series = cylinder_series(done.edges[0, 1] / np.sqrt(2) / r0, fourier, biot)  # the mean of a parabola over the cell
    print(f"{'cylinder series, Bi = 1, axis':34s}{np.abs(left / series - 1).max():10.1e}")


def heat() -> None:
    """What the balance of heat costs beside the isothermal one, 15 cm at 400 places, and a map of 200 x 100 with it."""
    jet = sl.jetprofile.PowerLaw(radius=100e-6, flow_rate=0.5e-6 / 3600, k=1.0, beta=0.47)
    path, room = straight_path(jet, np.linspace(0.15 / 400, 0.15, 400)), 298.15
    print(f"\n{'drying with heat':34s}{'s':>10s}{'isothermal, s':>15s}{'ratio':>8s}")
    for name in ("water", "ethanol", "acetone", "DMF", "DCM"):
        liquid = Evaporant.build(name, room, chi=0.5)
        saturation = liquid.pressure(room) * liquid.molar_mass / (8.31446261815324 * room * liquid.density)
        plain = Volatile(name, saturation, liquid.diffusivity, 0.0, 0.5)

        def hot(liquid: Evaporant = liquid) -> object:
            return dry_with_heat(path, 0.08, [liquid], temperature=room)

        with_heat = best(hot)
        without = best(lambda plain=plain: evaporate(path, 0.08, [plain], air_viscosity=NU))  # type: ignore[misc]
        print(f"{name:34s}{with_heat:10.4f}{without:15.4f}{with_heat / without:8.2f}")
    liquid, places = Evaporant.build("acetone", room, chi=0.5), straight_path(jet, np.linspace(0.04 / 200, 0.04, 200))

    def across() -> object:
        return dry_radially_with_heat(places, 0.0683, liquid, ConstantDiffusion(1e-9), temperature=room, cells=100)

    print(f"{'map of 200 x 100':34s}{best(across):10.4f}")


def coupled() -> None:
    """The design's run."""
    print(f"\n{'coupled run, 200 x 100':34s}{'s':>10s}{'wall, s':>10s}")
    for label, overrides in (
        ("Maxwell", ["network.closure=force"]),
        ("FENE-P", []),
        ("Maxwell, flat across", ["network.closure=force", "effects.radial=false"]),
    ):
        scene = sl.load_scene("pmma10-drying", ["accuracy.points=200", *overrides])
        start = time.perf_counter()
        spent = best(lambda scene=scene: sl.run(scene), 5)  # type: ignore[misc]
        print(f"{label:34s}{spent:10.3f}{(time.perf_counter() - start) / 6:10.3f}")
    result = sl.run(scene)
    assert result.sizes["z"] >= 200


def main() -> None:
    """Print everything."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        conformations()
        evaporation()
        drying()
        heat()
        coupled()
    for words, times in Counter(f"{item.category.__name__}: {item.message}" for item in said).items():
        print(f"said {times} times: {words}")


if __name__ == "__main__":
    main()
