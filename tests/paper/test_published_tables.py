"""Tables that long runs made for the pages of docs/, computed again in a cheap form: two members at steps of 20 s."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pandas as pd
import pytest

from tests.conftest import ROOT
from tests.test_docs import rows_of
from waxstudy.api.running import run


def stated(name: str) -> dict[str, object]:
    """A study's January with two members at a coarse step, and no traces."""
    study = tomllib.loads((ROOT / "studies" / name).read_text(encoding="utf-8"))
    study["study"] = {"name": "coarse", "step_s": 20}
    study["weather"] = {"january": study["weather"]["january"]}
    study["ensemble"] = {"members": 2, "seed": 1}
    study["output"] = {"trace_members": 0}
    return study


def of_cases(study: dict[str, object], folder: Path) -> pd.DataFrame:
    return run(study, folder).kpis.groupby("case").mean(numeric_only=True)


@pytest.mark.slow
def test_the_settings_of_the_tuning_page_track_as_it_says(tmp_path: Path) -> None:
    rows = [row for row in rows_of(ROOT / "docs" / "tuning.md") if len(row) == 5 and row[1][:1].isdigit()]
    assert len(rows) == 5
    study = stated("table5.toml")
    (ladder,) = (each for name, each in study["ladder"].items() if name == "pi")  # type: ignore[attr-defined]
    for number, (_, gain, time_s, *_) in enumerate(rows):
        tuned = {"gain": float(gain), "integration_time_s": float(time_s.replace(",", ""))}
        ladder["steps"].append({"id": f"T_{number}", "controller": tuned})
    study["ladder"] = {"pi": ladder}
    found = of_cases(study, tmp_path / "run")
    for number, (name, *_, january, _) in enumerate(rows):
        assert found.loc[f"T_{number}", "mae_K"] == pytest.approx(float(january), abs=0.03), name
    assert found.loc["T_1", "mae_K"] < 0.6 * found.loc["T_0", "mae_K"]


@pytest.mark.slow
def test_standby_takes_every_start_of_the_week_below_300_s_and_no_heat(tmp_path: Path) -> None:
    found = of_cases(stated("standby.toml"), tmp_path / "run")
    share = found["starts_over_300_s"] / found["starts"]
    assert share.loc[["O_WM", "P_WM"]].tolist() == [1.0, 1.0]
    assert share.loc[["O_SB", "P_SB"]].tolist() == [0.0, 0.0]
    heat = found["heat_corrected_kWh_m2_week"]
    for plain, standby in (("O_WM", "O_SB"), ("P_WM", "P_SB")):
        assert heat[standby] == pytest.approx(heat[plain], rel=0.01)
    printed = {row[0].partition(",")[0]: row for row in rows_of(ROOT / "docs" / "standby.md") if len(row) == 6}
    for case in ("O_WM", "O_SB", "P_WM", "P_SB"):
        assert found.loc[case, "mae_K"] == pytest.approx(float(printed[case][3].partition(" ")[0]), abs=0.03)
