"""What a block of the control chain must do, stage by stage."""

from __future__ import annotations

import copy
import io
import pickle
from collections.abc import Iterator, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from itertools import islice
from typing import Any

import numpy as np

from waxstudy.conformance import signals
from waxstudy.conformance.drive import CompiledBlock, interpreted
from waxstudy.conformance.purity import impure_names
from waxstudy.conformance.stage import Problems, Stage, Subject
from waxstudy.plugin import Block, SimulationError
from waxstudy.plugin.registry import PluginError, described
from waxstudy.plugin.structure import port_problems
from waxstudy.simulation.records import plain_parameters, state_dtype, state_problem, state_record

STEPS_S = (1.0, 5.0, 60.0)
WARM_UP_S = -604800.0
A_WEEK = "a week"
HALVINGS_S = (40.0, 20.0, 10.0, 5.0)
COARSEST_S, USUAL_S, FINEST_S = 40.0, 5.0, 1.25
NEAR = 2e-4  # of the output's span: what is this near has settled
ROUNDING_STEPS, MOST_STEPS = 0.6, 6.0  # what a shift in time by so many steps would do
FALL = 0.5  # of the distance at the coarsest step, which is eight times as long


def _block(subject: Subject) -> type[Block]:
    assert issubclass(subject.component, Block)
    return subject.component


def _examples(subject: Subject) -> Iterator[tuple[str, Any]]:
    for label, model in subject.models.items():
        yield label, plain_parameters(model)


def ports(subject: Subject) -> Problems:
    """Input and output have a unit and a finite range, within those of the kind."""
    yield from port_problems(_block(subject))


def state(subject: Subject) -> Problems:
    """The state is a dataclass of float, int, bool and Ring; every start gives a fresh one."""
    block = _block(subject)
    try:
        state_dtype(block.State)
    except (TypeError, NameError) as error:
        yield f"{error}"
        return
    for label, p in _examples(subject):
        try:
            first, second = block.start(p, 5.0), block.start(p, 5.0)
            untouched = copy.deepcopy(second)
        except (Exception, SystemExit) as error:
            yield f"example '{label}': start failed: {described(error)}"
            continue
        if not isinstance(first, block.State):
            yield f"example '{label}': start gives {first!r:.60}, not its State, {block.State.__name__}"
            continue
        if wrong := state_problem(first):
            yield f"example '{label}': {wrong}"
            continue
        try:
            interpreted(block, p, signals.random(block.input, 200), 5.0, state=first)
        except SimulationError:
            continue  # told by the next stage
        if first is second or _bytes(second) != _bytes(untouched):
            yield (
                f"example '{label}': two starts share memory, so that one chain changes the other: build what is "
                "mutable in `start`, or with field(default_factory=...)"
            )


def output(subject: Subject) -> Problems:
    """For any input the output is a number in its range, whatever the step and the time; nothing is printed."""
    block = _block(subject)
    for label, p in _examples(subject):
        inputs = {"random": signals.random(block.input), **signals.adversarial(block.input)}
        inputs[A_WEEK] = signals.random(block.input, 10080)
        printed = io.StringIO()
        with redirect_stdout(printed), redirect_stderr(printed):
            yield from islice(_failures(block, label, p, inputs), 1)  # what fails for one input mostly does for others
        if printed.getvalue():
            yield f"its step prints ({printed.getvalue().strip()[:40]!r}): remove it; the output is for results"


def _failures(block: type[Block], label: str, p: Any, inputs: Mapping[str, Sequence[float]]) -> Problems:
    for name, values in inputs.items():
        for dt in STEPS_S if name != A_WEEK else (60.0,):
            x = block.start(p, dt)
            try:
                interpreted(block, p, values, dt, WARM_UP_S if name == "random" else 0.0, state=x)
            except SimulationError as error:
                yield f"example '{label}', input '{name}', step {dt:g} s: {error}"
                continue
            if wrong := state_problem(x):
                yield f"example '{label}': {wrong}"


def reproducible(subject: Subject) -> Problems:
    """The output depends on parameters, state, input and time alone: no clock, no chance, no memory elsewhere."""
    block = _block(subject)
    for name, line in impure_names(block):
        yield f"line {line} uses `{name}`: a run must give the same figures each time; keep everything in the state"
    for label, p in _examples(subject):
        values, others = signals.random(block.input), signals.random(block.input, seed=signals.SEED + 1)
        alone = interpreted(block, p, values, 5.0)
        again = interpreted(block, p, values, 5.0)
        if alone != again:
            where = _first_difference(alone, again)
            yield f"example '{label}': a second run differs {where}: something outlives the state"
            continue
        x, y, beside = block.start(p, 5.0), block.start(p, 5.0), []
        for n, (u, other) in enumerate(zip(values, others, strict=True)):
            beside += interpreted(block, p, [u], 5.0, n * 5.0, x)
            interpreted(block, p, [other], 5.0, n * 5.0, y)
        if beside != alone:
            where = _first_difference(alone, beside)
            yield f"example '{label}': beside a second chain it differs {where}: both share memory outside the state"


