"""The plants as engines of the blind test, with what an engineer would honestly believe of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import date, timedelta
from typing import Any, ClassVar

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy.plugin.trial import Cause, Engine, Scene, Staged, Unmakeable
from waxstudy_trials.as_built import as_built, earlier, healthy
from waxstudy_trials.commissioning import fitted_valve
from waxstudy_trials.family import Channels
from waxstudy_trials.plant.causes import PUTS
from waxstudy_trials.plant.description import WARM_UP_S, Plant, built
from waxstudy_trials.plant.people import later, lived_in
from waxstudy_trials.plant.weather import Weather, weather
from waxstudy_trials.put import logged_puts, scene_of, with_all, with_causes
from waxstudy_trials.when import whens

STEP_S = 10  # of what is kept
DAY_S = 86_400
FIRST = date(2023, 1, 8)
# column of the loop -> what a channel is taken from
SOURCES = {
    "air_C": "air_C",
    "reading_C": "reading_C",
    "output": "output",
    "opening": "opening",
    "flow_L_h": "flow_L_h",
    "operative_C": "operative_C",
    "floor_surface_C": "floor_surface_C",
    "return_C": "return_C",
}
SCATTERED = ("power_W", "furniture_J_K")  # otherwise, as built
UNTOUCHED = 1e-9  # the least change that a cause makes of a channel


class OtherPlant(Engine):
    """The plant of `plant.loop` in the room of the realities: wet screed, on-off thermostat, wax motor."""

    name = "other-plant"
    departs = ("actuator", "valve", "emitter", "room")
    has_baselines = True
    base: ClassVar[Plant] = Plant()
    building: ClassVar[Mapping[str, Any]] = {
        "facade_m": {"south": 4.0, "west": 2.6},
        "window_area_m2": {"south": 3.0, "west": 3.0},
        "height_m": 2.6,
    }

    @classmethod
    def causes(cls) -> Sequence[Cause]:
        return [put.cause for put in PUTS.values()]

    @classmethod
    def draw(cls, random: np.random.Generator, names: Sequence[str], days: int) -> Scene:
        scene = scene_of(random, PUTS, names, days, gains_W=(25.0, 60.0))
        scene["plant"] = cls._scatter(random)
        scene["gains_factor"] = round(float(random.normal(1.0, 0.07)), 3)
        scene["sun_factor"] = round(float(random.normal(1.0, 0.06)), 3)
        return with_causes(scene, random, PUTS, names)

    @classmethod
    def draw_built(cls, random: np.random.Generator, names: Sequence[str], days: int) -> Scene:
        scene = scene_of(random, PUTS, names, days, gains_W=(25.0, 60.0))
        scene["plant"] = {name: value for name, value in cls._scatter(random).items() if name not in SCATTERED}
        scene |= {"as_built": as_built(random), "baseline": earlier(random, scene["day"])}
        return with_causes(scene, random, PUTS, names)

    @classmethod
    def baseline_of(cls, scene: Mapping[str, Any]) -> Scene | None:
        return healthy(scene)

    @classmethod
    def _scatter(cls, random: np.random.Generator) -> dict[str, float]:
        """Return numbers in which one plant is not another."""
        scattered = {
            "sensor_s": cls.base.sensor_s * float(np.exp(random.normal(0.0, 0.25))),
            "band_K": float(random.choice([0.4, 0.5, 0.6, 1.0])),
            "power_W": cls.base.power_W * float(np.exp(random.normal(0.0, 0.04))),
            "latent_J": cls.base.latent_J * float(np.exp(random.normal(0.0, 0.06))),
            "curve": cls.base.curve * float(np.exp(random.normal(0.0, 0.15))),
            "full_flow_L_h": cls.base.full_flow_L_h * float(random.uniform(0.85, 1.15)),
            "coupling": float(random.uniform(0.0, 0.2)),
            "furniture_J_K": cls.base.furniture_J_K * float(np.exp(random.normal(0.0, 0.4))),
        }
        return {name: float(f"{value:.4g}") for name, value in scattered.items()}

    @classmethod
    def make(cls, scene: Mapping[str, Any]) -> Staged:
        from waxstudy_trials.plant.loop import simulate

        plant = cls.base._replace(**scene["plant"])
        puts = [(PUTS[each["name"]], each["values"]) for each in scene["causes"]]
        assumed, differs = cls._weather(scene), scene.get("as_built")
        true = _true(scene, assumed)
        found = simulate(built(with_all(plant, puts), differs), true, scene["setpoint_C"])
        if not np.isfinite(found).all():
            raise Unmakeable("the plant does not settle")
        whole = _kept(found) | _inputs(assumed, scene["setpoint_C"])
        whole["signal"] = whole["output"]
        still = []
        for put in puts:
            rest = built(with_all(plant, [other for other in puts if other is not put]), differs)
            how = found, put[0].cause.stages[0]
            is_logger = put[0].logger is not None
            still.append({} if is_logger else _changed(whole, simulate(rest, true, scene["setpoint_C"], *how)))
        channels, without = logged_puts(whole, float(STEP_S), puts, still)
        return Staged(
            channels=channels,
            step_s=float(STEP_S),
            first_day=(FIRST + timedelta(days=scene["day"])).isoformat(),
            described={
                "nominal": cls._nominal(plant, scene["setpoint_C"]),
                "building": {"use": "nzeb", **cls._building(plant)},
            },
            effects=[None] * len(puts),
            without=without,
            when=whens(scene["causes"], channels, float(STEP_S)),
        )

    @classmethod
    def _weather(cls, scene: Mapping[str, Any]) -> Weather:
        random, days = np.random.default_rng(scene["seed"]), scene["days"] + WARM_UP_S // DAY_S
        return weather(random, days, scene["outdoor_C"], scene["gains_W"], cls.base.window_m2)

    @classmethod
    def _nominal(cls, plant: Plant, setpoint_C: float) -> dict[str, Any]:
        """Return the chain of its data sheets: the motor's of Table 2, the valve's curve as it was measured."""
        return {
            "sensor": {"use": "lag", "time_constant_s": plant.sensor_s},
            "controller": {"use": "on-off", "dead_band_K": plant.band_K},
            "actuator": {"use": "variable-times", "product": "B"},
            "valve": {"use": "quick-opening", **fitted(plant)},
            "setpoint_C": setpoint_C,
        }

    @classmethod
    def _building(cls, plant: Plant) -> dict[str, Any]:
        """Return what is known of the room as built; nobody has weighed the furniture."""
        return {
            **cls.building,
            "floor_area_m2": plant.area_m2,
            "window_U_W_m2K": plant.window_U_W_m2K,
            "window_g": 0.30,
            "wall_U_W_m2K": plant.wall_U_W_m2K,
            "thermal_bridge_W_m2K": 0.031,
            "floor_U_W_m2K": plant.floor_U_W_m2K,
            "screed_W_mK": plant.screed_W_mK,
            "screed_J_m3K": plant.screed_J_m3K,
            "concrete_J_m3K": plant.concrete_J_m3K,
            "pipe": {
                "outer_mm": 1000.0 * plant.pipe_outer_m,
                "wall_mm": round(500.0 * (plant.pipe_outer_m - plant.pipe_inner_m), 3),
                "spacing_mm": 1000.0 * plant.spacing_m,
                "conductivity_W_mK": plant.pipe_W_mK,
            },
            "air_capacity_multiplier": 3.0,
            "infiltration_L_s": plant.leak_L_s,
            "ventilation_L_s": plant.ventilation_L_s,
            "gain_radiant_share": plant.gain_radiant,
            "nominal_flow_L_h": plant.full_flow_L_h,
            "heating_curve_C": [[-22.0, 34.0], [20.0, 22.0]],
        }


class ThinFloorPlant(OtherPlant):
    """A corner office with a thin floor, a nearly linear valve of high authority and a slow motor; kept."""

    name = "thin-floor-plant"
    is_kept = True
    base = Plant(
        sensor_s=240.0,
        power_W=15.0,
        heat_J_K=95.0,
        friction=0.03,
        lift=0.05,
        curve=0.6,
        authority=0.45,
        full_flow_L_h=170.0,
        pipe_m=120.0,
        spacing_m=0.15,
        area_m2=18.0,
        above_m=0.028,
        below_m=0.014,
        concrete_m=0.16,
        floor_U_W_m2K=0.15,
        volume_m3=50.0,
        furniture_J_K=5.0e5,
        furniture_W_K=45.0,
        wall_m2=17.1,
        partition_m2=24.1,
        board_J_m2K=22_000.0,
        wall_U_W_m2K=0.17,
        window_m2=7.0,
        window_U_W_m2K=0.9,
        bridge_W_K=1.4,
        leak_L_s=0.4,
        ventilation_L_s=9.0,
    )
    building: ClassVar[Mapping[str, Any]] = {
        "facade_m": {"south": 5.0, "west": 3.6},
        "window_area_m2": {"south": 4.0, "west": 3.0},
        "height_m": 2.8,
        "screed_above_m": 0.028,
        "screed_below_m": 0.014,
        "concrete_m": 0.16,
        "gypsum_m": 0.026,
        "partition_gypsum_m": 0.026,
    }


def _true(scene: Mapping[str, Any], assumed: Weather) -> Weather:
    """Return the weather as it was, with the people who were there."""
    differs = scene.get("as_built")
    if not differs:
        factors = {"sun_W": scene["sun_factor"], "gains_W": scene["gains_factor"]}
        return assumed._replace(**{name: factor * getattr(assumed, name) for name, factor in factors.items()})
    people = lived_in(assumed, scene["seed"])
    return people._replace(gains_W=differs["gains"] * later(people.gains_W, differs["gains_later_h"]))


def _kept(found: FloatArray) -> dict[str, FloatArray]:
    """Return the record's columns at longer steps, the flow as its mean, without the warm-up."""
    from waxstudy_trials.plant.loop import COLUMNS

    rows = found[WARM_UP_S:].reshape(-1, STEP_S, len(COLUMNS))
    kept = {ours: rows[:, -1, COLUMNS.index(column)] for column, ours in SOURCES.items()}
    kept["flow_L_h"] = rows[:, :, COLUMNS.index("flow_L_h")].mean(axis=1)
    kept["supply_C"] = rows[:, -1, COLUMNS.index("supply_C")]
    return kept


