"""Claims about the list of checks: each finds its fault and none in a good record, and the page lists them all."""

from __future__ import annotations

from collections.abc import Callable
from itertools import groupby

import numpy as np
import pandas as pd
import pytest

from tests.dataset.regenerate_checks import PAGE, page
from tests.synthetic.conftest import Simulated, written
from waxstudy.dataset.channels import GLOBAL
from waxstudy.dataset.checks import CHECKS, Check, Record, run, samples
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.read import read_dataset
from waxstudy.study.model import Study

INTERVAL_S = 60.0
Change = Callable[[pd.DataFrame], pd.DataFrame]


def changed(name: str, change: Callable[[pd.Series], pd.Series | float]) -> Change:
    return lambda values: values.assign(**{name: change(values[name])})


def sample(name: str, value: float) -> Change:
    return changed(name, lambda x: x.where(np.arange(len(x)) != 700, value))


def swapped(one: str, other: str) -> Change:
    return lambda values: values.rename(columns={one: other, other: one})


def between(x: pd.Series, first: int, end: int) -> np.ndarray:
    return np.isin(np.arange(len(x)), range(first, end))


AIR = "air_temperature_C"
ROOM = [AIR, "sensor_temperature_C", "operative_temperature_C"]
# of each check, a fault for each thing that it does
FAULTS: dict[str, dict[str, Change]] = {
    "code": {"discards": sample(AIR, -999.0)},
    "impossible-sample": {"discards": sample(AIR, 80.0)},
    "spike": {"discards": sample(AIR, 30.0)},
    "failed": {"discards": changed(AIR, lambda x: x.mask(between(x, 700, 760), 5.0))},
    "peak": {"discards": sample("flow_L_h", 250.0)},
    "stray": {"discards": sample("displacement", 2.0)},
    "temperature": {"refuses": changed(AIR, lambda x: x + 273.15), "warns": changed(AIR, lambda x: x + 16.0)},
    "level": {
        "refuses": changed("displacement", lambda x: 100.0 * x),
        "warns": changed("displacement", lambda x: 1.1 * x),
    },
    "light": {"refuses": lambda values: values.assign(**{GLOBAL: 20_000.0})},
    "light-at-night": {"warns": lambda values: values.assign(**{GLOBAL: 100.0})},
    "gain": {"refuses": changed("internal_gain_W", lambda x: -x), "warns": sample("internal_gain_W", -50.0)},
    "flow": {
        "refuses": changed("flow_L_h", lambda x: x / 1000.0),
        "warns": changed("flow_L_h", lambda x: 10.0 * x / x.max()),
    },
    "dead-meter": {"discards": changed("flow_L_h", lambda x: 0.0 * x)},
    "still": {"discards": changed(AIR, lambda x: x.where(np.arange(len(x)) > 1500, 21.0))},
    "gaps": {"warns": sample(AIR, np.nan)},
    "constant": {"warns": changed(AIR, lambda x: 21.0)},
    "stuck": {"warns": changed(AIR, lambda x: x.where(np.arange(len(x)) > 400, 21.0))},
    "clipped": {"warns": changed(AIR, lambda x: x.clip(upper=x.quantile(0.8)))},
    "room-and-outdoors": {
        "refuses": lambda values: values.assign(air_temperature_C=values["outdoor_temperature_C"]),
        "warns": lambda values: values.assign(air_temperature_C=values["outdoor_temperature_C"] - 3.0),
    },
    "room-and-setpoint": {"refuses": swapped(AIR, "setpoint_C")},
    "room-and-supply": {"refuses": swapped(AIR, "supply_temperature_C")},
    "ventilation-and-outdoors": {"refuses": swapped("ventilation_supply_temperature_C", "outdoor_temperature_C")},
    "supply-and-return": {
        "refuses": swapped("supply_temperature_C", "return_temperature_C"),
        "warns": lambda values: swapped("supply_temperature_C", "return_temperature_C")(values).drop(columns=ROOM),
    },
    "output-and-signal": {"refuses": lambda values: values.assign(heating_signal=np.linspace(0.0, 1.0, len(values)))},
    "output-without-signal": {"warns": lambda values: values.drop(columns="heating_signal")},
    "signal-and-opening": {"refuses": swapped("heating_signal", "displacement")},
    "sensor-and-air": {"warns": changed(AIR, lambda x: x + 4.0)},
    "air-and-another": {"refuses": swapped(AIR, "ventilation_supply_temperature_C")},
    "sun-at-night": {
        "refuses": swapped("solar_gain_W", "internal_gain_W"),
        "warns": lambda values: values[["solar_gain_W"]] + 100.0,
    },
    "turned": {"refuses": changed("heating_signal", lambda x: 1.0 - x)},
    "clock-offset": {
        "refuses": swapped("heating_signal", "displacement"),
        "warns": changed("flow_L_h", lambda x: x.shift(-30)),
    },
    "early-sensor": {"warns": changed("sensor_temperature_C", lambda x: x.shift(-20))},
}


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory, study: Study, simulated: Simulated) -> pd.DataFrame:
    """Two days three times over, so that there are enough edges."""
    folder = written(tmp_path_factory.mktemp("checks") / "room", study, simulated, "O_WM", "O_CP")
    values = pd.concat([read_dataset(folder).values] * 3)
    return values.set_axis(pd.date_range("2020-01-06", periods=len(values), freq="min"), axis="index")


