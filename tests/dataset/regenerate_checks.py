"""Write docs/checks.md again: `python -m tests.dataset.regenerate_checks`."""

from __future__ import annotations

import re

from docs_site.tables import table
from tests.conftest import ROOT
from waxstudy.dataset.checks import CHECKS, Check

PAGE = ROOT / "docs" / "checks.md"
INTRO = """\
# The checks of a record

This page lists what is looked for in the values of a [dataset](datasets.md#what-is-checked), in this order. It is
written by `make golden` from `waxstudy/dataset/checks`. Each number has its reason in `waxstudy/dataset/limits.py`.

"""


def page() -> str:
    """The page as it should be: its table lists the checks, in their order."""
    return INTRO + table(("check", "what it sees", "what it does", "what mends it"), map(_row, CHECKS))


def _row(check: Check) -> tuple[str, ...]:
    return (f"`{check.name}`", re.sub(r"(\d)%", r"\1 %", check.sees), check.does, check.mend)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8", newline="\n")
