"""A reality with effects of the library that the modeller does not believe in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from waxstudy.plugin import Belief, Choice, Effect, Inputs, OutsideRoom, Role
from waxstudy.plugin.registry import told
from waxstudy.simulation import ensemble
from waxstudy.simulation.engine import Loop
from waxstudy.simulation.modes import drive
from waxstudy.simulation.outside import OutsideLoop
from waxstudy.simulation.run import loop_of
from waxstudy.study.model import Case, Study
from waxstudy.synthetic.departures import Departures, departed, departed_inputs
from waxstudy.synthetic.feedback import Change, march
from waxstudy.synthetic.simulate import (
    ROLE_CHANNELS,
    Reality,
    happened,
    reality_loop,
    simulate,
    surroundings,
    with_series,
)

INTERVAL_S = 60.0  # of the inputs that an effect edits


class EffectError(ValueError):
    """An effect cannot be part of this reality; the message says why."""


def with_effects(
    study: Study,
    case: Case,
    weeks: Sequence[str],
    days: int | None,
    setpoint_C: float,
    effects: Sequence[Choice],
    departures: Departures = MappingProxyType({}),
) -> tuple[Case, Reality]:
    """Return a case with effects in its chain, and what happens in its room with all of them.

    Room and heat stray from what is believed by `departures`, which are nobody's effect. What is recorded of supply,
    sun, gains and air outside is what is believed, without either. Raises as `reality_loop` and `march` do, and
    `EffectError`.
    """
    believed = reality_loop(study, case, weeks, days)
    belief = Belief(case.blocks, study.room, believed_inputs(believed, setpoint_C))
    true = applied(effects, departed(belief, departures))
    assert true.room
    case, study = replace(case, blocks=true.blocks), replace(study, room=true.room)
    loop = reality_loop(study, case, weeks, days)
    inputs = belief.inputs
    if inputs is None or true.inputs is inputs:
        return case, simulate(loop, study, setpoint_C, believed)

    def change(seen: Inputs) -> Inputs:
        changed = applied(effects, replace(belief, inputs=departed_inputs(seen, departures))).inputs
        assert changed
        return changed

    return case, _with_inputs(loop, study, case, inputs, change, setpoint_C, believed)


def _with_inputs(
    loop: Loop | OutsideLoop,
    study: Study,
    case: Case,
    inputs: Inputs,
    change: Change,
    setpoint_C: float,
    believed: Loop | OutsideLoop,
) -> Reality:
    """Return what happens under inputs that are changed, by the minute."""
    with told("[room]"):
        parts = round(loop.driven.weather.interval_s / inputs.interval_s)
        weather = with_series(loop.driven.weather, lambda values: np.repeat(values, parts))
        weather = replace(weather, interval_s=inputs.interval_s)
        by_minute = loop_of(study, case, drive(loop.driven.room, weather, study.step_s))
    assert isinstance(by_minute, Loop)
    true, week = march(by_minute, inputs, change, setpoint_C, ensemble.starts(study.ensemble)[0])
    return happened(true, week, study, setpoint_C, believed)


def _comes_later(effect: Choice) -> bool:
    return not (issubclass(effect.component, Effect) and effect.component.replaces)


def applied(effects: Sequence[Choice], belief: Belief) -> Belief:
    """Return a belief with all effects, those that replace a block first; raise `EffectError`, or `PluginError`."""
    for chosen in sorted(effects, key=_comes_later):
        effect = chosen.component
        assert issubclass(effect, Effect)
        what = f"effect '{effect.name}'"
        with told(what, EffectError):
            if hindrance := effect.hindrance(belief):
                raise EffectError(f"{what}: {hindrance}")
            try:
                made = effect.apply(belief, chosen.parameters)
            except ValueError as error:
                raise EffectError(f"{what}: {error}") from error
        if made.inputs is not belief.inputs and belief.room and issubclass(belief.room.component, OutsideRoom):
            raise EffectError(
                f"{what}: it changes what drives the room, which room '{belief.room.component.name}' keeps to its own "
                "engine; take a fast room"
            )
        belief = made
    return belief


def believed_inputs(loop: Loop | OutsideLoop, setpoint_C: float) -> Inputs:
    """Return what is believed to drive a room, by the minute or nearly so; its own air and flow are still to be had."""
    length = _steps_per_input(loop)
    values = {name: series[::length] for name, series in surroundings(loop).items()}
    count = len(values["outdoor_C"])
    return Inputs(
        interval_s=length * loop.driven.step_s,
        start_s=0.0,
        outdoor_C=values["outdoor_C"],
        supply_C=values["supply_C"],
        solar_W=values["solar_gain_W"],
        gains_W=values.get(ROLE_CHANNELS[Role.GAINS], np.zeros(count)),
        air_C=np.full(count, setpoint_C),
        ventilation_C=values.get(ROLE_CHANNELS[Role.SUPPLY_AIR]),
        flow_L_h=np.zeros(count),
        neighbour_C=values.get(ROLE_CHANNELS[Role.NEIGHBOUR]),
    )


def _steps_per_input(loop: Loop | OutsideLoop) -> int:
    """Return the least number of steps that lasts a minute and divides the weather's interval."""
    most, least = loop.driven.steps_per_interval, INTERVAL_S / loop.driven.step_s - 1e-9
    return next((n for n in range(1, most) if n >= least and most % n == 0), most)
