"""The limits that decide what a diagnosis says: the table criteria.csv.

`LIMITS` holds them by name; `waxstudy diagnose --criteria` and the table in docs/diagnosis-method.md are the same rows.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from importlib.resources import files


@dataclass(frozen=True)
class Criterion:
    """One limit: what it decides, why it is as it is, where it comes from, and what changes without it."""

    name: str
    limit: float
    decides: str
    reason: str
    source: str
    ablation: str


@dataclass(frozen=True)
class Limits:
    """The limits by name, as the table explains them."""

    prior: float
    price: float
    unknown_price: float
    scatter: float
    form: float
    sure: float
    alike: float
    notable_of_room: float
    named: float
    credible: float
    always: float
    departure: float
    convention: float
    blocks: float
    recorded: float


def _table() -> tuple[Criterion, ...]:
    text = files("waxstudy.diagnosis").joinpath("criteria.csv").read_text(encoding="utf-8")
    rows = csv.DictReader(text.splitlines())
    return tuple(Criterion(**{**row, "limit": float(row["limit"])}) for row in rows)  # type: ignore[arg-type]


CRITERIA = _table()
LIMITS = Limits(**{each.name: each.limit for each in CRITERIA})
