"""Traces zoom on a page of their own, which loads nothing and runs no script but its own."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import shutil
import sys
from html import unescape
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.report.test_page import browse, needs_browser, scroll_width
from waxstudy.cli import main
from waxstudy.report.content import Content
from waxstudy.report.diagnosis.traced import TRACED, traced
from waxstudy.report.traces.lines import MOST_POINTS, Line, Panel, Traces, extremes
from waxstudy.report.traces.page import _trace, as_html
from waxstudy.report.traces.run import of_run

EVIL = "<img src=x onerror=alert(1)></script><script>document.title='evil'</script>"
DRAG = """const target = document.querySelector(".nsewdrag"), box = target.getBoundingClientRect();
const at = (kind, share, where) => where.dispatchEvent(new MouseEvent(kind,
  {bubbles: true, view: window, buttons: 1, clientX: box.x + share * box.width, clientY: box.y + box.height / 2}));
at("mousedown", 0.25, target); at("mousemove", 0.4, document);
at("mousemove", 0.5, document); at("mouseup", 0.5, document);
setTimeout(() => {
  const plot = document.getElementById("traces");
  document.title = JSON.stringify([plot.layout.xaxis.range, plot.layout.xaxis2.range,
    document.querySelectorAll(".scatterlayer .trace path.js-line").length]);
}, 1000);"""


@pytest.fixture(scope="module")
def page(small: Content) -> str:
    pytest.importorskip("plotly")
    return as_html(of_run(small.run, small.study, [], None))


def evil_page() -> str:
    known = pd.Series([1.0, 2.0], index=pd.date_range("2026-01-01", periods=2))
    return as_html(Traces(EVIL, EVIL, [Panel(EVIL, "K", [Line(EVIL, 0, known)])]))


def rules_of(page: str) -> dict[str, str]:
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)
    assert policy
    return dict(rule.split(" ", 1) for rule in unescape(policy[1]).split("; "))


def run_command(*arguments: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(["traces", *arguments])
    return int(ended.value.code or 0)


def test_the_browser_may_run_the_scripts_of_the_page_alone_and_load_nothing(page: str) -> None:
    rules = rules_of(page)
    # what is loaded, where it is looked for, where forms go: the last two are no part of the first
    assert {rules[name] for name in ("default-src", "base-uri", "form-action")} == {"'none'"}
    digests = [
        f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"
        for script in re.findall(r"<script[^>]*>(.*?)</script>", page, re.S)
    ]
    assert rules["script-src"].split() == digests


def test_names_never_become_markup(page: str) -> None:
    evil = evil_page()
    assert "<img" not in evil
    assert "document.title='evil'</script>" not in evil
    # none of the scripts that may run came with a name: there are as many as on a page of plain names
    assert len(rules_of(evil)["script-src"].split()) == len(rules_of(page)["script-src"].split())


@needs_browser
def test_dragging_across_a_panel_zooms_all_of_them(page: str, tmp_path: Path) -> None:
    digest = base64.b64encode(hashlib.sha256(DRAG.encode()).digest()).decode()
    text = page.replace("script-src ", f"script-src 'sha256-{digest}' ", 1)
    file = tmp_path / "page.html"
    file.write_text(text.replace("</body>", f"<script>{DRAG}</script></body>"), encoding="utf-8")
    dom = browse(tmp_path, file, 1200, "--virtual-time-budget=20000", "--dump-dom")
    title = re.search(r"<title>(\[.*?\])</title>", dom)
    assert title, "the page ran no script"
    first, second, lines = json.loads(title[1])
    day = pd.Timestamp(first[0]), pd.Timestamp(first[1])
    assert 1.6 < (day[1] - day[0]) / pd.Timedelta(1, "D") < 1.9  # a quarter of the week
    assert first == second
    assert lines == 2 * 7 + 2  # two cases in seven panels, and their set-points


@needs_browser
def test_the_page_of_traces_fits_a_phone(page: str, tmp_path: Path) -> None:
    assert scroll_width(tmp_path, page, 390) <= 390


@needs_browser
def test_a_script_in_a_name_is_not_run(tmp_path: Path) -> None:
    pytest.importorskip("plotly")
    file = tmp_path / "page.html"
    file.write_text(evil_page().replace("</body>", "<script>document.title = 'evil'</script></body>"), encoding="utf-8")
    dom = browse(tmp_path, file, 1200, "--virtual-time-budget=10000", "--dump-dom")
    assert "<title>evil" not in dom
    drawn = dom.split('class="legendtext"')
    assert len(drawn) == 2, "plotly drew no legend"
    assert "<img" not in drawn[1]


@given(st.lists(st.floats(-100.0, 100.0) | st.just(np.nan), min_size=1, max_size=400), st.integers(2, 60))
def test_a_thinned_line_keeps_its_extremes_its_ends_and_its_breaks(values: list[float], most: int) -> None:
    line = np.array(values)
    kept = extremes(line, most)
    assert np.all(np.diff(kept) > 0)
    assert kept[0] == 0
    assert kept[-1] == len(line) - 1
    assert np.isnan(line[kept]).sum() == np.isnan(line).sum()
    if not np.isnan(line).all():
        assert (np.nanmin(line[kept]), np.nanmax(line[kept])) == (np.nanmin(line), np.nanmax(line))
        assert len(kept) <= most + 2 + np.isnan(line).sum()


def test_a_page_says_when_not_every_sample_is_drawn() -> None:
    pytest.importorskip("plotly")
    known = pd.Series(np.sin(np.arange(20_000.0)), index=pd.date_range("2026-01-01", periods=20_000, freq="min"))
    text = as_html(Traces("long", "", [Panel("air", "°C", [Line("measured", 0, known)])]))
    assert "The longest line has 20000 samples. Each line of more than 12000 is cut into 6000 pieces" in text


def test_a_page_on_which_every_sample_is_drawn_says_so_however_many_gaps_it_has() -> None:
    pytest.importorskip("plotly")
    times = pd.date_range("2026-01-01", periods=3 * MOST_POINTS, freq="min")
    known = pd.Series(np.arange(3.0 * MOST_POINTS), index=times)[np.arange(3 * MOST_POINTS) % 30 < 10]
    assert len(known) == MOST_POINTS
    line = Line("measured", 0, known)
    assert "Every sample is drawn." in as_html(Traces("gaps", "", [Panel("air", "°C", [line])]))
    assert np.isfinite(_trace(Panel("air", "°C", [line]), line, set())["y"]).sum() == len(known)


def test_a_channel_that_no_effect_changes_has_no_line_with_them() -> None:
    frame = pd.DataFrame({f"flow_L_h_{what}": [1.0, np.nan, 2.0] for what in TRACED})
    assert list(traced(frame, "flow_L_h")) == ["measured", "before"]
    frame.loc[2, "flow_L_h_after"] = 3.0
    assert list(traced(frame, "flow_L_h")) == ["measured", "before", "after"]


def test_the_command_names_the_nearest_case_and_week(small: Content, capsys: pytest.CaptureFixture[str]) -> None:
    folder = str(small.run.folder)
    assert run_command(folder, "--case", "presice") == 2
    assert "no case 'presice' in this run; did you mean 'precise'?; it has rough, precise" in capsys.readouterr().err
    assert run_command(folder, "--week", "sunni") == 2
    assert "did you mean 'sunny'?" in capsys.readouterr().err


def test_without_traces_or_without_a_run_nothing_is_written(bare: Content, tmp_path: Path) -> None:
    assert run_command(str(bare.run.folder)) == 3
    assert run_command(str(tmp_path)) == 3
    assert not (bare.run.folder / "traces.html").exists()
    assert list(tmp_path.iterdir()) == []


def test_without_plotly_the_command_says_which_extra_it_needs(
    small: Content, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "plotly", None)
    assert run_command(str(small.run.folder)) == 5
    assert "pip install 'waxstudy[interactive]'" in capsys.readouterr().err


def test_the_command_writes_the_page_of_a_diagnosis(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("plotly")
    index = pd.date_range("2026-01-01", periods=200, freq="5min", name="time")
    measured = np.sin(np.arange(200.0))
    traces = {"flow_L_h_measured": measured, "flow_L_h_before": measured + 0.1, "flow_L_h_after": measured + 0.05}
    pd.DataFrame(traces, index=index).to_parquet(tmp_path / "traces.parquet")
    (tmp_path / "diagnosis.json").write_text(json.dumps({"format": 1, "verdict": "gap", "dataset": "a <room>"}))
    assert run_command(str(tmp_path)) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'traces.html'}\n"
    text = (tmp_path / "traces.html").read_text(encoding="utf-8")
    assert "Traces of the diagnosis of “a &lt;room&gt;”" in text
    for words in ("Flow, L/h", "measured", "as believed", "with the effects found"):
        assert words.replace("/", "\\u002f") in text
    assert run_command(str(tmp_path), "--week", "cold") == 2
    shutil.copy(tmp_path / "diagnosis.json", tmp_path / "traces.parquet")
    assert run_command(str(tmp_path)) == 3
