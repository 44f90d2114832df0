"""The folder of formulations, as a package.

Its path points at the checkout's ``models/`` where ``pyproject.toml`` sits beside it, and at the copy
shipped in the wheel otherwise; `registry.add_models` adds folders of one's own.
"""

from pathlib import Path

_package = Path(__file__).resolve().parents[1]
_checkout = _package.parent
if (_checkout / "pyproject.toml").is_file() and (_checkout / "models").is_dir():
    __path__ = [str(_checkout / "models")]
else:
    __path__ = [str(_package / "_shipped" / "models")]
