"""What lies behind the names that two runs share: where it differs, figures differ for more than one reason."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from pathlib import PurePath
from typing import Any

from waxstudy.results.folder import RunError, again
from waxstudy.results.run import Run


def differing_inputs(run: Run, other: Run) -> list[str]:
    """Say where step, room, weather, comfort or a case's blocks differ behind the same names (here, there)."""
    ours, theirs = _named(run), _named(other)
    shared = [name for name in ours if name in theirs]
    found = {name: ", ".join(differences(ours[name], theirs[name])) for name in shared}
    return [f"not the same in both runs: {name}: {said}" for name, said in found.items() if said]


def _named(run: Run) -> dict[str, dict[str, Any]]:
    """Return a run's inputs by what they are called; raise `RunError` where its study cannot be read."""
    try:
        study = tomllib.loads(run.study_file.read_text(encoding="utf-8"))
        cases = [case for ladder in study["ladder"].values() for case in (ladder["start"], *ladder["steps"])]
        return {
            "study": {"step_s": study["study"]["step_s"]},
            "room": study["room"],
            **{f"weather {week}": weather for week, weather in study["weather"].items()},
            "comfort": study["comfort"],
            **{f"case {case['id']}": case for case in cases},
        }
    except (OSError, ValueError, KeyError) as error:
        raise RunError(f"{run.study_file}: cut off or damaged; {again(run.folder)}") from error


def differences(ours: Mapping[str, Any], theirs: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    """Yield each key that differs with both values; of another component only its name."""
    keys = ["use"] if ours.get("use") != theirs.get("use") else dict.fromkeys([*ours, *theirs])
    for key in keys:
        one, two = ours.get(key), theirs.get(key)
        if isinstance(one, dict) and isinstance(two, dict):
            yield from differences(one, two, f"{prefix}{key}.")
        elif one != two and key == "path":  # a report is passed on: no folders of this machine
            names = [PurePath(str(path)).name for path in (one, two)]
            yield f"{prefix}path ({', '.join(names)}{', in another folder' if names[0] == names[1] else ''})"
        elif one != two:
            yield f"{prefix}{key} ({_shown(one)}, {_shown(two)})"


def _shown(value: Any) -> str:
    """A value in a few characters; of a table that names a component, the name."""
    if isinstance(value, dict):
        return str(value.get("use", "..."))
    return "none" if value is None else "..." if isinstance(value, list) else str(value)
