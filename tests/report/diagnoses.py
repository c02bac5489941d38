"""Made-up diagnoses, one of each verdict, as a record of two weeks with all channels would give."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd

from waxstudy.diagnosis.result import (
    Alternative,
    BaselineFit,
    BeforeAfter,
    Calibrated,
    Diagnosis,
    FoundEffect,
    HeatBy,
    HeatPer,
    HeatPiece,
    Interval,
    Lack,
    Measurement,
    MissingHeat,
    Regime,
    StageGap,
    Step,
    Tried,
    Unexplained,
    Untestable,
    When,
)

DAYS, PER_DAY = 4, 1440


def traces(letting_by_L_h: float = 4.0) -> pd.DataFrame:
    """Cycles of an actuator behind a valve that lets water by, more on the third day."""
    random = np.random.default_rng(5)
    time = pd.date_range("2024-01-15 00:01", periods=DAYS * PER_DAY, freq="min")
    hour = np.arange(len(time)) / 60.0
    displacement = np.clip(1.5 * np.sin(2.0 * np.pi * hour / 5.0), 0.0, 1.0)
    believed = 58.0 * displacement**0.4
    by = letting_by_L_h * np.where(hour // 24 == 2, 2.0, 1.0)
    flow = np.where(displacement > 0.0, believed, 0.0) + by * (displacement < 0.3)
    seen = displacement + random.normal(0.0, 0.01, len(hour))
    values = {
        "flow_L_h": (
            flow + random.normal(0.0, 1.0, len(hour)),
            believed,
            believed + letting_by_L_h * (displacement < 0.3),
        ),
        "displacement": (seen, np.roll(displacement, 6), np.roll(displacement, 1)),
        "heating_signal": (
            (displacement > 0.5) * 1.0,
            (np.roll(displacement, 2) > 0.5) * 1.0,
            (displacement > 0.5) * 1.0,
        ),
    }
    columns = {
        f"{channel}_{what}": column
        for channel, columns in values.items()
        for what, column in zip(("measured", "before", "after"), columns, strict=True)
    }
    frame = pd.DataFrame(columns, index=pd.DatetimeIndex(time, name="time"))
    frame["air_temperature_C_measured"] = np.where(np.arange(len(time)) % 15 == 14, 21.0 + np.sin(hour / 4.0), np.nan)
    frame["air_temperature_C_before"] = frame["air_temperature_C_measured"] + 0.05
    frame["air_temperature_C_after"] = frame["air_temperature_C_measured"] + 0.04
    return frame


SIGNAL = StageGap(
    "sensor+controller",
    "heating_signal",
    "s",
    31.4,
    31.4,
    28.7,
    {"heat_percent": 0.12, "air_K": 0.004},
    (Regime("switching on", 30.1, 0.46), Regime("switching off", 32.9, 0.54)),
    0.08,
    "control_output",
)
MOTOR = StageGap(
    "actuator",
    "displacement",
    "1",
    0.0312,
    0.0312,
    0.0118,
    {"heat_percent": -0.43, "air_K": 0.012},
    (
        Regime("rise", 0.0521, 0.51),
        Regime("fall", 0.0388, 0.33),
        Regime("dead", 0.0221, 0.07),
        Regime("after a long pause", 0.0431, 0.061),
        Regime("undercool", 0.0121, 0.04),
        Regime("hold", 0.0119, 0.03),
        Regime("overheat", 0.0117, 0.02),
    ),
    0.93,
)
VALVE = StageGap(
    "valve",
    "flow_L_h",
    "L/h",
    5.234,
    1.318,
    1.083,
    {"heat_percent": 6.82, "air_K": 0.231},
    (
        Regime("undercool", 16.91, 0.83),
        Regime("fall", 8.42, 0.14),
        Regime("rise", 3.42, 0.02),
        Regime("overheat", 1.22, 0.006),
        Regime("hold", 1.19, 0.004),
    ),
    0.97,
)
ROOM = StageGap(
    "emitter+room",
    "air_temperature_C",
    "K",
    0.0831,
    0.0812,
    0.0711,
    {"heat_percent": 0.31, "air_K": 0.0831},
    (Regime("heating", 0.0802, 0.4), Regime("sun", 0.1011, 0.35), Regime("night", 0.0713, 0.25)),
    0.88,
    "return_temperature_C",
)
LET_BY = FoundEffect(
    "let-by",
    "valve",
    "The closed valve lets 7.1 % of its flow through at the pressure of an open one.",
    ("let-by",),
    {"fraction": Interval(0.0712, 0.0688, 0.0741)},
    0.985,
    0.0025,
    "flow_L_h",
    5.187,
    1.402,
    1.083,
    Interval(0.9297, 0.9012, 0.9544),
)
REST = [
    ("let-by", "valve", 21_412.0, 0.0025, 0.97),
    ("stuck-open", "valve", 20_987.0, 0.0025, 0.95),
    ("quick-opening", "valve", 812.4, 0.041, 0.11),
    ("max-flow", "valve", -12.1, 0.62, -0.04),
    ("wax-motor", "actuator", 611.0, 0.0025, 0.43),
    ("slow-actuator", "actuator", 402.5, 0.0125, 0.31),
    ("limited-travel", "actuator", -3.0, 0.92, 0.0),
    ("sensor-delay", "sensor", 4.2, 0.31, 0.04),
    ("sensor-lag", "sensor", 3.9, 0.33, 0.03),
    ("dead-band", "controller", 1.1, 0.55, 0.01),
    ("solar-factor", "room", 7.7, 0.11, 0.08),
    ("thermal-mass", "room", 5.1, 0.16, 0.05),
    ("infiltration", "room", 4.0, 0.21, -0.41),
]
CHANNELS = {"valve": "flow_L_h", "actuator": "displacement"}
WHY = {"slow-actuator": "explains too little", "max-flow": "may be chance"}
NO_PUMP = "the supply was at one temperature throughout"
EFFECT = Diagnosis(
    dataset="room-7",
    verdict="effect",
    summary="The valve lets water by when it is closed; this explains 93 % of what the flow is off by.",
    stages=(SIGNAL, MOTOR, VALVE, ROOM),
    effects=(LET_BY,),
    unexplained=(Unexplained("actuator", 0.0312, 0.0118, 0.0025, is_covered=True, channel="displacement"),),
    untestable=(
        Untestable("pipe-delay", NO_PUMP, Lack.NOT_EXCITED),
        Untestable("supply-offset", "return_temperature_C was not recorded", Lack.NOT_RECORDED),
        Untestable("floor-cover", "return_temperature_C was not recorded", Lack.NOT_RECORDED),
        Untestable("neighbour-heat", "neighbour_temperature_C was not recorded", Lack.NOT_RECORDED),
    ),
    tried=tuple(Tried(*each, CHANNELS.get(each[1], ""), WHY.get(each[0], "")) for each in REST),
    closed_loop={
        "heat_kWh_m2": BeforeAfter(2.312, 2.071, 2.304),
        "air_mean_C": BeforeAfter(21.113, 20.987, 21.104),
        "air_mae_K": BeforeAfter(0.0, 0.1277, 0.0113),
        "cycles_per_day": BeforeAfter(4.643, 5.286, 4.714),
        "open_h_per_day": BeforeAfter(10.21, 11.84, 10.33),
        "setpoint_shift_K": BeforeAfter(0.0, 0.1301, 0.0089),
        "heat_percent": BeforeAfter(0.0, -10.424, -0.346),
    },
    waterfall=(Step("flow_L_h", "L/h", "", 5.187), Step("flow_L_h", "L/h", "let-by", 1.402)),
    next_measurements=(Measurement("return_temperature_C at the circuit", ("supply-offset", "floor-cover")),),
    warnings=("flow_L_h: 0.3 % of the samples are missing.",),
    assumptions=(
        "The solar gain was estimated, not measured.",
        "The sensor temperature was logged as the controller reads it.",
    ),
    departures={"internal gains": 0.41, "solar gain": -1.13, "infiltration": 0.02, "heat capacity": 2.61},
    parts={
        "fit": ("2024-01-15", "2024-01-20"),
        "select": ("2024-01-20", "2024-01-24"),
        "shrinkage": ("2024-01-25", "2024-01-28"),
    },
    seed=1,
    is_quick=False,
    traces=traces(),
)
MOTOR_FOUND = FoundEffect(
    "wax-motor",
    "actuator",
    "The actuator behaves like a wax motor.",
    ("wax-motor", "constant-times"),
    {
        "dead_time_s": Interval(121.0, 96.0, 143.0),
        "rise_time_s": Interval(201.0, 181.0, 226.0),
        "hold_time_s": Interval(62.0, math.nan, math.nan),
        "fall_time_s": Interval(388.0, 341.0, 431.0),
    },
    0.91,
    0.0025,
    "displacement",
    0.0312,
    0.0141,
    0.0118,
    Interval(0.923, 0.81, 1.04),
)
STUCK = Alternative(
    "stuck-open",
    "actuator",
    "The valve never closes beyond 3.2 % of its travel.",
    {"opening": Interval(0.0321, math.nan, math.nan)},
)
TOGETHER = replace(LET_BY, group=("let-by", "stuck-open"), alternatives=(STUCK,))
GROUP = replace(
    EFFECT,
    verdict="group",
    summary="The valve never closes fully, which let-by and stuck-open explain alike; the actuator is a wax motor.",
    effects=(TOGETHER, MOTOR_FOUND),
    unexplained=(),
    waterfall=(
        *EFFECT.waterfall,
        Step("displacement", "1", "", 0.0312),
        Step("displacement", "1", "wax-motor", 0.0141),
        Step("displacement", "1", "limited-travel", 0.0149),
    ),
    next_measurements=(
        Measurement("displacement of the valve's stem while it is closed", ("let-by", "stuck-open")),
        Measurement("a pause of an hour between two heating cycles", ("wax-motor", "constant-times")),
    ),
)
UNKNOWN = replace(
    EFFECT,
    verdict="unknown",
    summary="The room is 0.42 K off while the sun shines, and no effect of the library explains it.",
    stages=(SIGNAL, MOTOR, replace(VALVE, gap=1.12, gap_after=1.12), replace(ROOM, gap=0.421, gap_after=0.421)),
    effects=(),
    unexplained=(
        Unexplained("emitter+room", 0.421, 0.0711, 0.0025, channel="air_temperature_C"),
        Unexplained("actuator", 0.0312, 0.0118, 0.0125, is_covered=True),
    ),
    tried=tuple(Tried(name, stage, gain, 0.2, min(share, 0.2)) for name, stage, gain, _, share in REST),
    waterfall=(),
)
NONE = replace(
    EFFECT,
    verdict="none",
    summary="What is believed and what was measured agree within the noise.",
    stages=(SIGNAL, replace(MOTOR, gap=0.0121), replace(VALVE, gap=1.12), ROOM),
    effects=(),
    unexplained=(Unexplained("emitter+room", 0.0831, 0.0711, 0.0075, is_room_form=True),),
    tried=tuple(Tried(name, stage, 1.0, 0.4, 0.02) for name, stage, *_ in REST),
    waterfall=(),
    next_measurements=(),
    warnings=(),
    closed_loop={},
)
UNTESTABLE = replace(
    EFFECT,
    verdict="untestable",
    summary="With one channel, nothing of the loop can be judged: what drives it was not recorded.",
    stages=(),
    effects=(),
    unexplained=(),
    tried=(),
    untestable=tuple(
        Untestable(name, f"{stage}: the channel before it was not recorded", Lack.NOT_RECORDED)
        for name, stage, *_ in REST
    ),
    waterfall=(),
    closed_loop={},
    departures={},
    parts={},
    next_measurements=(
        Measurement("heating_signal", ("wax-motor", "slow-actuator")),
        Measurement("flow_L_h", ("let-by",)),
    ),
    warnings=("The record lasts 22 hours; two weeks are needed to tell effects apart.",),
    traces=pd.DataFrame(),
)
POSTERIOR = {"let-by": 0.7012, "neighbour-heat": 0.2034, "none": 0.0611, "let-by+unknown": 0.0302, "unknown": 0.0041}
CHANGED = replace(
    EFFECT,
    stages=tuple(replace(stage, posterior=POSTERIOR if stage is VALVE else {}) for stage in EFFECT.stages),
    effects=(
        replace(LET_BY, probability=0.7314, when=When("every day from 22:00 to 06:30", ((21.5, 30.0), (45.5, 54.0)))),
    ),
    unexplained=(replace(EFFECT.unexplained[0], probability=0.0343),),
    tried=tuple(replace(each, probability=POSTERIOR.get(each.name, 0.0)) for each in EFFECT.tried),
    posterior=POSTERIOR,
    compared_with="room-7-before, 2023-12-01 to 2023-12-14",
    as_built=(
        Calibrated(
            "floor-cover resistance_m2K_W",
            Interval(0.0241, 0.0181, 0.0319),
            0.0,
            "Something with a thermal resistance of 0.024 m²K/W lies on the floor.",
            "room",
            is_clear=True,
        ),
        Calibrated(
            "gain-shift factor",
            Interval(0.972, 0.851, 1.113),
            1.0,
            "People and appliances heat the room 0.0 h later than believed and 0.97 times as much.",
            "drives",
        ),
        Calibrated(
            "film-walls",
            Interval(0.542, 0.409, 0.718),
            1.0,
            "film-walls: the factor on films is 0.54, 0.8 standard deviations of what is usual.",
            "room",
            description="factor on films",
        ),
        Calibrated(
            "sensor-delay delay_s",
            Interval(65.0, math.nan, math.nan),
            120.0,
            "The controller reads the temperature of 65 s ago.",
            "chain",
            is_clear=True,
        ),
    ),
    baseline=(
        BaselineFit("air_temperature_C", "K", 0.1751, 0.798, 0.0947),
        BaselineFit("flow_L_h", "L/h", 0.5446, 3.828, -0.0516),
    ),
)
ALL = {each.verdict: each for each in (EFFECT, GROUP, UNKNOWN, NONE, UNTESTABLE)} | {"changed": CHANGED}

PIECES_W = [-40.0, -44.0, -61.0, -51.0, -38.0, -42.0, -58.0, -47.0]
LACK = (
    "On average 48 W (33 to 62) of heat are missing in the room, growing with the cold outside: 3.1 W (2.1 to 4.1) per"
)
LACKING_HEAT = MissingHeat(
    before=tuple(HeatPiece(6.0 * i, 6.0 * i + 6.0, each, each - 14.0, each + 14.0) for i, each in enumerate(PIECES_W)),
    after=tuple(HeatPiece(6.0 * i, 6.0 * i + 6.0, 2.0, -12.0, 16.0) for i in range(len(PIECES_W))),
    mean_before=Interval(-47.6, -62.1, -33.1),
    mean_after=Interval(2.0, -4.1, 8.1),
    usual_W=6.4,
    by=(
        HeatBy(
            "hour",
            "00 to 06 h",
            12.0,
            Interval(-39.0, -54.0, -24.0),
            Interval(1.0, -7.0, 9.0),
            Interval(8.6, 2.0, 15.2),
        ),
        HeatBy(
            "hour",
            "06 to 12 h",
            12.0,
            Interval(-43.0, -58.0, -28.0),
            Interval(2.0, -6.0, 10.0),
            Interval(4.6, -2.0, 11.2),
        ),
        HeatBy(
            "outdoor difference",
            "12 to 19 K",
            16.0,
            Interval(-41.0, -56.0, -26.0),
            Interval(0.4, -8.0, 8.8),
            Interval(6.6, 0.0, 13.2),
        ),
    ),
    per=(HeatPer("outdoor difference", "W/K", Interval(-3.1, -4.1, -2.1), Interval(0.1, -0.8, 1.0), 0.47),),
    sentence=f"{LACK} kelvin. With let-by none stays as far as can be told (-4.0 to 8.0 W).",
    is_resolved=True,
)
