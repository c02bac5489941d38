"""Claims about waxstudy from Python: it says what the command line says, and imports nothing before it is used."""

from __future__ import annotations

import json
import pkgutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import waxstudy as wx
from tests.cli.conftest import Entry
from tests.cli.conftest import entry as entry
from tests.conftest import ROOT, SMALL
from tests.diagnosis.realities import rows
from tests.fleet.conftest import FLEET

PUBLIC = Path(__file__).with_name("public.txt")
NOMINAL = {
    "setpoint_C": 21.0,
    "sensor": {"use": "delay", "delay_s": 120.0},
    "controller": {"use": "on-off", "dead_band_K": 0.5},
    "actuator": {"use": "variable-times"},
    "valve": {"use": "quick-opening"},
}


def test_what_is_public_is_what_the_list_says() -> None:
    assert sorted(wx.__all__) == PUBLIC.read_text().split()
    assert all(getattr(wx, name) is not None for name in wx.__all__)
    assert dir(wx) == sorted(wx.__all__)
    with pytest.raises(AttributeError, match="no attribute 'runn'"):
        wx.runn  # noqa: B018


def test_the_import_brings_nothing_heavy() -> None:
    asked = "import sys, waxstudy; print(sorted({'numpy', 'pandas', 'numba', 'scipy', 'click'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_no_package_takes_the_place_of_a_public_name_once_it_is_imported() -> None:
    assert {each.name for each in pkgutil.iter_modules(wx.__path__)} & set(wx.__all__) == set()
    asked = "import waxstudy as wx; wx.Swept; print(wx.sweep.__name__, callable(wx.sweep))"
    done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    assert done.stdout == "sweep True\n"


def test_it_can_be_called_as_a_module() -> None:
    done = subprocess.run([sys.executable, "-m", "waxstudy", "--version"], capture_output=True, text=True, check=True)
    assert wx.__version__ in done.stdout


# --- studies ---------------------------------------------------------------------------------------


def test_a_run_tells_what_the_command_tells(entry: Entry, small_study: Path, small_run: Path) -> None:
    told: list[tuple[int, int]] = []
    run = wx.run(small_study, small_run, progress=lambda done, total: told.append((done, total)))
    assert told[0] == (0, 3)
    assert told[-1] == (3, 3)
    printed = json.loads(entry("report", "run", "--json").stdout)
    for row in printed["rows"]:
        mine = run.differences.loc[(row["week"], row["case"])]
        assert mine["heat_kWh_m2_week"] == pytest.approx(row["heat_kWh_m2_week"]["mean"], abs=1e-5)
        assert mine["single_run_share"] == pytest.approx(row["single_run_share"] or np.nan, nan_ok=True)
    traces = run.traces("O_WM", "january")
    assert isinstance(traces.index.get_level_values("time"), pd.DatetimeIndex)
    assert traces.attrs["units"]["flow_L_h"] == "L/h"
    assert run.differences.attrs["units"]["setpoint_shift_K_sd"] == "K"
    with pytest.raises(KeyError, match="no case 'O_XX' in week 'january': cases O_0, O_CP, O_WM"):
        run.traces("O_XX", "january")
    assert "O_WM" in run._repr_html_()


def test_a_study_may_be_a_mapping_and_its_results_go_with_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    run = wx.run(tomllib.loads(SMALL))
    folder = run.folder
    assert set(run.kpis["case"]) == {"O_0", "O_CP", "O_WM"}
    del run
    assert not folder.exists()
    assert list(tmp_path.iterdir()) == []


