"""The programme of a test bench: which exemplar of which product is heated how, and for how long."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy.plugin.files import read_file, why
from waxstudy.study.model import NAME_RULE, is_safe_name
from waxstudy.study.problems import Problem, StudyError, listed, shown

COLUMNS = ("combination", "product", "exemplar", "valve", "on_min", "off_min", "duration_min", "measured")
LONGEST_MIN = 100_000.0
MEASURED = ("displacement", "flow")
YES_NO = {"yes": True, "no": False}

Range = tuple[float, float]


@dataclass(frozen=True)
class Trial:
    """One record of a programme; on and off times are drawn evenly between their limits."""

    combination: str
    product: str
    exemplar: str
    has_valve: bool
    on_min: Range
    off_min: Range
    duration_min: float
    measured: str  # displacement or flow

    @property
    def profile(self) -> str:
        """On and off time in minutes, as `15-45` or `5to15-5to15`."""
        on, off = (f"{low:g}to{high:g}" if low < high else f"{low:g}" for low, high in (self.on_min, self.off_min))
        return f"{on}-{off}"

    @property
    def name(self) -> str:
        return f"{self.combination}_{self.profile}"

    def lengths_s(self, draw: np.random.Generator) -> FloatArray:
        """Return on and off times in turn [s], enough for the whole record."""
        shortest_s = 60.0 * (self.on_min[0] + self.off_min[0])
        count = int(np.ceil(60.0 * self.duration_min / shortest_s)) + 1
        pairs = [draw.uniform(*self.on_min, count), draw.uniform(*self.off_min, count)]
        return 60.0 * np.column_stack(pairs).ravel()


def table_a1() -> list[Trial]:
    """Return the records of Table A1 and one of flow: B2 in the manifold, heated 15-15 min (section 3.2.1).

    The paper does not say how long the flow was recorded; 12 h are chosen.
    """
    return _trials("table_a1.csv", files("waxstudy.rig").joinpath("table_a1.csv").read_text(encoding="utf-8"))


def read_programme(path: Path) -> list[Trial]:
    """Return the trials of a CSV file with the columns of `table_a1.csv`; raise `StudyError`."""
    try:
        text = read_file(path).decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise StudyError([Problem(str(path), 0, "", "", "", f"cannot be read: {why(error)}")]) from None
    return _trials(str(path), text)


def _trials(file: str, text: str) -> list[Trial]:
    rows = csv.DictReader(text.splitlines())
    if missing := [name for name in COLUMNS if name not in (rows.fieldnames or ())]:
        wrong = f"a programme needs the columns {listed(COLUMNS)}; missing: {listed(missing)}"
        raise StudyError([Problem(file, 1, "", "", "", wrong)])
    trials, problems = [], []
    for row in rows:
        try:
            trials.append(_trial(row))
        except _Wrong as wrong:
            problems.append(Problem(file, rows.line_num, "", wrong.key, shown(row[wrong.key]), str(wrong)))
    names = [trial.name for trial in trials]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        problems.append(Problem(file, 0, "", "", "", f"these records are there twice: {listed(twice)}"))
    if not trials and not problems:
        problems.append(Problem(file, 0, "", "", "", "has no record"))
    if problems:
        raise StudyError(problems)
    return trials


class _Wrong(ValueError):
    def __init__(self, key: str, wrong: str) -> None:
        super().__init__(wrong)
        self.key = key


def _trial(row: Mapping[str, str | None]) -> Trial:
    for key in ("combination", "product", "exemplar"):
        if not is_safe_name(row[key]):
            raise _Wrong(key, NAME_RULE)
    return Trial(
        str(row["combination"]),
        str(row["product"]),
        str(row["exemplar"]),
        YES_NO[_word(row, "valve", tuple(YES_NO))],
        _range(row, "on_min"),
        _range(row, "off_min"),
        _range(row, "duration_min")[1],
        _word(row, "measured", MEASURED),
    )


def _word(row: Mapping[str, str | None], key: str, allowed: Sequence[str]) -> str:
    if row[key] not in allowed:
        raise _Wrong(key, f"must be one of {listed(allowed)}")
    return str(row[key])


def _range(row: Mapping[str, str | None], key: str) -> Range:
    """Return a number twice, or the two limits of `5-15`."""
    low, _, high = str(row[key]).partition("-")
    try:
        limits = float(low), float(high or low)
    except ValueError:
        raise _Wrong(key, "must be minutes, such as 15, or limits, such as 5-15") from None
    if not 0.1 <= limits[0] <= limits[1] <= LONGEST_MIN:
        raise _Wrong(key, f"must lie within 0.1 to {LONGEST_MIN:g} min, the smaller limit first")
    return limits
