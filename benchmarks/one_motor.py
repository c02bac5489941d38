"""The same motor here, as an FMU in FMPy, and as a plugin in EnergyPlus: `python -m benchmarks.one_motor [OUT.svg]`.

EnergyPlus' run makes the air temperature, and a thermostat of it the signal; the two others get that signal.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import fmpy
import matplotlib.pyplot as plt
import numpy as np

from waxstudy.export.chain import block_model
from waxstudy.export.compiler import this_platform
from waxstudy.export.fmu import write_fmu
from waxstudy.plugin import Choice, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.report.figures.style import COLOURS
from waxstudy.simulation.chain import Stepped
from waxstudy_energyplus import objects

ROOT = Path(__file__).parents[1]
STEP_S, MINUTE_S, SETPOINT_C, FULL_KG_S = 5.0, 60.0, 21.0, 0.034
PER_MINUTE = round(MINUTE_S / STEP_S)
FIRST_MINUTE = 24 * 60  # after the day of warm-up
BEFORE_MIN, SHOWN_MIN = 2, 14  # of a switch
# colour, marker and its size of each program: rings in rings, as they lie on each other
STYLES = [(COLOURS[0], "o", 11), (COLOURS[1], "s", 7), (COLOURS[2], "x", 5)]


def in_energyplus(folder: Path) -> tuple[FloatArray, FloatArray]:
    """Return air temperature and opening of each minute of two days in EnergyPlus."""
    plugin, run = folder / "motor.py", folder / "run"
    run.mkdir()
    where = ["--zone", objects.ZONE, "--radiant", objects.RADIANT_FLOOR, "--full-flow-kg-s", str(FULL_KG_S)]
    words = ["export", "energyplus", "--use", "variable-times", *where, "--out", str(plugin)]
    subprocess.run([Path(sys.executable).with_name("waxstudy"), *words], check=True, capture_output=True)
    words = [sys.executable, "-m", "tests.energyplus.in_engine", str(plugin), str(run)]
    done = subprocess.run(words, check=True, capture_output=True, text=True, cwd=ROOT)
    air_C, flow_kg_s = np.array(json.loads(done.stdout.splitlines()[-1])["rows"]).T
    return air_C, flow_kg_s / FULL_KG_S


def signal_of(air_C: FloatArray) -> FloatArray:
    """Return the thermostat's signal at the motor's step."""
    thermostat = Stepped(Choice.of(installed().get("controller", "on-off"), {"dead_band_K": 0.5}), STEP_S)
    held_C = np.repeat(air_C, PER_MINUTE)
    return np.array([thermostat.step(SETPOINT_C - air, n * STEP_S) for n, air in enumerate(held_C)])


def here(choice: Choice, signal: FloatArray) -> FloatArray:
    motor = Stepped(choice, STEP_S)
    return np.array([motor.step(float(on), n * STEP_S) for n, on in enumerate(signal)])


def in_fmpy(choice: Choice, signal: FloatArray, folder: Path) -> FloatArray:
    write_fmu(folder / "motor.fmu", block_model(choice, STEP_S), fmi=2, platforms=[this_platform()])
    times_s = np.arange(len(signal)) * STEP_S
    given = np.array(list(zip(times_s, signal, strict=True)), dtype=[("time", float), ("signal", float)])
    found = fmpy.simulate_fmu(
        str(folder / "motor.fmu"),
        stop_time=len(signal) * STEP_S,
        step_size=STEP_S,
        output_interval=STEP_S,
        input=given,
        output=["opening"],
    )
    return np.asarray(found["opening"][1:])  # the first is that of the start


def by_minute(values: FloatArray) -> FloatArray:
    return np.asarray(values.reshape(-1, PER_MINUTE).mean(axis=1))


def draw(air_C: FloatArray, signal: FloatArray, openings: dict[str, FloatArray], path: Path) -> None:
    """Draw the first opening and the first closing after the warm-up: temperature, opening, differences."""
    switched = np.flatnonzero(np.diff(signal)) // PER_MINUTE + 1
    first, second = switched[switched >= FIRST_MINUTE][:2]
    figure, rows = plt.subplots(
        3, 2, figsize=(8.0, 6.2), sharex="col", sharey="row", height_ratios=(1, 2, 1.2), layout="constrained"
    )
    for column, begin in enumerate((first - BEFORE_MIN, second - BEFORE_MIN)):
        place = slice(begin, begin + SHOWN_MIN)
        minutes = np.arange(SHOWN_MIN) - BEFORE_MIN
        air, above, below = rows[:, column]
        air.plot(minutes, air_C[place], color="black")
        for (name, opening), (colour, marker, size) in zip(openings.items(), STYLES, strict=True):
            look = {"color": colour, "marker": marker, "markersize": size, "fillstyle": "none"}
            above.plot(minutes, opening[place], linewidth=0.8, label=name, **look)
            if name != "waxstudy":
                off = (opening - openings["waxstudy"])[place] * 1e16
                below.plot(minutes, off, linestyle="", label=f"{name} less waxstudy", **look)
        below.set_xlabel("minutes since the thermostat switched")
    rows[0, 0].set_ylabel("air [°C]")
    rows[1, 0].set_ylabel("opening, mean of a minute [1]")
    rows[2, 0].set_ylabel("difference [$10^{-16}$]")
    rows[2, 0].set_ylim(-4.0, 4.0)
    rows[1, 0].legend(loc="center right")
    rows[2, 1].legend(loc="lower right")
    figure.savefig(path)


def main() -> None:
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images" / "one-motor.svg"
    choice = Choice.of(installed().get("actuator", "variable-times"), {})
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        air_C, opening = in_energyplus(folder)
        signal = signal_of(air_C)
        ours, theirs = by_minute(here(choice, signal)), by_minute(in_fmpy(choice, signal, folder))
    openings = {"waxstudy": ours, "FMPy": theirs, "EnergyPlus": opening}
    for other, values in list(openings.items())[1:]:
        print(f"largest difference of {other}: {np.abs(values - ours).max():.1e} over {len(ours) / 60:.0f} h")
    draw(air_C, signal, openings, out)


if __name__ == "__main__":
    main()
