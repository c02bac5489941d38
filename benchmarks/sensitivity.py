"""Run the paper's study with one choice changed at a time and print the tables of docs/choices.md.

`python -m benchmarks.sensitivity [GROUP ...]` prints two tables for each group of choices: what happens to Table 5,
and to the figures that the findings rest on. All groups together take about ten minutes.
"""

from __future__ import annotations

import argparse
import copy
import shutil
import tempfile
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from waxstudy.plugin.registry import installed
from waxstudy.report.comparison import differences_percent
from waxstudy.report.content import Content, gather
from waxstudy.results.run import Run
from waxstudy.simulation.run import run
from waxstudy.study.read import read_study

STUDY = Path(__file__).parents[1] / "studies" / "table5.toml"
MEMBERS = 8
WEEKS = ("january", "february")
DAYS = range(1, 8)
PAIRS, CHOSEN_PAIR = ((2, 5), (3, 5), (3, 6), (1, 4), (4, 6)), (2, 5)
COLUMNS, DIFFERENCE = ("setpoint_shift_K", "mae_K", "heat_kWh_m2_week"), "heat_vs_most_detailed_percent"

# what is changed: a key of the study file, or of a case by its id, with dots between tables
Changes = Mapping[str, Any]


def days(*sunny: int) -> list[float]:
    """Equal sun on the named days of the week, none on the others."""
    return [float(day in sunny) for day in DAYS]


def february_sun(*sunny: int) -> Changes:
    return {"weather.february.sun_by_day": days(*sunny)}


def named(*sunny: int) -> str:
    return f"days {', '.join(map(str, sunny))}"


def weather(**values: Any) -> Changes:
    """The same parameters in both weeks."""
    return {f"weather.{week}.{key}": value for week in WEEKS for key, value in values.items()}


def wax_motor(**values: Any) -> Changes:
    """Another actuator in both most detailed cases."""
    return {f"{case}.actuator": values for case in ("O_WM", "P_WM")}


CONDUCTING = {"room.screed": {"conductivity_W_mK": 1.8, "density_kg_m3": 2000.0, "heat_capacity_J_kgK": 1000.0}}
UNFURNISHED = {"room.air_capacity_multiplier": 1.0}
LIVELY = {**UNFURNISHED, **CONDUCTING}
COLDER = {"room.circuit.heating_curve_C": [[-22.0, 32.0], [20.0, 20.0]]}
HALF_GAIN = {"P_CP.controller.gain": 9.0}
ALL_OF_G = weather(counted_share=1.0)
STEADY = {
    **weather(noise_K=0.0, swing_overcast_K=0.0, swing_clear_K=0.0, clear_sky_colder_K=0.0),
    **weather(overcast_transmittance=0.0, solar_gain_kWh_m2_week=1e-6),
    "room.gains.schedule": [1.0] * 24,
}

