"""Claims about a modulator's clock: no record tells when it was switched on."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from tests.diagnosis.realities import belief, dataset, plain, record, rows
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.model.modulator_clock import late_s
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.judge import Judge
from waxstudy.diagnosis.residuals.switching import Switching
from waxstudy.plugin import Belief, Choice
from waxstudy_paper.modulators import Pwm


def late_by(minutes: int) -> Record:
    """A record whose logger was told another time of day."""
    data = rows("PWM", days=6)
    time = pd.to_datetime(data["time"]) + pd.Timedelta(minutes=minutes)
    return record_of(dataset(data.assign(time=time), "PWM"))


@pytest.mark.parametrize("minutes", [0, 7, 25, -20])
def test_a_clock_that_runs_beside_the_record_s_is_found_from_the_pulses(minutes: int) -> None:
    seen = late_by(minutes)
    modulator = belief("PWM", seen).blocks["modulator"]
    assert late_s(seen, modulator) == pytest.approx(60.0 * minutes, abs=31.0)  # half a sample
    if minutes == 0:
        assert late_s(seen, modulator) == 0.0


@pytest.mark.parametrize("interval_s", [10.0, 30.0, 60.0, 300.0])
@pytest.mark.parametrize("is_told_at_once", [True, False])
def test_a_clock_that_is_right_stays_so_where_some_pulses_begin_later(interval_s: float, is_told_at_once: bool) -> None:
    """A pulse after a pause that was heated through begins within its period."""
    ends_s = interval_s * (1.0 + np.arange(round(4 * 86_400 / interval_s)))
    into_s = (ends_s if is_told_at_once else ends_s - interval_s) % 3600.0
    is_odd = ends_s // 3600.0 % 24 == 5
    signal = np.where(is_odd, (into_s >= 600.0) & (into_s < 1500.0), into_s < 1200.0)
    assert late_s(plain({"heating_signal": signal}, interval_s), Choice.of(Pwm, {"period_s": 3600.0})) == 0.0


@pytest.mark.parametrize("minutes", [7, 25])
def test_such_a_clock_is_no_gap(minutes: int) -> None:
    seen = late_by(minutes)
    believed = belief("PWM", seen)
    (segment,) = [each for each in segments(seen, believed) if each.stages == ("modulator",)]
    judge = Judge(segment, seen, believed)
    (residual,) = judge.residuals(segment.predict(seen, believed))
    pulses = judge.ways["heating_signal"]
    assert isinstance(pulses, Switching)
    assert residual.gap() <= 1.5 * pulses.typical_s


def test_pulses_that_were_logged_as_means_are_compared_with_means() -> None:
    output = np.repeat([0.3, 0.7, 0.5, 0.25], 12)
    hourly = plain({"control_output": output, "heating_signal": output}, 3600.0)
    pwm = Belief({"modulator": Choice.of(Pwm, {"period_s": 3600.0})})
    segment = Segment(("modulator",), "control_output", ("heating_signal",))
    predicted = segment.predict(hourly, pwm)
    shown = predicted["heating_signal"]
    assert [each.unit for each in Judge(segment, hourly, pwm).residuals(predicted)] == ["1"]
    steady = np.diff(output, prepend=output[0]) == 0.0
    assert shown[steady] == pytest.approx(output[steady], abs=0.02)


def test_a_switch_may_drive_a_modulator_whose_pulses_were_logged_as_means() -> None:
    output = np.repeat([0.0, 1.0, 0.0, 1.0], 12)
    signal = 0.4 * output
    hourly = plain({"control_output": output, "heating_signal": signal}, 3600.0)
    pwm = Belief({"modulator": Choice.of(Pwm, {"period_s": 3600.0})})
    segment = Segment(("modulator",), "control_output", ("heating_signal",))
    assert hourly.binary == {"control_output"}
    shown = segment.predict(hourly, pwm)["heating_signal"]
    assert np.isfinite(shown).all()
    assert shown[output == 1.0].mean() > 0.9


def test_pulses_without_that_rhythm_have_no_clock() -> None:
    seen = late_by(25)
    assert late_s(seen, Choice.of(Pwm, {"period_s": 2600.0})) == 0.0
    assert late_s(record("REAL"), Choice.of(Pwm, {"period_s": 3600.0})) == 0.0
