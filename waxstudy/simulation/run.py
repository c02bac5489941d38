"""Run a study: every case in every week, in threads, each finished case kept at once."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.plugin import (
    BackendMissing,
    LinearRoom,
    OutsideRoom,
    Refused,
    Room,
    SimulationError,
    Stopped,
    Weather,
    WeatherRecord,
)
from waxstudy.plugin.registry import PluginError, described, one_line, told
from waxstudy.plugin.shapes import driving_problems, physics_problems, room_problems, weather_problems
from waxstudy.results.folder import STUDY, run_folder
from waxstudy.results.kpis import WEATHER, BoolArray, Figures, MemberWeek, thinned
from waxstudy.results.run import CaseFolder, damaged, finish, what_is_wrong, writing_case
from waxstudy.simulation import ensemble, kernel
from waxstudy.simulation.budget import Needs, free_disk, free_memory
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.comfort import WEEK_H, equal_comfort
from waxstudy.simulation.engine import DAY_S, Loop, Part, Start
from waxstudy.simulation.modes import DrivenRoom, drive
from waxstudy.simulation.outside import OutsideLoop, engine_of, given_to
from waxstudy.simulation.season import heating
from waxstudy.simulation.software import software
from waxstudy.simulation.sources import component_digest, digest, source_digest
from waxstudy.study.model import Case, Choice, Season, Study, is_multiple

LOOK_S = 0.01  # between looks at what is finished
PART_STEPS = 2 * 17_280  # two days at 5 s; longer runs are reduced part by part


@dataclass
class Progress:
    """What the caller is told: warnings, the number of jobs once, then each job as it ends."""

    warn: Callable[[str], None] = lambda text: None
    total: Callable[[int], None] = lambda n: None
    done: Callable[[CaseFolder | None, bool], None] = lambda case, computed: None


@dataclass
class Plan:
    """A study made ready: rooms built, weather read, one job per case and week."""

    study: Study
    jit: bool
    driven: dict[str, DrivenRoom] = field(default_factory=dict)  # under the first weather of each week
    others: dict[str, list[DrivenRoom]] = field(default_factory=dict)  # under the others that it is drawn from
    starts: list[Start] = field(default_factory=list)
    stop: np.ndarray = field(default_factory=lambda: np.zeros(1, dtype=np.int64))

    def jobs(self) -> list[CaseFolder]:
        cases = self.study.cases
        return [CaseFolder(case, week, self.key(cases[case], week)) for case in cases for week in self.driven]

    def key(self, case: Case, week: str) -> str:
        """Digest of everything that the figures of a case depend on."""
        study, (driven, *others) = self.study, self.weathers(week)
        blocks = {kind: choice.described() for kind, choice in case.blocks.items()}
        said = (study.step_s, study.comfort, study.ensemble, study.output, blocks, study.room.described())
        used = [*case.blocks.values(), study.room]
        sources = sorted({component_digest(choice.component) for choice in used})
        numbers = [v for each in (driven, *others) for v in vars(each).values() if isinstance(v, np.ndarray)]
        room = (driven.room.floor_area_m2, driven.room.full_flow_L_h, driven.room.water_J_L_K)
        calendar = [(each.weather.interval_s, each.weather.first_day) for each in (driven, *others)]
        parts = [repr((said, room, *calendar)), source_digest(__name__), *sources]
        outside = [part for each in (driven, *others) if each.engine for part in given_to(each)]
        return digest([*parts, *(array.tobytes() for array in numbers), *outside])

    def weathers(self, week: str) -> list[DrivenRoom]:
        """Return the room under every weather of a week."""
        return [self.driven[week], *self.others.get(week, [])]


def prepare(study: Study, jit: bool = True) -> Plan:
    """Build the room, read the weather, and ask an outside engine whether it can take them.

    Raises `InputError`, `BackendMissing`, or `PluginError` for what breaks a contract.
    """
    room_class = study.room.component
    assert issubclass(room_class, Room)
    room = _named("room", partial(room_class.build, study.room.parameters))
    _keeps_its_contract("room", room_problems(room))
    _keeps_its_contract("room", physics_problems(room))
    plan = Plan(study, jit, starts=ensemble.starts(study.ensemble))
    for week in study.weeks:
        table = f"weather.{week}" if week not in study.drawn else f"ensemble.weather.{week}"
        plan.driven[week], *plan.others[week] = (_driven(study, room, week, one, table) for one in study.weathers(week))
        spans = {(each.weather.interval_s, each.weather.duration_s) for each in plan.weathers(week)}
        if len(spans) > 1:
            raise InputError(table, "its weathers are not equally long, or of different intervals")
    return plan


def _driven(study: Study, room: LinearRoom, week: str, choice: Choice, table: str) -> DrivenRoom:
    weather_class = choice.component
    assert issubclass(weather_class, Weather)
    record = _named(table, partial(weather_class.load, choice.parameters, room.facades))
    _keeps_its_contract(table, weather_problems(record, room.facades))
    for wrong in _weather_problems(record, study.step_s):
        raise InputError(table, wrong)
    # a `ValueError` says that the room asks for what this weather does not hold, such as a sky temperature
    _keeps_its_contract("room", _named(table, lambda: list(driving_problems(room, record))))
    engine = _named("room", partial(engine_of, study.room, record, study.step_s), week)
    with told("[room]"):
        driven = replace(drive(room, record, study.step_s), engine=engine)
    return replace(driven, counts=_counts(record, study.season, week))


def _counts(record: WeatherRecord, season: Season | None, week: str) -> BoolArray | None:
    try:
        return heating(record, season) if season else None
    except ValueError as error:
        raise InputError("season", f"{week}: {error}") from error


def _keeps_its_contract(table: str, problems: Iterable[str]) -> None:
    for problem in problems:
        raise PluginError(f"[{table}]: {problem}")


def _weather_problems(record: WeatherRecord, step_s: float) -> Iterator[str]:
    if not is_multiple(DAY_S, of=record.interval_s) or not is_multiple(record.interval_s, of=step_s):
        yield f"its interval of {record.interval_s:g} s must divide the day, and step_s must divide it"
    if record.duration_s < DAY_S:
        yield "it must last a day at least, for the warm-up"


class InputError(ValueError):
    """A room or weather cannot be had; `table` says which table of the study file asked for it, `key` which value."""

    def __init__(self, table: str, reason: str, key: str = "", value: object = None) -> None:
        super().__init__(reason)
        self.table, self.key, self.value = table, key, value

    @property
    def path(self) -> tuple[str, ...]:
        """The table as keys of the file; the name of a week, which comes last, may hold a point."""
        return tuple(self.table.split(".", 2 if self.table.startswith("ensemble.") else 1))


def _named(table: str, load: Callable[[], Any], week: str = "") -> Any:
    try:
        with told(f"[{table}]", ValueError, BackendMissing):
            return load()
    except Refused as error:
        at, _, key = error.key.partition(".")
        place = at if at != "weather" else f"weather.{week}" if week else table
        raise InputError(place, one_line(str(error)), key, error.value) from error
    except ValueError as error:
        raise InputError(table, one_line(str(error))) from error


def run(
    study: Study, folder: Path, *, jit: bool = True, progress: Progress | None = None, replaces: bool = False
) -> Plan:
    """Compute what is missing in the folder, or not as it was written, and finish it.

    Raises what `prepare` raises, `SimulationError` (naming case and week), `RunError` if the folder is in use,
    `OtherStudy` if it holds the results of another study's file and does not replace them, `TooLarge` for what fits
    into neither memory nor disk, `OSError`, or `KeyboardInterrupt`; what was finished before that is kept.
    """
    progress = progress or Progress()
    plan = prepare(study, jit)
    jobs = plan.jobs()
    with run_folder(folder, study.described(), study.file, replaces=replaces) as claim:
        progress.total(len(jobs))
        missing = [job for job in jobs if _is_missing(folder, job, progress)]
        needs = Needs.of(study, plan.driven, missing)
        workers = needs.workers(free_memory(), free_disk(folder), progress.warn)
        claim()  # not before it is known to fit: a run that is refused leaves the folder to its study
        _compute(plan, missing, folder, progress, workers)
        ladders, weeks = list(study.ladders.values()), list(plan.driven)
        for warning in finish(folder, study.described(), ladders, weeks, jobs, provenance(plan, jobs)):
            progress.warn(warning)
    return plan


def _is_missing(folder: Path, job: CaseFolder, progress: Progress) -> bool:
    """Whether a case is to be computed; says so of one that was there and is not as it was written."""
    path = damaged(folder, job)
    if path is None:
        progress.done(job, False)
    elif path.name != job.name or path.is_symlink():
        progress.warn(f"{path}: {what_is_wrong(path)}; {job.case}, {job.week} is computed again")
    return path is not None


def _compute(plan: Plan, jobs: Iterable[CaseFolder], folder: Path, progress: Progress, workers: int) -> None:
    """Compute the jobs in threads; on any error or Ctrl-C stop the others at their next weather interval."""
    with ThreadPoolExecutor(max_workers=workers) as pool:
        try:
            names: dict[Future[None], CaseFolder] = {}
            warned: set[str] = set()
            for job in jobs:
                loops = loops_of(plan, job)  # compiles here, so that threads only compute
                for warning in loops[0].warnings:
                    if warning not in warned:
                        progress.warn(warning)
                    warned.add(warning)
                names[pool.submit(_job, plan, job, loops, folder)] = job
            pending: set[Future[None]] = set(names)
            while pending:
                # Ctrl-C within `concurrent.futures.wait` may break its lock, and then a worker says so with a traceback
                ended = {future for future in pending if future.done()}
                pending -= ended
                if not ended:
                    time.sleep(LOOK_S)
                for future in ended:
                    future.result()
                    progress.done(names[future], True)
        except BaseException:
            plan.stop[0] = 1
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def loops_of(plan: Plan, job: CaseFolder) -> list[Loop | OutsideLoop]:
    """Return a job's case closed over the study's room, under every weather of the week."""
    case = plan.study.cases[job.case]
    return [loop_of(plan.study, case, driven, plan.jit) for driven in plan.weathers(job.week)]


def loop_of(study: Study, case: Case, driven: DrivenRoom, jit: bool = True) -> Loop | OutsideLoop:
    """Return a case closed over the study's room, whichever engine it runs on."""
    fast = Loop(Chain(case.blocks, study.step_s), driven, study.comfort.operative_limit_C, jit)
    return OutsideLoop(study.room, case, fast) if issubclass(study.room.component, OutsideRoom) else fast


