"""The pages of fits: one self-contained HTML file each."""

from __future__ import annotations

from waxstudy import __version__
from waxstudy.identification.result import ActuatorFit
from waxstudy.identification.valve import ValveFit
from waxstudy.report.figures.plot import plots
from waxstudy.report.html import filled
from waxstudy.report.identification import tables
from waxstudy.report.identification.figures import ACTUATOR_FIGURES, VALVE_FIGURES
from waxstudy.report.words import counted


def actuator_page(found: ActuatorFit) -> str:
    """Return the page of an actuator's fit."""
    kept = int((found.cycles["lost"] == "").sum())
    products = ", ".join(found.model.products)
    return filled(
        "identification.html.j2",
        title=f"Characteristic times of {products}",
        simulated=tables.SIMULATED if found.is_simulated else "",
        summary=f"Used: {counted(kept, 'cycle')} of {len(found.cycles)} in {counted(len(found.records), 'record')}.",
        untold=found.model.untold(),
        tables=tables.actuator_tables(found),
        figures=plots(ACTUATOR_FIGURES, found),
        steps=[step for time in found.model.times.values() for step in time.steps],
        warnings=[*tables.scatter(found), *found.warnings],
        sources=[(record.file, record.sha256) for record in found.records],
        reading=ACTUATOR_READING,
        version=__version__,
    )


def valve_page(found: ValveFit) -> str:
    """Return the page of a valve's fit."""
    return filled(
        "identification.html.j2",
        title=f"Valve curve from {found.record.name}",
        simulated=tables.SIMULATED if found.is_simulated else "",
        summary=f"Mean absolute error {100.0 * found.mae:.2f} % of full flow; authority {found.how_authority}.",
        untold=[],
        tables=tables.valve_tables(found),
        figures=plots(VALVE_FIGURES, found),
        steps=[],
        warnings=found.warnings,
        sources=[(found.record.file, found.record.sha256)],
        reading=VALVE_READING,
        version=__version__,
    )


ACTUATOR_READING = (
    "A time is a f + b: f = exp(-t/tau) with the undercooling time t before, for dead and rise time; f = 1 - "
    "exp(-t/tau) with the overheating time t, for hold time. The fall time is constant.",
    "p-values are those of an ordinary linear model with tau taken as known, as in the paper; there cycles count as "
    "independent.",
    "Intervals are 95 % intervals. For each of 600 repetitions every exemplar and every record gets another "
    "deviation, drawn with the scatter that was seen among them (and with how well that scatter is known), cycles "
    "another residual, and the whole fit, tau included, is made again.",
    "“Not bounded”: the resampled tau reaches the end of what was searched (20 to 7200 s).",
    "Cycles are left out where the valve does not fully open (90 %) or close (5 %), where a gap lies, or where a "
    "time is missing; a record of which less than half of the cycles remain is left out as a whole.",
)
VALVE_READING = (
    "The opening is that of the actuator's model, driven by the signal. Openings below 0.05 and above 0.95 are "
    "excluded.",
    "“Pace” is a factor on all times of the model, for this exemplar; the paper has none.",
    "Intervals are 95 % intervals of 100 fits to resampled whole cycles; they do not hold what is wrong with the "
    "actuator's model.",
)
