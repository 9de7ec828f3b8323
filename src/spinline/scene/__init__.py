"""The scene file and the images file as data: sections, quantities with units, keys, problems in words."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.scene.file import Scene, bundled_scenes, json_schema, load_scene, register_law, scene_from_dict

_NAMES = {
    "Scene": "file",
    "bundled_scenes": "file",
    "json_schema": "file",
    "load_scene": "file",
    "register_law": "file",
    "scene_from_dict": "file",
}

__all__ = [
    "Scene",
    "bundled_scenes",
    "json_schema",
    "load_scene",
    "register_law",
    "scene_from_dict",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
