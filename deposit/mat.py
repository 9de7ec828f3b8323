"""A mat from its fibres: thickness, porosity, pores, orientation, diameters, permeability, with their scatter over places.

The whole mat is read in passes of bounded memory (`whole`); what needs every fibre's height is done in windows at seeded places
where the mat is at least half as heavy as at its heaviest (`stack`, `pores`), and comes as mean and standard deviation over
them.

Three names for one number: *solidity* V_F/V_E needs its envelope V_E named; all three are reported (`ENVELOPES`). A faster
collector at the same time thins the mat and aligns it: by the highest point its porosity then rises, by the mean top it falls.
Porosity also follows from the slope m, which is an input: it is in the result.

References
----------
Review section VI.
"""

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import BoolArray, FloatArray, number, positive
from spinline.base.errors import InputError, SpinlineWarning
from spinline.deposit.areal_density import DensityMap
from spinline.deposit.passages import Window, share_inside
from spinline.deposit.permeability import LAWS, permeability_of, pressure_drop
from spinline.deposit.pores import bubble_point, pore_size
from spinline.deposit.segments import Segments
from spinline.deposit.stack import ENVELOPES, Stack, lay_stack
from spinline.deposit.voxels import voxelise
from spinline.deposit.whole import Source, WholeMat, chunks_of, map_of, survey

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["MatOptions", "MatSample", "analyse_mat", "first_stack", "sample_mat", "sample_windows"]

_NO_FIBRE, _LAY_MORE = ("mat.window", "no window has a fibre in it"), "take larger windows or lay longer"
_PORE_VOXELS = 800_000
_RADII = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0])  # of pores, in fibre radii


@dataclass(frozen=True)
class MatOptions:
    """How a mat is analysed.

    Attributes
    ----------
    window : float, optional
        Side of the windows, m. Default: 50 mean diameters.
    slope : float
        m of the stack.
    envelope : str
        For `porosity`, `solidity` and permeability; the others are reported beside it.
    voxel : float, optional
        Of the pores, m. Default: a third of the mean radius.
    flatten : float
    permeability : sequence of str
        Laws, keys of `LAWS`.
    direct : bool
        Compute the Stokes flow in the first window too.
    realisations : int
        Windows.
    cells : int
        Of the longer side of the areal map.
    polymer_density : float
        kg/m3.
    face_velocity : float
        Of the gas for the pressure drop, m/s.
    seed : int
    """

    window: float | None = None
    slope: float = 0.1
    envelope: str = "mean-top"
    voxel: float | None = None
    flatten: float = 0.0
    permeability: Sequence[str] = ("davies",)
    direct: bool = False
    realisations: int = 8
    cells: int = 100
    polymer_density: float = 1200.0
    face_velocity: float = 0.05
    seed: int = 0

    def __post_init__(self) -> None:
        for name, least, most in (("realisations", 1, 1000), ("cells", 1, 20_000), ("seed", 0, 2**63 - 1)):
            value = getattr(self, name)
            if not isinstance(value, int | np.integer) or not least <= value <= most:
                raise InputError(
                    f"mat.{name}", "is no whole number in its range", value=value, allowed=f"{least} to {most}"
                )
        for name, unit in (("window", "m"), ("voxel", "m"), ("polymer_density", "kg/m3"), ("face_velocity", "m/s")):
            if getattr(self, name) is not None:
                positive(f"mat.{name}", getattr(self, name), unit)
        if np.ndim(self.slope) or self.slope != np.inf:
            number("mat.slope", self.slope, least=0.0)
        number("mat.flatten", self.flatten, least=0.0, below=1.0)
        if self.envelope not in ENVELOPES:
            raise InputError("mat.envelope", "is not known", value=self.envelope, allowed=", ".join(ENVELOPES))
        laws = self.permeability
        if not laws or not isinstance(laws, list | tuple) or any(law not in list(LAWS) for law in laws):
            raise InputError("mat.permeability", "is not known", value=laws, allowed=", ".join(LAWS))


