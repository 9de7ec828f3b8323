"""What a reduction is written as: a Dataset of named variables with units, and of attributes that say how to make it again."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.files import write_text
from spinline.images.geometry import out_of_plane
from spinline.radiography.balance import unbalanced
from spinline.radiography.experiment import Experiment
from spinline.radiography.looks import FRINGES
from spinline.radiography.methods import METHODS
from spinline.xray.frame.blocks import FRAME_FLAGS, FrameFit
from spinline.xray.row.chords import shell_weights

__all__ = ["REDUCTION_VARIABLES", "UNIDENTIFIABLE", "assemble", "lines", "plausible", "to_csv"]

UNIDENTIFIABLE = (
    "One view cannot tell an elliptic section (depth 1 % over width: -0.04 in the fraction at 10 keV, R = 50 um), a tilt along "
    "the beam (4 degrees: -0.009; give tilt_out and depth with their errors) nor a fraction that depends on the azimuth from a "
    "round, axisymmetric, upright jet. A detector that is not linear (1 % at the flat's level: 0.04; give linearity) looks "
    "like polymer too. Absorption alone cannot tell a change of density "
    "(0.2 %: 0.008) nor evaporated solvent from one of the polymer fraction."
)

_BAD = 4.0  # misfit of a block whose errors are widened
_TOO_QUIET = -4.0  # median misfit, standard deviations

# name: (unit, what it is)
REDUCTION_VARIABLES: dict[str, tuple[str, str]] = {
    "row": ("1", "row of the frame, middle of the block"),
    "z": ("m", "distance along the jet from the frame's first edge"),
    "relative_radius": ("1", "r/R at the middle of the shell (chord: |x|/R)"),
    "relative_radius_bounds": ("1", "r/R of the shell's edges"),
    "polymer_fraction": ("1", "polymer volume fraction of the shell (chord: mean along chords)"),
    "polymer_fraction_std": ("1", "its standard deviation, calibration included"),
    "polymer_fraction_covariance": ("1", "covariance of the shells of a block, calibration included"),
    "polymer_mass_fraction": ("1", "polymer mass fraction of the shell"),
    "polymer_mass_fraction_std": ("1", "its standard deviation"),
    "polymer_concentration": ("kg m-3", "polymer mass per volume of the shell; 1000 kg m-3 = 1 g/cm3"),
    "polymer_concentration_std": ("kg m-3", "its standard deviation"),
    "mean_polymer_fraction": ("1", "polymer volume fraction, mean of the cross-section"),
    "mean_polymer_fraction_std": ("1", "its standard deviation, calibration included"),
    "mean_polymer_mass_fraction": ("1", "polymer mass fraction, mean of the cross-section"),
    "mean_polymer_mass_fraction_std": ("1", "its standard deviation"),
    "mean_polymer_concentration": ("kg m-3", "polymer mass per volume, mean of the cross-section"),
    "mean_polymer_concentration_std": ("kg m-3", "its standard deviation"),
    "calibration_std": (
        "1",
        "part of mean_polymer_fraction_std that all blocks share: from the calibration of the attenuation, or from the errors "
        "that pixel size, energy, attenuation and density are given with",
    ),
    "limit_std": ("1", "Cramer-Rao bound of mean_polymer_fraction if nothing but the shells were unknown"),
    "limit_ratio": ("1", "standard deviation of mean_polymer_fraction, without calibration, over limit_std"),
    "jet_radius": ("m", "jet radius"),
    "jet_radius_std": ("m", "its standard deviation, that of the pixel's size included"),
    "jet_axis": ("m", "position of the jet's axis from the middle of the row"),
    "jet_axis_std": ("m", "its standard deviation, that of the pixel's size included"),
    "beam_level": ("1", "level of the beam over that of the flat"),
    "beam_slope": ("1", "relative change of the beam from the middle of the row to its end"),
    "blur": ("m", "standard deviation of the point spread"),
    "misfit": (
        "1",
        "goodness of fit: Pearson's chi-square less its expectation, in its standard deviations; over 4 is a wrong model",
    ),
    "flags": ("", "what is odd about a block"),
    "fringe_significance": (
        "1",
        "Fresnel fringes in the frame, standard deviations: over 5 they are there, absorption is wrong; NaN: not looked for",
    ),
    "volume_fraction": ("1", "polymer volume fraction of the solution"),
    "attenuation_scale": ("1", "attenuation measured at the nozzle over that assumed; 1 where not calibrated"),
    "attenuation_scale_std": ("1", "its standard deviation"),
    "pixel_size": ("m", "width of a pixel at the jet"),
    "pixel_size_std": ("m", "its standard deviation"),
}

_REFERENCES = (
    "Greenfeld et al., Macromolecules 45, 3616 (2012); Lauricella et al., Rev. Mod. Phys. 92, 035004 (2020), Eqs. (41)-(42); "
    "Schoonjans et al., Spectrochim. Acta B 66, 776 (2011)"
)


def assemble(
    experiment: Experiment, fits: list[FrameFit], facts: dict[str, float], each: bool, remarks: tuple[str, ...] = ()
) -> xr.Dataset:
    """Dataset of a reduction.

    Parameters
    ----------
    experiment : Experiment
    fits : list of FrameFit
        One for each frame, or the one of their sum.
    facts : dict
        Numbers of the summed frame.
    each : bool
        Put a dimension `frame` in front.
    remarks : tuple of str
        More to be warned of.

    Returns
    -------
    xarray.Dataset
    """
    fit = fits[0]
    lead = ("frame",) if each else ()
    stack = (lambda arrays: np.stack(arrays)) if each else (lambda arrays: arrays[0])
    scale_std = float(np.hypot(experiment.calibration.std, experiment.detector.attenuation_std))
    middle = fit.rows.mean(axis=1) - 0.5
    edges = fit.shell_edges
    data = _fractions(experiment, fits, lead, stack)
    data |= _by_mass(experiment, data, lead)
    for name, key, with_std in (
        ("jet_radius", "radius", True),
        ("jet_axis", "axis", True),
        ("beam_level", "amplitude", False),
        ("beam_slope", "slope", False),
        ("blur", "blur", False),
    ):
        data[name] = ((*lead, "row"), stack([f.values[key] for f in fits]))
        if with_std:
            own = stack([f.std[key] for f in fits])
            data[f"{name}_std"] = (
                (*lead, "row"),
                np.hypot(own, data[name][1] * experiment.pixel_std / experiment.pixel),
            )
    for name, value in {
        "volume_fraction": experiment.solution.volume_fraction,
        "attenuation_scale": experiment.calibration.scale,
        "attenuation_scale_std": scale_std,
        "pixel_size": experiment.pixel,
        "pixel_size_std": experiment.pixel_std,
    }.items():
        data[name] = ((), value)
    data["fringe_significance"] = (lead, stack([np.float64(f.fringes) for f in fits]))
    flags = stack([f.flags for f in fits]).astype(np.int32)
    variables: dict[str, Any] = {name: (dims, values, _attributes(name)) for name, (dims, values) in data.items()}
    variables["flags"] = (
        (*lead, "row"),
        flags,
        {
            "long_name": REDUCTION_VARIABLES["flags"][1],
            "flag_meanings": " ".join(FRAME_FLAGS),
            "flag_masks": np.array([1 << i for i in range(len(FRAME_FLAGS))], dtype=np.int32),
        },
    )
    variables["relative_radius_bounds"] = (
        ("shell", "bound"),
        np.stack((edges[:-1], edges[1:]), axis=1),
        _attributes("relative_radius_bounds"),
    )
    coordinates = {
        "row": ("row", middle, _attributes("row")),
        "z": ("row", _along_the_jet(experiment, middle), _attributes("z")),
        "relative_radius": (
            "shell",
            0.5 * (edges[1:] + edges[:-1]),
            _attributes("relative_radius") | {"bounds": "relative_radius_bounds"},
        ),
    }
    if each:
        frames = np.array([experiment.stack.chosen[i] for i in range(experiment.stack.frames)])
        sources = [experiment.stack.source(i) for i in range(experiment.stack.frames)]
        coordinates["frame"] = ("frame", frames, {"long_name": "frame of the stack"})
        coordinates["frame_source"] = (
            "frame",
            np.array(sources, dtype=object),
            {"long_name": "where the frame is from"},
        )
    result = xr.Dataset(variables, coordinates)
    means = [data[name][1] for name in ("mean_polymer_fraction", "mean_polymer_fraction_std", "calibration_std")]
    odd = () if experiment.fringes >= FRINGES else unbalanced(experiment, *means)
    said = (*experiment.remarks, *remarks, *_flag_words(flags, fits), *odd)
    result.attrs = _provenance(experiment, fits, facts, said)
    return result


def _fractions(
    experiment: Experiment, fits: list[FrameFit], lead: tuple[str, ...], stack: Callable[[list[Any]], Any]
) -> dict[str, tuple[tuple[str, ...], Any]]:
    """Fractions with their errors: the counts' own, those of a bad fit widened, and what all blocks share."""
    fit, a = fits[0], experiment.absorber
    fraction, mean = stack([f.fraction for f in fits]), stack([f.mean for f in fits])
    excess = np.maximum(stack([_excess(f) for f in fits]), 1.0)  # a bad fit widens its errors
    statistical = stack([f.mean_std for f in fits]) * np.sqrt(excess)
    shift, mean_shift = experiment.calibration.shift(a, fraction), experiment.calibration.shift(a, mean)
    told = stack([_detector_covariance(experiment, f) for f in fits])
    weights = shell_weights(fit.shell_edges)
    mean_told = np.sqrt(np.maximum(np.einsum("i,...ij,j->...", weights, told, weights), 0.0))
    covariance = (
        stack([f.covariance for f in fits]) * excess[..., None, None] + shift[..., :, None] * shift[..., None, :] + told
    )
    std = np.sqrt(np.einsum("...ii->...i", covariance))
    common = np.hypot(mean_shift, mean_told)
    mean_std = np.hypot(statistical, common)
    limit = stack([f.limit_std for f in fits])
    return {
        "polymer_fraction": ((*lead, "row", "shell"), fraction),
        "polymer_fraction_std": ((*lead, "row", "shell"), std),
        "polymer_fraction_covariance": ((*lead, "row", "shell", "other_shell"), covariance),
        "mean_polymer_fraction": ((*lead, "row"), mean),
        "mean_polymer_fraction_std": ((*lead, "row"), mean_std),
        "calibration_std": ((*lead, "row"), np.abs(common)),
        "limit_std": ((*lead, "row"), limit),
        "limit_ratio": ((*lead, "row"), statistical / limit),
        "misfit": ((*lead, "row"), stack([f.misfit for f in fits])),
    }


