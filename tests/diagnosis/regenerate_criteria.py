"""Write docs/criteria.md again: `python -m tests.diagnosis.regenerate_criteria`."""

from __future__ import annotations

from docs_site.tables import table
from tests.conftest import ROOT
from waxstudy.report.diagnosis import criteria

PAGE = ROOT / "docs" / "criteria.md"
INTRO = """\
# The criteria

This page lists every limit that decides what a diagnosis says, as `waxstudy diagnose --criteria` prints them;
[diagnosis-method.md](diagnosis-method.md) says how they work together. It is written by `make golden` from
`waxstudy/diagnosis/criteria.csv`; `waxstudy/diagnosis/select/evidence.py` explains the numbers.

Of “is a room understood”, “does less stay than a room of another form would leave” and “is what stays no finding” one
criterion is enough; of all other questions every one that applies must hold. A number that was set on judged records
is marked: it is training, not proof.

"""


def page() -> str:
    """The page as it should be: its table lists the criteria, in their order."""
    listed = criteria.table()
    return INTRO + table(listed.names, listed.texts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8", newline="\n")
