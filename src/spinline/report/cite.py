"""What a result rests on, as BibTeX: the papers of the models that it says it used.

Read off the result's own attributes and variables; the entries are in ``data/references``.
"""

import re
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from spinline.base.errors import InputError

__all__ = ["bibtex", "cited", "described_by"]

_ALWAYS = ("spinline", "lauricella2020")
# attribute, text in it (none: that it is there), references
_SAID = (
    ("crossover_extension_criterion", "", ("greenfeld2011",)),
    ("k_estimate", "Eq. (31)", ("reznik2010", "greenfeld2012")),
    ("jet", "PowerLaw", ("greenfeld2012",)),
    ("jet", "StraightEhdJet", ("feng2002", "feng2003", "hohman2001")),
    ("jet", "JETSPIN", ("lauricella2015",)),
    ("jet_attributes", "JETSPIN", ("lauricella2015",)),
    ("source", "JETSPIN", ("lauricella2015",)),
    ("model", "Lagrangian chain", ("reneker2000", "yarin2001")),
    ("evaporation", "", ("yarin2001", "fuller1966")),
    ("evaporation", "chi", ("flory1942",)),
    ("evaporation", "kase-matsuo", ("kase1965",)),
    ("evaporation", "churchill-bernstein", ("churchill1977",)),
    ("air", "kase-matsuo", ("kase1965",)),
    ("concentration_laws", "Eq. (45)", ("yarin2001",)),
    ("concentration_laws", "WLF", ("williams1955",)),
    ("frozen_structure", "Fox", ("fox1956",)),
    ("constitutive_model", "FENEP", ("bird1980",)),
    ("constitutive_model", "Giesekus", ("giesekus1982",)),
    ("constitutive_model", "Rolie", ("likhtman2003", "greenfeld2013")),
    ("attenuation_source", "", ("greenfeld2012",)),
    ("attenuation_source", "xraylib", ("schoonjans2011",)),
    ("sampler", "emcee", ("foremanmackey2013",)),
    ("chi_squared", "", ("greenfeld2011",)),
)
_HELD = (  # variable, references
    ("entanglements_left", ("likhtman2003", "greenfeld2013")),
    ("permeability", ("davies1952",)),
    ("sobol_first", ("saltelli2010",)),
)


def cited(attributes: Mapping[str, Any], variables: frozenset[str] = frozenset()) -> list[str]:
    """Keys of the references of a result.

    Parameters
    ----------
    attributes : mapping
        Of the result.
    variables : frozenset of str
        Names of its variables.

    Returns
    -------
    list of str
        This program and the review first, the others in the order of the models.
    """
    found = list(_ALWAYS)
    for name, text, keys in _SAID:
        said = str(attributes.get(name, ""))
        if said and not said.startswith("off") and text in said:
            found += keys
    for name, keys in _HELD:
        if name in variables:
            found += keys
    return list(dict.fromkeys(found))


def bibtex(keys: list[str]) -> str:
    """Entries of these keys, as a ``.bib`` file has them."""
    from spinline.base.version import __version__

    text = resources.files("spinline").joinpath("data", "references", "references.bib").read_text("utf-8")
    entries = {re.match(r"@\w+\{(\w+),", entry)[1]: entry for entry in text.strip().split("\n\n")}  # type: ignore[index]
    return "\n\n".join(entries[key] for key in keys).replace("@version@", __version__)


def described_by(path: str | Path) -> tuple[dict[str, Any], frozenset[str]]:
    """Attributes and names of the variables of any file that the program writes.

    Raises
    ------
    InputError
        For what is no such file.
    """
    place = Path(path)
    if place.is_dir():
        from spinline.study.store import open_sweep

        found = open_sweep(place)
    elif place.suffix == ".h5":
        from spinline.deposit.fibres import FibreFile

        with FibreFile(place) as file:
            return dict(file.attributes), frozenset()
    else:
        from spinline.base.netcdf import open_dataset

        found = open_dataset(place)
    attributes, variables = (
        {str(key): value for key, value in found.attrs.items()},
        frozenset(map(str, found.variables)),
    )
    if not {"spinline_version", "spinline", "voxel_m"} & set(attributes):
        raise InputError(str(path), "is not a result of spinline", remedy="make one with `spinline run`")
    return attributes, variables
