"""Other names of polymers and solvents: what people write for what the library has."""

import re
from collections.abc import Mapping

__all__ = ["ALIASES", "known_as"]

# as written, in lower case without hyphens, blanks, commas, brackets: name in the library
ALIASES: Mapping[str, str] = {
    # polymers
    "peg": "PEO",
    "polyethyleneoxide": "PEO",
    "polyethyleneglycol": "PEO",
    "polyoxyethylene": "PEO",
    "polymethylmethacrylate": "PMMA",
    "polycaprolactone": "PCL",
    "polyecaprolactone": "PCL",
    "polyεcaprolactone": "PCL",
    "polyɛcaprolactone": "PCL",
    "polyepsiloncaprolactone": "PCL",
    "polyvinylpyrrolidone": "PVP",
    "polynvinylpyrrolidone": "PVP",
    "polynvinyl2pyrrolidone": "PVP",
    "polyvinylpyrrolidinone": "PVP",
    "povidone": "PVP",
    "polyacrylonitrile": "PAN",
    "polystyrene": "PS",
    "polyvinylalcohol": "PVA",
    "pvoh": "PVA",
    "pval": "PVA",
    "polylacticacid": "PLA",
    "polylactide": "PLA",
    "plla": "PLA",
    "polyllactide": "PLA",
    "polyllacticacid": "PLA",
    "polyvinylidenefluoride": "PVDF",
    "polyvinylidenedifluoride": "PVDF",
    "nylon6": "nylon 6",
    "pa6": "nylon 6",
    "polyamide6": "nylon 6",
    "polycaprolactam": "nylon 6",
    "polyethyleneterephthalate": "PET",
    "celluloseacetate": "cellulose acetate",
    "ca": "cellulose acetate",
    "polyvinylbutyral": "PVB",
    "gelatine": "gelatin",
    # solvents
    "h2o": "water",
    "diwater": "water",
    "distilledwater": "water",
    "deionizedwater": "water",
    "deionisedwater": "water",
    "demineralizedwater": "water",
    "demineralisedwater": "water",
    "ultrapurewater": "water",
    "purewater": "water",
    "purifiedwater": "water",
    "milliqwater": "water",
    "milliq": "water",
    "ethylalcohol": "ethanol",
    "etoh": "ethanol",
    "c2h5oh": "ethanol",
    "absoluteethanol": "ethanol",
    "anhydrousethanol": "ethanol",
    "propanone": "acetone",
    "2propanone": "acetone",
    "dimethylketone": "acetone",
    "dimethylformamide": "DMF",
    "nndimethylformamide": "DMF",
    "dichloromethane": "DCM",
    "methylenechloride": "DCM",
    "methylenedichloride": "DCM",
    "ch2cl2": "DCM",
    "trichloromethane": "chloroform",
    "chcl3": "chloroform",
    "tetrahydrofuran": "THF",
    "oxolane": "THF",
    "methanoicacid": "formic acid",
    "formicacid": "formic acid",
    "hcooh": "formic acid",
    "hexafluoroisopropanol": "HFIP",
    "hexafluoroisopropylalcohol": "HFIP",
    "hexafluoro2propanol": "HFIP",
    "111333hexafluoroisopropanol": "HFIP",
    "111333hexafluoropropan2ol": "HFIP",
    "111333hexafluoro2propanol": "HFIP",
    "hfp": "HFIP",
    "dimethylsulfoxide": "DMSO",
    "dimethylsulphoxide": "DMSO",
    "dimethylacetamide": "DMAc",
    "nndimethylacetamide": "DMAc",
    "dma": "DMAc",
    "ethanoicacid": "acetic acid",
    "aceticacid": "acetic acid",
    "glacialaceticacid": "acetic acid",
    "ch3cooh": "acetic acid",
    "acoh": "acetic acid",
    "trifluoroaceticacid": "TFA",
    "nmethyl2pyrrolidone": "NMP",
    "nmethyl2pyrrolidinone": "NMP",
    "1methyl2pyrrolidone": "NMP",
    "1methyl2pyrrolidinone": "NMP",
    "nmethylpyrrolidone": "NMP",
    "methylbenzene": "toluene",
    "meoh": "methanol",
    "methylalcohol": "methanol",
    "ipa": "isopropanol",
    "2propanol": "isopropanol",
    "propan2ol": "isopropanol",
    "isopropylalcohol": "isopropanol",
    "etoac": "ethyl acetate",
    "ethylethanoate": "ethyl acetate",
    "dichloroethane": "DCE",
    "12dichloroethane": "DCE",
    "ethylenedichloride": "DCE",
    "butanone": "MEK",
    "2butanone": "MEK",
    "methylethylketone": "MEK",
    "acn": "acetonitrile",
    "mecn": "acetonitrile",
    "14dioxane": "dioxane",
    "trifluoroethanol": "TFE",
    "222trifluoroethanol": "TFE",
}
_TWICE = re.compile(r"(.*\S)\s*\(([^()]+)\)")
_LEFT_OUT = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789", "-–‐‑ _,()'\u2019\u2032\u00a0[].")


def known_as(name: str, table: Mapping[str, object]) -> str | None:
    """The key of a table that a name stands for: the key itself in any case, or an alias; None where there is none.

    Examples
    --------
    >>> known_as("N,N-dimethylformamide", {"DMF": 1}), known_as("poly(ethylene oxide) (PEO)", {"PEO": 1})
    ('DMF', 'PEO')
    """
    plain = name.strip().lower()
    by_lower = {key.lower(): key for key in table}
    if plain in by_lower:
        return by_lower[plain]
    short = plain.translate(_LEFT_OUT)
    for key in (short, ALIASES.get(short, "").lower()):
        for known in table:
            if key and known.lower().translate(_LEFT_OUT) == key.translate(_LEFT_OUT):
                return known
    twice = _TWICE.fullmatch(plain)
    if twice is not None:  # "polyacrylonitrile (PAN)": both, and of the same
        names = {known_as(part, table) for part in twice.groups()}
        return names.pop() if len(names) == 1 else None
    return None