def _excess(fit: FrameFit) -> FloatArray:
    """Chi-square over the degrees of freedom where the fit is bad; 1 elsewhere."""
    if not fit.excess.size:
        return np.ones(fit.rows.shape[0])
    return np.where(fit.misfit > _BAD, fit.excess, 1.0)


def _detector_covariance(experiment: Experiment, fit: FrameFit) -> FloatArray:
    """What the errors of blur, glare and a scale told with them do to the fractions of each block."""
    covariance = experiment.detector.covariance
    blocks, shells = fit.fraction.shape
    if covariance is None or fit.shifts.shape != (blocks, shells, covariance.shape[0]):
        return np.zeros((blocks, shells, shells))
    return np.asarray(np.einsum("bsi,ij,btj->bst", fit.shifts, covariance, fit.shifts))


def _by_mass(
    experiment: Experiment, data: dict[str, tuple[tuple[str, ...], Any]], lead: tuple[str, ...]
) -> dict[str, tuple[tuple[str, ...], Any]]:
    """Mass fraction and concentration; NaN where a noisy fraction is so far out that the mixture would have no mass."""
    rho_p, rho_s = experiment.solution.polymer.density, experiment.solution.solvent_density
    found: dict[str, tuple[tuple[str, ...], Any]] = {}
    for prefix in ("", "mean_"):
        dims, phi = data[f"{prefix}polymer_fraction"]
        std = data[f"{prefix}polymer_fraction_std"][1]
        mass = phi * rho_p + (1.0 - phi) * rho_s
        safe = np.where(mass > 0, mass, np.nan)
        found[f"{prefix}polymer_mass_fraction"] = (dims, phi * rho_p / safe)
        found[f"{prefix}polymer_mass_fraction_std"] = (dims, std * rho_p * rho_s / safe**2)
        found[f"{prefix}polymer_concentration"] = (dims, phi * rho_p)
        found[f"{prefix}polymer_concentration_std"] = (dims, std * rho_p)
    return found


