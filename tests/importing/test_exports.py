"""Claims about importing: eight exports of one record make one dataset, and ask two questions at most."""

from __future__ import annotations

import json
import os
import pty
import sqlite3
import subprocess
import tomllib
from contextlib import closing
from pathlib import Path

import pandas as pd
import pytest

from tests.cli.conftest import Entry, Typed
from tests.conftest import WAXSTUDY, Waxstudy
from tests.importing.conftest import read
from tests.importing.exports import CHANNELS, MAKERS, Export
from waxstudy.dataset.read import read_dataset

LATE = pd.Timedelta(minutes=5)
ROUNDING = 5.1e-5  # of data.csv
NAMES = [make.__name__ for make in MAKERS]
BELIEVED = """
[nominal]
setpoint_C = 21.0
controller = { use = "on-off", dead_band_K = 0.5 }
valve = { use = "linear" }

[room]
use = "nzeb"
"""


@pytest.mark.parametrize("name", NAMES)
def test_each_export_makes_the_same_dataset(
    name: str, made: dict[str, Export], record: pd.DataFrame, entry: Entry
) -> None:
    export = made[name]
    before = {path: path.read_bytes() for path in files(export.source)}
    done = entry("import", export.source, *export.stated, "--out", "living")
    assert done.code == 0, done.stderr
    assert len(export.stated) // 2 <= 2
    assert done.stdout.splitlines()[-1] == "living"
    found = read(Path("living"))
    assert set(found) == set(CHANNELS)
    assert found.index[0] == record.index[0]
    assert record.index[-1] - found.index[-1] <= LATE  # what is logged on change ends with its last change
    assert found.notna().mean().min() > 0.75  # the valve rests for longer than it is held
    for channel in CHANNELS:
        off = found[channel].sub(record[channel]).abs().max()
        assert off <= export.within.get(channel, ROUNDING), f"{channel}: {off}"
    dataset = read_dataset(Path("living"))
    assert (dataset.interval_s, set(dataset.values)) == (60.0, set(CHANNELS))
    assert {path: path.read_bytes() for path in files(export.source)} == before


def files(source: Path) -> list[Path]:
    return sorted(source.iterdir()) if source.is_dir() else [source]


def test_what_was_decided_is_written_down_and_repeats_the_import_without_a_question(
    made: dict[str, Export], entry: Entry
) -> None:
    export = made["home_assistant_csv"]
    assert entry("import", export.source, *export.stated, "--out", "living").code == 0
    about = tomllib.loads(Path("living/dataset.toml").read_text(encoding="utf-8"))
    told = about["import"]
    assert any("No unit is written for" in each and "taken as degF" in each for each in told["assumed"])
    assert (told["room"], told["timezone"]) == ("living", "Europe/Tallinn")
    assert "UTC+2 h, all year" in about["dataset"]["origin"]
    sensor = told["channels"]["sensor_temperature_C"]
    assert (sensor["entity"], sensor["unit"]) == ("sensor.living_room_temperature", "degF")
    assert sensor["scale"] == pytest.approx(5.0 / 9.0)
    assert 0.7 <= sensor["confidence"] <= 1.0
    assert "degrees Fahrenheit" in sensor["why"]
    first = Path("living/data.csv").read_bytes()
    Path("living/data.csv").write_text("lost")
    other = entry("import", export.source, "--room", "bedroom", "--timezone", "UTC", "--out", "living")
    assert (other.code, "room 'living'" in other.stderr, "--replace" in other.stderr) == (2, True, True)
    with Path("living/dataset.toml").open("a") as file:
        file.write("[building]\nuse = 'nzeb'  # ours\nfloor_area_m2 = 20.0\n")
    done = entry(*told["command"].split()[1:])
    assert done.code == 0, done.stderr
    assert Path("living/data.csv").read_bytes() == first
    second = Path("living/dataset.toml").read_text()
    assert "use = 'nzeb'  # ours" in second
    assert entry(*told["command"].split()[1:]).code == 0
    assert Path("living/dataset.toml").read_text() == second


