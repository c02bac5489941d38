"""Print every speed and memory figure with its limit and its ratio to a reference taken in the same run."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit

from benchmarks.commands import HEADINGS, command_figure
from benchmarks.energyplus_model import house_figure
from benchmarks.fleet import fleet_figures
from benchmarks.fmu import fmu_figures
from benchmarks.imports import import_figures
from benchmarks.long import long_figures
from benchmarks.sweep import sweep_figure
from benchmarks.timing import best_s
from waxstudy.loop import figures as of_loop
from waxstudy.plugin import Actuator
from waxstudy.plugin.registry import installed
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.engine import Loop, Start
from waxstudy.simulation.lanes import LANES
from waxstudy.simulation.modes import DrivenRoom
from waxstudy.simulation.run import Plan, loops_of, prepare
from waxstudy.study.model import Choice, Study
from waxstudy.study.read import read_study

STUDY = Path(__file__).parents[1] / "studies" / "table5.toml"


@njit(error_model="python")
def _hand_written(readings, setpoint, dt):  # type: ignore[no-untyped-def]
    """The most detailed On/Off chain written by hand in one function: the reference for the loop's own cost."""
    ring, head, on, phase, opening, total = np.full(24, readings[0]), 0, False, 0.0, 0.0, 0.0
    signal = False
    for n in range(len(readings)):
        u, ring[head] = ring[head], readings[n]
        head = (head + 1) % 24
        error = setpoint - u
        if error > 0.25:
            on = True
        elif error < -0.25:
            on = False
        if on != signal:
            signal, phase = on, 0.0
        phase += dt
        if signal:
            opening = min(1.0, opening + max(0.0, min(dt, phase - 150.0)) / 146.0)
        else:
            opening = max(0.0, opening - max(0.0, min(dt, phase - 110.0)) / 123.0)
        flow = 0.0
        if opening > 0.17:
            flow = 0.5 * (opening - 0.17) / 0.24 if opening < 0.41 else 0.5 + 0.5 * (opening - 0.41) / 0.59
            flow = flow / np.sqrt(flow * flow * 0.9033 + 0.0967)
        total += flow
    return total


def _one_week(loop: Loop) -> None:
    list(loop.weeks(21.0, [Start(0.0, 0.0)]))


def chain_only(driven: DrivenRoom) -> DrivenRoom:
    """The same loop over a room of as few modes as it takes: what the chain and the loop cost without the room."""
    one = {name: np.ascontiguousarray(getattr(driven, name)[:LANES]) for name in ("decay", "heat_gain", "to_modes")}
    wide = {name: np.ascontiguousarray(getattr(driven, name)[:, :LANES]) for name in ("forcing", "outputs")}
    return DrivenRoom(**{**driven.__dict__, **one, **wide})


def loop_figures(study: Study, driven: DrivenRoom) -> None:
    n_steps = len(driven.supply_C) * driven.steps_per_interval + 7 * 17280
    readings = 21.0 + 0.5 * np.sin(np.arange(n_steps) / 400.0)
    reference = best_s(lambda: _hand_written(readings, 21.0, 5.0)) / n_steps * 1e9
    print(f"\nreference: O_WM's chain by hand in one function, no room: {reference:.1f} ns per step")
    print(f"{'chain':23} {'ns':>7} {'ratio':>6} {'with room ns':>13} {'ratio':>6}   limit 40 ns for a case's chain")
    bare = chain_only(driven)
    for label, blocks in chains(study):
        chain = Chain(blocks, study.step_s)
        alone, full = (best_s(partial(_one_week, Loop(chain, room, 21.0))) / n_steps * 1e9 for room in (bare, driven))
        print(f"{label:23} {alone:7.1f} {alone / reference:6.2f} {full:13.1f} {full / reference:6.2f}")


class InPython(Actuator):
    """An ideal actuator that cannot be compiled: what a call back into Python costs."""

    name = "in-python"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return float({"opening": u, 1: dt}["opening"])


