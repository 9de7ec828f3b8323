"""A jet computed bead by bead: any simulator's beads, bent or not, drive the network through the material stretch.

An element of length l that had the length l_0 when it left the nozzle has the material stretch ``Lambda = l / l_0``
and, volume being conserved, the radius ``r = r_0 Lambda^(-1/2)``; with its volume Omega, ``l_0 = Omega / (pi r_0^2)``
and ``r = (Omega / (pi l))^(1/2)``. That stretch, along the arc from the nozzle, takes the place of V; the laboratory
velocity does not (once a jet bends, dv_x/dx underestimates the strain rate several times).

Bead 0 is the nozzle point; element i joins beads i and i + 1. Arrays are (bead,) or (time, bead), NaN-padded at the far
end.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, positive, real
from spinline.base.errors import InputError
from spinline.jetprofile.columns import read_columns

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["LagrangianJet"]

_FARTHEST = 1e6  # m
_RANGES = {"radius": (1e-15, 1e6), "volume": (1e-50, 1e18), "stretch_ratio": (1e-30, 1e30)}  # m, m3, 1


@dataclass(frozen=True, eq=False)
class LagrangianJet:
    """Beads of a jet and what belongs to the elements between them.

    Attributes
    ----------
    initial_radius : float
        r_0, m: radius where Lambda = 1.
    x, y, z : ndarray, (..., bead)
        Cartesian positions, m; x is the spinning axis.
    arc_length : ndarray, (..., element)
        Arc from the nozzle to the middle of each element, m.
    stretch, element_radius : ndarray, (..., element)
        Lambda, and the jet radius in m.
    element_strain_rate : ndarray, (..., element)
        Rate of material stretch, 1/s; NaN without velocities.
    bead_velocity : ndarray, (..., bead)
        Speed, m/s; NaN where not given.
    time : ndarray, (time,) or None
        s, where the arrays have a time axis.
    usable : ndarray of bool, (..., element)
        False for padding, deposited or damaged elements.
    attributes : dict
        Where the jet came from.
    cross_velocity : ndarray, (..., element), or None
        Speed across the jet's own axis, m/s; None where the velocity is not known by components.
    air_slip : ndarray, (..., element), or None
        Speed along the axis against air that moves, m/s (`cross_velocity` is against it too); None in still air.
    """

    initial_radius: float
    x: FloatArray
    y: FloatArray
    z: FloatArray
    arc_length: FloatArray
    stretch: FloatArray
    element_radius: FloatArray
    element_strain_rate: FloatArray
    bead_velocity: FloatArray
    time: FloatArray | None
    usable: BoolArray
    attributes: dict[str, Any]
    cross_velocity: FloatArray | None = None
    air_slip: FloatArray | None = None

    @classmethod
    def from_arrays(
        cls,
        x: ArrayLike,
        y: ArrayLike | None = None,
        z: ArrayLike | None = None,
        *,
        initial_radius: float,
        radius: ArrayLike | None = None,
        volume: ArrayLike | None = None,
        stretch_ratio: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        time: ArrayLike | None = None,
        attributes: dict[str, Any] | None = None,
    ) -> Self:
        """Jet from bead positions and one of radius, volume and stretch of the elements.

        Parameters
        ----------
        x, y, z : array_like, (bead,) or (time, bead)
            Positions in m from the nozzle (bead 0) on; NaN beyond the last bead. y and z default to 0.
        initial_radius : float
            r_0, m.
        radius, volume, stretch_ratio : array_like, (..., bead - 1)
            Exactly one: element radius (m), element volume (m3), or l / l_0.
        velocity : array_like, optional, (..., bead) or (..., bead, 3)
            Axial velocity, or its three components, m/s.
        time : array_like, optional, (time,)
            s; required with a time axis.
        attributes : dict, optional
            Kept with the jet and written into results.

        Returns
        -------
        LagrangianJet

        Raises
        ------
        InputError
            For shapes that do not fit, values out of range, beads that coincide, or gaps between beads.
        """
        r0 = positive("initial_radius", initial_radius, "m")
        px = _beads("x", x)
        py = np.zeros_like(px) if y is None else _beads("y", y, px.shape)
        pz = np.zeros_like(px) if z is None else _beads("z", z, px.shape)
        moments = _times(time, px)
        present = np.isfinite(px) & np.isfinite(py) & np.isfinite(pz)
        if (present[..., 1:] & ~present[..., :-1]).any() or not present[..., :2].all():
            raise InputError(
                "x", "has gaps: each time needs two beads or more, from the nozzle on, and NaN only after the last"
            )
        usable = present[..., 1:] & present[..., :-1]
        length = np.sqrt(np.diff(px) ** 2 + np.diff(py) ** 2 + np.diff(pz) ** 2)
        if (length[usable] <= 0).any():
            raise InputError("x", "has two beads at one place", remedy="drop one of them")
        stretch = _stretch(length, usable, r0, radius, volume, stretch_ratio)
        speed, rate = _kinematics(velocity, (px, py, pz), length)
        edges = np.cumsum(np.where(usable, length, 0.0), axis=-1)
        return cls(
            initial_radius=r0,
            x=px,
            y=py,
            z=pz,
            arc_length=np.where(usable, edges - 0.5 * length, np.nan),
            stretch=stretch,
            element_radius=_radius(length, stretch, r0, volume),
            element_strain_rate=rate,
            bead_velocity=speed,
            time=moments,
            usable=usable,
            attributes=dict(attributes or {}),
            cross_velocity=_across(velocity, px, py, pz),
        )

    @classmethod
    def from_csv(cls, path: str | Path, *, initial_radius: float | None = None) -> Self:
        """Jet from a CSV file, one row per bead from the nozzle on, units in the header.

        Parameters
        ----------
        path : path
            Columns ``x``, optionally ``y``, ``z``, ``velocity`` and ``time`` (rows grouped by time), and one of
            ``radius``, ``volume``, ``stretch_ratio`` (no unit). A row's element is the one towards the *next* bead;
            the last bead's is left empty.
        initial_radius : float, optional
            r_0, m. Default: the radius of the first element, if radii are given.

        Returns
        -------
        LagrangianJet
        """
        kinds = {
            "x": "length",
            "y": "length",
            "z": "length",
            "radius": "length",
            "volume": "volume",
            "stretch_ratio": "number",
            "velocity": "velocity",
            "time": "time",
        }
        columns = read_columns(path, kinds, required=("x",))
        time = columns.pop("time", None)
        rows = [np.arange(columns["x"].size)] if time is None else _groups(time, str(path))
        width = max(map(len, rows))
        padded = {
            name: np.stack([np.pad(values[row], (0, width - len(row)), constant_values=np.nan) for row in rows])
            for name, values in columns.items()
        }
        if time is None:
            padded = {name: values[0] for name, values in padded.items()}
        if initial_radius is None:
            if "radius" not in padded:
                raise InputError("initial_radius", "is needed where the file has no radius", remedy="give r_0")
            initial_radius = float(padded["radius"].reshape(-1, width)[0, 0])
            if not np.isfinite(initial_radius):
                remedy = "a row's radius is that towards the next bead: write it in every row but the last"
                raise InputError(str(path), "has no radius in its first row", remedy=remedy)
        elements = {name: padded[name][..., :-1] for name in ("radius", "volume", "stretch_ratio") if name in padded}
        return cls.from_arrays(
            padded["x"],
            padded.get("y"),
            padded.get("z"),
            initial_radius=initial_radius,
            velocity=padded.get("velocity"),
            time=None if time is None else [float(time[row[0]]) for row in rows],
            attributes={"source": Path(path).name},
            **elements,
        )

    @classmethod
    def from_dataset(cls, dataset: "xr.Dataset") -> Self:
        """Jet from a Dataset as `read_jetspin` makes it (or a file that `spinline import-jet` wrote)."""
        for name in ("x", "stretch_ratio", "radius", "arc_length"):
            if name not in dataset:
                raise InputError(
                    "jet dataset",
                    f"has no variable {name}",
                    value=list(map(str, dataset.data_vars)),
                    remedy="use a source that holds bead positions and volumes (traj.dat, save.dat, XYZ with its log)",
                )
        if "nozzle_radius" not in dataset.attrs:
            raise InputError(
                "jet dataset", "has no attribute nozzle_radius", remedy="read it with its log or input file"
            )

        def get(name: str) -> FloatArray:
            like = dataset["x"] if name in ("x", "y", "z", "velocity") else dataset["stretch_ratio"]
            if name not in dataset:
                return np.full(like.shape, 0.0 if name in ("y", "z") else np.nan)
            return np.asarray(dataset[name].transpose(*like.dims).values, dtype=np.float64)

        stretch, radius = get("stretch_ratio"), get("radius")
        usable = np.isfinite(stretch) & np.isfinite(radius)
        if "valid_element" in dataset:
            usable &= np.asarray(dataset["valid_element"].transpose(*dataset["stretch_ratio"].dims).values, dtype=bool)
        if not usable.any():
            raise InputError(
                "jet dataset",
                "holds no element with a known radius",
                remedy="read save.dat or traj.dat style 5-7, which hold the volumes",
            )
        x = get("x")
        arc = get("element_arc_length") if "element_arc_length" in dataset else _midpoints(dataset)
        time = np.asarray(dataset["time"].values, dtype=np.float64) if "time" in dataset.coords else None
        return cls(
            initial_radius=float(dataset.attrs["nozzle_radius"]),
            x=x,
            y=get("y"),
            z=get("z"),
            arc_length=arc,
            stretch=np.where(usable, stretch, np.nan),
            element_radius=np.where(usable, radius, np.nan),
            element_strain_rate=np.where(usable, get("strain_rate"), np.nan),
            bead_velocity=get("velocity"),
            time=time if x.ndim == 2 else None,
            usable=usable,
            attributes=dict(dataset.attrs),
            cross_velocity=get("air_cross_slip")
            if "air_cross_slip" in dataset
            else _dataset_across(dataset, x, get("y"), get("z")),
            air_slip=get("air_slip") if "air_slip" in dataset else None,
        )

    def at(self, time: float | None = None) -> Self:
        """One moment of the jet: the frame nearest to `time` in s, or the last."""
        if self.time is None:
            return self
        index = self.time.size - 1
        if time is not None:
            t = float(real("time", time, least=float(self.time[0]), most=float(self.time[-1]), unit="s"))
            index = int(np.argmin(np.abs(self.time - t)))
        picked = {
            name: getattr(self, name)[index]
            for name in (
                "x",
                "y",
                "z",
                "arc_length",
                "stretch",
                "element_radius",
                "element_strain_rate",
                "bead_velocity",
                "usable",
            )
        }
        return type(self)(
            initial_radius=self.initial_radius,
            time=None,
            attributes=self.attributes | {"time": float(self.time[index])},
            cross_velocity=None if self.cross_velocity is None else self.cross_velocity[index],
            air_slip=None if self.air_slip is None else self.air_slip[index],
            **picked,
        )

    @property
    def start(self) -> float:
        """The nozzle, m along the arc."""
        return 0.0

    @property
    def end(self) -> float:
        """Middle of the last element that counts, m along the arc."""
        return float(np.max(self.arc_length[self.usable]))

    def fields(self, place: FloatArray) -> dict[str, FloatArray]:
        """Further variables along the jet, by their names in a result; none."""
        return {}

    def residence_time(self, arc: ArrayLike) -> FloatArray:
        """Age in s of the element at an arc length in m, linear between elements; NaN without velocities."""
        from spinline.jetprofile.bead_age import bead_ages

        return self._along(arc, bead_ages(self)[0][self.usable], 0.0)

    def stretch_ratio(self, arc: ArrayLike) -> FloatArray:
        """Material stretch at an arc length in m: linear in its logarithm between elements, 1 at the nozzle."""
        return np.exp(self._along(arc, np.log(self._one("stretch")), 0.0))

    def velocity_ratio(self, arc: ArrayLike) -> FloatArray:
        """The material stretch: what takes the place of V in a bead jet."""
        return self.stretch_ratio(arc)

    def radius(self, arc: ArrayLike) -> FloatArray:
        """Jet radius in m at an arc length in m."""
        return np.exp(self._along(arc, np.log(self._one("element_radius")), float(np.log(self.initial_radius))))

    def strain_rate(self, arc: ArrayLike) -> FloatArray:
        """Rate of material stretch in 1/s at an arc length in m; NaN without velocities."""
        rate = self._one("element_strain_rate")
        return self._along(arc, rate, float(rate[0]))

    def position_of(self, velocity_ratio: ArrayLike) -> FloatArray:
        """First arc length in m where the material stretch passes a value; NaN where it never does."""
        targets = real("velocity_ratio", velocity_ratio, above=0.0)
        arc = np.concatenate(([0.0], self._one("arc_length")))
        level = np.concatenate(([0.0], np.log(self._one("stretch"))))
        found = [_first_passage(arc, level, float(np.log(target))) for target in targets.ravel()]
        return np.reshape(np.asarray(found, dtype=np.float64), targets.shape)

    def _one(self, name: str) -> FloatArray:
        if self.time is not None:
            raise InputError("jet", "has many times", remedy="pick one with .at(time)")
        values: FloatArray = getattr(self, name)[self.usable]
        return values

    def _along(self, arc: ArrayLike, values: FloatArray, nozzle: float) -> FloatArray:
        """Values at an arc length, linear between the middles of the elements and from the nozzle to the first."""
        nodes = self._one("arc_length")
        s = real("arc_length", arc, least=0.0, most=float(nodes[-1]), unit="m")
        return np.interp(s, np.concatenate(([0.0], nodes)), np.concatenate(([nozzle], values)))


def _first_passage(arc: FloatArray, level: FloatArray, target: float) -> float:
    above = np.flatnonzero(level >= target)
    if not above.size:
        return float("nan")
    i = int(above[0])
    if i == 0:
        return float(arc[0])
    share = (target - level[i - 1]) / (level[i] - level[i - 1])
    return float(arc[i - 1] + share * (arc[i] - arc[i - 1]))


def _beads(field: str, values: ArrayLike, shape: tuple[int, ...] | None = None) -> FloatArray:
    array = np.array(values, dtype=np.float64)
    if shape is None and (array.ndim not in (1, 2) or array.shape[-1] < 2 or not array.size):
        raise InputError(field, "must be (bead,) or (time, bead) with two beads or more", value=f"shape {array.shape}")
    if shape is not None and array.shape != shape:
        raise InputError(field, "has another shape than x", value=f"{array.shape} against {shape}")
    if np.isinf(array).any():
        raise InputError(field, "is not finite", value=float("inf"))
    if (np.abs(array) > _FARTHEST).any():
        raise InputError(
            field,
            "lies beyond any laboratory",
            value=float(np.nanmax(np.abs(array))),
            allowed=f"up to {_FARTHEST:g} m",
            remedy="check the unit of length",
        )
    return array


def _times(time: ArrayLike | None, x: FloatArray) -> FloatArray | None:
    if x.ndim == 1:
        if time is not None:
            raise InputError("time", "is given, but x has no time axis", remedy="give x as (time, bead)")
        return None
    if time is None:
        raise InputError("time", "is needed where x has a time axis", remedy="give one time per row of x")
    moments = real("time", time, unit="s")
    if moments.shape != x.shape[:1]:
        raise InputError("time", "must have one value per row of x", value=f"{moments.shape} against {x.shape}")
    if (np.diff(moments) <= 0).any():
        raise InputError("time", "must strictly increase")
    return moments


def _stretch(
    length: FloatArray,
    usable: BoolArray,
    r0: float,
    radius: ArrayLike | None,
    volume: ArrayLike | None,
    stretch_ratio: ArrayLike | None,
) -> FloatArray:
    given = {"radius": radius, "volume": volume, "stretch_ratio": stretch_ratio}
    names = [name for name, values in given.items() if values is not None]
    if len(names) != 1:
        raise InputError(
            "jet", f"needs one of radius, volume and stretch_ratio, not {len(names)}", value=", ".join(names) or None
        )
    values = np.array(given[names[0]], dtype=np.float64)
    if values.shape != length.shape:
        raise InputError(names[0], "must have one value per element", value=f"{values.shape} against {length.shape}")
    real(names[0], values[usable], above=_RANGES[names[0]][0], below=_RANGES[names[0]][1])
    values = np.where(usable, values, np.nan)
    if radius is not None:
        return (r0 / values) ** 2
    if volume is not None:
        return np.pi * r0**2 * length / values
    return values


def _radius(length: FloatArray, stretch: FloatArray, r0: float, volume: ArrayLike | None) -> FloatArray:
    if volume is not None:
        value: FloatArray = np.sqrt(np.asarray(volume, dtype=np.float64) / (np.pi * length))
        return np.where(np.isfinite(stretch), value, np.nan)
    value = r0 / np.sqrt(stretch)
    return value


def _kinematics(
    velocity: ArrayLike | None, position: tuple[FloatArray, FloatArray, FloatArray], length: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Speed of each bead, and ``(dv . dr) / l^2`` of each element."""
    x = position[0]
    if velocity is None:
        return np.full_like(x, np.nan), np.full_like(length, np.nan)
    v = np.array(velocity, dtype=np.float64)
    if v.shape == x.shape:
        v = np.stack([v, np.zeros_like(v), np.zeros_like(v)], axis=-1)
    if v.shape != (*x.shape, 3):
        raise InputError("velocity", "must be (..., bead) or (..., bead, 3)", value=f"{v.shape} against {x.shape}")
    step = np.stack([np.diff(p) for p in position], axis=-1)
    rate = np.sum(np.diff(v, axis=-2) * step, axis=-1) / length**2
    return np.sqrt(np.sum(v**2, axis=-1)), rate


