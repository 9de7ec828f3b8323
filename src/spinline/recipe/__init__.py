"""From a recipe to the fibre: what is believed of it, the chain on draws, intervals with their causes, regimes, tables."""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.recipe.believe import Recipe
    from spinline.recipe.measured import Measurement
    from spinline.recipe.model import UNKNOWNS, Believed, Fibres, spun
    from spinline.recipe.predict import Fibre
    from spinline.recipe.recipe_file import fibre, load_recipe
    from spinline.recipe.regime import REGIMES
    from spinline.recipe.table import predict_table, read_experiments, recipes_of

_NAMES = {
    "Believed": "model",
    "Fibre": "predict",
    "Fibres": "model",
    "Measurement": "measured",
    "REGIMES": "regime",
    "Recipe": "believe",
    "UNKNOWNS": "model",
    "fibre": "recipe_file",
    "load_recipe": "recipe_file",
    "predict_table": "table",
    "read_experiments": "table",
    "recipes_of": "table",
    "spun": "model",
}

__all__ = [
    "REGIMES",
    "UNKNOWNS",
    "Believed",
    "Fibre",
    "Fibres",
    "Measurement",
    "Recipe",
    "fibre",
    "load_recipe",
    "predict_table",
    "read_experiments",
    "recipes_of",
    "spun",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
