"""Claims about `waxstudy believe`: it asks in an owner's words, guesses aloud, and writes beside what is there."""

from __future__ import annotations

import os
import pty
import subprocess
import tomllib
from pathlib import Path

import pandas as pd
import pytest

from docs_site.keys import dataset_keys
from tests.cli.conftest import Entry, Typed
from tests.cli.conftest import entry as entry
from tests.conftest import ROOT, WAXSTUDY
from tests.importing.test_bad_input import house
from waxstudy.believing import typical
from waxstudy.believing.questions import KEYS
from waxstudy.believing.tolerance import SPREADS, tolerance, widened
from waxstudy.dataset.read import read_dataset

USAGE, INVALID, INTERRUPTED = 2, 3, 130
OWN = {"heat-loss": 0.07, "floor-capacity": 0.1, "boards-capacity": 0.2, "water-exchange": 1.0, "above-pipes": 0.8}
HEAD = """\
# measured in winter
[dataset]
origin = "ours"  # a remark
[noise]
sensor_temperature_C = 0.05
"""
KNOWN = {
    "floor_area_m2": "20",
    "height_m": "2.5",
    "outer_walls": "south 5.0, west",
    "windows": "south 3.0",
    "year": "1985",
    "wall_U": "0.5",
    "window_U": "1.1",
    "below": "cellar",
    "floor_U": "0.5",
    "above": "outdoors",
    "walls": "light",
    "screed_mm": "50",
    "pipe_spacing_mm": "200",
    "covering": "wood",
    "ventilation": "balanced",
    "thermostat": "pi",
    "motor": "A",
    "valve": "linear",
    "setpoint_C": "20.5",
    "place": "59.4, 24.7",
}


def said(answers: dict[str, str]) -> list[str]:
    return [word for key, text in answers.items() for word in ("--set", f"{key}={text}")]


@pytest.fixture
def living(tmp_path: Path) -> Path:
    folder = tmp_path / "living"
    folder.mkdir()
    names = {"room_temperature": "sensor_temperature_C", "heating_valve": "heating_signal"}
    names |= {f"{where}_temperature": f"{where}_temperature_C" for where in ("supply", "outdoor")}
    house().rename(columns=names).to_csv(folder / "data.csv")
    (folder / "dataset.toml").write_text(HEAD)
    return folder


def about(folder: Path) -> dict[str, dict[str, object]]:
    return tomllib.loads((folder / "dataset.toml").read_text(encoding="utf-8"))


def test_where_nobody_answers_nothing_is_guessed_and_every_question_is_told(entry: Entry, living: Path) -> None:
    done = entry("believe", "living")
    assert done.code == INVALID
    assert len(done.stderr.splitlines()) == len(KEYS) - 2  # the flow is in the record, and no panels are
    assert "say --set 'windows=south 2.0', or --yes, or answer on a terminal" in done.stderr
    assert (living / "dataset.toml").read_text() == HEAD


def test_guesses_are_told_with_their_source_and_widen_the_room(entry: Entry, living: Path) -> None:
    done = entry("believe", "living", "--yes")
    assert done.code == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "living"
    assert "typical of 2005: EnEV 2002" in done.stdout
    text = (living / "dataset.toml").read_text()
    assert text.startswith('# measured in winter\n[dataset]\norigin = "ours"  # a remark\n')
    found = read_dataset(living)
    assert found.room_tolerance == about(living)["believe"]["room_tolerance"] > 9.0
    assert set(found.nominal) == {"controller", "actuator", "valve"}
    assert about(living)["building"]["nominal_flow_L_h"] == 60.0  # as the record shows
    assert f"room_tolerance = {found.room_tolerance:g}" in done.stdout
    assert done.stdout.splitlines()[-2] == "next: waxstudy diagnose living"
    again = entry(*str(about(living)["believe"]["command"]).split()[1:])
    assert (again.code, (living / "dataset.toml").read_text()) == (0, text)


def test_what_is_known_widens_nothing_and_is_written_in_the_room_s_words(entry: Entry, living: Path) -> None:
    done = entry("believe", "living", *said(KNOWN))
    assert done.code == 0, done.stderr
    # an owner knows that it is a PI controller, hardly its numbers
    assert "what is found of the PI controller's gain, times and pulses" in done.stdout
    assert "guessed" not in done.stdout
    found = about(living)
    assert "room_tolerance" not in found["dataset"]
    room = found["building"]
    assert room["facade_m"] == {"south": 5.0, "west": 4.47}
    assert (room["ceiling"], room["roof_U_W_m2K"]) == ("outdoors", 0.4)
    assert room["floor_U_W_m2K"] == 0.5 * typical.BELOW["cellar"]
    assert found["nominal"]["modulator"] == {"use": "pwm"}
    assert found["site"] == {"latitude": 59.4, "longitude": 24.7}
    assert read_dataset(living).room_tolerance == 1.0


