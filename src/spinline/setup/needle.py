"""The jet of a scene with ``profile = "needle"``: bench and solution, brought together."""

from copy import copy
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spinline.base.errors import InputError
from spinline.network.mesh import network_at_rest
from spinline.rheology.solution import Solution
from spinline.scene.file import Scene
from spinline.scene.needle import FieldTable, NeedleJet
from spinline.setup.values import given

if TYPE_CHECKING:
    from spinline.jetprofile.ehd import NeedleSettings, StraightEhdJet, TableField

__all__ = ["NeedleSeries", "needle_jet", "needle_settings"]

_KEPT = 300


def needle_settings(section: NeedleJet, scene: Scene, solution: Solution) -> "NeedleSettings":
    """Settings of the jet, in SI.

    Raises
    ------
    InputError
        For what the jet needs of the solution and was not given.
    """
    from spinline.jetprofile.ehd import NeedleSettings

    if solution.viscosity is None:
        raise InputError("solution.viscosity", "is missing: the jet of a needle needs it", remedy="give it")
    theta = solution.relaxation_time
    if theta is None and section.law != "newtonian":
        raise InputError(
            "solution.relaxation_time",
            f'is missing: jet.law = "{section.law}" needs it',
            remedy='give it, or jet.law = "newtonian" (a Newtonian jet of a polymer solution thins ten times too far)',
        )
    field: Any = section.field
    if isinstance(field, FieldTable):
        path = scene.folder / field.table
        if not path.exists():
            raise InputError(
                "jet.field.table", "does not exist", value=field.table, remedy="paths start from the scene's folder"
            )
        field = _table(path, path.stat().st_mtime_ns)
    limit = given(section.extensibility)
    if limit is None:  # strands of Kuhn segments: (contour / mesh size)^2
        rest = network_at_rest(solution.volume_fraction, scene.network.solvent_quality)
        limit = float(rest.full_stretch) ** 2
    try:
        return NeedleSettings(
            radius=section.radius.value,
            flow_rate=section.flow_rate.value,
            voltage=section.voltage.value,
            gap=section.gap.value,
            conductivity=section.conductivity.value,
            surface_tension=section.surface_tension.value,
            viscosity=solution.viscosity,
            density=solution.density,
            permittivity=section.permittivity.value,
            relaxation_time=0.0 if theta is None else theta,
            law=section.law,
            solvent_share=section.solvent_share.value,
            extensibility=limit,
            mobility=section.mobility.value,
            field=field,
            log=section.log,
            end=given(section.end),
            current=given(section.current),
            gravity=section.gravity.value,
        )
    except InputError as error:
        raise InputError(
            f"jet.{error.field}", error.problem, value=error.value, allowed=error.allowed, remedy=error.remedy
        ) from None


def needle_jet(section: NeedleJet, scene: Scene, solution: Solution) -> "StraightEhdJet":
    """The jet; kept, since a plan, a run and a trade of one scene ask for it in turn."""
    return _solved(needle_settings(section, scene, solution), given(section.length))


class NeedleSeries:
    """Jets of similar settings, each started from one before it: ten times faster, the same to the tolerance of the mesh.

    Parameters
    ----------
    first : StraightEhdJet, optional
        Where to start.
    length : float, optional
        How far the jets are looked at, m, within ``jet.end``; by default each section's.
    """

    def __init__(self, first: "StraightEhdJet | None" = None, length: float | None = None) -> None:
        self._near, self._length = first, length
        self._made: dict[NeedleSettings, StraightEhdJet] = {}
        if first is not None:
            same = copy(first)  # itself, where it is asked for again
            same.end = first.end if length is None else length
            self._made[first.settings] = same

    def jet(self, section: NeedleJet, scene: Scene, solution: Solution) -> "StraightEhdJet":
        """As `needle_jet`; the last 300 are kept.

        Raises
        ------
        InputError
            Where there is no steady jet.
        """
        from spinline.jetprofile.ehd import StraightEhdJet

        settings = needle_settings(section, scene, solution)
        if settings not in self._made:
            length = given(section.length) if self._length is None else self._length
            jet = StraightEhdJet(settings, length=length, near=self._near)
            if not jet.solved.direct:  # far from the last start: the next are near this one
                self._near = jet
            if len(self._made) >= _KEPT:
                del self._made[next(iter(self._made))]
            self._made[settings] = jet
        return self._made[settings]


@lru_cache(maxsize=64)
def _solved(settings: "NeedleSettings", length: float | None) -> "StraightEhdJet":
    from spinline.jetprofile.ehd import StraightEhdJet

    return StraightEhdJet(settings, length=length)


@lru_cache(maxsize=8)
def _table(path: Path, changed: int) -> "TableField":
    from spinline.jetprofile.ehd import TableField

    return TableField.from_csv(path)
