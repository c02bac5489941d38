"""The page is one file that says everything the report holds and needs nothing from outside."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from copy import copy
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.report.diagnoses import EFFECT
from waxstudy.plugin import Finding, PublishedRow
from waxstudy.report.against import Published
from waxstudy.report.cases import told_same
from waxstudy.report.comparison import members_by_week
from waxstudy.report.content import Content
from waxstudy.report.diagnosis.page import as_html as diagnosis_as_html
from waxstudy.report.figures import PAPER_FIGURES
from waxstudy.report.figures.overview import figure_overview
from waxstudy.report.page import as_html
from waxstudy.report.render import as_json, as_markdown, as_terminal, tables
from waxstudy.report.score import cells, scores

VOID = {"meta", "br", "hr", "img", "link", "input"}
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
needs_browser = pytest.mark.skipif(BROWSER is None, reason="no chromium or google-chrome on the path")


class Page(HTMLParser):
    """Elements, attributes and the texts of table cells; fails on an end tag that closes nothing."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.rows: list[list[tuple[str, str]]] = []
        self.headings: list[str] = []
        self.words: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        if tag not in VOID:
            self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append(("", dict(attrs).get("class") or ""))
        if tag in ("h1", "h2", "h3"):
            self.headings.append("")

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.attributes += [(tag, name, value or "") for name, value in attrs]

    def handle_endtag(self, tag: str) -> None:
        assert self.open
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in ("td", "th"):
            text, style = self.rows[-1][-1]
            self.rows[-1][-1] = (text + data, style)
        if self.open and self.open[-1] in ("h1", "h2", "h3"):
            self.headings[-1] += data
        if self.open and self.open[-1] != "style":
            self.words.append(data)

    @property
    def texts(self) -> list[list[str]]:
        return [[text for text, _ in row] for row in self.rows]

    def values(self, name: str) -> list[str]:
        return [value for _, attribute, value in self.attributes if attribute == name]


@pytest.fixture(scope="module")
def text(small: Content) -> str:
    return as_html(small)


@pytest.fixture(scope="module")
def against(small: Content) -> Content:
    """The small run held against made-up published figures, with words that HTML must escape."""
    published = [PublishedRow("rough", "cold", 0.51, 0.612, 2.53, 5.71)]
    paired = cells(small.rows, published, members_by_week(small.run))
    findings = [Finding("X1", "dQ < 1 % & more", "not held", "<b>2 %</b>"), Finding("X2", "fine", "held", "0 K")]
    rows = [replace(row, resolved=row.case == "usual" if row.resolved is not None else None) for row in small.rows]
    return replace(small, rows=rows, notes=("a note",), against=Published("book", paired, scores(paired), findings))


@pytest.fixture(scope="module")
def against_text(against: Content) -> str:
    return as_html(against)


def test_the_page_holds_every_case_with_its_heat_in_every_week(text: str, small: Content) -> None:
    texts = Page(text).texts
    for row in small.rows:
        heat = f"{row.heat_kWh_m2_week.mean:.2f} ± {row.heat_kWh_m2_week.sd:.2f}"
        assert any(cells[0] == row.case and heat in cells for cells in texts)
    assert len(small.rows) == 10


def test_every_table_of_the_report_is_on_the_page_word_for_word(against: Content, against_text: str) -> None:
    shown = Page(against_text).texts
    for table in tables(against):
        assert table.names in shown
        assert all(row in shown for row in table.texts)


def test_the_parts_come_in_the_order_that_a_reader_needs(against_text: str) -> None:
    headings = Page(against_text).headings
    order = (
        "Report of",
        "Comparison",
        "Notes",
        "Against book",
        "Findings",
        "Activation",
        "Figures",
        "Provenance",
        "How to",
    )
    places = [next(i for i, heading in enumerate(headings) if heading.startswith(start)) for start in order]
    assert places == sorted(places)


def test_every_figure_is_drawn_when_the_run_has_what_it_needs(text: str) -> None:
    page = Page(text)
    assert text.count("<svg id") == text.count('class="wide whole"') == 1 + len(PAPER_FIGURES) == 9
    for number in (12, 17, 18, 19, 20, 21, 22):
        assert any(heading.startswith(f"Figure {number}. ") for heading in page.headings)
    assert "Not drawn" not in text


