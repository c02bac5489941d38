"""The tables of a fit: coefficients, times, records with their errors (Table A1)."""

from __future__ import annotations

from typing import Any, NamedTuple

from waxstudy.identification.models import ProductCurve, Value
from waxstudy.identification.records import Record
from waxstudy.identification.result import ActuatorFit, counts
from waxstudy.identification.valve import ValveFit
from waxstudy.report.table import Column, Table, text

SIMULATED = "SIMULATED: these records come from a virtual test bench; no motor was measured"
MEANING = {
    "dead_a_s": "dead time: a exp(-x / tau) + b, x is the undercooling",
    "rise_a_s": "rise time: the same",
    "hold_a_s": "hold time: a (1 - exp(-x / tau)) + b, x is the overheating",
    "fall_s": "fall time",
    "h_min": "opening at which the flow starts",
    "h_mid": "opening at which the curve bends",
    "v_mid": "theoretical flow at the bend",
    "authority": "authority of the valve",
    "pace": "times of this exemplar over the actuator's",
    "delay": "switches later than in the middle between two samples, in intervals",
}


def actuator_tables(found: ActuatorFit) -> list[Table[Any]]:
    return [coefficients(found), activation(found), records(found)]


class Coefficient(NamedTuple):
    """A coefficient of a product, and the curve that it is of."""

    product: str
    name: str
    value: Value
    curve: ProductCurve

    @property
    def is_absent(self) -> bool:
        """Whether a constant has none such."""
        return self.curve.form == "constant" and self.name.endswith(("_a_s", "_tau_s"))

    @property
    def interval(self) -> str:
        """Its interval, as far as that means something."""
        if self.is_absent:
            return "" if self.value.told or self.curve.b_s.told else "cannot be told"
        if self.curve.form != "constant" and not self.curve.a_s.told:
            return "cannot be told"
        weak = ", of the constant alone" if self.curve.form == "constant" else ", not bounded"
        return interval(self.value, ".1f") + ("" if self.value.told else weak)


def coefficients(found: ActuatorFit) -> Table[Coefficient]:
    """Coefficient, 95 % interval, model."""
    columns: list[Column[Coefficient]] = [
        text("product"),
        text("name", heading="coefficient"),
        Column("value", lambda each: "-" if each.is_absent else each.value.value, ".1f", unit="s"),
        text("interval", heading="95 % interval", kind="prose"),
        text("model", lambda each: each.curve.form),
        Column("cycles", lambda each: each.curve.cycles),
        text("meaning", lambda each: MEANING.get(each.name), kind="prose"),
    ]
    rows = [
        Coefficient(product, name, value, found.model.times[name.split("_")[0]].curves[product])
        for product in found.model.products
        for name, value in found.model.coefficients(product).items()
    ]
    return Table("coefficients of the characteristic times", columns, rows)


def activation(found: ActuatorFit) -> Table[dict[str, Any]]:
    """Times of each product, as `ActuatorFit.activation` has them."""
    columns: list[Column[dict[str, Any]]] = [
        text("product", lambda of: of["product"]),
        Column("activation", lambda of: of["full_activation_median_s"], ".0f", unit="s"),
        Column("longest", lambda of: of["full_activation_max_s"], ".0f", unit="s"),
        Column("above 300 s", lambda of: f"{100.0 * of['full_activation_above_300_s']:.0f} %"),
        Column("deactivation", lambda of: of["deactivation_median_s"], ".0f", unit="s"),
        Column("longest", lambda of: of["deactivation_max_s"], ".0f", unit="s"),
    ]
    title = "full activation (dead + rise) and deactivation (hold + fall), median and longest"
    rows = [{"product": product, **found.activation(product)} for product in found.model.products]
    return Table(title, columns, rows)


def records(found: ActuatorFit) -> Table[Record]:
    """A row per record as in Table A1: whole cycles, lost ones with the reason, errors of the opening."""
    columns: list[Column[Record]] = [
        text("name", heading="record"),
        text("product"),
        text("exemplar"),
        text("valve", lambda record: "yes" if record.has_valve else "no"),
        Column("duration_min", form=".0f", heading="length", unit="min"),
        Column("stroke", lambda record: f"{record.stroke:.3f} {record.unit}".strip()),
        Column("cycles", found.kept),
        text("left out", lambda record: counts(found.lost(record)).replace("none", ""), "prose"),
        Column("MAE", lambda record: found.errors[record.name].mae if record.name in found.errors else None, ".3f"),
        Column("RMSE", lambda record: found.errors[record.name].rmse if record.name in found.errors else None, ".3f"),
    ]
    title = "records: cycles used and left out, and the model's error of the opening over the stroke"
    return Table(title, columns, found.records)


def notes(found: ActuatorFit) -> list[str]:
    """What a reader must know, the most important first."""
    told = [SIMULATED] if found.is_simulated else []
    steps = [step for time in found.model.times.values() for step in time.steps]
    return [*told, *found.model.untold(), *scatter(found), *steps, *found.warnings]


def scatter(found: ActuatorFit) -> list[str]:
    """Say how records and exemplars scatter, as far as that can be seen."""
    parts = found.model.times["dead"].scatter
    alone = "there is one exemplar of each product: how others differ cannot be told, intervals are of this one"
    few = "the records are too few to tell how those of one exemplar differ: intervals are too narrow by that"
    return [*([] if parts.exemplar_freedom else [alone]), *([] if parts.record_freedom else [few])]


def interval(value: Value, form: str) -> str:
    return f"{value.low:{form}} to {value.high:{form}}"


def valve_tables(found: ValveFit) -> list[Table[Any]]:
    def bounds(name: str) -> str:
        value = found.values[name]
        taken = "given" if value.low == value.high else "not told: at the bound"
        return interval(value, ".3f") if value.told else taken

    columns: list[Column[str]] = [
        text("parameter", lambda name: name),
        Column("value", lambda name: found.values[name].value, ".3f"),
        text("95 % interval", bounds),
        text("meaning", MEANING.get),
    ]
    title = f"curve of the valve: MAE {100.0 * found.mae:.2f} % of full flow over {int(found.considered.sum())} samples"
    return [Table(title, columns, list(found.values))]


def valve_notes(found: ValveFit) -> list[str]:
    told = [SIMULATED] if found.is_simulated else []
    authority = [] if found.how_authority in ("given", "fitted") else [f"the authority is {found.how_authority}"]
    return [*told, *authority, f"full flow is {found.full_flow:.4g} {found.record.unit}", *found.warnings]
