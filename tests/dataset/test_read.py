"""Claims about reading datasets: what was written is read back, foreign files are mapped, faults are told."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.conftest import DATA, ROOT
from tests.synthetic.conftest import SETPOINT_C, Simulated, described, written
from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.levels import only_switches
from waxstudy.dataset.read import Dataset, read_dataset
from waxstudy.plugin import Choice
from waxstudy.plugin.registry import installed
from waxstudy.study.model import Study
from waxstudy.synthetic.instruments import Instruments, measure

REALITIES, HOUSE = DATA / "realities", DATA / "measured_house"
NO_DATA = "is not there; WAXSTUDY_DATA names the folder of the data"

Change = Callable[[pd.DataFrame], pd.DataFrame]


@pytest.fixture
def good(folder: Path, study: Study, simulated: Simulated) -> Path:
    return written(folder, study, simulated, "O_WM", "O_CP")


def data_of(folder: Path) -> pd.DataFrame:
    return pd.read_csv(folder / "data.csv")


def reread(folder: Path, change: Change, extra: str = "") -> Dataset:
    """Read the dataset again after a change of its data and an addition to its description."""
    change(data_of(folder)).to_csv(folder / "data.csv", index=False)
    path = folder / "dataset.toml"
    path.write_text(path.read_text(encoding="utf-8") + extra, encoding="utf-8")
    return read_dataset(folder)


def told(dataset: Dataset, *words: str) -> bool:
    return any(all(word in warning for word in words) for warning in dataset.warnings)


# --- what waxstudy writes ---------------------------------------------------------------------------


@settings(max_examples=15)
@given(
    interval_s=st.sampled_from([5.0, 60.0, 300.0, 900.0, 3600.0]),
    without=st.sets(st.sampled_from(sorted(set(CHANNELS) - {"air_temperature_C"})), max_size=12),
    missing=st.sampled_from([0.0, 0.003, 0.5]),
    seed=st.integers(0, 99),
)
def test_what_a_reality_wrote_is_read_back_to_the_digit(
    study: Study, simulated: Simulated, interval_s: float, without: set[str], missing: float, seed: int
) -> None:
    measured = {"interval_s": interval_s, "without": sorted(without), "missing": missing, "seed": seed}
    with TemporaryDirectory() as place:
        read = read_dataset(written(Path(place) / "room", study, simulated, "O_WM", "O_CP", **measured))
    expected = measure(simulated("O_WM"), Instruments(**measured)).set_index("time")  # type: ignore[arg-type]
    assert read.interval_s == interval_s
    assert list(read.values.columns) == list(expected.columns)
    seen = expected.notna().any(axis=1).to_numpy()
    first, last = int(np.argmax(seen)), len(seen) - int(np.argmax(seen[::-1]))
    assert first == 0 or "setpoint_C" in without
    assert [stamp.isoformat() for stamp in read.time[:last]] == list(expected.index[:last])
    np.testing.assert_array_equal(read.values.to_numpy(), expected.to_numpy())


def test_the_belief_is_that_of_the_study(good: Path, study: Study) -> None:
    read = read_dataset(good)
    assert {kind: choice.described() for kind, choice in read.nominal.items()} == {
        kind: choice.described() for kind, choice in study.cases["O_CP"].blocks.items()
    }
    assert read.room is not None
    assert read.room.described() == study.room.described()
    assert (read.setpoint_C, read.assumed) == (SETPOINT_C, ("solar_gain_W", "internal_gain_W"))
    assert read.noise == described(good)["noise"]


# --- foreign files ----------------------------------------------------------------------------------

FOREIGN = """
[columns]
time = "Zeit"
flow_L_h = { column = "Durchfluss", scale = 1000.0 }
air_temperature_C = { mean = ["oben", { column = "unten", scale = 1.0 }], offset = -273.15 }
internal_gain_W = { sum = ["Licht", "Herd"] }
"""


def foreign(data: pd.DataFrame) -> pd.DataFrame:
    """The same record as another logger would export it."""
    kelvin = data["air_temperature_C"] + 273.15
    return pd.DataFrame(
        {
            "Zeit": pd.to_datetime(data["time"]).dt.strftime("%d.%m.%Y %H:%M"),
            "Durchfluss": data["flow_L_h"] / 1000.0,
            "oben": kelvin + 0.5,
            "unten": kelvin - 0.5,
            "Licht": 0.25 * data["internal_gain_W"],
            "Herd": 0.75 * data["internal_gain_W"],
            "Wind": 3.0,
        }
    )


def test_a_setpoint_that_is_logged_when_it_changes_holds_its_value(good: Path) -> None:
    """Also where its days are cut off afterwards: what was set before them is still meant."""
    data = data_of(good)
    written = data["setpoint_C"].where(np.arange(len(data)) == 0)
    written.iloc[len(data) // 2] = 22.5
    data.assign(setpoint_C=written).to_csv(good / "data.csv", index=False)
    setpoint_C = read_dataset(good).values["setpoint_C"]
    assert setpoint_C.notna().all()
    assert setpoint_C.iloc[len(data) // 2 - 1] == data["setpoint_C"].iloc[0]
    assert set(setpoint_C.iloc[len(data) // 2 :]) == {22.5}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize(("separator", "decimal"), [(",", "."), (";", ","), ("\t", ","), (";", ".")])
def test_a_foreign_file_is_the_same_record(good: Path, separator: str, decimal: str, encoding: str) -> None:
    ours = read_dataset(good)
    table = foreign(data_of(good)).rename(columns={"Wind": "Wind in °"})
    table.to_csv(good / "data.csv", index=False, sep=separator, decimal=decimal, encoding=encoding)
    path = good / "dataset.toml"
    text = path.read_text(encoding="utf-8").replace("[dataset]", '[dataset]\ntime_format = "%d.%m.%Y %H:%M"')
    path.write_text(text + FOREIGN, encoding="utf-8")
    theirs = read_dataset(good)
    assert sorted(theirs.values) == ["air_temperature_C", "flow_L_h", "internal_gain_W"]
    for name in theirs.values:
        np.testing.assert_allclose(theirs.values[name], ours.values[name], atol=1e-9)
    assert theirs.time.equals(ours.time)
    assert any("1 column of the data file" in sentence for sentence in theirs.assumptions)


def test_a_parquet_file_is_read_as_well(good: Path) -> None:
    ours, data = read_dataset(good), data_of(good)
    data.assign(time=pd.to_datetime(data["time"])).set_index("time").to_parquet(good / "data.parquet")
    (good / "data.csv").unlink()
    pd.testing.assert_frame_equal(read_dataset(good).values, ours.values)


def test_the_data_file_may_lie_elsewhere(good: Path, tmp_path: Path) -> None:
    ours = read_dataset(good)
    shutil.move(good / "data.csv", tmp_path / "record.txt")
    path = good / "dataset.toml"
    text = path.read_text(encoding="utf-8").replace("[dataset]", '[dataset]\nfile = "../record.txt"')
    path.write_text(text, encoding="utf-8")
    pd.testing.assert_frame_equal(read_dataset(good).values, ours.values)


@pytest.mark.parametrize("words", [("on", "off"), ("True", "False"), ("OPEN", "closed")])
def test_signals_may_be_told_in_words(good: Path, words: tuple[str, str]) -> None:
    ours = read_dataset(good)
    read = reread(good, lambda data: data.assign(heating_signal=np.where(data["heating_signal"] > 0.5, *words)))
    np.testing.assert_array_equal(read.values["heating_signal"], ours.values["heating_signal"])


def test_the_example_of_the_page_is_understood(good: Path) -> None:
    page = (ROOT / "docs" / "datasets-files.md").read_text(encoding="utf-8")
    example = next(block for block in re.findall(r"```toml\n(.*?)```", page, re.DOTALL) if "[columns]" in block)
    ours, data = read_dataset(good), data_of(good)
    names = ["T_Raum", "T_10", "T_110", "T_170"]
    table = pd.DataFrame({"Zeit": pd.to_datetime(data["time"]).dt.strftime("%d.%m.%Y %H:%M")})
    table = table.assign(V=data["flow_L_h"] / 1000.0, Ta=data["outdoor_temperature_C"] * 1.8 + 32.0)
    table = table.assign(P_light=data["internal_gain_W"] - 10.0, P_stove=20.0)
    table = table.assign(**{name: data["air_temperature_C"] for name in names})
    table.to_csv(good / "export.csv", index=False, sep=";", decimal=",")
    (good / "dataset.toml").write_text(example + "\n[nominal]\n", encoding="utf-8")
    read = read_dataset(good)
    assert list(read.values)[:2] == ["sensor_temperature_C", "air_temperature_C"]
    for name in set(read.values) - {"sensor_temperature_C"}:
        np.testing.assert_allclose(read.values[name], ours.values[name], atol=0.01)


def test_the_dataset_that_the_page_writes_by_hand_is_read_without_a_doubt(good: Path) -> None:
    page = (ROOT / "docs" / "datasets.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    drives = ["heating_signal", "supply_temperature_C", "outdoor_temperature_C", "solar_gain_W"]
    data = data_of(good)[["time", "air_temperature_C", *drives]].rename(columns={"air_temperature_C": "T_room"})
    data.iloc[4::5].to_csv(good / "data.csv", index=False)
    (good / "dataset.toml").write_text(example, encoding="utf-8")
    read = read_dataset(good)
    assert (set(read.values), read.warnings) == ({"air_temperature_C", *drives}, ())
    assert (read.interval_s, read.setpoint_C, dict(read.spreads)) == (300.0, 21.0, {"internal_gain_W": 0.7})
    assert list(read.nominal) == ["controller", "actuator", "valve"]


@pytest.mark.parametrize("minutes", [":00", "00", ""])
def test_offsets_from_utc_become_standard_time(good: Path, minutes: str) -> None:
    ours = read_dataset(good)

    def zoned(data: pd.DataFrame) -> pd.DataFrame:
        half = len(data) // 2
        summer = (pd.to_datetime(data["time"]) + pd.Timedelta(hours=1)).dt.strftime("%Y-%m-%dT%H:%M:%S+02") + minutes
        return data.assign(time=[*(data["time"][:half] + "+01" + minutes), *summer[half:]])

    read = reread(good, zoned)
    assert read.time.equals(ours.time)
    assert any("UTC+1 h" in sentence for sentence in read.assumptions)


# --- stamps and grid --------------------------------------------------------------------------------


def test_stamps_off_the_grid_go_to_the_nearest_place(good: Path) -> None:
    ours = read_dataset(good)

    def shaken(data: pd.DataFrame) -> pd.DataFrame:
        late = pd.to_timedelta(np.random.default_rng(1).choice([0, 0, 20, -20], len(data)), unit="s")
        return data.assign(time=(pd.to_datetime(data["time"]) + late).dt.strftime("%Y-%m-%dT%H:%M:%S"))

    read = reread(good, shaken)
    pd.testing.assert_frame_equal(read.values, ours.values)
    assert told(read, "stamps are off the grid, by up to 20 s")


def test_rows_that_are_not_there_are_missing_samples(good: Path) -> None:
    read = reread(good, lambda data: data.drop(index=range(100, 220)))
    missing = read.values.iloc[100:220]
    assert missing.drop(columns="setpoint_C").isna().all(axis=None)
    assert set(missing["setpoint_C"]) == {read.values["setpoint_C"].iloc[99]}  # which holds until another one is set
    assert read.values.notna().all(axis=1).sum() == 2880 - 120
    assert told(read, "4.2 % of the samples are missing, at most 2 h at once")


def test_a_finer_file_gives_means_of_flows_and_last_values_of_the_rest(good: Path) -> None:
    fine = read_dataset(good)
    path = good / "dataset.toml"
    path.write_text(path.read_text(encoding="utf-8").replace("interval_s = 60", "interval_s = 600"), encoding="utf-8")
    read = read_dataset(good)
    assert len(read.values) == 288
    flow = fine.values["flow_L_h"].to_numpy().reshape(-1, 10).mean(axis=1)
    np.testing.assert_allclose(read.values["flow_L_h"], flow)
    np.testing.assert_array_equal(read.values["air_temperature_C"], fine.values["air_temperature_C"][9::10])


@pytest.mark.parametrize(("interval_s", "is_told"), [(300, True), (360, False), (1140, True)])
def test_an_interval_that_is_no_multiple_of_the_rows_distance_is_told_with_the_nearest(
    good: Path, interval_s: int, is_told: bool
) -> None:
    path = good / "dataset.toml"
    text = path.read_text(encoding="utf-8").replace("interval_s = 60", f"interval_s = {interval_s}")
    path.write_text(text, encoding="utf-8")
    read = reread(good, lambda data: data.iloc[1::2])
    below = interval_s // 120 * 120
    words = "no multiple of the 120 s between the file's rows", f"take interval_s = {below} or {below + 120}"
    assert told(read, *words) is is_told


def test_stamps_at_the_start_are_moved_to_the_end(good: Path) -> None:
    ours = read_dataset(good)
    path = good / "dataset.toml"
    text = path.read_text(encoding="utf-8").replace("[dataset]", '[dataset]\nstamps = "start"')
    path.write_text(text, encoding="utf-8")
    assert (read_dataset(good).time - ours.time == pd.Timedelta(seconds=60)).all()


@pytest.mark.parametrize(
    ("steps_s", "interval_s", "late_s"),
    [
        ([40] * 3 + [60] * 30, 30, 30),  # logged at changes: a row is of its interval, not of all until the next
        ([60] * 60, 600, 60),  # of a finer file a row is of what passes until the next
    ],
    ids=["coarser", "finer"],
)
def test_a_row_stamped_at_its_start_ends_with_its_interval_or_at_the_next_row(
    tmp_path: Path, steps_s: list[int], interval_s: int, late_s: int
) -> None:
    start = pd.Timestamp("2020-01-10T00:00:00")
    offsets_s = np.cumsum([0, *steps_s])
    rows = [f"{(start + pd.Timedelta(seconds=int(s))).isoformat()},{20 + i / 100}" for i, s in enumerate(offsets_s)]
    (tmp_path / "data.csv").write_text("\n".join(["time,air_temperature_C", *rows]) + "\n")

    def first(stamps: str, moved_s: int) -> tuple[pd.Timestamp, list[float]]:
        told = f'[dataset]\ninterval_s = {interval_s}\nstamps = "{stamps}"\n[nominal]\n'
        (tmp_path / "dataset.toml").write_text(told)
        moved = [f"{(pd.Timestamp(r[:19]) + pd.Timedelta(seconds=moved_s)).isoformat()}{r[19:]}" for r in rows]
        (tmp_path / "data.csv").write_text("\n".join(["time,air_temperature_C", *moved]) + "\n")
        read = read_dataset(tmp_path)
        return read.time[0], read.values["air_temperature_C"].fillna(-1.0).tolist()

    assert first("start", 0) == first("end", late_s)


def test_the_interval_is_found_where_it_is_not_given(good: Path) -> None:
    path = good / "dataset.toml"
    path.write_text(path.read_text(encoding="utf-8").replace("interval_s = 60\n", ""), encoding="utf-8")
    read = read_dataset(good)
    assert read.interval_s == 60.0
    assert any("interval_s is not given" in sentence for sentence in read.assumptions)


@pytest.mark.parametrize("minutes", [1, 10, 60])
@pytest.mark.parametrize(
    ("night", "is_told"), [("2020-03-29T02:00", True), ("2020-03-08T02:00", True), ("2020-03-25T02:00", False)]
)
def test_a_clock_that_was_put_forward_is_told(tmp_path: Path, minutes: int, night: str, is_told: bool) -> None:
    times = pd.date_range(pd.Timestamp(night) - pd.Timedelta("2D"), periods=4 * 1440 // minutes, freq=f"{minutes}min")
    local = times.where(times < pd.Timestamp(night), times + pd.Timedelta("1h"))
    (tmp_path / "dataset.toml").write_text("[nominal]\n")
    values = 20.0 + np.sin(np.arange(len(local)) / 50.0)
    pd.DataFrame({"time": local, "air_temperature_C": values}).to_csv(tmp_path / "data.csv", index=False)
    assert told(read_dataset(tmp_path), "a Sunday, as where summer time begins") == is_told


# --- faults are told, and only impossible samples are taken out ------------------------------------


def test_spikes_and_codes_become_missing_and_are_counted(good: Path) -> None:
    def spoilt(data: pd.DataFrame) -> pd.DataFrame:
        data.loc[[100, 900], "air_temperature_C"] += 12.0
        data.loc[200:209, "outdoor_temperature_C"] = -999.0
        data.loc[300, "supply_temperature_C"] = 3000.0
        return data

    read = reread(good, spoilt)
    for name, rows in (
        ("air_temperature_C", [100, 900]),
        ("outdoor_temperature_C", list(range(200, 210))),
        ("supply_temperature_C", [300]),
    ):
        assert list(np.flatnonzero(read.values[name].isna())) == rows
        assert told(read, name, f"{len(rows)} sample")


@pytest.mark.parametrize(
    ("channel", "fault"),
    [("flow_L_h", 250.0), ("flow_L_h", 65535.0), ("solar_gain_W", 65535.0), ("displacement", 255.0)],
)
def test_one_sample_far_above_all_others_becomes_missing(good: Path, channel: str, fault: float) -> None:
    before = read_dataset(good)

    def spoilt(data: pd.DataFrame) -> pd.DataFrame:
        data.loc[700, channel] = fault
        return data

    read = reread(good, spoilt)
    assert told(read, channel, "1 sample", f"the first is {fault:g}")
    lost = read.values[channel].isna() & before.values[channel].notna()
    assert list(np.flatnonzero(lost)) == [700]


def test_an_oven_that_runs_for_one_sample_and_short_pulses_of_flow_are_no_faults(good: Path) -> None:
    def cooked(data: pd.DataFrame) -> pd.DataFrame:
        full = data["flow_L_h"].max()
        data.loc[[400, 800, 1200], "internal_gain_W"] = 6.0 * data["internal_gain_W"].max()
        data["flow_L_h"] = np.where(np.arange(len(data)) % 30 == 7, full, 0.0)
        return data

    assert not told(reread(good, cooked), "set to missing")


def test_few_short_pulses_and_two_sunny_hours_are_no_faults(good: Path) -> None:
    def mild(data: pd.DataFrame) -> pd.DataFrame:
        data["flow_L_h"], data["solar_gain_W"] = 0.0, 8.0
        data.loc[[100, 300, 500, 700, 900, 1100, 1300], "flow_L_h"] = [100.0, 95.0, 80.0, 40.0, 35.0, 30.0, 20.0]
        data.loc[[400, 1000], "solar_gain_W"] = 130.0
        return data

    assert not told(reread(good, mild), "set to missing")


@pytest.mark.parametrize("noise", [0.001, 0.01, 0.03])
def test_a_level_whose_noise_is_not_cut_off_is_cut_off(good: Path, noise: float) -> None:
    random = np.random.default_rng(4)
    before = read_dataset(good).values["displacement"]
    read = reread(good, lambda d: d.assign(displacement=d["displacement"].round(0) + random.normal(0, noise, len(d))))
    assert read.values["displacement"].between(0.0, 1.0).all()
    assert np.abs(read.values["displacement"] - before.round(0)).max() < 6.0 * noise
    assert any(sentence.startswith("displacement reaches from -0.") for sentence in read.assumptions)


def means_at_switches(signal: pd.Series) -> pd.Series:
    """A logger that averages: somewhere between where it switched, in the interval that ended."""
    return signal.where(signal == signal.shift().fillna(signal.iloc[0]), 0.37)


@pytest.mark.parametrize(
    "told_as",
    [
        lambda s: s.where(s.index != 500, 0.5),
        lambda s: s * 0.999,
        lambda s: s * 1.04,
        lambda s: s + np.random.default_rng(1).normal(0.0, 0.004, len(s)),
        means_at_switches,
    ],
)
def test_a_signal_is_on_or_off_however_it_was_logged(good: Path, told_as: Callable[[pd.Series], pd.Series]) -> None:
    before = read_dataset(good).values["heating_signal"]
    read = reread(good, lambda data: data.assign(heating_signal=told_as(data["heating_signal"])))
    pd.testing.assert_series_equal(read.values["heating_signal"], before)


def test_a_signal_that_runs_on_is_left_as_it_is(good: Path) -> None:
    slow = lambda data: 0.5 + 0.5 * np.sin(np.arange(len(data)) / 40.0)  # noqa: E731
    read = reread(good, lambda data: data.assign(control_output=slow(data), heating_signal=slow(data)))
    np.testing.assert_allclose(read.values["heating_signal"], slow(read.values), atol=1e-9)


def test_pulses_shorter_than_a_sample_keep_their_heat(good: Path) -> None:
    pulses = lambda data: np.where(np.arange(len(data)) % 4 == 0, 0.6, 0.0) + (np.arange(len(data)) % 50 > 40)  # noqa: E731
    read = reread(good, lambda data: data.drop(columns="control_output").assign(heating_signal=pulses(data).clip(0, 1)))
    assert read.values["heating_signal"].mean() == pytest.approx(pulses(read.values).clip(0, 1).mean(), abs=0.01)


def test_a_switch_beside_a_gap_is_not_known(good: Path) -> None:
    def lost(data: pd.DataFrame) -> pd.DataFrame:
        data.loc[500, "heating_signal"] = 0.4
        data.loc[501:700, "heating_signal"] = np.nan
        return data

    assert np.isnan(reread(good, lost).values["heating_signal"].iloc[500])


def test_a_controller_that_cannot_start_is_no_fault_of_reading() -> None:
    class Broken(installed().get("controller", "on-off")):  # type: ignore[misc]
        @staticmethod
        def start(p: object, dt: float) -> object:
            raise RuntimeError("no licence")

    assert only_switches(Choice.of(Broken, {})) is False


def averaged(data: pd.DataFrame) -> pd.DataFrame:
    output = means_at_switches(data["control_output"])
    return data.assign(control_output=output, heating_signal=output)


def test_output_and_signal_of_a_controller_that_switches_are_on_or_off(good: Path) -> None:
    before = read_dataset(good).values
    read = reread(good, averaged)
    for name in ("control_output", "heating_signal"):
        pd.testing.assert_series_equal(read.values[name], before["control_output"].rename(name))


def test_output_and_signal_of_another_controller_may_be_anything_between(good: Path) -> None:
    """One of high gain in samples of half an hour: nearly every sample between stands alone."""
    description = good / "dataset.toml"
    text = description.read_text(encoding="utf-8")
    description.write_text(re.sub(r'use = "on-off"\n.*', 'use = "pi"\ngain = 100.0', text), encoding="utf-8")
    read = reread(good, averaged)
    assert read.nominal["controller"].component.name == "pi"
    assert (read.values["heating_signal"] == 0.37).sum() == (read.values["control_output"] == 0.37).sum() > 3


@pytest.mark.parametrize(
    ("name", "values", "switches"),
    [
        ("on-off", {}, True),
        ("on-off", {"dead_band_K": 2.0}, True),
        ("pi", {}, False),
        ("pi", {"gain": 100.0}, False),
    ],
)
def test_a_controller_tells_by_what_it_gives_whether_it_only_switches(
    name: str, values: dict[str, float], switches: bool
) -> None:
    controller = Choice.of(installed().get("controller", name), values)
    assert only_switches(controller) is switches


def test_the_output_before_a_modulator_may_be_anything_between(good: Path) -> None:
    modulated = '\n[nominal.modulator]\nuse = "pwm"\n'
    read = reread(good, lambda d: d.assign(control_output=d["control_output"].where(d.index % 50 != 7, 0.4)), modulated)
    assert (read.values["control_output"] == 0.4).sum() > 20


def test_a_code_in_a_column_that_is_scaled_is_found_before_it_is_scaled(good: Path) -> None:
    def per_cent(data: pd.DataFrame) -> pd.DataFrame:
        opening = 100.0 * data.pop("displacement")
        return data.assign(travel=opening.where(data.index % 90 != 50, -999.0))

    read = reread(good, per_cent, '\n[columns]\ndisplacement = { column = "travel", scale = 0.01 }\n')
    assert told(read, "displacement", "32 samples are a code for a missing sample", "the first is -999")
    opening = read.values["displacement"]
    assert opening.isna().sum() >= 32
    assert opening.dropna().between(0.0, 1.0).all()


def test_a_stuck_sensor_is_told_and_left_as_it_is(good: Path) -> None:
    def stuck(data: pd.DataFrame) -> pd.DataFrame:
        data.loc[600:1200, "air_temperature_C"] = 21.3
        return data

    read = reread(good, stuck)
    assert (read.values["air_temperature_C"].iloc[600:1201] == 21.3).all()
    assert told(read, "air_temperature_C is stuck at 21.3", "for 10 h")


def test_a_clipped_sensor_is_told(good: Path) -> None:
    top = float(data_of(good)["air_temperature_C"].quantile(0.8))
    read = reread(good, lambda data: data.assign(air_temperature_C=data["air_temperature_C"].clip(upper=top)))
    assert told(read, "air_temperature_C is clipped", f"exactly {top:g}")


def test_a_controller_that_asks_for_nothing_is_not_stuck(good: Path) -> None:
    off = {"control_output": 0.0, "heating_signal": 0.0, "displacement": 0.0, "flow_L_h": 0.0}
    read = reread(good, lambda data: data.assign(**off))
    assert not told(read, "stuck")
    assert told(read, "control_output is 0 throughout")


@pytest.mark.parametrize(
    ("channel", "samples", "sentence"),
    [
        ("control_output", 5, "heating_signal changes 5 samples (300 s) before control_output"),
        ("heating_signal", 5, "heating_signal changes 5 samples (300 s) after control_output"),
        ("flow_L_h", -30, "flow_L_h changes"),
        ("sensor_temperature_C", -20, "ahead of air_temperature_C; a sensor cannot be early"),
    ],
)
def test_an_effect_before_its_cause_is_a_clock_offset(good: Path, channel: str, samples: int, sentence: str) -> None:
    def shifted(data: pd.DataFrame) -> pd.DataFrame:
        data = pd.concat([data] * 3, ignore_index=True)  # more edges
        start = pd.Timestamp(data["time"].iloc[0])
        times = (start + pd.to_timedelta(60 * np.arange(len(data)), unit="s")).strftime("%Y-%m-%dT%H:%M:%S")
        return data.assign(time=times, **{channel: data[channel].shift(samples)})

    assert told(reread(good, shifted), "clock offset", sentence)


@pytest.mark.parametrize("case", ["O_0", "O_CP", "O_D", "O_WM"])
def test_dead_times_of_the_chain_are_no_clock_offsets(
    folder: Path, study: Study, simulated: Simulated, case: str
) -> None:
    assert read_dataset(written(folder, study, simulated, case, "O_CP")).warnings == ()


def test_doubtful_units_are_told_and_not_refused(good: Path) -> None:
    kilowatts = reread(good, lambda data: data.assign(solar_gain_W=data["solar_gain_W"] / 1000.0))
    assert told(kilowatts, "solar_gain_W", "is it in kW?")


# --- valid but poor ---------------------------------------------------------------------------------

POOR: dict[str, Change] = {
    "one channel": lambda data: data[["time", "air_temperature_C"]],
    "a few hours": lambda data: data.head(200),
    "two rows": lambda data: data.head(2),
    "constant signals": lambda data: data.assign(**{name: 0.5 for name in data.columns if name != "time"}).assign(
        **{name: 21.0 for name in data.columns if name.endswith("_C")}, flow_L_h=60.0
    ),
    "mostly missing": lambda data: data.where(np.random.default_rng(2).random(data.shape) < 0.02).assign(
        time=data["time"]
    ),
    "rows mostly missing": lambda data: data.sample(frac=0.02, random_state=3).sort_index(),
    "one value": lambda data: data[["time"]].assign(flow_L_h=[3.0, *[np.nan] * (len(data) - 1)]),
    "nothing flows": lambda data: data.assign(flow_L_h=0.0),
}


@pytest.mark.parametrize("what", POOR)
def test_a_poor_record_is_read(good: Path, what: str) -> None:
    read = reread(good, POOR[what])
    assert len(read.values) >= 2
    assert set(read.values) <= set(CHANNELS)


def test_a_channel_without_a_value_is_not_there(good: Path) -> None:
    read = reread(good, lambda data: data.assign(displacement=np.nan))
    assert "displacement" not in read.values
    assert told(read, "displacement holds no value")


def test_remarks_in_the_description_are_told_and_not_read(good: Path) -> None:
    read = reread(good, lambda data: data, '\n[weather]\nplace = "Tallinn"\n')
    assert told(read, "weather is not known and not read")


@pytest.mark.parametrize(
    ("samples", "interval_s", "days"),
    [
        (97, 900.0, ["2021-01-02"]),  # the first sample ends the first of January
        (96, 900.0, ["2021-01-01", "2021-01-02"]),
        (3, 86_400.0, ["2021-01-01", "2021-01-02", "2021-01-03"]),
        (1, 900.0, ["2021-01-01"]),
    ],
)
def test_days_are_those_that_a_record_tells_of(good: Path, samples: int, interval_s: float, days: list[str]) -> None:
    first = "2021-01-02 00:00" if samples != 96 else "2021-01-01 12:00"
    time = pd.date_range(first, periods=samples, freq=pd.Timedelta(seconds=interval_s))
    values = pd.DataFrame(index=time)
    told = replace(read_dataset(good), time=time, values=values, interval_s=interval_s)
    assert list(told.days.strftime("%Y-%m-%d")) == days


def test_an_empty_nominal_says_that_nothing_is_believed(good: Path) -> None:
    path = good / "dataset.toml"
    text = path.read_text(encoding="utf-8")
    start, end = text.index("[nominal]"), text.index("[room]")
    path.write_text(f"{text[:start]}[nominal]\n{text[end:]}", encoding="utf-8")
    read = read_dataset(good)
    assert (dict(read.nominal), read.setpoint_C) == ({}, None)
    assert told(read, "nothing is believed of the control chain")


# --- the data at hand -------------------------------------------------------------------------------


@pytest.mark.skipif(not REALITIES.exists(), reason=f"{REALITIES} {NO_DATA}")
@pytest.mark.parametrize("name", [f"r{number:02}" for number in range(1, 9)])
def test_the_records_of_another_engine_are_read_without_a_false_warning(name: str) -> None:
    read = read_dataset(REALITIES / name)
    expected = data_of(REALITIES / name).set_index("time")
    np.testing.assert_array_equal(read.values.to_numpy(), expected.to_numpy())
    assert [warning for warning in read.warnings if "of the samples are missing" not in warning] == []
    assert read.room is not None
    room = read.room.component.build(read.room.parameters)  # type: ignore[attr-defined]
    assert (room.floor_area_m2, room.full_flow_L_h) == (pytest.approx(10.4), 122.0)
    assert not any("Not told in [building]" in sentence for sentence in read.assumptions)


@pytest.mark.skipif(not HOUSE.exists(), reason=f"{HOUSE} {NO_DATA}")
def test_the_measured_house_is_read_through_its_mapping(tmp_path: Path) -> None:
    shutil.copy(ROOT / "studies" / "measured_house" / "dataset.toml", tmp_path)
    (table_path,) = HOUSE.glob("*.csv")
    shutil.copy(table_path, tmp_path)
    read, table = read_dataset(tmp_path), pd.read_csv(table_path)
    assert (read.interval_s, len(read.values), len(read.warnings)) == (600.0, 1376, 1)
    np.testing.assert_allclose(read.values["flow_L_h"], table["o5_UFH_all_afterELheat_VFR"])
    heights = table.filter(regex="_AT$")
    np.testing.assert_allclose(read.values["air_temperature_C"], heights.mean(axis=1))
    np.testing.assert_allclose(read.values["internal_gain_W"], table.filter(regex="_IHS_elP$").sum(axis=1))


def test_two_columns_for_one_channel_and_two_channels_of_one_column_are_told(good: Path) -> None:
    def doubled(data: pd.DataFrame) -> pd.DataFrame:
        return data.assign(T1=data["air_temperature_C"], when=data["time"])

    mapped = '[columns]\ntime = "when"\nair_temperature_C = "T1"\noperative_temperature_C = "T1"\n'
    read = reread(good, doubled, mapped)
    assert told(read, "column 'air_temperature_C' of the data file is not read, as [columns] takes")
    assert told(read, "column 'time' of the data file is not read, as [columns] takes time from 'when'")
    assert told(read, "air_temperature_C, operative_temperature_C: all are column 'T1'")


def test_thousands_of_columns_that_are_no_channels_get_a_few_lines(good: Path) -> None:
    def wide(data: pd.DataFrame) -> pd.DataFrame:
        extra = pd.DataFrame(0.0, index=data.index[:], columns=[f"x{i}" for i in range(3000)])
        return pd.concat([data, extra.assign(flow_L_hh=1.0)], axis="columns").head(200)

    strange = [each for each in reread(good, wide).warnings if "no channel" in each]
    assert len(strange) == 6
    assert strange[-1].startswith("2996 other columns are no channels and are not read: among them 'flow_L_hh'; did")


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [1e300, -1e300, 1e15])
def test_a_number_beyond_all_channels_is_missing_and_told(good: Path, value: float) -> None:
    def wild(data: pd.DataFrame) -> pd.DataFrame:
        data.loc[[7, 900], ["air_temperature_C", "flow_L_h"]] = value
        return data

    read = reread(good, wild)
    for name in ("air_temperature_C", "flow_L_h"):
        assert list(np.flatnonzero(read.values[name].isna())) == [7, 900]
        assert told(read, f"{name}: 2 cells are no numbers of at most 1e+12")


# --- rows that lie unevenly --------------------------------------------------------------------------


@pytest.mark.parametrize("second", [0, 20, 27, 30, 33, 45])
def test_stamps_that_jitter_around_any_second_of_a_minute_lose_nothing(good: Path, second: int) -> None:
    jitter_s = np.random.default_rng(1).integers(-2, 3, len(data_of(good)))

    def late(data: pd.DataFrame) -> pd.DataFrame:
        return data.assign(time=pd.to_datetime(data["time"]) + pd.to_timedelta(second + jitter_s, unit="s"))

    ours = read_dataset(good)
    read = reread(good, late)
    assert not told(read, "left out")
    np.testing.assert_array_equal(read.values.to_numpy(), ours.values.to_numpy())
    assert abs((read.time[0] - ours.time[0]).total_seconds() - second) <= 15.0


def test_an_interval_of_which_most_rows_are_lost_is_missing(good: Path) -> None:
    def outage(data: pd.DataFrame) -> pd.DataFrame:
        return data.drop(index=data.index[3 * 15 + 1 : 3 * 15 + 15])  # one row of fifteen stays

    path = good / "dataset.toml"
    path.write_text(re.sub("interval_s = .*", "interval_s = 900", path.read_text()))
    read = reread(good, outage)
    assert read.interval_s == 900.0
    assert read.values.iloc[3].drop("setpoint_C").isna().all()
    assert read.values["flow_L_h"].isna().sum() == 1
    assert told(read, "hold less than half of the usual rows")


def test_a_logger_that_is_set_to_another_rate_loses_nothing(good: Path) -> None:
    def slower(data: pd.DataFrame) -> pd.DataFrame:
        is_kept = (np.arange(len(data)) < 1440) | (np.arange(len(data)) % 5 == 4)
        return data[is_kept]

    path = good / "dataset.toml"
    path.write_text(re.sub("interval_s = .*", "interval_s = 900", path.read_text()))
    read = reread(good, slower)
    assert not told(read, "less than half of the usual rows")
    assert np.isfinite(read.values["flow_L_h"]).all()


def test_rows_that_are_written_on_change_are_few_where_little_happens_and_stay(good: Path) -> None:
    def on_change(data: pd.DataFrame) -> pd.DataFrame:
        random = np.random.default_rng(1)
        busy = (np.arange(len(data)) // 120) % 2 == 0
        return data[random.random(len(data)) < np.where(busy, 0.6, 0.15)]

    path = good / "dataset.toml"
    path.write_text(re.sub("interval_s = .*", "interval_s = 900", path.read_text()))
    assert not told(reread(good, on_change), "less than half of the usual rows")
