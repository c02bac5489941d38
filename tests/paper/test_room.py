"""Rooms: what their models conserve, how exact they are, and what a study is told when a room is impossible."""

from __future__ import annotations

import pickle
import tomllib
from math import log, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from waxstudy.plugin import ROOM_OUTPUTS, Facade, FloatArray, LinearRoom, WeatherRecord
from waxstudy_paper.room import NzebRoom, RoomDescription, SurfacesRoom
from waxstudy_paper.room.assembly import add_layers, assemble, full_system, linear_room, radiant_conductance_W_K
from waxstudy_paper.room.construction import Layer
from waxstudy_paper.room.corner import solid_angles_sr
from waxstudy_paper.room.hydronics import Circuit, exchange_W_m2K, full_flow_L_h, supply_C
from waxstudy_paper.room.network import Network, System, without_massless
from waxstudy_paper.room.view import Rectangle

NZEB = NzebRoom.Parameters()
AIR_J_L_K = 1.206
DAY_S = 86_400.0


def positive(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False)


layers = st.fixed_dictionaries(
    {
        "thickness_m": positive(0.005, 0.3),
        "conductivity_W_mK": positive(0.02, 3.0),
        "density_kg_m3": st.just(0.0) | positive(10.0, 3000.0),
        "heat_capacity_J_kgK": positive(500.0, 2500.0),
    }
)
screeds = st.fixed_dictionaries(
    {
        "thickness_m": positive(0.01, 0.1),
        "conductivity_W_mK": positive(0.5, 2.0),
        "density_kg_m3": positive(500.0, 2500.0),
        "heat_capacity_J_kgK": positive(800.0, 1200.0),
    }
)
walls = st.fixed_dictionaries(
    {
        "area_m2": positive(1.0, 50.0),
        "facing": st.sampled_from(["wall", "ceiling"]),
        "boundary": st.sampled_from(["outdoors", "ground", "adiabatic"]),
        "layers": st.lists(layers, min_size=1, max_size=3),
        "tilt_deg": st.sampled_from([0.0, 60.0, 90.0, 180.0]),
    }
)
windows = st.fixed_dictionaries(
    {
        "area_m2": positive(0.5, 10.0),
        "U_W_m2K": positive(0.4, 2.0),
        "g": positive(0.0, 0.9),
        "panes": st.integers(0, 3),
        "azimuth_deg": st.sampled_from([90.0, 180.0, 270.0]),
    }
)


@st.composite
def descriptions(draw: st.DrawFn, /, **fixed: Any) -> RoomDescription:
    """Rooms of any shape, as a study would write them."""
    floor = {
        "area_m2": draw(positive(5.0, 100.0)),
        "facing": "floor",
        "boundary": draw(st.sampled_from(["outdoors", "ground", "adiabatic"])),
        "layers": [draw(screeds), draw(screeds), draw(layers)],
    }
    surfaces = [floor, *draw(st.lists(walls, min_size=1, max_size=4))]
    return RoomDescription.model_validate(
        {
            "surfaces": [{"name": f"surface {i}", **surface} for i, surface in enumerate(surfaces)],
            "windows": [{"name": f"window {i}", **w} for i, w in enumerate(draw(st.lists(windows, max_size=3)))],
            "air": {
                "volume_m3": draw(positive(10.0, 500.0)),
                "ventilation_L_s": draw(positive(0.0, 50.0)),
                "ventilation_supply_C": 20.0,
                "infiltration_L_s": draw(positive(0.1, 10.0)),
                "thermal_bridges_W_K": draw(positive(0.0, 5.0)),
            },
            "heated_floor": {"surface": "surface 0", "pipes_after_layer": 1},
            "circuit": {"exchange": "pipe"},
            "films": {"sky_W_m2K": draw(st.just(0.0) | positive(0.1, 6.0))},
            "ground_temperature_C": 20.0,
            "sensing": {"sensor_radiant_share": draw(positive(0.0, 1.0))},
            **fixed,
        }
    )


def outputs(room: LinearRoom, u: FloatArray, floor_heat_W: float = 0.0) -> dict[str, float]:
    """The outputs in the steady state."""
    heat = room.input_matrix @ u + room.floor_heat_share * floor_heat_W
    y = room.output_matrix @ np.linalg.solve(room.conductance_W_K, heat) + room.feedthrough @ u
    return dict(zip(ROOM_OUTPUTS, y, strict=True))


def inputs(room: LinearRoom, **values: float) -> FloatArray:
    assert set(values) <= set(names(room))
    return np.array([values.get(name, 0.0) for name in names(room)])


def names(room: LinearRoom) -> list[str]:
    return [each.name for each in room.inputs]


