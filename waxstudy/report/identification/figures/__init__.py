"""The figures of fits: the paper's figures 9 to 14 of an actuator, 15 and 16 of a valve."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

from waxstudy.identification.result import ActuatorFit
from waxstudy.identification.valve import ValveFit
from waxstudy.report.identification.figures import cycles, errors, flow, times

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["ACTUATOR_FIGURES", "VALVE_FIGURES", "Plot"]

Shown = TypeVar("Shown")


@dataclass(frozen=True)
class Plot(Generic[Shown]):
    """A figure with its words; `draw` raises `Lacking` where the fit lacks what it needs."""

    id: str
    number: str  # of the paper's figure
    title: str
    caption: str
    draw: Callable[[Shown], Figure]


ACTUATOR_FIGURES: Sequence[Plot[ActuatorFit]] = (
    Plot("periods", "9", cycles.PERIODS, cycles.PERIODS_CAPTION, cycles.figure_periods),
    Plot("cut-offs", "10", cycles.CUT_OFFS, cycles.CUT_OFFS_CAPTION, cycles.figure_cut_offs),
    Plot("times", "11", times.TIMES_TITLE, times.TIMES_CAPTION, times.figure_times),
    Plot("residuals", "", times.RESIDUALS, times.RESIDUALS_CAPTION, times.figure_residuals),
    Plot("activation", "12", times.ACTIVATION, times.ACTIVATION_CAPTION, times.figure_activation),
    Plot("errors", "13", errors.ERRORS, errors.ERRORS_CAPTION, errors.figure_errors),
    Plot("hours", "14", errors.HOURS, errors.HOURS_CAPTION, errors.figure_hours),
)
VALVE_FIGURES: Sequence[Plot[ValveFit]] = (
    Plot("cycle", "15", flow.CYCLE, flow.CYCLE_CAPTION, flow.figure_cycle),
    Plot("curve", "16", flow.CURVE, flow.CURVE_CAPTION, flow.figure_curve),
)
