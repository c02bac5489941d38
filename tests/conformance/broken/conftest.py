"""All broken plugins installed at once, as in a careless engineer's environment."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cli.conftest import entry
from tests.conformance.broken.catalogue import UNREGISTERED, USED
from tests.conformance.broken.plugin import install, module_of
from waxstudy.plugin.registry import installed

__all__ = ["entry"]


@pytest.fixture(scope="session")
def shelf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with every plugin of the catalogue."""
    folder = tmp_path_factory.mktemp("shelf")
    for name, plugin in {**UNREGISTERED, **USED}.items():
        install(folder, name, plugin.source)
    return folder


@pytest.fixture(scope="package")
def all_installed(shelf: Path) -> Iterator[Path]:
    """All of them installed for the test process itself."""
    sys.path.insert(0, str(shelf))
    installed.cache_clear()
    yield shelf
    sys.path.remove(str(shelf))
    for name in (*UNREGISTERED, *USED):
        sys.modules.pop(module_of(name), None)
    installed.cache_clear()
