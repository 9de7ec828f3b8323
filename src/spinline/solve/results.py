"""Results: named, with units, stored as netCDF that says how to make it again."""

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.errors import InputError
from spinline.base.files import write_text
from spinline.base.named_arrays import NamedArrays
from spinline.base.netcdf import open_dataset, save_dataset, write_variables
from spinline.solve.summary import SUMMARISED

if TYPE_CHECKING:
    import xarray as xr

    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.jetprofile.straight import StraightJet

__all__ = [
    "VARIABLES",
    "assemble",
    "described",
    "open_dataset",
    "open_result",
    "plain",
    "save",
    "scalars",
    "to_csv",
    "to_json",
    "with_bands",
    "with_numbers",
]

# name: (unit, what it is)
VARIABLES: dict[str, tuple[str, str]] = {
    "z": ("m", "distance from the nozzle"),
    "arc_length": ("m", "arc length from the nozzle"),
    "radius": ("m", "jet radius"),
    "velocity": ("m s-1", "jet velocity"),
    "velocity_ratio": ("1", "velocity over initial velocity V (bead jets: material stretch)"),
    "strain_rate": ("s-1", "strain rate"),
    "residence_time": ("s", "time since the nozzle"),
    "stretch_ratio": ("1", "material stretch since the nozzle"),
    "tension": ("N", "viscoelastic force along the jet"),
    "tensile_stress": ("Pa", "first normal stress difference of the solution"),
    "line_charge": ("C m-1", "free charge per length of the jet"),
    "conduction_share": ("1", "share of the current that is conducted"),
    "current": ("A", "electric current of the jet"),
    "air_velocity": ("m s-1", "mean velocity of the air on the axis"),
    "axial_stress": ("Pa", "axial stress of the jet, capillarity and solvent with it"),
    "wave_speed_squared": (
        "m2 s-2",
        "square of the speed of bending waves; below 0 bends grow as fast as they are short",
    ),
    "bending_start": ("m", "first place where bending waves can travel; NaN where none on the straight part"),
    "force_balance": ("1", "what the integrated momentum leaves over, of the largest force"),
    "bending_onset": ("m", "where bending waves have grown a hundredfold; NaN where not within the jet"),
    "bending_onset_early": ("m", "where they have grown tenfold"),
    "bending_onset_late": ("m", "where they have grown a thousandfold"),
    "mean_polymer_fraction": ("1", "polymer volume fraction, mean of the cross-section"),
    "network_velocity_ratio": ("1", "network velocity over initial velocity w"),
    "strand_stretch": ("1", "stretch of the strands lam: w, less what they have relaxed"),
    "flux_velocity_ratio": (
        "1",
        "velocity over initial velocity at which core_polymer_fraction_conservative carries the polymer",
    ),
    "entanglements_left": ("1", "part of the entanglements that is left, nu"),
    "axial_stretch": ("1", "axial stretch of the strands xi_par / xi_0"),
    "relative_extension": ("1", "extension of the strands over their contour xi_par / xi_max"),
    "radial_contraction": ("1", "radial contraction of the strands xi_perp / xi_0"),
    "orientation": ("1", "Hermans orientation of the segments"),
    "network_radius": ("m", "radius of the polymer network, Eq. (39)"),
    "network_radius_conservative": ("m", "radius of the polymer network that conserves the polymer flux"),
    "core_polymer_fraction": ("1", "polymer volume fraction of the core, exact walk, held at 1"),
    "core_polymer_fraction_eq40": ("1", "polymer volume fraction of the core, Eq. (40) as printed, held at 1"),
    "core_polymer_fraction_conservative": ("1", "polymer volume fraction of the core, flux conserved, held at 1"),
    "strand_force": ("N", "force at the ends of a strand; NaN where the contour is reached"),
    "compacted": ("", "core_polymer_fraction is held at 1"),
    "compacted_eq40": ("", "core_polymer_fraction_eq40 is held at 1"),
    "compacted_conservative": ("", "core_polymer_fraction_conservative is held at 1"),
    "flux_exceeded": ("", "a compacted network would be wider than the jet: no steady network"),
    "contour_reached": ("", "the closure asks for more than the contour; the strand is held at it"),
    "axial_stretch_std_error": ("1", "standard error of axial_stretch"),
    "radial_contraction_std_error": ("1", "standard error of radial_contraction"),
    "orientation_std_error": ("1", "standard error of orientation"),
    "slip_velocity": ("m s-1", "velocity of the solution past the network"),
    "drag_force": ("N", "drag of the solution on one bead of the network"),
    "lateral_network_radius": ("m", "radius of the network by Eq. (32b) in motion"),
    "lateral_polymer_fraction": ("1", "polymer volume fraction of the layers of that network, not held at 1"),
    "layer": ("1", "radius of a layer of the network at rest, over the initial radius"),
    "scission": ("", "strand_force is beyond what a covalent bond holds, 5 nN"),
    "volume_fraction": ("1", "polymer volume fraction of the solution"),
    "far_end_effect": (
        "1",
        "relative difference of the two marches from beyond the far end, at the station that moves most",
    ),
    "lateral_time": (
        "1",
        "time that the network has to contract F = c k_B T t/(xi_eff mu r_0^2), at the crossover or the end",
    ),
    "crossover_position": ("m", "where the network is fully stretched, Eq. (38)"),
    "crossover_radius": ("m", "jet radius where the network is fully stretched, Eq. (38)"),
    "crossover_radius_ratio": ("1", "the same over the initial radius"),
    "crossover_velocity_ratio": ("1", "velocity ratio of full stretch, Eq. (38)"),
    "crossover_extension_position": ("m", "where the extension passes the criterion"),
    "crossover_extension_radius": ("m", "jet radius where the extension passes the criterion"),
    "crossover_extension_radius_ratio": ("1", "the same over the initial radius"),
    "crossover_extension_velocity_ratio": ("1", "velocity ratio where the extension passes the criterion"),
    "evaporated_fraction": ("1", "volume lost by evaporation over the volume at the nozzle"),
    "reynolds_number": ("1", "Reynolds number of the air at the jet"),
    "sherwood_number": ("1", "Sherwood number of the (first) solvent"),
    "viscosity": ("Pa s", "zero-shear viscosity at the mean polymer fraction"),
    "relaxation_time": ("s", "relaxation time theta at the mean polymer fraction"),
    "weissenberg_number": ("1", "theta times the strain rate, theta at the mean polymer fraction"),
    "deborah_number": ("1", "theta of the solution at the nozzle times the strain rate"),
    "stress": ("Pa", "axial extra stress of the polymer; NaN where it is glass"),
    "radial_stress": ("Pa", "radial extra stress of the polymer; NaN where it is glass"),
    "tensile_force": ("N", "force of the polymer's stress on the cross-section; NaN where it is glass"),
    "frozen": ("", "the section is glass on average: the network changes no more"),
    "polymer_fraction": (
        "1",
        "polymer volume fraction across the jet: skin of drying and core of the contracted network",
    ),
    "drying_polymer_fraction": ("1", "polymer volume fraction across the jet by drying alone"),
    "surface_polymer_fraction": ("1", "polymer volume fraction at the surface by drying alone"),
    "axis_polymer_fraction": ("1", "polymer volume fraction on the axis by drying alone"),
    "skin_thickness": ("m", "thickness of the skin, see the attribute skin_criterion"),
    "drying_peclet": ("1", "evaporation against diffusion in the jet, D_a Sh C_sat/(2 D)"),
    "drying_biot": ("1", "resistance of the surface: drying_peclet times the slope of the activity"),
    "fourier_number": ("1", "time for diffusion across the jet, integral of D/r^2"),
    "r": ("1", "distance from the axis over the jet radius"),
    "vitrification_fraction": ("1", "polymer volume fraction that turns to glass"),
    **{
        f"{name}_{key}": (unit, f"{words} {what}")
        for name, what in (
            ("frozen", "where the mean of the section turns to glass"),
            ("skin", "where the surface turns to glass"),
            ("core", "where the axis turns to glass"),
        )
        for key, unit, words in (
            ("position", "m", "position"),
            ("time", "s", "time since the nozzle"),
            ("radius", "m", "jet radius"),
            ("stretch", "1", "stretch w of the strands"),
            ("extension", "1", "extension of the strands over their contour"),
            ("orientation", "1", "Hermans orientation"),
            ("relaxed", "1", "part of the affine stretch that has relaxed"),
        )
    },
    "fibre_radius": (
        "m",
        "radius of the dry fibre: of the section that became solid, or of the last, were it stretched no more",
    ),
    "fibre_diameter": ("m", "diameter of the dry fibre, twice fibre_radius"),
    "temperature": ("K", "temperature of the jet, uniform across it"),
    "water_fraction": ("1", "volume fraction of water that the jet took from the air"),
    "arrest_position": ("m", "where the jet becomes solid: glass or crystals"),
    "arrest_fraction": ("1", "polymer volume fraction there"),
    "arrest_temperature": ("K", "temperature there"),
    "arrest_slip": (
        "1",
        "velocity of the network over that of the jet there, at least arrest_fraction: a section holds no more than itself",
    ),
    "crystallinity": ("1", "degree of crystallinity at the end of the jet"),
    "x": ("m", "position along the spinning axis"),
    "y": ("m", "position across the spinning axis"),
    "time": ("s", "time"),
}


