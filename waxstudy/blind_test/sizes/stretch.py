"""A stretch of the loop between recorded channels: what it would show, driven by what was recorded before it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.blind_test.sizes.record import Record
from waxstudy.blind_test.sizes.room import OUTPUTS, built, response
from waxstudy.plugin import CHAIN, STAGES, Belief, Choice, FloatArray, Modulator
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.replay import replay

# what a block of each kind shows
SHOWN = {
    "sensor": "sensor_temperature_C",
    "controller": "control_output",
    "modulator": "heating_signal",
    "actuator": "displacement",
    "valve": "flow_L_h",
}
STEP_S = 5.0
CELL_S = 15.0  # of an interval: the shifts at which a switch is taken to be thrown
LEAST_RHYTHM = 0.5  # how far pulses must agree on when a period begins: 1 is all at one time

Shown = dict[str, FloatArray]


@dataclass(frozen=True)
class Stretch:
    """Stages between recorded channels: `driven_by` lies before them, those that are `judged` behind."""

    stages: tuple[str, ...]
    driven_by: str
    judged: tuple[str, ...]

    @property
    def name(self) -> str:
        return "+".join(self.stages)

    @property
    def has_room(self) -> bool:
        return "room" in self.stages

    def shown(self, record: Record, belief: Belief, is_rough: bool = False) -> Shown:
        """Return what the judged channels would show: (n,), of a room (quarters,).

        What hangs on when a switch was thrown within its interval is (shifts, n), a row for each time. Raises
        `SimulationError`, and `ValueError` for a room that cannot be.
        """
        kinds = [stage for stage in self.stages if stage in CHAIN]
        found = self._of_chain(record, belief, kinds) if kinds else {}
        if self.has_room:
            flow_L_h = found["flow_L_h"] if "valve" in kinds else record.values["flow_L_h"]
            found |= response(belief, _in_the_middle(flow_L_h), is_rough)
        return {channel: found[channel] for channel in self.judged}

    def _of_chain(self, record: Record, belief: Belief, kinds: list[str]) -> Shown:
        found: Shown = {}
        if self.driven_by == SHOWN["sensor"] and kinds[0] == "sensor":
            if SHOWN["sensor"] in self.judged:
                sensor = _replayed(record, belief, ["sensor"], record.drive(record.air), 1, None)
                found[SHOWN["sensor"]] = sensor["sensor"][0]
            kinds = kinds[1:]  # the controller reads what was recorded
        signal, parts, jump = record.drive(self.driven_by), 1, None
        is_switch = self.driven_by in record.switches
        if is_switch:
            parts = max(2, round(record.interval_s / CELL_S))
            signal, jump = np.repeat(signal, parts), np.full(parts * len(record), 0.5)
        for kind, rows in _replayed(record, belief, kinds, signal, parts, jump).items():
            is_shifted = is_switch and kind in ("actuator", "valve")
            found[SHOWN[kind]] = rows if is_shifted else _in_the_middle(rows)
        return found


def _replayed(
    record: Record, belief: Belief, kinds: list[str], signal: FloatArray, parts: int, jump: FloatArray | None
) -> Shown:
    """Return what each kind of block shows (parts, n), driven by a signal in cells (n * parts,), the flow in L/h.

    A row is what lies so many cells before the end of each interval, as if everything came that much later.
    """
    blocks = {kind: belief.blocks[kind] for kind in kinds if kind in belief.blocks}
    cell_s = record.interval_s / parts
    chain = Chain(blocks, cell_s / np.ceil(cell_s / STEP_S))
    setpoint_C = np.repeat(record.values.get("setpoint_C", np.zeros(len(record))), parts)
    start_s = -_late_s(record, blocks.get("modulator"))
    ends, mean = replay(chain, kinds[0], signal, setpoint_C, interval_s=cell_s, start_s=start_s, jump=jump)
    found = {kind: ends[kind].reshape(-1, parts)[:, ::-1].T for kind in kinds}
    if "valve" in kinds:
        assert belief.room
        total = np.cumsum(mean["valve"]).reshape(-1, parts)[:, ::-1].T
        found["valve"] = built(belief.room).full_flow_L_h / parts * np.diff(total, prepend=0.0)
    return found


def _in_the_middle(rows: FloatArray) -> FloatArray:
    return rows[len(rows) // 2] if rows.ndim == 2 else rows


def _late_s(record: Record, modulator: Choice | None) -> float:
    """Return how late a modulator's periods begin, by its pulses: nobody knows when its clock was switched on."""
    if modulator is None or "heating_signal" not in record.switches:
        return 0.0
    assert issubclass(modulator.component, Modulator)
    if not modulator.component.period:
        return 0.0
    period_s = float(getattr(modulator.parameters, modulator.component.period))
    rises = np.flatnonzero(np.diff(record.values["heating_signal"]) > 0.0)
    face = np.sum(np.exp(2j * np.pi * (rises + 1.5) * record.interval_s / period_s)) / max(1, len(rises))
    return float(np.angle(face)) / (2.0 * np.pi) * period_s if abs(face) > LEAST_RHYTHM else 0.0


def stretch_of(stage: str, record: Record, belief: Belief) -> Stretch | None:
    """Return the stretch that shows a stage, None where nothing recorded does or what drives it is not known.

    It reaches from the last recorded channel before the stage to the first behind it, or to the room.
    """
    shown = [n for n, kind in enumerate(CHAIN) if n and SHOWN[kind] in record.values]
    place = STAGES.index(stage)
    before = max((n for n in shown if n < place), default=0)
    behind = min((n for n in shown if n >= place), default=len(CHAIN))
    knows_drive = "controller" in belief.blocks and "setpoint_C" in record.values and bool(record.sensed)
    if not (before or knows_drive) or (behind < len(CHAIN) and not belief.blocks):
        return None
    driven_by = SHOWN[CHAIN[before]] if before else record.sensed
    first = before + 1 if before else 0
    seen = (SHOWN["sensor"],) if driven_by == SHOWN["sensor"] and "air_temperature_C" in record.values else ()
    if behind < len(CHAIN):
        return Stretch(STAGES[first : behind + 1], driven_by, (*seen, SHOWN[CHAIN[behind]]))
    # a return says nothing without knowing when water flowed
    shows = [c for c in OUTPUTS if c in record.values and (c != "return_temperature_C" or "flow_L_h" in record.values)]
    is_driven = bool(shows and belief.room and belief.inputs)
    return Stretch(STAGES[first:], driven_by, (*seen, *shows)) if is_driven else None
