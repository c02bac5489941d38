"""A linear room as large as another: it stands in for rooms of which only the size is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from waxstudy.plugin import FloatArray, LinearRoom, Role, WeatherRecord


def scaled(room: LinearRoom, floor_area_m2: float) -> LinearRoom:
    """Return a room with all its areas, flows and gains in proportion to its floor; it has the same temperatures."""
    times, gains = floor_area_m2 / room.floor_area_m2, room.places(Role.GAINS)
    width = np.full(len(room.inputs), times)
    width[gains] = 1.0  # these are watts already

    def drive(weather: WeatherRecord) -> tuple[FloatArray, FloatArray]:
        inputs, supply_C = room.drive(weather)
        inputs = inputs.copy()
        inputs[:, gains] *= times
        return inputs, supply_C

    return replace(
        room,
        floor_area_m2=floor_area_m2,
        capacity_J_K=room.capacity_J_K * times,
        conductance_W_K=room.conductance_W_K * times,
        input_matrix=room.input_matrix * width,
        feedthrough=room.feedthrough / np.where(width == 1.0, times, 1.0),
        full_flow_L_h=room.full_flow_L_h * times,
        floor_conductance_W_K=lambda flow: room.floor_conductance_W_K(flow) * times,
        drive=drive,
    )
