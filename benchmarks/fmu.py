"""What a step costs in an FMU, beside the same block compiled here: `python -m benchmarks.fmu`."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

from benchmarks.timing import best_s
from waxstudy.export.chain import block_model
from waxstudy.export.compiler import this_platform
from waxstudy.export.fmu import write_fmu
from waxstudy.plugin import Choice, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.replay import replay

STEP_S = 5.0
HELD = 4320  # steps: six hours on, six hours off
STEPS = 200 * HELD


def fmu_figures(folder: Path) -> None:
    """Print the cost of a step of `variable-times` in both."""
    choice = Choice.of(installed().get("actuator", "variable-times"), {})
    signal = (np.arange(STEPS) // HELD % 2).astype(float)
    here = best_s(partial(_replayed, Chain({"actuator": choice}, STEP_S), signal)) / STEPS * 1e9
    path = folder / "motor.fmu"
    write_fmu(path, block_model(choice, STEP_S), fmi=2, platforms=[this_platform()])
    description, unpacked = fmpy.read_model_description(str(path)), fmpy.extract(str(path), str(folder / "unpacked"))
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=unpacked,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="motor",
    )
    slave.instantiate()
    there = best_s(partial(_stepped, slave)) / STEPS * 1e9
    slave.freeInstance()
    slave.freeLibrary()
    print(
        f"\nvariable-times: {here:.1f} ns per step here, {there:.1f} ns in an FMU, {there / here:.2f} times (limit 2)"
    )


def _replayed(chain: Chain, signal: FloatArray) -> None:
    replay(
        chain,
        "actuator",
        signal,
        np.zeros(STEPS),
        interval_s=STEP_S,
        start_s=0.0,
        jump=np.zeros(STEPS),
        last="actuator",
    )


def _stepped(slave: FMU2Slave) -> None:
    slave.reset()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    for number in range(STEPS // HELD):
        slave.setReal([1], [float(number % 2)])
        slave.doStep(number * HELD * STEP_S, HELD * STEP_S)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        fmu_figures(Path(name))
