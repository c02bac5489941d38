"""Probabilities at a link that rules judged: as often as such answers were right in a judged run.

The shares are those of run 7 (results/blind_test/7, confusion of all 876 records). Of 82 answers that named an effect
of emitter or room 80 were right, of 212 that named one of the chain 172. Of 702 that named none of emitter or room 65
had one all the same, of 572 that named none of the chain 73. Of 104 that left something unknown 62 had a cause outside
the library and 16 an effect of it at emitter or room, as many at the chain.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

from waxstudy.diagnosis.result import Unexplained
from waxstudy.diagnosis.select.changed import joined
from waxstudy.diagnosis.select.search import Selection
from waxstudy.diagnosis.select.weigh import NONE, UNKNOWN

RIGHT = {False: 0.81, True: 0.95}  # where effects are named: of a chain, of a room
HIDDEN = {False: 0.04, True: 0.09}  # where nothing is, that an effect is there; a chain's 0.13 are of its three links
OPEN_UNKNOWN, OPEN_HIDDEN = 0.6, 0.15  # where something stays: that it is outside the library, or an effect of it


def stated(selection: Selection, remains: Sequence[Unexplained]) -> Mapping[str, float]:
    """Return the probability of each hypothesis of a link, by what rules said of it; they sum to 1."""
    tried = sorted({each.effect.name for each in selection.tried})
    is_open, of_room = any(each.is_finding for each in remains), selection.segment.with_room
    if selection.found:
        beside = {UNKNOWN} if is_open else set()
        sets = {joined(frozenset(names) | beside) for names in product(*(found.group for found in selection.found))}
        return {**dict.fromkeys(sorted(sets), RIGHT[of_room] / len(sets)), UNKNOWN: 1.0 - RIGHT[of_room]}
    hidden = (OPEN_HIDDEN if is_open else HIDDEN[of_room]) if tried else 0.0
    told = {UNKNOWN: OPEN_UNKNOWN} if is_open else {}
    return {NONE: 1.0 - hidden - sum(told.values()), **told, **dict.fromkeys(tried, hidden / max(1, len(tried)))}
