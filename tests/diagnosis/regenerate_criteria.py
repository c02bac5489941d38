"""Write the table of criteria in docs/diagnosis-method.md again: `python -m tests.diagnosis.regenerate_criteria`."""

from __future__ import annotations

import re

from tests.conftest import ROOT
from waxstudy.report.diagnosis.criteria import HEAD, as_markdown

PAGE = ROOT / "docs" / "diagnosis-method.md"


def page() -> str:
    """The page as it should be: its table lists the criteria, in their order."""
    rows = re.escape(HEAD) + r"(\|.*\n)*"
    text, found = re.subn(rows, lambda _: as_markdown(), PAGE.read_text(encoding="utf-8"))
    assert found == 1, f"{PAGE.name} should have one table of criteria"
    return text


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8", newline="\n")
