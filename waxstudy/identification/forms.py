"""Which model a characteristic time gets: common to all products, with a product term, separate, or constant.

The steps are the paper's (section 3.1.4), with limits for each: p < 0.001 for every parameter of a model that is used.
Products are compared against the scatter of whole records: cycles of one agree with each other more than records do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from waxstudy.identification.curves import LONGEST_S, SHORTEST_S, Fitted, Shape, Test, fit_constant, fit_curve, t_test
from waxstudy.identification.models import ProductCurve, TimeModel, Value
from waxstudy.identification.scatter import Nesting, resampled, scatter_of
from waxstudy.plugin import FloatArray

LIMIT_P = 0.001
FEWEST = 8  # cycles for a curve
ENOUGH = 3  # cycles that a level of what came before must have at least
SPAN = 2.0  # of the times before: a curve needs at least this factor between short and long ones
REPEATS = 600
WIDEST = 20.0  # of the interval of a tau, upper over lower end: beyond, it is as good as unknown
AT_END = 0.025  # of the resampled taus: beyond, the data do not bound it
IntArray = NDArray[np.intp]


@dataclass(frozen=True)
class Data:
    """The cycles that tell of one time."""

    name: str
    products: Sequence[str]
    product: IntArray  # (n,) index
    before_s: FloatArray  # all NaN of a product of which it is not known
    outcome_s: FloatArray
    nesting: Nesting

    def of(self, products: Sequence[int]) -> NDArray[np.bool_]:
        return np.isin(self.product, products)


@dataclass
class Part:
    """Products that share a model, and its fit to given outcomes."""

    form: str
    products: Sequence[int]
    group: IntArray  # of the part's own cycles
    rows: NDArray[np.bool_]
    shape: Shape | None  # None: constant
    test: Test | None = None
    tau_s: float | None = None  # taken, where the data do not tell it

    def fit(self, data: Data, outcomes: FloatArray) -> Fitted:
        if self.shape is None:
            return fit_constant(self.group, outcomes[self.rows])
        return fit_curve(self.shape, data.before_s[self.rows], self.group, outcomes[self.rows], self.tau_s)

    def predicted(self, data: Data, fitted: Fitted) -> FloatArray:
        b: FloatArray = fitted.b_s[self.group, 0]
        if self.shape is None:
            return b
        return np.asarray(b + fitted.a_s[0] * self.shape(data.before_s[self.rows], fitted.tau_s[:1])[0])


def model_of(data: Data, shape: Shape | None, draw: np.random.Generator) -> TimeModel:
    """Return the model of one time; `shape` None for one that is taken for constant."""
    steps: list[str] = []
    untold: list[str] = []
    everyone = range(len(data.products))
    curved = [p for p in everyone if shape is not None and _spans(data, p, untold)]
    parts = _chosen(data, shape, curved, steps) if shape is not None and curved else []
    parts += _constants(data, [p for p in everyone if p not in {q for part in parts for q in part.products}], steps)
    predicted = _predicted(data, parts)
    scatter = scatter_of(data.outcome_s / predicted - 1.0, data.nesting)
    drawn = resampled(predicted, data.outcome_s, data.nesting, scatter, draw, REPEATS)
    curves: dict[str, ProductCurve] = {}
    silent = [] if shape is None else [p for p in everyone if p not in curved]
    for part in parts:
        again = part.fit(data, drawn)
        if part.shape is not None and _is_unknown(again.tau_s):
            part.tau_s = _middle(data.before_s[part.rows])
        curves |= _curves(data, part, silent, again, part.fit(data, data.outcome_s[:, None]), untold)
    ordered = {name: curves[name] for name in data.products}
    return TimeModel(data.name, ordered, steps, untold, scatter, data.outcome_s - _predicted(data, parts))


def _predicted(data: Data, parts: Sequence[Part]) -> FloatArray:
    predicted: FloatArray = np.empty(len(data.outcome_s))
    for part in parts:
        predicted[part.rows] = part.predicted(data, part.fit(data, data.outcome_s[:, None]))
    return predicted


def _is_unknown(tau_s: FloatArray) -> bool:
    low, high = np.quantile(tau_s, (0.025, 0.975))
    return bool(high > WIDEST * low)


def _middle(before_s: FloatArray) -> float:
    """Return the geometric mean of short and long times before: a curve that bends where the data are."""
    ordered = np.sort(before_s)
    return float(np.sqrt(max(ordered[ENOUGH - 1], 1.0) * ordered[-ENOUGH]))


def _spans(data: Data, product: int, untold: list[str]) -> bool:
    """Whether a product's cycles came after short and long times, so that a curve can be seen."""
    before = np.sort(data.before_s[data.product == product])
    name = data.products[product]
    what = "overheating" if data.name == "hold" else "undercooling"
    cannot = f"{data.name}_a_s, {data.name}_b_s and {data.name}_tau_s of {name} cannot be told: {what} times"
    if np.isnan(before).all():
        untold.append(
            f"{cannot} are not known, as no cycle comes after a whole one; the constant that stands for it holds for "
            "such pauses as there were"
        )
        return False
    if len(before) < FEWEST:
        cycles = "1 cycle is" if len(before) == 1 else f"{len(before)} cycles are"
        untold.append(f"{data.name} time of {name}: {cycles} too few for a curve (at least {FEWEST})")
        return False
    low, high = before[ENOUGH - 1], before[-ENOUGH]
    if high < SPAN * max(low, 1.0):
        untold.append(
            f"{cannot} lie within {low:.0f} and {high:.0f} s, but for the {ENOUGH - 1} shortest and the {ENOUGH - 1} "
            f"longest, and a curve needs at least a factor of {SPAN:g}; the constant that stands for it holds for these"
        )
        return False
    return True


