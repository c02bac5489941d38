"""The numbers by which hypotheses are weighed: the table weights.csv, each with its reason and where it comes from."""

from __future__ import annotations

import csv
from dataclasses import dataclass, fields
from functools import cache
from importlib.resources import files


@dataclass(frozen=True)
class Weight:
    """One number, as the table has it."""

    name: str
    value: float
    what: str
    reason: str
    source: str


@dataclass(frozen=True)
class Weights:
    """All of them by name."""

    prior: float
    price: float
    parts_of_day: float
    unknown_price: float
    form: float
    form_of_room: float
    scatter: float
    coarse_scatter: float
    noise_scatter: float
    part_scatter: float
    least_left: float
    least_off: float
    ordinary: float
    surely_off: float
    near_rest: float
    beside_rest: float
    sure: float
    beyond_doubt: float
    alike: float
    least_share: float
    block_s: float
    lasting_s: float
    expected_s: float
    hidden_s: float
    screened: float
    screened_room: float
    open: float
    strongest: float
    notable: float
    strays: float
    blurred: float
    always: float
    promised: float
    clearly: float
    flows: float
    far_apart_s: float
    pulse_s: float
    soft: float
    noise_soft: float
    unseen_chain: float
    unseen_room: float
    least_seen: float
    named: float
    credible: float
    likelier: float
    right: float
    hidden: float
    open_unknown: float
    open_hidden: float
    wider: float
    most_wider: float
    early: float
    most_always: float
    most_left: float
    usual_heat: float
    resolved: float
    heat_sd: float
    heat_share: float
    heat_least_W: float
    clear_sd: float
    at_end: float

    def softness(self, is_by_noise: bool) -> float:
        return self.noise_soft if is_by_noise else self.soft

    def unseen(self, is_of_room: bool) -> float:
        return self.unseen_room if is_of_room else self.unseen_chain


@cache
def weights() -> tuple[Weight, ...]:
    """Return the table, in its order."""
    text = files("waxstudy.diagnosis").joinpath("weights.csv").read_text(encoding="utf-8")
    return tuple(_read(row) for row in csv.DictReader(text.splitlines()))


def _read(row: dict[str, str]) -> Weight:
    return Weight(row["name"], float(row["value"]), row["what"], row["reason"], row["source"])


def _all() -> Weights:
    found = {each.name: each.value for each in weights()}
    assert list(found) == [each.name for each in fields(Weights)], "weights.csv and Weights name the same, in order"
    return Weights(**found)


WEIGHTS = _all()
