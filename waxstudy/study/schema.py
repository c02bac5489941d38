"""The JSON Schema of study files, for editors: what the reader accepts, as far as a schema can tell.

The reader sees more: what one value asks of another, of an earlier case or of a file on disk, that a whole number
is written without a point, and what a component's own validators say.
"""

from __future__ import annotations

import inspect
import json
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.errors import PydanticInvalidForJsonSchema
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaWarningKind
from pydantic_core import core_schema

from waxstudy.plugin import CHAIN, Component
from waxstudy.plugin.registry import Registry
from waxstudy.study.activation import ActivationTable, StateTable
from waxstudy.study.drawn import MOST_WEATHERS
from waxstudy.study.fragment import FROM
from waxstudy.study.model import NAME_PATTERN, NAME_RULE, Comfort, Ensemble, Output, Season, StudyTable

DIALECT = "http://json-schema.org/draft-07/schema#"
NAME = f"^{NAME_PATTERN}$"

Json = dict[str, Any]


def schema(registry: Registry) -> Json:
    """Return the JSON Schema (draft-07) of study files that use the components of a registry."""
    definitions = definitions_of(registry, (*CHAIN, "room", "weather"))
    for kind in CHAIN:
        definitions[f"step.{kind}"] = _or_from(kind, _block(kind, _usable(registry, kind), definitions))
    study = parameters(StudyTable)
    study["properties"]["name"]["pattern"] = NAME
    study["properties"]["against"]["enum"] = list(_usable(registry, "reference"))
    return {
        "$schema": DIALECT,
        "title": "study file of waxstudy",
        **table("A study: which control chains are compared, in which room, under which weather."),
        "required": ["study", "room", "weather", "ladder"],
        "properties": {
            "study": study,
            "room": ref("room"),
            "weather": _named("Weeks, or other periods, that every case is run under.", ref("weather")),
            "comfort": parameters(Comfort),
            "season": parameters(Season),
            "ensemble": _ensemble(),
            "output": parameters(Output),
            "ladder": _named("Ladders: cases that grow step by step.", LADDER),
            "activation": _activation(),
        },
        "definitions": definitions,
    }


def definitions_of(registry: Registry, kinds: Sequence[str]) -> dict[str, Json]:
    """Return the blocks of some kinds, `room`, and the components that they may use, `room.nzeb`."""
    named = {kind: _usable(registry, kind) for kind in kinds}
    found = {f"{kind}.{name}": described(one) for kind, ones in named.items() for name, one in ones.items()}
    for kind, ones in named.items():
        block = _block(kind, ones) | {"required": ["use"]}
        found[kind] = block if kind == "weather" else _or_from(kind, block)
    return found


def _usable(registry: Registry, kind: str) -> dict[str, type[Component]]:
    """Return a kind's components but those whose name two packages claim, which the reader refuses."""
    names = [name for name in registry.names(kind) if (kind, name) not in registry.contested]
    return {name: registry.components[kind, name].component for name in names}


# --- tables ----------------------------------------------------------------------------------------


def table(description: str) -> Json:
    return {"description": description, "type": "object", "additionalProperties": False}


def _named(description: str, inner: Json) -> Json:
    """Return the tables `[parent.NAME]`."""
    made = {"type": "object", "minProperties": 1, "propertyNames": {"pattern": NAME}, "additionalProperties": inner}
    return {"description": f"{description} A name {NAME_RULE}."} | made


def _ensemble() -> Json:
    lists = {"type": "array", "minItems": 2, "maxItems": MOST_WEATHERS}
    values = "A parameter of this week's weather: one value for each of its weathers."
    week = table("Weathers of this week.") | {"additionalProperties": {"description": values, **lists}}
    made = parameters(Ensemble)
    made["properties"]["weather"] = _named("Weeks that have several weathers.", week)
    return made


def _activation() -> Json:
    """Return `[activation]`; a distribution may be a list or one of three tables."""
    made, state = parameters(ActivationTable), parameters(StateTable)
    rooms = "CSV file with a row for each kind of room: `name`, `loops`, and keys of [activation.draw]."
    state["properties"]["pause_s"] = SPREAD | {
        "description": "How long all loops are kept off before the call [s]; without it controllers go on as they do."
    }
    draw = "What loops differ in: `setpoint_C`, `flow_share`, `room.KEY`, or `BLOCK.KEY` of the states' cases."
    made["properties"] |= {
        "rooms": {"description": rooms, "type": "string"},
        "draw": {"description": draw, "type": "object", "additionalProperties": True},
        "state": _named("States in which the call finds the fleet.", state),
    }
    return made | {"required": [*made.get("required", []), "state"]}


