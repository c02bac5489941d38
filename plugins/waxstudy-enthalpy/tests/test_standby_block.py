"""The modulator `standby` before both wax motors, the empirical and the physical: the table of docs/standby.md."""

from __future__ import annotations

import copy
import re
from pathlib import Path

import pytest

from waxstudy.plugin.registry import installed
from waxstudy.simulation.chain import Stepped
from waxstudy.study.model import Choice

PAGE = Path(__file__).parents[3] / "docs" / "standby.md"
ROW = re.compile(r"^\| ([AB]) \| (\S+) \| (\d+) \|((?: \d+ \|){4}) (\d\.\d\d) \|$", re.MULTILINE)
ROWS = ROW.findall(PAGE.read_text(encoding="utf-8"))
HEATED_S, CLOSED_S = 3600, 900
PAUSES_MIN = (15, 30, 60, 120)


def full_opening_s(chain: list[Stepped], time_s: int) -> int:
    """Switch on and return the time to full opening; the chain is left as it is."""
    chain = copy.deepcopy(chain)
    for seconds in range(1, 1200):
        if stepped(chain, 1.0, time_s + seconds) > 1.0 - 1e-9:
            return seconds
    raise AssertionError("it never opens")


def stepped(chain: list[Stepped], value: float, time_s: float) -> float:
    for block in chain:
        value = block.step(value, time_s)
    return value


def after_pauses(product: str, motor: str, pulse_s: float) -> tuple[list[int], float]:
    """Return the times to full opening after each pause [s], and the largest opening in the pause once closed."""
    wanted = {
        ("modulator", "standby"): {"signal": "switched", "pulse_s": pulse_s},
        ("actuator", motor): {"product": product},
    }
    chain = [Stepped(Choice.of(installed().get(*key), values), 1.0) for key, values in wanted.items()]
    times_s, opening = [], 0.0
    for time_s in range(HEATED_S):
        stepped(chain, 1.0, time_s)
    for time_s in range(60 * PAUSES_MIN[-1] + 1):
        if time_s in [60 * minutes for minutes in PAUSES_MIN]:
            times_s.append(full_opening_s(chain, HEATED_S + time_s))
        now = stepped(chain, 0.0, HEATED_S + time_s)
        opening = max(opening, now if time_s > CLOSED_S else 0.0)
    return times_s, opening


@pytest.mark.parametrize(("product", "motor", "pulse_s", "times_s", "opening"), ROWS)
def test_the_page_shows_what_standby_pulses_do(
    product: str, motor: str, pulse_s: str, times_s: str, opening: str
) -> None:
    found_s, largest = after_pauses(product, motor, float(pulse_s))
    assert found_s == pytest.approx([int(cell) for cell in re.findall(r"\d+", times_s)], abs=1)
    assert largest == pytest.approx(float(opening), abs=0.006)


def test_the_page_has_a_row_for_each_product_motor_and_pulse() -> None:
    assert len(ROWS) == 16
