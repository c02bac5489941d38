"""The loop of a plant, second by second; equations in docs/blind_test_records.md.

Beside a record, stages up to one are driven by what the record has before them, and what follows by that one: so
only its own equations differ, and all that they change shows.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy_trials.dial import turn_of
from waxstudy_trials.plant.description import WARM_UP_S, Plant
from waxstudy_trials.plant.weather import PART_S, Weather

_turn_of = numba.njit(cache=True)(turn_of)
WATER_J_L_K = 4180.0
AIR_J_L_K = 1.206
CELLS = 9  # of the floor: four above the pipes, two below, three of concrete
RADIATION_W_M2K = 5.1
COLUMNS = (
    "air_C",
    "reading_C",
    "output",
    "opening",
    "flow_L_h",
    "operative_C",
    "floor_surface_C",
    "return_C",
    "supply_C",
)
# how many stages, from the sensor on, a record drives up to one
FORCED = {"sensor": 1, "controller": 2, "modulator": 2, "actuator": 3, "valve": 4, "emitter": 5, "room": 5}
AIR, READING, OUTPUT, OPENING, FLOW, OPERATIVE, SURFACE, RETURN, SUPPLY = range(len(COLUMNS))


def simulate(
    plant: Plant, weather: Weather, setpoint_C: float, recorded: FloatArray | None = None, stage: str = "room"
) -> FloatArray:
    """Return the columns of every second (n, columns); stages up to the one named are driven by a record, if any."""
    seconds = len(weather.outdoor_C) * PART_S
    forced = FORCED[stage] if recorded is not None else 0
    before = recorded if recorded is not None else np.zeros((1, len(COLUMNS)))
    found = np.zeros((seconds, len(COLUMNS)))
    _run(plant, weather, setpoint_C, before, forced, found)
    return found


@numba.njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _lifted(p: Any, opening: float) -> float:
    """Return the flow fraction of an opening, at the nominal pressure."""
    x = max(0.0, (opening - p.lift) / (1.0 - p.lift))
    v = (1.0 - math.exp(-p.curve * x)) / (1.0 - math.exp(-p.curve))
    v = p.seat_leak + (1.0 - p.seat_leak) * v
    return v / math.sqrt(v * v * (1.0 - p.authority) + p.authority)


@numba.njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _wax_C(p: Any, heat_J: float) -> tuple[float, float]:
    """Return temperature and molten share of the wax at an enthalpy above that of the box."""
    solid_J = p.heat_J_K * (p.melts_C - p.box_C)
    span_J = p.latent_J + p.heat_J_K * (p.molten_C - p.melts_C)
    if heat_J <= solid_J:
        return p.box_C + heat_J / p.heat_J_K, 0.0
    if heat_J <= solid_J + span_J:
        share = (heat_J - solid_J) / span_J
        return p.melts_C + share * (p.molten_C - p.melts_C), share
    return p.molten_C + (heat_J - solid_J - span_J) / p.heat_J_K, 1.0


@numba.njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _exchange_W_K(p: Any, flow_L_h: float) -> float:
    """Return what water and slab exchange per kelvin: film, pipe wall and shape of the slab in series."""
    film = 165.0 * max(1.0, (flow_L_h / 45.0) ** 0.8) * math.pi * p.pipe_inner_m * p.pipe_m
    wall = 2.0 * math.pi * p.pipe_W_mK * p.pipe_m / math.log(p.pipe_outer_m / p.pipe_inner_m)
    slab = 2.0 * math.pi * p.screed_W_mK * p.pipe_m / math.log(p.spacing_m / (math.pi * p.pipe_outer_m))
    return 1.0 / (1.0 / film + 1.0 / wall + 1.0 / slab + p.exchange_m2K_W / p.area_m2)


@numba.njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _film_W_m2K(warmer_K: float, is_free: bool) -> float:
    """Return natural convection: 1.31 |dT|^(1/3) where warm air rises off a surface, 0.76 where it stays."""
    return (1.31 if is_free else 0.76) * max(0.05, abs(warmer_K)) ** (1.0 / 3.0)


@numba.njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _run(p: Any, w: Any, setpoint_C: float, before: Any, forced: int, found: Any) -> None:  # noqa: C901
    seconds = len(found)
    cells_J_K, links_W_K = _floor(p)
    floor = np.full(CELLS, setpoint_C + 2.0)
    air, furniture, wall, partition, pane = setpoint_C, setpoint_C, setpoint_C, setpoint_C, setpoint_C - 2.0
    seen, housed = setpoint_C, setpoint_C
    output, since_s = 0.0, 1e6
    heat_J, stem, plug, water_C = 0.0, 0.0, 0.0, 22.0
    volume_L, tail = np.zeros(seconds), 0
    star = setpoint_C
    for n in range(seconds):
        part = n // PART_S
        share = (n % PART_S) / PART_S
        nxt = min(part + 1, len(w.outdoor_C) - 1)
        outdoor = w.outdoor_C[part] + share * (w.outdoor_C[nxt] - w.outdoor_C[part])
        supply = w.supply_C[part] + share * (w.supply_C[nxt] - w.supply_C[part])
        hour = n / 3600.0 % 24.0
        last = max(n - 1, 0)
        # thermostat
        true_air = before[last, AIR] if forced >= 1 else air
        seen += (true_air - seen) / p.sensor_s
        housed = seen if p.housing_s <= 0.0 else housed + (seen - housed) / max(1.0, p.housing_s)
        reading = housed + p.bias_K + p.sun_K_kW * w.sun_W[part] / 1000.0
        # controller
        told = before[n, READING] if forced >= 2 else reading
        is_elsewhere = (hour - p.aim_from_h) % 24.0 < (p.aim_to_h - p.aim_from_h) % 24.0
        aim = setpoint_C + (p.aim_K if is_elsewhere else 0.0) + p.turned_K * _turn_of(n - float(WARM_UP_S))
        since_s += 1.0
        wanted = output
        if told < aim - 0.5 * p.band_K:
            wanted = 1.0
        elif told > aim + 0.5 * p.band_K:
            wanted = 0.0
        if wanted != output and since_s >= p.lockout_s:
            output, since_s = wanted, 0.0
        # motor
        on = before[n, OUTPUT] if forced >= 3 else output
        wax_C, molten = _wax_C(p, heat_J)
        power = p.power_W * max(0.0, 1.0 - p.power_fall_1_K * (wax_C - p.box_C)) * on
        if 17.0 <= hour < 23.0:
            power *= p.evening_power
        heat_J = max(0.0, heat_J + (power - p.loss_W_K * (wax_C - p.box_C)) / p.inertia)
        wax_C, molten = _wax_C(p, heat_J)
        pushed = min(1.0, max(0.0, (molten - 0.08) / 0.84))
        if pushed > stem + p.friction or pushed >= 1.0:
            stem = max(stem, pushed - p.friction if pushed < 1.0 else 1.0)
        elif pushed < stem - p.friction or pushed <= 0.0:
            stem = min(stem, pushed + p.friction if pushed > 0.0 else 0.0)
        opening = min(stem, p.stop)
        # valve
        lifted = before[n, OPENING] if forced >= 4 else opening
        if lifted >= 1.0 or lifted <= 0.0:
            plug = lifted
        elif lifted > plug + p.play:
            plug = lifted - p.play
        elif lifted < plug - p.play:
            plug = lifted + p.play
        pressure = math.sqrt(max(0.0, 1.0 + p.coupling * (0.5 - w.others[part])))
        flow = p.full_flow_L_h * _lifted(p, max(plug, p.dirt)) * pressure
        if n % 7200 < p.pump_pause_s:
            flow = 0.0
        # water
        through = before[n, FLOW] if forced >= 5 else flow
        volume_L[n] = (volume_L[last] if n else 0.0) + through / 3600.0
        while tail < n and volume_L[n] - volume_L[tail] > p.pipe_L:
            tail += 1
        enters = supply + p.supply_K
        if p.pipe_L > 0.0:
            then = tail // PART_S
            cooled = math.exp(-(n - tail) / 3600.0)
            enters = air + (w.supply_C[then] + p.supply_K - air) * cooled
        slab = 0.5 * (floor[3] + floor[4])
        to_floor = 0.0
        if through > 0.01:
            per_K = through / 3600.0 * WATER_J_L_K
            locked = p.air_lock if n > (seconds + WARM_UP_S) // 2 else 1.0
            to_floor = per_K * (1.0 - math.exp(-locked * _exchange_W_K(p, through) / per_K)) * (enters - slab)
            leaves = enters - to_floor / per_K
            water_C += (leaves - water_C) * min(1.0, through / 3600.0 / 1.5)  # mixed on its way to the sensor
        # surfaces and air
        up = floor[0] > air
        resistance = p.above_m / 8.0 / p.screed_W_mK + p.cover_m2K_W
        inner = p.area_m2 / resistance
        convection = p.area_m2 * _film_W_m2K(floor[0] - air, up)
        radiation = p.area_m2 * RADIATION_W_M2K
        sun = p.sun * w.sun_W[part]
        surface = (inner * floor[0] + convection * air + radiation * star + p.sun_on_floor * sun) / (
            inner + convection + radiation
        )
        h_wall, h_part = p.wall_m2 * _film_W_m2K(wall - air, True), p.partition_m2 * _film_W_m2K(partition - air, True)
        h_ceil = p.area_m2 * _film_W_m2K(partition - air, partition < air)
        h_pane = p.window_m2 * _film_W_m2K(pane - air, True)
        gains = w.gains_W[part]
        r_wall, r_part, r_pane = p.wall_m2, p.partition_m2 + p.area_m2, p.window_m2
        r_all = (r_wall + r_part + r_pane + p.area_m2) * RADIATION_W_M2K
        star = (
            RADIATION_W_M2K * (r_wall * wall + r_part * partition + r_pane * pane + p.area_m2 * surface)
            + p.gain_radiant * gains
        ) / r_all
        leak = p.leak_L_s * (1.0 + p.gust * w.wind[part])
        is_open = (
            p.window_from_h <= hour < p.window_to_h
            if p.window_from_h <= p.window_to_h
            else (hour >= p.window_from_h or hour < p.window_to_h)
        )
        if is_open:
            leak += p.window_L_s
        stove = p.stove_W if 18.0 <= hour < 22.0 and outdoor < -2.0 else 0.0
        into_air = (
            convection * (surface - air)
            + h_wall * (wall - air)
            + (h_part + h_ceil) * (partition - air)
            + h_pane * (pane - air)
            + p.furniture_W_K * (furniture - air)
            + (AIR_J_L_K * leak + p.bridge_W_K) * (outdoor - air)
            + AIR_J_L_K * p.ventilation_L_s * (18.0 - air)
            + p.neighbour_W_K * (w.neighbour_C[part] - air)
            + (1.0 - p.gain_radiant) * gains
            + 0.1 * sun
            + stove
        )
        board = p.board_J_m2K * p.mass
        rest = (1.0 - p.sun_on_floor - 0.1) * sun
        furniture += (p.furniture_W_K * (air - furniture) + 0.3 * rest) / (p.furniture_J_K * p.mass)
        wall += (
            h_wall * (air - wall)
            + RADIATION_W_M2K * p.wall_m2 * (star - wall)
            + p.wall_U_W_m2K * p.wall_m2 * (outdoor - wall)
            + 0.2 * rest
        ) / (board * p.wall_m2)
        partition += (
            (h_part + h_ceil) * (air - partition) + RADIATION_W_M2K * r_part * (star - partition) + 0.5 * rest
        ) / (board * r_part)
        pane += (
            h_pane * (air - pane)
            + RADIATION_W_M2K * p.window_m2 * (star - pane)
            + p.window_m2 / (1.0 / p.window_U_W_m2K - 0.13) * (outdoor - pane)
        ) / (p.pane_J_m2K * p.mass * p.window_m2)
        air += into_air / (p.volume_m3 * 1000.0 * AIR_J_L_K * p.mass)
        _conduct(floor, cells_J_K, links_W_K, inner * (surface - floor[0]), to_floor, p, outdoor)
        found[n, AIR], found[n, READING], found[n, OUTPUT] = air, reading, output
        found[n, OPENING], found[n, FLOW] = opening, flow
        found[n, OPERATIVE], found[n, SURFACE] = 0.5 * (air + star), surface
        found[n, RETURN], found[n, SUPPLY] = water_C, supply


@numba.njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _floor(p: Any) -> tuple[Any, Any]:
    """Return capacities of the floor's cells [J/K] and conductances between each and the next [W/K]."""
    thick, conducts, heat = np.zeros(CELLS), np.zeros(CELLS), np.zeros(CELLS)
    for place in range(CELLS):
        is_screed = place < 6
        thick[place] = p.above_m / 4.0 if place < 4 else (p.below_m / 2.0 if is_screed else p.concrete_m / 3.0)
        conducts[place] = p.screed_W_mK if is_screed else p.concrete_W_mK
        heat[place] = p.screed_J_m3K if is_screed else p.concrete_J_m3K
    half = thick / conducts / 2.0
    return heat * thick * p.area_m2, p.area_m2 / (half[:-1] + half[1:])


@numba.njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _conduct(T: Any, cells_J_K: Any, links_W_K: Any, top_W: float, pipes_W: float, p: Any, outdoor: float) -> None:
    """Move the floor's cells on by a second; the pipes lie between the fourth and the fifth."""
    flow_W = top_W
    for place in range(CELLS):
        down_W = (
            links_W_K[place] * (T[place] - T[place + 1])
            if place < CELLS - 1
            else p.floor_U_W_m2K * p.area_m2 * (T[place] - outdoor)
        )
        pipe_W = 0.5 * pipes_W if place in (3, 4) else 0.0
        T[place] += (flow_W - down_W + pipe_W) / cells_J_K[place]
        flow_W = down_W
