"""Write the table of criteria in docs/diagnosis-method.md again: `python -m tests.diagnosis.regenerate_criteria`."""

from __future__ import annotations

import re
from collections.abc import Sequence

from tests.conftest import ROOT
from waxstudy.report.diagnosis.criteria import table


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |\n"


PAGE = ROOT / "docs" / "diagnosis-method.md"
HEAD = _line(table().names) + _line(["---"] * len(table().names))


def page() -> str:
    """The page as it should be: its table lists the criteria, in their order."""
    rows = re.escape(HEAD) + r"(\|.*\n)*"
    text, found = re.subn(rows, lambda _: HEAD + "".join(map(_line, table().texts)), PAGE.read_text(encoding="utf-8"))
    assert found == 1, f"{PAGE.name} should have one table of criteria"
    return text


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8", newline="\n")
