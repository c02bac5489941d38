"""The numbers of a plant; what is put into a record is a change of some of them."""

from __future__ import annotations

from typing import NamedTuple

from waxstudy_trials.as_built import AsBuilt

WARM_UP_S = 3 * 86_400  # before a record begins


class Plant(NamedTuple):
    """Room, floor, circuit, valve, motor, thermostat; the last ones do nothing as they are. All chosen."""

    # thermostat: the air through a housing; on and off around the setpoint
    sensor_s: float = 90.0
    band_K: float = 0.5
    # wax motor: enthalpy of wax and heater, a PTC's power, loss to the manifold's box, melting range, stem
    power_W: float = 18.0
    power_fall_1_K: float = 1.0 / 110.0
    loss_W_K: float = 0.186
    heat_J_K: float = 75.0
    latent_J: float = 800.0
    melts_C: float = 55.0
    molten_C: float = 62.0
    box_C: float = 25.0
    friction: float = 0.015
    # valve: an exponential curve from where it lifts, the pump's pressure shared with the pipes and other circuits
    lift: float = 0.12
    curve: float = 1.6
    authority: float = 0.15
    full_flow_L_h: float = 122.0
    coupling: float = 0.15
    # circuit: pipe in the slab
    pipe_m: float = 34.7
    pipe_outer_m: float = 0.020
    pipe_inner_m: float = 0.016
    pipe_W_mK: float = 0.35
    spacing_m: float = 0.30
    # floor: cells from the top, screed above and below the pipes, concrete, insulation
    area_m2: float = 10.4
    above_m: float = 0.040
    below_m: float = 0.020
    concrete_m: float = 0.050
    screed_W_mK: float = 1.2
    screed_J_m3K: float = 2.0e6
    concrete_W_mK: float = 1.7
    concrete_J_m3K: float = 2.07e6
    floor_U_W_m2K: float = 0.08
    # room: air, furniture, boards of walls and ceiling, panes
    volume_m3: float = 27.0
    furniture_J_K: float = 2.2e5
    furniture_W_K: float = 25.0
    wall_m2: float = 11.2
    partition_m2: float = 17.2
    board_J_m2K: float = 11_050.0
    wall_U_W_m2K: float = 0.12
    window_m2: float = 6.0
    window_U_W_m2K: float = 0.75
    pane_J_m2K: float = 8_400.0
    bridge_W_K: float = 0.85
    leak_L_s: float = 0.133
    ventilation_L_s: float = 5.2
    gain_radiant: float = 0.4
    sun_on_floor: float = 0.55
    # what may be wrong with it
    housing_s: float = 0.0  # a second lag of the thermostat
    bias_K: float = 0.0
    sun_K_kW: float = 0.0  # what the sun makes the thermostat read too much
    lockout_s: float = 0.0
    aim_K: float = 0.0  # added to the setpoint between two hours
    aim_from_h: float = 22.0
    aim_to_h: float = 6.0
    turned_K: float = 0.0  # at most, every day to another place
    inertia: float = 1.0  # of the motor
    evening_power: float = 1.0  # from 17 to 23 h
    stop: float = 1.0  # of the stem
    play: float = 0.0  # of the plug on the stem
    dirt: float = 0.0  # lift that the plug keeps
    seat_leak: float = 0.0  # of the theoretical flow
    pump_pause_s: float = 0.0  # at the beginning of every second hour
    supply_K: float = 0.0
    pipe_L: float = 0.0  # of water between the sensor and the circuit
    air_lock: float = 1.0  # factor on the exchange in the second half of the record
    cover_m2K_W: float = 0.0
    gust: float = 0.0  # share that the leaks grow by in wind
    window_L_s: float = 0.0
    window_from_h: float = 7.0
    window_to_h: float = 8.0
    sun: float = 1.0
    mass: float = 1.0  # on all but the floor
    neighbour_W_K: float = 0.0
    stove_W: float = 0.0  # from 18 to 22 h while it is colder than -2 C
    exchange_m2K_W: float = 0.0  # between pipes and floor, besides what is believed


def built(plant: Plant, as_built: AsBuilt | None) -> Plant:
    """Return a plant as it was built, whatever is wrong with it besides; gains are no number of a plant."""
    if not as_built:
        return plant
    return plant._replace(
        wall_U_W_m2K=plant.wall_U_W_m2K * as_built["wall_U"],
        window_U_W_m2K=plant.window_U_W_m2K * as_built["window_U"],
        sun=plant.sun * as_built["sun"],
        furniture_J_K=plant.furniture_J_K * as_built["furniture"],
        mass=plant.mass * as_built["mass"],
        leak_L_s=plant.leak_L_s * as_built["leaks"],
        full_flow_L_h=plant.full_flow_L_h * as_built["flow"],
        cover_m2K_W=plant.cover_m2K_W + as_built["cover_m2K_W"],
        exchange_m2K_W=plant.exchange_m2K_W + as_built["exchange_m2K_W"],
        supply_K=plant.supply_K - as_built["supply_sensor_K"],
        bias_K=plant.bias_K + as_built["room_sensor_K"],
        power_W=plant.power_W * as_built["wax"],
    )
