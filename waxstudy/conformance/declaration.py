"""What a component says of itself: name, documentation, parameters, examples, exemptions."""

from __future__ import annotations

import json
import pickle
from collections.abc import Collection, Mapping
from typing import Any, Literal, get_args, get_origin

import annotated_types
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from waxstudy.conformance.stage import Problems, Subject
from waxstudy.plugin import Block, Component, Controller, Tunable
from waxstudy.plugin.registry import described, hint
from waxstudy.plugin.structure import structure_problems

# the ending that a name must have for its unit
SUFFIXES: dict[str, str | tuple[str, ...]] = {
    "s": "_s",
    "min": "_min",
    "h": ("_h", "_hour"),  # a duration, or an hour of the day
    "K": "_K",
    "C": "_C",
    "m": "_m",
    "mm": "_mm",
    "m2": "_m2",
    "deg": "_deg",
    "L": "_L",
    "L/h": "_L_h",
    "L/s": "_L_s",
    "W": "_W",
    "J": "_J",
    "J/K": "_J_K",
    "W/K": "_W_K",
    "W/m2": "_W_m2",
    "N": "_N",
    "N/mm": "_N_mm",
    "mm/N": "_mm_N",
    "kPa": "_kPa",
}
SHORTEST_REASON = 20


def declaration(subject: Subject) -> Problems:
    """A component can be registered, and says what it is and which version of the contracts it was written for."""
    component = subject.component
    found = list(structure_problems(component))
    yield from found
    if found:
        return
    if not (component.__doc__ or "").strip() or component.__doc__ in {base.__doc__ for base in component.__mro__[1:]}:
        yield "it has no docstring: say in a sentence what it does, its equation and its source"
    if not any("api_version" in vars(base) for base in component.__mro__ if base is not Component):
        yield f'it does not say for which API it was written: add api_version = "{component.api_version}"'


def exemptions(component: type[Component], exemptible: Collection[str]) -> Problems:
    """Exemptions name a stage that can be exempted, and give a reason."""
    for stage, reason in component.exemptions.items():
        if stage not in exemptible:
            wrong = f"exemption from '{stage}', which is no stage that allows one{hint(stage, exemptible)}"
            yield f"{wrong} ({', '.join(exemptible)})"
        elif not isinstance(reason, str) or len(reason.strip()) < SHORTEST_REASON:
            yield f"exemption from '{stage}' without a reason: write a sentence that a user understands"


def documentation(subject: Subject) -> Problems:
    """Every parameter has unit, description, source, and bounds if it is a number; its name ends with its unit."""
    yield from _undocumented(subject.component.Parameters, "", set())
    if issubclass(subject.component, Block):
        yield from _untunable(subject.component)


def _untunable(block: type[Block]) -> Problems:
    """What is wrong with the parameters that are said to be tuned, or to be what textbook rules set."""
    fields = block.Parameters.model_fields
    named = [block.gain, block.integration_time] if issubclass(block, Controller) else []
    for name in (*block.tuned, *filter(None, named)):
        if name not in fields or fields[name].annotation is not float:
            yield f"{name} is said to be tuned, or set by rules: it is no parameter that is a float{hint(name, fields)}"
    stated: Mapping[str, Any] = block.tuned
    for name, where in stated.items():
        if not isinstance(where, Tunable):
            yield f"{name} is tuned in {where!r:.60}: write Tunable(low, high, is_log=...)"
        elif not where.low < where.high or (where.is_log and where.low <= 0.0):
            yield f"{name} is tuned from {where.low:g} to {where.high:g}: low < high is needed, and above 0 if is_log"


def _undocumented(model: type[BaseModel], prefix: str, seen: set[type]) -> Problems:
    """Problems of a model's fields and of the models in them, each model once."""
    seen.add(model)
    for name, field in model.model_fields.items():
        yield from (f"parameter {prefix}{name}: {wrong}" for wrong in _field_problems(prefix + name, field))
        for inner in _models_in(field.annotation):
            if inner not in seen:
                yield from _undocumented(inner, f"{prefix}{name}.", seen)


def _field_problems(name: str, field: FieldInfo) -> Problems:
    extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
    unit = extra.get("unit")
    if unit is None or "source" not in extra:
        yield "declare it with `parameter(default, unit=, description=, source=, ge=, le=)`"
        return
    for told in ("description", "source"):
        if not (field.description if told == "description" else extra[told]):
            yield f"its {told} is empty"
    suffix = SUFFIXES.get(str(unit))
    if suffix and not any(part.endswith(suffix) for part in name.split(".")):
        yield f"its unit is {unit}: let the name end with {suffix if isinstance(suffix, str) else ' or '.join(suffix)}"
    if _is_number(field) and not _bounded(field):
        yield "give both bounds (ge= or gt=, le= or lt=): a study file is checked against them"
    if any(not isinstance(choice, str | None) for choice in _choices(field.annotation)):
        yield "its choices are no texts: a step gets the index of a choice, which a number would be taken for"


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for inner in get_args(annotation) for model in _models_in(inner)]


def _choices(annotation: Any) -> list[Any]:
    if get_origin(annotation) is Literal:
        return list(get_args(annotation))
    return [choice for inner in get_args(annotation) for choice in _choices(inner)]


def _is_number(field: FieldInfo) -> bool:
    return field.annotation in (float, int, float | None, int | None)


def _bounded(field: FieldInfo) -> bool:
    low = any(isinstance(m, annotated_types.Ge | annotated_types.Gt | annotated_types.Interval) for m in field.metadata)
    high = any(
        isinstance(m, annotated_types.Le | annotated_types.Lt | annotated_types.Interval) for m in field.metadata
    )
    return low and high


def examples(subject: Subject) -> Problems:
    """Every example is a valid parameter set, and survives being written into a run folder and read again."""
    if not subject.examples:
        yield 'it has no example: set examples = {"default": {}} with parameters that show and test it'
    for label, values in subject.examples.items():
        try:
            model = subject.component.Parameters.model_validate_json(json.dumps(dict(values)))
        except ValidationError as error:
            reasons = "; ".join(f"{'.'.join(map(str, e['loc']))} {e['msg'].lower()}".strip() for e in error.errors())
            yield f"example '{label}' is refused: {reasons}"
            continue
        except (Exception, SystemExit) as error:
            yield f"example '{label}': a validator failed with {described(error)}"
            continue
        subject.models[label] = model
        yield from (f"example '{label}': {wrong}" for wrong in _not_kept(model))


def _not_kept(model: Any) -> Problems:
    written = model.model_dump(mode="json", exclude_none=True)
    try:
        again = type(model).model_validate_json(json.dumps(written))
    except Exception as error:
        yield f"written as {written} it cannot be read again ({type(error).__name__}): a run folder would be lost"
        return
    if again.model_dump(mode="json", exclude_none=True) != written:
        yield "read again after writing, it has other values: let validators keep what is given"
    if not type(model).model_config.get("frozen"):
        yield "its parameters can be changed: keep model_config of waxstudy.plugin.Parameters"
    try:
        pickle.loads(pickle.dumps(model))
    except Exception as error:
        yield f"its parameters cannot be pickled ({type(error).__name__}): define the class at the top of a module"
