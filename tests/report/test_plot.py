"""Claims about a figure on its way to a page."""

from __future__ import annotations

import re

import pytest
from matplotlib import rc_context, rcParams
from matplotlib.figure import Figure

from tests.report.test_page import Page
from waxstudy.report.figures.plot import WIDTH_IN, Lacking, drawing, panels, plots
from waxstudy.report.html import filled


@drawing("line", "A line & more", "What a <line> is.")
def figure_line(heights: list[float]) -> Figure:
    if not heights:
        raise Lacking("there is <nothing> to draw")
    figure, axes = panels(1, 2, 2.0)
    for panel in axes[0]:
        panel.plot(heights, label="line")
    figure.legend()
    return figure


def on_a_page(heights: list[float]) -> str:
    words = dict.fromkeys(("title", "simulated", "summary", "version"), "")
    lists = dict.fromkeys(("tables", "untold", "steps", "warnings", "sources"), ())
    return filled("identification.html.j2", figures=plots([figure_line], heights), **words, **lists)


def test_a_plot_has_the_words_of_its_drawing_and_an_svg_of_the_page_s_width() -> None:
    plot = figure_line.plot([1.0, 2.0])
    assert (plot.id, plot.title, plot.caption) == ("figure-line", "A line & more", "What a <line> is.")
    assert plot.missing == ""
    assert plot.svg.startswith(f'<svg id="figure-line-whole" width="{72 * WIDTH_IN:g}pt" height="144pt"')
    assert plot.svg.rstrip().endswith("</svg>")
    assert "xmlns" not in plot.svg
    assert "<metadata" not in plot.svg


def test_a_panel_that_a_phone_shows_alone_has_its_own_scale() -> None:
    figure, axes = panels(1, 2, 2.0, sharey=True)
    axes[0, 0].plot([1.0, 2.0])
    figure.draw_without_rendering()
    assert {label.get_visible() for label in axes[0, 1].get_yticklabels()} == {True}


def test_what_cannot_be_drawn_says_why_and_any_other_failure_is_one() -> None:
    plot = figure_line.plot([])
    assert (plot.svg, plot.missing) == ("", "there is <nothing> to draw")
    with pytest.raises(ZeroDivisionError):
        drawing("none", "", "")(lambda shown: panels(1, 1, shown / 0.0)[0]).plot(1.0)


def test_a_page_shows_title_alternative_text_and_caption_or_the_reason() -> None:
    text = on_a_page([1.0, 2.0])
    page = Page(text)
    assert "A line & more" in page.headings
    assert page.values("aria-label") == 2 * ["A line & more"]  # whole, and panel by panel on a phone
    assert "What a <line> is." in page.words
    assert text.count("<svg id") == 1
    assert text.count("<svg viewBox") == len(figure_line.plot([1.0, 2.0]).parts)
    bare = on_a_page([])
    assert "<svg" not in bare
    assert "<figcaption" not in bare
    assert "Not drawn: there is &lt;nothing&gt; to draw.</p>" in bare


def test_the_look_is_its_own_whatever_the_reader_has_set_and_leaves_that_as_it_is() -> None:
    usual = figure_line.plot([1.0, 2.0])
    with rc_context({"font.size": 20.0, "lines.linewidth": 9.0, "svg.fonttype": "none", "savefig.dpi": 10.0}):
        own = figure_line.plot([1.0, 2.0])
        assert (rcParams["font.size"], rcParams["svg.fonttype"]) == (20.0, "none")
    assert own.svg == usual.svg
    (line,) = figure_line([1.0, 2.0]).axes[0].get_lines()
    assert line.get_linewidth() == 1.2


def test_the_same_figure_is_the_same_text_and_another_is_another() -> None:
    assert figure_line.plot([1.0, 2.0]) == figure_line.plot([1.0, 2.0])
    assert figure_line.plot([1.0, 2.0]).svg != figure_line.plot([1.0, 2.5]).svg


def test_ids_begin_with_the_figure_s_own_so_that_two_on_a_page_stay_apart() -> None:
    svg = figure_line.plot([1.0, 2.0]).svg
    ids = re.findall(r'\bid="([^"]*)"', svg)
    uses = re.findall(r'href="#([^"]*)"|url\(#([^)]*)\)', svg)
    assert len(ids) > 10
    assert len(uses) > 10
    assert all(name.startswith("figure-line-") for name in ids)
    assert {one or other for one, other in uses} <= set(ids)
