"""Documentation: `python -m sphinx -W --keep-going -b html docs docs/_build/html` from the repository's root."""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

import spinline

project = "spinline"
author = "The spinline developers"
copyright = "2026, The spinline developers"
version = release = spinline.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "mathml", "generated", "nearest"]
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
autodoc_default_options = {"members": True}
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

html_theme = "furo"
html_title = f"spinline {release}"
html_static_path = ["_static"]
html_css_files = ["spinline.css"]
html_math_renderer = "mathml"


def one_name_each(_app, _what, _name, _thing, _options, lines):
    """Split ``a, b : type`` of an Attributes section, which napoleon takes for one name."""
    if "Attributes" not in lines:
        return
    start = lines.index("Attributes") + 2
    for i in range(len(lines) - 1, start - 1, -1):
        match = re.fullmatch(r"(\w+(?:, \w+)+) : (.*)", lines[i])
        if match:
            stop = next((j for j in range(i + 1, len(lines)) if not lines[j].startswith(" ")), len(lines))
            words = lines[i + 1 : stop]
            lines[i:stop] = [line for name in match[1].split(", ") for line in (f"{name} : {match[2]}", *words)]


def setup(app):
    app.connect("autodoc-process-docstring", one_name_each, priority=400)
