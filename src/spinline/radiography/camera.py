"""The camera of simulated frames: beam, detector and frames as data, read by the command line as its options."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from spinline.xray.matter.spectrum import Spectrum

__all__ = ["Camera"]


def _of(default: Any, kind: str, words: str, option: str = "") -> Any:
    """A field of the camera: how it is asked for on the command line (`cli.simulate` reads it there)."""
    return field(default=default, metadata={"kind": kind, "help": words, "option": option})


@dataclass(frozen=True)
class Camera:
    """Beam, detector and frames; each field is an option of ``spinline simulate-image``. SI, angles in rad.

    Attributes
    ----------
    energy_kev : float
    pixel : float
        m, in the plane of the jet.
    photons : float
        Per pixel and frame without a jet.
    frames, reference_frames : int
        Of the jet, and of flat and of dark each.
    pixels : int or None
        Of a row; None: one and a half times what the jet takes.
    distance : float
        From jet to detector, m; 0: no fringes.
    blur, motion : float
        m: Gaussian blur; way along the jet during an exposure.
    tail_share, tail_length : float
        Share of the light in the far tail of the point spread (glare), and the tail's length, m.
    axis, tilt, tilt_out : float
        Position of the axis from the middle (m), tilt in the image and out of it (rad).
    depth : float
        Of the section along the beam over its width.
    drift, slope, bend : float
        Standard deviation of the beam's level from frame to frame; its slope across the row, and its bend since the flat.
    flat_structure : float
        Standard deviation of the flat field's fixed pattern.
    dark : float
        Dark counts per pixel and frame.
    veil : float
        Stray light as a share of the flat.
    harmonic : float
        Share of the third harmonic in the signal.
    coherent : bool
        Total attenuation, or that without coherent scatter.
    seed : int
    """

    energy_kev: float = _of(10.0, "energy", "Photon energy.", "--energy")
    pixel: float = _of(0.67e-6, "length", "Size of a pixel in the plane of the jet.")
    photons: float = _of(1e4, "number", "Per pixel and frame, without a jet.")
    frames: int = _of(10, "count", "Frames of the jet.")
    reference_frames: int = _of(15, "count", "Flat frames, and dark frames.")
    pixels: int | None = _of(None, "count", "Pixels of a row.", "--width")
    distance: float = _of(0.0, "length", "From jet to detector; over 0: with Fresnel fringes.")
    blur: float = _of(0.0, "length", "Standard deviation of the detector's blur.")
    motion: float = _of(0.0, "length", "Way along the jet during an exposure.")
    tail_share: float = _of(0.0, "number", "Glare: share of the light in the detector's far tail.")
    tail_length: float = _of(0.0, "length", "Its length.")
    axis: float = _of(0.0, "length", "Position of the axis from the middle.")
    tilt: float = _of(0.0, "degrees", "Tilt in the image, degrees.")
    tilt_out: float = _of(0.0, "degrees", "Tilt out of the image, degrees.")
    depth: float = _of(1.0, "number", "Of the section along the beam over its width.")
    drift: float = _of(0.0, "number", "Beam level, standard deviation from frame to frame.")
    slope: float = _of(0.0, "number", "Beam slope from the middle of a row to its end.")
    bend: float = _of(0.0, "number", "Bend of the beam since the flat: coefficient of P2.")
    flat_structure: float = _of(0.0, "number", "Fixed pattern of the flat, standard deviation.")
    dark: float = _of(0.0, "number", "Dark counts per pixel and frame.")
    veil: float = _of(0.0, "number", "Stray light, share of the flat.")
    harmonic: float = _of(0.0, "number", "Share of the third harmonic in the signal.")
    coherent: bool = field(default=True, metadata={})
    seed: int = _of(0, "count", "Of the noise.")

    @property
    def beam(self) -> "float | Spectrum":
        """Energy, or the lines where there is a harmonic."""
        from spinline.xray.matter.spectrum import harmonic_spectrum

        return harmonic_spectrum(self.energy_kev, {3: self.harmonic}) if self.harmonic else self.energy_kev
