"""From the coefficients of a fitted map to what is reported: curves, errors, the bound, and what is odd."""

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.xray.map.basis import AxialBasis
from spinline.xray.map.result import MapFit, MapPosterior
from spinline.xray.map.rows import expected_rows
from spinline.xray.map.scoring import BestMap, MapModel
from spinline.xray.row.model import NUISANCES

__all__ = ["reported"]


def reported(model: MapModel, best: BestMap, z: FloatArray, edges: FloatArray) -> MapFit:
    """The result of a fit."""
    data, radial, penalty = model.data, model.radial, model.penalty
    rows, size = z.size, radial.size
    local = best.look.local
    band = best.factor.covariance()
    covariance = _at_rows(model.axial, band)
    left = best.weights * penalty.traces(band)
    shells = radial.shells(edges)
    inner = covariance[:, :size, :size]
    values = {name: local[:, size + i].copy() for i, name in enumerate(NUISANCES)}
    std = {name: np.zeros(rows) for name in NUISANCES}
    for i, name in enumerate(model.names):
        std[name] = np.sqrt(covariance[:, size + i, size + i])
    for curves in (values, std):
        for name in ("radius", "axis", "blur"):
            curves[name] = curves[name] * data.pixel
    expected = np.empty(data.counts.shape)
    expected_rows(
        data.flat,
        data.dark,
        data.veil,
        local,
        radial.table,
        model.base,
        model.contrast,
        model.parts,
        model.reach,
        data.tail,
        expected,
    )
    unknowns = float(best.coefficients.size - left.sum())
    pixels = float(data.good.sum())
    freedom = pixels - unknowns
    spread = np.sqrt(2.0 * max(freedom, 1.0) + best.look.inverse_means)
    fit = MapFit(
        z=z,
        edges=edges,
        fraction=local[:, :size] @ shells.T,
        fraction_std=np.sqrt(np.einsum("sj,ijk,sk->is", shells, inner, shells, optimize=True)),
        mean_fraction=local[:, :size] @ radial.area,
        mean_fraction_std=np.sqrt((inner @ radial.area) @ radial.area),
        radius=values["radius"],
        radius_std=std["radius"],
        axis=values["axis"],
        axis_std=std["axis"],
        values=values,
        std=std,
        limit_std=_limit(best.look.fisher[:, :size, :size], radial.area),
        smoothing=dict(zip(penalty.names, best.weights.tolist(), strict=True)),
        term_freedom=dict(zip(penalty.names, (penalty.prior(best.weights) - left).tolist(), strict=True)),
        effective_freedom=unknowns,
        expected=expected,
        deviance=best.look.deviance,
        degrees_of_freedom=freedom,
        misfit=float((best.look.pearson - freedom) / spread),
        excess=float(best.look.pearson / max(freedom, 1.0)),
        used=np.asarray(data.good.max(axis=1) > 0.0),
        converged=best.converged,
        iterations=best.turns,
        warnings=(),
        posterior=MapPosterior(
            radial, model.axial, model.names, local[:, :size], inner, best.factor, data.pixel, best.look.fisher
        ),
    )
    object.__setattr__(fit, "warnings", _warnings(fit, model, best))
    return fit


def _at_rows(axial: AxialBasis, band: FloatArray) -> FloatArray:
    """Covariance of the local parameters of each row, from that of neighbouring coefficients."""
    out = np.zeros((axial.first.size, *band.shape[2:]))
    for a in range(axial.degree + 1):
        for d in range(axial.degree + 1 - a):
            weight = (axial.values[:, a] * axial.values[:, a + d])[:, None, None]
            block = weight * band[axial.first + a, d]
            out += block
            if d:
                out += block.transpose(0, 2, 1)
    return out


def _limit(fisher: FloatArray, area: FloatArray) -> FloatArray:
    """Cramer-Rao bound of the mean from each row alone; NaN where a row tells nothing."""
    scale = np.sqrt(np.diagonal(fisher, axis1=1, axis2=2))
    out = np.full(scale.shape[0], np.nan)
    lit = (scale > 0.0).all(axis=1)
    if lit.any():
        scaled = fisher[lit] / (scale[lit, :, None] * scale[lit, None, :])
        scaled += 1e-12 * np.eye(area.size)
        weights = (area / scale[lit])[:, :, None]
        out[lit] = np.sqrt((weights * np.linalg.solve(scaled, weights)).sum(axis=(1, 2)))
    return out


def _warnings(fit: MapFit, model: MapModel, best: BestMap) -> tuple[str, ...]:
    said = []
    data, half = model.data, 0.5 * model.data.counts.shape[1]
    if not fit.converged:
        said.append("the fit did not converge: give radius and axis, or fit fewer unknowns")
    elif not best.settled:
        said.append("the weights of the smoothing did not settle: errors are approximate")
    if data.dead.any():
        said.append(f"{_rows(data.dead)} without a count above dark: left out")
    idle = ~fit.used & ~data.dead
    if idle.any():
        said.append(f"{_rows(idle)} masked: bridged by their neighbours")
    weak = fit.mean_fraction_std > np.abs(fit.mean_fraction)
    if weak.any():
        said.append(f"the error of the mean fraction exceeds the fraction in {_rows(weak)}: sum more frames")
    outside = np.any((fit.fraction < -3 * fit.fraction_std) | (fit.fraction > 1 + 3 * fit.fraction_std), axis=1)
    if outside.any():
        said.append(
            f"the fraction lies outside [0, 1] by more than 3 of its errors in {_rows(outside)}: "
            "check attenuation, flat and fringes"
        )
    if fit.misfit > 4:
        said.append(
            "the counts scatter more than Poisson about the model: fringes, an elliptic jet, a jump from row to row, "
            "or a wrong flat or gain"
        )
    noise = np.sqrt(fit.expected * data.scatter[:, None])
    off = np.where(data.good > 0, (data.counts - fit.expected) / noise, 0.0)
    row, pixel = divmod(int(np.argmax(np.abs(off))), off.shape[1])
    if abs(off[row, pixel]) > 8:
        said.append(
            f"pixel {pixel} of row {row} lies {off[row, pixel]:+.0f} standard deviations off: mask it if it is bad"
        )
    ends = (np.abs(fit.axis) + fit.radius) / data.pixel > half - 3
    if ends.any():
        said.append(
            f"the jet reaches the end of {_rows(ends)}: without air there, beam level and fraction are hard to tell apart"
        )
    detail = sum(freedom for name, freedom in fit.term_freedom.items() if name.startswith("fraction"))
    if detail > 0.6 * model.radial.size * model.axial.size:
        said.append(
            "the fraction asks for more detail than the splines have: give more radial_splines or axial_splines"
        )
    return tuple(said)


def _rows(which: BoolArray) -> str:
    """Rows by number: "row 3", "5 rows (7, 8, 9, ...)"."""
    at = np.flatnonzero(which)
    if at.size == 1:
        return f"row {at[0]}"
    return f"{at.size} rows ({', '.join(str(i) for i in at[:3])}{', ...' if at.size > 3 else ''})"
