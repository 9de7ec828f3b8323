"""What all rows of a set of frames share: blur, glare and attenuation, from the joint likelihood of many blocks of rows.

Every block has a jet and a beam of its own, x_b; the detector, theta, is one. Fitted together, with the Fisher matrix F of a
block cut into both, what theta is told is the sum over blocks of what is left of each once its own unknowns are gone,

    S = P + sum_b (F_tt - F_tx F_xx^-1 F_xt),    C = S^-1,

P being what is known beforehand; and of what a block says, C leaves

    cov(x_b) = F_xx^-1 + V C V^T,    V = dx_b/d theta = -F_xx^-1 F_xt,

the second part common to all blocks. A tail of the point spread (`tail`) is told by the halo beside the jet; one that is much
longer than the air in view is a change of the beam's level, and needs a prior. The attenuation is told where the fraction
is known.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.xray.frame.shared_results import Block, DetectorFit
from spinline.xray.row.chords import equal_shells, shell_weights
from spinline.xray.row.fit import fit_row
from spinline.xray.row.forward import Absorber, row_model
from spinline.xray.row.model import EXTRAS, NUISANCES, SHAPE_STD, RowModel
from spinline.xray.row.outcome import RowFit
from spinline.xray.row.scoring import largest_likelihood

__all__ = ["SHARED", "Block", "DetectorFit", "fit_detector", "hidden_traces", "row_shifts"]

SHARED = ("blur", "tail_share", "tail_length", "attenuation", "shape2", "shape3", "shape4")
_TURNS = 25
_NEAR = 1e-4  # squared step, in standard deviations
_HALVINGS = 6
_WIDEST = 12.0  # pixels: of a blur that is looked for
_SHARPEST = 0.15  # pixels: a blur under this is none
_VAGUE = 0.5  # of a tail's length: known no better, it needs a prior
_UNITS = {
    "blur": 1.0,
    "tail_share": 0.05,
    "tail_length": 20.0,
    "attenuation": 0.01,
    "shape2": 1e-3,
    "shape3": 1e-3,
    "shape4": 1e-3,
}


@dataclass(eq=False)
class _Part:
    """A block with its model and where its own unknowns are."""

    block: Block
    model: RowModel
    free: list[int]
    at: FloatArray
    base: float
    contrast: float
    shared: list[int] = field(default_factory=list)


def fit_detector(
    blocks: Sequence[Block],
    absorber: Absorber,
    unknown: Sequence[str],
    *,
    prior: dict[str, tuple[float, float]] | None = None,
    shells: int = 3,
    nuisances: Sequence[str] = ("radius", "axis", "amplitude", "slope"),
    turns: int = _TURNS,
) -> DetectorFit:
    """Fit what blocks share, each block's jet and beam free.

    Parameters
    ----------
    blocks : sequence of Block
        Of one pixel size; steady ones, of different radii where there are any.
    absorber : Absorber
        Its attenuation is scaled where that is unknown.
    unknown : sequence of str
        Of `SHARED`; "attenuation" only where some block's fraction is known.
    prior : dict, optional
        Name to value and standard deviation known beforehand (m for lengths).
    shells : int
        Of a block whose fraction is not known.
    nuisances : sequence of str
        Each block's own; any of "radius", "axis", "amplitude", "slope" and the shapes.
    turns : int
        After which it is given up; a fit that finds its way takes 4 to 8.

    Returns
    -------
    DetectorFit

    Raises
    ------
    InputError
        Where no block can be fitted, or none tells the unknowns apart.
    """
    names = tuple(name for name in SHARED if name in unknown)
    if "attenuation" in names and not any(block.known is not None for block in blocks):
        raise InputError("attenuation", "is not told: no block's fraction is known", remedy="give calibration_rows")
    parts = [part for block in blocks if (part := _part(block, absorber, names, shells, nuisances)) is not None]
    if not parts:
        raise InputError("counts", "have no block of rows that can be fitted", remedy="check flat, dark and transpose")
    p = blocks[0].detector.pixel
    units = np.array([_UNITS[name] * (p if name in ("blur", "tail_length") else 1.0) for name in names])
    d = blocks[0].detector
    first = {"blur": d.blur, "tail_share": d.tail_share, "tail_length": d.tail_length, "attenuation": 1.0}
    theta = np.array([first.get(name, 0.0) for name in names]) / units
    centre, precision = theta.copy(), np.zeros(theta.size)
    for i, name in enumerate(names):
        if name.startswith("shape"):
            precision[i] = (SHAPE_STD / units[i]) ** -2.0
        if prior and name in prior:
            centre[i], precision[i] = prior[name][0] / units[i], (prior[name][1] / units[i]) ** -2.0
    here = _total(parts, names, theta * units, centre, precision, units)
    if here is None:
        raise InputError(
            "counts", "have no block of rows that can be fitted", remedy="give blur and tail_length near theirs"
        )
    converged, sharp = False, False
    for _ in range(turns):
        deviance, matrix, slope = here
        ridge = 1e-12 * np.diag(np.diag(matrix)) + 1e-300 * np.eye(theta.size)
        step = np.asarray(np.linalg.solve(matrix + ridge, slope), dtype=np.float64)
        if float(slope @ step) < _NEAR:
            converged = True
            break
        found = _fallen(parts, names, theta, step, deviance, (centre, precision, units))
        if found is None:
            converged = float(slope @ step) < 0.1
            break
        theta, here = found
        if "blur" in names and theta[names.index("blur")] * units[names.index("blur")] < _SHARPEST * p:
            sharp = True
            break
    if sharp:
        return _without_blur(blocks, absorber, names, prior, shells, nuisances)
    return _told(names, theta * units, units, here, converged, precision)


def _without_blur(
    blocks: Sequence[Block],
    absorber: Absorber,
    names: tuple[str, ...],
    prior: dict[str, tuple[float, float]] | None,
    shells: int,
    nuisances: Sequence[str],
) -> DetectorFit:
    """The fit where the counts are likeliest without a blur."""
    rest = tuple(name for name in names if name != "blur")
    still = [replace(block, detector=replace(block.detector, blur=0.0)) for block in blocks]
    if not rest:
        return DetectorFit((), {"blur": 0.0}, {"blur": 0.0}, np.zeros((0, 0)), np.nan, True, True)
    found = fit_detector(still, absorber, rest, prior=prior, shells=shells, nuisances=nuisances)
    values, std = {**found.values, "blur": 0.0}, {**found.std, "blur": 0.0}
    return replace(found, values=values, std=std, sharp=True)


def _told(
    names: tuple[str, ...],
    theta: FloatArray,
    units: FloatArray,
    here: tuple[float, FloatArray, FloatArray],
    converged: bool,
    precision: FloatArray,
) -> DetectorFit:
    matrix = here[1]
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    try:
        inverse = np.linalg.inv(matrix / np.outer(scale, scale)) / np.outer(scale, scale)
    except np.linalg.LinAlgError:
        raise InputError(
            "tail_share",
            "the counts do not tell blur, glare and attenuation apart",
            remedy="give tail_length, or tail_share with its error",
        ) from None
    covariance = inverse * np.outer(units, units)
    std = dict(zip(names, np.sqrt(np.diag(covariance)).tolist(), strict=True))
    values = dict(zip(names, theta.tolist(), strict=True))
    vague = []
    for i, name in enumerate(names):
        limit = _VAGUE * abs(values[name]) if name == "tail_length" else 0.012 if name == "tail_share" else np.inf
        if std[name] > limit and precision[i] * inverse[i, i] < 0.5:
            vague.append(name)
    return DetectorFit(names, values, std, covariance, here[0], converged, vague=tuple(vague))


def _fallen(
    parts: list[_Part],
    names: tuple[str, ...],
    theta: FloatArray,
    step: FloatArray,
    deviance: float,
    known: tuple[FloatArray, FloatArray, FloatArray],
) -> tuple[FloatArray, tuple[float, FloatArray, FloatArray]] | None:
    """Along a step, where the deviance is lower."""
    share = 1.0
    for _ in range(_HALVINGS):
        at = theta + share * step
        there = _total(parts, names, at * known[2], *known)
        if there is not None and there[0] < deviance:
            return at, there
        share *= 0.4
    return None


def _part(
    block: Block, absorber: Absorber, names: tuple[str, ...], shells: int, nuisances: Sequence[str]
) -> _Part | None:
    """A block, fitted once with the detector as it is given; None where that fails."""
    single = block.known is not None and "attenuation" in names
    edges = equal_shells(1 if single else shells)
    scaled = absorber.along(block.cosine)
    start = block.seen()
    try:
        fit = fit_row(
            block.counts,
            scaled,
            start,
            shells=edges,
            nuisances=nuisances,
            good=block.good,
            radius=block.radius,
            axis=block.axis,
        )
    except InputError:
        return None
    extras = tuple(name for name in EXTRAS if name in (*names, *nuisances))
    widest = max(3.0 * start.blur, _WIDEST * block.detector.pixel) if start.blur > 0.0 else None
    model = row_model(scaled, start, edges, widest, extras)
    model.scale_exposure(block.good.astype(np.float64))
    k = model.shells
    tail = {"tail_share": start.tail_share, "tail_length": start.tail_length}
    at = np.array(
        [
            *fit.jet.fraction,
            *(fit.values[name] for name in NUISANCES),
            *(fit.values.get(n, tail.get(n, 0.0)) for n in extras),
        ]
    )
    if single:
        at[:k] = block.known
    own = [*([] if single else range(k)), *(k + i for i, name in enumerate((*NUISANCES, *extras)) if name in nuisances)]
    shared = [k + (*NUISANCES, *extras).index(name) if name != "attenuation" else -1 for name in names]
    return _Part(block, model, own, at, model.base, model.contrast, shared)


def _total(
    parts: list[_Part],
    names: tuple[str, ...],
    theta: FloatArray,
    centre: FloatArray,
    precision: FloatArray,
    units: FloatArray,
) -> tuple[float, FloatArray, FloatArray] | None:
    """Deviance with each block's own unknowns at their best, with what is left of curvature and slope, or None."""
    off = theta / units - centre
    deviance, matrix, slope = float(precision @ off**2), np.diag(precision), -precision * off
    placed = []
    for part in parts:
        at, chain = _placed(part, names, theta)
        lit = part.block.good
        prior = part.model.known_before()
        at, _, _, value = largest_likelihood(part.model, at, part.free, part.block.counts, lit, prior=prior)
        if not np.isfinite(value):
            return None
        f, g = _curvature(part, at, chain * units, lit)
        matrix += f
        slope += g
        deviance += value
        placed.append(at)
    for part, at in zip(parts, placed, strict=True):
        part.at = at
    return deviance, matrix, slope


