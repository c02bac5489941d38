"""A block, or the whole chain of a case, as a model to export."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from pydantic.fields import FieldInfo

from waxstudy.export.model import Model, NotExportable, Stage, Variable
from waxstudy.plugin import CHAIN, TEMPERATURE, Block, Choice, Port
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.machine_code import machine_code
from waxstudy.simulation.records import choices_of, parameter_dtype, parameter_record, state_record
from waxstudy.simulation.typed import CannotCompile

INPUT = {
    "sensor": "temperature_C",
    "controller": "error_K",
    "modulator": "output",
    "actuator": "signal",
    "valve": "opening",
}
OUTPUT = {
    "sensor": "reading_C",
    "controller": "output",
    "modulator": "signal",
    "actuator": "opening",
    "valve": "flow_fraction",
}
SAID = {
    "temperature_C": "what the sensor is exposed to",
    "setpoint_C": "setpoint of the controller",
    "error_K": "setpoint minus reading",
    "reading_C": "reading of the sensor",
    "output": "output of the controller",
    "signal": "heating signal, on above 0.5",
    "opening": "opening of the valve",
    "flow_fraction": "fraction of full flow",
}
START_C = 20.0


def block_model(choice: Choice, step_s: float) -> Model:
    """Return one block as a model; raise `NotExportable`, `PluginError` or `SimulationError`."""
    component = choice.component
    assert issubclass(component, Block)
    return _model({component.kind: choice}, step_s, (component.kind,))


def chain_model(blocks: Mapping[str, Choice], step_s: float) -> Model:
    """Return a whole chain, from temperature and setpoint to flow, as a model; raise as `block_model`."""
    return _model(blocks, step_s, CHAIN)


def _model(blocks: Mapping[str, Choice], step_s: float, kinds: tuple[str, ...]) -> Model:
    ready = Chain(blocks, step_s)
    states = ready.start()
    parameters, state = bytearray(), bytearray()
    stages: list[Stage] = []
    own: list[Variable] = []
    for kind in kinds:
        place, subtracts = CHAIN.index(kind), kind == "controller" and len(kinds) > 1
        block, plain = ready.blocks[place], ready.plain[place]
        if block is None:
            stages.append(Stage(kind, subtracts=subtracts))
            continue
        symbol, (low, high) = f"step_of_{kind}", (block.output.low, block.output.high)
        code, label = _code(block, plain, symbol), f"{kind} '{block.name}'"
        stages.append(Stage(label, code, symbol, len(parameters), len(state), low, high, subtracts))
        own += _parameters(block, plain, step_s, len(parameters))
        parameters += _whole(parameter_record(plain))
        state += _whole(state_record(states[place]))
    ends = [*_inputs(ready, kinds), *_outputs(ready, kinds)]
    time = Variable("time", "time", "s", "time of the importer")
    return Model(_title(blocks), step_s, (time, *ends, *own), bytes(parameters), bytes(state), stages)


def _code(block: type[Block], plain: Any, symbol: str) -> str:
    try:
        return machine_code(block, parameter_dtype(plain), symbol)
    except CannotCompile as error:
        raise NotExportable(f"{block.kind} '{block.name}' cannot be compiled, and so not exported: {error}") from error


def _whole(record: np.ndarray) -> bytes:
    """Bytes filled up to whole doubles."""
    data = record.tobytes()
    return data + bytes(-len(data) % 8)


def _title(blocks: Mapping[str, Choice]) -> str:
    """Say what each block is, and what of it is fixed because it is no number."""
    parts = []
    for kind, choice in blocks.items():
        values = choice.parameters.model_dump(mode="json")
        fixed = [f"{name} = {value}" for name, value in values.items() if isinstance(value, str)]
        parts.append(f"{kind} {choice.component.name}" + (f" ({', '.join(fixed)})" if fixed else ""))
    return ", ".join(parts)


# --- inputs and outputs ----------------------------------------------------------------------------


def _inputs(ready: Chain, kinds: tuple[str, ...]) -> Iterator[Variable]:
    first = ready.blocks[CHAIN.index(kinds[0])]
    yield _end("input", INPUT[kinds[0]], first.input if first else TEMPERATURE, 0)
    if len(kinds) > 1:
        yield _end("input", "setpoint_C", TEMPERATURE, 1)


def _outputs(ready: Chain, kinds: tuple[str, ...]) -> Iterator[Variable]:
    for number, kind in enumerate(kinds):
        block = ready.blocks[CHAIN.index(kind)]
        port = block.output if block else TEMPERATURE if kind == "sensor" else None
        yield _end("output", OUTPUT[kind], port or Port("level", "1", 0.0, 1.0), number)


def _end(causality: str, name: str, port: Port, place: int) -> Variable:
    start = min(max(START_C if port.unit == "C" else 0.0, port.low), port.high)
    return Variable(name, causality, port.unit, SAID[name], place, start, port.low, port.high)


# --- parameters ------------------------------------------------------------------------------------


def _parameters(block: type[Block], plain: Any, step_s: float, first_byte: int) -> Iterator[Variable]:
    """Yield the numbers of a block's parameters; those that its start asks for cannot be changed any more."""
    asked = _asked_by_start(block, plain, step_s)
    layout: Mapping[str, Any] = parameter_dtype(plain).fields or {}
    for name in getattr(plain, "_fields", ()):
        field, value = block.Parameters.model_fields[name], getattr(plain, name)
        if choices_of(field.annotation) or math.isnan(value):  # the title says the choice; what is not given is NaN
            continue
        extra: Any = field.json_schema_extra or {}
        causality = "constant" if name in asked else "parameter"
        said, place = field.description or "", first_byte + layout[name][1]
        kind = {float: "d", int: "q", bool: "?"}[type(value)]
        limits = (0.0, 1.0, False, False) if kind == "?" else _limits(field)
        yield Variable(f"{block.kind}.{name}", causality, extra.get("unit", ""), said, place, value, *limits, kind)


def _limits(field: FieldInfo) -> tuple[float, float, bool, bool]:
    low, high, above, below = -sys.float_info.max, sys.float_info.max, False, False
    for rule in field.metadata:
        if (least := getattr(rule, "ge", None)) is not None:
            low = float(least)
        if (least := getattr(rule, "gt", None)) is not None:
            low, above = float(least), True
        if (most := getattr(rule, "le", None)) is not None:
            high = float(most)
        if (most := getattr(rule, "lt", None)) is not None:
            high, below = float(most), True
    return low, high, above, below


def _asked_by_start(block: type[Block], plain: Any, step_s: float) -> set[str]:
    """Return which parameters a block's start looks at: what it made of them is in the state already."""
    names, asked = set(getattr(plain, "_fields", ())), set()

    class Watched(type(plain)):  # type: ignore[misc]
        def __getattribute__(self, name: str) -> Any:
            asked.update(names & {name})
            return super().__getattribute__(name)

        def __iter__(self) -> Iterator[Any]:
            asked.update(names)
            yield from super().__iter__()

        def __getitem__(self, place: Any) -> Any:
            asked.update(names)
            return super().__getitem__(place)

    block.start(Watched(*tuple(plain)) if names else plain, step_s)
    return asked
