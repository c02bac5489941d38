"""Inputs for a block: usual ones, and those that an author did not think of."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from waxstudy.plugin import ERROR, TEMPERATURE, Port

STEPS = 1500
SEED = 20260101
USUAL = {TEMPERATURE: (18.0, 26.0), ERROR: (-2.0, 2.0)}  # others: the port's whole range


def usual_range(port: Port) -> tuple[float, float]:
    return USUAL.get(port, (port.low, port.high))


def random(port: Port, steps: int = STEPS, seed: int = SEED) -> list[float]:
    """Held for random spans, as signals are; a fifth of the values lie anywhere in the port's range."""
    draw = np.random.default_rng(seed)
    low, high = usual_range(port)
    values: list[float] = []
    while len(values) < steps:
        wide = draw.random() < 0.2
        value = draw.uniform(port.low, port.high) if wide else draw.choice([low, high, draw.uniform(low, high)])
        values += [float(value)] * int(draw.integers(1, 60))
    return values[:steps]


def adversarial(port: Port) -> dict[str, list[float]]:
    """Ends of the range, in turn and held; the middle; the smallest numbers; switching at every step."""
    middle, tiny = 0.5 * (port.low + port.high), 5e-324
    edges = [
        port.low,
        port.high,
        middle,
        0.0,
        -0.0,
        tiny,
        np.nextafter(middle, port.high),
        np.nextafter(middle, port.low),
    ]
    inside = [float(value) for value in edges if port.low <= value <= port.high]
    return {
        "held low": [port.low] * (STEPS // 3),
        "held high, then low": [port.high] * (STEPS // 2) + [port.low] * (STEPS // 2),
        "switching at every step": [port.low, port.high] * (STEPS // 6),
        "edges": inside * (STEPS // (4 * len(inside))),
    }


def day(port: Port, step_s: float) -> Sequence[float]:
    """A smooth quarter of a day with switches between, held over `step_s`: for the convergence of the step."""
    low, high = usual_range(port)
    t = np.arange(0.0, 21600.0, step_s)
    wave = 0.5 * (low + high) + 0.5 * (high - low) * np.sin(2.0 * np.pi * t / 5400.0)
    switching = np.where(np.floor(t / 900.0) % 2 == 0, high, low)
    return [float(value) for value in np.where(t < 10800.0, wave, switching)]