@dataclass(frozen=True, eq=False)
class MatSample:
    """One window: its stack, its voxels and what they give; lengths in m."""

    stack: Stack
    solid: BoolArray | None
    voxel: float
    pore_radius: FloatArray
    pore_cumulative: FloatArray
    bubble_point_radius: float
    mean_radius: float


def analyse_mat(fibres: "Segments | Source", options: MatOptions | None = None) -> "xr.Dataset":
    """All properties of a mat.

    Parameters
    ----------
    fibres : Segments or FibreFile
    options : MatOptions

    Returns
    -------
    xarray.Dataset
        ``thickness(x, y)``, `mean_thickness`, `solidity`, `porosity` (1), `envelope_porosity(envelope)`, `areal_density`,
        ``pore_cumulative(pore_radius)``, `bubble_point_radius`, ``diameter_density(diameter)``,
        ``orientation_density(orientation)``, `order_parameter`, `director`, ``permeability(law)``, `pressure_drop(law)`; with
        ``_std`` over the windows where windows give it.
    """
    o = options or MatOptions()
    whole = survey(fibres)
    content = map_of(fibres, whole, o.cells)
    side = o.window if o.window is not None else 50 * whole.mean_diameter()
    side = positive("mat.window", side, "m")
    windows = sample_windows(content, side, o.realisations, o.seed)
    samples = [_sampled(laid, o, pores=k < 3) for k, laid in enumerate(_laid(_cut(fibres, windows), o))]
    return _dataset(whole, content, samples, o)


def first_stack(fibres: "Segments | Source", options: MatOptions) -> Stack:
    """The stack of the first window with fibre that `analyse_mat` takes.

    Raises
    ------
    InputError
        Where none has any.
    """
    whole = survey(fibres)
    content = map_of(fibres, whole, options.cells)
    side = options.window if options.window is not None else 50 * whole.mean_diameter()
    windows = sample_windows(content, side, options.realisations, options.seed)
    for laid in _laid(_cut(fibres, windows), options):
        return laid
    raise InputError(*_NO_FIBRE, remedy=_LAY_MORE)


def sample_windows(content: DensityMap, side: float, count: int, seed: int) -> list[Window]:
    """Windows at random places where the mat is at least half as heavy as at its heaviest cell."""
    rng = np.random.default_rng(seed)
    heavy = np.argwhere(content.content >= 0.5 * content.content.max())
    cells = heavy[rng.integers(0, len(heavy), count)]
    sx, sy = np.diff(content.x_edges[:2])[0], np.diff(content.y_edges[:2])[0]
    out = []
    for (i, j), (u, v) in zip(cells, rng.uniform(size=(count, 2)), strict=True):
        x, y = content.x_edges[i] + u * sx, content.y_edges[j] + v * sy
        out.append(Window(side, side, float(x) - side / 2, float(y) - side / 2))
    return out


def sample_mat(fibres: Segments, window: Window, options: MatOptions, *, pores: bool = True) -> MatSample:
    """Stack and pores of one window."""
    for laid in _laid([(window, fibres)], options):
        return _sampled(laid, options, pores=pores)
    raise InputError(*_NO_FIBRE, remedy=_LAY_MORE)


def _laid(parts: list[tuple[Window, Segments]], o: MatOptions) -> Iterator[Stack]:
    """Stacks of the windows that have fibre: not those that an end reaches into by less than a pixel."""
    for window, part in parts:
        laid = lay_stack(part, window, slope=o.slope, flatten=o.flatten)
        if laid.height.any():
            yield laid


def _sampled(laid: Stack, o: MatOptions, *, pores: bool) -> MatSample:
    run = laid.passages
    mean = float(np.average(run.radius, weights=np.repeat(run.spacing, np.diff(run.offsets))))
    if not pores:
        nothing = np.full(_RADII.size, np.nan)
        return MatSample(laid, None, float("nan"), mean * _RADII, nothing, float("nan"), mean)
    solid, voxel = pore_box(laid, mean, o.voxel)
    if solid.all() or not solid.any():
        cumulative, bubble = np.full(_RADII.size, np.nan), float("nan")
    else:
        cumulative = pore_size(solid, _RADII * mean / voxel)
        bubble = bubble_point(solid) * voxel
    return MatSample(laid, solid, voxel, mean * _RADII, cumulative, bubble, mean)


