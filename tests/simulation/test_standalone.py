"""Claims about a chain as machine code that needs neither numba nor the blocks where it runs."""

from __future__ import annotations

import ctypes
import pickle
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from waxstudy.plugin import TEMPERATURE, Choice, Parameters, Port, Sensor, SimulationError, parameter
from waxstudy.plugin.registry import installed
from waxstudy.simulation.advance import ChainAdvance
from waxstudy.simulation.cache import cache_folder
from waxstudy.simulation.carry import standalone
from waxstudy.simulation.interpreted import CompiledFailure
from waxstudy.simulation.standalone import ROW, Number, Standalone

STEP_S = 5.0
ON_OFF = {
    "sensor": ("delay", {"delay_s": 120.0}),
    "controller": ("on-off", {"dead_band_K": 0.5}),
    "actuator": ("variable-times", {"product": "B"}),
    "valve": ("quick-opening", {}),
}
PI = {**ON_OFF, "controller": ("pi", {}), "modulator": ("pwm", {})}
SHORT = {"controller": ("pi", {})}


def blocks_of(chain: dict[str, tuple[str, dict[str, Any]]]) -> dict[str, Choice]:
    return {kind: Choice.of(installed().get(kind, name), values) for kind, (name, values) in chain.items()}


def elsewhere(advance: ChainAdvance) -> Any:
    """Return it as the process of a run gets it."""
    return pickle.loads(pickle.dumps(advance))


@pytest.mark.parametrize("chain", [ON_OFF, PI, SHORT])
def test_machine_code_gives_what_python_gives_to_the_bit(chain: dict[str, Any]) -> None:
    here, there = (elsewhere(ChainAdvance(blocks_of(chain), STEP_S, 21.0, jit=jit)) for jit in (False, True))
    assert isinstance(there, Standalone)
    time_s = STEP_S * np.arange(5000)
    sensed_C = 21.0 + 0.8 * np.sin(time_s / 3000.0) + 0.1 * np.sin(time_s / 37.0)
    told = list(zip(sensed_C.tolist(), time_s.tolist(), strict=True))
    interpreted, compiled = ([step(u, t, STEP_S) for u, t in told] for step in (here, there))
    assert interpreted == compiled
    assert len({row[-1] for row in compiled}) > 1  # the valve has moved


def test_many_steps_at_once_are_the_same_steps() -> None:
    one, many = (elsewhere(ChainAdvance(blocks_of(PI), STEP_S, 21.0)) for _ in range(2))
    count, rise_K_s = 60, 1e-4
    memory = (Number * (count * ROW))()
    for begin_s in (0.0, 300.0):
        mean = many.carry(20.9, rise_K_s, begin_s, STEP_S, count, ctypes.addressof(memory))
        ahead_s = [n * STEP_S for n in range(count)]
        told = [20.9 + rise_K_s * each for each in ahead_s]
        each = [one(u, begin_s + t, STEP_S) for u, t in zip(told, ahead_s, strict=True)]
        assert np.array(memory).reshape(count, ROW).tolist() == [[*row, u] for row, u in zip(each, told, strict=True)]
        assert mean == sum(row[-1] for row in each) / count


def test_it_is_loaded_without_numba_and_without_the_blocks(tmp_path: Path) -> None:
    (tmp_path / "chain").write_bytes(pickle.dumps(ChainAdvance(blocks_of(ON_OFF), STEP_S, 21.0)))
    code = (
        "import pickle, sys; a = pickle.load(open('chain', 'rb')); print(a(19.0, 0.0, 5.0)[0]); "
        "print([n for n in ('numba', 'numpy', 'pydantic', 'waxstudy.plugin', 'waxstudy_paper') if n in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.split("\n")[:2] == ["1.0", "[]"]


@dataclass
class Count:
    steps: int = 0


class Breaking(Sensor):
    """A sensor for a test, that breaks after a while in one of several ways."""

    name = "breaking"
    api_version = "1.0"
    input = TEMPERATURE
    output = Port("temperature", "C", 0.0, 50.0)
    State = Count

    class Parameters(Parameters):
        after: float = parameter(3.0, unit="1", description="Steps.", source="a test")

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        x.steps += 1
        return u / (p.after - x.steps)


class Forging(Breaking):
    name = "forging"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        p.after = u
        return u


class Spelling(Breaking):
    name = "spelling"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return u + len(f"{u:.3f}") * 0.0


def advance_of(sensor: type[Sensor]) -> Any:
    return elsewhere(ChainAdvance({"sensor": Choice.of(sensor, {}), **blocks_of(SHORT)}, STEP_S, 21.0))


@pytest.mark.parametrize(("sensor", "steps"), [(Breaking, 3), (Forging, 1)])
def test_a_block_that_fails_is_named_with_the_time(sensor: type[Sensor], steps: int) -> None:
    advance = advance_of(sensor)
    assert isinstance(advance, Standalone)
    for n in range(steps - 1):
        advance(20.0, n * STEP_S, STEP_S)
    with pytest.raises(SimulationError, match=rf"sensor '{sensor.name}' failed at day 1, 00:00:{5 * (steps - 1):02d}"):
        advance(20.0, (steps - 1) * STEP_S, STEP_S)


def test_the_failure_can_be_told_to_another_process() -> None:
    error = pickle.loads(pickle.dumps(CompiledFailure("sensor 'breaking'", "day 1")))
    assert "plugins check breaking" in str(error)


def test_a_chain_with_a_block_that_needs_python_runs_in_python() -> None:
    advance = advance_of(Spelling)
    assert isinstance(advance, ChainAdvance)
    assert advance(20.0, 0.0, STEP_S)[0] == pytest.approx(0.3)  # the default gain, times 1 K


def test_a_damaged_object_file_is_made_again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("WAXSTUDY_CACHE", str(tmp_path / "cache"))
    from waxstudy.simulation import carry

    def made() -> bytes:
        carry.of_plain.cache_clear()
        return carry.of_plain(carry.carry, "carry")

    first = made()
    (file,) = cache_folder().glob("alone_*.o")
    file.write_bytes(file.read_bytes()[:-8] + b"12345678")
    assert made() == first
    carry.of_plain.cache_clear()
    assert standalone(blocks_of(SHORT), STEP_S, 21.0) is not None
