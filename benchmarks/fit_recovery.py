"""How well fits recover what the virtual bench was given: `python -m benchmarks.fit_recovery [--repetitions 100]`.

Each repetition makes the records of Table A1 anew: other exemplars, records, cycles and noise. Four tables: the
coefficients of Table 2 and how often their intervals hold them; times of profiles that were not fitted; the valve's
curve; and the error of the opening on records of another physics, the enthalpy model. Nothing here was measured: it
shows the method, not motors.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.dataset.notes import Notes
from waxstudy.identification.actuator import TIMES
from waxstudy.identification.description import Described
from waxstudy.identification.flow import FlowRecord
from waxstudy.identification.fragment import actuator_block
from waxstudy.identification.performance import block
from waxstudy.identification.records import Record, record_of, samples_of
from waxstudy.identification.result import ActuatorFit, fit
from waxstudy.identification.times import cycles_of
from waxstudy.identification.valve import authority_of, fit_valve
from waxstudy.rig.bench import Motors, run_trial
from waxstudy.rig.instruments import Bench
from waxstudy.rig.programme import Trial, table_a1

# MAE and RMSE of the paper's model against real motors, by the names of our records (Table A1)
PUBLISHED = {
    "A1_15-45": (0.014, 0.042),
    "A1_15-15": (0.018, 0.047),
    "A1_5-5": (0.058, 0.089),
    "A1v_15-15": (0.011, 0.019),
    "B1_15-45": (0.023, 0.047),
    "B1_30-30": (0.020, 0.037),
    "B1_10-10": (0.045, 0.097),
    "B1_18-6": (0.033, 0.050),
    "B1_15-15": (0.048, 0.079),
    "B1_3-3": (0.098, 0.122),
    "B2_15-15": (0.028, 0.048),
    "B1v_15-15": (0.061, 0.153),
    "B2v_15-15": (0.025, 0.042),
    "B2v_15-45": (0.019, 0.036),
    "B3v_15-15": (0.030, 0.056),
    "B4v_15-15": (0.058, 0.106),
    "B4v_5to15-5to15": (0.086, 0.148),
    "B4v_15-45": (0.043, 0.090),
}
NEW_MIN = ((12.0, 20.0), (20.0, 60.0), (14.0, 9.0), (25.0, 12.0))  # profiles that Table A1 does not have
CURVE = {"h_min": 0.17, "h_mid": 0.41, "v_mid": 0.50, "authority": 2.9 / 30.0}


def recorded(motors: Motors, trial: Trial) -> Record:
    """Return a record of the bench as the fit reads it."""
    made, notes = run_trial(motors, trial), Notes(trial.name)
    samples = samples_of(made.time_s, made.signal_V, made.value, "mm", notes)
    known = Described(
        Path(f"{trial.name}.csv"), trial.name, trial.product, trial.exemplar, trial.has_valve, trial.profile
    )
    record = record_of(samples, known, trial.product, notes) if samples else None
    assert record is not None, notes.problems
    return record


def fitted(motors: Motors, programme: Iterable[Trial]) -> ActuatorFit:
    return fit([recorded(motors, trial) for trial in programme if trial.measured == "displacement"])


def truth(motors: Motors, product: str) -> dict[str, float]:
    p: Any = motors.actuator_of(product).parameters
    return {name: getattr(p, name) for name in type(p).model_fields if name.endswith("_s")}


def coefficients(found: ActuatorFit, motors: Motors) -> list[dict[str, Any]]:
    rows = []
    for product in found.model.products:
        true = truth(motors, product)
        for name, value in found.model.coefficients(product).items():
            form = found.model.times[name.split("_")[0]].curves[product].form
            of = {"product": product, "name": name, "true": true[name], "form": form}
            rows.append({**of, "value": value.value, "low": value.low, "high": value.high, "told": value.told})
    return rows


def coefficient_table(rows: Sequence[dict[str, Any]]) -> str:
    """One line per coefficient: truth, estimates, width of the interval, how often it holds the truth."""
    found = pd.DataFrame(rows)
    lines = [
        f"   {'coefficient':12}{'truth':>7}{'mean':>9}{'scatter':>9}{'width':>8}{'covered':>10}{'told':>6}  models"
    ]
    for (product, name), each in found.groupby(["product", "name"], sort=False):
        inside = (each["low"] <= each["true"]) & (each["true"] <= each["high"])
        forms = ", ".join(f"{form} {count}" for form, count in each["form"].value_counts().items())
        width, covered = (each["high"] - each["low"]).median(), f"{int(inside.sum())}/{len(each)}"
        if not each["told"].any():
            width, covered = np.nan, "not told"
        lines.append(
            f"{product:3}{name:12}{each['true'].iloc[0]:7.0f}{each['value'].mean():9.1f}{each['value'].std():9.1f}"
            f"{width:8.1f}{covered:>10}{int(each['told'].sum()):6}  {forms}"
        )
    return "\n".join(lines)


def new_profiles(found: ActuatorFit, motors: Motors) -> list[dict[str, Any]]:
    """Return the errors of the times of cycles in profiles, and of exemplars, that were not in the fit."""
    rows = []
    for product in found.model.products:
        for on, off in NEW_MIN:
            trial = Trial("new", product, "new", False, (on, on), (off, off), 600.0, "displacement")
            cycles = cycles_of(recorded(motors, trial))
            cycles = cycles[(cycles["lost"] == "") & cycles["before_s"].notna()]
            for name, (shape, before) in TIMES.items():
                curve = found.model.times[name].curves[product]
                predicted = np.full(len(cycles), curve.b_s.value)
                if shape is not None and curve.form != "constant":
                    predicted += curve.a_s.value * shape(cycles[before].to_numpy(), np.array([curve.tau_s.value]))[0]
                wrong = np.abs(cycles[f"{name}_s"].to_numpy() - predicted)
                rows += [{"product": product, "time": name, "profile": f"{on:g}-{off:g}", "wrong_s": w} for w in wrong]
    return rows


def profile_table(rows: Sequence[dict[str, Any]]) -> str:
    found = pd.DataFrame(rows)
    order = dict(index=["product", "time"], columns="profile", values="wrong_s", aggfunc="median", sort=False)
    table = found.pivot_table(**order)  # type: ignore[arg-type]
    table["all"] = found.groupby(["product", "time"], sort=False)["wrong_s"].median()
    return str(table.round(1).to_string()) + f"\nall: {found['wrong_s'].median():.1f} s"


def valve(found: ActuatorFit, motors: Motors, trial: Trial) -> list[dict[str, Any]]:
    """Return the curve with the authority given and fitted, from flow and the actuator that was fitted before."""
    made, notes = run_trial(motors, trial), Notes(trial.name)
    samples = samples_of(made.time_s, made.signal_V, made.value, "L/h", notes)
    assert samples is not None
    on = samples.signal > 12.0
    record = FlowRecord(trial.name, "", "", True, samples.interval_s, on, samples.values, samples.missing, "L/h", ())
    actuator = block("actuator", actuator_block(found.model.coefficients(trial.product)))
    rows = []
    for how, authority in (("given", authority_of(2.9, 30.0)), ("fitted", None)):
        curve = fit_valve(record, actuator, authority=authority, how_authority=how)
        rows.append({"authority is": how, **curve.parameters(), "mae": curve.mae})
    return rows


def valve_table(rows: Sequence[dict[str, Any]]) -> str:
    found, lines = pd.DataFrame(rows), []
    for how, each in found.groupby("authority is", sort=False):
        off = {name: (each[name] - true).abs() for name, true in CURVE.items()}
        figures = ", ".join(f"{name} {wrong.median():.4f} ({wrong.max():.4f})" for name, wrong in off.items())
        mae = f"MAE {100.0 * each['mae'].median():.2f} % ({100.0 * each['mae'].max():.2f} %)"
        lines.append(f"authority {how}: median (largest) error: {figures}; {mae}")
    return "\n".join(lines)


def enthalpy_table(seed: int) -> str:
    """The error of the opening per record, on records of the enthalpy model, beside the paper's on real motors."""
    found = fitted(Motors("enthalpy", {}, "quick-opening", Bench(), seed), table_a1())
    lines = [f"{'record':18}{'MAE':>7}{'RMSE':>7}   {'paper, real motors':>18}"]
    for name, (mae, rmse) in PUBLISHED.items():
        errors = found.errors[name]
        lines.append(f"{name:18}{errors.mae:7.3f}{errors.rmse:7.3f}   {mae:9.3f}{rmse:9.3f}")
    ours = [found.errors[name].mae for name in PUBLISHED]
    theirs = [mae for mae, _ in PUBLISHED.values()]
    lines.append(f"{'mean':18}{np.mean(ours):7.3f}{'':7}   {np.mean(theirs):9.3f}")
    lines.append(f"{'largest':18}{max(ours):7.3f}{'':7}   {max(theirs):9.3f}")
    return "\n".join([*lines, *(f"note: {sentence}" for sentence in found.model.untold())])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repetitions", type=int, default=100)
    parser.add_argument("--valves", type=int, default=20, help="repetitions in which the valve is fitted too")
    arguments = parser.parse_args()
    told, times, curves = [], [], []
    (flow,) = (trial for trial in table_a1() if trial.measured == "flow")
    for seed in range(1, arguments.repetitions + 1):
        motors = Motors("variable-times", {}, "quick-opening", Bench(), seed)
        found = fitted(motors, table_a1())
        told += coefficients(found, motors)
        times += new_profiles(found, motors)
        if seed <= arguments.valves:
            curves += valve(found, motors, flow)
    print(f"Table 2 recovered, {arguments.repetitions} repetitions\n{coefficient_table(told)}\n")
    print(f"Absolute error of times in new profiles, new exemplars, median [s]\n{profile_table(times)}\n")
    print(f"Valve curve, {arguments.valves} repetitions\n{valve_table(curves)}\n")
    print(f"Opening of the enthalpy model, over the stroke\n{enthalpy_table(1)}")


if __name__ == "__main__":
    main()
