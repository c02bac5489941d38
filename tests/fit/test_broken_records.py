"""A record with something wrong gets a clear error with its line, or a warning and the right result."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.fit.conftest import Read, medians
from waxstudy.identification.times import cycles_of
from waxstudy.study.problems import StudyError

Frame = pd.DataFrame


def text(frame: Frame, **options: object) -> str:
    return str(frame.to_csv(index=False, **options))  # type: ignore[call-overload]


def changed(frame: Frame, **columns: object) -> Frame:
    return frame.assign(**columns)  # type: ignore[arg-type]


def lines(frame: Frame) -> list[str]:
    return text(frame).splitlines()


def joined(parts: list[str]) -> str:
    return "\n".join(parts) + "\n"


# --- what cannot be used is refused, with the reason, and the line where there is one ----------------


def back_in_time(frame: Frame) -> str:
    rows = lines(frame)
    rows[500], rows[501] = rows[501], rows[500]
    return joined(rows)


def same_stamp_twice(frame: Frame) -> str:
    rows = lines(frame)
    return joined([*rows[:501], rows[500], *rows[501:]])


def stamps_go_back(frame: Frame) -> str:
    stamps = pd.Timestamp("2024-03-01") + pd.to_timedelta(frame["time_s"], unit="s")
    stamps.iloc[700] = stamps.iloc[600]
    return text(frame.drop(columns="time_s").assign(time=stamps.dt.strftime("%Y-%m-%dT%H:%M:%S")))


def no_stroke(frame: Frame) -> Frame:
    return changed(frame, displacement_mm=8.0 + 0.002 * np.random.default_rng(1).normal(size=len(frame)))


def other_movement(frame: Frame) -> Frame:
    return changed(frame, displacement_mm=8.0 - np.abs(np.sin(frame["time_s"] / 170.0)))


def swapped(frame: Frame) -> Frame:
    on = (frame["signal_V"] > 12.0).astype(float)
    return changed(frame, displacement_mm=on, signal_V=frame["displacement_mm"])


def too_many_cells(frame: Frame) -> str:
    rows = lines(frame)
    rows[321] += ",7"
    return joined(rows)


def missing_time(frame: Frame) -> str:
    rows = lines(frame)
    rows[41] = "," + rows[41].split(",", 1)[1]
    return joined(rows)


def thousands(frame: Frame) -> str:
    return text(frame.assign(time_s=[f"{value:,.1f}" for value in frame["time_s"]]))


def huge_gap(frame: Frame) -> Frame:
    return changed(frame, time_s=np.where(frame.index > 3000, frame["time_s"] + 4e8, frame["time_s"]))


REFUSED: dict[str, tuple[Callable[[Frame], str | bytes | Frame], str]] = {
    "empty": (lambda frame: "", "record.csv: is empty: a header with the names of the columns is expected"),
    "a header alone": (lambda frame: "time_s,displacement_mm,signal_V\n", "holds no rows"),
    "no stroke": (no_stroke, "displacement: has no stroke: it stays within 7.99"),
    "constant displacement": (lambda f: changed(f, displacement_mm=8.0), "has no stroke: it stays within 8 and 8"),
    "constant signal": (lambda f: changed(f, signal_V=24.0), "signal: is 24 throughout: without a switch"),
    "a signal that does not switch": (
        lambda f: changed(f, signal_V=12.0 + 12.0 * np.sin(f["time_s"] / 900.0)),
        "does not switch",
    ),
    "swapped columns": (swapped, "displacement: takes two values only, as a signal does: are the two columns swapped?"),
    "movement without regard to the signal": (other_movement, "does not follow the signal"),
    "time going back": (back_in_time, "record.csv:502: time_s = 500.0: time goes back"),
    "a stamp that goes back": (stamps_go_back, "record.csv:702: time: time goes back, from 2024-03-01"),
    "a time twice": (same_stamp_twice, "record.csv:502: time_s = 500.0: the same time as in the row before"),
    "a row without time": (missing_time, "record.csv:42: time_s: is no number (1 such rows)"),
    "a mark between thousands": (
        thousands,
        'record.csv:1001: time_s = "1,000.0": is no number (13401 such rows) (numbers are written without a mark',
    ),
    "half a cycle": (lambda f: f.iloc[:900], "switches less than twice: there is no cycle"),
    "too many cells in a row": (too_many_cells, "record.csv:322: is no table that can be read"),
    "another quantity": (
        lambda f: f.rename(columns={"displacement_mm": "flow_L_h"}),
        "record.csv:1: displacement: no column has",
    ),
    "two columns that could be it": (lambda f: changed(f, position_mm=1.0), "more than one column could be it"),
    "a sample a minute": (lambda f: f.iloc[::60], "samples are 60 s apart: at most 10 s"),
    "words for numbers": (lambda f: changed(f, displacement_mm="far"), "14400 of 14400 cells are no numbers"),
    "a gap of years": (huge_gap, "record.csv:3003: time: a gap of 1.11e+05 h: split the record there"),
    "not text at all": (lambda f: bytes(range(256)) * 40, "record.csv"),
}


@pytest.mark.parametrize(("spoil", "said"), REFUSED.values(), ids=REFUSED)
def test_a_record_that_cannot_be_used_is_refused_with_the_reason(
    steady: Frame, read: Read, spoil: Callable[[Frame], str | bytes | Frame], said: str
) -> None:
    with pytest.raises(StudyError) as refused:
        read(spoil(steady))
    assert said in str(refused.value)
    assert "Traceback" not in str(refused.value)


def test_lines_are_counted_as_an_editor_does_after_comments_and_blank_lines(steady: Frame, read: Read) -> None:
    rows = back_in_time(steady).splitlines()
    with pytest.raises(StudyError, match=r"record\.csv:507: time_s"):
        read(joined(["# logger 7", "", *rows[:300], "", "", "", *rows[300:]]))


# --- what can be used gives the right result, with a warning where something was changed -------------


def with_rows(frame: Frame, at: int, *rows: str) -> str:
    whole = lines(frame)
    return joined([*whole[:at], *rows, *whole[at:]])


def decimal_commas(frame: Frame) -> str:
    return text(frame, sep=";", decimal=",")


def spikes(frame: Frame) -> Frame:
    values = frame["displacement_mm"].copy()
    values.iloc[[900, 3456, 3457, 9000]] = 99.0
    return changed(frame, displacement_mm=values)


def codes(frame: Frame) -> Frame:
    values = frame["displacement_mm"].copy()
    values.iloc[5000:5003] = -9999.0
    return changed(frame, displacement_mm=values)


def gap(frame: Frame) -> Frame:
    return frame.drop(index=range(5000, 5400))


def stuck(frame: Frame) -> Frame:
    values = frame["displacement_mm"].copy()
    values.iloc[9000:] = values.iloc[9000]
    return changed(frame, displacement_mm=values)


def jittered(frame: Frame) -> Frame:
    moved = frame["time_s"] + np.random.default_rng(1).uniform(-0.3, 0.3, len(frame))
    values = np.interp(moved, frame["time_s"], frame["displacement_mm"])
    return changed(frame, time_s=moved, displacement_mm=values)


def stamped(frame: Frame) -> Frame:
    stamps = pd.Timestamp("2024-03-01T10:00:00") + pd.to_timedelta(frame["time_s"], unit="s")
    return frame.drop(columns="time_s").assign(time=stamps.dt.strftime("%Y-%m-%d %H:%M:%S.%f"))


RIGHT: dict[str, tuple[Callable[[Frame], str | bytes | Frame], str]] = {
    "as it is": (lambda f: f, ""),
    "units in the header": (
        lambda f: f.set_axis(["Time [s]", "Displacement (mm)", "Voltage [V]"], axis="columns"),
        "",
    ),
    "units in a line of their own": (lambda f: with_rows(f, 1, "[s],[mm],[V]"), "line 2 holds units (s, mm, V)"),
    "units in a line, and decimal commas": (
        lambda f: decimal_commas(f).replace("\n", "\ns;mm;V\n", 1),
        "line 2 holds units",
    ),
    "decimal commas": (decimal_commas, ""),
    "a byte-order mark": (lambda f: b"\xef\xbb\xbf" + text(f).encode(), ""),
    "UTF-16": (lambda f: text(f).encode("utf-16"), ""),
    "a header in Windows' western encoding": (lambda f: text(f.assign(**{"\xb5": 1})).encode("cp1252"), ""),
    "Windows' ends of lines": (lambda f: text(f).replace("\n", "\r\n"), ""),
    "comments above the header": (lambda f: "# logger 7\n# channel 3\n\n" + text(f), ""),
    "blank lines": (lambda f: text(f).replace("\n", "\n\n"), ""),
    "stamps instead of seconds": (stamped, ""),
    "minutes instead of seconds": (
        lambda f: changed(f, time_s=f["time_s"] / 60.0).rename(columns={"time_s": "time [min]"}),
        "",
    ),
    "a signal of 0 and 1": (lambda f: changed(f, signal_V=(f["signal_V"] > 12.0).astype(int)), ""),
    "a signal in words": (lambda f: changed(f, signal_V=np.where(f["signal_V"] > 12.0, "on", "off")), ""),
    "an opening that is normalised": (lambda f: changed(f, displacement_mm=(8.0 - f["displacement_mm"]) / 2.5), ""),
    "a sensor the other way round": (lambda f: changed(f, displacement_mm=-f["displacement_mm"]), ""),
    "spikes": (spikes, "4 samples are spikes: replaced by their neighbours"),
    "one spike": (
        lambda f: changed(f, displacement_mm=f["displacement_mm"].where(f.index != 900, 99.0)),
        "1 sample is a spike: replaced by its neighbours",
    ),
    "codes for missing samples": (codes, "3 samples are a code for a missing sample"),
    "a cell that is no number": (
        lambda f: with_rows(f.drop(index=3999), 4000, "4000.0,error,0.0"),
        'displacement: 1 cell is no number (it is "error" in line 4001): missing',
    ),
    "a gap": (gap, "in gaps; cycles that touch one are left out"),
    "a sensor that gets stuck": (stuck, "the sensor is stuck at"),
    "a last line that is cut off": (lambda f: text(f)[:-12], ""),
    "samples at uneven times": (jittered, ""),
    "a sample every 10 s": (lambda f: f.iloc[::10], ""),
    "two samples a second": (
        lambda f: pd.DataFrame({n: np.interp(np.arange(1.0, 14400.0, 0.5), f["time_s"], f[n]) for n in f.columns}),
        "",
    ),
}


@pytest.mark.parametrize(("spoil", "said"), RIGHT.values(), ids=RIGHT)
def test_a_record_that_can_be_used_gives_the_right_times(
    steady: Frame, read: Read, spoil: Callable[[Frame], str | bytes | Frame], said: str
) -> None:
    record = read(spoil(steady))
    # a switch is known to half a sample
    expected = medians(read(steady, "steady.csv"))
    assert medians(record) == pytest.approx(expected, abs=0.25 + 0.6 * record.interval_s)
    assert any(said in warning for warning in record.warnings) if said else not record.warnings


def test_ten_million_blank_lines_do_no_harm(steady: Frame, read: Read) -> None:
    whole = lines(steady)
    record = read((joined(whole[:2000]) + "\n" * 10_000_000 + joined(whole[2000:])).encode())
    assert medians(record) == pytest.approx(medians(read(steady, "steady.csv")))


def test_cycles_that_touch_a_gap_or_a_stuck_sensor_are_left_out(steady: Frame, read: Read) -> None:
    assert cycles_of(read(gap(steady)))["lost"].tolist().count("gap") == 1
    lost = cycles_of(read(stuck(steady)))["lost"]
    assert (lost == "does not move").sum() >= 2


@pytest.mark.parametrize("column", ["displacement_mm", "signal_V"])
@pytest.mark.parametrize("rows", [slice(0, 5000), slice(9400, None)])
def test_what_is_missing_before_the_first_sample_or_after_the_last_is_a_gap(
    steady: Frame, read: Read, column: str, rows: slice
) -> None:
    """Nobody knows what a channel showed that begins later than the record or ends earlier."""
    values = steady[column].copy()
    values.iloc[rows] = np.nan
    record = read(changed(steady, **{column: values}))
    assert record.missing.tolist() == values.isna().tolist()
    (warning,) = record.warnings
    assert warning.startswith(f"{100.0 * values.isna().mean():.2g} % of the time is in gaps")


@pytest.mark.parametrize(("missing_s", "is_gap"), [(14, False), (15, True)])
def test_an_end_is_a_gap_from_as_many_missing_samples_as_anywhere(
    steady: Frame, read: Read, missing_s: int, is_gap: bool
) -> None:
    for first in (0, 5000, len(steady) - missing_s):
        values = steady["displacement_mm"].copy()
        values.iloc[first : first + missing_s] = np.nan
        assert read(changed(steady, displacement_mm=values)).missing.sum() == (missing_s if is_gap else 0)


def test_a_last_cycle_whose_end_is_missing_is_left_out(steady: Frame, read: Read) -> None:
    values = steady["displacement_mm"].where(steady["time_s"] < 8500.0)
    assert cycles_of(read(changed(steady, displacement_mm=values)))["lost"].iloc[-1] == "gap"


@pytest.mark.parametrize(
    ("from_s", "to_s", "known"), [(60, 200, False), (-100, 70, False), (-300, -60, True), (200, 400, True)]
)
def test_after_a_gap_that_touches_a_fall_nobody_knows_how_long_it_cooled(
    steady: Frame, read: Read, from_s: float, to_s: float, known: bool
) -> None:
    whole = cycles_of(read(steady, "steady.csv"))
    falls = whole["off_at_s"][3] + whole["hold_s"][3]
    seconds = steady["time_s"]
    cycles = cycles_of(read(steady[(seconds < falls + from_s) | (seconds > falls + to_s)]))
    assert cycles["lost"].tolist()[3:5] == ["gap", ""]
    assert bool(cycles["before_s"].notna()[4]) == known
    if known:
        assert cycles["before_s"][4] == pytest.approx(whole["before_s"][4], abs=0.1)


def test_a_copy_of_a_record_is_passed_over(steady: Frame, tmp_path: Path) -> None:
    from waxstudy.identification.description import described
    from waxstudy.identification.records import read_records

    for name in ("a", "b"):
        steady.to_csv(tmp_path / f"{name}.csv", index=False)
    steady.iloc[:-10].to_csv(tmp_path / "c.csv", index=False)
    records = read_records(described([tmp_path]), "B")
    assert [record.name for record in records] == ["a", "c"]
    assert records[0].warnings == ("b.csv is a copy of this file: passed over",)


@pytest.mark.parametrize("wrong", [[99.0], [99.0, 99.0], [-50.0], [240.0, 99.0, 3000.0]])
@pytest.mark.parametrize("row", [2000, 0, 14399 - 2])
def test_an_outlier_of_the_signal_is_no_switch(steady: Frame, read: Read, wrong: list[float], row: int) -> None:
    signal = steady["signal_V"].copy()
    places = [row + (step if step < 2 else 300) for step in range(len(wrong))] if row < 14000 else [row]
    signal.iloc[places] = wrong[: len(places)]
    record = read(changed(steady, signal_V=signal))
    assert medians(record) == pytest.approx(medians(read(steady, "steady.csv")))
    assert [warning for warning in record.warnings if f"the first {wrong[0]:g} in line {row + 2}" in warning]


def test_all_problems_of_all_records_are_told_at_once(steady: Frame, tmp_path: Path) -> None:
    from waxstudy.identification.description import described
    from waxstudy.identification.records import read_records

    no_stroke(steady).to_csv(tmp_path / "a.csv", index=False)
    swapped(steady).to_csv(tmp_path / "b.csv", index=False)
    with pytest.raises(StudyError) as refused:
        read_records(described([tmp_path / "a.csv", tmp_path / "b.csv"]), "B")
    assert [problem.file.rsplit("/")[-1] for problem in refused.value.problems] == ["a.csv", "b.csv"]
