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
FIRST_HOUR, LAST_HOUR = 24.0, 36.0  # after the day of warm-up
SMALLEST = 1e-17  # so that no difference shows on a logarithmic axis


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


def draw(air_C: FloatArray, openings: dict[str, FloatArray], path: Path) -> None:
    hours = np.arange(len(air_C)) / 60.0
    shown = (hours >= FIRST_HOUR) & (hours < LAST_HOUR)
    figure, (air, above, below) = plt.subplots(
        3, 1, figsize=(8.0, 6.0), sharex=True, height_ratios=(1, 2, 1.3), layout="constrained"
    )
    air.plot(hours[shown], air_C[shown], color="black")
    air.set_ylabel("air [°C]")
    styles = {"waxstudy": ("-", 4.5), "FMPy": ("-", 2.2), "EnergyPlus": ((0, (3, 3)), 1.4)}
    for colour, (name, opening) in zip(COLOURS, openings.items(), strict=False):
        line, width = styles[name]
        above.plot(hours[shown], opening[shown], color=colour, linestyle=line, linewidth=width, label=name)
        if name != "waxstudy":
            off = np.maximum(np.abs(opening - openings["waxstudy"]), SMALLEST)[shown]
            below.semilogy(hours[shown], off, color=colour, marker=".", linestyle="", label=f"{name} less waxstudy")
    above.set_ylabel("opening, mean of a minute [1]")
    below.set_ylabel("|difference| [1]")
    below.axhline(1e-9, color="black", linewidth=0.8)
    below.annotate("1e-9", (LAST_HOUR, 1e-9), ha="right", va="top")
    below.set_ylim(SMALLEST / 2.0, 1e-7)
    below.set_xlabel(f"hours since the start of the run; differences below {SMALLEST:g} are drawn there")
    above.legend(loc="center right")
    below.legend(loc="upper left", ncols=2)
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
    draw(air_C, openings, out)


if __name__ == "__main__":
    main()
