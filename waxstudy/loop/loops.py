"""The loops of a study: each case in each week, linearised where its members work, with its wear."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.loop.figures import loop_figures
from waxstudy.loop.linear import LinearLoop, linearised, minimum_duty
from waxstudy.loop.response import NotLinear
from waxstudy.plugin import SimulationError, Stopped
from waxstudy.plugin.registry import PluginError, described
from waxstudy.simulation.outside import OutsideLoop
from waxstudy.simulation.run import Plan, Progress, loops_of, prepare
from waxstudy.study.model import Case, Study


@dataclass(frozen=True)
class LoopRow:
    """One case in one week; NaN is what it has not, and `why` says the reason."""

    case: str
    week: str
    gain_margin: float
    phase_margin_deg: float
    limit_gain: float  # 1/K; with its other parameters as they are
    limit_period_h: float
    ultimate_gain: float  # 1/K; of a proportional controller in its place
    ultimate_period_h: float
    output: float  # at which the loop is linearised
    minimum_duty: float
    switches_per_day: float
    strokes_per_day: float
    why: str = ""
    loop: LinearLoop | None = None

    @property
    def is_stable(self) -> bool | None:
        """Whether it is, None where the loop has no margins."""
        margins = self.loop.margins if self.loop else None
        return None if margins is None else margins.is_stable


def loops(study: Study, cases: Sequence[str], weeks: Sequence[str], told: Progress, jit: bool = True) -> list[LoopRow]:
    """Return a row for each of these cases and weeks; raise what `prepare` raises and `SimulationError`."""
    plan = prepare(study, jit)
    jobs = [job for job in plan.jobs() if job.case in cases and job.week in weeks]
    told.total(len(jobs))
    return list(_rows(plan, [(job.case, job.week) for job in jobs], told))


def _rows(plan: Plan, wanted: Sequence[tuple[str, str]], told: Progress) -> Iterator[LoopRow]:
    for job in (job for job in plan.jobs() if (job.case, job.week) in wanted):
        try:
            of_weathers = loops_of(plan, job)
            figures = loop_figures(plan, job, of_weathers).mean(numeric_only=True)
            if any(isinstance(each, OutsideLoop) for each in of_weathers):
                told.warn(f"{job.case}, {job.week}: the linear stand-in of the room is linearised, not its engine")
            yield _row(plan, job.case, job.week, {name: float(figures[name]) for name in figures.index})
        except (Stopped, PluginError):
            raise
        except Exception as error:
            reason = str(error) if isinstance(error, SimulationError) else described(error)
            raise SimulationError(f"case {job.case}, {job.week}: {reason}") from error
        told.done(job, True)


def _row(plan: Plan, case_id: str, week: str, at: dict[str, float]) -> LoopRow:
    case, driven = plan.study.cases[case_id], plan.driven[week]
    loop, why, duty = None, "", np.nan
    try:
        loop = linearised(case, driven, at["conductance_W_K"], at["drop_K"])
        why = "" if loop.controller else f"its controller '{case.blocks['controller'].component.name}' switches"
        duty = minimum_duty(case, driven) if loop.controller else np.nan
    except NotLinear as error:
        why = str(error)
    margins, ultimate = (loop.margins, loop.ultimate) if loop else (None, None)
    gain, period_s = ultimate or (np.nan, np.nan)
    return LoopRow(
        case=case_id,
        week=week,
        gain_margin=margins.gain if margins else np.nan,
        phase_margin_deg=margins.phase_deg if margins else np.nan,
        limit_gain=margins.gain * _gain(case) if margins else np.nan,
        limit_period_h=margins.period_s / 3600.0 if margins else np.nan,
        ultimate_gain=gain,
        ultimate_period_h=period_s / 3600.0,
        output=loop.emission.output if loop else np.nan,
        minimum_duty=duty,
        switches_per_day=at["switches_per_day"],
        strokes_per_day=at["strokes_per_day"],
        why=why,
        loop=loop,
    )


def _gain(case: Case) -> float:
    """Return the gain that the case's controller has, NaN where it declares none."""
    controller = case.blocks["controller"]
    name = getattr(controller.component, "gain", "")
    return float(getattr(controller.parameters, name)) if name else np.nan
