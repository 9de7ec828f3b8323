"""Frames of a jet that was never imaged: from the result of a run to counts on disk, and the images file that reduces them.

The result's radius and polymer fraction are put in front of a beam (`spinline.xray.frame.image`), frame by frame with its own
drift and Poisson noise from (seed, frame), beside flat and dark frames with noise of their own. What was put in is kept in
the file (`truth_*`), so that a reduction can be held against it.
"""

import io
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray, number, positive
from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.files import outputs, streaming, write_text
from spinline.base.progress import report
from spinline.radiography.camera import Camera
from spinline.xray.frame.image import STEEPEST, JetField, core_and_sheath, expected_image, transmission_image
from spinline.xray.matter.medium import Medium, solution_medium
from spinline.xray.matter.spectrum import Spectrum
from spinline.xray.row.chords import equal_shells
from spinline.xray.row.model import beam_shape

if TYPE_CHECKING:
    import xarray as xr

    from spinline.scene.file import Scene

__all__ = ["Camera", "Frames", "field_from_result", "medium_from_result", "simulate", "write_frames"]

_SHELLS = 30
_MOST_PIXELS = 200_000_000
_AT_ONCE = 1 << 18  # pixels
_FIRST_FLAT, _FIRST_DARK = 1_000_000, 2_000_000  # numbers of the random streams


@dataclass(frozen=True, eq=False)
class Frames:
    """Simulated counts, with what was put in.

    Attributes
    ----------
    counts : ndarray of uint32, shape (frames, rows, pixels)
    flat, dark : ndarray of uint32, shape (reference frames, rows, pixels)
        With noise; flat frames hold dark counts too.
    jet : JetField
    transmission : ndarray, shape (rows, pixels)
    camera : Camera
    """

    counts: Any
    flat: Any
    dark: Any
    jet: JetField
    transmission: FloatArray
    camera: Camera


def field_from_result(result: "xr.Dataset", shells: int = _SHELLS) -> JetField:
    """Radius and polymer fraction of a straight jet's result.

    Parameters
    ----------
    result : xarray.Dataset
        Of `spinline.run`, along z. Where it has ``polymer_fraction(z, r)`` that is used; else the network's core
        (``core_polymer_fraction`` within ``network_radius``) in a sheath with the rest of ``mean_polymer_fraction``.
    shells : int
        Of equal width, where the result has none.

    Returns
    -------
    JetField

    Raises
    ------
    InputError
        For a jet of beads, several times, or a result without a fraction.
    """
    if "radius" not in result or result["radius"].dims != ("z",):
        raise InputError(
            "result",
            "is not that of a straight jet at one time",
            value=str(dict(result.sizes)),
            remedy="run a scene with a law or a table for a jet",
        )
    z, radius = result["z"].values, result["radius"].values
    if "polymer_fraction" in result and result["polymer_fraction"].dims == ("z", "r"):
        r, fraction = result["r"].values, result["polymer_fraction"].values
        edges = equal_shells(r.size)
        middle = 0.5 * (edges[1:] + edges[:-1])
        if not np.allclose(r, middle, atol=1e-6):
            fraction = np.stack([np.interp(middle, r, row) for row in fraction])
    else:
        for name in ("network_radius", "core_polymer_fraction", "mean_polymer_fraction"):
            if name not in result:
                raise InputError("result", f"has no {name}", remedy="give a result of spinline run")
        core = np.minimum(result["network_radius"].values / radius, 1.0)
        fraction = core_and_sheath(
            core, result["core_polymer_fraction"].values, result["mean_polymer_fraction"].values, shells
        )
    known = np.isfinite(fraction).all(axis=1) & np.isfinite(radius)
    if known.sum() < 2:
        raise InputError("result", "has no polymer fraction along the jet")
    return JetField(z[known], radius[known], fraction[known])


def medium_from_result(result: "xr.Dataset", beam: float | Spectrum, *, coherent: bool = True) -> Medium:
    """Attenuation and refraction of the solution that a result was computed for."""
    from spinline.setup.build import build_solution
    from spinline.xray.matter.attenuation import Material

    scene = _scene(result)
    solution = build_solution(scene)
    solvent = scene.solution.solvent
    what = Material(solvent if isinstance(solvent, str) else dict(solvent), solution.solvent_density)
    return solution_medium(solution.polymer, what, beam, coherent=coherent, temperature=solution.temperature)


