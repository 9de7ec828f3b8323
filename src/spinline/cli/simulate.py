"""The command that makes X-ray frames of a computed jet."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spinline.base.constants import KEV
from spinline.base.errors import InputError
from spinline.cli.speech import say

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["register", "simulate_image"]

Text = str | None


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("simulate-image")(simulate_image)


def simulate_image(
    source: Annotated[
        str, typer.Argument(metavar="SOURCE", help="Result of run (.nc), a scene file, or a bundled scene's name.")
    ],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Frames, .npz or .tif. Default: SOURCE's name with .npz.")
    ] = None,
    energy: Annotated[str, typer.Option(help="Photon energy.")] = "10 keV",
    photons: Annotated[float, typer.Option(help="Per pixel and frame, without a jet.")] = 1e4,
    frames: Annotated[int, typer.Option(help="Frames of the jet.")] = 10,
    pixel: Annotated[str, typer.Option(help="Size of a pixel in the plane of the jet.")] = "0.67 um",
    z_from: Annotated[Text, typer.Option("--from", help='Field of view along the jet, "0.1 mm".')] = None,
    z_to: Annotated[Text, typer.Option("--to", help='Its end, "0.4 mm".')] = None,
    width: Annotated[int | None, typer.Option(help="Pixels of a row.")] = None,
    distance: Annotated[str, typer.Option(help="From jet to detector; over 0: with Fresnel fringes.")] = "0 cm",
    blur: Annotated[str, typer.Option(help="Standard deviation of the detector's blur.")] = "0 um",
    motion: Annotated[str, typer.Option(help="Way along the jet during an exposure.")] = "0 um",
    axis: Annotated[str, typer.Option(help="Position of the axis from the middle.")] = "0 um",
    tilt: Annotated[float, typer.Option(help="Tilt in the image, degrees.")] = 0.0,
    tilt_out: Annotated[float, typer.Option(help="Tilt out of the image, degrees.")] = 0.0,
    drift: Annotated[float, typer.Option(help="Beam level, standard deviation from frame to frame.")] = 0.0,
    slope: Annotated[float, typer.Option(help="Beam slope from the middle of a row to its end.")] = 0.0,
    flat_structure: Annotated[float, typer.Option(help="Fixed pattern of the flat, standard deviation.")] = 0.0,
    dark: Annotated[float, typer.Option(help="Dark counts per pixel and frame.")] = 0.0,
    veil: Annotated[float, typer.Option(help="Stray light, share of the flat.")] = 0.0,
    harmonic: Annotated[float, typer.Option(help="Share of the third harmonic in the signal.")] = 0.0,
    reference_frames: Annotated[int, typer.Option(help="Flat frames, and dark frames.")] = 15,
    seed: Annotated[int, typer.Option(help="Of the noise.")] = 0,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files.")] = False,
) -> None:
    """X-ray frames of a computed jet, with the images file that reduces them."""
    import numpy as np

    from spinline.base.files import writable
    from spinline.base.units import parse
    from spinline.images.simulate import Camera, simulate, write_frames

    def length(text: str, option: str) -> float:
        return parse(text, "length", option).value

    target = out or Path(Path(source).name).with_suffix(".npz")
    if Path(target).suffix.lower() not in (".npz", ".tif", ".tiff"):
        raise InputError("--out", "is neither .npz nor .tif", value=str(target), remedy="name it frames.npz")
    for file in (target, target.with_suffix(".toml")):
        writable(file, force=force)
    camera = Camera(
        energy_kev=parse(energy, "energy", "--energy").value / KEV,
        pixel=length(pixel, "--pixel"),
        photons=photons,
        frames=frames,
        reference_frames=reference_frames,
        pixels=width,
        distance=length(distance, "--distance"),
        blur=length(blur, "--blur"),
        motion=length(motion, "--motion"),
        axis=length(axis, "--axis"),
        tilt=float(np.deg2rad(tilt)),
        tilt_out=float(np.deg2rad(tilt_out)),
        drift=drift,
        slope=slope,
        flat_structure=flat_structure,
        dark=dark,
        veil=veil,
        harmonic=harmonic,
        seed=seed,
    )
    result = _result(source)
    made = simulate(
        result, camera,
        start=None if z_from is None else length(z_from, "--from"),
        stop=None if z_to is None else length(z_to, "--to"),
    )  # fmt: skip
    files = write_frames(made, result, target, force=force)
    _, rows, pixels = made.counts.shape
    say(
        f"{made.counts.shape[0]} frames of {rows} x {pixels} pixels; darkest {100 * (1 - made.transmission.min()):.3g} % "
        f"under the beam, mean polymer fraction {made.jet.mean_fraction.min():.4g} to {made.jet.mean_fraction.max():.4g}"
    )
    say("wrote " + ", ".join(map(str, files)))


def _result(source: str) -> "xr.Dataset":
    """A result from its file, or by running a scene."""
    if Path(source).suffix == ".nc":
        from spinline.solve.results import open_result

        return open_result(source)
    from spinline.scene.file import load_scene
    from spinline.solve.spine import run

    return run(load_scene(source))
