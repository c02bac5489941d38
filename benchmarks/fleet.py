"""What a fleet costs: 1,000 loops through a call of 15 min, beside the same chain by hand in one function."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.timing import best_s, processor_s
from waxstudy.fleet.batch import computed, course_of
from waxstudy.fleet.course import copied
from waxstudy.fleet.prepare import prepared
from waxstudy.plugin.registry import installed
from waxstudy.study.read import read_study

STUDY = Path(__file__).parents[1] / "studies" / "activation.toml"
CALL_STEPS = 180  # 15 min at 5 s
WHOLE = 10  # loops through all states and calls of the study, warm-up included


def fleet_figures(by_hand: Callable[..., float]) -> None:
    """Print the time of a call, without what comes before it, and that of a loop through the whole study."""
    fleet = prepared(read_study(STUDY, installed()))
    week, case = next(iter(fleet.study.weeks)), fleet.cases[0]
    courses = [course_of(fleet, member, week, case) for member in fleet.members]
    state = courses[0].warm(fleet.members[0].start)

    def call() -> None:
        for course in courses:
            course.run(copied(state), 0, CALL_STEPS, 1.0)

    readings = 21.0 + 0.5 * np.sin(np.arange(CALL_STEPS) / 400.0)
    reference = best_s(lambda: [by_hand(readings, 21.0, 5.0) for _ in courses])
    taken = best_s(call)
    print(f"\nfleet of {len(courses):,} loops for 15 min at 5 s, from warm states: {taken:.2f} s (limit 0.5 s)")
    print(f"by hand, no room: {reference:.4f} s, {taken / reference:.0f} times; ", end="")
    begin = processor_s()
    computed(fleet, range(WHOLE), fleet.stop)
    each = (processor_s() - begin) / WHOLE
    print(f"a loop through the whole study, warm-ups included: {1000.0 * each:.0f} ms (limit 100 ms)")
