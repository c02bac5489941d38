"""A motor, or a whole chain, as a Python plugin for EnergyPlus: one file that needs no waxstudy."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from string import Template
from typing import Any

from waxstudy.export.model import NotExportable
from waxstudy.export.python_source import NotPortable, factory, ring, written
from waxstudy.plugin import CHAIN, Block, Choice, Ring
from waxstudy.simulation.chain import Chain
from waxstudy.version import __version__

TEMPLATE = files("waxstudy.export").joinpath("energyplus_plugin.txt")


@dataclass(frozen=True)
class Place:
    """Where the chain acts in a model of EnergyPlus."""

    zone: str
    radiant: str  # ZoneHVAC:LowTemperatureRadiant:VariableFlow or ConstantFlow
    full_flow_kg_s: float
    setpoint_C: float


def plugin(blocks: Mapping[str, Choice], step_s: float, place: Place, module: str) -> str:
    """Return the plugin's text.

    Raises `NotExportable`, `PluginError` or `SimulationError`.
    """
    ready = Chain(blocks, step_s)
    states = ready.start()
    texts, stages = [], []
    for number, kind in enumerate(CHAIN):
        block = ready.blocks[number]
        if block is not None:
            texts.append(_text(block))
            p, x = _namespace(_fields(ready.plain[number])), _namespace(_state(states[number]))
            stages.append(_stage(kind, p, x, block.output.low, block.output.high))
    if any("Ring(" in stage for stage in stages):
        texts.insert(0, ring())
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        TITLE=", ".join(f"{kind} {choice.component.name}" for kind, choice in blocks.items()),
        VERSION=__version__,
        STEP=written(step_s),
        OBJECTS=objects(place, module),
        ZONE=written(place.zone),
        RADIANT=written(place.radiant),
        FULL_FLOW=written(place.full_flow_kg_s),
        SETPOINT=written(place.setpoint_C),
        BLOCKS="\n\n".join(texts),
        STAGES="\n".join(stages),
    )


def objects(place: Place, module: str) -> str:
    """Return the objects that make EnergyPlus load the plugin, as IDF."""
    return "\n".join(
        [
            "PythonPlugin:SearchPaths, waxstudy, Yes, Yes, No;",
            f"PythonPlugin:Instance, waxstudy {module}, Yes, {module}, Motor;",
            f"Output:Variable, {place.zone}, Zone Mean Air Temperature, Timestep;",
        ]
    )


def _text(block: type[Block]) -> str:
    try:
        return factory(block, block.kind)
    except NotPortable as error:
        raise NotExportable(f"{block.kind} '{block.name}' cannot be written for EnergyPlus: {error}") from error


def _stage(kind: str, p: str, x: str, low: float, high: float) -> str:
    return f"            ({kind!r}, {kind}(), {p}, {x}, {written(low)}, {written(high)}),"


def _namespace(values: Mapping[str, str]) -> str:
    return f"SimpleNamespace({', '.join(f'{name}={value}' for name, value in values.items())})"


def _fields(plain: Any) -> dict[str, str]:
    return {name: written(getattr(plain, name)) for name in getattr(plain, "_fields", ())}


def _state(state: Any) -> dict[str, str]:
    """A state's fields; a ring is new, as every start makes it."""
    values = {field.name: getattr(state, field.name) for field in dataclasses.fields(state)}
    return {name: f"Ring({v.length})" if isinstance(v, Ring) else written(v) for name, v in values.items()}
