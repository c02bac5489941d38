"""A fit of an actuator as a whole: records, cycles, model, errors; and the same as plain values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from waxstudy.identification.actuator import ActuatorModel, fit_actuator
from waxstudy.identification.fragment import actuator_block, allowed, intervals, sources, text_of
from waxstudy.identification.models import ProductCurve
from waxstudy.identification.performance import Errors, block, errors_of, modelled
from waxstudy.identification.records import Record
from waxstudy.identification.times import cycles_of
from waxstudy.plugin import FloatArray
from waxstudy.study.problems import Problem, StudyError

if TYPE_CHECKING:
    import pandas as pd

LIMIT_S = 300.0  # full activation that a reserve asks for
# what makers of eleven actuators state [s], at room temperature: 1 to 6.5 min to open, 1 to 9 min to close
STATED_S = {"full_activation": (60.0, 390.0), "deactivation": (60.0, 540.0)}


@dataclass(frozen=True)
class ActuatorFit:
    """What `waxstudy fit actuator` found."""

    records: Sequence[Record]
    cycles: pd.DataFrame  # a row per cycle, lost ones too
    model: ActuatorModel
    modelled: Mapping[str, FloatArray]  # record -> opening, of records whose product has a model
    errors: Mapping[str, Errors]
    warnings: Sequence[str]

    @property
    def is_simulated(self) -> bool:
        return any(record.is_simulated for record in self.records)

    def lost(self, record: Record) -> dict[str, int]:
        """Return how many cycles of a record are left out, by reason."""
        why = self.cycles.loc[(self.cycles["record"] == record.name) & (self.cycles["lost"] != ""), "lost"]
        return {str(reason): int(count) for reason, count in why.value_counts().items()}

    def kept(self, record: Record) -> int:
        return int(((self.cycles["record"] == record.name) & (self.cycles["lost"] == "")).sum())

    def activation(self, product: str) -> dict[str, float]:
        """Return full activation and deactivation of the cycles of a product [s]: dead + rise, hold + fall."""
        own = self.cycles[(self.cycles["lost"] == "") & (self.cycles["product"] == product)]
        full, off = own["dead_s"] + own["rise_s"], own["hold_s"] + own["fall_s"]
        return {
            "full_activation_median_s": float(full.median()),
            "full_activation_max_s": float(full.max()),
            "full_activation_above_300_s": float((full > LIMIT_S).mean()),
            "deactivation_median_s": float(off.median()),
            "deactivation_max_s": float(off.max()),
        }

    def fragment(self, product: str) -> str:
        """Return the TOML fragment of a product."""
        coefficients = self.model.coefficients(product)
        own = [record for record in self.records if record.product == product]
        about = {
            "product": product,
            "simulated": self.is_simulated,
            "cycles": sum(self.kept(record) for record in own),
            "interval_95": intervals(coefficients),
            "untold": [*self.model.untold(), *allowed(coefficients)[1]],
            "records": sources(self.records),
        }
        return text_of("actuator", actuator_block(coefficients), about)

    def described(self) -> dict[str, Any]:
        """Return everything but the samples as plain values."""
        return {
            "simulated": self.is_simulated,
            "products": {product: self._product(product) for product in self.model.products},
            "steps": [step for time in self.model.times.values() for step in time.steps],
            "untold": self.model.untold(),
            "scatter": {
                name: {"cycle": time.scatter.cycle, "record": time.scatter.record, "exemplar": time.scatter.exemplar}
                for name, time in self.model.times.items()
            },
            "records": [self._record(record) for record in self.records],
            "warnings": list(self.warnings),
        }

    def _product(self, product: str) -> dict[str, Any]:
        return {
            "actuator": actuator_block(self.model.coefficients(product)),
            "coefficients": {name: asdict(value) for name, value in self.model.coefficients(product).items()},
            "models": {name: _model(time.curves[product]) for name, time in self.model.times.items()},
            **self.activation(product),
        }

    def _record(self, record: Record) -> dict[str, Any]:
        errors = self.errors.get(record.name)
        return {
            "name": record.name,
            "file": record.file,
            "sha256": record.sha256,
            "product": record.product,
            "exemplar": record.exemplar,
            "valve": record.has_valve,
            "simulated": record.is_simulated,
            "interval_s": record.interval_s,
            "duration_min": record.duration_min,
            "stroke": record.stroke,
            "unit": record.unit,
            "cycles": self.kept(record),
            "lost": self.lost(record),
            "mae": errors.mae if errors else None,
            "rmse": errors.rmse if errors else None,
        }


def _model(curve: ProductCurve) -> dict[str, Any]:
    test = curve.test
    return {
        "form": curve.form,
        "cycles": curve.cycles,
        "before_s": None if np.isnan(curve.before_s).any() else list(curve.before_s),
        "r_squared": test.r_squared if test else None,
        "largest_p": test.largest_p if test else None,
    }


def fit(records: Sequence[Record], seed: int = 1) -> ActuatorFit:
    """Return the fit of an actuator to records; raise `StudyError` where no cycle can be used."""
    import pandas as pd

    cycles = pd.concat([cycles_of(record) for record in records], ignore_index=True)
    warnings = [f"{record.file}: {sentence}" for record in records for sentence in record.warnings]
    fits = ActuatorFit(records, cycles, ActuatorModel({}), {}, {}, warnings)
    if not (cycles["lost"] == "").any():
        raise StudyError([_no_cycle(record, fits.lost(record)) for record in records])
    silent = [record for record in records if not fits.kept(record)]
    warnings += [f"{record.file}: no cycle can be used ({counts(fits.lost(record))})" for record in silent]
    model = fit_actuator(cycles, seed)
    opening = {
        record.name: modelled(
            block("actuator", actuator_block(model.coefficients(record.product))), record.on, record.interval_s
        )[0]
        for record in records
        if record.product in model.products
    }
    errors = {record.name: errors_of(record, opening[record.name]) for record in records if record.name in opening}
    found = ActuatorFit(records, cycles, model, opening, errors, warnings)
    warnings += [sentence for product in model.products for sentence in _unusual(product, found.activation(product))]
    return found


def _unusual(product: str, activation: Mapping[str, float]) -> list[str]:
    """Say which times no maker states: the unit of the time may be another."""
    return [
        f"the median {name.replace('_', ' ')} of {product} is {activation[f'{name}_median_s']:.0f} s, and makers state "
        f"{low:.0f} to {high:.0f} s: is the unit of the time right?"
        for name, (low, high) in STATED_S.items()
        if not low <= activation[f"{name}_median_s"] <= high
    ]


def counts(lost: Mapping[str, int]) -> str:
    """
    >>> counts({"gap": 2, "does not move": 1})
    'gap (2), does not move (1)'
    """
    return ", ".join(f"{reason} ({count})" for reason, count in lost.items()) or "none"


def _no_cycle(record: Record, lost: Mapping[str, int]) -> Problem:
    return Problem(record.file, 0, "", "", "", f"no cycle can be used: {counts(lost)}")
