"""The part of the room's step that needs no heat, several modes at a time as a processor's vectors have them.

Compiled and interpreted, sums are taken in the same order, so that they are equal to the bit.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

LANES = 4  # modes at a time; their number is a multiple of it


def free_step(decay: Any, force: Any, outputs: Any, modes: Any) -> tuple[float, float, float]:
    """Let every mode fade and be forced for a step, in place; return what the first three outputs have of them."""
    for i in range(len(modes)):
        modes[i] = decay[i] * modes[i] + force[i]
    return _sum(outputs[0], modes), _sum(outputs[1], modes), _sum(outputs[2], modes)


def _sum(row: Any, modes: Any) -> float:
    """Sum of products: one partial sum in each lane."""
    a = b = c = d = 0.0
    for i in range(0, len(modes), LANES):
        a += row[i] * modes[i]
        b += row[i + 1] * modes[i + 1]
        c += row[i + 2] * modes[i + 2]
        d += row[i + 3] * modes[i + 3]
    return float((a + c) + (b + d))


@intrinsic
def _free_step(typingctx, decay, force, outputs, modes):  # type: ignore[no-untyped-def]
    signature = types.UniTuple(types.float64, 3)(decay, force, outputs, modes)
    vector, whole = ir.VectorType(ir.DoubleType(), LANES), ir.IntType(32)

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        given = zip(signature.args, args, strict=True)
        decay, force, outputs, modes = (context.make_array(kind)(context, builder, arg) for kind, arg in given)
        count = cgutils.unpack_tuple(builder, modes.shape, 1)[0]

        def lanes(array: Any, place: Any) -> Any:
            return builder.bitcast(builder.gep(array.data, [place]), vector.as_pointer())

        def load(array: Any, place: Any) -> Any:
            return builder.load(lanes(array, place), align=8)

        sums = [cgutils.alloca_once_value(builder, ir.Constant(vector, [0.0] * LANES)) for _ in range(3)]
        with cgutils.for_range_slice(builder, count.type(0), count, count.type(LANES), inc=True) as (i, _):
            value = builder.fadd(builder.fmul(load(decay, i), load(modes, i)), load(force, i))
            builder.store(value, lanes(modes, i), align=8)
            for k, total in enumerate(sums):
                row = load(outputs, builder.add(i, builder.mul(count, count.type(k))))
                builder.store(builder.fadd(builder.load(total), builder.fmul(row, value)), total)
        results = []
        for total in sums:
            a, b, c, d = (builder.extract_element(builder.load(total), whole(k)) for k in range(LANES))
            results.append(builder.fadd(builder.fadd(a, c), builder.fadd(b, d)))
        return context.make_tuple(builder, signature.return_type, results)

    return signature, codegen


@overload(free_step)
def _free_step_compiled(decay, force, outputs, modes):  # type: ignore[no-untyped-def]
    return lambda decay, force, outputs, modes: _free_step(decay, force, outputs, modes)