GROUPS: Mapping[str, Mapping[str, Changes]] = {
    "chain": {
        "dead_band_K 4.0 and 1.0": {"O_0.controller.dead_band_K": 4.0, "O_CP.controller.dead_band_K": 1.0},
        "min_pulse_s 0": {"P_MC.modulator.min_pulse_s": 0.0},
        "min_pulse_s 180": {"P_MC.modulator.min_pulse_s": 180.0},
        "min_pulse_s 600": {"P_MC.modulator.min_pulse_s": 600.0},
        "B minus its spread": wax_motor(use="variable-times", product="B", dead_b_s=206.0, rise_b_s=121.0),
        "B without spread": wax_motor(use="variable-times", product="B", dead_b_s=219.0, rise_b_s=142.0),
        "form literal": wax_motor(use="variable-times", product="B", form="literal"),
        "constant-times": wax_motor(use="constant-times", product="B"),
    },
    "room": {
        "facade_m 2.6 south, 4.0 west": {"room.facade_m": {"south": 2.6, "west": 4.0}},
        "height_m 2.4": {"room.height_m": 2.4},
        "height_m 2.8": {"room.height_m": 2.8},
        "ceiling outdoors": {"room.ceiling": "outdoors"},
        "window_height_m 2.0, sill 0.3": {"room.window_height_m": 2.0, "room.window_sill_m": 0.3},
        "window_secondary_share 0.3": {"room.window_secondary_share": 0.3},
        "sun.air_share 0.3": {"room.sun.air_share": 0.3},
        "sun.floor_share 0.3": {"room.sun.floor_share": 0.3},
        "films.floor_W_m2K 4.2": {"room.films.floor_W_m2K": 4.2},
        "films.wall_W_m2K 3.5": {"room.films.wall_W_m2K": 3.5},
        "partition_gypsum_m 0.026": {"room.partition_gypsum_m": 0.026},
        "concrete_m 0.1": {"room.concrete_m": 0.1},
        "screed_below_m 0.04": {"room.screed_below_m": 0.04},
        "air_capacity_multiplier 6": {"room.air_capacity_multiplier": 6.0},
        "gains.schedule flat": {"room.gains.schedule": [1.0] * 24},
        "gains.radiant_share 0.4": {"room.gains.radiant_share": 0.4},
        "sensor_radiant_share 0.3": {"room.sensing.sensor_radiant_share": 0.3},
    },
    "circuit": {
        "heating curve 2 K warmer": {"room.circuit.heating_curve_C": [[-22.0, 36.0], [20.0, 24.0]]},
        "heating curve 2 K colder": COLDER,
        "exchange pipe": {"room.circuit.exchange": "pipe"},
        "full_flow_L_h 171 (40 % more)": {"room.circuit.full_flow_L_h": 171.3},
        "nominal_output_W_m2 48.6 (68 / 1.4)": {"room.circuit.nominal_output_W_m2": 48.6},
    },
    "weather": {
        "noise_K 0": weather(noise_K=0.0),
        "clear_sky_colder_K 0": weather(clear_sky_colder_K=0.0),
        "counted_share 1": ALL_OF_G,
        "January: all days alike": {"weather.january.sun_by_day": [1.0] * 7},
        "January: days 2, 6": {"weather.january.sun_by_day": days(2, 6)},
    },
    "seed": {f"seed {seed}": weather(seed=seed) for seed in (2, 3, 4, 5)},
    "members": {f"[ensemble] seed {seed}": {"ensemble.seed": seed} for seed in (2, 3)},
    "pairs": {named(*pair): february_sun(*pair) for pair in PAIRS if pair != CHOSEN_PAIR},
    "pairs, counted_share 1": {named(*pair): {**ALL_OF_G, **february_sun(*pair)} for pair in PAIRS},
    "more sunny days": {named(*sunny): february_sun(*sunny) for sunny in ((1, 3, 5), (2, 4, 6), DAYS)},
    "loop": {
        "air_capacity_multiplier 1": UNFURNISHED,
        "screed 1.8 W/mK": CONDUCTING,
        "both": LIVELY,
        "both, heating curve 2 K colder": {**LIVELY, **COLDER},
        "both, adapted gain 9": {**LIVELY, **HALF_GAIN},
        "steady weather": STEADY,
        "steady weather, both": {**STEADY, **LIVELY},
        "steady weather, adapted gain 9": {**STEADY, **HALF_GAIN},
    },
}


# --- the figures that the findings rest on: January and February, or one of them -------------------------

Figure = Callable[[Run], Sequence[float]]


def difference(case: str, reference: str) -> Figure:
    return lambda run: [float(np.mean(differences_percent(run.kpis, case, reference, week))) for week in WEEKS]


def step(column: str, simpler: str, case: str, weeks: Sequence[str] = WEEKS) -> Figure:
    def of(run: Run) -> Sequence[float]:
        mean = run.kpis.groupby(["case", "week"])[column].mean().to_dict()
        return [mean[case, week] - mean[simpler, week] for week in weeks]

    return of


def warm_share(run: Run) -> Sequence[float]:
    shares = run.kpis.groupby("week")["over_setpoint_1K_share"].mean()
    return [100.0 * float(shares["february"])]


def lowest_peak_C(run: Run) -> Sequence[float]:
    """Highest operative temperature of February, in the calmest case."""
    peaks = run.kpis.groupby(["week", "case"])["operative_max_C"].mean()
    return [float(peaks["february"].min())]


def near_a_quarter(run: Run) -> Sequence[float]:
    """Share of January in which the flow of P_CP lies within ten points of a quarter [%]."""
    fraction = run.durations("P_CP", "january")["flow_L_h"] / run.kpis["full_flow_L_h"].iloc[0]
    return [100.0 * float(fraction.between(0.15, 0.35).mean())]


def period_h(run: Run) -> Sequence[float]:
    """Mean time between rises of the flow of P_CP over its mean in January, first member."""
    flow = run.traces("P_CP", "january")["flow_L_h"].to_numpy()
    above = flow > flow.mean()
    return [168.0 / max(1, int(np.sum(above[1:] & ~above[:-1])))]


def return_step(simpler: str, case: str) -> Figure:
    def mean_C(run: Run, name: str) -> float:
        return float(run.durations(name, "january")["return_C"].mean())

    return lambda run: [mean_C(run, case) - mean_C(run, simpler)]


JUDGED: Mapping[str, Figure] = {
    "F1 difference of O_VC, %": difference("O_VC", "O_WM"),
    "F1 difference of P_MC, %": difference("P_MC", "P_WM"),
    "F2 difference of O_0, %": difference("O_0", "O_WM"),
    "F3 difference of P_0, %": difference("P_0", "P_WM"),
    "F4 difference of P_CP, %": difference("P_CP", "P_WM"),
    "F5 O_CP to O_D, MAE, K": step("mae_K", "O_CP", "O_D"),
    "F5 P_D to P_VC, MAE, K": step("mae_K", "P_D", "P_VC"),
    "F5 P_D to P_VC, shift, K": step("setpoint_shift_K", "P_D", "P_VC"),
    "F6 O_WM to P_WM, MAE, K": step("mae_K", "O_WM", "P_WM"),
    "F10 February over 22 C, %": warm_share,
    "F10 peak of the calmest case, C": lowest_peak_C,
    "F11 O_VC to O_WM, MAE, K": step("mae_K", "O_VC", "O_WM", ["february"]),
    "F11 P_MC to P_WM, MAE, K": step("mae_K", "P_MC", "P_WM", ["february"]),
    "F12 O_WM over P_WM, %": difference("O_WM", "P_WM"),
    "F15 P_CP near a quarter, %": near_a_quarter,
    "F15 period of P_CP, h": period_h,
    "F16 O_VC to O_WM, return, K": return_step("O_VC", "O_WM"),
    "F16 P_MC to P_WM, return, K": return_step("P_MC", "P_WM"),
}


