"""The detector of a set of images: blur and glare that all rows share, given, fitted, or found though nothing is given.

Groups of rows in which the jet stands still are summed to blocks (`xray.frame.still`) and fitted together: blur and tail
where they are asked for or given with an error, the blur where nothing is said of it, and with them the attenuation where the
fraction is known. Then the blocks are searched for what the model still lacks: a halo beside the jet (glare), a bend of the
beam.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.scene.images_file import Images
from spinline.xray.frame.shared import Block, DetectorFit, fit_detector, hidden_traces
from spinline.xray.row.fit import fit_row
from spinline.xray.row.forward import Absorber

__all__ = ["SharedDetector", "shared_detector"]

_FIRST_BLUR = 1.0  # pixels, where a fit of the blur starts
_FIRST_TAIL = (0.03, 15.0)  # share, and pixels
_BETTER = 16.0  # gain in deviance from which on there is a blur, or a bend of the beam
_SEEN = 5.0  # standard deviations of a halo that is said
_MAYBE = 3.0  # standard deviations of a bend that is said, and not fitted
_MOST_GLARE = 0.5  # of the light: more is no halo of a detector, but another beam than the flat's
_SHELLS = 3
_MOST_TURNS, _FEW_TURNS = 25, 10  # the fewer for a blur that nobody asked for


@dataclass(frozen=True, eq=False)
class SharedDetector:
    """What was found of a detector.

    Attributes
    ----------
    blur, tail_share, tail_length : float
        m, and a share: what the reduction takes.
    shapes : dict
        Legendre coefficients of the beam's bend, by name; fitted for all rows together.
    attenuation, attenuation_std : float
        Scale of the attenuation, told with the rest where the fraction is known; NaN where it was not.
    names, covariance : tuple of str, ndarray
        What all rows share, and how well it is known (the attenuation relative to itself).
    order : int
        Of the beam's shape that rows have to fit, 1 for its slope alone.
    notes : dict
    remarks : tuple of str
    glare : bool
        A halo is seen that is not in the model.
    """

    blur: float = 0.0
    tail_share: float = 0.0
    tail_length: float = 0.0
    shapes: tuple[tuple[str, float], ...] = ()
    attenuation: float = float("nan")
    attenuation_std: float = 0.0
    names: tuple[str, ...] = ()
    covariance: FloatArray | None = None
    order: int = 1
    notes: tuple[tuple[str, str], ...] = ()
    remarks: tuple[str, ...] = ()
    glare: bool = False


def shared_detector(
    images: Images, absorber: Absorber, blocks: Sequence[Block], pixel: float, *, calibrate: bool, joint_shapes: bool
) -> SharedDetector:
    """Fit what is unknown of the detector, and look for what is not in the model.

    Parameters
    ----------
    images : Images
    absorber : Absorber
    blocks : list of Block
        From `still.blocks_of_frame`, with no blur or tail.
    pixel : float
        m.
    calibrate : bool
        Some blocks' fraction is known: scale the attenuation by them, with the rest.
    joint_shapes : bool
        Fit the shape of the beam here, one for all rows.
    """
    start, unknown, prior, notes = _asked(images, pixel)
    if not blocks:
        return replace(start, notes=tuple(notes.items()))
    blocks = [
        replace(
            b, detector=replace(b.detector, blur=start.blur, tail_share=start.tail_share, tail_length=start.tail_length)
        )
        for b in blocks
    ]
    remarks: list[str] = []
    given_blur = images.blur is not None
    order = images.flat_shape or 1
    own = ["radius", "axis", "amplitude", "slope", *(f"shape{n}" for n in range(2, order + 1) if not joint_shapes)]
    if joint_shapes:
        unknown += [f"shape{n}" for n in range(2, order + 1)]
    fit: DetectorFit | None = None
    if unknown:
        if calibrate:
            unknown.append("attenuation")
        try:
            turns = _MOST_TURNS if given_blur or len(unknown) > 1 else _FEW_TURNS
            fit = fit_detector(blocks, absorber, unknown, prior=prior, shells=_SHELLS, nuisances=own, turns=turns)
        except InputError as error:
            if given_blur or any(name.startswith("tail") for name in unknown):
                raise
            remarks.append(f"the blur is not found and taken as 0 ({error.field} {error.problem})")
            start = replace(start, blur=0.0)
        else:
            if not given_blur and not fit.sharp and _no_blur(fit, blocks, absorber, unknown, prior, own):
                fit = None
                start = replace(start, blur=0.0)
                rest = [name for name in unknown if name not in ("blur", "attenuation")]
                blocks = [replace(b, detector=replace(b.detector, blur=0.0)) for b in blocks]
                if rest:
                    rest += ["attenuation"] if calibrate else []
                    fit = fit_detector(blocks, absorber, rest, prior=prior, shells=_SHELLS, nuisances=own)
    found = start if fit is None else _found(start, fit)
    if fit is not None:
        remarks += _vague(fit)
        notes |= _words(fit, pixel)
        if not given_blur and fit.values.get("blur", 0.0) > 0.0:
            remarks.append(_undeclared(fit, blocks, absorber, pixel, found))
    elif not given_blur:
        notes["blur"] = "none given, and none seen"
    blocks = [
        replace(
            b, detector=replace(b.detector, blur=found.blur, tail_share=found.tail_share, tail_length=found.tail_length)
        )
        for b in blocks
    ]
    scale = found.attenuation if np.isfinite(found.attenuation) else 1.0
    order, more, glare = _hidden(images, absorber.along(scale), blocks, own)
    return replace(found, order=order, notes=tuple(notes.items()), remarks=(*remarks, *more), glare=glare)


def _asked(
    images: Images, pixel: float
) -> tuple[SharedDetector, list[str], dict[str, tuple[float, float]], dict[str, str]]:
    """Where a fit starts, what is unknown, what is known of it beforehand, and how each was come by."""
    unknown: list[str] = []
    prior: dict[str, tuple[float, float]] = {}
    notes: dict[str, str] = {}
    blur, share, length = 0.0, 0.0, 0.0
    if images.blur is None or images.blur == "fit":
        unknown.append("blur")
        blur = _FIRST_BLUR * pixel
    else:
        blur = images.blur.value
        notes["blur"] = f"{images.blur.text}, given"
        if images.blur.std > 0.0:
            unknown.append("blur")
            prior["blur"] = (blur, images.blur.std)
    if images.tail_share is not None:
        share = _FIRST_TAIL[0]
        if images.tail_share != "fit":
            share = images.tail_share.value
            notes["tail_share"] = f"{images.tail_share.text}, given"
        if images.tail_share == "fit" or images.tail_share.std > 0.0:
            unknown.append("tail_share")
            if images.tail_share != "fit":
                prior["tail_share"] = (share, images.tail_share.std)
        length = _FIRST_TAIL[1] * pixel
        if images.tail_length is not None and images.tail_length != "fit":
            length, std = images.tail_length.metres(pixel)
            notes["tail_length"] = f"{images.tail_length.text}, given"
            if std > 0.0 and share > 0.0:
                unknown.append("tail_length")
                prior["tail_length"] = (length, std)
        elif share > 0.0:
            unknown.append("tail_length")
    return SharedDetector(blur, share, length), unknown, prior, notes


def _no_blur(
    fit: DetectorFit,
    blocks: Sequence[Block],
    absorber: Absorber,
    unknown: Sequence[str],
    prior: dict[str, tuple[float, float]],
    own: Sequence[str],
) -> bool:
    """Whether a blur that nobody gave is not over what the noise may show."""
    blur, std = fit.values["blur"], fit.std["blur"]
    return not fit.converged or blur < np.sqrt(_BETTER) * std


def _found(start: SharedDetector, fit: DetectorFit) -> SharedDetector:
    values, covariance = fit.values, fit.covariance.copy()
    attenuation, std = values.get("attenuation", float("nan")), 0.0
    if "attenuation" in fit.names:
        i = fit.names.index("attenuation")
        std = float(np.sqrt(covariance[i, i]))
        covariance[i] /= attenuation
        covariance[:, i] /= attenuation
    return replace(
        start,
        blur=values.get("blur", start.blur),
        tail_share=max(values.get("tail_share", start.tail_share), 0.0),
        tail_length=values.get("tail_length", start.tail_length),
        shapes=tuple((name, value) for name, value in values.items() if name.startswith("shape")),
        attenuation=attenuation,
        attenuation_std=std,
        names=fit.names,
        covariance=covariance,
    )


def _vague(fit: DetectorFit) -> list[str]:
    """Words where the counts do not tell a tail."""
    if not fit.converged:
        return ["blur and glare of the detector did not converge: give them, or one of them"]
    if not fit.vague:
        return []
    return [
        f"the counts hardly tell {' and '.join(fit.vague)} (+/- {fit.std[fit.vague[0]]:.2g}): a tail longer than the air in "
        "view is like a change of the beam's level; give tail_length, or tail_share with its error, from a measured edge"
    ]


def _words(fit: DetectorFit, pixel: float) -> dict[str, str]:
    """How each was come by."""
    said = {}
    for name, value in fit.values.items():
        std = fit.std[name]
        if name == "blur" or name == "tail_length":
            said[name] = f"{1e6 * value:.4g} +/- {1e6 * std:.2g} um ({value / pixel:.3g} pixels), fitted for all rows"
        elif name != "attenuation":
            said[name] = f"{value:.4g} +/- {std:.2g}, fitted for all rows"
    return said


def _undeclared(
    fit: DetectorFit, blocks: Sequence[Block], absorber: Absorber, pixel: float, found: SharedDetector
) -> str:
    """Words on a blur that was found though none was given, with what leaving it out would do."""
    blur = fit.values["blur"]
    block = max(blocks, key=lambda b: float(b.counts.sum()))
    scale = found.attenuation if np.isfinite(found.attenuation) else 1.0
    means = []
    for width in (0.0, blur):
        one = replace(
            block,
            detector=replace(block.detector, blur=width, tail_share=found.tail_share, tail_length=found.tail_length),
        )
        try:
            row = fit_row(
                one.counts,
                absorber.along(one.cosine * scale),
                one.seen(),
                shells=_SHELLS,
                good=one.good,
                radius=one.radius,
                axis=one.axis,
            )
        except InputError:
            break
        means.append(row.mean_fraction)
    shift = f"; left out, it would shift the mean fraction by {means[0] - means[1]:+.2g}" if len(means) == 2 else ""
    return (
        f"the jet's edges are blurred by {1e6 * blur:.2g} um ({blur / pixel:.2g} pixels), and none is given: it is fitted"
        f"{shift}; give blur if it is known"
    )


def _hidden(
    images: Images, absorber: Absorber, blocks: Sequence[Block], own: Sequence[str]
) -> tuple[int, list[str], bool]:
    """Order of the beam's shape that rows need, words, and whether there is glare that is not in the model."""
    order = images.flat_shape or 1
    try:
        traces = hidden_traces(blocks, absorber, shells=_SHELLS, nuisances=own)
    except InputError:
        return order, [], False
    tails = (
        {name: trace for name, trace in traces.items() if name.startswith("tail")} if images.tail_share is None else {}
    )
    bend = traces.get("shape2") if images.flat_shape is None else None
    tails = {name: trace for name, trace in tails.items() if trace[0] < _MOST_GLARE}
    best = max(tails.items(), key=lambda item: item[1][1], default=None)
    seen = best is not None and best[1][1] > _SEEN and best[1][0] > 0.0
    if bend is not None and abs(bend[1]) > _MAYBE and (best is None or bend[1] ** 2 > best[1][1] ** 2 or not seen):
        sure = abs(bend[1]) > _SEEN
        words = (
            f"the beam's shape {'changed' if sure else 'may have changed'} since the flat ({100 * bend[0]:+.2g} %, "
            f"{abs(bend[1]):.{0 if sure else 1}f} standard deviations): "
            f"{'it is fitted (flat_shape = 2)' if sure else 'flat_shape = 2 fits it'}; left out, it shifts the mean fraction "
            f"by {bend[2]:+.2g}"
        )
        return 2 if sure else order, [words], False
    if seen and best is not None:
        share, sigmas, shift = best[1]
        return (
            order,
            [
                f"the air beside the jet is darkened as by glare ({100 * share:.2g} % of the light over {best[0][5:]} pixels, "
                f"{sigmas:.0f} standard deviations), which is not in the model: it shifts the mean fraction by about "
                f'{shift:+.2g}; take tail_share = "fit"'
            ],
            True,
        )
    return order, [], False
