"""Coarse samples: what happened between two of them is not taken for another motor or valve."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tests.diagnosis.realities import PERFECT, belief, dataset, record, rows
from waxstudy.diagnosis.diagnose import diagnose
from waxstudy.diagnosis.model.opening_path import cells, path
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.residuals.continuous import is_lone, of_unknown_length
from waxstudy.diagnosis.residuals.judge import Judge


@given(arrays(float, st.integers(2, 60), elements=st.sampled_from([0.0, 0.1, 0.35, 0.6, 0.9, 1.0])))
def test_a_path_goes_through_its_samples_and_stays_between_them(opening: np.ndarray) -> None:
    fine = path(opening, 60.0)
    parts = cells(60.0)
    np.testing.assert_allclose(fine[parts - 1 :: parts], opening, atol=1e-12)
    low, high = np.minimum(opening[:-1], opening[1:]), np.maximum(opening[:-1], opening[1:])
    inner = fine[parts:].reshape(-1, parts)
    assert (inner >= low[:, None] - 1e-12).all()
    assert (inner <= high[:, None] + 1e-12).all()


@pytest.mark.parametrize("late_s", [0.0, 20.0, 45.0])
def test_a_motor_that_moves_evenly_is_followed_between_its_samples(late_s: float) -> None:
    at_s = 15.0 * np.arange(1, 121)
    true = np.clip((at_s - 300.0 - late_s) / 150.0, 0.0, 1.0) - np.clip((at_s - 1200.0 - late_s) / 200.0, 0.0, 1.0)
    np.testing.assert_allclose(path(true[3::4], 60.0), true, atol=1e-9)


@given(st.floats(0.0, 119.0))
def test_a_move_that_takes_no_whole_interval_is_as_fast_as_the_fastest_of_the_record(late_s: float) -> None:
    """A stroke of 140 s takes one of 120 s whole only if it begins shortly before, as the second one does."""
    at_s = 15.0 * np.arange(1, 401)
    moves = [(600.0 + late_s, 2400.0 + late_s), (3590.0, 4790.0)]
    true = sum(np.clip((at_s - on) / 140.0, 0.0, 1.0) - np.clip((at_s - off) / 140.0, 0.0, 1.0) for on, off in moves)
    np.testing.assert_allclose(path(true[7::8], 120.0), true, atol=1e-9)
    lost = np.append(true, np.repeat([1.0, 0.0, 1.0], 8) if true[-1] else np.repeat([0.0, 1.0, 0.0], 8))
    np.testing.assert_allclose(path(lost[7::8], 120.0)[:400], true, atol=1e-9)


def test_a_motor_that_turns_back_is_followed_from_sample_to_sample() -> None:
    opening = np.array([0.0, 0.3, 0.0, 0.0, 0.9, 1.0, 0.7, 1.0])
    straight = np.interp(np.arange(1.0, 8.01, 0.25) - 1.0, np.arange(8.0), opening)
    np.testing.assert_allclose(path(opening, 60.0)[3:12], straight[:9])
    np.testing.assert_allclose(path(opening, 60.0)[23:], straight[20:])


@pytest.mark.parametrize("interval_s", [60.0, 300.0, 900.0])
def test_what_is_believed_and_true_is_missed_by_noise_alone_however_coarse_the_samples(interval_s: float) -> None:
    seen = record("WAX", days=7, interval_s=interval_s, **PERFECT)
    believed = belief("WAX", seen)
    (motor,) = [segment for segment in segments(seen, believed) if segment.stages == ("actuator",)]
    (residual,) = Judge(motor, seen, believed).residuals(motor.predict(seen, believed))
    assert residual.gap() < 0.03  # 7.5 s of a stroke of 150 s is 0.05
    assert residual.judged.mean() > 0.7


@pytest.mark.parametrize("full", [1e-4, 1.0, 120.0])
def test_a_pulse_between_two_samples_is_left_out_and_a_lasting_change_is_not(full: float) -> None:
    drive, opening = np.zeros(20), np.zeros(20)
    opening[[8, 15]] = 0.6, 1.0
    assert np.flatnonzero(is_lone(full * opening, drive)).tolist() == [8, 15]
    opening[15:] = 1.0, 0.92, 0.92, 0.92, 0.92  # nor is a change that hardly swings back
    assert np.flatnonzero(is_lone(full * opening, drive)).tolist() == [8]
    opening[8:] = 0.6
    assert not is_lone(full * opening, drive).any()
    assert not is_lone(drive, opening).any()


def test_a_pulse_or_pause_that_one_sample_shows_is_left_out_with_what_follows_it() -> None:
    """It lasted nothing to two intervals: a motor may have come half way, or all of it."""
    drive = np.array([0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 1, 1, 1, 0, 0, 0], dtype=float)
    assert np.flatnonzero(of_unknown_length(drive, 6)).tolist() == [2, 3, 4, 5, 9, 10, 11, 12]
    assert np.flatnonzero(of_unknown_length(drive, 2)).tolist() == [2, 3, 4, 9, 10, 11]
    assert not of_unknown_length(np.zeros(5), 6).any()


@pytest.mark.parametrize("switch", range(5, 12))
def test_a_sample_alone_where_the_drive_moves_is_its_answer(switch: int) -> None:
    drive, opening = np.zeros(20), np.zeros(20)
    opening[8] = 0.6
    drive[switch:] = 1.0
    assert is_lone(opening, drive).any() == (switch not in (7, 8, 9))


@pytest.mark.slow
def test_nothing_is_claimed_of_a_loop_as_believed_that_is_sampled_coarsely() -> None:
    diagnosis = diagnose(dataset(rows("REAL", days=7, interval_s=900.0), "REAL"), quick=True)
    assert (diagnosis.verdict, list(diagnosis.effects)) == ("none", [])
