"""The documentation site: Sphinx, MyST and numpydoc. `make docs` builds it.

The repository itself is the source folder, so that pages which stand elsewhere (the guide in `models`,
the notebooks, the changelog) are pages as they are, and links between files are links between pages.
Notebooks are shown as they are kept; the tests run them.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs" / "_ext"))

from msmrta_opt import __version__

project = "msmrta_opt"
author = "the authors of msmrta_opt"
version = release = __version__
language = "en"

extensions = [
    "sphinx.ext.autodoc",
    "numpydoc",
    "myst_nb",
    "mathml",
    "from_package",
    "accessible",
]
templates_path = ["_templates"]
root_doc = "docs/index"
include_patterns = [
    "docs/*.md",
    "notebooks/*.ipynb",
    "notebooks/README.md",
    "models/README.md",
    "instances/README.md",
    "instances/suite/README.md",
    "studies/README.md",
    "benchmarks/README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
]

nitpicky = True
nitpick_ignore_regex = [("py:.*", ".*")]
"""Types in signatures are of other packages, whose pages are elsewhere; pages and labels are checked."""
default_role = "code"

nb_execution_mode = "off"
myst_enable_extensions = ["amsmath", "dollarmath"]
myst_heading_anchors = 3
myst_url_schemes = ["http", "https", "mailto"]

autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
numpydoc_show_class_members = False
maximum_signature_line_length = 120
python_use_unqualified_type_names = True

pygments_style = "vs"
html_theme = "alabaster"
html_math_renderer = "mathml"
html_title = f"msmrta_opt {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_copyright = False
html_show_sphinx = False
html_show_sourcelink = False
html_copy_source = False
html_domain_indices = False
html_theme_options: dict[str, Any] = {
    "description": "An operations researcher's workbench for multi-robot task assignment",
    "fixed_sidebar": False,
    "page_width": "1180px",
    "sidebar_width": "250px",
    "show_powered_by": False,
}
html_sidebars = {"**": ["about.html", "searchfield.html", "navigation.html"]}
