"""The figures of a report: the comparison at a glance, and eight figures of the paper redrawn from the run."""

from waxstudy.report.figures.activation import figure_12
from waxstudy.report.figures.control import figure_19
from waxstudy.report.figures.last_step import figure_22
from waxstudy.report.figures.loads import figure_21
from waxstudy.report.figures.supply import figure_b1
from waxstudy.report.figures.temperatures import figure_17, figure_18, figure_20

PAPER_FIGURES = figure_12, figure_17, figure_18, figure_19, figure_20, figure_21, figure_22, figure_b1
