"""The figures of a diagnosis: where the gap lies, what explains it, how far it shrinks."""

from waxstudy.report.diagnosis.figures.departures import figure_departures
from waxstudy.report.diagnosis.figures.gap_map import figure_gap_map
from waxstudy.report.diagnosis.figures.missing_heat import figure_missing_heat
from waxstudy.report.diagnosis.figures.neighbours import figure_neighbours
from waxstudy.report.diagnosis.figures.posterior import figure_posterior
from waxstudy.report.diagnosis.figures.ranking import figure_ranking
from waxstudy.report.diagnosis.figures.record import figure_record
from waxstudy.report.diagnosis.figures.switchings import figure_switchings
from waxstudy.report.diagnosis.figures.traces import figure_traces
from waxstudy.report.diagnosis.figures.waterfall import figure_waterfall

FIGURES = (
    figure_gap_map,
    figure_switchings,
    figure_traces,
    figure_missing_heat,
    figure_neighbours,
    figure_ranking,
    figure_waterfall,
    figure_record,
    figure_departures,
    figure_posterior,
)
