"""What textbooks say of gain and integration time, for the linearised loop of a case.

Sources: Ziegler and Nichols (1942), by the ultimate gain; Skogestad (2003), SIMC for a process that integrates, with as
long a closed loop as the delay; lambda tuning (Dahlin 1968) of such a process, with three delays for lambda.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from waxstudy.loop.linear import LinearLoop

DELAYS_IN_LAMBDA = 3.0  # usual for a process whose delay is not known well


@dataclass(frozen=True)
class Rule:
    """A rule's name, and the settings that it gives."""

    name: str
    gain: float  # 1/K
    integration_time_s: float


def textbook_rules(loop: LinearLoop) -> Iterator[Rule]:
    """Yield what each rule gives; without an ultimate gain there is no Ziegler-Nichols."""
    if loop.ultimate is not None:
        gain, period_s = loop.ultimate
        yield Rule("Ziegler-Nichols", 0.45 * gain, period_s / 1.2)
    reaction = loop.reaction()
    slope, delay_s = reaction.slope_K_s, reaction.delay_s
    yield Rule("SIMC", 1.0 / (slope * 2.0 * delay_s), 8.0 * delay_s)
    in_lambda_s = DELAYS_IN_LAMBDA * delay_s
    integration_s = 2.0 * in_lambda_s + delay_s
    yield Rule("lambda", integration_s / (slope * (in_lambda_s + delay_s) ** 2), integration_s)
