"""Several jets in one scan, seen from many sides: attenuation, places and sections of all of them at once.

A jet tilted by alpha crosses the plane of the scan in an ellipse of half-axes R/cos(alpha) and R. Seen from the angle theta, an
ellipse of half-axes a, b, turned by psi, at (X, Y) on the turntable, has the chord

    L(x) = (2 a b/w^2) sqrt(w^2 - (x - x_c)^2),    w^2 = a^2 cos^2(theta - psi) + b^2 sin^2(theta - psi),
    x_c = c + X cos(theta) + Y sin(theta),

and its chords add where jets overlap. The beam, and the way it moves while it counts, average the transmission over a width; a
part of the signal that the jet does not stop (harmonics, scatter) is a share h:

    ln(I_0/I) = level(theta) - ln((<exp(-mu sum L)> + h)/(1 + h)).

Width and depth of a chord together tell mu from the size: nothing of the water's attenuation is put in. Residuals are weighed
by soft_l1 (a bad reading counts little), its scale that of the residuals themselves. Errors are those of the residuals'
scatter. Readings that are off together with their neighbours in the scan are a model that lacks something (liquids that
differ, a wider beam, another jet): the errors are then those of sums of neighbours, and `warnings` says so.

Where sections touch or cross in the plane of the scan, chords of both add up from every side, and attenuation and size are no
longer told apart: two real water jets that touch came out as one of 3.7 by 0.9 mm in a liquid of 420 /m, where 1003 is right,
by a fit that settled. Such ends are refused, by what gives them away: sections that touch, an ellipse more than 2.5 times as
long as wide (a round jet that leans by over 66 degrees), or a share of the signal at the end of its range.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, number, real
from spinline.base.errors import InputError
from spinline.base.quadrature import gauss

__all__ = ["Section", "SectionsFit", "fit_sections", "section_chord"]

_NODES, _WEIGHTS = gauss(16)
_LONGEST = 2.5  # half-axis over the other: a round jet leans by 66 degrees
_LEAST_SHARE, _MOST_SHARE = -0.02, 0.5
_DARK, _SURE = 0.002, 3.0  # a share under 0 by less may be noise
_LEAST_LIGHT = 1e-9
_BINS = 10  # in half a section's width
_LAGS = 6  # readings
_TOGETHER = 5.0  # standard deviations of a correlation that is said
_MOST_LOST = 0.05  # of the readings
_BAD = 60.0  # robust standard deviations: jets that move do a few of them at their edges, a lost reading does 100


@dataclass(frozen=True)
class Section:
    """Where and how large a jet's section is.

    Attributes
    ----------
    x, y : float
        Centre in the turntable's frame, m.
    major, minor : float
        Half-axes, m, > 0.
    angle : float
        Of the major axis against x, rad.
    """

    x: float
    y: float
    major: float
    minor: float
    angle: float


@dataclass(frozen=True, eq=False)
class SectionsFit:
    """Jets found in scans from many sides.

    Attributes
    ----------
    sections, std : tuple of Section
        The estimates, and their standard deviations in the same places.
    attenuation, attenuation_std : float
        mu, 1/m.
    share, share_std : float
        Part of the signal that no jet stops.
    centre : float
        Position c of the turntable's axis, m.
    level : ndarray, shape (views,)
        Baseline of each view.
    integral : ndarray, shape (views,)
        Integral of mu L over the scan by the data, m^2/m: constant over views for a steady jet. Bad readings are the model's.
    good : ndarray of bool, shape (views, positions)
        False for readings that the fit takes for bad.
    expected : ndarray, shape (views, positions)
    scatter : float
        Robust standard deviation of the residuals.
    converged : bool
    together : float
        By how much the errors are widened for residuals that go together with their neighbours; 1 where they do not.
    warnings : tuple of str
    """

    sections: tuple[Section, ...]
    std: tuple[Section, ...]
    attenuation: float
    attenuation_std: float
    share: float
    share_std: float
    centre: float
    level: FloatArray
    integral: FloatArray
    good: BoolArray
    expected: FloatArray
    scatter: float
    converged: bool
    together: float = 1.0
    warnings: tuple[str, ...] = ()

    def tilt(self, jet: int) -> float:
        """Angle in rad by which a round jet of that section leans from the scan's normal, ``acos(minor/major)``."""
        section = self.sections[jet]
        return float(np.arccos(min(section.minor / section.major, section.major / section.minor)))


