"""What pydantic finds wrong with a value, in our own words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

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


def worded(detail: Mapping[str, Any]) -> str:
    """Return one of the errors of a `ValidationError` as the end of a sentence that begins with the key."""
    context = {name: str(value).removesuffix(".0") for name, value in detail.get("ctx", {}).items()}
    return SENTENCES.get(detail["type"], "is not allowed").format_map(context)


def reasons(error: ValidationError) -> str:
    """Return all that is wrong in one line, each with its key.

    >>> from pydantic import BaseModel, Field
    >>> class Valve(BaseModel):
    ...     authority: float = Field(gt=0)
    >>> try:
    ...     Valve(authority=-1.0)
    ... except ValidationError as error:
    ...     print(reasons(error))
    authority: must be greater than 0
    """
    details = error.errors(include_url=False, include_input=False)
    return "; ".join(": ".join((*map(str, each["loc"]), worded(each))) for each in details)
