"""How fast the valve answers after a pause."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from waxstudy.report.content import Content
from waxstudy.report.figures.plot import Lacking, drawing, panels
from waxstudy.report.figures.style import BLACK, DASHED, GREY, legend_below, series
from waxstudy.results.kpis import ACTIVATION_LIMIT_S

TICKS_MIN = (0.5, 1, 2, 5, 10, 20, 45, 120)


@drawing(
    "12",
    "Figure 12. Full activation time against the time off before",
    "Time from the signal to full opening (solid) and to 90 % of the full flow behind the valve of the first "
    "ladder's reference case (dashed), after a long heating period and the given time off. After a short "
    "pause the valve is still open. The grey line is the limit for the reserve market.",
)
def figure_12(content: Content) -> Figure:
    """Times to full opening and to 90 % of flow [min] of every actuator; raise `Lacking` without actuators."""
    if not content.activations:
        raise Lacking("no actuator is installed")
    figure, axes = panels(1, 2, 4.3, sharey=True)
    for i, curve in enumerate(content.activations):
        look = {"label": curve.actuator, "markersize": 4.0, **series(i)}
        axes[0, 0].plot(curve.off_min, curve.opening_s / 60.0, **look)
        axes[0, 1].plot(curve.off_min, curve.flow_s / 60.0, linestyle=DASHED, **look)
    for panel, title in zip(axes[0], ("to full opening", "to 90 % of full flow"), strict=True):
        _dress(panel, title)
    axes[0, 0].set_ylabel("time from the signal, min")
    legend_below(figure, axes[0, 0])
    return figure


def _dress(panel: Axes, title: str) -> None:
    limit_min = ACTIVATION_LIMIT_S / 60.0
    panel.set(title=title, xlabel="time off before, min", xscale="log")
    panel.xaxis.set_major_locator(FixedLocator(TICKS_MIN))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    panel.xaxis.set_minor_locator(NullLocator())
    panel.axhline(limit_min, color=GREY, linewidth=2.0, zorder=1.0)
    panel.text(TICKS_MIN[0], limit_min + 0.1, f"limit {limit_min:g} min", color=BLACK, va="bottom")
