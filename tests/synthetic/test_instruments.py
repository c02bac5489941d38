"""Claims about measuring: what is a mean is one, what is noise has the size stated, what is lost is lost."""

from __future__ import annotations

from datetime import datetime

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.synthetic.conftest import Simulated
from waxstudy.dataset.channels import CHANNELS, LIGHT
from waxstudy.synthetic.instruments import Instruments, gaps, measure
from waxstudy.synthetic.simulate import RealityError

PERFECT = {"noise": dict.fromkeys(CHANNELS, 0.0), "resolution": dict.fromkeys(CHANNELS, 0.0)}
MEANS = ("flow_L_h", "solar_gain_W", "internal_gain_W")


def perfect(interval_s: float) -> Instruments:
    return Instruments(interval_s=interval_s, **PERFECT)


@pytest.mark.parametrize("interval_s", [5.0, 60.0, 900.0])
def test_flow_and_gains_are_means_so_that_their_sums_are_kept(simulated: Simulated, interval_s: float) -> None:
    reality = simulated("O_WM")
    data = measure(reality, perfect(interval_s))
    for name in MEANS:
        in_steps = reality.week.channels[CHANNELS[name].source].sum() * reality.week.step_s
        assert data[name].sum() * interval_s == pytest.approx(in_steps, rel=1e-5)
    assert data["flow_L_h"].sum() > 0.0


@pytest.mark.parametrize("name", sorted(set(CHANNELS) - {*MEANS, *LIGHT, "neighbour_temperature_C"}))
def test_all_else_is_the_value_at_the_end_of_the_interval(simulated: Simulated, name: str) -> None:
    reality = simulated("O_WM")
    data = measure(reality, perfect(60.0))
    at_ends = reality.week.channels[CHANNELS[name].source][11::12]
    assert data[name].to_numpy() == pytest.approx(at_ends, abs=1e-6)


def test_the_stamps_are_the_ends_of_the_intervals(simulated: Simulated) -> None:
    reality = simulated("O_WM")
    times = [datetime.fromisoformat(text) for text in measure(reality, perfect(600.0))["time"]]
    start = datetime.fromisoformat(reality.first_day)
    assert [(time - start).total_seconds() for time in times] == [600.0 * (n + 1) for n in range(288)]


def test_noise_has_the_standard_deviation_stated_and_no_mean(simulated: Simulated) -> None:
    exact = measure(simulated("O_WM"), perfect(5.0))
    noise = {"air_temperature_C": 0.2, "supply_temperature_C": 0.05}
    noisy = measure(
        simulated("O_WM"), Instruments(5.0, noise=PERFECT["noise"] | noise, resolution=PERFECT["resolution"])
    )
    errors = noisy[list(noise)] - exact[list(noise)]
    n = len(errors)
    for name, sd in noise.items():
        assert errors[name].std() == pytest.approx(sd, rel=4.0 / np.sqrt(2.0 * n))
        assert abs(errors[name].mean()) < 4.0 * sd / np.sqrt(n)
    assert abs(np.corrcoef(errors.to_numpy().T)[0, 1]) < 4.0 / np.sqrt(n)
    untouched = [name for name in exact.columns if name not in noise]
    pd.testing.assert_frame_equal(noisy[untouched], exact[untouched])


def test_instruments_stay_within_their_range_and_a_meter_that_stands_still_shows_nothing(simulated: Simulated) -> None:
    flow = measure(simulated("O_WM"), perfect(60.0))["flow_L_h"]
    data = measure(simulated("O_WM"), Instruments(noise={"displacement": 0.2, "flow_L_h": 5.0}))
    assert data["displacement"].between(0.0, 1.0).all()
    assert (data["flow_L_h"] >= 0.0).all()
    assert (data["flow_L_h"][flow == 0.0] == 0.0).all()
    assert data["flow_L_h"][flow > 100.0].std() > 3.0


def test_a_reading_is_a_multiple_of_the_resolution(simulated: Simulated) -> None:
    data = measure(simulated("O_WM"), Instruments(resolution={"air_temperature_C": 0.25}))
    steps = data["air_temperature_C"] / 0.25
    assert np.array_equal(steps, steps.round())
    assert steps.nunique() > 2


def test_the_share_asked_for_is_lost_in_gaps_that_measured_channels_have_in_common(simulated: Simulated) -> None:
    data = measure(simulated("O_WM"), Instruments(missing=0.1))
    lost = data["air_temperature_C"].isna()
    assert lost.sum() == 288
    for name in data.columns.drop("time"):
        assert data[name].isna().sum() == (0 if CHANNELS[name].is_assumed else 288)
    starts = (lost & ~lost.shift(fill_value=False)).sum()
    assert 288 / starts > 5  # minutes


@given(st.integers(2, 3000), st.sampled_from([5.0, 60.0, 3600.0]), st.floats(0.0, 0.5), st.integers(0, 99))
def test_the_share_lost_is_exact_whatever_the_record(count: int, interval_s: float, share: float, seed: int) -> None:
    assert gaps(count, interval_s, share, np.random.default_rng(seed)).sum() == round(share * count)


def test_the_same_seed_gives_the_same_readings_and_another_others(simulated: Simulated) -> None:
    first, again, other = (measure(simulated("O_WM"), Instruments(missing=0.05, seed=seed)) for seed in (7, 7, 8))
    pd.testing.assert_frame_equal(first, again)
    for name in ("air_temperature_C", "flow_L_h"):
        assert not first[name].equals(other[name])


def test_leaving_a_channel_out_changes_no_other(simulated: Simulated) -> None:
    whole = measure(simulated("O_WM"), Instruments(missing=0.05))
    part = measure(simulated("O_WM"), Instruments(missing=0.05, without=["sensor_temperature_C", "flow_L_h"]))
    pd.testing.assert_frame_equal(part, whole.drop(columns=["sensor_temperature_C", "flow_L_h"]))


def test_an_interval_that_the_step_does_not_divide_is_refused(simulated: Simulated) -> None:
    with pytest.raises(RealityError, match="an interval of 7 s is no multiple of the study's step_s = 5"):
        measure(simulated("O_WM"), Instruments(interval_s=7.0))
