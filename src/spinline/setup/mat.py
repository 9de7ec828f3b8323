"""Sections of a scene to collectors, laydown laws and options of a mat; and whatever a user names to landings."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.errors import InputError
from spinline.base.file_format import HDF5_HEAD
from spinline.base.files import readable
from spinline.deposit.collectors import Belt, Drum, Plate
from spinline.deposit.frames import landings_from_table
from spinline.deposit.landing import LandingRecord, laid_by
from spinline.deposit.mat import MatOptions
from spinline.deposit.segments import Segments
from spinline.deposit.surrogate import Laydown, surrogate_fibre
from spinline.scene.mat_file import MatScene
from spinline.scene.mat_sections import LaydownSection, MatSection
from spinline.setup.collector import collector_of, landings_alone

if TYPE_CHECKING:
    import xarray as xr

    from spinline.scene.file import Scene

__all__ = [
    "collector_of",
    "kept_options",
    "laid_file",
    "landings_alone",
    "landings_of",
    "lay_scene",
    "laydown_of",
    "mat_kept",
    "options_from_text",
    "options_of",
    "options_text",
    "rows_of",
    "scene_jet",
]

Surface = Plate | Belt | Drum


def laydown_of(section: LaydownSection) -> Laydown:
    """Law of laydown of a scene: the median radius and spread of ln radius from mean and deviation of the diameter."""
    mean = section.diameter.value
    deviation = section.diameter_deviation.value if section.diameter_deviation else 0.0
    s2 = float(np.log1p((deviation / mean) ** 2))
    fraction = section.polymer_fraction
    return Laydown(
        speed=section.speed.value,
        covariance=section.spread.value**2,
        noise=float(np.sqrt(2 / section.turning_length.value)),
        radius=0.5 * mean * float(np.exp(-s2 / 2)),
        radius_spread=s2**0.5,
        radius_length=section.correlation.value if section.correlation else 0.0,
        polymer_fraction=1.0 if isinstance(fraction, int) else fraction.value,
    )


def options_of(section: MatSection) -> MatOptions:
    """Options of a mat's analysis."""
    return MatOptions(
        window=section.window.value if section.window else None,
        slope=section.slope.value,
        envelope=section.envelope,
        voxel=section.voxel.value if section.voxel else None,
        flatten=section.flatten.value,
        permeability=tuple(section.permeability),
        direct=section.direct,
        realisations=section.realisations,
        polymer_density=section.polymer_density.value,
        face_velocity=section.face_velocity.value,
        seed=section.seed,
    )


def options_text(options: MatOptions) -> str:
    """Options as text, for the file of fibres."""
    return json.dumps(asdict(options))


def options_from_text(text: str, changes: dict[str, Any]) -> MatOptions:
    """Options from a file of fibres, changed on the command line."""
    try:
        data = json.loads(text) if text else {}
    except (ValueError, RecursionError):
        data = {}
    told = data.items() if isinstance(data, dict) else ()
    known = {key: value for key, value in told if key in MatOptions.__dataclass_fields__}
    return MatOptions(**{**known, **{key: value for key, value in changes.items() if value is not None}})


def lay_scene(scene: MatScene) -> Iterator[Segments]:
    """Fibres of all jets of a scene, block by block; jet k's random numbers follow from (mat.seed, k)."""
    law, surface = laydown_of(scene.laydown), collector_of(scene.collector)
    if scene.collector.time is None:
        raise InputError("collector.time", "is missing", remedy='say how long fibre is laid, for example "10 s"')
    length = law.speed * scene.collector.time.value
    step = scene.laydown.step.value if scene.laydown.step else None
    for k in range(scene.jets.count):
        across = (k - (scene.jets.count - 1) / 2) * scene.jets.spacing.value
        yield from surrogate_fibre(
            law,
            length,
            step=step,
            machine_speed=surface.surface_speed,
            centre=(0.0, across),
            jet=k,
            seed=scene.mat.seed,
        )


def rows_of(scene: MatScene) -> int:
    """Segments that `lay_scene` will make."""
    law = laydown_of(scene.laydown)
    if scene.collector.time is None:
        return 0
    spread, turning = scene.laydown.spread.value, scene.laydown.turning_length.value
    step = scene.laydown.step.value if scene.laydown.step else min(spread, turning) / 20
    return scene.jets.count * max(round(law.speed * scene.collector.time.value / step), 1)


