"""Claims about what looks like something else: it is taken for what it is, asked for, or left out with a reason."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.importing.conftest import read
from tests.importing.test_bad_input import house, imported, refused

AIR = ("--map", "air_temperature_C=room_temperature")


@pytest.fixture
def frame() -> pd.DataFrame:
    return house(days=1.0, minutes=15.0)


# --- degrees Fahrenheit


@pytest.mark.parametrize(
    "name", ["Room 3 blind position", "Raum 3 Stellgröße", "room floor flow", "Zimmer Stellgröße Soll", "room air"]
)
def test_a_number_of_a_room_that_is_no_temperature_makes_no_degrees_fahrenheit(
    name: str, frame: pd.DataFrame, entry: Entry
) -> None:
    other = pd.Series(np.resize([80.0, 71.5, 92.0], len(frame)), frame.index)
    done = imported(entry, frame.assign(**{name: other}), "--yes", *AIR)
    assert "degF" not in done.stdout + done.stderr
    if done.code == 0:
        assert read(Path("living"))["outdoor_temperature_C"].to_list() == frame["outdoor_temperature"].to_list()


def test_a_source_that_writes_celsius_has_no_fahrenheit(frame: pd.DataFrame, entry: Entry) -> None:
    warm = frame.assign(room_temperature=70.0).rename(columns={"supply_temperature": "supply_temperature [°C]"})
    done = imported(entry, warm, *AIR)
    refused(done, "room_temperature in 'C' as air_temperature_C", "say its unit: --unit 'room_temperature=degF'")


def test_the_unit_that_made_a_misfit_is_not_its_way_out(frame: pd.DataFrame, entry: Entry) -> None:
    done = imported(entry, frame, *AIR, "--unit", "room_temperature=degF")
    refused(done, "room_temperature in 'degF' as air_temperature_C", "say its unit: --unit 'room_temperature=degC'")
