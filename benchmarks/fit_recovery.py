"""How well the coefficients of Table 2 are recovered from records of the virtual bench: `python -m benchmarks.fit_recovery`.

Each repetition makes the records of Table A1 anew: other exemplars, records, cycles and noise. The records go straight from
the bench to the fit, not through files.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.dataset.notes import Notes
from waxstudy.identification.actuator import ActuatorModel, fit_actuator
from waxstudy.identification.description import Described
from waxstudy.identification.records import Record, record_of, samples_of
from waxstudy.identification.times import cycles_of
from waxstudy.rig.bench import Motors, run_trial
from waxstudy.rig.instruments import Bench
from waxstudy.rig.programme import Trial, table_a1


def recorded(motors: Motors, trial: Trial) -> Record:
    """Return a record of the bench as the fit reads it."""
    made, notes = run_trial(motors, trial), Notes(trial.name)
    samples = samples_of(made.time_s, made.signal_V, made.value, "mm", notes)
    assert samples is not None
    known = Described(
        path=__import__("pathlib").Path(f"{trial.name}.csv"), name=trial.name, product=trial.product, exemplar=trial.exemplar
    )
    record = record_of(samples, known, trial.product, notes)
    assert record is not None, notes.problems
    return record


def fitted(motors: Motors, programme: Iterable[Trial]) -> tuple[ActuatorModel, pd.DataFrame]:
    trials = [trial for trial in programme if trial.measured == "displacement"]
    cycles = pd.concat([cycles_of(recorded(motors, trial)) for trial in trials])
    return fit_actuator(cycles), cycles


def truth(motors: Motors, product: str) -> dict[str, float]:
    p: Any = motors.actuator_of(product).parameters
    return {name: getattr(p, name) for name in type(p).model_fields if name.endswith("_s")}


def rows(repetitions: int, bench: Bench) -> pd.DataFrame:
    """Return a row per repetition, product and coefficient."""
    found = []
    for seed in range(1, repetitions + 1):
        motors = Motors("variable-times", {}, "quick-opening", bench, seed)
        model, cycles = fitted(motors, table_a1())
        for product in model.products:
            true = truth(motors, product)
            for name, value in model.coefficients(product).items():
                form = "constant" if name == "fall_s" else model.times[name.split("_")[0]].curves[product].form
                found.append((seed, product, name, true[name], value.value, value.low, value.high, value.told, form))
    columns = ["seed", "product", "name", "true", "value", "low", "high", "told", "form"]
    return pd.DataFrame(found, columns=columns)


def table(found: pd.DataFrame) -> str:
    """Return one line per coefficient: truth, mean estimate, how often its interval holds the truth, how wide that is."""
    lines = [f"{'':3}{'coefficient':13}{'truth':>8}{'mean':>9}{'scatter':>9}{'width':>8}{'covered':>9}{'told':>6}  forms"]
    for (product, name), each in found.groupby(["product", "name"], sort=False):
        inside = (each["low"] <= each["true"]) & (each["true"] <= each["high"])
        forms = ", ".join(f"{form} {count}" for form, count in each["form"].value_counts().items())
        width = (each["high"] - each["low"]).median()
        lines.append(
            f"{product:3}{name:13}{each['true'].iloc[0]:8.0f}{each['value'].mean():9.1f}{each['value'].std():9.1f}"
            f"{width:8.1f}{int(inside.sum()):5}/{len(each)}{int(each['told'].sum()):6}  {forms}"
        )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repetitions", type=int, default=100)
    arguments = parser.parse_args()
    print(table(rows(arguments.repetitions, Bench())))


if __name__ == "__main__":
    main()