for _where, _words in (("crossover", "where full stretch is reached"), ("end", "at the end of the jet")):
    VARIABLES |= {
        f"{_where}_{_name}": (VARIABLES[_name][0], f"{VARIABLES[_name][1]}, {_words}") for _name in SUMMARISED
    }


def described(name: str) -> tuple[str, str]:
    """Unit of a variable of a result, and what it is; of ``<name>_std`` and ``<name>_band`` too."""
    if name.endswith("_band"):
        stem = name.removesuffix("_band")
        unit, words = (
            VARIABLES[stem]
            if stem in VARIABLES
            else ("1", f"{VARIABLES[stem.removesuffix('_ratio')][1]}, over that at the nozzle")
        )
        return unit, f"quantiles over the inputs' uncertainty: {words}"
    if name not in VARIABLES and name.endswith("_std"):
        unit, words = VARIABLES[name.removesuffix("_std")]
        return unit, f"standard uncertainty, from the inputs': {words}"
    return VARIABLES[name]


_ACROSS = ("r", "layer")  # dimensions across the jet
_LAYERED = {"lateral_polymer_fraction": "layer"}  # variables that are not along r


def assemble(
    fields: dict[str, Any], numbers: dict[str, Any], attributes: dict[str, Any], jet: "StraightJet | LagrangianJet"
) -> NamedArrays:
    """Result of a run: fields along the jet, numbers, attributes.

    Parameters
    ----------
    fields : dict
        Variable name to array along the jet, and across it (``r``, ``layer``) as the last dimension.
    numbers : dict
        Variable name to number (or array along time).
    attributes : dict
        Of the result.
    jet : StraightJet or LagrangianJet
        Says which dimensions the fields have.

    Returns
    -------
    NamedArrays
    """
    time = getattr(jet, "time", None)
    lead = () if time is None else ("time",)
    beads = "arc_length" in fields
    coordinates: dict[str, Any] = {} if time is None else {"time": ("time", time, _units("time"))}
    along = (*lead, "element") if beads else ("z",)
    place = "arc_length" if beads else "z"
    coordinates[place] = (along, fields[place], _units(place))
    for across in _ACROSS:
        if across in fields:
            coordinates[across] = (across, fields[across], _units(across))
    data = {}
    for name, values in fields.items():
        if name not in (place, *_ACROSS):
            dims = (*lead, "bead") if beads and name in ("x", "y", "z") else along
            inwards = (_LAYERED.get(name, "r"),) if np.ndim(values) > len(dims) else ()
            data[name] = ((*dims, *inwards), values, _units(name, beads))
    data |= {
        name: ((), value, _units(name)) if np.ndim(value) == 0 else (lead, value, _units(name))
        for name, value in numbers.items()
    }
    return NamedArrays(data, coordinates, {key: _storable(value) for key, value in attributes.items()})