def done(check: Check, values: pd.DataFrame) -> set[str]:
    """What a check does about a record."""
    notes = Notes("data.csv")
    has_modulator = check.name in ("output-and-signal", "output-without-signal")
    run([check], Record(values.copy(), INTERVAL_S, has_modulator, full_flow_L_h=None), notes)
    warned = {"discards" if sentence.endswith("set to missing") else "warns" for sentence in notes.warnings}
    return warned | ({"refuses"} if notes.problems else set())


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.name)
def test_each_check_finds_its_fault_and_none_in_a_good_record(check: Check, good: pd.DataFrame) -> None:
    assert done(check, good) == set()
    for does, spoilt in FAULTS[check.name].items():
        assert done(check, spoilt(good)) == {does}
    assert " or ".join(FAULTS[check.name]) == check.does


# of a channel that a slower logger wrote: the good record in one row of ten, spoilt in a few of those
SPARSE: dict[str, tuple[str, dict[str, Change]]] = {
    "flow": ("flow_L_h", {"warns": changed("flow_L_h", lambda x: x.where(np.arange(len(x)) % 100 != 0, -20.0))}),
    "stray": ("displacement", {"": changed("displacement", lambda x: x.where(np.arange(len(x)) % 2000 != 0, 2.0))}),
}


def test_each_time_that_a_thermometer_stands_still_is_lost(good: pd.DataFrame) -> None:
    (check,) = (each for each in CHECKS if each.name == "still")
    place = np.arange(len(good))
    twice = good.assign(**{AIR: good[AIR].mask(place < 1500, 21.0).mask((place >= 2000) & (place < 4000), 22.0)})
    values = twice.copy()
    run([check], Record(values, INTERVAL_S, False, full_flow_L_h=None), Notes("data.csv"))
    assert values[AIR].isna().sum() == 1499 + 1999


def test_a_sensor_that_failed_for_hours_is_lost_there_alone_however_often(good: pd.DataFrame) -> None:
    (check,) = (each for each in CHECKS if each.name == "failed")
    x = good["outdoor_temperature_C"]
    lost = between(x, 700, 1000) | between(x, 2000, 2100)
    values = good.assign(outdoor_temperature_C=x.mask(lost, -50.0).mask(between(x, 998, 1001)))
    run([check], Record(values, INTERVAL_S, False, full_flow_L_h=None), notes := Notes("data.csv"))
    assert (values["outdoor_temperature_C"].isna() == (lost | between(x, 998, 1001))).all()
    assert "398 samples are of one value" in notes.warnings[0]


@pytest.mark.parametrize("places", [[700], list(range(700, 760))], ids=["once", "for an hour"])
def test_a_room_of_0_C_is_a_bus_that_failed_unless_the_room_is_that_cold(places: list[int], good: pd.DataFrame) -> None:
    (check,) = (each for each in CHECKS if each.name == "code")
    lost = good.assign(**{AIR: good[AIR].mask(np.isin(np.arange(len(good)), places), 0.0)})
    assert done(check, lost) == {"discards"}
    assert done(check, lost.assign(**{AIR: lost[AIR] - 18.0 * (lost[AIR] > 0.0)})) == set()
    assert done(check, lost.assign(outdoor_temperature_C=0.0, **{AIR: good[AIR]})) == set()
    assert done(check, good.assign(**{AIR: 0.0})) == set()