def test_a_later_answer_changes_what_was_written_and_leaves_what_was_changed_by_hand(
    entry: Entry, living: Path
) -> None:
    assert entry("believe", "living", *said({**KNOWN, "walls": "heavy", "thermostat": "pi"})).code == 0
    path = living / "dataset.toml"
    path.write_text(path.read_text().replace("height_m = 2.5", "height_m = 3.1  # measured"))
    done = entry("believe", "living", *said({"walls": "light", "thermostat": "on-off", "dead_band_K": "0.4"}))
    assert done.code == 0, done.stderr
    assert "[building] height_m = 3.1 stays: it was written by hand" in done.stderr
    assert "height_m = 3.1  # measured" in path.read_text()
    found = about(living)
    assert found["nominal"]["controller"] == {"use": "on-off", "dead_band_K": 0.4}
    assert "modulator" not in found["nominal"]
    assert "gypsum" not in found["building"]


def test_a_table_written_by_hand_stays_and_so_does_its_tolerance(entry: Entry, living: Path) -> None:
    path = living / "dataset.toml"
    path.write_text(HEAD.replace("[noise]", "room_tolerance = 2.5\n[noise]") + "[room]\nuse = 'nzeb'\n")
    done = entry("believe", "living", "--yes")
    assert done.code == 0, done.stderr
    assert "building" not in about(living)
    assert read_dataset(living).room_tolerance == 2.5
    refused = entry("believe", "living", "--set", "year=1990", "--yes")
    assert (refused.code, "its table was written by hand and stays" in refused.stderr) == (INVALID, True)


def test_another_s_room_and_loop_are_taken(entry: Entry, living: Path, tmp_path: Path) -> None:
    assert entry("believe", "living", "--yes", *said({"year": "1996"})).code == 0
    other = tmp_path / "bedroom"
    other.mkdir()
    (other / "data.csv").write_bytes((living / "data.csv").read_bytes())
    (other / "dataset.toml").write_text(HEAD)
    done = entry("believe", "bedroom", "--from", "living/dataset.toml", "--set", "floor_area_m2=11", "--yes")
    assert done.code == 0, done.stderr
    mine, theirs = about(other), about(living)
    assert (mine["building"]["floor_area_m2"], theirs["building"]["floor_area_m2"]) == (11.0, 16.0)
    assert mine["building"]["wall_U_W_m2K"] == theirs["building"]["wall_U_W_m2K"] == 0.5
    assert mine["nominal"] == theirs["nominal"]
    assert read_dataset(other).room_tolerance < read_dataset(living).room_tolerance
    (other / "dataset.toml").write_text(HEAD)
    done = entry("believe", "bedroom", "--from", ROOT / "studies" / "table5.toml", "--yes")
    assert done.code == 0, done.stderr
    assert about(other)["room"] == {"use": "nzeb"}
    assert "building" not in about(other)
    done = entry("believe", "bedroom", "--from", ROOT / "pyproject.toml")
    assert (done.code, "holds no [building], [room] or [nominal]" in done.stderr) == (INVALID, True)


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (("--set", "yaer=1990"), USAGE, "did you mean 'year'"),
        (("--set", "year"), USAGE, "is no KEY=VALUE"),
        (("--set", "year=old"), INVALID, "give a year from 1700 to 2100"),
        (("--set", "windows=suoth 2"), INVALID, "did you mean 'south'"),
        (("--set", "windows=south"), INVALID, "give square metres behind south"),
        (("--set", "motor=nowhere.toml"), INVALID, "nowhere.toml"),
        (("--set", "outer_walls=south 9.0, west 9.0", "--set", "floor_area_m2=16"), INVALID, "contradicts facade_m"),
        (("--set", "full_flow_L_h=0"), INVALID, "give a number from 5 to 5000 L/h"),
        (("--set", "place=Tallinn"), INVALID, "59.44, 24.75"),
    ],
)
def test_an_answer_that_is_none_is_refused_with_what_is_allowed(
    entry: Entry, living: Path, options: tuple[str, ...], code: int, told: str
) -> None:
    done = entry("believe", "living", "--yes", *options)
    assert (done.code, told in done.stderr) == (code, True), done.stderr
    assert (living / "dataset.toml").read_text() == HEAD


def test_the_more_is_known_the_less_a_room_is_widened() -> None:
    guessed = {each.key for each in SPREADS}
    last = tolerance(widened(guessed, OWN))
    for key in ("year", "outer_walls", "walls", "above", "ventilation", "windows", "floor_area_m2", "below", "wall_U"):
        guessed.discard(key)
        now = tolerance(widened(guessed, OWN))
        assert now <= last
        last = now
    assert tolerance(widened((), OWN)) == 1.0
    assert tolerance(widened({"year"}, OWN)) == 1.0  # all U-values are known: the year says nothing more
    assert tolerance(widened({"year", "wall_U"}, OWN)) > 7.0
    assert {each.key for each in SPREADS} <= set(KEYS)