def loss_W_K(room: RoomDescription, film_m2K_W: dict[str, float]) -> float:
    """Hand calculation: heat loss to everything but the ventilation, per kelvin."""
    outside = {"outdoors": 1 / room.films.exterior_W_m2K, "ground": room.ground_resistance_m2K_W}
    loss = room.air.infiltration_L_s * AIR_J_L_K + room.air.thermal_bridges_W_K
    for s in room.surfaces:
        if s.boundary != "adiabatic":
            resistance = sum(layer.thickness_m / layer.conductivity_W_mK for layer in s.layers)
            loss += s.area_m2 / (film_m2K_W[s.facing] + resistance + outside[s.boundary])
    inner_m2K_W = 1 / (room.films.wall_W_m2K + room.films.radiative_W_m2K)
    return loss + sum(w.area_m2 / (1 / w.U_W_m2K - inner_m2K_W + film_m2K_W["wall"]) for w in room.windows)


# --- the linear room -------------------------------------------------------------------------------


@given(descriptions())
@settings(max_examples=30, deadline=None)
def test_every_room_is_symmetric_positive_definite_and_has_the_declared_shapes(room: RoomDescription) -> None:
    linear = linear_room(room)
    n, m, p = len(linear.nodes), len(linear.inputs), len(ROOM_OUTPUTS)
    assert np.array_equal(linear.conductance_W_K, linear.conductance_W_K.T)
    assert np.linalg.eigvalsh(linear.conductance_W_K).min() > 0
    assert linear.capacity_J_K.min() > 0
    assert linear.conductance_W_K.shape == (n, n)
    assert linear.input_matrix.shape == (n, m)
    assert linear.output_matrix.shape == (p, n)
    assert linear.feedthrough.shape == (p, m)
    assert linear.floor_heat_share.sum() == pytest.approx(1.0, abs=1e-12)
    assert set(linear.air_nodes) <= {0.0, 1.0}
    assert len(set(linear.nodes)) == n


@given(descriptions())
@settings(max_examples=30, deadline=None)
def test_a_room_at_the_temperature_of_its_surroundings_stays_there(room: RoomDescription) -> None:
    linear = linear_room(room)
    u = np.array([20.0 if name.endswith("_C") else 0.0 for name in names(linear)])
    flow_W = linear.input_matrix @ u - linear.conductance_W_K @ np.full(len(linear.nodes), 20.0)
    assert np.abs(flow_W).max() <= 1e-12 * 20.0 * np.abs(linear.conductance_W_K).max()
    y = linear.output_matrix @ np.full(len(linear.nodes), 20.0) + linear.feedthrough @ u
    assert y == pytest.approx([20.0, 20.0, 20.0, 20.0, 20.0, 0.0], abs=1e-9)


@given(descriptions(films={"radiative_W_m2K": 1e-9}))
@settings(max_examples=30, deadline=None)
def test_the_steady_air_temperature_is_the_hand_calculation_where_nothing_radiates(room: RoomDescription) -> None:
    linear = linear_room(room)
    films = {"wall": 1 / room.films.wall_W_m2K, "ceiling": 1 / room.films.ceiling_W_m2K}
    films["floor"] = 1 / room.films.floor_W_m2K
    ventilation_W_K = room.air.ventilation_L_s * AIR_J_L_K
    # heat for the air only: the radiant part of the gains has no way to a surface here
    u = inputs(linear, outdoor_C=-10.0, ventilation_supply_C=-10.0, ground_C=-10.0)
    to_air_W = 1000.0 * np.array([name == "air" for name in linear.nodes])
    node_C = np.linalg.solve(linear.conductance_W_K, linear.input_matrix @ u + to_air_W)
    rise_K = node_C[linear.nodes.index("air")] + 10.0  # no share of a temperature, which may be near 0 C
    assert rise_K == pytest.approx(1000.0 / (loss_W_K(room, films) + ventilation_W_K), rel=1e-7)


@given(descriptions())
@settings(max_examples=15, deadline=None)
def test_eliminating_massless_nodes_gives_what_tiny_capacities_give(room: RoomDescription) -> None:
    full = full_system(assemble(room))
    tiny = System(**{**vars(full), "capacity_J_K": np.maximum(full.capacity_J_K, 1e-6)})
    reduced = without_massless(full)
    for rate_1_s in (0.0, 1e-5, 1e-3, 1e-3j):
        exact, approximate = transfer(reduced, rate_1_s), transfer(tiny, rate_1_s)
        assert np.abs(exact - approximate).max() <= 1e-7 * np.abs(exact).max()


def transfer(system: System, rate_1_s: complex) -> Any:
    """Laplace transform from inputs and floor heat to outputs."""
    sources = np.column_stack([system.input_matrix, system.heat_share])
    pencil = np.diag(rate_1_s * system.capacity_J_K) + system.conductance_W_K
    direct = np.column_stack([system.feedthrough, np.zeros(len(system.feedthrough))])
    return system.output_matrix @ np.linalg.solve(pencil, sources.astype(complex)) + direct


