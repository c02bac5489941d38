"""Write the table of checks in docs/datasets.md again: `python -m tests.dataset.regenerate_checks`."""

from __future__ import annotations

import re

from tests.conftest import ROOT
from waxstudy.dataset.checks import CHECKS, Check

PAGE = ROOT / "docs" / "datasets.md"
HEAD = "| check | what it sees | what it does | what mends it |\n|---|---|---|---|\n"


def page() -> str:
    """The page as it should be: its table lists the checks, in their order."""
    table = HEAD + "".join(map(_row, CHECKS))
    text, found = re.subn(re.escape(HEAD) + r"(\|.*\n)*", lambda _: table, PAGE.read_text(encoding="utf-8"))
    assert found == 1, f"{PAGE.name} should have one table of checks"
    return text


def _row(check: Check) -> str:
    sees = re.sub(r"(\d)%", r"\1 %", check.sees)
    return f"| `{check.name}` | {sees} | {check.does} | {check.mend} |\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8", newline="\n")
