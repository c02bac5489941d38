"""A block's `step`, compiled by numba as for a run, as LLVM's text that needs nothing of Python when it runs.

The text is of no platform: the compiler of the shell makes machine code of it for each.
"""

from __future__ import annotations

import re
from typing import Any

import llvmlite.binding as llvm
import numpy as np
from numba import from_dtype, njit, types

from waxstudy.plugin import Block
from waxstudy.simulation.compiled import jitted
from waxstudy.simulation.records import state_dtype
from waxstudy.simulation.typed import CannotCompile, examine, reason

# what LLVM itself and every C library have
LIBRARY = re.compile(
    r"llvm\..*|mem(cpy|move|set)|a?(cos|sin|tan)h?|atan2|cbrt|ceil|copysign|erfc?|exp2?|expm1|fabs|floor|fmax|fmin|fmod|"
    r"frexp|hypot|ldexp|lgamma|log(10|1p|2)?|modf|nextafter|pow|remainder|rint|(ll?)?round|sqrt|tgamma|trunc"
)
PICKLED = re.compile(r'^(@"?\.const\.pickledata[^=]*= internal constant \[\d+ x i8\]) c".*"', re.MULTILINE)
COUNTED = re.compile(r'!"_Z[^":]*')  # names in remarks for the compiler: numba counts what it compiles
PLATFORM = re.compile(r"^(target (datalayout|triple)|source_filename) = .*\n", re.MULTILINE)


def machine_code(block: type[Block], parameters: np.dtype[Any], symbol: str) -> str:
    """Return LLVM's text with one function `symbol`, of the type `Step` of `shell/chain.h`; parameters have a layout.

    Raises `CannotCompile` with the reason, `PluginError` for a mistake that would give other results than Python does.
    """
    state = state_dtype(block.State)
    step: Any = jitted(block.step)  # type: ignore[arg-type]  # a static method is its function
    examine(block, step, parameters, state)

    def entry(p, x, u, t, dt):  # type: ignore[no-untyped-def]
        return step(p, x, u, t, dt) + 0.0  # as the guard of a run: no negative zero

    number = types.float64
    compiled = njit((from_dtype(parameters), from_dtype(state), number, number, number), error_model="python")(entry)
    (found,) = compiled.overloads.values()
    return alone(found, symbol)


def alone(compiled: Any, symbol: str) -> str:
    """Return what numba has compiled as LLVM's text with one function `symbol`; raise `CannotCompile`."""
    try:
        module = llvm.parse_assembly(compiled.library.get_llvm_str())
        _leave_only(module, compiled.fndesc.llvm_func_name, symbol)
    except RuntimeError as error:
        raise CannotCompile(reason(error)) from error
    if foreign := sorted(f.name for f in module.functions if f.is_declaration and not LIBRARY.fullmatch(f.name)):
        raise CannotCompile(f"its machine code needs Python when it runs ({', '.join(foreign[:3])})")
    # what exceptions say, with the places of their sources, could be read by Python only
    return COUNTED.sub('!"', PLATFORM.sub("", PICKLED.sub(r"\1 zeroinitializer", str(module))))


def _leave_only(module: Any, name: str, symbol: str) -> None:
    """Rename one function, and remove all that it does not need: numba adds ways to call it from Python."""
    for function in module.functions:
        if function.name == name:
            function.name, function.visibility = symbol, "hidden"
        elif not function.is_declaration:
            function.linkage = "internal"
    for variable in module.global_variables:
        if variable.linkage == llvm.Linkage.common:
            variable.linkage = "internal"
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    machine = llvm.Target.from_default_triple().create_target_machine()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options()))
    helpers = [each for each in module.functions if not each.is_declaration and each.name != symbol]
    for number, helper in enumerate(helpers):  # so that the same block is the same text
        helper.name = f"{symbol}_{number}"
