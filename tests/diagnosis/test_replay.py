"""Claims about a chain driven by a record: it is the closed loop's chain, and a switch jumps where it is told to."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.diagnosis.realities import SETPOINT_C, belief, record, study
from waxstudy.conformance.drive import interpreted
from waxstudy.diagnosis.model.segments import segments
from waxstudy.plugin import CHAIN, TRACE, Actuator, Choice, FloatArray, SimulationError
from waxstudy.simulation import replay as replaying
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.engine import Loop
from waxstudy.simulation.interpreted import checked
from waxstudy.simulation.replay import replay
from waxstudy.simulation.run import prepare

STEP_S = 5.0
SHOWN = {"controller": "output", "modulator": "signal", "actuator": "opening", "valve": "flow_fraction"}
EACH_CASE = pytest.mark.parametrize("case", ["IDEAL", "LATE", "REAL", "PWM"])


def closed(case: str, hours: int = 30) -> tuple[Chain, FloatArray, FloatArray]:
    """The chain, what its sensor was exposed to in each step, and the trace, from a room at its setpoint."""
    driven = prepare(study()).driven["january"]
    chain = Chain(study().cases[case].blocks, STEP_S)
    loop = Loop(chain, driven, 21.0)
    state = loop.start(SETPOINT_C)
    first_C = float(state.readings[0])
    trace = loop.advance(state, np.arange(hours), 0.0, SETPOINT_C, trace=True)[1]
    return chain, np.concatenate(([first_C], trace[:-1, TRACE.index("air_C")])), trace


def held(chain: Chain, first: str, signal: FloatArray) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Each sample held over one step."""
    still = np.zeros(len(signal))
    setpoint_C = np.full(len(signal), SETPOINT_C)
    return replay(chain, first, signal, setpoint_C, interval_s=STEP_S, start_s=0.0, jump=still)


@EACH_CASE
def test_a_replayed_chain_does_what_it_did_in_the_closed_loop(case: str) -> None:
    chain, sensed_C, trace = closed(case)
    ends, means = held(chain, "sensor", sensed_C)
    for kind, name in SHOWN.items():
        in_loop = trace[:, TRACE.index(name)]  # type: ignore[arg-type]
        # the trace has the air, which is what the sensor was exposed to but for rounding
        assert ends[kind] == pytest.approx(in_loop, abs=1e-9)
        assert means[kind] == pytest.approx(in_loop, abs=1e-9)
    assert np.ptp(ends["valve"]) > 0.5


@EACH_CASE
@pytest.mark.parametrize("first", ["controller", "modulator", "actuator", "valve"])
def test_a_chain_can_begin_at_any_block_with_what_was_recorded_before_it(case: str, first: str) -> None:
    chain, sensed_C, _ = closed(case)
    whole, _ = held(chain, "sensor", sensed_C)
    before = CHAIN[CHAIN.index(first) - 1]
    part, _ = held(chain, first, whole[before])
    assert set(part) == set(CHAIN[CHAIN.index(first) :])
    for kind, values in part.items():
        assert np.array_equal(values, whole[kind])


@EACH_CASE
def test_compiled_blocks_give_what_each_gives_in_python(case: str) -> None:
    chain, sensed_C, _ = closed(case, hours=12)
    ends, _ = held(chain, "sensor", sensed_C)
    signal = sensed_C
    for place, kind in enumerate(CHAIN):
        if kind == "controller":
            signal = SETPOINT_C - signal
        if block := chain.blocks[place]:
            signal = np.array(interpreted(block, chain.plain[place], signal.tolist(), STEP_S))
        assert np.array_equal(ends[kind], signal)


@EACH_CASE
@pytest.mark.parametrize("last", CHAIN)
def test_what_lies_behind_the_last_block_is_left_out_and_the_rest_stays(case: str, last: str) -> None:
    chain = Chain(study().cases[case].blocks, STEP_S)
    signal, setpoint_C = 21.0 + np.cumsum(np.random.default_rng(5).normal(0.0, 0.05, 400)), np.full(400, 21.0)
    whole, part = (
        replay(chain, "sensor", signal, setpoint_C, interval_s=60.0, start_s=0.0, last=end) for end in (CHAIN[-1], last)
    )
    for every, some in zip(whole, part, strict=True):
        assert list(some) == list(CHAIN[: CHAIN.index(last) + 1])
        assert all(np.array_equal(every[kind], some[kind]) for kind in some)