def chains(study: Study) -> Iterator[tuple[str, Mapping[str, Choice]]]:
    """Every case's chain, then O_WM's with each other installed actuator in place of its own."""
    yield from ((case.id, case.blocks) for case in study.cases.values())
    blocks = study.cases["O_WM"].blocks
    others = [installed().get("actuator", name) for name in installed().names("actuator")]
    for actuator in (*others, InPython):
        if actuator is not blocks["actuator"].component:
            yield f"O_WM, {actuator.name}", {**blocks, "actuator": Choice(actuator, actuator.Parameters())}


def year_figure(study: Study, driven: DrivenRoom) -> None:
    """A year of O_WM: the week's weather 52 times over, without the warm-up's share."""
    weeks = 52
    long = DrivenRoom(
        **{
            **driven.__dict__,
            "forcing": np.tile(driven.forcing, (weeks, 1)),
            "offsets": np.tile(driven.offsets, (weeks, 1)),
            "supply_C": np.tile(driven.supply_C, weeks),
        }
    )
    loop = Loop(Chain(study.cases["O_WM"].blocks, study.step_s), long, 21.0)
    print(f"\na year of O_WM at 5 s, in process: {best_s(partial(_one_week, loop)):.2f} s (limit 0.5 s)")


def tuning_figure(study: Study, plan: Plan) -> None:
    """What an evaluation of a tuning costs, beside the ensemble's weeks alone."""
    job = next(job for job in plan.jobs() if (job.case, job.week) == ("P_WM", "january"))
    loops = loops_of(plan, job)
    evaluation = best_s(lambda: of_loop.loop_figures(plan, job, loops))
    weeks = best_s(lambda: list(loops[0].weeks(study.comfort.setpoint_C, plan.starts)))
    told = f"{evaluation:.2f} s (limit 2 s), {evaluation / weeks:.1f} times its weeks alone"
    print(f"\nan evaluation of a tuning (P_WM, January, {len(plan.starts)} members at 5 s): {told}")


def command_figures(folder: Path) -> None:
    one = folder / "one.toml"
    one.write_text(STUDY.read_text().replace("members = 16", "members = 1"))
    cold = {"WAXSTUDY_CACHE": str(folder / "cache")}
    print(f"\nwhole commands\n{HEADINGS}          limits; 500 MB for each")
    nothing = min(command_figure("waxstudy --help", ["--help"], "0.25 s").wall_s for _ in range(3))
    command_figure("1 member, first since the last change", ["run", str(one), "--out", str(folder / "0")], "")
    command_figure("1 member, warm", ["run", str(one), "--out", str(folder / "1")], "3 s")
    full = command_figure("16 members, warm", ["run", str(STUDY), "--out", str(folder / "16")], "20 s")
    first = command_figure("16 members, first run ever", ["run", str(STUDY), "--out", str(folder / "f")], "", cold)
    compiling_s, ratio = first.wall_s - full.wall_s, full.wall_s / nothing
    print(f"{'':40} {compiling_s:+6.2f} s for compiling (limit 15 s); help to full run 1 : {ratio:.0f}")
    command_figure("16 members, nothing to compute", ["run", str(STUDY), "--out", str(folder / "16")], "")
    for form in ("table", "html"):
        arguments = ["report", str(folder / "16"), "--format", form, "--against", "paper"]
        command_figure(f"report --format {form} --against paper", arguments, "")


def main() -> None:
    study = read_study(STUDY, installed())
    plan = prepare(study)
    driven = plan.driven["january"]
    print(f"room: {len(driven.room.nodes)} nodes, {len(driven.decay)} modes kept, error {driven.dropped_error_K:.1g} K")
    loop_figures(study, driven)
    year_figure(study, driven)
    tuning_figure(study, plan)
    fleet_figures(_hand_written)
    folder = Path(tempfile.mkdtemp())
    try:
        fmu_figures(folder)
        house_figure(folder)
        command_figures(folder)
        import_figures(folder)
        sweep_figure(folder)
        long_figures(folder)
    finally:
        shutil.rmtree(folder)


main()
