"""What the files of the frames say of themselves: energy, size of a pixel, distance, where the images file does not."""

from spinline.base.constants import KEV
from spinline.base.errors import InputError
from spinline.base.units import Measured
from spinline.images.stacks import Stack
from spinline.scene.images_file import Images

__all__ = ["with_metadata"]

_KEYS = {"energy": (1.0 / KEV, "keV"), "pixel_size": (1e6, "um"), "propagation_distance": (1e2, "cm")}
_APART = 0.01  # of a number that is given and that the file says otherwise


def with_metadata(images: Images, stack: Stack) -> tuple[Images, list[str]]:
    """The images file with what it leaves out taken from the frames' own file, and remarks that say so.

    Raises
    ------
    InputError
        Where size of a pixel or energy is neither given nor in the file.
    """
    said: list[str] = []
    found = stack.account.metadata
    changes: dict[str, Measured] = {}
    attenuated = images.polymer_attenuation is not None
    for key, (scale, unit) in _KEYS.items():
        if key not in found:
            continue
        text = f"{found[key] * scale:.6g} {unit}"
        given = getattr(images, key)
        if given is not None:
            if abs(given.value - found[key]) > max(_APART * found[key], 2.0 * given.std):
                said.append(
                    f"{key} = {given.text} is given, {stack.account.source} says {text}: the given one is taken"
                )
            continue
        instead = {
            "energy": images.spectrum is not None or attenuated,
            "pixel_size": images.nozzle_diameter is not None,
        }
        if instead.get(key, images.method != "phase"):
            continue
        changes[key] = Measured(found[key], 0.0, text)
        said.append(f"{key} = {text} is taken from {stack.account.source}: give it if it is not so")
    one = images
    if changes:
        one = images.model_copy(update=changes)
        one._text, one._folder, one._name = images._text, images._folder, images._name
    if one.pixel_size is None and one.nozzle_diameter is None:
        raise InputError(
            "pixel_size",
            "is missing, and the file of the frames does not say it",
            remedy="give one of pixel_size and nozzle_diameter (with nozzle_rows)",
        )
    if not attenuated and one.energy is None and one.spectrum is None:
        raise InputError(
            "energy",
            "is missing, and the file of the frames does not say it",
            remedy="give one of energy and spectrum, or polymer_attenuation and solvent_attenuation",
        )
    return _at_the_jet(one), said


def _at_the_jet(images: Images) -> Images:
    """The images file with its distance as a parallel beam would need for the same fringes: over the magnification."""
    if images.magnification == 1.0 or images.propagation_distance is None:
        return images
    d, m = images.propagation_distance, images.magnification
    scaled = Measured(d.value / m, d.std / m, f"{d.text} over a magnification of {m:g}")
    one = images.model_copy(update={"propagation_distance": scaled})
    one._text, one._folder, one._name = images._text, images._folder, images._name
    return one