def restore(subject: Subject) -> Problems:
    """A state that is saved and read again goes on as if nothing had happened."""
    block = _block(subject)
    for label, p in _examples(subject):
        values = signals.random(block.input)
        half = len(values) // 2
        x = block.start(p, 5.0)
        whole = interpreted(block, p, values, 5.0)
        interpreted(block, p, values[:half], 5.0, state=x)
        try:
            x = pickle.loads(pickle.dumps(x))
        except Exception as error:
            yield f"its state cannot be pickled ({type(error).__name__}): define State at the top of a module"
            return
        rest = interpreted(block, p, values[half:], 5.0, half * 5.0, x)
        if rest != whole[half:]:
            where = _first_difference(whole[half:], rest)
            yield f"example '{label}': restored, it differs {where}: a part of it is not in the state"


def compiled(subject: Subject) -> Problems:
    """Compiled, it gives the same bits as in Python."""
    from waxstudy.simulation.typed import CannotCompile

    block = _block(subject)
    for label, p in _examples(subject):
        for name, values in {"random": signals.random(block.input), **signals.adversarial(block.input)}.items():
            for dt in STEPS_S:
                try:
                    machine = CompiledBlock(block, p, dt)
                except CannotCompile as error:
                    yield f"it cannot be compiled, and would run many times slower in Python: {error}"
                    return
                except PluginError as error:
                    yield f"{error}"
                    return
                expected, found = interpreted(block, p, values, dt), machine.run(values, dt)
                if machine.changed_parameters:
                    yield "its step changes its parameters: keep what changes in the state"
                    return
                if expected != found:
                    where = _first_difference(expected, found)
                    yield (
                        f"example '{label}', input '{name}', step {dt:g} s: compiled, it differs {where}: write powers "
                        "as products, prefer `math` to numpy; or exempt it from this stage"
                    )
                    return


def step_halving(subject: Subject) -> Problems:
    """With a shorter step its output settles.

    What is left at a step of 5 s is less than rounding a time to whole steps makes, or falls as the step gets
    shorter; and it is never more than some steps' delay.
    """
    block = _block(subject)
    held = signals.day(block.input, COARSEST_S)
    for label, p in _examples(subject):
        finest = _outputs(block, p, held, FINEST_S)
        span = float(np.ptp(finest)) or 1.0
        away = {dt: _distance(_outputs(block, p, held, dt), dt, finest) / span for dt in HALVINGS_S}
        left, step = away[USUAL_S], _shifted(finest, USUAL_S) / span
        stays = left > FALL * away[COARSEST_S] + NEAR
        if left > MOST_STEPS * step + NEAR or (stays and left > ROUNDING_STEPS * step + NEAR):
            steps = ", ".join(f"{100 * a:.2f} % at {dt:g} s" for dt, a in away.items())
            yield (
                f"example '{label}': its output does not settle with a shorter step (mean distance to a step of "
                f"{FINEST_S:g} s: {steps}): let every rate be multiplied by dt, and every time be measured in seconds"
            )


def _outputs(block: type[Block], p: Any, held: Sequence[float], dt: float) -> np.ndarray:
    return np.asarray(interpreted(block, p, np.repeat(held, round(COARSEST_S / dt)).tolist(), dt))


def _at_coarse_steps(outputs: np.ndarray, dt: float) -> np.ndarray:
    parts = round(COARSEST_S / dt)
    return outputs[parts - 1 :: parts]


def _distance(outputs: np.ndarray, dt: float, finest: np.ndarray) -> float:
    """Mean distance at the end of each of the coarsest steps."""
    return float(np.mean(np.abs(_at_coarse_steps(outputs, dt) - _at_coarse_steps(finest, FINEST_S))))


def _shifted(finest: np.ndarray, by_s: float) -> float:
    """Mean distance of the finest output from itself, that much earlier or later."""
    n = round(by_s / FINEST_S)
    later = np.concatenate([np.full(n, finest[0]), finest[:-n]])
    earlier = np.concatenate([finest[n:], np.full(n, finest[-1])])
    return max(_distance(moved, FINEST_S, finest) for moved in (later, earlier))


def _bytes(x: Any) -> bytes:
    return state_record(x).tobytes()


def _first_difference(expected: Sequence[float], found: Sequence[float]) -> str:
    n = next(i for i, (a, b) in enumerate(zip(expected, found, strict=True)) if a != b)
    return f"at step {n + 1} ({found[n]!r} instead of {expected[n]!r})"


STAGES = (
    Stage("ports", "input and output with unit and range", ports, needed=True),
    Stage("state", "a fresh state of simple fields", state, needed=True),
    Stage("output", "a number in its range for any input", output, needed=True),
    Stage("reproducible", "the same again, also beside another chain", reproducible),
    Stage("restore", "goes on after being saved and read", restore),
    Stage("compiled", "compiled as in Python, to the bit", compiled, exemptible=True),
    Stage("step-halving", "settles with a shorter step", step_halving, exemptible=True),
)