def _along_the_jet(experiment: Experiment, middle: FloatArray) -> FloatArray:
    """Distance along the jet of rows: longer than in the image where the jet leans in it or out of it."""
    step = np.hypot(1.0, experiment.lean.slope) if experiment.lean.slope.size else np.ones(1)
    way = np.concatenate(([0.0], np.cumsum(step)))
    at = np.interp(middle + 0.5, np.arange(way.size), way)
    return np.asarray(at * experiment.pixel / out_of_plane(experiment.images))


def _attributes(name: str) -> dict[str, Any]:
    unit, words = REDUCTION_VARIABLES[name]
    return {"units": unit, "long_name": words} if unit else {"long_name": words}


def _flag_words(flags: Any, fits: list[FrameFit]) -> tuple[str, ...]:
    """How many blocks are odd, and why, in words."""
    blocks = flags.size
    said = []
    for i, (name, words) in enumerate(FRAME_FLAGS.items()):
        count = int(((flags >> i) & 1).sum())
        if count:
            reason = next((r for f in fits for r in f.reasons.values()), "") if name == "not_fitted" else ""
            said.append(f"{count} of {blocks} blocks: {words}" + (f" (the first: {reason})" if reason else ""))
    misfit = np.concatenate([f.misfit[np.isfinite(f.misfit)] for f in fits])
    if misfit.size and float(np.median(misfit)) < _TOO_QUIET:
        said.append(
            "the counts scatter less than Poisson: averaged frames or flats, or a gain that is too small; errors are too large"
        )
    return tuple(said)


