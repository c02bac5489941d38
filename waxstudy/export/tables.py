"""The tables of a model in C, as `shell/model.h` and `shell/chain.h` declare them."""

from __future__ import annotations

import json
from collections.abc import Iterator

from waxstudy.export.model import Model, Stage, Variable


def model_tables(model: Model) -> str:
    """Return what every model needs: variables, sizes and the memory at the start."""
    starts = ", ".join(repr(variable.start) for variable in model.of("input"))
    return "\n".join(
        [
            '#include "model.h"',
            f"const char TOKEN[] = {_text(model.token)};",
            f"const double STEP_S = {model.step_s!r};",
            f"const unsigned VARIABLE_COUNT = {len(model.variables)};",
            f"const size_t INPUT_COUNT = {len(model.of('input'))}, OUTPUT_COUNT = {len(model.of('output'))};",
            f"const size_t PARAMETER_BYTES = {len(model.parameters)}, STATE_BYTES = {len(model.state)};",
            f"const double INPUT_START[] = {{{starts}}};",
            *_array("unsigned char PARAMETER_START", map(str, model.parameters or b"\0")),
            *_array("unsigned char STATE_START", map(str, model.state or b"\0")),
            *_array("Variable VARIABLES", map(_variable, model.variables)),
        ]
    )


def chain_tables(model: Model) -> str:
    """Return the blocks of a chain."""
    symbols = [stage.symbol for stage in model.stages if stage.symbol]
    steps = ["", '#include "chain.h"', *(f"extern Step {symbol};" for symbol in symbols)]
    return "\n".join([*steps, *_array("Block BLOCKS", map(_stage, model.stages)), ""])


def _array(name: str, items: Iterator[str]) -> list[str]:
    return [f"const {name}[] = {{{', '.join(items)}}};"]


def _variable(variable: Variable) -> str:
    limits = f"{variable.low!r}, {variable.high!r}, {int(variable.above_low)}, {int(variable.below_high)}"
    causality = variable.causality.upper()
    return f"{{{_text(variable.name)}, {causality}, '{_letter(variable)}', {variable.place}, {limits}}}"


def _letter(variable: Variable) -> str:
    return variable.type.replace("?", "\\?")


def _stage(stage: Stage) -> str:
    numbers = f"{stage.parameters}, {stage.state}, {stage.low!r}, {stage.high!r}, {int(stage.subtracts)}"
    return f"{{{_text(stage.label)}, {stage.symbol or 0}, {numbers}}}"


def _text(text: str) -> str:
    return json.dumps(text)
