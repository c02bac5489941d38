"""What may have changed since the baseline, and how likely each is."""

from __future__ import annotations

from matplotlib.figure import Figure

from waxstudy.diagnosis.result import Diagnosis
from waxstudy.report.diagnosis.words import chance, hypothesis
from waxstudy.report.figures.plot import Lacking, drawing, one_panel
from waxstudy.report.figures.style import BLACK, COLOURS, name_rows

MOST = 8


@drawing(
    "posterior",
    "How likely each hypothesis is",
    "Probability of the likeliest hypotheses of the whole loop, at most eight. All of them, of the effects of the "
    "library, of nothing and of something unknown, sum to 100 %.",
)
def figure_posterior(diagnosis: Diagnosis) -> Figure:
    """Probabilities [%]; raise `Lacking` where nothing can be judged."""
    if not diagnosis.posterior:
        raise Lacking("no link of the loop can be judged")
    shown = sorted(diagnosis.posterior.items(), key=lambda each: -each[1])[:MOST]
    figure, panel = one_panel(0.9 + 0.3 * len(shown))
    for place, (_, probability) in enumerate(shown):
        panel.barh(place, 100.0 * probability, 0.62, color=COLOURS[1])
        offset = (5, 0)
        panel.annotate(
            chance(probability), (100.0 * probability, place), offset, textcoords="offset points", va="center"
        )
    panel.axvline(0.0, color=BLACK, linewidth=0.8)
    name_rows(panel, [hypothesis(names) for names, _ in shown])
    panel.grid(axis="y", visible=False)
    panel.set(xlim=(0.0, 112.0), xticks=range(0, 101, 25))
    panel.set_xlabel("probability, %")
    return figure
