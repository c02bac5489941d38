"""The figures of fits: the paper's figures 9 to 14 of an actuator, 15 and 16 of a valve."""

from waxstudy.report.identification.figures.cycles import figure_cut_offs, figure_periods
from waxstudy.report.identification.figures.errors import figure_errors, figure_hours
from waxstudy.report.identification.figures.flow import figure_curve, figure_cycle
from waxstudy.report.identification.figures.times import figure_activation, figure_residuals, figure_times

OF_TIMES = figure_times, figure_residuals, figure_activation
ACTUATOR_FIGURES = figure_periods, figure_cut_offs, *OF_TIMES, figure_errors, figure_hours
VALVE_FIGURES = figure_cycle, figure_curve