def pore_box(laid: Stack, mean_radius: float, voxel: float | None) -> tuple[BoolArray, float]:
    """Voxels of the middle of a window up to its 90 % height, few enough for distance transforms.

    Returns
    -------
    solid : ndarray of bool
    voxel : float
        m; coarser than a third of a radius, with a warning, only if even a box of 16 radii has too many.
    """
    top = float(np.quantile(laid.height, 0.9))
    top = top if top > 0 else float(laid.height.max())
    edge = mean_radius / 3 if voxel is None else positive("mat.voxel", voxel, "m")
    w = laid.passages.window
    side = min(w.width, w.height)
    if voxel is None:
        side = min(side, max(np.sqrt(_PORE_VOXELS * edge**3 / top), min(16 * mean_radius, side)))
        need = side**2 * top / edge**3
        if need > 2 * _PORE_VOXELS:
            edge *= (need / (2 * _PORE_VOXELS)) ** (1 / 3)
            warnings.warn(
                f"pores are taken at {mean_radius / edge:.2g} voxels a fibre radius (3 are wanted): the mat is thick; give "
                "mat.voxel to insist",
                SpinlineWarning,
                stacklevel=3,
            )
    return _middle(voxelise(laid, edge, thickness=top), max(round(side / edge), 1)), edge