def test_a_folder_of_another_import_is_kept_unless_it_is_to_be_replaced(made: dict[str, Export], entry: Entry) -> None:
    german, sensors = made["german_csv"].source, made["file_per_sensor"].source
    assert entry("import", german, "--out", "living").code == 0
    before = Path("living/dataset.toml").read_bytes()
    refused = entry("import", sensors, "--out", "living")
    assert (refused.code, "Messwerte.csv" in refused.stderr, "--replace" in refused.stderr) == (2, True, True)
    assert Path("living/dataset.toml").read_bytes() == before
    assert entry("import", sensors, "--out", "living", "--replace").code == 0
    assert Path("living/dataset.toml").read_bytes() != before
    Path("full").mkdir()
    Path("full/notes.txt").write_text("mine")
    refused = entry("import", sensors, "--out", "full", "--replace")
    assert (refused.code, [path.name for path in Path("full").iterdir()]) == (2, ["notes.txt"])
    assert "holds no import" in refused.stderr
    refused = entry("import", "living/data.csv", "--out", "living", "--replace")
    assert (refused.code, "a source lies in it" in refused.stderr) == (2, True)


def test_a_change_of_a_tenth_becomes_noise_and_so_does_a_tenth_of_a_litre(
    made: dict[str, Export], entry: Entry
) -> None:
    for name, channel, at_least, at_most in (
        ("on_change_of_a_tenth", "sensor_temperature_C", 0.05, 0.1),
        ("counter_of_litres", "flow_L_h", 2.0, 3.0),
    ):
        done = entry("import", made[name].source, "--out", name)
        assert done.code == 0, done.stderr
        noise = read_dataset(Path(name)).noise[channel]
        assert at_least <= noise <= at_most


