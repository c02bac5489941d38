"""The keys of study files and of dataset.toml, read from the schemas that editors use."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

from docs_site.tables import plain, table
from waxstudy.believing.tolerance import SPREADS
from waxstudy.dataset.schema import dataset_schema
from waxstudy.plugin import CHAIN
from waxstudy.plugin.registry import installed
from waxstudy.study.schema import schema

Node = Mapping[str, Any]
HEAD = ("key", "what it is", "default", "allowed", "source")
BLOCKS = {*CHAIN, "room", "weather"}
# a key's description as the schema composes it
PARTS = re.compile(r"^(?P<what>.*?)(?: Default: (?P<default>.*?)\.)?(?: Source: (?P<source>.*?)\.?)?$", re.DOTALL)


def study_keys() -> str:
    """Return the page of a study file's keys."""
    intro = "Every key of a study file. [The study file](../study-file.md) says how they go together.\n\n"
    return "# Keys of a study\n\n" + intro + "\n".join(_tables(schema(installed())["properties"]))


def dataset_keys() -> str:
    """Return the page of the keys of dataset.toml."""
    intro = "Every key of `dataset.toml`. [Datasets](../datasets.md) says how they go together.\n\n"
    tables = "\n".join(_tables(dataset_schema(installed())["properties"]))
    return f"# Keys of a dataset\n\n{intro}{tables}\n{_spreads()}"


def _spreads() -> str:
    about = "What each guess of `waxstudy believe` adds to an uncertainty of the room, as squares: the spread of the"
    rows = [(f"`{each.key}`", f"`{each.unknown}`", f"{each.spread:g}", plain(each.why)) for each in SPREADS]
    widens = table(("guessed", "widens", "by", "why"), rows)
    return f"## What guesses widen\n\n{about} logarithm.\n\n{widens}"


def _tables(properties: Mapping[str, Node], parent: str = "") -> Iterator[str]:
    for name, node in properties.items():
        yield from _section(f"{parent}{name}", node)


def _section(path: str, node: Node) -> Iterator[str]:
    """A table of the file with its keys, and then the tables inside it."""
    heading = f"`[{path}]`"
    about = str(node.get("description", ""))
    yield f"## {heading}\n"
    yield f"{_block(node) or plain(about.removeprefix(heading).removeprefix(': '))}\n"
    keys = {name: key for name, key in node.get("properties", {}).items() if not _is_table(key)}
    if keys:
        yield table(HEAD, [row(name, key, name in node.get("required", [])) for name, key in keys.items()])
    inner = {name: key for name, key in node.get("properties", {}).items() if _is_table(key)}
    further = node.get("additionalProperties")
    if isinstance(further, Mapping) and (_is_table(further) or "$ref" in further):
        inner["NAME"] = further
    yield from _tables(inner, f"{path}.")


def _is_table(node: Node) -> bool:
    return node.get("type") == "object" and bool(node.get("properties") or node.get("additionalProperties"))


def _block(node: Node) -> str:
    """What a block says, whose keys depend on the component that it uses; empty for other nodes."""
    kind = str(node.get("$ref", "")).rpartition("/")[2].removeprefix("step.")
    return f"`use` names the {kind}; its keys are in [Components](components.md#{kind})." if kind in BLOCKS else ""


def row(name: str, node: Node, is_required: bool = False) -> tuple[str, ...]:
    """Return a key's row: what it is with its unit, default, what is allowed, and where it comes from."""
    found = PARTS.match(node.get("description", ""))
    what, source = (plain(found[part] or "") for part in ("what", "source")) if found else ("", "")
    default = "required" if is_required else f"`{json.dumps(node['default'])}`" if "default" in node else ""
    return (f"`{name}`", _block(node) or what, default, _allowed(node), source)


def _allowed(node: Node) -> str:
    """What values a key takes, in words."""
    if "enum" in node:
        return ", ".join(f"`{json.dumps(value)}`" for value in node["enum"])
    if "anyOf" in node:
        return " or ".join(dict.fromkeys(filter(None, map(_allowed, filter(_is_node, node["anyOf"])))))
    if node.get("type") == "array":
        inner = node.get("items")
        return "list of " + (_allowed(inner) if isinstance(inner, Mapping) else "values")
    if "properties" in node:
        return "table of " + ", ".join(f"`{name}`" for name in node["properties"])
    return _range(node) or WORDS.get(str(node.get("type")), "")


WORDS = {"string": "text", "number": "a number", "integer": "a whole number", "boolean": "true or false"} | {
    "object": "table"
}
BOUNDS = {"minimum": "at least", "exclusiveMinimum": "more than", "maximum": "at most", "exclusiveMaximum": "less than"}


def _range(node: Node) -> str:
    said = [f"{word} {node[bound]:g}" for bound, word in BOUNDS.items() if bound in node]
    whole = "a whole number, " if node.get("type") == "integer" else ""
    return whole + ", ".join(said) if said else ""


def _is_node(node: object) -> bool:
    return isinstance(node, Mapping)
