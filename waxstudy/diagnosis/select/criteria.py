"""What it takes to claim an effect, by where it is claimed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.diagnosis.estimate.fitter import Fitter
from waxstudy.diagnosis.model.conventions import LONG_S
from waxstudy.diagnosis.model.segments import SUPPLY
from waxstudy.diagnosis.observations.record import CONTINUOUS

LEAST_GAP = 1.1  # over the floor
LEAST_SAMPLED_GAP, LEAST_SMOOTHED_GAP = 1.5, 1.75
LEAST_OF_TRAVEL = 3.5  # the same of a motor that moves from end to end between two samples
LEAST_SHARE = 0.5  # of a gap above its floor that an effect must explain
LEAST_OF_SENSOR = 0.9  # the same of a thermometer, of which little else is to be known
LEAST_OF_FORM = 0.8  # the same of an effect with several parameters over the whole record: they bend to much
# the same in whitened residual, of a valve's clear gap: other circuits are in all of its flow, its curve where it moves
LEAST_OF_VALVE, CLEAR_GAP = 0.15, 3.0
CLEAR_GAIN = 50.0  # whitened
EXPLAINED = 1.5  # what is left over the floor, where nothing else can be in it


@dataclass(frozen=True)
class Needs:
    """What a claim must reach, besides being no chance and worth a name."""

    gap: float  # floors that its channel is missed by
    share: float  # of whitened residual above the floor that it explains
    plain_share: float  # of residual in the channel's unit, likewise
    left: float  # floors that it may leave

    @classmethod
    def of(cls, fitter: Fitter, stage: str, channel: str, unit: str, gain: float, over: float) -> Needs:
        """Return what an effect of a stage needs at a channel that is missed by `over` floors, where it gains so much.

        A heating curve is claimed to be shifted only where nothing else is left of its gap.
        """
        share = LEAST_OF_SENSOR if stage == "sensor" else LEAST_SHARE
        is_clear_flow = stage == "valve" and gain >= CLEAR_GAIN and over >= CLEAR_GAP
        return cls(
            gap=least_gap(fitter, channel, unit),
            share=LEAST_OF_VALVE if is_clear_flow else share,
            plain_share=share,
            left=EXPLAINED if channel == SUPPLY else np.inf,
        )


def runs_on(channel: str, unit: str) -> bool:
    """Whether a channel is a control output that does not switch."""
    return channel == "control_output" and unit != "s"


def least_gap(fitter: Fitter, channel: str, unit: str) -> float:
    """Return the gap over the floor below which nothing is claimed: more where a floor is not all that must be missed.

    Behind a smoothed drive an output cut off at 0 or 1 looks like another tuning, and a pulse that comes too late like
    another motor; samples that are far apart miss how a motor moved between them.
    """
    behind = channel in ("displacement", "flow_L_h")
    needs = [LEAST_GAP]
    if runs_on(channel, unit) or (behind and fitter.segment.driven_by in CONTINUOUS):
        needs.append(LEAST_SMOOTHED_GAP)
    if behind and fitter.record.interval_s >= LONG_S:
        needs.append(LEAST_OF_TRAVEL if channel == "displacement" else LEAST_SAMPLED_GAP)
    return max(needs)
