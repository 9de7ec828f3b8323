"""The polymer network inside an electrospinning jet, and the microstructure it leaves.

>>> import spinline as sl
>>> jet = sl.jetprofile.PowerLaw(radius=125e-6, flow_rate=8.9e-10, k=1.0, beta=0.47)
>>> walk = sl.network.random_walk(velocity_ratio=jet.velocity_ratio(1e-3), volume_fraction=0.05)

The four physics packages stand alone (`jetprofile`, `rheology`, `network`, `xray`); the rooms beside this file tie them
together, each saying in its first lines what lives there: ``base, scene, setup, drying, network_models, plan, solve,
study, fit, recipe, images, radiography, report, cli``. Importing this module imports nothing heavy.
"""

from spinline import moved
from spinline.base.lazy import lazily
from spinline.base.version import __version__

TYPE_CHECKING = False  # typing itself would be most of the cost of this import
if TYPE_CHECKING:
    from spinline import images, jetprofile, network, report, rheology, scene, solve, xray
    from spinline.base import units
    from spinline.base.errors import InputError, SpinlineWarning
    from spinline.radiography import exposure, preview, reduce
    from spinline.radiography import reduction_dataset as reduction
    from spinline.radiography.preview import preview_images
    from spinline.radiography.reduce import reduce_images
    from spinline.recipe.recipe_file import fibre
    from spinline.report import figures
    from spinline.scene.file import Scene, load_scene
    from spinline.scene.images_file import Images, load_images
    from spinline.solve import results
    from spinline.solve.results import open_result
    from spinline.solve.spine import run
    from spinline.study import compare, sensitivity, sweep, window


_NAMES = {
    "Images": "scene.images_file",
    "InputError": "base.errors",
    "Scene": "scene.file",
    "SpinlineWarning": "base.errors",
    "compare": "study.compare:",
    "exposure": "radiography.exposure:",
    "fibre": "recipe.recipe_file",
    "figures": "report.figures:",
    "images": "images:",
    "jetprofile": "jetprofile:",
    "load_images": "scene.images_file",
    "load_scene": "scene.file",
    "network": "network:",
    "open_result": "solve.results",
    "preview": "radiography.preview:",
    "preview_images": "radiography.preview",
    "reduce": "radiography.reduce:",
    "reduce_images": "radiography.reduce",
    "reduction": "radiography.reduction_dataset:",
    "report": "report:",
    "results": "solve.results:",
    "rheology": "rheology:",
    "run": "solve.spine",
    "scene": "scene:",
    "sensitivity": "study.sensitivity:",
    "solve": "solve:",
    "sweep": "study.sweep:",
    "units": "base.units:",
    "window": "study.window:",
    "xray": "xray:",
}

__all__ = [
    "Images",
    "InputError",
    "Scene",
    "SpinlineWarning",
    "__version__",
    "compare",
    "exposure",
    "fibre",
    "figures",
    "images",
    "jetprofile",
    "load_images",
    "load_scene",
    "network",
    "open_result",
    "preview",
    "preview_images",
    "reduce",
    "reduce_images",
    "reduction",
    "report",
    "results",
    "rheology",
    "run",
    "scene",
    "sensitivity",
    "solve",
    "sweep",
    "units",
    "window",
    "xray",
]


__getattr__, __dir__ = lazily(__name__, _NAMES)
moved.install()
