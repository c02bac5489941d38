"""Hold the heated floor of Table 3 against EN 1264-2, ISO 11855-2 and exact conduction.

`python -m benchmarks.floor` prints output and water-to-room resistance at 34/29 C into 20 C, and time constants;
docs/room-choices.md has the tables. All of it is for a floor without covering and no heat downwards.
"""

from __future__ import annotations

from math import log, pi
from typing import Any

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.sparse import diags_array, eye_array, kron
from scipy.sparse.linalg import spsolve

from waxstudy_paper.room import NzebRoom, RoomDescription, SurfacesRoom
from waxstudy_paper.room.construction import Layer
from waxstudy_paper.room.hydronics import film_W_m2K, full_flow_L_h

# EN 1264-2, tables A.1 to A.3, without covering: factors over the pipe spacing [m]
SPACINGS_M = (0.05, 0.075, 0.1, 0.15, 0.2, 0.225, 0.3, 0.375)
A_COVER = (1.069, 1.066, 1.063, 1.057, 1.051, 1.048, 1.0395, 1.03)
A_PIPE = (1.013, 1.021, 1.029, 1.04, 1.046, 1.049, 1.053, 1.056)
A_SPACING, FILM_W_M2K = 1.23, 10.8
B_W_M2K = 6.7  # pipe walls of 2 mm of 0.35 W/(m K)
WATER_KG_L = 0.9957


def log_mean_K(room: RoomDescription) -> float:
    """Return the logarithmic mean difference between water and room at the design temperatures."""
    circuit = room.circuit
    warm_K, cold_K = (t - circuit.design_room_C for t in (circuit.design_supply_C, circuit.design_return_C))
    return (warm_K - cold_K) / log(warm_K / cold_K)


def en_1264_W_m2K(spacing_m: float, cover_m: float, screed_W_mK: float, pipe_outer_m: float) -> float:
    """Return the output of a type A floor without covering per kelvin of logarithmic mean difference.

    K_H = B a_B a_T^(1 - s/0.075) a_u^(100 (0.045 - s_u)) a_D^(250 (D - 0.020)),  s 0.05 to 0.375 m, s_u from 0.01 m
    with the cover s_u above the pipe. a_B = (1/10.8 + 0.045/1.0) / (1/10.8 + 0.045/lambda). Source: EN 1264-2.
    """
    a_screed = (1 / FILM_W_M2K + 0.045) / (1 / FILM_W_M2K + 0.045 / screed_W_mK)
    a_cover, a_pipe = (np.interp(spacing_m, SPACINGS_M, factors) for factors in (A_COVER, A_PIPE))
    by_spacing = A_SPACING ** (1 - spacing_m / 0.075)
    return float(
        B_W_M2K
        * a_screed
        * by_spacing
        * a_cover ** (100 * (0.045 - cover_m))
        * a_pipe ** (250 * (pipe_outer_m - 0.020))
    )


def iso_11855_m2K_W(room: RoomDescription) -> float:
    """Return the resistance from the water at full flow to the plane of the pipes, per floor area.

    R = s^0.13 / (8 pi) (d_i s / m)^0.87 + s ln(d/d_i) / (2 pi lambda_pipe) + s ln(s/(pi d)) / (2 pi lambda_screed)
    with the flow m [kg/s], taken to be turbulent. Source: ISO 11855-2, resistance method; it asks for a cover of 0.3 s.
    """
    circuit = room.circuit
    spacing, outer, bore = circuit.spacing_m, circuit.pipe_outer_m, circuit.pipe_outer_m - 2 * circuit.pipe_wall_m
    flow_kg_s = full_flow_L_h(circuit, room.floor.area_m2) / 3600 * WATER_KG_L
    film = spacing**0.13 / (8 * pi) * (bore * spacing / flow_kg_s) ** 0.87
    wall = spacing * log(outer / bore) / (2 * pi * circuit.pipe_conductivity_W_mK)
    return film + wall + spacing * log(spacing / (pi * outer)) / (2 * pi * room.beside_pipes[0].conductivity_W_mK)


