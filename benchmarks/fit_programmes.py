"""What a programme of measurements tells of an actuator: `python -m benchmarks.fit_programmes [--repetitions 10]`.

One product on the virtual bench, whose truth is known; per programme the width of some intervals, how often the time
constants are told, and the error of times in profiles and of exemplars that were not measured.
The table is in docs/fit-tested.md.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from benchmarks.fit_recovery import fitted, new_profiles
from waxstudy.rig.bench import Motors
from waxstudy.rig.instruments import Bench
from waxstudy.rig.programme import Range, Trial

PRODUCT = "B"
FIXED: Mapping[str, float] = {"15-15": 180.0, "15-45": 360.0, "10-10": 180.0, "30-30": 300.0, "18-6": 180.0}  # min


def fixed(*profiles: str, exemplars: int = 1) -> list[Trial]:
    """Return a record per profile and exemplar."""
    return [
        _trial(f"M{exemplar}", exemplar, *(2 * (float(part),) for part in profile.split("-")), FIXED[profile])
        for exemplar in range(1, exemplars + 1)
        for profile in profiles
    ]


def drawn(hours: float, exemplars: int = 1, records: int = 1) -> list[Trial]:
    """Return records with on and off times drawn evenly from 6 to 30 and from 6 to 60 min."""
    return [
        _trial(f"M{exemplar}r{record}", exemplar, (6.0, 30.0), (6.0, 60.0), 60.0 * hours / records)
        for exemplar in range(1, exemplars + 1)
        for record in range(records)
    ]


def _trial(name: str, exemplar: int, on_min: Range, off_min: Range, minutes: float) -> Trial:
    return Trial(name, PRODUCT, str(exemplar), False, on_min, off_min, minutes, "displacement")


PROGRAMMES: Mapping[str, tuple[Sequence[Trial], float]] = {
    "15-15": (fixed("15-15"), 1.0),
    "15-15, 15-45": (fixed("15-15", "15-45"), 1.0),
    "15-15, 15-45, 10-10": (fixed("15-15", "15-45", "10-10"), 1.0),
    "all five profiles": (fixed(*FIXED), 1.0),
    "all five, 3 exemplars": (fixed(*FIXED, exemplars=3), 1.0),
    "drawn, 8 h": (drawn(8.0), 1.0),
    "drawn, 20 h": (drawn(20.0), 1.0),
    "drawn, 20 h in 4 records": (drawn(20.0, records=4), 1.0),
    "drawn, 3 exemplars of 20 h": (drawn(20.0, exemplars=3, records=4), 1.0),
    "the same, a sample per 10 s": (drawn(20.0, exemplars=3, records=4), 10.0),
}
SHOWN = ("dead_a_s", "dead_b_s", "dead_tau_s", "rise_b_s", "hold_a_s", "hold_tau_s", "fall_s")


def row(trials: Sequence[Trial], interval_s: float, repetitions: int) -> dict[str, str]:
    """Return a programme's figures: medians over the repetitions."""
    widths: dict[str, list[float]] = {name: [] for name in SHOWN}
    told, cycles, wrong = 0, [], []
    for seed in range(1, repetitions + 1):
        motors = Motors("variable-times", {}, "quick-opening", Bench(interval_s=interval_s), seed)
        found = fitted(motors, trials)
        values = found.model.coefficients(PRODUCT)
        for name in SHOWN:
            widths[name].append(values[name].width if values[name].told else np.nan)
        told += values["dead_tau_s"].told and values["hold_tau_s"].told
        cycles.append(sum(found.kept(record) for record in found.records))
        wrong += [each["wrong_s"] for each in new_profiles(found, motors)]
    figures = {
        name: "-" if np.isnan(each).mean() > 0.5 else f"{np.nanmedian(each):.0f}" for name, each in widths.items()
    }
    hours = sum(trial.duration_min for trial in trials) / 60.0
    ends = {
        "taus told": f"{told}/{repetitions}",
        "error, s": f"{np.median(wrong):.1f}",
        "95 %": f"{np.quantile(wrong, 0.95):.0f}",
    }
    return {"hours": f"{hours:.0f}", "cycles": f"{np.median(cycles):.0f}", **figures, **ends}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repetitions", type=int, default=10)
    count = parser.parse_args().repetitions
    rows = {name: row(trials, interval_s, count) for name, (trials, interval_s) in PROGRAMMES.items()}
    print("Width of 95 % intervals [s]; error of times in new profiles of new exemplars: median, 95 %")
    print(pd.DataFrame(rows).T.to_string())


if __name__ == "__main__":
    main()
