"""How a report writes counts, figures with their spread, and verdicts."""

from __future__ import annotations

import math

# the two levels at which a run can tell something
MEAN_DECIDES, SINGLE_RUN = "the mean decides", "single run"
MORE_DIGITS = 3


def counted(n: int, noun: str) -> str:
    """
    >>> counted(1, "case"), counted(2, "case")
    ('1 case', '2 cases')
    """
    return f"{n} {noun}" if n == 1 else f"{n} {noun}s"


def capital(text: str) -> str:
    """
    >>> capital("heat in kWh")
    'Heat in kWh'
    """
    return f"{text[0].upper()}{text[1:]}"


def yes_or_no(holds: bool | None) -> str:
    """
    >>> yes_or_no(True), yes_or_no(False), yes_or_no(None)
    ('yes', 'no', '')
    """
    return {None: "", True: "yes", False: "no"}[holds]


def percent(share: float) -> str:
    """
    >>> percent(0.875), percent(math.nan)
    ('88 %', '')
    """
    return "" if math.isnan(share) else f"{100.0 * share:.0f} %"


def telling(value: float, form: str) -> str:
    """Return a form with as many digits more, at most three, as keep what is not zero from being written as zero.

    >>> telling(0.004, ".2f"), telling(0.05, ".2f"), telling(1e-9, ".2f")
    ('.3f', '.2f', '.5f')
    """
    places = int(form.strip(".f"))
    more = (each for each in range(places, places + MORE_DIGITS) if float(f"{value:.{each}f}"))
    return f".{next(more, places + MORE_DIGITS)}f"


def with_spread(value: float, spread: float, form: str) -> str:
    """
    >>> with_spread(0.05, 0.01, ".2f"), with_spread(0.05, math.nan, ".2f"), with_spread(math.nan, math.nan, ".2f")
    ('0.05 ± 0.01', '0.05', '')
    """
    if math.isnan(value):
        return ""
    text = f"{value:z{form}}"  # z: no minus before a zero
    return text if math.isnan(spread) else f"{text} ± {spread:{form}}"
