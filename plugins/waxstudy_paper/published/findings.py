"""The paper's findings as checks on a run of its eleven cases.

Each check has one figure per ensemble member and a range that the finding asks for. It is not resolved where the
standard deviation of single runs is larger than the distance of the mean to the nearest limit. The figures that make
the verdict come first, all others after them with their own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.plugin import Finding, FinishedRun, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.report.activation import activation
from waxstudy.report.comparison import differences_percent, member_values
from waxstudy.report.words import with_spread
from waxstudy.simulation.chain import Stepped
from waxstudy.study.model import Choice

WEEKS = ("january", "february")
ON_OFF = ("O_0", "O_CP", "O_D", "O_VC", "O_WM")
PI = ("P_0", "P_CP", "P_D", "P_VC", "P_MC", "P_WM")
HELD, NOT_HELD, NOT_RESOLVED = "held", "not held", "not resolved"
INF = float("inf")
MOST_DECIMALS = 4


@dataclass(frozen=True)
class Check:
    """One figure per member and the range that it should lie in."""

    label: str
    values: FloatArray
    low: float
    high: float
    unit: str = ""

    @property
    def verdict(self) -> str:
        mean = float(np.mean(self.values))
        spread = float(np.std(self.values, ddof=1)) if len(self.values) > 1 else INF
        if np.ptp(self.values) == 0.0 and len(self.values) > 1:
            spread = 0.0
        if min(abs(mean - self.low), abs(mean - self.high)) < spread:
            return NOT_RESOLVED
        return HELD if self.low <= mean <= self.high else NOT_HELD

    def __str__(self) -> str:
        mean = float(np.mean(self.values))
        if not math.isfinite(mean):
            return f"{self.label} not known"
        spread = float(np.std(self.values, ddof=1)) if len(self.values) > 1 else np.nan
        if not spread >= 0.5 * 10.0**-MOST_DECIMALS:  # it would be shown as zero
            return f"{self.label} {with_spread(mean, np.nan, f'.{_decimals(mean, 3)}f')} {self.unit}".rstrip()
        return f"{self.label} {with_spread(mean, spread, f'.{_decimals(spread, 2)}f')} {self.unit}".rstrip()


def _decimals(value: float, figures: int) -> int:
    """Decimals that show so many significant figures.

    >>> _decimals(0.36, 2), _decimals(1.1, 2), _decimals(361.0, 3), _decimals(0.0, 3), _decimals(2e-6, 2)
    (2, 1, 0, 2, 4)
    """
    leading = math.floor(math.log10(abs(value))) if value and math.isfinite(value) else 0
    return min(max(figures - 1 - leading, 0), MOST_DECIMALS)


def exact(label: str, value: float, low: float, high: float, unit: str = "") -> Check:
    """A figure that no ensemble scatters."""
    return Check(label, np.array([value, value]), low, high, unit)


class Figures:
    """Per-member figures of a run by short names."""

    def __init__(self, run: FinishedRun) -> None:
        self.run = run

    def of(self, case: str, week: str, column: str) -> FloatArray:
        return member_values(self.run.kpis, case, week, column)

    def mae(self, case: str, week: str = "january") -> FloatArray:
        return self.of(case, week, "mae_K")

    def heat(self, case: str, week: str) -> FloatArray:
        return self.of(case, week, "heat_kWh_m2_week")

    def shift(self, case: str, week: str) -> FloatArray:
        return self.of(case, week, "single_run_shift_K")

    def difference(self, case: str, week: str) -> FloatArray:
        return differences_percent(self.run.kpis, case, "O_WM" if case in ON_OFF else "P_WM", week)

    def share_of_time(self, case: str, week: str, channel: str, low: float, high: float) -> FloatArray:
        """Share of the time that a channel spends between two values, for each member."""
        spans = self.run.durations(case, week)
        groups = [group[channel].to_numpy() for _, group in spans.groupby("member")]
        return np.array([np.mean((values >= low) & (values <= high)) for values in groups])


def findings(run: FinishedRun) -> Sequence[Finding]:
    """Return the sixteen findings for a run; raise `ValueError` naming cases or weeks that the run lacks."""
    missing = sorted({*ON_OFF, *PI} - set(run.kpis["case"])) + sorted(set(WEEKS) - set(run.kpis["week"]))
    if missing:
        raise ValueError(f"the paper's findings need all its cases and weeks; missing: {', '.join(missing)}")
    figures = Figures(run)
    return [_finding(name, statement, check(figures)) for name, statement, check in FINDINGS]


def _finding(name: str, statement: str, checks: Iterable[Check]) -> Finding:
    checks = list(checks)
    verdicts = [check.verdict for check in checks]
    worst = next((verdict for verdict in (NOT_HELD, NOT_RESOLVED) if verdict in verdicts), HELD)
    judged = list(zip(checks, verdicts, strict=True))
    telling = [str(check) for check, verdict in judged if verdict == worst]
    others = [f"{check} ({verdict})" for check, verdict in judged if verdict != worst]
    return Finding(name, statement, worst, "; ".join([*telling, *others]))


def wax_motor_changes_heat_little(f: Figures) -> Iterable[Check]:
    for week in WEEKS:
        yield Check(f"O_VC, {week}", f.difference("O_VC", week), -1.0, 1.0, "%")
        yield Check(f"P_MC, {week}", f.difference("P_MC", week), -1.0, 1.0, "%")


def usual_on_off_overestimates(f: Figures) -> Iterable[Check]:
    for week in WEEKS:
        yield Check(f"O_0, {week}", f.difference("O_0", week), 3.0, 8.0, "%")


def usual_pi_is_close(f: Figures) -> Iterable[Check]:
    for week in WEEKS:
        yield Check(f"P_0, {week}", f.difference("P_0", week), -1.0, 1.0, "%")


def continuous_pi_underestimates(f: Figures) -> Iterable[Check]:
    for week in WEEKS:
        for case in ("P_CP", "P_D", "P_VC"):
            yield Check(f"{case}, {week}", f.difference(case, week), -4.0, -1.0, "%")


def delay_and_curve_hardly_matter(f: Figures) -> Iterable[Check]:
    for week in WEEKS:
        for simpler, case in (("O_CP", "O_D"), ("O_D", "O_VC"), ("P_CP", "P_D"), ("P_D", "P_VC")):
            step = f"{simpler} to {case}, {week}:"
            yield Check(f"{step} shift", f.shift(case, week) - f.shift(simpler, week), -0.02, 0.02, "K")
            yield Check(f"{step} MAE", f.mae(case, week) - f.mae(simpler, week), -0.02, 0.02, "K")
            yield Check(f"{step} heat", f.difference(case, week) - f.difference(simpler, week), -0.5, 0.5, "points")


def modulation_brings_on_off_fluctuation(f: Figures) -> Iterable[Check]:
    for case in ("P_MC", "P_WM"):
        yield Check(f"{case} less O_WM", f.mae(case) - f.mae("O_WM"), -0.1, 0.1, "K")


def order_of_fluctuation(f: Figures) -> Iterable[Check]:
    pairs = [("P_CP", "P_0"), ("P_0", "P_MC"), ("P_0", "P_WM")]
    pairs += [(pi, on_off) for pi in ("P_MC", "P_WM") for on_off in ("O_CP", "O_WM")]
    pairs += [("O_CP", "O_0"), ("O_WM", "O_0")]
    for less, more in pairs:
        yield Check(f"{more} less {less}", f.mae(more) - f.mae(less), 0.0, INF, "K")


def dead_band_is_the_source(f: Figures) -> Iterable[Check]:
    yield Check("MAE of O_0 over O_CP", f.mae("O_0") / f.mae("O_CP"), 2.0, INF)


def shifts(f: Figures) -> Iterable[Check]:
    for week in WEEKS:
        for case in PI:
            yield Check(f"{case}, {week}", f.shift(case, week), -INF, 0.0, "K")
        yield Check(f"O_0, {week}", f.shift("O_0", week), 0.0, INF, "K")
        for case in (*ON_OFF[1:], *PI):
            yield Check(f"O_0 less {case}, {week}", f.shift("O_0", week) - f.shift(case, week), 0.0, INF, "K")


def sun_dominates_february(f: Figures) -> Iterable[Check]:
    for case in (*ON_OFF, *PI):
        more = f.mae(case, "february") - f.mae(case, "january")
        yield Check(f"{case}, February less January MAE", more, 0.0, INF, "K")
        yield Check(f"{case}, highest in February", f.of(case, "february", "operative_max_C"), 24.0, INF, "°C")
    shares = np.mean([f.of(case, "february", "over_setpoint_1K_share") for case in (*ON_OFF, *PI)], axis=0)
    yield Check("share over 22 °C in February", shares, 0.15, 0.25)


def wax_motor_in_february(f: Figures) -> Iterable[Check]:
    week = "february"
    yield Check("O_WM less O_VC, MAE", f.mae("O_WM", week) - f.mae("O_VC", week), -INF, 0.0, "K")
    yield Check("P_WM less P_MC, MAE", f.mae("P_WM", week) - f.mae("P_MC", week), 0.0, INF, "K")


def on_off_like_pi_in_detail(f: Figures) -> Iterable[Check]:
    for week, low, high in (("january", -1.0, 1.0), ("february", 1.0, 3.0)):
        heat = 100.0 * (f.heat("O_WM", week) / f.heat("P_WM", week) - 1.0)
        yield Check(f"O_WM over P_WM, {week}", heat, low, high, "%")


def full_activation(f: Figures) -> Iterable[Check]:
    times = {product: activation(product, _actuator(product), None, (30.0, 45.0, 120.0)) for product in "AB"}
    for minutes, seconds in zip((30, 45), times["B"].opening_s, strict=False):
        yield exact(f"B after {minutes} min off", float(seconds), 300.0, INF, "s")
    for product in "AB":
        yield exact(f"{product}, longest", float(np.max(times[product].opening_s)), 0.0, 420.0, "s")
    yield exact("A after 45 min off", float(times["A"].opening_s[1]), 270.0, 330.0, "s")


def quick_opening(f: Figures) -> Iterable[Check]:
    valve = installed().get("valve", "quick-opening")
    flow = Stepped(Choice(valve, valve.Parameters.model_validate({})), 1.0).step(0.5, 0.0)
    yield exact("flow at half opening", flow, 0.9, 1.0)


def load_dynamics(f: Figures) -> Iterable[Check]:
    """Mostly: more than half of the time within 10 points of a quarter; binary: at most 10 % between the ends."""
    full = float(f.of("O_CP", "january", "full_flow_L_h")[0])

    def between(case: str, low: float = 0.05, high: float = 0.95) -> FloatArray:
        return f.share_of_time(case, "january", "flow_L_h", low * full, high * full)

    for case in ("P_CP", "P_D"):
        yield Check(f"{case} near a quarter", between(case, 0.15, 0.35), 0.5, 1.0)
    for case in ("P_MC", "P_WM"):
        yield Check(f"{case} between the ends", between(case) - between("O_WM"), -0.1, 0.1)
    for case in ("P_0", "P_VC"):
        yield Check(f"{case} less P_CP between the ends", between(case) - between("P_CP"), -INF, 0.0)
        yield Check(f"{case} less P_MC between the ends", between(case) - between("P_MC"), 0.0, INF)


def return_temperature(f: Figures) -> Iterable[Check]:
    """Mean of the cumulative curve, which is what "lower" can mean for whole curves."""
    for simpler, case in (("O_VC", "O_WM"), ("P_MC", "P_WM")):
        less = _curve_mean(f, case) - _curve_mean(f, simpler)
        yield Check(f"{case} less {simpler}", less, -INF, 0.0, "K")


def _curve_mean(f: Figures, case: str) -> FloatArray:
    return f.run.durations(case, "january").groupby("member")["return_C"].mean().to_numpy()


def _actuator(product: str) -> Choice:
    block = installed().get("actuator", "variable-times")
    return Choice(block, block.Parameters.model_validate({"product": product}))


FINDINGS: Sequence[tuple[str, str, Callable[[Figures], Iterable[Check]]]] = (
    ("F1", "Adding the wax motor alone changes heat use little", wax_motor_changes_heat_little),
    ("F2", "Business-as-usual On/Off overestimates heat use by about 5 %", usual_on_off_overestimates),
    ("F3", "Business-as-usual PI is close to the most detailed PI", usual_pi_is_close),
    ("F4", "Continuous PI with adapted parameters underestimates", continuous_pi_underestimates),
    ("F5", "Sensor delay and valve curve hardly matter", delay_and_curve_hardly_matter),
    ("F6", "Modulation raises PI fluctuation to that of On/Off with 0.5 K", modulation_brings_on_off_fluctuation),
    ("F7", "Order of fluctuation in January", order_of_fluctuation),
    ("F8", "The dead band is the source of On/Off fluctuation", dead_band_is_the_source),
    ("F9", "Shifts are negative for PI and largest for O_0", shifts),
    ("F10", "Solar gains dominate in February", sun_dominates_february),
    ("F11", "In February the wax motor helps On/Off and hurts PI", wax_motor_in_february),
    ("F12", "On/Off and PI differ little in the most detailed cases", on_off_like_pi_in_detail),
    ("F13", "Full activation above 5 min after long cooling, never above 7", full_activation),
    ("F14", "Quick opening: most of the flow at half opening", quick_opening),
    ("F15", "Mass flow: continuous PI near a quarter, modulated binary", load_dynamics),
    ("F16", "Return temperature is lower with the wax motor", return_temperature),
)
