"""Families of emitter and room: what the water and the air get besides."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from waxstudy.plugin import Belief, FloatArray, Inputs, Prior
from waxstudy_trials.family import Family, one


class InputFamily(Family):
    """A family that changes what drives the room."""

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        assert belief.inputs
        return replace(belief, inputs=cls.driven(belief.inputs, p))

    @classmethod
    def driven(cls, inputs: Inputs, p: Any) -> Inputs:
        raise NotImplementedError


def warmed(inputs: Inputs, heat_W: FloatArray) -> Inputs:
    """Return the inputs with heat to the air besides."""
    before = 0.0 if inputs.extra_W is None else inputs.extra_W
    return replace(inputs, extra_W=before + heat_W)


class HuntingSupply(InputFamily):
    """The mixing valve hunts: the water swings around what the slow sensor at the manifold shows."""

    name = "hunting-supply"
    stage = "emitter"
    stages = ("emitter", "room")
    Parameters = one("swing_K", 0.0, "K", "Amplitude of the swing, with a period of three hours.", 0.0, 15.0)
    priors = {"swing_K": Prior(0.0, 12.0, noticeable=0.3)}

    @classmethod
    def driven(cls, inputs: Inputs, p: Any) -> Inputs:
        swing_K = p.swing_K * np.sin(2.0 * np.pi * inputs.hour / 3.0)
        return replace(inputs, supply_C=inputs.supply_C + swing_K)


class Stove(InputFamily):
    """On cold evenings somebody lights a stove."""

    name = "stove"
    stage = "room"
    stages = ("room", "emitter")
    Parameters = one("heat_W", 0.0, "W", "Heat to the air from 18 to 22 h while it is colder than -2 C.", 0.0, 2000.0)
    priors = {"heat_W": Prior(0.0, 1000.0, noticeable=10.0)}

    @classmethod
    def driven(cls, inputs: Inputs, p: Any) -> Inputs:
        is_lit = (inputs.hour >= 18.0) & (inputs.hour < 22.0) & (inputs.outdoor_C < -2.0)
        return warmed(inputs, p.heat_W * is_lit)


class OpenDoor(InputFamily):
    """Over noon and of an evening the door to a cool hall stands open."""

    name = "open-door"
    stage = "room"
    stages = ("room", "emitter")
    is_kept = True
    Parameters = one("conductance_W_K", 0.0, "W/K", "Exchange with a hall of 15 C.", 0.0, 100.0)
    priors = {"conductance_W_K": Prior(0.0, 40.0, noticeable=0.5)}

    @classmethod
    def driven(cls, inputs: Inputs, p: Any) -> Inputs:
        hour = inputs.hour
        is_open = ((hour >= 12.0) & (hour < 13.5)) | ((hour >= 17.5) & (hour < 19.0))
        return warmed(inputs, p.conductance_W_K * is_open * (15.0 - inputs.air_C))


class ColdVentilation(InputFamily):
    """In hard frost the heat recovery thaws, and its supply air is colder than its sensor shows."""

    name = "cold-ventilation"
    stage = "room"
    stages = ("room", "emitter")
    is_kept = True
    Parameters = one("flow_W_K", 0.0, "W/K", "Air flow that bypasses the recovery below -4 C.", 0.0, 50.0)
    priors = {"flow_W_K": Prior(0.0, 20.0, noticeable=0.3)}

    @classmethod
    def driven(cls, inputs: Inputs, p: Any) -> Inputs:
        bypass_W_K = p.flow_W_K * (inputs.outdoor_C < -4.0)
        return warmed(inputs, bypass_W_K * (inputs.outdoor_C - inputs.air_C))