# no faults: a room that is known to half a kelvin, a chamber, and a valve that never opens
MEANT: dict[str, Change] = {
    "still": changed(AIR, lambda x: (2.0 * x.where(np.arange(len(x)) > 1500, 21.0)).round() / 2.0),
    "still to a fifth of a kelvin": changed(
        AIR, lambda x: (5.0 * x.where(np.arange(len(x)) > 1500, 21.0)).round() / 5.0
    ),
    "still that is held": changed(
        "ventilation_supply_temperature_C", lambda x: x.where(np.arange(len(x)) > 1500, 18.0)
    ),
    "still in fog": changed("outdoor_temperature_C", lambda x: x.where(np.arange(len(x)) > 1500, 0.0).round()),
    "failed of a setpoint": changed("setpoint_C", lambda x: x.mask(between(x, 700, 760), 5.0)),
    "failed of a switched supply": changed(
        "supply_temperature_C", lambda x: x.mask(np.arange(len(x)) % 400 < 30, 60.0).mask(between(x, 900, 950), 61.0)
    ),
    "failed of a supply of two values": changed(
        "supply_temperature_C", lambda x: pd.Series(np.where(np.arange(len(x)) % 400 < 30, 60.0, 20.0), x.index)
    ),
    "failed that is a window": changed(
        AIR, lambda x: x.mask(between(x, 700, 702), 15.0).mask(between(x, 702, 704), 18.0)
    ),
    "failed that never comes back": changed(AIR, lambda x: x.mask(np.arange(len(x)) > len(x) - 60, 5.0)),
    "failed that is a step over days without samples": changed(
        "outdoor_temperature_C",
        lambda x: x.mask(between(x, 700, 4000)).mask(between(x, 4000, 4060), 25.0).mask(between(x, 4060, 8000)),
    ),
    "code of a setpoint": changed("setpoint_C", lambda x: x.where(np.arange(len(x)) > 300, 0.0)),
    "dead-meter that was off": lambda values: values.assign(
        flow_L_h=values["flow_L_h"].where(values["displacement"] <= 0.0) * 0.0
    ),
    "still of outdoors": changed("outdoor_temperature_C", lambda x: 0.0),
    "dead-meter": lambda values: values.assign(flow_L_h=0.0, displacement=0.0),
}


@pytest.mark.parametrize("name", MEANT)
def test_what_may_be_meant_so_is_kept(name: str, good: pd.DataFrame) -> None:
    (check,) = (each for each in CHECKS if each.name == name.split()[0])
    assert done(check, MEANT[name](good)) == set()


@pytest.mark.parametrize("name", SPARSE)
def test_rows_without_a_value_are_none_of_a_channel_s_samples(name: str, good: pd.DataFrame) -> None:
    """A tenth of the flow is negative; and of some 800 levels five are too many strays to be faults."""
    (check,) = (each for each in CHECKS if each.name == name)
    channel, faults = SPARSE[name]
    for does, spoilt in faults.items():
        sparse = changed(channel, lambda x: x.where(np.arange(len(x)) % 10 == 0))(spoilt(good))
        assert done(check, sparse) == {does} - {""}


def test_what_is_run_channel_by_channel_stands_together_in_the_list() -> None:
    topics = [topic for topic, _ in groupby(check.about for check in CHECKS)]
    assert len(topics) == len(set(topics))


def test_the_page_lists_every_check() -> None:
    current = PAGE.read_text(encoding="utf-8") == page()
    assert current, f"the table of {PAGE.name} is old: python -m tests.dataset.regenerate_checks"


def test_two_values_of_a_failed_sensor_do_not_hide_each_other_and_switched_water_is_none() -> None:
    air = 20.0 + np.sin(np.arange(3000) / 40.0) + 0.01 * (np.arange(3000) % 7)
    air[700:800], air[1500:1600] = -15.0, 45.0
    lost = samples._left(air, 4.0, 60.0)
    assert lost.sum() == 200
    assert lost[700:800].all()
    assert lost[1500:1600].all()
    names = {name for check in CHECKS if check.name == "failed" for (name,) in check.of}
    assert AIR in names
    assert not names & {"supply_temperature_C", "return_temperature_C", "ventilation_supply_temperature_C"}