def test_the_typical_values_get_better_with_the_years() -> None:
    for before, after in zip(typical.ERAS, typical.ERAS[1:], strict=False):
        assert before.until < after.until
        assert all(now <= then for then, now in zip(before[1:-1], after[1:-1], strict=True))


def on_a_terminal(folder: Path, typed: bytes) -> tuple[int, str, str]:
    """Answer what is asked of year and valve; all else is known."""
    ours, theirs = pty.openpty()
    known = said({k: v for k, v in KNOWN.items() if k not in ("year", "valve")})
    command = [str(WAXSTUDY), "believe", "living", *known]
    child = subprocess.Popen(command, cwd=folder, stdin=theirs, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    os.close(theirs)
    os.write(ours, typed)
    out, asked = (text.decode() for text in child.communicate(timeout=120))
    os.close(ours)
    return child.returncode, out, asked


@pytest.mark.slow
def test_what_was_typed_before_an_interruption_is_not_typed_again(living: Path, tmp_path: Path) -> None:
    before = (living / "dataset.toml").read_text()
    code, _, asked = on_a_terminal(tmp_path, b"1998\n\x04")
    assert code == INTERRUPTED
    assert asked.endswith("interrupted before all was written; to go on, add to the same command: --set year=1998\n")
    assert (living / "dataset.toml").read_text() == before


def test_what_was_typed_is_told_where_its_writing_is_interrupted(
    entry: Entry, living: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", Typed("1998\n"))
    monkeypatch.setattr("waxstudy.believing.write.whole_file", Typed.interrupted)
    done = entry("believe", "living", *said({key: text for key, text in KNOWN.items() if key != "year"}))
    assert done.code == INTERRUPTED
    assert done.stderr.endswith("to go on, add to the same command: --set year=1998\n")
    assert (living / "dataset.toml").read_text() == HEAD


@pytest.mark.slow
def test_it_asks_on_a_terminal(living: Path, tmp_path: Path) -> None:
    code, out, asked = on_a_terminal(tmp_path, b"last year\n2005\n\n")  # the year's default typed, the valve's taken
    assert code == 0, asked
    assert out.splitlines()[-1] == "living"
    assert asked.index("In which year") < asked.index("give a year from 1700") < asked.index("What curve has the valve")
    found = about(living)
    assert found["nominal"]["valve"] == {"use": "quick-opening"}
    assert found["believe"]["answers"]["year"] == "2005"
    assert "year" in found["believe"]["stated"]
    assert "valve" not in found["believe"]["stated"]


def test_the_reference_shows_every_spread() -> None:
    page = dataset_keys()
    rows = [f"| `{each.key}` | `{each.unknown}` | {each.spread:g} | {each.why} |" for each in SPREADS]
    assert [row for row in rows if row not in page] == []


@pytest.mark.parametrize("floor_m2", [2, 500])
def test_every_default_is_one_that_is_allowed_in_the_smallest_and_the_largest_room(
    entry: Entry, living: Path, floor_m2: int
) -> None:
    done = entry("believe", "living", "--yes", "--set", f"floor_area_m2={floor_m2}")
    assert done.code == 0, done.stderr


def test_a_file_with_a_byte_order_mark_is_read_and_written(entry: Entry, living: Path) -> None:
    (living / "dataset.toml").write_text(HEAD, encoding="utf-8-sig")
    assert entry("believe", "living", "--yes").code == 0
    assert about(living)["dataset"]["origin"] == "ours"


def test_the_curve_follows_a_record_that_has_grown_unless_somebody_changed_it(entry: Entry, living: Path) -> None:
    assert entry("believe", "living", "--yes").code == 0
    curve = about(living)["building"]["heating_curve_C"]
    data = pd.read_csv(living / "data.csv")
    data.assign(supply_temperature_C=data["supply_temperature_C"] + 3.0).to_csv(living / "data.csv", index=False)
    done = entry("believe", "living", "--yes")
    assert "by hand" not in done.stderr
    grown = about(living)["building"]["heating_curve_C"]
    assert grown != curve
    path = living / "dataset.toml"
    path.write_text(path.read_text().replace(f"[[-20.0, {grown[0][1]}]", "[[-20.0, 41.5]", 1))
    done = entry("believe", "living", "--yes")
    assert "[building] heating_curve_C" in done.stderr
    assert about(living)["building"]["heating_curve_C"][0] == [-20.0, 41.5]


def test_the_offset_of_an_import_s_stamps_is_the_site_s_zone(entry: Entry, living: Path) -> None:
    path = living / "dataset.toml"
    path.write_text(HEAD + '[import]\ntimezone = "UTC+02:00"\n')
    assert entry("believe", "living", "--yes", "--set", "place=59.44, 24.75").code == 0
    assert about(living)["site"]["timezone"] == "UTC+02:00"
