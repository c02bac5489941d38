"""What is put into a room in EnergyPlus: changes of the numbers of its chain, its description and what drives it.

Values carry the library's names where they mean the same there, and names of their own where they do not.
"""

from __future__ import annotations

from collections.abc import Mapping

from waxstudy_trials.dial import SETPOINT_OFFSET
from waxstudy_trials.put import Change, Put, Range, as_it_is, effect
from waxstudy_trials.put_families import OF_CHAIN, OF_ROOM

PLAIN = 10.0  # what a period is rounded to [s]


def times(own: str, name: str = "factor") -> Change:
    """Return the change of one number by a factor."""
    return lambda house, values: {own: getattr(house, own) * values[name]}


EITHER_WAY = Range(0.1, 8.0, is_signed=True, is_factor=True)
SENSOR = (
    effect(
        "sensor-delay",
        "sensor",
        lambda house, v: {"delay_s": house.delay_s + v["later_s"]},
        later_s=Range(10.0, 1700.0),
    ),
    effect("sensor-lag", "sensor", as_it_is("housing_s", "time_constant_s"), time_constant_s=Range(15.0, 2400.0)),
    effect("sensor-bias", "sensor", as_it_is("bias_K", "bias_K"), bias_K=Range(0.02, 2.0, is_signed=True)),
)
CONTROL = (
    effect(
        "dead-band", "controller", lambda house, v: {"band_K": house.band_K + v["wider_K"]}, wider_K=Range(0.04, 1.5)
    ),
    SETPOINT_OFFSET,
    effect(
        "pi-tuning",
        "controller",
        lambda house, v: {
            "gain_1_K": house.gain_1_K * v["gain_factor"],
            "integration_s": house.integration_s * v["time_factor"],
        },
        gain_factor=EITHER_WAY,
        time_factor=EITHER_WAY,
    ),
    effect(
        "pwm-period",
        "modulator",
        lambda house, v: {"period_s": PLAIN * round(house.period_s * v["factor"] / PLAIN)},
        factor=Range(0.02, 1.5, is_signed=True, is_factor=True),
    ),
    effect(
        "min-pulse",
        "modulator",
        lambda house, v: {"min_pulse_s": house.min_pulse_s + v["longer_s"]},
        longer_s=Range(10.0, 500.0),
    ),
)
MOTOR = (
    effect("wax-motor", "actuator", lambda house, v: {"product": "B", "inertia": v["size"]}, size=Range(0.1, 3.0)),
    effect("slow-actuator", "actuator", as_it_is("inertia", "factor"), factor=Range(0.05, 3.0, is_factor=True)),
    effect(
        "limited-travel",
        "actuator",
        lambda house, v: {"stop": 1.0 - v["short_of_open"]},
        short_of_open=Range(0.02, 0.8),
    ),
)
VALVE = (
    effect("let-by", "valve", as_it_is("seat_leak", "leak"), leak=Range(0.0005, 0.08)),
    effect("stuck-open", "valve", lambda house, v: {"dirt": house.lift + v["lifted"]}, lifted=Range(0.002, 0.2)),
    effect(
        "low-authority",
        "valve",
        lambda house, v: {"authority": min(1.0, house.authority * v["pressure"])},
        pressure=Range(0.3, 6.0, is_signed=True, is_factor=True),
    ),
    effect(
        "quick-opening",
        "valve",
        lambda house, v: {"lift": v["lift"], "curve": v["curve"], "authority": v["authority"]},
        lift=Range(0.01, 0.25),
        curve=Range(0.05, 1.5, is_factor=True),
        authority=Range(0.08, 1.0),
    ),
    effect("max-flow", "valve", as_it_is("flow", "factor"), factor=Range(0.03, 1.2, is_signed=True, is_factor=True)),
)
ROOM = (
    effect("supply-offset", "emitter", as_it_is("supply_K", "offset_K"), offset_K=Range(0.1, 6.0, is_signed=True)),
    effect("floor-cover", "emitter", as_it_is("cover_m2K_W", "resistance_m2K_W"), resistance_m2K_W=Range(0.004, 0.3)),
    effect("infiltration", "room", times("leaks"), factor=Range(0.5, 30.0, is_factor=True)),
    effect(
        "window-opening",
        "room",
        lambda house, v: {"window_L_s": v["flow_L_s"], "window_from_h": v["from_h"], "window_hours": v["hours"]},
        flow_L_s=Range(0.5, 60.0),
        from_h=Range(0.0, 24.0, is_even=True),
        hours=Range(0.5, 3.0),
    ),
    effect("solar-factor", "room", times("sun"), factor=Range(0.1, 2.5, is_signed=True, is_factor=True)),
    effect(
        "gain-shift",
        "room",
        lambda house, v: {"gains_later_h": v["shift_h"], "gains": house.gains * v["factor"]},
        shift_h=Range(0.3, 10.0, is_signed=True),
        factor=Range(0.1, 3.0, is_signed=True, is_factor=True),
    ),
    effect("thermal-mass", "room", as_it_is("mass", "factor"), factor=Range(0.1, 3.0, is_factor=True)),
    effect("neighbour-heat", "room", as_it_is("neighbour_W_K", "conductance_W_K"), conductance_W_K=Range(0.5, 30.0)),
)
PUTS: Mapping[str, Put] = {
    put.cause.name: put for put in (*SENSOR, *CONTROL, *MOTOR, *VALVE, *ROOM, *OF_CHAIN, *OF_ROOM)
}

# what the chain must be for a cause to change anything, or to be one that is not believed
NEEDS: Mapping[str, Mapping[str, bool]] = {
    "sensor-delay": {"is_late": True},
    "dead-band": {"is_pi": False},
    "pi-tuning": {"is_pi": True},
    "pwm-period": {"is_pi": True},
    "min-pulse": {"is_pi": True},
    "wax-motor": {"is_motor": False},
    "slow-actuator": {"is_motor": True},
    "weak-at-night": {"is_motor": True},
    "low-authority": {"is_curved": True, "is_motor": True},
    "quick-opening": {"is_curved": False, "is_motor": True},
    "sticking-valve": {"is_motor": True},
}