def _provenance(
    experiment: Experiment, fits: list[FrameFit], facts: dict[str, float], remarks: tuple[str, ...]
) -> dict[str, Any]:
    from spinline.base.version import __version__

    images, stack = experiment.images, experiment.stack
    return {
        "Conventions": "CF-1.11",
        "title": images.title or images.name,
        "spinline_version": __version__,
        "images": images.text,
        "method": fits[0].method,
        "method_meaning": METHODS[fits[0].method].meaning,
        "fitted_beside_the_fractions": " ".join((*experiment.nuisances, *experiment.detector.names))
        if fits[0].method != "chord"
        else "radius axis amplitude slope",
        "frames": experiment.used if not images.each else stack.frames,
        "frames_read": _frames_read(experiment),
        "frame_shape": f"{stack.rows} x {stack.columns}",
        "block_rows": images.block_rows,
        "polymer": experiment.solution.polymer.name,
        "polymer_density": experiment.solution.polymer.density,
        "solvent": ", ".join(f"{name} {share:g}" for name, share in experiment.solution.solvent.items()),
        "solvent_density": experiment.solution.solvent_density,
        **{f"{key}_source": words for key, words in experiment.notes.items() if key != "fringes"},
        **facts,
        "fringes": _fringes(experiment, fits),
        "not_told_apart": _untold(experiment),
        "warnings": "\n".join(remarks),
        "references": _REFERENCES,
    }


def _frames_read(experiment: Experiment) -> str:
    """How many frames came from where."""
    stack, account = experiment.stack, experiment.stack.account
    total = stack.reader.shape[0]
    part = f"; frames {experiment.images.frames.text}" if experiment.images.part != slice(None) else ""
    used = experiment.used if not experiment.images.each else stack.frames
    parts = f" ({account.parts})" if account.parts else ""
    gone = f"; {len(account.missing)} never written" if account.missing else ""
    return f"{used} of {total} frames of {account.source}{parts}{part}{gone}"


def _untold(experiment: Experiment) -> str:
    """What these images cannot tell apart, with what is given of it."""
    images = experiment.images
    given = []
    if images.tilt_out is not None:
        given.append(f"tilt_out = {images.tilt_out.text}")
    if images.depth is not None:
        given.append(f"depth = {images.depth.text}")
    words = f" Given, and in the errors: {', '.join(given)}." if given else ""
    return UNIDENTIFIABLE + words


def _fringes(experiment: Experiment, fits: list[FrameFit]) -> str:
    """What was done about fringes."""
    if fits[0].method == "phase":
        return "fitted"
    seen = np.array([fit.fringes for fit in fits])
    if len(fits) == 1 or not (seen >= FRINGES).any():
        return experiment.notes["fringes"]
    return f"meets Fresnel fringes in {int((seen >= FRINGES).sum())} of {len(fits)} frames, reduced as absorption"