def scene_jet(
    source: str | Path, overrides: Sequence[str]
) -> tuple[Path | LandingRecord | None, Surface | None, MatOptions | None]:
    """Bead run (or landings, of a jet that is blown for it), collector and options of a scene that has a ``[jet]``.

    (None, None, None) for one of laydown alone.

    Raises
    ------
    InputError
        Where the scene's jet has no beads that land, or the scene no collector.
    """
    from spinline.base.text import read_toml_text

    data, _ = read_toml_text(Path(source), "scene", 1_000_000, "give a scene file, a file of landings or a run")
    if "jet" not in data:
        return None, None, None
    from spinline.scene.file import load_scene

    scene = load_scene(source, overrides)
    if scene.jet.profile == "blown":
        return _blown(scene), _surface_of(scene), options_of(scene.mat) if scene.mat else None
    path = getattr(scene.jet, "path", None)
    if scene.jet.profile not in ("jetspin", "lagrangian") or path is None:
        raise InputError(
            "jet.profile",
            "has no beads that land",
            value=scene.jet.profile,
            remedy="`spinline spin` it first and give the file it writes"
            if scene.jet.profile == "spun"
            else "take a bead jet that ran to its collector, or give [laydown] in place of [jet]",
        )
    surface = _surface_of(scene)
    place = Path(path) if Path(path).is_absolute() else scene.folder / path
    return place, surface, options_of(scene.mat) if scene.mat else None


def _surface_of(scene: Any) -> Surface:
    if scene.collector is None:
        raise InputError("collector", "is missing", remedy='add [collector] with kind = "plate" and its distance')
    return collector_of(scene.collector)


def _blown(scene: Any) -> LandingRecord:
    """Landings of the jets of a blown scene, run here."""
    from spinline.setup.blown import blown_dataset
    from spinline.setup.build import build_solution

    return LandingRecord.from_dataset(landings_alone(blown_dataset(scene, build_solution(scene))))


def laid_file(source: str | Path | LandingRecord) -> Segments | None:
    """Fibres of a jet file whose run had its own collector; None for anything else."""
    if isinstance(source, LandingRecord):
        return None
    path = Path(source)
    if not path.exists() or not _netcdf(path):
        return None
    from spinline.base.netcdf import open_dataset

    data = open_dataset(path)
    return laid_by(data) if "deposit" in data.dims else None


def mat_kept(scene: "Scene") -> dict[str, str]:
    """``[mat]`` of a scene that is spun, as an attribute of its jet file: `deposit` hands it on to `mat`."""
    return {} if scene.mat is None else {"mat": options_text(options_of(scene.mat))}


def kept_options(source: str | Path | LandingRecord) -> str:
    """Options of a mat that a jet file has kept of its scene's ``[mat]``, as text; "" where it has none."""
    if isinstance(source, LandingRecord) or not _netcdf(Path(source)):
        return ""
    from spinline.base.netcdf import open_dataset

    return str(open_dataset(Path(source)).attrs.get("mat", ""))


def landings_of(source: str | Path | LandingRecord) -> LandingRecord:
    """Landings of a JETSPIN run (its ``bead.dat``) or of a file with the dimension `landing`.

    Raises
    ------
    InputError
        Where there are none.
    """
    if isinstance(source, LandingRecord):
        return source
    path = Path(source)
    if path.is_dir():
        path = path / "bead.dat"
        if not path.exists():
            raise InputError(
                str(source), "has no table of landed beads (bead.dat)", remedy="run JETSPIN with `print binary removed`"
            )
    if path.suffix == ".nc" or _netcdf(path):
        return LandingRecord.from_dataset(_with_landings(path))
    if not path.exists():
        raise InputError(str(source), "does not exist", remedy="give a run directory, a file of landings, or a scene")
    from spinline.jetprofile.jetspin import read_jetspin

    return landings_from_table(read_jetspin(path))


def _netcdf(path: Path) -> bool:
    """Whether a file is netCDF, by its first bytes, under whatever name."""
    if not path.is_file():
        return False
    with readable(path).open("rb") as file:
        return file.read(len(HDF5_HEAD)) == HDF5_HEAD


def _with_landings(path: Path) -> "xr.Dataset":
    from spinline.base.netcdf import open_dataset

    data = open_dataset(path)
    if "landing" not in data.dims:
        raise InputError(
            str(path),
            "has no landings",
            value=", ".join(map(str, data.dims)),
            remedy="run the jet until it reaches its collector, with its landings kept",
        )
    return landings_alone(data)
