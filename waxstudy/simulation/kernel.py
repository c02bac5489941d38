"""The time loop, written once and run compiled or interpreted with bit-identical results.

Compiled, a block is the address of its guarded function and its parameters and state are addresses of records;
interpreted, they are the Python objects themselves. `call_block` and `free_step` are the only places that differ.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from waxstudy.plugin import TRACE as TRACE
from waxstudy.simulation.lanes import free_step

CHAIN_LENGTH = 5  # sensor, controller, modulator, actuator, valve
CONTROLLER = 1

STOPPED = -2
DONE = -1
ROOM = CHAIN_LENGTH  # code of a failure that is not a block's
COLDEST_C, HOTTEST_C = -200.0, 500.0  # no room leaves this range; NaN does


def call_block(step: Any, p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Call one block (the interpreted way; the compiled way is the overload below)."""
    return float(step(p, x, u, t, dt))


@intrinsic
def _call_address(typingctx, step, p, x, u, t, dt):  # type: ignore[no-untyped-def]
    signature = types.float64(types.int64, types.int64, types.int64, types.float64, types.float64, types.float64)

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        pointer, number = cgutils.voidptr_t, ir.DoubleType()
        function = ir.FunctionType(number, [pointer, pointer, number, number, number])
        address = builder.inttoptr(args[0], function.as_pointer())
        records = [builder.inttoptr(arg, pointer) for arg in args[1:3]]
        return builder.call(address, [*records, *args[3:]])

    return signature, codegen


@overload(call_block)
def _call_block_compiled(step, p, x, u, t, dt):  # type: ignore[no-untyped-def]
    return lambda step, p, x, u, t, dt: _call_address(step, p, x, u, t, dt)


def simulate(  # noqa: C901 - one loop, compiled as a whole
    steps: Any,  # (5,) block functions, 0 where the chain leaves the block out
    parameters: Any,  # (5,)
    states: Any,  # (5,) changed in place
    low: Any,  # (5,) and high: range of each block's output
    high: Any,
    decay: Any,  # (modes,) exp(-lambda dt); as many as fill whole `lanes.LANES`
    heat_gain: Any,  # (modes,) per W of floor heat held over a step
    forcing: Any,  # (intervals, modes) of the slow inputs, per step
    outputs: Any,  # (6, modes) rows of ROOM_OUTPUTS
    offsets: Any,  # (intervals, 6) direct part of the slow inputs
    heat_offset: Any,  # (6,) direct part of the floor heat
    supply: Any,  # (intervals,) C
    conductance: Any,  # (table,) W/K over the flow fraction 0..1
    modes: Any,  # (modes,) state, changed in place
    readings: Any,  # (3,) sensed, layer, operative at the start; changed in place
    setpoint: float,
    start_s: float,
    dt: float,
    steps_per_interval: int,
    limit: float,  # operative temperature below which a step counts as cold
    trace: Any,  # (steps, len(TRACE)), or (0, ...) for none
    counters: Any,  # (2,) cold steps; failing step
    stop: Any,  # (1,) set from outside to end the loop at the next interval
) -> int:
    """Run the loop over all intervals; return DONE, STOPPED, ROOM, or the index of the block that failed."""
    n_modes = len(decay)
    last = len(conductance) - 1
    recording = len(trace) > 0
    sensed, layer, operative = readings[0], readings[1], readings[2]
    row_air, row_surface, row_heat = outputs[3], outputs[4], outputs[5]
    # what a watt over a step does to these three by its end
    by_sensed, by_layer, by_operative = heat_offset[0], heat_offset[1], heat_offset[2]
    for i in range(n_modes):
        by_sensed += outputs[0][i] * heat_gain[i]
        by_layer += outputs[1][i] * heat_gain[i]
        by_operative += outputs[2][i] * heat_gain[i]
    n = 0
    cold = 0
    for interval in range(len(supply)):
        if stop[0] != 0:
            return STOPPED
        force, offset, supply_C = forcing[interval], offsets[interval], supply[interval]
        for _ in range(steps_per_interval):
            # the step without its heat, first: a processor works on it while it waits for one block after the other
            free_sensed, free_layer, free_operative = free_step(decay, force, outputs, modes)
            t = start_s + n * dt
            u = sensed
            output = 0.0
            signal = 0.0
            opening = 0.0
            for k in range(CHAIN_LENGTH):
                if k == CONTROLLER:
                    u = setpoint - u
                if steps[k] != 0:
                    u = call_block(steps[k], parameters[k], states[k], u, t, dt)
                    # false for NaN too
                    if not (low[k] <= u <= high[k]):
                        counters[1] = n
                        return k
                if k == 1:
                    output = u
                elif k == 2:
                    signal = u
                elif k == 3:
                    opening = u
            place = u * last
            index = min(int(place), last - 1)
            part = place - index
            heat = (conductance[index] * (1.0 - part) + conductance[index + 1] * part) * (supply_C - layer)
            sensed = offset[0] + free_sensed + by_sensed * heat
            layer = offset[1] + free_layer + by_layer * heat
            operative = offset[2] + free_operative + by_operative * heat
            for i in range(n_modes):
                modes[i] += heat_gain[i] * heat
            if operative < limit:
                cold += 1
            if recording:
                air = offset[3] + heat_offset[3] * heat
                surface = offset[4] + heat_offset[4] * heat
                floor_heat = offset[5] + heat_offset[5] * heat
                for i in range(n_modes):
                    air += row_air[i] * modes[i]
                    surface += row_surface[i] * modes[i]
                    floor_heat += row_heat[i] * modes[i]
                row = trace[n]
                row[0] = air
                row[1] = operative
                row[2] = surface
                row[3] = layer
                row[4] = floor_heat
                row[5] = output
                row[6] = signal
                row[7] = opening
                row[8] = u
                row[9] = heat
            n += 1
        if not (COLDEST_C < operative < HOTTEST_C and COLDEST_C < layer < HOTTEST_C):
            counters[1] = n
            return ROOM
    readings[0] = sensed
    readings[1] = layer
    readings[2] = operative
    counters[0] = cold
    return DONE