def ours_m2K_W(room: RoomDescription) -> float:
    """Return our resistance from the water at full flow to the plane of the pipes, per floor area."""
    linear = SurfacesRoom.build(room)
    stream_W_K = linear.full_flow_L_h / 3600 * linear.water_J_L_K
    conductance_W_K = float(linear.floor_conductance_W_K(np.array([1.0]))[0])
    return -room.floor.area_m2 / (stream_W_K * np.log1p(-conductance_W_K / stream_W_K))


def exact_m2K_W(room: RoomDescription, film_m2K_W: float, below: int, cell_m: float = 0.001) -> float:
    """Return the resistance from the pipe's outer face to the room by two-dimensional conduction.

    Finite volumes over half a spacing, from the floor surface through so many layers `below` the plane of the pipes,
    where nothing gets through; the pipe is all cells whose middle lies within its radius.
    """
    after, circuit = room.heated_floor.pipes_after_layer, room.circuit
    layers = room.floor.layers[: after + below]
    thick = [round(layer.thickness_m / cell_m) for layer in layers]
    conductivity = np.repeat([layer.conductivity_W_mK for layer in layers], thick)
    wide, high = round(circuit.spacing_m / 2 / cell_m), len(conductivity)
    x, y = (np.arange(wide) + 0.5) * cell_m, (np.arange(high) + 0.5 - sum(thick[:after])) * cell_m
    pipe = (x[None, :] ** 2 + y[:, None] ** 2 <= (circuit.pipe_outer_m / 2) ** 2).ravel()
    to_room = cell_m / (film_m2K_W + cell_m / 2 / conductivity[0])
    sideways = kron(diags_array(conductivity), _chain(np.ones(wide - 1)))
    upwards = kron(_chain(2 / (1 / conductivity[1:] + 1 / conductivity[:-1])), eye_array(wide))
    losses = (sideways + upwards + to_room * diags_array((np.arange(wide * high) < wide).astype(float))).tocsr()
    temperature = pipe.astype(float)  # 1 K above the room
    temperature[~pipe] = spsolve(losses[~pipe][:, ~pipe].tocsc(), -(losses @ temperature)[~pipe])
    return float(circuit.spacing_m / 2 / (to_room * temperature[:wide].sum()))


def _chain(conductance: Any) -> Any:
    """Return the matrix of cells in a row that are joined by these conductances."""
    ends = np.append(conductance, 0.0) + np.insert(conductance, 0, 0.0)
    return diags_array([ends, -conductance, -conductance], offsets=[0, 1, -1])


def water_and_wall_m2K_W(room: RoomDescription) -> float:
    """Return the resistance from the water at full flow to the pipe's outer face, per floor area."""
    circuit = room.circuit
    bore = circuit.pipe_outer_m - 2 * circuit.pipe_wall_m
    flow_L_s = np.array([full_flow_L_h(circuit, room.floor.area_m2) / 3600])
    film = 1 / (pi * bore * float(film_W_m2K(flow_L_s, bore)[0]))
    return circuit.spacing_m * (film + log(circuit.pipe_outer_m / bore) / (2 * pi * circuit.pipe_conductivity_W_mK))


def output_W_m2(room: RoomDescription, to_layer_m2K_W: float, above_m2K_W: float) -> float:
    """Return the output at the design temperatures if the plane of the pipes has one temperature, as in our room."""
    circuit = room.circuit

    def surplus_K(output: float) -> float:
        layer_C = circuit.design_room_C + output * above_m2K_W
        warm_K, cold_K = circuit.design_supply_C - layer_C, circuit.design_return_C - layer_C
        return float((warm_K - cold_K) / np.log(warm_K / cold_K) - output * to_layer_m2K_W)

    most = (circuit.design_return_C - circuit.design_room_C) / above_m2K_W
    return float(brentq(surplus_K, 0.0, most * (1 - 1e-9)))


# --- time constant ---------------------------------------------------------------------------------


def slab_time_constants_h(thickness_m: float, screed: Layer, film_m2K_W: float) -> tuple[float, float]:
    """Return a slab's slowest time constant with a film above and no heat downwards: exact, and by a formula.

    tau = L^2 / (a beta^2),  beta tan(beta) = L / (lambda R_film)   by the heat equation
    tau = rho c L (R_film + L / (3 lambda))                         one capacity, the screed's resistance by a third
    """
    resistance, capacity = thickness_m / screed.conductivity_W_mK, screed.density_kg_m3 * screed.heat_capacity_J_kgK
    beta = brentq(lambda b: b * np.tan(b) - resistance / film_m2K_W, 1e-6, pi / 2 - 1e-9)
    stored = thickness_m * capacity / 3600
    return float(resistance * stored / beta**2), float(stored * (film_m2K_W + resistance / 3))