def test_a_bare_run_gives_one_line_of_reason_for_each_figure_that_it_cannot_draw(bare: Content) -> None:
    page = as_html(bare)
    reasons = re.findall(r"Not drawn: (.*)</p>", page)
    assert len(reasons) == 4
    assert sum("keeps no traces" in reason for reason in reasons) == 3
    assert sum("single one" in reason for reason in reasons) == 1
    assert page.count("<svg id") == 5
    assert "One member" not in page
    assert "no difference can be called resolved" in page


def test_nothing_is_fetched_from_outside_and_nothing_is_executed(text: str) -> None:
    page = Page(text)
    assert "http" not in text
    assert page.values("src") == []
    assert {tag for tag, _, _ in page.attributes} & {"script", "link", "iframe", "object", "img"} == set()
    assert "<script" not in text
    assert "@import" not in text
    assert all(value.startswith("#") for value in page.values("href") + page.values("xlink:href"))


def test_ids_are_unique_and_every_reference_leads_to_one(text: str) -> None:
    page = Page(text)
    ids = page.values("id")
    assert len(ids) == len(set(ids))
    references = re.findall(r"url\(#([^)]*)\)", text)
    references += [value[1:] for value in page.values("href") + page.values("xlink:href")]
    assert set(references) <= set(ids)
    assert len(references) > 100


def test_published_figures_stand_dim_beside_ours(against_text: str) -> None:
    rows = [row for row in Page(against_text).rows if row and row[0][0] == "rough"]
    dim = [[text for text, style in row if "published" in style.split()] for row in rows]
    assert next(filter(None, dim)) == ["0.51", "0.612", "2.53", "5.71"]


def test_foreign_words_are_shown_and_never_become_markup(against_text: str) -> None:
    assert ["X1", "dQ < 1 % & more", "not held", "", "<b>2 %</b>"] in Page(against_text).texts
    assert "<b>" not in against_text


def test_the_summary_counts_cases_resolved_differences_and_findings(against_text: str) -> None:
    words = " ".join(Page(against_text).words)
    assert "5 cases in 2 ladders (switching, steady) over 2 weeks (cold, sunny), with 2 members per case." in words
    assert "Of 6 differences in heat from the reference case, 2 are resolved." in words
    assert "Of the 2 findings of “book”: 1 held, 1 not held, 0 not resolved." in words


def test_notes_and_provenance_are_told_without_the_path_of_the_run(against_text: str, small: Content) -> None:
    words = " ".join(Page(against_text).words)
    assert "a note" in words
    assert str(small.run.folder.parent) not in against_text
    for told in ("run folder", "run", "seed", "1", f"numpy {np.__version__}"):
        assert told in words


def test_the_page_is_small_and_the_same_every_time(text: str, small: Content) -> None:
    assert len(text.encode()) < 4_000_000
    assert as_html(small) == text


# --- in a browser ------------------------------------------------------------------------------------


def browse(place: Path, file: Path, width: int, *options: str) -> str:
    """What a browser prints of a page; one that stalls, as on a busy machine it may, is started once more."""
    assert BROWSER
    command = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking"]
    command += [f"--window-size={width},3000", *options, file.as_uri()]

    def printed(profile: str) -> str:
        of_its_own = [*command, f"--user-data-dir={place / profile}"]
        return subprocess.run(of_its_own, capture_output=True, text=True, check=True, timeout=120).stdout

    try:
        return printed("profile")
    except subprocess.TimeoutExpired:
        return printed("another profile")


def scroll_width(place: Path, page: str, width: int) -> int:
    """How wide a page is in a frame of this width: the window itself is never narrower than 500 pixels."""
    text = json.dumps(page).replace("</", "<\\/")
    script = f"""const frame = document.createElement("iframe");
        frame.width = {width}; frame.onload = () => document.title = frame.contentDocument.documentElement.scrollWidth;
        frame.srcdoc = {text}; document.body.append(frame)"""
    file = place / "frame.html"
    file.write_text(f"<!DOCTYPE html><title></title><body><script>{script}</script>", encoding="utf-8")
    found = re.search(r"<title>(\d+)</title>", browse(place, file, 1300, "--virtual-time-budget=20000", "--dump-dom"))
    assert found
    return int(found[1])


@needs_browser
@pytest.mark.parametrize("width", [1200, 390])
def test_the_page_never_scrolls_sideways(width: int, against_text: str, tmp_path: Path) -> None:
    assert scroll_width(tmp_path, against_text, width) <= width
    assert scroll_width(tmp_path, f"<!DOCTYPE html><div style='width:{2 * width}px'>x", width) > width


