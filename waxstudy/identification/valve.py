"""The valve's curve from a record of flow: three points and an authority (section 3.2.2 of the paper).

The smallest mean absolute error is the paper's; that a value is the median of resampled fits is ours.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

from waxstudy.identification.flow import FlowRecord
from waxstudy.identification.fragment import intervals, rounded, text_of
from waxstudy.identification.models import Value
from waxstudy.identification.performance import modelled
from waxstudy.identification.records import BoolArray
from waxstudy.plugin import Choice, FloatArray
from waxstudy.study.problems import Problem, StudyError

VALVE = "quick-opening"  # whose parameters are fitted
BOUNDS: Mapping[str, tuple[float, float]] = {
    "h_min": (0.1, 0.3),
    "h_mid": (0.1, 1.0),
    "v_mid": (0.0, 1.0),
    "pace": (0.85, 1.15),
    "delay": (-0.5, 0.5),
    "authority": (0.01, 1.0),
}
OF_RECORD = ("pace", "delay")  # of this exemplar and record, not of the valve
EXCLUDED = (0.05, 0.95)  # openings outside are left out: many samples, little change
PACES: FloatArray = np.linspace(*BOUNDS["pace"], 61)
REPEATS = 100
SEARCHES = 3  # one alone ends at a corner of the bounds once in twenty: little authority and a late bend
FEWEST_CYCLES = 3
FIRST_STEP = 0.05  # of a search, over the parameter's bounds
NEAR: Mapping[str, float] = {"pace": 0.01}  # a bound, over the range
LEAST_APART = 0.01  # of h_min and h_mid


@dataclass(frozen=True)
class ValveFit:
    """What `waxstudy fit valve` found."""

    record: FlowRecord
    actuator: Mapping[str, Any]
    is_simulated: bool
    values: Mapping[str, Value]  # h_min, h_mid, v_mid, authority, pace
    how_authority: str
    opening: FloatArray  # modelled, mean of each interval
    flow: FloatArray  # measured, over full flow
    full_flow: float
    considered: BoolArray
    mae: float
    warnings: Sequence[str]

    def parameters(self) -> dict[str, float]:
        """Return the parameters of the block."""
        return {name: rounded(value.value) for name, value in self.values.items() if name not in OF_RECORD}

    def modelled_flow(self) -> FloatArray:
        return curve(self.opening, *(self.values[name].value for name in ("h_min", "h_mid", "v_mid", "authority")))

    def fragment(self) -> str:
        about = {
            "simulated": self.is_simulated,
            "mae": rounded(self.mae),
            "authority": self.how_authority,
            "interval_95": intervals(self.values),
            "records": [{"name": self.record.name, "file": self.record.file, "sha256": self.record.sha256}],
            "actuator": dict(self.actuator),
        }
        return text_of("valve", {"use": VALVE, **self.parameters()}, about)

    def described(self) -> dict[str, Any]:
        return {
            "simulated": self.is_simulated,
            "valve": {"use": VALVE, **self.parameters()},
            "values": {name: asdict(value) for name, value in self.values.items()},
            "authority": self.how_authority,
            "mae": self.mae,
            "samples": int(self.considered.sum()),
            "full_flow": self.full_flow,
            "unit": self.record.unit,
            "record": {"file": self.record.file, "sha256": self.record.sha256},
            "actuator": dict(self.actuator),
            "warnings": list(self.warnings),
        }


def curve(h: FloatArray, h_min: float, h_mid: float, v_mid: float, authority: float) -> FloatArray:
    """Return the flow 0..1 of openings: V through three points, V / sqrt(V^2 (1 - N) + N) with authority N.

    The same as the block `quick-opening` with h_max = 1.
    """
    v = np.interp(h, (h_min, h_mid, 1.0), (0.0, v_mid, 1.0))
    flow: FloatArray = v / np.sqrt(v * v * (1.0 - authority) + authority)
    return np.minimum(flow, 1.0)


def fit_valve(
    record: FlowRecord,
    actuator: Choice,
    *,
    authority: float | None = None,
    how_authority: str = "fitted",
    is_simulated: bool = False,
    product: str | None = None,
    seed: int = 1,
) -> ValveFit:
    """Return the curve whose parameters are medians of fits to resampled whole cycles; raise `StudyError`.

    Each fit has the smallest mean absolute error; the medians together need not. Besides the paper's three parameters
    the pace of this exemplar is fitted, a factor on the actuator's times, and the delay of the switches, which lie
    anywhere between two samples. An actuator of another `product` than the record's is told.
    """
    openings = _openings(record, actuator)
    middle = openings[len(PACES) // 2]
    full = _full_flow(record, middle)
    cycle = _cycle_of(record)
    if (count := max(0, int(cycle.max()) + 1)) < FEWEST_CYCLES:
        cycles = "1 cycle" if count == 1 else f"{count} cycles"
        wrong = f"{cycles} after the first, whose start is unknown; at least {FEWEST_CYCLES} are needed"
        raise StudyError([Problem(record.file, 0, "", "flow", "", wrong)])
    names = [name for name in BOUNDS if name != "authority" or authority is None]
    near = _near(openings) & ~record.missing & (cycle >= 0)
    problem = _Problem(_delayed(openings)[:, :, near], record.flow[near] / full, cycle[near], authority)
    best = _best(problem, names, seed)
    again = _again(problem, best, names, np.random.default_rng(seed))
    values = {name: _value(name, again[:, i]) for i, name in enumerate(names)}
    if authority is not None:
        values["authority"] = Value(authority, authority, authority, told=False)
    opening = _at(_delayed(openings), values["pace"].value, values["delay"].value)
    considered = (opening > EXCLUDED[0]) & (opening < EXCLUDED[1]) & near
    return ValveFit(
        record,
        actuator.described(),
        is_simulated or record.is_simulated,
        values,
        how_authority,
        opening,
        record.flow / full,
        full,
        considered,
        float(problem.error([values[name].value for name in names])),
        [
            *(f"{record.file}: {sentence}" for sentence in record.warnings),
            *_of_others(record, product),
            *_notes(values),
        ],
    )


def _openings(record: FlowRecord, actuator: Choice) -> FloatArray:
    """Return the mean opening of each interval for each pace (paces, n): a slower motor lives in slower time."""
    return np.array([modelled(actuator, record.on, record.interval_s, float(pace))[1] for pace in PACES])


def _delayed(openings: FloatArray) -> FloatArray:
    """Return the openings one interval early, as they are, and one late (3, paces, n)."""
    early, late = np.roll(openings, -1, axis=1), np.roll(openings, 1, axis=1)
    early[:, -1], late[:, 0] = openings[:, -1], openings[:, 0]
    return np.array([early, openings, late])


def _at(openings: FloatArray, pace: float, delay: float) -> FloatArray:
    """Return the opening at a pace, and as if all switches came later by a part of the interval."""
    place = float(np.clip((pace - PACES[0]) / (PACES[1] - PACES[0]), 0.0, len(PACES) - 1.0))
    low = min(int(place), len(PACES) - 2)
    share, other = abs(delay), 2 if delay > 0.0 else 0
    mixed: FloatArray = (1.0 - share) * _mixed(openings[1], low, place) + share * _mixed(openings[other], low, place)
    return mixed


def _mixed(openings: FloatArray, low: int, place: float) -> FloatArray:
    mixed: FloatArray = openings[low] + (place - low) * (openings[low + 1] - openings[low])
    return mixed


def _near(openings: FloatArray) -> BoolArray:
    """Return the samples that any pace puts within the considered openings."""
    return np.asarray(((openings > EXCLUDED[0]) & (openings < EXCLUDED[1])).any(axis=0))


def _full_flow(record: FlowRecord, opening: FloatArray) -> float:
    """Return the median flow of the fully open valve; raise `StudyError` where it never is, or nothing flows."""
    open_ = (opening > EXCLUDED[1]) & ~record.missing
    full = float(np.median(record.flow[open_])) if open_.any() else 0.0
    closed = (opening < EXCLUDED[0]) & ~record.missing
    shut = float(np.median(record.flow[closed])) if closed.any() else 0.0
    if full <= 0.0 or shut > 0.5 * full:
        wrong = f"does not follow the signal: {full:g} with the valve open, {shut:g} with it closed; right columns?"
        raise StudyError([Problem(record.file, 0, "", "flow", "", wrong)])
    return full


def _cycle_of(record: FlowRecord) -> np.ndarray:
    """Return the number of the cycle that each sample is of, -1 before the second: nobody knows how the first began."""
    rises = np.diff(record.on.astype(np.int8), prepend=0) == 1
    return np.cumsum(rises) - 2


@dataclass(frozen=True)
class _Problem:
    """The error of parameters (h_min, h_mid, v_mid, pace, delay, authority if it is fitted)."""

    openings: FloatArray  # (3, paces, n)
    flow: FloatArray
    cycle: np.ndarray
    authority: float | None

    def error(self, x: Sequence[float] | FloatArray, weight: FloatArray | None = None) -> float:
        """Return the mean absolute error over the considered openings; 1 and more for what is out of order."""
        h_min, h_mid, v_mid, pace, delay = (float(value) for value in x[:5])
        authority = self.authority if self.authority is not None else float(x[5])
        out = sum(
            max(0.0, low - value) + max(0.0, value - high)
            for value, (low, high) in zip(x, BOUNDS.values(), strict=False)
        )
        if out > 0.0 or h_mid < h_min + LEAST_APART:
            return 1.0 + float(out) + max(0.0, h_min + LEAST_APART - h_mid)
        opening = _at(self.openings, pace, delay)
        share = ((opening > EXCLUDED[0]) & (opening < EXCLUDED[1])).astype(float)
        if weight is not None:
            share *= weight
        wrong = np.abs(curve(opening, h_min, h_mid, v_mid, authority) - self.flow)
        total = float(share.sum())
        return float((share * wrong).sum() / total) if total > 0.0 else 1.0


def _best(problem: _Problem, names: Sequence[str], seed: int) -> FloatArray:
    from scipy.optimize import differential_evolution

    bounds: Any = [BOUNDS[name] for name in names]
    options: Any = {"popsize": 20, "tol": 1e-4, "maxiter": 400, "polish": False}
    found = [differential_evolution(problem.error, bounds, rng=seed + again, **options) for again in range(SEARCHES)]
    return _polished(problem.error, min(found, key=lambda each: float(each.fun)).x, names)


def _polished(error: Callable[[FloatArray], float], start: FloatArray, names: Sequence[str]) -> FloatArray:
    from scipy.optimize import minimize

    steps = np.array([FIRST_STEP * np.ptp(BOUNDS[name]) for name in names])
    middle = np.array([np.mean(BOUNDS[name]) for name in names])
    simplex = np.vstack((start, start + np.diag(np.where(start > middle, -steps, steps))))
    options = {"xatol": 1e-4, "fatol": 1e-7, "maxiter": 600, "initial_simplex": simplex}
    polished: FloatArray = minimize(error, start, method="Nelder-Mead", options=options).x  # type: ignore[call-overload]
    return polished


def _again(problem: _Problem, best: FloatArray, names: Sequence[str], draw: np.random.Generator) -> FloatArray:
    """Return the parameters of resampled cycles (repeats, parameters); each search begins at another delay.

    Delay and pace can hardly be told apart: along their ridge the error is nearly the same.
    """
    delay = names.index("delay")
    cycles = np.unique(problem.cycle)
    found = []
    for _ in range(REPEATS):
        counts = np.bincount(draw.choice(cycles, len(cycles)), minlength=int(cycles[-1]) + 1).astype(float)
        start = best.copy()
        start[delay] = draw.uniform(*BOUNDS["delay"])
        found.append(_polished(partial(problem.error, weight=counts[problem.cycle]), start, names))
    return np.array(found)


def _value(name: str, again: FloatArray) -> Value:
    """Return the middle of the resampled fits: the best one lies anywhere on the ridge of delay and pace."""
    low, found, high = (float(each) for each in np.quantile(again, (0.025, 0.5, 0.975)))
    return Value(found, low, high, told=not _is_at_bound(name, found))


def _is_at_bound(name: str, found: float) -> bool:
    """Whether a parameter ends where its search does; a switch lies between two samples whatever the search."""
    near = NEAR.get(name, 1e-3) * np.ptp(BOUNDS[name])
    return name != "delay" and bool(min(abs(found - bound) for bound in BOUNDS[name]) < near)


def _notes(values: Mapping[str, Value]) -> list[str]:
    """Say which parameter ends at a bound, where it means little."""
    return [
        f"{name} = {value.value:.3g} lies at the bound of its search: it is not told"
        for name, value in values.items()
        if not value.told and value.low < value.high
    ]


def _of_others(record: FlowRecord, product: str | None) -> list[str]:
    if product is None or record.product is None or product == record.product:
        return []
    return [f"{record.file} is of product {record.product}, the actuator of {product}: are these the right files?"]


def authority_of(valve_kPa: float, pump_kPa: float) -> float:
    """Return N = dp_valve / dp_pump, of the open valve and the pump (Petitjean 1994).

    >>> round(authority_of(2.9, 30.0), 4)
    0.0967
    """
    return valve_kPa / pump_kPa
