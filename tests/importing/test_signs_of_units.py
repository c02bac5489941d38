"""Claims about units as signs, endings and letters in another case: known, or told why what has them is not used."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.cli.conftest import Entry
from tests.importing.conftest import read
from tests.importing.test_bad_input import house, imported, refused
from waxstudy.importing.units import conversion, is_unit


@pytest.mark.parametrize("unit", ["?", "!", "%-", "*", "(", "'", "~", "=", "\\"])
def test_a_sign_that_is_no_unit_is_told_to_be_none(entry: Entry, unit: str) -> None:
    assert not is_unit(unit)
    with pytest.raises(ValueError, match="no unit that is known"):
        conversion(unit, "level")
    done = imported(entry, house(), "--unit", f"heating_valve={unit}")
    refused(done, "no unit that is known")


def test_a_stroke_is_the_unit_of_what_has_none(entry: Entry) -> None:
    done = imported(entry, house().rename(columns={"heating_valve": "heating_valve [-]"}), "--yes")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["heating_signal"].to_list() == house()["heating_valve"].to_list()


@pytest.mark.parametrize(
    ("name", "factor"),
    [("Durchfluss_l_min", 60.0), ("Durchfluss l/m", 60.0), ("Durchfluss_lmin", 60.0), ("Flow_LPM", 60.0),
     ("flow_kg_h", 1.0), ("Flow_l_s", 3600.0), ("Durchfluss [L/H]", 1.0), ("Durchfluss [l/m]", 60.0),
     ("Flow L/S", 3600.0)],
)  # fmt: skip
def test_the_unit_of_a_flow_is_heard_in_any_case(entry: Entry, name: str, factor: float) -> None:
    frame = house()
    frame[name] = (frame.pop("flow_L_h") / factor).round(6)
    done = imported(entry, frame, "--yes")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["flow_L_h"].max() == pytest.approx(60.0, rel=1e-3)


@pytest.mark.parametrize("degree", ["°", "º", " Grad", "ºC"])
def test_a_mere_degree_behind_a_temperature_is_one_of_its_scale(entry: Entry, degree: str) -> None:
    frame = house()
    written = frame["room_temperature"].map(lambda value: f"{value:.3f}{degree}")
    done = imported(entry, frame.assign(room_temperature=written), "--yes")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["sensor_temperature_C"].to_list() == frame["room_temperature"].to_list()


def test_a_degree_of_what_is_no_temperature_is_an_angle(entry: Entry) -> None:
    frame = house(days=1.0).assign(**{"sun elevation [°]": 5.0})
    frame["sun elevation [°]"] += np.linspace(-9.0, 9.0, len(frame))
    del frame["outdoor_temperature"]
    refused(imported(entry, frame, "--yes"), "no outdoor temperature was found")


def test_what_is_not_used_because_of_its_unit_is_told(entry: Entry) -> None:
    done = imported(entry, house().rename(columns={"flow_L_h": "Flow [l/mm]"}), "--yes")
    assert done.code == 0, done.stderr
    assert "not used, because the unit is of something else than the name: Flow ('l/mm')" in " ".join(
        done.stderr.split()
    )
