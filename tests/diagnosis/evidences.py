"""Evidence that meets every criterion of its question, to change one number of."""

from __future__ import annotations

from waxstudy.diagnosis.select.evidence import AirLeft, Evidence, Exact, Kept, Late, Left

SOUND = Evidence(
    stage="actuator",
    channel="displacement",
    parameters=2,
    gain=1000.0,
    form_share=1.0,
    p=0.0025,
    loss=100.0,
    strain=0.0,
    over=10.0,
    share=0.99,
    plain_share=0.99,
    left=1.0,
    missed=1.0,
    departure=5.0,
    travel=5.0,
)
KEPT = Kept(stage="room", parameters=2, fresh_share=1.0, whole_share=1.0, distinct=5.0)
UNDERSTOOD = AirLeft(over_form=0.5, share_left=0.1)
LATE = Late(growth=5.0, over=5.0, over_form=5.0)
UNKNOWN = Left(over=5.0, p=0.001, over_form=5.0, of_drives=5.0)
EXACT = Exact(over_loose=1.0, over=5.0, left=1.0, left_K=0.001)