def test_the_loop_in_python_gives_the_compiled_one_s_bits() -> None:
    chain = Chain(study().cases["REAL"].blocks, STEP_S)
    random = np.random.default_rng(4)
    signal, setpoint_C = 21.0 + np.cumsum(random.normal(0.0, 0.05, 400)), np.full(400, 21.0)
    ends, means = replay(chain, "sensor", signal, setpoint_C, interval_s=60.0, start_s=0.0)
    before, middle = np.concatenate((signal[:1], signal[:-1])), (np.arange(12) + 0.5) / 12
    u = np.concatenate([old + middle * (new - old) for old, new in zip(before, signal, strict=True)])
    states = chain.start()
    for place, kind in enumerate(CHAIN):
        if kind == "controller":
            u = np.repeat(setpoint_C, 12) - u
        if block := chain.blocks[place]:
            own = checked(block), chain.plain[place], states[place], chain.low[place], chain.high[place]
            assert replaying.run(*own, u, 0.0, STEP_S) == replaying.DONE
        assert np.array_equal(u[11::12], ends[kind])
        assert u.reshape(-1, 12).mean(axis=1) == pytest.approx(means[kind], rel=1e-12, abs=1e-12)


@given(st.integers(0, 12), st.booleans())
def test_a_switch_jumps_after_the_part_of_its_interval_that_it_is_given(twelfths: int, is_on_first: bool) -> None:
    signal = np.array([0.0, 0.0, 1.0, 1.0]) if not is_on_first else np.array([1.0, 1.0, 0.0, 0.0])
    jump = np.full(4, twelfths / 12.0)
    _, means = replay(Chain({}, STEP_S), "modulator", signal, signal, interval_s=60.0, start_s=0.0, jump=jump)
    new = 1.0 - twelfths / 12.0
    assert means["valve"][2] == pytest.approx(1.0 - new if is_on_first else new)
    assert means["valve"][[0, 1, 3]] == pytest.approx(signal[[0, 1, 3]])


@given(st.lists(st.floats(0.0, 1.0), min_size=2, max_size=20))
def test_without_jumps_a_signal_runs_straight_from_sample_to_sample(samples: list[float]) -> None:
    signal = np.array(samples)
    _, means = replay(Chain({}, STEP_S), "actuator", signal, signal, interval_s=60.0, start_s=0.0)
    between = 0.5 * (signal + np.concatenate((signal[:1], signal[:-1])))
    assert means["valve"] == pytest.approx(between)


@given(st.integers(2, 200), st.integers(0, 199))
@settings(max_examples=20)
def test_what_comes_later_changes_nothing_before(count: int, place: int) -> None:
    chain = Chain(study().cases["REAL"].blocks, STEP_S)
    signal = np.where(np.arange(count) % 50 < 20, 1.0, 0.0)
    other = signal.copy()
    other[place % count :] = 1.0 - other[place % count :]
    both = [
        replay(chain, "actuator", each, each, interval_s=60.0, start_s=0.0, jump=np.full(count, 0.5))[0]["valve"]
        for each in (signal, other)
    ]
    assert np.array_equal(both[0][: place % count], both[1][: place % count])


class Failing(Actuator):
    """Loses itself after an hour."""

    name = "failing"
    api_version = "1.0"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return u if t < 3600.0 + 60.0 else float("nan")


def test_a_block_that_fails_is_named_with_the_time_of_the_record() -> None:
    chain = Chain({"actuator": Choice(Failing, Failing.Parameters())}, STEP_S)
    zero = np.zeros(200)
    with pytest.raises(SimulationError, match=r"actuator failed at .*1:01"):
        replay(chain, "actuator", zero, zero, interval_s=60.0, start_s=0.0)


def test_a_record_with_gaps_drives_every_link_to_finite_predictions() -> None:
    seen = record("REAL", missing=0.2)
    believed = belief("REAL", seen)
    assert np.isnan(seen.values["displacement"]).mean() == pytest.approx(0.2, abs=0.01)
    for segment in segments(seen, believed):
        for channel, values in segment.predict(seen, believed, segment.conventions[0]).items():
            assert np.isfinite(values).all() or channel == "return_temperature_C"
