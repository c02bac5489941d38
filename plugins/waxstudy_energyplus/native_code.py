"""The machine code of `native.py`, made where numba is."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import carray, types
from numba.core import cgutils
from numba.extending import intrinsic

from waxstudy.plugin import Advance
from waxstudy.simulation.advance import ChainAdvance
from waxstudy.simulation.carry import addresses_at, numbers_at, of_plain, of_text
from waxstudy.simulation.standalone import Address, Told
from waxstudy_energyplus.native import AT, DRIVE, READ, Wire

FIELDS = [each[0] for each in Wire._fields_]
ADDRESSES = sum(each[1] is Address for each in Wire._fields_)  # the first ones
NUMBERS = len(FIELDS) - ADDRESSES


def _places(*names: str) -> list[int]:
    """Return where fields stand among the addresses, or among the numbers."""
    return [place if (place := FIELDS.index(name)) < ADDRESSES else place - ADDRESSES for name in names]


ACTIVE, STATE, GET, SET, CARRY, TOLD = _places("is_active", "state", "get_value", "set_value", "carry", "told")
HANDLES, VARIABLES, ROWS = _places("handles", "variables", "rows")
PLACES, WEIGHTS, SENSED = _places("places", "weights", "sensed")
FLOW, STEP, STEPS = _places("flow", "step", "steps")
CHAIN, SPARE, CHAIN_BYTES = _places("chain", "spare", "chain_bytes")
BEFORE, LAST, ENGINE_STEP = _places("before_C", "last_C", "engine_step_s")
FULL, FAILED = _places("full_flow_kg_s", "failed")
TOLD_NAMES = [each[0] for each in Told._fields_]
TOLD_FIELDS = len(TOLD_NAMES)
TOLD_ROWS = TOLD_NAMES.index("rows")
TOLD_SENSED, TOLD_RISE, TOLD_START = (TOLD_NAMES.index(name) for name in ("sensed_C", "rise_K_s", "start_s"))

_POINTER, _NUMBER, _INT = cgutils.voidptr_t, ir.DoubleType(), ir.IntType(32)


def _called(builder: Any, address: Any, returns: Any, *arguments: Any) -> Any:
    kind = ir.FunctionType(returns, [each.type for each in arguments])
    return builder.call(builder.inttoptr(address, kind.as_pointer()), arguments)


@intrinsic
def _get(typingctx, function, state, handle):  # type: ignore[no-untyped-def]
    """Return what the engine's function of state and handle gives."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        state = builder.inttoptr(args[1], _POINTER)
        return _called(builder, args[0], _NUMBER, state, builder.trunc(args[2], _INT))

    return types.float64(types.int64, types.int64, types.int64), codegen


@intrinsic
def _set(typingctx, function, state, handle, value):  # type: ignore[no-untyped-def]
    """Call the engine's function of state, handle and a number."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        state = builder.inttoptr(args[1], _POINTER)
        _called(builder, args[0], ir.VoidType(), state, builder.trunc(args[2], _INT), args[3])
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.int64, types.float64), codegen


@intrinsic
def _carry(typingctx, function, told):  # type: ignore[no-untyped-def]
    """Call `carry` by its address."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        mean, raised = cgutils.alloca_once(builder, _NUMBER), cgutils.alloca_once(builder, _POINTER)
        _called(builder, args[0], _INT, mean, raised, args[1])
        return builder.load(mean)

    return types.float64(types.int64, types.int64), codegen


def read(wire):  # type: ignore[no-untyped-def]
    """After reporting: keep what the step has brought; see `loop.Loop.read`."""
    at, number = carray(addresses_at(wire), ADDRESSES), carray(numbers_at(wire + 8 * ADDRESSES), NUMBERS)
    count, step = at[VARIABLES], at[STEP]
    handles, places = carray(addresses_at(at[HANDLES]), count), carray(addresses_at(at[PLACES]), at[SENSED])
    weights, row = carray(numbers_at(at[WEIGHTS]), at[SENSED]), carray(numbers_at(at[ROWS] + 8 * step * count), count)
    number[BEFORE] = number[LAST]
    if 0 <= step < at[STEPS]:
        for n in range(count):
            row[n] = _get(at[GET], at[STATE], handles[n])
    sensed = 0.0
    for n in range(at[SENSED]):
        sensed += weights[n] * _get(at[GET], at[STATE], handles[places[n]])
    number[LAST] = sensed
    at[STEP] = step + 1
    return 0.0


def drive(wire):  # type: ignore[no-untyped-def]
    """Before the predictor: let the chain run through the step, and set its mean flow; see `loop.Loop.drive`."""
    at, number = carray(addresses_at(wire), ADDRESSES), carray(numbers_at(wire + 8 * ADDRESSES), NUMBERS)
    told, told_number = carray(addresses_at(at[TOLD]), TOLD_FIELDS), carray(numbers_at(at[TOLD]), TOLD_FIELDS)
    step = at[STEP]
    told_number[TOLD_SENSED] = number[LAST]
    told_number[TOLD_RISE] = (number[LAST] - number[BEFORE]) / number[ENGINE_STEP]
    told_number[TOLD_START] = step * number[ENGINE_STEP]
    told[TOLD_ROWS] = at[CHAIN] + step * at[CHAIN_BYTES] if 0 <= step < at[STEPS] else at[SPARE]
    mean = _carry(at[CARRY], at[TOLD])
    if mean < 0.0:
        number[FAILED] = mean
        at[ACTIVE] = 0  # Python is called next, and raises
    else:
        _set(at[SET], at[STATE], at[FLOW], mean * number[FULL])
    return 0.0


CALLBACK = """
@python_{name} = global ptr null
declare i32 @{name}(ptr, ptr, i64)
define void @{at}{name}(ptr %state) {{
  %given = alloca double
  %raised = alloca ptr
  %wire = load i64, ptr @wire
  %place = inttoptr i64 %wire to ptr
  %active = load i64, ptr %place
  %is_python = icmp eq i64 %active, 0
  br i1 %is_python, label %python, label %native
native:
  %code = call i32 @{name}(ptr %given, ptr %raised, i64 %wire)
  ret void
python:
  %function = load ptr, ptr @python_{name}
  call void %function(ptr %state)
  ret void
}}
"""


def codes_for(advance: Advance) -> tuple[bytes, ...]:
    """Return the object files that a run's process loads besides those of a chain; none for one that runs in Python."""
    if not (isinstance(advance, ChainAdvance) and advance.is_machine_code):
        return ()
    text = "@wire = global i64 0\n" + "".join(CALLBACK.format(at=AT, name=name) for name in (READ, DRIVE))
    return of_plain(read, READ), of_plain(drive, DRIVE), of_text((text,), lambda: text)
