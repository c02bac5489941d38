"""What a result was computed with."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterable
from importlib.metadata import version
from typing import Any

from waxstudy.plugin import Component
from waxstudy.plugin.registry import installed

PACKAGES = ("waxstudy", "numpy", "scipy", "numba", "llvmlite", "pandas")


def software(used: Iterable[type[Component]]) -> dict[str, Any]:
    """Return the versions of the plugins that have these components, of what computes, and the machine's kind."""
    plugins = {entry.package: entry.version for entry in map(installed().package_of, used)}
    return {
        "plugins": dict(sorted(plugins.items())),
        "packages": {name: version(name) for name in PACKAGES},
        "python": sys.version.split()[0],
        "machine": f"{platform.system()} {platform.machine()}",
    }