def _middle(box: BoolArray, side: int) -> BoolArray:
    i, j = max((box.shape[0] - side) // 2, 0), max((box.shape[1] - side) // 2, 0)
    return box[i : i + side, j : j + side]


def _cut(fibres: "Segments | Source", windows: list[Window]) -> list[tuple[Window, Segments]]:
    """Rows near each window, in one pass."""
    parts: list[list[Segments]] = [[] for _ in windows]
    for s in chunks_of(fibres):
        low_x, high_x = np.minimum(s.x, s.x + s.dx), np.maximum(s.x, s.x + s.dx)
        low_y, high_y = np.minimum(s.y, s.y + s.dy), np.maximum(s.y, s.y + s.dy)
        for k, w in enumerate(windows):
            pad = 0.5 * w.width
            keep = (
                (high_x > w.x - pad)
                & (low_x < w.x + w.width + pad)
                & (high_y > w.y - pad)
                & (low_y < w.y + w.height + pad)
            )
            if keep.any():
                parts[k].append(s.take(keep))
    joined = [(w, Segments.join(p)) for w, p in zip(windows, parts, strict=True) if p]
    return [(w, part) for w, part in joined if (share_inside(part, w) > 0).any()]


def _dataset(whole: WholeMat, content: DensityMap, samples: list[MatSample], o: MatOptions) -> "xr.Dataset":
    import xarray as xr

    if len(samples) < o.realisations:
        warnings.warn(
            f"{o.realisations - len(samples)} of {o.realisations} windows have no fibre and are left out: the mat is "
            "thinner than one fibre there",
            SpinlineWarning,
            stacklevel=3,
        )
    if not samples:
        raise InputError(*_NO_FIBRE, remedy=_LAY_MORE)
    solidity = np.array([[s.stack.solidity(e) for e in ENVELOPES] for s in samples])
    chosen = solidity[:, ENVELOPES.index(o.envelope)]
    k = _permeabilities(samples, chosen, o)
    data: dict[str, Any] = {}
    thickness = np.array([s.stack.thickness(o.envelope) for s in samples])
    volume = np.array([s.stack.passages.fibre_volume / s.stack.area for s in samples])

    def put(name: str, rows: FloatArray, unit: str, dims: tuple[str, ...] = ()) -> None:
        data[name] = (dims, _mean(rows), {"units": unit})
        data[f"{name}_std"] = (dims, _spread(rows), {"units": unit})

    put("mean_thickness", thickness, "m")
    put("solidity", chosen, "1")
    put("porosity", 1 - chosen, "1")
    put("envelope_porosity", 1 - solidity, "1", ("envelope",))
    put("areal_density", volume * o.polymer_density, "kg m-2")
    put("coverage", np.array([s.stack.coverage for s in samples]), "1")
    put("permeability", k, "m2", ("law",))
    known = np.isfinite(k)
    drop = np.full(k.shape, np.nan)
    drop[known] = pressure_drop(np.broadcast_to(thickness[:, None], k.shape)[known], k[known], o.face_velocity)
    put("pressure_drop", drop, "Pa", ("law",))
    put("bubble_point_radius", np.array([s.bubble_point_radius for s in samples]), "m")
    put("pore_cumulative", np.array([s.pore_cumulative for s in samples]), "1", ("pore_radius",))
    bulk = float(_mean(chosen))
    data["thickness"] = (
        ("x", "y"),
        content.per_area / bulk,
        {"units": "m", "long_name": "polymer per area over the mean solidity"},
    )
    data["areal_density_map"] = (("x", "y"), content.per_area * o.polymer_density, {"units": "kg m-2"})
    first = samples[0].stack
    data["height"] = (("u", "v"), first.height, {"units": "m", "long_name": "upper surface in the first window"})
    _whole_mat(data, whole)
    middle = [0.5 * (e[1:] + e[:-1]) for e in (content.x_edges, content.y_edges)]
    coords = {
        "x": ("x", middle[0], {"units": "m"}),
        "y": ("y", middle[1], {"units": "m"}),
        "u": ("u", (np.arange(first.height.shape[0]) + 0.5) * first.pixel, {"units": "m"}),
        "v": ("v", (np.arange(first.height.shape[1]) + 0.5) * first.pixel, {"units": "m"}),
        "pore_radius": ("pore_radius", _mean(np.array([s.pore_radius for s in samples])), {"units": "m"}),
        "law": list(o.permeability),
        "envelope": list(ENVELOPES),
    }
    data = {name: (dims, value, about) for name, (dims, value, about) in data.items()}
    out = xr.Dataset(data, coords=coords)
    out.attrs |= {
        "envelope": o.envelope,
        "slope": o.slope,
        "flatten": o.flatten,
        "realisations": len(samples),
        "seed": o.seed,
        "window_m": first.passages.window.width,
        "pixel_m": first.pixel,
        "voxel_m": samples[0].voxel,
        "voxels_per_radius": samples[0].mean_radius / samples[0].voxel,
        "weight": "length",
        "polymer_density": o.polymer_density,
        "face_velocity": o.face_velocity,
        "left_out": "compression, fusion of crossings, slip of fibres after landing",
    }
    if o.direct and samples[0].solid is not None:
        _direct(out, samples[0])
    return out


def _whole_mat(data: dict[str, Any], whole: WholeMat) -> None:
    used = np.flatnonzero(whole.diameters)
    edges = whole.diameter_edges[max(used[0] - 1, 0) : used[-1] + 3]
    step = max(1, -(-(edges.size - 1) // 60))  # at most 60 bins
    content = whole.diameters[max(used[0] - 1, 0) : used[-1] + 2]
    coarse = np.add.reduceat(content, np.arange(0, content.size, step))
    bounds = np.r_[edges[:-1][::step], edges[-1]]
    density = coarse / (whole.length * np.diff(bounds))
    data["diameter_density"] = (("diameter",), density, {"units": "m-1", "long_name": "per length of fibre"})
    data["diameter"] = (("diameter",), 0.5 * (bounds[1:] + bounds[:-1]), {"units": "m"})
    data["diameter_low"] = (("diameter",), bounds[:-1], {"units": "m"})
    data["diameter_high"] = (("diameter",), bounds[1:], {"units": "m"})
    bins = whole.angles.size
    data["orientation"] = (("orientation",), (np.arange(bins) + 0.5) * np.pi / bins - np.pi / 2, {"units": "rad"})
    total = max(whole.chord, 1e-300)
    data["orientation_density"] = (("orientation",), whole.angles / total * bins / np.pi, {"units": "rad-1"})
    scalars = {
        "order_parameter": (whole.order_parameter, "1"),
        "director": (whole.director, "rad"),
        "mean_diameter": (whole.mean_diameter(), "m"),
        "diameter_deviation": (whole.diameter_deviation, "m"),
        "surface_mean_diameter": (whole.mean_diameter("surface"), "m"),
        "volume_mean_diameter": (whole.mean_diameter("volume"), "m"),
        "laid_length": (whole.chord, "m"),
        "flight_length": (whole.length, "m"),
        "polymer_volume": (whole.dry_volume, "m3"),
        "coiled_share": (whole.coiled / whole.length, "1"),
        "drawn_share": (whole.drawn / whole.length, "1"),
    }
    for name, (value, unit) in scalars.items():
        data[name] = ((), value, {"units": unit})


def _law(law: str, sample: MatSample, solidity: float) -> float:
    if not 0 < solidity < 1:
        return float("nan")
    return float(permeability_of(law, solidity, sample.mean_radius))


def _permeabilities(samples: list[MatSample], solidity: FloatArray, o: MatOptions) -> FloatArray:
    """Permeability (window, law), m2; NaN where a law has none, which is said once."""
    _judge(solidity, o.envelope)
    with warnings.catch_warnings(record=True) as notes:
        warnings.simplefilter("always")
        k = np.array([[_law(law, s, p) for law in o.permeability] for s, p in zip(samples, solidity, strict=True)])
    _again(notes)
    return k


def _judge(chosen: FloatArray, envelope: str) -> None:
    """Say what is odd about the solidity of the windows."""
    empty, full = int(np.isnan(chosen).sum()), chosen[chosen >= 1]
    words = []
    if empty:
        words.append(
            f"{empty} of {chosen.size} windows have no {envelope} envelope: fibre covers less than 1 % of them. Without "
            "porosity and permeability there; take mean-top"
        )
    if full.size:
        words.append(
            f"the {envelope} solidity of {full.size} of {chosen.size} windows is 1 or more (up to {full.max():.4g}): the mat "
            "is thinner than a layer, and where its fibre bends sharply or crosses itself the volume counts twice. No "
            "permeability there; take larger windows or lay longer"
        )
    for text in words:
        warnings.warn(text, SpinlineWarning, stacklevel=5)


def _direct(out: "xr.Dataset", sample: MatSample) -> None:
    from spinline.deposit.stokes import GROWN, stokes_permeability

    assert sample.solid is not None
    thickness = (sample.solid.shape[2] - 0.5) * sample.voxel
    thicker = voxelise(sample.stack, sample.voxel, thickness=thickness, grown=GROWN)
    flow = stokes_permeability(_middle(thicker, sample.solid.shape[0]))
    out["permeability_direct"] = (
        (),
        flow.permeability * sample.voxel**2,
        {"units": "m2", "long_name": "Stokes flow through the first window's box, wrapped at its sides"},
    )
    out["permeability_direct"].attrs |= {"solidity": float(sample.solid.mean()), "iterations": flow.iterations}


def _again(notes: "list[warnings.WarningMessage]") -> None:
    for text in dict.fromkeys(str(note.message) for note in notes):
        warnings.warn(text, SpinlineWarning, stacklevel=5)


def _mean(rows: FloatArray) -> FloatArray:
    good = np.isfinite(rows)
    count = good.sum(axis=0)
    total = np.where(good, rows, 0.0).sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _spread(rows: FloatArray) -> FloatArray:
    good = np.isfinite(rows)
    count = good.sum(axis=0)
    square = np.where(good, (rows - _mean(rows)) ** 2, 0.0).sum(axis=0)
    return np.where(count > 1, np.sqrt(square / np.maximum(count - 1, 1)), np.nan)
