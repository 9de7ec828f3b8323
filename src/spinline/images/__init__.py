"""X-ray frames on disk: formats, stacks, flat and dark, photons. The images file itself is data of `spinline.scene`."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.scene.images_file import (
        KEV,
        Images,
        Source,
        bundled_images,
        images_from_dict,
        images_schema,
        load_images,
    )

_FILE = "spinline.scene.images_file"
_NAMES = dict.fromkeys(
    ("KEV", "Images", "Source", "bundled_images", "images_from_dict", "images_schema", "load_images"), _FILE
)

__all__ = ["KEV", "Images", "Source", "bundled_images", "images_from_dict", "images_schema", "load_images"]

__getattr__, __dir__ = lazily(__name__, _NAMES)
