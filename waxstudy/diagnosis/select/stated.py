"""Probabilities at a link that rules judged: as often as such answers were right in a judged run (weights.csv)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

from waxstudy.diagnosis.result import Unexplained
from waxstudy.diagnosis.select.changed import joined
from waxstudy.diagnosis.select.posterior import NONE, UNKNOWN
from waxstudy.diagnosis.select.search import Selection
from waxstudy.diagnosis.weights import WEIGHTS


def stated(selection: Selection, remains: Sequence[Unexplained]) -> Mapping[str, float]:
    """Return the probability of each hypothesis of a link, by what rules said of it; they sum to 1.

    Effects that would not show count at the room, not again at its supply.
    """
    tried = [] if selection.segment.is_supply else sorted({each.effect.name for each in selection.tried})
    is_open = any(each.is_finding for each in remains)
    if selection.found:
        beside = {UNKNOWN} if is_open else set()
        sets = {joined(frozenset(names) | beside) for names in product(*(found.group for found in selection.found))}
        return {
            **dict.fromkeys(sorted(sets), WEIGHTS.right / len(sets)),
            UNKNOWN: 1.0 - WEIGHTS.right,
        }
    hidden = (WEIGHTS.open_hidden if is_open else WEIGHTS.hidden) if tried else 0.0
    told = {UNKNOWN: WEIGHTS.open_unknown} if is_open else {}
    return {NONE: 1.0 - hidden - sum(told.values()), **told, **dict.fromkeys(tried, hidden / max(1, len(tried)))}
