"""Channels that stand in each other's place."""

from __future__ import annotations

from functools import partial

import pandas as pd

from waxstudy.dataset.channels import LIGHT
from waxstudy.dataset.checks.check import Findings, Record, Refuse, Warn, check
from waxstudy.dataset.limits import (
    ABOVE_ROOM_K,
    ANOTHER,
    APART_K,
    BACK_K,
    BELOW_K,
    COLD_C,
    DARK,
    DARK_W,
    ENOUGH,
    EVEN,
    FOLLOWS,
    HELD,
    MANY,
    MOSTLY,
    MOVED,
    NIGHT_H,
    NO_FLOW_L_H,
    OFF_K,
    SAME,
    SAME_K,
    TWO,
    VARIED_K,
    WARM_C,
    WARMER_K,
)

SENSOR, AIR, OPERATIVE = ROOM = ("sensor_temperature_C", "air_temperature_C", "operative_temperature_C")
OUTDOORS, VENTILATION = "outdoor_temperature_C", "ventilation_supply_temperature_C"
SUPPLY, RETURN, FLOOR = "supply_temperature_C", "return_temperature_C", "floor_surface_temperature_C"
OUTPUT, SIGNAL, OPENING, FLOW = "control_output", "heating_signal", "displacement", "flow_L_h"
SUN, PEOPLE = "solar_gain_W", "internal_gain_W"


swapped = partial(check, mend="name them the other way round in `[columns]`")


def _swapped(first: object, second: object, why: str) -> Refuse:
    return Refuse(f"{first}, {second}", f"look swapped: {why}")


@swapped("room", "refuses or warns", *((name, OUTDOORS) for name in ROOM))
def room_and_outdoors(record: Record, inside: pd.Series, outside: pd.Series) -> Findings:
    """A room that is the same as outdoors within {SAME_K:g} K; or a cold and changing one, with {BELOW_K:g} K more and
    even outdoors, over {COLD_C:g} °C. Any other room below outdoors most of the time is a warning."""
    inside_C, outside_C = inside.median(), outside.median()
    is_even = outside_C > COLD_C and outside.std() < EVEN * max(inside.std(), 1.0)
    if outside.std() > VARIED_K and (inside - outside).abs().mean() < SAME_K:
        yield Refuse(inside.name, f"is the same as {OUTDOORS}: one of the two is another column")
    elif inside_C < outside_C - BELOW_K and is_even:
        yield _swapped(inside.name, OUTDOORS, "outdoors it is warm and even, inside cold and changing")
    elif inside_C < outside_C:
        yield Warn(f"{inside.name} is below {OUTDOORS} most of the time: does this room need heat?")


@swapped("room", "refuses", *((name, "setpoint_C") for name in ROOM))
def room_and_setpoint(record: Record, room: pd.Series, setpoint: pd.Series) -> Findings:
    """A setpoint that takes over {MOVED} values, while the room takes {HELD} at most."""
    if room.nunique() <= HELD and setpoint.nunique() > MOVED:
        yield _swapped(room.name, setpoint.name, "the setpoint moves all the time and the room hardly ever")


@swapped("room", "refuses", *((name, SUPPLY) for name in ROOM))
def room_and_supply(record: Record, room: pd.Series, supply: pd.Series) -> Findings:
    """A room above {WARM_C:g} °C and {WARMER_K:g} K above the supply, unless outdoors it is above {COLD_C:g} °C."""
    is_warm = OUTDOORS in record.values and record.values[OUTDOORS].median() > COLD_C
    if not is_warm and room.median() > max(WARM_C, supply.median() + WARMER_K):
        yield _swapped(room.name, SUPPLY, "the room is warmer than the water that heats it")


@swapped("ventilation", "refuses", (VENTILATION, OUTDOORS))
def ventilation_and_outdoors(record: Record, supplied: pd.Series, outside: pd.Series) -> Findings:
    """Cold and changing air that is supplied, while outdoors it is {BELOW_K:g} K warmer and even."""
    if outside.median() > supplied.median() + BELOW_K and outside.std() < EVEN * supplied.std():
        yield _swapped(VENTILATION, OUTDOORS, "outdoors it is warm and even, the supplied air cold and changing")


@swapped("water", "refuses or warns", (SUPPLY, RETURN, FLOW))
def supply_and_return(record: Record, supply: pd.Series, back: pd.Series, flow: pd.Series) -> Findings:
    """A return {BACK_K:g} K above the supply in {MOSTLY:.0%} of the samples with over half of the largest flow, and
    {ABOVE_ROOM_K:g} K above the room. A warning, if no temperature of the room was recorded: nobody knows then whether
    the water heats."""
    is_flowing = flow > max(0.5 * flow.max(), NO_FLOW_L_H)
    supply, back = supply[is_flowing], back[is_flowing]
    if len(back) < ENOUGH or not (back - supply > BACK_K).mean() > MOSTLY:
        return
    room_C = next((record.values[name].median() for name in ROOM if name in record.values), None)
    if room_C is None:
        yield Warn(
            f"{RETURN} is above {SUPPLY} while water flows: are they swapped? No channel tells how warm the room is"
        )
    elif back.median() > room_C + ABOVE_ROOM_K:
        yield _swapped(SUPPLY, RETURN, "the return is warmer while water flows (or one is several K off)")


