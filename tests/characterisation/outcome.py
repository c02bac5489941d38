"""What a diagnosis says of a record of the characterisation set, in a few figures."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tests.characterisation.records import Recipe, made
from waxstudy.blind_test.record import digest_of
from waxstudy.simulation.threads import use_one_thread

RECORDS = Path(__file__).parents[2] / "results" / "characterisation"
DIGITS = 4


def outcome(recipe: Recipe) -> dict[str, Any]:
    """Return what a diagnosis says of a record, in a few figures."""
    use_one_thread()
    from waxstudy.dataset.read import read_dataset
    from waxstudy.diagnosis.diagnose import diagnose

    folder = RECORDS / recipe.name
    about = folder.with_suffix(".json")
    if not about.exists():
        about.parent.mkdir(parents=True, exist_ok=True)
        about.write_text(json.dumps(made(recipe, folder)), encoding="utf-8")
    begin = time.perf_counter()
    said = diagnose(read_dataset(folder), quick=recipe.is_quick).described()
    seconds = time.perf_counter() - begin
    drawn = json.loads(about.read_text(encoding="utf-8"))
    return {"name": recipe.name, **_summary(drawn, said), "digest": digest_of(folder)[:16], "seconds": seconds}


def _summary(drawn: Mapping[str, Any], said: Mapping[str, Any]) -> dict[str, Any]:
    measured = drawn["measured"]
    return {
        "causes": {each["name"]: _rounded(each["values"]) for each in drawn["causes"]},
        "measured": f"{measured['days']} d at {measured['interval_s']:g} s, noise {measured['noise_factor']:g}",
        "verdict": said["verdict"],
        "effects": [_effect(each) for each in said["effects"]],
        "unexplained": [[e["stage"], e["channel"], _excuse(e)] for e in said["unexplained"]],
        "gaps": {e["channel"]: _rounded([e["gap"], e["gap_after"], e["noise_floor"]]) for e in said["stages"]},
        "untestable": len(said["untestable"]),
    }


def _excuse(said: Mapping[str, Any]) -> str:
    """Return why what stays is no finding, empty where it is one."""
    return next((name for name in ("is_room_form", "is_covered", "is_of_drives") if said.get(name)), "")


def _effect(said: Mapping[str, Any]) -> dict[str, Any]:
    parameters = {name: _rounded([v["value"], v["low"], v["high"]]) for name, v in said["parameters"].items()}
    return {
        "group": said["group"],
        "channel": said["channel"],
        **parameters,
        "shrink": _rounded(said["shrink"]["value"]),
    }


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}") if value == value else None
    if isinstance(value, Mapping):
        return {name: _rounded(each) for name, each in value.items()}
    return [_rounded(each) for each in value] if isinstance(value, list | tuple) else value
