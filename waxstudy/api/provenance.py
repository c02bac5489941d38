"""Where a diagnosis comes from: software, data, what is believed, seed and command."""

from __future__ import annotations

import json
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import installed_effects
from waxstudy.plugin.files import DATA_BYTES, read_file, why
from waxstudy.results.folder import RunError
from waxstudy.simulation.software import software

FORMAT = 1  # of diagnosis.json; those of earlier versions have no number
FILE = "diagnosis.json"


def provenance(judged: Dataset, baseline: Dataset | None, seed: int, options: Sequence[str]) -> dict[str, Any]:
    """Return where a diagnosis comes from; `options` beside the dataset give the same one again.

    There is no such command for a record that lies in no folder.
    """
    chosen = [*judged.nominal.values(), *([judged.room] if judged.room else [])]
    used = [each.component for each in chosen]
    is_kept = all(each.folder.is_dir() for each in (judged, baseline) if each)
    return {
        **software([*used, *installed_effects()]),
        "data_sha256": dict(judged.sha256),
        **({"baseline_sha256": dict(baseline.sha256)} if baseline else {}),
        "believed": {
            "chain": {kind: choice.described() for kind, choice in judged.nominal.items()},
            "setpoint_C": judged.setpoint_C,
            "room": judged.room.described() if judged.room else None,
            "room_tolerance": judged.room_tolerance,
        },
        "seed": seed,
        "command": shlex.join(["waxstudy", "diagnose", str(judged.folder), *options]) if is_kept else None,
    }


def read_diagnosis(path: str | Path) -> dict[str, Any]:
    """Return what diagnosis.json holds (docs/diagnosis-json.md); `path`: it, or its folder.

    Raises `RunError` for what is none, or of a format that this version does not read.
    """
    file = Path(path) / FILE if Path(path).is_dir() else Path(path)
    try:
        found = json.loads(read_file(file, DATA_BYTES))
    except (OSError, ValueError) as error:
        raise RunError(f"{file}: cannot be read: {why(error)}") from error
    given = found.get("format", 0) if isinstance(found, dict) else None
    if not isinstance(given, int) or "verdict" not in found:
        raise RunError(f"{file}: holds no diagnosis")
    if given > FORMAT:
        raise RunError(f"{file}: diagnosis of format {given}, this version reads up to {FORMAT}: take a later waxstudy")
    return dict(found)