def screed_alone(thickness_m: float) -> RoomDescription:
    """Return the room of Table 3 with nothing but screed in its floor, the pipes in the middle."""
    given = NzebRoom.description(NzebRoom.Parameters()).model_dump(exclude_none=True)
    floor = next(surface for surface in given["surfaces"] if surface["name"] == "floor")
    half = {**floor["layers"][0], "thickness_m": thickness_m / 2}
    floor |= {"boundary": "adiabatic", "layers": [half, half]}
    return RoomDescription.model_validate({**given, "circuit": {"exchange": "pipe"}})


def our_time_constant_h(room: RoomDescription) -> float:
    """Return the slowest time constant of the floor's nodes while all others are held."""
    linear = SurfacesRoom.build(room)
    floor = linear.air_nodes == 0.0
    root = np.sqrt(linear.capacity_J_K[floor])
    return float(1 / eigh(linear.conductance_W_K[np.ix_(floor, floor)] / np.outer(root, root))[0].min() / 3600)


# --- the tables ------------------------------------------------------------------------------------


def outputs() -> dict[str, tuple[float, float]]:
    """Return output [W/m2] and water-to-room resistance [m2 K/W] at the design temperatures, by method."""
    nominal, pipe = (nzeb(exchange) for exchange in ("nominal", "pipe"))
    above, _ = nominal.beside_pipes
    layers, difference_K = above.resistance_m2K_W, log_mean_K(nominal)
    spacing, outer, screed = nominal.circuit.spacing_m, nominal.circuit.pipe_outer_m, above.conductivity_W_mK
    en_1264 = {
        f"EN 1264-2, {1000 * cover:.0f} mm of screed above the pipe": 1 / en_1264_W_m2K(spacing, cover, screed, outer)
        for cover in (above.thickness_m, above.thickness_m - outer / 2)
    }
    water = water_and_wall_m2K_W(nominal)
    resistances = {
        **en_1264,
        "conduction in two dimensions, screed alone": water + exact_m2K_W(nominal, 1 / FILM_W_M2K, below=1),
        "conduction in two dimensions, with the concrete": water + exact_m2K_W(nominal, 1 / FILM_W_M2K, below=2),
        "ISO 11855-2, resistances": iso_11855_m2K_W(nominal) + layers + 1 / FILM_W_M2K,
    }
    found = {name: difference_K / resistance for name, resistance in resistances.items()}
    found["ours, exchange 'pipe'"] = output_W_m2(pipe, ours_m2K_W(pipe), layers + 1 / FILM_W_M2K)
    found["ours, exchange 'nominal' (default)"] = output_W_m2(nominal, ours_m2K_W(nominal), nominal.cover_m2K_W)
    return {name: (output, difference_K / output) for name, output in found.items()}


def nzeb(exchange: str) -> RoomDescription:
    return NzebRoom.description(NzebRoom.Parameters.model_validate({"circuit": {"exchange": exchange}}))


def main() -> None:
    print("| at 34/29 C into 20 C | output W/m2 | resistance m2 K/W |\n|---|---|---|")
    for name, (output, resistance) in outputs().items():
        print(f"| {name} | {output:.1f} | {resistance:.3f} |")
    heads = ["screed alone", "ours h", "heat equation h", "capacity times film and a third of the screed h"]
    print(f"\n| {' | '.join(heads)} |\n|---|---|---|---|")
    for thickness_m in (0.04, 0.06, 0.08):
        room = screed_alone(thickness_m)
        layer, film = room.beside_pipes[0], room.films.interior_m2K_W("floor")
        exact, simple = slab_time_constants_h(thickness_m, layer, film)
        print(f"| {1000 * thickness_m:.0f} mm | {our_time_constant_h(room):.2f} | {exact:.2f} | {simple:.2f} |")
    print(f"| the floor of Table 3 | {our_time_constant_h(nzeb('nominal')):.1f} | | |")


if __name__ == "__main__":
    main()
