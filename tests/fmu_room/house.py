"""An FMU of a room with two nodes, in the shell of the exporter; and the same room in Python."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

from waxstudy.export.compiler import this_platform
from waxstudy.export.fmu import pack
from waxstudy.export.model import Model, Variable
from waxstudy.export.tables import model_tables
from waxstudy.results.atomic import scratch_folder

STEP_S = 60.0
SOURCE = Path(__file__).with_name("two_nodes.c")
NAN, HANG, CRASH = 1.0, 2.0, 3.0
INPUTS = {"flow": "valve", "supply_C": "Tsup", "outdoor_C": "Tout", "gains_W": "Qint", "start_air_C": "Ta0"}
INPUTS |= {"start_floor_C": "Tf0"}
OUTPUTS = {"air_C": "Tair", "layer_C": "Tfloor", "return_C": "Tret"}
SUN = {"180": "Isouth"}


def write_house(path: Path, fmi: int = 2, trouble: float = 0.0) -> Path:
    """Write the FMU."""

    def given(name: str, unit: str, place: int, start: float) -> Variable:
        return Variable(name, "input", unit, "", place, start, -1e4, 1e4)

    variables = [
        Variable("time", "time", "s", ""),
        given("valve", "1", 0, 0.0),
        given("Tsup", "C", 1, 30.0),
        given("Tout", "K", 2, 273.15),
        given("Qint", "W", 3, 0.0),
        given("Isouth", "W/m2", 4, 0.0),
        *(Variable(name, "output", "C", "", place, 0.0, -1e4, 1e4) for place, name in enumerate(("Tair", "Tfloor"))),
        Variable("Tret", "output", "C", "", 2, 0.0, -1e4, 1e4),
        Variable("Ta0", "parameter", "C", "", 0, 20.0, -50.0, 50.0),
        Variable("Tf0", "parameter", "C", "", 8, 22.0, -50.0, 50.0),
        Variable("bare", "parameter", "", "", 16, 0.0, 0.0, 9.0),
    ]
    state = struct.pack("3d", 0.0, 0.0, 0.0)
    model = Model("two nodes", STEP_S, variables, struct.pack("3d", 20.0, 22.0, trouble), state, ())
    with scratch_folder("waxstudy-house-") as folder:
        tables = folder / "tables.c"
        tables.write_text(model_tables(model))
        pack(path, model, [tables, SOURCE], fmi=fmi, platforms=[this_platform()])
    return path


class House:
    """The same equations."""

    def __init__(self, air_C: float, floor_C: float) -> None:
        self.air_C, self.floor_C = air_C, floor_C

    def step(self, flow: float, supply_C: float, outdoor_C: float, gains_W: float, sun_W_m2: float) -> Any:
        """Return air, floor and the water's heat after a step."""
        heat_W = 0.7 * flow * 140.0 * (supply_C - self.floor_C)
        between_W = 110.0 * (self.floor_C - self.air_C)
        into_air_W = between_W - 12.0 * (self.air_C - outdoor_C) + gains_W + 1.5 * sun_W_m2
        self.air_C += STEP_S / 4e5 * into_air_W
        self.floor_C += STEP_S / 2e6 * (heat_W - between_W)
        return self.air_C, self.floor_C, heat_W
