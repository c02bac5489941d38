"""`waxstudy plugins show`"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from waxstudy.cli.errors import BACKEND, INVALID, PLUGIN, USAGE, CommandError
from waxstudy.cli.output import Command
from waxstudy.cli.plugins.lookup import as_json, print_json, print_tables, registered, table

if TYPE_CHECKING:
    from pydantic import BaseModel
    from pydantic.fields import FieldInfo

    from waxstudy.plugin import Component, Parameters
    from waxstudy.plugin.registry import Registered


@click.command("show", cls=Command)
@click.argument("name", metavar="NAME")
@click.argument("file", metavar="[FILE]", required=False, type=click.Path(path_type=Path))
@as_json
def command(name: str, file: Path | None, as_json: bool) -> None:
    """Show the components called NAME: parameters with unit, range, default and source; state; input and output.

    With FILE, show what it holds for them, as the zones of a model of EnergyPlus and what stands against each.
    """
    if file is not None:
        _show_contents(registered(name), file, as_json)
        return
    shown = [_described(entry) for entry in registered(name)]
    if as_json:
        print_json(shown)
        return
    parts: list[object] = []
    for component in shown:
        parts += [*([""] if parts else []), *_parts(component)]
    print_tables(*parts)


def _show_contents(entries: Sequence[Registered], file: Path, as_json: bool) -> None:
    """Print what a file holds for the component that reads such files."""
    rows = next((rows for rows in (_contents(entry, file) for entry in entries) if rows is not None), None)
    if rows is None:
        raise CommandError(f"'{entries[0].component.name}' reads no file that could be shown", USAGE)
    if as_json:
        print_json([dict(row) for row in rows])
        return
    shown = table(tuple(rows[0]) if rows else ("nothing",))
    for row in rows:
        shown.add_row(*row.values())
    print_tables(shown)


def _contents(entry: Registered, file: Path) -> Sequence[Mapping[str, str]] | None:
    """Return what a file holds for a component, None for one that reads none."""
    from waxstudy.plugin import BackendMissing
    from waxstudy.plugin.registry import PluginError, one_line, told

    try:
        with told(entry.component.name, NotImplementedError, ValueError, BackendMissing):
            return entry.component.contents(file)
    except NotImplementedError:
        return None
    except BackendMissing as error:
        raise CommandError(str(error), BACKEND) from error
    except PluginError as error:
        raise CommandError(str(error), PLUGIN) from error
    except ValueError as error:
        raise CommandError(f"{file}: {one_line(str(error))}", INVALID) from error


def _described(entry: Registered) -> dict[str, Any]:
    """What a component says of itself; `problems` tells what of it cannot be shown."""
    from waxstudy.plugin import Block, Effect
    from waxstudy.plugin.registry import PluginError, told

    component: Any = entry.component
    parts: dict[str, Callable[[], Any]] = {
        "parameters": lambda: _parameters(component.Parameters, _defaults(component)),
        "exemptions": lambda: {str(stage): str(reason) for stage, reason in component.exemptions.items()},
    }
    if issubclass(component, Block):
        parts |= {"input": lambda: _port(component.input), "output": lambda: _port(component.output)}
        parts["state"] = lambda: _state(component)
    if issubclass(component, Effect):
        parts |= {"stage": lambda: str(component.stage), "priors": lambda: _priors(component.priors)}
    described = _declared(entry)
    for name, part in parts.items():
        try:
            with told(name):
                described[name] = part()
        except PluginError as error:
            described["problems"].append(str(error))
    return described


def _declared(entry: Registered) -> dict[str, Any]:
    component = entry.component
    return {
        "kind": component.kind,
        "name": component.name,
        "package": entry.package,
        "version": entry.version,
        "api_version": component.api_version,
        "source_file": _source_file(component),
        "documentation": inspect.cleandoc(component.__doc__ or ""),
        "problems": [],
    }


def _source_file(component: type[Component]) -> str:
    try:
        return f"{inspect.getsourcefile(component)}:{inspect.getsourcelines(component)[1]}"
    except (OSError, TypeError):
        return "unknown"


def _parameters(model: type[BaseModel], defaults: Mapping[str, Any], prefix: str = "") -> list[dict[str, Any]]:
    """One row per parameter; those of a table inside are written as a study file does, `circuit.spacing_m`."""
    from pydantic import BaseModel

    rows: list[dict[str, Any]] = []
    for name, field in model.model_fields.items():
        extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
        inner: Any = field.annotation
        default = defaults.get(name)
        if isinstance(inner, type) and issubclass(inner, BaseModel) and isinstance(default, Mapping):
            rows += _parameters(inner, default, f"{prefix}{name}.")
            continue
        rows.append(
            {
                "name": prefix + name,
                "unit": extra.get("unit", ""),
                "range": _range(field),
                "default": default,
                "required": name not in defaults and field.is_required(),
                "description": field.description or "",
                "source": extra.get("source", ""),
            }
        )
    return rows


def _defaults(component: type[Component]) -> Mapping[str, Any]:
    """What a study gets that gives no parameter: validators may fill in more than the fields themselves."""
    from waxstudy.plugin.registry import PluginError, told

    model: type[Parameters] = component.Parameters
    try:
        with told():
            return model().model_dump(mode="json")
    except PluginError:  # something is required, or a validator fails
        fields = model.model_fields.items()
        return {
            name: field.get_default(call_default_factory=False) for name, field in fields if not field.is_required()
        }


def _range(field: FieldInfo) -> str:
    from typing import get_args

    bounds = {name: getattr(m, name) for m in field.metadata for name in ("ge", "gt", "le", "lt") if hasattr(m, name)}
    if bounds:
        low = f"{bounds['ge']:g}" if "ge" in bounds else f"> {bounds['gt']:g}" if "gt" in bounds else ""
        high = f"{bounds['le']:g}" if "le" in bounds else f"< {bounds['lt']:g}" if "lt" in bounds else ""
        return " to ".join(part for part in (low, high) if part)
    choices = [c for a in (field.annotation, *get_args(field.annotation)) for c in get_args(a) if isinstance(c, str)]
    return ", ".join(dict.fromkeys(choices))


def _priors(priors: Any) -> dict[str, dict[str, Any]]:
    """Where an effect's parameters are looked for."""
    from waxstudy.plugin import Prior
    from waxstudy.plugin.registry import PluginError

    if not isinstance(priors, Mapping) or not all(isinstance(prior, Prior) for prior in priors.values()):
        raise PluginError("they must be a table of Prior(low, high, noticeable=...)")
    return {str(name): dict(vars(prior)) for name, prior in priors.items()}


