"""Parameters of a component: frozen, checked, and documented field by field."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from waxstudy.plugin.wording import reasons


class Parameters(BaseModel):
    """Base of every component's parameters.

    Fields carry their unit as a suffix of the name; declare each with `parameter`.
    Numbers are never read from text, unknown keys are refused, NaN and infinity too.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        arbitrary_types_allowed=True,
        validate_default=True,
    )


def parameter(
    default: Any = ...,
    *,
    unit: str,
    description: str,
    source: str,
    **options: Any,
) -> Any:
    """Declare one parameter field.

    `unit` is "1" for a dimensionless number and "" for a choice or a text; `source` names a table, an
    equation, a standard, or says "chosen: " and why. `options` go to pydantic (`ge`, `le`, `default_factory`).
    """
    extra: dict[str, Any] = {"unit": unit, "source": source}
    if "default_factory" in options:
        return Field(description=description, json_schema_extra=extra, **options)
    return Field(default, description=description, json_schema_extra=extra, **options)


P = TypeVar("P", bound=Parameters)


def checked(model: type[P], values: Mapping[str, Any]) -> P:
    """Return parameters of a model; raise `ValueError` with a one-line reason."""
    try:
        return model.model_validate(dict(values))
    except ValidationError as error:
        raise ValueError(reasons(error)) from None


def changed(parameters: P, **values: Any) -> P:
    """Return parameters with some of them changed; raise `ValueError` with a one-line reason."""
    return checked(type(parameters), {**dict(parameters), **values})
