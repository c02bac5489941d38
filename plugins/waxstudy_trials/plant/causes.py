"""What is put into a plant: changes of its own numbers, effects of the library and families outside it.

Values carry the library's names where they mean the same there, and names of their own where they do not.
"""

from __future__ import annotations

from collections.abc import Mapping

from waxstudy_trials.dial import SETPOINT_OFFSET
from waxstudy_trials.put import Put, Range, as_it_is, effect, family
from waxstudy_trials.put_families import OF_CHAIN, OF_ROOM

EFFECTS = (
    effect("sensor-lag", "sensor", as_it_is("housing_s", "time_constant_s"), time_constant_s=Range(15.0, 2400.0)),
    effect("sensor-bias", "sensor", as_it_is("bias_K", "bias_K"), bias_K=Range(0.02, 2.0, is_signed=True)),
    effect(
        "dead-band",
        "controller",
        lambda plant, v: {"band_K": max(0.05, plant.band_K + v["wider_K"])},
        wider_K=Range(0.04, 1.5),
    ),
    SETPOINT_OFFSET,
    effect("slow-actuator", "actuator", as_it_is("inertia", "factor"), factor=Range(0.05, 3.0, is_factor=True)),
    effect(
        "limited-travel",
        "actuator",
        lambda plant, v: {"stop": 1.0 - v["short_of_open"]},
        short_of_open=Range(0.02, 0.8),
    ),
    effect("let-by", "valve", as_it_is("seat_leak", "leak"), leak=Range(0.0005, 0.08)),
    effect("stuck-open", "valve", lambda plant, v: {"dirt": plant.lift + v["lifted"]}, lifted=Range(0.002, 0.2)),
    effect(
        "max-flow",
        "valve",
        lambda plant, v: {"full_flow_L_h": plant.full_flow_L_h * v["factor"]},
        factor=Range(0.03, 1.2, is_signed=True, is_factor=True),
    ),
    effect(
        "low-authority",
        "valve",
        lambda plant, v: {"authority": min(1.0, plant.authority * v["pressure"])},
        pressure=Range(0.3, 9.0, is_signed=True, is_factor=True),
    ),
    effect("supply-offset", "emitter", as_it_is("supply_K", "offset_K"), offset_K=Range(0.1, 6.0, is_signed=True)),
    effect("pipe-delay", "emitter", as_it_is("pipe_L", "volume_L"), volume_L=Range(0.3, 15.0)),
    effect("floor-cover", "emitter", as_it_is("cover_m2K_W", "resistance_m2K_W"), resistance_m2K_W=Range(0.004, 0.3)),
    effect(
        "infiltration",
        "room",
        lambda plant, v: {"leak_L_s": plant.leak_L_s * v["factor"]},
        factor=Range(0.5, 30.0, is_factor=True),
    ),
    effect(
        "window-opening",
        "room",
        lambda plant, v: {
            "window_L_s": v["flow_L_s"],
            "window_from_h": v["from_h"],
            "window_to_h": (v["from_h"] + v["hours"]) % 24.0,
        },
        flow_L_s=Range(0.5, 60.0),
        from_h=Range(0.0, 24.0, is_even=True),
        hours=Range(0.5, 3.0),
    ),
    effect(
        "solar-factor",
        "room",
        lambda plant, v: {"sun": plant.sun * v["factor"]},
        factor=Range(0.1, 2.5, is_signed=True, is_factor=True),
    ),
    effect("thermal-mass", "room", as_it_is("mass", "factor"), factor=Range(0.1, 3.0, is_factor=True)),
    effect("neighbour-heat", "room", as_it_is("neighbour_W_K", "conductance_W_K"), conductance_W_K=Range(0.5, 30.0)),
)

AIR_LOCK = family(
    "air-lock", ("emitter", "room"), lambda plant, v: {"air_lock": 1.0 - v["less"]}, True, less=Range(0.05, 0.9)
)
PUTS: Mapping[str, Put] = {put.cause.name: put for put in (*EFFECTS, *OF_CHAIN, AIR_LOCK, *OF_ROOM)}