def _part(data: Data, form: str, products: Sequence[int], shape: Shape | None) -> Part:
    """Return a part: groups are the products, or all together where the model is common."""
    rows = data.of(products)
    group = (
        np.zeros(int(rows.sum()), dtype=np.intp) if form == "common" else np.searchsorted(products, data.product[rows])
    )
    part = Part(form, products, group, rows, shape)
    if shape is not None:
        outcome = data.outcome_s[rows]
        fitted = part.fit(data, data.outcome_s[:, None])
        part.test = t_test(shape, data.before_s[rows], group, outcome, fitted)
    return part


def _chosen(data: Data, shape: Shape, products: list[int], steps: list[str]) -> list[Part]:
    """Return the parts for products whose times before span enough."""
    names = " and ".join(data.products[p] for p in products)
    common = _part(data, "common" if len(products) > 1 else "separate", products, shape)
    assert common.test is not None
    fine = _is_significant(common.test)
    if len(products) == 1:
        steps.append(f"{data.name} of {names}, one model: {_told(common.test)}")
        return [common] if fine else []
    steps.append(f"{data.name} of {names}, common model: {_told(common.test)}")
    term = _part(data, "product term", products, shape)
    assert term.test is not None
    p_term = _p_of_more(data, [common], [term], len(products) - 1)
    beside = _beside_motors(data, common, term, len(products))
    steps.append(
        f"{data.name}, product term instead: products differ by it with {_p(p_term)} ({beside}); {_told(term.test)}"
    )
    if fine and p_term >= LIMIT_P:
        steps.append(f"{data.name}: the common model is used")
        return [common]
    alone = [_part(data, "separate", [p], shape) for p in products]
    p_alone = _p_of_more(data, [term], alone, 2 * (len(products) - 1))
    steps.append(f"{data.name}, separate models instead: curves differ beyond the term with {_p(p_alone)}")
    if _is_significant(term.test) and p_alone >= LIMIT_P:
        steps.append(f"{data.name}: the model with a product term is used")
        return [term]
    for part in alone:
        assert part.test is not None
        verdict = "is used" if _is_significant(part.test) else "is not used"
        steps.append(
            f"{data.name}: the separate model of {data.products[part.products[0]]} {verdict}: {_told(part.test)}"
        )
    return [part for part in alone if part.test and _is_significant(part.test)]


def _constants(data: Data, products: list[int], steps: list[str]) -> list[Part]:
    """Return a constant for each product: common to all if they do not differ."""
    if not products:
        return []
    names = " and ".join(data.products[p] for p in products)
    alone = _part(data, "constant", products, None)
    if len(products) > 1:
        common = _part(data, "common", products, None)
        p = _p_of_more(data, [common], [alone], len(products) - 1)
        beside = _beside_motors(data, common, alone, len(products))
        steps.append(f"{data.name} of {names}, constant: products differ with {_p(p)} ({beside})")
        return [common if p >= LIMIT_P else alone]
    steps.append(f"{data.name} of {names}: a constant is used")
    return [alone]


def _is_significant(test: Test) -> bool:
    return test.largest_p < LIMIT_P


def _told(test: Test) -> str:
    return f"{_p(test.largest_p)} for its least significant parameter, R2 {test.r_squared:.3f}"