def _inputs(assumed: Weather, setpoint_C: float) -> dict[str, FloatArray]:
    """Return what is known or assumed besides, and what follows from it."""
    steps = 900 // STEP_S
    first = WARM_UP_S // 900
    held = {name: np.repeat(getattr(assumed, name)[first:], steps) for name in ("sun_W", "gains_W", "neighbour_C")}
    at = np.arange(len(held["sun_W"]) + first * steps) / steps
    outdoor_C = np.interp(at, np.arange(len(assumed.outdoor_C)), assumed.outdoor_C)[first * steps :]
    return {
        "outdoor_C": outdoor_C,
        "solar_gain_W": held["sun_W"],
        "internal_gain_W": held["gains_W"],
        "neighbour_C": held["neighbour_C"],
        "setpoint_C": np.full(len(outdoor_C), setpoint_C),
    }


def _changed(channels: Channels, still: FloatArray) -> dict[str, FloatArray]:
    """Return the channels that a cause changes, as they would be without it."""
    without = _kept(still)
    without["signal"] = without["output"]
    return {n: values for n, values in without.items() if np.max(np.abs(values - channels[n])) > UNTOUCHED}


def fitted(plant: Plant) -> dict[str, float]:
    """Return the curve that is believed of the plant's valve."""
    from waxstudy_trials.plant.loop import _lifted

    return fitted_valve(lambda opening: float(_lifted(plant, opening)), plant.lift, plant.authority)
