"""What pydantic found in a study file: at which key, in our own words, and what is allowed there."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from waxstudy.plugin.registry import nearest
from waxstudy.plugin.wording import worded
from waxstudy.study.lines import KeyPath
from waxstudy.study.problems import listed


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
    wrong = worded(detail)
    owner, declared = _declared(model, keys)
    if kind == "extra_forbidden":
        names = list(owner.model_fields) if owner else []
        return Sentence(keys, None, wrong, nearest(str(keys[-1]), names), f"allowed: {listed(names)}")
    value = value_at(values, keys)
    context = detail.get("ctx", {})
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
