"""What a jet hands to the collector: one row per bead that landed, and the balance of the run.

The record is in the laboratory frame; `lay` turns it into fibres in the collector's frame. An element lands when its second
end does. Its radius is that of the *flight*, ``(V/(pi l_flight))^(1/2)``: the laid chord is shorter by the coils that the mesh
does not resolve, and a radius from the chord grew from 4.2 to 5.4 um as the mesh went from 0.1 to 0.4 mm where the flight's
stayed. ``excess = l_flight / l_chord`` is kept: above 1 the fibre coils below the mesh, below 1 the collector draws it.
"""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.deposit.collectors import Collector
from spinline.deposit.segments import Segments

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["LandingRecord", "feed_remark", "laid_by", "lay"]

IntArray = NDArray[np.int64]
_FLOATS = ("touch_time", "x", "y", "z", "vx", "vy", "vz", "volume", "polymer_fraction", "flight_length", "charge")
BALANCE = ("volume_fed", "volume_in_flight", "volume_evaporated", "charge_fed", "charge_in_flight", "charge_conducted")


@dataclass(frozen=True, eq=False)
class LandingRecord:
    """Beads that landed, in order of touch-down within each fibre; arrays (landing,).

    Attributes
    ----------
    touch_time : ndarray
        s.
    position, velocity : ndarray, (landing, 3)
        m and m/s, laboratory frame, x the spinning axis.
    volume : ndarray
        m3, of the element between the row before and this one; 0 on the first row of a fibre.
    polymer_fraction, flight_length, charge : ndarray
        Of the same element: 1, m, C.
    jet, fibre : ndarray of int
        Rows of different jet or fibre are not joined.
    balance : dict
        Volumes (m3) and charges (C) fed, in flight, lost; empty where the jet did not keep them.
    attributes : dict
    """

    touch_time: FloatArray
    position: FloatArray
    velocity: FloatArray
    volume: FloatArray
    polymer_fraction: FloatArray
    flight_length: FloatArray
    charge: FloatArray
    jet: IntArray
    fibre: IntArray
    balance: dict[str, float] = field(default_factory=dict)
    attributes: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def from_arrays(
        cls,
        touch_time: ArrayLike,
        position: ArrayLike,
        volume: ArrayLike,
        flight_length: ArrayLike,
        *,
        velocity: ArrayLike | None = None,
        polymer_fraction: ArrayLike = 1.0,
        charge: ArrayLike = 0.0,
        jet: ArrayLike = 0,
        fibre: ArrayLike = 0,
        balance: dict[str, float] | None = None,
        attributes: dict[str, Any] | None = None,
    ) -> Self:
        """Record from arrays; what belongs to elements is ignored on the first row of each fibre.

        Raises
        ------
        InputError
            For shapes that do not fit, a volume or flight length that is not positive, or time that runs back along a fibre.
        """
        time = real("touch_time", touch_time, unit="s")
        if time.ndim != 1:
            raise InputError("touch_time", "must be one row of times", value=f"shape {time.shape}")
        n = time.size
        places = _rows("position", position, n)
        speeds = np.full((n, 3), np.nan) if velocity is None else _rows("velocity", velocity, n)
        jets, fibres = _integers("jet", jet, n), _integers("fibre", fibre, n)
        joined = np.zeros(n, dtype=bool)
        joined[1:] = (jets[1:] == jets[:-1]) & (fibres[1:] == fibres[:-1])
        back = np.flatnonzero(joined & np.r_[False, np.diff(time) < 0])
        if back.size:
            raise InputError(
                "touch_time", f"runs back along a fibre, at row {int(back[0])}", value=float(time[back[0]])
            )

        def element(name: str, value: ArrayLike, first: float, **bounds: Any) -> FloatArray:
            raw = (
                np.broadcast_to(np.asarray(value, dtype=np.float64), (n,)) if np.ndim(value) == 0 else np.asarray(value)
            )
            if raw.shape != (n,):
                raise InputError(name, "must have a value per landing", value=f"shape {raw.shape}", allowed=f"({n},)")
            out = np.full(n, first)
            out[joined] = real(name, raw[joined], **bounds)
            return out

        return cls(
            touch_time=time,
            position=places,
            velocity=speeds,
            volume=element("volume", volume, 0.0, above=0.0, unit="m3"),
            polymer_fraction=element("polymer_fraction", polymer_fraction, np.nan, above=0.0, most=1.0),
            flight_length=element("flight_length", flight_length, np.nan, above=0.0, unit="m"),
            charge=element("charge", charge, 0.0, unit="C"),
            jet=jets,
            fibre=fibres,
            balance={key: float(value) for key, value in (balance or {}).items()},
            attributes=dict(attributes or {}),
        )

    @classmethod
    def from_dataset(cls, dataset: "xr.Dataset") -> Self:
        """Record from a Dataset with the dimension `landing` (see `to_dataset`)."""
        missing = [name for name in _FLOATS if name not in dataset and name not in ("vx", "vy", "vz", "charge")]
        if missing:
            raise InputError(
                "landing record",
                f"has no {', '.join(missing)}",
                value=list(map(str, dataset.data_vars)),
                remedy="run the jet to the collector with its landings kept, or give stored frames",
            )
        values = {name: np.asarray(dataset[name].values, dtype=np.float64) for name in _FLOATS if name in dataset}
        n = values["touch_time"].size
        has_velocity = all(name in values and np.isfinite(values[name]).all() for name in ("vx", "vy", "vz"))
        return cls.from_arrays(
            values["touch_time"],
            np.stack([values["x"], values["y"], values["z"]], axis=-1),
            values["volume"],
            values["flight_length"],
            velocity=np.stack([values["vx"], values["vy"], values["vz"]], axis=-1) if has_velocity else None,
            polymer_fraction=values["polymer_fraction"],
            charge=values.get("charge", np.zeros(n)),
            jet=dataset["jet"].values if "jet" in dataset else 0,
            fibre=dataset["fibre"].values if "fibre" in dataset else 0,
            balance={key: float(dataset.attrs[key]) for key in BALANCE if key in dataset.attrs},
            attributes={str(key): value for key, value in dataset.attrs.items() if key not in BALANCE},
        )

    def to_dataset(self) -> "xr.Dataset":
        """The record as a Dataset along `landing`."""
        import xarray as xr

        units = {"touch_time": "s", "volume": "m3", "polymer_fraction": "1", "flight_length": "m", "charge": "C"}
        data: dict[str, Any] = {name: ("landing", getattr(self, name), {"units": unit}) for name, unit in units.items()}
        for k, name in enumerate("xyz"):
            data[name] = ("landing", self.position[:, k], {"units": "m"})
            data[f"v{name}"] = ("landing", self.velocity[:, k], {"units": "m/s"})
        data["jet"], data["fibre"] = ("landing", self.jet), ("landing", self.fibre)
        return xr.Dataset(data, attrs={**self.attributes, **self.balance})

    def imbalance(self) -> dict[str, float]:
        """Relative volume and charge that the balance leaves over, where the jet kept it: 0 to rounding."""
        out = {}
        for what, lost in (("volume", "volume_evaporated"), ("charge", "charge_conducted")):
            keys = (f"{what}_fed", f"{what}_in_flight")
            if all(key in self.balance for key in keys):
                fed = self.balance[keys[0]]
                left = fed - self.balance[keys[1]] - self.balance.get(lost, 0.0) - float(np.sum(getattr(self, what)))
                scale = max(abs(fed), float(np.sum(np.abs(getattr(self, what)))))
                out[what] = left / scale if scale else 0.0
        return out


