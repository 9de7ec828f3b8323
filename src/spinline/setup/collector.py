"""The collector of a scene, and what a jet's file says has landed on it."""

from typing import TYPE_CHECKING

from spinline.deposit.collectors import Belt, Drum, Plate, collector
from spinline.scene.mat_sections import CollectorSection

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["collector_of", "landings_alone"]

Surface = Plate | Belt | Drum


def collector_of(section: CollectorSection) -> Surface:
    """Collector of a scene."""
    return collector(
        section.kind,
        section.distance.value,
        speed=section.speed.value if section.speed else None,
        rotation=section.rotation,
        radius=section.radius.value if section.radius else None,
    )


def landings_alone(data: "xr.Dataset") -> "xr.Dataset":
    """What has landed of a file that holds beads as well: ``landing_x`` as x, and so on."""
    own = [str(name) for name in data.data_vars if data[name].dims == ("landing",)]
    return data[own].rename({name: name.removeprefix("landing_") for name in own if name.startswith("landing_")})