def _placed(part: _Part, names: tuple[str, ...], theta: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A block's parameters with the shared ones put in, and the derivatives of its own form of them with theirs."""
    at, chain, block = part.at.copy(), np.ones(theta.size), part.block
    for i, (name, value) in enumerate(zip(names, theta.tolist(), strict=True)):
        if name == "attenuation":
            part.model.base, part.model.contrast = part.base * value, part.contrast * value
            continue
        if name == "blur":
            wide = max(float(np.hypot(value, block.smear)), 1e-300)
            at[part.shared[i]], chain[i] = wide / block.cosine, value / wide / block.cosine
        elif name == "tail_length":
            at[part.shared[i]], chain[i] = value / block.cosine, 1.0 / block.cosine
        else:
            at[part.shared[i]] = value
    return at, chain


def _columns(part: _Part, at: FloatArray, chain: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean counts, derivatives with a block's own unknowns, and with the shared ones."""
    mean, jacobian = part.model.evaluate(at)
    k, m = part.model.shells, part.model
    columns = np.empty((mean.size, chain.size))
    for i, index in enumerate(part.shared):
        if index < 0:  # the attenuation: what all shells absorb, over the contrast
            columns[:, i] = jacobian[:, :k] @ ((m.base + m.contrast * at[:k]) / m.contrast) / (m.base / part.base)
        else:
            columns[:, i] = jacobian[:, index]
    return mean, jacobian[:, part.free], columns * chain


def _curvature(part: _Part, at: FloatArray, chain: FloatArray, lit: BoolArray) -> tuple[FloatArray, FloatArray]:
    """What a block tells of the shared unknowns once its own are gone."""
    mean, own, shared = _columns(part, at, chain)
    mean, own, shared, data = mean[lit], own[lit], shared[lit], part.block.counts[lit]
    weight = 1.0 / mean
    prior = part.model.known_before()
    fxx = own.T @ (own * weight[:, None])
    gx = own.T @ ((data - mean) * weight)
    if prior is not None:
        fxx[np.diag_indices_from(fxx)] += prior[part.free]
        gx -= prior[part.free] * at[part.free]
    fxt = own.T @ (shared * weight[:, None])
    solved = _solve(fxx, np.column_stack((fxt, gx)))
    f = shared.T @ (shared * weight[:, None]) - fxt.T @ solved[:, :-1]
    g = shared.T @ ((data - mean) * weight) - fxt.T @ solved[:, -1]
    return 0.5 * (f + f.T), g


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    scaled = matrix / np.outer(scale, scale) + 1e-13 * np.eye(scale.size)
    return np.asarray(np.linalg.solve(scaled, right / scale[:, None]) / scale[:, None])


def hidden_traces(
    blocks: Sequence[Block],
    absorber: Absorber,
    *,
    lengths: Sequence[float] = (6.0, 20.0, 60.0),
    shells: int = 3,
    nuisances: Sequence[str] = ("radius", "axis", "amplitude", "slope"),
) -> dict[str, tuple[float, float, float]]:
    """What the blocks show of glare, and of a change of the beam's shape, that the model at hand has not.

    Parameters
    ----------
    blocks, absorber, shells, nuisances
        As in `fit_detector`.
    lengths : sequence of float
        Of tails that are looked for, pixels.

    Returns
    -------
    dict
        "tail 6", "tail 20", ... and "shape2": size (share, or amplitude of the polynomial), its significance in standard
        deviations, and what leaving it out shifts the mean fraction by, a mean over blocks. One step of scoring: no fit.
    """
    found: dict[str, tuple[float, float, float]] = {}
    p = blocks[0].detector.pixel
    wanted = [(f"tail {length:g}", "tail_share", length * p) for length in lengths]
    for label, name, length in (*wanted, ("shape2", "shape2", 0.0)):
        matrix = slope = 0.0
        shifts, precision = [], []
        for block in blocks:
            looked = block if not length else replace(block, detector=replace(block.detector, tail_length=length))
            part = _part(looked, absorber, (name,), shells, nuisances)
            if part is None:
                continue
            if length:
                part.model.tail = (0.0, length)
            part.at[part.shared[0]] = 0.0
            f, g = _curvature(part, part.at, np.ones(1), block.good)
            matrix += float(f[0, 0])
            slope += float(g[0])
            v, std = _mean_shift(part, np.ones(1), shells)
            shifts.append(float(v[0]))
            precision.append(std**-2.0)
        if matrix > 0.0:
            size = slope / matrix
            shift = -size * float(np.average(shifts, weights=precision))
            found[label] = (size, slope / np.sqrt(matrix), shift)
    return found


def _mean_shift(part: _Part, chain: FloatArray, shells: int) -> tuple[FloatArray, float]:
    """Derivative of a block's mean fraction with the shared unknowns, and its own standard deviation."""
    mean, own, shared = _columns(part, part.at, chain)
    lit = part.block.good
    fisher = own[lit].T @ (own[lit] / mean[lit, None])
    prior = part.model.known_before()
    if prior is not None:
        fisher[np.diag_indices_from(fisher)] += prior[part.free]
    weights = np.zeros(len(part.free))
    weights[: part.model.shells] = shell_weights(part.model.edges)
    solved = _solve(fisher, np.column_stack((own[lit].T @ (shared[lit] / mean[lit, None]), weights)))
    return -weights @ solved[:, :-1], float(np.sqrt(max(float(weights @ solved[:, -1]), 1e-300)))


def row_shifts(
    fit: RowFit, absorber: Absorber, block: Block, names: Sequence[str], nuisances: Sequence[str]
) -> FloatArray:
    """Derivatives of the shells' fractions of a fitted row with what is shared, shape (shells, names): V.

    Parameters
    ----------
    fit : RowFit
        With the detector at what `fit_detector` said.
    absorber : Absorber
        As it was fitted with.
    block : Block
        The detector, not yet as a leaning row sees it.
    names : sequence of str
        Of `SHARED`.
    nuisances : sequence of str
        What the fit had free.
    """
    extras = tuple(name for name in EXTRAS if name in (*names, *nuisances))
    seen = block.seen()
    model = row_model(absorber.along(block.cosine), seen, fit.jet.shell_edges, None, extras)
    model.scale_exposure(block.good.astype(np.float64))
    k = model.shells
    tail = {"tail_share": seen.tail_share, "tail_length": seen.tail_length}
    at = [
        *fit.jet.fraction,
        *(fit.values[name] for name in NUISANCES),
        *(fit.values.get(n, tail.get(n, 0.0)) for n in extras),
    ]
    own = [*range(k), *(k + i for i, name in enumerate((*NUISANCES, *extras)) if name in nuisances)]
    shared = [k + (*NUISANCES, *extras).index(name) if name != "attenuation" else -1 for name in names]
    part = _Part(block, model, own, np.array(at), model.base, model.contrast, shared)
    chain = np.ones(len(shared))
    for i, name in enumerate(names):
        if name == "blur" and block.detector.blur > 0.0:
            chain[i] = block.detector.blur / float(np.hypot(block.detector.blur, block.smear)) / block.cosine
        elif name == "tail_length":
            chain[i] = 1.0 / block.cosine
    mean, mine, others = _columns(part, part.at, chain)
    lit = block.good
    fisher = mine[lit].T @ (mine[lit] / mean[lit, None])
    prior = model.known_before()
    if prior is not None:
        fisher[np.diag_indices_from(fisher)] += prior[own]
    return -_solve(fisher, mine[lit].T @ (others[lit] / mean[lit, None]))[:k]
