"""Claims about standby pulses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.conftest import ROOT
from tests.paper.test_blocks import outputs
from waxstudy.plugin import CHAIN
from waxstudy.plugin.registry import installed
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.replay import replay
from waxstudy.study.model import Choice
from waxstudy.study.read import read_study
from waxstudy_paper.modulators import Pwm, Standby


def pulsed(levels: Any, **values: Any) -> np.ndarray:
    return outputs(Standby, levels, **{"signal": "switched", **values})


def test_pulses_begin_when_the_pause_is_long_enough_and_come_every_period() -> None:
    y = pulsed([1.0] * 60 + [0.0] * 720, pulse_s=40.0)
    on = 5.0 * (np.flatnonzero(np.diff(y, prepend=0.0) > 0.5))
    assert on.tolist() == [0.0, *np.arange(1200.0, 3900.0, 300.0)]
    assert y[60:].sum() * 5.0 == 9 * 40.0


def test_heating_goes_first_and_the_wait_begins_anew() -> None:
    level = np.zeros(600)
    level[200:210] = 1.0
    y = pulsed(level)
    assert y[200:210].all()
    assert not y[210 : 210 + 180].any()
    assert y[210 + 180]


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=400))
def test_a_pulse_of_0_is_pwm_alone(levels: list[float]) -> None:
    assert np.array_equal(outputs(Standby, levels, pulse_s=0.0, dt=30.0), outputs(Pwm, levels, dt=30.0))


@given(st.floats(1.0, 59.0), st.sampled_from([1.0, 5.0, 20.0, 60.0]))
def test_the_mean_duty_is_that_of_the_pulses_at_any_step(pulse_s: float, step_s: float) -> None:
    periods = 48
    y = pulsed(np.zeros(round(300.0 * periods / step_s)), dt=step_s, pulse_s=pulse_s, first_pulse_s=0.0)
    assert step_s * y.sum() == pytest.approx(periods * pulse_s, abs=0.5 * step_s + 1e-6)


def test_compiled_and_interpreted_give_the_same_pulses() -> None:
    rng = np.random.default_rng(1)
    level = np.repeat(rng.random(48) > 0.7, 180).astype(float)
    chain = Chain({"modulator": Choice.of(Standby, {"signal": "switched"})}, 5.0)
    n = len(level)
    ends, _ = replay(
        chain, "modulator", level, np.zeros(n), interval_s=5.0, start_s=0.0, jump=np.zeros(n), last="modulator"
    )
    assert np.array_equal(ends["modulator"], pulsed(level))


def test_pulses_without_rest_are_refused() -> None:
    with pytest.raises(ValueError, match=r"pulse_s = 300\.0 must be less than pulse_period_s = 300\.0"):
        Standby.Parameters.model_validate({"pulse_s": 300.0})


def test_the_study_of_standby_is_valid_and_changes_the_modulator_alone() -> None:
    study = read_study(ROOT / "studies" / "standby.toml", installed())
    for before, after in (("O_WM", "O_SB"), ("P_WM", "P_SB")):
        blocks, with_standby = study.cases[before].blocks, study.cases[after].blocks
        assert with_standby["modulator"].component is Standby
        rest = set(CHAIN) - {"modulator"}
        assert all(blocks.get(kind) == with_standby.get(kind) for kind in rest)