def _midpoints(dataset: "xr.Dataset") -> FloatArray:
    arc = np.asarray(dataset["arc_length"].transpose(*dataset["x"].dims).values, dtype=np.float64)
    return 0.5 * (arc[..., 1:] + arc[..., :-1])


def _groups(time: FloatArray, path: str) -> list[Any]:
    if not np.isfinite(time).all():
        raise InputError(f"{path}: time", "is not finite")
    starts = np.flatnonzero(np.diff(time, prepend=np.nan) != 0)
    return np.split(np.arange(time.size), starts[1:])


def _across(velocity: ArrayLike | None, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray | None:
    if velocity is None or np.ndim(velocity) == x.ndim:
        return None
    return across_axis(np.array(velocity, dtype=np.float64), x, y, z)


def across_axis(velocity: FloatArray, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Speed of elements across their own axis, (..., element): the mean velocity of its two beads less its part along
    it.
    """
    step = np.stack([np.diff(p) for p in (x, y, z)], axis=-1)
    mean = 0.5 * (velocity[..., 1:, :] + velocity[..., :-1, :])
    square = np.sum(step**2, axis=-1)
    along = np.divide(np.sum(mean * step, axis=-1), square, out=np.full_like(square, np.nan), where=square > 0)
    value: FloatArray = np.sqrt(np.sum((mean - along[..., np.newaxis] * step) ** 2, axis=-1))
    return value


def _dataset_across(dataset: "xr.Dataset", x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray | None:
    parts = [f"velocity_{axis}" for axis in "xyz"]
    if not all(name in dataset for name in parts):
        return None
    velocity = [np.asarray(dataset[name].transpose(*dataset["x"].dims).values, dtype=np.float64) for name in parts]
    return across_axis(np.stack(velocity, axis=-1), x, y, z)