# --- runs ---------------------------------------------------------------------------------------------------


class Outcome:
    """What is kept of a run: means of Table 5's columns by week, scores, judged figures and verdicts."""

    def __init__(self, content: Content) -> None:
        assert content.against
        self.means = {
            (column, week): float(np.mean([getattr(row, column).mean for row in content.rows if row.week == week]))
            for column in COLUMNS
            for week in WEEKS
        }
        self.rmse = {(score.column, score.week): score.rmse for score in content.against.scores}
        self.judged = {name: figure(content.run) for name, figure in JUDGED.items()}
        self.findings = content.against.findings

    def with_verdict(self, verdict: str) -> str:
        return " ".join(finding.id for finding in self.findings if finding.verdict == verdict)


def changed(values: Mapping[str, Any], changes: Changes) -> dict[str, Any]:
    """Return the study with other values at the given keys."""
    study = copy.deepcopy(dict(values))
    cases = [case for ladder in study["ladder"].values() for case in (ladder["start"], *ladder["steps"])]
    tables = study | {case["id"]: case for case in cases}
    for path, value in changes.items():
        *parents, key = path.split(".")
        table = tables
        for name in parents:
            table = table.setdefault(name, {})
        table[key] = value
    return study


def outcome(values: Mapping[str, Any], folder: Path) -> Outcome:
    """Run a study into a folder; what the folder holds already is not computed again."""
    study_file = folder.with_suffix(".toml")
    study_file.write_text(tomli_w.dumps(values))
    study = read_study(study_file, installed())
    run(study, folder)
    return Outcome(gather(Run(folder), study, "paper"))


def outcomes(place: Path, groups: Sequence[str]) -> Iterator[tuple[str, dict[str, Outcome]]]:
    values = changed(tomllib.loads(STUDY.read_text()), {"ensemble.members": MEMBERS})
    found = {"as chosen": outcome(values, place / "chosen")}
    for group in groups:
        for name, changes in GROUPS[group].items():
            shutil.copytree(place / "chosen", place / "changed")
            found[name] = outcome(changed(values, changes), place / "changed")
            shutil.rmtree(place / "changed")
        yield group, found
        found = {"as chosen": found["as chosen"]}


# --- tables ---------------------------------------------------------------------------------------------------


def table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    for cells in (headings, ["---"] * len(headings), *rows):
        print(f"| {' | '.join(cells)} |")
    print()


def pair(values: Sequence[float], form: str = "+.3f") -> str:
    return " / ".join(format(value, form) for value in values)


def effects(found: Mapping[str, Outcome]) -> None:
    """Changes of the mean over the eleven cases, January / February, and how Table 5 agrees then."""
    chosen, rows = found["as chosen"], []
    for name, one in found.items():
        moves = [pair([one.means[c, week] - chosen.means[c, week] for week in WEEKS]) for c in COLUMNS]
        rmse = [pair([one.rmse[c, week] for week in WEEKS], ".3f") for c in (*COLUMNS, DIFFERENCE)]
        rows.append([name, *moves, *rmse, one.with_verdict("not held"), one.with_verdict("held")])
    units = ["shift, K", "MAE, K", "heat, kWh/m²"]
    table(["choice", *units, *(f"RMSE of {unit}" for unit in (*units, "difference, %")), "not held", "held"], rows)


def judged(found: Mapping[str, Outcome]) -> None:
    """The figures that the findings rest on, January / February, and their standard deviation over the columns."""
    rows = []
    for name in JUDGED:
        figures = [one.judged[name] for one in found.values()]
        spread = np.std(figures, axis=0, ddof=1)
        rows.append([name, *(pair(figure, ".3f") for figure in figures), pair(spread, ".3f")])
    table(["figure", *found, "sd"], rows)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.sensitivity", description=__doc__)
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=f"of {', '.join(GROUPS)}; all if none is given")
    groups = parser.parse_args().groups or list(GROUPS)
    if unknown := [group for group in groups if group not in GROUPS]:
        parser.error(f"no such group: {', '.join(unknown)}")
    with tempfile.TemporaryDirectory() as place:
        for group, found in outcomes(Path(place), groups):
            print(f"## {group}\n", flush=True)
            effects(found)
            judged(found)


if __name__ == "__main__":
    main()