def _p(p: float) -> str:
    return "p < 0.001" if p < LIMIT_P else f"p = {p:.2g}"


def _p_of_more(data: Data, small: Sequence[Part], large: Sequence[Part], more: int) -> float:
    """Return the p-value of more parameters: F-test against the scatter of records, or of cycles if that is larger."""
    rows = np.any([part.rows for part in large], axis=0)
    parameters = sum(len(set(part.group.tolist())) + (2 if part.shape else 0) for part in large)
    by_record = _mean_square(data, large, data.nesting.record, parameters)
    by_cycle = _mean_square(data, large, np.arange(len(rows)), parameters)
    usable = [each for each in (by_record, by_cycle) if each]
    return _f_test(_rss(data, small) - _rss(data, large), more, max(usable)) if usable else 1.0


def _rss(data: Data, parts: Sequence[Part]) -> float:
    return sum(float(part.fit(data, data.outcome_s[:, None]).rss[0]) for part in parts)


def _f_test(gain: float, more: int, error: tuple[float, int]) -> float:
    """Return the p-value of a sum of squares for `more` parameters over a mean square and its freedom."""
    from scipy.stats import f as fisher

    if gain <= 0.0:
        return 1.0
    return float(fisher.sf(gain / more / error[0], more, error[1])) if error[0] > 0.0 else 0.0


def _mean_square(data: Data, parts: Sequence[Part], unit: IntArray, parameters: int) -> tuple[float, int] | None:
    """Return the mean square of what the parts leave, by units such as records, and its freedom; None without any."""
    rows, rest = np.any([part.rows for part in parts], axis=0), np.zeros(len(data.outcome_s))
    for part in parts:
        rest[part.rows] = data.outcome_s[part.rows] - part.predicted(data, part.fit(data, data.outcome_s[:, None]))
    counts = np.bincount(unit[rows])
    freedom = int(np.count_nonzero(counts)) - parameters
    sums = np.bincount(unit[rows], rest[rows])[counts > 0]
    return (float((sums**2 / counts[counts > 0]).sum()) / freedom, freedom) if freedom > 0 else None


def _beside_motors(data: Data, small: Part, large: Part, products: int) -> str:
    """Say how a difference of products stands against that of exemplars: the paper's test does not ask."""
    error = _mean_square(data, [large], data.nesting.exemplar, products)
    if error is None:
        return "one motor each: product and motor cannot be told apart"
    return (
        f"{_p(_f_test(_rss(data, [small]) - _rss(data, [large]), products - 1, error))} against the scatter of motors"
    )


def _curves(
    data: Data, part: Part, silent: Sequence[int], again: Fitted, fitted: Fitted, untold: list[str]
) -> dict[str, ProductCurve]:
    """Return the curve of each product of a part, with intervals from resampled fits.

    Of `silent` products the data do not tell whether there is a curve.
    """
    bounded = (
        part.shape is not None
        and part.tau_s is None
        and float(np.mean(~again.is_inside)) <= AT_END
        and bool(fitted.is_inside[0])
    )
    names = [data.products[p] for p in part.products]
    if part.tau_s is not None:
        untold.append(
            f"{data.name}_a_s, {data.name}_b_s and {data.name}_tau_s of {' and '.join(names)} cannot be told apart: "
            f"a tau of {part.tau_s:.0f} s is taken, the middle of the times before; between those recorded the curve "
            "holds"
        )
    elif part.shape is not None and not bounded:
        untold.append(
            f"{data.name}_tau_s of {' and '.join(names)} is not bounded within {SHORTEST_S:g} and {LONGEST_S:g} s, "
            "and a and b go with it: other on and off times are needed; between those recorded the curve holds"
        )
    curves = {}
    for place, name in zip(part.products, names, strict=True):
        group = 0 if part.form == "common" else list(part.products).index(place)
        before = data.before_s[data.product == place]
        curves[name] = ProductCurve(
            _value(fitted.a_s, again.a_s, bounded),
            _value(fitted.b_s[group], again.b_s[group], bounded or (part.shape is None and place not in silent)),
            _value(fitted.tau_s, again.tau_s, bounded),
            part.form if part.shape is not None else "constant",
            part.test,
            len(before),
            (float(before.min()), float(before.max())) if len(before) else (np.nan, np.nan),
        )
    return curves


def _value(found: FloatArray, again: FloatArray, told: bool) -> Value:
    low, high = np.quantile(again, (0.025, 0.975))
    return Value(float(found[0]), float(low), float(high), told)