def simulate(result: "xr.Dataset", camera: Camera, *, start: float | None = None, stop: float | None = None) -> Frames:
    """Make frames of the jet of a result.

    Parameters
    ----------
    result : xarray.Dataset
    camera : Camera
    start, stop : float, optional
        Field of view along the jet, m; left out: all of it.

    Returns
    -------
    Frames

    Raises
    ------
    InputError
        For a field of view outside the jet, more than 2e8 pixels in all, or what the image model refuses.
    """
    _check(camera)
    field = field_from_result(result)
    first = (
        float(field.position[0]) if start is None else number("start", start, least=float(field.position[0]), unit="m")
    )
    last = float(field.position[-1]) if stop is None else number("stop", stop, most=float(field.position[-1]), unit="m")
    step = camera.pixel / np.cos(camera.tilt_out) / np.cos(camera.tilt)
    rows = int((last - first) / step)
    if rows < 1:
        raise InputError("stop", "leaves no row", value=last, allowed=f"over {first + step:g} m")
    jet = field.at(first + step * (np.arange(rows) + 0.5))
    wide = 2 * float(jet.radius.max()) / camera.pixel
    if wide < _FEWEST_ACROSS:
        few = f"the jet is {wide:.2g} pixels wide: no reduction tells its fraction; take smaller pixels"
        warnings.warn(few, SpinlineWarning, stacklevel=2)
    lean = abs(np.tan(camera.tilt)) * camera.pixel * rows
    width = 3.0 * float(jet.radius.max()) / np.cos(camera.tilt) + 2.0 * (abs(camera.axis) + lean)
    pixels = camera.pixels or int(np.ceil(width / camera.pixel)) + 8
    total = rows * pixels * (camera.frames + 2 * camera.reference_frames)
    if total > _MOST_PIXELS:
        raise InputError(
            "frames",
            "are too many or too large",
            value=total,
            allowed=f"{_MOST_PIXELS:g} pixels in all",
            remedy="look at less of the jet (--from, --to), fewer frames, or larger pixels",
        )
    medium = medium_from_result(result, camera.beam, coherent=camera.coherent)
    seen = transmission_image(
        jet,
        medium,
        pixels,
        camera.pixel,
        distance=camera.distance,
        axis=camera.axis,
        tilt=camera.tilt,
        tilt_out=camera.tilt_out,
        blur=camera.blur,
        motion=camera.motion,
        tail=(camera.tail_share, camera.tail_length),
        depth=camera.depth,
    )
    bend = beam_shape({"shape2": camera.bend}, pixels)
    pattern = _stream(camera.seed, 3_000_000).normal(0.0, 1.0, (rows, pixels))
    flat = camera.photons * np.maximum(1.0 + camera.flat_structure * pattern, 0.05)
    counts = np.empty((camera.frames, rows, pixels), dtype=np.uint32)
    for i in range(camera.frames):
        stream = _stream(camera.seed, i)
        level = max(1.0 + camera.drift * float(stream.normal()), 0.05)
        mean = expected_image(
            seen,
            flat * bend,
            dark=camera.dark,
            veil=camera.veil,
            amplitude=level,
            slope=camera.slope if camera.slope else 0.0,
        )
        report("frames", i, camera.frames)
        _draw(stream, mean, counts[i])
    shape = (camera.reference_frames, rows, pixels)
    bright, dark = np.empty(shape, dtype=np.uint32), np.empty(shape, dtype=np.uint32)
    for i in range(camera.reference_frames):
        report("frames without the jet", i, camera.reference_frames)
        _draw(_stream(camera.seed, _FIRST_FLAT + i), flat + camera.dark, bright[i])
        _draw(_stream(camera.seed, _FIRST_DARK + i), np.broadcast_to(camera.dark, (rows, pixels)), dark[i])
    return Frames(counts, bright, dark, jet, seen, camera)


