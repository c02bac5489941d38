"""The tables of a fit: coefficients, times, records with their errors (Table A1)."""

from __future__ import annotations

from waxstudy.identification.models import ProductCurve, Value
from waxstudy.identification.result import ActuatorFit, counts
from waxstudy.identification.valve import ValveFit
from waxstudy.report.words import Table

SIMULATED = "SIMULATED: these records come from a virtual test bench; no motor was measured"
MEANING = {
    "dead_a_s": "dead time: a exp(-undercooling / tau) + b",
    "rise_a_s": "rise time: the same",
    "hold_a_s": "hold time: a (1 - exp(-overheating / tau)) + b",
    "fall_s": "fall time",
    "h_min": "opening at which the flow starts",
    "h_mid": "opening at which the curve bends",
    "v_mid": "theoretical flow at the bend",
    "authority": "authority of the valve",
    "pace": "times of this exemplar over the actuator's",
    "delay": "switches later than in the middle between two samples, in intervals",
}


def actuator_tables(found: ActuatorFit) -> list[Table]:
    return [coefficients(found), activation(found), records(found)]


def coefficients(found: ActuatorFit) -> Table:
    """Coefficient, 95 % interval, model."""
    rows = []
    for product in found.model.products:
        for name, value in found.model.coefficients(product).items():
            time = found.model.times[name.split("_")[0]].curves[product]
            shown = _shown(name, value, time)
            rows.append([product, name, *shown, time.form, str(time.cycles), MEANING.get(name, "")])
    headings = ["product", "coefficient", "value, s", "95 % interval", "model", "cycles", "meaning"]
    return "coefficients of the characteristic times", headings, rows


def _shown(name: str, value: Value, curve: ProductCurve) -> list[str]:
    """Return a coefficient and its interval, as far as both mean something."""
    if curve.form == "constant":
        if name.endswith(("_a_s", "_tau_s")):
            return ["-", "cannot be told" if not value.told and not curve.b_s.told else ""]
        return [f"{value.value:.1f}", interval(value, 1) + ("" if value.told else ", of the constant alone")]
    if not curve.a_s.told:
        return [f"{value.value:.1f}", "cannot be told"]
    return [f"{value.value:.1f}", interval(value, 1) + ("" if value.told else ", not bounded")]


def activation(found: ActuatorFit) -> Table:
    rows = []
    for product in found.model.products:
        of = found.activation(product)
        figures = [f"{of[name]:.0f}" for name in of if name.endswith("_s") and "above" not in name]
        rows.append([product, *figures[:2], f"{100.0 * of['full_activation_above_300_s']:.0f} %", *figures[2:]])
    headings = ["product", "activation, s", "longest", "above 300 s", "deactivation, s", "longest"]
    return "full activation (dead + rise) and deactivation (hold + fall), median and longest", headings, rows


def records(found: ActuatorFit) -> Table:
    """A row per record as in Table A1: whole cycles, lost ones with the reason, errors of the opening."""
    rows = []
    for record in found.records:
        errors = found.errors.get(record.name)
        stroke = f"{record.stroke:.3f} {record.unit}".strip()
        rows.append(
            [
                record.name,
                record.product,
                record.exemplar,
                "yes" if record.has_valve else "no",
                f"{record.duration_min:.0f}",
                stroke,
                str(found.kept(record)),
                counts(found.lost(record)).replace("none", ""),
                f"{errors.mae:.3f}" if errors else "",
                f"{errors.rmse:.3f}" if errors else "",
            ]
        )
    headings = ["record", "product", "exemplar", "valve", "min", "stroke", "cycles", "left out", "MAE", "RMSE"]
    return "records: cycles used and left out, and the model's error of the opening over the stroke", headings, rows


def notes(found: ActuatorFit) -> list[str]:
    """What a reader must know, the most important first."""
    told = [SIMULATED] if found.is_simulated else []
    steps = [step for time in found.model.times.values() for step in time.steps]
    return [*told, *found.model.untold(), *scatter(found), *steps, *found.warnings]


def scatter(found: ActuatorFit) -> list[str]:
    """Say how records and exemplars scatter, as far as that can be seen."""
    parts = found.model.times["dead"].scatter
    said = []
    if not parts.exemplar_freedom:
        said.append(
            "there is one exemplar of each product: how others differ cannot be told, intervals are of this one"
        )
    if not parts.record_freedom:
        said.append(
            "the records are too few to tell how those of one exemplar differ: intervals are too narrow by that"
        )
    return said


def interval(value: Value, digits: int) -> str:
    return f"{value.low:.{digits}f} to {value.high:.{digits}f}"


def valve_tables(found: ValveFit) -> list[Table]:
    rows = []
    for name, value in found.values.items():
        taken = "given" if value.low == value.high else "not told: at the bound"
        shown = interval(value, 3) if value.told else taken
        rows.append([name, f"{value.value:.3f}", shown, MEANING[name]])
    title = f"curve of the valve: MAE {100.0 * found.mae:.2f} % of full flow over {int(found.considered.sum())} samples"
    return [(title, ["parameter", "value", "95 % interval", "meaning"], rows)]


def valve_notes(found: ValveFit) -> list[str]:
    told = [SIMULATED] if found.is_simulated else []
    authority = [] if found.how_authority in ("given", "fitted") else [f"the authority is {found.how_authority}"]
    return [*told, *authority, f"full flow is {found.full_flow:.4g} {found.record.unit}", *found.warnings]