@given(st.sampled_from([3600.0, 4 * 3600.0, DAY_S]), positive(0.05, 0.4))
@settings(max_examples=20, deadline=None)
def test_a_slab_answers_a_harmonic_surface_temperature_as_the_heat_equation_says(
    period_s: float, thickness_m: float
) -> None:
    slab = Layer(thickness_m=thickness_m, conductivity_W_mK=2.0, density_kg_m3=2300.0, heat_capacity_J_kgK=900.0)
    network = Network(())
    add_layers(network, "slab", (slab,), 1.0, cell_time_s=300.0)
    system = network.system(0, [])
    rate = 2j * pi / period_s
    pencil = rate * np.diag(system.capacity_J_K) + system.conductance_W_K
    admittance = pencil[0, 0] - pencil[0, 1:] @ np.linalg.solve(pencil[1:, 1:], pencil[1:, 0])
    wave_1_m = np.sqrt(rate * 2300.0 * 900.0 / 2.0)
    exact = 2.0 * wave_1_m * np.tanh(wave_1_m * thickness_m)
    # second-order differences: 1/8 of 2 pi cell_time / period at the face, 1/24 in the wave length
    assert abs(admittance - exact) <= (1 / 8 + 1 / 24) * 2 * pi * 300.0 / period_s * abs(exact)


@pytest.mark.parametrize("ceiling", ["adiabatic", "outdoors"])
def test_over_a_week_of_changing_inputs_heat_stored_and_lost_is_the_heat_that_came_in(ceiling: str) -> None:
    room = NzebRoom.description(NzebRoom.Parameters.model_validate({"ceiling": ceiling}))
    linear, full = linear_room(room), full_system(assemble(room))
    weather = a_week()
    u, _ = linear.drive(weather)
    heat_W = np.random.default_rng(1).uniform(0, 700, len(u))  # of the water, another one every hour
    start, end, mean = integrate(linear, u, heat_W)
    stored_J = linear.capacity_J_K @ (end - start)
    duration_s = weather.duration_s
    lost_J = losses_W(room, full, linear, mean, u.mean(0)) * duration_s
    assert stored_J + lost_J == pytest.approx((heat_in_W(room, weather) + heat_W.mean()) * duration_s, rel=1e-9)


def a_week() -> WeatherRecord:
    hours = np.arange(168)
    sun = np.maximum(0.0, np.sin((hours % 24 - 6) / 12 * pi))
    facades = {"azimuth 180 tilt 90": 300 * sun, "azimuth 270 tilt 90": 200 * sun**2}
    return WeatherRecord(3600.0, "2021-01-01", -5 + 5 * np.sin(hours / 20), facades)


