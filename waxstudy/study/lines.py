"""The line of every key of a TOML text.

The standard parser gives the values but no places, so the text is parsed a second time into a syntax tree.
"""

from __future__ import annotations

import tomllib

import tree_sitter_toml
from tree_sitter import Language, Node, Parser

KeyPath = tuple[str | int, ...]

DEEPEST = 20  # deeper values are refused, so their keys need no line

KEYS = ("bare_key", "quoted_key", "dotted_key")


def key_lines(text: str) -> dict[KeyPath, int]:
    """Return the first line of each key, table and list entry of a valid TOML text.

    >>> key_lines("[a]\\nb.c = [{ d = 1 }]")
    {('a',): 1, ('a', 'b'): 2, ('a', 'b', 'c'): 2, ('a', 'b', 'c', 0): 2, ('a', 'b', 'c', 0, 'd'): 2}
    """
    tree = Parser(Language(tree_sitter_toml.language())).parse(text.encode())
    walk = _Walk()
    for node in tree.root_node.named_children:
        walk.statement(node, ())
    return walk.lines


class _Walk:
    def __init__(self) -> None:
        self.lines: dict[KeyPath, int] = {}
        self.counts: dict[KeyPath, int] = {}  # entries so far of each [[array of tables]]

    def statement(self, node: Node, table: KeyPath) -> None:
        """Note `key = value`, `[table]` or `[[table]]`."""
        if node.type == "pair":
            path = self.note(node, table)
            self.value(node.named_children[-1], path)
        elif node.type in ("table", "table_array_element"):
            path = self.note(node, ())
            if node.type == "table_array_element":
                path = self.next_entry(path, node)
            for inner in node.named_children[1:]:
                self.statement(inner, path)

    def value(self, node: Node, path: KeyPath) -> None:
        """Note what is inside a list or an inline table."""
        if node.type == "inline_table":
            for pair in node.named_children:
                self.statement(pair, path)
        elif node.type == "array":
            entries = [inner for inner in node.named_children if inner.type != "comment"]
            for i, inner in enumerate(entries):
                self.lines[(*path, i)] = inner.start_point.row + 1
                self.value(inner, (*path, i))

    def note(self, node: Node, table: KeyPath) -> KeyPath:
        """Note the key at the start of a statement and return its path."""
        path = table
        for key in _keys(node.named_children[0])[:DEEPEST]:
            if path in self.counts:  # a key of an array of tables belongs to its last entry
                path = (*path, self.counts[path] - 1)
            path = (*path, key)
            self.lines.setdefault(path, node.start_point.row + 1)
        return path

    def next_entry(self, path: KeyPath, node: Node) -> KeyPath:
        entry = self.counts.get(path, 0)
        self.counts[path] = entry + 1
        self.lines[(*path, entry)] = node.start_point.row + 1
        return (*path, entry)


def _keys(node: Node) -> list[str]:
    """Return the parts of a bare, quoted or dotted key; the standard parser knows how to unquote them."""
    keys: list[str] = []
    table = tomllib.loads(f"{(node.text or b'').decode()} = 0") if node.type in KEYS else 0
    while isinstance(table, dict):
        [(key, table)] = table.items()
        keys.append(key)
    return keys
