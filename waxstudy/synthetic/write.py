"""Writing a dataset and, apart from it, its truth."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import tomli_w

from waxstudy.dataset.channels import CHANNELS
from waxstudy.results.atomic import whole_file, whole_folder
from waxstudy.study.model import Case, Choice, Study
from waxstudy.synthetic.instruments import Instruments, measure
from waxstudy.synthetic.simulate import Reality
from waxstudy.version import __version__

ORIGIN = f"a room simulated by waxstudy {__version__} with its own control chain, as instruments would show it"


class OtherTruth(Exception):
    """There is a truth of this name, and it says other things; the message is its path."""


@dataclass(frozen=True)
class Telling:
    """What is told of a reality: the case that it is, the one that the modeller believes, and in which weeks.

    `effects` are those that the reality has besides; of them, the case has what is in its chain.
    """

    study: Study
    case: Case
    believed: Case
    weeks: Sequence[str]
    setpoint_C: float
    effects: Sequence[Choice] = ()

    def nominal(self) -> dict[str, Any]:
        return _configuration(self.believed) | {"setpoint_C": self.setpoint_C}

    def differences(self) -> dict[str, dict[str, Any]]:
        """Return the blocks that differ: what is believed and what is true, None for no block."""
        believed, true = _configuration(self.believed), _configuration(self.case)
        kinds = [kind for kind in {**believed, **true} if believed.get(kind) != true.get(kind)]
        return {kind: {"believed": believed.get(kind), "true": true.get(kind)} for kind in kinds}

    def steps(self) -> list[str]:
        """Return the cases of the ladder after the believed one up to the true one; none backwards or across."""
        cases = list(self.study.ladders[self.case.ladder].cases)
        if self.believed.id not in cases:
            return []
        return cases[cases.index(self.believed.id) + 1 : cases.index(self.case.id) + 1]


def truth_beside(folder: Path) -> Path:
    """Return where the truth of a dataset goes: never into its folder.

    >>> truth_beside(Path("data/room-7")).as_posix()
    'data/room-7-truth.json'
    """
    whole = folder if folder.name not in ("", "..") else folder.resolve()
    return whole.with_name(f"{whole.name}-truth.json")


def write(folder: Path, telling: Telling, reality: Reality, instruments: Instruments) -> None:
    """Write the dataset's folder and the truth, both whole or not at all.

    Raises `RealityError`, `OSError`, or `OtherTruth` where there is one.
    """
    data = measure(reality, instruments)
    about = described(folder.name, telling, list(data.columns[1:]), instruments)
    hidden = truth_of(folder.name, telling, reality, instruments)
    folder.parent.mkdir(parents=True, exist_ok=True)
    # outermost, the folder takes its place last: no dataset without its truth
    with whole_folder(folder) as place:
        data.to_csv(place / "data.csv", index=False, lineterminator="\n")
        (place / "dataset.toml").write_bytes(tomli_w.dumps(about).encode())
        write_truth(truth_beside(folder), json.dumps(hidden, indent=1) + "\n")


def write_truth(path: Path, text: str) -> None:
    """Write a truth; the same may be there, left by a command that was killed. Raises `OtherTruth` for another."""
    if os.path.lexists(path):
        if not path.is_file() or path.read_text(encoding="utf-8", errors="replace") != text:
            raise OtherTruth(path)
        return
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def described(name: str, telling: Telling, names: Sequence[str], instruments: Instruments) -> dict[str, Any]:
    """Return dataset.toml, which says nothing of the true case."""
    channels = [CHANNELS[name] for name in names]
    noise = {channel.name: instruments.noise_of(channel) for channel in channels}
    inputs = [c.name for c in channels if c.is_assumed and c.name != "setpoint_C"]
    interval_s = instruments.interval_s
    return {
        "dataset": {
            "name": name,
            "interval_s": int(interval_s) if interval_s.is_integer() else interval_s,
            "origin": ORIGIN,
            "inputs": inputs,
        },
        "nominal": telling.nominal(),
        "room": telling.study.room.described(),
        "noise": {name: sd for name, sd in noise.items() if sd > 0.0},
    }


def truth_of(name: str, telling: Telling, reality: Reality, instruments: Instruments) -> dict[str, Any]:
    """Return what the dataset is to be judged by."""
    study = telling.study
    effects = [{"name": e.component.name, "parameters": e.parameters.model_dump()} for e in telling.effects]
    return {
        "dataset": name,
        "case": telling.case.id,
        "believed": telling.believed.id,
        **({"effects": effects} if effects else {}),
        "steps": telling.steps(),
        "differences": telling.differences(),
        "true_configuration": _configuration(telling.case),
        "setpoint_C": telling.setpoint_C,
        "room": study.room.described(),
        "weather": [{"week": week, **study.weeks[week].described()} for week in telling.weeks],
        "step_s": study.step_s,
        "figures": reality.figures(),
        "instruments": {**asdict(instruments), "without": list(instruments.without)},
        "versions": _versions() | ({"engine": reality.engine} if reality.engine else {}),
    }


def _configuration(case: Case) -> dict[str, Any]:
    return {kind: choice.described() for kind, choice in case.blocks.items()}


def _versions() -> dict[str, str]:
    packages = {name: version(name) for name in ("waxstudy", "numpy", "scipy", "numba", "pandas")}
    return packages | {"python": sys.version.split()[0]}