def with_numbers(result: NamedArrays, numbers: dict[str, Any]) -> NamedArrays:
    """The result with further numbers (or arrays along time)."""
    return result.assign(
        {
            name: ((), value, _units(name)) if np.ndim(value) == 0 else ("time", value, _units(name))
            for name, value in numbers.items()
        }
    )


def with_bands(result: NamedArrays, bands: dict[str, Any]) -> NamedArrays:
    """The result with bands from `spinline.solve.bands.banded`, along ``quantile`` (and the jet)."""
    if not bands:
        return result
    from spinline.solve.bands import LEVELS

    along = "element" if "element" in result.dims else "z"
    return result.assign_coords(quantile=list(LEVELS)).assign(
        {
            name: (("quantile",) if np.ndim(value) == 1 else ("quantile", along), value, _units(name))
            for name, value in bands.items()
        }
    )


def scalars(result: "xr.Dataset | NamedArrays") -> dict[str, float]:
    """The numbers of a result that have no dimension."""
    return {str(name): float(variable) for name, variable in result.data_vars.items() if variable.ndim == 0}


def save(result: "xr.Dataset | NamedArrays", path: str | Path, *, force: bool = False) -> Path:
    """Write a result as netCDF-4, whole or not at all.

    Parameters
    ----------
    result : xarray.Dataset
        From `spinline.run`.
    path : path
        File to write.
    force : bool
        Overwrite.

    Returns
    -------
    Path
    """
    if isinstance(result, NamedArrays):
        variables = {name: (one.dims, one.values, one.attrs) for name, one in result.variables.items()}
        return write_variables(variables, result.attrs, path, coordinates=result.coords, force=force)
    return save_dataset(result, path, force=force)


