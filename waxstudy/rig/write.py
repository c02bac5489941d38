"""The records of a programme as files: a folder as a laboratory would hand it over, and apart from it the truth."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import tomli_w

from waxstudy.results.atomic import whole_folder
from waxstudy.rig.bench import Motors, Recorded, run_trial
from waxstudy.rig.programme import Trial
from waxstudy.synthetic.write import truth_beside, write_truth
from waxstudy.version import __version__

DESCRIPTION = "records.toml"
MARK = "simulated by waxstudy rig: no motor was measured"


def write_rig(folder: Path, motors: Motors, programme: Sequence[Trial]) -> None:
    """Write every record, `records.toml` and, beside it, the truth; raise as `run_trial` and `write_truth` do."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    told: list[dict[str, Any]] = []
    with whole_folder(folder) as inside:
        for recorded in (run_trial(motors, trial) for trial in programme):
            _write_record(inside / f"{recorded.trial.name}.csv", recorded)
            told.append(_told(recorded))
        text = tomli_w.dumps(_description(motors, programme))
        (inside / DESCRIPTION).write_text(f"# {MARK}\n{text}", encoding="utf-8")
        write_truth(truth_beside(folder), json.dumps(_truth(motors, programme, told), indent=2) + "\n")


def _write_record(path: Path, recorded: Recorded) -> None:
    import pandas as pd

    name = "displacement_mm" if recorded.trial.measured == "displacement" else "flow_L_h"
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# {MARK}\n")
        table = pd.DataFrame({"time_s": recorded.time_s, name: recorded.value, "signal_V": recorded.signal_V})
        table.round({"time_s": 3, name: 4}).to_csv(file, index=False, lineterminator="\n")


def _description(motors: Motors, programme: Sequence[Trial]) -> dict[str, Any]:
    return {
        "simulated": True,
        "origin": f"waxstudy rig {__version__}, actuator {motors.actuator}",
        "record": {
            trial.name: {
                "file": f"{trial.name}.csv",
                "product": trial.product,
                "exemplar": trial.exemplar,
                "valve": trial.has_valve,
                "profile_min": trial.profile,
                "measured": trial.measured,
            }
            for trial in programme
        },
    }


def _told(recorded: Recorded) -> dict[str, Any]:
    return {"record": recorded.trial.name, "pace": dict(recorded.pace)}


def _truth(motors: Motors, programme: Sequence[Trial], records: Sequence[dict[str, Any]]) -> dict[str, Any]:
    products = sorted({trial.product for trial in programme})
    return {
        "simulated": True,
        "waxstudy": __version__,
        "seed": motors.seed,
        "actuator": {product: motors.actuator_of(product).described() for product in products},
        "valve": motors.valve_of().described(),
        "bench": motors.bench.model_dump(),
        "records": list(records),
    }