def test_it_asks_on_a_terminal_and_takes_the_answers(made: dict[str, Export], tmp_path: Path) -> None:
    export = made["home_assistant_csv"]
    ours, theirs = pty.openpty()
    command = [str(WAXSTUDY), "import", str(export.source), "--out", "living"]
    child = subprocess.Popen(command, cwd=tmp_path, stdin=theirs, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    os.close(theirs)
    # a zone that is none is asked again; of the rooms the second
    os.write(ours, b"Europe/Talin\nEurope/Tallinn\n2\n")
    out, said = (text.decode() for text in child.communicate(timeout=120))
    os.close(ours)
    assert child.returncode == 0, said
    assert out.splitlines()[-1] == "living"
    assert said.index("In which time zone") < said.index("did you mean 'Europe/Tallinn'") < said.index("several rooms")
    about = tomllib.loads((tmp_path / "living/dataset.toml").read_text(encoding="utf-8"))
    assert (about["import"]["room"], about["import"]["timezone"]) == ("living", "Europe/Tallinn")


def test_what_was_typed_is_told_where_its_writing_is_interrupted(
    made: dict[str, Export], entry: Entry, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", Typed("Europe/Tallinn\n2\n"))
    monkeypatch.setattr("waxstudy.importing.write.whole_folder", Typed.interrupted)
    done = entry("import", made["home_assistant_csv"].source, "--out", "living")
    assert done.code == 130
    assert done.stderr.endswith("to go on, add to the same command: --timezone Europe/Tallinn --room living\n")
    assert not Path("living").exists()


def test_names_that_say_nothing_are_told_by_their_values(record: pd.DataFrame, entry: Entry) -> None:
    names = dict(zip(CHANNELS, ("T1", "X", "S", "Q [L/h]", "T2", "T3", "T4"), strict=True))
    record.rename(columns=names).to_csv("plain.csv")
    asked = entry("import", "plain.csv", "--out", "plain")
    assert (asked.code, asked.stderr.count("or --yes")) == (3, 7)
    assert "if a controller asks for it, say --map control_output=S" in asked.stderr
    assert not Path("plain").exists()
    assert entry("import", "plain.csv", "--yes", "--out", "plain").code == 0
    told = tomllib.loads(Path("plain/dataset.toml").read_text())["import"]["channels"]
    assert {channel: each["entity"] for channel, each in told.items()} == {
        channel: name.removesuffix(" [L/h]") for channel, name in names.items()
    }
    assert max(each["confidence"] for each in told.values()) < 0.7
    assert "follows the valve" in told["return_temperature_C"]["why"]


def test_a_thermostat_of_home_assistant_tells_setpoint_and_action(record: pd.DataFrame, entry: Entry) -> None:
    with closing(sqlite3.connect("house.db")) as base:
        base.executescript(
            "create table states_meta (metadata_id integer primary key, entity_id text);"
            "create table state_attributes (attributes_id integer primary key, shared_attrs text);"
            "create table states (state_id integer primary key, state text, last_updated_ts float, "
            "metadata_id integer, attributes_id integer);"
            "insert into states_meta values (1, 'climate.hall'), (2, 'weather.outdoor_temperature');"
        )
        seconds = (record.index - pd.Timestamp(0)) // pd.Timedelta(seconds=1)
        for key, (at, row) in enumerate(zip(seconds, record.itertuples(index=False), strict=True), 1):
            action = "heating" if row.heating_signal else "idle"
            told = {"current_temperature": row.sensor_temperature_C, "temperature": 21.0, "hvac_action": action}
            states = [
                (2 * key, "heat", float(at), 1, key),
                (2 * key + 1, str(row.outdoor_temperature_C), float(at), 2, 0),
            ]
            base.execute("insert into state_attributes values (?, ?)", (key, json.dumps(told)))
            base.executemany("insert into states values (?, ?, ?, ?, ?)", states)
        base.commit()
    done = entry("import", "house.db", "--timezone", "UTC", "--map", "control_output=", "--out", "hall")
    assert done.code == 0, done.stderr
    found = read(Path("hall"))
    for channel in ("sensor_temperature_C", "setpoint_C", "heating_signal", "outdoor_temperature_C"):
        assert found[channel].to_list() == record[channel].to_list()


def test_where_nobody_answers_all_questions_are_told_at_once(made: dict[str, Export], entry: Entry) -> None:
    done = entry("import", made["home_assistant_csv"].source, "--out", "living")
    assert (done.code, len(done.stderr.splitlines())) == (3, 2)
    assert "say --timezone ..." in done.stderr
    assert "say --room ..." in done.stderr
    assert not Path("living").exists()


def test_a_coarser_interval_has_means_of_flow_and_the_last_of_all_else(record: pd.DataFrame, entry: Entry) -> None:
    record.to_csv("fine.csv")
    done = entry("import", "fine.csv", "--interval", "10 min", "--out", "coarse")
    assert done.code == 0, done.stderr
    found = read(Path("coarse"))
    ends = record.resample("10min", closed="right", label="right")
    assert found["flow_L_h"].to_list() == pytest.approx(ends["flow_L_h"].mean().to_list(), abs=1e-3)
    assert found["sensor_temperature_C"].to_list() == ends["sensor_temperature_C"].last().to_list()
    done = entry("import", "fine.csv", "--interval", "often", "--out", "never")
    assert (done.code, "write it as '6 h'" in done.stderr) == (2, True)


@pytest.mark.slow
def test_an_import_gets_the_verdict_of_the_record(
    made: dict[str, Export], record: pd.DataFrame, waxstudy: Waxstudy, tmp_path: Path
) -> None:
    assert waxstudy("import", made["german_csv"].source, "--out", "living").returncode == 0
    about = (tmp_path / "living/dataset.toml").read_text(encoding="utf-8")
    (tmp_path / "living/dataset.toml").write_text(about.partition("[nominal]")[0] + BELIEVED)
    cut = tmp_path / "cut"
    cut.mkdir()
    record.to_csv(cut / "data.csv", date_format="%Y-%m-%dT%H:%M:%S")
    (cut / "dataset.toml").write_text(f"[dataset]\ninterval_s = 60\n{BELIEVED}")
    done = [waxstudy("diagnose", folder, "--quick", "--json", "--quiet") for folder in ("living", "cut")]
    imported, ours = (json.loads(each.stdout) for each in done)
    assert imported["verdict"] == ours["verdict"]
    assert [each["name"] for each in imported["effects"]] == [each["name"] for each in ours["effects"]]
