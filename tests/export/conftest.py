"""FMUs, each made once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.export.importer import Fmu
from waxstudy.export.chain import block_model
from waxstudy.export.compiler import this_platform
from waxstudy.export.fmu import write_fmu
from waxstudy.plugin import Choice
from waxstudy.plugin.registry import installed

Made = Callable[..., Fmu]


@pytest.fixture(scope="session")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Return an FMU of an installed block, made once for each version and set of parameters."""
    known: dict[str, Fmu] = {}

    def made(
        kind: str = "actuator", name: str = "variable-times", fmi: int = 2, step_s: float = 5.0, **values: Any
    ) -> Fmu:
        key = repr((kind, name, fmi, step_s, values))
        if key not in known:
            folder: Path = tmp_path_factory.mktemp("fmu")
            model = block_model(Choice.of(installed().get(kind, name), values), step_s)
            write_fmu(folder / "block.fmu", model, fmi=fmi, platforms=[this_platform()])
            known[key] = Fmu(folder / "block.fmu", folder / "unpacked")
        return known[key]

    return made
