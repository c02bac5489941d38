"""A plugin of `waxstudy export energyplus` in a run of EnergyPlus, through its C API: prints time, air and flow.

The engine's build comes without the Python of plugins: what that would offer them is offered here by the same calls.
Called as `python -m tests.energyplus.in_engine PLUGIN.py FOLDER`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np

from waxstudy.plugin import WeatherRecord
from waxstudy.simulation.engine import START
from waxstudy_energyplus import objects
from waxstudy_energyplus.described import DescribedLoop
from waxstudy_energyplus.library import Engine
from waxstudy_energyplus.model import MINUTE_S, model
from waxstudy_energyplus.run import job_of, variables
from waxstudy_energyplus.weather_file import still_year
from waxstudy_paper.room import NzebRoom

SETPOINT_C = 21.0
WARM_UP_DAYS = 1


class Exchange:
    """The part of `api.exchange` that a plugin asks."""

    def __init__(self, engine: Engine) -> None:
        self.engine, self.handles = engine, list[Any]()
        self.rows: list[tuple[float, float]] = []
        self.air_C = 0.0

    def _kept(self, handle: Any) -> int:
        self.handles.append(handle)
        return len(self.handles) - 1

    def api_data_fully_ready(self, state: object) -> bool:
        return True

    def get_variable_handle(self, state: object, name: str, key: str) -> int:
        return self._kept(self.engine.variable(name, key))

    def get_actuator_handle(self, state: object, kind: str, control: str, key: str) -> int:
        return self._kept(self.engine.actuator(kind, control, key))

    def get_variable_value(self, state: object, handle: int) -> float:
        self.air_C = float(self.handles[handle]())
        return self.air_C

    def set_actuator_value(self, state: object, handle: int, value: float) -> None:
        self.handles[handle](value)
        self.rows.append((self.air_C, value))

    def zone_time_step(self, state: object) -> float:
        return MINUTE_S / 3600.0


class Driven(DescribedLoop):
    """The loop of a room, with the plugin in the place of the chain."""

    motor: Any = None

    def drive(self) -> None:
        if self.is_warming():
            self.hold()
        elif self.motor.on_begin_zone_timestep_before_predictor(None):
            raise RuntimeError("the plugin gave up")


def main(plugin: Path, folder: Path) -> None:
    engine_module: Any = ModuleType("pyenergyplus.plugin")
    engine_module.EnergyPlusPlugin = object
    sys.modules |= {"pyenergyplus": ModuleType("pyenergyplus"), "pyenergyplus.plugin": engine_module}
    names: dict[str, Any] = {"__name__": "plugin"}
    exec(compile(plugin.read_text(), str(plugin), "exec", dont_inherit=True), names)
    room = NzebRoom.description(NzebRoom.Parameters())
    dark = {facade: np.zeros(24) for facade in room.facades}
    weather = WeatherRecord(3600.0, "2021-01-01", np.full(24, -5.0), dark)
    job = job_of(
        room, weather, lambda *_: [], setpoint_C=SETPOINT_C, step_s=5.0, start=START, warm_up_days=WARM_UP_DAYS
    )
    engine = Engine(job.engine)
    engine.request("Zone Mean Air Temperature", objects.ZONE)
    loop = Driven(job, engine)
    loop.motor = names["Motor"]()
    exchange = Exchange(engine)
    loop.motor.api = SimpleNamespace(exchange=exchange)
    (folder / "room.epJSON").write_text(json.dumps(model(room, WARM_UP_DAYS + 1)))
    (folder / "year.epw").write_text(still_year())
    code = engine.run(["-w", str(folder / "year.epw"), "-d", str(folder), str(folder / "room.epJSON")])
    read = np.array(loop.rows).reshape(-1, len(job.variables))
    heat_W = read[:, list(variables(room)).index("water_heat_W")]
    print(json.dumps({"code": code, "rows": exchange.rows, "heat_W": heat_W.tolist()}))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
