"""The pages of fits: one self-contained HTML file each."""

from __future__ import annotations

from waxstudy.identification.result import ActuatorFit
from waxstudy.identification.valve import ValveFit
from waxstudy.report.figures.plot import plots
from waxstudy.report.html import filled
from waxstudy.report.identification import tables
from waxstudy.report.identification.figures import ACTUATOR_FIGURES, VALVE_FIGURES
from waxstudy.report.words import counted
from waxstudy.version import __version__


def actuator_page(found: ActuatorFit) -> str:
    """Return the page of an actuator's fit."""
    kept = int((found.cycles["lost"] == "").sum())
    products = ", ".join(found.model.products)
    return filled(
        "actuator.html.j2",
        title=f"Characteristic times of {products}",
        simulated=tables.SIMULATED if found.is_simulated else "",
        summary=f"Used: {counted(kept, 'cycle')} of {len(found.cycles)} in {counted(len(found.records), 'record')}.",
        untold=found.model.untold(),
        tables=tables.actuator_tables(found),
        figures=plots(ACTUATOR_FIGURES, found),
        steps=[step for time in found.model.times.values() for step in time.steps],
        warnings=[*tables.scatter(found), *found.warnings],
        sources=[(record.file, record.sha256) for record in found.records],
        version=__version__,
    )


def valve_page(found: ValveFit) -> str:
    """Return the page of a valve's fit."""
    return filled(
        "valve.html.j2",
        title=f"Valve curve from {found.record.name}",
        simulated=tables.SIMULATED if found.is_simulated else "",
        summary=f"Mean absolute error {100.0 * found.mae:.2f} % of full flow; authority {found.how_authority}.",
        untold=[],
        tables=tables.valve_tables(found),
        figures=plots(VALVE_FIGURES, found),
        steps=[],
        warnings=found.warnings,
        sources=[(found.record.file, found.record.sha256)],
        version=__version__,
    )
