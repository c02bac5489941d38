"""How sure a diagnosis may be: `python -m benchmarks.posterior SET KEYFILE`.

SET is a blind test's folder that was made for this, never one that is judged. Every link that can be is weighed, and
the truth is opened. What is learned, separately of chains with and without a healthy record and of rooms: the power by
which weights are softened, and the share of nothing that goes to effects which would not show. Chosen is what gives the
truth the most (logarithmic score); each engine is then left out in turn and scored by what the others chose. Kept
engines are not looked at. Effects that could not show with the power of today are fitted roughly whatever power is
asked for: they have next to nothing.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from statistics import fmean

from waxstudy.blind_test.answer import UNKNOWN, hypothesis
from waxstudy.blind_test.box import open_box
from waxstudy.blind_test.key import Key
from waxstudy.blind_test.marks import Truth
from waxstudy.dataset.baseline import read_baseline
from waxstudy.dataset.read import read_dataset
from waxstudy.diagnosis.diagnose import weighed_links
from waxstudy.diagnosis.select.posterior import Weighed, posterior
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin.trial import engine_of

LEAST = 1e-4  # what the truth is given at least, as in the score of a blind test
POWERS = (1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0)
SHARES = (0.0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3)


@dataclass(frozen=True)
class Link:
    """A link of a record: its hypotheses, as light as they can be kept, and what is true of it."""

    engine: str
    weighed: Sequence[Weighed]
    true: str
    has_baseline: bool

    @property
    def is_of_room(self) -> bool:
        return self.weighed[0].is_of_room

    def loss(self, soft: float, unseen: float) -> float:
        """Minus the logarithm of the probability of the truth."""
        return -math.log(max(LEAST, posterior(self.weighed, soft, unseen).get(self.true, 0.0)))


def links(folder: Path, key: Key) -> Iterator[Link]:
    """Yield every link of every record that is weighed: without a baseline those of the chain."""
    for box in sorted((folder / "boxes").glob("*.box")):
        truth = Truth.read(open_box(key, box.stem, box.read_bytes()))
        if engine_of(truth.engine).is_kept:
            continue
        dataset = read_dataset(folder / "records" / box.stem)
        baseline = read_baseline(dataset, dataset.folder / "baseline") if truth.has_baseline else None
        print(f"{box.stem}: {truth.label}", file=sys.stderr)
        for segment, weighed in weighed_links(dataset, baseline):
            here = {UNKNOWN if c.is_family else c.name for c in truth.causes if c.stages & set(segment.stages)}
            yield Link(truth.engine, [_light(each) for each in weighed], hypothesis(here), truth.has_baseline)


def _light(weighed: Weighed) -> Weighed:
    return replace(weighed, fitted=replace(weighed.fitted, residuals=[]))


def best(found: Sequence[Link]) -> tuple[float, float]:
    """Return the power and the share that give the truth the most."""
    return min(product(POWERS, SHARES), key=lambda pair: sum(each.loss(*pair) for each in found))


def row(name: str, found: Sequence[Link], soft: float, unseen: float) -> str:
    loss = fmean(each.loss(soft, unseen) for each in found)
    now = fmean(each.loss(WEIGHTS.softness(not each.has_baseline), WEIGHTS.unseen(each.is_of_room)) for each in found)
    learned = f"power {soft:4.2f}   share {unseen:5.3f}"
    return f"{name:24} {len(found):5d} links   {learned}   loss {loss:5.3f}   as it is {now:5.3f}"


def tell(found: Sequence[Link]) -> None:
    kinds: Mapping[str, Sequence[Link]] = {
        "chains": [each for each in found if each.has_baseline and not each.is_of_room],
        "chains without baseline": [each for each in found if not each.has_baseline],
        "rooms": [each for each in found if each.is_of_room],
    }
    for kind, own in kinds.items():
        if not own:
            continue
        print(row(kind, own, *best(own)))
        for engine in sorted({each.engine for each in own}):
            others, left = [e for e in own if e.engine != engine], [e for e in own if e.engine == engine]
            if others:
                print(row(f"  {engine}, left out", left, *best(others)))


if __name__ == "__main__":
    folder, key_file = map(Path, sys.argv[1:])
    tell(list(links(folder, Key.read(key_file.read_text()))))
