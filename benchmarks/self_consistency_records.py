"""The records of `benchmarks.self_consistency`: every effect in three severities, and nulls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from zlib import crc32

from waxstudy.plugin import Choice
from waxstudy.plugin.registry import installed
from waxstudy.study.model import Case, Ladder, Study
from waxstudy.study.read import read_study

STUDY = Path(__file__).parents[1] / "studies" / "table5.toml"
SEVERITIES = ("slight", "clear", "strong")
WEEKS = (("january", "february"), ("february", "january"), ("january", "january"), ("february", "february"))
NULL_CASES = ("O_CP", "O_D", "O_VC", "O_WM", "O_LW", "O_CT", "P_CP", "P_VC", "P_MC", "P_WM")
SHIFTS_K = (0.0, 0.4, -0.4)

Values = Mapping[str, float]


def _times(dead: float, rise: float, hold: float, fall: float) -> Values:
    return {"dead_time_s": dead, "rise_time_s": rise, "hold_time_s": hold, "fall_time_s": fall}


def _curve(h_min: float, h_mid: float, v_mid: float, authority: float) -> Values:
    return {"h_min": h_min, "h_mid": h_mid, "v_mid": v_mid, "authority": authority}


def _varying(dead: Sequence[float], rise: Sequence[float], hold: Sequence[float], fall_s: float) -> Values:
    named = {"dead": dead, "rise": rise, "hold": hold}
    three = {f"{name}_{key}_s": v for name, of in named.items() for key, v in zip(("a", "b", "tau"), of, strict=True)}
    return {**three, "fall_s": fall_s}


# effect -> the case that is believed, and what is true: slight, clear, strong. Chosen: slight is near what an effect
# calls noticeable, clear is what an engineer would look for, strong is what nobody would overlook
TABLE: Mapping[str, tuple[str, Sequence[Values]]] = {
    "sensor-delay": ("O_WM", [{"delay_s": v} for v in (180.0, 300.0, 900.0)]),
    "sensor-lag": ("O_WM", [{"time_constant_s": v} for v in (120.0, 600.0, 1800.0)]),
    "sensor-bias": ("O_WM", [{"bias_K": v} for v in (0.06, 0.3, 1.0)]),
    "dead-band": ("O_WM", [{"dead_band_K": v} for v in (0.6, 0.8, 1.5)]),
    "setpoint-offset": ("O_WM", [{"offset_K": v, "from_h": 22.0, "to_h": 6.0} for v in (-0.3, -1.0, -2.0)]),
    "pi-tuning": (
        "P_WM",
        [{"gain": gain, "integration_time_s": t_s} for gain, t_s in ((15.0, 2300.0), (9.0, 2300.0), (4.0, 900.0))],
    ),
    "modulation": (
        "P_VC",
        [{"period_s": period_s, "min_pulse_s": s} for period_s, s in ((600.0, 0.0), (1800.0, 120.0), (3600.0, 300.0))],
    ),
    "pwm-period": ("P_MC", [{"period_s": v} for v in (3300.0, 1800.0, 900.0)]),
    "min-pulse": ("P_MC", [{"min_pulse_s": v} for v in (360.0, 600.0, 1200.0)]),
    "wax-motor": (
        "O_VC",
        [
            {**_times(30.0, 40.0, 30.0, 40.0), "past": 0.1},
            {**_times(232.0, 163.0, 140.0, 123.0), "past": 1.0},
            {**_times(400.0, 300.0, 300.0, 300.0), "past": 0.5},
        ],
    ),
    "constant-times": (
        "O_WM",
        [_times(150.0, 146.0, 110.0, 123.0), _times(300.0, 250.0, 200.0, 200.0), _times(600.0, 500.0, 400.0, 400.0)],
    ),
    "variable-times": (
        "O_CT",
        [
            _varying((-100.0, 200.0, 780.0), (-30.0, 163.0, 1140.0), (82.0, 58.0, 600.0), 123.0),
            _varying((-192.0, 300.0, 780.0), (-30.0, 200.0, 1140.0), (195.0, 60.0, 600.0), 180.0),
            _varying((-300.0, 600.0, 1500.0), (-50.0, 400.0, 1140.0), (400.0, 100.0, 1500.0), 300.0),
        ],
    ),
    "slow-actuator": ("O_WM", [{"factor": v} for v in (1.5, 2.0, 3.5)]),
    "limited-travel": ("O_WM", [{"opening": v} for v in (0.85, 0.6, 0.3)]),
    "quick-opening": (
        "O_LW",
        [_curve(0.05, 0.45, 0.5, 0.7), _curve(0.12, 0.43, 0.5, 0.3), _curve(0.17, 0.41, 0.5, 0.097)],
    ),
    "low-authority": ("O_WM", [{"authority": v} for v in (0.075, 0.05, 0.5)]),
    "let-by": ("O_WM", [{"fraction": v} for v in (0.004, 0.015, 0.05)]),
    "stuck-open": ("O_WM", [{"opening": v} for v in (0.175, 0.19, 0.25)]),
    "max-flow": ("O_WM", [{"factor": v} for v in (0.93, 0.7, 0.4)]),
    "supply-offset": ("O_WM", [{"offset_K": v} for v in (0.4, 2.0, -4.0)]),
    "pipe-delay": ("O_WM", [{"volume_L": v} for v in (1.0, 4.0, 12.0)]),
    "floor-cover": ("O_WM", [{"resistance_m2K_W": v} for v in (0.02, 0.06, 0.15)]),
    "infiltration": ("O_WM", [{"factor": v} for v in (2.0, 6.0, 20.0)]),
    "window-opening": ("O_WM", [{"flow_L_s": v, "from_h": 7.0, "to_h": 8.0} for v in (3.0, 15.0, 40.0)]),
    "solar-factor": ("O_WM", [{"factor": v} for v in (0.8, 0.5, 2.5)]),
    "gain-shift": (
        "O_WM",
        [{"shift_h": shift_h, "factor": factor} for shift_h, factor in ((1.0, 1.2), (4.0, 1.6), (8.0, 2.5))],
    ),
    "thermal-mass": ("O_WM", [{"factor": v} for v in (1.3, 2.0, 4.0)]),
    "neighbour-heat": ("O_WM", [{"conductance_W_K": v} for v in (2.0, 8.0, 25.0)]),
    "extra-heat": ("O_WM", [{"heat_W": v, "radiant_share": 0.5} for v in (25.0, 60.0, 150.0)]),
}


@dataclass(frozen=True)
class Made:
    """A record to make: the believed case, what the reality has besides, the weeks and the setpoint."""

    name: str
    case: str
    weeks: Sequence[str] = WEEKS[0]
    effect: str = ""
    severity: str = ""
    values: Values = field(default_factory=dict)
    shift_K: float = 0.0

    @property
    def seed(self) -> int:
        return crc32(self.name.encode())

    @property
    def effects(self) -> list[Choice]:
        return [Choice.of(installed().components["effect", self.effect].component, self.values)] if self.effect else []


def with_effect(severities: Sequence[str]) -> list[Made]:
    """Return every effect of the table in some severities."""
    return [
        Made(f"{name}-{severity}", case, effect=name, severity=severity, values=values)
        for name, (case, three) in TABLE.items()
        for severity, values in zip(SEVERITIES, three, strict=True)
        if severity in severities
    ]


def nulls(count: int) -> list[Made]:
    """Return records without an effect: cases, weeks and setpoints in turn, each with noise of its own."""
    places = [(case, weeks, shift_K) for shift_K in SHIFTS_K for weeks in WEEKS for case in NULL_CASES]
    chosen = [(number, *places[number % len(places)]) for number in range(count)]
    return [Made(f"null-{number:03d}", case, weeks, shift_K=shift_K) for number, case, weeks, shift_K in chosen]


@cache
def study() -> Study:
    """The paper's study, with a linear valve on a wax motor (O_LW) and constant times (O_CT) besides."""
    read = read_study(STUDY, installed())
    wax, plain = read.cases["O_WM"].blocks, Choice.of(installed().components["valve", "linear"].component, {})
    constant = Choice.of(installed().components["actuator", "constant-times"].component, {})
    more = {"O_LW": {**wax, "valve": plain}, "O_CT": {**wax, "actuator": constant}}
    cases = {name: Case(name, "more", blocks) for name, blocks in more.items()}
    ladders = {**read.ladders, "more": Ladder("more", "O_LW", list(more))}
    return replace(read, cases={**read.cases, **cases}, ladders=ladders)