def test_what_is_wrong_with_a_study_has_its_fields(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    study = tomllib.loads(SMALL)
    study["ensemble"]["membres"] = 3
    with pytest.raises(wx.StudyError, match="membres") as told:
        wx.run(study)
    (problem,) = told.value.problems
    assert (problem.where, problem.key, problem.near) == ("[ensemble]", "membres", "members")
    assert str(problem).startswith("study: [ensemble] membres")
    with pytest.raises(wx.StudyError, match="no study file can hold"):
        wx.run({**tomllib.loads(SMALL), "output": None})


def test_replace_is_refused_where_it_would_do_nothing(tmp_path: Path) -> None:
    (tmp_path / "fleet.toml").write_text(FLEET)
    with pytest.raises(ValueError, match=r"this study has \[activation\]"):
        wx.run(tmp_path / "fleet.toml", tmp_path / "run", replace=True)
    assert not (tmp_path / "run").exists()


def test_an_edited_mapping_goes_on_in_its_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    study = tomllib.loads(SMALL)
    before = wx.run(study, "run").differences.loc[("january", "O_CP"), "mae_K"]
    study["ladder"]["on-off"]["steps"][0]["controller"]["dead_band_K"] = 0.6
    after = wx.run(study, "run").differences.loc[("january", "O_CP"), "mae_K"]
    assert after > before


def test_a_run_that_fails_leaves_no_folder_behind(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    study = tomllib.loads(SMALL)
    study["weather"] = {"january": {"use": "epw", "path": "nowhere.epw"}}
    with pytest.raises(wx.StudyError, match=r"nowhere\.epw"):
        wx.run(study)
    study["weather"] = tomllib.loads(SMALL)["weather"]
    monkeypatch.setattr("waxstudy.simulation.run.free_disk", lambda folder: 1.0)
    with pytest.raises(wx.RunError, match="free on the disk"):
        wx.run(study)
    assert list(tmp_path.iterdir()) == []


# --- records ---------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def frame() -> pd.DataFrame:
    """Four days of a loop whose sensor lags, every minute."""
    made = rows("REAL")
    return made.drop(columns="time").set_index(pd.DatetimeIndex(made["time"]))


def test_a_frame_is_a_record_in_whatever_unit_and_zone(frame: pd.DataFrame) -> None:
    plain = wx.Dataset.from_frame(frame, believed=NOMINAL, room={"use": "nzeb"})
    strange = frame.assign(sensor_temperature_C=frame["sensor_temperature_C"] * 1.8 + 32.0).rename(
        columns={"sensor_temperature_C": "T_room"}
    )
    strange.index = strange.index.tz_localize("Etc/GMT-2").tz_convert("Europe/Tallinn")
    other = wx.Dataset.from_frame(
        strange,
        columns={"sensor_temperature_C": "T_room"},
        units={"T_room": "degF"},
        believed=NOMINAL,
        room={"use": "nzeb"},
    )
    assert other.time.equals(plain.time)
    np.testing.assert_allclose(other.values["sensor_temperature_C"], plain.values["sensor_temperature_C"], atol=1e-9)
    assert plain.interval_s == 60.0


def test_a_record_says_in_four_lines_what_it_is(frame: pd.DataFrame, tmp_path: Path) -> None:
    few = frame[["sensor_temperature_C", "outdoor_temperature_C"]].iloc[: 36 * 60]
    record = wx.Dataset.from_frame(few, believed=NOMINAL, room={"use": "nzeb"})
    assert repr(record).splitlines() == [
        f"<waxstudy.Dataset 'frame': 1.5 days to {few.index[-1]}, every 60 s",
        "  channels: sensor_temperature_C, outdoor_temperature_C",
        "  believed: delay, on-off, variable-times, quick-opening, nzeb",
        "  folder:   none, it was made of a frame>",
    ]
    few.rename_axis("time").to_csv(tmp_path / "data.csv")
    (tmp_path / "dataset.toml").write_text('[nominal]\nsetpoint_C = 21.0\n[room]\nuse = "nzeb"\n')
    read = repr(wx.Dataset.read(tmp_path)).splitlines()
    assert read[2:] == ["  believed: nzeb", f"  folder:   {tmp_path}>"]


@pytest.mark.parametrize(
    ("changes", "wrong"),
    [
        ({"units": {"sensor_temperature_C": "kWh"}}, "'kWh' is no unit of it"),
        ({"units": {"air": "degF"}}, "has a unit, but the frame has no such column"),
        ({"believed": {"controller": {"use": "on-of"}}}, "on-off"),
        ({"believed": "nowhere.toml"}, "cannot be read"),
        ({"columns": {"air_temperature_C": "T_rooom"}}, "is to be column 'T_rooom', but the frame has no such column"),
        ({"columns": {"air_temperature_c": "sensor_temperature_C"}}, "did you mean 'air_temperature_C'"),
    ],
)
def test_a_frame_that_cannot_be_used_is_refused(frame: pd.DataFrame, changes: dict[str, object], wrong: str) -> None:
    with pytest.raises(wx.StudyError, match=wrong):
        wx.Dataset.from_frame(frame, **{"believed": NOMINAL, "room": {"use": "nzeb"}, **changes})  # type: ignore[arg-type]


def test_times_in_utc_do_not_say_where_the_room_is(frame: pd.DataFrame) -> None:
    in_utc = frame.set_axis(frame.index.tz_localize("UTC"))
    with pytest.raises(wx.StudyError, match="say its timezone"):
        wx.Dataset.from_frame(in_utc, believed=NOMINAL, room={"use": "nzeb"})
    there = wx.Dataset.from_frame(in_utc, believed=NOMINAL, room={"use": "nzeb"}, timezone="Europe/Tallinn")
    assert there.time[0] - frame.index[0] == pd.Timedelta("2h")


def test_two_channels_may_be_one_column_whose_unit_counts_once(frame: pd.DataFrame) -> None:
    both = {"air_temperature_C": "T_room", "sensor_temperature_C": "T_room"}
    one = frame[["sensor_temperature_C"]].set_axis(["T_room"], axis="columns") * 1.8 + 32.0
    units = dict.fromkeys(both, "degF")
    record = wx.Dataset.from_frame(one, columns=both, units=units, believed=NOMINAL, room={"use": "nzeb"})
    assert list(record.values) == ["sensor_temperature_C", "air_temperature_C"]
    np.testing.assert_allclose(record.values["air_temperature_C"], frame["sensor_temperature_C"], atol=1e-9)
    units["sensor_temperature_C"] = "K"
    with pytest.raises(wx.StudyError, match="is said to be in 'degF' and in 'K'"):
        wx.Dataset.from_frame(one, columns=both, units=units, believed=NOMINAL, room={"use": "nzeb"})


def test_what_is_said_in_the_call_counts_before_the_file(frame: pd.DataFrame, tmp_path: Path) -> None:
    file = tmp_path / "dataset.toml"
    file.write_text(
        "[dataset]\nroom_tolerance = 2.5\n[nominal]\nsetpoint_C = 21.0\n[room]\nuse = 'nzeb'\n"
        "[site]\nlatitude = 10.0\nlongitude = 20.0\n",
        encoding="utf-8-sig",
    )
    record = wx.Dataset.from_frame(frame, believed=file, site={"latitude": 59.0})
    assert record.site
    assert (record.site.latitude, record.site.longitude, record.room_tolerance) == (59.0, 20.0, 2.5)
    own = wx.Dataset.from_frame(frame, believed=file, dataset={"room_tolerance": 1.5})
    assert own.room_tolerance == 1.5


def test_a_building_is_told_by_its_floor(frame: pd.DataFrame) -> None:
    room = {"floor_area_m2": 20.0, "facade_m": {"south": 5.0}, "window_area_m2": {"south": 2.5}}
    record = wx.Dataset.from_frame(frame, believed=NOMINAL, room=room)
    assert record.room
    assert record.room.parameters.floor_area_m2 == 20.0  # type: ignore[attr-defined]


@pytest.mark.slow
def test_a_diagnosis_shows_where_what_and_how_far(frame: pd.DataFrame) -> None:
    told: list[float] = []
    controller = {"use": "on-off", "dead_band_K": 0.8}  # it truly is 0.5 K
    record = wx.Dataset.from_frame(frame, believed={**NOMINAL, "controller": controller}, room={"use": "nzeb"})
    found = wx.diagnose(record, quick=True, progress=lambda what, share: told.append(share))
    assert "dead-band" in list(found.effects["name"])
    assert found.provenance["command"] is None  # a frame lies in no folder
    assert found.diagnosis.begins == str(frame.index[0] - pd.Timedelta("1min")).replace(" ", "T")
    controller_gap = found.how_far.set_index("stage").loc["controller"]
    assert controller_gap["gap_after"] < 0.5 * controller_gap["gap"]
    assert (found.where["over_floor"] >= 0.0).all()
    assert found.summary in repr(found)
    assert found._repr_html_().startswith("<iframe")
    assert told[-1] > 0.5
    figure = found.plot.traces()
    assert figure.axes
    assert figure._repr_png_().startswith(b"\x89PNG")  # in a notebook
    with pytest.raises(AttributeError, match="no figure 'trace'"):
        found.plot.trace()


def test_components_are_told_by_kind() -> None:
    actuators = wx.components("actuator")
    assert "variable-times" in actuators.index
    assert set(actuators["kind"]) == {"actuator"}
    assert len(wx.components()) > len(actuators)
    with pytest.raises(ValueError, match="no kind 'motor'"):
        wx.components("motor")


def test_a_finished_run_is_read_from_a_folder_named_by_text(finished: Path) -> None:
    assert wx.Results(str(finished)).kpis.equals(wx.Results(finished).kpis)


# --- its page ----------------------------------------------------------------------------------------


def code_of_the_page(heading: str) -> str:
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    return text.split(f"## {heading}\n")[1].split("```python\n")[1].split("```")[0]


@pytest.mark.slow
def test_the_page_s_study_and_record_run_as_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frame: pd.DataFrame
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("studies").mkdir()
    Path("studies/table5.toml").write_text(SMALL)
    in_degF = frame.assign(T_room=frame["air_temperature_C"] * 1.8 + 32.0)
    in_degF.drop(columns=["air_temperature_C", "sensor_temperature_C"]).to_parquet("living.parquet")
    names: dict[str, object] = {}
    exec(code_of_the_page("A study") + code_of_the_page("A record"), names)
    assert isinstance(names["run"], wx.Results)
    assert isinstance(names["found"], wx.Found)