def _port(port: Any) -> dict[str, Any]:
    from waxstudy.plugin import Port
    from waxstudy.plugin.registry import PluginError

    if not isinstance(port, Port) or not all(isinstance(bound, int | float) for bound in (port.low, port.high)):
        raise PluginError("it must be a Port(quantity, unit, low, high)")
    return vars(port)


def _state(component: Any) -> list[dict[str, Any]]:
    """Fields of the state with their values at the start of the first example, at a step of 5 s."""
    import dataclasses

    from waxstudy.plugin.registry import PluginError
    from waxstudy.simulation.records import plain_parameters

    example: Mapping[str, Any] = next(iter(component.examples.values()), {})
    start = component.start(plain_parameters(component.Parameters.model_validate(dict(example))), 5.0)
    if not isinstance(start, component.State):
        raise PluginError(f"start gives {type(start).__name__}, not its State, {component.State.__name__}")
    return [
        {
            "name": field.name,
            "type": getattr(field.type, "__name__", str(field.type)),
            "start": _start(getattr(start, field.name)),
        }
        for field in dataclasses.fields(start)
    ]


def _start(value: Any) -> Any:
    """A field's value as JSON holds it."""
    from waxstudy.plugin import Ring

    if isinstance(value, Ring):
        return {"ring": value.length}
    return value if isinstance(value, bool | int | float) else type(value).__name__


def _parts(shown: Mapping[str, Any]) -> list[object]:
    title = f"{shown['kind']} '{shown['name']}' of {shown['package']} {shown['version']} (API {shown['api_version']})"
    parts: list[object] = [title, shown["source_file"], "", shown["documentation"]]
    ports = [(side, shown[side]) for side in ("input", "output") if side in shown]
    parts += [""] if ports else []
    parts += [f"{side + ':':8} {p['quantity']} [{p['unit']}], {p['low']:g} to {p['high']:g}" for side, p in ports]
    parts += ["", f"stage:   {shown['stage']}"] if "stage" in shown else []
    if "parameters" in shown:
        parts += ["", _parameter_table(shown["parameters"]) if shown["parameters"] else "no parameters"]
    if shown.get("priors"):
        parts += ["", _prior_table(shown["priors"])]
    if shown.get("state"):
        state = table(("state", "type", "at the start"))
        for field in shown["state"]:
            value = "empty" if isinstance(field["start"], dict) else str(field["start"])
            state.add_row(field["name"], field["type"], value)
        parts += ["", state]
    parts += [f"exempt from {stage}: {reason}" for stage, reason in shown.get("exemptions", {}).items()]
    return [*parts, *(["", *shown["problems"]] if shown["problems"] else [])]


def _parameter_table(parameters: list[dict[str, Any]]) -> object:
    rows = table(("parameter", "unit", "range", "default", "what it is", "source"))
    for p in parameters:
        default = "required" if p["required"] else "" if p["default"] is None else _short(p["default"])
        rows.add_row(p["name"], p["unit"], p["range"], default, p["description"], p["source"])
    return rows


def _prior_table(priors: Mapping[str, Mapping[str, Any]]) -> object:
    """Where each parameter is looked for; on a log scale the departures are factors."""
    rows = table(("looked for", "from", "to", "scale", "noticeable"))
    for name, prior in priors.items():
        scale, times = ("log", "x ") if prior["is_log"] else ("linear", "")
        rows.add_row(name, f"{prior['low']:g}", f"{prior['high']:g}", scale, f"{times}{prior['noticeable']:g}")
    return rows


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
