"""One simulated loop of 14 days as eight exports: how much importing them asks, and whether the verdict stays.

    python -m benchmarks.exports [--quick] [NAME ...]

The verdict of each export is held against that of the record cut to the same channels (docs/what-is-believed.md).
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import pandas as pd
import tomli_w

from tests.importing.exports import CHANNELS, MAKERS, Export
from waxstudy.api.diagnosing import Found, diagnose
from waxstudy.dataset.channels import CHANNELS as ALL
from waxstudy.importing.asking import Question
from waxstudy.importing.bring import bring
from waxstudy.importing.request import Request
from waxstudy.importing.write import write
from waxstudy.plugin.registry import installed
from waxstudy.study.read import read_study
from waxstudy.synthetic.instruments import Instruments, measure
from waxstudy.synthetic.simulate import reality_loop, simulate

STUDY = Path(__file__).parent.parent / "studies" / "table5.toml"
SETPOINT_C = 21.0
# what is believed: the truth, O_WM, but for its motor
BELIEVED: dict[str, Any] = {
    "nominal": {
        "setpoint_C": SETPOINT_C,
        "sensor": {"use": "delay", "delay_s": 120.0},
        "controller": {"use": "on-off", "dead_band_K": 0.5},
        "valve": {"use": "quick-opening"},
    },
    "room": {"use": "nzeb"},
}


class Row(NamedTuple):
    """What one export came to."""

    name: str
    questions: int
    import_s: float
    diagnose_s: float
    verdict: str
    effects: tuple[str, ...]


class Answering:
    """Answers as the export's options do, and counts what is asked."""

    def __init__(self, stated: Sequence[str]) -> None:
        self.answers = dict(zip(stated[::2], stated[1::2], strict=True))
        self.questions = 0

    def __call__(self, question: Question) -> str:
        self.questions += 1
        return self.answers[question.option.strip()]


def record_of(weeks: Sequence[str] = ("january", "february"), days: int = 14) -> pd.DataFrame:
    """Return the channels that a house may log, every minute."""
    study = read_study(STUDY, installed())
    reality = simulate(reality_loop(study, study.cases["O_WM"], list(weeks), days), study, SETPOINT_C)
    data = measure(reality, Instruments(without=tuple(name for name in ALL if name not in CHANNELS)))
    return data.set_index(pd.DatetimeIndex(data["time"], name="time"))[list(CHANNELS)]


def imported(export: Export, out: Path) -> int:
    """Import an export; return how many questions were asked."""
    answering = Answering(export.stated)
    write(out, bring(Request([export.source]), answering))
    return answering.questions


def cut(record: pd.DataFrame, out: Path) -> None:
    """Write the record itself as a dataset."""
    out.mkdir()
    record.to_csv(out / "data.csv", date_format="%Y-%m-%dT%H:%M:%S")
    (out / "dataset.toml").write_text("[dataset]\ninterval_s = 60\n", encoding="utf-8")


def judged(folder: Path, quick: bool) -> Found:
    """Return the diagnosis of a dataset by what is believed of it here."""
    path = folder / "dataset.toml"
    about = path.read_text(encoding="utf-8").partition("[nominal]")[0]
    path.write_text(about + tomli_w.dumps(BELIEVED), encoding="utf-8")
    return diagnose(folder, quick=quick)


def rows(record: pd.DataFrame, names: Sequence[str], place: Path, quick: bool) -> Iterator[Row]:
    """Yield what the record itself comes to, then each of its exports."""
    cut(record, place / "cut")
    yield _row("the record itself", 0, 0.0, place / "cut", quick)
    for make in MAKERS:
        if make.__name__ in names:
            export = make(record, place)
            began, out = time.perf_counter(), place / f"imported-{make.__name__}"
            questions = imported(export, out)
            yield _row(make.__name__, questions, time.perf_counter() - began, out, quick)


def _row(name: str, questions: int, import_s: float, folder: Path, quick: bool) -> Row:
    began = time.perf_counter()
    found = judged(folder, quick)
    effects = tuple(sorted(each.name for each in found.diagnosis.effects))
    return Row(name, questions, import_s, time.perf_counter() - began, found.verdict, effects)


def main(arguments: Sequence[str]) -> None:
    quick, names = "--quick" in arguments, [each for each in arguments if each != "--quick"]
    print(f"{'export':26}{'questions':>10}{'import s':>10}{'diagnose s':>11}  verdict", flush=True)
    with TemporaryDirectory(prefix="waxstudy-exports-") as place:
        for row in rows(record_of(), names or [make.__name__ for make in MAKERS], Path(place), quick):
            told = f"{row.verdict}: {', '.join(row.effects)}" if row.effects else row.verdict
            figures = f"{row.questions:>10}{row.import_s:>10.1f}{row.diagnose_s:>11.1f}"
            print(f"{row.name:26}{figures}  {told}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
