"""Claims about reading diagnosis.json: later versions read it, earlier ones refuse what is newer."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import waxstudy as wx


def written(folder: Path, **values: object) -> Path:
    path = folder / "diagnosis.json"
    path.write_text(json.dumps({"verdict": "none", **values}))
    return path


def test_a_file_or_its_folder_is_read_and_so_is_one_from_before_there_was_a_number(tmp_path: Path) -> None:
    path = written(tmp_path, format=1, seed=3)
    assert wx.read_diagnosis(path) == wx.read_diagnosis(tmp_path) == {"verdict": "none", "format": 1, "seed": 3}
    assert wx.read_diagnosis(written(tmp_path))["verdict"] == "none"


def test_a_later_one_is_refused_with_both_numbers(tmp_path: Path) -> None:
    with pytest.raises(wx.RunError, match="format 2, this version reads up to 1"):
        wx.read_diagnosis(written(tmp_path, format=2))


@pytest.mark.parametrize("text", ["", "[1, 2]", '{"format": 1}', '{"format": "a", "verdict": "none"}'])
def test_what_is_no_diagnosis_is_refused_by_name(tmp_path: Path, text: str) -> None:
    (tmp_path / "diagnosis.json").write_text(text)
    with pytest.raises(wx.RunError, match=r"diagnosis\.json: (cannot be read|holds no diagnosis)"):
        wx.read_diagnosis(tmp_path)
    with pytest.raises(wx.RunError, match="cannot be read"):
        wx.read_diagnosis(tmp_path / "nowhere.json")
