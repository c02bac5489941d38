"""An FMU does what the block does here, at any step of its importer, and refuses in words what it cannot do."""

from __future__ import annotations

import gc
import math
import os
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import psutil
import pytest
from fmpy.validation import validate_fmu

from tests.export.conftest import Made
from tests.export.importer import Fmu, Instance, Refused
from waxstudy.plugin import Choice
from waxstudy.plugin.registry import installed
from waxstudy.rig.bench import LEAD_S
from waxstudy.rig.programme import Trial, table_a1
from waxstudy.simulation.chain import Stepped

STEP_S = 5.0
TOLERANCE = 1e-9
IMPORTER_STEPS_S = (1.0, 5.0, 7.0, 60.0)
VERSIONS = (2, 3)


# --- the same as here ------------------------------------------------------------------------------


def signal_of(trial: Trial, longest_s: float) -> Callable[[float], float]:
    """The heating signal of a rig's programme: off, then on and off in turn."""
    draw = np.random.default_rng(1)
    switches_s = np.cumsum(np.concatenate(([draw.uniform(*LEAD_S)], trial.lengths_s(draw))))
    return lambda time_s: float(np.searchsorted(switches_s, time_s, side="right") % 2)


def stepped_here(
    component: str, signal: Callable[[float], float], length_s: float, until_s: float, **values: object
) -> list[float]:
    """The block's own step, every 5 s: each holds what the importer had set when the step began."""
    block = Stepped(Choice.of(installed().get("actuator", component), values), STEP_S)
    begins = STEP_S * np.arange(int(until_s / STEP_S))
    return [block.step(signal(math.floor(t / length_s + 1e-9) * length_s), float(t)) for t in begins]


def worst(fmu: Fmu, trial: Trial, length_s: float, until_s: float, **values: object) -> float:
    """The largest difference between the FMU's outputs and the block's, over a programme."""
    signal = signal_of(trial, until_s)
    here = [math.nan, *stepped_here("variable-times", signal, length_s, until_s, **values)]
    there, last, largest = Instance(fmu).begin(), -1.0, 0.0
    for number in range(int(until_s / length_s)):
        time_s = number * length_s
        if (now := signal(time_s)) != last:
            there.set("signal", now)
            last = now
        there.step(time_s, length_s)
        if (done := int((time_s + length_s) / STEP_S + 1e-9)) >= 1:
            largest = max(largest, abs(there.get("opening") - here[done]))
    there.free()
    assert max(here[1:]) == 1.0  # it was opened at all
    return largest


@pytest.mark.parametrize("length_s", IMPORTER_STEPS_S)
def test_an_fmu_gives_what_the_blocks_own_step_gives_at_any_step_of_the_importer(fmu: Made, length_s: float) -> None:
    trial = next(each for each in table_a1() if each.name == "B4v_5to15-5to15")
    assert worst(fmu(product="B"), trial, length_s, 3 * 3600.0, product="B") <= TOLERANCE


@pytest.mark.slow
@pytest.mark.parametrize("length_s", IMPORTER_STEPS_S)
def test_an_fmu_gives_what_the_blocks_own_step_gives_over_all_programmes_of_the_rig(fmu: Made, length_s: float) -> None:
    for trial in {(each.product, each.profile): each for each in table_a1()}.values():
        until_s = min(60.0 * trial.duration_min, 6 * 3600.0)
        found = worst(fmu(product=trial.product), trial, length_s, until_s, product=trial.product)
        assert found <= TOLERANCE, trial.name


@pytest.mark.parametrize("fmi", VERSIONS)
def test_an_fmu_is_valid_and_runs_in_fmpy_with_changed_parameters(fmu: Made, fmi: int, tmp_path: Path) -> None:
    made = fmu(product="B", fmi=fmi)
    path = str(Path(made.library._name).parents[3] / "block.fmu")
    assert validate_fmu(path) == []
    signal = np.array([(0.0, 0.0), (100.0, 1.0)], dtype=[("time", float), ("signal", float)])
    options = {"stop_time": 900.0, "output_interval": 5.0, "input": signal}
    as_is = fmpy.simulate_fmu(path, **options)
    later = fmpy.simulate_fmu(path, start_values={"actuator.dead_b_s": 332.0}, **options)
    first = [float(result["time"][np.argmax(result["opening"] > 0.0)]) for result in (as_is, later)]
    assert first[1] - first[0] == 100.0


def test_the_description_has_units_bounds_and_the_sentences_of_the_plugin(fmu: Made) -> None:
    named = {each.name: each for each in fmu(product="B").description.modelVariables}
    field = installed().get("actuator", "variable-times").Parameters.model_fields["fall_s"]
    fall = named["actuator.fall_s"]
    assert (fall.unit, fall.min, fall.max, fall.start) == ("s", "0.0", "3600.0", "123.0")
    assert fall.description == field.description
    assert "actuator.product" not in named  # a choice is made when the FMU is written
    assert "product = B" in fmu(product="B").description.description