def _job(plan: Plan, job: CaseFolder, loops: Sequence[Loop | OutsideLoop], folder: Path) -> None:
    with writing_case(folder, job) as case:

        def keep(trace: pd.DataFrame) -> None:
            try:
                case.trace(trace)
            except OSError as error:
                raise _NotWritten(error) from error

        try:
            told = simulate_case(plan, job, loops, keep)
        except _NotWritten as error:
            raise error.reason from None
        except (Stopped, BackendMissing, PluginError):
            raise
        except Exception as error:
            reason = str(error) if isinstance(error, SimulationError) else described(error)
            raise SimulationError(f"case {job.case}, {job.week}: {reason}") from error
        case.figures(*told)


class _NotWritten(Exception):
    """The disk refused, which is no fault of the simulation that was going on."""

    def __init__(self, reason: OSError) -> None:
        self.reason = reason


def simulate_case(
    plan: Plan, job: CaseFolder, loops: Sequence[Loop | OutsideLoop], keep: Callable[[pd.DataFrame], None]
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Solve the setpoint shift on the ensemble, then simulate every member at it: every start in every weather.

    Returns key figures and durations; traces go to `keep`, part by part.
    """
    comfort, driven = plan.study.comfort, loops[0].driven
    found = equal_comfort(comfort, loops, plan.starts, plan.stop)
    single_K = found.single_run_shifts_K(comfort.hours_below_per_week)
    kpis, spans = [], []
    for member, (number, start) in enumerate(product(range(len(loops)), range(len(plan.starts)))):
        setpoint_C = comfort.setpoint_C + found.shift_K
        figures, durations = _simulate_member(plan, loops[number], member, start, setpoint_C, keep)
        row = {"case": job.case, "week": job.week, "member": member, "setpoint_shift_K": found.shift_K}
        row |= {WEATHER: number} if len(loops) > 1 else {}
        row["heat_per_K_kWh_m2_week"] = driven.heat_W_K * WEEK_H / 1000.0 / driven.room.floor_area_m2
        kpis.append({**row, "single_run_shift_K": float(single_K[member]), **figures})
        spans.append(durations.assign(member=member))
    return pd.DataFrame(kpis), pd.concat(spans, ignore_index=True)


def _simulate_member(
    plan: Plan,
    loop: Loop | OutsideLoop,
    member: int,
    start: int,
    setpoint_C: float,
    keep: Callable[[pd.DataFrame], None],
) -> tuple[dict[str, float], pd.DataFrame]:
    """Simulate a member part by part; a member without a trace gives one of no rows, for its columns.

    Returns key figures and durations: what they are made of ends with the member, so only one lies in memory.
    """
    output, driven, figures, rows = plan.study.output, loop.driven, Figures(), 0
    intervals = part_intervals(driven, output.trace_interval_s)
    for number, simulated in enumerate(loop.parts(setpoint_C, plan.starts[start], intervals, plan.stop)):
        part = member_week(loop, simulated, setpoint_C, plan.study, number * intervals)
        figures.add(part)
        if member < output.trace_members or member == number == 0:
            kept = thinned(part, output.trace_interval_s, driven.weather.first_day, rows).assign(member=member)
            rows += len(kept)
            keep(kept if member < output.trace_members else kept[:0])
    return figures.key_figures(), figures.durations()


def part_intervals(driven: DrivenRoom, trace_interval_s: float) -> int:
    """Return of how many weather intervals a part of a run is: `PART_STEPS` at most, in whole rows of its trace."""
    steps, row = driven.steps_per_interval, round(trace_interval_s / driven.step_s)
    whole = math.lcm(steps, row) // steps
    return max(1, PART_STEPS // steps // whole) * whole


def member_week(
    loop: Loop | OutsideLoop, simulated: Part, setpoint_C: float, study: Study, first: int = 0
) -> MemberWeek:
    """Name the columns of a trace that begins with a weather interval; add supply, return and flow in their units."""
    driven, room, trace = loop.driven, loop.driven.room, simulated.trace
    columns = {name: trace[:, i] for i, name in enumerate(kernel.TRACE)}
    last = first + len(trace) // driven.steps_per_interval
    supply_C = np.repeat(driven.supply_C[first:last], driven.steps_per_interval)
    flow_L_h = columns.pop("flow_fraction") * room.full_flow_L_h
    heat_W = columns.pop("water_heat_W")
    capacity_W_K = flow_L_h / 3600.0 * room.water_J_L_K
    # where no water flows, the pipe is taken to stand at the floor's temperature
    flowing = capacity_W_K > 0.0
    return_C = np.where(flowing, supply_C - heat_W / np.where(flowing, capacity_W_K, 1.0), columns["layer_C"])
    more = {"supply_C": supply_C, "return_C": return_C, "flow_L_h": flow_L_h}
    columns |= more | {"water_heat_W_m2": heat_W / room.floor_area_m2}
    comfort, steps = study.comfort, driven.steps_per_interval
    return MemberWeek(
        columns,
        driven.step_s,
        setpoint_C,
        room.full_flow_L_h,
        comfort.setpoint_C,
        comfort.operative_limit_C,
        simulated.stored_J / 3.6e6 / room.floor_area_m2,
        None if driven.counts is None else np.repeat(driven.counts[first:last], steps),
        months(driven.weather, first, last, steps),
    )


def months(weather: WeatherRecord, first: int, last: int, steps_per_interval: int) -> dict[str, slice]:
    """Return which steps of a part, of intervals `first` to `last`, lie in which month (YYYY-MM)."""
    since_s = np.arange(first, last) * weather.interval_s
    days = np.datetime64(weather.first_day) + (since_s // DAY_S).astype("timedelta64[D]")
    names, begins = np.unique(days.astype("datetime64[M]"), return_index=True)
    ends = [*begins[1:], last - first]
    return {
        str(name): slice(begin * steps_per_interval, end * steps_per_interval)
        for name, begin, end in zip(names, begins, ends, strict=True)
    }


def provenance(plan: Plan, jobs: Iterable[CaseFolder]) -> dict[str, Any]:
    """Versions, inputs (one digest over all cases), seed and machine that the run's figures come from."""
    study = plan.study
    engines = {driven.engine for driven in plan.driven.values()} - {""}
    used = [study.room, *study.weeks.values(), *(c for case in study.cases.values() for c in case.blocks.values())]
    return {
        **software(choice.component for choice in used),
        **({"engine": ", ".join(sorted(engines))} if engines else {}),
        **({"fragments": dict(study.fragments)} if study.fragments else {}),
        "inputs": digest(job.key for job in jobs),
        "seed": study.ensemble.seed,
        "command": f"waxstudy run {STUDY}",  # of this folder: what the user's file was called is no part of a run
    }