def lines(result: xr.Dataset) -> list[str]:
    """The answer in sentences."""
    last = result.median("frame") if "frame" in result.dims else result
    fitted = np.isfinite(last["mean_polymer_fraction"].values)
    if not fitted.any():
        return ["Nothing could be fitted."]
    good = fitted & plausible(result)
    blocks = int(good.sum())
    phi, std = last["mean_polymer_fraction"].values[good], last["mean_polymer_fraction_std"].values[good]
    radius = 1e6 * last["jet_radius"].values[good]
    tops = [0, blocks - 1]
    rho = float(result.attrs["polymer_density"])
    frames = f"{result.sizes['frame']} frames, each " if "frame" in result.dims else ""
    said = [
        f"{frames}{int(fitted.sum())} of {result.sizes['row']} blocks of {result.attrs['block_rows']} rows by "
        f"{result.attrs['method']!r}; "
        f"radius {radius[tops[0]]:.4g} um at the first, {radius[tops[1]]:.4g} um at the last."
    ]
    ratio = float(np.nanmedian(last["limit_ratio"].values))
    said.append(
        f"Mean polymer fraction {phi[tops[0]]:.4f} +/- {std[tops[0]]:.4f} at the first, "
        f"{phi[tops[1]]:.4f} +/- {std[tops[1]]:.4f} "
        f"at the last; median {np.median(phi):.4f} +/- {np.median(std):.4f} ({1e-3 * rho * np.median(phi):.4f} +/- "
        f"{1e-3 * rho * np.median(std):.4f} g/cm3); solution {float(result['volume_fraction']):.4f}."
    )
    if blocks < fitted.sum():
        said.append(
            f"Left out of these numbers, not of the file: {int(fitted.sum()) - blocks} whose fraction cannot be."
        )
    said.append(f"Errors are {ratio:.3g} times the Cramer-Rao bound of a jet and beam that are known.")
    if "calibration_source" in result.attrs:
        said.append(f"Attenuation: {result.attrs['calibration_source']}.")
    return said


def plausible(result: xr.Dataset) -> BoolArray:
    """Blocks whose mean fraction can be, within its error; all of them where none can (then attenuation or flat is wrong).

    Parameters
    ----------
    result : xarray.Dataset
        Of a reduction; a block of many frames counts if it can be in half of them.
    """
    bit = 1 << list(FRAME_FLAGS).index("impossible")
    odd = ((result["flags"] & bit) > 0).astype(float)
    share = odd.mean("frame") if "frame" in odd.dims else odd
    can: BoolArray = np.asarray(share.values <= 0.5)
    return can if can.any() else np.ones_like(can)


def to_csv(result: xr.Dataset, path: str | Path, *, force: bool = False) -> Path:
    """Write one line for each block (and frame), units in the header; concentrations in g/cm3."""
    import pandas as pd

    table: dict[str, FloatArray] = {}
    frames = result.sizes.get("frame", 0)
    blocks = result.sizes["row"]
    if frames:
        table["frame"] = np.repeat(np.arange(frames), blocks)
    ordered = {name: result[name] for name in (*result.coords, *result.data_vars)}
    for name, variable in ordered.items():
        dims = [d for d in variable.dims if d != "frame"]
        if dims not in (["row"], ["row", "shell"]):
            continue
        values = np.asarray(variable.values)
        unit = str(variable.attrs.get("units", ""))
        if unit == "kg m-3":
            values, unit = 1e-3 * values, "g/cm3"
        label = f" [{unit}]" if unit not in ("", "1") else ""
        if frames and "frame" not in variable.dims:
            values = np.broadcast_to(values, (frames, *values.shape))
        if dims == ["row"]:
            table[f"{name}{label}"] = values.reshape(-1)
        else:
            flat = values.reshape(-1, values.shape[-1])
            for j, r in enumerate(result["relative_radius"].values):
                table[f"{name}(r/R={r:.4g}){label}"] = flat[:, j]
    return write_text(path, str(pd.DataFrame(table).to_csv(None, index=False)), force=force)