def integrate(linear: LinearRoom, u: FloatArray, heat_W: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """First, last and mean node temperatures; every hour is exact, by the exponential of the whole system."""
    n, sources = len(linear.nodes), np.column_stack([linear.input_matrix, linear.floor_heat_share])
    m = sources.shape[1]
    change = np.zeros((2 * n + m, 2 * n + m))  # of temperatures, their integral, and the sources
    change[:n, :n] = -linear.conductance_W_K / linear.capacity_J_K[:, None]
    change[:n, 2 * n :] = sources / linear.capacity_J_K[:, None]
    change[n : 2 * n, :n] = np.eye(n)
    hour = scipy.linalg.expm(change * 3600.0)
    start = np.random.default_rng(2).uniform(18, 24, n)
    x = np.concatenate([start, np.zeros(n + m)])
    for inputs_now, heat_now in zip(u, heat_W, strict=True):
        x[2 * n :] = [*inputs_now, heat_now]
        x = hour @ x
    return start, x[:n], x[n : 2 * n] / (3600.0 * len(u))


def losses_W(room: RoomDescription, full: System, linear: LinearRoom, kept_C: FloatArray, u: FloatArray) -> float:
    """Heat that leaves through every way out; massless nodes follow from the balance of the full network."""
    network = assemble(room).network
    massless = full.capacity_J_K == 0
    temperature_C = np.empty(len(massless))
    temperature_C[~massless] = kept_C
    balance_W = full.input_matrix[massless] @ u - full.conductance_W_K[np.ix_(massless, ~massless)] @ kept_C
    temperature_C[massless] = np.linalg.solve(full.conductance_W_K[np.ix_(massless, massless)], balance_W)
    outside_C = dict(zip(names(linear), u, strict=True))
    return float(sum(g * (temperature_C[node] - outside_C[name]) for node, name, g in network.holds))


def heat_in_W(room: RoomDescription, weather: WeatherRecord) -> float:
    """Hand calculation of gains and sun, mean of the week."""
    sun_W = 0.0
    for w in room.windows:
        behind = 1 - w.U_W_m2K / (room.films.wall_W_m2K + room.films.radiative_W_m2K)
        solar = w.g * (1 - w.secondary_share) + w.g * w.secondary_share / behind
        sun_W += w.area_m2 * solar * weather.irradiance_W_m2[f"azimuth {w.azimuth_deg:g} tilt 90"].mean()
    return sun_W + room.gains.mean_W_m2 * 10.4


# --- the paper's room ------------------------------------------------------------------------------


def test_the_room_of_table_3_loses_7_7_W_K_by_hand_and_in_the_model() -> None:
    p = NzebRoom.Parameters(ventilation_L_s_m2=0.0)
    room = NzebRoom.description(p)
    films = {facing: room.films.interior_m2K_W(facing) for facing in ("wall", "ceiling", "floor")}
    by_hand = loss_W_K(room, films)
    assert by_hand == pytest.approx(7.7, abs=0.05)
    linear = linear_room(room)
    y = outputs(linear, inputs(linear, gains_W=100.0))
    assert 100.0 / y["operative_C"] == pytest.approx(by_hand, rel=0.02)  # heated unevenly, hence not exact


@pytest.mark.parametrize(("outdoor_C", "sun_kWh_m2", "paper_kWh_m2"), [(-1.9, 0.15, 2.41), (-6.8, 0.82, 2.31)])
def test_21_C_in_the_papers_weeks_takes_the_papers_heat_within_5_percent(
    outdoor_C: float, sun_kWh_m2: float, paper_kWh_m2: float
) -> None:
    room = NzebRoom.build(NZEB)
    irradiance_W_m2 = sun_kWh_m2 * 1000 / 168 * 10.4 / (6.0 * 0.3)
    sun = {name: irradiance_W_m2 for name in names(room) if name.startswith("irradiance")}
    u = inputs(room, outdoor_C=outdoor_C, ventilation_supply_C=18.0, gains_W=41.6, **sun)
    cold, warm = outputs(room, u)["operative_C"], outputs(room, u, floor_heat_W=1.0)["operative_C"]
    heat_W = (21.0 - cold) / (warm - cold)
    assert heat_W / 10.4 * 168 / 1000 == pytest.approx(paper_kWh_m2, rel=0.05)
    by_hand_W = 7.7 * (21.0 - outdoor_C) + 5.2 * AIR_J_L_K * (21.0 - 18.0) - 41.6 - sun_kWh_m2 * 10_400 / 168
    assert heat_W == pytest.approx(by_hand_W, rel=0.02)


def test_each_surface_exchanges_radiation_with_all_the_others_as_its_area_says() -> None:
    room = NzebRoom.description(NZEB)
    to_star = radiant_conductance_W_K(room)
    total = sum(to_star.values())
    for part in room.parts:
        to_others = to_star[part.name] * (1 - to_star[part.name] / total)
        assert to_others == pytest.approx(part.area_m2 * room.films.radiative_W_m2K, rel=0.015)


def test_u_values_and_areas_of_table_3_are_those_of_the_description() -> None:
    room = NzebRoom.description(NZEB)
    surfaces = {s.name: s for s in room.surfaces}
    resistance = {s.name: sum(x.thickness_m / x.conductivity_W_mK for x in s.layers) for s in room.surfaces}
    films = room.films
    assert 1 / (resistance["floor"] + films.interior_m2K_W("floor") + 0.04) == pytest.approx(0.08)
    assert 1 / (resistance["south wall"] + films.interior_m2K_W("wall") + 0.04) == pytest.approx(0.12)
    assert surfaces["floor"].area_m2 == pytest.approx(10.4)
    assert surfaces["south wall"].area_m2 + surfaces["west wall"].area_m2 == pytest.approx(6.6 * 2.6 - 6.0)
    assert [layer.thickness_m for layer in surfaces["floor"].layers[:3]] == [0.04, 0.02, 0.05]
    assert {s.name for s in room.surfaces if s.boundary == "adiabatic"} == {
        "north partition",
        "east partition",
        "ceiling",
    }


def test_a_roof_adds_its_u_value_and_its_thermal_bridges() -> None:
    roofed = NzebRoom.description(NzebRoom.Parameters(ceiling="outdoors", roof_U_W_m2K=0.1))
    closed = NzebRoom.description(NZEB)
    films = {facing: closed.films.interior_m2K_W(facing) for facing in ("wall", "ceiling", "floor")}
    extra = 10.4 * (0.1 + 0.031 + 0.0048 * AIR_J_L_K)
    assert loss_W_K(roofed, films) - loss_W_K(closed, films) == pytest.approx(extra, rel=1e-9)


def test_the_description_of_the_papers_room_as_a_study_file_gives_the_same_room() -> None:
    description = NzebRoom.description(NZEB).model_dump(mode="json", exclude_none=True)
    again = SurfacesRoom.Parameters.model_validate(tomllib.loads(tomli_w.dumps(description)))
    ours, theirs = NzebRoom.build(NZEB), SurfacesRoom.build(again)
    assert ours.inputs == theirs.inputs
    for matrix in ("conductance_W_K", "capacity_J_K", "input_matrix", "output_matrix", "feedthrough"):
        assert np.array_equal(getattr(ours, matrix), getattr(theirs, matrix))


def test_the_example_of_the_documentation_is_a_room() -> None:
    page = (Path(__file__).parents[2] / "docs" / "room.md").read_text(encoding="utf-8")
    example = tomllib.loads(page.split("```toml\n")[1].split("```")[0])["room"]
    assert example.pop("use") == SurfacesRoom.name
    assert SurfacesRoom.build(SurfacesRoom.Parameters.model_validate(example)).floor_area_m2 == 16.0


def test_a_room_survives_pickling() -> None:
    room = NzebRoom.build(NZEB)
    again = pickle.loads(pickle.dumps(room))
    flow = np.linspace(0, 1, 5)
    assert np.array_equal(again.floor_conductance_W_K(flow), room.floor_conductance_W_K(flow))
    assert np.array_equal(again.drive(a_week())[0], room.drive(a_week())[0])


@given(positive(2.0, 10.0), positive(2.0, 10.0), positive(2.4, 4.0), positive(0.1, 2.3))
@settings(max_examples=30, deadline=None)
def test_the_operative_point_sees_the_whole_sphere(width: float, depth: float, height: float, point: float) -> None:
    p = NzebRoom.Parameters.model_validate(
        {"facade_m": {"south": width, "west": depth}, "height_m": height, "operative_height_m": point}
    )
    angles = solid_angles_sr(p)
    assert sum(angles.values()) == pytest.approx(4 * pi, rel=1e-12)
    assert min(angles.values()) > 0


def test_a_rectangle_seen_from_the_middle_of_a_cube_fills_a_sixth_and_an_infinite_one_half() -> None:
    assert Rectangle(1.0, -1.0, 1.0, -1.0, 1.0).solid_angle_sr == pytest.approx(4 * pi / 6)
    assert Rectangle(1.0, -1e9, 1e9, -1e9, 1e9).solid_angle_sr == pytest.approx(2 * pi)
    aside = Rectangle(2.0, 3.0, 3.001, 1.0, 1.001)  # small and aside: area * cos / distance^2
    assert aside.solid_angle_sr == pytest.approx(1e-6 * 2.0 / (4 + 9 + 1) ** 1.5, rel=1e-3)


def test_the_operative_point_sees_a_window_where_it_sits_in_the_facade() -> None:
    x = np.linspace(-1.0, 1.0, 2001)[:, None]  # 3 m2 of 1.5 m height, centred, from 0.2 to 1.7 m above the point
    z = np.linspace(0.2, 1.7, 2001)[None, :]
    angle = np.trapezoid(np.trapezoid(1.3 / (x**2 + z**2 + 1.3**2) ** 1.5, z[0], axis=1), x[:, 0])
    assert solid_angles_sr(NZEB)["south window"] == pytest.approx(angle, rel=1e-6)


def test_a_secondary_gain_changes_where_the_sun_arrives_but_not_how_much_of_it() -> None:
    def heat_W(secondary: float) -> float:
        room = NzebRoom.description(NzebRoom.Parameters(window_secondary_share=secondary))
        linear = linear_room(room)
        u = inputs(linear, **{"irradiance azimuth 180 tilt 90 W_m2": 100.0})
        # held at 0 C everywhere inside, the heat that must be taken away
        return float((linear.input_matrix @ u).sum())

    assert heat_W(0.0) == pytest.approx(3.0 * 0.3 * 100.0)
    assert heat_W(0.0) == pytest.approx(heat_W(1.0), rel=0.02)
    assert heat_W(0.0) != heat_W(1.0)


def test_sensor_and_operative_point_mix_air_and_radiation_as_told() -> None:
    sensing = {"sensor_radiant_share": 0.3, "operative_air_share": 0.5}
    room = NzebRoom.build(NzebRoom.Parameters.model_validate({"sensing": sensing}))
    y = outputs(room, inputs(room, outdoor_C=-10.0, ventilation_supply_C=18.0), floor_heat_W=300.0)
    radiant_C = 2 * y["operative_C"] - y["air_C"]
    assert radiant_C > y["air_C"] + 0.1
    assert y["sensed_C"] == pytest.approx(0.7 * y["air_C"] + 0.3 * radiant_C)


def test_in_the_steady_state_the_floor_gives_the_room_what_the_water_gives_it_less_its_loss_downwards() -> None:
    description = NzebRoom.description(NZEB)
    room = linear_room(description)
    y = outputs(room, inputs(room, outdoor_C=-10.0, ventilation_supply_C=18.0), floor_heat_W=400.0)
    below = sum(layer.thickness_m / layer.conductivity_W_mK for layer in description.floor.layers[1:]) + 0.04
    down_W_m2 = (y["layer_C"] + 10.0) / below
    assert y["floor_heat_W_m2"] == pytest.approx(400.0 / 10.4 - down_W_m2)
    assert y["layer_C"] - y["floor_surface_C"] == pytest.approx(y["floor_heat_W_m2"] * 0.04 / 1.2)


def test_the_ensembles_air_temperature_applies_everywhere_but_in_the_heated_floor() -> None:
    room = NzebRoom.build(NZEB)
    floor = {name for name, air in zip(room.nodes, room.air_nodes, strict=True) if not air}
    assert floor == {name for name in room.nodes if name.startswith("floor ")}


# --- inputs ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("interval_s", [300.0, 900.0, 3600.0])
def test_gains_follow_the_hours_and_keep_the_stated_mean(interval_s: float) -> None:
    schedule = [0.0] * 7 + [3.0] + [1.0] * 16
    room = NzebRoom.build(NzebRoom.Parameters.model_validate({"gains": {"schedule": schedule}}))
    count = int(2 * DAY_S / interval_s)
    facades = {name: np.zeros(count) for name in room.facades}
    u, _ = room.drive(WeatherRecord(interval_s, "2021-01-01", np.zeros(count), facades))
    gains_W = u[:, names(room).index("gains_W")]
    assert gains_W.mean() == pytest.approx(4.0 * 10.4)
    by_hour = gains_W.reshape(48, -1)
    assert np.ptp(by_hour, axis=1).max() == 0
    assert (by_hour[:7] == 0).all()
    assert by_hour[7, 0] == by_hour[31, 0] == pytest.approx(3 * by_hour[8, 0])


def test_each_direction_of_a_window_is_asked_for_once_and_reaches_its_own_input() -> None:
    room = NzebRoom.build(NZEB)
    assert set(room.facades.values()) == {Facade(180.0), Facade(270.0)}
    weather = a_week()
    u, supply = room.drive(weather)
    assert u.shape == (168, len(room.inputs))
    for name in room.facades:
        assert np.array_equal(u[:, names(room).index(f"irradiance {name} W_m2")], weather.irradiance_W_m2[name])
    assert np.array_equal(u[:, names(room).index("outdoor_C")], weather.outdoor_C)
    assert (u[:, names(room).index("ventilation_supply_C")] == 18.0).all()
    assert supply.shape == (168,)


def test_sun_on_an_outer_wall_counts_only_where_it_is_absorbed() -> None:
    dark = NzebRoom.description(NZEB).model_dump(mode="json", exclude_none=True)
    dark["surfaces"][0] |= {"solar_absorptance": 0.6, "azimuth_deg": 150.0}
    plain, sunlit = NzebRoom.build(NZEB), SurfacesRoom.build(SurfacesRoom.Parameters.model_validate(dark))
    assert "azimuth 150 tilt 90" in sunlit.facades
    assert "azimuth 150 tilt 90" not in plain.facades
    u = inputs(sunlit, **{"irradiance azimuth 150 tilt 90 W_m2": 100.0})
    assert float((sunlit.input_matrix @ u).sum()) == pytest.approx(0.6 * 7.4 * 100.0)


def sunlit_room(**changes: Any) -> RoomDescription:
    """A roof, a floor and a south window without mass to speak of: what they lose and gain is a hand calculation."""
    return RoomDescription.model_validate(
        small_room(
            surfaces=[
                small_room()["surfaces"][0],
                {**small_room()["surfaces"][1], "name": "roof", "facing": "ceiling", "tilt_deg": 0.0},
            ],
            windows=[{"name": "south", "area_m2": 2.0, "U_W_m2K": 1.0, "g": 0.5, "azimuth_deg": 180.0}],
            **changes,
        )
    )


def lost_to_the_sky_W(room: RoomDescription, tilt_of: str) -> float:
    """Heat that a roof or window at 0 C loses to a sky at -20 C under air of 0 C, the inside held at 0 C."""
    linear = linear_room(room)
    full = full_system(assemble(room))
    into_W = full.input_matrix @ inputs(linear, sky_C=-20.0)
    return -float(into_W[assemble(room).network.nodes.index(tilt_of)])


def test_a_roof_sees_all_of_the_sky_and_an_upright_window_35_percent_of_it() -> None:
    room = sunlit_room(films={"sky_W_m2K": 4.0})
    assert lost_to_the_sky_W(room, "roof 1") == pytest.approx(30.0 * 4.0 * 20.0)
    window_W_K = 2.0 / (1.0 - 1 / (2.5 + 5.13))  # from the pane through the glass and the film outside
    assert lost_to_the_sky_W(room, "south") == pytest.approx(window_W_K * 4.0 / 25.0 * 0.5**1.5 * 20.0)


def test_a_sky_as_warm_as_the_air_changes_nothing() -> None:
    plain, with_sky = linear_room(sunlit_room()), linear_room(sunlit_room(films={"sky_W_m2K": 4.0}))
    assert "sky_C" not in names(plain)
    cold = outputs(with_sky, inputs(with_sky, outdoor_C=-10.0, sky_C=-10.0))
    assert cold == pytest.approx(outputs(plain, inputs(plain, outdoor_C=-10.0)))


def test_a_room_under_a_sky_refuses_weather_that_knows_none() -> None:
    linear = linear_room(sunlit_room(films={"sky_W_m2K": 4.0}))
    sun = {name: np.zeros(24) for name in linear.facades}
    u, _ = linear.drive(WeatherRecord(3600.0, "2021-01-01", np.zeros(24), sun, sky_C=np.full(24, -15.0)))
    assert (u[:, names(linear).index("sky_C")] == -15.0).all()
    with pytest.raises(ValueError, match=r"no sky temperature, which films\.sky_W_m2K of the room needs"):
        linear.drive(WeatherRecord(3600.0, "2021-01-01", np.zeros(24), sun))


def test_sun_that_is_reflected_out_is_missing_inside() -> None:
    def heat_W(**sun: float) -> float:
        linear = linear_room(sunlit_room(sun=sun))
        return float((linear.input_matrix @ inputs(linear, **{"irradiance azimuth 180 tilt 90 W_m2": 100.0})).sum())

    transmitted_W = 2.0 * 0.5 * 0.88 * 100.0
    assert heat_W() - heat_W(reflected_share=0.1) == pytest.approx(0.1 * transmitted_W)


def test_windows_with_other_panes_ask_for_sun_of_their_own() -> None:
    window = {"area_m2": 2.0, "U_W_m2K": 1.0, "g": 0.5, "azimuth_deg": 180.0}
    panes = [{**window, "name": f"{n} panes", "panes": n} for n in (0, 2, 3)]
    room = SurfacesRoom.build(SurfacesRoom.Parameters.model_validate(small_room(windows=panes)))
    assert set(room.facades.values()) == {Facade(180.0), Facade(180.0, panes=2), Facade(180.0, panes=3)}
    assert "irradiance azimuth 180 tilt 90 panes 3 W_m2" in names(room)


# --- the heating circuit ---------------------------------------------------------------------------


def water_heat_W_m2(room: LinearRoom, flow: float, supply_C: float, cover_m2K_W: float) -> float:
    """Into a room of 20 C through the cover, in the steady state without loss downwards."""
    conductance = room.floor_conductance_W_K(np.array([flow]))[0] / room.floor_area_m2
    return float((supply_C - 20.0) / (1 / conductance + cover_m2K_W))


def with_circuit(**circuit: Any) -> LinearRoom:
    return NzebRoom.build(NzebRoom.Parameters.model_validate({"circuit": circuit}))


def test_the_nominal_exchange_meets_the_nominal_output_at_the_design_temperatures() -> None:
    room = with_circuit()
    cover = NzebRoom.description(NZEB).cover_m2K_W
    assert cover == pytest.approx(0.04 / 1.2 + 6.335 / 68, rel=1e-3)
    assert water_heat_W_m2(room, 1.0, 34.0, cover) == pytest.approx(68.0)
    return_C = 34.0 - 68.0 * 10.4 / (room.full_flow_L_h / 3600 * room.water_J_L_K)
    assert return_C == pytest.approx(29.0)
    assert room.full_flow_L_h == pytest.approx(122, abs=0.5)


def test_the_pages_name_the_exchange_that_the_room_of_table_3_has() -> None:
    pages = Path(__file__).parents[2] / "docs"
    said = " ".join((pages / "room-equations.md").read_text(encoding="utf-8").split())
    compared = " ".join((pages / "energyplus.md").read_text(encoding="utf-8").split())
    room = NzebRoom.description(NZEB)
    full_L_s = full_flow_L_h(room.circuit, 10.4) / 3600.0

    def k(exchange: str, flow_L_s: float) -> float:
        circuit = room.circuit.model_copy(update={"exchange": exchange})
        return float(exchange_W_m2K(circuit, room.cover_m2K_W, room.screed_W_mK, np.array([flow_L_s]))[0])

    nominal, pipe, laminar = k("nominal", full_L_s), k("pipe", full_L_s), k("pipe", 0.1 * full_L_s)
    assert f"For Table 3 k is {nominal:.1f} W/(m2 K)" in said
    assert f"k is {pipe:.1f} W/(m2 K) at full flow and {laminar:.1f} in laminar flow" in said
    assert f"resistance method has {pipe:.1f} and the nominal output needs {nominal:.1f}" in compared


def test_the_pipe_exchange_is_the_resistance_method() -> None:
    room = with_circuit(exchange="pipe", full_flow_L_h=2000.0)  # turbulent, film resistance hardly counts
    wall = 0.3 * log(20 / 16) / (2 * pi * 0.35)
    spread = 0.3 * log(0.3 / (pi * 0.02)) / (2 * pi * 1.2)
    stream_W_K = 2000.0 / 3600 * room.water_J_L_K
    conductance = room.floor_conductance_W_K(np.array([1.0]))[0]
    exchange = -stream_W_K * np.log(1 - conductance / stream_W_K) / 10.4
    assert 1 / exchange == pytest.approx(wall + spread, rel=0.02)
    assert 1 / exchange > wall + spread


@given(st.sampled_from(["nominal", "pipe"]), positive(20.0, 2000.0))
@settings(max_examples=40, deadline=None)
def test_more_flow_gives_more_heat_and_little_flow_gives_all_it_carries(exchange: str, full_L_h: float) -> None:
    room = with_circuit(exchange=exchange, full_flow_L_h=full_L_h)
    flow = np.linspace(0.0, 1.0, 400)
    conductance = room.floor_conductance_W_K(flow)
    assert conductance[0] == 0.0
    assert (np.diff(conductance) > 0).all()
    little = np.array([1.0, 0.1]) / full_L_h  # 1 and 0.1 L/h
    carried_W_K = little * full_L_h / 3600 * room.water_J_L_K
    assert room.floor_conductance_W_K(little) == pytest.approx(carried_W_K, rel=1e-6)
    assert (conductance <= flow * full_L_h / 3600 * room.water_J_L_K * (1 + 1e-12)).all()


def test_the_heating_curve_is_straight_between_its_points_and_held_outside() -> None:
    supply = supply_C(Circuit(), np.array([-40.0, -22.0, -1.0, 20.0, 35.0]))
    assert supply == pytest.approx([34.0, 34.0, 28.0, 22.0, 22.0])


# --- impossible rooms ------------------------------------------------------------------------------


def small_room(**changes: Any) -> dict[str, Any]:
    layer = {"thickness_m": 0.05, "conductivity_W_mK": 1.0, "density_kg_m3": 2000.0, "heat_capacity_J_kgK": 1000.0}
    return {
        "surfaces": [
            {
                "name": "floor",
                "facing": "floor",
                "area_m2": 10.0,
                "boundary": "adiabatic",
                "layers": [layer, layer],
            },
            {"name": "wall", "area_m2": 30.0, "boundary": "outdoors", "layers": [layer]},
        ],
        "air": {"volume_m3": 25.0},
        "heated_floor": {"surface": "floor", "pipes_after_layer": 1},
        "circuit": {"exchange": "pipe"},
        **changes,
    }


def reason(parameters: type[Any], values: dict[str, Any]) -> str:
    with pytest.raises(ValidationError) as caught:
        parameters.model_validate(values)
    (error,) = caught.value.errors()
    assert "\n" not in error["msg"]
    return str(error["msg"])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"heated_floor": {"surface": "flor", "pipes_after_layer": 1}},
            "no surface 'flor' (surfaces: floor, wall)",
        ),
        ({"heated_floor": {"surface": "wall", "pipes_after_layer": 1}}, "'wall' faces 'wall', not 'floor'"),
        ({"heated_floor": {"surface": "floor", "pipes_after_layer": 2}}, "one of the 2 layers"),
        ({"surfaces": small_room()["surfaces"] * 2}, "name 'wall' is used 2 times"),
        ({"surfaces": small_room()["surfaces"][:1]}, "needs a wall or a ceiling"),
        (
            {"surfaces": [small_room()["surfaces"][0], {**small_room()["surfaces"][1], "boundary": "adiabatic"}]},
            "leave",
        ),
        (
            {"surfaces": [small_room()["surfaces"][0], {**small_room()["surfaces"][1], "boundary": "ground"}]},
            "ground_temp",
        ),
        (
            {"surfaces": [small_room()["surfaces"][0], {**small_room()["surfaces"][1], "operative_weight": 1.0}]},
            "every",
        ),
        ({"windows": [{"name": "w", "area_m2": 1.0, "U_W_m2K": 9.0, "g": 0.5, "azimuth_deg": 0.0}]}, "inner film"),
        ({"circuit": {"nominal_output_W_m2": 100.0}}, "above the return of 29 C"),
        ({"films": {"exterior_W_m2K": 4.0, "sky_W_m2K": 4.5}}, "sky_W_m2K is a part of exterior_W_m2K"),
    ],
)
def test_an_impossible_description_is_refused_with_its_reason(changes: dict[str, Any], said: str) -> None:
    SurfacesRoom.build(SurfacesRoom.Parameters.model_validate(small_room()))
    assert said in reason(SurfacesRoom.Parameters, small_room(**changes))


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"window_area_m2": {"south": 11.0}}, "window_area_m2.south = 11 does not fit"),
        ({"window_sill_m": 1.5}, "more than height_m"),
        ({"wall_U_W_m2K": 4.0}, "wall_U_W_m2K: without any insulation it is"),
        ({"operative_height_m": 3.0}, "not below the ceiling"),
        ({"window_U_W_m2K": 7.0, "films": {"radiative_W_m2K": 1.0}}, "above that of its inner film"),
        ({"circuit": {"nominal_output_W_m2": 90.0}}, "above the return of 29 C"),
        ({"circuit": {"heating_curve_C": [[0.0, 30.0], [0.0, 20.0]]}}, "must rise"),
        ({"gains": {"schedule": [0.0] * 24}}, "not all of them 0"),
    ],
)
def test_an_impossible_nzeb_room_is_refused_with_its_reason(values: dict[str, Any], said: str) -> None:
    assert said in reason(NzebRoom.Parameters, values)
