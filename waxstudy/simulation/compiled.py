"""Compile blocks and the loop with numba, guarded and cached on disk.

Every block becomes a C function behind a guard that turns an exception into NaN.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
from numba import carray, cfunc, from_dtype, njit, types
from numba.core.errors import NumbaWarning
from numba.extending import intrinsic, overload

from waxstudy.plugin import Block, delayed
from waxstudy.plugin.registry import PluginError
from waxstudy.simulation import kernel
from waxstudy.simulation.cache import cached
from waxstudy.simulation.records import parameter_dtype, state_dtype
from waxstudy.simulation.sources import digest, function_digest, helpers
from waxstudy.simulation.typed import CannotCompile, examine, reason

GUARD = """\
def guarded(p, x, u, t, dt):
    try:
        return step(carray(p, 1)[0], carray(x, 1)[0], u, t, dt) + 0.0
    except Exception:
        return nan
"""


# --- the delay ring, compiled ----------------------------------------------------------------------


@intrinsic
def _samples(typingctx, ring):  # type: ignore[no-untyped-def]
    """Pointer to the samples of a ring record: its own address plus its offset."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        record = builder.bitcast(args[0], context.get_value_type(types.voidptr))
        number = context.get_value_type(types.int64)
        offset = builder.load(builder.bitcast(record, number.as_pointer()))
        target = context.get_value_type(types.CPointer(types.float64))
        return builder.bitcast(builder.gep(record, [offset]), target)

    return types.CPointer(types.float64)(ring), codegen


@overload(delayed)
def _delayed_compiled(ring, value):  # type: ignore[no-untyped-def]
    def compiled(ring, value):  # type: ignore[no-untyped-def]
        if ring.length == 0:
            return value
        values = carray(_samples(ring), ring.length)
        if ring.head < 0:
            for i in range(ring.length):
                values[i] = value
            ring.head = 0
        oldest = values[ring.head]
        values[ring.head] = value
        ring.head = ring.head + 1 if ring.head + 1 < ring.length else 0  # a division would take longer than the rest
        return oldest

    return compiled


# --- compilation ---


def jitted(function: FunctionType, above: tuple[FunctionType, ...] = ()) -> Any:
    """Compile a plain function together with the plain helpers that it calls by name."""
    if function in above:
        raise CannotCompile(f"{function.__name__} calls itself by way of others")
    inner = {name: jitted(helper, (*above, function)) for name, helper in helpers(function).items()}
    namespace = function.__globals__ | inner
    copy = FunctionType(function.__code__, namespace, function.__name__, function.__defaults__, function.__closure__)
    return njit(copy, error_model="python", boundscheck=True)


@cache
def _guarded(block: type[Block], parameter_dtype: np.dtype[Any]) -> Any:
    """Compile a block's guarded C function for one layout of its parameter record."""
    step = block.step
    assert isinstance(step, FunctionType)
    layout = state_dtype(block.State)
    number = types.float64
    pointers = (types.CPointer(from_dtype(parameter_dtype)), types.CPointer(from_dtype(layout)))
    signature = number(*pointers, number, number, number)
    name = digest((function_digest(step), str(parameter_dtype), str(layout)))

    def build(folder: Path | None) -> Any:
        path = folder / f"guard_{name}.py" if folder else None
        compiled = jitted(step)
        if path is None or not path.exists():  # what was compiled before was examined before
            examine(block, compiled, parameter_dtype, layout)
            if path:
                path.write_text(GUARD)
        # numba imports the module of what it finds in its cache, so the guard needs one that exists
        namespace = {"__name__": __name__, "step": compiled, "carray": carray, "nan": float("nan")}
        exec(compile(GUARD, str(path or "<guard>"), "exec"), namespace)
        return cfunc(signature, cache=path is not None)(namespace["guarded"])

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NumbaWarning)  # e.g. that it cannot be cached, which only costs time
            return cached(build)
    except (PluginError, CannotCompile):
        raise
    except Exception as error:
        raise CannotCompile(reason(error)) from error


def address(block: type[Block], plain: Any) -> int:
    """Return the address of the compiled, guarded block for the layout of these parameters.

    Raises `CannotCompile`, or `PluginError` for a mistake that would give other results than Python does.
    """
    compile_block: Callable[..., Any] = _guarded  # a cached function takes hashable arguments, which classes are
    return int(compile_block(block, parameter_dtype(plain)).address)


_LOOP = types.int64(
    types.int64[::1],
    types.int64[::1],
    types.int64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[:, ::1],
    types.float64[:, ::1],
    types.float64[:, ::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64,
    types.float64,
    types.float64,
    types.int64,
    types.float64,
    types.float64[:, ::1],
    types.int64[::1],
    types.int64[::1],
)


@cache
def loop() -> Callable[..., int]:
    """Return the compiled loop; it releases the interpreter lock."""

    def build(folder: Path | None) -> Any:
        return njit(_LOOP, nogil=True, cache=folder is not None)(kernel.simulate)

    compiled: Callable[..., int] = cached(build)
    return compiled
