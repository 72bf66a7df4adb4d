"""Sphinx's configuration of the site, which `make docs` builds of the Markdown here."""

import logging
import os
import sys
from pathlib import Path

import openmmhelfrich

sys.path.insert(0, str(Path(__file__).parent))

from _site import links, notebooks, pages

project = "openmm-helfrich"
author = "The openmm-helfrich developers"
version = release = openmmhelfrich.__version__
extensions = [
    "myst_nb",  # MyST-Parser, and notebooks
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
]
exclude_patterns = ["_site"]
default_role = "code"
highlight_language = "text"

# Anchors of headings are GitHub's, and a link to one that is not there is a warning.
myst_heading_anchors = 4

# Tutorials run as a reader runs them, from their own folder. What has run before with the same
# package is taken from the cache; an error in a cell ends the build.
nb_execution_mode = "cache"
nb_execution_cache_path = str(notebooks.cache_folder())
nb_execution_timeout = 600  # s, for a cell
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_merge_streams = True
logging.getLogger("traitlets").setLevel(logging.ERROR)  # not that a notebook runs
# Several run side by side, so one thread is enough for each.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OPENMM_CPU_THREADS"):
    os.environ[variable] = "1"

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
napoleon_google_docstring = False
napoleon_use_rtype = False

# Names of other packages have no page here.
nitpick_ignore_regex = [
    (r"py:.*", r"(?!openmmhelfrich).*"),
    (r"cpp:.*", r"(?!HelfrichPlugin::\w+Force$).*"),
    (r"c:.*", r"(?!Helfrich_).*"),
]

html_theme = "furo"
html_title = f"openmm-helfrich {release}"
html_static_path = ["_site/static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
smartquotes = False
copybutton_exclude = ".linenos, .gp, .go"


def setup(app):
    """Make the pages of forces and languages, and link what has no links of its own."""
    app.connect("builder-inited", lambda app: pages.write_all())
    links.setup(app)
