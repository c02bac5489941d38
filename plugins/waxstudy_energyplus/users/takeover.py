"""The copy of a user's model that is run: its days, and the control of one unit; all else as the user made it."""

from __future__ import annotations

import copy
from calendar import isleap
from collections.abc import Mapping
from datetime import date, timedelta
from pathlib import Path
from typing import Any

from waxstudy_energyplus.model import UNWANTED, Model
from waxstudy_energyplus.users.file import UsersModel
from waxstudy_energyplus.users.loop import ALWAYS_WARM_C, NEVER_C, STILL_WARMER_C
from waxstudy_energyplus.users.zones import BASEBOARDS, VARIABLE, Unit

OURS = "waxstudy"
WARM, WARMER, NEVER = f"{OURS} always", f"{OURS} always above", f"{OURS} never"
AVAILABLE = f"{OURS} availability"
OUTDOORS = "outdoor"  # in the name of a control temperature: then the schedules are a heating curve
WEEKDAYS = ("Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday")
OWN_STEPS_PER_HOUR = 6  # EnergyPlus' own, for a model that does not say
NO_DAY_YEAR = 2017  # EnergyPlus' own for a model that names neither year nor day of the week


def taken_over(model: UsersModel, unit: Unit, first: date, days: int, steps_per_hour: int) -> Model:
    """Return the model for so many days from a day on, with a unit that does what the runtime API says."""
    objects = of_days(model, first, days, steps_per_hour)
    _take_control(objects, model, unit)
    return objects


def of_days(model: UsersModel, first: date, days: int, steps_per_hour: int) -> Model:
    """Return the model for so many days from a day on, without its reports, which change no result."""
    objects = {
        kind: {name: copy.deepcopy(dict(fields)) for name, fields in named.items()}
        for kind, named in model.objects.items()
        if not kind.startswith(("Output:", "OutputControl:"))
    }
    _resolve_files(objects, model.path.parent)
    objects["OutputControl:Files"] = {"files": {f"output_{name}": "No" for name in UNWANTED}}
    control = model.first("SimulationControl")
    periods = {"run_simulation_for_sizing_periods": "No", "run_simulation_for_weather_file_run_periods": "Yes"}
    objects["SimulationControl"] = {
        "control": {**control, **periods, "do_hvac_sizing_simulation_for_sizing_periods": "No"}
    }
    objects["Timestep"] = {"step": {"number_of_timesteps_per_hour": steps_per_hour}}
    objects["RunPeriod"] = {f"{OURS} days": _period(model, first, days)}
    return objects


def steps_per_hour(model: UsersModel) -> int:
    """Return the model's own zone time steps per hour."""
    return int(model.first("Timestep").get("number_of_timesteps_per_hour", OWN_STEPS_PER_HOUR))


def first_day(model: UsersModel, month: int, day: int) -> date:
    """Return a day of the year in a year whose weekdays are those of the model's own run period.

    It is no leap year: most weather files have no 29 February.
    """
    period = model.first("RunPeriod")
    weekday, year = period.get("day_of_week_for_start_day"), int(period.get("begin_year") or 0)
    if year and isleap(year):
        return date(_with_weekday(month, day, date(year, month, day).weekday()), *_of_any(month, day))
    if weekday and not year:
        begin = int(period["begin_month"]), int(period["begin_day_of_month"])
        year = _with_weekday(*begin, WEEKDAYS.index(weekday))
    return date(year or NO_DAY_YEAR, *_of_any(month, day))


def _with_weekday(month: int, day: int, weekday: int) -> int:
    """Return a year that is no leap year and has a weekday on a day."""
    later = _of_any(month, day) != (month, day)
    years = (year for year in range(2001, 2029) if not isleap(year))
    return next(year for year in years if date(year, *_of_any(month, day)).weekday() == (weekday + later) % 7)


def _of_any(month: int, day: int) -> tuple[int, int]:
    """Return a day that any year has: the one after 29 February."""
    return (3, 1) if (month, day) == (2, 29) else (month, day)


def _period(model: UsersModel, first: date, days: int) -> dict[str, Any]:
    """Return the run period; holidays, rain and snow as the model's own has them."""
    own = dict(model.first("RunPeriod"))
    own.pop("day_of_week_for_start_day", None)
    last = first + timedelta(days=days - 1)
    for side, day in (("begin", first), ("end", last)):
        own |= {f"{side}_month": day.month, f"{side}_day_of_month": day.day, f"{side}_year": day.year}
    return own


def _take_control(objects: Model, model: UsersModel, unit: Unit) -> None:
    """Give the unit a design object and schedules of its own, with which it always asks for heat.

    A baseboard takes the zone's thermostat for that, and an availability of its own, which the run sets.
    """
    fields = objects[unit.kind][unit.name]
    if unit.kind in BASEBOARDS:
        objects.setdefault("Schedule:Constant", {})[AVAILABLE] = {"hourly_value": 1.0}
        fields["availability_schedule_name"] = AVAILABLE
        return
    found = model.named(f"{unit.kind}:Design", fields["design_object"])
    design = copy.deepcopy(dict(found[1])) if found is not None else {}
    values = {WARM: ALWAYS_WARM_C, WARMER: STILL_WARMER_C, NEVER: NEVER_C}
    for name, value in values.items():
        objects.setdefault("Schedule:Constant", {})[name] = {"hourly_value": value}
    if unit.kind == VARIABLE:
        design["heating_control_temperature_schedule_name"] = WARMER
        if "cooling_control_temperature_schedule_name" in design:
            design["cooling_control_temperature_schedule_name"] = NEVER
    else:
        _ask_for_heat(fields, design)
    objects[f"{unit.kind}:Design"][f"{OURS} design"] = design
    fields["design_object"] = f"{OURS} design"


def _ask_for_heat(fields: dict[str, Any], design: Mapping[str, Any]) -> None:
    """Let a unit of constant flow take its warmest water, unless its water follows the outdoor temperature."""
    if OUTDOORS not in str(design.get("temperature_control_type", "")).lower():
        fields["heating_high_control_temperature_schedule_name"] = WARMER
        fields["heating_low_control_temperature_schedule_name"] = WARM
    for side in ("high", "low"):
        if fields.get(name := f"cooling_{side}_control_temperature_schedule_name"):
            fields[name] = NEVER


def _resolve_files(objects: Model, folder: Path) -> None:
    """Make the names of files that stand beside the model absolute: the copy runs elsewhere."""
    for named in objects.values():
        for fields in named.values():
            for key, value in fields.items():
                if key.endswith("file_name") and isinstance(value, str) and (folder / value).is_file():
                    fields[key] = str((folder / value).resolve())
