"""Channels that stand in each other's place."""

from __future__ import annotations

from typing import TYPE_CHECKING

from waxstudy.dataset.notes import Notes

if TYPE_CHECKING:
    import pandas as pd

ENOUGH = 10
ROOM = ("sensor_temperature_C", "air_temperature_C", "operative_temperature_C")
COLD_C = 15.0  # outdoors: a floor heats, it does not cool
NOT_SENSED = (
    "floor_surface_temperature_C",
    "supply_temperature_C",
    "return_temperature_C",
    "ventilation_supply_temperature_C",
)
NO_FLOW_L_H = 5.0  # the noise of a meter is taken for no flow
NIGHT_H = (23, 0, 1, 2)


def look_at_pairs(values: pd.DataFrame, has_modulator: bool, notes: Notes) -> None:
    """Refuse channels that are clearly swapped, and warn of those that do not go together."""
    for name in ROOM:
        if name in values:
            _room_and_outdoors(name, values, notes)
            _room_and_setpoint(name, values, notes)
            _room_and_supply(name, values, notes)
    _ventilation_and_outdoors(values, notes)
    _supply_and_return(values, notes)
    _output_and_signal(values, has_modulator, notes)
    _signal_and_opening(values, has_modulator, notes)
    _sensor_and_air(values, notes)
    _sun_at_night(values, notes)


def _swap(first: str, second: str, why: str, notes: Notes) -> None:
    notes.refuse(f"{first}, {second}", f"look swapped: {why}")


def _both(values: pd.DataFrame, *names: str) -> pd.DataFrame | None:
    """Return the samples that several channels have; None if they are too few."""
    if not set(names) <= set(values.columns):
        return None
    pairs = values[list(names)].dropna()
    return pairs if len(pairs) >= ENOUGH else None


def _room_and_outdoors(name: str, values: pd.DataFrame, notes: Notes) -> None:
    pairs = _both(values, name, "outdoor_temperature_C")
    if pairs is None:
        return
    inside, outside = pairs[name], pairs["outdoor_temperature_C"]
    if outside.std() > 2.0 and (inside - outside).abs().mean() < 1.0:
        notes.refuse(name, "is the same as outdoor_temperature_C: one of the two is another column")
    elif (
        inside.median() < outside.median() - 5.0
        and outside.median() > COLD_C
        and outside.std() < 0.35 * max(inside.std(), 1.0)
    ):
        _swap(name, "outdoor_temperature_C", "outdoors it is warm and even, inside cold and changing", notes)
    elif inside.median() < outside.median():
        notes.warn(f"{name} is below outdoor_temperature_C most of the time: does this room need heat?")


def _room_and_setpoint(name: str, values: pd.DataFrame, notes: Notes) -> None:
    pairs = _both(values, name, "setpoint_C")
    if pairs is not None and pairs[name].nunique() <= 3 and pairs["setpoint_C"].nunique() > 50:
        _swap(name, "setpoint_C", "the setpoint moves all the time and the room hardly ever", notes)


def _room_and_supply(name: str, values: pd.DataFrame, notes: Notes) -> None:
    pairs = _both(values, name, "supply_temperature_C")
    if pairs is None or not _is_cold(values):
        return
    room, supply = pairs[name], pairs["supply_temperature_C"]
    if room.median() > 24.0 and room.median() > supply.median() + 3.0:
        _swap(name, "supply_temperature_C", "the room is warmer than the water that heats it", notes)


def _ventilation_and_outdoors(values: pd.DataFrame, notes: Notes) -> None:
    pairs = _both(values, "ventilation_supply_temperature_C", "outdoor_temperature_C")
    if pairs is None:
        return
    supplied, outside = pairs["ventilation_supply_temperature_C"], pairs["outdoor_temperature_C"]
    if outside.median() > supplied.median() + 5.0 and outside.std() < 0.35 * supplied.std():
        why = "outdoors it is warm and even, the supplied air cold and changing"
        _swap("ventilation_supply_temperature_C", "outdoor_temperature_C", why, notes)


def _is_cold(values: pd.DataFrame) -> bool:
    outdoors = values.get("outdoor_temperature_C")
    return outdoors is None or not outdoors.median() > COLD_C


def _supply_and_return(values: pd.DataFrame, notes: Notes) -> None:
    pairs = _both(values, "supply_temperature_C", "return_temperature_C", "flow_L_h")
    if pairs is None:
        return
    flowing = pairs[pairs["flow_L_h"] > max(0.5 * pairs["flow_L_h"].max(), NO_FLOW_L_H)]
    if len(flowing) < ENOUGH:
        return
    supply, back = flowing["supply_temperature_C"], flowing["return_temperature_C"]
    room = next((float(values[name].median()) for name in ROOM if name in values), 22.0)
    if (back - supply > 0.5).mean() > 0.8 and back.median() > room + 2.0:
        _swap(
            "supply_temperature_C",
            "return_temperature_C",
            "the return is warmer while water flows (or one is several K off)",
            notes,
        )


def _output_and_signal(values: pd.DataFrame, has_modulator: bool, notes: Notes) -> None:
    pairs = _both(values, "control_output", "heating_signal")
    if pairs is None or not has_modulator:
        return
    if pairs["control_output"].nunique() <= 2 and pairs["heating_signal"].nunique() > 20:
        why = "a modulator is believed, and the output is 0 or 1 while the signal takes many values"
        _swap("control_output", "heating_signal", why, notes)


def _signal_and_opening(values: pd.DataFrame, has_modulator: bool, notes: Notes) -> None:
    names = ("control_output", "heating_signal", "displacement")
    found = _both(values, *names)
    if found is None or has_modulator:
        return
    output, signal, opening = (found[name] for name in names)
    if output.nunique() > 1 and (output == opening).mean() > 0.999 and (output == signal).mean() < 0.99:
        why = "the opening is the control output to the digit, and the signal is not"
        _swap("heating_signal", "displacement", why, notes)


def _sensor_and_air(values: pd.DataFrame, notes: Notes) -> None:
    pairs = _both(values, "sensor_temperature_C", "air_temperature_C")
    if pairs is None:
        return
    difference_K = pairs["sensor_temperature_C"] - pairs["air_temperature_C"]
    if abs(difference_K.median()) > 3.0:
        off = f"{difference_K.median():+.2g} K off air_temperature_C"
        notes.warn(f"sensor_temperature_C is {off}: are they of the same room?")
    for name in NOT_SENSED:
        others = _both(values, "sensor_temperature_C", name)
        if others is not None and difference_K.std() > 0.2:
            other_K = others["sensor_temperature_C"] - others[name]
            if other_K.std() < 0.3 * difference_K.std() and abs(other_K.median()) < 3.0:
                _swap("air_temperature_C", name, f"the sensor follows {name} and not the air", notes)


def _sun_at_night(values: pd.DataFrame, notes: Notes) -> None:
    """The sun does not shine at night: two channels are swapped, or the clock is wrong."""
    if "solar_gain_W" not in values:
        return
    at_night = values.index.hour.isin(NIGHT_H)  # type: ignore[attr-defined]
    solar = values["solar_gain_W"]
    night_W, day_W = float(solar[at_night].mean()), float(solar[~at_night].mean())
    if not (night_W > 2.0 and night_W > 0.1 * day_W):
        return
    for name in ("internal_gain_W", "flow_L_h"):
        if name in values and values[name][at_night].max() <= 0.0 < values[name].max():
            _swap("solar_gain_W", name, "the first is there at night, the second never", notes)
            return
    notes.warn(f"solar_gain_W is {night_W:.3g} W on average at night: are its clock and column right?")