@swapped("signals", "refuses", (OUTPUT, SIGNAL))
def output_and_signal(record: Record, output: pd.Series, signal: pd.Series) -> Findings:
    """An output before a modulator with {TWO} values, and a signal behind it with over {MANY}."""
    if record.has_modulator and output.nunique() <= TWO and signal.nunique() > MANY:
        why = "a modulator is believed, and the output is 0 or 1 while the signal takes many values"
        yield _swapped(OUTPUT, SIGNAL, why)


@check("signals", "warns", (OUTPUT,), mend="name it heating_signal in `[columns]`, if that is what the motor gets")
def output_without_signal(record: Record, output: pd.Series) -> Findings:
    """An output before a modulator with {TWO} values, and no signal recorded: it may be a call for heat, which is the
    signal."""
    if record.has_modulator and SIGNAL not in record.values and output.nunique() == TWO:
        yield Warn(
            f"{OUTPUT} has {TWO} values, though a modulator is believed behind it: is it what the motor gets? "
            f"Then it is {SIGNAL}"
        )


@swapped("signals", "refuses", (OUTPUT, SIGNAL, OPENING))
def signal_and_opening(record: Record, output: pd.Series, signal: pd.Series, opening: pd.Series) -> Findings:
    """An opening that is the output to the digit, and a signal that is not, with no modulator between."""
    is_opening, is_signal = (output == opening).mean() > SAME, (output == signal).mean() >= ANOTHER
    if not record.has_modulator and output.nunique() > 1 and is_opening and not is_signal:
        yield _swapped(SIGNAL, OPENING, "the opening is the control output to the digit, and the signal is not")


@check("sensor", "warns", (SENSOR, AIR), mend="both of one room; an offset of the sensor may stay")
def sensor_and_air(record: Record, sensor: pd.Series, air: pd.Series) -> Findings:
    """A sensor over {OFF_K:g} K off the air, in the median."""
    off_K = (sensor - air).median()
    if abs(off_K) > OFF_K:
        yield Warn(f"{SENSOR} is {off_K:+.2g} K off {AIR}: are they of the same room?")


@swapped("sensor", "refuses", *((SENSOR, AIR, name) for name in (FLOOR, SUPPLY, RETURN, VENTILATION)), fewest=0)
def air_and_another(record: Record, sensor: pd.Series, air: pd.Series, other: pd.Series) -> Findings:
    """A sensor that follows a temperature of floor, water or supplied air, and that far more closely than the air."""
    air_K, other_K = (sensor - air).dropna(), (sensor - other).dropna()
    follows = air_K.std() > APART_K and other_K.std() < FOLLOWS * air_K.std() and abs(other_K.median()) < OFF_K
    if follows and min(len(air_K), len(other_K)) >= ENOUGH:
        yield _swapped(AIR, other.name, f"the sensor follows {other.name} and not the air")


@check("sun", "refuses or warns", (SUN,), fewest=0, mend="right clock and column in `[columns]`")
def sun_at_night(record: Record, solar: pd.Series) -> Findings:
    """Sun from 23 to 3 h, over {DARK_W:g} W and {DARK:.0%} of that by day, while there are no other gains, or no flow,
    at that time. A warning, if there are, or if they are not measured."""
    values = record.values
    at_night = values.index.hour.isin(NIGHT_H)  # type: ignore[attr-defined]
    night_W, day_W = float(solar[at_night].mean()), float(solar[~at_night].mean())
    if not (night_W > DARK_W and night_W > DARK * day_W):
        return
    there = [name for name in (PEOPLE, FLOW) if name in values]
    dark = [name for name in there if values[name][at_night].max() <= 0.0 < values[name].max()]
    if dark:
        yield _swapped(SUN, dark[0], "the first is there at night, the second never")
    else:
        yield Warn(f"{SUN} is {night_W:.3g} W on average at night: are its clock and column right?")


@check("sun", "warns", *((name,) for name in LIGHT), fewest=0, mend="right clock and column in `[columns]`")
def light_at_night(record: Record, light: pd.Series) -> Findings:
    """Light or power of panels from 23 to 3 h, over {DARK_W:g} (W/m2, W) and {DARK:.0%} of that by day."""
    at_night = record.values.index.hour.isin(NIGHT_H)  # type: ignore[attr-defined]
    night, day = float(light[at_night].mean()), float(light[~at_night].mean())
    if night > DARK_W and night > DARK * day:
        yield Warn(f"{light.name} is {night:.3g} on average at night: are its clock and column right?")
