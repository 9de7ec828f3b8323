"""Atoms of the solvents: what molar masses and diffusion volumes follow from."""

from collections.abc import Mapping

__all__ = ["ELEMENTS", "VAPOURS"]

ELEMENTS = ("C", "H", "O", "N", "Cl", "F", "S")
# name: atoms of these elements, and rings
VAPOURS: Mapping[str, tuple[int, int, int, int, int, int, int, int]] = {
    "water": (0, 2, 1, 0, 0, 0, 0, 0),
    "ethanol": (2, 6, 1, 0, 0, 0, 0, 0),
    "acetone": (3, 6, 1, 0, 0, 0, 0, 0),
    "DMF": (3, 7, 1, 1, 0, 0, 0, 0),
    "DCM": (1, 2, 0, 0, 2, 0, 0, 0),
    "chloroform": (1, 1, 0, 0, 3, 0, 0, 0),
    "THF": (4, 8, 1, 0, 0, 0, 0, 1),
    "formic acid": (1, 2, 2, 0, 0, 0, 0, 0),
    "HFIP": (3, 2, 1, 0, 0, 6, 0, 0),
    "DMSO": (2, 6, 1, 0, 0, 0, 1, 0),
    "DMAc": (4, 9, 1, 1, 0, 0, 0, 0),
    "acetic acid": (2, 4, 2, 0, 0, 0, 0, 0),
    "TFA": (2, 1, 2, 0, 0, 3, 0, 0),
    "NMP": (5, 9, 1, 1, 0, 0, 0, 1),
    "toluene": (7, 8, 0, 0, 0, 0, 0, 1),
    "methanol": (1, 4, 1, 0, 0, 0, 0, 0),
    "isopropanol": (3, 8, 1, 0, 0, 0, 0, 0),
    "ethyl acetate": (4, 8, 2, 0, 0, 0, 0, 0),
    "DCE": (2, 4, 0, 0, 2, 0, 0, 0),
    "MEK": (4, 8, 1, 0, 0, 0, 0, 0),
    "acetonitrile": (2, 3, 0, 1, 0, 0, 0, 0),
    "dioxane": (4, 8, 2, 0, 0, 0, 0, 1),
    "chlorobenzene": (6, 5, 0, 0, 1, 0, 0, 1),
    "TFE": (2, 3, 1, 0, 0, 3, 0, 0),
}
