"""Tables of where the motor agrees with the paper's empirical model, in the fit and outside of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy_enthalpy.bench import PROFILES_MIN, STEP_S, TIMES, Rig, Times, cycle_times, empirical, on_off, parameters
from waxstudy_enthalpy.calibration import model_times, target_times
from waxstudy_enthalpy.motor import core_temperature_C

# MAE of the empirical model against real motors (Table A1), without a valve where measured so
PUBLISHED_MAE: Mapping[tuple[str, str], float] = {
    ("A", "15-15"): 0.018,
    ("A", "15-45"): 0.014,
    ("A", "5-5"): 0.058,
    ("B", "15-15"): 0.048,
    ("B", "15-45"): 0.023,
    ("B", "30-30"): 0.020,
    ("B", "10-10"): 0.045,
    ("B", "18-6"): 0.033,
    ("B", "3-3"): 0.098,
    ("B", "random"): 0.086,
}
OUTSIDE_MIN = ((18, 6), (5, 5), (3, 3))
RANDOM_SEEDS = (1, 2, 3, 4, 5)
RECORD_MIN = 482.0  # length of the paper's random record
AMBIENT_C = (15.0, 20.0, 25.0, 30.0, 35.0)


def random_signal(seed: int, minutes: float = RECORD_MIN) -> FloatArray:
    """Return on and off times drawn evenly from 5 to 15 min."""
    draw, parts, steps = np.random.default_rng(seed), [], 0
    while steps * STEP_S < 60.0 * minutes:
        on, off = np.round(draw.uniform(300.0, 900.0, 2) / STEP_S).astype(int)
        parts += [np.ones(on), np.zeros(off)]
        steps += on + off
    return np.concatenate(parts)


def whole_cycles(opening: FloatArray, signal: FloatArray) -> Iterator[Times | None]:
    """Yield the times of each cycle after the first, None where the valve does not fully open and close."""
    on = np.flatnonzero(np.diff(signal) > 0) + 1
    for start, end in zip(on, [*on[1:], len(signal)], strict=True):
        heated = int(np.argmin(signal[start:end])) or end - start
        part, before = opening[start:end], opening[start - 1]
        whole = before <= 0.01 and part[heated - 1] >= 0.99 and part[-1] <= 0.01
        yield cycle_times(part, before, heated * STEP_S) if whole else None


@dataclass(frozen=True)
class Comparison:
    """Motor against empirical model over one signal."""

    mae: float  # of the opening
    cycles: int  # after the first
    compared: int  # cycles in which both open and close fully
    mean_s: float  # absolute difference of the times of these cycles
    worst_s: float
    low: tuple[float, float]  # smallest and largest opening of the last hour: motor, empirical
    high: tuple[float, float]


def compare(product: str, signal: FloatArray) -> Comparison:
    """Return how the motor differs from the empirical model, both starting from a long pause."""
    ours, theirs = Rig(parameters({"product": product})).run(signal), empirical(product, signal)
    pairs = list(zip(whole_cycles(ours, signal), whole_cycles(theirs, signal), strict=True))
    errors = np.array([np.subtract(a, b) for a, b in pairs if a and b]) if pairs else np.empty((0, 4))
    sizes = np.abs(errors) if len(errors) else np.array([np.nan])
    hour = -round(3600.0 / STEP_S)
    return Comparison(
        float(np.mean(np.abs(ours - theirs))),
        len(pairs),
        len(errors),
        float(sizes.mean()),
        float(sizes.max()),
        (float(ours[hour:].min()), float(theirs[hour:].min())),
        (float(ours[hour:].max()), float(theirs[hour:].max())),
    )


def in_fit() -> None:
    """Print the settled times of both models."""
    print("Settled times [s]: motor, (empirical model), difference")
    print(f"{'':10}" + "".join(f"{name:>22}" for name in TIMES))
    for product in "AB":
        ours, theirs = model_times({"product": product}), target_times(product)
        for (on, off), row, wanted in zip(PROFILES_MIN, ours, theirs, strict=True):
            cells = "".join(f"{a:8.1f} ({b:5.1f}) {a - b:+5.1f}" for a, b in zip(row, wanted, strict=True))
            print(f"{product} {on:2}-{off:<2} min{cells}")
        size = np.abs(ours - theirs)
        print(f"{product}: mean absolute error {size.mean():.2f} s, worst {size.max():.2f} s over {size.size} times")


def outside() -> None:
    """Print how both models differ over signals that were not fitted, and over those that were."""
    print("\nOpening over whole records from a cold start; last column: empirical model against real motors (Table A1)")
    print(f"{'':16}{'MAE':>7} {'cycles':>7} {'whole':>6} {'times: mean':>12} {'worst [s]':>10}", end="")
    print(f" {'motor spans':>13} {'empirical':>11} {'published':>10}")
    for product in "AB":
        for label, signal in _signals():
            _print_comparison(product, label, compare(product, signal))


def _signals() -> Iterator[tuple[str, FloatArray]]:
    for on, off in (*PROFILES_MIN, *OUTSIDE_MIN):
        yield f"{on}-{off}", on_off(on, off, round(RECORD_MIN / (on + off)))
    for seed in RANDOM_SEEDS:
        yield f"random {seed}", random_signal(seed)


def _print_comparison(product: str, label: str, found: Comparison) -> None:
    times = f"{found.mean_s:12.1f} {found.worst_s:10.1f}" if found.compared else f"{'-':>12} {'-':>10}"
    spans = [f"{low:.2f}..{high:.2f}" for low, high in zip(found.low, found.high, strict=True)]
    published = PUBLISHED_MAE.get((product, label.split()[0]))
    print(f"{product} {label:10} min{found.mae:7.4f} {found.cycles:7} {found.compared:6} {times}", end="")
    print(f" {spans[0]:>13} {spans[1]:>11} {published if published is not None else '-':>10}")


def cold_start() -> None:
    """Print the first cycle after a long pause."""
    print("\nFirst cycle from a cold start, 15 min on [s]: motor, (empirical model)")
    for product in "AB":
        signal = on_off(15, 15, 1)
        ours = cycle_times(Rig(parameters({"product": product})).run(signal), 0.0, 900.0)
        theirs = cycle_times(empirical(product, signal), 0.0, 900.0)
        cells = (f"{name} {a:5.0f} ({b:3.0f})" for name, a, b in zip(TIMES, ours, theirs, strict=True))
        print(f"{product}: " + ", ".join(cells) + f"; heater at full power for {inrush_s({'product': product}):.0f} s")


def inrush_s(values: Mapping[str, Any]) -> float:
    """Return how long a cold heater takes its full power [s]."""
    rig = Rig(parameters(values), 1.0)
    for seconds in range(1, 1801):
        rig.run(np.ones(1))
        if core_temperature_C(rig.p, rig.core_J) > rig.p.knee_C:
            return float(seconds)
    return float("inf")


def ambient() -> None:
    """Print what ambient temperature does to the times; the empirical model has none."""
    print("\nSettled times [s] in other ambient temperatures (the empirical model has one set for all)")
    print(f"{'':16}" + "".join(f"{name:>7}" for name in TIMES) + f"{'opens in':>10}  (15-15, then 15-45 min)")
    for product in "AB":
        for ambient_C in AMBIENT_C:
            values: dict[str, Any] = {"product": product, "ambient_C": ambient_C}
            for profile, row in zip(PROFILES_MIN[:2], model_times(values)[:2], strict=True):
                label = f"{product} {ambient_C:.0f} C {profile[0]}-{profile[1]}"
                print(f"{label:16}" + "".join(f"{value:7.0f}" for value in row) + f"{row[0] + row[1]:10.0f}")


def print_all() -> None:
    in_fit()
    outside()
    cold_start()
    ambient()