def lay(record: LandingRecord, collector: Collector) -> Segments:
    """Fibres in the collector's frame from a record in the laboratory's.

    Parameters
    ----------
    record : LandingRecord
    collector : Collector

    Returns
    -------
    Segments
        In order of touch-down (of their second end), each with its two ends, flight radius and excess. Beads that land on
        one spot give a segment of no chord: its length is that of the flight, its excess infinite.
    """
    place = collector.laid(record.position, record.touch_time)
    joined = np.flatnonzero((record.jet[1:] == record.jet[:-1]) & (record.fibre[1:] == record.fibre[:-1])) + 1
    order = joined[np.argsort(record.touch_time[joined], kind="stable")]
    step = place[order] - place[order - 1]
    flight = record.flight_length[order]
    return Segments(
        x=place[order - 1, 0],
        y=place[order - 1, 1],
        dx=step[:, 0],
        dy=step[:, 1],
        touch_time=record.touch_time[order],
        radius=np.sqrt(record.volume[order] / (np.pi * flight)),
        polymer_fraction=record.polymer_fraction[order],
        length=flight,
        jet=record.jet[order].astype(np.int32),
        fibre=record.fibre[order].astype(np.int32),
    )


def feed_remark(segments: Segments, surface_speed: float) -> str:
    """What to say of a surface that runs faster than the fibre is fed; nothing where it does not.

    The feed is the length laid over the time in which it was, mean of the jets.
    """
    feeds = []
    for jet in np.unique(segments.jet):
        own = segments.jet == jet
        span = float(np.ptp(segments.touch_time[own]))
        if span > 0:
            feeds.append(float(segments.length[own].sum()) / span)
    feed = float(np.mean(feeds)) if feeds else np.inf
    if not abs(surface_speed) > feed:
        return ""
    return (
        f"the collector's surface runs at {abs(surface_speed):.3g} m/s, faster than the fibre is fed ({feed:.3g} m/s): it is "
        "drawn, and a fibre that is drawn hangs above the surface, by some hundredths of a millimetre in a blown jet; "
        "take a slower surface, or do not trust the thickness of the mat"
    )