def section_chord(section: Section, position: ArrayLike, view: ArrayLike, centre: float = 0.0) -> FloatArray:
    """Path through an elliptic section in m; positions in m and views in rad broadcast against each other."""
    x, theta = real("position", position, unit="m"), real("view", view, unit="rad")
    return _chord(section, x - centre, theta)


def fit_sections(
    position: ArrayLike,
    view: ArrayLike,
    extinction: ArrayLike,
    *,
    jets: int = 2,
    start: tuple[Section, ...] | None = None,
    width: float | None = None,
    share: float | None = None,
) -> SectionsFit:
    """Fit the sections of several jets, and their attenuation, to scans from many sides.

    Parameters
    ----------
    position : array_like, shape (positions,)
        m, evenly spaced and rising.
    view : array_like, shape (views,)
        rad, at least 5 views within half a turn.
    extinction : array_like, shape (views, positions)
        ln(I_0/I); each view may have its own baseline.
    jets : int
        How many; 2 are found by themselves, 1 or more than 2 need `start`.
    start : tuple of Section, optional
        First guesses.
    width : float, optional
        Of the beam, with its way during a reading, m, >= 0. Left out: the step (a scan in motion).
    share : float, optional
        Part of the signal that no jet stops, [0, 1); fitted where left out.

    Returns
    -------
    SectionsFit

    Raises
    ------
    InputError
        For shapes that do not fit, too few views, a number of jets without a start, or jets that the scans do not tell apart.

    Notes
    -----
    About 0.5 s for 18 views of 41 positions.
    """
    from scipy.optimize import least_squares

    x, theta, data = _scans(position, view, extinction)
    step = float(np.diff(x).mean())
    broad = step if width is None else number("width", width, least=0.0, most=10 * step, unit="m")
    held = None if share is None else number("share", share, least=0.0, below=1.0)
    level = np.median(np.sort(data, axis=1)[:, : max(x.size // 10, 3)], axis=1)
    depth = data - level[:, None]
    middle, first = _found(x, theta, depth, jets) if start is None else (_mean_path(x, theta, depth)[0], start)
    if len(first) != jets:
        raise InputError("start", "has another number of jets", value=len(first), allowed=f"{jets}")
    problem = _Problem(x, theta, data, broad, jets)
    mu = float(depth.sum(axis=1).mean()) * step / sum(np.pi * s.major * s.minor for s in first)
    p = problem.pack(mu, held or 0.0, middle, first, level)
    lower, upper = np.full(p.size, -np.inf), np.full(p.size, np.inf)
    lower[1], upper[1] = (_LEAST_SHARE, _MOST_SHARE) if held is None else (held - 1e-12, held + 1e-12)
    lower[5 : 3 + 5 * jets : 5] = lower[6 : 3 + 5 * jets : 5] = 1e-3  # half-axes
    robust = 0.1
    for _ in range(3):
        found = least_squares(
            problem.residuals,
            p,
            jac=problem.slopes,
            loss="soft_l1",
            f_scale=robust,
            x_scale=0.1,
            bounds=(lower, upper),
            max_nfev=60,
            ftol=1e-7,
            xtol=1e-7,
        )
        p = found.x
        robust = max(1.4826 * float(np.median(np.abs(found.fun))), 1e-9)
    _require_apart(problem.unpack(p)[3], float(p[1]), broad, held is None)
    fitted = problem.expected(p)
    good = np.abs(data - fitted) < _BAD * robust
    mu, h, centre, sections, base = problem.unpack(p)
    kept = problem.slopes(p)[good.ravel()]
    free = np.flatnonzero((np.abs(kept).sum(axis=0) > 0) & (upper - lower > 1e-9))
    spread = (data - fitted)[good].std() ** 2 * good.sum() / max(good.sum() - free.size, 1)
    sd = np.zeros(p.size)
    together, said = _judged(np.where(good, data - fitted, 0.0), good, _places(sections, x - centre, theta))
    sd[free] = together * np.sqrt(spread * np.diag(np.linalg.pinv(kept[:, free].T @ kept[:, free])))
    mu_std, h_std, _, sections_std, _ = problem.unpack(sd)
    clean = np.where(good, data, fitted) - base[:, None]
    stopped = np.maximum(np.exp(-clean) * (1.0 + h) - h, 1e-6)
    _require_light(h, h_std if held is None else np.inf)
    return SectionsFit(
        sections=sections,
        std=sections_std,
        attenuation=mu,
        attenuation_std=mu_std,
        share=h,
        share_std=h_std,
        centre=centre,
        level=base,
        integral=-np.log(stopped).sum(axis=1) * step,
        good=good,
        expected=fitted,
        scatter=robust,
        converged=bool(found.success),
        together=together,
        warnings=said if found.success else ("the fit did not converge: give start", *said),
    )


def _require_light(share: float, std: float) -> None:
    """Refuse a share of light that is less than none."""
    if share < -max(_DARK, _SURE * std):
        raise InputError(
            "share",
            "comes out under 0, which no light does: the sections do not explain the scans",
            value=f"{share:.3g} +/- {std:.2g}",
            allowed="[0, 1)",
            remedy="give width as it is, or scan one liquid at a time",
        )


def _scans(position: ArrayLike, view: ArrayLike, extinction: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Positions, views and readings, checked."""
    x, theta = real("position", position, unit="m"), real("view", view, unit="rad")
    data = real("extinction", extinction)
    if x.ndim != 1 or x.size < 8 or (np.diff(x) <= 0).any() or np.ptp(np.diff(x)) > 1e-3 * np.diff(x).mean():
        raise InputError(
            "position", "is not an evenly spaced, rising row", value=x.shape, allowed="at least 8 positions"
        )
    if theta.ndim != 1 or theta.size < 5:
        raise InputError("view", "are too few", value=theta.size, allowed="at least 5 views")
    if data.shape != (theta.size, x.size):
        allowed = f"({theta.size}, {x.size})"
        raise InputError("extinction", "does not fit views and positions", value=data.shape, allowed=allowed)
    return x, theta, data


def _places(sections: tuple[Section, ...], x: FloatArray, theta: FloatArray) -> list[FloatArray]:
    """Distance of every reading from the middle of every section, over half the section's width, (views, positions)."""
    out = []
    for s in sections:
        turned = theta - s.angle
        half = np.sqrt((s.major * np.cos(turned)) ** 2 + (s.minor * np.sin(turned)) ** 2)
        out.append(np.abs(x - (s.x * np.cos(theta) + s.y * np.sin(theta))[:, None]) / half[:, None])
    return out


def _judged(residual: FloatArray, good: BoolArray, places: list[FloatArray]) -> tuple[float, tuple[str, ...]]:
    """Factor on the errors for residuals that go together, along the scan or at one place of a section, and what is odd."""
    said = []
    lost = 1.0 - float(good.mean())
    if lost > _MOST_LOST:
        said.append(
            f"{100 * lost:.2g} % of the readings lie far off the fit and are left out: is there another jet, or one that moved?"
        )
    power = float((residual**2).sum()) / max(int(good.sum()), 1)
    total, first = 0.0, 0.0
    for lag in range(1, min(_LAGS, residual.shape[1] - 2) + 1):
        pairs = good[:, lag:] & good[:, :-lag]
        product = (
            float((residual[:, lag:] * residual[:, :-lag])[pairs].sum()) / max(int(pairs.sum()), 1) / max(power, 1e-300)
        )
        if product < 2.0 / np.sqrt(max(int(pairs.sum()), 1)):
            break
        first = first or product
        total += product
    together = float(np.sqrt(1.0 + 2.0 * total))
    if first > _TOGETHER / np.sqrt(good.size):
        said.append(
            f"the readings are off together with their neighbours (correlation {first:.2g}): liquids that differ, another "
            f"width of the beam, or sections that are no ellipses; errors are widened by {together:.2g}, perhaps not enough"
        )
    squares, count = 0.0, 0
    for place in places:
        bins = np.minimum((place * _BINS).astype(int), 2 * _BINS)[good]
        number = np.bincount(bins, minlength=2 * _BINS + 1)[: 2 * _BINS]
        sums = np.bincount(bins, residual[good], minlength=2 * _BINS + 1)[: 2 * _BINS]
        squares += float((sums[number > 0] ** 2 / number[number > 0]).sum()) / max(power, 1e-300)
        count += int((number > 0).sum())
    if squares > count + _TOGETHER * np.sqrt(2.0 * count):
        together = max(together, float(np.sqrt(squares / count)))
        said.append(
            f"the sections' edges or middles do not fit the readings of all views ({squares:.3g} where {count} is usual): "
            f"check width; the errors are widened by {together:.2g}, perhaps not enough"
        )
    return together, tuple(said)


def _require_apart(sections: tuple[Section, ...], share: float, width: float, free: bool) -> None:
    """Refuse what is no answer, whatever the fit says of itself."""
    for i, one in enumerate(sections):
        ratio = max(one.major, one.minor) / max(min(one.major, one.minor), 1e-300)
        if ratio > _LONGEST:
            raise InputError(
                "jets",
                f"are not told apart: section {i} comes out {ratio:.2g} times as long as wide",
                value=len(sections),
                allowed=f"up to {_LONGEST:g}, a round jet that leans by 66 degrees",
                remedy="scan where the jets are apart, more views, or give start",
            )
        for j, two in enumerate(sections[:i]):
            apart = float(np.hypot(one.x - two.x, one.y - two.y))
            along = np.arctan2(one.y - two.y, one.x - two.x)
            reach = sum(
                float(np.hypot(s.major * np.cos(along - s.angle), s.minor * np.sin(along - s.angle)))
                for s in (one, two)
            )
            if apart - reach < width:
                raise InputError(
                    "jets",
                    f"are not told apart: sections {j} and {i} touch or cross: attenuation and size change together",
                    value=f"{1e3 * apart:.3g} mm apart, {1e3 * reach:.3g} mm of both half-axes",
                    remedy="scan where the jets are apart",
                )
    if free and not _LEAST_SHARE + 1e-6 < share < _MOST_SHARE - 1e-6:
        raise InputError(
            "share",
            "ends at the limit of its range: the sections do not explain the scans",
            value=share,
            allowed=f"({_LEAST_SHARE:g}, {_MOST_SHARE:g})",
            remedy="give share, or scan where the jets are apart",
        )


class _Problem:
    """The scans as a function of mu, share, centre, sections and levels, all of them of order one."""

    def __init__(self, x: FloatArray, theta: FloatArray, data: FloatArray, width: float, jets: int) -> None:
        self.theta, self.data, self.shape, self.jets = theta, data, data.shape, jets
        self.scale = 0.5 * float(x[-1] - x[0])
        self.nodes = x + 0.5 * width * _NODES[:, None] if width > 0.0 else x[None]
        self.weights = 0.5 * _WEIGHTS if width > 0.0 else np.ones(1)
        self.units = np.array([self.scale] * 4 + [1.0])

    def pack(
        self, mu: float, share: float, centre: float, sections: tuple[Section, ...], level: FloatArray
    ) -> FloatArray:
        places = np.array([[s.x, s.y, s.major, s.minor, s.angle] for s in sections]) / self.units
        return np.concatenate(([mu * self.scale, share, centre / self.scale], places.ravel(), level))

    def unpack(self, p: FloatArray) -> tuple[float, float, float, tuple[Section, ...], FloatArray]:
        places = p[3 : 3 + 5 * self.jets].reshape(self.jets, 5) * self.units
        sections = tuple(Section(*map(float, place)) for place in places)
        return float(p[0] / self.scale), float(p[1]), float(p[2] * self.scale), sections, p[3 + 5 * self.jets :]

    def expected(self, p: FloatArray) -> FloatArray:
        mu, h, centre, sections, base = self.unpack(p)
        depth: FloatArray = np.zeros((self.nodes.shape[0], *self.shape))
        for section in sections:
            depth += _chord(section, self.nodes[:, None, :] - centre, self.theta[:, None])
        transmission = (self.weights[:, None, None] * np.exp(-mu * depth)).sum(axis=0)
        light = np.maximum(transmission + h, _LEAST_LIGHT)  # a trial may have less than none
        return np.asarray(base[:, None] - np.log(light / (1.0 + h)))

    def residuals(self, p: FloatArray) -> FloatArray:
        return np.asarray((self.expected(p) - self.data).ravel())

    def slopes(self, p: FloatArray) -> FloatArray:
        """Derivatives, shape (readings, parameters): differences, and 1 for the levels."""
        here = self.expected(p)
        out = np.zeros((int(np.prod(self.shape)), p.size))
        numbers = 3 + 5 * self.jets
        for i in range(numbers):
            move = np.zeros(p.size)
            move[i] = 1e-6
            out[:, i] = ((self.expected(p + move) - here) / 1e-6).ravel()
        for j in range(self.shape[0]):
            out[j * self.shape[1] : (j + 1) * self.shape[1], numbers + j] = 1.0
        return out


def _chord(section: Section, x: FloatArray, theta: FloatArray) -> FloatArray:
    turned = theta - section.angle
    square = (section.major * np.cos(turned)) ** 2 + (section.minor * np.sin(turned)) ** 2
    off = x - (section.x * np.cos(theta) + section.y * np.sin(theta))
    value: FloatArray = 2.0 * section.major * section.minor / square * np.sqrt(np.maximum(square - off**2, 0.0))
    return value


def _mean_path(x: FloatArray, theta: FloatArray, depth: FloatArray) -> FloatArray:
    """Centre of the turntable, and X and Y of the centre of mass."""
    mean = (depth * x).sum(axis=1) / depth.sum(axis=1)
    columns = np.stack((np.ones_like(theta), np.cos(theta), np.sin(theta)), axis=1)
    return np.asarray(np.linalg.lstsq(columns, mean, rcond=None)[0])


def _found(x: FloatArray, theta: FloatArray, depth: FloatArray, jets: int) -> tuple[float, tuple[Section, ...]]:
    """Two like jets from the moments of the scans: their variance is ``w^2/4 + (half the distance, projected)^2``."""
    if jets != 2:
        raise InputError("start", "is missing", remedy="give a first guess of each section; only two are found alone")
    centre, mean_x, mean_y = _mean_path(x, theta, depth)
    mean = (depth * x).sum(axis=1) / depth.sum(axis=1)
    variance = (depth * (x - mean[:, None]) ** 2).sum(axis=1) / depth.sum(axis=1)
    columns = np.stack((np.ones_like(theta), np.cos(2 * theta), np.sin(2 * theta)), axis=1)
    level, even, odd = np.linalg.lstsq(columns, variance, rcond=None)[0]
    half = np.sqrt(2.0 * np.hypot(even, odd))
    turn = 0.5 * np.arctan2(odd, even)
    radius = 2.0 * np.sqrt(max(level - 0.5 * half**2, 1e-4 * level))
    apart = half * np.array([np.cos(turn), np.sin(turn)])
    return float(centre), tuple(
        Section(
            float(mean_x + side * apart[0]), float(mean_y + side * apart[1]), float(radius), float(radius), float(turn)
        )
        for side in (-1.0, 1.0)
    )
