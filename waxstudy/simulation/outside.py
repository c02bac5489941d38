"""One case in a room of another engine, with the same interface as the fast room's loop."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from waxstudy.plugin import TRACE, OutsideRoom
from waxstudy.simulation.advance import ChainAdvance
from waxstudy.simulation.engine import Loop, Start, Week
from waxstudy.study.model import Case, Choice

OPERATIVE = TRACE.index("operative_C")


class OutsideLoop:
    """A chain closed over an outside room. `stand_in` is the fast loop that gives the first guess."""

    def __init__(self, room: Choice, case: Case, stand_in: Loop) -> None:
        self.room, self.case, self.stand_in = room, case, stand_in
        self.chain, self.driven, self.warnings = stand_in.chain, stand_in.driven, stand_in.warnings

    def weeks(
        self, setpoint_C: float, starts: Iterable[Start], *, trace: bool = False, stop: np.ndarray | None = None
    ) -> Iterator[Week]:
        """Warm up and simulate the week from every start; raise what the room raises."""
        component, driven = self.room.component, self.driven
        assert issubclass(component, OutsideRoom)
        for start in starts:
            record = component.simulate(
                self.room.parameters,
                driven.weather,
                ChainAdvance(self.case.blocks, driven.step_s, setpoint_C),
                setpoint_C=setpoint_C,
                step_s=driven.step_s,
                air_K=start.air_K,
                slab_K=start.slab_K,
                stop=lambda: stop is not None and bool(stop[0]),
            )
            cold = np.count_nonzero(record[:, OPERATIVE] < self.stand_in.limit_C)
            yield Week(hours_below=cold * driven.step_s / 3600.0, trace=record if trace else record[:0])