def laid_by(dataset: "xr.Dataset") -> Segments:
    """Fibres of a jet that laid them itself (dimension `deposit`, as the Lagrangian solver keeps them).

    Both ends of each element are there, in its collector's frame.

    Raises
    ------
    InputError
        Where something is missing, or nothing has landed.
    """
    needed = ("time", "y0", "z0", "y1", "z1", "radius", "volume", "polymer_volume", "flight_length")
    missing = [name for name in needed if f"deposit_{name}" not in dataset]
    if missing:
        raise InputError(
            "jet file", f"has no deposit_{', deposit_'.join(missing)}", remedy="run the jet to a collector"
        )
    get = {name: np.asarray(dataset[f"deposit_{name}"].values, dtype=np.float64) for name in needed}
    if not get["time"].size:
        raise InputError("jet file", "holds no landed element", remedy="run the jet until it reaches its collector")
    volume = real("deposit_volume", get["volume"], above=0.0, unit="m3")
    jet = np.asarray(dataset["deposit_jet"].values if "deposit_jet" in dataset else np.zeros(volume.size)).astype(
        np.int32
    )
    return Segments(
        get["y0"],
        get["z0"],
        get["y1"] - get["y0"],
        get["z1"] - get["z0"],
        get["time"],
        get["radius"],
        np.minimum(get["polymer_volume"] / volume, 1.0),
        get["flight_length"],
        jet,
        jet,
    )


def _rows(name: str, value: ArrayLike, n: int) -> FloatArray:
    rows = real(name, value)
    if rows.shape != (n, 3):
        raise InputError(name, "must be (landing, 3)", value=f"shape {rows.shape}", allowed=f"({n}, 3)")
    return rows


def _integers(name: str, value: ArrayLike, n: int) -> IntArray:
    raw = real(name, value, least=0, most=2**31 - 1)
    if raw.ndim == 0:
        raw = np.full(n, raw)
    if raw.shape != (n,) or np.any(raw != np.round(raw)):
        raise InputError(name, "must be a whole number per landing", value=f"shape {raw.shape}")
    return raw.astype(np.int64)
