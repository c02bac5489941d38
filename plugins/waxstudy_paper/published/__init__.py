"""The paper's published figures and findings."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from importlib.resources import files

from waxstudy.plugin import Finding, FinishedRun, PublishedRow, Reference


class Paper(Reference):
    """Table 5 (one run per case) and twenty findings of Parts et al., each as a check on a run."""

    name = "paper"
    api_version = "1.0"

    @classmethod
    def rows(cls) -> Sequence[PublishedRow]:
        text = files(__name__).joinpath("table5.csv").read_text(encoding="utf-8")
        return [
            PublishedRow(row["case"], row["week"], *(float(value) for value in list(row.values())[2:]))
            for row in csv.DictReader(text.splitlines())
        ]

    @classmethod
    def findings(cls, run: FinishedRun) -> Sequence[Finding]:
        from waxstudy_paper.published.findings import findings

        return findings(run)
