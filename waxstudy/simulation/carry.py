"""The loop of a `Standalone` chain, and the object files of loop and blocks, kept in the folder of compiled code."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import llvmlite.binding as llvm
import numpy as np
from llvmlite import ir
from numba import carray, njit, types
from numba.core import cgutils
from numba.extending import intrinsic

from waxstudy.plugin import CHAIN, Block
from waxstudy.plugin.registry import PluginError
from waxstudy.results.atomic import whole_file
from waxstudy.simulation.cache import cached
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.kernel import CHAIN_LENGTH, CONTROLLER
from waxstudy.simulation.machine_code import alone, machine_code
from waxstudy.simulation.records import parameter_dtype, parameter_record, state_dtype, state_record
from waxstudy.simulation.sources import digest, function_digest
from waxstudy.simulation.standalone import CARRY, ROW, Address, Stage, Standalone, Told
from waxstudy.simulation.typed import CannotCompile
from waxstudy.study.model import Choice

ADDRESSES = sum(each[1] is Address for each in Told._fields_)
NUMBERS = len(Told._fields_) - ADDRESSES


@intrinsic
def _call_step(typingctx, step, p, x, u, t, dt):  # type: ignore[no-untyped-def]
    """Call the machine code of a block's step by its address; NaN where it raised."""
    signature = types.float64(types.int64, types.int64, types.int64, types.float64, types.float64, types.float64)

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        pointer, number, status = cgutils.voidptr_t, ir.DoubleType(), ir.IntType(32)
        function = ir.FunctionType(status, [pointer, pointer, pointer, pointer, number, number, number])
        returned, raised = cgutils.alloca_once(builder, number), cgutils.alloca_once(builder, pointer)
        places = [builder.bitcast(each, pointer) for each in (returned, raised)]
        records = [builder.inttoptr(arg, pointer) for arg in args[1:3]]
        code = builder.call(builder.inttoptr(args[0], function.as_pointer()), [*places, *records, *args[3:]])
        is_well = builder.icmp_signed("==", code, ir.Constant(status, 0))
        return builder.select(is_well, builder.load(returned), ir.Constant(number, float("nan")))

    return signature, codegen


@intrinsic
def numbers_at(typingctx, address):  # type: ignore[no-untyped-def]
    """Return the memory at an address as numbers, for `carray`."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        return builder.inttoptr(args[0], context.get_value_type(signature.return_type))

    return types.CPointer(types.float64)(types.int64), codegen


@intrinsic
def addresses_at(typingctx, address):  # type: ignore[no-untyped-def]
    """Return the memory at an address as addresses, for `carray`."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        return builder.inttoptr(args[0], context.get_value_type(signature.return_type))

    return types.CPointer(types.int64)(types.int64), codegen


def carry(told):  # type: ignore[no-untyped-def]
    """Run the chain on a straight temperature (`standalone.Told` is at `told`).

    Returns the mean flow, or below zero which block failed at which step.
    """
    given = carray(addresses_at(told), ADDRESSES)
    number = carray(numbers_at(told + 8 * ADDRESSES), NUMBERS)
    setpoint, sensed, rise, start_s, dt = number[0], number[1], number[2], number[3], number[4]
    step, p = carray(addresses_at(given[0]), CHAIN_LENGTH), carray(addresses_at(given[1]), CHAIN_LENGTH)
    x, low = carray(addresses_at(given[2]), CHAIN_LENGTH), carray(numbers_at(given[3]), CHAIN_LENGTH)
    high, count = carray(numbers_at(given[4]), CHAIN_LENGTH), given[5]
    row = carray(numbers_at(given[6]), count * ROW)
    total = 0.0
    for n in range(count):
        ahead_s = n * dt
        reading = sensed + rise * ahead_s
        u = reading
        for k in range(CHAIN_LENGTH):
            if k == CONTROLLER:
                u = setpoint - u
            if step[k] != 0:
                u = _call_step(step[k], p[k], x[k], u, start_s + ahead_s, dt)
                if not (low[k] <= u <= high[k]):  # false for NaN too
                    return -1.0 - (n * CHAIN_LENGTH + k)
            if k > 0:
                row[n * ROW + k - 1] = u
        row[n * ROW + CHAIN_LENGTH - 1] = reading
        total += u
    return total / count


def standalone(blocks: Mapping[str, Choice], step_s: float, setpoint_C: float) -> Standalone | None:
    """Return the chain of a case as machine code at rest, None where a block has to run in Python."""
    chain = Chain(blocks, step_s)
    code_of: Callable[..., bytes] = _of_block  # a cached function takes hashable arguments, which classes are
    try:
        pairs = zip(chain.blocks, chain.plain, strict=True)
        codes = [code_of(block, parameter_dtype(plain)) for block, plain in pairs if block]
    except (CannotCompile, PluginError):  # Python says what is wrong with it, or runs it
        return None
    stages = [
        Stage(
            kind,
            _symbol(block),
            f"{kind} '{block.name}'",
            parameter_record(plain).tobytes(),
            state_record(state).tobytes(),
            block.output.low,
            block.output.high,
        )
        if block
        else Stage(kind)
        for kind, block, plain, state in zip(CHAIN, chain.blocks, chain.plain, chain.start(), strict=True)
    ]
    return Standalone([of_plain(carry, CARRY), *codes], stages, setpoint_C)


def _symbol(block: type[Block]) -> str:
    return f"step_of_{block.kind}"


@cache
def _of_block(block: type[Block], layout: np.dtype[Any]) -> bytes:
    step = block.step
    assert isinstance(step, FunctionType)
    key = (function_digest(step), str(layout), str(state_dtype(block.State)), _symbol(block))
    return of_text(key, lambda: machine_code(block, layout, _symbol(block)))


@cache
def of_plain(function: FunctionType, symbol: str) -> bytes:
    """Return the object file of a function of one address that gives a number."""

    def text() -> str:
        compiled = njit(types.float64(types.int64), error_model="numpy", no_cpython_wrapper=True)(function)
        (found,) = compiled.overloads.values()
        return alone(found, symbol)

    return of_text((function_digest(function), symbol), text)


def of_text(key: tuple[str, ...], text: Callable[[], str]) -> bytes:
    """Return the object file of LLVM's text, from the folder of compiled code if it is whole there."""
    name = digest((*key, llvm.get_default_triple()))

    def build(folder: Path | None) -> bytes:
        path = folder / f"alone_{name}.o" if folder else None
        if path and path.is_file():
            data = path.read_bytes()
            if hashlib.sha256(data[32:]).digest() == data[:32]:
                return data[32:]
        code = _object_file(text())
        if path:
            with whole_file(path) as temporary:
                temporary.write_bytes(hashlib.sha256(code).digest() + code)
        return code

    return cached(build)


def _object_file(text: str) -> bytes:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    module = llvm.parse_assembly(text)
    for function in module.functions:
        if not function.is_declaration and function.linkage != llvm.Linkage.internal:
            function.visibility = "default"  # so that it is found by its name
    return bytes(llvm.Target.from_default_triple().create_target_machine(jit=True, opt=3).emit_object(module))
