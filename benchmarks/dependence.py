"""What errors of a calibrated room go with: `python -m benchmarks.dependence SET KEYFILE`.

SET is a blind test's folder with records that have a healthy one; used are those in which nothing changed of room and
emitter. The errors of the healthy record are regressed on a drive, followed with time constants of half an hour, 3 and
12 h, or on the hour of the day; what that says is taken off the later record's errors, whose room is fitted to it as a
diagnosis does. Told are the shares of the mean square that go: of the healthy record, which the regression has seen,
and of the later one, which it has not. Below 0 it makes them larger. A second table has the mean square of the later
record's whitened errors by period: it would be the same at all periods if the discrepancy were exact.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

from waxstudy.blind_test.box import open_box
from waxstudy.blind_test.key import Key
from waxstudy.blind_test.marks import Truth
from waxstudy.dataset.baseline import read_baseline
from waxstudy.dataset.read import read_dataset
from waxstudy.diagnosis.criteria import ROOM_STAGES
from waxstudy.diagnosis.diagnose import _cut, _problems, _work
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.observations.record import DAY_S, Record
from waxstudy.plugin import FloatArray

DRIVES = {
    "sun": "solar_gain_W",
    "outdoor": "outdoor_temperature_C",
    "heating": "flow_L_h",
}
OVER_H = (0.5, 3.0, 12.0)
PERIODS_H = (0.0, 1.5, 6.0, 24.0, np.inf)
CHANNELS = ("air_temperature_C", "operative_temperature_C", "floor_surface_temperature_C")

Errors = tuple[FloatArray, np.ndarray, FloatArray]  # (n,), where they are judged, and regressors (n, columns)
Shares = dict[tuple[str, str], list[tuple[float, float]]]


def followed(values: FloatArray, tau_s: float, step_s: float) -> FloatArray:
    """Return values after a first-order lag that begins where their first day has its mean (n,)."""
    kept = float(np.exp(-step_s / tau_s))
    first = float(values[: max(1, round(DAY_S / step_s))].mean())
    return np.asarray(lfilter([1.0 - kept], [1.0, -kept], values, zi=[kept * first])[0])


def regressors(record: Record, count: int) -> Mapping[str, FloatArray]:
    """Return what errors of `count` means may depend on, by name, each (count, columns) with a constant."""
    merged = len(record) // count
    step_s = merged * record.interval_s
    angle = 2.0 * np.pi * (record.start_s + (np.arange(count) + 0.5) * step_s) / DAY_S
    found = {"hour": [np.cos(angle), np.sin(angle), np.cos(2.0 * angle), np.sin(2.0 * angle)]}
    for name, channel in DRIVES.items():
        if record.has(channel):
            mean = record.filled(channel)[: count * merged].reshape(count, merged).mean(axis=1)
            found[name] = [followed(mean, 3600.0 * each_h, step_s) for each_h in OVER_H]
    found["all"] = [column for columns in found.values() for column in columns]
    return {name: np.column_stack([np.ones(count), *columns]) for name, columns in found.items()}


def rooms(folder: Path, key: Key) -> Iterator[tuple[tuple[Record, Hypothesis], tuple[Record, Hypothesis]]]:
    """Yield the room of each healthy record and of the later one, nothing of which changed."""
    for box in sorted((folder / "boxes").glob("*.box")):
        truth = Truth.read(open_box(key, box.stem, box.read_bytes()))
        if not truth.has_baseline or any(cause.stages & set(ROOM_STAGES) for cause in truth.causes):
            continue
        dataset = read_dataset(folder / "records" / box.stem)
        work = _work(dataset, read_baseline(dataset, dataset.folder / "baseline"))
        for segment in (each for each in _cut(work)[0] if each.with_room and each.name in work.healthy):
            whole, healthy = _problems(work, segment)[0], work.healthy[segment.name]
            later = Estimator(whole, keeps=True).base
            print(f"{box.stem}: {truth.label}", file=sys.stderr)
            yield (healthy.problem.record, healthy.fitted), (whole.record, later)


def gone_with(before: Errors, after: Errors) -> tuple[float, float]:
    """Return the shares of both mean squares that go with regressors, as the first errors have them."""
    errors, judged, columns = before
    slopes = np.linalg.lstsq(columns[judged], errors[judged], rcond=None)[0]
    return _share_gone(before, slopes), _share_gone(after, slopes)


def _share_gone(of: Errors, slopes: FloatArray) -> float:
    errors, judged, columns = of
    return 1.0 - float(np.mean((errors - columns @ slopes)[judged] ** 2) / np.mean(errors[judged] ** 2))


def by_period(residual: Residual, step_h: float) -> FloatArray:
    """Return the mean square of whitened errors by their period, between those of `PERIODS_H` (periods,).

    Their mean has no period and is left out.
    """
    count = len(residual.whitened)
    power = np.abs(np.fft.rfft(residual.whitened)[1:]) ** 2 / max(1, int(residual.judged.sum()))
    period_h = count * step_h / np.arange(1, len(power) + 1)
    place = np.searchsorted(PERIODS_H, period_h) - 1
    return np.bincount(place, power, len(PERIODS_H) - 1) / np.bincount(place, minlength=len(PERIODS_H) - 1)


def measured(folder: Path, key: Key) -> tuple[Shares, Mapping[str, list[FloatArray]]]:
    """Return by channel and drive which shares of the mean square go, of each healthy record and of the later one.

    And by channel the later one's mean square of whitened errors by their period.
    """
    found: Shares = defaultdict(list)
    powers: Mapping[str, list[FloatArray]] = defaultdict(list)
    for healthy, later in rooms(folder, key):
        known = {each.channel: each for each in healthy[1].residuals}
        pairs = [(known[each.channel], each) for each in later[1].residuals if each.channel in known]
        for before, after in pairs:
            if before.channel not in CHANNELS or not before.gap() or not after.gap():
                continue
            merged = len(later[0]) // len(after.error)
            powers[after.channel].append(by_period(after, merged * later[0].interval_s / 3600.0))
            seen = regressors(healthy[0], len(before.error))
            unseen = regressors(later[0], len(after.error))
            for name in seen.keys() & unseen.keys():
                about = (before.error, before.judged, seen[name]), (after.error, after.judged, unseen[name])
                found[before.channel, name].append(gone_with(*about))
    return found, powers


def main(folder: Path, key: Key) -> None:
    shares, powers = measured(folder, key)
    print("| channel | depends on | records | healthy, median | later, median | quartiles |\n|---|---|---|---|---|---|")
    for (channel, name), each in sorted(shares.items()):
        seen, unseen = np.array(each).T
        low, middle, high = np.percentile(unseen, [25.0, 50.0, 75.0])
        print(f"| {channel} | {name} | {len(each)} | {np.median(seen):.2f} | {middle:.2f} | {low:.2f} to {high:.2f} |")
    ends = [f"{low:g} to {high:g} h" for low, high in pairwise(PERIODS_H)]
    print("\n| " + " | ".join(["channel", "records", *ends]) + " |\n" + "|---" * (2 + len(ends)) + "|")
    for channel, found in sorted(powers.items()):
        told = [f"{each:.2f}" for each in np.median(found, axis=0)]
        print("| " + " | ".join([channel, str(len(found)), *told]) + " |")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Key.read(Path(sys.argv[2]).read_text()))