def open_result(path: str | Path) -> "xr.Dataset":
    """Read a result that `save` or ``spinline run`` wrote.

    Raises
    ------
    InputError
        If it is not one.
    """
    result = open_dataset(path)
    if "spinline_version" not in result.attrs or "volume_fraction" not in result:
        raise InputError(str(path), "is not a result of spinline", remedy="make one with `spinline run`")
    return result


def to_json(result: "xr.Dataset | NamedArrays", names: tuple[str, ...] = ()) -> str:
    """JSON text of a result: variables by name in SI, NaN as null, attributes under "attributes"."""
    picked = names or tuple(map(str, result.variables))
    data: dict[str, Any] = {name: plain(result[name].values) for name in picked}
    data["attributes"] = {str(key): plain(value) for key, value in result.attrs.items()}
    return json.dumps(data, allow_nan=False, ensure_ascii=False)


def to_csv(result: "xr.Dataset | NamedArrays", path: str | Path, *, force: bool = False) -> Path:
    """Write the profile as a table, one row per place (and time), units in the header; maps across the jet are left out."""
    place = "element" if "element" in result.dims else "z"
    result = _spread(result.dataset() if isinstance(result, NamedArrays) else result)
    along = [name for name in result.variables if place in result[name].dims and "r" not in result[name].dims]
    table = result[along].to_dataframe().reset_index()
    # an index that is only a count has no unit; everything else has
    units = {name: result[name].attrs.get("units", "") if name in result.variables else "" for name in table.columns}
    flags = {name: table[name].astype(int) for name in table.columns if table[name].dtype == bool}
    table = table.assign(**flags)
    table.columns = [f"{name} [{units[name]}]" if units[name] not in ("", "1") else str(name) for name in table.columns]
    return write_text(path, str(table.to_csv(None, index=False)), force=force)


def _spread(result: "xr.Dataset") -> "xr.Dataset":
    """Bands along the jet as variables of their own, ``radius_low95`` ..., for a table."""
    columns = {}
    for name, values in result.data_vars.items():
        if values.dims[:1] == ("quantile",) and values.ndim == 2:
            for i, side in ((0, "low95"), (1, "low68"), (3, "high68"), (4, "high95")):
                stem = str(name).removesuffix("_band")
                columns[f"{stem}_{side}"] = (values.dims[1], values.values[i], values.attrs)
    return result.drop_dims("quantile").assign(columns) if columns else result


def _units(name: str, beads: bool = False) -> dict[str, str]:
    unit, words = described(name)
    if name == "z" and beads:
        words = "position across the spinning axis"
    return {"units": unit, "long_name": words} if unit else {"long_name": words}


def _storable(value: Any) -> Any:
    return value if isinstance(value, str | int | float) and not isinstance(value, bool) else str(value)


def plain(value: Any) -> Any:
    """JSON-ready value: arrays as lists, NaN and inf as None."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
