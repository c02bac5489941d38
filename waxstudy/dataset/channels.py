"""The channels of a dataset: the one place that knows their names, and how they are sampled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

INF = float("inf")
GLOBAL, DIFFUSE, PANELS = LIGHT = ("global_irradiance_W_m2", "diffuse_irradiance_W_m2", "photovoltaic_power_W")

Quantity = Literal["indoor", "water", "outdoor", "level", "flow", "gain", "light"]
UNITS: dict[Quantity, str] = {
    "indoor": "C", "water": "C", "outdoor": "C", "level": "1", "flow": "L/h", "gain": "W", "light": "W/m2",
}  # fmt: skip


@dataclass(frozen=True)
class Channel:
    """One column of data.csv, and the instrument that `waxstudy reality` measures it with by default."""

    name: str  # ends in its unit; a level from 0 to 1 has none
    source: str  # column of the simulation that it is taken from
    quantity: Quantity  # what values are plausible for it
    is_mean: bool = False  # over the interval that ended; else the value at its end
    is_assumed: bool = False  # known to the modeller without measuring: no noise, no gaps
    noise: float = 0.0  # standard deviation, in the channel's unit
    is_quiet_at_zero: bool = False  # no noise where there is nothing to measure, as a meter that stands still
    resolution: float = 0.0  # 0: as computed
    low: float = -INF
    high: float = INF

    @property
    def unit(self) -> str:
        return UNITS[self.quantity]


# each shows what a room does, where its drives are recorded; the first is what most people log
SHOW_ROOM = ("air_temperature_C", "operative_temperature_C", "floor_surface_temperature_C")
# noise and resolution are chosen: thermistors in the room and on pipes, a small water meter, a displacement probe
CHANNELS = {
    channel.name: channel
    for channel in (
        Channel("sensor_temperature_C", "reading_C", "indoor", noise=0.03, resolution=0.01),
        Channel("air_temperature_C", "air_C", "indoor", noise=0.03, resolution=0.01),
        Channel("operative_temperature_C", "operative_C", "indoor", noise=0.03, resolution=0.01),
        Channel("setpoint_C", "setpoint_C", "indoor", is_assumed=True),
        Channel("control_output", "output", "level"),
        Channel("heating_signal", "signal", "level"),
        Channel("displacement", "opening", "level", noise=0.01, resolution=0.001, low=0.0, high=1.0),
        Channel(
            "flow_L_h", "flow_L_h", "flow", is_mean=True, noise=1.0, is_quiet_at_zero=True, resolution=0.1, low=0.0
        ),
        Channel("supply_temperature_C", "supply_C", "water", noise=0.05, resolution=0.01),
        Channel("return_temperature_C", "return_C", "water", noise=0.05, resolution=0.01),
        Channel("outdoor_temperature_C", "outdoor_C", "outdoor", noise=0.1, resolution=0.01),
        Channel("solar_gain_W", "solar_gain_W", "gain", is_mean=True, is_assumed=True, resolution=0.1),
        Channel("internal_gain_W", "internal_gain_W", "gain", is_mean=True, is_assumed=True, resolution=0.1),
        Channel("floor_surface_temperature_C", "floor_surface_C", "indoor", noise=0.03, resolution=0.01),
        Channel("ventilation_supply_temperature_C", "ventilation_supply_C", "outdoor", noise=0.1, resolution=0.01),
        Channel("neighbour_temperature_C", "neighbour_C", "outdoor", noise=0.03, resolution=0.01),
        # what tells the heat of the sun, which nobody meters
        Channel(GLOBAL, "global_W_m2", "light", is_mean=True, is_assumed=True, resolution=0.1),
        Channel(DIFFUSE, "diffuse_W_m2", "light", is_mean=True, is_assumed=True, resolution=0.1),
        Channel(PANELS, "photovoltaic_W", "gain", is_mean=True, is_assumed=True, resolution=1.0),
    )
}
