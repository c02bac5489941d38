"""What pydantic found, in our own words."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from waxstudy.plugin.registry import nearest
from waxstudy.study.lines import KeyPath
from waxstudy.study.problems import listed

DATE = "must be a date such as 2020-01-31"
LIST = "must be a list in [ ]"
TABLE = "must be a table in {{ }}"
TEXT = "must be a text in quotes"

# type of the error -> sentence; the names in braces are what pydantic knows about the limit
SENTENCES = {
    "missing": "missing",
    "extra_forbidden": "unknown key",
    "float_type": "must be a number",
    "int_type": "must be a whole number, such as 1",
    "int_from_float": "must be a whole number, such as 1",
    "bool_type": "must be true or false",
    "string_type": TEXT,
    "path_type": TEXT,
    "list_type": LIST,
    "tuple_type": LIST,
    "set_type": LIST,
    "frozen_set_type": LIST,
    "dict_type": TABLE,
    "model_type": TABLE,
    "model_attributes_type": TABLE,
    "date_type": DATE,
    "date_parsing": DATE,
    "date_from_datetime_parsing": DATE,
    "literal_error": "must be {expected}",
    "enum": "must be {expected}",
    "greater_than": "must be greater than {gt}",
    "greater_than_equal": "must be at least {ge}",
    "less_than": "must be less than {lt}",
    "less_than_equal": "must be at most {le}",
    "multiple_of": "must be a multiple of {multiple_of}",
    "finite_number": "must be a finite number",
    "too_short": "must have at least {min_length} entries",
    "too_long": "must have at most {max_length} entries",
    "string_too_short": "must have at least {min_length} characters",
    "string_too_long": "must have at most {max_length} characters",
    "string_pattern_mismatch": "must match the pattern {pattern}",
    "value_error": "{error}",  # a validator's own words
    "assertion_error": "{error}",
}


class Sentence(NamedTuple):
    """One problem: at which key, what is wrong, and what is allowed."""

    keys: KeyPath
    value: Any
    wrong: str
    near: str
    allowed: str


def sentences(error: ValidationError, model: type[BaseModel], values: Mapping[str, Any]) -> list[Sentence]:
    """Return one sentence per key; the branches of a union become one."""
    found: dict[KeyPath, Sentence] = {}
    for detail in error.errors(include_url=False, include_input=False):
        if _is_default(detail, values):  # left unfilled because of another key, which is told
            continue
        sentence = _sentence(dict(detail), model, values)
        if before := found.get(sentence.keys):
            sentence = sentence._replace(wrong=f"{before.wrong}, or {sentence.wrong}")
        found[sentence.keys] = sentence
    return list(found.values())


def refused_default(error: ValidationError, values: Mapping[str, Any]) -> str:
    """Return the field whose own default is refused, if that is all that is wrong, else ""."""
    details = error.errors(include_url=False, include_input=False)
    return str(details[0]["loc"][0]) if all(_is_default(detail, values) for detail in details) else ""


def _is_default(detail: Any, values: Mapping[str, Any]) -> bool:
    """Whether it is about a value that was not written and is not missing either."""
    return bool(detail["loc"]) and detail["loc"][0] not in values and detail["type"] != "missing"


def _sentence(detail: dict[str, Any], model: type[BaseModel], values: Mapping[str, Any]) -> Sentence:
    kind = detail["type"]
    keys = _written(detail["loc"], values, missing=kind == "missing")
    context = {name: str(value).removesuffix(".0") for name, value in detail.get("ctx", {}).items()}
    wrong = SENTENCES.get(kind, "is not allowed").format_map(context)
    owner, declared = _declared(model, keys)
    if kind == "extra_forbidden":
        names = list(owner.model_fields) if owner else []
        return Sentence(keys, None, wrong, nearest(str(keys[-1]), names), f"allowed: {listed(names)}")
    value = value_at(values, keys)
    near = nearest(str(value), re.findall("'([^']*)'", context.get("expected", "")))
    return Sentence(keys, value, wrong, near, "" if "error" in context else _explained(declared))


def _explained(declared: FieldInfo | None) -> str:
    """Return the first clause of a field's description, and its unit."""
    if declared is None:
        return ""
    text = re.split(r"; |\. |\.$", declared.description or "")[0]
    extra = declared.json_schema_extra
    unit = extra.get("unit") if isinstance(extra, dict) else None
    return f"{text}; unit {unit}" if unit not in (None, "", "1") else text


def value_at(values: Any, keys: KeyPath) -> Any:
    """Return what was written at a key path; `None` if nothing was."""
    for key in keys:
        if not _holds(values, key):
            return None
        values = values[key]
    return values


def _holds(values: Any, key: str | int) -> bool:
    if isinstance(values, list):
        return isinstance(key, int) and key < len(values)
    return isinstance(values, dict) and key in values


def _written(place: KeyPath, values: Any, *, missing: bool) -> KeyPath:
    """Return the part of pydantic's place that is in the file; it also names branches of unions and defaults."""
    keys: KeyPath = ()
    for key in place:
        if _holds(values, key):
            keys, values = (*keys, key), values[key]
    return (*keys, place[-1]) if missing else keys


def _declared(model: type[BaseModel], keys: KeyPath) -> tuple[type[BaseModel] | None, FieldInfo | None]:
    """Return the model in which the last key stands, and the key's field."""
    owner: type[BaseModel] | None = model
    declared: FieldInfo | None = None
    for i, key in enumerate(key for key in keys if isinstance(key, str)):
        if i:
            owner = _model_in(declared.annotation) if declared else None
        declared = owner.model_fields.get(key) if owner else None
    return owner, declared


def _model_in(annotation: Any) -> type[BaseModel] | None:
    """Return the model that an annotation such as `tuple[Layer, ...] | None` holds."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((model for inner in get_args(annotation) if (model := _model_in(inner))), None)
