"""axe-core over a page in the browser: what it finds that keeps people from using it.

The script is that of the npm package ``axe-core``, which is no part of this project: ``AXE_CORE`` names
the file, or it lies in ``node_modules`` (``npm install axe-core``).
"""

from __future__ import annotations

import os
from pathlib import Path

from .browser import Browser

_PLACES = (
    *([Path(os.environ["AXE_CORE"])] if os.environ.get("AXE_CORE") else []),
    Path(__file__).parents[2] / "node_modules" / "axe-core" / "axe.min.js",
    Path("/usr/lib/node_modules/axe-core/axe.min.js"),
    Path("/usr/local/lib/node_modules/axe-core/axe.min.js"),
)
SCRIPT = next((path for path in _PLACES if path.is_file()), None)
WITHOUT_AXE = "needs axe-core: npm install axe-core, or its script's path in AXE_CORE"

_RUN = """
axe.run(document, { resultTypes: ["violations"], preload: false }).then((found) =>
  found.violations.flatMap((rule) => rule.nodes.map((node) =>
    [rule.id, node.target.join(" "), rule.help, node.html.slice(0, 120)].join(": "))))
"""


def violations(browser: Browser) -> list[str]:
    """What axe-core finds on the page that is open: rule, place, what would be right."""
    assert SCRIPT is not None, WITHOUT_AXE
    browser.run(SCRIPT.read_text(encoding="utf-8") + "; undefined")
    found: list[str] = browser.run(_RUN)
    return found