def _name(description: str) -> Json:
    return {"description": f"{description}; {NAME_RULE}.", "type": "string", "pattern": NAME}


def ref(name: str) -> Json:
    return {"$ref": f"#/definitions/{name}"}


def _case(description: str, prefix: str, required: list[str]) -> Json:
    blocks = {kind: ref(f"{prefix}{kind}") for kind in CHAIN}
    return table(description) | {"required": required, "properties": {"id": _name("Id of the case"), **blocks}}


LADDER: Json = table("Cases in order; a step changes the case before it.") | {
    "required": ["reference", "start"],
    "properties": {
        "reference": _name("Id of the case of this ladder that the others are compared with"),
        "start": _case("The first case: its id, and its blocks.", "", ["id", "controller"]),
        "steps": {
            "description": "The other cases: each an id, and what it changes in the case before.",
            "type": "array",
            "items": _case("A case: its id, and what it changes in the case before.", "step.", ["id"]),
        },
    },
}


_NUMBER: Json = {"type": "number"}
SPREAD: Json = {
    "anyOf": [
        {"type": "array", "minItems": 1},
        *(
            table("A distribution.") | {"required": keys, "properties": dict.fromkeys(keys, _NUMBER)}
            for keys in (["low", "high"], ["mean", "sd"])
        ),
        table("A distribution.")
        | {"required": ["values", "shares"], "properties": {key: {"type": "array"} for key in ("values", "shares")}},
    ]
}

# --- components ------------------------------------------------------------------------------------

ANY_KEY = "The keys of all components, for editors that do not follow `if`; the last branch lets everything pass."


def _block(kind: str, named: Mapping[str, type[Component]], step_of: Mapping[str, Json] | None = None) -> Json:
    """Return a block: `use` chooses the component that its other keys belong to.

    In a step they are changes: nothing is needed, and without `use` they may belong to any component of the kind.
    """
    chosen = []
    for name, component in named.items():
        needed = [] if step_of else needed_keys(component)
        then = {"allOf": [ref(f"{kind}.{name}")], "required": needed} if needed else ref(f"{kind}.{name}")
        chosen.append({"if": {"properties": {"use": {"const": name}}}, "then": then})
    return {
        "description": f"The {kind}: `use` chooses one, the other keys are its parameters.",
        "type": "object",
        "$comment": ANY_KEY,
        "anyOf": [*(ref(f"{kind}.{name}") for name in named), True],
        "if": {"required": ["use"]},
        "then": {"properties": {"use": {"enum": list(named)}}, "allOf": chosen or [True]},
        "else": any_of([step_of[f"{kind}.{name}"] for name in named]) if step_of else {},
    }


def _or_from(kind: str, block: Json) -> Json:
    """Return a block that may also be taken from a file, with changes upon it."""
    path = {"description": f"TOML file whose table [{kind}] is taken, relative to the study file.", "type": "string"}
    shown = {key: block[key] for key in ("description", "type", "$comment", "anyOf")}
    rest = {key: value for key, value in block.items() if key not in shown}
    return shown | {"if": {"required": [FROM]}, "then": {"properties": {FROM: path}}, "else": rest}


def any_of(components: list[Json]) -> Json:
    """Return what a block without `use` may hold: any parameter of any component of its kind."""
    if any(component.get("additionalProperties") is not False for component in components):
        return {}
    found: dict[str, list[Json]] = {}
    for component in components:
        for key, declared in component["properties"].items():
            found.setdefault(key, []).append(declared)
    known = {key: one[0] if len(one) == 1 else {"anyOf": one} for key, one in found.items() if key != "use"}
    return {"properties": known, "additionalProperties": False}


def described(component: type[Component]) -> Json:
    """Return a component's keys; where a stranger's cannot be described, all pass, and the description says why."""
    about = " ".join(inspect.cleandoc(component.__doc__ or "").partition("\n\n")[0].split())
    use = {"use": {"description": f"`{component.name}`: {about}", "const": component.name}}
    try:
        made = parameters(component.Parameters)
        made["properties"] = use | made["properties"]
        json.dumps(made, allow_nan=False)
    except Exception as error:  # a stranger's types and defaults may raise anything
        why = f"{type(error).__name__}: {error}".partition("\n")[0]
        return {"description": f"{about} No check of its parameters: {why}", "type": "object", "properties": use}
    return _without(made, "required") | {"description": about}