def test_a_number_that_the_start_of_a_block_asks_for_cannot_be_changed_any_more(fmu: Made) -> None:
    made = fmu(kind="sensor", name="delay", delay_s=20.0)
    (delay,) = [each for each in made.description.modelVariables if each.name == "sensor.delay_s"]
    assert (delay.causality, delay.variability) == ("local", "constant")
    with pytest.raises(Refused, match="delay_s cannot be set"):
        Instance(made).set("sensor.delay_s", 40.0)
    there = Instance(made)
    shown = []
    there.begin()
    for number in range(6):
        there.set("temperature_C", float(number))
        there.step(5.0 * number, 5.0)
        shown.append(there.get("reading_C"))
    assert shown == [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


# --- state and instances ---------------------------------------------------------------------------


def run_on(there: Instance, begin: int, end: int) -> list[float]:
    found = []
    for number in range(begin, end):
        there.set("signal", float(number // 60 % 2 == 0))
        there.step(7.0 * number, 7.0)
        found.append(there.get("opening"))
    return found


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_state_can_be_kept_and_gone_back_to_also_in_another_instance(fmu: Made, fmi: int) -> None:
    made = fmu(product="B", fmi=fmi)
    there = Instance(made).begin()
    run_on(there, 0, 33)  # in the middle of a step of the block
    kept = there.state()
    data = there.serialized(kept)
    first = run_on(there, 33, 200)
    there.restore(kept)
    assert run_on(there, 33, 200) == first
    other = Instance(made, "other").begin()
    read = other.read_back(data)
    other.restore(read)
    assert run_on(other, 33, 200) == first
    assert max(first) > min(first)
    with pytest.raises(Refused, match="no state of this model"):
        other.read_back(b"x" * len(data))
    for instance, state in ((there, kept), (other, read)):
        instance.forget(state)
        instance.free()


def test_instances_beside_each_other_know_nothing_of_each_other(fmu: Made) -> None:
    made = fmu(product="B")
    first, second = Instance(made).begin(), Instance(made, "second").begin()
    first.set("signal", 1.0)
    for number in range(100):
        first.step(5.0 * number, 5.0)
        second.step(5.0 * number, 5.0)
    assert (first.get("opening"), second.get("opening")) == (1.0, 0.0)
    first.call("Reset")
    assert first.begin().get("opening") == 0.0


def test_ten_thousand_instances_leave_no_memory_behind(fmu: Made) -> None:
    made, process, left = fmu(product="B"), psutil.Process(os.getpid()), []
    for _ in range(5):
        many = [Instance(made) for _ in range(2_500)]  # beside each other
        for each in many:
            each.begin().step(0.0, 60.0)
            each.forget(each.state())
            each.free()
        del many, each
        gc.collect()
        left.append(process.memory_info().rss)
    # the allocator's own arrangement is of the first two rounds; then 100 bytes for each of the last 7,500
    assert left[-1] - left[1] < 750_000, left


# --- what is refused -------------------------------------------------------------------------------


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize(
    ("name", "value", "wrong"),
    [
        ("signal", math.nan, "signal cannot be nan"),
        ("signal", 1.5, "signal cannot be 1.5: allowed is from 0 and up to 1"),
        ("actuator.fall_s", 0.0, "fall_s cannot be 0: allowed is above 0 and up to 3600"),
        ("actuator.fall_s", math.inf, "fall_s cannot be inf"),
        ("opening", 0.5, "opening cannot be set"),
    ],
)
def test_a_value_that_is_not_allowed_is_refused_with_its_name_and_bounds(
    fmu: Made, fmi: int, name: str, value: float, wrong: str
) -> None:
    there = Instance(fmu(product="B", fmi=fmi))
    with pytest.raises(Refused, match=wrong):
        there.set(name, value)
    there.free()


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize(
    ("at", "length", "wrong"),
    [
        (0.0, 0.0, "a step of 0 s"),
        (0.0, -5.0, "a step of -5 s"),
        (0.0, math.nan, "a step of -?nan s"),
        (60.0, 5.0, "begins at 60 s, but the last one ended at 0 s"),
        (0.0, 1e12, "at most"),
    ],
)
def test_a_step_that_cannot_be_is_refused_and_changes_nothing(
    fmu: Made, fmi: int, at: float, length: float, wrong: str
) -> None:
    there = Instance(fmu(product="B", fmi=fmi)).begin()
    with pytest.raises(Refused, match=wrong):
        there.step(at, length)
    there.step(0.0, 5.0)
    there.free()


def test_parameters_are_set_before_initialization_ends_and_steps_come_after(fmu: Made) -> None:
    there = Instance(fmu(product="B"))
    with pytest.raises(Refused, match="needs an instance that is initialized"):
        there.step(0.0, 5.0)
    there.begin()
    with pytest.raises(Refused, match="set before initialization ends"):
        there.set("actuator.fall_s", 100.0)
    there.free()


def test_another_files_token_is_refused(fmu: Made) -> None:
    with pytest.raises(Refused, match="GUID"):
        Instance(fmu(product="B"), token="{0}")
    with pytest.raises(Refused, match="token"):
        Instance(fmu(product="B", fmi=3), token="{0}")
