"""Documentation: `python -m sphinx -W --keep-going -b html docs docs/_build/html` from the repository's root."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

import spinline

project = "spinline"
author = "The spinline developers"
copyright = "2026, The spinline developers"
version = release = spinline.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "mathml", "generated"]
exclude_patterns = ["_build", "**.ipynb_checkpoints"]
nitpicky = False
default_role = "py:obj"

# the notebooks hold no outputs: every build runs them, and one that fails fails the build
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_execution_in_temp = True
nb_merge_streams = True

myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
myst_dmath_double_inline = True

autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "show-inheritance": False}
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

html_theme = "furo"
html_title = f"spinline {release}"
html_static_path = ["_static"]
html_css_files = ["spinline.css"]
html_math_renderer = "mathml"
