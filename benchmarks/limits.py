"""What each limit of the criteria decides: `python -m benchmarks.limits SET KEYFILE`.

SET is a blind test's folder that was made for this, never one that is judged. Each record is diagnosed as if it had no
baseline, so that its room is asked the criteria as well (links of the chain are always weighed), and the truth is
opened. A limit decides where evidence fails by it alone, or passes by it alone. Such a limit is then taken away, and
the record diagnosed again. Told are the records in which a limit decides, those whose answer is another without it,
and how many of these turn right and wrong. Limits that are only read as numbers are not measured. What is done is kept
in SET/limits until the sources change: the same command goes on.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import replace
from functools import partial, partialmethod
from math import inf
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.self_consistency import sources
from waxstudy.blind_test.answer import Answer
from waxstudy.blind_test.box import open_box
from waxstudy.blind_test.key import Key
from waxstudy.blind_test.marks import Mark, Truth
from waxstudy.dataset.read import read_dataset
from waxstudy.diagnosis import criteria, diagnose
from waxstudy.diagnosis.criteria import ONE_IS_ENOUGH, Criterion, Question
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.start_points import Screen
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.select.search import Selection
from waxstudy.plugin.trial import engine_of
from waxstudy.results.atomic import whole_file
from waxstudy.simulation.threads import use_one_thread

ASKED = criteria._of
READ = {Question.NUISANCE, Question.JUDGE, Question.CONVENTION}  # questions whose limits are read as numbers
FITS = ("fit", "refined", "nuisance_fit")  # of an estimator; no limit that is taken away changes what they find
WORKERS = 2


class Watched:
    """Asks the criteria in the place of `criteria._of`, without one limit, and notes which ones decide alone."""

    def __init__(self, without: str = "") -> None:
        self.without, self.alone = without, set[str]()

    def __call__(self, question: Question, evidence: Any) -> Iterator[Criterion]:
        found = list(ASKED(question, evidence))
        is_one = question in ONE_IS_ENOUGH
        deciding = {each.limit.name for each in found if each.holds(evidence) is is_one}
        if len(deciding) == 1:
            self.alone |= deciding
        return (self._as_asked(each, not is_one) for each in found)

    def _as_asked(self, each: Criterion, is_met: bool) -> Criterion:
        """Return a criterion, of the limit that is taken away one that is always met, or never where one is enough."""
        if each.limit.name != self.without:
            return each
        is_least = each.operator in (">", ">=")
        return replace(each, limit=replace(each.limit, value=-inf if is_least is is_met else inf))


@contextmanager
def fits_kept() -> Iterator[None]:
    """Keep every fit while one record is diagnosed again and again: only which fits are asked for changes.

    Links that are weighed are asked no criteria, and are kept whole.
    """
    found: dict[Any, Hypothesis | None] = {}
    alive: list[Any] = []  # problems, so that no other one gets the identity of one that is gone
    links: dict[str, Selection] = {}

    def kept_link(work: Any, segment: Segment, *given: Any) -> Selection:
        if segment.name not in links:
            links[segment.name] = weighed(work, segment, *given)
        return links[segment.name]

    def kept(name: str, estimator: Estimator[Any], *given: Any, **named: Any) -> Hypothesis | None:
        problem = estimator.problem
        of = name, id(problem), estimator.thorough, estimator.keeps
        asked = *of, _plain(given), _plain(sorted(named.items()))
        if asked not in found:
            alive.append(problem)
            found[asked] = own[name](estimator, *given, **named)
        return found[asked]

    own, weighed = {name: getattr(Estimator, name) for name in FITS}, diagnose._changed
    diagnose._changed = kept_link
    for name in FITS:
        setattr(Estimator, name, partialmethod(partial(kept, name)))
    try:
        yield
    finally:
        diagnose._changed = weighed
        for name in FITS:
            setattr(Estimator, name, own[name])


def _plain(value: Any) -> Any:
    """Return what can be a key in place of hypotheses, screens, arrays, lists and mappings."""
    if isinstance(value, Screen):
        return _plain((value.least, value.share))
    if isinstance(value, Hypothesis):
        return _plain((value.effects, value.departures, value.convention))
    if isinstance(value, np.ndarray):
        return value.tobytes()
    if isinstance(value, Mapping):
        return tuple((key, _plain(each)) for key, each in value.items())
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return tuple(map(_plain, value))
    return value


def answered(record: Path, watched: Watched) -> dict[str, Any]:
    """Return what a diagnosis says of a record, as its JSON has it."""
    criteria._of = watched
    try:
        return json.loads(json.dumps(diagnose.diagnose(read_dataset(record)).described(), default=str))
    finally:
        criteria._of = ASKED


def done(folder: Path, name: str) -> Mapping[str, Any]:
    """Diagnose one record with all limits, then without each that decides; return what is said of it."""
    path = folder / "limits" / f"{name}-{sources()}.json"
    if not path.exists():
        whole = Watched()
        with fits_kept():
            said: dict[str, Any] = {"": answered(folder / "records" / name, whole)}
            for limit in sorted(whole.alone):
                said[limit] = answered(folder / "records" / name, Watched(limit))
        with whole_file(path) as place:
            place.write_text(json.dumps(said) + "\n", encoding="utf-8")
    return json.loads(path.read_text(encoding="utf-8"))


def table(told: Mapping[str, tuple[Truth, Mapping[str, Any]]]) -> Iterator[str]:
    """Yield a line for each limit."""
    yield "| limit | decides in | answer is another | turns right | turns wrong |"
    yield "|---|---|---|---|---|"
    for limit in _measured():
        marks = [(_mark(t, said[""]), _mark(t, said[limit])) for t, said in told.values() if limit in said]
        other = [(old, new) for old, new in marks if _named(old) != _named(new)]
        better = sum(new.is_right and not old.is_right for old, new in other)
        worse = sum(old.is_right and not new.is_right for old, new in other)
        yield f"| {limit} | {len(marks)} of {len(told)} | {len(other)} | {better} | {worse} |"


def _measured() -> list[str]:
    """Return the limits that some evidence is held against, in their order."""
    asked = {each.limit.name for each in criteria.criteria() if set(each.questions) - READ}
    return [name for name in criteria.limits() if name in asked]


def _mark(truth: Truth, said: Mapping[str, Any]) -> Mark:
    return Mark(truth, Answer.read(said))


def _named(mark: Mark) -> tuple[set[frozenset[str]], set[frozenset[str]]]:
    return {claim.group for claim in mark.answer.claims}, set(mark.answer.open_stages)


def main(folder: Path, key: Key) -> None:
    (folder / "limits").mkdir(exist_ok=True)
    truths = {}
    for box in sorted((folder / "boxes").glob("*.box")):
        truth = Truth.read(open_box(key, box.stem, box.read_bytes()))
        if not engine_of(truth.engine).is_kept:
            truths[box.stem] = truth
    told = {}
    use_one_thread()
    with ProcessPoolExecutor(WORKERS, get_context("spawn")) as pool:  # libraries are loaded after that
        tasks = {pool.submit(done, folder, name): name for name in truths}
        for task in as_completed(tasks):
            name = tasks[task]
            told[name] = (truths[name], task.result())
            print(f"{len(told)} of {len(truths)}: {name}, {truths[name].label}", file=sys.stderr, flush=True)
    print("\n".join(table(told)))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Key.read(Path(sys.argv[2]).read_text(encoding="utf-8").strip()))
