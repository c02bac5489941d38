"""Write docs/criteria.md again: `python -m tests.diagnosis.regenerate_criteria`."""

from __future__ import annotations

from docs_site.tables import table
from tests.conftest import ROOT
from waxstudy.report.diagnosis import criteria

PAGE = ROOT / "docs" / "criteria.md"
INTRO = """\
# The criteria

This page lists the numbers that decide what a diagnosis says, as `waxstudy diagnose --criteria` prints them, without
those that say how closely it looks; [diagnosis-room.md](diagnosis-room.md) says how they work together. It is written
by `make golden` from `limits.csv`, `criteria.csv` and `weights.csv` in `waxstudy/diagnosis`; `select/evidence.py` there
explains the numbers.

## The limits

A number that was set on judged records is marked: it is training, not proof.

"""


CRITERIA = """\

What each of them decides on records that were made afresh, `python -m benchmarks.limits` tells
([diagnosis-limits.md](diagnosis-limits.md#what-each-limit-decides)).

## The criteria

Of “is a room understood” and “is what stays no finding” one criterion is enough; of all other questions every one that
applies must hold.

"""


WEIGHTS = """\

## The weights

By these [hypotheses are weighed](diagnosis-weighing.md), and answers are stated of a room without a healthy record.
What is chosen was looked at on 150 pairs and 170 single records that the blind test's own engines made, and on none
that is judged.

"""


def page() -> str:
    """The page as it should be: its tables list limits, criteria and weights, in their order."""
    parts = (
        (INTRO, criteria.table_of_limits()),
        (CRITERIA, criteria.table()),
        (WEIGHTS, criteria.table_of_weights()),
    )
    return "".join(words + table(found.names, found.texts) for words, found in parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8", newline="\n")
