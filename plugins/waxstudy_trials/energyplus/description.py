"""The numbers of a room in EnergyPlus and its chain; what is put into a record is a change of some of them."""

from __future__ import annotations

from typing import NamedTuple

from waxstudy_trials.as_built import AsBuilt


class House(NamedTuple):
    """Thermostat, motor, valve, room; the last ones do nothing as they are. All chosen."""

    # thermostat: the air some time ago, or through a housing
    delay_s: float = 120.0
    lag_s: float = 0.0
    # controller: on and off around the setpoint, or PI with a pulse in every period
    is_pi: bool = False
    band_K: float = 0.5
    gain_1_K: float = 14.0
    integration_s: float = 3000.0
    tracking_s: float = 30.0
    period_s: float = 1800.0
    min_pulse_s: float = 180.0
    # wax motor: a product of the package waxstudy-enthalpy with others' scatter; none is ideal
    product: str = ""
    box_C: float = 21.0
    power: float = 1.0
    latent: float = 1.0
    # valve: a power's curve from where it lifts, the pump's pressure shared with the pipes and other circuits
    lift: float = 0.0
    curve: float = 1.0
    authority: float = 1.0
    coupling: float = 0.05
    full_flow_L_h: float = 150.0
    # factors on what is believed of the room
    furniture: float = 1.0
    exchange: float = 1.0  # of water and floor
    leaks: float = 1.0
    gains: float = 1.0
    sun: float = 1.0
    wall_U: float = 1.0
    window_U: float = 1.0
    exchange_m2K_W: float = 0.0  # between pipes and floor, besides what is believed
    # what may be wrong with it
    housing_s: float = 0.0  # a second lag of the thermostat
    bias_K: float = 0.0
    sun_K_kW: float = 0.0  # what the sun makes the thermostat read too much
    lockout_s: float = 0.0
    aim_K: float = 0.0  # added to the setpoint between two hours
    aim_from_h: float = 22.0
    aim_to_h: float = 6.0
    turned_K: float = 0.0  # at most, every day to another place
    inertia: float = 1.0  # factor on all that is warmed in the motor
    evening_power: float = 1.0  # from 17 to 23 h
    stop: float = 1.0  # of the stem
    play: float = 0.0  # of the plug on the stem
    dirt: float = 0.0  # opening that the plug keeps
    seat_leak: float = 0.0  # of the theoretical flow
    flow: float = 1.0  # factor on the full flow
    pump_pause_s: float = 0.0  # at the beginning of every second hour
    supply_K: float = 0.0
    cover_m2K_W: float = 0.0
    gust: float = 0.0  # share that the leaks grow by in wind
    window_L_s: float = 0.0
    window_from_h: float = 7.0
    window_hours: float = 1.0
    gains_later_h: float = 0.0
    mass: float = 1.0  # on all but the floor
    neighbour_W_K: float = 0.0
    stove_W: float = 0.0  # from 18 to 22 h while it is colder than -2 C


def built(house: House, as_built: AsBuilt | None) -> House:
    """Return a house as it was built, whatever is wrong with it besides; without a difference the same."""
    if not as_built:
        return house
    return house._replace(
        wall_U=house.wall_U * as_built["wall_U"],
        window_U=house.window_U * as_built["window_U"],
        sun=house.sun * as_built["sun"],
        gains=house.gains * as_built["gains"],
        gains_later_h=house.gains_later_h + as_built["gains_later_h"],
        furniture=house.furniture * as_built["furniture"],
        mass=house.mass * as_built["mass"],
        leaks=house.leaks * as_built["leaks"],
        flow=house.flow * as_built["flow"],
        cover_m2K_W=house.cover_m2K_W + as_built["cover_m2K_W"],
        exchange_m2K_W=house.exchange_m2K_W + as_built["exchange_m2K_W"],
        supply_K=house.supply_K - as_built["supply_sensor_K"],
        bias_K=house.bias_K + as_built["room_sensor_K"],
        power=house.power * as_built["wax"],
    )