def _draw(stream: np.random.Generator, mean: FloatArray, counts: "np.ndarray[Any, Any]") -> None:
    """Counts of a frame, some rows at a time: the numbers are those of one draw, and a signal need not wait for all."""
    step = max(1, _AT_ONCE // mean.shape[1])
    for start in range(0, len(mean), step):
        counts[start : start + step] = stream.poisson(mean[start : start + step])


def write_frames(frames: Frames, result: "xr.Dataset", path: str | Path, *, force: bool = False) -> tuple[Path, ...]:
    """Write frames as .npz, or .tif with flat and dark beside it, and the images file that reduces them.

    Parameters
    ----------
    frames : Frames
    result : xarray.Dataset
        The frames' own: its scene gives the solution.
    path : path
        ``frames.npz`` (holds what was put in, too) or ``frames.tif``. The images file is its name with .toml.
    force : bool
        Overwrite.

    Returns
    -------
    tuple of Path
        All that was written, the images file last.
    """
    target = Path(path)
    kind = target.suffix.lower()
    if kind not in (".npz", ".tif", ".tiff"):
        raise InputError("output", "is neither .npz nor .tif", value=str(path), remedy="name it frames.npz")
    toml = target.with_suffix(".toml")
    parts = {"counts": frames.counts, "flat": frames.flat, "dark": frames.dark}
    names = dict.fromkeys(parts, target)
    if kind != ".npz":
        names |= {key: target.with_name(f"{target.stem}_{key}{target.suffix}") for key in ("flat", "dark")}
    outputs(*dict.fromkeys(names.values()), toml, force=force)
    if kind == ".npz":
        with streaming(target, force=force) as stream:
            np.savez_compressed(
                stream,
                **parts,
                truth_position=frames.jet.position,
                truth_radius=frames.jet.radius,
                truth_polymer_fraction=frames.jet.fraction,
                truth_mean_polymer_fraction=frames.jet.mean_fraction,
                truth_transmission=frames.transmission,
            )
    else:
        import tifffile

        for key, stack in parts.items():
            made = io.BytesIO()  # tifffile wants a file that the system knows, or memory
            tifffile.imwrite(made, stack.astype(np.uint16) if stack.max() < 65536 else stack, photometric="minisblack")
            with streaming(names[key], force=force) as stream:
                stream.write(made.getbuffer())
    write_text(toml, images_text(frames.camera, result, names), force=force)
    return (*dict.fromkeys(names.values()), toml)


def images_text(camera: Camera, result: "xr.Dataset", names: dict[str, Path]) -> str:
    """The images file of simulated frames."""
    lines = ["title = " + _toml("Simulated: " + str(result.attrs.get("title", "")).replace("\n", " "))]
    lines += [f'{key} = "{path.name}"' for key, path in names.items()]
    lines += ["gain = 1.0", f'pixel_size = "{camera.pixel * 1e6:.9g} um"']
    if camera.harmonic:
        e, h = camera.energy_kev, camera.harmonic
        lines.append(f'spectrum = {{ "{e:.9g} keV" = {1.0 - h:.9g}, "{3 * e:.9g} keV" = {h:.9g} }}')
    else:
        lines.append(f'energy = "{camera.energy_kev:.9g} keV"')
    if not camera.coherent:
        lines.append("coherent = false")
    if camera.distance:
        lines += [f'propagation_distance = "{camera.distance * 1e2:.9g} cm"', 'method = "phase"']
    if camera.tail_share:
        lines += [f"tail_share = {camera.tail_share:.9g}", f'tail_length = "{camera.tail_length * 1e6:.9g} um"']
    if camera.tilt_out:
        lines.append(f'tilt_out = "{np.degrees(camera.tilt_out):.9g} deg"')
    if camera.depth != 1.0:
        lines.append(f"depth = {camera.depth:.9g}")
    if camera.bend:
        lines.append("flat_shape = 2")
    if camera.blur:
        lines.append(f'blur = "{camera.blur * 1e6:.9g} um"')
    solution = [f"{_key(key)} = {_toml(value)}" for key, value in _data(result)["solution"].items()]
    return "\n".join([*lines, "", "[solution]", *solution]) + "\n"


def _data(result: "xr.Dataset") -> dict[str, Any]:
    """The scene of a result as dictionaries, with what ``--set`` changed in it."""
    from spinline.base.text import parsed_toml
    from spinline.scene.file import apply_override

    text = str(result.attrs.get("scene", ""))
    if not text:
        raise InputError("result", "does not hold its scene", remedy="give a result of spinline run")
    data = parsed_toml(text, "result", "scene")
    for line in text.splitlines():
        if line.startswith("# --set "):
            apply_override(data, line.removeprefix("# --set "))
    return data


def _scene(result: "xr.Dataset") -> "Scene":
    from spinline.scene.file import scene_from_dict

    return scene_from_dict(_data(result))


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(key)} = {_toml(one)}" for key, one in value.items()) + " }"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return str(value).lower() if isinstance(value, bool) else repr(value)


def _key(name: str) -> str:
    return name if name.replace("_", "").replace("-", "").isalnum() and name.isascii() else _toml(name)


def _stream(seed: int, index: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))


_FEWEST_ACROSS = 6  # of a jet: a radius under 3 pixels, which `plan_exposure` refuses


def _check(camera: Camera) -> None:
    for name in ("energy_kev", "pixel", "photons"):
        positive(name, getattr(camera, name))
    for name in ("distance", "blur", "motion", "drift", "flat_structure", "dark", "veil"):
        number(name, getattr(camera, name), least=0.0, below=1.0 if name in ("drift", "flat_structure") else 1e9)
    number("tail_share", camera.tail_share, least=0.0, below=0.8)
    number("tail_length", camera.tail_length, least=0.0, unit="m")
    for name in ("tilt", "tilt_out"):
        number(name, getattr(camera, name), least=-STEEPEST, most=STEEPEST, unit="rad")
    if camera.pixels is not None:
        number("pixels", camera.pixels, least=4)
    number("depth", camera.depth, least=0.5, most=2.0)
    number("bend", camera.bend, least=-0.5, most=0.5)
    number("harmonic", camera.harmonic, least=0.0, below=1.0)
    for name, least in (("frames", 1), ("reference_frames", 1), ("seed", 0)):
        value = getattr(camera, name)
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            raise InputError(name, "is not a whole number", value=value, allowed=f"at least {least}")
