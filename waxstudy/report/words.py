"""How a report writes its figures: headings, tables of text, counts."""

from __future__ import annotations

import math

HEADINGS = {
    "setpoint_shift_K": ("shift", "K", 2),
    "mae_K": ("MAE", "K", 3),
    "heat_kWh_m2_week": ("heat", "kWh/m²", 2),
    "heat_vs_most_detailed_percent": ("difference", "%", 2),
}

Table = tuple[str, list[str], list[list[str]]]  # title, headings, rows


def counted(n: int, noun: str) -> str:
    """
    >>> counted(1, "case"), counted(2, "case")
    ('1 case', '2 cases')
    """
    return f"{n} {noun}" if n == 1 else f"{n} {noun}s"


def decimals(value: float) -> str:
    """Five decimals, as in a CSV table; empty for NaN."""
    return "" if math.isnan(value) else f"{value:.5f}"


def with_spread(value: float, spread: float, digits: int) -> str:
    """
    >>> with_spread(0.05, 0.01, 2), with_spread(0.05, math.nan, 2), with_spread(math.nan, math.nan, 2)
    ('0.05 ± 0.01', '0.05', '')
    """
    if math.isnan(value):
        return ""
    text = f"{value:z.{digits}f}"  # z: no minus before a zero
    return text if math.isnan(spread) else f"{text} ± {spread:.{digits}f}"
