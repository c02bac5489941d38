"""Which parameters of a case are tuned, and between which bounds: as its blocks declare, or as is asked for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from waxstudy.plugin import CHAIN, Block, Choice, Tunable
from waxstudy.plugin.registry import nearest
from waxstudy.study.model import Case, Study
from waxstudy.study.problems import Problem, StudyError, listed, shown
from waxstudy.study.source import Source, read_source

DIGITS = 4  # of a value that is tried: the fragment holds what was tried
DEFAULT = "controller"  # kind whose declared parameters are tuned where none is asked for
Bounds = tuple[float, float]


@dataclass(frozen=True)
class Axis:
    """A parameter and its bounds."""

    kind: str
    name: str
    unit: str
    low: float
    high: float
    is_log: bool

    @property
    def key(self) -> str:
        return f"{self.kind}.{self.name}"

    def at(self, share: float) -> float:
        """Return the value at a share of the way, 0 to 1."""
        linear = self.low + share * (self.high - self.low)
        value = self.low * (self.high / self.low) ** share if self.is_log else linear
        return min(self.high, max(self.low, float(f"{value:.{DIGITS}g}")))

    def share(self, value: float) -> float:
        """Return how far a value is on the way from low to high."""
        if self.is_log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


def axes_of(study: Study, case: Case, asked: Mapping[str, Bounds | None]) -> list[Axis]:
    """Return what is tuned; `asked` are keys such as "controller.gain" with bounds, or None for those declared.

    Raises `StudyError` for parameters that are not there or no numbers, and bounds that exclude what the case has.
    """
    wrong = _Wrong(study, case)
    known = {f"{kind}.{name}": kind for kind, choice in case.blocks.items() for name in _numbers(choice)}
    asked = asked or {key: None for key, kind in known.items() if kind == DEFAULT and _declared(case, key)}
    if not asked:
        declared = [key for key in known if _declared(case, key)]
        raise wrong("", f"its {DEFAULT} declares nothing to be tuned", f"name what is, with --vary: {listed(declared)}")
    for key in asked:
        if key not in known:
            raise wrong(key, "no number among the parameters of this case", f"there are: {listed(known)}", known)
    return [_axis(case, key, bounds, wrong) for key, bounds in asked.items()]


def _axis(case: Case, key: str, bounds: Bounds | None, wrong: _Wrong) -> Axis:
    kind, _, name = key.partition(".")
    choice, declared = case.blocks[kind], _declared(case, key)
    if bounds is None and declared is None:
        raise wrong(key, f"{kind} '{choice.component.name}' declares no bounds for it", "write KEY=LOW..HIGH")
    low, high = bounds or (declared.low, declared.high) if declared else bounds or (0.0, 0.0)
    start = float(getattr(choice.parameters, name))
    if not low <= start <= high:
        raise wrong(key, f"lies outside the bounds {low:g} to {high:g} that it is to be tuned within", "", value=start)
    for end in (low, high):
        try:
            choice.changed(**{name: end})
        except ValueError as error:
            raise wrong(key, f"the bound {end:g} is refused: {error}", "") from None
    extra = type(choice.parameters).model_fields[name].json_schema_extra
    unit = str(extra.get("unit", "")) if isinstance(extra, dict) else ""
    return Axis(kind, name, unit, low, high, is_log=low > 0.0 and (declared.is_log if declared else high > 10.0 * low))


def _numbers(choice: Choice) -> list[str]:
    fields = type(choice.parameters).model_fields
    return [name for name in fields if isinstance(getattr(choice.parameters, name), float)]


def _declared(case: Case, key: str) -> Tunable | None:
    kind, _, name = key.partition(".")
    component = case.blocks[kind].component
    return component.tuned.get(name) if issubclass(component, Block) else None


class _Wrong:
    """What is wrong with a key of a case, at the line where the case has it."""

    def __init__(self, study: Study, case: Case) -> None:
        self.study, self.case = study, case

    def __call__(
        self, key: str, wrong: str, allowed: str, known: Sequence[str] | Mapping[str, str] = (), value: object = None
    ) -> StudyError:
        file = str(self.study.file or "study")
        text = "" if value is None else shown(value)
        place = (file, self._line(key), f"case {self.case.id}", key, text)
        return StudyError([Problem(*place, wrong, nearest(key, known), allowed)])

    def _line(self, key: str) -> int:
        try:
            return line_of(read_source(self.study.file), self.case, key) if self.study.file else 0
        except StudyError:  # the file has changed or gone since it was read
            return 0


def line_of(source: Source, case: Case, key: str) -> int:
    """Return the line where a case, or the last one before it that says so, has a parameter; else where it begins."""
    ladder = source.values["ladder"][case.ladder]
    path = ("ladder", case.ladder)
    steps = [(*path, "start"), *((*path, "steps", place) for place in range(len(ladder.get("steps", []))))]
    tables = [ladder["start"], *ladder.get("steps", [])]
    here = [table["id"] for table in tables].index(case.id)
    kind, _, name = key.partition(".")
    said = [place for place in range(here + 1) if name in tables[place].get(kind, {})]
    at = steps[said[-1]] if said else steps[here]
    return source.line((*at, kind, name))


def with_settings(study: Study, case: Case, settings: Mapping[str, float]) -> Study:
    """Return a study of one case alone with these settings; raise `ValueError` where its blocks refuse them."""
    blocks = dict(case.blocks)
    for key, value in settings.items():
        kind, _, name = key.partition(".")
        blocks[kind] = blocks[kind].changed(**{name: value})
    changed = replace(case, blocks={kind: blocks[kind] for kind in CHAIN if kind in blocks})
    ladder = replace(study.ladders[case.ladder], reference=case.id, cases=(case.id,))
    return replace(study, cases={case.id: changed}, ladders={case.ladder: ladder})