@needs_browser
def test_a_long_line_of_a_file_scrolls_in_its_own_frame(against_text: str, tmp_path: Path) -> None:
    long = against_text.replace("</main>", f"<pre>{'x' * 400}</pre></main>")
    assert long != against_text
    assert scroll_width(tmp_path, long, 390) <= 390


def test_the_whole_figure_stays_drawn_on_a_phone_as_its_panels_are_clipped_by_it(text: str) -> None:
    assert re.search(r"\.whole \{[^}]*overflow: hidden", text)
    assert not re.search(r"\.whole \{[^}]*display: none", text)


@needs_browser
def test_a_browser_draws_text_and_colours_of_the_figures(text: str, tmp_path: Path) -> None:
    from matplotlib.image import imread

    file, shot = tmp_path / "page.html", tmp_path / "shot.png"
    file.write_text(text, encoding="utf-8")
    browse(tmp_path, file, 1200, f"--screenshot={shot}")
    pixels = (255 * imread(shot)[..., :3]).round().astype(int)
    assert pixels.shape[1] == 1200
    for colour in ((0, 0, 0), (0x00, 0x72, 0xB2), (0xE6, 0x9F, 0x00), (255, 255, 255)):
        assert np.sum(np.all(pixels == colour, axis=-1)) > 200


# --- what a reader sees first ------------------------------------------------------------------------


def test_the_legend_says_in_words_what_each_case_adds(text: str) -> None:
    rows = {row[0]: row[1:] for row in reversed(Page(text).texts) if row and row[0] in ("rough", "precise", "pulsed")}
    assert rows["rough"][0] == "first"
    assert rows["precise"] == ["rough", "controller: dead_band_K = 0.5 instead of 2"]
    assert rows["pulsed"][1].startswith("modulator “pwm”: pulse-width modulation")


def test_cases_that_are_the_same_run_are_told(small: Content) -> None:
    kpis = small.run.kpis
    assert told_same(small.run) == []
    twin = kpis[kpis["case"] == "usual"].assign(case="pulsed")
    run = copy(small.run)
    run.kpis = pd.concat([kpis[kpis["case"] != "pulsed"], twin])  # type: ignore[misc]
    told = "usual and pulsed are the same run: what the later one adds changes nothing here"
    assert told_same(run) == [told]
    twins = replace(small, run=run)
    for text in (as_terminal(twins, 200, colour=False), as_markdown(twins), as_html(twins)):
        assert text.count(told) == 1
    assert told in json.loads(as_json(twins))["notes"]


def test_findings_are_sentences_with_a_figure_and_the_rest_is_folded(against_text: str) -> None:
    assert re.search(r'<li><span class="bad">Not held</span>: dQ &lt; 1 % &amp; more\.', against_text)
    assert "<details>" in against_text


def test_on_a_phone_every_panel_has_a_view_of_its_own(small: Content) -> None:
    plot = figure_overview.plot(small)
    boxes = [[float(side) for side in part.split()] for part in plot.parts]
    assert len(boxes) == 4  # three panels and the legend
    width, height = plot.size
    assert all(x > -5 and y > -5 and x + w < width + 5 and y + h < height + 5 for x, y, w, h in boxes)
    assert [x for x, *_ in boxes[:3]] == sorted(x for x, *_ in boxes[:3])


@needs_browser
def test_axe_finds_nothing_that_keeps_readers_out(against_text: str, tmp_path: Path) -> None:
    axe = Path(pytest.importorskip("axe_core_python").__file__).with_name("axe.min.js").read_text(encoding="utf-8")
    diagnosed = diagnosis_as_html(EFFECT)
    run = "axe.run().then(found => document.title = 'axe ' + found.violations.map(each => each.impact + ' ' + each.id))"
    for full in (against_text, diagnosed):
        text = re.sub(r"(<svg[^>]*>).*?</svg>", r"\1</svg>", full, flags=re.S)  # thousands of paths that it passes over
        copy = tmp_path / "copy.html"
        copy.write_text(text.replace("</body>", f"<script>{axe}</script><script>{run}</script></body>"), "utf-8")
        dom = browse(tmp_path, copy, 1200, "--virtual-time-budget=60000", "--dump-dom")
        found = re.search(r"<title>axe (.*?)</title>", dom)
        assert found, "axe did not run to its end"
        assert not re.search("serious|critical", found[1]), found[1]
