"""Heat month by month, and how far each case is from its reference in each."""

from __future__ import annotations

from matplotlib.figure import Figure

from waxstudy.report.content import Content
from waxstudy.report.figures.plot import drawing, panels
from waxstudy.report.figures.style import BLACK, THICK, legend_under, look


@drawing(
    "months",
    "Heat by month",
    "Above: water heat of the first case and of the reference case of each ladder. Below: heat of every case against "
    "the reference, in months that have a hundredth of its heat at least. Members' mean, of the first record of "
    "several months.",
)
def figure_months(content: Content) -> Figure:
    """Heat [kWh/m²] and differences [%] by month, a column per ladder."""
    ladders = content.run.ladders
    figure, axes = panels(2, len(ladders), 6.6, sharex=True, sharey="row")
    rows = {row.case: row for row in content.months if row.week == content.months[0].week}
    for (above, below), ladder in zip(axes.T, ladders, strict=True):
        for case in ladder.cases:
            names, row, style = list(rows[case].heat_kWh_m2), rows[case], look(content, case)
            if case in (ladder.cases[0], ladder.reference):
                above.plot(list(row.heat_kWh_m2.values()), label=case, **style)
            if case != ladder.reference:
                below.plot([row.difference_percent[name] for name in names], label=case, **style)
        below.axhline(0.0, color=BLACK, linewidth=THICK, label=ladder.reference)
        above.set(title=f"{ladder.name}, {row.week}", ylim=(0.0, None))
        below.set_xticks(range(len(names)), [name[5:] for name in names])
        below.set_xlabel(f"month, from {names[0]}")
        legend_under(below, 1.0 / len(ladders))
    axes[0, 0].set_ylabel("heat, kWh/m² a month")
    axes[1, 0].set_ylabel("heat against the reference case, %")
    figure.align_ylabels()
    return figure
