"""The polymer network inside an electrospinning jet, and the microstructure it leaves.

>>> import spinline as sl
>>> jet = sl.jetprofile.PowerLaw(radius=125e-6, flow_rate=8.9e-10, k=1.0, beta=0.47)
>>> walk = sl.network.random_walk(velocity_ratio=jet.velocity_ratio(1e-3), volume_fraction=0.05)

The four physics packages stand alone (`jetprofile`, `rheology`, `network`, `xray`); `scene`, `solve`,
`results`, `figures` and `report` tie them together. Importing this module imports nothing heavy.
"""

from typing import TYPE_CHECKING

from spinline.lazy import lazily

if TYPE_CHECKING:
    from spinline import (
        compare,
        exposure,
        figures,
        images,
        jetprofile,
        network,
        preview,
        reduce,
        reduction,
        report,
        results,
        rheology,
        scene,
        sensitivity,
        solve,
        sweep,
        units,
        window,
        xray,
    )
    from spinline.errors import InputError, SpinlineWarning
    from spinline.images import Images, load_images
    from spinline.preview import preview_images
    from spinline.reduce import reduce_images
    from spinline.results import open_result
    from spinline.scene import Scene, load_scene
    from spinline.solve import run

__version__ = "0.1.0"

_MODULES = frozenset(
    [
        "compare",
        "exposure",
        "figures",
        "images",
        "jetprofile",
        "network",
        "preview",
        "reduce",
        "reduction",
        "report",
        "results",
        "rheology",
        "scene",
        "sensitivity",
        "solve",
        "sweep",
        "units",
        "window",
        "xray",
    ]
)
_NAMES = {
    "Images": "images",
    "InputError": "errors",
    "Scene": "scene",
    "SpinlineWarning": "errors",
    "load_images": "images",
    "load_scene": "scene",
    "open_result": "results",
    "preview_images": "preview",
    "reduce_images": "reduce",
    "run": "solve",
}

__all__ = [
    "Images",
    "InputError",
    "Scene",
    "SpinlineWarning",
    "__version__",
    "compare",
    "exposure",
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


__getattr__, __dir__ = lazily(__name__, {module: module for module in _MODULES} | _NAMES)
