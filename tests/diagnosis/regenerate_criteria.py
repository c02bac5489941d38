"""Write criteria and weights in docs/diagnosis-method.md again: `python -m tests.diagnosis.regenerate_criteria`."""

from __future__ import annotations

import re
from collections.abc import Sequence

from tests.conftest import ROOT
from waxstudy.report.diagnosis.criteria import table, table_of_weights


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |\n"


PAGE = ROOT / "docs" / "diagnosis-method.md"


def page() -> str:
    """The page as it should be: its tables list the criteria and the weights, in their order."""
    written = PAGE.read_text(encoding="utf-8")
    for each in (table(), table_of_weights()):
        head = _line(each.names) + _line(["---"] * len(each.names))
        lines = head + "".join(map(_line, each.texts))
        rows = re.escape(head) + r"(\|.*\n)*"
        written, found = re.subn(rows, lambda _, lines=lines: lines, written)  # type: ignore[misc]
        assert found == 1, f"{PAGE.name} should have one table of {each.name}"
    return written


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8", newline="\n")