def needed_keys(component: type[Component]) -> list[str]:
    """Return the parameters that are missing if left out, beside nothing and in every example.

    A validator may complete others, such as the times of a product; then the reader is the judge.
    """
    model = component.Parameters
    required = [field.alias or key for key, field in model.model_fields.items() if field.is_required()]
    try:
        tried: list[Json] = [{}, *map(dict, component.examples.values())]
    except (AttributeError, TypeError, ValueError):  # a stranger's may be anything
        return []
    return [key for key in required if all(_is_missed(model, key, given) for given in tried)]


def _is_missed(model: type[BaseModel], key: str, given: Json) -> bool:
    try:
        model.model_validate_json(json.dumps(_without(given, key), default=str))
    except ValidationError as error:
        return any(detail["type"] == "missing" and detail["loc"] == (key,) for detail in error.errors())
    except Exception:  # a stranger's validator may raise anything
        pass
    return False


# --- parameters ------------------------------------------------------------------------------------


def parameters(model: type[BaseModel]) -> Json:
    """Return a model's schema; raise whatever pydantic raises for a type that has none."""
    made = model.model_json_schema(schema_generator=_Draft7)
    nested = {name: _without(one, "title") for name, one in made.pop("$defs", {}).items()}
    inlined: Json = _inlined(_without(made, "title"), nested)
    return inlined


def _inlined(node: Any, models: Mapping[str, Json]) -> Any:
    """Return a schema with its nested models in place: beside a reference, draft-07 ignores a description."""
    if isinstance(node, list):
        return [_inlined(inner, models) for inner in node]
    if not isinstance(node, dict):
        return node
    rest = {key: _inlined(inner, models) for key, inner in node.items() if key != "$ref"}
    if "$ref" not in node:
        return rest
    return _inlined(models[node["$ref"].removeprefix("#/$defs/")], models) | rest


class _Draft7(GenerateJsonSchema):
    """Pydantic's schema in the words of draft-07, for TOML, which has no null."""

    schema_dialect = DIALECT

    def nullable_schema(self, schema: core_schema.NullableSchema) -> Json:
        return self.generate_inner(schema["schema"])

    def tuple_schema(self, schema: core_schema.TupleSchema) -> Json:
        made = super().tuple_schema(schema)
        if "prefixItems" in made:
            made["additionalItems"] = made.get("items", False)
            made["items"] = made.pop("prefixItems")
        return made

    def function_before_schema(self, schema: core_schema.BeforeValidatorFunctionSchema) -> Json:
        return _without(super().function_before_schema(schema), "required")  # it may complete what is missing

    def function_wrap_schema(self, schema: core_schema.WrapValidatorFunctionSchema) -> Json:
        return _without(super().function_wrap_schema(schema), "required")

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False

    def model_schema(self, schema: core_schema.ModelSchema) -> Json:
        made = super().model_schema(schema)
        if "properties" in made:
            made["properties"] = {key: _told(field) for key, field in made["properties"].items()}
        return made

    def emit_warning(self, kind: JsonSchemaWarningKind, detail: str) -> None:
        """A default that cannot be shown is left out; a choice that is left out would be refused."""
        if kind == "skipped-choice":
            raise PydanticInvalidForJsonSchema(detail)


def _told(field: Json) -> Json:
    """Return a field with its unit, default and source told in the description, which is what editors show."""
    text, unit, source = (str(field.pop(key, "")).rstrip(".") for key in ("description", "unit", "source"))
    field = _without_null(field)
    default = field.get("default")
    sentences = [
        f"{text[:1].upper()}{text[1:]}" + (f" [{unit}]" if unit not in ("", "1") else ""),
        f"Default: {json.dumps(default)}" if isinstance(default, bool | int | float | str) else "",
        f"Source: {source}" if source else "",
    ]
    return {"description": " ".join(f"{sentence}." for sentence in sentences if sentence), **field}


def _without(made: Json, word: str) -> Json:
    return {key: value for key, value in made.items() if key != word}


def _without_null(value: Any) -> Any:
    if isinstance(value, list):
        return [_without_null(inner) for inner in value]
    if isinstance(value, dict):
        return {key: _without_null(inner) for key, inner in value.items() if inner is not None}
    return value
